//! The container on files made here, whole and broken.

use super::*;

fn path() -> &'static Path {
    Path::new("made/here.bsdf")
}

fn example() -> TensorWriter {
    let mut file = TensorWriter::new();
    file.bytes("description", &[5], b"paper");
    file.f32s("theta_i", &[2], &[0.0, 1.5]);
    file.f64s("wide", &[1, 3], &[1.0, -2.0, 1e300]);
    file.bytes("nothing", &[0, 7], &[]);
    file.bytes("one", &[], &[1]);
    file
}

#[test]
fn what_is_written_is_read() {
    let bytes = example().to_bytes();
    let file = TensorFile::parse(&bytes, path()).unwrap();
    let names: Vec<_> = file.fields().iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names, ["description", "theta_i", "wide", "nothing", "one"]);
    let field = |name| file.find(name).unwrap();
    assert_eq!(file.text(field("description")).unwrap(), "paper");
    assert_eq!(file.f32s(field("theta_i")).unwrap(), [0.0, 1.5]);
    assert_eq!(file.f64s(field("theta_i")).unwrap(), [0.0, 1.5]);
    assert_eq!(file.f64s(field("wide")).unwrap(), [1.0, -2.0, 1e300]);
    assert_eq!(
        (field("wide").shape.as_slice(), field("wide").dtype),
        (&[1, 3][..], Dtype::F64)
    );
    assert_eq!((field("nothing").count(), field("one").count()), (0, 1));
    assert!(file.f32s(field("wide")).is_none() && file.f64s(field("one")).is_none());
    assert!(file.text(field("wide")).is_none() && file.find("absent").is_none());
    for field in file.fields() {
        assert_eq!(field.range.start % 8, 0, "{}", field.name);
        assert_eq!(
            field.range.len() as u64,
            field.count() as u64 * field.dtype.size()
        );
    }
}

/// Every length short of the whole is refused, wherever it cuts, and says where the file ends.
#[test]
fn truncated_at_every_byte() {
    let bytes = example().to_bytes();
    // The last field that has data ends the file.
    for length in 0..bytes.len() {
        let error = TensorFile::parse(&bytes[..length], path())
            .unwrap_err()
            .to_string();
        assert!(error.starts_with("made/here.bsdf: "), "{error}");
        assert!(
            error.contains(&format!("{length} bytes")),
            "{length}: {error}"
        );
    }
}

/// Any single byte changed: read or refused, never a panic; and no field reaches beyond the file.
#[test]
fn any_byte_may_be_wrong() {
    let bytes = example().to_bytes();
    for at in 0..bytes.len() {
        for value in [0, 1, 0x7f, 0x80, 0xff] {
            let mut broken = bytes.clone();
            broken[at] = value;
            if let Ok(file) = TensorFile::parse(&broken, path()) {
                for field in file.fields() {
                    let _ = (file.f64s(field), file.text(field));
                    assert!(field.range.end <= broken.len());
                }
            }
        }
    }
}

/// The bytes of a file with one field, of which some parts are given.
fn one_field(name: &[u8], dimensions: &[u64], dtype: u8, offset: u64) -> Vec<u8> {
    let mut out = b"tensor_file\0\x01\0\x01\0\0\0".to_vec();
    out.extend((name.len() as u16).to_le_bytes());
    out.extend(name);
    out.extend((dimensions.len() as u16).to_le_bytes());
    out.push(dtype);
    out.extend(offset.to_le_bytes());
    for n in dimensions {
        out.extend(n.to_le_bytes());
    }
    out.resize(128, 0);
    out
}

#[test]
fn broken_headers_say_where_and_what() {
    let whole = example().to_bytes();
    let changed = |at: usize, with: &[u8]| {
        let mut bytes = whole.clone();
        bytes[at..at + with.len()].copy_from_slice(with);
        bytes
    };
    let twice = {
        let mut bytes = b"tensor_file\0\x01\0\x02\0\0\0".to_vec();
        let field = &one_field(b"a", &[], 1, 60)[18..32];
        bytes.extend(field);
        bytes.extend(field);
        bytes.resize(128, 0);
        bytes
    };
    for (bytes, words) in [
        (
            changed(0, b"MERL"),
            ["magic, byte 0", "`MERLor_file\\x00`", "`tensor_file`"],
        ),
        (
            changed(12, &[2]),
            ["version, byte 12", "found 2.0", "expected 1.0"],
        ),
        (
            changed(14, &[0xff; 4]),
            ["number of fields, byte 14", "4294967295", "at most 1024"],
        ),
        (
            changed(14, &[6]),
            ["field 5 of the header", "name of", "1 to 256"],
        ),
        (
            one_field(b"", &[], 1, 64),
            ["byte 18", "a name of 0 bytes", "1 to 256"],
        ),
        (
            one_field(b"\xff\xfe", &[], 1, 64),
            ["byte 20", "`\\xff\\xfe`", "UTF-8"],
        ),
        (
            one_field(b"a", &[1; 17], 1, 64),
            ["byte 21", "17 dimensions", "at most 16"],
        ),
        (
            one_field(b"a", &[], 0, 64),
            ["field `a`, byte 23", "type 0", "1 (uint8) to 11"],
        ),
        (
            one_field(b"a", &[], 12, 64),
            ["field `a`, byte 23", "type 12", "float64"],
        ),
        (
            one_field(b"a", &[17], 10, 64),
            ["field `a`", "68 bytes from byte 64", "128 bytes"],
        ),
        (
            one_field(b"a", &[1], 10, u64::MAX),
            ["field `a`", "4 bytes from", "128 bytes"],
        ),
        (
            one_field(b"a", &[u64::MAX, 3], 10, 64),
            ["×3", "more than 2⁶⁴", "128 bytes"],
        ),
        (
            one_field(b"a", &[1 << 32, 1 << 32], 10, 64),
            ["4294967296×", "2⁶⁴", "128 bytes"],
        ),
        (
            one_field(b"a", &[1 << 62], 11, 64),
            ["4611686018427387904", "2⁶⁴", "128 bytes"],
        ),
        (
            one_field(b"a", &[2], 10, 8),
            ["offset of field `a`", "byte 8", "within the header"],
        ),
        (
            twice,
            [
                "field 1 of the header",
                "a second field `a`",
                "names that differ",
            ],
        ),
    ] {
        let error = TensorFile::parse(&bytes, path()).unwrap_err().to_string();
        for word in words {
            assert!(error.contains(word), "{error} lacks {word}");
        }
    }
    // Data at an odd place are no error.
    let mut odd = one_field(b"a", &[2], 10, 65);
    odd[65..69].copy_from_slice(&1.5f32.to_le_bytes());
    let file = TensorFile::parse(&odd, path()).unwrap();
    assert_eq!(file.f32s(&file.fields()[0]).unwrap(), [1.5, 0.0]);
}

#[test]
fn files_are_written_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("made.bsdf");
    std::fs::write(&path, "older").unwrap();
    example().write(&path).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), example().to_bytes());
    let missing = folder.path().join("no/folder.bsdf");
    assert!(matches!(
        example().write(&missing),
        Err(BrdfError::Io { .. })
    ));
    assert!(example().write(folder.path()).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn what_is_no_file_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let what = "a tensor_file";
    let error = |path: &Path| file::map(path, MAGIC, what).unwrap_err().to_string();
    assert!(error(folder.path()).contains("not a regular file"));
    assert!(error(&folder.path().join("absent")).contains("absent"));
    let path = folder.path().join("empty");
    std::fs::write(&path, []).unwrap();
    assert!(error(&path).contains("an empty file"));
    std::fs::write(&path, b"tensor").unwrap();
    assert!(error(&path).contains("`tensor`"));
    // 4 GiB of nothing.
    let sparse = std::fs::File::create(&path).unwrap();
    sparse.set_len(1 << 32).unwrap();
    assert!(error(&path).contains("\\x00"));
    #[cfg(unix)]
    {
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        if made.is_ok_and(|status| status.success()) {
            assert!(error(&pipe).contains("not a regular file"));
        } else {
            eprintln!("skipped: mkfifo makes no pipe here");
        }
    }
}
