//! `gonio render --layers`, and what files say of their layers.

use crate::support::{BALL, Place, tiny};
use gonio::image::Layers;

/// Three lights in three groups, a material that no group has, and one whose samples are negative.
const ROOM: &str = r#"
[camera]
eye = [0, 2, 6]
target = [0, 0.3, 0]

[environment]
uniform = [0.2, 0.3, 0.4]
group = "sky"

[[material]]
name = "grey"
model = "lambertian:0.5"

[[material]]
name = "bulb"
model = "lambertian:0"
emission = [30, 20, 10]
group = "practical"

[[shape]]
kind = "sphere"
material = "grey"

[[shape]]
kind = "rectangle"
material = "grey"
rotate_deg = [-90, 0, 0]
translate = [0, -1, 0]
scale = 8

[[shape]]
kind = "sphere"
material = "bulb"
scale = 0.3
translate = [1.5, 0.5, 1]

[[light]]
kind = "point"
position = [-2, 3, 2]
intensity = [20, 20, 18]
group = "key"
"#;

#[test]
fn layers_are_those_that_are_asked_for() {
    let place = Place::new();
    let scene = place.write("room.toml", ROOM);
    let channels = |layers: &[&str]| {
        place.good(&tiny(&[&[&*scene, "-o", "a.exr"], layers].concat()));
        let layers = Layers::read_exr(&place.path().join("a.exr")).unwrap();
        let names = layers.channels.into_iter().map(|c| c.name);
        names.filter(|n| n.contains('.')).collect::<Vec<_>>()
    };
    let usual = channels(&[]);
    let of = |layer: &str, components: &str| -> Vec<String> {
        components.chars().map(|c| format!("{layer}.{c}")).collect()
    };
    let mut expected = [
        of("albedo", "BGR"),
        of("depth", "Z"),
        of("normal", "XYZ"),
        vec!["samples.count".into()],
        of("variance", "BGR"),
    ]
    .concat();
    assert_eq!(usual, expected);
    assert_eq!(channels(&["--layers", "groups"]).len(), usual.len() + 3 * 3);
    expected.extend(of("direct", "BGR"));
    expected.extend(of("position", "XYZ"));
    expected.sort();
    assert_eq!(
        channels(&["--layers", "direct", "--layers", "position"]),
        expected
    );
    let all = channels(&["--layers", "all"]);
    assert_eq!(
        channels(&["--layers", "position,material,direct,indirect,groups"]),
        all
    );
    let info = place.json(&["info", "a.exr", "--json"]);
    assert_eq!(
        info["gonio.groups"],
        serde_json::json!(["key", "practical", "sky"])
    );
    assert_eq!(info["gonio.materials"], serde_json::json!(["grey", "bulb"]));
    assert_eq!(info["gonio.rejectedInLayers"], "0");
    let words = place.good(&["info", "a.exr"]).out;
    for line in [
        "gonio.groups",
        "key, practical, sky",
        "group.key.BGR",
        "grey, bulb",
    ] {
        assert!(words.contains(line), "{words}");
    }
}

#[test]
fn layers_that_do_not_exist_are_refused() {
    let place = Place::new();
    let scene = place.write("room.toml", ROOM);
    let help = |layer: &str| {
        place
            .bad(&tiny(&[&scene, "--layers", layer]), 2, &["--layers"])
            .err
    };
    assert!(help("drect").contains("did you mean 'direct'"));
    assert!(help("group").contains("groups"));
    help("");
    help("direct,,indirect");
}

/// A scene without groups has one layer for all of its light, and is told so.
#[test]
fn a_scene_without_groups_is_told_so() {
    let place = Place::new();
    let scene = place.write("ball.toml", BALL);
    let said = place.good(&tiny(&[&scene, "--layers", "groups", "-o", "a.exr"]));
    assert!(
        said.err.contains("no light of the scene is in a group"),
        "{said:?}"
    );
    let layers = Layers::read_exr(&place.path().join("a.exr")).unwrap();
    assert_eq!(layers.rgb("group.default"), layers.rgb(""));
}

/// Fireflies weigh less in a layer of its own, and in what a PNG shows if that is asked for; R, G and B stay. Parts, checkpoints and any split make the
/// same file, which says so.
#[test]
fn fireflies_weigh_less_where_that_is_asked_for() {
    let place = Place::new();
    // The bulb's light by way of a mirrored ball is found by chance.
    let mirror = "[[material]]\nname = \"mirror\"\nmodel = \"mirror\"\n\n[[shape]]\nkind = \"sphere\"\nmaterial = \"mirror\"";
    let room = ROOM.replacen(
        "[[shape]]\nkind = \"sphere\"\nmaterial = \"grey\"",
        mirror,
        1,
    );
    let scene = place.write(
        "room.toml",
        room.replace("[30, 20, 10]", "[3000, 2000, 1000]"),
    );
    let usual = ["render", &scene, "--size", "16x12", "--spp", "5"];
    let with = |more: &[&str]| {
        let how = [&usual[..], &["--reweight-fireflies"], more].concat();
        place.good(&how)
    };
    place.good(&[&usual[..], &["-o", "plain.exr", "-o", "plain.png"]].concat());
    with(&["-o", "a.exr", "-o", "mean.png"]);
    with(&[
        "-o",
        "one-thread.exr",
        "-o",
        "shown.png",
        "--show",
        "reweighted",
        "--threads",
        "1",
    ]);
    assert_eq!(place.read("one-thread.exr"), place.read("a.exr"));
    assert_eq!(place.read("mean.png"), place.read("plain.png"));
    assert_ne!(place.read("shown.png"), place.read("plain.png"));
    let layers = |name: &str| Layers::read_exr(&place.path().join(name)).unwrap();
    let (plain, found) = (layers("plain.exr"), layers("a.exr"));
    assert_eq!(found.rgb(""), plain.rgb(""));
    assert!(plain.rgb("reweighted").is_none());
    assert_ne!(found.rgb("reweighted"), found.rgb(""));
    with(&["--samples", "0:3", "-o", "first.gonio"]);
    with(&["--samples", "3:5", "-o", "second.gonio"]);
    place.good(&[
        "merge",
        "second.gonio",
        "first.gonio",
        "-o",
        "merged.exr",
        "-o",
        "merged.png",
        "--show",
        "reweighted",
    ]);
    assert_eq!(place.read("merged.exr"), place.read("a.exr"));
    assert_eq!(place.read("merged.png"), place.read("shown.png"));
    place.good(&[
        "render",
        &scene,
        "--size",
        "16x12",
        "--spp",
        "3",
        "--reweight-fireflies",
        "--checkpoint",
        "a.checkpoint",
        "-o",
        "begun.exr",
    ]);
    with(&[
        "--checkpoint",
        "a.checkpoint",
        "--resume",
        "-o",
        "resumed.exr",
    ]);
    assert_eq!(place.read("resumed.exr"), place.read("a.exr"));
    let info = place.json(&["info", "a.exr", "--json"]);
    assert!(
        info["gonio.reweighted"]
            .as_str()
            .unwrap()
            .contains("biased")
    );
    assert!(
        place
            .json(&["info", "plain.exr", "--json"])
            .get("gonio.reweighted")
            .is_none()
    );
    assert_eq!(
        place.json(&["info", "first.gonio", "--json"])["layers"],
        "reweighted"
    );
    place.good(&[&usual[..], &["--samples", "3:5", "-o", "other.gonio"]].concat());
    place.bad(
        &["merge", "first.gonio", "other.gonio", "-o", "b.exr"],
        3,
        &["other layers: none, expected reweighted"],
    );
    place.bad(
        &[
            "merge",
            "other.gonio",
            "-o",
            "b.gonio",
            "--show",
            "reweighted",
        ],
        2,
        &["--show reweighted", "--reweight-fireflies"],
    );
    place.bad(
        &[&usual[..], &["--show", "reweighted"]].concat(),
        2,
        &["--show reweighted", "--reweight-fireflies"],
    );
}

/// Parts have the layers, the names of materials and groups, and make the file that one machine makes.
#[test]
fn merged_parts_have_the_layers_of_the_whole() {
    let place = Place::new();
    let scene = place.write("room.toml", ROOM);
    let render = |more: &[&str]| {
        let arguments = [
            "render", &scene, "--size", "16x12", "--spp", "5", "--layers", "all",
        ];
        place.good(&[&arguments[..], more].concat())
    };
    render(&["-o", "whole.exr"]);
    render(&["--samples", "0:2", "-o", "a.gonio"]);
    render(&["--samples", "2:5", "-o", "b.gonio", "--threads", "1"]);
    place.good(&["merge", "b.gonio", "a.gonio", "-o", "merged.exr"]);
    assert!(place.read("merged.exr") == place.read("whole.exr"));
    let info = place.json(&["info", "a.gonio", "--json"]);
    assert_eq!(
        info["layers"],
        "position, material, direct, indirect, groups"
    );
    assert_eq!(
        info["groups"],
        serde_json::json!(["key", "practical", "sky"])
    );
    assert_eq!(info["materials"], serde_json::json!(["grey", "bulb"]));
    // Parts with other layers are parts of another picture.
    let arguments = [
        "render",
        &scene,
        "--size",
        "16x12",
        "--spp",
        "5",
        "--samples",
        "0:2",
    ];
    place.good(&[&arguments[..], &["-o", "c.gonio"]].concat());
    let said = place.bad(
        &["merge", "c.gonio", "b.gonio", "-o", "d.exr"],
        3,
        &["b.gonio", "other layers", "expected none"],
    );
    assert!(said.err.contains("c.gonio"), "{said:?}");
}

/// A function that is negative for light from one side, which the other side's makes up for: the picture is sound, a layer would not be.
#[test]
fn faulty_shares_are_counted_and_told() {
    let place = Place::new();
    place.write(
        "bad.wgsl",
        "fn eval(wi: vec3f, wo: vec3f) -> vec3f { return vec3f(select(0.3, -0.01, wi.x > 0.0)); }",
    );
    let light = |x: f32, group: &str| {
        format!(
            "[[light]]\nkind = \"directional\"\ndirection = [{x}, 0, -1]\nirradiance = 1\ngroup = \"{group}\"\n"
        )
    };
    let wall = "[camera]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n[[material]]\nname = \"odd\"\nmodel = \"bad.wgsl\"\n\
                [[shape]]\nkind = \"rectangle\"\nmaterial = \"odd\"\nscale = 9\n";
    let scene = place.write(
        "wall.toml",
        format!("{wall}{}{}", light(1.0, "left"), light(-1.0, "right")),
    );
    let usual = [
        "render",
        &scene,
        "--size",
        "8x8",
        "--spp",
        "2",
        "--integrator",
        "direct",
    ];
    let layers = ["--layers", "groups", "-o", "a.exr", "-o", "a.gonio"];
    let said = place.good(&[&usual[..], &layers].concat());
    let words = "128 shares of sound samples were negative or not finite";
    assert!(said.err.contains(words), "{said:?}");
    let info = place.json(&["info", "a.exr", "--json"]);
    assert_eq!(info["gonio.rejectedInLayers"], "128");
    assert_eq!(info["gonio.rejectedSamples"], "0");
    assert_eq!(
        place.json(&["info", "a.gonio", "--json"])["rejectedInLayers"],
        128
    );
    assert!(
        place
            .good(&["merge", "a.gonio", "-o", "b.exr"])
            .err
            .contains(words)
    );
    // Nothing to tell of where light isn't told apart.
    let said = place.good(&[&usual[..], &["-o", "c.exr"]].concat());
    assert!(!said.err.contains("shares"), "{said:?}");
}

/// Where the scene isn't at hand, faulty samples still have the name of their material.
#[test]
fn faulty_samples_have_names_after_merging() {
    let place = Place::new();
    place.write(
        "bad.wgsl",
        "fn eval(wi: vec3f, wo: vec3f) -> vec3f { return vec3f(-1.0); }",
    );
    let scene = place.write("ball.toml", BALL);
    place.good(&[
        "render",
        &scene,
        "--size",
        "16x12",
        "--spp",
        "1",
        "--material",
        "bad.wgsl",
        "--part",
        "0/1",
        "-o",
        "a.gonio",
    ]);
    let said = place.good(&["merge", "a.gonio", "-o", "a.exr"]);
    assert!(said.err.contains("material 'grey'"), "{said:?}");
    for file in ["a.gonio", "a.exr"] {
        let words = place.good(&["info", file]).out;
        assert!(words.contains("material 'grey'"), "{words}");
    }
}

/// Without the library `--denoise` says how to get it, before any time is spent; with it there is a layer, and a PNG that shows it.
#[test]
fn a_picture_without_noise_needs_the_library() {
    let place = Place::new();
    let scene = place.write("room.toml", ROOM);
    let usual = ["render", &scene, "--size", "32x24", "--spp", "4"];
    let with = |more: &[&'static str]| [&usual[..], more].concat();
    place.bad(
        &with(&["--show", "denoised"]),
        2,
        &["--show denoised", "--denoise"],
    );
    if !cfg!(feature = "denoise") {
        place.bad(
            &with(&["--denoise"]),
            2,
            &["built without Open Image Denoise", "--features denoise"],
        );
        return;
    }
    place.good(&with(&["-o", "plain.exr", "-o", "plain.png"]));
    place.good(&with(&[
        "--denoise",
        "-o",
        "a.exr",
        "-o",
        "a.png",
        "--show",
        "denoised",
    ]));
    let layers = |name: &str| Layers::read_exr(&place.path().join(name)).unwrap();
    let (plain, found) = (layers("plain.exr"), layers("a.exr"));
    assert_eq!(found.rgb(""), plain.rgb(""));
    assert!(found.rgb("denoised").is_some() && found.rgb("denoised") != found.rgb(""));
    assert!(found.metadata("gonio.denoised").is_some());
    assert_ne!(place.read("a.png"), place.read("plain.png"));
}
