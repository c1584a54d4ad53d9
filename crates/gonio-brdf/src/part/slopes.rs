//! Slope scales along two axes: how a description gives them, and the frame they are meant in.

use super::distribution::ALPHA_MIN;
use super::geometry::turned;
use crate::{BrdfError, ModelSpec, ParameterInfo};
use gonio_num::{Real, Vec3};
use std::f64::consts::PI;

/// Slope scales αx, αy and the angle from the tangent to the x axis.
#[derive(Debug, Clone, Copy)]
pub struct Slopes<R> {
    /// Slope scale along x, [[`ALPHA_MIN`], 1].
    pub alpha_x: R,
    /// Slope scale along y, [[`ALPHA_MIN`], 1].
    pub alpha_y: R,
    /// Cosine and sine of the rotation of the x axis, if any.
    pub rotation: Option<[R; 2]>,
    alpha: R,
    aspect: R,
}

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
pub(crate) const ROTATION_DEG: ParameterInfo = ParameterInfo::number(
    "rotation_deg",
    "°",
    (-360.0, 360.0),
    Some(0.0),
    "angle from the tangent to the direction of alpha_x, counter-clockwise seen from above",
);

/// Whether a description has αx = αy.
pub(crate) fn isotropic(spec: &ModelSpec) -> bool {
    scales(spec).is_ok_and(|(x, y)| x == y)
}

/// (αx, αy) of a description.
fn scales(spec: &ModelSpec) -> Result<(f64, f64), BrdfError> {
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

/// a = √(1 − 0.9 anisotropy).
fn aspect<R: Real>(anisotropy: R) -> R {
    (R::one() - R::lit(0.9) * anisotropy).sqrt()
}

impl<R: Real> Slopes<R> {
    /// From `roughness`, `alpha`, `anisotropy`, `alpha_x`, `alpha_y` and `rotation_deg`.
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let (x, y) = scales(spec)?;
        let rotation_deg: f64 = spec.real("rotation_deg");
        let turn = R::lit(rotation_deg * PI / 180.0);
        Ok(Self {
            alpha_x: R::lit(x),
            alpha_y: R::lit(y),
            rotation: (rotation_deg != 0.0 && x != y).then(|| [turn.cos(), turn.sin()]),
            alpha: R::lit((x * y).sqrt()),
            aspect: R::lit((y / x).sqrt()),
        })
    }

    /// Of slope scales along x and y, limited to their range.
    pub(crate) fn of_scales(alpha_x: R, alpha_y: R) -> Self {
        let floor = |a: R| a.clamp(R::lit(ALPHA_MIN), R::one());
        let (alpha_x, alpha_y) = (floor(alpha_x), floor(alpha_y));
        Self {
            alpha_x,
            alpha_y,
            rotation: None,
            alpha: (alpha_x * alpha_y).sqrt(),
            aspect: (alpha_y / alpha_x).sqrt(),
        }
    }

    /// Of a perceptual roughness, an anisotropy and a rotation in degrees.
    pub(crate) fn new(roughness: R, anisotropy: R, rotation_deg: R) -> Self {
        let turn = rotation_deg * R::lit(PI / 180.0);
        let mut slopes = Self {
            alpha_x: R::one(),
            alpha_y: R::one(),
            rotation: Some([turn.cos(), turn.sin()]),
            alpha: roughness * roughness,
            aspect: R::one(),
        };
        slopes.set("anisotropy", anisotropy);
        slopes
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Slopes<S> {
        Slopes {
            alpha_x: f(self.alpha_x),
            alpha_y: f(self.alpha_y),
            rotation: self.rotation.map(|[c, s]| [f(c), f(s)]),
            alpha: f(self.alpha),
            aspect: f(self.aspect),
        }
    }

    /// Sets one of the six parameters; another name changes nothing.
    pub(crate) fn set(&mut self, parameter: &str, x: R) {
        let floor = |a: R| a.clamp(R::lit(ALPHA_MIN), R::one());
        match parameter {
            "roughness" => self.alpha = x * x,
            "alpha" => self.alpha = x,
            "anisotropy" => self.aspect = aspect(x),
            "alpha_x" => return self.alpha_x = floor(x),
            "alpha_y" => return self.alpha_y = floor(x),
            "rotation_deg" => {
                let turn = x * R::lit(PI / 180.0);
                return self.rotation = Some([turn.cos(), turn.sin()]);
            }
            _ => return,
        }
        self.alpha_x = floor(self.alpha / self.aspect);
        self.alpha_y = floor(self.alpha * self.aspect);
    }

    /// A direction in the frame of αx and αy.
    #[inline(always)]
    pub fn in_axes(&self, w: Vec3<R>) -> Vec3<R> {
        match self.rotation {
            Some([c, s]) => turned(w, c, -s),
            None => w,
        }
    }

    /// A direction of the frame of αx and αy in the local frame.
    #[inline(always)]
    pub fn from_axes(&self, w: Vec3<R>) -> Vec3<R> {
        match self.rotation {
            Some([c, s]) => turned(w, c, s),
            None => w,
        }
    }
}
