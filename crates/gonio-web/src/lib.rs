//! Gonio in a browser: what a page asks of the library, as one function from JSON to JSON and arrays of numbers.
//!
//! This crate is floor 7. It holds bindings and no physics: each operation reads its request, calls the library, and puts what it gets
//! into arrays. `web/src/engine/protocol.ts` has the types of every operation, for the page; the modules here have the other side.
//!
//! Files are read from the file system, which in a browser is a folder in memory that the page fills.
//!
//! ```
//! let answer = gonio_web::call(r#"{"operation": "describe", "request": {"function": "ggx:roughness=0.3"}}"#);
//! assert!(answer.json().contains(r#""model":"torrance-sparrow""#));
//! let answer = gonio_web::call(r#"{"operation": "describe", "request": {"function": "gxx"}}"#);
//! assert!(answer.json().contains("did you mean `ggx`?"));
//! ```

mod answer;
#[cfg(target_family = "wasm")]
mod boundary;
mod catalogue;
mod checking;
mod complaint;
mod describe;
mod learn;
mod light;
mod picture;
mod plots;
mod subject;

pub use answer::Answer;

use complaint::Complaint;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

/// A request: which operation, and what of it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Call {
    operation: String,
    request: Value,
}

/// What an operation is given, as it reads it.
fn read<T: DeserializeOwned>(request: Value) -> Result<T, Complaint> {
    serde_json::from_value(request).map_err(|e| Complaint::new(format!("request: {e}")))
}

/// An operation that needs nothing.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Nothing {}

/// Answers one request, `{"operation": NAME, "request": {…}}`.
///
/// What can't be answered is an error in the answer: one sentence, and how to go on.
pub fn call(text: &str) -> Answer {
    answered(text).unwrap_or_else(|complaint| Answer::error(&complaint))
}

fn answered(text: &str) -> Result<Answer, Complaint> {
    let call: Call =
        serde_json::from_str(text).map_err(|e| Complaint::new(format!("request: {e}")))?;
    let request = call.request;
    match call.operation.as_str() {
        "catalogue" => read::<Nothing>(request).map(|_| catalogue::catalogue()),
        "describe" => describe::describe(read(request)?),
        "set" => describe::set(read(request)?),
        "forget" => read::<Nothing>(request).map(|_| subject::forget()),
        "evaluate" => plots::evaluate(read(request)?),
        "lobe" => plots::lobe(read(request)?),
        "curve" => plots::curve(read(request)?),
        "hemisphere" => plots::hemisphere(read(request)?),
        "slice" => plots::slice(read(request)?),
        "albedo" => plots::albedo(read(request)?),
        "ball" => plots::ball(read(request)?),
        "plot" => plots::plot(read(request)?),
        "render" => picture::render(read(request)?),
        "panorama" => light::panorama(read(request)?),
        "check" => checking::check(read(request)?),
        "export" => describe::export(read(request)?),
        "file" => describe::file(read(request)?),
        "learn" => learn::learn(read(request)?),
        other => Err(Complaint::new(format!("there is no operation `{other}`"))),
    }
}
