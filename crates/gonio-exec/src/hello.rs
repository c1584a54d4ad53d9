//! How a process introduces itself.

use crate::error::{Ask, Fault, Question, excerpt};
use crate::json::Colour;
use gonio_verify::{Expectation, Precision};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// The longest name, in characters.
const LONGEST_NAME: usize = 200;
/// The most parameters.
const MOST_PARAMETERS: usize = 256;

/// The form of questions and answers after the hello.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Batches {
    /// A line of JSON each.
    #[default]
    Json,
    /// A header of 12 bytes and little-endian numbers of 4 bytes.
    Float32,
    /// A header of 12 bytes and little-endian numbers of 8 bytes.
    Float64,
}

/// What a process says of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Hello {
    /// Its name in the report.
    pub name: String,
    /// Whether it answers `pdf`.
    pub pdf: bool,
    /// Whether it answers `sample`.
    pub sample: bool,
    /// Form of questions and answers.
    pub batches: Batches,
    /// What it declares.
    pub expectation: Expectation,
    /// The number format inside.
    pub precision: Precision,
    /// Set if it transmits: index of refraction of the side z < 0 over that of the side z > 0, each channel.
    pub relative_ior: Option<[f64; 3]>,
    /// Names and values for the report.
    pub parameters: BTreeMap<String, String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Said {
    id: u32,
    name: String,
    offers: Vec<String>,
    #[serde(default)]
    batches: Batches,
    #[serde(default = "yes")]
    reciprocal: bool,
    #[serde(default = "yes")]
    energy_conserving: bool,
    #[serde(default = "yes")]
    isotropic: bool,
    precision: Option<SaidPrecision>,
    relative_ior: Option<Colour>,
    #[serde(default)]
    parameters: BTreeMap<String, Value>,
}

#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum SaidPrecision {
    Single,
    Double,
}

fn yes() -> bool {
    true
}

impl Hello {
    /// Reads the line that answers the first question.
    ///
    /// # Errors
    /// [`Fault::Hello`], with what the line says.
    pub fn parse(line: &[u8]) -> Result<Self, Fault> {
        let wrong = |found: String, expected: String| Fault::Hello { found, expected };
        let said: Said = serde_json::from_slice(line).map_err(|e| {
            let (found, what) = (excerpt(line), "an object with `id`, `name` and `offers`");
            match e.is_data() {
                true => wrong(found, format!("{what} ({e})")),
                // Something else than an answer, such as a banner.
                false => Fault::NotAnAnswer {
                    question: Question {
                        id: 0,
                        ask: Ask::Hello,
                    },
                    found,
                    expected: format!("a line of JSON, {what} ({e})"),
                },
            }
        })?;
        if said.id != 0 {
            return Err(wrong(
                format!("`id` = {}", said.id),
                "the question's, 0".into(),
            ));
        }
        let name = said.name.trim().to_owned();
        let length = name.chars().count();
        if length == 0 || length > LONGEST_NAME || name.chars().any(char::is_control) {
            return Err(wrong(
                format!("`name` = {:?}", name.chars().take(40).collect::<String>()),
                format!("1 to {LONGEST_NAME} characters, none of them a control character"),
            ));
        }
        for offer in &said.offers {
            if !["eval", "pdf", "sample"].contains(&offer.as_str()) {
                let shown: String = offer.chars().take(40).collect();
                return Err(wrong(
                    format!("it offers {shown:?}"),
                    "`eval`, `pdf` and `sample`".into(),
                ));
            }
        }
        let offers = |what| said.offers.iter().any(|o| o == what);
        if !offers("eval") {
            return Err(wrong(
                "it doesn't offer `eval`".into(),
                "at least that: nothing can be checked without".into(),
            ));
        }
        let precision = match (said.precision, said.batches) {
            (Some(SaidPrecision::Double), Batches::Float32) => {
                return Err(wrong(
                    "`precision` = \"double\", with batches of `float32`".into(),
                    "batches of `float64` or `json`: others round what it computes".into(),
                ));
            }
            (Some(SaidPrecision::Single), _) | (None, Batches::Float32) => Precision::Single,
            _ => Precision::Double,
        };
        let relative_ior = said.relative_ior.map(|Colour(n)| n);
        if let Some(n) = relative_ior
            && !n.iter().all(|n| (0.01..=100.0).contains(n))
        {
            return Err(wrong(
                format!("`relative_ior` = {n:?}"),
                "0.01 to 100, or left out if nothing passes through".into(),
            ));
        }
        if said.parameters.len() > MOST_PARAMETERS {
            return Err(wrong(
                format!("{} parameters", said.parameters.len()),
                format!("at most {MOST_PARAMETERS}"),
            ));
        }
        let parameters = said
            .parameters
            .into_iter()
            .map(|(key, value)| (shown(&key), shown(&in_words(&value))))
            .collect();
        Ok(Self {
            name,
            pdf: offers("pdf"),
            sample: offers("sample"),
            batches: said.batches,
            expectation: Expectation {
                reciprocal: said.reciprocal,
                energy_conserving: said.energy_conserving,
                isotropic: said.isotropic,
            },
            precision,
            relative_ior,
            parameters,
        })
    }

    /// The name with its parameters, as descriptions of models are written: `mine:roughness=0.3`.
    pub fn description(&self) -> String {
        let pairs: Vec<String> = self
            .parameters
            .iter()
            .map(|(key, value)| format!("{key}={value}"))
            .collect();
        match pairs.is_empty() {
            true => self.name.clone(),
            false => format!("{}:{}", self.name, pairs.join(",")),
        }
    }
}

/// A parameter's value: words without quotes, a colour as `r/g/b`.
fn in_words(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(items) => items.iter().map(in_words).collect::<Vec<_>>().join("/"),
        other => other.to_string(),
    }
}

/// At most 100 characters, none of them a control character.
fn shown(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).take(100).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(line: &str) -> String {
        Hello::parse(line.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn the_least_that_a_hello_says() {
        let hello = Hello::parse(br#"{"id": 0, "name": "mine", "offers": ["eval"]}"#).unwrap();
        assert_eq!(
            hello,
            Hello {
                name: "mine".into(),
                pdf: false,
                sample: false,
                batches: Batches::Json,
                expectation: Expectation::PHYSICAL,
                precision: Precision::Double,
                relative_ior: None,
                parameters: BTreeMap::new(),
            }
        );
        assert_eq!(hello.description(), "mine");
    }

    #[test]
    fn all_that_a_hello_can_say() {
        let hello = Hello::parse(
            br#"{"id": 0, "name": "glass", "offers": ["eval", "pdf", "sample"], "batches": "float32",
            "reciprocal": false, "energy_conserving": false, "isotropic": false, "precision": "single",
            "relative_ior": [1.5, 1.51, 1.52], "parameters": {"roughness": 0.3, "metal": "gold", "tint": [1, 0.5, 0]}}"#,
        )
        .unwrap();
        assert!(hello.pdf && hello.sample && !hello.expectation.isotropic);
        assert_eq!(hello.precision, Precision::Single);
        assert_eq!(hello.relative_ior, Some([1.5, 1.51, 1.52]));
        assert_eq!(
            hello.description(),
            "glass:metal=gold,roughness=0.3,tint=1/0.5/0"
        );
    }

    #[test]
    fn float32_is_single_precision() {
        let line = |more: &str| {
            format!(r#"{{"id":0,"name":"m","offers":["eval"],"batches":"float32"{more}}}"#)
        };
        assert_eq!(
            Hello::parse(line("").as_bytes()).unwrap().precision,
            Precision::Single
        );
        assert!(refused(&line(r#","precision":"double""#)).contains("float32"));
    }

    #[test]
    fn bad_hellos_are_refused_by_name() {
        let with = |more: &str| format!(r#"{{"id": 0, "name": "m", "offers": ["eval"], {more}}}"#);
        for (line, word) in [
            ("".into(), "an empty line"),
            ("hello".into(), "`hello`"),
            ("[1]".into(), "`[1]`"),
            (r#"{"id": 0, "name": "m"}"#.into(), "missing field `offers`"),
            (
                r#"{"id": 1, "name": "m", "offers": ["eval"]}"#.into(),
                "`id` = 1",
            ),
            (
                r#"{"id": 0, "name": " ", "offers": ["eval"]}"#.into(),
                "`name`",
            ),
            (
                r#"{"id": 0, "name": "a\nb", "offers": ["eval"]}"#.into(),
                "control",
            ),
            (
                r#"{"id": 0, "name": "m", "offers": ["pdf"]}"#.into(),
                "doesn't offer `eval`",
            ),
            (
                r#"{"id": 0, "name": "m", "offers": ["eval", "evil"]}"#.into(),
                "\"evil\"",
            ),
            (with(r#""reciprocl": true"#), "unknown field `reciprocl`"),
            (
                with(r#""reciprocal": "yes""#),
                "invalid type: string \"yes\", expected a boolean",
            ),
            (with(r#""batches": "float16""#), "unknown variant `float16`"),
            (with(r#""precision": "half""#), "unknown variant `half`"),
            (with(r#""relative_ior": 0"#), "`relative_ior`"),
            (with(r#""relative_ior": [1, 2]"#), "three numbers or one"),
        ] {
            let message = refused(&line);
            assert!(message.contains(word), "{line}: {message}");
        }
        let long = format!(
            r#"{{"id":0,"name":"{}","offers":["eval"]}}"#,
            "x".repeat(500)
        );
        assert!(refused(&long).len() < 300);
    }
}
