//! A mixture of two models (T9b).

use super::Composite;
use super::sum::same_interior;
use crate::part::colour::{cast, each_component, mean, only_where, scale};
use crate::{
    Brdf, BrdfError, Declares, Kind, Model, ModelInfo, ModelSpec, Number, ParameterInfo, Sample,
};
use gonio_num::{Real, Vec3};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "mix",
    summary: "two models in shares that add up to 1, as in mix(0.3, lambertian:0.2, ggx:metal=gold)",
    paper: "Nicodemus et al. 1977, \"Geometrical Considerations and Nomenclature for Reflectance\": linearity",
    parameters: &[
        ParameterInfo::colour(
            "weight",
            (0.0, 1.0),
            Some([0.5; 3]),
            "share of the second model; the first has the rest",
        ),
        ParameterInfo {
            name: "of",
            kind: Kind::Models,
            meaning: "the models, two",
        },
    ],
    positional: Some("weight"),
    aliases: &[],
    recordable: true,
    declares,
};

fn declares(spec: &ModelSpec) -> Declares {
    let [Ok(first), Ok(second)] = [0, 1].map(|k| match spec.models("of").get(k) {
        Some(part) => part.declares(),
        None => Err(spec.wrong("of", "two models")),
    }) else {
        return Declares::physical(f64::INFINITY);
    };
    let mut bound: f64 = 0.0;
    for w in spec.rgb("weight").unwrap_or_default() {
        // 0 times an unbounded albedo is 0, not NaN.
        let share = |w: f64, b: f64| if w == 0.0 { 0.0 } else { w * b };
        bound = bound.max(share(1.0 - w, first.albedo_bound) + share(w, second.albedo_bound));
    }
    Declares {
        reciprocal: first.reciprocal && second.reciprocal,
        isotropic: first.isotropic && second.isotropic,
        relative_ior: first.relative_ior.or(second.relative_ior),
        ..Declares::physical(bound)
    }
}

/// f = (1 − w)·f₁ + w·f₂, for each colour.
///
/// `sample` chooses one of the two with a probability proportional to its share times its estimated albedo (plus 1/50 of both). A
/// continuous direction gets the weight and density of the whole; a discrete one the part's weight over its probability.
///
/// If both transmit they must agree on the index of refraction, since there is one inner side; its absorption is that of the first
/// that does.
#[derive(Debug, Clone)]
pub struct Mix<R: Real, const N: usize, P = Model<R, N>> {
    /// w, [0, 1].
    pub weight: [R; N],
    /// f₁ and f₂.
    pub parts: Box<[P; 2]>,
}

impl<R: Number, const N: usize> Mix<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        match spec.models("of") {
            parts @ [first, second] => {
                same_interior(spec, parts)?;
                Ok(Self {
                    weight: spec.colour("weight")?,
                    parts: Box::new([first.build()?, second.build()?]),
                })
            }
            _ => Err(spec.wrong("of", "exactly two models: mix(weight, model, model)")),
        }
    }

    pub(crate) fn set(&mut self, _parameter: &str, value: [R; 3]) {
        self.weight = super::components(value);
    }
}

impl<R: Real, const N: usize> Composite<R, N> for Mix<R, N> {
    type With<S: Number, P: Brdf<S, N>> = Mix<S, N, P>;

    fn with<'a, S: Number, P: Brdf<S, N>>(
        &'a self,
        number: &impl Fn(R) -> S,
        part: &impl Fn(&'a Model<R, N>) -> P,
    ) -> Mix<S, N, P>
    where
        R: 'a,
    {
        let [first, second] = &*self.parts;
        Mix {
            weight: cast(self.weight, number),
            parts: Box::new([part(first), part(second)]),
        }
    }
}

impl<R: Real, const N: usize, P: Brdf<R, N>> Mix<R, N, P> {
    /// The first part that transmits.
    fn interior(&self) -> Option<&P> {
        self.parts.iter().find(|part| part.transmits())
    }

    /// The share of part `k`.
    #[inline]
    fn share(&self, k: usize) -> [R; N] {
        let mut share = self.weight;
        if k == 0 {
            each_component!(N, c => { share[c] = R::one() - share[c]; });
        }
        share
    }

    /// Probabilities of choosing each part.
    #[inline]
    fn choices(&self, wo: Vec3<R>) -> [R; 2] {
        let [first, second] = &*self.parts;
        let (a, b) = (first.albedo_estimate(wo), second.albedo_estimate(wo));
        let floor = (a + b) * R::lit(0.02) + R::lit(1e-6);
        let (a, b) = (
            mean(self.share(0)) * (a + floor),
            mean(self.share(1)) * (b + floor),
        );
        let over = (a + b).recip();
        [a * over, b * over]
    }

    /// (1 − w)·a + w·b.
    #[inline]
    fn mixed(&self, a: [R; N], b: [R; N]) -> [R; N] {
        let mut f = a;
        each_component!(N, c => { f[c] = self.weight[c].lerp(a[c], b[c]); });
        f
    }
}

impl<R: Real, const N: usize, P: Brdf<R, N>> Brdf<R, N> for Mix<R, N, P> {
    #[inline]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let [first, second] = &*self.parts;
        self.mixed(first.eval(wi, wo), second.eval(wi, wo))
    }

    #[inline]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let ([a, b], [first, second]) = (self.choices(wo), &*self.parts);
        a * first.pdf(wi, wo) + b * second.pdf(wi, wo)
    }

    #[inline]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let ([a, b], [first, second]) = (self.choices(wo), &*self.parts);
        let ((f, p), (g, q)) = (first.eval_and_pdf(wi, wo), second.eval_and_pdf(wi, wo));
        (self.mixed(f, g), a * p + b * q)
    }

    #[inline]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let [a, b] = self.choices(wo);
        let below = R::lit(0.999_999_9);
        let first = u[2].lt(a);
        let (mut drawn, mut delta) = (Sample::none(), Sample::none());
        for (k, chosen) in [(0, first), (1, !first)] {
            if !R::maybe_any(chosen) {
                continue;
            }
            let (probability, from) = if k == 0 { (a, R::zero()) } else { (b, a) };
            let rest = (u[2] - from) / probability.max(R::lit(1e-20));
            let rest = rest.clamp(R::zero(), below);
            let s = self.parts[k].sample(wo, [u[0], u[1], rest]);
            drawn = Sample::select(chosen, s, drawn);
            let over = probability.max(R::lit(1e-20)).recip();
            let mut weight = scale(s.weight, over);
            let share = self.share(k);
            each_component!(N, c => { weight[c] = weight[c] * share[c]; });
            let discrete = Sample {
                weight,
                pdf: s.pdf * probability,
                ..s
            };
            delta = Sample::select(chosen, discrete, delta);
        }
        let (wi, valid) = (drawn.wi, drawn.pdf.gt(R::zero()));
        let (whole, density) = self.eval_cos_and_pdf(wi, wo);
        let whole = only_where(valid, whole);
        let density = R::select(valid, density, R::zero());
        Sample::select(drawn.delta, delta, Sample::continuous(wi, whole, density))
    }

    #[inline]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        let [first, second] = &*self.parts;
        let weight = mean(self.weight);
        weight.lerp(first.albedo_estimate(wo), second.albedo_estimate(wo))
    }

    fn transmits(&self) -> bool {
        self.interior().is_some()
    }

    fn relative_ior(&self) -> [R; N] {
        self.interior().map_or([R::one(); N], Brdf::relative_ior)
    }

    fn absorption(&self) -> [R; N] {
        self.interior().map_or([R::zero(); N], Brdf::absorption)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model(text: &str) -> Model<f64, 3> {
        ModelSpec::parse(text).unwrap().build().unwrap()
    }

    #[test]
    fn shares_add_up_for_each_colour() {
        let (wi, wo) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.6, 0.8));
        let m = model("mix(0/0.25/1, lambertian:0.4, lambertian:0.8)");
        for (f, rho) in m.eval(wi, wo).into_iter().zip([0.4, 0.5, 0.8]) {
            assert!((f - rho / std::f64::consts::PI).abs() < 1e-15);
        }
        // Nested: a quarter of white, three quarters of black but for the mirror, which `eval` can't see.
        let m = model("mix(0.75, lambertian:1, mix(0.5, lambertian:0, mirror:1))");
        assert!((m.eval(wi, wo)[0] - 0.25 / std::f64::consts::PI).abs() < 1e-15);
        let s = m.sample(wo, [0.5, 0.5, 0.999]);
        assert!(s.delta && s.wi == Vec3::new(0.0, -0.6, 0.8));
        // Weight times probability is the mirror's share of the reflectance.
        assert!((s.weight[0] * s.pdf - 0.375).abs() < 1e-12);
    }

    /// The mean weight over all draws is the albedo 0.7·0.5 + 0.3·1. The choice falls between cells of u₂: half of 1/1000.
    #[test]
    fn draws_reflect_the_albedo() {
        let m = model("mix(0.3, lambertian:0.5, mirror:1)");
        let wo = Vec3::new(0.0, 0.6, 0.8);
        let n = 1000;
        let albedo: f64 = (0..n)
            .map(|k| m.sample(wo, [0.3, 0.7, (f64::from(k) + 0.5) / f64::from(n)]))
            .map(|s| s.weight[0] / f64::from(n))
            .sum();
        assert!((albedo - 0.65).abs() < 1e-3, "{albedo}");
    }

    #[test]
    fn declared_from_the_parts() {
        let declares = |text: &str| ModelSpec::parse(text).unwrap().declares().unwrap();
        let d = declares("mix(0.5, lambertian:0.4, mirror:1)");
        assert!(d.reciprocal && d.energy_conserving && (d.albedo_bound - 0.7).abs() < 1e-15);
        assert!(!declares("mix(0.5, lambertian:0.4, toon)").energy_conserving);
        assert!(declares("mix(0, lambertian:0.4, toon)").energy_conserving);
        assert!(!declares("mix(0.5, ggx:anisotropy=0.5, toon)").isotropic);
        // A pane is mixed with what reflects, not with another medium.
        let glass = "mix(0.5, lambertian:0.4, smooth-dielectric:ior=1.5)";
        assert_eq!(declares(glass).relative_ior, Some([1.5; 3]));
        assert!(model(glass).transmits());
        let two = "mix(0.5, smooth-dielectric:ior=1.3, smooth-dielectric:ior=1.5)";
        let error = ModelSpec::parse(two)
            .unwrap()
            .build::<f64, 3>()
            .unwrap_err();
        assert!(error.to_string().contains("inner side"), "{error}");
    }
}
