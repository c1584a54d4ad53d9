//! Every encoding, and every way in which a file can be broken.

use super::*;
use gonio_num::Vec3;

const HEADER: &str = "element vertex 4\nproperty float x\nproperty double y\nproperty float z\n\
    property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n\
    property uchar red\nproperty uchar green\nproperty uchar blue\n\
    element face 2\nproperty list uchar int vertex_indices\nproperty uchar flags\n\
    element edge 1\nproperty list uchar short ends\nend_header\n";

const VERTICES: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.5],
    [0.0, 1.0, 0.0],
];

fn binary(big: bool) -> Vec<u8> {
    let name = if big { "big" } else { "little" };
    let mut out = format!("ply\nformat binary_{name}_endian 1.0\n{HEADER}").into_bytes();
    let mut put = |le: &[u8]| {
        let mut b = le.to_vec();
        if big {
            b.reverse();
        }
        out.extend(b);
    };
    for [x, y, z] in VERTICES {
        put(&x.to_le_bytes());
        put(&f64::from(y).to_le_bytes());
        put(&z.to_le_bytes());
        for n in [0.0f32, 0.0, 1.0, x, y] {
            put(&n.to_le_bytes());
        }
        for c in [255u8, 0, 128] {
            put(&[c]);
        }
    }
    for face in [&[0i32, 1, 2, 3][..], &[0, 2, 1]] {
        put(&[face.len() as u8]);
        for i in face {
            put(&i.to_le_bytes());
        }
        put(&[7]);
    }
    put(&[2]);
    put(&0i16.to_le_bytes());
    put(&1i16.to_le_bytes());
    out
}

fn ascii() -> Vec<u8> {
    let mut text = format!("ply\r\nformat ascii 1.0\ncomment made by hand\n{HEADER}");
    for [x, y, z] in VERTICES {
        text += &format!("{x} {y} {z}  0 0 1 {x} {y} 255 0 128\n");
    }
    text += "4 0 1 2 3 7\n3 0 2 1 7\n2 0 1";
    text.into_bytes()
}

fn load(bytes: &[u8]) -> Result<TriangleMesh, String> {
    parse(bytes, Path::new("a.ply")).map_err(|e| e.to_string())
}

#[test]
fn all_encodings_give_the_same_mesh() {
    let mesh = load(&ascii()).unwrap();
    assert_eq!(mesh.positions[2], Vec3::new(1.0, 1.0, 0.5));
    assert_eq!(mesh.indices, [[0, 1, 2], [0, 2, 3], [0, 2, 1]]);
    assert_eq!(mesh.uvs[2], [1.0, 0.0]);
    assert_eq!(mesh.normals, [Vec3::new(0.0, 0.0, 1.0); 4]);
    // sRGB 128/255 is linear 0.21586.
    assert!((mesh.colours[0][2] - 0.215_860_5).abs() < 1e-6);
    assert_eq!(mesh.colours[0][0], 1.0);
    assert_eq!(load(&binary(false)).unwrap(), mesh);
    assert_eq!(load(&binary(true)).unwrap(), mesh);
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    for whole in [binary(false), binary(true)] {
        for end in 0..whole.len() {
            assert!(load(&whole[..end]).is_err(), "cut at {end}");
        }
    }
    // Ascii may lose digits of its last word unnoticed, but no word.
    let whole = ascii();
    for end in 0..whole.len() - 1 {
        assert!(load(&whole[..end]).is_err(), "cut at {end}");
    }
}

#[test]
fn changed_bytes_never_panic() {
    for whole in [ascii(), binary(false), binary(true)] {
        for i in 0..whole.len() {
            for change in [0x00, 0xff, b'9', b'-', b'\n'] {
                let mut b = whole.clone();
                b[i] = change;
                if let Ok(mesh) = load(&b) {
                    mesh.check().unwrap();
                }
            }
        }
    }
}

#[test]
fn a_huge_count_is_refused_without_its_memory() {
    for count in ["4000000000", "18446744073709551615"] {
        for element in ["vertex 4", "face 2", "edge 1"] {
            let name = element.split(' ').next().unwrap();
            for whole in [ascii(), binary(false)] {
                let text = whole.clone();
                let at = text
                    .windows(element.len())
                    .position(|w| w == element.as_bytes())
                    .unwrap();
                let mut b = whole[..at].to_vec();
                b.extend(format!("{name} {count}").bytes());
                b.extend(&whole[at + element.len()..]);
                let e = load(&b).unwrap_err();
                assert!(e.contains(count) && e.contains(name), "{e}");
            }
        }
    }
    let list = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uint int vertex_indices\nend_header\n0 0 0\n4000000000 0 0 0\n";
    assert!(load(list.as_bytes()).unwrap_err().contains("face 0"));
}

#[test]
fn faults_name_place_find_and_expectation() {
    let text = String::from_utf8(ascii()).unwrap();
    let cases = [
        (
            text.replace("4 0 1 2 3", "4 0 1 2 9"),
            "triangle 1",
            "vertex index 9",
        ),
        (
            text.replace("4 0 1 2 3", "4 0 1 2 -1"),
            "face 0",
            "vertex index -1",
        ),
        (text.replace("4 0 1 2 3", "4 0 1 2.5 3"), "face 0", "2.5"),
        (text.replace("3 0 2 1 7", "2 0 2 7"), "face 1", "2 corners"),
        (text.replace("1 1 0.5", "1 nan 0.5"), "vertex 2", "NaN"),
        (text.replace("1 1 0.5", "1 inf 0.5"), "vertex 2", "inf"),
        (
            text.replace("1 1 0.5", "1 what 0.5"),
            "vertex 2, y (line",
            "\"what\"",
        ),
        (text.replace("ascii 1.0", "ascii 2.0"), "line 2", "format"),
        (
            text.replace("format ascii 1.0\n", ""),
            "line",
            "without a format",
        ),
        (
            text.replace("property float x", "property quad x"),
            "line 5",
            "a type",
        ),
        (
            text.replace("property float x\n", ""),
            "vertex",
            "no x, y and z",
        ),
        (
            text.replace("list uchar int", "list float int"),
            "line",
            "whole number",
        ),
        (
            text.replace("element vertex", "element point"),
            "the header",
            "no element `vertex`",
        ),
        (
            text.replace("element face", "element side"),
            "the header",
            "no element `face`",
        ),
        (text.replace("vertex_indices", "corners"), "face", "no list"),
        (
            text.replace("end_header", "end_heade"),
            "line",
            "end_header",
        ),
        ("PNG".into(), "line 1", "the word ply"),
        (String::new(), "line 1", "the word ply"),
        ("ply\n".into(), "line 2", "end_header"),
    ];
    for (text, place, what) in cases {
        let e = load(text.as_bytes()).unwrap_err();
        assert!(
            e.contains("a.ply") && e.contains(place) && e.contains(what),
            "expected {place} and {what}: {e}"
        );
    }
}

#[test]
fn a_missing_file_is_named() {
    let e = read(Path::new("/nowhere/none.ply")).unwrap_err();
    assert!(e.to_string().contains("none.ply"));
}
