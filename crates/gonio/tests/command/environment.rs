//! `gonio env info`.

use crate::support::{BALL, Place, panorama, tiny};

#[test]
fn a_panorama_is_described() {
    let place = Place::new();
    let file = place.picture("sky.exr", &panorama());
    let text = place.good(&["env", "info", &file]).out;
    for word in ["lat-long", "16", "irradiance +y", "W m⁻²", "mean radiance"] {
        assert!(text.contains(word), "no {word}: {text}");
    }
    let info = place.json(&["env", "info", &file, "--json"]);
    assert_eq!((&info["width"], &info["height"]), (&16.into(), &8.into()));
    assert_eq!(info["layout"], "lat-long");
    // The upper half shines with 2, and half of the horizon's row of texels blends into the lower: below 2π.
    let up = info["irradiance"][2][0].as_f64().unwrap();
    assert!(up > 5.9 && up < 6.29, "{up}");
    assert_eq!(
        place.json(&["env", "info", "uniform:1/2/3", "--json"])["mean_radiance"],
        serde_json::json!([1.0, 2.0, 3.0])
    );
}

#[test]
fn nan_and_infinite_texels_are_named_and_can_be_replaced() {
    let place = Place::new();
    for (name, value, word) in [
        ("nan.exr", f32::NAN, "NaN"),
        ("inf.exr", f32::INFINITY, "inf"),
        ("negative.exr", -1.0, "-1"),
    ] {
        let mut image = panorama();
        image.set(5, 3, [1.0, value, 1.0]);
        let layers = gonio::image::Layers::from_image(&image);
        layers.write_exr(&place.path().join(name)).unwrap();
        let words = [name, "(5, 3)", "G", word, "--env-sanitize"];
        place.bad(&["env", "info", name], 3, &words);
        place.bad(&["render", "--env", name], 3, &words);
        place.bad(&["measure", "irradiance", "--env", name], 3, &words);
        let info = place.json(&["env", "info", name, "--env-sanitize", "--json"]);
        let replaced =
            ["non_finite_replaced", "negative_replaced"].map(|k| info[k].as_u64().unwrap());
        assert_eq!(replaced.iter().sum::<u64>(), 1, "{name}: {replaced:?}");
        let replaced = "warning: one unsound texel of the panorama was replaced\n";
        let said = place.good(&["measure", "irradiance", "--env", name, "--env-sanitize"]);
        assert_eq!(said.err, replaced);
        let said = place.good(&tiny(&["--env", name, "--env-sanitize"]));
        assert_eq!(said.err, replaced);
        let own = BALL.replace("uniform = 1.0", &format!("file = \"{name}\""));
        let scene = place.write("own.toml", own);
        place.bad(&["render", &scene], 3, &words);
        assert!(
            place
                .good(&tiny(&[&scene, "--env-sanitize"]))
                .err
                .contains(replaced)
        );
    }
}

#[test]
fn a_layout_that_cannot_be_told_is_asked_for() {
    let place = Place::new();
    let file = place.picture("square.exr", &gonio::image::Image::filled(8, 8, [1.0; 3]));
    place.bad(&["env", "info", &file], 3, &["8 × 8", "--env-layout"]);
    for layout in ["angular", "mirror-ball", "lat-long"] {
        let info = place.json(&["env", "info", &file, "--env-layout", layout, "--json"]);
        assert_eq!(info["layout"], layout);
    }
}
