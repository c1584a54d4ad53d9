//! `gonio env prefilter`, `sh`, `lights` and `irradiance`.

use crate::support::{BALL, Place, panorama};
use gonio::image::{CubeMap, Image};

/// What makes a run small.
const SMALL: [&str; 6] = ["--size", "16", "--diffuse-size", "16", "--dfg-size", "8"];

#[test]
fn each_target_gets_its_files() {
    let place = Place::new();
    let sky = place.picture("sky.exr", &panorama());
    for (target, map) in [
        ("gltf", "ktx2"),
        ("three", "exr"),
        ("filament", "ktx2"),
        ("unreal", "dds"),
        ("unity", "dds"),
        ("custom", "ktx2"),
    ] {
        let mut words = vec![
            "env",
            "prefilter",
            &sky,
            "-o",
            target,
            "--for",
            target,
            "--json",
        ];
        words.extend(SMALL);
        let report = place.json(&words);
        assert_eq!(report["target"], target);
        for l in report["levels"].as_array().unwrap() {
            // See the tests of gonio-ibl.
            let error = l["error"]["mean"].as_f64().unwrap_or(0.0);
            assert!(error < 5e-3, "{l}");
        }
        let specular = place.path().join(target).join(format!("specular.{map}"));
        if map == "exr" {
            let atlas = Image::read(&specular).unwrap();
            assert_eq!((atlas.width, atlas.height), (336, 64));
        } else {
            let cube = CubeMap::read(&specular).unwrap();
            assert_eq!((cube.size, cube.levels.len()), (16, 5));
            // The upper half shines with 2, the lower with 0.5: the roughest level is between.
            let top = cube.levels[4][if target == "unreal" { 4 } else { 2 }].get(0, 0)[0];
            let side = cube.levels[4][0].get(0, 0)[0];
            assert!(
                top > 1.5 && top <= 2.01 && side < top,
                "{target}: {top} {side}"
            );
        }
        for file in ["harmonics.json", "dfg.exr", "report.json"] {
            assert!(
                place.path().join(target).join(file).is_file(),
                "{target}/{file}"
            );
        }
    }
}

#[test]
fn harmonics_are_printed_and_written() {
    let place = Place::new();
    let text = place.good(&["env", "sh", "uniform:1", "--irradiance"]).out;
    // π √4π.
    assert!(text.contains("11.136"), "{text}");
    let json = place.json(&[
        "env",
        "sh",
        "uniform:1",
        "--for",
        "filament",
        "-o",
        "sh.json",
        "--json",
    ]);
    let first = json["coefficients"][0][0].as_f64().unwrap();
    assert!((first - 1.0).abs() < 1e-4, "{first}");
    let file: serde_json::Value = serde_json::from_slice(&place.read("sh.json")).unwrap();
    assert_eq!(file["coefficients"], json["coefficients"]);
}

#[test]
fn lights_are_those_of_a_scene() {
    let place = Place::new();
    let sky = place.picture("sky.exr", &panorama());
    let json = place.json(&["env", "lights", "8", &sky, "-o", "lights.toml", "--json"]);
    let lights = json["lights"].as_array().unwrap();
    assert_eq!(lights.len(), 8);
    let lights = String::from_utf8(place.read("lights.toml")).unwrap();
    let scene = place.write("scene.toml", format!("{BALL}\n{lights}"));
    place.good(&crate::support::tiny(&[&scene]));
    let median = place.json(&["env", "lights", "8", &sky, "--method", "median", "--json"]);
    assert!(median["mean_error"].as_f64().unwrap() < 0.5);
}

#[test]
fn irradiance_is_printed_and_mapped() {
    let place = Place::new();
    let up = place.json(&[
        "env",
        "irradiance",
        "uniform:1",
        "--normal",
        "0,2,0",
        "--json",
    ]);
    assert_eq!(
        up[0]["irradiance"][0].as_f64().unwrap(),
        std::f64::consts::PI
    );
    place.good(&[
        "env",
        "irradiance",
        "uniform:1",
        "-o",
        "e.exr",
        "--size",
        "4",
    ]);
    let map = place.image("e.exr");
    assert_eq!((map.width, map.height), (8, 4));
    for p in map.pixels {
        assert!((p[0] - std::f32::consts::PI).abs() < 1e-4, "{p:?}");
    }
    place.good(&[
        "env",
        "irradiance",
        "uniform:2",
        "-o",
        "g.dds",
        "--exponent",
        "9",
        "--size",
        "4",
    ]);
    let cube = CubeMap::read(&place.path().join("g.dds")).unwrap();
    assert!((cube.levels[0][3].get(1, 2)[2] - 2.0).abs() < 1e-4);
}

#[test]
fn bad_arguments_are_refused_before_work() {
    let place = Place::new();
    let prefilter = |more: &[&'static str]| {
        let mut words = vec!["env", "prefilter", "uniform:1", "-o", "out"];
        words.extend(more);
        words
    };
    for (more, word) in [
        (&["--for", "godot"][..], "godot"),
        (&["--size", "100"], "power of two"),
        (&["--size", "8"], "16 to 4096"),
        (&["--kernel", "mirror"], "roughness"),
        (&["--kernel", "ggx:anisotropy=0.5"], "anisotropic"),
        (&["--kernel", "nosuch"], "nosuch"),
        (&["--samples", "0"], "samples"),
        (&["--tolerance", "9"], "tolerance"),
        (&["--bands", "11"], "1 to 10"),
        (&["--window", "hamming"], "hann"),
        (&["--dfg-size", "0"], "table"),
        (&["--dfg-model", "lambertian"], "roughness"),
        (&["--diffuse-size", "5"], "diffuse"),
        (&["--format", "bc7"], "bc6h"),
        (&["--samples", "9", "--reference"], "--reference"),
    ] {
        place.bad(&prefilter(more), 2, &[word]);
        assert!(!place.path().join("out").exists(), "{more:?}");
    }
    place.bad(
        &["env", "prefilter", "nosuch.hdr", "-o", "x"],
        3,
        &["nosuch.hdr"],
    );
    place.bad(
        &["env", "prefilter", "uniform:1", "-o", "no/such"],
        3,
        &["no"],
    );
    place.bad(&["env", "sh", "uniform:1", "--bands", "0"], 2, &["1 to 10"]);
    place.bad(
        &["env", "sh", "uniform:1", "--for", "unity", "--irradiance"],
        2,
        &["--irradiance"],
    );
    place.bad(&["env", "sh", "uniform:1", "-o", "sh.txt"], 2, &["json"]);
    place.bad(&["env", "lights", "0", "uniform:1"], 2, &["1 to 4096"]);
    place.bad(&["env", "lights", "4", "uniform:0"], 2, &["black"]);
    place.bad(
        &["env", "lights", "4", "uniform:1", "--method", "mean"],
        2,
        &["median"],
    );
    place.bad(
        &["env", "lights", "4", "uniform:1", "-o", "l.txt"],
        2,
        &["toml"],
    );
    place.bad(
        &["env", "irradiance", "uniform:1", "--normal", "0,0,0"],
        2,
        &["direction"],
    );
    place.bad(
        &["env", "irradiance", "uniform:1", "--exponent", "2"],
        2,
        &["output"],
    );
    place.bad(
        &["env", "irradiance", "uniform:1", "-o", "e.png"],
        2,
        &["png"],
    );
    place.bad(
        &[
            "env",
            "irradiance",
            "uniform:1",
            "-o",
            "e.exr",
            "--exponent",
            "-1",
        ],
        2,
        &["exponent = -1"],
    );
}
