//! Pictures in parts, and what files say of how they came to be.

use crate::support::{BALL, Place};

/// The arguments of a part, or of the whole.
fn render<'a>(scene: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["render", scene, "--size", "16x12", "--seed", "4"], more].concat()
}

#[test]
fn merged_parts_are_the_file_of_one_machine() {
    let place = Place::new();
    let scene = place.write("ball.toml", BALL);
    place.good(&render(
        &scene,
        &[
            "--spp",
            "21",
            "--threads",
            "1",
            "-o",
            "one.exr",
            "-o",
            "one.png",
        ],
    ));
    // Ranges, and thirds, on other numbers of threads; one by the index of a job system.
    let range = |range: &str, threads: &str| {
        place.good(&render(
            &scene,
            &["--spp", "21", "--samples", range, "--threads", threads],
        ));
    };
    range("0:1", "7");
    range("1:13", "2");
    range("13:21", "3");
    place.good(&[
        "merge",
        "samples-13-21.gonio",
        "samples-0-1.gonio",
        "samples-1-13.gonio",
        "-o",
        "a.exr",
        "-o",
        "a.png",
    ]);
    assert!(place.read("a.exr") == place.read("one.exr"));
    assert!(place.read("a.png") == place.read("one.png"));
    for (part, index) in [("0/3", None), ("auto/3", Some("1")), ("2/3", None)] {
        let arguments = render(&scene, &["--spp", "21", "--part", part]);
        let mut command = place.command(&arguments);
        if let Some(index) = index {
            command.env("SLURM_ARRAY_TASK_ID", index);
        }
        assert!(command.output().unwrap().status.success());
    }
    let summary = place.json(&[
        "merge",
        "samples-0-7.gonio",
        "samples-7-14.gonio",
        "samples-14-21.gonio",
        "-o",
        "b.exr",
        "--json",
    ]);
    assert!(place.read("b.exr") == place.read("one.exr"));
    assert_eq!(
        (&summary["parts"], &summary["samples_per_pixel"]),
        (&3.into(), &21.into())
    );
    // Parts of parts.
    place.good(&[
        "merge",
        "samples-7-14.gonio",
        "samples-14-21.gonio",
        "-o",
        "later.gonio",
    ]);
    place.good(&["merge", "later.gonio", "samples-0-7.gonio", "-o", "c.exr"]);
    assert!(place.read("c.exr") == place.read("one.exr"));
    // The negative control: another seed.
    place.good(&[
        "render",
        &scene,
        "--size",
        "16x12",
        "--spp",
        "21",
        "-o",
        "other.exr",
    ]);
    assert!(place.read("other.exr") != place.read("one.exr"));
}

#[test]
fn a_part_that_is_there_is_not_rendered_again() {
    let place = Place::new();
    let scene = place.write("ball.toml", BALL);
    let part = render(&scene, &["--spp", "8", "--part", "1/2", "-o", "a.gonio"]);
    place.good(&part);
    let bytes = place.read("a.gonio");
    let said = place.good(&part);
    assert!(
        said.out
            .contains("has the samples 4:8 of this picture already"),
        "{said:?}"
    );
    assert!(place.read("a.gonio") == bytes);
    // Of another scene, damaged, or another part: rendered, and said.
    let rendered = |words: &str| {
        let said = place.good(&part);
        assert!(
            said.err.contains("a.gonio is rendered again") && said.err.contains(words),
            "{said:?}"
        );
    };
    place.write("ball.toml", BALL.replace("0.5", "0.25"));
    rendered("another scene: ");
    place.write("a.gonio", &bytes[..bytes.len() - 40]);
    rendered("bytes, expected");
    let mut damaged = place.read("a.gonio");
    let last = damaged.len() - 50;
    damaged[last] ^= 1;
    place.write("a.gonio", damaged);
    rendered("note: ");
    place.good(&render(
        &scene,
        &["--spp", "8", "--part", "0/2", "-o", "a.gonio"],
    ));
    rendered("the samples 0:4 of 8");
}

/// Everything that the picture depends on is in the hash, and the place of the files isn't.
#[test]
fn scenes_are_told_apart_by_their_contents() {
    let place = Place::new();
    let lit = BALL.replace("uniform = 1.0", "file = \"sky.hdr\"");
    place.write("ball.toml", &lit);
    place.picture("sky.hdr", &crate::support::panorama());
    std::fs::create_dir(place.path().join("elsewhere")).unwrap();
    for name in ["ball.toml", "sky.hdr"] {
        place.write(&format!("elsewhere/{name}"), place.read(name));
    }
    let hash = |more: &[&str]| {
        let arguments: Vec<&str> = [
            &[
                "render", "--size", "4x4", "--spp", "1", "-o", "a.png", "--json",
            ],
            more,
        ]
        .concat();
        place.json(&arguments)["scene_hash"]
            .as_str()
            .unwrap()
            .to_owned()
    };
    let own = hash(&["ball.toml"]);
    assert_eq!(own.len(), 32);
    assert_eq!(hash(&["elsewhere/ball.toml"]), own);
    assert_eq!(hash(&["ball.toml", "--seed", "3"]), own);
    let mut seen = vec![own];
    for more in [
        &["ball.toml", "--env-rotate", "1"][..],
        &["ball.toml", "--env", "uniform:1"],
        &["ball.toml", "--env", "sky.hdr"],
        &["ball.toml", "--material", "ggx"],
        &["ball.toml", "--material", "ggx:roughness=0.4"],
    ] {
        let other = hash(more);
        assert!(!seen.contains(&other), "{more:?}");
        seen.push(other);
    }
    // A file that the scene names, and one that only a description names.
    place.picture("sky.hdr", &gonio::image::Image::filled(8, 4, [2.0; 3]));
    assert!(!seen.contains(&hash(&["ball.toml"])));
    let shader =
        |f: &str| format!("fn eval(wi: vec3f, wo: vec3f) -> vec3f {{ return vec3f({f}); }}");
    place.write("a.wgsl", shader("0.1"));
    let first = hash(&["ball.toml", "--material", "a.wgsl"]);
    place.write("a.wgsl", shader("0.2"));
    assert_ne!(hash(&["ball.toml", "--material", "a.wgsl"]), first);
}

#[test]
fn what_a_file_says_of_itself() {
    let place = Place::new();
    let scene = place.write("ball.toml", BALL);
    place.good(&render(
        &scene,
        &["--spp", "3", "-o", "a.exr", "-o", "a.gonio", "-o", "a.png"],
    ));
    let info = place.json(&["info", "a.exr", "--json"]);
    for (key, value) in [
        ("size", "16x12"),
        ("gonio.scene", "ball.toml"),
        ("gonio.seed", "4"),
        ("gonio.samplesPerPixel", "3"),
        ("gonio.samples", "0:3"),
        ("gonio.rejectedSamples", "0"),
        ("gonio.sampler", "Sobol"),
        ("gonio.colourSpace", "linear, Rec.709 primaries, D65 white"),
    ] {
        assert_eq!(info[key], value, "{info}");
    }
    assert!(
        info["generator"].as_str().unwrap().starts_with("gonio "),
        "{info}"
    );
    let hash = info["gonio.sceneHash"].clone();
    assert_eq!(hash.as_str().unwrap().len(), 32);
    assert!(info["gonio.seconds"].is_null());
    let said = place.good(&["info", "a.exr"]);
    assert!(said.out.contains("gonio.sceneHash"), "{said:?}");
    let part = place.json(&["info", "a.gonio", "--json"]);
    assert_eq!(part["identity"]["scene"], hash);
    assert_eq!((&part["samples"], &part["of"]), (&"0:3".into(), &3.into()));
    assert_eq!(place.json(&["info", "a.png", "--json"])["size"], "16x12");
    // The time only if it is asked for.
    place.good(&render(
        &scene,
        &["--spp", "3", "-o", "b.exr", "--write-time"],
    ));
    let timed = place.json(&["info", "b.exr", "--json"]);
    assert!(
        timed["gonio.seconds"]
            .as_str()
            .unwrap()
            .parse::<f64>()
            .unwrap()
            > 0.0
    );
}

/// A shader that is negative everywhere: its samples are counted, told, and fail a strict rendering.
#[test]
fn strict_renderings_have_no_faulty_samples() {
    let place = Place::new();
    place.write(
        "bad.wgsl",
        "fn eval(wi: vec3f, wo: vec3f) -> vec3f { return vec3f(-1.0); }",
    );
    let scene = place.write(
        "ball.toml",
        BALL.replace("\"lambertian\"", "\"bad.wgsl\"")
            .replace("params = { reflectance = 0.5 }", ""),
    );
    let lax = place.good(&render(
        &scene,
        &["--spp", "2", "-o", "a.exr", "-o", "a.gonio"],
    ));
    assert!(lax.err.contains("material 'grey'"), "{lax:?}");
    let info = place.json(&["info", "a.exr", "--json"]);
    assert!(
        info["gonio.firstRejectedSample"]
            .as_str()
            .unwrap()
            .starts_with("pixel "),
        "{info}"
    );
    assert_ne!(info["gonio.rejectedSamples"], "0");
    let strict = place.gonio(&render(&scene, &["--spp", "2", "-o", "b.exr", "--strict"]));
    assert_eq!(strict.code, 1, "{strict:?}");
    assert!(strict.err.contains("negative or not finite"), "{strict:?}");
    // The picture is written: it shows where.
    assert!(place.read("b.exr") == place.read("a.exr"));
    let merged = place.gonio(&["merge", "a.gonio", "-o", "c.exr", "--strict"]);
    assert_eq!(merged.code, 1, "{merged:?}");
    assert!(place.read("c.exr") == place.read("a.exr"));
    let sound = place.write("sound.toml", BALL);
    place.good(&render(&sound, &["--spp", "2", "-o", "b.exr", "--strict"]));
}

#[test]
fn progress_for_programs() {
    let place = Place::new();
    let scene = place.write("ball.toml", BALL);
    let said = place.good(&render(
        &scene,
        &["--spp", "5", "-o", "a.exr", "--progress", "json"],
    ));
    let lines: Vec<serde_json::Value> = said
        .err
        .lines()
        .filter(|l| l.starts_with('{'))
        .map(|l| serde_json::from_str(l).unwrap())
        .collect();
    assert_eq!(lines[0]["event"], "progress", "{said:?}");
    assert_eq!(lines[lines.len() - 1]["samples"], 5, "{said:?}");
    assert_eq!(lines[lines.len() - 1]["fraction"], 1.0);
    let said = place.good(&render(
        &scene,
        &["--spp", "5", "-q", "-o", "a.exr", "--progress", "openjd"],
    ));
    assert!(
        said.out
            .contains("openjd_progress: 100.0\nopenjd_status: 5 samples"),
        "{said:?}"
    );
}

#[test]
fn what_can_not_be_merged_or_divided_is_said() {
    let place = Place::new();
    let scene = place.write("ball.toml", BALL);
    let part = |range: &str, more: &[&str]| {
        place.good(&render(
            &scene,
            &[&["--samples", range, "--spp", "6"], more].concat(),
        ));
    };
    part("0:2", &[]);
    part("2:4", &[]);
    part("4:6", &["-o", "seeded.gonio", "--filter", "box"]);
    let merge = |parts: &[&str], code, words: &[&str]| {
        place.bad(&[&["merge"], parts, &["-o", "a.exr"]].concat(), code, words);
    };
    merge(
        &["samples-0-2.gonio", "samples-2-4.gonio"],
        3,
        &["samples-2-4.gonio", "4:6"],
    );
    merge(&["samples-2-4.gonio"], 3, &["0:2"]);
    merge(
        &["samples-0-2.gonio", "samples-0-2.gonio"],
        3,
        &["are in samples-0-2.gonio, too"],
    );
    merge(
        &["samples-0-2.gonio", "samples-2-4.gonio", "seeded.gonio"],
        3,
        &["seeded.gonio: another filter: box, expected blackman-harris as in samples-2-4.gonio"],
    );
    merge(&["ball.toml"], 3, &["ball.toml", "a part of a picture"]);
    merge(&["none.gonio"], 3, &["none.gonio"]);
    merge(&["."], 3, &["a folder"]);
    place.bad(&["merge", "samples-0-2.gonio"], 2, &["--output"]);
    place.bad(&["merge", "samples-0-2.gonio", "-o", "a.txt"], 2, &[".txt"]);
    place.bad(&["info", "none.gonio"], 3, &["none.gonio"]);
    for (arguments, words) in [
        (&["--part", "2/2"][..], "0/8"),
        (
            &["--part", "1/9", "--spp", "3", "-o", "b.gonio"],
            "at most 3 parts",
        ),
        (&["--part", "auto/2"], "no job system"),
        (&["--samples", "4:2"], "FIRST:END"),
        (&["--samples", "0:9", "--spp", "8"], "beyond --spp 8"),
        (&["--samples", "0:2", "--time", "1s"], "--time"),
        (&["--resume"], "--checkpoint"),
    ] {
        let mut command = place.command(&render(&scene, arguments));
        for name in [
            "SLURM_ARRAY_TASK_ID",
            "PBS_ARRAY_INDEX",
            "HQ_TASK_ID",
            "JOB_COMPLETION_INDEX",
        ] {
            command.env_remove(name);
        }
        let said = crate::support::said(command.output().unwrap(), arguments);
        assert!(
            said.code == 2 && said.err.contains(words),
            "{arguments:?} {said:?}"
        );
    }
}
