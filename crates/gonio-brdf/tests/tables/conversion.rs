//! Any source to any format, with a report of what it cost.

use super::support::*;
use gonio_brdf::BrdfError;
use gonio_brdf::measured::{ConversionReport, LoadOptions, Source, Target, convert, format, load};
use std::path::Path;

fn target(parameterization: Option<&str>, resolution: Option<&[usize]>) -> Target {
    Target {
        parameterization: parameterization.map(str::to_owned),
        resolution: resolution.map(<[usize]>::to_vec),
        ..Target::default()
    }
}

fn converted(source: &str, path: &Path, target: &Target) -> ConversionReport {
    let source = Source::open(source).unwrap();
    convert(&source, path, target, &mut |_| true).unwrap()
}

/// The error that is reported is what such a table has: the bound of each follows from its step (in lobes' widths, squared, over eight), or
/// for patches and squares from their size.
#[test]
fn models_become_files_of_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let model = "ggx:roughness=0.8,metal=gold";
    for (file, parameterization, resolution, bound) in [
        ("a.binary", None, Some(&[45, 30, 24][..]), 0.02),
        ("a.bin", None, None, 0.25),
        ("a.astm", None, Some(&[16, 16, 24]), 0.1),
        ("a.brdf", None, Some(&[13, 13, 13]), 0.15),
        ("a.xml", Some("klems-half"), None, 0.25),
        ("b.xml", Some("tensor-tree-3"), Some(&[5]), 0.12),
        ("a.gonio", None, Some(&[45, 30, 24]), 0.02),
        (
            "b.gonio",
            Some("spherical-anisotropic"),
            Some(&[9, 12, 9, 12]),
            0.25,
        ),
    ] {
        let path = folder.path().join(file);
        let report = converted(model, &path, &target(parameterization, resolution));
        let d = report.difference;
        assert!(d.weighted_relative_rms < bound, "{file}: {d:?}");
        assert!(!report.copied && report.bytes > 0 && d.worst.is_some());
        assert!(report.lost.is_empty(), "{file}: {:?}", report.lost);
        for a in &report.albedo[..3] {
            for k in 0..3 {
                let change = (a.after[k] - a.before[k]).abs() / a.before[k];
                assert!(change < 0.15, "{file}: {a:?}");
            }
        }
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 8);
}

#[test]
fn numbers_are_copied_where_a_format_can_hold_them() {
    let folder = tempfile::tempdir().unwrap();
    let merl = folder.path().join("a.binary");
    format::merl::write(
        &merl,
        &table(&half([20, 10, 8]), "ggx:roughness=0.5,metal=gold"),
    )
    .unwrap();
    let own = folder.path().join("a.gonio");
    let report = converted(merl.to_str().unwrap(), &own, &Target::default());
    assert!(report.copied && report.difference.rms == 0.0, "{report:?}");
    let back = folder.path().join("b.binary");
    let report = converted(own.to_str().unwrap(), &back, &Target::default());
    assert!(
        report.copied && report.difference.relative_rms < 1e-6,
        "{report:?}"
    );
    let provenance = &load(&own, LoadOptions::default())
        .unwrap()
        .measurement()
        .metadata
        .provenance
        .clone();
    assert!(
        provenance[0].contains("MERL") && provenance[1].contains("copied by gonio"),
        "{provenance:?}"
    );
}

#[test]
fn what_is_lost_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let small = target(None, Some(&[12, 8, 6]));
    // Anisotropy.
    let report = converted("ggx:alpha_x=0.2,alpha_y=0.6", &path("a.binary"), &small);
    assert!(
        report.lost.iter().any(|l| l.starts_with("anisotropy")),
        "{:?}",
        report.lost
    );
    // A function that isn't reciprocal.
    let report = converted("toon", &path("b.binary"), &small);
    assert!(
        report.lost.iter().any(|l| l.starts_with("the order")),
        "{:?}",
        report.lost
    );
    // Channels, sides, metadata.
    let own = path("c.gonio");
    let mut m = super::support::table(&klems("LBNL/Klems Quarter"), "lambertian:0.2/0.4/0.6");
    let mut back = m.components[0].clone();
    back.side = gonio_brdf::measured::Side::ReflectionBack;
    m.components.push(back);
    m.metadata.author = "somebody".into();
    format::container::write(&own, &m).unwrap();
    let report = converted(
        own.to_str().unwrap(),
        &path("c.brdf"),
        &target(None, Some(&[5, 5, 5])),
    );
    let lost = report.lost.join("\n");
    for word in [
        "reflection-back",
        "3 channels as they were: red, green, blue",
        "metadata: ",
        "author",
    ] {
        assert!(lost.contains(word), "{lost} lacks {word}");
    }
}

#[test]
fn conversions_that_make_no_sense_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.binary");
    let source = Source::open("lambertian").unwrap();
    let refused = |path: &Path, target: &Target| {
        convert(&source, path, target, &mut |_| true)
            .unwrap_err()
            .to_string()
    };
    assert!(refused(&folder.path().join("a.png"), &Target::default()).contains("merl (.binary)"));
    let named = Target {
        format: Some("merk".into()),
        ..Target::default()
    };
    assert!(refused(&path, &named).contains("no format `merk`"));
    assert!(refused(&path, &target(Some("klems-full"), None)).contains("can't hold"));
    assert!(refused(&path, &target(Some("cubic"), None)).contains("no layout `cubic`"));
    assert!(refused(&path, &target(None, Some(&[1, 2]))).contains("3 numbers"));
    assert!(refused(&path, &target(None, Some(&[4096, 4096, 4096]))).contains("3 numbers"));
    assert!(refused(&folder.path().join("a.bin"), &target(None, Some(&[8]))).contains("only one"));
    let deep = target(Some("tensor-tree-4"), Some(&[12]));
    assert!(refused(&folder.path().join("a.xml"), &deep).contains("rank 4 to 2^-7"));
    assert!(matches!(
        Source::open("mirror"),
        Err(BrdfError::Unsupported { .. })
    ));
    assert!(matches!(
        Source::open("no/such.binary"),
        Err(BrdfError::Io { .. })
    ));
    assert!(matches!(
        Source::open("lambertain"),
        Err(BrdfError::UnknownModel { .. })
    ));
    let stopped = convert(&source, &path, &Target::default(), &mut |_| false);
    assert!(matches!(stopped, Err(BrdfError::Interrupted)));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
