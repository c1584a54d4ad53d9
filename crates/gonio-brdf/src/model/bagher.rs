//! The model of Bagher, Soler & Holzschuch: microfacets whose every number is a colour.

use super::components;
use crate::part::colour::{cast, each_component, grey, mean, only_where};
use crate::part::distribution::{Distribution, Shape};
use crate::part::fresnel::schlick;
use crate::part::geometry::{Half, above, mirrored_about, sin_theta};
use crate::part::special::exp_m1;
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density};
use std::f64::consts::FRAC_1_PI;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "bagher",
    summary: "microfacets with the shifted gamma distribution and a masking of its own for each colour, to be fitted to measurements",
    paper: "Bagher, Soler & Holzschuch 2012, \"Accurate Fitting of Measured Reflectances Using a Shifted Gamma Micro-facet \
            Distribution\"",
    parameters: &[
        ParameterInfo::colour(
            "diffuse",
            (0.0, 1.0),
            Some([0.5; 3]),
            "diffuse reflectance kd",
        ),
        ParameterInfo::colour(
            "specular",
            (0.0, 10.0),
            Some([0.5; 3]),
            "scale ks of the lobe",
        ),
        ParameterInfo::colour(
            "alpha_squared",
            (1e-8, 1.0),
            Some([0.025; 3]),
            "a, the square of a slope scale: α in the paper",
        ),
        ParameterInfo::colour(
            "p",
            (0.0, 2.0),
            Some([0.5; 3]),
            "exponent p of the distribution: the larger, the sharper the peak on its tail",
        ),
        ParameterInfo::colour(
            "f0",
            (0.0, 10.0),
            Some([0.04; 3]),
            "F₀ of Fresnel reflectance; a free number, with ks, rather than a reflectance",
        ),
        ParameterInfo::colour(
            "f1",
            (-10.0, 10.0),
            Some([0.0; 3]),
            "F₁, what is subtracted from Schlick's reflectance towards the normal",
        ),
        ParameterInfo::colour(
            "masking_lambda",
            (0.0, 1e8),
            Some([2.3; 3]),
            "Λ of the masking G₁; 0: none",
        ),
        ParameterInfo::colour(
            "masking_ln_c",
            (-30.0, 300.0),
            Some([-16.6; 3]),
            "ln c of G₁: fits have c up to 10¹⁰⁹",
        ),
        ParameterInfo::colour("masking_k", (1.0, 1000.0), Some([40.0; 3]), "k of G₁"),
        ParameterInfo::colour(
            "masking_theta0_rad",
            (-1.0, 1.5),
            Some([0.09; 3]),
            "θ₀ of G₁: up to this angle of incidence nothing is masked",
        ),
    ],
    positional: None,
    aliases: &[],
    recordable: true,
    declares,
};

/// Nothing ties the masking to the distribution: no bound holds for all values.
fn declares(_: &ModelSpec) -> Declares {
    Declares::physical(f64::INFINITY)
}

/// f = kd/π + ks D(h) F(θ′) G₁(θi) G₁(θr)/(π cosθi cosθr), each number a colour:
///
/// - D = K e^(−x) x^−p/(π cos⁴θh), x = a + tan²θh/a, with K such that ∫ D cosθh dh = 1: the distribution `sgd` of
///   `torrance-sparrow` (a = α²)
/// - F = F₀ + (1 − F₀)(1 − cosθ′)⁵ − F₁ cosθ′, not below 0
/// - G₁ = 1 − Λ (exp(c (θ − θ₀)ᵏ) − 1) for θ > θ₀, else 1; kept within [0, 1]: a curve fitted to the masking that D has
///
/// Reciprocal. The factor 1/π is 4/π times what facets reflect, and with F and G₁ free the lobe may reflect more than arrives: the numbers
/// are those of a fit, whose scale is in ks.
///
/// Sampling: each colour's lobe by its D, and the diffuse part, in proportion to estimates of their albedo.
#[derive(Debug, Clone, Copy)]
pub struct Bagher<R: Real, const N: usize> {
    /// kd, [0, 1].
    pub diffuse: [R; N],
    /// ks ≥ 0.
    pub specular: [R; N],
    /// F₀.
    pub f0: [R; N],
    /// F₁.
    pub f1: [R; N],
    /// D.
    pub normals: [Distribution<R>; N],
    /// G₁.
    pub masking: Masking<R, N>,
}

/// The constants of G₁.
#[derive(Debug, Clone, Copy)]
pub struct Masking<R: Real, const N: usize> {
    /// Λ ≥ 0.
    pub lambda: [R; N],
    /// ln c.
    pub ln_c: [R; N],
    /// k ≥ 1.
    pub k: [R; N],
    /// θ₀ in rad.
    pub theta0: [R; N],
}

impl<R: Real, const N: usize> Masking<R, N> {
    /// G₁ of the colour `n` at θ = `theta` in rad.
    #[inline(always)]
    fn g1(&self, n: usize, theta: R) -> R {
        let beyond = theta - self.theta0[n];
        let log = self.ln_c[n] + self.k[n] * beyond.max(R::lit(1e-10)).ln();
        // exp(e⁴) times the largest Λ stays within single precision; there G₁ has long been 0.
        let power = log.min(R::lit(4.0)).exp();
        let g = (R::one() - self.lambda[n] * exp_m1(power)).saturate();
        R::select(beyond.gt(R::zero()), g, R::one())
    }
}

/// θ of a direction above the horizon, with its digits near the pole.
#[inline(always)]
fn theta<R: Real>(w: Vec3<R>) -> R {
    sin_theta(w).atan2(w.z.max(R::zero()))
}

impl<R: Real, const N: usize> Bagher<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let (a, p): ([R; N], [R; N]) = (spec.colour("alpha_squared")?, spec.colour("p")?);
        let mut normals = [Distribution::isotropic(Shape::ShiftedGamma, R::one()); N];
        for ((normals, a), p) in normals.iter_mut().zip(a).zip(p) {
            *normals = gamma(a, p);
        }
        Ok(Self {
            diffuse: spec.colour("diffuse")?,
            specular: spec.colour("specular")?,
            f0: spec.colour("f0")?,
            f1: spec.colour("f1")?,
            normals,
            masking: Masking {
                lambda: spec.colour("masking_lambda")?,
                ln_c: spec.colour("masking_ln_c")?,
                k: spec.colour("masking_k")?,
                theta0: spec.colour("masking_theta0_rad")?,
            },
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Bagher<S, N> {
        let mut normals = [self.normals[0].cast(f); N];
        for (to, from) in normals.iter_mut().zip(&self.normals).skip(1) {
            *to = from.cast(f);
        }
        Bagher {
            diffuse: cast(self.diffuse, f),
            specular: cast(self.specular, f),
            f0: cast(self.f0, f),
            f1: cast(self.f1, f),
            normals,
            masking: Masking {
                lambda: cast(self.masking.lambda, f),
                ln_c: cast(self.masking.ln_c, f),
                k: cast(self.masking.k, f),
                theta0: cast(self.masking.theta0, f),
            },
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        let value: [R; N] = components(value);
        match parameter {
            "diffuse" => self.diffuse = value,
            "specular" => self.specular = value,
            "f0" => self.f0 = value,
            "f1" => self.f1 = value,
            "masking_lambda" => self.masking.lambda = value,
            "masking_ln_c" => self.masking.ln_c = value,
            "masking_k" => self.masking.k = value,
            "masking_theta0_rad" => self.masking.theta0 = value,
            "p" => {
                for (normals, p) in self.normals.iter_mut().zip(value) {
                    normals.set_tail(p);
                }
            }
            _ => {
                for (normals, a) in self.normals.iter_mut().zip(value) {
                    normals.set_alpha(a.sqrt(), a.sqrt());
                }
            }
        }
    }

    /// F of the colour `n`.
    #[inline(always)]
    fn fresnel(&self, n: usize, cos: R) -> R {
        let f = schlick(cos, self.f0[n], R::one()) - self.f1[n] * cos;
        f.max(R::zero())
    }

    /// The weights with which the parts are drawn, which needn't add up to 1: the diffuse part's, and each lobe's.
    #[inline(always)]
    fn weights(&self, wo: Vec3<R>) -> (R, [R; N]) {
        let mu = wo.z.saturate();
        let mut lobes = self.specular;
        each_component!(N, n => {
            lobes[n] = lobes[n] * self.fresnel(n, mu) * R::lit(4.0 * FRAC_1_PI / N as f64);
        });
        // All black: whatever is drawn has weight 0.
        (mean(self.diffuse) + R::lit(1e-20), lobes)
    }

    #[inline(always)]
    fn value(&self, wi: Vec3<R>, wo: Vec3<R>, half: &Half<R>) -> [R; N] {
        let (theta_i, theta_o) = (theta(wi), theta(wo));
        // D is at most 3e15, F and ks are at most 20 and 10.
        let over = R::lit(FRAC_1_PI) / (wi.z * wo.z).max(R::lit(1e-20));
        let mut f = grey(R::zero());
        for n in 0..N {
            let g = self.masking.g1(n, theta_i) * self.masking.g1(n, theta_o);
            let lobe = self.normals[n].density_of(half) * self.fresnel(n, half.cos) * g * over;
            f[n] = R::lit(FRAC_1_PI) * self.diffuse[n] + self.specular[n] * lobe;
        }
        only_where(above(wi, wo), f)
    }

    #[inline(always)]
    fn density(&self, wi: Vec3<R>, wo: Vec3<R>, half: &Half<R>) -> R {
        let (diffuse, lobes) = self.weights(wo);
        let over = R::lit(0.25) / half.cos.max(R::lit(1e-15));
        let mut total = diffuse;
        let mut density = diffuse * cosine_hemisphere_density(wi);
        for n in 0..N {
            total = total + lobes[n];
            let d = self.normals[n].normal_density(half.h(), R::zero());
            density = density + lobes[n] * (d * over);
        }
        R::select(above(wi, wo), density / total, R::zero())
    }
}

/// D of a and p.
fn gamma<R: Real>(a: R, p: R) -> Distribution<R> {
    let alpha = a.sqrt();
    Distribution::new(Shape::ShiftedGamma, alpha, alpha, p)
}

impl<R: Real, const N: usize> Brdf<R, N> for Bagher<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        self.value(wi, wo, &Half::new(wi, wo))
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        self.density(wi, wo, &Half::new(wi, wo))
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let half = Half::new(wi, wo);
        (self.value(wi, wo, &half), self.density(wi, wo, &half))
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let (diffuse, lobes) = self.weights(wo);
        let mut total = diffuse;
        each_component!(N, n => { total = total + lobes[n]; });
        let x = u[2] * total;
        let mut wi = cosine_hemisphere([u[0], u[1]]);
        let mut before = diffuse;
        for n in 0..N {
            // The last lobe that starts at or below x wins.
            let h = self.normals[n].sample_normal(u[0], u[1]);
            wi = Vec3::select(before.le(x), mirrored_about(wo, h), wi);
            before = before + lobes[n];
        }
        self.sample_of(wi, wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        let (diffuse, lobes) = self.weights(wo);
        let mut total = diffuse;
        each_component!(N, n => { total = total + lobes[n]; });
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Model;
    use gonio_radiometry::warp::around_axis;
    use std::f64::consts::PI;

    fn model(text: &str) -> Model<f64, 3> {
        ModelSpec::parse(text).unwrap().build().unwrap()
    }

    #[test]
    fn by_hand() {
        // p = 0: K = 1/(a Γ(1, a)) = e^a/a, so D = exp(−tan²θh/a)/(π a cos⁴θh), Beckmann's. ωi and ωr at 60° from the normal and 90° of azimuth
        // apart: |ωi + ωr|² = 2.5, cos²θh = 0.4, tan²θh = 1.5, cosθ′ = √2.5/2.
        let s = 0.75f64.sqrt();
        let (wi, wo) = (Vec3::new(s, 0.0, 0.5), Vec3::new(0.0, s, 0.5));
        let m = model(
            "bagher:diffuse=0.3,specular=0.7,alpha_squared=0.5,p=0,f0=0.2,f1=0.1,masking_lambda=0.25,\
             masking_ln_c=-1,masking_k=2,masking_theta0_rad=0.5",
        );
        let d = (-3.0f64).exp() / (PI * 0.5 * 0.16);
        let c = 2.5f64.sqrt() / 2.0;
        let f = 0.2 + 0.8 * (1.0 - c).powi(5) - 0.1 * c;
        let g = 1.0 + 0.25 * (1.0 - ((-1.0f64).exp() * (PI / 3.0 - 0.5).powi(2)).exp());
        let expected = 0.3 / PI + 0.7 * d * f * g * g / (PI * 0.25);
        // The normalisation is by quadrature.
        assert!((m.eval(wi, wo)[0] / expected - 1.0).abs() < 1e-9);
    }

    /// Without masking and with F = 1 it is 4/π times `torrance-sparrow` with the same distribution, G = 1.
    #[test]
    fn each_colour_has_its_own_distribution() {
        let a = [0.01f64, 0.09, 0.25];
        let m = model(
            "bagher:diffuse=0,specular=1,alpha_squared=0.01/0.09/0.25,p=0.3/0.6/1.2,f0=1,masking_lambda=0",
        );
        let (wi, wo) = (
            around_axis(0.1, 0.3f64.sin(), 0.3f64.cos()),
            around_axis(0.55, 0.4f64.sin(), 0.4f64.cos()),
        );
        let f = m.eval(wi, wo);
        let h = Half::new(wi, wo).h();
        for (k, p) in [0.3, 0.6, 1.2].into_iter().enumerate() {
            let d = Distribution::new(Shape::ShiftedGamma, a[k].sqrt(), a[k].sqrt(), p);
            let expected = d.density(h) / (PI * wi.z * wo.z);
            assert!((f[k] / expected - 1.0).abs() < 1e-13, "{k}");
        }
    }

    /// Up to θ₀ nothing is masked; beyond, G₁ falls to 0 and stays there, also where its power is huge.
    #[test]
    fn masking_is_kept_between_0_and_1() {
        let m: Masking<f32, 1> = Masking {
            lambda: [1e8],
            ln_c: [250.0],
            k: [600.0],
            theta0: [0.5],
        };
        assert_eq!([0.0, 0.5].map(|t| m.g1(0, t)), [1.0; 2]);
        assert_eq!([1.5f32, 1.57].map(|t| m.g1(0, t)), [0.0; 2]);
        let falling = Masking::<f32, 1> {
            lambda: [2.0],
            ln_c: [0.0],
            k: [4.0],
            theta0: [0.5],
        };
        // 0.5⁴ = 1/16: 1 − 2 (e^(1/16) − 1).
        assert!((falling.g1(0, 1.0) - (3.0 - 2.0 * 0.0625f64.exp() as f32)).abs() < 1e-6);
    }
}
