//! Answers in a browser are those of the native library, to the last bit: hashes of them that `web/src/engine/same-bits.test.ts` compares with
//! what WebAssembly answers. `GONIO_UPDATE=1` writes them anew.

#![allow(clippy::unwrap_used)]

use gonio_web::call;
use serde_json::{Value, json};
use std::path::Path;

/// FNV-1a of 32 bits (Fowler, Noll & Vo): short enough to be written once more in TypeScript.
fn hash(bytes: &[u8]) -> u32 {
    let step = |h: u32, byte: &u8| (h ^ u32::from(*byte)).wrapping_mul(0x0100_0193);
    bytes.iter().fold(0x811c_9dc5, step)
}

#[test]
fn answers_are_the_same_everywhere() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = here.join("tests/answers.json");
    let mut answers: Vec<Value> =
        serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    // As a page has them.
    let folder = tempfile::tempdir().unwrap();
    let files = folder.path().join("files");
    std::fs::create_dir(&files).unwrap();
    for name in ["scene.toml", "ball.glb", "stand.glb", "sunset.hdr"] {
        let from = here.join("../../assets/preview").join(name);
        std::fs::copy(from, files.join(name)).unwrap();
    }
    std::env::set_current_dir(folder.path()).unwrap();

    let update = std::env::var_os("GONIO_UPDATE").is_some();
    for answer in &mut answers {
        let asked = json!({ "operation": answer["operation"], "request": answer["request"] });
        let bytes = call(&asked.to_string()).into_bytes();
        assert!(!bytes[8..].starts_with(b"{\"error"), "{asked}");
        let found = format!("{:08x}", hash(&bytes));
        if update {
            answer["hash"] = found.into();
        } else {
            assert_eq!(answer["hash"], found, "{asked}");
        }
    }
    if update {
        let text = serde_json::to_string_pretty(&answers).unwrap();
        std::fs::write(&file, text + "\n").unwrap();
    }
}

/// A hash tells one bit of one number.
#[test]
fn a_hash_tells_a_bit() {
    assert_eq!(hash(b""), 0x811c_9dc5);
    // The published value of "foobar".
    assert_eq!(hash(b"foobar"), 0xbf9c_f968);
    assert_ne!(
        hash(&0.5_f32.to_le_bytes()),
        hash(&0.500_000_06_f32.to_le_bytes())
    );
}
