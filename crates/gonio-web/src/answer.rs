//! [`Answer`], what is given back: JSON, and arrays of numbers that would be slow as text.

use crate::complaint::Complaint;
use serde::Serialize;
use serde_json::json;

/// JSON and arrays of 32-bit numbers.
#[derive(Debug, Clone)]
pub struct Answer {
    json: String,
    numbers: Vec<f32>,
}

/// An array by name: numbers in any shape, one after the other.
pub(crate) type Array = (&'static str, Vec<f32>);

impl Answer {
    /// `{"answer": …, "arrays": {NAME: [first, count]}}`, the places counted in numbers.
    pub(crate) fn new(answer: impl Serialize, arrays: Vec<Array>) -> Self {
        let mut numbers = Vec::with_capacity(arrays.iter().map(|a| a.1.len()).sum());
        let mut places = serde_json::Map::new();
        for (name, array) in arrays {
            places.insert(name.into(), json!([numbers.len(), array.len()]));
            numbers.extend(array);
        }
        Self {
            json: json!({ "answer": answer, "arrays": places }).to_string(),
            numbers,
        }
    }

    /// `{"error": …}`.
    pub(crate) fn error(complaint: &Complaint) -> Self {
        Self {
            json: json!({ "error": complaint }).to_string(),
            numbers: Vec::new(),
        }
    }

    /// The JSON.
    pub fn json(&self) -> &str {
        &self.json
    }

    /// The numbers of all arrays.
    pub fn numbers(&self) -> &[f32] {
        &self.numbers
    }

    /// As a page gets it: the lengths in bytes of all and of the JSON, each as a little-endian `u32`; the JSON; zeros up to a multiple of
    /// four; the numbers, little-endian.
    pub fn into_bytes(self) -> Vec<u8> {
        let text = self.json.len().next_multiple_of(4);
        let total = 8 + text + 4 * self.numbers.len();
        let mut bytes = Vec::with_capacity(total);
        for length in [total, self.json.len()] {
            bytes.extend((length as u32).to_le_bytes());
        }
        bytes.extend(self.json.as_bytes());
        bytes.resize(8 + text, 0);
        for x in &self.numbers {
            bytes.extend(x.to_le_bytes());
        }
        bytes
    }
}

/// Colours one after the other.
pub(crate) fn colours(values: impl IntoIterator<Item = [f64; 3]>) -> Vec<f32> {
    values.into_iter().flatten().map(|x| x as f32).collect()
}

/// The largest finite value of each channel, 0 at least.
pub(crate) fn largest<'a>(values: impl IntoIterator<Item = &'a [f64; 3]>) -> [f64; 3] {
    let mut largest = [0.0_f64; 3];
    for value in values {
        for (most, x) in largest.iter_mut().zip(value) {
            if x.is_finite() {
                *most = most.max(*x);
            }
        }
    }
    largest
}
