//! Pictures divided by samples, and interrupted: the same bits, or an error that says why not.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use gonio_num::{Affine3, Vec3};
use gonio_render::part::{self, Label, Opened};
use gonio_render::{
    Exposure, Identity, Kept, Names, Parts, RenderError, RenderOptions, Stop, Target, expose,
};
use gonio_scene::{Camera, Light, Scene, SceneBuilder, Shape};
use std::ops::{ControlFlow, Range};
use std::path::{Path, PathBuf};
use support::*;
use tempfile::TempDir;

/// A ball with a highlight of a lamp: radiances of many magnitudes.
fn scene() -> Scene {
    let mut scene = SceneBuilder::new("parts");
    let gold = material("ggx:metal=gold,roughness=0.2");
    add(&mut scene, Shape::Sphere, Affine3::identity(), gold);
    let grey = material("lambertian:reflectance=0.5");
    add(&mut scene, Shape::Rectangle, floor(-1.0, 10.0), grey);
    let lamp = emitter("lambertian:reflectance=0", [500.0, 300.0, 1.0]);
    let above = ceiling(3.0, 0.2).then(&Affine3::translation(Vec3::new(1.5, 0.0, 0.0)));
    add(&mut scene, Shape::Rectangle, above, lamp);
    let fill = Light::Point {
        position: Vec3::new(-2.0, 4.0, 1.0),
        intensity: [0.01; 3],
    };
    scene.light_in(fill, "fill");
    scene.build().unwrap()
}

fn camera() -> Camera {
    camera_above(6.0, 30.0)
}

/// 12 × 12 pixels of 37 samples: no power of two.
const SPP: u32 = 37;

/// All layers there are: what holds for the picture holds for them.
fn settings() -> RenderOptions {
    RenderOptions {
        keep: Kept {
            position: true,
            material: true,
            direct: true,
            indirect: true,
            groups: 2,
            reweighted: true,
        },
        ..options(INTEGRATORS[1], SAMPLERS[1], 12, SPP)
    }
}

/// Of the default size, and of all layers.
fn exposure(first: u32) -> Exposure {
    Exposure::keeping(settings().keep, 12, 12, first).unwrap()
}

fn label(of: Option<u32>) -> Label {
    Label {
        identity: Identity::new("00ff", &camera(), &settings()),
        scene: "parts".into(),
        of,
        names: Names::of(&scene()),
    }
}

fn until(end: u32) -> RenderOptions {
    let target = Target {
        samples: end,
        time: None,
        noise: None,
        adaptive: false,
    };
    RenderOptions {
        target,
        ..settings()
    }
}

/// The samples of a range, on some threads.
fn taken(scene: &Scene, range: Range<u32>, threads: usize) -> Exposure {
    let mut exposure = exposure(range.start);
    go_on(scene, &mut exposure, range.end, threads);
    exposure
}

fn go_on(scene: &Scene, exposure: &mut Exposure, end: u32, threads: usize) {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    let stop = pool.install(|| {
        let go_on = |_: &_, _: &_| ControlFlow::Continue(());
        expose(scene, &camera(), &until(end), exposure, go_on).unwrap()
    });
    assert_eq!(stop, Stop::Samples);
}

/// The hash of the EXR that a film is written as.
fn hash(exposure: &Exposure) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    exposure
        .film
        .layers(&Names::of(&scene()), Vec::new())
        .write_exr(&path)
        .unwrap();
    blake3::hash(&std::fs::read(path).unwrap()).to_string()
}

fn stored(folder: &TempDir, exposure: &Exposure, of: Option<u32>) -> PathBuf {
    let Range { start, end } = exposure.samples;
    let path = folder.path().join(format!("{start}-{end}.gonio"));
    part::write(&path, &label(of), exposure).unwrap();
    path
}

#[test]
fn any_split_on_any_number_of_threads_has_the_same_hash() {
    let scene = scene();
    let whole = hash(&taken(&scene, 0..SPP, 1));
    let splits: [(&[u32], usize); 3] = [
        (&[0, 20, SPP], 2),
        (&[0, 1, 2, 3, 16, 17, 36, SPP], 7),
        (&[0, SPP], 3),
    ];
    for (cuts, threads) in splits {
        let folder = tempfile::tempdir().unwrap();
        let mut paths: Vec<PathBuf> = cuts
            .windows(2)
            .map(|w| stored(&folder, &taken(&scene, w[0]..w[1], threads), Some(SPP)))
            .collect();
        // In another order than that of the samples.
        paths.reverse();
        let parts = Parts::of(&paths).unwrap();
        parts.require_whole().unwrap();
        let mut told = Vec::new();
        let merged = parts.add(|n| told.push(n)).unwrap();
        assert_eq!(
            (hash(&merged), merged.samples.clone()),
            (whole.clone(), 0..SPP)
        );
        assert_eq!(told.len(), paths.len());
    }
    // The negative control: one sample less.
    assert_ne!(hash(&taken(&scene, 0..SPP - 1, 1)), whole);
}

/// Stopped wherever it can be, put into a file, and gone on with from there.
#[test]
fn any_interruptions_leave_the_same_hash() {
    let scene = scene();
    let uninterrupted = taken(&scene, 0..SPP, 1);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint");
    for ends in [vec![1, 9, 10, 33], vec![36], (1..SPP).collect()] {
        let mut exposure = exposure(0);
        for end in ends {
            go_on(&scene, &mut exposure, end, 2);
            part::write_alone(&path, &label(None), &exposure).unwrap();
            exposure = part::open(&path).unwrap().read().unwrap();
            assert_eq!(exposure.samples, 0..end);
        }
        go_on(&scene, &mut exposure, SPP, 2);
        assert_eq!(exposure.film.pixels(), uninterrupted.film.pixels());
        assert_eq!(hash(&exposure), hash(&uninterrupted));
        assert_eq!(exposure.rays, uninterrupted.rays);
        // It is finished: nothing more is done.
        let never = |_: &_, _: &_| panic!("a pass after the last one");
        let stop = expose(&scene, &camera(), &until(SPP), &mut exposure, never).unwrap();
        assert_eq!(stop, Stop::Samples);
    }
}

/// Where noise ends a picture does not depend on interruptions.
#[test]
fn noise_stops_it_at_the_same_sample() {
    let scene = scene();
    let target = Target {
        samples: 1 << 20,
        time: None,
        noise: Some(0.2),
        adaptive: false,
    };
    let options = RenderOptions {
        target,
        ..settings()
    };
    let run = |every: Option<u32>| {
        let mut exposure = exposure(0);
        loop {
            let begun = exposure.samples.end;
            let pause = |_: &_, e: &Exposure| match every {
                Some(n) if e.samples.end >= begun + n => ControlFlow::Break(()),
                _ => ControlFlow::Continue(()),
            };
            let stop = expose(&scene, &camera(), &options, &mut exposure, pause).unwrap();
            if stop != Stop::Interrupted {
                assert_eq!(stop, Stop::Noise);
                return (exposure.samples.end, exposure);
            }
        }
    };
    let (end, exposure) = run(None);
    assert!(end > 16);
    let (paused, other) = run(Some(5));
    assert_eq!((paused, hash(&other)), (end, hash(&exposure)));
}

#[test]
fn parts_that_do_not_belong_together_are_refused() {
    let scene = scene();
    let folder = tempfile::tempdir().unwrap();
    let part = |range: Range<u32>| stored(&folder, &taken(&scene, range, 2), Some(8));
    let (a, b, c) = (part(0..3), part(3..6), part(6..8));
    let refused = |paths: &[&PathBuf], words: &[&str]| {
        let paths: Vec<PathBuf> = paths.iter().map(|p| (*p).clone()).collect();
        let fault = Parts::of(&paths).and_then(|p| p.require_whole());
        let said = fault.unwrap_err().to_string();
        for word in words {
            assert!(said.contains(word), "no {word:?} in {said:?}");
        }
    };
    refused(&[&a, &c], &["6-8.gonio", "3:6", "0-3.gonio", "missing"]);
    refused(&[&a, &b], &["3-6.gonio", "6:8"]);
    refused(&[&c, &b], &["3-6.gonio", "0:3"]);
    refused(&[&a, &a, &b, &c], &["0:3", "too"]);
    refused(
        &[&a, &part(2..8)],
        &["2-8.gonio", "2:3 are in", "0-3.gonio"],
    );
    let open_ended = stored(&folder, &taken(&scene, 3..8, 2), None);
    refused(&[&a, &open_ended], &["open number", "of 8"]);
    let other = folder.path().join("other.gonio");
    let reseeded = RenderOptions {
        seed: 12,
        ..settings()
    };
    let of = Label {
        identity: Identity::new("00ff", &camera(), &reseeded),
        ..label(Some(8))
    };
    part::write(&other, &of, &taken(&scene, 3..8, 2)).unwrap();
    refused(
        &[&a, &other],
        &[
            "other.gonio",
            "another seed: 12, expected 7 as in",
            "0-3.gonio",
        ],
    );
    let fewer = RenderOptions {
        keep: Kept {
            groups: 0,
            ..settings().keep
        },
        ..settings()
    };
    let without_groups = Label {
        identity: Identity::new("00ff", &camera(), &fewer),
        ..label(Some(8))
    };
    let path = folder.path().join("fewer.gonio");
    part::write(&path, &without_groups, &taken(&scene, 3..8, 2)).unwrap();
    refused(
        &[&a, &path],
        &[
            "fewer.gonio",
            "other layers: position, material, direct, indirect, reweighted, expected position, material, direct, indirect, groups, reweighted as in",
        ],
    );
    let as_they_are = RenderOptions {
        keep: Kept {
            reweighted: false,
            ..settings().keep
        },
        ..settings()
    };
    let without_levels = Label {
        identity: Identity::new("00ff", &camera(), &as_they_are),
        ..label(Some(8))
    };
    let path = folder.path().join("plain.gonio");
    part::write(&path, &without_levels, &taken(&scene, 3..8, 2)).unwrap();
    refused(
        &[&a, &path],
        &["plain.gonio", "other layers", "groups, reweighted as in"],
    );
    refused(&[&folder.path().to_owned()], &["a folder"]);
    refused(
        &[&folder.path().join("none.gonio")],
        &["none.gonio", "open it"],
    );
}

/// The bytes of a small part, and those of its header.
fn small() -> (Vec<u8>, Range<usize>) {
    let folder = tempfile::tempdir().unwrap();
    let bytes = std::fs::read(stored(&folder, &taken(&scene(), 2..5, 1), Some(9))).unwrap();
    let header = 16..16 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    (bytes, header)
}

fn read(bytes: &[u8]) -> Result<Exposure, RenderError> {
    Opened::of(bytes, bytes.len() as u64, Path::new("a.gonio"))?.read()
}

fn error(bytes: &[u8]) -> String {
    let error = read(bytes).unwrap_err();
    assert!(
        matches!(
            error,
            RenderError::Part { .. } | RenderError::Limit { .. } | RenderError::Parameter { .. }
        ),
        "{error:?}"
    );
    error.to_string()
}

#[test]
fn damaged_parts_are_errors() {
    let (bytes, header) = small();
    assert_eq!(read(&bytes).unwrap().samples, 2..5);
    // Cut off anywhere in the header, and at some places after it.
    for end in (0..header.end + 1).chain((header.end..bytes.len()).step_by(101)) {
        let said = error(&bytes[..end]);
        assert!(said.starts_with("a.gonio, "), "{end}: {said}");
    }
    let mut longer = bytes.clone();
    longer.push(0);
    assert!(error(&longer).contains("whole file"));
    // A bit that is wrong anywhere is noticed, by the hash if by nothing else.
    for at in (0..bytes.len()).step_by(7) {
        let mut changed = bytes.clone();
        changed[at] ^= 0x10;
        error(&changed);
    }
    let with = |range: Range<usize>, new: &[u8]| {
        let mut changed = bytes.clone();
        changed.splice(range, new.iter().copied());
        error(&changed)
    };
    assert!(with(0..8, b"\x89PNG\r\n\x1a\n").contains("byte 0"));
    assert!(with(8..12, &[1, 0, 0, 0]).contains("version 1 of the format, expected version 2"));
    assert!(with(12..16, &[255; 4]).contains("a header of 4294967295 bytes"));
    assert!(error(b"").contains("the end of the file, of 0 bytes"));
    assert!(error(&[0; 100]).contains("a part of a picture"));
}

/// Headers that say what can't be: no memory is taken for it.
#[test]
fn headers_that_lie_are_errors() {
    let (bytes, header) = small();
    let text = String::from_utf8(bytes[header.clone()].to_vec()).unwrap();
    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{text}");
        let changed = text.replacen(from, to, 1).into_bytes();
        let size = (changed.len() as u32).to_le_bytes();
        let rest = &bytes[header.end..];
        error(&[&bytes[..12], &size, &changed, rest].concat())
    };
    assert!(with("\"width\":12", "\"width\":4000000000").contains("more than the limit"));
    assert!(with("\"width\":12", "\"width\":13").contains("bytes, expected"));
    assert!(with("\"width\":12", "\"width\":0").contains("at least 1"));
    assert!(with("\"first\":2", "\"first\":5").contains("samples 5 to 5 of 9"));
    assert!(with("\"of\":9", "\"of\":4").contains("samples 2 to 5 of 4"));
    // One sample fewer than the pixels have.
    assert!(with("\"first\":2", "\"first\":3").contains("pixel 0, 0"));
    assert!(with("\"columns\":[1", "\"columns\":[9").contains("columns"));
    // Layers that the columns don't have, and too many of them; groups without names.
    assert!(with("\"position\":true", "\"position\":false").contains("118 widths of 0 to 8"));
    assert!(with("\"groups\":2", "\"groups\":4000000000").contains("more than the limit"));
    assert!(
        with("\"groups\":[\"fill\",", "\"groups\":[").contains("2, as many as there are groups")
    );
    assert!(with("\"seconds\":", "\"seconds\":-").contains("seconds"));
    assert!(with("\"identity\"", "\"identitx\"").contains("identity"));
}

#[test]
fn exposures_that_do_not_fit_are_errors() {
    let scene = scene();
    let try_with = |exposure: &mut Exposure, options: &RenderOptions| {
        expose(&scene, &camera(), options, exposure, |_, _| {
            ControlFlow::Continue(())
        })
    };
    let mut other_size = Exposure::new(8, 8, 0).unwrap();
    assert!(try_with(&mut other_size, &settings()).is_err());
    let mut without = Exposure::new(12, 12, 0).unwrap();
    let error = try_with(&mut without, &settings()).unwrap_err().to_string();
    let all = "position, material, direct, indirect, groups, reweighted";
    assert_eq!(
        error,
        format!("layers is {all}, expected those of the film")
    );
    let mut more = taken(&scene, 0..4, 1);
    let error = try_with(&mut more, &until(3)).unwrap_err().to_string();
    assert!(error.contains("3, after 4 that are taken"), "{error}");
    let mut later = exposure(40);
    assert!(try_with(&mut later, &until(40)).is_err());
}
