//! Files that are broken, and files that are none: one clear error each, no panic, no hang.

use super::support::*;
use gonio_brdf::BrdfError;
use gonio_brdf::measured::{Channel, Layout, LoadOptions, Side, format, load, parse, tabulate};
use std::path::Path;
use std::time::{Duration, Instant};

/// A small sound file of each format and kind.
fn sound() -> Vec<(&'static str, Vec<u8>)> {
    let folder = tempfile::tempdir().unwrap();
    let front = [Side::ReflectionFront];
    let nm: Vec<Channel> = [450.0, 600.0].map(Channel::Wavelength).to_vec();
    let mut all = Vec::new();
    let mut add = |name: &'static str, layout: Layout, channels: &[Channel], sides: &[Side]| {
        let mut f = |_, _, out: &mut [f64]| out.fill(0.25);
        let m = tabulate(&layout, channels, sides, &mut f, &mut |_| true).unwrap();
        let path = folder.path().join("a");
        (format::find(name).unwrap().write)(&path, &m).unwrap();
        all.push((name, std::fs::read(path).unwrap()));
    };
    add("merl", half([2, 2, 2]), &rgb(), &front);
    add("astm", spherical(2, 3), &nm, &front);
    add("pbrt", mirrored(2, 3), &nm, &front);
    add(
        "radiance",
        klems("LBNL/Klems Quarter"),
        &[Channel::Luminance],
        &front,
    );
    add("radiance", tree(3, 2), &[Channel::Luminance], &front);
    add("gonio", spherical(2, 3), &nm, &front);
    add(
        "gonio",
        klems("LBNL/Klems Quarter"),
        &[Channel::Luminance],
        &front,
    );
    add("gonio", tree(4, 1), &[Channel::Luminance], &front);
    all
}

fn fails(bytes: &[u8]) -> Option<String> {
    match parse(Path::new("broken.file"), bytes) {
        Ok(_) => None,
        Err(e @ BrdfError::Format { .. }) => Some(e.to_string()),
        Err(e) => panic!("not an error of the format: {e}"),
    }
}

#[test]
fn files_cut_short_are_refused() {
    for (name, bytes) in sound() {
        assert!(fails(&bytes).is_none(), "{name}");
        let step = bytes.len() / 700 + 1;
        for length in (0..bytes.len()).step_by(step) {
            let Some(error) = fails(&bytes[..length]) else {
                // Text may end in the middle of its last number; rows of pbrt-v2 are not counted.
                assert!(
                    name == "pbrt" || length + 24 > bytes.len(),
                    "{name} cut at {length}"
                );
                continue;
            };
            assert!(error.starts_with("broken.file: "), "{error}");
        }
    }
}

/// Each byte changed in turn: whatever comes of it, it is no panic.
#[test]
fn changed_bytes_are_harmless() {
    for (name, bytes) in sound() {
        let step = bytes.len() / 400 + 1;
        for at in (0..bytes.len()).step_by(step) {
            for new in [0x00, 0xff, b'9', b'<', bytes[at] ^ 0x80] {
                let mut changed = bytes.clone();
                changed[at] = new;
                if let Some(error) = fails(&changed) {
                    assert!(error.contains("expected"), "{name} {at}: {error}");
                }
            }
        }
    }
}

#[test]
fn broken_merl_files_say_what_is_wrong() {
    let bytes = |dims: [i32; 3], value: f64, count: usize| {
        let mut out: Vec<u8> = dims.iter().flat_map(|d| d.to_le_bytes()).collect();
        (0..count).for_each(|_| out.extend(value.to_le_bytes()));
        out
    };
    let mut not_finite = bytes([2, 2, 2], 1.0, 24);
    not_finite[12 + 8 * 9..12 + 8 * 10].copy_from_slice(&f64::NAN.to_le_bytes());
    let mut reversed: Vec<u8> = [90i32, 90, 180]
        .iter()
        .flat_map(|d| d.to_be_bytes())
        .collect();
    reversed.extend([0; 100]);
    for (content, words) in [
        (
            bytes([90, 90, 180], 0.0, 10),
            vec!["whole file", "92 bytes", "34992012 bytes", "90×90×180"],
        ),
        (
            bytes([2, 2, 2], 0.0, 25),
            vec!["whole file", "212 bytes", "204 bytes"],
        ),
        (
            bytes([4096, 4096, 4096], 0.0, 1),
            vec!["whole file", "20 bytes"],
        ),
        (
            bytes([2, 2, 2], f64::INFINITY, 24),
            vec!["red plane", "cell 0", "inf", "finite"],
        ),
        (bytes([2, 2, 2], 1e300, 24), vec!["red plane", "finite"]),
        (not_finite, vec!["green plane", "cell 1", "byte 84", "NaN"]),
        (reversed, vec!["byte 0", "90 if it were big-endian"]),
    ] {
        let error = fails(&content).unwrap();
        for word in words {
            assert!(error.contains(word), "{error} lacks {word}");
        }
    }
}

#[test]
fn broken_utia_files_say_what_is_wrong() {
    let n = 6 * 48 * 6 * 48 * 3;
    let reversed: Vec<u8> = (0..n)
        .flat_map(|k| (0.1 + f64::from(k)).to_be_bytes())
        .collect();
    let mut nan: Vec<u8> = (0..n).flat_map(|_| 0.5f64.to_le_bytes()).collect();
    nan[8 * 5..8 * 6].copy_from_slice(&f64::NAN.to_le_bytes());
    for (content, words) in [
        (reversed, ["number 2", "big-endian"]),
        (nan, ["number 5, byte 40", "NaN"]),
    ] {
        let error = fails(&content).unwrap();
        assert!(words.iter().all(|w| error.contains(w)), "{error}");
    }
}

#[test]
fn broken_text_says_the_line() {
    let columns = "VARS theta_i,phi_i,theta_s,phi_s,R\n";
    for (text, words) in [
        (
            format!("{columns}0,0,0,0\n"),
            vec!["line 2", "4 numbers", "5, as line 1 says"],
        ),
        (
            format!("{columns}0,0,0,0,nan\n"),
            vec!["line 2", "nan", "finite"],
        ),
        (format!("{columns}0,0,x,0,1\n"), vec!["line 2", "`x`"]),
        (
            format!("{columns}0,0,100,0,1\n"),
            vec!["line 2", "elevation of 100"],
        ),
        (columns.into(), vec!["no row"]),
        (
            format!("NUM_POINTS 7\n{columns}0,0,0,0,1\n"),
            vec!["line 1", "7 before 1 rows"],
        ),
        (
            format!("NUM_POINTS many\n{columns}"),
            vec!["line 1", "`many`"],
        ),
        (
            "VARS theta_i,phi_i,R\n0,0,1\n".into(),
            vec!["line 1", "theta_s"],
        ),
        (
            "VARS theta_i,theta_s\n".into(),
            vec!["line 1", "at least one of values"],
        ),
        ("2 400\n".into(), vec!["end of the file", "1 wavelengths"]),
        ("0\n".into(), vec!["line 1", "1 to 4096"]),
        ("1.5\n".into(), vec!["line 1", "1.5"]),
        ("99999999\n".into(), vec!["line 1", "1 to 4096"]),
        ("2 500 400\n".into(), vec!["line 1", "400 nm", "increase"]),
        (
            "1 500\n0 0 0 0\n".into(),
            vec!["a row of 4 numbers", "5 a row"],
        ),
        (
            "1 500\n0 0 0 0 1 9 0 0 0 1\n".into(),
            vec!["line 2", "elevation of 9"],
        ),
        ("1 500\n".into(), vec!["no row"]),
        ("<WindowElement>".into(), vec!["line 1", "XML"]),
        ("<a><WindowElement/></a>".into(), vec!["line 1", "root `a`"]),
        (
            "<WindowElement/>".into(),
            vec!["line 1", "without `Optical`"],
        ),
        (
            "<!DOCTYPE x [<!ENTITY a 'aaaa'>]><WindowElement>&a;</WindowElement>".into(),
            vec!["XML"],
        ),
    ] {
        let error = fails(text.as_bytes()).unwrap_or_else(|| panic!("{text}"));
        assert!(words.iter().all(|w| error.contains(w)), "{text}: {error}");
    }
}

#[test]
fn broken_containers_name_the_field() {
    use gonio_brdf::measured::tensor_file::TensorWriter;
    let base = |change: &dyn Fn(&mut TensorWriter)| {
        let mut file = TensorWriter::new();
        file.bytes("gonio.version", &[1], &[1]);
        change(&mut file);
        fails(&file.to_bytes()).unwrap()
    };
    let text =
        |file: &mut TensorWriter, name: &str, t: &str| file.bytes(name, &[t.len()], t.as_bytes());
    let error = base(&|_| {});
    assert!(
        error.contains("field `channels`") && error.contains("none"),
        "{error}"
    );
    let error = base(&|f| text(f, "channels", "red\ngreen"));
    assert!(error.contains("S.layout"), "{error}");
    let error = base(&|f| {
        text(f, "channels", "y");
        text(f, "reflection-front.layout", "sphere");
    });
    assert!(
        error.contains("`sphere`") && error.contains("klems"),
        "{error}"
    );
    let klems = |counts: &[f64], shape: &[usize]| {
        base(&|f| {
            text(f, "channels", "y");
            text(f, "reflection-front.layout", "klems");
            for side in ["incoming", "outgoing"] {
                f.f64s(
                    &format!("reflection-front.{side}.edges_deg"),
                    &[3],
                    &[0.0, 45.0, 90.0],
                );
                f.f64s(
                    &format!("reflection-front.{side}.counts"),
                    &[counts.len()],
                    counts,
                );
            }
            let n = shape.iter().product();
            f.f32s("reflection-front.values", shape, &vec![0.5; n]);
        })
    };
    assert!(klems(&[1.0, 8.0], &[9, 8, 1]).contains("[9, 9, 1]"));
    assert!(klems(&[1.0, 1e9], &[1, 1, 1]).contains("counts"));
    assert!(klems(&[1.0], &[1, 1, 1]).contains("edges_deg"));
    let tree = |codes: &[f64]| {
        base(&|f| {
            text(f, "channels", "y");
            text(f, "reflection-front.layout", "tensor-tree");
            f.f64s("reflection-front.children", &[codes.len() / 8, 8], codes);
            f.f32s("reflection-front.values", &[1, 1], &[0.5]);
        })
    };
    // A leaf that isn't there, a circle, a branch in two places, no whole number.
    let leaves = [-1.0; 8];
    let with = |at: usize, code: f64| {
        let mut codes = leaves.to_vec();
        codes.extend(leaves);
        codes[at] = code;
        codes
    };
    for codes in [
        with(0, -2.0),
        with(0, 0.0),
        with(0, 0.5),
        with(8, 0.0),
        with(0, f64::NAN),
        with(0, 7.0),
    ] {
        let error = tree(&codes);
        assert!(error.contains("children"), "{error}");
    }
}

/// What is no file of any format names every format that was tried.
#[test]
fn unknown_content_lists_what_was_looked_for() {
    for content in [
        &b""[..],
        b"PNG!",
        b"\x00\x01\x02\x03",
        b"hello, world",
        &[0; 4096],
    ] {
        let error = fails(content).unwrap();
        for f in format::FORMATS {
            assert!(error.contains(f.name), "{error}");
        }
    }
    assert!(fails(b"").unwrap().contains("an empty file"));
}

#[test]
fn what_is_no_file_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let load = |path: &Path| {
        let start = Instant::now();
        let error = load(path, LoadOptions::default()).unwrap_err();
        assert!(
            start.elapsed() < Duration::from_secs(5),
            "{}",
            path.display()
        );
        error.to_string()
    };
    assert!(load(folder.path()).contains("a folder"));
    assert!(load(&folder.path().join("nothing")).contains("nothing"));
    assert!(load(Path::new("")).len() > 2);
    // Four gigabytes of nothing, alone and behind beginnings of each kind.
    for head in [
        &b""[..],
        b"1 500\n",
        b"VARS theta_i\n",
        b"<WindowElement>",
        b"tensor_file\0\x01\0",
        &[90, 0, 0, 0, 90, 0, 0, 0, 180, 0, 0, 0],
    ] {
        let path = folder.path().join("sparse");
        let file = std::fs::File::create(&path).unwrap();
        std::io::Write::write_all(&mut &file, head).unwrap();
        file.set_len(4 << 30).unwrap();
        load(&path);
        std::fs::remove_file(&path).unwrap();
    }
    #[cfg(unix)]
    {
        let circle = folder.path().join("circle");
        std::os::unix::fs::symlink(&circle, &circle).unwrap();
        assert!(load(&circle).contains("circle"));
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        if made.is_ok_and(|s| s.success()) {
            assert!(load(&pipe).contains("a pipe or a device"));
        } else {
            eprintln!("skipped: no mkfifo here");
        }
        for device in ["/dev/null", "/dev/zero"] {
            if Path::new(device).exists() {
                assert!(load(Path::new(device)).contains("a pipe or a device"));
            }
        }
    }
}

#[test]
fn writers_leave_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let m = table(&half([2, 2, 2]), "lambertian");
    assert!(format::merl::write(&folder.path().join("no/folder.binary"), &m).is_err());
    assert!(format::merl::write(folder.path(), &m).is_err());
    assert!(format::container::write(&folder.path().join("no/a.gonio"), &m).is_err());
    // What a format can't hold it says, before anything is written.
    for name in ["utia", "astm", "pbrt", "radiance"] {
        let path = folder.path().join("a");
        let error = (format::find(name).unwrap().write)(&path, &m).unwrap_err();
        assert!(matches!(error, BrdfError::Unsupported { .. }), "{error}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// What the fuzz targets begin with, and whatever they once found: sound files are read, others refused.
#[test]
fn the_kept_corpus_is_harmless() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
    let mut count = 0;
    for target in std::fs::read_dir(corpus).unwrap() {
        for file in std::fs::read_dir(target.unwrap().path()).unwrap() {
            let path = file.unwrap().path();
            let found = fails(&std::fs::read(&path).unwrap());
            let name = path.file_name().unwrap().to_str().unwrap();
            if format::FORMATS.iter().any(|f| name.starts_with(f.name)) {
                assert_eq!(found, None, "{name}");
            }
            count += 1;
        }
    }
    assert!(count >= 20, "{count}");
}
