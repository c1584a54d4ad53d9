//! [`Spectra`], tables for each wavelength, which may be larger than memory.

use super::tables::check_finite;
use crate::measured::file::Fault;
use gonio_radiometry::colour::{RgbSpace, rgb_of_reflectance};
use gonio_radiometry::spectrum::{Illuminant, Spectrum};
use memmap2::Mmap;
use std::ops::Range;
use std::sync::Arc;

/// Tables over the unit square for each slice and wavelength.
#[derive(Debug, Clone)]
pub struct Spectra {
    /// Wavelengths, increasing, in nanometres.
    pub lambda_nm: Vec<f32>,
    /// Nodes along the first coordinate.
    pub width: usize,
    /// Nodes along the second coordinate.
    pub height: usize,
    /// Values, row by row, wavelength by wavelength, slice by slice.
    pub values: Values,
}

/// Single-precision numbers, in memory or in a mapped file.
#[derive(Debug, Clone)]
pub enum Values {
    /// In memory.
    Owned(Vec<f32>),
    /// The bytes of a mapped file, little-endian.
    Mapped(Arc<Mmap>, Range<usize>),
}

impl Values {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Owned(values) => values.len(),
            Self::Mapped(_, range) => range.len() / 4,
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The numbers from `at` on, `count` of them.
    ///
    /// # Panics
    /// If there are fewer.
    pub fn slice(&self, at: usize, count: usize) -> impl Iterator<Item = f32> {
        let (owned, bytes): (&[f32], &[[u8; 4]]) = match self {
            Self::Owned(values) => (&values[at..at + count], &[]),
            Self::Mapped(map, range) => {
                let bytes = &map[range.clone()];
                (&[], &bytes.as_chunks().0[at..at + count])
            }
        };
        let mapped = bytes.iter().map(|b| f32::from_le_bytes(*b));
        owned.iter().copied().chain(mapped)
    }

    /// Number `at`.
    ///
    /// # Panics
    /// If there are fewer.
    pub fn get(&self, at: usize) -> f32 {
        match self {
            Self::Owned(values) => values[at],
            Self::Mapped(map, range) => {
                let bytes = &map[range.clone()];
                f32::from_le_bytes(bytes.as_chunks().0[at])
            }
        }
    }
}

impl Spectra {
    /// Nodes of one table.
    pub(super) fn size(&self) -> usize {
        self.width * self.height
    }

    /// How many slices.
    pub(super) fn slices(&self) -> usize {
        self.values.len() / (self.lambda_nm.len() * self.size())
    }

    /// Everything but the values themselves, which [`Spectra::project`] goes through.
    pub(super) fn check(&self, slices: usize) -> Result<(), Fault> {
        let place = "field `wavelengths`";
        check_finite("wavelengths", &self.lambda_nm)?;
        match self.lambda_nm.first() {
            None => return Err(Fault::new(place, "no wavelength", "one or more")),
            Some(first) if *first <= 0.0 => {
                return Err(Fault::new(
                    place,
                    first,
                    "positive wavelengths in nanometres",
                ));
            }
            Some(_) => {}
        }
        if let Some(k) = self.lambda_nm.windows(2).position(|l| l[0] >= l[1]) {
            let found = format!("{} after {}", self.lambda_nm[k + 1], self.lambda_nm[k]);
            return Err(Fault::new(place, found, "increasing wavelengths"));
        }
        let expected = slices * self.lambda_nm.len() * self.size();
        if self.values.len() != expected {
            return Err(Fault::new(
                "field `spectra`",
                format!("{} values", self.values.len()),
                format!("{expected}"),
            ));
        }
        Ok(())
    }

    /// Linear RGB of every node, slice by slice, colour by colour, row by row; and how many spectral values are negative.
    ///
    /// The colour of a reflectance under D65 by the CIE 1931 observer, with the primaries and the white of sRGB: a perfect reflector
    /// is (1, 1, 1). Spectra are linear between their wavelengths and constant beyond them.
    pub(super) fn project(&self, slices: usize) -> Result<(Vec<f32>, u64), Fault> {
        let weights = self.weights();
        let size = self.size();
        let mut rgb = vec![0.0; slices * 3 * size];
        let mut negative = 0;
        let mut sums = vec![[0.0f64; 3]; size];
        for slice in 0..slices {
            sums.fill([0.0; 3]);
            for (k, weight) in weights.iter().enumerate() {
                let begin = (slice * weights.len() + k) * size;
                for (i, (sum, value)) in sums
                    .iter_mut()
                    .zip(self.values.slice(begin, size))
                    .enumerate()
                {
                    if !value.is_finite() {
                        return Err(Fault::new(
                            format!("field `spectra`, value {}", begin + i),
                            value,
                            "a finite number",
                        ));
                    }
                    negative += u64::from(value < 0.0);
                    for c in 0..3 {
                        sum[c] += weight[c] * f64::from(value);
                    }
                }
            }
            for (i, sum) in sums.iter().enumerate() {
                for c in 0..3 {
                    rgb[(slice * 3 + c) * size + i] = sum[c] as f32;
                }
            }
        }
        Ok((rgb, negative))
    }

    /// RGB of the reflectance that is 1 at one wavelength and 0 at the others, for each wavelength: colour is linear in it.
    fn weights(&self) -> Vec<[f64; 3]> {
        let lambda: Vec<f64> = self.lambda_nm.iter().map(|l| f64::from(*l)).collect();
        let light = Illuminant::D65.spectrum();
        let weight = |k: usize| {
            let mut values = vec![0.0; lambda.len()];
            values[k] = 1.0;
            let one = Spectrum::irregular(lambda.clone(), values)
                .expect("invariant: the wavelengths were checked");
            rgb_of_reflectance(&one, &light, &RgbSpace::SRGB)
        };
        (0..lambda.len()).map(weight).collect()
    }

    /// The wavelengths around `lambda_nm` and the weight of the longer one; constant beyond the ends.
    pub(super) fn around(&self, lambda_nm: f64) -> (usize, usize, f64) {
        let l = &self.lambda_nm;
        let high = l.partition_point(|l| f64::from(*l) <= lambda_nm);
        if high == 0 || high == l.len() {
            let k = high.min(l.len() - 1);
            return (k, k, 0.0);
        }
        let (a, b) = (f64::from(l[high - 1]), f64::from(l[high]));
        (high - 1, high, (lambda_nm - a) / (b - a))
    }
}
