//! Files that are missing, cut short, corrupt or huge, in every format: exit code 3, the file named, nothing written.

use crate::support::{CORNERS, Place, glb, panorama, ply, tiny, triangle};

/// The command that reads a file of this extension.
fn reader(file: &str) -> Vec<Vec<&str>> {
    match file.rsplit('.').next().unwrap() {
        "hdr" | "exr" | "png" | "jpg" => vec![
            vec!["env", "info", file],
            vec!["diff", file, file],
            vec!["measure", "irradiance", "--env", file],
            tiny(&["--env", file]),
        ],
        _ => vec![tiny(&[file]), vec!["measure", "irradiance", file]],
    }
}

fn refused(place: &Place, name: &str, bytes: &[u8]) {
    let file = place.write(name, bytes);
    for arguments in reader(&file) {
        place.bad(&arguments, 3, &[&file]);
    }
}

const SCENES: [&str; 5] = ["toml", "gltf", "glb", "obj", "ply"];
const PICTURES: [&str; 4] = ["hdr", "exr", "png", "jpg"];

#[test]
fn missing_files() {
    let place = Place::new();
    for extension in SCENES.into_iter().chain(PICTURES) {
        let file = format!("nowhere.{extension}");
        for arguments in reader(&file) {
            place.bad(&arguments, 3, &[&file]);
        }
    }
    // A file beside it was probably meant.
    place.write("helmet.glb", triangle("glb"));
    place.bad(
        &["render", "helmet.gld"],
        3,
        &["did you mean 'helmet.glb'?"],
    );
    place.bad(&["render", "helmt.glb"], 3, &["did you mean 'helmet.glb'?"]);
    place.bad(&["render", "."], 3, &["folder"]);
    place.bad(&["render", "helmet.fbx"], 3, &["helmet.fbx"]);
}

#[test]
fn empty_files_and_files_of_noise() {
    let place = Place::new();
    // Bytes that no format begins with.
    let noise: Vec<u8> = (0..600_u32)
        .map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8 | 0x80)
        .collect();
    for extension in SCENES.into_iter().chain(PICTURES) {
        refused(&place, &format!("empty.{extension}"), b"");
        refused(&place, &format!("noise.{extension}"), &noise);
    }
}

#[test]
fn files_cut_short() {
    let place = Place::new();
    for extension in ["glb", "ply"] {
        let whole = triangle(extension);
        refused(
            &place,
            &format!("cut.{extension}"),
            &whole[..whole.len() - 20],
        );
        refused(&place, &format!("begun.{extension}"), &whole[..10]);
    }
    refused(&place, "cut.obj", b"v 0 0 0\nv 1 0 0\nv 0 1");
    refused(
        &place,
        "cut.gltf",
        br#"{"asset": {"version": "2.0"}, "scenes": [{"nod"#,
    );
    refused(&place, "cut.toml", b"[[shape]]\nkind = \"sph");
    for extension in ["hdr", "exr", "png"] {
        let name = place.picture(&format!("whole.{extension}"), &panorama());
        let whole = place.read(&name);
        refused(
            &place,
            &format!("cut.{extension}"),
            &whole[..whole.len() * 2 / 3],
        );
    }
    // The beginning of a JPEG file.
    refused(
        &place,
        "cut.jpg",
        b"\xff\xd8\xff\xe0\x00\x10JFIF\x00\x01\x01\x00\x00\x01\x00\x01\x00\x00",
    );
}

#[test]
fn files_that_claim_to_be_huge() {
    let place = Place::new();
    refused(
        &place,
        "huge.hdr",
        b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n",
    );
    let name = place.picture("whole.png", &panorama());
    let mut png = place.read(&name);
    png[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    refused(&place, "huge.png", &png);
    let name = place.picture("whole.exr", &panorama());
    let mut exr = place.read(&name);
    let window = exr.windows(10).position(|w| w == b"dataWindow").unwrap() + 10 + 1 + 6 + 4;
    exr[window + 8..window + 16].copy_from_slice(&[0xff, 0xff, 0xff, 0x3f, 0xff, 0xff, 0xff, 0x3f]);
    refused(&place, "huge.exr", &exr);
    refused(
        &place,
        "huge.ply",
        b"ply\nformat binary_little_endian 1.0\nelement vertex 99999999999999\nproperty float x\nproperty float y\n\
          property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n",
    );
    let mut long = triangle("glb");
    long[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
    refused(&place, "huge.glb", &long);
    refused(
        &place,
        "many.glb",
        &glb(CORNERS, [0, 1, 2], |d| {
            d["accessors"][0]["count"] = 4_000_000_000_u32.into();
        }),
    );
}

#[test]
fn meshes_with_impossible_numbers() {
    let place = Place::new();
    let mut corners = CORNERS;
    corners[4] = f32::NAN;
    refused(&place, "nan.glb", &glb(corners, [0, 1, 2], |_| {}));
    corners[4] = f32::INFINITY;
    refused(&place, "inf.glb", &glb(corners, [0, 1, 2], |_| {}));
    refused(&place, "range.glb", &glb(CORNERS, [0, 1, 7], |_| {}));
    refused(&place, "nan.ply", &ply("nan 0 0", "0 1 2"));
    refused(&place, "range.ply", &ply("0 0 0", "0 1 3"));
    refused(&place, "below.ply", &ply("0 0 0", "0 1 -1"));
    refused(&place, "nan.obj", b"v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    refused(&place, "range.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    refused(&place, "zero.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n");
}

#[test]
fn degenerate_triangles_are_warned_about_and_left_out() {
    let place = Place::new();
    let file = place.write("two.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\n");
    let said = place.good(&tiny(&[&file]));
    assert_eq!(said.err.matches("warning: ").count(), 1, "{said:?}");
    assert!(said.err.contains("degenerate"), "{said:?}");
}
