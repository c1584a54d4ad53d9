//! Open Job Description: a template of two steps, revision 2023-09.
//! <https://github.com/OpenJobDescription/openjd-specifications/wiki/2023-09-Template-Schemas>

use super::{Files, Job};
use serde_json::{Value, json};

/// Seconds that a part has for its checkpoint when it is cancelled.
const GRACE: u32 = 120;

pub(super) fn files(job: &Job) -> Files {
    let render = job.render("{{Task.Param.Part}}", Some("openjd"));
    let cancelation = json!({"mode": "NOTIFY_THEN_TERMINATE", "notifyPeriodInSeconds": GRACE});
    let action = |arguments: Vec<String>| -> Value {
        json!({"actions": {"onRun": {
            "command": job.gonio,
            "args": arguments,
            "cancelation": cancelation,
        }}})
    };
    let template = json!({
        "specificationVersion": "jobtemplate-2023-09",
        "name": job.name,
        "description": format!("{} parts, divided by samples, and their merge", job.parts),
        "steps": [
            {
                "name": "Render",
                "parameterSpace": {"taskParameterDefinitions": [
                    {"name": "Part", "type": "INT", "range": format!("0-{}", job.parts - 1)},
                ]},
                "hostRequirements": {"amounts": [
                    {"name": "amount.worker.vcpu", "min": job.cpus},
                ]},
                "script": action(render),
            },
            {
                "name": "Merge",
                "dependencies": [{"dependsOn": "Render"}],
                "script": action(job.merge()),
            },
        ],
    });
    let path = format!("{}/job.json", job.folder);
    (
        vec![("job.json", format!("{template:#}\n"))],
        format!("openjd run {path} --step Merge --run-dependencies, or the farm's own command"),
    )
}
