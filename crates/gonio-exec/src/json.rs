//! Questions and answers as lines of JSON.

use crate::error::{Ask, Fault, Question, excerpt};
use gonio_num::Vec3;
use gonio_verify::SubjectSample;
use serde::de::{Deserializer, Error, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Bytes that a number and its separators may take in an answer.
const NUMBER_BYTES: usize = 48;
/// Bytes that everything else in an answer may take.
const FRAME_BYTES: usize = 4096;

/// The longest line that answers a question of `count` entries.
pub(crate) fn longest(ask: Ask, count: usize) -> usize {
    let numbers = match ask {
        // A hello has parameters.
        Ask::Hello => return 1 << 16,
        Ask::Eval => 3,
        Ask::Pdf => 1,
        Ask::Sample => 8,
    };
    FRAME_BYTES + NUMBER_BYTES * numbers * count
}

#[derive(Serialize)]
struct Asked<'a> {
    id: u32,
    ask: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    protocol: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    wi: Option<Vec<[f64; 3]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    wo: Option<Vec<[f64; 3]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    u: Option<&'a [[f64; 3]]>,
}

fn line(asked: &Asked) -> Vec<u8> {
    let mut line = serde_json::to_vec(asked).expect("invariant: numbers and words are always JSON");
    line.push(b'\n');
    line
}

fn rows(directions: &[Vec3<f64>]) -> Option<Vec<[f64; 3]>> {
    Some(directions.iter().map(|w| w.to_array()).collect())
}

/// The first question.
pub(crate) fn hello(protocol: u32) -> Vec<u8> {
    line(&Asked {
        id: 0,
        ask: Ask::Hello.name(),
        protocol: Some(protocol),
        wi: None,
        wo: None,
        u: None,
    })
}

/// A question about pairs of directions.
pub(crate) fn pairs(question: Question, wi: &[Vec3<f64>], wo: &[Vec3<f64>]) -> Vec<u8> {
    line(&Asked {
        id: question.id,
        ask: question.ask.name(),
        protocol: None,
        wi: rows(wi),
        wo: rows(wo),
        u: None,
    })
}

/// A question for samples.
pub(crate) fn draws(question: Question, wo: &[Vec3<f64>], u: &[[f64; 3]]) -> Vec<u8> {
    line(&Asked {
        id: question.id,
        ask: question.ask.name(),
        protocol: None,
        wi: None,
        wo: rows(wo),
        u: Some(u),
    })
}

/// A number as programs print them: JSON's, `null`, or the words NaN and Infinity (quoted by [`strict`]).
struct Number(f64);

/// Three numbers, or one that stands for all three.
pub(crate) struct Colour(pub [f64; 3]);

/// Three numbers, or `null`.
struct Row(Option<[f64; 3]>);

struct NumberVisitor;

impl Visitor<'_> for NumberVisitor {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number")
    }
    fn visit_f64<E: Error>(self, x: f64) -> Result<f64, E> {
        Ok(x)
    }
    fn visit_u64<E: Error>(self, x: u64) -> Result<f64, E> {
        Ok(x as f64)
    }
    fn visit_i64<E: Error>(self, x: i64) -> Result<f64, E> {
        Ok(x as f64)
    }
    fn visit_unit<E: Error>(self) -> Result<f64, E> {
        Ok(f64::NAN)
    }
    fn visit_str<E: Error>(self, text: &str) -> Result<f64, E> {
        match text {
            "NaN" => Ok(f64::NAN),
            "Infinity" => Ok(f64::INFINITY),
            "-Infinity" => Ok(f64::NEG_INFINITY),
            _ => Err(E::invalid_value(Unexpected::Str(text), &self)),
        }
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(NumberVisitor).map(Self)
    }
}

struct ColourVisitor;

impl<'de> Visitor<'de> for ColourVisitor {
    type Value = [f64; 3];

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("three numbers or one")
    }
    fn visit_f64<E: Error>(self, x: f64) -> Result<[f64; 3], E> {
        Ok([x; 3])
    }
    fn visit_u64<E: Error>(self, x: u64) -> Result<[f64; 3], E> {
        Ok([x as f64; 3])
    }
    fn visit_i64<E: Error>(self, x: i64) -> Result<[f64; 3], E> {
        Ok([x as f64; 3])
    }
    fn visit_unit<E: Error>(self) -> Result<[f64; 3], E> {
        Ok([f64::NAN; 3])
    }
    fn visit_str<E: Error>(self, text: &str) -> Result<[f64; 3], E> {
        NumberVisitor.visit_str(text).map(|x| [x; 3])
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<[f64; 3], A::Error> {
        let mut colour = [0.0; 3];
        for (k, c) in colour.iter_mut().enumerate() {
            let Some(Number(x)) = items.next_element()? else {
                return Err(A::Error::invalid_length(k, &self));
            };
            *c = x;
        }
        match items.next_element::<Number>()? {
            None => Ok(colour),
            Some(_) => Err(A::Error::invalid_length(4, &self)),
        }
    }
}

impl<'de> Deserialize<'de> for Colour {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(ColourVisitor).map(Self)
    }
}

impl<'de> Deserialize<'de> for Row {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        let row = Option::<[Number; 3]>::deserialize(d)?;
        Ok(Self(row.map(|row| row.map(|Number(x)| x))))
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Evaluated {
    id: u32,
    f: Vec<Colour>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Densities {
    id: u32,
    pdf: Vec<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Samples {
    id: u32,
    wi: Vec<Row>,
    weight: Vec<Colour>,
    pdf: Vec<Number>,
    delta: Option<Vec<bool>>,
}

/// The line with NaN and Infinity, which many programs print although JSON lacks them, in quotes.
fn strict(line: &str) -> std::borrow::Cow<'_, str> {
    if !line.contains("NaN") && !line.contains("Infinity") {
        return line.into();
    }
    let mut out = String::with_capacity(line.len() + 64);
    let (mut quoted, mut escaped) = (false, false);
    let mut rest = line;
    while let Some(c) = rest.chars().next() {
        if !quoted
            && let Some(word) = ["NaN", "Infinity", "-Infinity"]
                .into_iter()
                .find(|w| rest.starts_with(w))
        {
            out.push('"');
            out += word;
            out.push('"');
            rest = &rest[word.len()..];
            continue;
        }
        match c {
            '"' if !escaped => quoted = !quoted,
            _ => {}
        }
        escaped = quoted && c == '\\' && !escaped;
        out.push(c);
        rest = &rest[c.len_utf8()..];
    }
    out.into()
}

fn parse<T: serde::de::DeserializeOwned>(
    question: Question,
    line: &[u8],
    fields: &str,
) -> Result<T, Fault> {
    let wrong = |why: String| Fault::NotAnAnswer {
        question,
        found: excerpt(line),
        expected: format!("a line of JSON with {fields} ({why})"),
    };
    let text = std::str::from_utf8(line)
        .map_err(|e| wrong(format!("byte {} is no UTF-8", e.valid_up_to() + 1)))?;
    serde_json::from_str(&strict(text)).map_err(|e| wrong(e.to_string()))
}

fn same_id(question: Question, id: u32) -> Result<(), Fault> {
    if id == question.id {
        return Ok(());
    }
    Err(Fault::NotAnAnswer {
        question,
        found: format!("an answer with `id` = {id}"),
        expected: format!("the question's `id` = {}", question.id),
    })
}

pub(crate) fn same_length(
    question: Question,
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), Fault> {
    if found == expected {
        return Ok(());
    }
    Err(Fault::Length {
        question,
        what,
        found,
        expected,
    })
}

/// Reads the answer to `eval`.
pub(crate) fn evaluated(
    question: Question,
    line: &[u8],
    out: &mut [[f64; 3]],
) -> Result<(), Fault> {
    let answer: Evaluated = parse(question, line, "`id` and `f`")?;
    same_id(question, answer.id)?;
    same_length(question, "f", answer.f.len(), out.len())?;
    for (out, Colour(f)) in out.iter_mut().zip(answer.f) {
        *out = f;
    }
    Ok(())
}

/// Reads the answer to `pdf`.
pub(crate) fn densities(question: Question, line: &[u8], out: &mut [f64]) -> Result<(), Fault> {
    let answer: Densities = parse(question, line, "`id` and `pdf`")?;
    same_id(question, answer.id)?;
    same_length(question, "pdf", answer.pdf.len(), out.len())?;
    for (out, Number(p)) in out.iter_mut().zip(answer.pdf) {
        *out = p;
    }
    Ok(())
}

/// Reads the answer to `sample`.
pub(crate) fn samples(
    question: Question,
    line: &[u8],
    out: &mut [Option<SubjectSample>],
) -> Result<(), Fault> {
    let answer: Samples = parse(question, line, "`id`, `wi`, `weight` and `pdf`")?;
    same_id(question, answer.id)?;
    same_length(question, "wi", answer.wi.len(), out.len())?;
    same_length(question, "weight", answer.weight.len(), out.len())?;
    same_length(question, "pdf", answer.pdf.len(), out.len())?;
    if let Some(delta) = &answer.delta {
        same_length(question, "delta", delta.len(), out.len())?;
    }
    let drawn = answer.wi.into_iter().zip(answer.weight).zip(answer.pdf);
    for (k, (out, ((Row(wi), Colour(weight)), Number(pdf)))) in
        out.iter_mut().zip(drawn).enumerate()
    {
        *out = wi.map(|wi| SubjectSample {
            wi: wi.into(),
            weight,
            pdf,
            delta: answer.delta.as_ref().is_some_and(|delta| delta[k]),
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const EVAL: Question = Question {
        id: 7,
        ask: Ask::Eval,
    };
    const SAMPLE: Question = Question {
        id: 7,
        ask: Ask::Sample,
    };

    fn f(line: &str) -> Result<[[f64; 3]; 2], Fault> {
        let mut out = [[0.0; 3]; 2];
        evaluated(EVAL, line.as_bytes(), &mut out).map(|()| out)
    }

    #[test]
    fn questions_are_lines() {
        let up = Vec3::new(0.0, 0.0, 1.0);
        let text = String::from_utf8(pairs(EVAL, &[up], &[up])).unwrap();
        assert_eq!(
            text,
            "{\"id\":7,\"ask\":\"eval\",\"wi\":[[0.0,0.0,1.0]],\"wo\":[[0.0,0.0,1.0]]}\n"
        );
        let text = String::from_utf8(draws(SAMPLE, &[up], &[[0.5, 0.25, 0.0]])).unwrap();
        assert_eq!(
            text,
            "{\"id\":7,\"ask\":\"sample\",\"wo\":[[0.0,0.0,1.0]],\"u\":[[0.5,0.25,0.0]]}\n"
        );
        assert_eq!(hello(1), b"{\"id\":0,\"ask\":\"hello\",\"protocol\":1}\n");
    }

    #[test]
    fn colours_may_be_grey() {
        assert_eq!(
            f(r#"{"id": 7, "f": [[1, 2.5, -3], 4]}"#).unwrap(),
            [[1.0, 2.5, -3.0], [4.0; 3]]
        );
    }

    #[test]
    fn what_is_not_finite_is_an_answer() {
        let [a, b] = f(r#"{"id": 7, "f": [[NaN, Infinity, -Infinity], null]}"#).unwrap();
        assert!(a[0].is_nan() && a[1] == f64::INFINITY && a[2] == f64::NEG_INFINITY);
        assert!(b[0].is_nan());
        assert_eq!(
            strict(r#"{"a NaN \" NaN": NaN}"#),
            r#"{"a NaN \" NaN": "NaN"}"#
        );
    }

    #[test]
    fn samples_may_be_nothing() {
        let line = br#"{"id": 7, "wi": [[0, 0, 1], null, [0, 0.6, 0.8]], "weight": [1, 0, [1, 2, 3]], "pdf": [0.5, 0, 1],
            "delta": [false, false, true]}"#;
        let mut out = [None; 3];
        samples(SAMPLE, line, &mut out).unwrap();
        assert_eq!(out[0].unwrap().pdf, 0.5);
        assert!(!out[0].unwrap().delta);
        assert_eq!(out[1], None);
        let third = out[2].unwrap();
        assert!(third.delta && third.weight == [1.0, 2.0, 3.0] && third.wi.z == 0.8);
    }

    #[test]
    fn wrong_answers_are_named() {
        for (line, word) in [
            ("", "an empty line"),
            ("Warning: no GPU", "`Warning: no GPU`"),
            (r#"{"id": 7, "f": [1]}"#, "with 1 values of `f`, expected 2"),
            (
                r#"{"id": 7, "f": [1, 2, 3]}"#,
                "with 3 values of `f`, expected 2",
            ),
            (r#"{"id": 6, "f": [1, 2]}"#, "`id` = 6"),
            (r#"{"id": 7, "pdf": [1, 2]}"#, "unknown field `pdf`"),
            (r#"{"id": 7}"#, "missing field `f`"),
            (r#"{"f": [1, 2]}"#, "missing field `id`"),
            (r#"{"id": 7, "f": [1, "2"]}"#, "string \"2\""),
            (r#"{"id": 7, "f": [[1, 2], 1]}"#, "invalid length 2"),
            (r#"{"id": 7, "f": [[1, 2, 3, 4], 1]}"#, "invalid length 4"),
            (r#"{"id": 7, "f": [true, 1]}"#, "boolean"),
            (r#"{"id": 7, "f": [1, 2]} {"#, "trailing characters"),
        ] {
            let message = f(line).unwrap_err().to_string();
            assert!(message.contains(word), "{line}: {message}");
        }
        let message = evaluated(EVAL, b"{\"id\": 7, \"f\": [\xff]}", &mut [[0.0; 3]])
            .unwrap_err()
            .to_string();
        assert!(message.contains("byte 17 is no UTF-8"), "{message}");
    }

    proptest! {
        /// No line makes the reader panic, and a number survives being printed.
        #[test]
        fn any_line_is_an_answer_or_an_error(line in "\\PC{0,80}", x in any::<f64>()) {
            let _ = f(&line);
            prop_assume!(x.is_finite());
            let [a, b] = f(&format!(r#"{{"id": 7, "f": [{x:?}, [1, {x:?}, NaN]]}}"#)).unwrap();
            prop_assert_eq!(a[0].to_bits(), x.to_bits());
            prop_assert_eq!(b[1].to_bits(), x.to_bits());
        }
    }
}
