//! A rough boundary into a body of glass, water or another clear medium.

use crate::part::boundary_loss::BoundaryLoss;
use crate::part::colour::{add, grey, only_where, scale};
use crate::part::dielectric::{self, Boundary};
use crate::part::distribution::Shape;
use crate::part::fresnel::dielectric_cosines;
use crate::part::geometry::{flipped_where, refracted_about};
use crate::part::masking::{Masking, visibility_across, visibility_from_areas};
use crate::part::rough::{self, RoughSurface};
use crate::part::slopes;
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "rough-dielectric",
    summary: "a rough boundary into glass or ice: reflection and refraction by microfacets",
    paper: "Walter et al. 2007, \"Microfacet Models for Refraction through Rough Surfaces\"; Heitz 2014 for masking; Kulla & Conty 2017 \
            for interreflection",
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
            &["smith", "smith-correlated"],
            Some("smith-correlated"),
            "masking and shadowing G: independent in the two directions (Walter et al. 2007) or correlated through the height",
        ),
        dielectric::IOR,
        dielectric::REFLECTANCE,
        dielectric::TRANSMITTANCE,
        dielectric::ABSORPTION,
        ParameterInfo::choice(
            "interreflection",
            &["kulla-conty", "none"],
            None,
            "a reciprocal lobe for the light that leaves after several facets; on for ggx and beckmann when not given",
        ),
    ],
    positional: None,
    aliases: &[crate::Alias {
        name: "frosted-glass",
        preset: &[("ior", "1.5"), ("roughness", "0.5")],
    }],
    recordable: true,
    declares: |spec| {
        // Smith's masking for the Blinn–Phong distribution borrows Λ from Beckmann's: visible areas then don't add up.
        let all = dielectric::declares(spec);
        Declares {
            isotropic: slopes::isotropic(spec),
            relative_ior: Some([dielectric::contrasted(spec.real::<f64>("ior")); 3]),
            albedo_bound: if rough::shape(spec) == Shape::BlinnPhong {
                f64::INFINITY
            } else {
                all.albedo_bound
            },
            energy_conserving: rough::shape(spec) != Shape::BlinnPhong,
            ..all
        }
    },
};

/// With n the index of refraction of the side that a direction is on and h the facet's normal, ∝ n_i ωi + n_r ωr:
///
/// - reflection: f = ρ F D G/(4 |cosθi cosθr|)
/// - refraction: f = τ (1 − F) D G |ωi·h| |ωr·h| n_r²/(|cosθi cosθr| (n_i ωi·h + n_r ωr·h)²) (eq. 21)
/// - what leaves after several facets, on both sides:
///   f = (1 − E(ωi)) (1 − E(ωr)) n_r²/(π Σ n² (1 − Ē))
///
/// E is the share of light, in units of n², that leaves after one facet, reflected or refracted (a table over √μ, √α and the index), Ē
/// its mean on each side, and Σ goes over both sides: the lobe is reciprocal and makes a white furnace on either side. How much of
/// it is refracted is an approximation.
///
/// Sampling: a normal (visible ones for GGX), then reflection or refraction by F; the cosine for the last lobe. An index nearer to 1 than 1e-3
/// is taken for 1 ± 1e-3.
#[derive(Debug, Clone, Copy)]
pub struct RoughDielectric<R: Real, const N: usize> {
    /// D and G.
    pub surface: RoughSurface<R>,
    /// Indices and scales.
    pub boundary: Boundary<R, N>,
    /// The lobe of several facets, if any.
    interreflection: Option<BoundaryLoss<R>>,
}

/// What evaluation and density share for one pair of directions, in the frame of (αx, αy).
struct Pair<R: Real> {
    /// The directions on the outer side.
    up: [Vec3<R>; 2],
    /// Whether each is in the body.
    inside: [R; 2],
    /// Index of refraction on the side of each.
    n: [R; 2],
    h: Vec3<R>,
    /// |n_i ωi + n_r ωr|².
    length2: R,
    /// |ω·h| of each.
    cos: [R; 2],
    d: R,
}

impl<R: Real, const N: usize> RoughDielectric<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let masking = Masking::from_name(&spec.word("masking"));
        let surface = RoughSurface::from_spec(spec, masking.unwrap_or(Masking::SmithCorrelated))?;
        let mut boundary = Boundary::from_spec(spec)?;
        boundary.ior = dielectric::contrasted(boundary.ior);
        let known = matches!(surface.distribution.shape(), Shape::Ggx | Shape::Beckmann);
        let interreflection = match spec.word("interreflection").as_str() {
            "kulla-conty" if !known => {
                return Err(spec.wrong(
                    "interreflection",
                    "none: its tables are for distribution=ggx and beckmann",
                ));
            }
            "none" => None,
            _ => known.then(|| BoundaryLoss::new(&surface, boundary.ior)),
        };
        Ok(Self {
            surface,
            boundary,
            interreflection,
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> RoughDielectric<S, N> {
        RoughDielectric {
            surface: self.surface.cast(f),
            boundary: self.boundary.cast(f),
            interreflection: self.interreflection.map(|l| l.cast(f)),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        if !self.surface.set(parameter, value[0]) {
            self.boundary.set(parameter, value);
            self.boundary.ior = dielectric::contrasted(self.boundary.ior);
        }
        if let Some(loss) = &mut self.interreflection {
            *loss = BoundaryLoss::new(&self.surface, self.boundary.ior);
        }
    }

    #[inline(always)]
    fn pair(&self, wi: Vec3<R>, wo: Vec3<R>) -> Pair<R> {
        let w = [self.surface.into_axes(wi), self.surface.into_axes(wo)];
        let one = R::one();
        let below = [w[0].z.lt(R::zero()), w[1].z.lt(R::zero())];
        let n = [
            R::select(below[0], self.boundary.ior, one),
            R::select(below[1], self.boundary.ior, one),
        ];
        // Symmetric in the directions to the last bit, which makes f reciprocal where their sum is small.
        let sum = w[0] * n[0] + w[1] * n[1];
        let length2 = sum.length_squared();
        // Opposite and both grazing, on one side: any half vector is as good as another.
        let lost = length2.lt(R::lit(1e-30));
        let length2 = length2.max(R::lit(1e-30));
        let over = length2.sqrt().recip();
        let h = sum * R::select(sum.z.lt(R::zero()), -over, over);
        let h = Vec3::select(lost, Vec3::new(R::zero(), R::zero(), one), h);
        Pair {
            up: [flipped_where(below[0], w[0]), flipped_where(below[1], w[1])],
            inside: [R::from_mask(below[0]), R::from_mask(below[1])],
            n,
            h,
            length2,
            cos: [w[0].dot(h), w[1].dot(h)],
            d: self.surface.distribution.density(h),
        }
    }

    /// Whether the pair lies on one side of the surface.
    #[inline(always)]
    fn reflects(pair: &Pair<R>) -> R::Mask {
        (pair.inside[0] - pair.inside[1]).abs().lt(R::lit(0.5))
    }

    /// Whether both directions are off the horizon, and each sees the front of the facet from its side.
    #[inline(always)]
    fn valid(pair: &Pair<R>) -> R::Mask {
        let sign = R::lit(-2.0);
        let faces = |k: usize| (pair.cos[k] * (sign * pair.inside[k] + R::one())).gt(R::zero());
        off_horizon(pair) & faces(0) & faces(1)
    }

    /// Fresnel reflectance at the pair's facet.
    #[inline(always)]
    fn fresnel(&self, pair: &Pair<R>) -> R {
        // From both cosines: the same for both orders of the directions.
        let [ci, co] = [pair.cos[0].abs(), pair.cos[1].abs()];
        let mean = ((ci + co) * R::lit(0.5)).min(R::one());
        let reflected = self.boundary.fresnel(mean, pair.inside[1].gt(R::lit(0.5)));
        let outer = R::select(pair.inside[0].gt(R::lit(0.5)), co, ci);
        let inner = R::select(pair.inside[0].gt(R::lit(0.5)), ci, co);
        let through = dielectric_cosines(outer, inner, self.boundary.ior);
        R::select(Self::reflects(pair), reflected, through)
    }

    /// f of the pair.
    #[inline(always)]
    fn value(&self, pair: &Pair<R>, fresnel: R, loss_o: R) -> [R; N] {
        let d = &self.surface.distribution;
        let reflects = Self::reflects(pair);
        let [i, o] = [pair.up[0], pair.up[1]];
        let n2 = pair.n[1] * pair.n[1];
        // 4 G/(4 cosθi cosθr), for both.
        let same = visibility_from_areas(self.surface.masking, d, i, o);
        let across = visibility_across(self.surface.masking, d, i, o) * R::lit(4.0);
        let cosines = pair.cos[0].abs() * pair.cos[1].abs();
        let reflected = fresnel * pair.d * same;
        let through = (R::one() - fresnel) * pair.d * across * cosines * n2 / pair.length2;
        let valid = Self::valid(pair);
        let f = R::select(valid, R::select(reflects, reflected, through), R::zero());
        let mut sum = f;
        if let Some(loss) = &self.interreflection {
            let loss_i = loss.directional(&self.surface, i.z, pair.inside[0]);
            let many = loss.value(loss_i, loss_o) * n2;
            sum = sum + R::select(off_horizon(pair), many, R::zero());
        }
        let b = &self.boundary;
        add(
            only_where(reflects, scale(b.reflectance, sum)),
            only_where(!reflects, scale(b.transmittance, sum)),
        )
    }

    /// The sampling density of the pair.
    #[inline(always)]
    fn density(&self, pair: &Pair<R>, fresnel: R, loss_o: R) -> R {
        let p = self.boundary.reflection_probability(fresnel);
        let co = pair.cos[1].abs();
        let over_cos = self
            .surface
            .normal_density_over_cos(pair.h, pair.d, pair.up[1], co);
        let reflected = R::lit(0.25) * over_cos * p;
        let n2 = pair.n[0] * pair.n[0];
        let through = over_cos * co * (R::one() - p) * n2 * pair.cos[0].abs() / pair.length2;
        let facets = R::select(Self::reflects(pair), reflected, through);
        let facets = R::select(Self::valid(pair), facets, R::zero());
        let Some(loss) = &self.interreflection else {
            return facets;
        };
        let share = pair.inside[0].lerp(R::one() - loss.share_inside, loss.share_inside);
        let cosine = cosine_hemisphere_density(pair.up[0]) * share;
        let density = loss_o.lerp(facets, cosine);
        R::select(off_horizon(pair), density, R::zero())
    }

    /// The loss towards the viewer: the probability of drawing the lobe of several facets.
    #[inline(always)]
    fn loss(&self, wo_up: Vec3<R>, inside: R) -> R {
        match &self.interreflection {
            Some(loss) => loss.directional(&self.surface, wo_up.z, inside),
            None => R::zero(),
        }
    }
}

#[inline(always)]
fn off_horizon<R: Real>(pair: &Pair<R>) -> R::Mask {
    pair.up[0].z.gt(R::zero()) & pair.up[1].z.gt(R::zero())
}

impl<R: Real, const N: usize> Brdf<R, N> for RoughDielectric<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let pair = self.pair(wi, wo);
        let loss = self.loss(pair.up[1], pair.inside[1]);
        self.value(&pair, self.fresnel(&pair), loss)
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let pair = self.pair(wi, wo);
        let loss = self.loss(pair.up[1], pair.inside[1]);
        self.density(&pair, self.fresnel(&pair), loss)
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let pair = self.pair(wi, wo);
        let (fresnel, loss) = (self.fresnel(&pair), self.loss(pair.up[1], pair.inside[1]));
        (
            self.value(&pair, fresnel, loss),
            self.density(&pair, fresnel, loss),
        )
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let inside = wo.z.lt(R::zero());
        let o = flipped_where(inside, self.surface.into_axes(wo));
        let loss = self.loss(o, R::from_mask(inside));
        let many = u[2].lt(loss);
        let rest = ((u[2] - loss) / (R::one() - loss).max(R::lit(1e-6))).saturate();

        let h = self.surface.sample_normal(o, u[0], u[1]);
        let cos = o.dot(h);
        let seen = cos.gt(R::zero());
        let cos = cos.clamp(R::zero(), R::one());
        let f = self.boundary.fresnel(cos, inside);
        let p = self.boundary.reflection_probability(f);
        let reflects = rest.lt(p);
        let up = o.reflect(h);
        let ratio = self.boundary.opposite_over_own(inside).recip();
        let down = refracted_about(o, h, cos, ratio);
        let facet = Vec3::select(reflects, up, down);
        // What is reflected must leave on this side, what is refracted on the other; a direction along the horizon counts as none.
        let right = R::select(reflects, up.z, -down.z).gt(R::zero()) & seen;
        let along = Vec3::new(R::one(), R::zero(), R::zero());
        let mut wi = Vec3::select(right, facet, along);
        if let Some(lobe) = &self.interreflection {
            let cosine = cosine_hemisphere([u[0], u[1]]);
            // The part of u[2] below the loss chooses the side: the share of the other side.
            let own_inside = R::from_mask(inside);
            let other = own_inside.lerp(lobe.share_inside, R::one() - lobe.share_inside);
            let crosses = u[2].lt(loss * other);
            wi = Vec3::select(many, flipped_where(crosses, cosine), wi);
        }
        let wi = flipped_where(inside, self.surface.out_of_axes(wi));
        self.sample_of(wi, wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        let inside = wo.z.lt(R::zero());
        let f = self.boundary.fresnel(wo.z.abs().min(R::one()), inside);
        self.boundary.albedo(f)
    }

    #[inline(always)]
    fn transmits(&self) -> bool {
        true
    }

    #[inline(always)]
    fn relative_ior(&self) -> [R; N] {
        grey(self.boundary.ior)
    }

    #[inline(always)]
    fn absorption(&self) -> [R; N] {
        self.boundary.absorption
    }
}
