//! HyperQueue: a job file, <https://it4innovations.github.io/hyperqueue/stable/jobs/jobfile/>.

use super::{Files, Job, quoted};
use std::fmt::Write;

/// Times that a part may lose its worker.
const CRASHES: u32 = 20;

pub(super) fn files(job: &Job) -> Files {
    let mut text = format!("name = {}\n", string(&job.name));
    let mut task = |id: u32, name: &str, cpus: u32, arguments: Vec<String>, more: &str| {
        let words: Vec<String> = std::iter::once(job.gonio.clone())
            .chain(arguments)
            .map(|word| string(&word))
            .collect();
        let log = |kind: &str| string(&format!("{}/{name}.{kind}", job.folder));
        // Writing to a string never fails.
        let _ = write!(
            text,
            "\n[[task]]\nid = {id}\ncwd = {}\nstdout = {}\nstderr = {}\ncrash_limit = {CRASHES}\n{more}command = [{}]\n\n\
             [[task.request]]\nresources = {{ \"cpus\" = \"{cpus}\" }}\n",
            string(&job.here),
            log("out"),
            log("err"),
            words.join(", ")
        );
    };
    for k in 0..job.parts {
        let name = format!("part-{k}");
        task(k, &name, job.cpus, job.render(&k.to_string(), None), "");
    }
    let all: Vec<String> = (0..job.parts).map(|k| k.to_string()).collect();
    let deps = format!("deps = [{}]\n", all.join(", "));
    task(job.parts, "merge", 1, job.merge(), &deps);
    let path = quoted(&format!("{}/job.toml", job.folder));
    (
        vec![("job.toml", text)],
        format!("hq job submit-file {path}"),
    )
}

/// A basic string of TOML, which has the escapes of JSON.
fn string(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
