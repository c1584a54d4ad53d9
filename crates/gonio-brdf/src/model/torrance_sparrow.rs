//! The microfacet model of Torrance and Sparrow (T18).

use crate::part::colour::{add, each_component, mean, only_where, scale};
use crate::part::distribution::Shape;
use crate::part::fresnel::{self, Fresnel};
use crate::part::geometry::{Half, above, mirrored_about};
use crate::part::interreflection::{self, Interreflection, Loose};
use crate::part::masking::{Masking, visibility};
use crate::part::random_walk::WalkTable;
use crate::part::rough::{self, RoughSurface};
use crate::part::slopes;
use crate::{
    Alias, Brdf, BrdfError, Declares, ModelInfo, ModelSpec, Number, ParameterInfo, Sample,
};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density};
use std::sync::Arc;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "torrance-sparrow",
    summary: "microfacets: tiny mirrors with a distribution of normals that shadow, mask and light each other",
    paper: "Torrance & Sparrow 1967, \"Theory for Off-Specular Reflection from Roughened Surfaces\"; Cook & Torrance 1982; \
            Walter et al. 2007; Heitz 2014; for interreflection Heitz et al. 2016, Kulla & Conty 2017, Turquin 2019",
    parameters: &[
        rough::DISTRIBUTION,
        slopes::ROUGHNESS,
        slopes::ALPHA,
        slopes::ANISOTROPY,
        slopes::ALPHA_X,
        slopes::ALPHA_Y,
        slopes::ROTATION_DEG,
        rough::GAMMA,
        rough::P,
        rough::C,
        ParameterInfo::choice(
            "masking",
            Masking::NAMES,
            Some("smith-correlated"),
            "masking and shadowing G",
        ),
        fresnel::parameter("schlick"),
        fresnel::F0,
        fresnel::F82,
        fresnel::IOR,
        fresnel::ETA,
        fresnel::K,
        fresnel::METAL,
        fresnel::FILM_THICKNESS,
        fresnel::FILM_IOR,
        interreflection::PARAMETER,
    ],
    positional: None,
    aliases: &[
        Alias {
            name: "ggx",
            preset: &[("distribution", "ggx")],
        },
        Alias {
            name: "beckmann",
            preset: &[("distribution", "beckmann")],
        },
        Alias {
            name: "gtr",
            preset: &[("distribution", "gtr")],
        },
        Alias {
            name: "student-t",
            preset: &[("distribution", "student-t")],
        },
        Alias {
            name: "cook-torrance",
            preset: &[("distribution", "beckmann"), ("masking", "v-cavity")],
        },
        Alias {
            name: "torrance-sparrow-1967",
            preset: &[
                ("distribution", "gaussian"),
                ("masking", "v-cavity"),
                ("interreflection", "none"),
            ],
        },
    ],
    recordable: true,
    declares,
};

fn declares(spec: &ModelSpec) -> Declares {
    // Smith's masking for the Blinn–Phong distribution borrows Λ from Beckmann's: visible areas then don't add up.
    let borrowed = rough::shape(spec) == Shape::BlinnPhong && spec.word("masking") != "v-cavity";
    Declares {
        isotropic: slopes::isotropic(spec),
        reciprocal: spec.word("interreflection") != "turquin",
        ..Declares::physical(if borrowed { f64::INFINITY } else { 1.0 })
    }
}

/// f = F(θ′) G(ωi, ωr) D(θh)/(4 cosθi cosθr), and what leaves after several facets, which is selectable:
///
/// - `kulla-conty`: f_ms = F_ms (1 − E(μi)) (1 − E(μr))/(π (1 − Ē)),  F_ms = F̄² Ē/(1 − F̄ (1 − Ē)), added: reciprocal
/// - `turquin`: the lobe times 1 + F₀ (1 − E(μr))/E(μr): its shape stays, and it is not reciprocal
/// - `random-walk`: the lobe of light that is traced from facet to facet on Smith's surface (Heitz et al. 2016): ground truth within its noise,
///   and slow; for GGX and Beckmann of one slope scale
/// - `none`: rough surfaces are then too dark
///
/// E is the directional albedo for F = 1 (a table over √μ, √α and the distribution's tail), Ē its mean, F̄ the mean reflectance and F₀
/// that at normal incidence. For F = 1 a white furnace then is 1 but for the table's interpolation: never more, and at most 6e-3 less. With
/// anisotropy the table is read at the smaller slope scale, which loses less than the true surface: too little is given back,
/// never too much.
///
/// Sampling: visible normals for GGX (Dupuy & Benyoub 2023), all normals for the others, and the cosine for the lobe of several
/// facets, mixed by their shares of the albedo.
#[derive(Debug, Clone)]
pub struct TorranceSparrow<R: Real, const N: usize> {
    /// D and G.
    pub surface: RoughSurface<R>,
    /// F.
    pub fresnel: Fresnel<R, N>,
    /// What leaves after several facets.
    pub interreflection: Interreflection<R, N>,
}

/// What evaluation and density share for one pair of directions, in the frame of (αx, αy).
struct Pair<R: Real> {
    wi: Vec3<R>,
    wo: Vec3<R>,
    half: Half<R>,
    /// D of the half vector.
    d: R,
}

impl<R: Number, const N: usize> TorranceSparrow<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let masking = Masking::from_name(&spec.word("masking"));
        let surface = RoughSurface::from_spec(spec, masking.unwrap_or(Masking::SmithCorrelated))?;
        let fresnel = Fresnel::from_spec(spec)?;
        let word = spec.word("interreflection");
        let interreflection = if word == "random-walk" {
            Interreflection::RandomWalk(walk(spec)?)
        } else {
            Interreflection::new(&word, &surface, &fresnel)
        };
        Ok(Self {
            surface,
            fresnel,
            interreflection,
        })
    }

    /// Whether its formula can be written down: a traced walk can't.
    pub(crate) fn is_recordable(&self) -> bool {
        !matches!(self.interreflection, Interreflection::RandomWalk(_))
    }

    #[inline(always)]
    fn pair(&self, wi: Vec3<R>, wo: Vec3<R>) -> Pair<R> {
        let (wi, wo) = (self.surface.into_axes(wi), self.surface.into_axes(wo));
        let half = Half::new(wi, wo);
        Pair {
            wi,
            wo,
            half,
            d: self.surface.distribution.density_of(&half),
        }
    }

    /// Towards a viewer at cosine `mu`: what is lost, and the probability of drawing what is given back as a lobe.
    #[inline(always)]
    fn loose(&self, mu: R) -> Loose<R> {
        match &self.interreflection {
            Interreflection::KullaConty(lobe) => lobe.towards(&self.surface, mu),
            Interreflection::Turquin { .. } => Loose {
                loss: Interreflection::<R, N>::loss(&self.surface, mu),
                probability: R::zero(),
            },
            Interreflection::RandomWalk(walk) => Loose {
                loss: R::zero(),
                probability: walk.probability(mu),
            },
            Interreflection::None => Loose {
                loss: R::zero(),
                probability: R::zero(),
            },
        }
    }

    /// f of a pair above the horizon.
    #[inline(always)]
    fn value(&self, pair: &Pair<R>, loose: &Loose<R>) -> [R; N] {
        let (wi, wo) = (pair.wi, pair.wo);
        let (d, masking) = (&self.surface.distribution, self.surface.masking);
        let facets = pair.d * visibility(masking, d, wi, wo, &pair.half);
        let mut f = scale(self.fresnel.eval(pair.half.cos), facets);
        match &self.interreflection {
            Interreflection::KullaConty(lobe) => {
                let loss_i = Interreflection::<R, N>::loss(&self.surface, wi.z);
                add(f, lobe.value(loss_i, loose.loss))
            }
            Interreflection::Turquin { f0 } => {
                let lost = loose.loss / (R::one() - loose.loss);
                each_component!(N, k => { f[k] = f[k] * (R::one() + f0[k] * lost); });
                f
            }
            Interreflection::RandomWalk(walk) => add(f, walk.eval(wi, wo)),
            Interreflection::None => f,
        }
    }

    /// The sampling density of a pair above the horizon.
    #[inline(always)]
    fn density(&self, pair: &Pair<R>, loose: &Loose<R>) -> R {
        let half = &pair.half;
        let facets = R::lit(0.25) * self.surface.normal_density_over_cos(half, pair.d, pair.wo);
        match &self.interreflection {
            Interreflection::KullaConty(_) | Interreflection::RandomWalk(_) => loose
                .probability
                .lerp(facets, cosine_hemisphere_density(pair.wi)),
            Interreflection::Turquin { .. } | Interreflection::None => facets,
        }
    }
}

impl<R: Real, const N: usize> TorranceSparrow<R, N> {
    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> TorranceSparrow<S, N> {
        TorranceSparrow {
            surface: self.surface.cast(f),
            fresnel: self.fresnel.cast(f),
            interreflection: self.interreflection.cast(f),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        if !self.surface.set(parameter, value[0]) {
            self.fresnel.set(parameter, value);
        }
        self.interreflection.update(&self.surface, &self.fresnel);
    }
}

/// Traces the walk of a description's surface.
fn walk(spec: &ModelSpec) -> Result<Arc<WalkTable>, BrdfError> {
    let surface: RoughSurface<f64> = RoughSurface::from_spec(spec, Masking::SmithCorrelated)?;
    let unsupported = |what: &str| BrdfError::Unsupported {
        what: format!("interreflection=random-walk needs {what}"),
    };
    if spec.word("masking") != "smith-correlated" {
        return Err(unsupported(
            "masking=smith-correlated, the surface that the light walks on",
        ));
    }
    if !matches!(surface.distribution.shape(), Shape::Ggx | Shape::Beckmann) {
        return Err(unsupported("distribution=ggx or beckmann"));
    }
    if surface.distribution.alpha_x() != surface.distribution.alpha_y() {
        return Err(unsupported("one slope scale for all directions"));
    }
    let fresnel: Fresnel<f64, 3> = Fresnel::from_spec(spec)?;
    Ok(Arc::new(WalkTable::trace(&surface.distribution, &fresnel)))
}

impl<R: Number, const N: usize> Brdf<R, N> for TorranceSparrow<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let pair = self.pair(wi, wo);
        only_where(above(wi, wo), self.value(&pair, &self.loose(wo.z)))
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let density = self.density(&self.pair(wi, wo), &self.loose(wo.z));
        R::select(above(wi, wo), density, R::zero())
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let (up, pair, loose) = (above(wi, wo), self.pair(wi, wo), self.loose(wo.z));
        (
            only_where(up, self.value(&pair, &loose)),
            R::select(up, self.density(&pair, &loose), R::zero()),
        )
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let local = self.surface.into_axes(wo);
        let h = self.surface.sample_normal(local, u[0], u[1]);
        let mut wi = mirrored_about(local, h);
        if let Interreflection::KullaConty(_) | Interreflection::RandomWalk(_) =
            self.interreflection
        {
            let many = cosine_hemisphere([u[0], u[1]]);
            wi = Vec3::select(u[2].lt(self.loose(wo.z).probability), many, wi);
        }
        self.sample_of(self.surface.out_of_axes(wi), wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        mean(self.fresnel.eval(wo.z.saturate()))
    }
}
