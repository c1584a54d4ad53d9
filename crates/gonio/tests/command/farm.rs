//! Jobs for other systems: their files as those systems read them, and their commands run as those systems would.

use crate::support::{BALL, Place};
use serde_json::Value;
use std::process::Command;

/// The program under test, as machines call it.
const GONIO: &str = env!("CARGO_BIN_EXE_gonio");
const OPTIONS: [&str; 5] = ["--", "--size", "12x12", "--spp", "10"];

fn farm(place: &Place, system: &str, more: &[&str]) {
    let common = [
        "ball.toml",
        "--parts",
        "3",
        "--cpus",
        "1",
        "-o",
        "job",
        "--gonio",
        GONIO,
    ];
    let all = [&["farm", system], &common[..], more, &OPTIONS].concat();
    let said = place.good(&all);
    assert!(said.out.contains("submit it: "), "{said:?}");
}

/// A scene, and its picture by one machine.
fn place() -> (Place, Vec<u8>) {
    let place = Place::new();
    place.write("ball.toml", BALL);
    place.good(&[
        "render",
        "ball.toml",
        "--size",
        "12x12",
        "--spp",
        "10",
        "-o",
        "one.exr",
    ]);
    let one = place.read("one.exr");
    (place, one)
}

fn text(place: &Place, name: &str) -> String {
    String::from_utf8(place.read(name)).unwrap()
}

fn words(list: &Value) -> Vec<String> {
    let all = list.as_array().unwrap().iter();
    all.map(|w| w.as_str().unwrap().to_owned()).collect()
}

/// Runs a command of a job in another folder, as its machine would.
fn on_a_machine(program: &str, words: &[String], variables: &[(&str, &str)]) {
    let elsewhere = tempfile::tempdir().unwrap();
    let output = Command::new(program)
        .args(words)
        .envs(variables.iter().copied())
        .current_dir(elsewhere.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{words:?} {output:?}");
}

#[test]
fn openjd() {
    let (place, one) = place();
    farm(
        &place,
        "openjd",
        &["--picture", "a.exr", "--picture", "a.png"],
    );
    let job: Value = serde_json::from_str(&text(&place, "job/job.json")).unwrap();
    assert_eq!(job["specificationVersion"], "jobtemplate-2023-09");
    let [render, merge] = [&job["steps"][0], &job["steps"][1]];
    assert_eq!(merge["dependencies"][0]["dependsOn"], render["name"]);
    let space = &render["parameterSpace"]["taskParameterDefinitions"][0];
    assert_eq!(
        (&space["name"], &space["range"]),
        (&"Part".into(), &"0-2".into())
    );
    let action = |step: &Value| step["script"]["actions"]["onRun"].clone();
    for k in ["2", "0", "1"] {
        let words: Vec<String> = words(&action(render)["args"])
            .iter()
            .map(|w| w.replace("{{Task.Param.Part}}", k))
            .collect();
        on_a_machine(action(render)["command"].as_str().unwrap(), &words, &[]);
    }
    on_a_machine(GONIO, &words(&action(merge)["args"]), &[]);
    assert!(place.read("job/a.exr") == one);
    assert!(place.path().join("job/a.png").exists());
}

/// The array's script, run by a shell with the variables that Slurm sets.
#[cfg(unix)]
#[test]
fn slurm() {
    let (place, one) = place();
    farm(&place, "slurm", &[]);
    let submit = text(&place, "job/submit.sh");
    assert!(submit.contains("--dependency=afterok:"), "{submit}");
    let script = text(&place, "job/render.sbatch");
    for line in [
        "#SBATCH --array=0-2",
        "#SBATCH --cpus-per-task=1",
        "#SBATCH --signal=B:TERM@120",
    ] {
        assert!(script.contains(line), "{script}");
    }
    let file = |name: &str| vec![place.path().join("job").join(name).display().to_string()];
    for k in ["1", "0", "2"] {
        on_a_machine("sh", &file("render.sbatch"), &[("SLURM_ARRAY_TASK_ID", k)]);
    }
    on_a_machine("sh", &file("merge.sbatch"), &[]);
    assert!(place.read("job/picture.exr") == one);
    // Checkpoints go when parts are there.
    assert!(
        std::fs::read_dir(place.path().join("job"))
            .unwrap()
            .all(|f| !f
                .unwrap()
                .file_name()
                .to_string_lossy()
                .ends_with(".checkpoint"))
    );
}

#[test]
fn hyperqueue() {
    let (place, one) = place();
    farm(&place, "hyperqueue", &[]);
    let job: toml::Table = text(&place, "job/job.toml").parse().unwrap();
    let tasks = job["task"].as_array().unwrap();
    assert_eq!(tasks.len(), 4);
    let merge = &tasks[3];
    assert_eq!(merge["deps"].as_array().unwrap().len(), 3);
    for task in tasks {
        assert_eq!(task["request"][0]["resources"]["cpus"].as_str(), Some("1"));
        let words: Vec<String> = task["command"]
            .as_array()
            .unwrap()
            .iter()
            .map(|w| w.as_str().unwrap().to_owned())
            .collect();
        on_a_machine(&words[0], &words[1..], &[]);
    }
    assert!(place.read("job/picture.exr") == one);
}

#[test]
fn kubernetes() {
    let (place, one) = place();
    farm(
        &place,
        "kubernetes",
        &["--container", "registry/gonio:1", "--claim", "scenes"],
    );
    let list: Value = serde_json::from_str(&text(&place, "job/job.json")).unwrap();
    let [parts, merge] = [&list["items"][0], &list["items"][1]];
    assert_eq!(
        (&parts["kind"], &parts["spec"]["completionMode"]),
        (&"Job".into(), &"Indexed".into())
    );
    assert_eq!(
        (&parts["spec"]["completions"], &merge["metadata"]["name"]),
        (&3.into(), &"gonio-ball-merge".into())
    );
    // The volume is this folder.
    let here = place.path().display().to_string();
    let arguments = |job: &Value| -> Vec<String> {
        let container = &job["spec"]["template"]["spec"]["containers"][0];
        words(&container["args"])
            .iter()
            .map(|w| w.replace("/work", &here))
            .collect()
    };
    let (parts, merge) = (arguments(parts), arguments(merge));
    std::thread::scope(|threads| {
        // It begins first, and waits.
        let waiting = threads.spawn(|| on_a_machine(GONIO, &merge, &[]));
        for k in ["0", "1", "2"] {
            on_a_machine(GONIO, &parts, &[("JOB_COMPLETION_INDEX", k)]);
        }
        waiting.join().unwrap();
    });
    assert!(place.read("job/picture.exr") == one);
}

#[test]
fn jobs_that_make_no_sense() {
    let place = Place::new();
    place.write("ball.toml", BALL);
    let bad = |arguments: &[&str], code, words: &[&str]| {
        place.bad(&[&["farm"], arguments].concat(), code, words);
    };
    bad(&["slurm", "none.toml", "--parts", "2"], 3, &["none.toml"]);
    bad(&["slurm", "ball.toml", "--parts", "0"], 2, &["1 to 100000"]);
    bad(
        &["slurm", "ball.toml", "--parts", "65"],
        2,
        &["65 parts of 64 samples"],
    );
    bad(
        &["slurm", "ball.toml", "--parts", "2", "--", "--time", "3s"],
        2,
        &["--time is not"],
    );
    bad(
        &["slurm", "ball.toml", "--parts", "2", "--", "--sppp", "3"],
        2,
        &["--sppp"],
    );
    bad(
        &["slurm", "ball.toml", "--parts", "2", "--picture", "a.txt"],
        2,
        &[".txt"],
    );
    bad(
        &["kubernetes", "ball.toml", "--parts", "2"],
        2,
        &["--container"],
    );
    bad(
        &[
            "kubernetes",
            "/ball.toml",
            "--parts",
            "2",
            "--container",
            "a",
            "--claim",
            "b",
        ],
        2,
        &["a path in the volume"],
    );
    bad(&["pbs", "ball.toml", "--parts", "2"], 2, &["pbs"]);
}
