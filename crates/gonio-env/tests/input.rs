//! Bad pictures and bad words: one clear error that names what is wrong, where, and how to go on.

use gonio_env::{EnvError, Environment, Layout, LoadOptions};
use gonio_image::Image;
use std::path::PathBuf;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a scratch folder")
}

fn options(layout: Option<Layout>, sanitize: bool) -> LoadOptions {
    LoadOptions {
        layout,
        sanitize,
        ..LoadOptions::default()
    }
}

fn parse_error(text: &str) -> EnvError {
    Environment::parse(text, &LoadOptions::default()).expect_err("a bad word")
}

/// Writes a picture and loads it.
fn through_file(image: &Image, options: &LoadOptions) -> Result<Environment, EnvError> {
    let folder = folder();
    let path = folder.path().join("sky.exr");
    image.write(&path).expect("a written picture");
    Environment::load_with(&path, options)
}

#[test]
fn uniform_words_are_read() {
    let of = |text| {
        Environment::parse(text, &LoadOptions::default())
            .unwrap()
            .mean_radiance()
    };
    assert_eq!(of("uniform:1"), [1.0; 3]);
    assert_eq!(of("uniform:0.5/0.25/2"), [0.5, 0.25, 2.0]);
    for text in ["uniform:", "uniform:x", "uniform:1/2", "uniform:1/2/3/4"] {
        let error = parse_error(text).to_string();
        assert!(error.contains("one number or three"), "{error}");
    }
    for text in ["uniform:-1", "uniform:NaN", "uniform:1/inf/1"] {
        let error = parse_error(text).to_string();
        assert!(
            error.starts_with("radiance = ") && error.contains("≥ 0"),
            "{error}"
        );
    }
}

#[test]
fn a_missing_file_is_named_and_a_word_suggested() {
    let error = parse_error("no/such/sky.hdr");
    assert_eq!(error.to_string(), "no/such/sky.hdr: no such file");
    assert!(error.help().unwrap().contains("uniform:r/g/b"));
    let error = parse_error("unifrom:1");
    assert_eq!(error.help().unwrap(), "did you mean \"uniform:1\"?");
}

#[test]
fn unsound_texels_are_named_or_replaced_and_counted() {
    let mut image = Image::filled(8, 4, [1.0; 3]);
    image.set(5, 1, [0.5, f32::NAN, 0.5]);
    image.set(2, 3, [-2.0, 1.0, 1.0]);
    image.set(0, 2, [3.0, 1.0, f32::INFINITY]);
    let error = through_file(&image, &options(None, false)).unwrap_err();
    let text = error.to_string();
    assert!(
        text.contains("sky.exr: texel (5, 1) has G = NaN, expected a finite number ≥ 0 (3 such"),
        "{text}"
    );
    assert!(error.help().unwrap().contains("--env-sanitize"));

    let info = through_file(&image, &options(None, true)).unwrap().info();
    assert_eq!((info.non_finite_replaced, info.negative_replaced), (2, 1));
    assert!(info.irradiance.iter().flatten().all(|e| e.is_finite()));
    // +∞ became the largest finite value, 3.
    assert_eq!(info.peak.texel, [0, 2]);
    assert_eq!(info.peak.radiance, [3.0, 1.0, 3.0]);
}

#[test]
fn what_stands_outside_a_disc_is_not_looked_at() {
    let mut image = Image::filled(16, 16, [1.0; 3]);
    image.set(0, 0, [f32::NAN; 3]);
    image.set(15, 0, [1e9; 3]);
    for layout in [Layout::Angular, Layout::MirrorBall] {
        let env = Environment::from_image(image.clone(), layout).unwrap();
        let info = env.info();
        assert_eq!(info.peak.radiance, [1.0; 3], "{layout}");
        assert!(
            (info.mean_radiance[0] - 1.0).abs() < 1e-6,
            "{layout}: {:?}",
            info.mean_radiance
        );
        assert_eq!(info.non_finite_replaced, 0);
    }
}

#[test]
fn the_layout_is_found_or_asked_for() {
    let of = |w, h| through_file(&Image::filled(w, h, [1.0; 3]), &LoadOptions::default());
    assert_eq!(of(6, 3).unwrap().info().layout, Some(Layout::LatLong));
    let error = of(5, 3).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("5 × 3 pixels: the layout can't be told"),
        "{error}"
    );
    assert!(error.help().unwrap().contains("--env-layout lat-long"));
    // Any shape will do once it is named.
    let named = through_file(
        &Image::filled(5, 3, [1.0; 3]),
        &options(Some(Layout::LatLong), false),
    );
    assert_eq!(named.unwrap().info().width, 5);

    let disc = gonio_env::test_image::six_axes(Layout::Angular, 32);
    let error = through_file(&disc, &LoadOptions::default()).unwrap_err();
    assert!(
        error.to_string().contains("black outside a disc"),
        "{error}"
    );
    assert!(
        error
            .help()
            .unwrap()
            .contains("--env-layout angular` or `--env-layout mirror-ball")
    );

    let error =
        Environment::from_image(Image::filled(4, 2, [1.0; 3]), Layout::Angular).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("4 × 2 pixels, expected a square picture"),
        "{error}"
    );
}

#[test]
fn an_empty_or_inconsistent_picture_is_refused() {
    for (width, height, pixels) in [(0, 0, 0), (0, 4, 0), (2, 2, 3)] {
        let image = Image {
            width,
            height,
            pixels: vec![[1.0; 3]; pixels],
        };
        let error = Environment::from_image(image, Layout::LatLong).unwrap_err();
        assert!(matches!(error, EnvError::Shape { .. }), "{error}");
    }
}

#[test]
fn broken_files_are_errors_of_their_reader() {
    let folder = folder();
    let sound = folder.path().join("sound.hdr");
    Image::filled(64, 32, [1.0; 3]).write(&sound).unwrap();
    let bytes = std::fs::read(&sound).unwrap();
    let write = |name: &str, bytes: &[u8]| -> PathBuf {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    for path in [
        write("truncated.hdr", &bytes[..bytes.len() / 2]),
        write("empty.hdr", &[]),
        write("words.hdr", b"these are only words"),
        write(
            "huge.hdr",
            b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n",
        ),
    ] {
        let error = Environment::load(&path, None).unwrap_err();
        assert!(matches!(error, EnvError::Image(_)), "{error}");
        let name = path.file_name().unwrap().to_str().unwrap();
        assert!(error.to_string().contains(name), "{error}");
    }
}

#[test]
fn a_folder_without_six_faces_says_what_it_has() {
    let folder = folder();
    let error = |path: PathBuf| Environment::load(path, None).unwrap_err();
    let of_folder = || error(folder.path().to_owned());
    assert!(
        of_folder()
            .to_string()
            .ends_with("a folder without any, expected the six faces of a cube")
    );
    let of_pattern = || error(folder.path().join("sky_{face}.png"));
    assert!(
        of_pattern()
            .to_string()
            .contains("sky_px.png, expected the six faces")
    );
    let face = Image::filled(4, 4, [1.0; 3]);
    for name in ["posx.hdr", "negx.hdr", "sky_right.png"] {
        face.write(&folder.path().join(name)).unwrap();
    }
    assert!(of_folder().to_string().contains("posx.hdr but no posy.hdr"));
    assert!(
        of_pattern()
            .to_string()
            .contains("sky_right.png but no sky_left.png")
    );
    assert!(of_pattern().help().unwrap().contains("px.exr … nz.exr"));
}

#[test]
fn numbers_out_of_range_are_errors() {
    let env = Environment::uniform([1.0; 3]);
    assert!(
        env.clone()
            .try_rotated_deg(f32::NAN)
            .unwrap_err()
            .to_string()
            .contains("rotation = NaN")
    );
    assert!(
        env.clone()
            .try_scaled([1.0, -1.0, 1.0])
            .unwrap_err()
            .to_string()
            .contains("scale = 1/-1/1")
    );
    assert!(Environment::try_uniform([f32::INFINITY; 3]).is_err());
}

#[test]
fn information_reads_well() {
    let mut image = Image::filled(16, 8, [0.25, 0.5, 1.0]);
    // A sun of four clipped texels, up on the right.
    for (x, y) in [(11, 2), (12, 2), (11, 1), (12, 1)] {
        image.set(x, y, [1000.0; 3]);
    }
    let env = Environment::from_image(image, Layout::LatLong).unwrap();
    let info = env.info();
    assert!(info.looks_clipped);
    assert_eq!(info.texels_at_maximum, 4);
    assert_eq!(info.peak.texel, [11, 1]);
    // Texel 11 of 16: u = 11.5/16, φ = 360° (u − 1/2) = 78.75°; row 1 of 8: θ = 180° · 1.5/8.
    assert!((info.peak.phi_deg - 78.75).abs() < 1e-9 && (info.peak.theta_deg - 33.75).abs() < 1e-9);
    let turned = env.clone().rotated_deg(10.0).info();
    assert!(
        (turned.peak.phi_deg - 68.75).abs() < 1e-9,
        "counter-clockwise is to the left"
    );
    let text = info.to_string();
    for part in [
        "lat-long, 16 × 8",
        "W m⁻² sr⁻¹",
        "irradiance +y",
        "looks clipped",
        "θ = 33.75°",
    ] {
        assert!(text.contains(part), "{text}");
    }
    let json = serde_json::to_value(&info).unwrap();
    assert_eq!(json["layout"], "lat-long");
    assert_eq!(json["peak"]["texel"][0], 11);
    let uniform = Environment::uniform([1.0; 3]).info();
    assert!(!uniform.looks_clipped);
    assert_eq!(uniform.irradiance, [[std::f64::consts::PI; 3]; 6]);
    // A white picture is all maximum, but no sun.
    let white = Environment::from_image(Image::filled(16, 8, [1.0; 3]), Layout::LatLong).unwrap();
    assert!(!white.info().looks_clipped);
    assert_eq!(white.info().dynamic_range, Some(1.0));
    let black = Environment::from_image(Image::filled(16, 8, [0.0; 3]), Layout::LatLong).unwrap();
    assert_eq!(black.info().dynamic_range, None);
    assert_eq!(black.info().black_share, 1.0);
    assert!(black.info().to_string().contains("it is black"));
}
