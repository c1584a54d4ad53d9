//! `gonio relight`: pictures whose lights are mixed again.

use crate::support::{Place, Said};
use gonio::image::{Image, Layers};
use gonio::verify::statistics::{Moments, welch_t_test};

/// A room with three groups of lights, `key` times a factor, and all of it times another.
fn room(key: f32, all: f32) -> String {
    format!(
        r#"
[camera]
eye = [0, 2, 6]
target = [0, 0.3, 0]

[environment]
uniform = [{}, {}, {}]
group = "sky"

[[material]]
name = "grey"
model = "lambertian:0.5"

[[material]]
name = "bulb"
model = "lambertian:0"
emission = {{ radiance = [30, 20, 10], strength = {all} }}

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
intensity = {}
group = "key"
"#,
        0.25 * all,
        0.5 * all,
        all,
        20.0 * key * all
    )
}

struct Room(Place);

impl Room {
    /// With the picture `NAME.exr` of the room.
    fn shoot(&self, name: &str, scene: &str, more: &[&str]) {
        let file = self.0.write(&format!("{name}.toml"), scene);
        let output = format!("{name}.exr");
        let usual = [
            "render",
            &file,
            "--size",
            "24x18",
            "--spp",
            "8",
            "--layers",
            "groups,direct",
            "-o",
            &output,
        ];
        self.0.good(&[&usual[..], more].concat());
    }

    fn new(more: &[&str]) -> Self {
        let room = Self(Place::new());
        room.shoot("a", &self::room(1.0, 1.0), more);
        room
    }

    fn relight(&self, lights: &[&str], output: &str) -> Said {
        let mut arguments = vec!["relight", "a.exr", "-o", output];
        lights
            .iter()
            .for_each(|light| arguments.extend(["--light", light]));
        self.0.good(&arguments)
    }

    fn layers(&self, name: &str) -> Layers {
        Layers::read_exr(&self.0.path().join(name)).unwrap()
    }
}

/// The largest relative difference of two numbers of two pictures.
fn distance(a: &Image, b: &Image) -> f32 {
    let pairs = a.pixels.as_flattened().iter().zip(b.pixels.as_flattened());
    pairs.fold(0.0, |worst, (a, b)| worst.max((a - b).abs() / b.max(1e-20)))
}

/// A sample is a sum of at most 2 × 64 + 1 pieces of light, all positive, in any order: 2⁻²⁴ of the sum for each addition, in either
/// picture; the means and the mixture round a few times more.
const ROUNDING: f32 = 2.0 * (2.0 * 64.0 + 1.0 + 8.0) / (1 << 24) as f32;

/// With factors of 1 the mixture is the picture, but for rounding. With 2 for all it is the picture of all lights twice as bright, whose
/// random numbers are the same since no light is a larger part of the whole; doubling adds no rounding.
#[test]
fn all_lights_together_are_brighter_as_in_a_rendering() {
    let room = Room::new(&[]);
    room.relight(&["key=1"], "same.exr");
    let picture = |name: &str| room.layers(name).rgb("").unwrap();
    let same = distance(&picture("same.exr"), &picture("a.exr"));
    assert!(same <= ROUNDING, "{same}");
    room.relight(&["key=2", "sky=2,2,2", "default=2"], "twice.exr");
    room.shoot("b", &self::room(1.0, 2.0), &[]);
    let twice = distance(&picture("twice.exr"), &picture("b.exr"));
    assert!(twice <= ROUNDING, "{twice}");
    // The control: one group fewer.
    room.relight(&["key=2", "sky=2"], "less.exr");
    assert!(distance(&picture("less.exr"), &picture("b.exr")) > 0.01);
}

/// The integrator that takes light after light chooses none: with one lamp brighter it takes the same samples.
#[test]
fn one_light_is_brighter_as_in_a_rendering() {
    let direct = ["--integrator", "direct"];
    let room = Room::new(&direct);
    room.relight(&["key=3"], "relit.exr");
    room.shoot("b", &self::room(3.0, 1.0), &direct);
    let picture = |name: &str| room.layers(name).rgb("").unwrap();
    let found = distance(&picture("relit.exr"), &picture("b.exr"));
    assert!(found <= ROUNDING, "{found}");
    assert!(distance(&picture("a.exr"), &picture("b.exr")) > 0.1);
}

/// Paths choose among lights by power, so a brighter light is sampled more often: the mixture and the rendering have the same expectation,
/// by eight means of pictures of either, each with random numbers of its own.
#[test]
fn one_light_is_brighter_as_in_a_rendering_by_paths() {
    let room = Room(Place::new());
    let (mut relit, mut without, mut rendered) = (Moments::new(), Moments::new(), Moments::new());
    let mean = |name: &str| {
        let image = room.layers(name).rgb("").unwrap();
        let sum: f64 = image.pixels.iter().map(|p| f64::from(p[0])).sum();
        sum / image.pixels.len() as f64
    };
    for seed in 0..8 {
        let (one, other) = (seed.to_string(), (seed + 100).to_string());
        room.shoot("a", &self::room(1.0, 1.0), &["--seed", &one]);
        room.relight(&["key=3"], "relit.exr");
        relit.push(mean("relit.exr"));
        room.relight(&["key=0"], "without.exr");
        without.push(mean("without.exr"));
        room.shoot("b", &self::room(3.0, 1.0), &["--seed", &other]);
        rendered.push(mean("b.exr"));
    }
    let p_value = |a: &Moments, b: &Moments| welch_t_test(a, b).p_value;
    let found = p_value(&relit, &rendered);
    assert!(found > 1e-6, "{found}");
    // The control: a light that is forgotten.
    let found = p_value(&without, &rendered);
    assert!(found < 1e-6, "{found}");
}

/// Groups are mixed again and again, what isn't known is left out, and the file says what was done.
#[test]
fn a_mixture_says_what_it_is() {
    let room = Room::new(&[]);
    let said = room.relight(&["key=0.5", "sky=1,0,0.25"], "b.exr");
    assert!(
        said.out.contains("key × 0.5, default × 1, sky × 1,0,0.25"),
        "{said:?}"
    );
    let (before, after) = (room.layers("a.exr"), room.layers("b.exr"));
    for gone in ["variance.R", "direct.G"] {
        assert!(
            before.channel(gone).is_some() && after.channel(gone).is_none(),
            "{gone}"
        );
    }
    for kept in [
        "albedo.R",
        "normal.X",
        "depth.Z",
        "samples.count",
        "group.default.B",
    ] {
        assert_eq!(before.channel(kept), after.channel(kept), "{kept}");
    }
    let info = room.0.json(&["info", "b.exr", "--json"]);
    assert_eq!(info["gonio.relight"], "key=0.5 sky=1,0,0.25");
    assert!(
        info["gonio.variance"]
            .as_str()
            .unwrap()
            .starts_with("not known")
    );
    assert!(info["gonio.noise"].is_null() && info["gonio.direct"].is_null());
    assert_eq!(info["gonio.sceneHash"].as_str().unwrap().len(), 32);
    // Once more, back to the first one where nothing was lost: halving and doubling are exact.
    let place = &room.0;
    place.good(&[
        "relight", "b.exr", "--light", "key=2", "-q", "-o", "c.exr", "-o", "c.png",
    ]);
    let again = room.layers("c.exr");
    assert_eq!(again.rgb("group.key"), before.rgb("group.key"));
    assert_eq!(
        again.metadata("gonio.relight"),
        Some("key=0.5 sky=1,0,0.25; key=2")
    );
    assert_eq!(place.image("c.png").width, 24);
    let json = place.json(&[
        "relight", "a.exr", "--light", "key=2", "--json", "-o", "d.hdr",
    ]);
    assert_eq!(json["factors"]["key"], serde_json::json!([2.0, 2.0, 2.0]));
    assert_eq!(json["left_out"], serde_json::json!(["direct", "variance"]));
}

#[test]
fn what_can_not_be_mixed_is_refused() {
    let room = Room::new(&[]);
    let place = &room.0;
    let refused = |arguments: &[&str], code, words: &[&str]| {
        let usual = ["relight", "a.exr", "-o", "b.exr"];
        place
            .bad(&[&usual[..], arguments].concat(), code, words)
            .err
    };
    let said = refused(
        &["--light", "kye=2"],
        2,
        &["no group of lights is called 'kye'"],
    );
    assert!(
        said.contains("did you mean 'key'? the picture has: key, default, sky"),
        "{said}"
    );
    refused(
        &["--light", "moon=2"],
        2,
        &["the picture has: key, default, sky"],
    );
    refused(
        &["--light", "key=2", "--light", "key=3"],
        2,
        &["'key' is there twice"],
    );
    for bad in [
        "key", "key=", "key=x", "key=-1", "key=nan", "key=1,2", "=1", "",
    ] {
        refused(&["--light", bad], 2, &["GROUP=FACTOR"]);
    }
    refused(&[], 2, &["--light"]);
    refused(
        &["--light", "key=1", "--exposure", "bright"],
        2,
        &["--exposure"],
    );
    let other = |file: &str, words: &[&str]| {
        place.bad(
            &["relight", file, "--light", "key=2", "-o", "b.exr"],
            3,
            words,
        );
    };
    place.picture("plain.exr", &Image::filled(4, 4, [1.0; 3]));
    place.picture("plain.png", &Image::filled(4, 4, [1.0; 3]));
    other(
        "plain.exr",
        &["plain.exr", "no layer of a group", "--layers groups"],
    );
    other("plain.png", &["plain.png"]);
    other("none.exr", &["none.exr"]);
    place.bad(
        &["relight", "a.exr", "--light", "key=2", "-o", "b.jpg"],
        2,
        &["b.jpg"],
    );
    // A group that is listed but lost, one that has no light in it, and a list that is none.
    let spoil = |change: &dyn Fn(&mut Layers)| {
        let mut layers = room.layers("a.exr");
        change(&mut layers);
        layers.write_exr(&place.path().join("spoilt.exr")).unwrap();
    };
    spoil(&|layers| layers.channels.retain(|c| c.name != "group.sky.G"));
    other("spoilt.exr", &["group.sky.R, G and B are not all there"]);
    spoil(&|layers| {
        let place = layers.channels.iter_mut().find(|c| c.name == "group.key.R");
        if let gonio::image::ChannelData::Float(samples) = &mut place.unwrap().samples {
            samples[30] = f32::NAN;
        }
    });
    other(
        "spoilt.exr",
        &["the layer group.key has NaN at column 6, row 1"],
    );
    spoil(&|layers| layers.set_metadata("gonio.groups", "key, sky"));
    other("spoilt.exr", &["gonio.groups", "expected a list of names"]);
    // A group that isn't listed is not a fault of the file's, but its light is missing.
    spoil(&|layers| layers.set_metadata("gonio.groups", "[\"key\",\"sky\"]"));
    let said = place.good(&["relight", "spoilt.exr", "--light", "key=2", "-o", "b.exr"]);
    assert!(said.err.contains("% of the picture's light"), "{said:?}");
}
