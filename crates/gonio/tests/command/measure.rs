//! `gonio measure`: readings that are known in closed form.

use crate::support::{BALL, Place, panorama};
use serde_json::Value;
use std::f64::consts::PI;

/// Red, and its standard error where the reading was sampled.
fn red(reading: &Value) -> (f64, Option<f64>) {
    (
        reading["value"][0].as_f64().unwrap(),
        reading["standard_error"][0].as_f64(),
    )
}

/// Whether a reading is within 5 standard errors, or 1e-5 where it has none to speak of.
fn agrees(reading: &Value, expected: f64) -> bool {
    let (value, error) = red(reading);
    (value - expected).abs() <= 5.0 * error.unwrap_or(0.0) + 1e-5 * expected
}

#[test]
fn irradiance_under_uniform_radiance_is_pi() {
    let place = Place::new();
    let said = place.good(&["measure", "irradiance", "--env", "uniform:1"]);
    assert_eq!(said.out, "irradiance: 3.141593 W m⁻²\n");
    let reading = place.json(&["measure", "irradiance", "--env", "uniform:1", "--json"]);
    assert!((red(&reading).0 - PI).abs() < 1e-12);
    assert_eq!(reading["unit"], "W m⁻²");
    assert!(reading["standard_error"].is_null());
}

#[test]
fn readings_of_a_bare_environment() {
    let place = Place::new();
    let file = place.picture("sky.exr", &panorama());
    let [up, down] = ["0,1,0", "0,-1,0"].map(|normal| {
        red(&place.json(&[
            "measure",
            "irradiance",
            "--env",
            &file,
            "--normal",
            normal,
            "--json",
        ]))
        .0
    });
    // The sky has 2, the ground ½.
    assert!(
        (up / PI - 2.0).abs() < 0.1 && (down / PI - 0.5).abs() < 0.1,
        "{up} {down}"
    );
    let l = place.json(&[
        "measure",
        "radiance",
        "--env",
        "uniform:7",
        "--direction",
        "0,0,-1",
        "--json",
    ]);
    assert_eq!(
        (l["unit"].as_str().unwrap(), red(&l).0),
        ("W m⁻² sr⁻¹", 7.0)
    );
    let flux = place.json(&[
        "measure",
        "flux",
        "--env",
        "uniform:1",
        "--corner",
        "0,0,0",
        "--side-u",
        "0,0,2",
        "--side-v",
        "3,0,0",
        "--json",
    ]);
    assert_eq!(flux["unit"], "W");
    assert!(agrees(&flux, 6.0 * PI), "{flux}");
}

/// A point light of 4 W/sr at a distance of 2: E = I cosθ / r² = 1, and its flux is 16π W.
#[test]
fn a_point_light() {
    let place = Place::new();
    let light = "[[light]]\nkind = \"point\"\nposition = [0, 2, 0]\nintensity = 4\n\n\
                 [[material]]\nname = \"grey\"\nmodel = \"lambertian\"\nparams = { reflectance = 0.5 }\n\n\
                 [[shape]]\nkind = \"rectangle\"\nmaterial = \"grey\"\nrotate_deg = [-90, 0, 0]\n";
    let scene = place.write("light.toml", light);
    let irradiance = |more: &[&str]| {
        place.json(
            &[
                &[
                    "measure",
                    "irradiance",
                    &scene,
                    "--json",
                    "--samples",
                    "4096",
                ],
                more,
            ]
            .concat(),
        )
    };
    assert!(agrees(&irradiance(&[]), 1.0));
    assert!(agrees(&irradiance(&["--direct"]), 1.0));
    // At 60° to the light half of it.
    assert!(agrees(
        &irradiance(&["--normal", "0.8660254,0.5,0", "--direct"]),
        0.5
    ));
    let flux = place.json(&["measure", "flux", &scene, "--light", "0", "--json"]);
    assert!((red(&flux).0 - 16.0 * PI).abs() < 1e-5, "{flux}");
    let exitance = place.json(&[
        "measure",
        "exitance",
        &scene,
        "--point",
        "0,0,0",
        "--normal",
        "0,1,0",
        "--samples",
        "4096",
        "--json",
    ]);
    assert_eq!(exitance["quantity"], "radiant exitance");
    assert!(agrees(&exitance, 0.5), "{exitance}");
    // L = albedo E / π.
    let seen = [
        "measure",
        "radiance",
        &scene,
        "--origin",
        "0,1,0",
        "--direction",
        "0,-1,0",
    ];
    let radiance = place.json(&[&seen[..], &["--samples", "64", "--json"]].concat());
    assert!(agrees(&radiance, 0.5 / PI), "{radiance}");
    let text = place.good(&seen).out;
    assert!(
        text.contains("W m⁻² sr⁻¹") && text.contains("standard error"),
        "{text}"
    );
    place.bad(
        &["measure", "flux", &scene, "--light", "1"],
        2,
        &["--light 0"],
    );
    place.bad(
        &[
            "measure", "exitance", &scene, "--point", "0,1,0", "--normal", "0,1,0",
        ],
        2,
        &["no surface", "--distance"],
    );
}

#[test]
fn the_same_seed_gives_the_same_reading() {
    let place = Place::new();
    let scene = place.write("ball.toml", BALL);
    let read = |seed: &str| {
        place
            .good(&[
                "measure",
                "irradiance",
                &scene,
                "--point",
                "0,3,0",
                "--normal",
                "0,-1,0",
                "--samples",
                "2048",
                "--seed",
                seed,
            ])
            .out
    };
    assert_eq!(read("1"), read("1"));
    assert_ne!(read("1"), read("2"));
}

#[test]
fn the_scenes_environment_turns() {
    let place = Place::new();
    // Bright towards −x, the left quarter.
    let image = gonio::image::Image::from_fn(16, 8, |x, _| {
        if (2..6).contains(&x) {
            [1.0; 3]
        } else {
            [0.0; 3]
        }
    });
    place.picture("side.hdr", &image);
    let scene = place.write(
        "ball.toml",
        BALL.replace("uniform = 1.0", "file = \"side.hdr\""),
    );
    let read = |degrees: &str| {
        red(&place.json(&[
            "measure",
            "irradiance",
            &scene,
            "--point",
            "0,5,0",
            "--normal",
            "-1,0,0",
            "--env-rotate",
            degrees,
            "--direct",
            "--json",
        ]))
        .0
    };
    assert!(read("0") > 10.0 * read("180").max(1e-3));
}

#[test]
fn a_dark_scene_is_read_as_dark_and_says_so() {
    let place = Place::new();
    let scene = place.write("ball.toml", BALL.replace("uniform = 1.0", "uniform = 0.0"));
    let said = place.good(&[
        "measure",
        "irradiance",
        &scene,
        "--point",
        "0,2,0",
        "--samples",
        "16",
    ]);
    assert!(
        said.err.starts_with("warning: the scene has no light"),
        "{said:?}"
    );
    assert!(said.out.contains("irradiance: 0 ± 0 W m⁻²"), "{said:?}");
}
