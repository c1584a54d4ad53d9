//! Scene files that are wrong: the line is shown, with the word that was probably meant.

use crate::support::{BALL, Place, tiny};

#[test]
fn mistakes_show_their_line() {
    let place = Place::new();
    for (right, wrong, words) in [
        (
            "[[shape]]",
            "[[shpe]]",
            &["shpe", "did you mean `shape`?"][..],
        ),
        (
            "material = \"grey\"",
            "materal = \"grey\"",
            &["materal", "did you mean `material`?"],
        ),
        (
            "material = \"grey\"",
            "material = \"gray\"",
            &["gray", "did you mean `grey`?"],
        ),
        (
            "kind = \"sphere\"",
            "kind = \"spere\"",
            &["spere", "sphere"],
        ),
        (
            "model = \"lambertian\"",
            "model = \"lambertan\"",
            &["lambertan", "did you mean `lambertian`?"],
        ),
        (
            "reflectance = 0.5",
            "reflectanse = 0.5",
            &["reflectanse", "did you mean `reflectance`?"],
        ),
        (
            "reflectance = 0.5",
            "reflectance = -1",
            &["reflectance", "-1"],
        ),
        (
            "reflectance = 0.5",
            "reflectance = nan",
            &["reflectance", "nan"],
        ),
        ("uniform = 1.0", "uniform = inf", &["uniform", "inf"]),
        (
            "uniform = 1.0",
            "unifrom = 1.0",
            &["did you mean `uniform`?"],
        ),
        (
            "uniform = 1.0",
            "file = \"nowhere.hdr\"",
            &["nowhere.hdr", "relative to the folder"],
        ),
        ("uniform = 1.0", "uniform = ", &["TOML"]),
        (
            "kind = \"sphere\"",
            "kind = \"mesh\"\nfile = \"nowhere.ply\"",
            &["nowhere.ply"],
        ),
        (
            "kind = \"sphere\"",
            "kind = \"sphere\"\nscale = 0",
            &["flattens"],
        ),
        (
            "kind = \"sphere\"",
            "kind = \"sphere\"\ntranslate = [0, nan, 0]",
            &["translate"],
        ),
    ] {
        assert!(BALL.contains(right), "{right}");
        let file = place.write("wrong.toml", BALL.replacen(right, wrong, 1));
        let said = place.bad(&tiny(&[&file]), 3, words);
        // The file, and the line: "wrong.toml:17:…", but for files that it names.
        assert!(
            said.err.contains("wrong.toml:") || wrong.contains("nowhere"),
            "{said:?}"
        );
        place.bad(&["measure", "irradiance", &file], 3, words);
    }
}

#[test]
fn rough_models_refuse_impossible_roughness() {
    let place = Place::new();
    for value in ["-1", "nan", "inf", "2", "\"rough\""] {
        let text = BALL
            .replace("lambertian", "ggx")
            .replace("reflectance = 0.5", &format!("roughness = {value}"));
        let file = place.write("wrong.toml", text);
        place.bad(&tiny(&[&file]), 3, &["wrong.toml:", "roughness"]);
    }
}

#[test]
fn empty_scenes_have_nothing_to_render() {
    let place = Place::new();
    for (name, text) in [
        ("empty.toml", "name = \"nothing\"\n"),
        ("empty.obj", "# nothing\n"),
        ("empty.gltf", r#"{"asset": {"version": "2.0"}}"#),
    ] {
        let file = place.write(name, text);
        place.bad(&tiny(&[&file]), 3, &["empty"]);
    }
    // An environment alone is something to see.
    let file = place.write("sky.toml", "[environment]\nuniform = 1.0\n");
    place.good(&tiny(&[&file]));
}

#[test]
fn warnings_come_once() {
    let place = Place::new();
    let scene = place.write("dark.toml", BALL.replace("uniform = 1.0", "uniform = 0.0"));
    for more in [&[][..], &["-q"], &["--json"]] {
        let said = place.good(&tiny(&[&[scene.as_str()], more].concat()));
        assert_eq!(
            said.err.matches("warning: the scene has no light").count(),
            1,
            "{said:?}"
        );
    }
    let json = place.json(&tiny(&[&scene, "--json"]));
    assert_eq!(json["warnings"].as_array().unwrap().len(), 1);
}
