//! Distributions of microfacet normals: density, and sampling with exact densities.

mod abc;
mod beckmann;
mod blinn_phong;
mod gaussian;
mod ggx;
mod gtr;
mod sgd;
mod student_t;
#[cfg(test)]
pub(super) mod tests;

use super::geometry::Half;
use super::special::integral;
use gonio_num::{Real, Vec3, Work};
use gonio_radiometry::warp::around_axis;

/// Which distribution of normals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Beckmann & Spizzichino 1963: Gaussian slopes.
    Beckmann,
    /// Trowbridge & Reitz 1975, "GGX" in Walter et al. 2007: long tails.
    Ggx,
    /// Blinn 1977: a power of the cosine, exponent p = 2/α² − 2; anisotropic as in Ashikhmin & Shirley 2000.
    BlinnPhong,
    /// Torrance & Sparrow 1967: a Gaussian in the angle θh.
    Gaussian,
    /// Burley 2012, "generalized Trowbridge–Reitz": tails by an exponent γ; γ = 2 is GGX.
    Gtr,
    /// Ribardière et al. 2017: Student's t-distribution of slopes; γ = 2 is GGX, γ → ∞ Beckmann.
    StudentT,
    /// Bagher et al. 2012: shifted gamma distribution.
    ShiftedGamma,
    /// Löw et al. 2012: 1/(1 + B (1 − cosθh))ᶜ, after the ABC model of Church & Takacs 1991.
    Abc,
}

impl Shape {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Beckmann,
        Self::Ggx,
        Self::BlinnPhong,
        Self::Gaussian,
        Self::Gtr,
        Self::StudentT,
        Self::ShiftedGamma,
        Self::Abc,
    ];

    /// The words for them in a description, in the order of [`Shape::ALL`].
    pub const NAMES: &'static [&'static str] = &[
        "beckmann",
        "ggx",
        "blinn-phong",
        "gaussian",
        "gtr",
        "student-t",
        "sgd",
        "abc",
    ];

    /// The shape of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        let index = Self::NAMES.iter().position(|n| *n == name)?;
        Some(Self::ALL[index])
    }

    /// Its place in [`Shape::ALL`].
    pub const fn index(self) -> usize {
        match self {
            Self::Beckmann => 0,
            Self::Ggx => 1,
            Self::BlinnPhong => 2,
            Self::Gaussian => 3,
            Self::Gtr => 4,
            Self::StudentT => 5,
            Self::ShiftedGamma => 6,
            Self::Abc => 7,
        }
    }

    /// Whether it has two slope scales: those whose slopes are a stretched image of a round distribution, and Blinn–Phong.
    pub const fn can_be_anisotropic(self) -> bool {
        matches!(
            self,
            Self::Beckmann | Self::Ggx | Self::BlinnPhong | Self::StudentT
        )
    }

    /// The parameter that sets its tail, with its range and default.
    pub const fn tail(self) -> Option<Tail> {
        match self {
            Self::Gtr => Some(Tail {
                name: "gamma",
                range: (0.5, 10.0),
                default: 2.0,
            }),
            Self::StudentT => Some(Tail {
                name: "gamma",
                range: (1.6, 40.0),
                default: 2.0,
            }),
            Self::ShiftedGamma => Some(Tail {
                name: "p",
                range: (0.0, 2.0),
                default: 0.5,
            }),
            Self::Abc => Some(Tail {
                name: "c",
                range: (0.0, 3.0),
                default: 1.0,
            }),
            _ => None,
        }
    }
}

/// The parameter that sets a distribution's tail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tail {
    /// Its name in a description.
    pub name: &'static str,
    /// Smallest and largest value.
    pub range: (f64, f64),
    /// When not given.
    pub default: f64,
}

/// A distribution of normals with slope scales along x and y.
///
/// Its density D satisfies ∫ D(h) h.z dh = 1 over the hemisphere (h in sr).
#[derive(Debug, Clone, Copy)]
pub struct Distribution<R> {
    shape: Shape,
    alpha_x: R,
    alpha_y: R,
    tail: R,
    /// D at the pole, for the shapes whose normalisation isn't a product of slope scales.
    peak: R,
    /// σ/α, see [`Distribution::spread`].
    spread: R,
}

/// The smallest slope scale: smaller ones are taken for this one. At it, single precision still resolves the peak to
/// about 0.1 %; for anything smoother use `mirror`.
pub const ALPHA_MIN: f64 = 1e-4;

/// How near to 1 the exponents of `gtr`, `sgd` and `abc` may be, where powers turn into logarithms: nearer ones are taken for 1 + this.
const CONTRAST: f64 = 1e-3;

impl<R: Real> Distribution<R> {
    /// The distribution of slope scales within [[`ALPHA_MIN`], 1], and its tail if it has one ([`Shape::tail`]); values outside
    /// count as the nearest end.
    ///
    /// A shape that can't be anisotropic takes √(αx αy) for both.
    pub fn new(shape: Shape, alpha_x: R, alpha_y: R, tail: R) -> Self {
        let mut d = Self {
            shape,
            alpha_x,
            alpha_y,
            tail: R::zero(),
            peak: R::one(),
            spread: R::one(),
        };
        if let Some(known) = shape.tail() {
            let (low, high) = known.range;
            let t = tail.clamp(R::lit(low), R::lit(high));
            // Student's t has no logarithm at 1, which isn't in its range.
            let near = (t - R::one()).abs().lt(R::lit(CONTRAST));
            d.tail = R::select(near, R::lit(1.0 + CONTRAST), t);
        }
        d.set_alpha(alpha_x, alpha_y);
        d
    }

    /// Beckmann's, of slope scales that are within [[`ALPHA_MIN`], 1].
    #[inline(always)]
    pub(crate) fn beckmann(alpha_x: R, alpha_y: R) -> Self {
        Self {
            shape: Shape::Beckmann,
            alpha_x,
            alpha_y,
            tail: R::zero(),
            peak: R::one(),
            spread: R::one(),
        }
    }

    /// An isotropic one without a tail parameter, or with its default.
    pub fn isotropic(shape: Shape, alpha: R) -> Self {
        let tail = shape.tail().map_or(0.0, |t| t.default);
        Self::new(shape, alpha, alpha, R::lit(tail))
    }

    /// Other slope scales.
    pub fn set_alpha(&mut self, alpha_x: R, alpha_y: R) {
        let limited = |a: R| a.clamp(R::lit(ALPHA_MIN), R::one());
        (self.alpha_x, self.alpha_y) = (limited(alpha_x), limited(alpha_y));
        if !self.shape.can_be_anisotropic() {
            let a = (self.alpha_x * self.alpha_y).sqrt();
            (self.alpha_x, self.alpha_y) = (a, a);
        }
        self.peak = match self.shape {
            Shape::Beckmann | Shape::Ggx | Shape::BlinnPhong | Shape::StudentT => R::one(),
            Shape::Gaussian => gaussian::peak(self.alpha_x),
            Shape::Gtr => gtr::peak(self.alpha_x, self.tail),
            Shape::ShiftedGamma => sgd::peak(self.alpha_x, self.tail),
            Shape::Abc => abc::peak(self.alpha_x, self.tail),
        };
        self.spread = match self.shape {
            Shape::Beckmann | Shape::Ggx | Shape::BlinnPhong => R::one(),
            Shape::StudentT => student_t::spread(self.tail),
            _ => self.mean_slope() / self.alpha_x,
        };
    }

    /// 4 ∫ D sin²θ dθ, for a round distribution.
    fn mean_slope(&self) -> R {
        // Over y = ln tanθ: D has features from a fraction of α² (`sgd`) to the horizon.
        let sum: R = integral(-20.0, 12.0, 12, |y: R| {
            let tan = y.exp();
            let cos = (R::one() + tan * tan).sqrt().recip();
            let sin = tan * cos;
            // dθ = tanθ cos²θ dy
            self.density(Vec3::new(sin, R::zero(), cos)) * sin * sin * (sin * cos)
        });
        R::lit(4.0) * sum
    }

    /// Another tail.
    pub fn set_tail(&mut self, tail: R) {
        *self = Self::new(self.shape, self.alpha_x, self.alpha_y, tail);
    }

    /// Which one.
    #[inline(always)]
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// Slope scale along x, [[`ALPHA_MIN`], 1].
    #[inline(always)]
    pub fn alpha_x(&self) -> R {
        self.alpha_x
    }

    /// Slope scale along y, [[`ALPHA_MIN`], 1].
    #[inline(always)]
    pub fn alpha_y(&self) -> R {
        self.alpha_y
    }

    /// The parameter of its tail; 0 for a shape without.
    #[inline(always)]
    pub fn tail(&self) -> R {
        self.tail
    }

    /// σ/α, where σ = 2 lim (1 + Λ(w)) w.z towards grazing w, by which masking is measured: 2/π times the mean slope tanθ of the
    /// surface. 1 for GGX; also for Beckmann and Blinn–Phong, whose masking isn't measured by it.
    #[inline(always)]
    pub fn spread(&self) -> R {
        self.spread
    }

    /// D(h) in sr⁻¹; 0 for h.z ≤ 0.
    ///
    /// - `h`: unit, local frame
    ///
    /// The formulas stand in the files of the shapes.
    #[inline(always)]
    pub fn density(&self, h: Vec3<R>) -> R {
        let d = match self.shape {
            Shape::Beckmann => beckmann::density(self, h),
            Shape::Ggx => ggx::density(self, h),
            _ => R::out_of_line(DensityOf(self, h)),
        };
        R::select(h.z.gt(R::zero()), d, R::zero())
    }

    /// [`Distribution::density`] of a half vector above the horizon, which for GGX needn't be normalised first; 0 where it vanishes.
    #[inline(always)]
    pub fn density_of(&self, half: &Half<R>) -> R {
        match self.shape {
            Shape::Ggx => ggx::density_along(self, half.sum, half.length2),
            _ => self.density(half.h()),
        }
    }

    /// A normal of density [`Distribution::normal_density`].
    ///
    /// `u0`, `u1`: in [0, 1).
    #[inline(always)]
    pub fn sample_normal(&self, u0: R, u1: R) -> Vec3<R> {
        match self.shape {
            Shape::Beckmann => beckmann::sample(self, u0, u1),
            Shape::Ggx => ggx::sample(self, u0, u1),
            _ => R::out_of_line(SampleOf(self, [u0, u1])),
        }
    }

    /// The density in sr⁻¹ of the normals of [`Distribution::sample_normal`], where D(h) = `d`: D(h)·h.z where that can be drawn in
    /// closed form, near it for the others.
    #[inline(always)]
    pub fn normal_density(&self, h: Vec3<R>, d: R) -> R {
        match self.shape {
            Shape::Gaussian | Shape::ShiftedGamma | Shape::Abc => {
                R::out_of_line(SampleDensityOf(self, h))
            }
            _ => d * h.z,
        }
    }

    /// A normal with density D(h) G₁(w) max(w·h, 0)/w.z: those of the GGX distribution that are visible from `w`. For other shapes
    /// it has no meaning.
    #[inline(always)]
    pub fn sample_visible_ggx(&self, w: Vec3<R>, u0: R, u1: R) -> Vec3<R> {
        ggx::sample_visible(self, w, u0, u1)
    }

    /// The same with another number type.
    pub fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Distribution<S> {
        Distribution {
            shape: self.shape,
            alpha_x: f(self.alpha_x),
            alpha_y: f(self.alpha_y),
            tail: f(self.tail),
            peak: f(self.peak),
            spread: f(self.spread),
        }
    }

    /// (h.x/αx)² + (h.y/αy)².
    #[inline(always)]
    fn stretched(&self, h: Vec3<R>) -> R {
        (h.x / self.alpha_x).sq() + (h.y / self.alpha_y).sq()
    }
}

/// D of the less usual shapes, which are not part of every kernel's code.
struct DensityOf<'a, R>(&'a Distribution<R>, Vec3<R>);

impl<R: Real> Work for DensityOf<'_, R> {
    type Output = R;
    #[inline(always)]
    fn run(self) -> R {
        let Self(d, h) = self;
        match d.shape {
            Shape::Beckmann => beckmann::density(d, h),
            Shape::Ggx => ggx::density(d, h),
            Shape::BlinnPhong => blinn_phong::density(d, h),
            Shape::Gaussian => gaussian::density(d, h),
            Shape::Gtr => gtr::density(d, h),
            Shape::StudentT => student_t::density(d, h),
            Shape::ShiftedGamma => sgd::density(d, h),
            Shape::Abc => abc::density(d, h),
        }
    }
}

/// A normal of the less usual shapes.
struct SampleOf<'a, R>(&'a Distribution<R>, [R; 2]);

impl<R: Real> Work for SampleOf<'_, R> {
    type Output = Vec3<R>;
    #[inline(always)]
    fn run(self) -> Vec3<R> {
        let Self(d, [u0, u1]) = self;
        match d.shape {
            Shape::Beckmann => beckmann::sample(d, u0, u1),
            Shape::Ggx => ggx::sample(d, u0, u1),
            Shape::BlinnPhong => blinn_phong::sample(d, u0, u1),
            Shape::Gaussian => gaussian::sample(d, u0, u1),
            Shape::Gtr => gtr::sample(d, u0, u1),
            Shape::StudentT => student_t::sample(d, u0, u1),
            Shape::ShiftedGamma => sgd::sample(d, u0, u1),
            Shape::Abc => abc::sample(d, u0, u1),
        }
    }
}

/// The density of a normal that is drawn otherwise than by D h.z.
struct SampleDensityOf<'a, R>(&'a Distribution<R>, Vec3<R>);

impl<R: Real> Work for SampleDensityOf<'_, R> {
    type Output = R;
    #[inline(always)]
    fn run(self) -> R {
        let Self(d, h) = self;
        match d.shape {
            Shape::Gaussian => gaussian::sample_density(d, h),
            Shape::ShiftedGamma => sgd::sample_density(d, h),
            _ => abc::sample_density(d, h),
        }
    }
}

/// sin²θ of a direction, which keeps its digits near the pole.
#[inline(always)]
fn sin2<R: Real>(h: Vec3<R>) -> R {
    h.x * h.x + h.y * h.y
}

/// cos²θ of a direction, not below 1e-12.
#[inline(always)]
fn cos2<R: Real>(h: Vec3<R>) -> R {
    (h.z * h.z).max(R::lit(1e-12))
}

/// The direction with this sin²θ, at the azimuth 2π`u0`.
#[inline(always)]
fn at_sin2<R: Real>(sin2: R, u0: R) -> Vec3<R> {
    let s = sin2.saturate();
    around_axis(u0, s.safe_sqrt(), (R::one() - s).safe_sqrt())
}

/// The normal with slopes r (αx cos 2πu, αy sin 2πu).
#[inline(always)]
fn slopes<R: Real>(d: &Distribution<R>, r: R, u: R) -> Vec3<R> {
    let v = around_axis(u, r, R::one());
    Vec3::new(d.alpha_x * v.x, d.alpha_y * v.y, R::one()).normalize()
}

/// 1 − `u1`, not below 1e-12: what a logarithm can take.
#[inline(always)]
fn rest<R: Real>(u1: R) -> R {
    (R::one() - u1).max(R::lit(1e-12))
}
