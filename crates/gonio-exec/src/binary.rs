//! Questions and answers as little-endian numbers behind a header of 12 bytes.
//!
//! Header: four letters (`eval`, `pdf ` or `samp`), the number of entries and the question's number, each 4 bytes. The answer
//! begins with the same 12 bytes. Rows of numbers follow: of an answer to `samp` 8 each (wi, weight, pdf, and whether it is a
//! Dirac delta's: 0 or 1).

use crate::error::{Ask, Fault, Question, excerpt};
use crate::hello::Batches;
use gonio_num::Vec3;
use gonio_verify::SubjectSample;

/// Bytes of the header.
pub(crate) const HEADER: usize = 12;

/// Size of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Width {
    Four,
    Eight,
}

impl Width {
    /// `None`: batches are lines of JSON.
    pub(crate) fn of(batches: Batches) -> Option<Self> {
        match batches {
            Batches::Json => None,
            Batches::Float32 => Some(Self::Four),
            Batches::Float64 => Some(Self::Eight),
        }
    }

    fn bytes(self) -> usize {
        match self {
            Self::Four => 4,
            Self::Eight => 8,
        }
    }

    fn put(self, out: &mut Vec<u8>, numbers: impl IntoIterator<Item = f64>) {
        for x in numbers {
            match self {
                Self::Four => out.extend((x as f32).to_le_bytes()),
                Self::Eight => out.extend(x.to_le_bytes()),
            }
        }
    }

    fn numbers(self, bytes: &[u8]) -> impl Iterator<Item = f64> {
        bytes.chunks_exact(self.bytes()).map(|b| match *b {
            [a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
            [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
            _ => f64::NAN,
        })
    }
}

fn letters(ask: Ask) -> [u8; 4] {
    match ask {
        Ask::Hello => *b"helo",
        Ask::Eval => *b"eval",
        Ask::Pdf => *b"pdf ",
        Ask::Sample => *b"samp",
    }
}

/// Numbers in a row of an answer.
fn row(ask: Ask) -> usize {
    match ask {
        Ask::Hello => 0,
        Ask::Eval => 3,
        Ask::Pdf => 1,
        Ask::Sample => 8,
    }
}

fn header(question: Question, count: usize) -> Vec<u8> {
    let count = u32::try_from(count).expect("invariant: batches are short");
    let mut out = letters(question.ask).to_vec();
    out.extend(count.to_le_bytes());
    out.extend(question.id.to_le_bytes());
    out
}

/// Bytes of an answer.
pub(crate) fn length(question: Question, count: usize, width: Width) -> usize {
    HEADER + row(question.ask) * count * width.bytes()
}

/// A question about pairs of directions.
pub(crate) fn pairs(
    question: Question,
    wi: &[Vec3<f64>],
    wo: &[Vec3<f64>],
    width: Width,
) -> Vec<u8> {
    let mut out = header(question, wi.len());
    width.put(&mut out, wi.iter().flat_map(|w| w.to_array()));
    width.put(&mut out, wo.iter().flat_map(|w| w.to_array()));
    out
}

/// A question for samples.
pub(crate) fn draws(question: Question, wo: &[Vec3<f64>], u: &[[f64; 3]], width: Width) -> Vec<u8> {
    let mut out = header(question, wo.len());
    width.put(&mut out, wo.iter().flat_map(|w| w.to_array()));
    // The largest number of f32 below 1: rounding must not make a 1 of it.
    let below_1 = f64::from(1.0_f32 - f32::EPSILON / 2.0);
    let most = if width == Width::Four { below_1 } else { 1.0 };
    width.put(&mut out, u.iter().flatten().map(|x| x.min(most)));
    out
}

/// Checks the first 12 bytes of an answer, or as many as came.
pub(crate) fn check_header(question: Question, count: usize, bytes: &[u8]) -> Result<(), Fault> {
    let expected = header(question, count);
    let n = bytes.len().min(HEADER);
    if bytes[..n] == expected[..n] {
        return Ok(());
    }
    if n == HEADER && bytes[..4] == expected[..4] && bytes[8..12] == expected[8..12] {
        let found = u32::from_le_bytes([bytes[4], bytes[5], bytes[6], bytes[7]]) as usize;
        return Err(Fault::Length {
            question,
            what: "rows",
            found,
            expected: count,
        });
    }
    let hex: Vec<String> = expected.iter().map(|b| format!("{b:02x}")).collect();
    Err(Fault::NotAnAnswer {
        question,
        found: excerpt(bytes),
        expected: format!("the question's own first 12 bytes, {}", hex.join(" ")),
    })
}

/// Reads the answer to `eval`; `bytes` has the right length.
pub(crate) fn evaluated(bytes: &[u8], width: Width, out: &mut [[f64; 3]]) {
    let mut numbers = width.numbers(&bytes[HEADER..]);
    for (out, x) in out.iter_mut().flatten().zip(&mut numbers) {
        *out = x;
    }
}

/// Reads the answer to `pdf`; `bytes` has the right length.
pub(crate) fn densities(bytes: &[u8], width: Width, out: &mut [f64]) {
    for (out, x) in out.iter_mut().zip(width.numbers(&bytes[HEADER..])) {
        *out = x;
    }
}

/// Reads the answer to `samp`; `bytes` has the right length.
pub(crate) fn samples(
    question: Question,
    bytes: &[u8],
    width: Width,
    out: &mut [Option<SubjectSample>],
) -> Result<(), Fault> {
    let mut numbers = width.numbers(&bytes[HEADER..]);
    for out in out {
        let mut r = [0.0; 8];
        for (r, x) in r.iter_mut().zip(&mut numbers) {
            *r = x;
        }
        let [x, y, z, red, green, blue, pdf, delta] = r;
        if delta != 0.0 && delta != 1.0 {
            return Err(Fault::NotAnAnswer {
                question,
                found: format!("{delta} in the eighth column"),
                expected: "0, or 1 for a Dirac delta".into(),
            });
        }
        *out = (pdf != 0.0).then_some(SubjectSample {
            wi: Vec3::new(x, y, z),
            weight: [red, green, blue],
            pdf,
            delta: delta == 1.0,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const EVAL: Question = Question {
        id: 258,
        ask: Ask::Eval,
    };

    #[test]
    fn a_question_is_a_header_and_numbers() {
        let (a, b) = (Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 0.0, -2.0));
        let bytes = pairs(EVAL, &[a], &[b], Width::Four);
        assert_eq!(bytes[..12], *b"eval\x01\0\0\0\x02\x01\0\0");
        let numbers: Vec<f64> = Width::Four.numbers(&bytes[12..]).collect();
        assert_eq!(numbers, [1.0, 0.0, 0.0, 0.0, 0.0, -2.0]);
        assert_eq!(pairs(EVAL, &[a], &[b], Width::Eight).len(), 12 + 48);
        assert_eq!(length(EVAL, 1, Width::Eight), 12 + 24);
    }

    #[test]
    fn random_numbers_stay_below_1_in_single_precision() {
        let question = Question {
            id: 1,
            ask: Ask::Sample,
        };
        let up = [Vec3::new(0.0, 0.0, 1.0)];
        let bytes = draws(question, &up, &[[1.0 - 1e-12, 0.5, 0.0]], Width::Four);
        let numbers: Vec<f64> = Width::Four.numbers(&bytes[24..]).collect();
        assert!(numbers[0] < 1.0 && numbers[0] > 0.999_999_9);
        assert_eq!(numbers[1..], [0.5, 0.0]);
    }

    #[test]
    fn headers_are_compared_as_they_come() {
        let good = header(EVAL, 5);
        for n in 0..=good.len() {
            assert!(check_header(EVAL, 5, &good[..n]).is_ok());
        }
        let short = check_header(EVAL, 5, &header(EVAL, 4)).unwrap_err();
        assert!(matches!(
            short,
            Fault::Length {
                found: 4,
                expected: 5,
                ..
            }
        ));
        let early = Question { id: 257, ..EVAL };
        for bytes in [
            header(early, 5),
            b"Warning: no GPU".to_vec(),
            b"ev?".to_vec(),
        ] {
            let message = check_header(EVAL, 5, &bytes).unwrap_err().to_string();
            assert!(
                message.contains("65 76 61 6c 05 00 00 00 02 01 00 00"),
                "{message}"
            );
        }
    }

    #[test]
    fn deltas_are_marked_by_1() {
        let question = Question {
            id: 1,
            ask: Ask::Sample,
        };
        let answer = |delta: f64, pdf: f64| {
            let mut bytes = header(question, 1);
            Width::Eight.put(&mut bytes, [0.0, 0.0, 1.0, 0.5, 0.6, 0.7, pdf, delta]);
            let mut out = [None];
            samples(question, &bytes, Width::Eight, &mut out).map(|()| out[0])
        };
        let s = answer(1.0, 0.25).unwrap().unwrap();
        assert!(s.delta && s.weight == [0.5, 0.6, 0.7] && s.pdf == 0.25);
        assert_eq!(answer(0.0, 0.0).unwrap(), None);
        assert!(answer(0.0, f64::NAN).unwrap().unwrap().pdf.is_nan());
        assert!(answer(0.5, 1.0).is_err() && answer(f64::NAN, 1.0).is_err());
    }

    proptest! {
        #[test]
        fn numbers_survive(values in proptest::collection::vec(any::<[f64; 3]>(), 1..20)) {
            let mut bytes = header(EVAL, values.len());
            Width::Eight.put(&mut bytes, values.iter().flatten().copied());
            prop_assert_eq!(bytes.len(), length(EVAL, values.len(), Width::Eight));
            let mut out = vec![[0.0; 3]; values.len()];
            evaluated(&bytes, Width::Eight, &mut out);
            for (a, b) in out.iter().flatten().zip(values.iter().flatten()) {
                prop_assert_eq!(a.to_bits(), b.to_bits());
            }
        }
    }
}
