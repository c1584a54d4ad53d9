//! `gonio brdf plot`.

use crate::support::{Place, panorama};

const KINDS: [&str; 7] = [
    "polar",
    "cartesian",
    "albedo",
    "slice",
    "lobe3d",
    "sphere",
    "difference",
];

/// Arguments for a small plot.
fn small<'a>(functions: &[&'a str], kind: &'a str, output: &'a str) -> Vec<&'a str> {
    let options = ["--kind", kind, "--size", "400x300", "-o", output];
    [&["brdf", "plot"], functions, &options].concat()
}

#[test]
fn each_kind_is_written_as_svg_and_png() {
    let place = Place::new();
    let two = ["ggx:metal=gold,roughness=0.3", "oren-nayar"];
    for kind in KINDS {
        let svg = format!("{kind}.svg");
        let said = place.good(&small(&two, kind, &svg));
        assert_eq!(said.out, "", "{kind}");
        let text = String::from_utf8(place.read(&svg)).unwrap();
        assert!(
            text.starts_with("<svg ") && text.ends_with("</svg>\n"),
            "{kind}"
        );
        assert!(text.contains("oren-nayar"), "{kind}");
        let png = format!("{kind}.PNG");
        let arguments = small(&two, kind, &png);
        place.good(&[&arguments[..], &["--density", "1"]].concat());
        let image = place.image(&png);
        assert_eq!((image.width, image.height), (400, 300), "{kind}");
    }
    // Nothing temporary is left.
    assert_eq!(place.files().len(), 2 * KINDS.len());
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let place = Place::new();
    let arguments = ["ggx:roughness=0.2"];
    for kind in ["polar", "albedo", "slice", "sphere"] {
        for (threads, name) in [("1", "one.png"), ("3", "three.png")] {
            let mut command = place.command(&small(&arguments, kind, name));
            let output = command.env("RAYON_NUM_THREADS", threads).output().unwrap();
            assert!(output.status.success(), "{kind}");
        }
        assert!(place.read("one.png") == place.read("three.png"), "{kind}");
    }
}

#[test]
fn measured_files_and_glass_are_drawn() {
    let place = Place::new();
    let resolution = ["--resolution", "12x12x24"];
    let convert = ["brdf", "convert", "ggx:roughness=0.5", "m.gonio"];
    place.good(&[&convert[..], &resolution].concat());
    let functions = [
        "m.gonio",
        "ggx:roughness=0.5",
        "rough-dielectric:roughness=0.4",
    ];
    place.good(&small(&functions, "polar", "a.svg"));
    let text = String::from_utf8(place.read("a.svg")).unwrap();
    assert!(text.contains("m.gonio") && text.contains("inside"));
}

#[test]
fn a_ball_under_a_panorama() {
    let place = Place::new();
    place.picture("sky.hdr", &panorama());
    for (light, name) in [
        ("sky.hdr", "a.png"),
        ("panorama", "b.png"),
        ("uniform:1", "c.png"),
    ] {
        let arguments = [
            "brdf",
            "plot",
            "lambertian:0.8",
            "mirror",
            "--kind",
            "sphere",
            "--light",
            light,
            "--size",
            "300x240",
            "--density",
            "1",
            "-o",
            name,
        ];
        place.good(&arguments);
        assert_eq!(place.image(name).width, 300);
    }
}

#[test]
fn a_mirror_is_an_arrow_or_an_error() {
    let place = Place::new();
    let said = place.good(&small(&["mirror"], "polar", "a.svg"));
    assert!(said.err.contains("note: Arrow: a Dirac delta"), "{said:?}");
    for kind in ["slice", "lobe3d"] {
        place.bad(
            &small(&["mirror"], kind, "b.svg"),
            2,
            &["mirror", "Dirac deltas", "--kind"],
        );
    }
}

#[test]
fn bad_arguments() {
    let place = Place::new();
    std::fs::create_dir(place.path().join("folder.svg")).unwrap();
    let one = ["lambertian"];
    let nine = ["lambertian"; 9];
    place.bad(
        &small(&nine, "polar", "a.svg"),
        2,
        &["9 functions", "at most 8"],
    );
    place.bad(
        &small(&one, "pola", "a.svg"),
        2,
        &["pola", "did you mean 'polar'?"],
    );
    place.bad(
        &small(&one, "polar", "a.pdf"),
        2,
        &["can't be written as .pdf", ".svg or .png"],
    );
    place.bad(&small(&one, "polar", "a.pgn"), 2, &["did you mean .png?"]);
    place.bad(&small(&one, "polar", "a"), 2, &["no extension"]);
    place.bad(
        &small(&one, "polar", "nowhere/a.svg"),
        3,
        &["nowhere", "does not exist"],
    );
    place.bad(
        &small(&one, "polar", "folder.svg"),
        3,
        &["this is a folder"],
    );
    place.bad(
        &small(&one, "difference", "a.svg"),
        2,
        &["1 reflection functions", "2 to compare"],
    );
    place.bad(
        &small(&["lambertian"; 3], "difference", "a.svg"),
        2,
        &["2 to compare"],
    );
    place.bad(
        &small(&["lambertain"], "polar", "a.svg"),
        2,
        &["did you mean"],
    );
    place.bad(&small(&["gone.bsdf"], "polar", "a.svg"), 3, &["gone.bsdf"]);
    place.bad(&["brdf", "plot", "-o", "a.svg"], 2, &["missing"]);
    place.bad(&["brdf", "plot", "lambertian"], 2, &["missing", "--output"]);
    for (option, value, word) in [
        ("--theta", "90", "but not 90°"),
        ("--theta", "-10", "0° to 180°"),
        ("--theta", "1,2,3,4,5,6,7,8,9", "at most 8"),
        ("--theta", "x", "finite number"),
        ("--phi", "nan", "finite number"),
        ("--channel", "grey", "grey"),
        ("--scale", "logg", "did you mean 'log'?"),
        ("--size", "10x10", "200 to 10000"),
        ("--size", "wide", "WIDTHxHEIGHT"),
        ("--density", "9", "1 to 8"),
    ] {
        let arguments = ["brdf", "plot", "lambertian", "-o", "a.svg", option, value];
        place.bad(&arguments, 2, &[word]);
    }
    let arguments = small(&one, "sphere", "a.png");
    place.bad(
        &[&arguments[..], &["--light", "gone.hdr"]].concat(),
        3,
        &["gone.hdr"],
    );
}

/// What stood there stays when a plot fails.
#[test]
fn a_failure_leaves_the_old_file() {
    let place = Place::new();
    place.write("a.svg", "old");
    place.bad(&small(&["mirror"], "slice", "a.svg"), 2, &["mirror"]);
    assert_eq!(place.read("a.svg"), b"old");
}

/// A shader that ends for some directions only is an error, not a gap in a curve.
#[test]
fn a_shader_that_does_not_end_is_not_drawn() {
    let place = Place::new();
    place.write(
        "stuck.wgsl",
        "fn eval(wi: vec3f, wo: vec3f) -> vec3f {\n  var x = wi;\n  while x.x > 0.6 && x.x < 0.65 { x.y += 1.0; }\n  return x;\n}",
    );
    let arguments = ["brdf", "plot", "stuck.wgsl:step_limit=1000", "-o", "a.svg"];
    place.bad(
        &arguments,
        3,
        &["did not end after 1000 steps, in the loop at line 3"],
    );
}
