//! Places that can't be written to: said before any time is spent, and nothing half-written is left.

use crate::support::{BALL, Place, said, tiny};
use std::time::{Duration, Instant};

/// A rendering of an hour, were it not refused at once.
fn long(output: &str) -> [&str; 5] {
    ["render", "--time", "1h", "-o", output]
}

#[test]
fn outputs_are_checked_before_time_is_spent() {
    let place = Place::new();
    place.write("file", "");
    std::fs::create_dir(place.path().join("folder.png")).unwrap();
    let start = Instant::now();
    for (output, code, words) in [
        ("nowhere/a.png", 3, ["nowhere", "mkdir"]),
        ("file/a.exr", 3, ["file", "not a folder"]),
        ("folder.png", 3, ["folder.png", "this is a folder"]),
        ("a.jpg", 2, [".jpg", ".exr, .hdr, .png or .gonio"]),
        ("a.PGN", 2, [".pgn", "did you mean .png?"]),
        ("picture", 2, ["no extension", ".exr, .hdr, .png or .gonio"]),
    ] {
        place.bad(&long(output), code, &words);
        // The second output counts as well as the first.
        place.bad(
            &[&long("good.png")[..], &["-o", output]].concat(),
            code,
            &words,
        );
        if code == 3 {
            place.write("a.hdr", "");
            place.bad(
                &["diff", "a.hdr", "a.hdr", "--heatmap", output],
                code,
                &words,
            );
        }
    }
    assert!(start.elapsed() < Duration::from_secs(60));
}

#[cfg(unix)]
#[test]
fn a_folder_that_may_not_be_written_to() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::new();
    let folder = place.path().join("locked");
    std::fs::create_dir(&folder).unwrap();
    std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(0o555)).unwrap();
    if std::fs::write(folder.join("probe"), "").is_ok() {
        eprintln!("skipped: this user may write to every folder");
        return;
    }
    place.bad(&long("locked/a.png"), 3, &["locked/a.png", "permission"]);
}

/// A file that may not grow stands for a disk that is full. The signal that the limit sends is ignored, as it would not be
/// sent by a disk.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_nothing_half_written() {
    let place = Place::new();
    let scene = place.write("ball.toml", BALL);
    let before = place.files();
    let limited = |blocks: u32, output: &[&str]| {
        let command = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
        let mut shell = std::process::Command::new("sh");
        shell
            .args([
                "-c",
                &command,
                env!("CARGO_BIN_EXE_gonio"),
                "render",
                &scene,
                "--size",
                "64x64",
                "--spp",
                "1",
            ])
            .args(output)
            .current_dir(place.path());
        said(shell.output().unwrap(), output)
    };
    // Not even the probe fits.
    let full = limited(1, &["-o", "a.exr"]);
    assert_eq!(full.code, 3, "{full:?}");
    assert!(
        full.err.contains("error: a.exr: cannot write")
            && full.err.contains("help: free some space"),
        "{full:?}"
    );
    assert_eq!(place.files(), before);
    // The probe fits, one picture doesn't: the other is kept.
    let nearly = limited(32, &["-o", "a.exr", "-o", "a.png"]);
    assert_eq!(nearly.code, 3, "{nearly:?}");
    assert!(nearly.err.contains("error: a.exr"), "{nearly:?}");
    assert!(
        nearly.out.contains("wrote a.png") && !nearly.out.contains("wrote a.exr"),
        "{nearly:?}"
    );
    let mut after = before;
    after.insert("a.png".into());
    assert_eq!(place.files(), after);
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_that_is_full() {
    let place = Place::new();
    let full = || {
        std::fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap()
    };
    for arguments in [
        &["brdf", "list"][..],
        &["brdf", "list", "--json"],
        &["measure", "irradiance", "--env", "uniform:1"],
    ] {
        let output = place.command(arguments).stdout(full()).output().unwrap();
        let said = said(output, arguments);
        assert_eq!(said.code, 3, "{said:?}");
        assert!(
            said.err.starts_with("error: standard output: cannot write"),
            "{said:?}"
        );
    }
    // Nobody hears the error, but the exit code says it.
    let output = place.command(&["rendr"]).stderr(full()).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_is_no_failure() {
    let place = Place::new();
    for arguments in [
        &["--help"][..],
        &["brdf", "list"],
        &["brdf", "list", "--json"],
        &["brdf", "check", "lambertian", "--effort", "quick"],
        &tiny(&[]),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = place.command(arguments).stdout(writer).output().unwrap();
        let said = said(output, arguments);
        assert_eq!((said.code, said.err.as_str()), (0, ""), "{arguments:?}");
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = place
            .command(&["render", "--spp", "0"])
            .stderr(writer)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2));
    }
}
