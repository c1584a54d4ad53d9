//! [`Brdf`], what every reflection function can do.

use crate::part::colour::{each_component, grey, scale};
use gonio_num::{Mask, Real, Vec3};

/// A direction drawn by [`Brdf::sample`].
#[derive(Debug, Clone, Copy)]
pub struct Sample<R: Real, const N: usize> {
    /// Direction to the light, unit, local frame.
    pub wi: Vec3<R>,
    /// f·|cosθi| / pdf for each colour component; 0 where `pdf` is 0.
    pub weight: [R; N],
    /// Density per solid angle in sr⁻¹, of the whole function (not of the part that was chosen); where `delta` is true,
    /// the probability of choosing this discrete direction. 0: no direction was drawn.
    pub pdf: R,
    /// Whether `wi` is a discrete direction (a mirror's), which `eval` and `pdf` cannot see.
    pub delta: R::Mask,
}

impl<R: Real, const N: usize> Sample<R, N> {
    /// Nothing: pdf 0, weight 0, direction +z.
    #[inline(always)]
    pub fn none() -> Self {
        Self {
            wi: Vec3::new(R::zero(), R::zero(), R::one()),
            weight: [R::zero(); N],
            pdf: R::zero(),
            delta: R::Mask::splat(false),
        }
    }

    /// A direction with density `pdf`, whose f·|cosθi| is `eval_cos`. Nothing where `pdf` is not positive.
    #[inline(always)]
    pub fn continuous(wi: Vec3<R>, eval_cos: [R; N], pdf: R) -> Self {
        // Below the smallest normal number a quotient loses its digits or overflows: such a draw is nothing.
        let valid = pdf.gt(R::lit(1e-37));
        let over = R::select(valid, pdf, R::one()).recip();
        let mut weight = eval_cos;
        each_component!(N, k => { weight[k] = R::select(valid, eval_cos[k] * over, R::zero()); });
        let up = Vec3::new(R::zero(), R::zero(), R::one());
        Self {
            wi: Vec3::select(valid, wi, up),
            weight,
            pdf: R::select(valid, pdf, R::zero()),
            delta: R::Mask::splat(false),
        }
    }

    /// `a` where the mask is true, `b` elsewhere.
    #[inline(always)]
    pub fn select(mask: R::Mask, a: Self, b: Self) -> Self {
        let mut weight = a.weight;
        each_component!(N, k => { weight[k] = R::select(mask, a.weight[k], b.weight[k]); });
        Self {
            wi: Vec3::select(mask, a.wi, b.wi),
            weight,
            pdf: R::select(mask, a.pdf, b.pdf),
            delta: (mask & a.delta) | (!mask & b.delta),
        }
    }
}

/// A reflection function with a way to sample it.
///
/// `wi` points to the light and `wo` to the viewer; both leave the surface, unit length, local frame with normal +z. Nothing
/// is ever NaN.
///
/// A function that only reflects is 0 where either has z ≤ 0. One that also transmits ([`Brdf::transmits`]) is a function of
/// both sides of the surface: +z leads out of the body, −z into it, and either direction may lie on either side. It scatters
/// *radiance*, which a refracting boundary scales: L/n² is what passes unchanged, with n the index of refraction of
/// the side. So f n(ωi)² is what is the same with the directions exchanged (Veach 1997, §5.2).
pub trait Brdf<R: Real, const N: usize> {
    /// f(wi→wo) in sr⁻¹, **without** the cosine. Discrete (mirror) parts are not seen here.
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N];

    /// f·|cosθi| in sr⁻¹.
    #[inline(always)]
    fn eval_cos(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        scale(self.eval(wi, wo), wi.z.abs())
    }

    /// Density in sr⁻¹ with which [`Brdf::sample`] draws `wi` for this `wo`. Its integral is at most 1: what is missing
    /// is the probability of drawing nothing or a discrete direction.
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R;

    /// [`Brdf::eval`] and [`Brdf::pdf`] at once, the same to the bit: for models where the two share work.
    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        (self.eval(wi, wo), self.pdf(wi, wo))
    }

    /// [`Brdf::eval_cos`] and [`Brdf::pdf`] at once, the same to the bit: what an estimator of reflected light needs.
    #[inline(always)]
    fn eval_cos_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let (f, pdf) = self.eval_and_pdf(wi, wo);
        (scale(f, wi.z.abs()), pdf)
    }

    /// The sample that has drawn `wi`: with the weight and the density of the whole function.
    #[inline(always)]
    fn sample_of(&self, wi: Vec3<R>, wo: Vec3<R>) -> Sample<R, N> {
        let (eval_cos, pdf) = self.eval_cos_and_pdf(wi, wo);
        Sample::continuous(wi, eval_cos, pdf)
    }

    /// Draws a direction to the light for the viewer's direction `wo` from `u` in [0, 1)³: `u[0]`, `u[1]` place it,
    /// `u[2]` chooses among parts.
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N>;

    /// A cheap estimate of the directional albedo (mean over the colours), the probability weight with which a sum
    /// chooses this part. It steers efficiency only: no result depends on it.
    fn albedo_estimate(&self, wo: Vec3<R>) -> R;

    /// Whether light may pass to the other side of the surface.
    #[inline(always)]
    fn transmits(&self) -> bool {
        false
    }

    /// Index of refraction of the inner side (−z) over the outer side (+z) for each component, > 0: radiance that passes
    /// inwards is multiplied by its square, outwards divided. 1 for what doesn't refract.
    #[inline(always)]
    fn relative_ior(&self) -> [R; N] {
        grey(R::one())
    }

    /// Absorption coefficient σ ≥ 0 of the inner side for each component, in units of 1/length of the scene: over a distance d
    /// a fraction e^(−σd) of the radiance remains (Bouguer, Lambert, Beer). 0 for what isn't transmitted.
    #[inline(always)]
    fn absorption(&self) -> [R; N] {
        grey(R::zero())
    }
}
