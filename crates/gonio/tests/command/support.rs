//! A scratch folder in which the command runs, and small files to run it on.

use gonio::image::Image;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A folder of its own for each test, in which the command runs.
pub struct Place {
    folder: TempDir,
}

/// What the command said, and its exit code.
#[derive(Debug)]
pub struct Said {
    pub code: i32,
    pub out: String,
    pub err: String,
}

impl Place {
    pub fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
        }
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Writes a file; returns its name, for use as an argument.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        std::fs::write(self.path().join(name), bytes).unwrap();
        name.into()
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path().join(name)).unwrap()
    }

    /// Writes a picture in the format of the name's extension; returns the name.
    pub fn picture(&self, name: &str, image: &Image) -> String {
        image.write(&self.path().join(name)).unwrap();
        name.into()
    }

    pub fn image(&self, name: &str) -> Image {
        Image::read(&self.path().join(name)).unwrap()
    }

    /// The names of the files there are.
    pub fn files(&self) -> BTreeSet<PathBuf> {
        std::fs::read_dir(self.path())
            .unwrap()
            .map(|entry| PathBuf::from(entry.unwrap().file_name()))
            .collect()
    }

    /// The command with these arguments, not yet started.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
        command
            .args(arguments)
            .current_dir(self.path())
            .stdin(Stdio::null());
        command
    }

    /// Runs the command.
    pub fn gonio(&self, arguments: &[&str]) -> Said {
        said(self.command(arguments).output().unwrap(), arguments)
    }

    /// Runs the command, which must succeed.
    pub fn good(&self, arguments: &[&str]) -> Said {
        let said = self.gonio(arguments);
        assert_eq!(said.code, 0, "{arguments:?}: {said:?}");
        said
    }

    /// Runs the command, which must succeed and print JSON.
    pub fn json(&self, arguments: &[&str]) -> Value {
        let said = self.good(arguments);
        serde_json::from_str(&said.out)
            .unwrap_or_else(|e| panic!("{arguments:?} printed no JSON: {e}\n{}", said.out))
    }

    /// Runs the command, which must fail as the documentation says: with this exit code, one `error:` line, one `help:`
    /// line, nothing on standard output, these words in the message, and no file more or less than before.
    pub fn bad(&self, arguments: &[&str], code: i32, words: &[&str]) -> Said {
        let before = self.files();
        let said = self.gonio(arguments);
        let context = format!("{arguments:?}: {said:#?}");
        assert_eq!(said.code, code, "{context}");
        for (kind, others) in [("error: ", true), ("help: ", false)] {
            let count = said.err.lines().filter(|l| l.starts_with(kind)).count();
            assert_eq!(count, 1, "lines of {kind}{others}; {context}");
        }
        assert!(
            said.err.lines().last().unwrap().starts_with("help: "),
            "{context}"
        );
        assert_eq!(said.out, "", "{context}");
        for word in words {
            assert!(said.err.contains(word), "no {word:?} in {context}");
        }
        assert!(!said.err.contains("os error"), "{context}");
        assert_eq!(self.files(), before, "{context}");
        said
    }
}

/// What a process said. Whatever went wrong, it did not panic.
pub fn said(output: Output, arguments: &[&str]) -> Said {
    let said = Said {
        // A process that a signal ended has none.
        code: output.status.code().unwrap_or(-1),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    };
    assert!(!said.err.contains("panicked"), "{arguments:?}: {said:#?}");
    said
}

/// A grey ball under a uniform sky.
pub const BALL: &str = r#"
name = "ball"

[environment]
uniform = 1.0

[[material]]
name = "grey"
model = "lambertian"
params = { reflectance = 0.5 }

[[shape]]
kind = "sphere"
material = "grey"
"#;

/// Arguments that keep a rendering short.
pub const TINY: [&str; 4] = ["--size", "16x16", "--spp", "1"];

/// `arguments`, and those of a short rendering.
pub fn tiny<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    [&["render"], arguments, &TINY].concat()
}

/// A binary glTF file of one triangle in the plane z = 0; `change` may spoil its document.
pub fn glb(corners: [f32; 9], indices: [u16; 3], change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let mut bin: Vec<u8> = corners.iter().flat_map(|x| x.to_le_bytes()).collect();
    bin.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
    bin.resize(44, 0);
    let mut document = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"name": "paint", "doubleSided": true}],
        "buffers": [{"byteLength": 44}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}
        ]
    });
    change(&mut document);
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = b"glTF".to_vec();
    file.extend(2_u32.to_le_bytes());
    file.extend((28 + text.len() as u32 + bin.len() as u32).to_le_bytes());
    for (kind, data) in [(0x4E4F_534A_u32, &text), (0x004E_4942, &bin)] {
        file.extend((data.len() as u32).to_le_bytes());
        file.extend(kind.to_le_bytes());
        file.extend(data);
    }
    file
}

/// The corners of a triangle in the plane z = 0.
pub const CORNERS: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// A triangle in three formats: OBJ, PLY and binary glTF.
pub fn triangle(extension: &str) -> Vec<u8> {
    match extension {
        "obj" => b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec(),
        "ply" => ply("0 0 0", "0 1 2"),
        _ => glb(CORNERS, [0, 1, 2], |_| {}),
    }
}

/// A PLY file of one triangle, with this first vertex and these indices.
pub fn ply(first: &str, indices: &str) -> Vec<u8> {
    format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n{first}\n1 0 0\n0 1 0\n3 {indices}\n"
    )
    .into_bytes()
}

/// A panorama that is brighter above.
pub fn panorama() -> Image {
    Image::from_fn(16, 8, |_, y| if y < 4 { [2.0, 1.5, 1.0] } else { [0.5; 3] })
}
