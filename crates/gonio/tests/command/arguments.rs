//! Arguments that make no sense: exit code 2, and a word that was probably meant.

use crate::support::Place;

#[test]
fn slips_of_the_pen_are_understood() {
    let place = Place::new();
    for (arguments, word) in [
        (vec!["rendr"], "did you mean 'render'?"),
        (vec!["list"], "did you mean 'gonio brdf list'?"),
        (
            vec!["irradiance"],
            "did you mean 'gonio env irradiance' or 'gonio measure irradiance'?",
        ),
        (vec!["brdf", "lst"], "did you mean 'list'?"),
        (vec!["measure", "irradance"], "did you mean 'irradiance'?"),
        (
            vec!["render", "--matrial", "ggx"],
            "did you mean '--material'?",
        ),
        (vec!["render", "--tonemap", "agxx"], "did you mean 'agx'?"),
        (
            vec!["render", "--integrator", "pth"],
            "did you mean 'path'?",
        ),
        (vec!["render", "--filter", "bx"], "did you mean 'box'?"),
        (
            vec!["render", "--light-choice", "unifrm"],
            "did you mean 'uniform'?",
        ),
        (
            vec!["render", "--sampler", "sobel"],
            "did you mean 'sobol'?",
        ),
        (
            vec!["render", "--material", "lambertan"],
            "did you mean `lambertian`?",
        ),
        (
            vec!["render", "--material", "ggx:roughnes=1"],
            "did you mean `roughness`?",
        ),
        (
            vec!["render", "--material", "objct=ggx"],
            "did you mean `object`?",
        ),
        (
            vec!["brdf", "show", "oren-nayer"],
            "did you mean `oren-nayar`?",
        ),
        (
            vec!["brdf", "check", "ggx:metal=glod"],
            "did you mean `gold`?",
        ),
        (
            vec!["render", "--material", "ward@gold-pant"],
            "did you mean `ward@gold-paint`?",
        ),
        (
            vec!["env", "info", "uniform:1", "--env-layout", "anguler"],
            "did you mean \"angular\"?",
        ),
        (
            vec!["brdf", "check", "ggx", "--effort", "quik"],
            "did you mean 'quick'?",
        ),
        (vec!["render", "-o", "x.pn"], "did you mean .png?"),
    ] {
        place.bad(&arguments, 2, &[word]);
    }
}

#[test]
fn values_out_of_range_name_the_range() {
    let place = Place::new();
    for (option, value, word) in [
        ("--size", "0x5", "WIDTHxHEIGHT"),
        ("--size", "-3x5", "WIDTHxHEIGHT"),
        ("--size", "16", "WIDTHxHEIGHT"),
        ("--size", "4000000000x4000000000", "MiB"),
        ("--spp", "0", "from 1 to 4294967295"),
        ("--spp", "-1", "from 1"),
        ("--spp", "1.5", "whole number"),
        ("--time", "-1", "such as 30s"),
        ("--time", "0", "such as 30s"),
        ("--time", "soon", "such as 30s"),
        ("--noise", "0", "such as 2%"),
        ("--noise", "-2%", "such as 2%"),
        ("--noise", "nan", "such as 2%"),
        ("--threads", "0", "from 1 to 4096"),
        ("--threads", "-2", "from 1 to 4096"),
        ("--seed", "-1", "from 0"),
        ("--max-bounces", "x", "from 0"),
        ("--light-candidates", "0", "from 1 to 64"),
        ("--light-candidates", "-1", "from 1"),
        ("--exposure", "nan", "finite"),
        ("--env-rotate", "inf", "finite"),
        ("--env", "uniform:-1", "≥ 0"),
        ("--env", "uniform:nan", "≥ 0"),
        ("--env", "uniform:", "uniform"),
        ("--material", "ggx:roughness=-1", "from 0 to 1"),
        ("--material", "ggx:roughness=nan", "from 0 to 1"),
        ("--material", "ggx:roughness=", "roughness"),
        ("--material", "lambertian:reflectance=2", "reflectance"),
        ("--material", "", "--material"),
        ("--material", "lambertian:reflectance", "expected a colour"),
        ("--camera", "front", "there is no camera `front`"),
        ("--camera", "7", "one camera: 0"),
    ] {
        place.bad(&["render", option, value], 2, &[word]);
    }
    for (option, value) in [
        ("--samples", "1"),
        ("--samples", "-1"),
        ("--normal", "0,0,0"),
        ("--normal", "0,1"),
        ("--normal", "0,nan,0"),
    ] {
        place.bad(
            &["measure", "irradiance", "--env", "uniform:1", option, value],
            2,
            &[],
        );
    }
    for angles in ["181,0", "-1,0", "nan", "1,2,3", "north"] {
        place.bad(
            &["brdf", "eval", "ggx", "--wi", angles, "--wo", "0"],
            2,
            &["θ from 0 to 180"],
        );
    }
}

#[test]
fn what_does_not_go_together_is_named() {
    let place = Place::new();
    let both = ["--light-candidates", "2", "--env-sampling", "product"];
    let render = [&["render"][..], &both].concat();
    place.bad(
        &render,
        2,
        &["--light-candidates", "leave one of the two out"],
    );
}

#[test]
fn what_is_missing_is_named() {
    let place = Place::new();
    place.bad(&[], 2, &["a subcommand is missing", "gonio --help"]);
    place.bad(
        &["brdf"],
        2,
        &["a subcommand is missing", "gonio brdf --help"],
    );
    place.bad(&["render", "--spp"], 2, &["--spp"]);
    place.bad(&["render", "a.toml", "b.toml"], 2, &["b.toml"]);
    place.bad(
        &["brdf", "eval", "ggx", "--wi", "0"],
        2,
        &["--wo", "gonio brdf eval --help"],
    );
    place.bad(&["diff", "a.png"], 2, &["<B>"]);
    place.bad(&["measure", "irradiance"], 2, &["--env"]);
    place.bad(
        &["measure", "flux", "--env", "uniform:1"],
        2,
        &["--corner", "--light"],
    );
    place.bad(
        &["measure", "flux", "--env", "uniform:1", "--corner", "0,0,0"],
        2,
        &["--side-u", "--side-v"],
    );
}

/// The paths of all subcommands that do something.
const LEAVES: [&[&str]; 11] = [
    &["render"],
    &["brdf", "list"],
    &["brdf", "show"],
    &["brdf", "eval"],
    &["brdf", "check"],
    &["env", "info"],
    &["measure", "irradiance"],
    &["measure", "exitance"],
    &["measure", "radiance"],
    &["measure", "flux"],
    &["diff"],
];

#[test]
fn every_subcommand_has_help_with_an_example_and_json() {
    let place = Place::new();
    for path in LEAVES {
        let said = place.good(&[path, &["--help"]].concat());
        assert!(
            said.out.contains(&format!("  gonio {}", path.join(" "))),
            "{path:?}"
        );
        assert!(said.out.contains("Example"), "{path:?}");
        assert!(said.out.contains("--json"), "{path:?}");
        assert_eq!(said.err, "");
    }
    for path in [
        &["--help"][..],
        &["brdf", "--help"],
        &["env", "--help"],
        &["measure", "--help"],
    ] {
        assert!(place.good(path).out.contains("Example"), "{path:?}");
    }
    assert!(place.good(&["--version"]).out.starts_with("gonio "));
    assert!(place.good(&["--help"]).out.contains("4 interrupted"));
}

#[cfg(unix)]
#[test]
fn words_that_are_not_unicode() {
    use crate::support::said;
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let place = Place::new();
    let word = OsStr::from_bytes(b"caf\xe9.toml");
    for (before, code) in [
        (&["render"][..], 3),
        (&["render", "--env"], 2),
        (&[], 2),
        (&["render", "--spp"], 2),
    ] {
        let output = place.command(before).arg(word).output().unwrap();
        let said = said(output, before);
        assert_eq!(said.code, code, "{said:?}");
        assert!(
            said.err.starts_with("error: ") && said.err.contains("\nhelp: "),
            "{said:?}"
        );
    }
    // A picture may have such a name.
    std::fs::rename(
        place
            .path()
            .join(place.write("ball.toml", crate::support::BALL)),
        place.path().join(word),
    )
    .unwrap();
    let output = place
        .command(&["render", "--size", "4x4", "--spp", "1"])
        .arg(word)
        .output()
        .unwrap();
    assert_eq!(said(output, &[]).code, 0);
}
