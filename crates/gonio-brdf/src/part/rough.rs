//! [`RoughSurface`], the facets of a rough surface: their distribution, masking and direction, and the parameters for them.

use super::distribution::{ALPHA_MIN, Distribution, Shape};
use super::geometry::turned;
use super::masking::Masking;
use crate::{BrdfError, ModelSpec, ParameterInfo};
use gonio_num::{Real, Vec3};
use std::f64::consts::PI;

/// Facets with a distribution of normals, turned about the surface's normal.
#[derive(Debug, Clone, Copy)]
pub struct RoughSurface<R: Real> {
    /// D.
    pub distribution: Distribution<R>,
    /// G.
    pub masking: Masking,
    /// Cosine and sine of the rotation of the x axis, if any.
    rotation: Option<[R; 2]>,
    alpha: R,
    aspect: R,
}

/// `distribution`.
pub(crate) const DISTRIBUTION: ParameterInfo = ParameterInfo::choice(
    "distribution",
    Shape::NAMES,
    Some("ggx"),
    "distribution D of the facets' normals",
);
/// `roughness`.
pub(crate) const ROUGHNESS: ParameterInfo = ParameterInfo::number(
    "roughness",
    "",
    (0.0, 1.0),
    Some(0.3),
    "perceptual roughness; alpha = roughness², not below 1e-4",
);
/// `alpha`.
pub(crate) const ALPHA: ParameterInfo = ParameterInfo::number(
    "alpha",
    "",
    (0.0, 1.0),
    None,
    "slope scale instead of roughness, not below 1e-4",
);
/// `anisotropy`.
pub(crate) const ANISOTROPY: ParameterInfo = ParameterInfo::number(
    "anisotropy",
    "",
    (0.0, 1.0),
    Some(0.0),
    "alpha_x = alpha/a, alpha_y = alpha·a with a = √(1 − 0.9 anisotropy) (Burley 2012)",
);
/// `alpha_x`.
pub(crate) const ALPHA_X: ParameterInfo = ParameterInfo::number(
    "alpha_x",
    "",
    (0.0, 1.0),
    None,
    "slope scale along x, with alpha_y, instead of the above",
);
/// `alpha_y`.
pub(crate) const ALPHA_Y: ParameterInfo = ParameterInfo::number(
    "alpha_y",
    "",
    (0.0, 1.0),
    None,
    "slope scale along y, with alpha_x",
);
/// `rotation_deg`.
pub(crate) const ROTATION: ParameterInfo = ParameterInfo::number(
    "rotation_deg",
    "°",
    (-360.0, 360.0),
    Some(0.0),
    "angle from the tangent to the direction of alpha_x, counter-clockwise seen from above",
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

/// a = √(1 − 0.9 anisotropy).
fn aspect<R: Real>(anisotropy: R) -> R {
    (R::one() - R::lit(0.9) * anisotropy).sqrt()
}

/// (αx, αy) of a description.
pub(crate) fn slope_scales(spec: &ModelSpec) -> Result<(f64, f64), BrdfError> {
    let given = |key: &str| spec.values.contains_key(key);
    let floor = |x: f64| x.clamp(ALPHA_MIN, 1.0);
    match (spec.number("alpha_x"), spec.number("alpha_y")) {
        (Some(x), Some(y)) => {
            for other in ["roughness", "alpha", "anisotropy"] {
                if given(other) {
                    return Err(spec.wrong(other, "no value beside alpha_x and alpha_y"));
                }
            }
            Ok((floor(x), floor(y)))
        }
        (None, None) => {
            if given("alpha") && given("roughness") {
                return Err(spec.wrong("alpha", "either roughness or alpha, not both"));
            }
            let roughness: f64 = spec.real("roughness");
            let alpha = spec.number("alpha").unwrap_or(roughness * roughness);
            let aspect = aspect(spec.real::<f64>("anisotropy"));
            Ok((floor(alpha / aspect), floor(alpha * aspect)))
        }
        (x, _) => {
            let missing = if x.is_some() { "alpha_y" } else { "alpha_x" };
            Err(spec.wrong(missing, "both alpha_x and alpha_y"))
        }
    }
}

/// Whether the surface of a description looks the same from all sides.
pub(crate) fn is_isotropic(spec: &ModelSpec) -> bool {
    slope_scales(spec).is_ok_and(|(x, y)| x == y)
}

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
        let (x, y) = slope_scales(spec)?;
        let shape = shape(spec);
        if x != y && !shape.can_be_anisotropic() {
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
        let rotation_deg: f64 = spec.real("rotation_deg");
        let turn = R::lit(rotation_deg * PI / 180.0);
        Ok(Self {
            distribution: Distribution::new(shape, R::lit(x), R::lit(y), R::lit(value)),
            masking,
            rotation: (rotation_deg != 0.0 && x != y).then(|| [turn.cos(), turn.sin()]),
            alpha: R::lit((x * y).sqrt()),
            aspect: R::lit((y / x).sqrt()),
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> RoughSurface<S> {
        RoughSurface {
            distribution: self.distribution.cast(f),
            masking: self.masking,
            rotation: self.rotation.map(|[c, s]| [f(c), f(s)]),
            alpha: f(self.alpha),
            aspect: f(self.aspect),
        }
    }

    /// Sets one of its parameters; false if it has no such.
    pub(crate) fn set(&mut self, parameter: &str, x: R) -> bool {
        let d = &mut self.distribution;
        match parameter {
            "roughness" => self.alpha = x * x,
            "alpha" => self.alpha = x,
            "anisotropy" => self.aspect = aspect(x),
            "alpha_x" => {
                let y = d.alpha_y();
                d.set_alpha(x, y);
                return true;
            }
            "alpha_y" => {
                let x_scale = d.alpha_x();
                d.set_alpha(x_scale, x);
                return true;
            }
            "rotation_deg" => {
                let turn = x * R::lit(PI / 180.0);
                self.rotation = Some([turn.cos(), turn.sin()]);
                return true;
            }
            "gamma" | "p" | "c" => {
                if d.shape().tail().is_some_and(|t| t.name == parameter) {
                    d.set_tail(x);
                }
                return true;
            }
            _ => return false,
        }
        d.set_alpha(self.alpha / self.aspect, self.alpha * self.aspect);
        true
    }

    /// A direction in the frame of (αx, αy).
    #[inline(always)]
    pub fn into_axes(&self, w: Vec3<R>) -> Vec3<R> {
        match self.rotation {
            Some([c, s]) => turned(w, c, -s),
            None => w,
        }
    }

    /// A direction back from the frame of (αx, αy).
    #[inline(always)]
    pub fn out_of_axes(&self, w: Vec3<R>) -> Vec3<R> {
        match self.rotation {
            Some([c, s]) => turned(w, c, s),
            None => w,
        }
    }

    /// A normal drawn towards `wo` (in the frame of the slope scales, above the surface): by visible normals where that is closed
    /// form. Its density is [`RoughSurface::normal_density`].
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
    /// - `cos`: wo·h
    #[inline(always)]
    pub fn normal_density_over_cos(&self, h: Vec3<R>, d: R, wo: Vec3<R>, cos: R) -> R {
        match self.distribution.shape() {
            Shape::Ggx => d * super::masking::smith_g1_over_cos(&self.distribution, wo),
            _ => self.distribution.normal_density(h, d) / cos.max(R::lit(1e-15)),
        }
    }
}
