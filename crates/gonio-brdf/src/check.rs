//! [`check`], a model held to what it declares.

use crate::{Brdf, BrdfError, Model, ModelSpec, Sample};
use gonio_num::Vec3;
use gonio_verify::{
    Checker, Effort, EvalFn, Expectation, Reflection, Report, Subject, SubjectFailed, SubjectSample,
};

/// Builds the model in double precision and checks every property of [`gonio_verify`] against its declarations.
///
/// A property that the model declares to lack does not fail: the report prints what its lack costs. For a sum, linearity
/// is checked against its parts. The report is the same at each call.
///
/// ```
/// use gonio_brdf::{ModelSpec, check};
/// let report = check(&ModelSpec::parse("oren-nayar:sigma_deg=15")?, gonio_verify::Effort::Quick)?;
/// assert!(report.passed(), "{report}");
/// # Ok::<(), gonio_brdf::BrdfError>(())
/// ```
///
/// # Errors
/// If the model cannot be built.
pub fn check(spec: &ModelSpec, effort: Effort) -> Result<Report, BrdfError> {
    let model: Model<f64, 3> = spec.build()?;
    let declares = spec.declares()?;
    let name = spec.to_string();
    let reflection = Double {
        model: &model,
        relative_ior: declares.relative_ior,
    };
    let subject = Subject::batched(name.clone(), &reflection);
    let expectation = Expectation {
        reciprocal: declares.reciprocal,
        energy_conserving: declares.energy_conserving,
        isotropic: declares.isotropic,
    };
    let parts: &[Model<f64, 3>] = match &model {
        Model::Sum(sum) => &sum.parts,
        _ => &[],
    };
    let evals: Vec<_> = parts
        .iter()
        .map(|part| move |wi: Vec3<f64>, wo: Vec3<f64>| part.eval(wi, wo))
        .collect();
    let components: Vec<&EvalFn> = evals.iter().map(|e| e as &EvalFn).collect();
    Ok(Checker::new(&subject, &expectation, effort)
        .components(&components)
        .run(name)?)
}

/// A model in double precision, asked in batches.
struct Double<'a> {
    model: &'a Model<f64, 3>,
    relative_ior: Option<[f64; 3]>,
}

impl Reflection for Double<'_> {
    fn eval(
        &self,
        wi: &[Vec3<f64>],
        wo: &[Vec3<f64>],
        f: &mut [[f64; 3]],
    ) -> Result<(), SubjectFailed> {
        for ((wi, wo), f) in wi.iter().zip(wo).zip(f) {
            *f = self.model.eval(*wi, *wo);
        }
        Ok(())
    }

    fn pdf(
        &self,
        wi: &[Vec3<f64>],
        wo: &[Vec3<f64>],
        pdf: &mut [f64],
    ) -> Result<(), SubjectFailed> {
        for ((wi, wo), pdf) in wi.iter().zip(wo).zip(pdf) {
            *pdf = self.model.pdf(*wi, *wo);
        }
        Ok(())
    }

    fn sample(
        &self,
        wo: &[Vec3<f64>],
        u: &[[f64; 3]],
        samples: &mut [Option<SubjectSample>],
    ) -> Result<(), SubjectFailed> {
        for ((wo, u), sample) in wo.iter().zip(u).zip(samples) {
            let s: Sample<f64, 3> = self.model.sample(*wo, *u);
            *sample = (s.pdf > 0.0).then_some(SubjectSample {
                wi: s.wi,
                weight: s.weight,
                pdf: s.pdf,
                delta: s.delta,
            });
        }
        Ok(())
    }

    fn has_pdf(&self) -> bool {
        true
    }

    fn has_sample(&self) -> bool {
        true
    }

    fn relative_ior(&self) -> Option<[f64; 3]> {
        self.relative_ior
    }
}
