//! The light that leaves a rough surface after several facets: what the single-scattering formula of Torrance and Sparrow loses.

use super::albedo::{self, Loss};
use super::colour::{cast, each_component, mean};
use super::fresnel::Fresnel;
use super::random_walk::WalkTable;
use super::rough::RoughSurface;
use crate::ParameterInfo;
use gonio_num::Real;
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

/// `interreflection`.
pub(crate) const PARAMETER: ParameterInfo = ParameterInfo::choice(
    "interreflection",
    &["kulla-conty", "turquin", "random-walk", "none"],
    Some("kulla-conty"),
    "light that leaves after several facets: a reciprocal lobe, a factor on the lobe of one facet, the walk itself, or none of it",
);

/// How the lost light is given back.
#[derive(Debug, Clone)]
pub enum Interreflection<R: Real, const N: usize> {
    /// Not at all.
    None,
    /// A lobe of its own, reciprocal: [`KullaConty`].
    KullaConty(KullaConty<R, N>),
    /// A factor on the lobe of one facet, 1 + F₀ (1 − E(μr))/E(μr): not reciprocal. Turquin 2019, "Practical Multiple
    /// Scattering Compensation for Microfacet Models", eq. 16.
    Turquin {
        /// Reflectance at normal incidence F₀.
        f0: [R; N],
    },
    /// The lobe of a random walk on Smith's surface (Heitz et al. 2016), traced when the model is built.
    RandomWalk(Arc<WalkTable>),
}

/// The lobe of Kulla & Conty 2017, "Revisiting Physically Based Shading at Imageworks":
///
/// f_ms = F_ms (1 − E(μi)) (1 − E(μr))/(π (1 − Ē)), F_ms = F̄² Ē/(1 − F̄ (1 − Ē))
///
/// where E is the directional albedo for F = 1 (a table over √μ and √α), Ē its mean and F̄ the mean reflectance: the geometric
/// series F̄^k (1 − Ē)^(k−1) Ē over k ≥ 2 facets.
#[derive(Debug, Clone, Copy)]
pub struct KullaConty<R: Real, const N: usize> {
    /// F̄.
    average: [R; N],
    /// F_ms.
    factor: [R; N],
    /// 1/(π (1 − Ē)).
    scale: R,
}

/// What leaves towards one viewer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Loose<R: Real> {
    /// 1 − E(μr).
    pub loss: R,
    /// Probability of drawing the lobe of several facets.
    pub probability: R,
}

impl<R: Real, const N: usize> Interreflection<R, N> {
    /// The surface's tables, and the slope scale they are read at: the smaller one, which loses less than the true surface, so that
    /// too little is given back, never too much.
    #[inline(always)]
    fn loss_table(surface: &RoughSurface<R>) -> (&'static Loss, R) {
        let d = &surface.distribution;
        let alpha = d.alpha_x().min(d.alpha_y());
        (albedo::losses(d.shape(), surface.masking), alpha)
    }

    /// 1 − E(μ) of the surface for reflectance 1.
    #[inline(always)]
    pub(crate) fn loss(surface: &RoughSurface<R>, mu: R) -> R {
        let (table, alpha) = Self::loss_table(surface);
        table.directional(mu, alpha, surface.distribution.tail())
    }

    /// The one called `word` for a surface and its reflectance; `random-walk` must have been traced by the caller.
    pub(crate) fn new(word: &str, surface: &RoughSurface<R>, fresnel: &Fresnel<R, N>) -> Self {
        match word {
            "kulla-conty" => Self::KullaConty(KullaConty::new(surface, fresnel)),
            "turquin" => Self::Turquin {
                f0: fresnel.eval(R::one()),
            },
            _ => Self::None,
        }
    }

    /// For a surface or reflectance that has changed.
    pub(crate) fn update(&mut self, surface: &RoughSurface<R>, fresnel: &Fresnel<R, N>) {
        match self {
            Self::KullaConty(lobe) => *lobe = KullaConty::new(surface, fresnel),
            Self::Turquin { f0 } => *f0 = fresnel.eval(R::one()),
            Self::None | Self::RandomWalk(_) => {}
        }
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Interreflection<S, N> {
        match self {
            Self::None => Interreflection::None,
            Self::KullaConty(lobe) => Interreflection::KullaConty(KullaConty {
                average: cast(lobe.average, f),
                factor: cast(lobe.factor, f),
                scale: f(lobe.scale),
            }),
            Self::Turquin { f0 } => Interreflection::Turquin { f0: cast(*f0, f) },
            Self::RandomWalk(walk) => Interreflection::RandomWalk(Arc::clone(walk)),
        }
    }
}

impl<R: Real, const N: usize> KullaConty<R, N> {
    fn new(surface: &RoughSurface<R>, fresnel: &Fresnel<R, N>) -> Self {
        let (table, alpha) = Interreflection::<R, N>::loss_table(surface);
        let mean_loss = table.mean(alpha, surface.distribution.tail());
        let average = fresnel.average();
        let mut factor = average;
        for f in &mut factor {
            *f = *f * *f * (R::one() - mean_loss) / (R::one() - *f * mean_loss);
        }
        Self {
            average,
            factor,
            scale: R::lit(FRAC_1_PI) / mean_loss.max(R::lit(1e-9)),
        }
    }

    /// Towards a viewer at cosine `mu`.
    #[inline(always)]
    pub(crate) fn towards(&self, surface: &RoughSurface<R>, mu: R) -> Loose<R> {
        let loss = Interreflection::<R, N>::loss(surface, mu);
        let many = loss * mean(self.factor);
        let once = (R::one() - loss) * mean(self.average) + R::lit(1e-20);
        Loose {
            loss,
            probability: many / (many + once),
        }
    }

    /// The lobe's value, with the losses in both directions.
    #[inline(always)]
    pub(crate) fn value(&self, loss_i: R, loss_o: R) -> [R; N] {
        let shape = loss_i * loss_o * self.scale;
        let mut f = self.factor;
        each_component!(N, k => { f[k] = f[k] * shape; });
        f
    }
}
