//! A model times a colour.

use super::Composite;
use crate::part::colour::{cast, mean, mul};
use crate::{
    Brdf, BrdfError, Declares, Kind, Model, ModelInfo, ModelSpec, Number, ParameterInfo, Sample,
};
use gonio_num::{Real, Vec3};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "scaled",
    summary: "a model times a colour, as in scaled(0.5, ggx:roughness=0.2)",
    paper: "Nicodemus et al. 1977, \"Geometrical Considerations and Nomenclature for Reflectance\": linearity",
    parameters: &[
        ParameterInfo::colour(
            "factor",
            (0.0, 1000.0),
            Some([1.0; 3]),
            "what to multiply by",
        ),
        ParameterInfo {
            name: "of",
            kind: Kind::Models,
            meaning: "the model, one",
        },
    ],
    positional: Some("factor"),
    aliases: &[],
    recordable: true,
    declares: |spec| {
        let of = spec.models("of").first().map(ModelSpec::declares);
        let Some(Ok(d)) = of else {
            return Declares::physical(f64::INFINITY);
        };
        // 0 times an unbounded albedo is 0, not NaN.
        let factor = spec.largest("factor");
        let bound = if factor == 0.0 {
            0.0
        } else {
            factor * d.albedo_bound
        };
        Declares {
            albedo_bound: bound,
            energy_conserving: bound <= 1.0,
            ..d
        }
    },
};

/// f = c·f₁.
#[derive(Debug, Clone)]
pub struct Scaled<R: Real, const N: usize, P = Model<R, N>> {
    /// c ≥ 0.
    pub factor: [R; N],
    /// The model f₁.
    pub of: Box<P>,
}

impl<R: Number, const N: usize> Scaled<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        match spec.models("of") {
            [of] => Ok(Self {
                factor: spec.colour("factor")?,
                of: Box::new(of.build()?),
            }),
            _ => Err(spec.wrong("of", "exactly one model: scaled(factor, model)")),
        }
    }

    pub(crate) fn set(&mut self, _parameter: &str, value: [R; 3]) {
        self.factor = super::components(value);
    }
}

impl<R: Real, const N: usize> Composite<R, N> for Scaled<R, N> {
    type With<S: Number, P: Brdf<S, N>> = Scaled<S, N, P>;

    fn with<'a, S: Number, P: Brdf<S, N>>(
        &'a self,
        number: &impl Fn(R) -> S,
        part: &impl Fn(&'a Model<R, N>) -> P,
    ) -> Scaled<S, N, P>
    where
        R: 'a,
    {
        Scaled {
            factor: cast(self.factor, number),
            of: Box::new(part(&self.of)),
        }
    }
}

impl<R: Real, const N: usize, P: Brdf<R, N>> Brdf<R, N> for Scaled<R, N, P> {
    #[inline]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        mul(self.factor, self.of.eval(wi, wo))
    }

    #[inline]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        self.of.pdf(wi, wo)
    }

    #[inline]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let (f, pdf) = self.of.eval_and_pdf(wi, wo);
        (mul(self.factor, f), pdf)
    }

    #[inline]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let s = self.of.sample(wo, u);
        Sample {
            weight: mul(self.factor, s.weight),
            ..s
        }
    }

    #[inline]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        self.of.albedo_estimate(wo) * mean(self.factor)
    }

    fn transmits(&self) -> bool {
        self.of.transmits()
    }

    fn relative_ior(&self) -> [R; N] {
        self.of.relative_ior()
    }

    fn absorption(&self) -> [R; N] {
        self.of.absorption()
    }
}
