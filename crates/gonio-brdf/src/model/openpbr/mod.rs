//! OpenPBR Surface 1.1.

mod parameters;

use super::{Composite, Model};
use crate::part::colour::{cast, each_component, grey, mean, only_where, scale};
use crate::part::fresnel::{Fresnel, dielectric};
use crate::part::geometry::flipped_where;
use crate::part::gloss::Gloss;
use crate::part::sheen_lobe;
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, Number, Sample};
use gonio_num::{Mask, Real, Vec3};
use parameters::{Values, slab};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "openpbr",
    summary: "OpenPBR Surface: fuzz over a coat over a mixture of metal, glass and opaque dielectric",
    paper: "Portsmouth et al. 2025, \"OpenPBR Surface specification\" 1.1 (Academy Software Foundation); Zeltner et al. 2022 for the fuzz; \
            Belcour & Barla 2017 for the film; Portsmouth, Kutz & Hill 2024 for the diffuse base",
    parameters: parameters::PARAMETERS,
    positional: None,
    aliases: &[crate::Alias {
        name: "open-pbr-surface",
        preset: &[],
    }],
    recordable: true,
    declares: |spec| {
        let zero = |key: &str| spec.real::<f64>(key) == 0.0;
        let metal = spec.real::<f64>("base_metalness") == 1.0;
        Declares {
            reciprocal: metal && zero("coat_weight") && zero("fuzz_weight"),
            isotropic: zero("specular_roughness_anisotropy") && zero("coat_roughness_anisotropy"),
            relative_ior: transmitting_index(spec).map(|ior| [ior; 3]),
            ..Declares::physical(1.0)
        }
    },
};

fn is_thin(spec: &ModelSpec) -> bool {
    spec.word("geometry_thin_walled") == "on"
}

/// The index of what lies on the inner side, for a body that light enters, or a sheet, which has two outer sides.
fn transmitting_index(spec: &ModelSpec) -> Option<f64> {
    let positive = |key: &str| spec.real::<f64>(key) > 0.0;
    if is_thin(spec) {
        return Some(1.0);
    }
    let values: Values<f64, 3> = Values::from_spec(spec).ok()?;
    positive("transmission_weight").then(|| values.body_ior())
}

/// From the specification's tree, with its layers as scaling by albedo (μr the viewer's cosine):
///
/// - f = F f_fuzz + (1 − F E_fuzz(μr)) f_coated
/// - f_coated = C f_coat + lerp(1, T (1 − E_coat(μr)), C) Δ f_base, T the absorption along both paths in the coat, Δ the darkening by light that is
///   reflected inside it
/// - f_base = lerp(f_dielectric, f_metal, M), f_dielectric = lerp(f_opaque, f_body, T), f_opaque = f_gloss + (1 − E_gloss(μr)) lerp(f_diffuse,
///   f_subsurface, S)
///
/// with f_fuzz `sheen-ltc`, f_coat and f_gloss a GGX dielectric of one facet, f_metal GGX with the F82 tint and Kulla & Conty's
/// interreflection, f_diffuse `eon`, f_body `rough-dielectric`. The film on the base is that of `torrance-sparrow:fresnel=thin-film`; on what
/// passes into a body it acts by the albedos. Every layer keeps the energy: a white base is a white furnace.
///
/// Where the specification leaves a choice, or this model has none to give:
/// - The base under a denser coat has the inverse index: the coat keeps away the directions that would be totally reflected. What passes
///   into a body is bent by its index towards the outside, which parallel faces of a coat don't change.
/// - `subsurface_radius` and the media's scattering need transport through a volume: f_subsurface is the limit of no distance, diffuse with the
///   albedo subsurface_color. A body only absorbs. There is no dispersion.
/// - Thin-walled, a sheet reflects R + (1 − R)² R A²/(1 − R²A²) and transmits (1 − R)² A/(1 − R²A²), R at the facet and A =
///   transmission_color along the refracted path; what it transmits has the lobe of its reflection, turned over.
/// - Emission, opacity, normals and tangents belong to the scene.
///
/// Sampling: a slab by its share of the albedo.
#[derive(Debug, Clone)]
pub struct OpenPbr<R: Real, const N: usize, P = Model<R, N>> {
    values: Values<R, N>,
    slabs: Box<[P; slab::COUNT]>,
    present: [bool; slab::COUNT],
    thin: bool,
    layers: Layers<R, N>,
}

/// What follows from the values for the layers.
#[derive(Debug, Clone, Copy)]
struct Layers<R: Real, const N: usize> {
    gloss: Gloss<R>,
    gloss_ior: R,
    coat: Gloss<R>,
    /// Share of light from a rough base that the coat reflects back to it.
    inner_reflection: R,
    /// Roughness of the base as the coat sees it, [0, 1].
    base_roughness: R,
    /// Albedo of the base at normal incidence.
    base_albedo: [R; N],
    metal: Fresnel<R, N>,
    film: Fresnel<R, N>,
}

impl<R: Real, const N: usize> Layers<R, N> {
    fn new(v: &Values<R, N>) -> Self {
        let one = R::one();
        let gloss_ior = v.gloss_ior();
        let f0 = dielectric(one, gloss_ior);
        let mut base_albedo = v.base();
        each_component!(N, k => {
            let metal = v.specular_weight.min(one) * base_albedo[k];
            let body = v.subsurface_weight.lerp(base_albedo[k], v.subsurface_color[k]);
            let under = (one - f0) * (one - v.transmission_weight) * body;
            base_albedo[k] = v.base_metalness.lerp(f0 + under, metal);
        });
        let coat: Fresnel<R, 1> = Fresnel::Dielectric { ior: v.coat_ior };
        let rough = f0.lerp(one, v.specular_roughness);
        Self {
            gloss: Gloss::new(&v.base_surface().distribution, gloss_ior),
            gloss_ior,
            coat: Gloss::new(&v.coat_surface().distribution, v.coat_ior),
            inner_reflection: one - (one - coat.average()[0]) / (v.coat_ior * v.coat_ior),
            base_roughness: v.base_metalness.lerp(rough, v.specular_roughness),
            base_albedo,
            metal: v.metal_fresnel(),
            film: v.gloss_film(),
        }
    }

    fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Layers<S, N> {
        Layers {
            gloss: self.gloss.cast(f),
            gloss_ior: f(self.gloss_ior),
            coat: self.coat.cast(f),
            inner_reflection: f(self.inner_reflection),
            base_roughness: f(self.base_roughness),
            base_albedo: cast(self.base_albedo, f),
            metal: self.metal.cast(f),
            film: self.film.cast(f),
        }
    }
}

/// Factors on the slabs' reflection functions, for one pair of directions.
struct Factors<R: Real, const N: usize> {
    fuzz: R,
    coat: R,
    metal: [R; N],
    gloss: [R; N],
    /// On what lies under the gloss.
    under: [R; N],
    body: [R; N],
    /// What a film leaves of what passes into the body.
    film_passage: [R; N],
}

/// Lobes that are drawn: a slab, and whether it is turned over to the other side of a sheet.
const LOBES: [(usize, bool); 8] = [
    (slab::FUZZ, false),
    (slab::COAT, false),
    (slab::METAL, false),
    (slab::GLOSS, false),
    (slab::DIFFUSE, false),
    (slab::SUBSURFACE, false),
    (slab::BODY, false),
    (slab::SUBSURFACE, true),
];

impl<R: Number, const N: usize> OpenPbr<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let positive = |key: &str| spec.real::<f64>(key) > 0.0;
        let below_one = |key: &str| spec.real::<f64>(key) < 1.0;
        let film = positive("thin_film_weight");
        if film && N != 3 {
            return Err(BrdfError::Unsupported {
                what: format!(
                    "a thin film's colour is known for RGB, and {N} components were asked for"
                ),
            });
        }
        let dielectric = below_one("base_metalness");
        let opaque = dielectric && below_one("transmission_weight");
        let translucent = dielectric && positive("transmission_weight");
        let thin = is_thin(spec);
        let mut present = [false; slab::COUNT];
        present[slab::FUZZ] = positive("fuzz_weight");
        present[slab::COAT] = positive("coat_weight");
        present[slab::METAL] = positive("base_metalness");
        present[slab::METAL_FILM] = present[slab::METAL] && film;
        present[slab::GLOSS] = opaque || (thin && translucent) || (film && translucent);
        present[slab::GLOSS_FILM] = present[slab::GLOSS] && film;
        present[slab::DIFFUSE] = opaque && below_one("subsurface_weight");
        present[slab::SUBSURFACE] = opaque && positive("subsurface_weight");
        present[slab::BODY] = positive("transmission_weight");
        let values = Values::from_spec(spec)?;
        Ok(Self {
            slabs: values.slabs(thin),
            layers: Layers::new(&values),
            values,
            present,
            thin,
        })
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        self.values.set(parameter, value);
        let film = self.present[slab::METAL_FILM] || self.present[slab::GLOSS_FILM];
        match parameter {
            "fuzz_weight" => self.present[slab::FUZZ] = true,
            "coat_weight" => self.present[slab::COAT] = true,
            "transmission_weight" => self.present[slab::BODY] = true,
            "subsurface_weight" => {
                self.present[slab::DIFFUSE] = true;
                self.present[slab::SUBSURFACE] = true;
            }
            "base_metalness" => {
                for k in [slab::METAL, slab::GLOSS, slab::DIFFUSE, slab::SUBSURFACE] {
                    self.present[k] = true;
                }
                self.present[slab::METAL_FILM] = film;
                self.present[slab::GLOSS_FILM] = film;
            }
            "thin_film_weight" => {
                for k in [slab::METAL_FILM, slab::GLOSS, slab::GLOSS_FILM] {
                    self.present[k] = true;
                }
            }
            _ => {}
        }
        self.slabs = self.values.slabs(self.thin);
        self.layers = Layers::new(&self.values);
    }
}

impl<R: Real, const N: usize> Composite<R, N> for OpenPbr<R, N> {
    type With<S: Number, P: Brdf<S, N>> = OpenPbr<S, N, P>;

    fn with<'a, S: Number, P: Brdf<S, N>>(
        &'a self,
        number: &impl Fn(R) -> S,
        part: &impl Fn(&'a Model<R, N>) -> P,
    ) -> OpenPbr<S, N, P>
    where
        R: 'a,
    {
        OpenPbr {
            values: self.values.cast(number),
            slabs: Box::new(self.slabs.each_ref().map(part)),
            present: self.present,
            thin: self.thin,
            layers: self.layers.cast(number),
        }
    }
}

/// `a` where the mask is true, 0 elsewhere.
#[inline]
fn only<R: Real>(mask: R::Mask, a: R) -> R {
    R::select(mask, a, R::zero())
}

impl<R: Real, const N: usize, P: Brdf<R, N>> OpenPbr<R, N, P> {
    /// The film's reflectance over that of the bare dielectric towards the cosine `mu`, mixed by the film's weight.
    #[inline]
    fn film_ratio(&self, mu: R) -> [R; N] {
        let mut ratio = grey(R::one());
        if self.present[slab::GLOSS_FILM] {
            let bare = dielectric(mu, self.layers.gloss_ior).max(R::lit(1e-6));
            let film = self.layers.film.eval(mu);
            each_component!(N, k => {
                ratio[k] = self.values.thin_film_weight.lerp(R::one(), film[k] / bare);
            });
        }
        ratio
    }

    /// What a sheet reflects over what one of its faces does, and what it transmits, at a facet's cosine.
    #[inline]
    fn sheet(&self, cos: R) -> [[R; N]; 2] {
        let one = R::one();
        let f = dielectric(cos, self.layers.gloss_ior);
        let sin2 = (one - cos * cos).max(R::zero());
        let n2 = self.layers.gloss_ior * self.layers.gloss_ior;
        let path = (one - sin2 / n2).max(R::lit(1e-4)).sqrt().recip();
        let (mut reflected, mut through) = (self.values.transmission_color, grey(one));
        each_component!(N, k => {
            let a = (reflected[k].max(R::lit(1e-20)).ln() * path).exp();
            let around = (one - f * f * a * a).max(R::lit(1e-6)).recip();
            let twice = (one - f) * (one - f);
            reflected[k] = one + twice * a * a * around;
            through[k] = twice * a * around;
        });
        [reflected, through]
    }

    /// 1/μ′ in the coat, 0 on the inner side.
    #[inline]
    fn coat_path(&self, w: Vec3<R>) -> R {
        let n2 = self.values.coat_ior * self.values.coat_ior;
        let sin2 = (R::one() - w.z * w.z).max(R::zero());
        let path = (R::one() - sin2 / n2).max(R::lit(1e-4)).sqrt().recip();
        only::<R>(w.z.gt(R::zero()), path)
    }

    /// The factors for a pair of which `a` is the viewer's direction or, where that is inside, the light's.
    fn factors(&self, wi: Vec3<R>, wo: Vec3<R>) -> Factors<R, N> {
        let (one, v, l) = (R::one(), &self.values, &self.layers);
        let a = Vec3::select(wo.z.gt(R::zero()), wo, wi);
        let outer = a.z.gt(R::zero());
        let mu = a.z.saturate();
        let mut left = one;
        if self.present[slab::FUZZ] {
            let e = sheen_lobe::reflectance(mu, v.fuzz_roughness);
            left = one - only::<R>(outer, v.fuzz_weight * e);
        }
        let mut base = grey(left);
        if self.present[slab::COAT] {
            let kept = one - only::<R>(outer, l.coat.albedo(mu));
            let path = (self.coat_path(wi) + self.coat_path(wo)) * R::lit(0.5);
            let smooth = dielectric(mu, v.coat_ior);
            let inner = l.base_roughness.lerp(smooth, l.inner_reflection);
            let darkening = v.coat_weight * v.coat_darkening;
            each_component!(N, k => {
                let passes = (v.coat_color[k].max(R::lit(1e-20)).ln() * path).exp();
                let layer = v.coat_weight.lerp(one, passes * kept);
                let again = one - l.base_albedo[k].saturate() * inner;
                let delta = (one - inner) / again.max(R::lit(1e-6));
                base[k] = base[k] * layer * darkening.lerp(one, delta);
            });
        }
        let gloss = l.gloss.albedo(mu);
        let bare = dielectric(mu, l.gloss_ior);
        let ratio = self.film_ratio(mu);
        let (metal, rest) = (v.base_metalness, one - v.base_metalness);
        let opaque = rest * (one - v.transmission_weight);
        let mut out = Factors {
            fuzz: v.fuzz_weight,
            coat: left * v.coat_weight,
            metal: scale(base, metal * v.specular_weight.min(one)),
            gloss: scale(base, opaque),
            under: scale(base, opaque),
            body: scale(base, rest * v.transmission_weight),
            film_passage: ratio,
        };
        each_component!(N, k => {
            out.gloss[k] = out.gloss[k] * v.specular_color[k];
            out.under[k] = out.under[k] * (one - gloss * ratio[k]).max(R::zero());
            let passes = (one - bare * ratio[k]).max(R::zero());
            out.film_passage[k] = passes / (one - bare).max(R::lit(1e-4));
        });
        out
    }

    /// A slab's f, 0 where it is absent.
    #[inline]
    fn slab(&self, k: usize, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        if self.present[k] {
            self.slabs[k].eval(wi, wo)
        } else {
            grey(R::zero())
        }
    }

    /// A slab's f, mixed with that of the slab with a film.
    #[inline]
    fn with_film(&self, k: usize, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let mut f = self.slab(k, wi, wo);
        if self.present[k + 1] {
            let film = self.slabs[k + 1].eval(wi, wo);
            each_component!(N, c => { f[c] = self.values.thin_film_weight.lerp(f[c], film[c]); });
        }
        f
    }

    /// f of a sheet's or a body's passage.
    #[inline]
    fn body(&self, wi: Vec3<R>, wo: Vec3<R>, gloss: [R; N], film_passage: [R; N]) -> [R; N] {
        let v = &self.values;
        let up = wi.z.gt(R::zero());
        let mut out = grey(R::zero());
        if self.thin {
            let i = flipped_where(!up, wi);
            let cos = ((i + wo).length() * R::lit(0.5)).min(R::one());
            let [reflected, through] = self.sheet(cos);
            let turned = self.slabs[slab::BODY].eval(i, wo);
            each_component!(N, k => {
                let same = gloss[k] * reflected[k] * v.specular_color[k];
                out[k] = R::select(up, same, turned[k] * through[k]);
            });
            return out;
        }
        let f = self.slabs[slab::BODY].eval(wi, wo);
        let (outer, inner) = (up & wo.z.gt(R::zero()), !up & wo.z.lt(R::zero()));
        each_component!(N, k => {
            let mut same = f[k];
            if self.present[slab::GLOSS_FILM] {
                same = v.thin_film_weight.lerp(same, gloss[k]);
            }
            let across = R::select(inner, f[k], f[k] * film_passage[k]);
            out[k] = R::select(outer, same * v.specular_color[k], across);
        });
        out
    }

    /// f, of directions that a sheet has turned so that the viewer is outside.
    fn value(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let v = &self.values;
        let x = self.factors(wi, wo);
        let metal = self.with_film(slab::METAL, wi, wo);
        let gloss = self.with_film(slab::GLOSS, wi, wo);
        let (fuzz, coat) = (self.slab(slab::FUZZ, wi, wo), self.slab(slab::COAT, wi, wo));
        let diffuse = self.slab(slab::DIFFUSE, wi, wo);
        let mut below = self.slab(slab::SUBSURFACE, wi, wo);
        if self.thin && self.present[slab::SUBSURFACE] {
            let up = wi.z.gt(R::zero());
            let turned = self.slabs[slab::SUBSURFACE].eval(flipped_where(!up, wi), wo);
            let g = v.subsurface_scatter_anisotropy * R::lit(0.5);
            let half = R::lit(0.5);
            each_component!(N, k => {
                below[k] = turned[k] * R::select(up, half - g, half + g);
            });
        }
        let mut f = fuzz;
        each_component!(N, k => {
            let body = v.subsurface_weight.lerp(diffuse[k], below[k]);
            f[k] = x.fuzz * f[k]
                + x.coat * coat[k]
                + x.metal[k] * metal[k]
                + x.gloss[k] * gloss[k]
                + x.under[k] * body;
        });
        if self.present[slab::BODY] {
            let body = self.body(wi, wo, gloss, x.film_passage);
            each_component!(N, k => { f[k] = f[k] + x.body[k] * body[k]; });
        }
        f
    }

    /// The albedo that each of [`LOBES`] is thought to have towards a viewer, and their sum.
    fn shares(&self, wo: Vec3<R>) -> ([R; LOBES.len()], R) {
        let (one, v, l) = (R::one(), &self.values, &self.layers);
        let mu = wo.z.abs().min(one);
        let x = self.factors(wo, wo);
        let sheen = sheen_lobe::reflectance(mu, v.fuzz_roughness);
        let metal = mean(l.metal.eval(mu)) * R::lit(0.98) + R::lit(0.02);
        let ratio = mean(self.film_ratio(mu)).max(R::lit(0.1));
        let gloss = l.gloss.albedo(mu) * ratio;
        let under = mean(x.under);
        let hidden = v.subsurface_weight * under * mean(v.subsurface_color);
        let mut w = [
            x.fuzz * mean(v.fuzz_color) * sheen,
            x.coat * l.coat.albedo(mu),
            mean(x.metal) * metal,
            mean(x.gloss) * gloss,
            (one - v.subsurface_weight) * under * v.base_weight * mean(v.base_color),
            hidden,
            mean(x.body),
            R::zero(),
        ];
        if self.thin {
            let [reflected, through] = self.sheet(mu);
            let tint = mean(v.specular_color);
            w[3] = w[3] + mean(x.body) * gloss * mean(reflected) * tint;
            w[6] = w[6] * mean(through);
            let g = v.subsurface_scatter_anisotropy * R::lit(0.5);
            w[5] = hidden * (R::lit(0.5) - g);
            w[7] = hidden * (R::lit(0.5) + g);
        } else {
            // Inside there is only the body; and a film above it is drawn with it.
            let inside = wo.z.lt(R::zero());
            for (k, w) in w.iter_mut().enumerate() {
                if LOBES[k].0 != slab::BODY {
                    *w = R::select(inside, R::zero(), *w);
                }
            }
        }
        let mut sum = R::lit(1e-9);
        for (k, w) in w.iter_mut().enumerate() {
            if !self.present[LOBES[k].0] {
                *w = R::zero();
            }
            sum = sum + *w;
        }
        (w, sum)
    }

    /// Whether a lobe is drawn on the other side of a sheet.
    fn is_turned(&self, lobe: usize) -> bool {
        let (k, turned) = LOBES[lobe];
        turned || (self.thin && k == slab::BODY)
    }

    /// The density of a pair that a sheet has turned so that the viewer is outside.
    fn density(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let (w, sum) = self.shares(wo);
        let over = Vec3::new(wi.x, wi.y, -wi.z);
        let mut density = R::zero();
        for (lobe, (k, turned)) in LOBES.into_iter().enumerate() {
            if !self.present[k] || (turned && !self.thin) {
                continue;
            }
            let i = if self.is_turned(lobe) { over } else { wi };
            density = density + w[lobe] * self.slabs[k].pdf(i, wo);
        }
        density / sum
    }

    /// Whether a sheet is seen from below.
    #[inline]
    fn seen_from_below(&self, wo: Vec3<R>) -> R::Mask {
        R::Mask::splat(self.thin) & wo.z.lt(R::zero())
    }
}

impl<R: Real, const N: usize, P: Brdf<R, N>> Brdf<R, N> for OpenPbr<R, N, P> {
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let below = self.seen_from_below(wo);
        self.value(flipped_where(below, wi), flipped_where(below, wo))
    }

    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let below = self.seen_from_below(wo);
        self.density(flipped_where(below, wi), flipped_where(below, wo))
    }

    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let below = self.seen_from_below(wo);
        let o = flipped_where(below, wo);
        let (w, sum) = self.shares(o);
        let x = u[2] * sum;
        let (mut before, mut wi, mut valid) = (R::zero(), o, R::zero());
        for (lobe, (k, turned)) in LOBES.into_iter().enumerate() {
            if !self.present[k] || (turned && !self.thin) {
                continue;
            }
            // The last of those that start at or below x wins, if it has a share at all.
            let here = before.le(x) & w[lobe].gt(R::zero());
            if R::maybe_any(here) {
                let rest = (x - before) / w[lobe].max(R::lit(1e-20));
                let rest = rest.clamp(R::zero(), R::lit(0.999_999_9));
                let s = self.slabs[k].sample(o, [u[0], u[1], rest]);
                let drawn = if self.is_turned(lobe) {
                    Vec3::new(s.wi.x, s.wi.y, -s.wi.z)
                } else {
                    s.wi
                };
                wi = Vec3::select(here, drawn, wi);
                valid = R::select(here, s.pdf, valid);
            }
            before = before + w[lobe];
        }
        let wi = flipped_where(below, wi);
        let (f, density) = self.eval_cos_and_pdf(wi, wo);
        let drawn = valid.gt(R::zero());
        let density = only::<R>(drawn, density);
        Sample::continuous(wi, only_where(drawn, f), density)
    }

    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        let below = self.seen_from_below(wo);
        self.shares(flipped_where(below, wo)).1
    }

    fn transmits(&self) -> bool {
        self.thin || self.present[slab::BODY]
    }

    fn relative_ior(&self) -> [R; N] {
        if self.thin {
            return grey(R::one());
        }
        if self.present[slab::BODY] {
            return self.slabs[slab::BODY].relative_ior();
        }
        grey(R::one())
    }

    fn absorption(&self) -> [R; N] {
        if self.thin || !self.present[slab::BODY] {
            return grey(R::zero());
        }
        self.slabs[slab::BODY].absorption()
    }
}
