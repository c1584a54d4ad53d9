//! [`check`], a model held to what it declares.

use crate::model::shader::Raw;
use crate::{Brdf, BrdfError, Model, ModelSpec, Sample};
use gonio_num::Vec3;
use gonio_verify::{
    Checker, Effort, EvalFn, Expectation, Progress, Property, Reflection, Report, Settings,
    Subject, SubjectFailed, SubjectSample,
};

/// Builds the model and checks every property of [`gonio_verify`] against its declarations: in double precision, and in single
/// precision against that.
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
    check_with(spec, &CheckOptions::new(effort))
}

/// How [`check_with`] looks.
#[derive(Clone)]
pub struct CheckOptions<'a> {
    /// How hard, as the report says.
    pub effort: Effort,
    /// Counts and bounds.
    pub settings: Settings,
    /// Properties that may be violated.
    pub allow: Vec<Property>,
    /// Is told of each step.
    pub progress: Option<&'a Progress<'a>>,
}

impl CheckOptions<'_> {
    /// The usual ones for `effort`.
    pub fn new(effort: Effort) -> Self {
        Self {
            effort,
            settings: Settings::new(effort),
            allow: Vec::new(),
            progress: None,
        }
    }
}

/// [`check`] with all its choices.
///
/// # Errors
/// If the model cannot be built.
pub fn check_with(spec: &ModelSpec, options: &CheckOptions) -> Result<Report, BrdfError> {
    let model: Model<f64, 3> = spec.build()?;
    let narrow: Model<f32, 3> = spec.build()?;
    let declares = spec.declares()?;
    let name = spec.to_string();
    let double = Double {
        model: &model,
        relative_ior: declares.relative_ior,
    };
    let single = Single(&narrow);
    // A shader is looked at as it is, without what protects a rendering from it.
    let raw = match (&model, &narrow) {
        (Model::Shader(double), Model::Shader(single)) => Some((Raw(double), Raw(single))),
        _ => None,
    };
    let (double, single): (&dyn Reflection, &dyn Reflection) = match &raw {
        Some((double, single)) => (double, single),
        None => (&double, &single),
    };
    let subject = Subject::batched(name.clone(), double).with_single(single);
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
    let mut checker = Checker::new(&subject, &expectation, options.effort)
        .settings(options.settings)
        .allow(&options.allow)
        .components(&components);
    if let Some(progress) = options.progress {
        checker = checker.progress(progress);
    }
    Ok(checker.run(name)?)
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
            *sample = (s.pdf != 0.0).then_some(SubjectSample {
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

/// A model in single precision. Its batches on lanes have the same bits.
struct Single<'a>(&'a Model<f32, 3>);

impl Reflection for Single<'_> {
    fn eval(
        &self,
        wi: &[Vec3<f64>],
        wo: &[Vec3<f64>],
        f: &mut [[f64; 3]],
    ) -> Result<(), SubjectFailed> {
        for ((wi, wo), f) in wi.iter().zip(wo).zip(f) {
            *f = self.0.eval(wi.to_f32(), wo.to_f32()).map(f64::from);
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
            *pdf = f64::from(self.0.pdf(wi.to_f32(), wo.to_f32()));
        }
        Ok(())
    }

    fn sample(
        &self,
        wo: &[Vec3<f64>],
        u: &[[f64; 3]],
        samples: &mut [Option<SubjectSample>],
    ) -> Result<(), SubjectFailed> {
        // A number just below 1 must not be rounded to 1.
        const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;
        for ((wo, u), sample) in wo.iter().zip(u).zip(samples) {
            let u = u.map(|u| (u as f32).min(BELOW_ONE));
            let s: Sample<f32, 3> = self.0.sample(wo.to_f32(), u);
            *sample = (s.pdf != 0.0).then(|| SubjectSample {
                wi: s.wi.to_f64(),
                weight: s.weight.map(f64::from),
                pdf: f64::from(s.pdf),
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
}
