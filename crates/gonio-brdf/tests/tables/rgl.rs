//! Files of the RGL database: made here, whole and broken; and, where there are some, the database's own.

use super::adaptive::{KINDS, adaptive, check_integrals, spectrum, varied};
use super::support::*;
use gonio_brdf::BrdfError;
use gonio_brdf::measured::tensor_file::TensorWriter;
use gonio_brdf::measured::{
    LoadOptions, Measurement, Source, Target, convert, format, load, parse, read,
};
use gonio_verify::Effort;
use std::f64::consts::PI;
use std::path::Path;

fn rgl(measurement: &Measurement) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.bsdf");
    (format::find("rgl").unwrap().write)(&path, measurement).unwrap();
    std::fs::read(path).unwrap()
}

#[test]
fn files_are_read_as_written_and_in_place() {
    let folder = tempfile::tempdir().unwrap();
    for kind in KINDS {
        for channels in [rgb(), spectrum()] {
            for name in ["rgl", "gonio"] {
                let made = adaptive(kind, &channels, kind != "half", varied);
                let path = folder.path().join("a");
                (format::find(name).unwrap().write)(&path, &made).unwrap();
                let (format, read) = read(&path).unwrap();
                assert_eq!(format.name, name);
                assert_eq!(read.components, made.components);
                assert_eq!(read.channels, made.channels);
                assert_eq!(read.metadata.description, "made here");
                assert!(read.components[0].data.values().is_mapped());
                assert!(read.unused.is_empty());
            }
        }
    }
}

/// As a source of other formats, copied to those that hold it, and refused where a table would have to be made.
#[test]
fn conversion() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let made = adaptive("isotropic", &rgb(), true, varied);
    (format::find("rgl").unwrap().write)(&path("a.bsdf"), &made).unwrap();
    let source = Source::open(path("a.bsdf").to_str().unwrap()).unwrap();
    let target = Target::default();
    for (name, copied) in [("b.gonio", true), ("b.bsdf", true), ("b.binary", false)] {
        let mut target = target.clone();
        if name == "b.binary" {
            target.resolution = Some(vec![24, 12, 8]);
        }
        let report = convert(&source, &path(name), &target, &mut |_| true).unwrap();
        assert_eq!(report.copied, copied, "{name}");
        assert_eq!(report.difference.rms == 0.0, copied, "{name}");
    }
    let model = Source::open("ggx:roughness=0.5").unwrap();
    let error = convert(&model, &path("c.bsdf"), &target, &mut |_| true).unwrap_err();
    assert!(matches!(error, BrdfError::Unsupported { .. }));
    assert!(error.to_string().contains("adaptive"), "{error}");
    assert!(!path("c.bsdf").exists());
}

/// Dimensions and numbers; no dimensions: a field that is left out.
type Array = (Vec<usize>, Vec<f32>);

/// A sound file, but for the fields that `change` takes or adds.
fn broken(change: &dyn Fn(&str) -> Option<Array>) -> String {
    let mut file = TensorWriter::new();
    for (name, shape) in [
        ("theta_i", &[2][..]),
        ("phi_i", &[1]),
        ("ndf", &[1, 3]),
        ("sigma", &[2, 3]),
        ("vndf", &[1, 2, 2, 3]),
        ("luminance", &[1, 2, 2, 2]),
        ("rgb", &[1, 2, 3, 2, 2]),
    ] {
        let count: usize = shape.iter().product();
        let mut values: Vec<f32> = vec![1.0; count];
        if name == "theta_i" {
            values = vec![0.0, 1.5];
        }
        match change(name) {
            Some((shape, _)) if shape.is_empty() => {}
            Some((shape, values)) => file.f32s(name, &shape, &values),
            None => file.f32s(name, shape, &values),
        }
    }
    if change("jacobian").is_none() {
        file.bytes("jacobian", &[1], &[1]);
    }
    match parse(Path::new("broken.file"), &file.to_bytes()) {
        Ok(_) => String::new(),
        Err(e @ BrdfError::Format { .. }) => e.to_string(),
        Err(e) => panic!("not an error of the format: {e}"),
    }
}

#[test]
fn broken_files_name_the_field() {
    assert_eq!(broken(&|_| None), "");
    for missing in ["phi_i", "ndf", "sigma", "luminance", "rgb", "jacobian"] {
        let error = broken(&|name| (name == missing).then(Default::default));
        assert!(
            error.contains(&format!("`{missing}` among them")),
            "{error}"
        );
    }
    let nan = f32::NAN;
    for (field, shape, values, words) in [
        (
            "theta_i",
            vec![2],
            vec![1.0, 0.5],
            ["`theta_i`", "0.5 after 1"],
        ),
        ("theta_i", vec![2], vec![0.0, 2.0], ["`theta_i`", "π/2"]),
        (
            "theta_i",
            vec![2],
            vec![0.0, nan],
            ["`theta_i`, value 1", "NaN"],
        ),
        (
            "theta_i",
            vec![2, 1],
            vec![0.0, 1.0],
            ["`theta_i`", "dimensions 2×1"],
        ),
        ("theta_i", vec![0], vec![], ["`theta_i`", "0 angles"]),
        (
            "phi_i",
            vec![3],
            vec![0.0, 0.1, 0.2],
            ["`phi_i`", "from −π"],
        ),
        (
            "phi_i",
            vec![3],
            vec![-PI as f32, 0.0, PI as f32],
            ["`vndf`", "3×2×n×n"],
        ),
        ("ndf", vec![1, 1], vec![1.0], ["`ndf`", "1×1 nodes"]),
        (
            "ndf",
            vec![1, 3],
            vec![1.0, nan, 1.0],
            ["`ndf`, value 1", "NaN"],
        ),
        (
            "ndf",
            vec![1, 9000],
            vec![1.0; 9000],
            ["`ndf`", "1×9000 nodes"],
        ),
        (
            "sigma",
            vec![2, 2],
            vec![1.0, 1.0, 1.0, 2.0],
            ["`sigma`", "same θ"],
        ),
        (
            "vndf",
            vec![1, 2, 2, 2],
            vec![0.0; 8],
            ["`vndf`, slice 0", "no positive"],
        ),
        (
            "vndf",
            vec![1, 2, 1, 4],
            vec![1.0; 8],
            ["`vndf`", "1×4 nodes"],
        ),
        (
            "vndf",
            vec![1, 3, 2, 2],
            vec![1.0; 12],
            ["`vndf`", "1×2×n×n"],
        ),
        (
            "rgb",
            vec![1, 2, 4, 2, 2],
            vec![1.0; 32],
            ["`rgb`", "1×2×3×n×n"],
        ),
        (
            "rgb",
            vec![1, 2, 3, 2, 3],
            vec![1.0; 36],
            ["`rgb`", "2×2, as `luminance`"],
        ),
        (
            "rgb",
            vec![1, 2, 3, 2, 2],
            vec![nan; 24],
            ["`rgb`, value 0", "NaN"],
        ),
    ] {
        let error = broken(&|name| (name == field).then(|| (shape.clone(), values.clone())));
        for word in words {
            assert!(error.contains(word), "{field}: {error} lacks {word}");
        }
    }
}

/// Cut anywhere, the header above all: the data of the last field end the file.
#[test]
fn files_cut_short_are_refused() {
    let bytes = rgl(&adaptive("one elevation", &rgb(), true, varied));
    let header = 700;
    let cuts = (0..header).chain((header..bytes.len()).step_by(97));
    for length in cuts {
        let error = parse(Path::new("broken.file"), &bytes[..length]).unwrap_err();
        assert!(
            matches!(error, BrdfError::Format { .. }),
            "{length}: {error}"
        );
    }
    let mut wrong = bytes.clone();
    wrong[3] = b'X';
    let error = parse(Path::new("broken.file"), &wrong).unwrap_err();
    assert!(error.to_string().contains("one of gonio"), "{error}");
}

/// A header that claims four gigabytes which the file has, all of them zeros: nothing is allocated for them.
#[test]
fn large_claims_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.bsdf");
    let made = adaptive("one elevation", &rgb(), true, varied);
    let mut bytes = rgl(&made);
    // The dimensions of `vndf`, which stand 8 before the end of its entry: 1, 1, 17, 24.
    let name = bytes.windows(4).position(|w| w == b"vndf").unwrap();
    let height = name + 4 + 2 + 1 + 8 + 16;
    bytes[height..height + 8].copy_from_slice(&8000u64.to_le_bytes());
    bytes[height + 8..height + 16].copy_from_slice(&100_000u64.to_le_bytes());
    std::fs::write(&path, &bytes).unwrap();
    let file = std::fs::File::options().write(true).open(&path).unwrap();
    file.set_len(4 << 30).unwrap();
    let start = std::time::Instant::now();
    let error = load(&path, LoadOptions::default()).unwrap_err().to_string();
    assert!(
        error.contains("`vndf`") && error.contains("8000×100000"),
        "{error}"
    );
    assert!(start.elapsed() < std::time::Duration::from_secs(5));
}

/// The database's own files, where there are some.
#[test]
fn files_of_the_database() {
    let given = std::env::var_os("GONIO_RGL").map(std::path::PathBuf::from);
    let above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let folder = given
        .into_iter()
        .chain(above.map(|folder| folder.join("shared/data/rgl")))
        .find(|folder| folder.is_dir());
    let Some(folder) = folder else {
        eprintln!("skipped: no files of the RGL database; GONIO_RGL names a folder that has them");
        return;
    };
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "bsdf") {
            continue;
        }
        count += 1;
        let name = path.file_name().unwrap().to_str().unwrap();
        let data = load(&path, LoadOptions::default()).unwrap();
        let angles: Vec<f64> = (0..=17).map(|k| 5.0 * f64::from(k)).chain([88.0]).collect();
        check_integrals(name, &data, [128, 128], &angles);
        let report = verified(name, data, Effort::Quick);
        assert!(report.passed(), "{report}");
    }
    assert!(count > 0, "no file");
}
