//! A coat of varnish over anything (T9b).

use super::{Composite, torrance_sparrow::TorranceSparrow};
use crate::part::colour::{cast, each_component, grey, mean, only_where, scale};
use crate::part::fresnel::{Fresnel, dielectric};
use crate::part::gloss::Gloss;
use crate::part::interreflection::Interreflection;
use crate::part::masking::Masking;
use crate::part::rough::RoughSurface;
use crate::part::slopes::{ANISOTROPY, ROTATION_DEG};
use crate::{
    Brdf, BrdfError, Declares, Kind, Model, ModelInfo, ModelSpec, Number, ParameterInfo, Sample,
};
use gonio_num::{Real, Vec3};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "coat",
    summary: "a coat of varnish over any model, as in coat(roughness=0.1, color=1/0.8/0.5, lambertian:0.6)",
    paper: "Kulla & Conty 2017, \"Revisiting Physically Based Shading at Imageworks\" (layers by albedo); Portsmouth et al. 2025, \
            \"OpenPBR Surface\" 1.1 (absorption and darkening); Elias, Simonot & Menu 2001 (interfaced Lambertian)",
    parameters: &[
        ParameterInfo {
            name: "of",
            kind: Kind::Models,
            meaning: "the model below, one",
        },
        ParameterInfo::number(
            "weight",
            "",
            (0.0, 1.0),
            Some(1.0),
            "share of the surface that is coated",
        ),
        ParameterInfo::number(
            "roughness",
            "",
            (0.0, 1.0),
            Some(0.1),
            "perceptual roughness of the coat; alpha = roughness², not below 1e-4",
        ),
        ANISOTROPY,
        ROTATION_DEG,
        ParameterInfo::number(
            "ior",
            "",
            (1.0, 4.0),
            Some(1.5),
            "index of refraction of the coat",
        ),
        ParameterInfo::colour(
            "color",
            (0.0, 1.0),
            Some([1.0; 3]),
            "what passes the coat twice, down and up, at normal incidence",
        ),
        ParameterInfo::number(
            "darkening",
            "",
            (0.0, 1.0),
            Some(1.0),
            "how much of the darkening by reflection inside the coat is kept",
        ),
        ParameterInfo::choice(
            "layering",
            &["reciprocal", "albedo-scaling"],
            Some("reciprocal"),
            "what the coat leaves: the less of both directions, or that of the viewer's (not reciprocal, white stays white)",
        ),
    ],
    positional: None,
    aliases: &[],
    recordable: true,
    declares: |spec| {
        let of = spec.models("of").first().map(ModelSpec::declares);
        let Some(Ok(d)) = of else {
            return Declares::physical(f64::INFINITY);
        };
        let bound = d.albedo_bound.max(1.0);
        Declares {
            reciprocal: d.reciprocal && spec.word("layering") == "reciprocal",
            isotropic: d.isotropic && spec.real::<f64>("anisotropy") == 0.0,
            albedo_bound: bound,
            energy_conserving: bound <= 1.0,
            ..d
        }
    },
};

/// f = w f_c + ((1 − w) + w L T Δ) f₁, f₁ what lies below and f_c the reflection of a rough dielectric (`torrance-sparrow` without
/// interreflection: what isn't reflected by one facet enters the coat), with
///
/// - L = min(1 − E(μi), 1 − E(μr)), or 1 − E(μr): E the albedo of f_c (a table). The first is reciprocal and keeps the energy over whatever lies
///   below, at the price of some light at grazing angles; with the second white under the coat stays white. Either is 1 on the inner side.
/// - T = color^((1/μ′i + 1/μ′r)/2), the absorption along the refracted paths, μ′ = √(1 − (1 − μ²)/η²)
/// - Δ = lerp(1, (1 − K)/(1 − E₁ K), darkening): light that is reflected inside the coat meets what lies below again. E₁ is the albedo of f₁
///   at normal incidence, and K the internal reflectance, averaged over the directions that f₁ reflects to: F̄ᵢ = 1 − (1 − F̄)/η² over
///   a Lambertian, F₀ over a mirror. Both are means of 64 draws from f₁.
///
/// f₁ is evaluated with the directions outside: the coat doesn't narrow its lobes.
#[derive(Debug, Clone)]
pub struct Coat<R: Real, const N: usize, P = Model<R, N>> {
    /// w, [0, 1].
    pub weight: R,
    /// What passes twice, [0, 1].
    pub color: [R; N],
    /// [0, 1].
    pub darkening: R,
    /// f_c and f₁.
    parts: Box<[P; 2]>,
    ior: R,
    gloss: Gloss<R>,
    reciprocal: bool,
    /// Δ.
    kept: [R; N],
}

impl<R: Number, const N: usize> Coat<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let [of] = spec.models("of") else {
            return Err(spec.wrong("of", "exactly one model: coat(key=value, model)"));
        };
        let surface = RoughSurface::ggx(
            Masking::SmithCorrelated,
            spec.real("roughness"),
            spec.real("anisotropy"),
            spec.real("rotation_deg"),
        );
        let ior = spec.real("ior");
        let mut coat = Self {
            weight: spec.real("weight"),
            color: spec.colour("color")?,
            darkening: spec.real("darkening"),
            gloss: Gloss::new(&surface.distribution, ior),
            ior,
            parts: Box::new([
                Model::TorranceSparrow(TorranceSparrow {
                    surface,
                    fresnel: Fresnel::Dielectric { ior },
                    interreflection: Interreflection::None,
                }),
                of.build()?,
            ]),
            reciprocal: spec.word("layering") == "reciprocal",
            kept: grey(R::one()),
        };
        coat.update();
        Ok(coat)
    }

    /// What lies below.
    pub fn base(&self) -> &Model<R, N> {
        &self.parts[1]
    }

    pub(crate) fn base_mut(&mut self) -> &mut Model<R, N> {
        &mut self.parts[1]
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        let x = value[0];
        let Model::TorranceSparrow(top) = &mut self.parts[0] else {
            unreachable!("invariant: the coat reflects by microfacets")
        };
        match parameter {
            "weight" => self.weight = x,
            "color" => self.color = super::components(value),
            "darkening" => self.darkening = x,
            _ => top.set(parameter, value),
        }
        if parameter == "ior" {
            self.ior = x;
        }
        self.gloss = Gloss::new(&top.surface.distribution, self.ior);
        self.update();
    }

    /// Finds Δ anew, for another coat or base.
    pub(crate) fn update(&mut self) {
        const DRAWS: u32 = 64;
        let up = Vec3::new(R::zero(), R::zero(), R::one());
        let (mut albedo, mut internal) = (grey::<R, N>(R::zero()), R::zero());
        let mut total = R::lit(1e-6);
        for k in 0..DRAWS {
            // The additive recurrence of the root of x⁴ = x + 1: evenly spread in three dimensions.
            let u = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9]
                .map(|step: f64| R::lit((0.5 + f64::from(k) * step).fract()));
            let s = self.parts[1].sample(up, u);
            let leaves = s.wi.z.gt(R::zero());
            let mut weight = only_where(leaves, s.weight);
            for (sum, w) in albedo.iter_mut().zip(&mut weight) {
                *w = *w * R::lit(1.0 / f64::from(DRAWS));
                *sum = *sum + *w;
            }
            let share = mean(weight);
            let reflected = dielectric(s.wi.z.clamp(R::zero(), R::one()), self.ior.recip());
            internal = internal + share * reflected;
            total = total + share;
        }
        let k = internal / total;
        for (kept, e) in self.kept.iter_mut().zip(albedo) {
            let delta = (R::one() - k) / (R::one() - e.saturate() * k).max(R::lit(1e-6));
            *kept = self.darkening.lerp(R::one(), delta);
        }
    }
}

impl<R: Real, const N: usize> Composite<R, N> for Coat<R, N> {
    type With<S: Number, P: Brdf<S, N>> = Coat<S, N, P>;

    fn with<'a, S: Number, P: Brdf<S, N>>(
        &'a self,
        number: &impl Fn(R) -> S,
        part: &impl Fn(&'a Model<R, N>) -> P,
    ) -> Coat<S, N, P>
    where
        R: 'a,
    {
        let [top, base] = &*self.parts;
        Coat {
            weight: number(self.weight),
            color: cast(self.color, number),
            darkening: number(self.darkening),
            parts: Box::new([part(top), part(base)]),
            ior: number(self.ior),
            gloss: self.gloss.cast(number),
            reciprocal: self.reciprocal,
            kept: cast(self.kept, number),
        }
    }
}

impl<R: Real, const N: usize, P: Brdf<R, N>> Coat<R, N, P> {
    /// E(μ), 0 on the inner side.
    #[inline]
    fn reflected(&self, w: Vec3<R>) -> R {
        let outer = w.z.gt(R::zero());
        R::select(outer, self.gloss.albedo(w.z), R::zero())
    }

    /// 1/μ′, 0 on the inner side.
    #[inline]
    fn path(&self, w: Vec3<R>) -> R {
        let sin2 = (R::one() - w.z * w.z).max(R::zero());
        let cos2 = R::one() - sin2 / (self.ior * self.ior);
        let path = cos2.max(R::lit(1e-4)).sqrt().recip();
        R::select(w.z.gt(R::zero()), path, R::zero())
    }

    /// The factor on what lies below, with E(μr).
    #[inline]
    fn left(&self, wi: Vec3<R>, wo: Vec3<R>, reflected_o: R) -> [R; N] {
        let reflected = if self.reciprocal {
            self.reflected(wi).max(reflected_o)
        } else {
            reflected_o
        };
        let path = (self.path(wi) + self.path(wo)) * R::lit(0.5);
        let under = R::one() - reflected;
        let mut left = self.color;
        each_component!(N, k => {
            let passes = left[k].max(R::lit(1e-20)).ln();
            let passes = (passes * path).exp() * under * self.kept[k];
            left[k] = self.weight.lerp(R::one(), passes);
        });
        left
    }

    /// Probabilities of choosing the coat and what lies below.
    #[inline]
    fn choices(&self, wo: Vec3<R>, reflected: R) -> [R; 2] {
        let coat = self.weight * reflected;
        let below = self.parts[1].albedo_estimate(wo) * mean(self.left(wo, wo, reflected));
        let floor = R::lit(0.02) * (coat + below) + R::lit(1e-6);
        // The coat has no inner side to sample.
        let coat = R::select(wo.z.gt(R::zero()), coat + floor, R::zero());
        let over = (coat + below + floor).recip();
        [coat * over, (below + floor) * over]
    }
}

impl<R: Real, const N: usize, P: Brdf<R, N>> Brdf<R, N> for Coat<R, N, P> {
    #[inline]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let [top, base] = &*self.parts;
        let (mut f, below) = (top.eval(wi, wo), base.eval(wi, wo));
        let left = self.left(wi, wo, self.reflected(wo));
        each_component!(N, k => { f[k] = self.weight * f[k] + left[k] * below[k]; });
        f
    }

    #[inline]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let ([a, b], [top, base]) = (self.choices(wo, self.reflected(wo)), &*self.parts);
        a * top.pdf(wi, wo) + b * base.pdf(wi, wo)
    }

    #[inline]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let [top, base] = &*self.parts;
        let reflected = self.reflected(wo);
        let [a, b] = self.choices(wo, reflected);
        let ((mut f, p), (below, q)) = (top.eval_and_pdf(wi, wo), base.eval_and_pdf(wi, wo));
        let left = self.left(wi, wo, reflected);
        each_component!(N, k => { f[k] = self.weight * f[k] + left[k] * below[k]; });
        (f, a * p + b * q)
    }

    #[inline]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let reflected = self.reflected(wo);
        let [a, b] = self.choices(wo, reflected);
        let [top, base] = &*self.parts;
        let rest = ((u[2] - a) / b.max(R::lit(1e-20))).clamp(R::zero(), R::lit(0.999_999_9));
        let below = base.sample(wo, [u[0], u[1], rest]);
        let drawn = Sample::select(u[2].lt(a), top.sample(wo, [u[0], u[1], u[2]]), below);
        let mut weight = scale(below.weight, b.max(R::lit(1e-20)).recip());
        let left = self.left(below.wi, wo, reflected);
        each_component!(N, k => { weight[k] = weight[k] * left[k]; });
        let delta = Sample {
            weight,
            pdf: below.pdf * b,
            ..below
        };
        let (wi, valid) = (drawn.wi, drawn.pdf.gt(R::zero()));
        let (whole, density) = self.eval_cos_and_pdf(wi, wo);
        let whole = only_where(valid, whole);
        let density = R::select(valid, density, R::zero());
        Sample::select(drawn.delta, delta, Sample::continuous(wi, whole, density))
    }

    #[inline]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        let reflected = self.reflected(wo);
        let below = self.parts[1].albedo_estimate(wo);
        self.weight * reflected + below * mean(self.left(wo, wo, reflected))
    }

    fn transmits(&self) -> bool {
        self.parts[1].transmits()
    }

    fn relative_ior(&self) -> [R; N] {
        self.parts[1].relative_ior()
    }

    fn absorption(&self) -> [R; N] {
        self.parts[1].absorption()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::part::fresnel::Fresnel;
    use gonio_radiometry::warp::around_axis;

    fn model(text: &str) -> Model<f64, 3> {
        ModelSpec::parse(text).unwrap().build().unwrap()
    }

    /// The mean weight of draws over a grid.
    fn albedo(model: &Model<f64, 3>, mu: f64) -> [f64; 3] {
        let wo = around_axis(0.0, (1.0 - mu * mu).sqrt(), mu);
        let n = 40;
        let mut sum = [0.0; 3];
        for k in 0..n * n * n {
            let u = [k % n, k / n % n, k / (n * n)].map(|i| (f64::from(i) + 0.5) / f64::from(n));
            let s = model.sample(wo, u);
            for (sum, w) in sum.iter_mut().zip(s.weight) {
                *sum += w / f64::from(n * n * n);
            }
        }
        sum
    }

    /// Over a Lambertian of albedo ρ and a smooth coat, the albedo is F + (1 − F) ρ (1 − K)/(1 − ρK), K = 1 − (1 − F̄)/η²: exact for light
    /// under a smooth interface (Elias et al. 2001). F is a table here, above the truth by up to 1e-2, and K a mean of 64 draws.
    #[test]
    fn over_a_lambertian_it_is_the_interfaced_one() {
        let coated = model("coat(roughness=0.02, layering=albedo-scaling, lambertian:0.2/0.5/1)");
        let mean = Fresnel::<f64, 3>::Dielectric { ior: 1.5 }.average()[0];
        let k = 1.0 - (1.0 - mean) / 2.25;
        for mu in [1.0, 0.7] {
            let f = dielectric(mu, 1.5);
            for (found, rho) in albedo(&coated, mu).into_iter().zip([0.2, 0.5, 1.0]) {
                let exact = f + (1.0 - f) * rho * (1.0 - k) / (1.0 - rho * k);
                assert!((found - exact).abs() < 0.02, "{mu} {rho}: {found} {exact}");
            }
        }
    }

    #[test]
    fn a_coat_without_contrast_or_weight_is_none() {
        let (wi, wo) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.28, 0.96));
        let bare = model("ggx:f0=0.5,roughness=0.4").eval(wi, wo)[0];
        for text in ["weight=0", "ior=1"] {
            let f = model(&format!("coat({text}, ggx:f0=0.5,roughness=0.4)")).eval(wi, wo)[0];
            assert!((f - bare).abs() < 2e-3 * bare, "{text}: {f} {bare}");
        }
    }

    #[test]
    fn colour_is_what_passes_twice() {
        let up = Vec3::new(0.0, 0.0, 1.0);
        let text = |color: &str| format!("coat(color={color}, darkening=0, ior=1, mirror:1)");
        let s = model(&text("0.25/0.5/1")).sample(up, [0.5, 0.5, 0.9]);
        let clear = model(&text("1")).sample(up, [0.5, 0.5, 0.9]);
        for (k, c) in [0.25, 0.5, 1.0].into_iter().enumerate() {
            assert!((s.weight[k] / clear.weight[k] - c).abs() < 1e-3);
        }
        assert!(s.delta);
    }

    #[test]
    fn one_base() {
        for text in ["coat(weight=1)", "coat(mirror:1, mirror:1)"] {
            let built = ModelSpec::parse(text).and_then(|s| s.build::<f64, 3>());
            let error = built.unwrap_err().to_string();
            assert!(error.contains("exactly one model"), "{error}");
        }
    }
}
