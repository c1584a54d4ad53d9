//! Conversations with processes that behave, and with those that don't. Each is a few lines of Python; without a `python3` (or
//! what GONIO_PYTHON names) these tests say so and skip.

#![allow(clippy::unwrap_used)]

mod support;

use gonio_exec::{Batches, ExecError, Fault, Killer, Process};
use gonio_num::Vec3;
use std::time::{Duration, Instant};
use support::{Script, python};

/// A time that no right answer takes, on the slowest machine.
const LONG: Duration = Duration::from_secs(60);
/// A time after which a silent process is given up.
const SHORT: Duration = Duration::from_millis(1000);

/// Says hello, and answers with `eval`; `more` is executed for each question, with `question` and `answer`.
fn answering(more: &str) -> String {
    format!(
        r#"
import json, sys, os, time, signal
def f(wi, wo): return wi[2] + 10 * wo[2]
for line in sys.stdin:
    question = json.loads(line)
    answer = {{"id": question["id"]}}
    ask = question["ask"]
    if ask == "hello": answer |= {{"name": "script", "offers": ["eval", "pdf", "sample"]}}
    if ask == "eval": answer["f"] = [f(*p) for p in zip(question["wi"], question["wo"])]
    if ask == "pdf": answer["pdf"] = [wi[2] for wi in question["wi"]]
    if ask == "sample":
        answer["wi"] = [wo if wo[2] > 0 else None for wo in question["wo"]]
        answer["weight"] = question["u"]
        answer["pdf"] = [wo[2] for wo in question["wo"]]
{more}
    print(json.dumps(answer), flush=True)
"#
    )
}

fn up(z: f64) -> Vec3<f64> {
    Vec3::new(0.0, 0.0, z)
}

/// Asks one question of `count` pairs.
fn eval(process: &mut Process, count: usize) -> Result<Vec<[f64; 3]>, ExecError> {
    let wi: Vec<_> = (0..count).map(|k| up(k as f64)).collect();
    let mut f = vec![[0.0; 3]; count];
    process.eval(&wi, &vec![up(1.0); count], &mut f).map(|()| f)
}

/// Starts the script, asks it twice, and ends it: the first error.
fn fails(body: &str, limit: Duration) -> Option<ExecError> {
    let script = Script::new(body)?;
    let mut process = match Process::start(&script.command(), limit) {
        Ok(process) => process,
        Err(e) => return Some(e),
    };
    let error = eval(&mut process, 3)
        .and_then(|_| eval(&mut process, 3))
        .err();
    Some(match error {
        Some(e) => e,
        None => process.finish().expect_err("it fails"),
    })
}

#[test]
fn answers_belong_to_questions() {
    let Some(script) = Script::new(&answering("")) else {
        return;
    };
    let mut process = Process::start(&script.command(), LONG).unwrap();
    assert_eq!(process.hello().name, "script");
    assert_eq!(process.hello().batches, Batches::Json);
    // More than one question takes, none, and one.
    for count in [10_000, 0, 1] {
        for (k, f) in eval(&mut process, count).unwrap().iter().enumerate() {
            assert_eq!(*f, [k as f64 + 10.0; 3]);
        }
    }
    let mut pdf = [0.0; 2];
    process
        .pdf(&[up(0.5), up(0.25)], &[up(1.0); 2], &mut pdf)
        .unwrap();
    assert_eq!(pdf, [0.5, 0.25]);
    let mut samples = [None; 2];
    let u = [[0.1, 0.2, 0.3]; 2];
    process
        .sample(&[up(0.5), up(-0.5)], &u, &mut samples)
        .unwrap();
    assert_eq!(samples[0].unwrap().weight, u[0]);
    assert_eq!(samples[0].unwrap().wi, up(0.5));
    assert_eq!(samples[1], None);
    process.finish().unwrap();
}

#[test]
fn silence_is_given_up() {
    let Some(e) = fails("import time\ntime.sleep(1000)", SHORT) else {
        return;
    };
    assert!(matches!(e.fault, Fault::Timeout { received: 0, .. }), "{e}");
    assert!(
        e.to_string().contains("no answer to hello within 1 s"),
        "{e}"
    );
    let later = fails(
        &answering("    if question['id'] == 2: time.sleep(1000)"),
        SHORT,
    )
    .unwrap();
    // Python may be slow to start, but not to be found out.
    assert!(matches!(later.fault, Fault::Timeout { .. }), "{later}");
    // Nothing is read, not even a question longer than a pipe.
    let body = r#"
import time
print('{"id": 0, "name": "deaf", "offers": ["eval"]}', flush=True)
time.sleep(1000)
"#;
    let script = Script::new(body).unwrap();
    let mut process = Process::start(&script.command(), SHORT).unwrap();
    let began = Instant::now();
    let e = eval(&mut process, 4096).unwrap_err();
    assert!(matches!(e.fault, Fault::Timeout { .. }), "{e}");
    assert!(began.elapsed() < SHORT + Duration::from_secs(5));
}

#[test]
fn the_last_words_of_a_crash_are_kept() {
    let Some(e) = fails("raise RuntimeError('no\\x1b[2Jlight')", LONG) else {
        return;
    };
    assert!(e.to_string().contains("it ended (exit status 1)"), "{e}");
    assert!(e.to_string().contains("hello"), "{e}");
    assert_eq!(e.stderr.last().unwrap(), "RuntimeError: no\u{fffd}[2Jlight");
    let e = fails(&answering("    if question['id'] == 2: sys.exit(7)"), LONG).unwrap();
    assert!(e.to_string().contains("exit status 7"), "{e}");
    assert!(e.to_string().contains("question 2 (eval)"), "{e}");
    #[cfg(unix)]
    {
        let e = fails(
            &answering("    if question['id'] == 1: os.kill(os.getpid(), signal.SIGSEGV)"),
            LONG,
        )
        .unwrap();
        assert!(e.to_string().contains("killed by signal 11"), "{e}");
    }
    // In the middle of an answer.
    let e = fails(
        &answering(
            "    if question['id'] == 1: print('{\"id\": 1', end='', flush=True); sys.exit(0)",
        ),
        LONG,
    )
    .unwrap();
    assert!(e.to_string().contains("exit status 0"), "{e}");
}

#[test]
fn garbage_is_shown() {
    let Some(e) = fails(
        &format!("print('Loading…', flush=True)\n{}", answering("")),
        LONG,
    ) else {
        return;
    };
    // Early enough it is found before the question.
    assert!(e.to_string().contains("`Loading…`"), "{e}");
    let e = fails(&answering("    if ask == 'eval': print('debug')"), LONG).unwrap();
    assert!(
        matches!(e.fault, Fault::NotAnAnswer { .. } | Fault::Unasked { .. }),
        "{e}"
    );
    assert!(e.to_string().contains("`debug"), "{e}");
    let bytes =
        "    if ask == 'eval': sys.stdout.buffer.write(bytes([255, 0, 10])); sys.stdout.flush()";
    let e = fails(&answering(bytes), LONG).unwrap();
    assert!(e.to_string().contains("the bytes ff 00"), "{e}");
    // Without end: as much is read as an answer could have.
    let endless = "    if ask == 'eval':\n        while True: sys.stdout.write('x' * 65536)";
    let e = fails(&answering(endless), LONG).unwrap();
    assert!(e.to_string().contains("a line of more than"), "{e}");
}

#[test]
fn answers_of_another_length_are_refused() {
    for (change, found) in [("[1:]", "2"), ("* 2", "6")] {
        let body = answering(&format!(
            "    if ask == 'eval': answer['f'] = answer['f'] {change}"
        ));
        let Some(e) = fails(&body, LONG) else { return };
        let expected =
            format!("question 1 (eval) was answered with {found} values of `f`, expected 3");
        assert!(e.to_string().contains(&expected), "{e}");
    }
    let body = answering("    if ask == 'sample': answer['pdf'].pop()");
    let script = Script::new(&body).unwrap();
    let mut process = Process::start(&script.command(), LONG).unwrap();
    let e = process
        .sample(&[up(1.0); 3], &[[0.5; 3]; 3], &mut [None; 3])
        .unwrap_err();
    assert!(e.to_string().contains("2 values of `pdf`"), "{e}");
}

#[test]
fn what_nobody_asked_for_is_noticed() {
    let Some(e) = fails(
        &answering("    if ask == 'eval': print(json.dumps(answer))"),
        LONG,
    ) else {
        return;
    };
    // The second copy is noticed before the next question, or as no answer to it.
    assert!(
        matches!(e.fault, Fault::Unasked { .. }) || e.to_string().contains("`id` = 1"),
        "{e}"
    );
    // After the end of its input, too.
    let body = format!("{}\nprint('goodbye')", answering(""));
    let e = fails(&body, LONG).unwrap();
    assert!(
        e.to_string()
            .contains("wrote `goodbye` without being asked, after its answer to question 2 (eval)"),
        "{e}"
    );
    // Answers that run ahead of the questions.
    let ahead = "    if ask == 'eval': answer['id'] += 1";
    let e = fails(&answering(ahead), LONG).unwrap();
    assert!(e.to_string().contains("`id` = 2"), "{e}");
}

#[test]
fn nan_is_an_answer() {
    let Some(script) = Script::new(&answering(
        "    if ask == 'eval': answer['f'] = [float('nan'), float('inf'), [1, None, -float('inf')]]",
    )) else {
        return;
    };
    let mut process = Process::start(&script.command(), LONG).unwrap();
    let f = eval(&mut process, 3).unwrap();
    assert!(f[0][0].is_nan() && f[1] == [f64::INFINITY; 3] && f[2][1].is_nan());
    process.finish().unwrap();
}

#[test]
fn a_flood_on_standard_error_is_no_matter() {
    let flood = "    sys.stderr.write('noise ' * 200000 + '\\n')";
    let Some(script) = Script::new(&answering(flood)) else {
        return;
    };
    let mut process = Process::start(&script.command(), LONG).unwrap();
    for _ in 0..5 {
        eval(&mut process, 10).unwrap();
    }
    process.finish().unwrap();
    let endless = "import sys\nwhile True: sys.stderr.write('noise\\n')";
    let e = fails(endless, SHORT).unwrap();
    assert!(matches!(e.fault, Fault::Timeout { .. }), "{e}");
    assert!((1..=12).contains(&e.stderr.len()));
}

#[test]
fn closed_streams_are_named() {
    let stays = "    if ask == 'hello': os.close(0); print(json.dumps(answer), flush=True); time.sleep(1000)";
    let Some(e) = fails(&answering(stays), LONG) else {
        return;
    };
    assert!(
        e.to_string().contains("it closed its standard input"),
        "{e}"
    );
    let stays = "    if ask == 'eval': os.close(1); time.sleep(1000)";
    let e = fails(&answering(stays), LONG).unwrap();
    assert!(
        e.to_string().contains("it closed its standard output"),
        "{e}"
    );
    assert!(e.to_string().contains("question 1 (eval)"), "{e}");
}

/// Whether a process of this number is there, a zombie included.
#[cfg(target_os = "linux")]
fn exists(id: &str) -> bool {
    std::path::Path::new("/proc").join(id.trim()).exists()
}

/// Asks a process that ignores every request to end, and returns how it went after the process has gone.
#[cfg(target_os = "linux")]
#[test]
fn nothing_is_left_behind() {
    let ignores = r#"
import os, signal, sys
for s in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP): signal.signal(s, signal.SIG_IGN)
child = os.fork()
if child == 0:
    while True: signal.pause()
open(sys.argv[1], 'w').write(f'{os.getpid()} {child}')
"#;
    let body = format!("{ignores}\n{}\nwhile True: time.sleep(1)", answering(""));
    let Some(script) = Script::new(&body) else {
        return;
    };
    let ids = script.folder().join("ids");
    let command = format!("{} '{}'", script.command(), ids.display());
    type End = fn(Process, Killer);
    let ends: [End; 3] = [
        |process, _| process.finish().unwrap(),
        |process, _| drop(process),
        |process, killer| {
            killer.kill();
            drop(process);
        },
    ];
    for end in ends {
        let mut killer = None;
        let mut process = Process::start_with(&command, LONG, |k| killer = Some(k)).unwrap();
        eval(&mut process, 3).unwrap();
        let began = Instant::now();
        end(process, killer.unwrap());
        assert!(began.elapsed() < Duration::from_secs(10));
        let ids = std::fs::read_to_string(&ids).unwrap();
        let (parent, child) = ids.split_once(' ').unwrap();
        assert!(!exists(parent), "a zombie at least");
        // Its child is an orphan, whose end somebody else has to notice.
        let deadline = Instant::now() + Duration::from_secs(10);
        while exists(child) && !is_zombie(child) {
            assert!(Instant::now() < deadline, "the child lives on");
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

/// Ended, but not noticed by whoever inherited it.
#[cfg(target_os = "linux")]
fn is_zombie(id: &str) -> bool {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", id.trim())).unwrap_or_default();
    stat.rsplit(')')
        .next()
        .is_some_and(|s| s.trim().starts_with('Z'))
}

#[test]
fn programs_that_cannot_be_started_are_named() {
    let start = |command: &str| Process::start(command, LONG).unwrap_err();
    let e = start("no-such-program-anywhere --flag");
    assert!(
        e.to_string()
            .starts_with("no-such-program-anywhere --flag: can't start"),
        "{e}"
    );
    assert!(e.help().contains("PATH"));
    let folder = tempfile::tempdir().unwrap();
    let e = start(&format!("'{}'", folder.path().display()));
    assert!(matches!(e.fault, Fault::Start { .. }), "{e}");
    let text = folder.path().join("mine.py");
    std::fs::write(&text, "print(1)").unwrap();
    let e = start(&format!("'{}'", text.display()));
    assert!(matches!(e.fault, Fault::Start { .. }), "{e}");
    assert!(matches!(start("  ").fault, Fault::EmptyCommand));
    assert!(matches!(start("python3 'mine.py").fault, Fault::OpenQuote));
}

/// A shell in between is ended with what it has started.
#[cfg(unix)]
#[test]
fn a_shell_can_be_named() {
    let Some(script) = Script::new(&answering("")) else {
        return;
    };
    let command = format!(
        "sh -c 'cat | {} | cat'",
        script.command().replace('\'', "\"'\"")
    );
    let mut process = Process::start(&command, LONG).unwrap();
    assert_eq!(eval(&mut process, 2).unwrap()[1], [11.0; 3]);
    process.finish().unwrap();
}

/// The three programs of the documentation say the same.
#[test]
fn the_examples_agree() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/exec");
    let build = tempfile::tempdir().unwrap();
    let mut commands = Vec::new();
    if let Some(python) = python() {
        commands.push(format!("{python} '{}'", folder.join("ggx.py").display()));
        if support::has_numpy(&python) {
            commands.push(format!(
                "{python} '{}'",
                folder.join("ggx_numpy.py").display()
            ));
        } else {
            eprintln!("skipped: {python} has no numpy");
        }
    }
    let program = build.path().join("ggx");
    let compiled = std::process::Command::new("c++")
        .args(["-O1", "-std=c++17", "-Wall", "-Werror"])
        .arg(folder.join("ggx.cpp"))
        .arg("-o")
        .arg(&program)
        .status();
    match compiled {
        Ok(status) => {
            assert!(status.success());
            commands.push(format!("'{}'", program.display()));
        }
        Err(e) => eprintln!("skipped: c++: {e}"),
    }
    let mut answers = Vec::new();
    for command in &commands {
        let mut process = Process::start(&format!("{command} 0.4"), LONG).unwrap();
        assert_eq!(process.hello().parameters["roughness"], "0.4");
        let spiral: Vec<Vec3<f64>> = (0..500)
            .map(|k| {
                let (z, phi) = (1.0 - f64::from(k) / 300.0, 2.4 * f64::from(k));
                let r = (1.0 - z * z).max(0.0).sqrt();
                let (s, c) = gonio_num::Real::sin_cos(phi);
                Vec3::new(r * c, r * s, z)
            })
            .collect();
        let wo: Vec<_> = spiral.iter().rev().copied().collect();
        let u: Vec<[f64; 3]> = (0..500)
            .map(|k| [f64::from(k) / 500.0, f64::from(k % 21) / 21.0, 0.0])
            .collect();
        let (mut f, mut pdf, mut samples) = (vec![[0.0; 3]; 500], vec![0.0; 500], vec![None; 500]);
        process.eval(&spiral, &wo, &mut f).unwrap();
        process.pdf(&spiral, &wo, &mut pdf).unwrap();
        process.sample(&wo, &u, &mut samples).unwrap();
        process.finish().unwrap();
        let mut all: Vec<f64> = f.into_iter().flatten().chain(pdf).collect();
        for s in samples {
            let s = s.filter(|s| s.pdf > 0.0);
            all.extend(s.map_or([0.0; 7], |s| {
                let ([x, y, z], [r, g, b]) = (s.wi.to_array(), s.weight);
                [x, y, z, r, g, b, s.pdf]
            }));
        }
        answers.push(all);
    }
    for other in answers.iter().skip(1) {
        assert_eq!(other.len(), answers[0].len());
        for (a, b) in answers[0].iter().zip(other) {
            // A dozen roundings of 1e-16, and the factor of some 10² by which the lobe's slope multiplies them.
            assert!((a - b).abs() <= 1e-12 * a.abs().max(1.0), "{a} {b}");
        }
    }
}
