//! [`Brdf`], what every reflection function can do.

use crate::part::colour::{each_component, scale};
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

    /// A direction with density `pdf`, whose f·|cosθi| is `eval_cos`. Nothing where `pdf` is not positive or `wi` is
    /// not above the horizon.
    #[inline(always)]
    pub fn continuous(wi: Vec3<R>, eval_cos: [R; N], pdf: R) -> Self {
        // Below the smallest normal number a quotient loses its digits or overflows: such a draw is nothing.
        let valid = pdf.gt(R::lit(1e-37)) & wi.z.gt(R::zero());
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
/// `wi` points to the light and `wo` to the viewer; both leave the surface, unit length, local frame with normal +z. Where
/// either has z ≤ 0 everything is 0. Nothing is ever NaN.
pub trait Brdf<R: Real, const N: usize> {
    /// f(wi→wo) in sr⁻¹, **without** the cosine. Discrete (mirror) parts are not seen here.
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N];

    /// f·cosθi in sr⁻¹: [`Brdf::eval`] times max(wi.z, 0).
    #[inline(always)]
    fn eval_cos(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        scale(self.eval(wi, wo), wi.z.max(R::zero()))
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
        (scale(f, wi.z.max(R::zero())), pdf)
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
}
