//! `gonio brdf check --exec`, `--junit` and `--html`.

use crate::support::Place;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The Python that runs scripts; `None`, said aloud, where there is none.
fn python() -> Option<String> {
    let python = std::env::var("GONIO_PYTHON").unwrap_or_else(|_| "python3".into());
    let found = Command::new(&python)
        .args(["-c", "import sys; assert sys.version_info >= (3, 10)"])
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success());
    if !found {
        eprintln!("skipped: no `{python}` of version 3.10 or later");
    }
    found.then_some(python)
}

/// A diffuse surface with a little too much, where `more` is its albedo over 1.
const DIFFUSE: &str = r#"
import json, math, sys
albedo = float(sys.argv[1])
for line in sys.stdin:
    question = json.loads(line)
    answer = {"id": question["id"]}
    if question["ask"] == "hello":
        answer |= {"name": "paint", "offers": ["eval"], "parameters": {"albedo": albedo}}
    else:
        answer["f"] = [albedo / math.pi if i[2] > 0 and o[2] > 0 else 0 for i, o in zip(question["wi"], question["wo"])]
    print(json.dumps(answer), flush=True)
"#;

#[test]
fn a_program_gets_a_verdict_and_files() {
    let Some(python) = python() else { return };
    let place = Place::new();
    place.write("paint.py", DIFFUSE);
    let command = format!("{python} paint.py 0.5");
    let arguments = ["brdf", "check", "--exec", &command, "--effort", "quick"];
    let out = place
        .good(&[&arguments[..], &["--html", "a.html", "--junit", "a.xml"]].concat())
        .out;
    assert!(out.starts_with("paint:albedo=0.5\n"), "{out}");
    assert!(out.contains("PASS:"), "{out}");
    let page = String::from_utf8(place.read("a.html")).unwrap();
    assert!(page.contains("<title>PASS · paint:albedo=0.5</title>"));
    // The command is quoted for a shell, and then for HTML.
    assert!(page.contains("gonio brdf check --exec &#39;"), "{page}");
    let xml = String::from_utf8(place.read("a.xml")).unwrap();
    let tree = roxmltree::Document::parse(&xml).unwrap();
    assert_eq!(tree.root_element().attribute("failures"), Some("0"));
    let json = place.json(&[&arguments[..], &["--json"]].concat());
    assert_eq!(json[0]["subject"], "paint:albedo=0.5");

    // What fails is written, too, and the exit code is 1.
    let command = format!("{python} paint.py 1.5");
    let said = place.gonio(&[
        "brdf", "check", "--exec", &command, "--effort", "quick", "--junit", "b.xml",
    ]);
    assert_eq!(said.code, 1, "{said:?}");
    assert!(
        said.err
            .contains("error: not as declared: paint:albedo=1.5"),
        "{said:?}"
    );
    let xml = String::from_utf8(place.read("b.xml")).unwrap();
    let tree = roxmltree::Document::parse(&xml).unwrap();
    let failure = tree
        .descendants()
        .find(|n| n.has_tag_name("failure"))
        .unwrap();
    assert_eq!(failure.attribute("type"), Some("energy"));
    assert!(
        failure
            .attribute("message")
            .unwrap()
            .starts_with("1.5 (bound 1.0001)")
    );
}

#[test]
fn models_of_the_registry_have_reports() {
    let place = Place::new();
    let spec = "ggx:metal=gold,roughness=0.3";
    place.good(&[
        "brdf",
        "check",
        spec,
        "--effort",
        "quick",
        "--html",
        "gold.html",
        "--junit",
        "gold.xml",
    ]);
    let page = String::from_utf8(place.read("gold.html")).unwrap();
    for word in [
        "Parameters",
        "roughness = 0.3",
        "Heitz",
        "gonio brdf check ggx:metal=gold,roughness=0.3 --effort quick",
    ] {
        assert!(page.contains(word), "{word}");
    }
    // The same bytes again; what stood there is replaced.
    place.good(&[
        "brdf",
        "check",
        spec,
        "--effort",
        "quick",
        "--html",
        "gold.html",
    ]);
    assert_eq!(page.as_bytes(), place.read("gold.html"));
    assert_eq!(place.files().len(), 2);
}

#[test]
fn programs_that_fail_are_named() {
    let place = Place::new();
    let exec = |command: &str, more: &[&str], code, words: &[&str]| {
        let arguments = [&["brdf", "check", "--exec", command][..], more].concat();
        place.bad(&arguments, code, words)
    };
    exec("", &[], 2, &["the command line is empty"]);
    exec("mine 'a", &[], 2, &["a quote isn't closed"]);
    exec(
        "no-such-program",
        &[],
        3,
        &["can't start `no-such-program`"],
    );
    if cfg!(unix) {
        exec(
            "sleep 1000",
            &["--exec-timeout", "0.5"],
            3,
            &["no answer to hello within 0.5 s"],
        );
        exec(
            "sh -c 'echo no light >&2; exit 9'",
            &[],
            3,
            &["  | no light", "exit status 9"],
        );
        exec(
            "echo hello",
            &[],
            3,
            &["`hello`", "expected a line of JSON"],
        );
    }
}

/// A build server shows an error, not a failed property.
#[cfg(unix)]
#[test]
fn a_program_that_dies_is_an_error_in_junit() {
    let place = Place::new();
    let said = place.gonio(&[
        "brdf",
        "check",
        "--exec",
        "sh -c 'exit 9'",
        "--junit",
        "a.xml",
    ]);
    assert_eq!(said.code, 3, "{said:?}");
    let xml = String::from_utf8(place.read("a.xml")).unwrap();
    let document = roxmltree::Document::parse(&xml).unwrap();
    let all = document.root_element();
    assert_eq!(all.attribute("errors"), Some("1"));
    assert_eq!(all.attribute("failures"), Some("0"));
    let error = all.descendants().find(|n| n.has_tag_name("error")).unwrap();
    let message = error.attribute("message").unwrap();
    assert!(message.contains("exit status 9"), "{xml}");
}

#[test]
fn arguments_of_check_are_checked() {
    let place = Place::new();
    place.bad(&["brdf", "check"], 2, &["--exec"]);
    place.bad(&["brdf", "check", "ggx", "--exec", "mine"], 2, &["--exec"]);
    place.bad(
        &["brdf", "check", "ggx", "--exec-timeout", "5"],
        2,
        &["--exec-timeout"],
    );
    for seconds in ["0", "-1", "nan", "1e99", "soon"] {
        let timeout = format!("--exec-timeout={seconds}");
        place.bad(
            &["brdf", "check", "--exec", "mine", &timeout],
            2,
            &["seconds"],
        );
    }
    for option in ["--junit", "--html"] {
        let file = |path: &str, words: &[&str]| {
            place.bad(&["brdf", "check", "lambertian", option, path], 3, words);
        };
        file("nowhere/a.file", &["nowhere does not exist", "mkdir"]);
        file(".", &["a folder"]);
        place.bad(&["brdf", "check", "lambertian", option], 2, &[option]);
    }
    let same = ["brdf", "check", "lambertian", "--html", "a", "--junit", "a"];
    place.bad(&same, 2, &["different names"]);
}

/// Ctrl-C ends what was started.
#[cfg(target_os = "linux")]
#[test]
fn an_interrupt_ends_the_program() {
    let Some(python) = python() else { return };
    let place = Place::new();
    place.write(
        "deaf.py",
        "import os, time\nopen('id', 'w').write(str(os.getpid()))\ntime.sleep(1000)\n",
    );
    let exec = format!("{python} deaf.py");
    let mut child = place
        .command(&["brdf", "check", "--exec", &exec])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let id = loop {
        let id = std::fs::read_to_string(place.path().join("id")).unwrap_or_default();
        if !id.is_empty() {
            break id;
        }
        std::thread::sleep(Duration::from_millis(10));
    };
    let interrupted = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(interrupted.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(4));
    // It ends in its own time, and may be a zombie until its new parent notices.
    let alive = || {
        let stat = std::fs::read_to_string(format!("/proc/{id}/stat")).unwrap_or_default();
        !stat.is_empty() && !stat.contains(") Z")
    };
    let deadline = Instant::now() + Duration::from_secs(20);
    while alive() {
        assert!(Instant::now() < deadline, "{id} lives on");
        std::thread::sleep(Duration::from_millis(10));
    }
}
