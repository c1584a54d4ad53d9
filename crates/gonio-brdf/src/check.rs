//! [`check`], a model held to what it declares.

use crate::{Brdf, BrdfError, Model, ModelSpec};
use gonio_num::Vec3;
use gonio_verify::{Checker, Effort, Expectation, Report, Subject, SubjectSample};

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
    let eval = |wi: Vec3<f64>, wo: Vec3<f64>| model.eval(wi, wo);
    let pdf = |wi: Vec3<f64>, wo: Vec3<f64>| model.pdf(wi, wo);
    let sample = |wo: Vec3<f64>, u: [f64; 3]| {
        let s = model.sample(wo, u);
        (s.pdf > 0.0).then_some(SubjectSample {
            wi: s.wi,
            weight: s.weight,
            pdf: s.pdf,
            delta: s.delta,
        })
    };
    let name = spec.to_string();
    let mut subject = Subject::new(name.clone(), &eval)
        .with_pdf(&pdf)
        .with_sample(&sample);
    if let Some(ior) = declares.relative_ior {
        subject = subject.transmitting(ior);
    }
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
    let components: Vec<&gonio_verify::EvalFn> =
        evals.iter().map(|e| e as &gonio_verify::EvalFn).collect();
    Ok(Checker::new(&subject, &expectation, effort)
        .components(&components)
        .run(name))
}
