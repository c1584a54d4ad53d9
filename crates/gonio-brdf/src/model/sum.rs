//! A sum of models (T9b).

use super::Composite;
use crate::part::colour::{add, grey, only_where, scale};
use crate::{
    Brdf, BrdfError, Declares, Kind, Model, ModelInfo, ModelSpec, Number, ParameterInfo, Sample,
};
use gonio_num::{Real, Vec3};
use std::marker::PhantomData;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "sum",
    summary: "the sum of several models, as in sum(lambertian:reflectance=0.4, ggx:f0=0.04)",
    paper: "Nicodemus et al. 1977, \"Geometrical Considerations and Nomenclature for Reflectance\": linearity",
    parameters: &[ParameterInfo {
        name: "parts",
        kind: Kind::Models,
        meaning: "the models to add",
    }],
    positional: None,
    aliases: &[],
    recordable: true,
    declares,
};

fn declares(spec: &ModelSpec) -> Declares {
    let mut all = Declares::physical(0.0);
    for part in spec.models("parts") {
        let d = part.declares().unwrap_or(all);
        all.reciprocal &= d.reciprocal;
        all.isotropic &= d.isotropic;
        all.albedo_bound += d.albedo_bound;
        all.relative_ior = all.relative_ior.or(d.relative_ior);
    }
    all.energy_conserving = all.albedo_bound <= 1.0;
    all
}

/// Refuses parts that transmit into media of different indices of refraction.
pub(super) fn same_interior(spec: &ModelSpec, parts: &[ModelSpec]) -> Result<(), BrdfError> {
    let mut first: Option<[f64; 3]> = None;
    for part in parts {
        let Some(ior) = part.declares()?.relative_ior else {
            continue;
        };
        match first {
            Some(other) if other != ior => {
                return Err(BrdfError::Unsupported {
                    what: format!(
                        "the parts of `{spec}` transmit into media of different indices of refraction, {other:?} and {ior:?}: \
                         a surface has one inner side"
                    ),
                });
            }
            _ => first = Some(ior),
        }
    }
    Ok(())
}

/// f = Σ fₖ.
///
/// `sample` chooses a part with a probability proportional to its estimated albedo (at least 1/50 of the sum for each part).
/// A continuous direction gets the weight and density of the whole sum; a discrete one the part's weight over its probability.
///
/// Parts that transmit must agree on the index of refraction, since there is one inner side; its absorption is that of the first
/// of them.
#[derive(Debug, Clone)]
pub struct Sum<R: Real, const N: usize, P = Model<R, N>> {
    /// The parts, at least one.
    pub parts: Vec<P>,
    colours: PhantomData<[R; N]>,
}

impl<R: Number, const N: usize> Sum<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let parts = spec.models("parts");
        if parts.is_empty() {
            return Err(spec.wrong("parts", "at least one model: sum(model, model)"));
        }
        same_interior(spec, parts)?;
        let parts: Result<_, _> = parts.iter().map(ModelSpec::build).collect();
        Ok(Self {
            parts: parts?,
            colours: PhantomData,
        })
    }

    pub(crate) fn set(&mut self, _parameter: &str, _value: [R; 3]) {}
}

impl<R: Real, const N: usize> Composite<R, N> for Sum<R, N> {
    type With<S: Number, P: Brdf<S, N>> = Sum<S, N, P>;

    fn with<'a, S: Number, P: Brdf<S, N>>(
        &'a self,
        _number: &impl Fn(R) -> S,
        part: &impl Fn(&'a Model<R, N>) -> P,
    ) -> Sum<S, N, P>
    where
        R: 'a,
    {
        Sum {
            parts: self.parts.iter().map(part).collect(),
            colours: PhantomData,
        }
    }
}

impl<R: Real, const N: usize, P: Brdf<R, N>> Sum<R, N, P> {
    /// The first part that transmits.
    fn interior(&self) -> Option<&P> {
        self.parts.iter().find(|part| part.transmits())
    }

    /// Probability weight of part `k`, before division by the total.
    #[inline]
    fn choice(&self, k: usize, wo: Vec3<R>, mean: R) -> R {
        self.parts[k].albedo_estimate(wo) + mean
    }

    /// What is added to each part's albedo estimate, and the total of the weights.
    #[inline]
    fn choices(&self, wo: Vec3<R>) -> (R, R) {
        let mut sum = R::lit(1e-6);
        for part in &self.parts {
            sum = sum + part.albedo_estimate(wo);
        }
        let floor = sum * R::lit(0.02);
        (floor, sum + floor * R::lit(self.parts.len() as f64))
    }
}

impl<R: Real, const N: usize, P: Brdf<R, N>> Brdf<R, N> for Sum<R, N, P> {
    #[inline]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let mut f = grey(R::zero());
        for part in &self.parts {
            f = add(f, part.eval(wi, wo));
        }
        f
    }

    #[inline]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let (floor, total) = self.choices(wo);
        let mut sum = R::zero();
        for (k, part) in self.parts.iter().enumerate() {
            sum = sum + self.choice(k, wo, floor) * part.pdf(wi, wo);
        }
        sum / total
    }

    #[inline]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let (floor, total) = self.choices(wo);
        let (mut f, mut sum) = (grey(R::zero()), R::zero());
        for (k, part) in self.parts.iter().enumerate() {
            let (part_f, pdf) = part.eval_and_pdf(wi, wo);
            f = add(f, part_f);
            sum = sum + self.choice(k, wo, floor) * pdf;
        }
        (f, sum / total)
    }

    #[inline]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let (floor, total) = self.choices(wo);
        let x = u[2] * total;
        let (mut before, mut drawn, mut chosen) = (R::zero(), Sample::none(), R::one());
        for (k, part) in self.parts.iter().enumerate() {
            let weight = self.choice(k, wo, floor);
            // The last of those that start at or below x wins.
            let here = before.le(x);
            if R::maybe_any(here) {
                let rest = ((x - before) / weight).clamp(R::zero(), R::lit(0.999_999_9));
                drawn = Sample::select(here, part.sample(wo, [u[0], u[1], rest]), drawn);
                chosen = R::select(here, weight / total, chosen);
            }
            before = before + weight;
        }
        let delta = Sample {
            weight: scale(drawn.weight, chosen.recip()),
            pdf: drawn.pdf * chosen,
            ..drawn
        };
        let (wi, valid) = (drawn.wi, drawn.pdf.gt(R::zero()));
        let (whole, density) = self.eval_cos_and_pdf(wi, wo);
        let whole = only_where(valid, whole);
        let density = R::select(valid, density, R::zero());
        Sample::select(drawn.delta, delta, Sample::continuous(wi, whole, density))
    }

    #[inline]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        let mut sum = R::zero();
        for part in &self.parts {
            sum = sum + part.albedo_estimate(wo);
        }
        sum
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
