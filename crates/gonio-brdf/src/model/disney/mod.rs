//! Disney's principled models of 2012 and 2015.

mod parameters;

use crate::part::clearcoat::Clearcoat;
use crate::part::colour::{add, cast, each_component, grey, mean, only_where, scale};
use crate::part::dielectric::contrasted;
use crate::part::facet_pair::{DrawnFacet, FacetPair};
use crate::part::fresnel::dielectric;
use crate::part::geometry::{Half, above, flipped_where, mirrored_about};
use crate::part::masking::{Masking, visibility_from_areas};
use crate::part::rough::RoughSurface;
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, Sample};
use gonio_num::{Real, Vec3, Work};
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density};
use std::f64::consts::FRAC_1_PI;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "disney",
    summary: "Disney's principled model: one material for most, set by an artist's words",
    paper: "Burley 2012, \"Physically-Based Shading at Disney\"; Burley 2015, \"Extending the Disney BRDF to a BSDF with Integrated \
            Subsurface Scattering\"",
    parameters: parameters::PARAMETERS,
    positional: Some("base_color"),
    aliases: &[
        crate::Alias {
            name: "principled",
            preset: &[],
        },
        crate::Alias {
            name: "disney-2012",
            preset: &[("version", "2012")],
        },
        crate::Alias {
            name: "disney-2015",
            preset: &[("version", "2015")],
        },
    ],
    recordable: true,
    declares: |spec| {
        // The diffuse part takes nothing from the specular ones: their sum may reflect more than it gets. The metal's does not.
        let metal = spec.real::<f64>("metallic") == 1.0;
        let coated = spec.real::<f64>("clearcoat") > 0.0;
        let ior: f64 = ior(spec);
        Declares {
            isotropic: spec.real::<f64>("anisotropic") == 0.0,
            relative_ior: (spec.number("spec_trans").unwrap_or(0.0) > 0.0)
                .then(|| [contrasted(ior); 3]),
            ..Declares::physical(if metal && !coated { 1.0 } else { f64::INFINITY })
        }
    },
};

/// The index of refraction of a description: (1 + r)/(1 − r) with r = √F₀, F₀ = 0.08 specular.
fn ior<R: Real>(spec: &ModelSpec) -> R {
    match spec.number("ior") {
        Some(ior) => R::lit(ior),
        None => ior_of_specular(spec.real("specular")),
    }
}

fn ior_of_specular<R: Real>(specular: R) -> R {
    let r = (specular * R::lit(0.08)).safe_sqrt();
    (R::one() + r) / (R::one() - r)
}

/// With m metallic, t spec_trans, c the base colour, ĉ = c over its luminance, w(x) = (1 − x)⁵, and RR = 2 roughness cos²θ′:
///
/// - diffuse: (1 − m)(1 − t) c/π · lerp(d, s, flatness), with d = (1 − w(θi)/2)(1 − w(θr)/2) + RR (w(θi) + w(θr) + w(θi) w(θr)(RR − 1)) and
///   s = 5/4 (F (1/(cosθi + cosθr) − ½) + ½), F = lerp(1, RR/2, w(θi)) lerp(1, RR/2, w(θr))
/// - sheen: (1 − m) sheen · lerp(1, ĉ, sheen_tint) · w(θ′)
/// - specular: F D G/(4 cosθi cosθr), GGX with Smith's uncorrelated masking. 2012: F = lerp(F₀, 1, w(θ′)), F₀ = lerp(0.08 specular ·
///   lerp(1, ĉ, specular_tint), c, m). 2015: the same of metal and tint, and Fresnel's equations for the rest
/// - transmission (2015): (1 − m) t √c (1 − F) as in `rough-dielectric`; from inside, reflection is scaled by (1 − m) t
/// - clearcoat: ¼ clearcoat F D G/(4 cosθi cosθr), F of index 1.5 by Schlick, D the distribution GTR with γ = 1, G of GGX with α = 0.25
///
/// Both years have the same diffuse part, written differently. Luminance is that of Rec. 709. Light that interreflects between facets is lost.
/// `alpha` has the floor of the other models, 1e-4, not 1e-3. The thin surface and the scattering distance of 2015 are no part of it.
///
/// Sampling: the cosine, visible normals, and normals of the clearcoat, in shares of their albedos.
#[derive(Debug, Clone, Copy)]
pub struct Disney<R: Real, const N: usize> {
    /// c, [0, 1].
    pub base_color: [R; N],
    /// m, [0, 1].
    pub metallic: R,
    /// D and G of the specular part.
    pub surface: RoughSurface<R>,
    /// Index of refraction of the dielectric.
    pub ior: R,
    /// [0, 1].
    pub specular_tint: R,
    /// [0, 1].
    pub sheen: R,
    /// [0, 1].
    pub sheen_tint: R,
    /// [0, 1].
    pub clearcoat: R,
    /// Flatness, or `subsurface` of 2012, [0, 1].
    pub flatness: R,
    /// t, [0, 1].
    pub spec_trans: R,
    roughness: R,
    version: Version,
    transmits: bool,
    coated: bool,
    coat: Clearcoat<R>,
    derived: Derived<R, N>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Version {
    Of2012,
    Of2015,
}

/// What follows from the parameters alone.
#[derive(Debug, Clone, Copy)]
struct Derived<R: Real, const N: usize> {
    /// (1 − m)(1 − t) c.
    diffuse: [R; N],
    /// (1 − m) sheen, tinted.
    sheen: [R; N],
    /// F = share·(Fresnel's) + lerp(f0, 1 − share, w).
    f0: [R; N],
    share: R,
    /// (1 − m) t √c.
    through: [R; N],
    /// (1 − m) t.
    glass: R,
}

impl<R: Real, const N: usize> Derived<R, N> {
    fn zero() -> Self {
        Self {
            diffuse: grey(R::zero()),
            sheen: grey(R::zero()),
            f0: grey(R::zero()),
            share: R::zero(),
            through: grey(R::zero()),
            glass: R::zero(),
        }
    }

    fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Derived<S, N> {
        Derived {
            diffuse: cast(self.diffuse, f),
            sheen: cast(self.sheen, f),
            f0: cast(self.f0, f),
            share: f(self.share),
            through: cast(self.through, f),
            glass: f(self.glass),
        }
    }
}

/// The colour over its luminance (Rec. 709; the mean where it isn't RGB); 1 for black.
fn hue<R: Real, const N: usize>(c: [R; N]) -> [R; N] {
    let luminance = if N == 3 {
        c[0] * R::lit(0.2126) + c[1] * R::lit(0.7152) + c[2] * R::lit(0.0722)
    } else {
        mean(c)
    };
    let lit = luminance.gt(R::zero());
    let over = luminance.max(R::lit(1e-20)).recip();
    let mut out = c;
    each_component!(N, k => { out[k] = R::select(lit, c[k] * over, R::one()); });
    out
}

impl<R: Real, const N: usize> Disney<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let version = match spec.word("version").as_str() {
            "2012" => Version::Of2012,
            _ => Version::Of2015,
        };
        let (others, year): (&[&str], _) = match version {
            Version::Of2012 => (&["ior", "flatness", "spec_trans"], "2015"),
            Version::Of2015 => (&["subsurface"], "2012"),
        };
        for key in others {
            if spec.values.contains_key(*key) {
                return Err(spec.wrong(key, &format!("no value here: only version={year} has it")));
            }
        }
        if spec.values.contains_key("ior") && spec.values.contains_key("specular") {
            return Err(spec.wrong("ior", "either ior or specular, not both"));
        }
        let optional = |key: &str| R::lit(spec.number(key).unwrap_or(0.0));
        let roughness = spec.real("roughness");
        let mut model = Self {
            base_color: spec.colour("base_color")?,
            metallic: spec.real("metallic"),
            surface: RoughSurface::ggx(
                Masking::Smith,
                roughness,
                spec.real("anisotropic"),
                spec.real("rotation_deg"),
            ),
            ior: ior(spec),
            specular_tint: spec.real("specular_tint"),
            sheen: spec.real("sheen"),
            sheen_tint: spec.real("sheen_tint"),
            clearcoat: spec.real("clearcoat"),
            flatness: optional("subsurface") + optional("flatness"),
            spec_trans: optional("spec_trans"),
            roughness,
            version,
            transmits: spec.number("spec_trans").unwrap_or(0.0) > 0.0,
            coated: spec.real::<f64>("clearcoat") > 0.0,
            coat: Clearcoat::new(spec.real("clearcoat_gloss")),
            derived: Derived::zero(),
        };
        model.derive();
        Ok(model)
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Disney<S, N> {
        Disney {
            base_color: cast(self.base_color, f),
            metallic: f(self.metallic),
            surface: self.surface.cast(f),
            ior: f(self.ior),
            specular_tint: f(self.specular_tint),
            sheen: f(self.sheen),
            sheen_tint: f(self.sheen_tint),
            clearcoat: f(self.clearcoat),
            flatness: f(self.flatness),
            spec_trans: f(self.spec_trans),
            roughness: f(self.roughness),
            version: self.version,
            transmits: self.transmits,
            coated: self.coated,
            coat: self.coat.cast(f),
            derived: self.derived.cast(f),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        let x = value[0];
        match parameter {
            "base_color" => self.base_color = crate::model::components(value),
            "metallic" => self.metallic = x,
            "roughness" => {
                self.roughness = x;
                self.surface.set(parameter, x);
            }
            "anisotropic" => {
                self.surface.set("anisotropy", x);
            }
            "rotation_deg" => {
                self.surface.set(parameter, x);
            }
            "specular" => self.ior = ior_of_specular(x),
            "ior" if self.version == Version::Of2015 => self.ior = x,
            "specular_tint" => self.specular_tint = x,
            "sheen" => self.sheen = x,
            "sheen_tint" => self.sheen_tint = x,
            "clearcoat" => {
                self.clearcoat = x;
                self.coated = true;
            }
            "clearcoat_gloss" => self.coat = Clearcoat::new(x),
            "spec_trans" if self.version == Version::Of2015 => {
                self.spec_trans = x;
                self.transmits = true;
            }
            "flatness" if self.version == Version::Of2015 => self.flatness = x,
            "subsurface" if self.version == Version::Of2012 => self.flatness = x,
            // A parameter of the other year.
            _ => {}
        }
        self.derive();
    }

    fn derive(&mut self) {
        let one = R::one();
        if self.transmits {
            self.ior = contrasted(self.ior);
        }
        let (m, hue) = (self.metallic, hue(self.base_color));
        let r = (self.ior - one) / (self.ior + one);
        let mut d = Derived::zero();
        let dielectric = one - m;
        d.glass = dielectric * self.spec_trans;
        d.share = match self.version {
            Version::Of2012 => R::zero(),
            Version::Of2015 => dielectric * (one - self.specular_tint),
        };
        for k in 0..N {
            let c = self.base_color[k];
            d.diffuse[k] = dielectric * (one - self.spec_trans) * c;
            d.through[k] = d.glass * c.safe_sqrt();
            d.sheen[k] = dielectric * self.sheen * self.sheen_tint.lerp(one, hue[k]);
            let tinted = match self.version {
                Version::Of2012 => self.specular_tint.lerp(one, hue[k]),
                Version::Of2015 => self.specular_tint * hue[k],
            };
            d.f0[k] = m * c + dielectric * r * r * tinted;
        }
        self.derived = d;
    }

    /// F of the outer side, and Fresnel's part of it, at an angle to the facet.
    #[inline(always)]
    fn fresnel(&self, cos: R) -> [R; N] {
        let d = &self.derived;
        let weight = (R::one() - cos).saturate().pow5();
        let exact = d.share * dielectric(cos, self.ior);
        let grazing = R::one() - d.share;
        let mut f = d.f0;
        each_component!(N, k => { f[k] = exact + weight.lerp(f[k], grazing); });
        f
    }

    /// Fresnel reflectance of the boundary from either side.
    #[inline(always)]
    fn boundary(&self, cos: R, inside: R::Mask) -> R {
        dielectric(cos, R::select(inside, self.ior.recip(), self.ior))
    }

    /// f of a pair on the outer side, in the frame of (αx, αy).
    ///
    /// - `facets`: D G/(4 cosθi cosθr)
    #[inline(always)]
    fn outer(&self, wi: Vec3<R>, wo: Vec3<R>, half: &Half<R>, facets: R) -> [R; N] {
        let (one, d) = (R::one(), &self.derived);
        let fi = (one - wi.z).saturate().pow5();
        let fo = (one - wo.z).saturate().pow5();
        let rr = R::lit(2.0) * self.roughness * half.cos * half.cos;
        let plain = (one - R::lit(0.5) * fi) * (one - R::lit(0.5) * fo)
            + rr * (fi + fo + fi * fo * (rr - one));
        let f90 = rr * R::lit(0.5);
        let fss = fi.lerp(one, f90) * fo.lerp(one, f90);
        let sum = (wi.z + wo.z).max(R::lit(1e-20));
        let flat = R::lit(1.25) * (fss * (sum.recip() - R::lit(0.5)) + R::lit(0.5));
        let body = self.flatness.lerp(plain, flat) * R::lit(FRAC_1_PI);
        let weight = (one - half.cos).saturate().pow5();
        let coat = if self.coated {
            self.clearcoat * self.coat.value(wi, wo, half)
        } else {
            R::zero()
        };
        let mut f = self.fresnel(half.cos);
        each_component!(N, k => {
            f[k] = f[k] * facets + d.diffuse[k] * body + d.sheen[k] * weight + coat;
        });
        f
    }

    /// Probabilities of the cosine, the facets and the clearcoat for a viewer on the outer side.
    #[inline(always)]
    fn shares(&self, cos: R) -> [R; 3] {
        let d = &self.derived;
        let through = (R::one() - dielectric(cos, self.ior)) * mean(d.through);
        let facets = mean(self.fresnel(cos)) + through + R::lit(1e-6);
        let body = mean(d.diffuse) + R::lit(0.25) * mean(d.sheen);
        let coat = if self.coated {
            self.clearcoat * self.coat.albedo(cos)
        } else {
            R::zero()
        };
        let over = (body + facets + coat).recip();
        [body * over, facets * over, coat * over]
    }

    /// Probability with which a facet reflects instead of refracting.
    #[inline(always)]
    fn reflection_probability(&self, cos: R, inside: R::Mask) -> R {
        let d = &self.derived;
        let f = self.boundary(cos, inside);
        let outer = mean(self.fresnel(cos));
        let reflected = R::select(inside, d.glass * f, outer) + R::lit(1e-20);
        reflected / (reflected + (R::one() - f) * mean(d.through))
    }

    /// f of a pair on either side.
    #[inline(always)]
    fn value_across(&self, pair: &FacetPair<R>) -> [R; N] {
        let d = &self.derived;
        let [i, o] = pair.up;
        let half = Half::of(pair.h, pair.reflected_cosine());
        let facets = R::select(pair.valid(), pair.reflection(&self.surface), R::zero());
        let f = pair.fresnel(self.ior);
        let inner = d.glass * f * facets;
        let across = (R::one() - f) * pair.refraction(&self.surface);
        let across = R::select(pair.valid(), across, R::zero());
        let inside = pair.inside[1].gt(R::lit(0.5));
        let mut value = self.outer(i, o, &half, facets);
        let reflects = pair.reflects();
        each_component!(N, k => {
            let here = R::select(inside, inner, value[k]);
            value[k] = R::select(reflects, here, across * d.through[k]);
        });
        only_where(pair.off_horizon(), value)
    }

    /// Density of a pair on either side.
    #[inline(always)]
    fn density_across(&self, pair: &FacetPair<R>) -> R {
        let [i, o] = pair.up;
        let inside = pair.inside[1].gt(R::lit(0.5));
        let cos = R::select(pair.reflects(), pair.reflected_cosine(), pair.cos[1].abs());
        let p = self.reflection_probability(cos.min(R::one()), inside);
        let facets = pair.density(&self.surface, p);
        let facets = R::select(pair.valid(), facets, R::zero());
        let [body, specular, coat] = self.shares(o.z);
        let half = Half::of(pair.h, pair.reflected_cosine());
        let beside = body * cosine_hemisphere_density(i) + self.coat_density(coat, &half);
        let outer = specular * facets + R::select(pair.reflects(), beside, R::zero());
        let density = R::select(inside, facets, outer);
        R::select(pair.off_horizon(), density, R::zero())
    }

    /// Density of a pair on the outer side where nothing is transmitted.
    ///
    /// - `d`: D(h)
    #[inline(always)]
    fn density_outer(&self, wi: Vec3<R>, wo: Vec3<R>, half: &Half<R>, d: R) -> R {
        let [body, specular, coat] = self.shares(wo.z);
        let facets = R::lit(0.25) * self.surface.normal_density_over_cos(half, d, wo);
        body * cosine_hemisphere_density(wi) + specular * facets + self.coat_density(coat, half)
    }

    /// The clearcoat's part of the density, drawn with the probability `share`.
    #[inline(always)]
    fn coat_density(&self, share: R, half: &Half<R>) -> R {
        if self.coated {
            share * self.coat.density(half)
        } else {
            R::zero()
        }
    }
}

/// [`Disney::value_across`] for glass, which is not part of an opaque surface's code.
struct ValueAcross<'a, R: Real, const N: usize>(&'a Disney<R, N>, Vec3<R>, Vec3<R>);
/// [`Disney::density_across`], the same way.
struct DensityAcross<'a, R: Real, const N: usize>(&'a Disney<R, N>, Vec3<R>, Vec3<R>);

impl<R: Real, const N: usize> Work for ValueAcross<'_, R, N> {
    type Output = [R; N];
    #[inline(always)]
    fn run(self) -> [R; N] {
        let Self(model, wi, wo) = self;
        model.value_across(&FacetPair::new(&model.surface, model.ior, wi, wo))
    }
}

impl<R: Real, const N: usize> Work for DensityAcross<'_, R, N> {
    type Output = R;
    #[inline(always)]
    fn run(self) -> R {
        let Self(model, wi, wo) = self;
        model.density_across(&FacetPair::new(&model.surface, model.ior, wi, wo))
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for Disney<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        if self.transmits {
            return R::out_of_line(ValueAcross(self, wi, wo));
        }
        let (i, o) = (self.surface.into_axes(wi), self.surface.into_axes(wo));
        let half = Half::new(i, o);
        let surface = &self.surface;
        let facets = surface.distribution.density_of(&half)
            * visibility_from_areas(surface.masking, &surface.distribution, i, o);
        only_where(above(wi, wo), self.outer(i, o, &half, facets))
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        if self.transmits {
            return R::out_of_line(DensityAcross(self, wi, wo));
        }
        let (i, o) = (self.surface.into_axes(wi), self.surface.into_axes(wo));
        let half = Half::new(i, o);
        let d = self.surface.distribution.density_of(&half);
        let density = self.density_outer(i, o, &half, d);
        R::select(above(wi, wo), density, R::zero())
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        if self.transmits {
            return (
                R::out_of_line(ValueAcross(self, wi, wo)),
                R::out_of_line(DensityAcross(self, wi, wo)),
            );
        }
        let (i, o) = (self.surface.into_axes(wi), self.surface.into_axes(wo));
        let half = Half::new(i, o);
        let surface = &self.surface;
        let d = surface.distribution.density_of(&half);
        let facets = d * visibility_from_areas(surface.masking, &surface.distribution, i, o);
        let (f, density) = (
            self.outer(i, o, &half, facets),
            self.density_outer(i, o, &half, d),
        );
        let up = above(wi, wo);
        (only_where(up, f), R::select(up, density, R::zero()))
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let facet = DrawnFacet::new(&self.surface, wo, [u[0], u[1]]);
        let [body, specular, _] = self.shares(facet.wo.z);
        // From inside there are only facets.
        let body = R::select(facet.inside, R::zero(), body);
        let specular = R::select(facet.inside, R::one(), specular);
        let mut wi = mirrored_about(facet.wo, facet.h);
        if self.transmits {
            let rest = ((u[2] - body) / specular).saturate();
            let p = self.reflection_probability(facet.cos, facet.inside);
            wi = facet.leaving(self.ior, rest.lt(p));
        }
        if self.coated {
            let coat = self.coat.sample(facet.wo, [u[0], u[1]]);
            wi = Vec3::select(u[2].ge(body + specular), coat, wi);
        }
        let cosine = cosine_hemisphere([u[0], u[1]]);
        wi = Vec3::select(u[2].lt(body), cosine, wi);
        let wi = flipped_where(facet.inside, self.surface.out_of_axes(wi));
        self.sample_of(wi, wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        let (d, cos) = (&self.derived, wo.z.abs().min(R::one()));
        let inside = wo.z.lt(R::zero());
        let f = self.boundary(cos, inside);
        let through = (R::one() - f) * mean(d.through);
        let outer = mean(add(self.fresnel(cos), scale(d.sheen, R::lit(0.25))))
            + mean(d.diffuse)
            + self.clearcoat * self.coat.albedo(cos);
        through + R::select(inside, d.glass * f, outer)
    }

    #[inline(always)]
    fn transmits(&self) -> bool {
        self.transmits
    }

    #[inline(always)]
    fn relative_ior(&self) -> [R; N] {
        grey(if self.transmits { self.ior } else { R::one() })
    }
}
