//! Reflectance of a film as thin as the wavelength: iridescence (Belcour & Barla 2017).

use super::super::colour::{cast, grey};
use crate::model::components;
use gonio_num::{Real, Work};
use std::f64::consts::{PI, TAU};

/// A film of a dielectric on a body, in air.
///
/// The light that is reflected back and forth in the film interferes with itself. With the amplitudes r12 at its outer face and r23 at the body's,
/// R = |r12|², T = 1 − R, z = −r12 r23 and the phase δ = 2π/λ · 2 n d cosθ2 of one passage, the reflectance of each polarisation is
///
/// C₀ + 2 Σ_m C_m Re(zᵐ e^(imδ)), C₀ = R + S, C_m = S − T, S = T² |r23|²/(1 − |z|²)
///
/// (Airy's sum as a Fourier series in δ). A colour is the mean of it over the wavelengths, weighted; for weights that are sums of
/// Gaussians in 1/λ the mean of e^(imδ) has a closed form. Four terms are kept, of which the first left out is below |z|⁵.
///
/// Source: Belcour & Barla 2017, "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence", eqs 8 to
/// 12; here with amplitudes instead of separate phases, and with weights of our own, so that a flat spectrum is neutral.
#[derive(Debug, Clone, Copy)]
pub struct ThinFilm<R: Real, const N: usize> {
    /// d in nm, [0, 5000].
    pub thickness_nm: R,
    /// Index of refraction n of the film, [1, 4].
    pub ior: R,
    /// Real part of the body's index.
    pub eta: [R; N],
    /// Imaginary part of the body's index, ≥ 0.
    pub k: [R; N],
}

/// Terms of the Fourier series.
const ORDERS: usize = 4;

/// Weights of wavelengths as sums of Gaussians in 1/λ: (share, mean in µm⁻¹, standard deviation in µm⁻¹), for each of the CIE 1931 matching
/// functions x̄, ȳ, z̄ times illuminant D65, normalised.
///
/// Fitted to their Fourier transforms up to an optical path of 8 µm by least squares; off by at most 0.009, 0.007 and 0.012.
const GAUSSIANS: [&[(f64, f64, f64)]; 3] = [
    &[
        (0.592_312, 1.652_907, 0.073_972),
        (0.217_446, 1.785_305, 0.070_064),
        (0.190_242, 2.225_383, 0.093_872),
    ],
    &[
        (0.261_059, 1.679_110, 0.084_609),
        (0.695_266, 1.834_238, 0.103_895),
        (0.043_676, 2.101_788, 0.095_752),
    ],
    &[
        (0.017_370, 1.948_294, 0.049_401),
        (0.982_630, 2.205_923, 0.104_795),
    ],
];

/// Linear RGB (Rec.709) from X, Y and Z each relative to illuminant D65: rows of the sRGB matrix times the white point, made to
/// sum to 1.
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.079_947, -1.537_133, -0.542_814],
    [-0.921_260, 1.876_013, 0.045_247],
    [0.052_888, -0.204_026, 1.151_138],
];

impl<R: Real, const N: usize> ThinFilm<R, N> {
    pub(super) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "film_thickness_nm" => self.thickness_nm = value[0],
            "film_ior" => self.ior = value[0],
            "ior" => self.eta = grey(value[0]),
            "eta" => self.eta = components(value),
            "k" => self.k = components(value),
            _ => {}
        }
    }

    pub(super) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> ThinFilm<S, N> {
        ThinFilm {
            thickness_nm: f(self.thickness_nm),
            ior: f(self.ior),
            eta: cast(self.eta, f),
            k: cast(self.k, f),
        }
    }

    /// Reflectance at the angle of cosine `cos` in air, linear RGB, limited to [0, 1]: saturated colours of a film lie outside the
    /// gamut. A fourth component and those after it repeat the third.
    #[inline(always)]
    pub(super) fn eval(&self, cos: R) -> [R; N] {
        components(R::out_of_line(Reflectance {
            thickness_nm: self.thickness_nm,
            n: self.ior,
            eta: first_three(self.eta),
            k: first_three(self.k),
            cos,
        }))
    }
}

#[inline(always)]
fn first_three<R: Real, const N: usize>(a: [R; N]) -> [R; 3] {
    [a[0], a[1.min(N - 1)], a[2.min(N - 1)]]
}

/// Linear RGB of a film at one angle.
struct Reflectance<R> {
    thickness_nm: R,
    n: R,
    eta: [R; 3],
    k: [R; 3],
    cos: R,
}

impl<R: Real> Work for Reflectance<R> {
    type Output = [R; 3];
    #[inline(always)]
    fn run(self) -> [R; 3] {
        let Self {
            thickness_nm,
            n,
            eta,
            k,
            cos,
        } = self;
        let cos2 = cos * cos;
        let cos_film = cos_inside(n, cos2);
        let path_um = n * thickness_nm * cos_film * R::lit(2e-3);
        let waves = waves(path_um);
        // Amplitudes at the outer face, of s and of p.
        let tiny = R::lit(1e-20);
        let outer = [
            (cos - n * cos_film) / (cos + n * cos_film).max(tiny),
            (n * cos - cos_film) / (n * cos + cos_film).max(tiny),
        ];
        let mut out = eta;
        for c in 0..3 {
            let inner = inner(n, cos_film, cos2, eta[c], k[c]);
            let mut sum = R::zero();
            for p in 0..2 {
                sum = sum + airy(outer[p], inner[p], &waves[c]);
            }
            out[c] = (sum * R::lit(0.5)).saturate();
        }
        out
    }
}

/// The mean of cos mδ and of sin mδ over the wavelengths, m = 1 … [`ORDERS`], for red, green and blue.
#[inline(always)]
fn waves<R: Real>(path_um: R) -> [[[R; 2]; ORDERS]; 3] {
    let mut out = [[[R::zero(); 2]; ORDERS]; 3];
    for m in 0..ORDERS {
        let path = path_um * R::lit((m + 1) as f64);
        let square = path * path;
        let mut xyz = [[R::zero(); 2]; 3];
        for (matching, gaussians) in GAUSSIANS.iter().enumerate() {
            for &(share, mean, deviation) in *gaussians {
                let decay = (square * R::lit(-2.0 * PI * PI * deviation * deviation)).exp();
                let (sin, cos) = (path * R::lit(TAU * mean)).sin_cos();
                let weight = decay * R::lit(share);
                xyz[matching][0] = xyz[matching][0] + weight * cos;
                xyz[matching][1] = xyz[matching][1] + weight * sin;
            }
        }
        for part in 0..2 {
            for c in 0..3 {
                let [x, y, z] = RGB_FROM_XYZ[c];
                out[c][m][part] =
                    R::lit(x) * xyz[0][part] + R::lit(y) * xyz[1][part] + R::lit(z) * xyz[2][part];
            }
        }
    }
    out
}

/// The cosine in a film of index `n`, for cos²θ in air: √(n² − sin²θ)/n, with all digits for n = 1 at grazing angles.
#[inline(always)]
fn cos_inside<R: Real>(n: R, cos2: R) -> R {
    ((n - R::one()) * (n + R::one()) + cos2).safe_sqrt() / n
}

/// The complex amplitudes (real, imaginary) of s and p reflected at the body, from a film of index `n` with the cosine `cos` in it, for cos²θ in air.
#[inline(always)]
fn inner<R: Real>(n: R, cos: R, cos2: R, eta: R, k: R) -> [[R; 2]; 2] {
    // a + ib = N₃ cosθ₃ = √(η² − k² − sin²θ + 2iηk), with sinθ that in air.
    let t = (eta - R::one()) * (eta + R::one()) - k * k + cos2;
    let modulus = (t * t + (eta * k).sq() * R::lit(4.0))
        .max(R::lit(1e-20))
        .sqrt();
    let a = ((modulus + t) * R::lit(0.5)).safe_sqrt();
    let b = ((modulus - t) * R::lit(0.5)).safe_sqrt();
    let c = n * cos;
    // s: (n c₂ − (a + ib))/(n c₂ + (a + ib)); p: (N² c₂ − n (a + ib))/(N² c₂ + n (a + ib)), N² = η² − k² + 2iηk.
    let (re, im) = ((eta * eta - k * k) * cos, R::lit(2.0) * eta * k * cos);
    [
        quotient([c - a, -b], [c + a, b]),
        quotient([re - n * a, im - n * b], [re + n * a, im + n * b]),
    ]
}

/// A complex quotient.
#[inline(always)]
fn quotient<R: Real>(x: [R; 2], y: [R; 2]) -> [R; 2] {
    let over = (y[0] * y[0] + y[1] * y[1]).max(R::lit(1e-20)).recip();
    [
        (x[0] * y[0] + x[1] * y[1]) * over,
        (x[1] * y[0] - x[0] * y[1]) * over,
    ]
}

/// The reflectance of one polarisation, from the amplitudes at both faces and the mean waves.
#[inline(always)]
fn airy<R: Real>(outer: R, inner: [R; 2], waves: &[[R; 2]; ORDERS]) -> R {
    let one = R::one();
    let r12 = outer * outer;
    let r23 = inner[0] * inner[0] + inner[1] * inner[1];
    let t = one - r12;
    let z = [-(outer * inner[0]), -(outer * inner[1])];
    let s = t * t * r23 / (one - r12 * r23).max(R::lit(1e-20));
    let mut power = z;
    let mut sum = r12 + s;
    for wave in waves {
        let real = power[0] * wave[0] - power[1] * wave[1];
        sum = sum + R::lit(2.0) * (s - t) * real;
        power = [
            power[0] * z[0] - power[1] * z[1],
            power[0] * z[1] + power[1] * z[0],
        ];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::super::{conductor, dielectric};
    use super::*;

    fn film(thickness_nm: f64, ior: f64, eta: f64, k: f64) -> ThinFilm<f64, 3> {
        ThinFilm {
            thickness_nm,
            ior,
            eta: [eta; 3],
            k: [k; 3],
        }
    }

    /// |r|² of one wavelength by Airy's formula, s and p averaged.
    fn exact(film: &ThinFilm<f64, 3>, cos: f64, lambda_um: f64) -> f64 {
        let n = film.ior;
        let cos2 = cos * cos;
        let cos_film = cos_inside(n, cos2);
        let delta = TAU / lambda_um * 2e-3 * n * film.thickness_nm * cos_film;
        let outer = [
            (cos - n * cos_film) / (cos + n * cos_film),
            (n * cos - cos_film) / (n * cos + cos_film),
        ];
        let inner = inner(n, cos_film, cos2, film.eta[0], film.k[0]);
        let (sin_d, cos_d) = delta.sin_cos();
        (0..2)
            .map(|p| {
                let [x, y] = inner[p];
                let turned = [x * cos_d - y * sin_d, x * sin_d + y * cos_d];
                let r = outer[p];
                let up = [r + turned[0], turned[1]];
                let down = [1.0 + r * turned[0], r * turned[1]];
                let [re, im] = quotient(up, down);
                0.5 * (re * re + im * im)
            })
            .sum()
    }

    #[test]
    fn no_film_is_the_body_and_no_contrast_is_no_film() {
        for cos in [0.05, 0.3, 0.7, 1.0] {
            // A film of the index of air, however thick.
            let [r, ..] = film(400.0, 1.0, 0.2, 3.9).eval(cos);
            assert!((r - conductor(cos, 0.2, 3.9)).abs() < 1e-12);
            let [r, ..] = film(400.0, 1.0, 1.5, 0.0).eval(cos);
            assert!((r - dielectric(cos, 1.5)).abs() < 1e-12);
            // A film of the body's own index.
            let [r, ..] = film(400.0, 1.5, 1.5, 0.0).eval(cos);
            assert!((r - dielectric(cos, 1.5)).abs() < 1e-12);
            // No thickness; what is left out of the series is below 2 |z|⁵, |z| < 0.21 here.
            let [r, ..] = film(0.0, 1.4, 1.6, 0.0).eval(cos.max(0.3));
            assert!((r - dielectric(cos.max(0.3), 1.6)).abs() < 1e-3);
        }
    }

    /// The series at one wavelength is Airy's formula: a "wave" that isn't averaged.
    #[test]
    fn the_series_is_airys_formula() {
        for (d, n, eta, k) in [
            (300.0, 1.33, 1.5, 0.0),
            (120.0, 1.5, 0.2, 3.4),
            (550.0, 1.3, 2.0, 1.0),
        ] {
            let film = film(d, n, eta, k);
            for cos in [0.4, 0.8, 1.0] {
                for lambda_um in [0.45, 0.6] {
                    let cos2: f64 = cos * cos;
                    let cos_film = cos_inside(n, cos2);
                    let delta = TAU / lambda_um * 2e-3 * n * d * cos_film;
                    let waves: [[f64; 2]; ORDERS] = std::array::from_fn(|m| {
                        let (sin, cos) = ((m + 1) as f64 * delta).sin_cos();
                        [cos, sin]
                    });
                    let inner = inner(n, cos_film, cos2, eta, k);
                    let outer = [
                        (cos - n * cos_film) / (cos + n * cos_film),
                        (n * cos - cos_film) / (n * cos + cos_film),
                    ];
                    let series =
                        0.5 * (airy(outer[0], inner[0], &waves) + airy(outer[1], inner[1], &waves));
                    // |z|⁵ with |z| ≤ 0.27 · 0.95 for the steepest of these.
                    assert!((series - exact(&film, cos, lambda_um)).abs() < 3e-3);
                }
            }
        }
    }

    /// Colours against the integral over wavelengths with the weights themselves, as far as the Gaussians carry.
    #[test]
    fn colours_are_means_over_the_wavelengths() {
        for (d, n, eta, k) in [(300.0, 1.33, 1.5, 0.0), (550.0, 1.5, 0.2, 3.4)] {
            let film = film(d, n, eta, k);
            for cos in [0.5, 1.0] {
                let mut xyz = [0.0; 3];
                for (sum, gaussians) in xyz.iter_mut().zip(GAUSSIANS) {
                    for &(share, mean, deviation) in gaussians {
                        let steps = 400;
                        for i in 0..steps {
                            let x = (f64::from(i) + 0.5) / f64::from(steps) * 12.0 - 6.0;
                            let weight =
                                (-0.5 * x * x).exp() / TAU.sqrt() * 12.0 / f64::from(steps);
                            *sum +=
                                share * weight * exact(&film, cos, 1.0 / (mean + deviation * x));
                        }
                    }
                }
                let found = film.eval(cos);
                for (c, row) in RGB_FROM_XYZ.iter().enumerate() {
                    let expected: f64 = row.iter().zip(xyz).map(|(m, x)| m * x).sum();
                    assert!(
                        (found[c] - expected.clamp(0.0, 1.0)).abs() < 5e-3,
                        "{c} {found:?} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn white_is_neutral() {
        for row in RGB_FROM_XYZ {
            assert!((row.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
        for gaussians in GAUSSIANS {
            let sum: f64 = gaussians.iter().map(|g| g.0).sum();
            assert!((sum - 1.0).abs() < 2e-6);
        }
    }
}
