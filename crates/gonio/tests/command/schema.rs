//! Jobs against what their systems take: the fields, types and rules of what was published, as far as `gonio farm` uses them.
//!
//! - Kubernetes: API reference v1.35, `batch/v1` Job and `core/v1` PodTemplateSpec, and the rules that its API server checks
//! - HyperQueue: the documentation's "Job Definition File" of version 0.23

use crate::support::{BALL, Place};
use serde_json::{Value, json};

/// What a value has to be.
#[derive(Clone, Copy)]
enum Kind {
    Text,
    /// A whole number, 0 or more.
    Whole,
    Each(&'static Kind),
    /// A table of these fields and no others, with names, kinds, and whether they have to be there.
    Table(&'static [(&'static str, Kind, bool)]),
    /// A table of any names.
    Texts,
}
use Kind::{Each, Table, Text, Texts, Whole};

/// What is wrong with a value, the first thing that is.
fn fault(value: &Value, kind: Kind, at: &str) -> Option<String> {
    let expected = match kind {
        Text if value.is_string() => return None,
        Whole if value.is_u64() => return None,
        Texts
            if value
                .as_object()
                .is_some_and(|o| o.values().all(Value::is_string)) =>
        {
            return None;
        }
        Each(kind) => {
            if let Some(all) = value.as_array() {
                let mut faults = all.iter().enumerate();
                return faults.find_map(|(i, v)| fault(v, *kind, &format!("{at}[{i}]")));
            }
            "a list"
        }
        Table(fields) => {
            if let Some(object) = value.as_object() {
                let unknown = object.keys().find(|k| fields.iter().all(|f| f.0 != *k));
                if let Some(key) = unknown {
                    return Some(format!("{at} has {key}, which nothing is called"));
                }
                return fields
                    .iter()
                    .find_map(|&(name, kind, required)| match object.get(name) {
                        Some(value) => fault(value, kind, &format!("{at}.{name}")),
                        None => required.then(|| format!("{at} has no {name}")),
                    });
            }
            "a table"
        }
        Text => "a text",
        Whole => "a whole number",
        Texts => "a table of texts",
    };
    Some(format!("{at} is {value}, expected {expected}"))
}

const CONTAINER: Kind = Table(&[
    ("name", Text, true),
    ("image", Text, true),
    ("command", Each(&Text), false),
    ("args", Each(&Text), false),
    ("workingDir", Text, false),
    (
        "resources",
        Table(&[("requests", Texts, false), ("limits", Texts, false)]),
        false,
    ),
    (
        "volumeMounts",
        Each(&Table(&[("name", Text, true), ("mountPath", Text, true)])),
        false,
    ),
]);

const POD: Kind = Table(&[
    ("restartPolicy", Text, true),
    ("terminationGracePeriodSeconds", Whole, false),
    ("containers", Each(&CONTAINER), true),
    (
        "volumes",
        Each(&Table(&[
            ("name", Text, true),
            (
                "persistentVolumeClaim",
                Table(&[("claimName", Text, true)]),
                false,
            ),
        ])),
        false,
    ),
]);

const FAILURE_RULE: Kind = Table(&[
    ("action", Text, true),
    (
        "onExitCodes",
        Table(&[
            ("containerName", Text, false),
            ("operator", Text, true),
            ("values", Each(&Whole), true),
        ]),
        false,
    ),
    (
        "onPodConditions",
        Each(&Table(&[("type", Text, true), ("status", Text, true)])),
        false,
    ),
]);

const JOB: Kind = Table(&[
    ("apiVersion", Text, true),
    ("kind", Text, true),
    ("metadata", Table(&[("name", Text, true)]), true),
    (
        "spec",
        Table(&[
            ("completionMode", Text, false),
            ("completions", Whole, false),
            ("parallelism", Whole, false),
            ("backoffLimit", Whole, false),
            ("backoffLimitPerIndex", Whole, false),
            (
                "podFailurePolicy",
                Table(&[("rules", Each(&FAILURE_RULE), true)]),
                false,
            ),
            ("template", Table(&[("spec", POD, true)]), true),
        ]),
        true,
    ),
]);

const LIST: Kind = Table(&[
    ("apiVersion", Text, true),
    ("kind", Text, true),
    ("items", Each(&JOB), true),
]);

/// The rules that no type says: those of the Job that an API server checks.
fn broken_rule(job: &Value) -> Option<&'static str> {
    let (spec, pod) = (&job["spec"], &job["spec"]["template"]["spec"]);
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let name = text(&job["metadata"]["name"]);
    let indexed = spec["completionMode"] == "Indexed";
    // The host's name of a pod is the job's with the index.
    let room = if indexed { 63 - "-99999".len() } else { 63 };
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    let label = !name.is_empty() && name.len() <= room && name.chars().all(plain);
    let ends = |c: char| c == '-';
    let policy = &spec["podFailurePolicy"]["rules"];
    let rules: Vec<Value> = policy.as_array().cloned().unwrap_or_default();
    let containers: Vec<Value> = pod["containers"].as_array().cloned().unwrap_or_default();
    let named = |name: &Value| containers.iter().any(|c| c["name"] == *name);
    let exit_codes_are_good = |rule: &Value| {
        let codes = &rule["onExitCodes"];
        let values: Vec<u64> = (codes["values"].as_array().into_iter().flatten())
            .filter_map(Value::as_u64)
            .collect();
        codes.is_null()
            || (["In", "NotIn"].contains(&text(&codes["operator"]).as_str())
                && values.windows(2).all(|pair| pair[0] < pair[1])
                && (1..=255).contains(&values.len())
                && !(codes["operator"] == "In" && values.contains(&0))
                && (codes["containerName"].is_null() || named(&codes["containerName"])))
    };
    let one_of = |value: &Value, words: &[&str]| words.contains(&text(value).as_str());
    let volumes: Vec<Value> = pod["volumes"].as_array().cloned().unwrap_or_default();
    let mounts = containers
        .iter()
        .flat_map(|c| c["volumeMounts"].as_array().into_iter().flatten());
    let mounted = |mount: &Value| volumes.iter().any(|v| v["name"] == mount["name"]);
    let checks = [
        (
            job["apiVersion"] == "batch/v1" && job["kind"] == "Job",
            "a Job of batch/v1",
        ),
        (
            label && !name.starts_with(ends) && !name.ends_with(ends),
            "a name that is a DNS label",
        ),
        (
            !indexed || spec["completions"].is_u64(),
            "completions, where it is indexed",
        ),
        (
            !indexed || spec["parallelism"].as_u64() <= spec["completions"].as_u64(),
            "no more pods at once than completions",
        ),
        (
            spec["completions"].as_u64() <= Some(100_000),
            "at most 10⁵ completions",
        ),
        (
            spec["backoffLimitPerIndex"].is_null() || indexed,
            "a limit of each index, where it is indexed",
        ),
        (
            policy.is_null() || pod["restartPolicy"] == "Never",
            "no restarts beside a policy of failures",
        ),
        (
            one_of(&pod["restartPolicy"], &["Never", "OnFailure"]),
            "a policy of restarts that jobs have",
        ),
        (rules.len() <= 20, "at most 20 rules"),
        (
            rules
                .iter()
                .all(|r| one_of(&r["action"], &["FailJob", "FailIndex", "Ignore", "Count"])),
            "an action that there is",
        ),
        (
            rules
                .iter()
                .all(|r| r["onExitCodes"].is_null() != r["onPodConditions"].is_null()),
            "one condition a rule",
        ),
        (
            rules.iter().all(exit_codes_are_good),
            "exit codes that are sorted, of a container that is there",
        ),
        ({ mounts }.all(mounted), "volumes for all mounts"),
    ];
    checks
        .iter()
        .find(|(holds, _)| !holds)
        .map(|(_, rule)| *rule)
}

fn job(system: &str, file: &str, more: &[&str]) -> String {
    let place = Place::new();
    let scene = place.write("My Room_2.toml", BALL);
    let usual = ["farm", system, &scene, "--parts", "3", "-o", "job"];
    let options = ["--", "--size", "8x8", "--layers", "all"];
    place.good(&[&usual[..], more, &options].concat());
    String::from_utf8(place.read(&format!("job/{file}"))).unwrap()
}

#[test]
fn jobs_of_kubernetes_are_as_its_api_wants_them() {
    let text = job(
        "kubernetes",
        "job.json",
        &["--container", "registry/gonio:1", "--claim", "scenes"],
    );
    let list: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(fault(&list, LIST, "list"), None);
    assert_eq!(
        (&list["apiVersion"], &list["kind"]),
        (&"v1".into(), &"List".into())
    );
    let jobs = list["items"].as_array().unwrap();
    assert_eq!(jobs.len(), 2);
    for job in jobs {
        assert_eq!(broken_rule(job), None, "{job:#}");
    }
    // Controls: what would be refused is found.
    let parts = &jobs[0];
    let with = |pointer: &str, value: Value| {
        let mut changed = parts.clone();
        *changed.pointer_mut(pointer).unwrap() = value;
        fault(&changed, JOB, "job").or(broken_rule(&changed).map(str::to_owned))
    };
    let found = |pointer: &str, value: Value, says: &str| {
        let fault = with(pointer, value).unwrap_or_default();
        assert!(fault.contains(says), "{pointer}: {fault}");
    };
    found(
        "/spec/completions",
        json!("3"),
        "job.spec.completions is \"3\", expected a whole number",
    );
    found("/spec", json!({"templat": {}}), "job.spec has templat");
    found(
        "/spec/template/spec",
        json!({"containers": []}),
        "has no restartPolicy",
    );
    found(
        "/spec/completionMode",
        json!("NonIndexed"),
        "a limit of each index",
    );
    found("/spec/parallelism", json!(4), "no more pods");
    found(
        "/spec/template/spec/restartPolicy",
        json!("OnFailure"),
        "no restarts",
    );
    found(
        "/spec/template/spec/containers/0/name",
        json!("other"),
        "a container that is there",
    );
    found(
        "/spec/template/spec/volumes/0/name",
        json!("other"),
        "volumes",
    );
    found(
        "/spec/podFailurePolicy/rules/0/onExitCodes/values",
        json!([3, 2]),
        "sorted",
    );
    found("/metadata/name", json!("My_Job"), "DNS label");
    found("/apiVersion", json!("batch/v1beta1"), "batch/v1");
}

const TASK: Kind = Table(&[
    ("id", Whole, false),
    ("command", Each(&Text), true),
    ("cwd", Text, false),
    ("stdout", Text, false),
    ("stderr", Text, false),
    ("deps", Each(&Whole), false),
    ("crash_limit", Whole, false),
    ("time_limit", Text, false),
    (
        "request",
        Each(&Table(&[
            ("resources", Texts, false),
            ("time_request", Text, false),
        ])),
        false,
    ),
]);

const JOB_FILE: Kind = Table(&[
    ("name", Text, false),
    ("max_fails", Whole, false),
    ("task", Each(&TASK), true),
]);

/// What no type says: identifiers are used once, and tasks depend on others that are there.
fn broken_task(job: &Value) -> Option<String> {
    let tasks = job["task"].as_array()?;
    let ids: Vec<&Value> = tasks.iter().map(|t| &t["id"]).collect();
    let twice = ids
        .iter()
        .enumerate()
        .find(|(i, id)| ids[..*i].contains(id));
    if let Some((_, id)) = twice {
        return Some(format!("two tasks are {id}"));
    }
    let deps = |task: &Value| task["deps"].as_array().cloned().unwrap_or_default();
    let missing = |task: &Value| {
        deps(task)
            .into_iter()
            .find(|d| !ids.contains(&d) || *d == task["id"])
    };
    tasks
        .iter()
        .find_map(missing)
        .map(|d| format!("no other task is {d}"))
}

#[test]
fn jobs_of_hyperqueue_are_as_its_files_have_them() {
    let table: toml::Table = job("hyperqueue", "job.toml", &[]).parse().unwrap();
    let job = serde_json::to_value(table).unwrap();
    assert_eq!(fault(&job, JOB_FILE, "job"), None);
    assert_eq!(broken_task(&job), None);
    let with = |pointer: &str, value: Value| {
        let mut changed = job.clone();
        *changed.pointer_mut(pointer).unwrap() = value;
        fault(&changed, JOB_FILE, "job")
            .or(broken_task(&changed))
            .unwrap_or_default()
    };
    assert!(with("/task/0/command", json!("gonio render")).contains("expected a list"));
    assert!(with("/task/0", json!({"comand": []})).contains("has comand"));
    assert!(with("/task/3/deps/1", json!(7)).contains("no other task is 7"));
    assert!(with("/task/1/id", json!(0)).contains("two tasks are 0"));
}
