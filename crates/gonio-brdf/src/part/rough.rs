//! [`RoughSurface`], the facets of a rough surface: their distribution, masking and direction, and the parameters for them.

use super::distribution::{Distribution, Shape};
use super::geometry::Half;
use super::masking::Masking;
use super::slopes::{self, Slopes};
use crate::{BrdfError, ModelSpec, ParameterInfo};
use gonio_num::{Real, Vec3};

/// Facets with a distribution of normals, turned about the surface's normal.
#[derive(Debug, Clone, Copy)]
pub struct RoughSurface<R: Real> {
    /// D.
    pub distribution: Distribution<R>,
    /// G.
    pub masking: Masking,
    slopes: Slopes<R>,
}

/// `distribution`.
pub(crate) const DISTRIBUTION: ParameterInfo = ParameterInfo::choice(
    "distribution",
    Shape::NAMES,
    Some("ggx"),
    "distribution D of the facets' normals",
);
/// `gamma`.
pub(crate) const GAMMA: ParameterInfo = ParameterInfo::number(
    "gamma",
    "",
    (0.5, 40.0),
    None,
    "tail of gtr (0.5 to 10) and student-t (1.6 to 40): the larger, the shorter; 2 is ggx",
);
/// `p`.
pub(crate) const P: ParameterInfo = ParameterInfo::number(
    "p",
    "",
    (0.0, 2.0),
    None,
    "exponent p of sgd: the larger, the sharper its centre; 0.5 when not given",
);
/// `c`.
pub(crate) const C: ParameterInfo = ParameterInfo::number(
    "c",
    "",
    (0.0, 3.0),
    None,
    "exponent C of abc: the smaller, the longer its tail; 1 when not given",
);

/// The distribution of a description, whose word must be known.
pub(crate) fn shape(spec: &ModelSpec) -> Shape {
    Shape::from_name(&spec.word("distribution")).unwrap_or(Shape::Ggx)
}

impl<R: Real> RoughSurface<R> {
    /// From the parameters `distribution` (GGX for a model without), `roughness`, `alpha`, `anisotropy`, `alpha_x`, `alpha_y`,
    /// `rotation_deg`, `gamma`, `p` and `c` of a description.
    ///
    /// A parameter that another distribution needs is an error, not ignored.
    pub(crate) fn from_spec(spec: &ModelSpec, masking: Masking) -> Result<Self, BrdfError> {
        let slopes = Slopes::from_spec(spec)?;
        let shape = shape(spec);
        if !slopes::isotropic(spec) && !shape.can_be_anisotropic() {
            return Err(BrdfError::Unsupported {
                what: format!(
                    "the distribution {} has one slope scale for all directions: it can't be anisotropic",
                    Shape::NAMES[shape.index()]
                ),
            });
        }
        let tail = shape.tail();
        for key in ["gamma", "p", "c"] {
            if spec.values.contains_key(key) && tail.is_none_or(|t| t.name != key) {
                let users = Shape::ALL
                    .into_iter()
                    .filter(|s| s.tail().is_some_and(|t| t.name == key));
                let users: Vec<_> = users.map(|s| Shape::NAMES[s.index()]).collect();
                let found = Shape::NAMES[shape.index()];
                return Err(spec.wrong(
                    key,
                    &format!(
                        "no value here: only distribution={} uses it, and distribution is {found}",
                        users.join(" or ")
                    ),
                ));
            }
        }
        let mut value = 0.0;
        if let Some(tail) = tail {
            value = spec.number(tail.name).unwrap_or(tail.default);
            let (low, high) = tail.range;
            if !(low..=high).contains(&value) {
                let name = Shape::NAMES[shape.index()];
                return Err(spec.wrong(tail.name, &format!("{low} to {high} for {name}")));
            }
        }
        Ok(Self {
            distribution: Distribution::new(shape, slopes.alpha_x, slopes.alpha_y, R::lit(value)),
            masking,
            slopes,
        })
    }

    /// GGX of a perceptual roughness, an anisotropy and a rotation in degrees as in the parameters
    /// of these names.
    pub(crate) fn ggx(masking: Masking, roughness: R, anisotropy: R, rotation_deg: R) -> Self {
        Self::ggx_of(masking, Slopes::new(roughness, anisotropy, rotation_deg))
    }

    /// GGX of slope scales along x and y.
    pub(crate) fn ggx_of_slopes(masking: Masking, alpha_x: R, alpha_y: R) -> Self {
        Self::ggx_of(masking, Slopes::of_scales(alpha_x, alpha_y))
    }

    fn ggx_of(masking: Masking, slopes: Slopes<R>) -> Self {
        let (x, y) = (slopes.alpha_x, slopes.alpha_y);
        Self {
            distribution: Distribution::new(Shape::Ggx, x, y, R::zero()),
            masking,
            slopes,
        }
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> RoughSurface<S> {
        RoughSurface {
            distribution: self.distribution.cast(f),
            masking: self.masking,
            slopes: self.slopes.cast(f),
        }
    }

    /// Sets one of its parameters; false if it has no such.
    pub(crate) fn set(&mut self, parameter: &str, x: R) -> bool {
        match parameter {
            "roughness" | "alpha" | "anisotropy" | "alpha_x" | "alpha_y" | "rotation_deg" => {
                self.slopes.set(parameter, x);
                self.distribution
                    .set_alpha(self.slopes.alpha_x, self.slopes.alpha_y);
                true
            }
            "gamma" | "p" | "c" => {
                let tail = self.distribution.shape().tail();
                if tail.is_some_and(|t| t.name == parameter) {
                    self.distribution.set_tail(x);
                }
                true
            }
            _ => false,
        }
    }

    /// A direction in the frame of (αx, αy).
    #[inline(always)]
    pub fn into_axes(&self, w: Vec3<R>) -> Vec3<R> {
        self.slopes.in_axes(w)
    }

    /// A direction back from the frame of (αx, αy).
    #[inline(always)]
    pub fn out_of_axes(&self, w: Vec3<R>) -> Vec3<R> {
        self.slopes.from_axes(w)
    }

    /// A normal drawn towards `wo` (in the frame of the slope scales, above the surface): by visible normals where that is closed
    /// form. Its density over the cosine to `wo` is [`RoughSurface::normal_density_over_cos`].
    #[inline(always)]
    pub fn sample_normal(&self, wo: Vec3<R>, u0: R, u1: R) -> Vec3<R> {
        match self.distribution.shape() {
            Shape::Ggx => self.distribution.sample_visible_ggx(wo, u0, u1),
            _ => self.distribution.sample_normal(u0, u1),
        }
    }

    /// The density of [`RoughSurface::sample_normal`] in sr⁻¹, over `cos`.
    ///
    /// - `d`: D(h)
    #[inline(always)]
    pub fn normal_density_over_cos(&self, half: &Half<R>, d: R, wo: Vec3<R>) -> R {
        match self.distribution.shape() {
            Shape::Ggx => d * super::masking::smith_g1_over_cos(&self.distribution, wo),
            _ => self.distribution.normal_density(half.h(), d) / half.cos.max(R::lit(1e-15)),
        }
    }
}
