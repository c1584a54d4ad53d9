//! The parts of the material beyond the plain metallic-roughness base, each of which may be absent.

use crate::model::components;
use crate::model::sheen_charlie::{ALPHA_MIN, SheenCharlie, Visibility};
use crate::part::charlie_albedo::share_below;
use crate::part::colour::{cast, each_component, grey, largest, mean};
use crate::part::dielectric;
use crate::part::distribution::{Distribution, Shape};
use crate::part::fresnel::{Fresnel, ThinFilm, schlick};
use crate::part::geometry::{Half, above, azimuth, turned};
use crate::part::masking::{Masking, smith_g1_over_cos, visibility};
use crate::{BrdfError, ModelSpec};
use gonio_num::{Frame, Real, Vec3};
use std::f64::consts::PI;

/// KHR_materials_anisotropy: the direction along which the base's facets are rougher.
#[derive(Debug, Clone, Copy)]
pub struct Anisotropy<R: Real> {
    /// Whether there is any.
    pub on: bool,
    strength: R,
    /// x and y before the rotation, and the factor on the strength.
    direction: [R; 3],
    /// Cosine and sine of the rotation.
    rotation: [R; 2],
    /// Cosine and sine of the angle from the tangent.
    axis: [R; 2],
}

impl<R: Real> Anisotropy<R> {
    pub(super) fn from_spec(spec: &ModelSpec) -> Self {
        let strength: f64 = spec.real("anisotropy");
        let direction = spec.rgb("anisotropy_direction").unwrap_or([1.0, 0.0, 1.0]);
        let mut new = Self {
            on: strength > 0.0,
            strength: R::lit(strength),
            direction: direction.map(R::lit),
            rotation: [R::one(), R::zero()],
            axis: [R::one(), R::zero()],
        };
        new.set("rotation_deg", [spec.real("rotation_deg"); 3]);
        new
    }

    pub(super) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Anisotropy<S> {
        Anisotropy {
            on: self.on,
            strength: f(self.strength),
            direction: cast(self.direction, f),
            rotation: cast(self.rotation, f),
            axis: cast(self.axis, f),
        }
    }

    pub(super) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "anisotropy" => {
                self.on = true;
                self.strength = value[0];
            }
            "rotation_deg" => {
                let turn = value[0] * R::lit(PI / 180.0);
                self.rotation = [turn.cos(), turn.sin()];
            }
            _ => self.direction = value,
        }
        let [x, y, _] = self.direction;
        let [cos, sin] = azimuth(Vec3::new(x, y, R::zero()));
        let direction = Vec3::new(cos, sin, R::zero());
        let [cos, sin] = self.rotation;
        let axis = turned(direction, cos, sin);
        self.axis = [axis.x, axis.y];
    }

    /// The slope scales along the direction and across it, where `alpha` is that of the isotropic surface.
    pub(super) fn scales(&self, alpha: R) -> [R; 2] {
        if !self.on {
            return [alpha, alpha];
        }
        let strength = self.strength * self.direction[2].max(R::zero());
        [(strength * strength).lerp(alpha, R::one()), alpha]
    }

    /// A direction in the frame of the two slope scales.
    #[inline(always)]
    pub(super) fn in_axes(&self, w: Vec3<R>) -> Vec3<R> {
        if self.on {
            turned(w, self.axis[0], -self.axis[1])
        } else {
            w
        }
    }

    /// A direction back from the frame of the two slope scales.
    #[inline(always)]
    pub(super) fn out_of_axes(&self, w: Vec3<R>) -> Vec3<R> {
        if self.on {
            turned(w, self.axis[0], self.axis[1])
        } else {
            w
        }
    }
}

/// KHR_materials_iridescence: a thin film on the base.
#[derive(Debug, Clone, Copy)]
pub struct Film<R: Real> {
    /// Whether there is one.
    pub on: bool,
    /// Share of the film's reflectance in the base's, [0, 1].
    pub strength: R,
    /// Index of refraction of the film.
    pub ior: R,
    /// Thickness of the film.
    pub thickness_nm: R,
}

impl<R: Real> Film<R> {
    pub(super) fn from_spec(spec: &ModelSpec) -> Self {
        Self {
            on: spec.real::<f64>("iridescence") > 0.0,
            strength: spec.real("iridescence"),
            ior: spec.real("iridescence_ior"),
            thickness_nm: spec.real("iridescence_thickness_nm"),
        }
    }

    pub(super) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Film<S> {
        Film {
            on: self.on,
            strength: f(self.strength),
            ior: f(self.ior),
            thickness_nm: f(self.thickness_nm),
        }
    }

    pub(super) fn set(&mut self, parameter: &str, x: R) {
        match parameter {
            "iridescence" => {
                self.on = true;
                self.strength = x;
            }
            "iridescence_ior" => self.ior = x,
            _ => self.thickness_nm = x,
        }
    }

    /// The reflectance `plain` of a base whose F₀ is `f0`, mixed with that of the base under the film.
    #[inline(always)]
    pub(super) fn over<const N: usize>(&self, plain: [R; N], f0: [R; N], cos: R) -> [R; N] {
        // The index of a clear body with this F₀, below 0.998 to keep it finite and 1 − F at full precision.
        let mut eta = f0;
        each_component!(N, k => {
            let root = f0[k].safe_sqrt().min(R::lit(0.999));
            eta[k] = (R::one() + root) / (R::one() - root);
        });
        let film = ThinFilm {
            thickness_nm: self.thickness_nm,
            ior: self.ior,
            eta,
            k: grey(R::zero()),
        };
        let film = Fresnel::ThinFilm(film).eval(cos);
        let mut out = plain;
        each_component!(N, k => { out[k] = self.strength.lerp(plain[k], film[k]); });
        out
    }
}

/// The smallest attenuation distance: smaller ones are taken for this one.
const LEAST_DISTANCE: f64 = 1e-6;

/// KHR_materials_transmission and KHR_materials_volume: what passes the surface.
#[derive(Debug, Clone, Copy)]
pub struct Passage<R: Real, const N: usize> {
    /// Whether light passes.
    pub on: bool,
    /// Whether the surface bounds a body; else it is a thin wall.
    pub solid: bool,
    /// Share of what enters that passes, [0, 1].
    pub share: R,
    attenuation_color: [R; N],
    /// 1/attenuation distance; 0 where nothing is absorbed.
    attenuation: R,
}

impl<R: Real, const N: usize> Passage<R, N> {
    pub(super) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let distance = spec.number("attenuation_distance");
        Ok(Self {
            on: spec.real::<f64>("transmission") > 0.0,
            solid: super::parameters::is_solid(spec),
            share: spec.real("transmission"),
            attenuation_color: spec.colour("attenuation_color")?,
            attenuation: R::lit(distance.map_or(0.0, |d| d.max(LEAST_DISTANCE).recip())),
        })
    }

    pub(super) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Passage<S, N> {
        Passage {
            on: self.on,
            solid: self.solid,
            share: f(self.share),
            attenuation_color: cast(self.attenuation_color, f),
            attenuation: f(self.attenuation),
        }
    }

    pub(super) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "transmission" => {
                self.on = true;
                self.share = value[0];
            }
            "attenuation_color" => self.attenuation_color = components(value),
            _ => self.attenuation = value[0].max(R::lit(LEAST_DISTANCE)).recip(),
        }
    }

    /// Whether it refracts.
    #[inline(always)]
    pub(super) fn refracts(&self) -> bool {
        self.on && self.solid
    }

    /// Index of refraction of the body, for a base of index `ior`.
    #[inline(always)]
    pub(super) fn relative_ior(&self, ior: R) -> R {
        if self.refracts() {
            dielectric::contrasted(ior)
        } else {
            R::one()
        }
    }

    /// σ = −ln(c)/d.
    #[inline(always)]
    pub(super) fn absorption(&self) -> [R; N] {
        let mut out = grey(R::zero());
        if self.refracts() {
            each_component!(N, k => {
                // What lets nothing through leaves e⁻⁶⁹.
                let log = self.attenuation_color[k].max(R::lit(1e-30)).ln();
                out[k] = (-log * self.attenuation).max(R::zero());
            });
        }
        out
    }
}

/// KHR_materials_sheen: upright fibres on the base.
#[derive(Debug, Clone, Copy)]
pub struct Sheen<R: Real, const N: usize> {
    /// Whether there are any.
    pub on: bool,
    /// The fibres.
    pub fibres: SheenCharlie<R, N>,
}

impl<R: Real, const N: usize> Sheen<R, N> {
    pub(super) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let mut new = Self {
            on: spec.largest("sheen_color") > 0.0,
            fibres: SheenCharlie {
                color: spec.colour("sheen_color")?,
                alpha: R::one(),
                visibility: Visibility::Charlie,
            },
        };
        new.set("sheen_roughness", [spec.real("sheen_roughness"); 3]);
        Ok(new)
    }

    pub(super) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Sheen<S, N> {
        Sheen {
            on: self.on,
            fibres: self.fibres.cast(f),
        }
    }

    pub(super) fn set(&mut self, parameter: &str, value: [R; 3]) {
        if parameter == "sheen_color" {
            self.on = true;
            self.fibres.color = components(value);
        } else {
            self.fibres.alpha = (value[0] * value[0]).max(R::lit(ALPHA_MIN));
        }
    }

    /// The share that reaches the base in the direction of cosine `cos`, and what the fibres reflect of it on average.
    #[inline(always)]
    pub(super) fn split(&self, cos: R) -> (R, R) {
        let albedo = R::one() - share_below(cos, self.fibres.alpha);
        let below = R::one() - largest(self.fibres.color) * albedo;
        (below.max(R::zero()), mean(self.fibres.color) * albedo)
    }
}

/// The smallest cosine that a coat's own normal divides by.
const LEAST_COSINE: f64 = 1e-3;

/// KHR_materials_clearcoat: a clear coat over all the rest.
#[derive(Debug, Clone, Copy)]
pub struct Coat<R: Real> {
    /// Whether there is one.
    pub on: bool,
    /// [0, 1].
    pub strength: R,
    /// GGX of alpha = roughness².
    pub distribution: Distribution<R>,
    /// The frame of its normal, where that isn't the base's.
    pub frame: Option<Frame<R>>,
}

impl<R: Real> Coat<R> {
    pub(super) fn from_spec(spec: &ModelSpec) -> Self {
        let mut new = Self {
            on: spec.real::<f64>("clearcoat") > 0.0,
            strength: spec.real("clearcoat"),
            distribution: Distribution::isotropic(Shape::Ggx, R::one()),
            frame: None,
        };
        new.set("clearcoat_roughness", [spec.real("clearcoat_roughness"); 3]);
        if let Some(normal) = spec.rgb("clearcoat_normal")
            && spec.values.contains_key("clearcoat_normal")
        {
            new.set("clearcoat_normal", normal.map(R::lit));
        }
        new
    }

    pub(super) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Coat<S> {
        Coat {
            on: self.on,
            strength: f(self.strength),
            distribution: self.distribution.cast(f),
            frame: self.frame.map(|frame| {
                let over = |v: Vec3<R>| Vec3::new(f(v.x), f(v.y), f(v.z));
                Frame {
                    s: over(frame.s),
                    t: over(frame.t),
                    n: over(frame.n),
                }
            }),
        }
    }

    pub(super) fn set(&mut self, parameter: &str, value: [R; 3]) {
        let x = value[0];
        match parameter {
            "clearcoat" => {
                self.on = true;
                self.strength = x;
            }
            "clearcoat_roughness" => self.distribution.set_alpha(x * x, x * x),
            _ => {
                // On the outer side, whatever is given.
                let z = value[2].max(R::lit(1e-3));
                let normal = Vec3::new(x, value[1], z).normalize();
                self.frame = Some(Frame::from_normal(normal));
            }
        }
    }

    /// A direction in the frame of the coat's normal.
    #[inline(always)]
    fn local(&self, w: Vec3<R>) -> Vec3<R> {
        match &self.frame {
            Some(frame) => frame.to_local(w),
            None => w,
        }
    }

    /// The coat's share in the mix with what it covers, for a viewer: its strength times Schlick's reflectance of glass.
    #[inline(always)]
    pub(super) fn share(&self, wo: Vec3<R>) -> R {
        let cos = self.local(wo).z.abs();
        self.strength * schlick(cos.saturate(), R::lit(0.04), R::one())
    }

    /// D V, and the density of [`Coat::draw`]. A coat with its own normal N reflects as that has it: D V |N·ωi|/cosθi.
    #[inline(always)]
    pub(super) fn lobe(&self, wi: Vec3<R>, wo: Vec3<R>, half: &Half<R>) -> (R, R) {
        let (i, o) = (self.local(wi), self.local(wo));
        let half = Half::of(self.local(half.h()), half.cos);
        let d = self.distribution.density_of(&half);
        let mut f = d * visibility(Masking::Smith, &self.distribution, i, o, &half);
        let mut density = R::lit(0.25) * d * smith_g1_over_cos(&self.distribution, o);
        if self.frame.is_some() {
            let faces = above(i, o);
            f = R::select(faces, f * i.z / wi.z.max(R::lit(LEAST_COSINE)), R::zero());
            density = R::select(faces, density, R::zero());
        }
        (f, density)
    }

    /// A direction mirrored by one of the facets that the viewer sees; −z, which is no direction to the light, where it or the viewer is
    /// behind the coat's normal.
    #[inline(always)]
    pub(super) fn draw(&self, wo: Vec3<R>, u: [R; 2]) -> Vec3<R> {
        let o = self.local(wo);
        let front = Vec3::new(o.x, o.y, o.z.abs());
        let wi = o.reflect(self.distribution.sample_visible_ggx(front, u[0], u[1]));
        match &self.frame {
            Some(frame) => {
                let down = Vec3::new(R::zero(), R::zero(), -R::one());
                Vec3::select(above(wi, o), frame.to_world(wi), down)
            }
            None => wi,
        }
    }
}
