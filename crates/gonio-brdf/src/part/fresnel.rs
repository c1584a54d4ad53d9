//! Fresnel reflectance of unpolarised light (T17).

use super::colour::{cast, each_component, grey};
use super::special::GAUSS_LEGENDRE_16;
use crate::model::components;
use crate::{BrdfError, ModelSpec, ParameterInfo, part::metal};
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
    let sin2_t = (R::one() - cos * cos).max(R::zero()) / (ior * ior);
    let total = sin2_t.ge(R::one());
    let cos_t = (R::one() - sin2_t).max(tiny).sqrt();
    let s = (cos - ior * cos_t) / (cos + ior * cos_t).max(tiny);
    let p = (ior * cos - cos_t) / (ior * cos + cos_t).max(tiny);
    R::select(total, R::one(), (s * s + p * p) * R::lit(0.5))
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
    // r⊥² = (t1 − t2)/(t1 + t2) and r∥² = r⊥² (t3 − t4)/(t3 + t4): their mean with one division.
    (t1 - t2) * t3 / ((t1 + t2) * (t3 + t4)).max(R::lit(1e-30))
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
            Self::Dielectric { ior } => grey(dielectric(cos, ior)),
            Self::Conductor { eta, k } => {
                let mut out = eta;
                each_component!(N, c => { out[c] = conductor(cos, eta[c], k[c]); });
                out
            }
        }
    }

    /// Cosine-weighted mean over the hemisphere, 2 ∫₀¹ F(μ) μ dμ.
    ///
    /// Closed form for Schlick's, (1 + 20 F₀)/21; else Gauss–Legendre quadrature of 16 nodes in √μ, whose error is below 1e-5.
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
                for (x, w) in GAUSS_LEGENDRE_16 {
                    for side in [-1.0, 1.0] {
                        // μ = t², 2μ dμ = 4t³ dt, t = (1 ± x)/2: nodes gather at grazing angles.
                        let t = 0.5 * (1.0 + side * x);
                        let mu = t * t;
                        let f = self.eval(R::lit(mu));
                        for c in 0..N {
                            out[c] = out[c] + f[c] * R::lit(w * 4.0 * t * mu);
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
            Self::Dielectric { ior } => Fresnel::Dielectric { ior: f(ior) },
            Self::Conductor { eta, k } => Fresnel::Conductor {
                eta: cast(eta, f),
                k: cast(k, f),
            },
        }
    }

    /// Sets one of the constants, if this kind of reflectance has it.
    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match (self, parameter) {
            (Self::Schlick { f0 }, "f0") => *f0 = components(value),
            (Self::Dielectric { ior }, "ior") => *ior = value[0],
            (Self::Conductor { eta, .. }, "eta") => *eta = components(value),
            (Self::Conductor { k, .. }, "k") => *k = components(value),
            _ => {}
        }
    }

    /// From the parameters `fresnel`, `f0`, `ior`, `eta`, `k` and `metal` of a description.
    ///
    /// A parameter that another kind of reflectance needs is an error, not ignored.
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let given = |key: &str| spec.values.contains_key(key);
        let mut kind = spec.word("fresnel");
        if !given("fresnel") {
            // What is given says which reflectance is meant.
            if given("metal") || given("eta") || given("k") {
                kind = "conductor".into();
            } else if given("ior") {
                kind = "dielectric".into();
            } else if given("f0") {
                kind = "schlick".into();
            }
        }
        for (key, used_by) in [
            ("f0", "schlick"),
            ("ior", "dielectric"),
            ("eta", "conductor"),
            ("k", "conductor"),
            ("metal", "conductor"),
        ] {
            if given(key) && kind != used_by {
                return Err(spec.wrong(
                    key,
                    &format!(
                        "no value here: only fresnel={used_by} uses it, and fresnel is {kind}"
                    ),
                ));
            }
        }
        Ok(match kind.as_str() {
            "schlick" => Self::Schlick {
                f0: spec.colour("f0")?,
            },
            "dielectric" => Self::Dielectric {
                ior: spec.real("ior"),
            },
            "conductor" => {
                if given("metal") && (given("eta") || given("k")) {
                    return Err(spec.wrong("metal", "either metal=NAME or eta and k, not both"));
                }
                if given("eta") || given("k") {
                    for key in ["eta", "k"] {
                        if !given(key) {
                            return Err(spec.wrong(key, "both eta and k"));
                        }
                    }
                    Self::Conductor {
                        eta: spec.colour("eta")?,
                        k: spec.colour("k")?,
                    }
                } else {
                    let word = spec.word("metal");
                    let name = if word.is_empty() { "gold" } else { &word };
                    let metal = metal::find(name)
                        .ok_or_else(|| spec.wrong("metal", "the name of a measured metal"))?;
                    Self::Conductor {
                        eta: spec.components("metal", metal.eta)?,
                        k: spec.components("metal", metal.k)?,
                    }
                }
            }
            _ => Self::None,
        })
    }
}

/// `fresnel`: which reflectance.
pub(crate) const fn parameter(default: &'static str) -> ParameterInfo {
    ParameterInfo::choice(
        "fresnel",
        &["schlick", "dielectric", "conductor", "none"],
        Some(default),
        "reflectance of the facets; when not given, the parameters below that are given decide",
    )
}
/// `f0`.
pub(crate) const F0: ParameterInfo = ParameterInfo::colour(
    "f0",
    (0.0, 1.0),
    Some([0.04; 3]),
    "reflectance at normal incidence (fresnel=schlick)",
);
/// `ior`.
pub(crate) const IOR: ParameterInfo = ParameterInfo::number(
    "ior",
    "",
    (0.1, 10.0),
    Some(1.5),
    "relative index of refraction (fresnel=dielectric)",
);
/// `eta`.
pub(crate) const ETA: ParameterInfo = ParameterInfo::colour(
    "eta",
    (0.001, 100.0),
    Some([1.5; 3]),
    "real part of the index of refraction, with k (fresnel=conductor)",
);
/// `k`.
pub(crate) const K: ParameterInfo = ParameterInfo::colour(
    "k",
    (0.0, 100.0),
    Some([0.0; 3]),
    "imaginary part of the index of refraction, with eta (fresnel=conductor)",
);
/// `metal`.
pub(crate) const METAL: ParameterInfo = ParameterInfo::choice(
    "metal",
    metal::NAMES,
    None,
    "a measured metal instead of eta and k (fresnel=conductor); gold when neither is given",
);

#[cfg(test)]
mod tests {
    use super::*;

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
    fn averages_match_fine_quadrature() {
        let cases: [Fresnel<f64, 1>; 4] = [
            Fresnel::Schlick { f0: [0.3] },
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
            assert!((f.average()[0] - sum).abs() < 1e-5, "{f:?}: {sum}");
        }
    }
}
