//! Lafortune's model: diffuse and up to three generalised cosine lobes.

use crate::part::colour::{cast, mean, only_where, scale};
use crate::part::geometry::above;
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Frame, Real, Vec3};
use gonio_radiometry::warp::{
    cosine_hemisphere, cosine_hemisphere_density, cosine_power_hemisphere,
};
use std::f64::consts::{FRAC_1_PI, TAU};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "lafortune",
    summary: "diffuse, and up to three generalised cosine lobes: off-specular, retro-reflective, anisotropic",
    paper: "Lafortune, Foo, Torrance & Greenberg 1997, \"Non-Linear Approximation of Reflectance Functions\"; Ngan, Durand & \
            Matusik 2005 for the normalised form",
    parameters: &[
        ParameterInfo::colour(
            "diffuse",
            (0.0, 1.0),
            Some([0.5; 3]),
            "diffuse reflectance kd",
        ),
        specular("specular", 0.5),
        coefficient(
            "cx",
            Some(-1.0),
            "Cx of the first lobe: −1 mirrors, 1 turns back",
        ),
        coefficient("cy", None, "Cy of the first lobe; as cx when not given"),
        coefficient("cz", Some(1.0), "Cz of the first lobe"),
        exponent("exponent"),
        specular("specular_2", 0.0),
        coefficient("cx_2", Some(-1.0), "Cx of the second lobe"),
        coefficient(
            "cy_2",
            None,
            "Cy of the second lobe; as cx_2 when not given",
        ),
        coefficient("cz_2", Some(1.0), "Cz of the second lobe"),
        exponent("exponent_2"),
        specular("specular_3", 0.0),
        coefficient("cx_3", Some(-1.0), "Cx of the third lobe"),
        coefficient("cy_3", None, "Cy of the third lobe; as cx_3 when not given"),
        coefficient("cz_3", Some(1.0), "Cz of the third lobe"),
        exponent("exponent_3"),
        ParameterInfo::choice(
            "normalisation",
            &["energy", "published"],
            Some("energy"),
            "published: ks·(…)ᵖ; energy: times (p + 2)/2π over the largest |C|ᵖ, so that no albedo of a lobe is above its ks",
        ),
    ],
    positional: None,
    aliases: &[],
    recordable: true,
    declares,
};

const fn specular(name: &'static str, default: f64) -> ParameterInfo {
    ParameterInfo::colour(
        name,
        (0.0, 10.0),
        Some([default; 3]),
        "scale ks of the lobe; 0: no such lobe",
    )
}

const fn coefficient(
    name: &'static str,
    default: Option<f64>,
    meaning: &'static str,
) -> ParameterInfo {
    let default = match default {
        Some(x) => Some([x; 3]),
        None => None,
    };
    ParameterInfo::colour(name, (-2.0, 2.0), default, meaning)
}

const fn exponent(name: &'static str) -> ParameterInfo {
    ParameterInfo::number(
        name,
        "",
        (0.0, 1e5),
        Some(20.0),
        "exponent p of the lobe: the larger, the narrower",
    )
}

/// The parameters of each lobe: ks, Cx, Cy, Cz, p.
const LOBES: [[&str; 5]; 3] = [
    ["specular", "cx", "cy", "cz", "exponent"],
    ["specular_2", "cx_2", "cy_2", "cz_2", "exponent_2"],
    ["specular_3", "cx_3", "cy_3", "cz_3", "exponent_3"],
];

/// The power of a lobe is limited to e to this: beyond it single precision overflows.
const LARGEST_LOG: f64 = 60.0;

/// RGB of Cx, Cy and Cz.
fn coefficients(spec: &ModelSpec, [_, x, y, z, _]: [&str; 5]) -> [[f64; 3]; 3] {
    let cx = spec.rgb(x).unwrap_or_default();
    [
        cx,
        spec.rgb(y).unwrap_or(cx),
        spec.rgb(z).unwrap_or_default(),
    ]
}

/// With u = ωi·(C∘ωr)/max|C|, |u| ≤ cosα for α about the axis of C∘ωr, and ∫ cosᵖα cosθ dω is largest about the normal,
/// 2π/(p + 2): the lobe's albedo is at most ks (energy) or 2π ks max|C|ᵖ/(p + 2).
fn declares(spec: &ModelSpec) -> Declares {
    let published = spec.word("normalisation") == "published";
    let mut bound = spec.rgb("diffuse").unwrap_or_default();
    let mut isotropic = true;
    for keys in LOBES {
        let ks = spec.rgb(keys[0]).unwrap_or_default();
        let [cx, cy, cz] = coefficients(spec, keys);
        let p: f64 = spec.real(keys[4]);
        isotropic &= ks == [0.0; 3] || cx == cy;
        for k in 0..3 {
            let most = cx[k].abs().max(cy[k].abs()).max(cz[k].abs());
            let gain = if published {
                TAU * most.powf(p) / (p + 2.0)
            } else {
                1.0
            };
            // 0 times infinity is 0 here: without ks there is no lobe.
            bound[k] += if ks[k] > 0.0 { ks[k] * gain } else { 0.0 };
        }
    }
    Declares {
        isotropic,
        ..Declares::physical(bound.into_iter().fold(0.0, f64::max))
    }
}

/// f = kd/π + Σ ks·c·max(0, Cx ωi.x ωr.x + Cy ωi.y ωr.y + Cz ωi.z ωr.z)ᵖ, over up to three lobes, for each colour.
///
/// - energy: c = (p + 2)/(2π max(|Cx|, |Cy|, |Cz|)ᵖ); only the ratios of the C count. With Cx = Cy = −Cz it is the normalised
///   Phong lobe. (Ngan et al. fit this form to measured materials.)
/// - published: c = 1 (Lafortune et al., eq. 4). The power is limited to e⁶⁰.
///
/// −Cx = −Cy = Cz: around the mirror direction; −Cx = −Cy > Cz: off-specular, towards the horizon; Cx, Cy, Cz > 0: back
/// towards the light; Cx ≠ Cy: anisotropic. Reciprocal in any case.
///
/// Sampling: each lobe by its cosine power around C∘ωr (for each colour its own, where the C are coloured) and the diffuse
/// part, in proportion to estimates of their albedo.
#[derive(Debug, Clone, Copy)]
pub struct Lafortune<R: Real, const N: usize> {
    /// kd, [0, 1].
    pub diffuse: [R; N],
    /// The lobes.
    pub lobes: [Lobe<R, N>; 3],
    /// Whether c normalises, otherwise c = 1.
    pub normalised: bool,
}

/// A generalised cosine lobe.
#[derive(Debug, Clone, Copy)]
pub struct Lobe<R: Real, const N: usize> {
    /// ks ≥ 0.
    pub specular: [R; N],
    /// Cx, Cy, Cz.
    pub c: [[R; N]; 3],
    /// p ≥ 0.
    pub exponent: R,
    /// Whether it is there at all: ks is not black.
    active: bool,
    /// Whether the C are the same for each colour: one axis then serves all.
    grey: bool,
    /// Whether Cy follows Cx.
    tied: bool,
}

/// A part to sample: an axis, a cosine power around it, and its weight in the choice.
struct Part<R> {
    axis: Vec3<R>,
    exponent: R,
    weight: R,
}

impl<R: Real, const N: usize> Lobe<R, N> {
    fn from_spec(spec: &ModelSpec, keys: [&str; 5], normalised: bool) -> Result<Self, BrdfError> {
        let rgb = coefficients(spec, keys);
        let specular = spec.rgb(keys[0]).unwrap_or_default();
        let exponent: f64 = spec.real(keys[4]);
        let active = specular != [0.0; 3];
        if active && !normalised {
            let most = rgb
                .as_flattened()
                .iter()
                .fold(0.0, |a: f64, c| a.max(c.abs()));
            if exponent * most.max(1e-300).ln() > LARGEST_LOG {
                return Err(spec.wrong(
                    keys[4],
                    "a lobe whose power stays below e⁶⁰: smaller C, a smaller exponent, or normalisation=energy",
                ));
            }
        }
        let mut c = [[R::zero(); N]; 3];
        for (axis, key) in [1, 2, 3].into_iter().enumerate() {
            c[axis] = spec.components(keys[key], rgb[axis])?;
        }
        Ok(Self {
            specular: spec.colour(keys[0])?,
            c,
            exponent: R::lit(exponent),
            active,
            grey: rgb.iter().all(|c| c[0] == c[1] && c[1] == c[2]),
            tied: spec.rgb(keys[2]).is_none(),
        })
    }

    fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Lobe<S, N> {
        Lobe {
            specular: cast(self.specular, f),
            c: [cast(self.c[0], f), cast(self.c[1], f), cast(self.c[2], f)],
            exponent: f(self.exponent),
            active: self.active,
            grey: self.grey,
            tied: self.tied,
        }
    }

    /// Sets what stands at place `at` of [`LOBES`].
    fn set(&mut self, at: usize, value: [R; 3]) {
        let colour = super::components(value);
        match at {
            0 => (self.specular, self.active) = (colour, true),
            4 => self.exponent = value[0],
            axis => {
                self.grey = false;
                self.c[axis - 1] = colour;
                match axis {
                    1 if self.tied => self.c[1] = colour,
                    2 => self.tied = false,
                    _ => {}
                }
            }
        }
    }

    /// The largest |C| of colour `k`, not 0.
    #[inline(always)]
    fn most(&self, k: usize) -> R {
        let [x, y, z] = [self.c[0][k], self.c[1][k], self.c[2][k]];
        x.abs().max(y.abs()).max(z.abs()).max(R::lit(1e-15))
    }

    /// `base`ᵖ, 0 where `base` ≤ 0.
    #[inline(always)]
    fn power(&self, base: R) -> R {
        let log = self.exponent * base.max(R::lit(1e-37)).ln();
        let power = log.min(R::lit(LARGEST_LOG)).exp();
        R::select(base.gt(R::zero()), power, R::zero())
    }

    /// ks·c·(C·(ωi∘ωr))ᵖ of colour `k`, with c over (p + 2)/2π if normalised.
    #[inline(always)]
    fn value(&self, normalised: bool, k: usize, product: Vec3<R>) -> R {
        let base = self.c[0][k] * product.x + self.c[1][k] * product.y + self.c[2][k] * product.z;
        if normalised {
            let power = self.power((base / self.most(k)).min(R::one()));
            self.specular[k] * power * (self.exponent + R::lit(2.0)) * R::lit(0.5 * FRAC_1_PI)
        } else {
            self.specular[k] * self.power(base)
        }
    }

    /// The part that samples the lobe of colour `k` (of every colour, if they share the axis).
    #[inline(always)]
    fn part(&self, normalised: bool, k: usize, wo: Vec3<R>) -> Part<R> {
        let axis = Vec3::new(
            self.c[0][k] * wo.x,
            self.c[1][k] * wo.y,
            self.c[2][k] * wo.z,
        );
        let length2 = axis.length_squared();
        let tiny = R::lit(1e-30);
        let length = length2.max(tiny).sqrt();
        let up = Vec3::new(R::zero(), R::zero(), R::one());
        let axis = Vec3::select(length2.lt(tiny), up, axis * length.recip());
        let ks = if self.grey {
            mean(self.specular)
        } else {
            self.specular[k] * R::lit(1.0 / N as f64)
        };
        let (over, gain) = if normalised {
            (self.most(k), R::one())
        } else {
            (R::one(), R::lit(TAU) / (self.exponent + R::lit(2.0)))
        };
        // The cosine at the lobe's middle, and what of a wide lobe is left above the horizon.
        let width = (self.exponent + R::lit(2.0)).sqrt().recip();
        let cosine = (axis.z.max(R::zero()) + R::lit(0.4) * width).min(R::one());
        Part {
            axis,
            exponent: self.exponent,
            weight: ks * gain * self.power(length / over) * cosine,
        }
    }
}

impl<R: Real> Part<R> {
    /// (p + 1)/2π cosᵖα.
    #[inline(always)]
    fn density(&self, wi: Vec3<R>) -> R {
        let cos = self.axis.dot(wi);
        let power = cos.clamp(R::zero(), R::one()).powf(self.exponent);
        let density = (self.exponent + R::one()) * R::lit(0.5 * FRAC_1_PI) * power;
        R::select(cos.gt(R::zero()), density, R::zero())
    }

    #[inline(always)]
    fn sample(&self, u: [R; 2]) -> Vec3<R> {
        Frame::from_normal(self.axis).to_world(cosine_power_hemisphere(u, self.exponent))
    }
}

impl<R: Real, const N: usize> Lafortune<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let normalised = spec.word("normalisation") == "energy";
        let [a, b, c] = LOBES;
        Ok(Self {
            diffuse: spec.colour("diffuse")?,
            lobes: [
                Lobe::from_spec(spec, a, normalised)?,
                Lobe::from_spec(spec, b, normalised)?,
                Lobe::from_spec(spec, c, normalised)?,
            ],
            normalised,
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Lafortune<S, N> {
        let [a, b, c] = &self.lobes;
        Lafortune {
            diffuse: cast(self.diffuse, f),
            lobes: [a.cast(f), b.cast(f), c.cast(f)],
            normalised: self.normalised,
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        for (lobe, keys) in self.lobes.iter_mut().zip(LOBES) {
            if let Some(at) = keys.iter().position(|key| *key == parameter) {
                return lobe.set(at, value);
            }
        }
        self.diffuse = super::components(value);
    }

    #[inline(always)]
    fn value(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let product = Vec3::new(wi.x * wo.x, wi.y * wo.y, wi.z * wo.z);
        let mut f = scale(self.diffuse, R::lit(FRAC_1_PI));
        for lobe in &self.lobes {
            if !lobe.active {
                continue;
            }
            for k in 0..N {
                f[k] = f[k] + lobe.value(self.normalised, k, product);
            }
        }
        f
    }
}

/// Runs the body for each part that samples a lobe of `$model` towards `$wo`. A loop: written out, the nine parts would make a function
/// of a size that compilers take long for.
macro_rules! each_part {
    ($model:ident, $wo:ident, $part:ident => $body:block) => {
        for lobe in &$model.lobes {
            if !lobe.active {
                continue;
            }
            let axes = if lobe.grey { 1 } else { N };
            for k in 0..axes {
                let $part = lobe.part($model.normalised, k, $wo);
                $body
            }
        }
    };
}

impl<R: Real, const N: usize> Brdf<R, N> for Lafortune<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        only_where(above(wi, wo), self.value(wi, wo))
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        // All black: whatever is drawn has weight 0.
        let mut total = mean(self.diffuse) + R::lit(1e-20);
        let mut density = total * cosine_hemisphere_density(wi);
        each_part!(self, wo, part => {
            total = total + part.weight;
            density = density + part.weight * part.density(wi);
        });
        R::select(above(wi, wo), density / total, R::zero())
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let diffuse = mean(self.diffuse) + R::lit(1e-20);
        let mut total = diffuse;
        each_part!(self, wo, part => {
            total = total + part.weight;
        });
        let x = u[2] * total;
        let mut wi = cosine_hemisphere([u[0], u[1]]);
        let mut before = diffuse;
        each_part!(self, wo, part => {
            // The last part that starts at or below x wins.
            wi = Vec3::select(before.le(x), part.sample([u[0], u[1]]), wi);
            before = before + part.weight;
        });
        self.sample_of(wi, wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        let mut total = mean(self.diffuse);
        each_part!(self, wo, part => {
            total = total + part.weight;
        });
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Model;
    use gonio_radiometry::warp::around_axis;

    fn model(text: &str) -> Model<f64, 3> {
        ModelSpec::parse(text).unwrap().build().unwrap()
    }

    fn tilted(cos: f64, turns: f64) -> Vec3<f64> {
        around_axis(turns, (1.0 - cos * cos).sqrt(), cos)
    }

    #[test]
    fn its_defaults_are_the_normalised_phong_lobe() {
        let (a, b) = (model("lafortune"), model("phong:exponent=20"));
        let scaled = model("lafortune:cx=-0.577,cz=0.577");
        for (i, o, turn) in [(0.9, 0.5, 0.5), (0.3, 0.35, 0.52), (0.1, 0.8, 0.2)] {
            let (wi, wo) = (tilted(i, turn), tilted(o, 0.0));
            let (f, g) = (a.eval(wi, wo)[0], b.eval(wi, wo)[0]);
            assert!((f - g).abs() < 1e-12, "{f} {g}");
            assert!((f - scaled.eval(wi, wo)[0]).abs() < 1e-12);
        }
    }

    #[test]
    fn equation_4_by_hand() {
        // u = (3, 0, 4)/5, v = (0, 3, 4)/5 meet only in z: (0.9·16/25)² for the first lobe, (16/25)³ for the second.
        let m = model(
            "lafortune:normalisation=published,diffuse=0,specular=2,cx=-1.1,cz=0.9,exponent=2,\
             specular_2=1/0/0,cx_2=1,cz_2=1,exponent_2=3",
        );
        let f = m.eval(Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.6, 0.8));
        let first = 2.0 * (0.9f64 * 0.64).powi(2);
        assert!((f[0] - first - 0.64f64.powi(3)).abs() < 1e-14);
        assert!((f[1] - first).abs() < 1e-14);
        // Anisotropy: with Cy = 0 only x counts.
        let m = model(
            "lafortune:normalisation=published,diffuse=0,specular=1,cx=1,cy=0,cz=0,exponent=1",
        );
        let f = m.eval(Vec3::new(0.48, 0.6, 0.64), Vec3::new(0.6, 0.48, 0.64));
        assert!((f[0] - 0.288).abs() < 1e-14);
    }

    #[test]
    fn lobes_that_would_overflow_are_refused() {
        let spec = ModelSpec::parse("lafortune:normalisation=published,cx=-2,exponent=1000");
        let error = spec.unwrap().build::<f64, 3>().unwrap_err().to_string();
        assert!(
            error.contains("exponent") && error.contains("e⁶⁰"),
            "{error}"
        );
        model("lafortune:cx=-2,exponent=1000");
    }
}
