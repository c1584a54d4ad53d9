//! The laboratory's verdicts.

use crate::answer::Answer;
use crate::complaint::Complaint;
use crate::subject::Subject;
use gonio_verify::Effort;
use serde::Deserialize;
use serde_json::json;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Check {
    function: String,
    effort: String,
}

/// The report of `gonio brdf check --json`, with whether nothing failed.
pub(crate) fn check(of: Check) -> Result<Answer, Complaint> {
    let effort = match of.effort.as_str() {
        "quick" => Effort::Quick,
        "standard" => Effort::Standard,
        "thorough" => Effort::Thorough,
        other => {
            let message = format!("the effort is `{other}`, expected quick, standard or thorough");
            return Err(Complaint::new(message));
        }
    };
    let subject = Subject::open(&of.function)?;
    let report = gonio_brdf::check(&subject.spec, effort)?;
    let mut answer = json!(report);
    answer["passed"] = report.passed().into();
    Ok(Answer::new(answer, Vec::new()))
}
