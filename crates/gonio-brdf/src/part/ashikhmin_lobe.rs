//! What Ashikhmin's two models have in common: an anisotropic power of the half vector's cosine with Fresnel reflectance, above
//! a diffuse part that gets what the lobe lets through.

use super::colour::{add, cast, each_component, mean, only_where, scale};
use super::fresnel::{dielectric, schlick};
use super::geometry::{Half, above, mirrored_about};
use super::special::{exp_m1, ln_1p};
use crate::model::components;
use crate::{BrdfError, ModelSpec, ParameterInfo};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{around_axis, cosine_hemisphere, cosine_hemisphere_density};
use std::f64::consts::FRAC_1_PI;

/// The density of half vectors p(h) = √((nu + 1)(nv + 1))/2π (h.z)ⁿ, n = nu cos²φ + nv sin²φ; ∫ p dh = 1 over the hemisphere.
///
/// Source: Ashikhmin & Shirley 2000, eqs 4 and 6.
#[derive(Debug, Clone, Copy)]
pub struct HalfPower<R> {
    /// Exponent along x, ≥ 0.
    pub nu: R,
    /// Exponent along y, ≥ 0.
    pub nv: R,
}

impl<R: Real> HalfPower<R> {
    /// p(h) in sr⁻¹; 0 for h.z ≤ 0.
    #[inline(always)]
    pub fn density(&self, h: Vec3<R>) -> R {
        let one = R::one();
        // (h.z)ⁿ = exp(−n/2 ln(1 + tan²θ)) keeps its digits near the pole.
        let z2 = (h.z * h.z).max(R::lit(1e-12));
        let sin2 = h.x * h.x + h.y * h.y;
        let weighted = self.nu * (h.x * h.x) + self.nv * (h.y * h.y); // n sin²θ
        let n = weighted / sin2.max(R::lit(1e-30));
        let power = (R::lit(-0.5) * n * ln_1p(sin2 / z2)).exp();
        let constant = ((self.nu + one) * (self.nv + one)).sqrt() * R::lit(0.5 * FRAC_1_PI);
        R::select(h.z.gt(R::zero()), constant * power, R::zero())
    }

    /// A half vector with the density p(h): tanφ = √((nu + 1)/(nv + 1)) tan 2πu₀, cosθ = (1 − u₁)^(1/(n + 1)).
    #[inline(always)]
    pub fn sample(&self, u0: R, u1: R) -> Vec3<R> {
        let one = R::one();
        let (along_x, along_y) = (self.nu + one, self.nv + one);
        let d = around_axis(u0, one, R::zero());
        let (x, y) = (along_y.sqrt() * d.x, along_x.sqrt() * d.y);
        let over = (x * x + y * y).max(R::lit(1e-30)).sqrt().recip();
        let (cos, sin) = (x * over, y * over);
        let exponent = along_x * cos * cos + along_y * sin * sin; // n + 1
        let log = (one - u1).max(R::lit(1e-12)).ln() / exponent; // ln cosθ
        let sin_theta = (-exp_m1(log + log)).safe_sqrt();
        Vec3::new(sin_theta * cos, sin_theta * sin, log.exp())
    }

    /// The same with another number type.
    pub fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> HalfPower<S> {
        HalfPower {
            nu: f(self.nu),
            nv: f(self.nv),
        }
    }
}

/// The reflectance of the lobe.
#[derive(Debug, Clone, Copy)]
pub enum Reflectance<R: Real, const N: usize> {
    /// [`schlick`] from Rs.
    Schlick([R; N]),
    /// [`dielectric`] of a relative index of refraction.
    Dielectric(R),
}

/// The constants of f = (diffuse part) + s p(h) F(k·h)/4·(a factor of the two directions).
#[derive(Debug, Clone, Copy)]
pub struct AshikhminLobe<R: Real, const N: usize> {
    /// Rd, [0, 1].
    pub diffuse: [R; N],
    /// F.
    pub fresnel: Reflectance<R, N>,
    /// p.
    pub halves: HalfPower<R>,
    /// s ≥ 0.
    pub scale: [R; N],
    /// Whether the diffuse part is Rd/π, otherwise what the lobe lets through.
    pub lambertian: bool,
}

/// `diffuse`.
pub(crate) const DIFFUSE: ParameterInfo = ParameterInfo::colour(
    "diffuse",
    (0.0, 1.0),
    Some([0.5; 3]),
    "diffuse reflectance Rd",
);
/// `specular`.
pub(crate) const SPECULAR: ParameterInfo = ParameterInfo::colour(
    "specular",
    (0.0, 1.0),
    Some([0.2; 3]),
    "reflectance Rs of the lobe at normal incidence (fresnel=schlick)",
);
/// `nu`.
pub(crate) const NU: ParameterInfo = ParameterInfo::number(
    "nu",
    "",
    (0.0, 1e6),
    Some(100.0),
    "exponent of the lobe along x: the larger, the narrower",
);
/// `nv`.
pub(crate) const NV: ParameterInfo = ParameterInfo::number(
    "nv",
    "",
    (0.0, 1e6),
    Some(100.0),
    "exponent of the lobe along y",
);
/// `fresnel`.
pub(crate) const FRESNEL: ParameterInfo = ParameterInfo::choice(
    "fresnel",
    &["schlick", "dielectric"],
    Some("schlick"),
    "reflectance F of the lobe: from specular, or from ior; when not given, the one of the two that is given decides",
);
/// `ior`.
pub(crate) const IOR: ParameterInfo = ParameterInfo::number(
    "ior",
    "",
    (1.01, 20.0),
    Some(1.5),
    "relative index of refraction (fresnel=dielectric)",
);
/// `scale`.
pub(crate) const SCALE: ParameterInfo = ParameterInfo::colour(
    "scale",
    (0.0, 10.0),
    Some([1.0; 3]),
    "what the lobe is multiplied by: 1 as published; fits to measurements have others",
);
/// `diffuse_term`.
pub(crate) const DIFFUSE_TERM: ParameterInfo = ParameterInfo::choice(
    "diffuse_term",
    &["published", "lambertian"],
    Some("published"),
    "published: what the lobe lets through; lambertian: Rd/π, whatever the lobe reflects",
);

/// A pair of directions and its half vector.
pub(crate) struct Pair<R: Real> {
    pub(crate) wi: Vec3<R>,
    pub(crate) wo: Vec3<R>,
    pub(crate) half: Half<R>,
    /// p of the half vector.
    p: R,
}

/// Whether nu = nv.
pub(crate) fn isotropic(spec: &ModelSpec) -> bool {
    spec.number("nu") == spec.number("nv")
}

/// A bound of the albedo, for lobes whose draws weigh at most F s.
///
/// Draws above the horizon have k·h > μ/2, as cosθi = 2 (k·h) h.z − μ. So Schlick's F is at most Rs + (1 − Rs) x with
/// x = (1 − μ/2)⁵ in [1/32, 1], and the published diffuse part has exactly the albedo Rd (1 − Rs)(1 − x): the sum is linear in x,
/// largest at one of the ends.
pub(crate) fn albedo_bound(spec: &ModelSpec) -> f64 {
    let (rd, s) = (
        spec.rgb("diffuse").unwrap_or_default(),
        spec.rgb("scale").unwrap_or_default(),
    );
    let schlick = !is_dielectric(spec);
    let lambertian = spec.word("diffuse_term") == "lambertian";
    let mut bound: f64 = 0.0;
    for k in 0..3 {
        let rs = spec.rgb("specular").unwrap_or_default()[k];
        let (f, through) = if schlick {
            (rs + (1.0 - rs) / 32.0, 1.0 - rs)
        } else {
            (1.0, 1.0 - at_normal_incidence(spec.real::<f64>("ior")))
        };
        let steep = if lambertian {
            rd[k]
        } else {
            rd[k] * through * 31.0 / 32.0
        };
        let grazing = if lambertian { rd[k] } else { 0.0 };
        bound = bound.max(s[k] * f + steep).max(s[k] + grazing);
    }
    bound
}

fn is_dielectric(spec: &ModelSpec) -> bool {
    let given = |key: &str| spec.values.contains_key(key);
    spec.word("fresnel") == "dielectric" || (!given("fresnel") && given("ior"))
}

/// ((η − 1)/(η + 1))².
#[inline(always)]
fn at_normal_incidence<R: Real>(ior: R) -> R {
    ((ior - R::one()) / (ior + R::one())).sq()
}

impl<R: Real, const N: usize> AshikhminLobe<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let dielectric = is_dielectric(spec);
        for (key, wanted) in [("specular", false), ("ior", true)] {
            if spec.values.contains_key(key) && dielectric != wanted {
                let (used_by, is) = if wanted {
                    ("dielectric", "schlick")
                } else {
                    ("schlick", "dielectric")
                };
                return Err(spec.wrong(
                    key,
                    &format!("no value here: only fresnel={used_by} uses it, and fresnel is {is}"),
                ));
            }
        }
        Ok(Self {
            diffuse: spec.colour("diffuse")?,
            fresnel: if dielectric {
                Reflectance::Dielectric(spec.real("ior"))
            } else {
                Reflectance::Schlick(spec.colour("specular")?)
            },
            halves: HalfPower {
                nu: spec.real("nu"),
                nv: spec.real("nv"),
            },
            scale: spec.colour("scale")?,
            lambertian: spec.word("diffuse_term") == "lambertian",
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> AshikhminLobe<S, N> {
        AshikhminLobe {
            diffuse: cast(self.diffuse, f),
            fresnel: match self.fresnel {
                Reflectance::Schlick(rs) => Reflectance::Schlick(cast(rs, f)),
                Reflectance::Dielectric(ior) => Reflectance::Dielectric(f(ior)),
            },
            halves: self.halves.cast(f),
            scale: cast(self.scale, f),
            lambertian: self.lambertian,
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match (parameter, &mut self.fresnel) {
            ("diffuse", _) => self.diffuse = components(value),
            ("scale", _) => self.scale = components(value),
            ("nu", _) => self.halves.nu = value[0],
            ("nv", _) => self.halves.nv = value[0],
            ("specular", Reflectance::Schlick(rs)) => *rs = components(value),
            ("ior", Reflectance::Dielectric(ior)) => *ior = value[0],
            _ => {}
        }
    }

    #[inline(always)]
    pub(crate) fn pair(&self, wi: Vec3<R>, wo: Vec3<R>) -> Pair<R> {
        let half = Half::new(wi, wo);
        Pair {
            wi,
            wo,
            half,
            p: self.halves.density(half.h()),
        }
    }

    /// s F at the cosine k·h.
    #[inline(always)]
    fn reflectance(&self, cos: R) -> [R; N] {
        let mut out = self.scale;
        match self.fresnel {
            Reflectance::Schlick(rs) => {
                each_component!(N, k => { out[k] = out[k] * schlick(cos, rs[k], R::one()); });
                out
            }
            Reflectance::Dielectric(ior) => scale(out, dielectric(cos, ior)),
        }
    }

    /// Rd, or Rd (1 − Rs): the diffuse part's albedo but for [`through`].
    #[inline(always)]
    fn diffuse_reflectance(&self) -> [R; N] {
        let mut out = self.diffuse;
        if self.lambertian {
            return out;
        }
        match self.fresnel {
            Reflectance::Schlick(rs) => {
                each_component!(N, k => { out[k] = out[k] * (R::one() - rs[k]); });
                out
            }
            Reflectance::Dielectric(ior) => scale(out, R::one() - at_normal_incidence(ior)),
        }
    }

    /// The diffuse part, and s p F/4·`factor`, above the horizon.
    #[inline(always)]
    pub(crate) fn value(&self, pair: &Pair<R>, factor: R) -> [R; N] {
        let lobe = R::lit(0.25) * pair.p * factor;
        let body = if self.lambertian {
            R::lit(FRAC_1_PI)
        } else {
            R::lit(28.0 / 23.0 * FRAC_1_PI) * (through(pair.wi.z) * through(pair.wo.z))
        };
        let diffuse = scale(self.diffuse_reflectance(), body);
        let specular = scale(self.reflectance(pair.half.cos), lobe);
        only_where(above(pair.wi, pair.wo), add(diffuse, specular))
    }

    /// The density of drawing the light's direction: a half vector with density p, or the cosine.
    ///
    /// - `gain`: an estimate of the lobe's albedo over s F
    #[inline(always)]
    pub(crate) fn density(&self, pair: &Pair<R>, gain: R) -> R {
        let lobe = R::lit(0.25) * pair.p / pair.half.cos.max(R::lit(1e-15));
        let diffuse = cosine_hemisphere_density(pair.wi);
        let [d, s] = self.shares(pair.wo.z, gain);
        let mixed = (d * diffuse + s * lobe) / (d + s);
        R::select(above(pair.wi, pair.wo), mixed, R::zero())
    }

    #[inline(always)]
    pub(crate) fn draw(&self, wo: Vec3<R>, gain: R, u: [R; 3]) -> Vec3<R> {
        let h = self.halves.sample(u[0], u[1]);
        let diffuse = cosine_hemisphere([u[0], u[1]]);
        let [d, s] = self.shares(wo.z, gain);
        Vec3::select((u[2] * (d + s)).lt(d), diffuse, mirrored_about(wo, h))
    }

    /// Albedo of the diffuse part and estimate of the lobe's, means over the colours.
    #[inline(always)]
    pub(crate) fn shares(&self, mu: R, gain: R) -> [R; 2] {
        let mu = mu.saturate();
        let through = if self.lambertian {
            R::one()
        } else {
            through(mu)
        };
        // Both black: whatever is drawn has weight 0.
        [
            mean(self.diffuse_reflectance()) * through + R::lit(1e-20),
            mean(self.reflectance(mu)) * gain,
        ]
    }
}

/// 1 − (1 − μ/2)⁵.
#[inline(always)]
fn through<R: Real>(mu: R) -> R {
    R::one() - (R::one() - R::lit(0.5) * mu).pow5()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Midpoints of θ and φ: ∫ p dh = 1; and the mean of 1/p over draws within a cap is the cap's solid angle.
    #[test]
    fn half_vectors_have_their_density() {
        for (nu, nv) in [(0.0, 0.0), (20.0, 5.0), (3.0, 200.0)] {
            let d = HalfPower::<f64> { nu, nv };
            let n = 1000;
            let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
            let mut sum = 0.0;
            for theta in (0..n).map(|k| at(k) * std::f64::consts::FRAC_PI_2) {
                for turn in (0..128).map(|k| f64::from(k) / 128.0) {
                    sum += d.density(around_axis(turn, theta.sin(), theta.cos())) * theta.sin();
                }
            }
            let integral = sum * std::f64::consts::PI.powi(2) / f64::from(n * 128);
            assert!((integral - 1.0).abs() < 1e-4, "{nu} {nv}: {integral}");
            let (mut inside, cos0) = (0.0, 0.98);
            for k in 0..n * n {
                let h = d.sample(at(k % n), at(k / n));
                assert!((h.length() - 1.0).abs() < 1e-12);
                if h.z > cos0 {
                    inside += 1.0 / d.density(h) / f64::from(n * n);
                }
            }
            let cap = std::f64::consts::TAU * (1.0 - cos0);
            assert!((inside / cap - 1.0).abs() < 5e-3, "{nu} {nv}: {inside}");
        }
    }
}
