//! A rough boundary into a body of glass, water or another clear medium.

use crate::part::boundary_loss::BoundaryLoss;
use crate::part::colour::{add, grey, only_where, scale};
use crate::part::dielectric::{self, Boundary};
use crate::part::distribution::Shape;
use crate::part::facet_pair::{DrawnFacet, FacetPair};
use crate::part::geometry::flipped_where;
use crate::part::masking::Masking;
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
/// it is refracted is an approximation. With anisotropy 1 − E is that of the smaller slope scale times (α_min/α_max)^(5/4): less is given
/// back than was lost.
///
/// Sampling: a normal (visible ones for GGX), then reflection or refraction by F; the cosine for the last lobe. An index nearer to 1 than 1/1024
/// is taken for 1 ± 1/1024.
#[derive(Debug, Clone, Copy)]
pub struct RoughDielectric<R: Real, const N: usize> {
    /// D and G.
    pub surface: RoughSurface<R>,
    /// Indices and scales.
    pub boundary: Boundary<R, N>,
    /// The lobe of several facets, if any.
    interreflection: Option<BoundaryLoss<R>>,
}

impl<R: Real, const N: usize> RoughDielectric<R, N> {
    /// Of a GGX or Beckmann surface, with the lobe of several facets.
    pub(crate) fn with_interreflection(surface: RoughSurface<R>, boundary: Boundary<R, N>) -> Self {
        Self {
            surface,
            boundary,
            interreflection: Some(BoundaryLoss::new(&surface, boundary.ior)),
        }
    }

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
    fn pair(&self, wi: Vec3<R>, wo: Vec3<R>) -> FacetPair<R> {
        FacetPair::new(&self.surface, self.boundary.ior, wi, wo)
    }

    /// f of the pair.
    #[inline(always)]
    fn value(&self, pair: &FacetPair<R>, fresnel: R, loss_o: R) -> [R; N] {
        let reflects = pair.reflects();
        let reflected = fresnel * pair.reflection(&self.surface);
        let through = (R::one() - fresnel) * pair.refraction(&self.surface);
        let f = R::select(reflects, reflected, through);
        let mut sum = R::select(pair.valid(), f, R::zero());
        if let Some(loss) = &self.interreflection {
            let loss_i = loss.directional(&self.surface, pair.up[0].z, pair.inside[0]);
            let many = loss.value(loss_i, loss_o) * (pair.n[1] * pair.n[1]);
            sum = sum + R::select(pair.off_horizon(), many, R::zero());
        }
        let b = &self.boundary;
        add(
            only_where(reflects, scale(b.reflectance, sum)),
            only_where(!reflects, scale(b.transmittance, sum)),
        )
    }

    /// The sampling density of the pair.
    #[inline(always)]
    fn density(&self, pair: &FacetPair<R>, fresnel: R, loss_o: R) -> R {
        let p = self.boundary.reflection_probability(fresnel);
        let facets = pair.density(&self.surface, p);
        let facets = R::select(pair.valid(), facets, R::zero());
        let Some(loss) = &self.interreflection else {
            return facets;
        };
        let share = pair.inside[0].lerp(R::one() - loss.share_inside, loss.share_inside);
        let cosine = cosine_hemisphere_density(pair.up[0]) * share;
        let density = loss_o.lerp(facets, cosine);
        R::select(pair.off_horizon(), density, R::zero())
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

impl<R: Real, const N: usize> Brdf<R, N> for RoughDielectric<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let pair = self.pair(wi, wo);
        let loss = self.loss(pair.up[1], pair.inside[1]);
        self.value(&pair, pair.fresnel(self.boundary.ior), loss)
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let pair = self.pair(wi, wo);
        let loss = self.loss(pair.up[1], pair.inside[1]);
        self.density(&pair, pair.fresnel(self.boundary.ior), loss)
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let pair = self.pair(wi, wo);
        let (fresnel, loss) = (
            pair.fresnel(self.boundary.ior),
            self.loss(pair.up[1], pair.inside[1]),
        );
        (
            self.value(&pair, fresnel, loss),
            self.density(&pair, fresnel, loss),
        )
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let facet = DrawnFacet::new(&self.surface, wo, [u[0], u[1]]);
        let inside = facet.inside;
        let loss = self.loss(facet.wo, R::from_mask(inside));
        let many = u[2].lt(loss);
        let rest = ((u[2] - loss) / (R::one() - loss).max(R::lit(1e-6))).saturate();

        let f = self.boundary.fresnel(facet.cos, inside);
        let p = self.boundary.reflection_probability(f);
        let mut wi = facet.leaving(self.boundary.ior, rest.lt(p));
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
