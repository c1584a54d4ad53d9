//! `gonio render`, from a scene to pictures.

use crate::support::{BALL, CORNERS, Place, glb, panorama, tiny, triangle};
use gonio::image::Image;

#[test]
fn the_preview_needs_no_files() {
    let place = Place::new();
    let said = place.good(&tiny(&[]));
    assert!(said.out.contains("16×16 pixels, 1 sample each"), "{said:?}");
    assert!(
        said.out.contains("wrote gonio.png\nwrote gonio.exr\n"),
        "{said:?}"
    );
    assert_eq!(said.err, "");
    assert_eq!(place.files().len(), 2);
    let image = place.image("gonio.exr");
    assert_eq!((image.width, image.height), (16, 16));
    assert!(
        image
            .pixels
            .iter()
            .flatten()
            .all(|c| c.is_finite() && *c >= 0.0)
    );
    assert!(image.pixels.iter().flatten().any(|c| *c > 0.0));
    assert_eq!(place.image("gonio.png").width, 16);
}

/// The mean of the 8 × 8 pixels in the middle of a picture.
fn centre(image: &Image) -> f32 {
    let (x, y) = (image.width / 2 - 4, image.height / 2 - 4);
    (0..64)
        .map(|k| image.get(x + k % 8, y + k / 8)[0] / 64.0)
        .sum()
}

/// Arguments of a picture whose centre is known well: 64 pixels of 16 samples. A sample of a ball of albedo ρ in a furnace
/// is between 0 and 2ρ, so the standard error of the mean is at most ρ/32; stratified, it is far less.
const WELL: [&str; 8] = [
    "--size", "32x32", "--spp", "16", "--filter", "box", "-o", "a.exr",
];

/// A Lambertian ball in a uniform furnace of radiance 1 shows its albedo, the sky 1.
#[test]
fn a_ball_in_a_furnace_has_its_albedo() {
    let place = Place::new();
    let scene = place.write("ball.toml", BALL);
    for integrator in ["path", "direct"] {
        for sampler in ["sobol", "independent"] {
            place.good(
                &[
                    &[
                        "render",
                        &scene,
                        "--integrator",
                        integrator,
                        "--sampler",
                        sampler,
                    ],
                    &WELL[..],
                ]
                .concat(),
            );
            let image = place.image("a.exr");
            let seen = centre(&image);
            assert!((seen - 0.5).abs() < 0.02, "{integrator} {sampler}: {seen}");
            assert_eq!(image.get(0, 0), [1.0; 3]);
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_files_on_any_number_of_threads() {
    let place = Place::new();
    let render = |name: &str, more: &[&str]| {
        let (png, exr) = (format!("{name}.png"), format!("{name}.exr"));
        place.good(
            &[
                &[
                    "render", "--size", "16x9", "--spp", "3", "-o", &png, "-o", &exr,
                ],
                more,
            ]
            .concat(),
        );
        (place.read(&png), place.read(&exr))
    };
    let one = render("one", &["--threads", "1", "--seed", "5"]);
    assert!(one == render("two", &["--threads", "2", "--seed", "5"]));
    assert!(one == render("five", &["--threads", "5", "--seed", "5"]));
    // The negative control: another seed, another picture.
    assert!(one.1 != render("other", &["--threads", "1", "--seed", "6"]).1);
}

#[test]
fn pictures_of_each_format_show_the_same() {
    let place = Place::new();
    let scene = place.write("ball.toml", BALL);
    place.good(&tiny(&[
        &scene,
        "-o",
        "a.exr",
        "-o",
        "a.hdr",
        "-o",
        "a.PNG",
        "--tonemap",
        "linear",
    ]));
    let [exr, hdr, png] = ["a.exr", "a.hdr", "a.PNG"].map(|name| place.image(name).get(8, 8)[0]);
    // Radiance HDR keeps 8 bits of the largest channel; a PNG step of sRGB near ½ is 0.7 %.
    assert!((exr - hdr).abs() < 4e-3 * exr, "{exr} {hdr}");
    assert!((exr - png).abs() < 8e-3 * exr, "{exr} {png}");
    // One stop doubles what the PNG shows, and leaves radiance alone.
    place.good(&tiny(&[
        &scene,
        "-o",
        "b.exr",
        "-o",
        "b.png",
        "--tonemap",
        "linear",
        "--exposure",
        "-1",
    ]));
    assert_eq!(place.image("b.exr").get(8, 8)[0], exr);
    let darker = place.image("b.png").get(8, 8)[0];
    assert!((2.0 * darker - exr).abs() < 2e-2 * exr, "{darker} {exr}");
}

#[test]
fn the_summary_as_json() {
    let place = Place::new();
    let scene = place.write("ball.toml", BALL);
    let summary = place.json(&tiny(&[&scene, "-o", "a.png", "--json", "--seed", "3"]));
    assert_eq!(summary["outputs"], serde_json::json!(["a.png"]));
    assert_eq!(
        (&summary["width"], &summary["height"]),
        (&16.into(), &16.into())
    );
    assert_eq!(summary["samples_per_pixel"], 1);
    assert_eq!(summary["stopped_by"], "samples");
    assert_eq!(summary["seed"], 3);
    assert_eq!(summary["rejected_samples"]["count"], 0);
    assert!(summary["seconds"].as_f64().unwrap() > 0.0);
    assert!(summary["rays"].as_u64().unwrap() >= 256);
    assert_eq!(summary["warnings"], serde_json::json!([]));
    assert!(
        summary["notes"][0].as_str().unwrap().contains("no camera"),
        "{summary}"
    );
}

/// Samples where the noise is: some pixels of the ball have more than others, and the summary says so. What it can't be joined with is an error.
#[test]
fn pixels_go_on_where_the_noise_is() {
    let place = Place::new();
    let arguments = [
        "render",
        "--size",
        "24x16",
        "--noise",
        "15%",
        "--adaptive",
        "-o",
        "a.exr",
    ];
    let summary = place.json(&[&arguments[..], &["--json"]].concat());
    let mean = summary["mean_samples_per_pixel"].as_f64().unwrap();
    let most = summary["samples_per_pixel"].as_f64().unwrap();
    assert!(32.0 < mean && mean < most, "{summary}");
    assert!(summary["noise"].as_f64().unwrap() <= 0.15 && summary["stopped_by"] == "noise");
    let said = place.good(&arguments);
    assert!(said.out.contains("samples in the mean and"), "{said:?}");
    // Without a noise it is the mean that is given.
    let divided = ["render", "--size", "24x16", "--adaptive", "-o", "b.exr"];
    let summary = place.json(&[&divided[..], &["--spp", "40", "--json"]].concat());
    let mean = summary["mean_samples_per_pixel"].as_f64().unwrap();
    let most = summary["samples_per_pixel"].as_f64().unwrap();
    assert!((39.5..=40.0).contains(&mean) && most >= 64.0, "{summary}");
    assert!(summary["stopped_by"] == "samples", "{summary}");
    place.bad(
        &[&divided[..], &["--part", "0/2"]].concat(),
        2,
        &["--part", "--adaptive"],
    );
    for part in [["--samples", "0:8"], ["--part", "0/2"]] {
        let both = [&arguments[..], &part].concat();
        place.bad(&both, 2, &[part[0], "--noise"]);
    }
    let shared = [&arguments[..], &["--sampler", "blue-noise", "--spp", "64"]].concat();
    place.bad(&shared, 2, &["adaptive", "share a sequence"]);
}

/// Error as blue noise needs to know the number of samples, and is another picture.
#[test]
fn error_as_blue_noise() {
    let place = Place::new();
    place.good(&tiny(&["--sampler", "blue-noise", "-o", "blue.exr"]));
    place.good(&tiny(&["-o", "own.exr"]));
    assert_ne!(
        place.image("blue.exr").pixels,
        place.image("own.exr").pixels
    );
    place.bad(&["render", "--sampler", "blue-noise"], 2, &["--spp"]);
}

/// A shader that stops ending in the middle of a picture is named, with its loop.
#[test]
fn a_shader_that_does_not_end_is_named() {
    let place = Place::new();
    place.write(
        "stuck.wgsl",
        "fn eval(wi: vec3f, wo: vec3f) -> vec3f {\n  var x = wi;\n  while x.x > 0.2 && x.x < 0.22 { x.y += 1.0; }\n  return x;\n}",
    );
    let ball = BALL.replace("\"lambertian\"", "\"stuck.wgsl\"");
    let scene = place.write(
        "ball.toml",
        ball.replace("reflectance = 0.5", "step_limit = 1000"),
    );
    let said = place.good(&tiny(&[&scene, "-o", "a.png"]));
    for words in [
        "'grey'",
        "did not end after 1000 steps, in the loop at line 3",
    ] {
        assert!(said.err.contains(words), "{words}: {said:?}");
    }
}

#[test]
fn quiet_says_nothing() {
    let place = Place::new();
    let scene = place.write("ball.toml", BALL);
    let said = place.good(&tiny(&[&scene, "-q"]));
    assert_eq!((said.out.as_str(), said.err.as_str()), ("", ""));
}

#[test]
fn time_and_noise_end_a_rendering() {
    let place = Place::new();
    let scene = place.write("ball.toml", BALL);
    let run = |more: &[&str]| {
        place.json(
            &[
                &["render", &scene, "--size", "8x8", "-o", "a.exr", "--json"],
                more,
            ]
            .concat(),
        )
    };
    assert_eq!(run(&["--time", "0.2s"])["stopped_by"], "time");
    let quiet = run(&["--noise", "50%"]);
    assert_eq!(quiet["stopped_by"], "noise");
    assert!(quiet["noise"].as_f64().unwrap() <= 0.5);
    assert_eq!(
        run(&["--noise", "1e-9%", "--spp", "2"])["stopped_by"],
        "samples"
    );
}

#[test]
fn a_mesh_without_camera_and_light_gets_both_and_says_so() {
    let place = Place::new();
    for extension in ["glb", "obj", "ply"] {
        let name = place.write(&format!("triangle.{extension}"), triangle(extension));
        let said = place.good(&tiny(&[&name, "-o", "a.exr"]));
        assert!(
            said.err
                .contains("note: the scene has no light: the built-in panorama lights it"),
            "{said:?}"
        );
        assert!(
            said.err.contains("note: the scene has no camera"),
            "{said:?}"
        );
        assert!(!said.err.contains("warning"), "{said:?}");
        let image = place.image("a.exr");
        assert!(
            image.pixels.iter().flatten().any(|c| *c > 0.0),
            "{extension}"
        );
    }
}

#[test]
fn a_dark_environment_that_was_asked_for_stays_dark() {
    let place = Place::new();
    let name = place.write("triangle.glb", triangle("glb"));
    let said = place.good(&tiny(&[&name, "--env", "uniform:0", "-o", "a.exr"]));
    assert!(
        said.err.contains("warning: the scene has no light"),
        "{said:?}"
    );
    assert_eq!(said.err.matches("no light").count(), 1, "{said:?}");
    assert!(
        place
            .image("a.exr")
            .pixels
            .iter()
            .flatten()
            .all(|c| *c == 0.0)
    );
}

#[test]
fn environments_from_files_turn() {
    let place = Place::new();
    let scene = place.write("triangle.glb", triangle("glb"));
    // A panorama whose right half is bright, so that half a turn changes what is seen.
    let half = Image::from_fn(16, 8, |x, _| if x < 8 { [0.0; 3] } else { [1.0; 3] });
    place.picture("half.hdr", &half);
    place.picture("half.exr", &half);
    let look = |env: &str, degrees: &str| {
        place.good(&tiny(&[
            &scene,
            "--env",
            env,
            "--env-rotate",
            degrees,
            "-o",
            "a.exr",
        ]));
        place.image("a.exr").pixels
    };
    let still = look("half.hdr", "0");
    assert_eq!(still, look("half.exr", "0"));
    assert_eq!(still, look("half.hdr", "360"));
    assert_ne!(still, look("half.hdr", "180"));
    assert_ne!(still, look("half.hdr", "-90"));
}

#[test]
fn the_scenes_own_environment_turns() {
    let place = Place::new();
    place.picture("half.hdr", &Image::from_fn(16, 8, |x, _| [x as f32; 3]));
    let scene = place.write(
        "ball.toml",
        BALL.replace("uniform = 1.0", "file = \"half.hdr\""),
    );
    let look = |degrees: &str| {
        place.good(&tiny(&[&scene, "--env-rotate", degrees, "-o", "a.exr"]));
        place.image("a.exr").pixels
    };
    assert_ne!(look("0"), look("90"));
}

#[test]
fn materials_are_replaced_by_name_or_all() {
    let place = Place::new();
    let two = BALL.replace(
        "[[shape]]",
        "[[material]]\nname = \"a=b\"\nmodel = \"mirror\"\n\n[[shape]]",
    );
    let scene = place.write("ball.toml", two);
    for (material, albedo) in [
        ("lambertian:reflectance=0.25", 0.25),
        ("grey=lambertian:reflectance=0.75", 0.75),
        ("*=lambertian:reflectance=0", 0.0),
        // Another material, whose name has the sign itself.
        ("a=b=lambertian:reflectance=0", 0.5),
    ] {
        place.good(&[&["render", &scene, "--material", material], &WELL[..]].concat());
        let seen = centre(&place.image("a.exr"));
        assert!((seen - albedo).abs() <= 0.04 * albedo, "{material}: {seen}");
    }
    place.bad(
        &tiny(&[&scene, "--material", "gray=ggx"]),
        2,
        &["did you mean `grey`?"],
    );
}

#[test]
fn the_preview_keeps_its_stand_when_its_object_changes() {
    let place = Place::new();
    let look = |material: &str| {
        place.good(&tiny(&["--material", material, "-o", "a.exr"]));
        place.image("a.exr").pixels
    };
    assert_eq!(
        look("lambertian:reflectance=0.9"),
        look("object=lambertian:reflectance=0.9")
    );
    assert_ne!(
        look("lambertian:reflectance=0.9"),
        look("*=lambertian:reflectance=0.9")
    );
}

#[test]
fn cameras_are_chosen_by_name_and_number() {
    let place = Place::new();
    let cameras = "[[camera]]\nname = \"front\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n\n\
                   [[camera]]\nname = \"away\"\neye = [0, 0, 5]\ntarget = [0, 0, 9]\n";
    let scene = place.write("ball.toml", format!("{BALL}\n{cameras}"));
    let look = |more: &[&str]| {
        let said = place.good(&tiny(
            &[&[scene.as_str(), "-o", "a.exr", "--filter", "box"], more].concat(),
        ));
        assert_eq!(said.err, "");
        place.image("a.exr").get(8, 8)[0]
    };
    // The front one sees the ball, the other the sky.
    assert!(look(&[]) < 0.6);
    assert!(look(&["--camera", "front"]) < 0.6);
    assert_eq!(look(&["--camera", "away"]), 1.0);
    assert_eq!(look(&["--camera", "1"]), 1.0);
    place.bad(
        &tiny(&[&scene, "--camera", "frnt"]),
        2,
        &["did you mean `front`?"],
    );
    place.bad(
        &tiny(&[&scene, "--camera", "2"]),
        2,
        &["there is no camera `2`", "front, away"],
    );
}

#[test]
fn a_gltf_file_with_its_buffer_beside_it() {
    let place = Place::new();
    let file = glb(CORNERS, [0, 1, 2], |document| {
        document["buffers"][0]["uri"] = "triangle.bin".into();
    });
    // The container holds the document and the buffer: take them apart.
    let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    place.write("triangle.bin", &file[20 + length + 8..]);
    let scene = place.write("triangle.gltf", &file[20..20 + length]);
    place.picture("sky.exr", &panorama());
    let said = place.good(&tiny(&[&scene, "--env", "sky.exr", "-o", "a.png"]));
    assert!(!said.err.contains("light"), "{said:?}");
}

#[test]
fn exr_files_have_layers_and_say_how_they_came_to_be() {
    let place = Place::new();
    let scene = place.write("ball.toml", BALL);
    place.good(&tiny(&[&scene, "-o", "a.exr", "--seed", "9"]));
    let layers = gonio::image::Layers::read_exr(&place.path().join("a.exr")).unwrap();
    for name in ["R", "albedo.R", "normal.X", "variance.R"] {
        assert!(
            layers.channels.iter().any(|c| c.name == name),
            "{name}: {:?}",
            layers.channels.iter().map(|c| &c.name).collect::<Vec<_>>()
        );
    }
    assert_eq!(layers.metadata("gonio.seed"), Some("9"));
}
