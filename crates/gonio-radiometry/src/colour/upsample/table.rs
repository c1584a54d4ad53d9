//! [`RgbToSpectrum`]: a table of coefficients.

use super::{SigmoidPolynomial, Solver};
use crate::RadiometryError;
use crate::spectrum::read_limited;
use gonio_num::Real;
use std::path::Path;
use std::sync::LazyLock;

/// Coefficients of sigmoid polynomials over the RGB cube, interpolated.
///
/// The cube is cut into three pyramids by its largest component; within each the table is over that component (denser near 0
/// and 1) and the ratios of the other two to it. Source: Jakob and Hanika 2019, section 4; the layout is that of their files.
#[derive(Debug, Clone, PartialEq)]
pub struct RgbToSpectrum {
    resolution: usize,
    /// Values of the largest component, increasing from 0 to 1.
    scale: Vec<f32>,
    /// c₀, c₁, c₂ by [largest component][scale][ratio of the second after it][ratio of the first after it].
    data: Vec<f32>,
}

static SRGB: LazyLock<RgbToSpectrum> =
    LazyLock::new(|| RgbToSpectrum::new(Solver::srgb(), DEFAULT_RESOLUTION));

/// Largest table: 3 × 128³ × 3 coefficients, 75 MB.
const MAX_RESOLUTION: usize = 128;
const DEFAULT_RESOLUTION: usize = 32;
/// What may follow a table in its file \[bytes\].
const MAX_APPENDIX: u64 = 1 << 20;

/// Solves one pyramid, of the colours whose component `largest` is the largest, into `pyramid`.
fn solve_pyramid(solver: &Solver, largest: usize, scale: &[f64], pyramid: &mut [f32]) {
    let n = scale.len();
    let last = (n - 1) as f64;
    for j in 0..n {
        for i in 0..n {
            let rgb = |z: f64| {
                let mut c = [z; 3];
                c[(largest + 1) % 3] = z * i as f64 / last;
                c[(largest + 2) % 3] = z * j as f64 / last;
                c
            };
            let mut store = |k: usize, s: SigmoidPolynomial| {
                let at = 3 * ((k * n + j) * n + i);
                for (slot, c) in pyramid[at..at + 3].iter_mut().zip(s.coefficients) {
                    *slot = c as f32;
                }
            };
            let solve = |z: f64, from: SigmoidPolynomial| {
                // Black has no chroma: that of its neighbour, very dark.
                let c = rgb(z.max(1e-5));
                solver
                    .solve_from(c, from)
                    .unwrap_or_else(|| solver.solve(c).sigmoid)
            };
            // From a mid brightness to both ends, each from its neighbour.
            let middle = n / 3;
            let start = solver.solve(rgb(scale[middle])).sigmoid;
            store(middle, start);
            let mut s = start;
            for k in (0..middle).rev() {
                s = solve(scale[k], s);
                store(k, s);
            }
            s = start;
            for (k, &z) in scale.iter().enumerate().skip(middle + 1) {
                s = solve(z, s);
                store(k, s);
            }
        }
    }
}

impl RgbToSpectrum {
    /// Solves for a table of `resolution` steps an axis.
    ///
    /// # Panics
    /// If `resolution` isn't in 4 to 128.
    pub fn new(solver: &Solver, resolution: usize) -> Self {
        assert!(
            (4..=MAX_RESOLUTION).contains(&resolution),
            "the resolution of a table of spectra is {resolution}; expected 4 to {MAX_RESOLUTION}"
        );
        let last = (resolution - 1) as f64;
        let smooth = |x: f64| x * x * (3.0 - 2.0 * x);
        let scale: Vec<f64> = (0..resolution)
            .map(|k| smooth(smooth(k as f64 / last)))
            .collect();
        let mut data = vec![0.0; 9 * resolution * resolution * resolution];
        // Each cell is a function of its place alone: threads don't change a bit.
        std::thread::scope(|threads| {
            let size = data.len() / 3;
            for (largest, pyramid) in data.chunks_exact_mut(size).enumerate() {
                let scale = &scale;
                threads.spawn(move || solve_pyramid(solver, largest, scale, pyramid));
            }
        });
        Self {
            resolution,
            scale: scale.iter().map(|&z| z as f32).collect(),
            data,
        }
    }

    /// The table of sRGB under D65 with 32 steps an axis, made at first use in about half a second on three cores (release
    /// build).
    ///
    /// Its colours are 0.001 from the RGB on average, 0.004 at worst over most of the cube, and up to 0.02 next to white;
    /// [`Solver`] is for those who need better. A lookup takes about 85 ns.
    pub fn srgb() -> &'static Self {
        &SRGB
    }

    /// Steps an axis.
    pub fn resolution(&self) -> usize {
        self.resolution
    }

    /// The values of the largest component that the table has, increasing from 0 to 1.
    pub fn scale(&self) -> &[f32] {
        &self.scale
    }

    /// The reflectance of `rgb` (linear, in [0, 1]³; outside it is clamped, NaN is 0). Greys are exact.
    pub fn lookup(&self, rgb: [f64; 3]) -> SigmoidPolynomial {
        let rgb = rgb.map(Real::saturate);
        if rgb[0] == rgb[1] && rgb[1] == rgb[2] {
            return SigmoidPolynomial::grey(rgb[0]);
        }
        let mut largest = 0;
        for k in 1..3 {
            if rgb[k] > rgb[largest] {
                largest = k;
            }
        }
        let z = rgb[largest];
        let n = self.resolution;
        let last = (n - 1) as f64;
        let cell = |ratio: f64| {
            let x = ratio * last;
            let i = (x as usize).min(n - 2);
            (i, x - i as f64)
        };
        let (i, x) = cell(rgb[(largest + 1) % 3] / z);
        let (j, y) = cell(rgb[(largest + 2) % 3] / z);
        let k = self
            .scale
            .partition_point(|&s| f64::from(s) <= z)
            .clamp(1, n - 1)
            - 1;
        let (low, high) = (f64::from(self.scale[k]), f64::from(self.scale[k + 1]));
        let w = (z - low) / (high - low);
        let mut c = [0.0; 3];
        for (dk, wk) in [(0, 1.0 - w), (1, w)] {
            for (dj, wj) in [(0, 1.0 - y), (1, y)] {
                for (di, wi) in [(0, 1.0 - x), (1, x)] {
                    let at = 3 * (((largest * n + k + dk) * n + j + dj) * n + i + di);
                    for (sum, &value) in c.iter_mut().zip(&self.data[at..at + 3]) {
                        *sum += wk * wj * wi * f64::from(value);
                    }
                }
            }
        }
        SigmoidPolynomial::new(c)
    }

    /// Reads a table in the binary form of the paper's program: "SPEC", the resolution n as 32-bit integer, n scales and
    /// 9n³ coefficients as 32-bit floats, little-endian. What follows isn't read: some programs append the observer they used.
    ///
    /// # Errors
    /// [`RadiometryError::Read`] if the file can't be read; [`RadiometryError::CoefficientFile`] with the byte if it isn't such
    /// a table: wrong mark, a resolution outside 4 to 128, too few bytes, scales that don't increase from 0 to 1, or a
    /// number that isn't finite.
    pub fn read(path: &Path) -> Result<Self, RadiometryError> {
        let n = MAX_RESOLUTION as u64;
        let bytes = read_limited(path, 8 + 4 * (n + 9 * n * n * n) + MAX_APPENDIX)?;
        Self::from_bytes(&bytes, &path.display().to_string())
    }

    /// Reads a table from `bytes`; `file` is its name in errors. See [`RgbToSpectrum::read`].
    ///
    /// # Errors
    /// As [`RgbToSpectrum::read`].
    pub fn from_bytes(bytes: &[u8], file: &str) -> Result<Self, RadiometryError> {
        let error = |byte: usize, found: String, expected: &str| RadiometryError::CoefficientFile {
            file: file.to_owned(),
            byte: byte as u64,
            found,
            expected: expected.to_owned(),
        };
        if bytes.len() < 8 || &bytes[..4] != b"SPEC" {
            let found: String = bytes.iter().take(4).map(|b| format!("{b:02x} ")).collect();
            let found = format!("{} bytes that begin {found}", bytes.len());
            return Err(error(0, found, "the mark \"SPEC\" and a resolution"));
        }
        let resolution = u32::from_le_bytes([bytes[4], bytes[5], bytes[6], bytes[7]]) as usize;
        if !(4..=MAX_RESOLUTION).contains(&resolution) {
            return Err(error(4, format!("resolution {resolution}"), "4 to 128"));
        }
        let numbers = resolution + 9 * resolution * resolution * resolution;
        let length = 8 + 4 * numbers;
        if bytes.len() < length {
            let found = format!("{} bytes", bytes.len());
            let expected = format!("{length} bytes for resolution {resolution}");
            return Err(error(bytes.len(), found, &expected));
        }
        let values: Vec<f32> = bytes[8..length]
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            .collect();
        if let Some(i) = values.iter().position(|v| !v.is_finite()) {
            return Err(error(8 + 4 * i, values[i].to_string(), "a finite number"));
        }
        let (scale, data) = values.split_at(resolution);
        if scale[0] != 0.0 || scale[resolution - 1] != 1.0 {
            let found = format!("scales from {} to {}", scale[0], scale[resolution - 1]);
            return Err(error(8, found, "scales from 0 to 1"));
        }
        if let Some(i) = scale.windows(2).position(|s| s[0] >= s[1]) {
            let found = format!("the scale {} after {}", scale[i + 1], scale[i]);
            return Err(error(8 + 4 * (i + 1), found, "increasing scales"));
        }
        Ok(Self {
            resolution,
            scale: scale.to_vec(),
            data: data.to_vec(),
        })
    }

    /// The bytes that [`RgbToSpectrum::from_bytes`] reads.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = b"SPEC".to_vec();
        bytes.extend((self.resolution as u32).to_le_bytes());
        for v in self.scale.iter().chain(&self.data) {
            bytes.extend(v.to_le_bytes());
        }
        bytes
    }
}
