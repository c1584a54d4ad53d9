//! [`Kernel`], what light is averaged with: a weight that depends on the angle to the axis alone.
//!
//! A prefiltered map answers, for an axis n, with the mean of the radiance weighed by K(θ), θ the angle from n:
//!
//! ```text
//! L̄(n) = ∫ L(ω) K(θ) dω / ∫ K(θ) dω        over the hemisphere around n
//! ```
//!
//! Kernels are functions of q = |n − ω|² = 2 (1 − cos θ), the squared chord: near the axis it keeps the digits that cos θ loses.

use crate::IblError;
use gonio_brdf::{Brdf, Model, ModelSpec};
use gonio_num::{Real, Vec3};
use gonio_radiometry::quadrature::GaussLegendre;
use std::f64::consts::PI;
use std::sync::Arc;

/// A weight over the hemisphere around an axis.
#[derive(Debug, Clone)]
pub enum Kernel {
    /// D(θh) cos θ of GGX facets of slope scale `alpha`, with θh = θ/2 since the viewer looks along the axis (N = V = R): Karis 2013,
    /// "Real Shading in Unreal Engine 4". alpha in (0, 1].
    Ggx {
        /// Slope scale.
        alpha: f64,
    },
    /// D(θh) cos θ of the sheen "Charlie", D ∝ sin^(1/α) θh: Estevez & Kulla 2017. alpha in \[1e-3, 1].
    Charlie {
        /// Its roughness.
        alpha: f64,
    },
    /// cosⁿ θ: n = 1 is diffuse reflection, larger n the specular maps of Miller & Hoffman 1984. n in \[0, 1e5].
    Cosine {
        /// n.
        exponent: f64,
    },
    /// f(ω, n) cos θ of any isotropic reflection function seen along its normal, tabulated.
    Model(Arc<ModelKernel>),
}

/// The kernel of a model, tabulated over t = √(q/4) from 0 to √½, the horizon.
#[derive(Debug)]
pub struct ModelKernel {
    /// The description of the model.
    pub name: String,
    /// ∫ f cos θ dω: its directional albedo at normal incidence, for each channel.
    pub albedo: [f64; 3],
    /// Largest difference between the shapes of the three channels, relative to their largest value: the kernel is their mean.
    pub colour_difference: f64,
    values: Vec<f32>,
}

/// Intervals of a tabulated kernel.
const TABLE: usize = 8192;
/// t at the horizon: q = 2.
const T_MAX: f64 = std::f64::consts::FRAC_1_SQRT_2;

impl Kernel {
    /// GGX of perceptual roughness `roughness` in (0, 1]; alpha = roughness².
    ///
    /// # Errors
    /// Out of range.
    pub fn ggx(roughness: f64) -> Result<Self, IblError> {
        if !(roughness > 0.0 && roughness <= 1.0) {
            return Err(IblError::parameter(
                "roughness",
                roughness,
                "a number in (0, 1]",
            ));
        }
        let alpha = (roughness * roughness).max(1e-4);
        Ok(Self::Ggx { alpha })
    }

    /// Charlie of perceptual roughness `roughness` in (0, 1]; alpha = roughness², not below 1e-3.
    ///
    /// # Errors
    /// Out of range.
    pub fn charlie(roughness: f64) -> Result<Self, IblError> {
        if !(roughness > 0.0 && roughness <= 1.0) {
            return Err(IblError::parameter(
                "roughness",
                roughness,
                "a number in (0, 1]",
            ));
        }
        let alpha = (roughness * roughness).max(1e-3);
        Ok(Self::Charlie { alpha })
    }

    /// cosⁿ θ.
    ///
    /// # Errors
    /// n below 0 or above 1e5.
    pub fn cosine(exponent: f64) -> Result<Self, IblError> {
        if !(0.0..=1e5).contains(&exponent) {
            return Err(IblError::parameter(
                "exponent",
                exponent,
                "a number in [0, 1e5]",
            ));
        }
        Ok(Self::Cosine { exponent })
    }

    /// The kernel of a model of the registry.
    ///
    /// # Errors
    /// [`IblError::Model`] for mirrors, for anisotropic models, and for those that reflect nothing along their normal.
    pub fn model(spec: &ModelSpec) -> Result<Self, IblError> {
        let fail = |reason: &str| IblError::Model {
            model: spec.to_string(),
            reason: reason.to_owned(),
        };
        if !spec.declares()?.isotropic {
            return Err(fail(
                "an anisotropic function has no kernel that depends on the angle alone",
            ));
        }
        let model: Model<f64, 3> = spec.build()?;
        if model.is_delta() {
            return Err(fail(
                "a mirror's kernel is a point; level 0 of a map shows it",
            ));
        }
        // Nodes of the table, and between them those of the quadrature for the albedo.
        let nodes: Vec<f64> = (0..=TABLE)
            .map(|i| T_MAX * i as f64 / TABLE as f64)
            .collect();
        let values = evaluate(&model, &nodes);
        let rule = GaussLegendre::new(4);
        let panels = 512;
        let mut albedo = [0.0; 3];
        let mut points = Vec::new();
        let mut weights = Vec::new();
        for k in 0..panels {
            let edge = |k: usize| T_MAX * (k as f64 / panels as f64).powi(2);
            for (t, w) in rule.on(edge(k), edge(k + 1)) {
                points.push(t);
                // dω = 2π d(cos θ) and cos θ = 1 − 2t².
                weights.push(8.0 * PI * t * w);
            }
        }
        for (f, w) in evaluate(&model, &points).iter().zip(&weights) {
            for k in 0..3 {
                albedo[k] += f[k] * w;
            }
        }
        if albedo.iter().all(|a| *a <= 0.0) {
            return Err(fail("it reflects nothing towards its normal"));
        }
        let mean = |v: &[f64; 3]| (v[0] + v[1] + v[2]) / 3.0;
        let peak = values.iter().map(mean).fold(0.0, f64::max);
        let whole = mean(&albedo);
        let mut difference = 0.0f64;
        for v in &values {
            for k in 0..3 {
                if albedo[k] > 0.0 {
                    difference = difference.max((v[k] * whole / albedo[k] - mean(v)).abs() / peak);
                }
            }
        }
        Ok(Self::Model(Arc::new(ModelKernel {
            name: spec.to_string(),
            albedo,
            colour_difference: difference,
            values: values.iter().map(|v| (mean(v) / peak) as f32).collect(),
        })))
    }

    /// K at the squared chord `q` in \[0, 2], up to a constant factor; at most about 1.
    #[inline(always)]
    pub fn value(&self, q: f64) -> f64 {
        match self {
            Self::Ggx { alpha } => Ggx::new(*alpha).weight(q),
            Self::Charlie { alpha } => Charlie::new(*alpha).weight(q),
            Self::Cosine { exponent } => Cosine::new(*exponent).weight(q),
            Self::Model(m) => {
                let x = ((0.25 * q).max(0.0).sqrt() / T_MAX * TABLE as f64).min(TABLE as f64);
                let i = (x as usize).min(TABLE - 1);
                let t = x - i as f64;
                f64::from(m.values[i]) * (1.0 - t) + f64::from(m.values[i + 1]) * t
            }
        }
    }

    /// A length \[radians] over which the kernel changes near its axis: the width of the lobe.
    pub fn width(&self) -> f64 {
        match self {
            Self::Ggx { alpha } => 2.0 * alpha,
            Self::Charlie { alpha } => 2.0 * alpha.max(0.05),
            Self::Cosine { exponent } => (2.0 / (exponent + 1.0)).sqrt(),
            Self::Model(_) => {
                // Where it has fallen to half of its largest value.
                let peak = (0..=1024)
                    .map(|i| self.value(2.0 * (f64::from(i) / 1024.0).powi(4)))
                    .fold(0.0, f64::max);
                let falls = (0..=1024)
                    .rev()
                    .map(|i| 2.0 * (f64::from(i) / 1024.0).powi(4));
                let last = falls.into_iter().find(|q| self.value(*q) > 0.5 * peak);
                last.unwrap_or(2.0).sqrt().max(1e-4)
            }
        }
    }

    /// Mean of K over the hemisphere.
    pub fn mean(&self) -> f64 {
        let rule = GaussLegendre::new(8);
        let mut sum = 0.0;
        for k in 0..256 {
            // dω = π dq; panels crowd at the axis.
            let edge = |k: i32| 2.0 * (f64::from(k) / 256.0).powi(6);
            let [part] = rule.integrate(edge(k), edge(k + 1), |q| [self.value(q)]);
            sum += part;
        }
        0.5 * sum
    }
}

/// f·cos θ towards the normal at t = √(q/4). Ten thousand values once a level are too few for a batch, whose code for every model
/// would have to be compiled here.
fn evaluate(model: &Model<f64, 3>, t: &[f64]) -> Vec<[f64; 3]> {
    let wo = Vec3::new(0.0, 0.0, 1.0);
    t.iter()
        .map(|t| {
            let cos = (1.0 - 2.0 * t * t).max(0.0);
            let sin = 2.0 * t * (1.0 - t * t).max(0.0).sqrt();
            model.eval_cos(Vec3::new(sin, 0.0, cos), wo)
        })
        .collect()
}

/// A kernel over any number.
pub(crate) trait Weight {
    /// K at the squared chord q ≥ 0; 0 below the horizon.
    fn weight<R: Real>(&self, q: R) -> R;
}

/// GGX: cos θ (α²/(α² + (1 − α²) q/4))², from cos²θh = 1 − q/4.
#[derive(Clone, Copy)]
pub(crate) struct Ggx {
    a2: f64,
}

impl Ggx {
    pub fn new(alpha: f64) -> Self {
        Self { a2: alpha * alpha }
    }
}

impl Weight for Ggx {
    #[inline(always)]
    fn weight<R: Real>(&self, q: R) -> R {
        let cos = (R::one() - R::lit(0.5) * q).max(R::zero());
        let e = R::lit(self.a2) / (R::lit(self.a2) + R::lit(0.25 * (1.0 - self.a2)) * q);
        cos * (e * e)
    }
}

/// Charlie: cos θ (q/2)^(1/2α), from sin²θh = q/4.
#[derive(Clone, Copy)]
pub(crate) struct Charlie {
    power: f64,
}

impl Charlie {
    pub fn new(alpha: f64) -> Self {
        Self { power: 0.5 / alpha }
    }
}

impl Weight for Charlie {
    #[inline(always)]
    fn weight<R: Real>(&self, q: R) -> R {
        let half = R::lit(0.5) * q;
        let cos = (R::one() - half).max(R::zero());
        cos * (half.max(R::lit(1e-30)).ln() * R::lit(self.power)).exp()
    }
}

/// cosⁿ θ.
#[derive(Clone, Copy)]
pub(crate) struct Cosine {
    exponent: f64,
}

impl Cosine {
    pub fn new(exponent: f64) -> Self {
        Self { exponent }
    }
}

impl Weight for Cosine {
    #[inline(always)]
    fn weight<R: Real>(&self, q: R) -> R {
        let cos = R::one() - R::lit(0.5) * q;
        let power = (cos.max(R::lit(1e-30)).ln() * R::lit(self.exponent)).exp();
        R::select(cos.gt(R::zero()), power, R::zero())
    }
}

/// Diffuse reflection, without its logarithm.
#[derive(Clone, Copy)]
pub(crate) struct Diffuse;

impl Weight for Diffuse {
    #[inline(always)]
    fn weight<R: Real>(&self, q: R) -> R {
        (R::one() - R::lit(0.5) * q).max(R::zero())
    }
}

impl ModelKernel {
    /// K for a lane's worth of squared chords.
    #[inline(always)]
    pub(crate) fn look_up(&self, q: f32) -> f32 {
        let x = ((0.25 * q).max(0.0).sqrt() * (TABLE as f64 / T_MAX) as f32).min(TABLE as f32);
        let i = (x as usize).min(TABLE - 1);
        let t = x - i as f32;
        self.values[i] * (1.0 - t) + self.values[i + 1] * t
    }
}
