//! Kubernetes: an indexed Job, and a Job that waits for its parts and merges them.

use super::{Files, Job, VOLUME, quoted};
use serde_json::{Value, json};

/// Times that a part may fail.
const RETRIES: u32 = 20;
/// Seconds that a part has for its checkpoint when its pod is evicted.
const GRACE: u32 = 120;

pub(super) fn files(job: &Job, container: &str, claim: &str) -> Files {
    let pod = |arguments: Vec<String>, cpus: u32| -> Value {
        json!({"spec": {
            "restartPolicy": "Never",
            "terminationGracePeriodSeconds": GRACE,
            "containers": [{
                "name": "gonio",
                "image": container,
                "command": [job.gonio],
                "args": arguments,
                "workingDir": VOLUME,
                "resources": {"requests": {"cpu": cpus.to_string()}},
                "volumeMounts": [{"name": "work", "mountPath": VOLUME}],
            }],
            "volumes": [{"name": "work", "persistentVolumeClaim": {"claimName": claim}}],
        }})
    };
    // What the arguments or the input are wrong for is wrong in every pod; an interruption or a machine that is lost is not.
    let hopeless = json!({"rules": [
        {"action": "FailJob", "onExitCodes": {"containerName": "gonio", "operator": "In", "values": [2, 3]}},
        {"action": "Ignore", "onPodConditions": [{"type": "DisruptionTarget", "status": "True"}]},
    ]});
    let parts = json!({
        "apiVersion": "batch/v1",
        "kind": "Job",
        "metadata": {"name": job.name},
        "spec": {
            "completionMode": "Indexed",
            "completions": job.parts,
            "parallelism": job.parts,
            "backoffLimitPerIndex": RETRIES,
            "podFailurePolicy": hopeless,
            "template": pod(job.render("auto", Some("json")), job.cpus),
        },
    });
    // Jobs know no dependencies: the merge waits for its files.
    let mut merge = job.merge();
    merge.push("--wait".into());
    let merge = json!({
        "apiVersion": "batch/v1",
        "kind": "Job",
        "metadata": {"name": format!("{}-merge", job.name)},
        "spec": {
            "backoffLimit": RETRIES,
            "podFailurePolicy": hopeless,
            "template": pod(merge, 1),
        },
    });
    let list = json!({"apiVersion": "v1", "kind": "List", "items": [parts, merge]});
    let path = quoted("job.json");
    (
        vec![("job.json", format!("{list:#}\n"))],
        format!("kubectl apply -f {path}, in the folder where it was written"),
    )
}
