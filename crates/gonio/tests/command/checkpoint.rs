//! Renderings that are ended in every way, and go on.

#![cfg(unix)]

use crate::support::{BALL, Place, said};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// A picture that takes about a second in a debug build.
const SIZE: [&str; 4] = ["--size", "24x24", "--spp", "400"];

fn arguments<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let all = [
        "render",
        "ball.toml",
        "-o",
        "a.exr",
        "--checkpoint",
        "a.checkpoint",
    ];
    [&all[..], &SIZE, more].concat()
}

/// kill −9 at random moments: what is left is always a sound checkpoint or none, it never has fewer samples than before, and in the end the
/// picture is the one without interruption.
#[test]
fn killed_again_and_again() {
    let place = Place::new();
    place.write("ball.toml", BALL);
    let whole = [&["render", "ball.toml", "-o", "whole.exr"][..], &SIZE].concat();
    let begun = Instant::now();
    place.good(&whole);
    // Shorter than the whole: few runs come to their end.
    let longest = begun.elapsed().mul_f64(0.5).min(Duration::from_millis(500));
    let more = arguments(&["--resume", "--checkpoint-every", "0.02s", "-q"]);
    let (mut kills, mut taken, mut finished) = (0_u32, 0, 0);
    while kills < 50 {
        let mut child = place
            .command(&more)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // A fixed sequence that is spread evenly: the golden ratio.
        let share = (f64::from(kills) * 0.618_033_988_75).fract();
        std::thread::sleep(longest.mul_f64(share));
        let ended = child.try_wait().unwrap();
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
        if !place.path().join("a.checkpoint").exists() {
            assert_eq!(taken, 0);
            continue;
        }
        let info = place.json(&["info", "a.checkpoint", "--json"]);
        let (_, end) = info["samples"].as_str().unwrap().split_once(':').unwrap();
        let end: u32 = end.parse().unwrap();
        assert!(end >= taken, "{end} after {taken}");
        taken = end;
        if ended.is_some_and(|status| status.success()) {
            finished += 1;
            assert!(place.read("a.exr") == place.read("whole.exr"));
            std::fs::remove_file(place.path().join("a.checkpoint")).unwrap();
            taken = 0;
        }
    }
    place.good(&more);
    assert!(
        place.read("a.exr") == place.read("whole.exr"),
        "{finished} runs came to their end"
    );
    // At most one file is left of those that were being written, for each name.
    let left: Vec<_> = place
        .files()
        .into_iter()
        .filter(|f| f.to_string_lossy().ends_with(".tmp"))
        .collect();
    assert!(
        left.iter()
            .all(|f| !f.to_string_lossy().contains("checkpoint")),
        "{left:?}"
    );
}

/// SIGTERM, twice: a checkpoint, exit code 4, and the same picture after going on.
#[test]
fn ended_by_a_job_queue_and_gone_on_with() {
    let place = Place::new();
    place.write("ball.toml", BALL);
    let small = ["--size", "24x24"];
    let long = [
        &[
            "render",
            "ball.toml",
            "-o",
            "a.exr",
            "-o",
            "a.gonio",
            "--checkpoint",
            "a.checkpoint",
            "--spp",
            "1000000",
        ],
        &small[..],
    ]
    .concat();
    let mut command = place.command(&long);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    super::interrupt::wait_until_it_listens(child.id());
    for _ in 0..2 {
        let id = child.id().to_string();
        // The second may come too late, to nobody.
        let _ = Command::new("kill")
            .args(["-TERM", &id])
            .stderr(Stdio::null())
            .status();
        std::thread::sleep(Duration::from_millis(30));
    }
    let said = said(child.wait_with_output().unwrap(), &long);
    assert_eq!(said.code, 4, "{said:?}");
    assert!(
        said.err.contains("a.checkpoint holds them") && said.err.contains("--resume"),
        "{said:?}"
    );
    assert!(!place.path().join("a.gonio").exists());
    let info = place.json(&["info", "a.checkpoint", "--json"]);
    let end: u32 = info["samples"].as_str().unwrap()[2..].parse().unwrap();
    let more = (end + 5).to_string();
    let go_on = [
        &[
            "render",
            "ball.toml",
            "-o",
            "a.exr",
            "--checkpoint",
            "a.checkpoint",
            "--resume",
            "--spp",
            &more,
        ],
        &small[..],
    ]
    .concat();
    let summary = place.json(&[&go_on[..], &["--json"]].concat());
    assert_eq!(summary["samples_per_pixel"], end + 5);
    place.good(
        &[
            &["render", "ball.toml", "-o", "b.exr", "--spp", &more],
            &small[..],
        ]
        .concat(),
    );
    assert!(place.read("a.exr") == place.read("b.exr"));
}

#[test]
fn checkpoints_of_something_else_are_refused() {
    let place = Place::new();
    place.write("ball.toml", BALL);
    let run = |more: &[&'static str]| {
        [
            &[
                "render",
                "ball.toml",
                "--size",
                "8x8",
                "-o",
                "a.exr",
                "--checkpoint",
                "a.checkpoint",
            ],
            more,
        ]
        .concat()
    };
    place.good(&run(&["--spp", "4", "--resume"]));
    let again = |code, more: &[&'static str], words: &[&str]| {
        place.bad(&run(more), code, words);
    };
    again(
        2,
        &["--spp", "8"],
        &["there is a checkpoint already", "--resume"],
    );
    again(
        3,
        &["--spp", "8", "--resume", "--seed", "1"],
        &["another seed: 0, expected 1"],
    );
    again(
        3,
        &["--spp", "8", "--resume", "--integrator", "direct"],
        &["another integrator: Path", "expected Direct"],
    );
    again(
        3,
        &["--spp", "8", "--resume", "--max-bounces", "3"],
        &["another integrator"],
    );
    again(
        3,
        &["--spp", "2", "--resume"],
        &["the samples 0:4, expected some of 0:2"],
    );
    again(
        3,
        &["--spp", "8", "--part", "1/2", "--resume"],
        &["expected some of 4:8"],
    );
    // As another version would have written it.
    let bytes = place.read("a.checkpoint");
    let own = concat!("gonio ", env!("CARGO_PKG_VERSION"));
    let at = bytes
        .windows(own.len())
        .position(|w| w == own.as_bytes())
        .unwrap();
    let mut older = bytes.clone();
    older[at + own.len() - 1] ^= 1;
    place.write("a.checkpoint", older);
    again(3, &["--spp", "8", "--resume"], &["another version: gonio "]);
    place.write("a.checkpoint", &bytes[..bytes.len() / 2]);
    again(3, &["--spp", "8", "--resume"], &["a.checkpoint", "bytes"]);
    place.write("a.checkpoint", b"");
    again(3, &["--spp", "8", "--resume"], &["a.checkpoint", "0 bytes"]);
    place.write("a.checkpoint", &bytes);
    place.write("ball.toml", BALL.replace("0.5", "0.75"));
    again(3, &["--spp", "8", "--resume"], &["another scene: "]);
    assert!(place.read("a.checkpoint") == bytes);
}

/// A disk that is full, as a limit on the size of files: the rendering goes on, the checkpoint before stays, and the failure is told.
#[test]
fn a_full_disk_leaves_the_older_checkpoint() {
    let place = Place::new();
    place.write("ball.toml", BALL);
    let run = |spp: &str| {
        let all = [
            "--size",
            "64x64",
            "-o",
            "a.png",
            "--checkpoint",
            "a.checkpoint",
            "--checkpoint-every",
            "0.01s",
            "--resume",
            "--spp",
            spp,
        ];
        all.map(str::to_owned).join(" ")
    };
    place.good(
        &[
            &["render", "ball.toml"],
            &run("2").split(' ').collect::<Vec<_>>()[..],
        ]
        .concat(),
    );
    let before = place.read("a.checkpoint");
    // In units of 512 or 1024 bytes; SIGXFSZ is ignored, so that writing fails.
    let script = format!(
        "ulimit -f 200; trap '' XFSZ; exec '{}' render ball.toml {}",
        env!("CARGO_BIN_EXE_gonio"),
        run("40")
    );
    let output = Command::new("sh")
        .args(["-c", &script])
        .current_dir(place.path())
        .output()
        .unwrap();
    let said = said(output, &[]);
    assert_eq!(said.code, 3, "{said:?}");
    assert!(
        said.err.contains("a.checkpoint") && said.err.contains("cannot write"),
        "{said:?}"
    );
    assert!(place.read("a.checkpoint") == before);
    assert!(place.path().join("a.png").exists());
    assert!(
        !place
            .files()
            .iter()
            .any(|f| f.to_string_lossy().ends_with(".tmp"))
    );
}
