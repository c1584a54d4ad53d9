//! `gonio brdf`.

use crate::support::Place;

#[test]
fn the_list_names_every_model() {
    let place = Place::new();
    let list = place.good(&["brdf", "list"]).out;
    let json = place.json(&["brdf", "list", "--json"]);
    let models = json.as_array().unwrap();
    assert!(models.len() >= 10);
    for model in models {
        let name = model["name"].as_str().unwrap();
        assert!(list.lines().any(|line| line.starts_with(name)), "{name}");
        for key in [
            "summary",
            "paper",
            "aliases",
            "parameters",
            "presets",
            "declares",
        ] {
            assert!(!model[key].is_null() || name == "table", "{name} {key}");
        }
    }
}

#[test]
fn each_model_can_be_shown_in_eighty_columns() {
    let place = Place::new();
    for name in gonio::brdf::registry::names() {
        let text = place.good(&["brdf", "show", name]).out;
        assert!(text.starts_with(&format!("{name}: ")), "{text}");
        assert!(text.contains("Source: "), "{text}");
        for line in text.lines() {
            // One word may be longer: a command to copy.
            assert!(
                line.chars().count() <= 80 || line.starts_with("Check it"),
                "{line}"
            );
        }
        assert_eq!(place.json(&["brdf", "show", name, "--json"])["name"], name);
    }
    let text = place.good(&["brdf", "show", "ggx:roughness=0.25"]).out;
    assert!(
        text.contains("here 0.25") && text.contains("default 0.04"),
        "{text}"
    );
}

#[test]
fn presets_are_counted_listed_and_shown() {
    let place = Place::new();
    // A line or two a model, not a line a preset.
    let list = place.good(&["brdf", "list"]).out;
    assert!(list.contains("86 presets, as ward@alum-bronze: gonio brdf list --presets ward"));
    assert!(!list.contains("gold-paint"), "{list}");
    let sets = place.good(&["brdf", "list", "--presets"]).out;
    assert!(
        sets.lines().any(|l| l.starts_with("cook-torrance@low-e1")),
        "{sets}"
    );
    let ward = place.good(&["brdf", "list", "--presets", "ward"]).out;
    assert!(
        ward.contains("gold-paint") && ward.lines().count() < 40,
        "{ward}"
    );
    assert!(ward.lines().all(|l| l.chars().count() <= 80), "{ward}");
    let json = place.json(&["brdf", "list", "--presets", "ward", "--json"]);
    assert_eq!(json[0]["presets"].as_array().unwrap().len(), 86);
    let shown = place.json(&["brdf", "show", "ward", "--json"]);
    assert_eq!(shown["presets"][0]["set"], "ngan");

    let text = place.good(&["brdf", "show", "ward@gold-paint"]).out;
    assert!(
        text.contains("here 0.234") && text.contains("(ngan: MERL materials"),
        "{text}"
    );
    // A sum: the named model is shown, with the whole beside it.
    let text = place
        .good(&["brdf", "show", "cook-torrance@gold-paint:alpha=0.3"])
        .out;
    assert!(
        text.starts_with("torrance-sparrow: ") && text.contains("here 0.3"),
        "{text}"
    );
    assert!(text.contains("sum(lambertian:"), "{text}");
    place.good(&[
        "brdf",
        "check",
        "cook-torrance@gold-paint",
        "--effort",
        "quick",
    ]);

    let nowhere = ["brdf", "list", "--presets", "lambertian"];
    place.bad(
        &nowhere,
        2,
        &["`lambertian` has no presets", "list --presets"],
    );
    place.bad(
        &["brdf", "list", "--presets", "wart"],
        2,
        &["did you mean `ward`?"],
    );
}

#[test]
fn values_for_a_pair_of_directions() {
    let place = Place::new();
    let half = "lambertian:reflectance=0.5";
    let text = place
        .good(&["brdf", "eval", half, "--wi", "0,0", "--wo", "0,0"])
        .out;
    assert!(text.contains("f            0.1591549 sr⁻¹"), "{text}");
    let value = |spec: &str, wi: &str, wo: &str, key: &str| {
        let json = place.json(&["brdf", "eval", spec, "--wi", wi, "--wo", wo, "--json"]);
        json[key]
            .as_array()
            .map_or(json[key].as_f64(), |rgb| rgb[0].as_f64())
            .unwrap()
    };
    let pi = std::f64::consts::PI;
    assert!((value(half, "60,0", "0", "f_per_sr") - 0.5 / pi).abs() < 1e-12);
    assert!((value(half, "60,0", "0", "f_cos_per_sr") - 0.25 / pi).abs() < 1e-12);
    assert!((value(half, "60,0", "0", "pdf_per_sr") - 0.5 / pi).abs() < 1e-12);
    // Below the horizon there is no reflection.
    assert_eq!(value(half, "120,0", "0", "f_per_sr"), 0.0);
    // A mirror's light is all in a Dirac delta.
    assert_eq!(value("mirror", "30,0", "30,180", "f_per_sr"), 0.0);
    assert!(
        place
            .good(&["brdf", "eval", "mirror", "--wi", "30,0", "--wo", "30,180"])
            .out
            .contains("Dirac")
    );
    // Gold is not grey.
    let gold = place
        .good(&[
            "brdf",
            "eval",
            "ggx:metal=gold",
            "--wi",
            "45,0",
            "--wo",
            "45,180",
        ])
        .out;
    assert!(gold.contains("(red, green, blue)"), "{gold}");
}

#[test]
fn every_model_is_as_it_declares() {
    let place = Place::new();
    let reports = place.json(&["brdf", "check", "all", "--effort", "quick", "--json"]);
    let reports = reports.as_array().unwrap();
    assert!(reports.len() >= 20);
    let mut declared = 0;
    for report in reports {
        for verdict in report["verdicts"].as_array().unwrap() {
            assert_ne!(verdict["outcome"], "fail", "{}", report["subject"]);
            declared += usize::from(verdict["outcome"] == "declared");
        }
    }
    // Toon is not physical, and says so.
    assert!(declared > 0);
    let one = place
        .good(&["brdf", "check", "toon", "--effort", "quick"])
        .out;
    assert!(one.contains("! lacks") && one.contains("PASS"), "{one}");
}

/// Tables are what was measured: they may reflect more than they receive, and the check says by how much.
#[test]
fn tables_are_checked_as_they_are() {
    let place = Place::new();
    let spec = format!(
        "table:file={}",
        place.write("bright.binary", bright_table())
    );
    let report = place
        .good(&["brdf", "check", &spec, "--effort", "quick"])
        .out;
    let energy = report.lines().find(|l| l.contains("energy")).unwrap();
    assert!(
        energy.contains("! lacks") && energy.contains("31.41"),
        "{energy}"
    );
}

/// A MERL table of a surface that reflects more than it receives: 90 × 90 × 180 values of 10 sr⁻¹ in each channel.
fn bright_table() -> Vec<u8> {
    let dimensions = [90_i32, 90, 180];
    let count = dimensions.iter().map(|d| *d as usize).product::<usize>();
    let scales = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
    let mut file: Vec<u8> = dimensions.iter().flat_map(|d| d.to_le_bytes()).collect();
    for scale in scales {
        for _ in 0..count {
            file.extend((10.0_f64 / scale).to_le_bytes());
        }
    }
    file
}

#[test]
fn damaged_tables_are_refused() {
    let place = Place::new();
    let sound = bright_table();
    for (name, bytes) in [
        ("empty", vec![]),
        ("short", sound[..1000].to_vec()),
        ("huge", [i32::MAX.to_le_bytes(); 3].concat()),
        ("negative", [(-90_i32).to_le_bytes(); 3].concat()),
    ] {
        let file = place.write(&format!("{name}.binary"), bytes);
        place.bad(
            &["brdf", "check", &format!("table:file={file}")],
            3,
            &[&file],
        );
    }
    place.bad(
        &["brdf", "check", "table:file=nowhere.binary"],
        3,
        &["nowhere.binary"],
    );
    place.bad(&["brdf", "check", "table"], 2, &["file"]);
}

#[test]
fn files_are_converted_and_shown() {
    let place = Place::new();
    let report = place.json(&[
        "brdf",
        "convert",
        "ggx:roughness=0.6,metal=gold",
        "gold.binary",
        "--resolution",
        "20x12x10",
        "--json",
    ]);
    assert_eq!(
        (&report["format"], &report["copied"]),
        (&"merl".into(), &false.into())
    );
    let error = report["difference"]["weighted_relative_rms"]
        .as_f64()
        .unwrap();
    assert!(error > 0.0 && error < 0.1, "{error}");
    let copied = place
        .good(&["brdf", "convert", "gold.binary", "gold.gonio"])
        .out;
    for words in ["gonio, ", "copied", "20 × 12 × 10", "RMS 0 sr⁻¹", "Albedo"] {
        assert!(copied.contains(words), "{copied} lacks {words}");
    }
    let info = place.good(&["brdf", "info", "gold.gonio"]).out;
    for words in [
        "half-difference",
        "theta_h",
        "red, green, blue",
        "sr⁻¹",
        "reciprocal by its layout",
        "read as MERL",
    ] {
        assert!(info.contains(words), "{info} lacks {words}");
    }
    let json = place.json(&["brdf", "info", "gold.binary", "--json"]);
    assert_eq!(
        (&json["format"], &json["negative"]),
        (&"merl".into(), &0.into())
    );
    assert_eq!(json["components"][0]["axes"][2]["name"], "phi_d");
    // What was made is a model.
    let f = place.json(&[
        "brdf",
        "eval",
        "table:gold.gonio",
        "--wi",
        "30,0",
        "--wo",
        "30,180",
        "--json",
    ]);
    assert!(f["f_per_sr"][0].as_f64().unwrap() > f["f_per_sr"][2].as_f64().unwrap());
    let help = place.good(&["brdf", "convert", "--help"]).out;
    for words in [".binary", ".xml", "tensor-tree-4", "Examples"] {
        assert!(help.contains(words), "{help} lacks {words}");
    }
    assert_eq!(place.files().len(), 2);
}

#[test]
fn conversions_that_make_no_sense_are_refused() {
    let place = Place::new();
    let convert = |rest: &[&str], code, words: &[&str]| {
        place.bad(&[&["brdf", "convert"], rest].concat(), code, words);
    };
    convert(
        &["ggx", "a.png"],
        2,
        &["a.png", "merl (.binary)", "convert --help"],
    );
    convert(
        &["ggx", "a.binary", "--parameterization", "klems-full"],
        2,
        &["merl", "klems-full"],
    );
    convert(
        &["ggx", "a.binary", "--resolution", "2x2"],
        2,
        &["3 numbers"],
    );
    convert(
        &["ggx", "a.binary", "--resolution", "two"],
        2,
        &["90x45x36"],
    );
    convert(&["gxg", "a.binary"], 2, &["gxg"]);
    convert(&["mirror", "a.binary"], 2, &["mirror"]);
    convert(&["nowhere.binary", "a.gonio"], 3, &["nowhere.binary"]);
    convert(
        &["ggx", "no/folder.binary", "--resolution", "4"],
        3,
        &["no/folder.binary"],
    );
    place.write("junk.binary", b"junk");
    place.bad(
        &["brdf", "info", "junk.binary"],
        3,
        &["junk.binary", "radiance", "merl", "utia"],
    );
    place.bad(&["brdf", "info", "."], 3, &["a folder"]);
}

#[test]
fn replaced_values_are_a_warning() {
    let place = Place::new();
    let mut file: Vec<u8> = [2_i32, 2, 2].iter().flat_map(|d| d.to_le_bytes()).collect();
    for k in 0..24 {
        file.extend((if k == 3 { -5.0_f64 } else { 500.0 }).to_le_bytes());
    }
    place.write("dark.binary", file);
    let said = place.good(&[
        "brdf",
        "eval",
        "table:dark.binary",
        "--wi",
        "0",
        "--wo",
        "0",
    ]);
    assert!(
        said.err
            .contains("warning: dark.binary: 1 of 24 values is negative and taken as 0"),
        "{said:?}"
    );
    let said = place.good(&["brdf", "convert", "dark.binary", "dark.gonio"]);
    assert!(
        said.err.contains("warning: dark.binary: 1 of 24"),
        "{said:?}"
    );
    place.bad(
        &["brdf", "check", "table:dark.binary,negative=refuse"],
        3,
        &["dark.binary", "node [0, 1, 1]", "channel 0"],
    );
}
