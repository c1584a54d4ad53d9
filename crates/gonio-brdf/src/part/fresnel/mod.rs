//! Fresnel reflectance of unpolarised light (T17).

mod description;
mod thin_film;

pub(crate) use description::{ETA, F0, F82, FILM_IOR, FILM_THICKNESS, IOR, K, METAL, parameter};
pub use thin_film::ThinFilm;

use super::colour::{cast, each_component, grey};
use super::special::GAUSS_LEGENDRE_16;
use gonio_num::Real;

/// Schlick's approximation: F = F₀ + (F₉₀ − F₀)(1 − cosθ)⁵.
///
/// - `cos`: cosine of the angle to the (micro)facet's normal, [0, 1]
/// - `f0`, `f90`: reflectance at normal and at grazing incidence, [0, 1]; Schlick has F₉₀ = 1
///
/// Source: Schlick 1994, "An Inexpensive BRDF Model for Physically-based Rendering", eq. 15.
#[inline(always)]
pub fn schlick<R: Real>(cos: R, f0: R, f90: R) -> R {
    f0 + (f90 - f0) * (R::one() - cos).saturate().pow5()
}

/// Reflectance of a smooth boundary between two dielectrics: F = (r∥² + r⊥²)/2.
///
/// - `cos`: cosine of the angle of incidence, [0, 1]
/// - `ior`: relative index of refraction, of the far side over the near side, > 0
///
/// 1 at grazing incidence and beyond the critical angle (`ior` < 1). Source: Born & Wolf, Principles of Optics, §1.5.2.
#[inline(always)]
pub fn dielectric<R: Real>(cos: R, ior: R) -> R {
    let tiny = R::lit(1e-20);
    // η cosθt from η² − 1, which keeps its digits at grazing angles, where 1 − sin²θ/η² loses them.
    let n2 = ior * ior;
    let g2 = (ior - R::one()) * (ior + R::one()) + cos * cos;
    let total = g2.le(R::zero());
    let g = g2.max(tiny).sqrt();
    let f = both_polarisations([cos - g, cos + g], [n2 * cos - g, n2 * cos + g]);
    R::select(total, R::one(), f)
}

/// (r⊥² + r∥²)/2 of two quotients, with one division.
#[inline(always)]
fn both_polarisations<R: Real>(s: [R; 2], p: [R; 2]) -> R {
    let below = (s[1] * p[1]).sq().max(R::lit(1e-30));
    ((s[0] * p[1]).sq() + (p[0] * s[1]).sq()) * R::lit(0.5) / below
}

/// [`dielectric`] from the cosines on both sides, which must obey Snell's law: the same to the last bit from either side.
///
/// - `outer`, `inner`: cosines of the angles of incidence and refraction, [0, 1]
/// - `ior`: index of the inner side over that of the outer
#[inline(always)]
pub fn dielectric_cosines<R: Real>(outer: R, inner: R, ior: R) -> R {
    let s = [outer - ior * inner, outer + ior * inner];
    both_polarisations(s, [ior * outer - inner, ior * outer + inner])
}

/// Reflectance of a smooth boundary between vacuum and an absorbing medium of index η + ik.
///
/// - `cos`: cosine of the angle of incidence, [0, 1]
/// - `eta` > 0, `k` ≥ 0: real and imaginary part of the index
///
/// 1 at grazing incidence. With k = 0 it is [`dielectric`] for η ≥ 1.
/// Source: Born & Wolf, Principles of Optics, §14.4.1.
#[inline(always)]
pub fn conductor<R: Real>(cos: R, eta: R, k: R) -> R {
    let [t1, t2, t3, t4] = conductor_terms(cos, eta, k);
    // r⊥² = (t1 − t2)/(t1 + t2) and r∥² = r⊥² (t3 − t4)/(t3 + t4): their mean with one division.
    (t1 - t2) * t3 / ((t1 + t2) * (t3 + t4)).max(R::lit(1e-30))
}

/// [`conductor`] for light that is polarised: r⊥², across the plane of incidence (s), and r∥², in it (p).
#[inline(always)]
pub fn conductor_polarised<R: Real>(cos: R, eta: R, k: R) -> [R; 2] {
    let [t1, t2, t3, t4] = conductor_terms(cos, eta, k);
    let across = (t1 - t2) / (t1 + t2).max(R::lit(1e-30));
    [across, across * (t3 - t4) / (t3 + t4).max(R::lit(1e-30))]
}

/// The terms t₁ to t₄ with r⊥² = (t₁ − t₂)/(t₁ + t₂), r∥² = r⊥² (t₃ − t₄)/(t₃ + t₄).
#[inline(always)]
fn conductor_terms<R: Real>(cos: R, eta: R, k: R) -> [R; 4] {
    let tiny = R::lit(1e-20);
    let cos2 = cos * cos;
    let sin2 = (R::one() - cos2).max(R::zero());
    let t0 = eta * eta - k * k - sin2;
    // a² + b², where a + ib = √(η² − k² − sin² + 2iηk).
    let a2b2 = (t0 * t0 + (eta * k).sq() * R::lit(4.0)).max(tiny).sqrt();
    // The larger of a and b; the other one is ηk over it, which keeps its digits where η ≪ k. So a = p/q:
    let larger = ((a2b2 + t0.abs()) * R::lit(0.5)).max(tiny).sqrt();
    let b_larger = t0.lt(R::zero());
    let p = R::select(b_larger, eta * k, larger);
    let q = R::select(b_larger, larger, R::one());
    let t1 = (a2b2 + cos2) * q;
    let t2 = R::lit(2.0) * p * cos;
    let t3 = (cos2 * a2b2 + sin2 * sin2) * q;
    let t4 = t2 * sin2;
    [t1, t2, t3, t4]
}

/// Schlick's approximation with the reflectance near 82° (cosθ = 1/7) multiplied by a tint:
///
/// F = F₀ + (1 − F₀)(1 − cosθ)⁵ − b cosθ (1 − cosθ)⁶, b = (1 − t) S(1/7)/((1/7)(6/7)⁶), S Schlick's
///
/// - `cos`: cosine of the angle to the (micro)facet's normal, [0, 1]
/// - `f0`: reflectance at normal incidence, [0, 1]
/// - `tint`: t, [0, 1]; 1 is Schlick's
///
/// Where a small F₀ meets a dark tint the polynomial dips below 0 between 82° and the normal: there it is 0.
/// Source: Kutz, Hašan & Edmondson 2021, "Novel Aspects of the Adobe Standard Material", §2.3; Hoffman 2019, "Fresnel Equations
/// Considered Harmful"; OpenPBR 1.1, eq. 41.
#[inline(always)]
pub fn f82_tint<R: Real>(cos: R, f0: R, tint: R) -> R {
    let left = (R::one() - cos).saturate();
    let b = f82_strength(f0, tint);
    let f = schlick(cos, f0, R::one()) - b * cos * left.pow5() * left;
    f.max(R::zero())
}

/// b of [`f82_tint`].
#[inline(always)]
fn f82_strength<R: Real>(f0: R, tint: R) -> R {
    const AT: f64 = 1.0 / 7.0;
    const SIXTH: f64 = 46_656.0 / 117_649.0; // (6/7)⁶
    let s = schlick(R::lit(AT), f0, R::one());
    s * (R::one() - tint) * R::lit(1.0 / (AT * SIXTH))
}

/// One of the reflectances above, with its constants.
#[derive(Debug, Clone, Copy)]
pub enum Fresnel<R: Real, const N: usize> {
    /// 1 at every angle.
    None,
    /// [`schlick`] with F₉₀ = 1.
    Schlick {
        /// Reflectance at normal incidence.
        f0: [R; N],
    },
    /// [`f82_tint`].
    F82Tint {
        /// Reflectance at normal incidence.
        f0: [R; N],
        /// Factor on Schlick's reflectance at cosθ = 1/7.
        tint: [R; N],
    },
    /// [`dielectric`].
    Dielectric {
        /// Relative index of refraction.
        ior: R,
    },
    /// [`conductor`].
    Conductor {
        /// Real part of the index.
        eta: [R; N],
        /// Imaginary part of the index.
        k: [R; N],
    },
    /// [`ThinFilm`].
    ThinFilm(ThinFilm<R, N>),
}

impl<R: Real, const N: usize> Fresnel<R, N> {
    /// Reflectance at the angle with cosine `cos`, [0, 1].
    #[inline(always)]
    pub fn eval(&self, cos: R) -> [R; N] {
        match *self {
            Self::None => grey(R::one()),
            Self::Schlick { f0 } => {
                let mut out = f0;
                each_component!(N, k => { out[k] = schlick(cos, f0[k], R::one()); });
                out
            }
            Self::F82Tint { f0, tint } => {
                let mut out = f0;
                each_component!(N, k => { out[k] = f82_tint(cos, f0[k], tint[k]); });
                out
            }
            Self::Dielectric { ior } => grey(dielectric(cos, ior)),
            Self::Conductor { eta, k } => {
                let mut out = eta;
                each_component!(N, c => { out[c] = conductor(cos, eta[c], k[c]); });
                out
            }
            Self::ThinFilm(ref film) => film.eval(cos),
        }
    }

    /// Cosine-weighted mean over the hemisphere, 2 ∫₀¹ F(μ) μ dμ.
    ///
    /// Closed form for Schlick's, (1 + 20 F₀)/21; else Gauss–Legendre quadrature of 16 nodes in √μ, whose error is below 1e-5
    /// (64 nodes and 2e-4 for a dark tint).
    pub fn average(&self) -> [R; N] {
        match *self {
            Self::None => grey(R::one()),
            Self::Schlick { f0 } => {
                let mut out = f0;
                for x in &mut out {
                    *x = (R::one() + R::lit(20.0) * *x) * R::lit(1.0 / 21.0);
                }
                out
            }
            _ => {
                let mut out = grey(R::zero());
                // A dark tint makes a kink, where F reaches 0.
                let panels: u32 = if matches!(self, Self::F82Tint { .. }) {
                    4
                } else {
                    1
                };
                let width = 1.0 / f64::from(panels);
                for panel in 0..panels {
                    for (x, w) in GAUSS_LEGENDRE_16 {
                        for side in [-0.5, 0.5] {
                            // μ = t², 2μ dμ = 4t³ dt: nodes gather at grazing angles.
                            let t = width * (f64::from(panel) + 0.5 + side * x);
                            let mu = t * t;
                            let f = self.eval(R::lit(mu));
                            for c in 0..N {
                                out[c] = out[c] + f[c] * R::lit(w * width * 4.0 * t * mu);
                            }
                        }
                    }
                }
                out
            }
        }
    }

    /// The same with another number type.
    pub fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Fresnel<S, N> {
        match *self {
            Self::None => Fresnel::None,
            Self::Schlick { f0 } => Fresnel::Schlick { f0: cast(f0, f) },
            Self::F82Tint { f0, tint } => Fresnel::F82Tint {
                f0: cast(f0, f),
                tint: cast(tint, f),
            },
            Self::Dielectric { ior } => Fresnel::Dielectric { ior: f(ior) },
            Self::Conductor { eta, k } => Fresnel::Conductor {
                eta: cast(eta, f),
                k: cast(k, f),
            },
            Self::ThinFilm(ref film) => Fresnel::ThinFilm(film.cast(f)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// tanθ = η is Brewster's angle: nothing of what swings in the plane of incidence is reflected. The mean of both is the unpolarised one.
    #[test]
    fn polarised() {
        let brewster = 1.0 / (1.0f64 + 1.5 * 1.5).sqrt();
        let [s, p] = conductor_polarised(brewster, 1.5, 0.0);
        assert!(p < 1e-15 && (s - (1.25f64 / 3.25).powi(2)).abs() < 1e-12);
        for cos in [0.0, 0.01, 0.3, 0.8, 1.0] {
            for (eta, k) in [(1.5, 0.0), (0.2, 3.4), (1.4, 7.5)] {
                let [s, p] = conductor_polarised(cos, eta, k);
                assert!((0.5 * (s + p) - conductor(cos, eta, k)).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn glass_at_normal_and_grazing_incidence() {
        assert!((dielectric(1.0, 1.5) - 0.04).abs() < 1e-15);
        assert_eq!(dielectric(0.0, 1.5), 1.0);
        assert_eq!(dielectric(0.0f32, 1.5), 1.0);
        // Brewster's angle: only the s-polarised part reflects, ((η² − 1)/(η² + 1))² / 2.
        let brewster = 1.0 / (1.0f64 + 1.5 * 1.5).sqrt();
        let s = (1.25f64 / 3.25).powi(2) / 2.0;
        assert!((dielectric(brewster, 1.5) - s).abs() < 1e-12);
        // Beyond the critical angle from inside (sin = 1/1.5, cos = 0.745).
        assert_eq!(dielectric(0.74, 1.0 / 1.5), 1.0);
        assert!(dielectric(0.75, 1.0 / 1.5) < 1.0);
    }

    #[test]
    fn conductor_limits() {
        for i in 0..=20 {
            let cos = f64::from(i) / 20.0;
            assert!((conductor(cos, 1.5, 0.0) - dielectric(cos, 1.5)).abs() < 1e-9);
            assert_eq!(conductor(cos, 1.0, 0.0) > 1e-9, i == 0);
        }
        // ((η−1)² + k²)/((η+1)² + k²) at normal incidence.
        let (n, k) = (0.2f64, 3.4f64);
        let normal = ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
        assert!((conductor(1.0, n, k) - normal).abs() < 1e-14);
        assert!((conductor(0.0, n, k) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn f82_tint_is_the_tint_at_82_degrees() {
        let at = 1.0 / 7.0;
        for (f0, tint) in [(0.9, 0.5), (0.3, 1.0), (1.0, 0.0)] {
            assert!((f82_tint(at, f0, tint) - tint * schlick(at, f0, 1.0)).abs() < 1e-15);
            assert!((f82_tint(1.0, f0, tint) - f0).abs() < 1e-15);
            assert!((f82_tint(0.0, f0, tint) - 1.0).abs() < 1e-15);
        }
        assert_eq!(f82_tint(0.4, 0.0, 0.0), 0.0);
    }

    #[test]
    fn averages_match_fine_quadrature() {
        let cases: [Fresnel<f64, 1>; 6] = [
            Fresnel::Schlick { f0: [0.3] },
            Fresnel::F82Tint {
                f0: [0.6],
                tint: [0.4],
            },
            Fresnel::F82Tint {
                f0: [0.05],
                tint: [0.0],
            },
            Fresnel::Dielectric { ior: 1.5 },
            Fresnel::Conductor {
                eta: [0.2],
                k: [3.9],
            },
            Fresnel::None,
        ];
        for f in cases {
            let n = 200_000;
            let mut sum = 0.0;
            for i in 0..n {
                let mu = (f64::from(i) + 0.5) / f64::from(n);
                sum += 2.0 * f.eval(mu)[0] * mu / f64::from(n);
            }
            // The darker of the tints makes a kink.
            let tolerance = match f {
                Fresnel::F82Tint { tint: [0.0], .. } => 2e-4,
                _ => 1e-5,
            };
            assert!((f.average()[0] - sum).abs() < tolerance, "{f:?}: {sum}");
        }
    }
}
