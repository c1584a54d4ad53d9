//! `gonio env convert`.

use crate::support::{Place, panorama};
use gonio::image::{CubeMap, Image};

#[test]
fn a_panorama_goes_round_through_files() {
    let place = Place::new();
    let sky = place.picture("sky.hdr", &panorama());
    let report = place.json(&[
        "env",
        "convert",
        &sky,
        "cube.ktx2",
        "--size",
        "8",
        "--mips",
        "--json",
    ]);
    assert_eq!(report["to"]["layout"], "cube-strip");
    assert_eq!(report["to"]["convention"], "opengl");
    assert_eq!(report["files"], serde_json::json!(["cube.ktx2"]));
    // The panorama's step at the horizon is blurred over a row of 22.5°: from below, where 0.5 meets 2, the glow between is
    // ∫ 1.5 (1/2 − θ/22.5°) sin θ dω over half a row: 3 % of the lower half's irradiance.
    assert!(report["worst"].as_f64().unwrap() < 0.04, "{report}");
    let cube = CubeMap::read(&place.path().join("cube.ktx2")).unwrap();
    assert_eq!((cube.size, cube.levels.len()), (8, 4));
    for (from, to, more) in [
        ("cube.ktx2", "cube.dds", ["--texels", "bc6h"]),
        ("cube.dds", "square.exr", ["--to", "octahedral"]),
        ("cube.ktx2", "faces", ["--to", "cube-faces"]),
        ("faces", "face_{face}.png", ["--exposure", "-2"]),
        ("face_{face}.png", "back.exr", ["--rotate", "90,0,0"]),
    ] {
        let said = place.good(&["env", "convert", from, to, more[0], more[1]]);
        assert!(
            said.out.contains("ratio") && said.out.contains(to),
            "{said:?}"
        );
        assert_eq!(said.err, "");
    }
    let above = place.image("face_py.png").get(4, 4);
    // 2 · 2⁻² = 0.5, within a step of 8-bit sRGB.
    assert!((above[0] - 0.5).abs() < 0.005, "{above:?}");
    let info = place.json(&["env", "info", "faces", "--json"]);
    assert_eq!(
        (&info["layout"], &info["width"]),
        (&"cube-strip".into(), &48.into())
    );
    // It is light, too.
    let up = |env: &str| {
        let said = place.good(&["measure", "irradiance", "--env", env, "--normal", "0,1,0"]);
        said.out
            .split_whitespace()
            .find_map(|w| w.parse::<f64>().ok())
            .unwrap()
    };
    assert!((up("cube.ktx2") / up("sky.hdr") - 1.0).abs() < 0.03);
}

#[test]
fn bad_words_and_files_are_answered() {
    let place = Place::new();
    let sky = place.picture("sky.exr", &panorama());
    let square = place.picture("square.exr", &Image::filled(8, 8, [1.0; 3]));
    let convert = |words: &[&'static str], code, expected: &[&str]| {
        let all: Vec<&str> = [&["env", "convert"], words].concat();
        place.bad(&all, code, expected);
    };
    assert_eq!((sky.as_str(), square.as_str()), ("sky.exr", "square.exr"));
    convert(
        &["sky.exr", "a.exr", "--to", "octahedrl"],
        2,
        &["did you mean \"octahedral\"", "cube-faces"],
    );
    convert(
        &["sky.exr", "a.exr", "--convention", "pbr"],
        2,
        &["did you mean \"pbrt\""],
    );
    convert(&["sky.exr", "a.jpg"], 2, &[".jpg", ".ktx2"]);
    convert(&["sky.exr", "a.hdr", "--mips"], 2, &["--mips", ".dds"]);
    convert(
        &["sky.exr", "a.png", "--texels", "half"],
        2,
        &["--texels half"],
    );
    convert(&["sky.exr", "a.exr", "--to", "cube-faces"], 2, &["{face}"]);
    convert(
        &["sky.exr", "a.exr", "--rotate", "1,2"],
        2,
        &["yaw,pitch,roll"],
    );
    convert(&["sky.exr", "no/a.exr"], 3, &["no", "mkdir"]);
    convert(&["square.exr", "a.exr"], 3, &["8 × 8", "--from lat-long"]);
    convert(
        &["sky.exr", "a.exr", "--from", "cube-cross"],
        3,
        &["16 × 8", "4 : 3"],
    );
    convert(&["none.hdr", "a.exr"], 3, &["none.hdr: no such file"]);
    place.good(&[
        "env",
        "convert",
        "square.exr",
        "a.exr",
        "--from",
        "octahedral",
    ]);
}

#[test]
fn unsound_texels_are_repaired_only_when_asked() {
    let place = Place::new();
    let mut image = Image::filled(16, 8, [2.0; 3]);
    image.set(5, 3, [1.0, f32::NAN, 1.0]);
    image.set(6, 3, [f32::INFINITY; 3]);
    image.write(&place.path().join("sky.exr")).unwrap();
    place.bad(
        &["env", "convert", "sky.exr", "a.exr"],
        3,
        &["(5, 3)", "NaN", "2 such", "--repair"],
    );
    let said = place.good(&["env", "convert", "sky.exr", "a.exr", "--repair"]);
    assert!(said.err.contains("2 unsound texels"), "{said:?}");
    assert_eq!(place.image("a.exr"), Image::filled(16, 8, [2.0; 3]));
    let info = place.json(&["env", "info", "sky.exr", "--repair", "--json"]);
    assert_eq!(info["non_finite_replaced"], 2);
}

#[test]
fn truncated_textures_name_the_byte() {
    let place = Place::new();
    place.picture("sky.exr", &panorama());
    for name in ["a.ktx2", "a.dds"] {
        place.good(&["env", "convert", "sky.exr", name, "--size", "4"]);
        let bytes = place.read(name);
        place.write(name, &bytes[..bytes.len() - 1]);
        let byte = format!("byte {}", bytes.len() - 1);
        place.bad(&["env", "info", name], 3, &[name, &byte, "end of the file"]);
    }
}

#[test]
fn black_and_single_texels_have_a_stated_result() {
    let place = Place::new();
    place.picture("one.exr", &Image::filled(1, 1, [3.0; 3]));
    place.picture("black.exr", &Image::new(16, 8));
    let said = place.good(&["env", "convert", "black.exr", "b.exr", "--to", "octahedral"]);
    assert!(said.out.contains("none: no light"), "{said:?}");
    place.bad(&["env", "convert", "one.exr", "o.ktx2"], 3, &["1 × 1"]);
    place.good(&[
        "env", "convert", "one.exr", "o.ktx2", "--from", "lat-long", "--size", "2",
    ]);
    let cube = CubeMap::read(&place.path().join("o.ktx2")).unwrap();
    assert!(
        cube.levels[0]
            .iter()
            .all(|face| *face == Image::filled(2, 2, [3.0; 3]))
    );
}

/// What a person may hand over by mistake.
#[test]
fn what_is_no_panorama_is_named() {
    let place = Place::new();
    place.picture("sky.exr", &panorama());
    std::fs::create_dir(place.path().join("empty")).unwrap();
    place.write("nothing.hdr", b"");
    // 4 GiB without a block on the disk: of a picture that ends, and of nothing.
    for (name, start) in [
        ("zeros.exr", &b""[..]),
        (
            "huge.hdr",
            b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 32768 +X 65536\n",
        ),
        ("huge.png", b"\x89PNG\r\n\x1a\n"),
        ("huge.tif", b"II*\0"),
    ] {
        place.write(name, start);
        let file = std::fs::File::options()
            .write(true)
            .open(place.path().join(name))
            .unwrap();
        file.set_len(4 << 30).unwrap();
    }
    for (name, words) in [
        (
            "empty",
            &[
                "empty: a folder without any, expected the six faces of a cube",
                "px.exr",
            ][..],
        ),
        (
            "nothing.hdr",
            &["nothing.hdr", "an empty file", "EXR, Radiance HDR"],
        ),
        ("zeros.exr", &["zeros.exr", "bytes 00 00", "expected EXR"]),
        ("huge.hdr", &["huge.hdr", "exceed the limit"]),
        ("huge.png", &["huge.png", "PNG"]),
        ("huge.tif", &["huge.tif", "TIFF"]),
    ] {
        for arguments in [
            &["env", "convert", name, "out.exr", "--from", "lat-long"][..],
            &["env", "info", name],
        ] {
            place.bad(arguments, 3, words);
        }
    }
}

#[test]
fn a_tiff_is_a_panorama_too() {
    let place = Place::new();
    place.write("sky.tif", tiff_of_floats(&panorama()));
    place.good(&["env", "convert", "sky.tif", "sky.exr"]);
    assert_eq!(place.image("sky.exr"), panorama());
}

/// A TIFF of 32-bit floats in one strip: the directory first, then what its entries point to. TIFF 6.0, section 2.
fn tiff_of_floats(image: &Image) -> Vec<u8> {
    let (width, height) = (image.width as u32, image.height as u32);
    let entries: [[u32; 4]; 10] = [
        [256, 4, 1, width],
        [257, 4, 1, height],
        // Bits, and the kind of sample (3, a float), of each channel are after the directory.
        [258, 3, 3, 134],
        [259, 3, 1, 1],
        [262, 3, 1, 2],
        [273, 4, 1, 146],
        [277, 3, 1, 3],
        [278, 4, 1, height],
        [279, 4, 1, 12 * width * height],
        [339, 3, 3, 140],
    ];
    let mut bytes = b"II*\0\x08\0\0\0\x0a\0".to_vec();
    for [tag, kind, count, value] in entries {
        bytes.extend((tag as u16).to_le_bytes());
        bytes.extend((kind as u16).to_le_bytes());
        bytes.extend(count.to_le_bytes());
        bytes.extend(value.to_le_bytes());
    }
    bytes.extend([0; 4]);
    for number in [32_u16, 32, 32, 3, 3, 3] {
        bytes.extend(number.to_le_bytes());
    }
    let samples = image.pixels.iter().flatten();
    bytes.extend(samples.flat_map(|c| c.to_le_bytes()));
    bytes
}

/// Standard error is a terminal only for who watches: `script` makes one.
#[cfg(target_os = "linux")]
#[test]
fn a_conversion_shows_how_far_it_is() {
    let place = Place::new();
    place.picture("sky.exr", &Image::filled(512, 256, [1.0; 3]));
    let command = format!(
        "{} env convert sky.exr out.exr --to octahedral --size 400",
        env!("CARGO_BIN_EXE_gonio")
    );
    let run = std::process::Command::new("script")
        .args(["-qec", &command, "/dev/null"])
        .current_dir(place.path())
        .env("TERM", "xterm")
        .output();
    let Ok(output) = run else {
        eprintln!("skipped: no `script` here");
        return;
    };
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}");
    for word in ["reading", "converting", " %"] {
        assert!(said.contains(word), "no {word:?} in {said}");
    }
    // Without a terminal there is nothing to see.
    let quiet = place.good(&["env", "convert", "sky.exr", "out.exr", "--to", "octahedral"]);
    assert_eq!(quiet.err, "");
}
