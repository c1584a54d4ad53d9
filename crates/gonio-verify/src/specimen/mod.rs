//! The instrument's own calibration: reflection functions that are right, which must pass, and functions with one known fault
//! each, which the right property must catch.
//!
//! The faults are those that renderers have had: their issue trackers tell of each class.

mod broken;
mod broken_sampling;
mod calibration;
mod fault;
mod right;

pub use calibration::{Calibration, calibrate, short};
pub use fault::{Broken, Caught};
pub use right::{
    Bands, Coated, CosineDrawn, Frosted, Ggx, Lambertian, Mirror, Phong, Varnished, above,
    consistent,
};

use crate::{
    Checker, Effort, EvalFn, Expectation, Property, Reflection, Report, Settings, Subject,
    SubjectFailed, SubjectSample,
};
use gonio_num::Vec3;

/// A reflection function for one pair of directions, with all three operations.
pub trait Pointwise: Send + Sync {
    /// f(wi, wo) in sr⁻¹, without the cosine.
    fn eval(&self, wi: Vec3<f64>, wo: Vec3<f64>) -> [f64; 3];
    /// The density per solid angle of sampling wi given wo.
    fn pdf(&self, wi: Vec3<f64>, wo: Vec3<f64>) -> f64;
    /// Draws wi given wo.
    fn sample(&self, wo: Vec3<f64>, u: [f64; 3]) -> Option<SubjectSample>;
}

impl<T: Pointwise + ?Sized> Pointwise for Box<T> {
    fn eval(&self, wi: Vec3<f64>, wo: Vec3<f64>) -> [f64; 3] {
        (**self).eval(wi, wo)
    }
    fn pdf(&self, wi: Vec3<f64>, wo: Vec3<f64>) -> f64 {
        (**self).pdf(wi, wo)
    }
    fn sample(&self, wo: Vec3<f64>, u: [f64; 3]) -> Option<SubjectSample> {
        (**self).sample(wo, u)
    }
}

/// What is asked one pair at a time, in batches.
pub struct Each<'a>(pub &'a dyn Pointwise);

impl Reflection for Each<'_> {
    fn eval(
        &self,
        wi: &[Vec3<f64>],
        wo: &[Vec3<f64>],
        f: &mut [[f64; 3]],
    ) -> Result<(), SubjectFailed> {
        for ((wi, wo), f) in wi.iter().zip(wo).zip(f) {
            *f = self.0.eval(*wi, *wo);
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
            *pdf = self.0.pdf(*wi, *wo);
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
            *sample = self.0.sample(*wo, *u);
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

/// A reflection function of known quality.
pub struct Specimen {
    /// Its name, for a fault what is wrong.
    pub name: &'static str,
    /// The property that must catch it; `None` for what is right.
    pub fault: Option<Property>,
    /// What it declares.
    pub expect: Expectation,
    /// The function.
    pub reflection: Box<dyn Pointwise>,
    /// The same in single precision.
    pub single: Option<Box<dyn Pointwise>>,
    /// See [`Subject::transmitting`].
    pub relative_ior: Option<[f64; 3]>,
    /// What its sum should be of.
    pub components: Vec<Box<dyn Pointwise>>,
    /// See [`Settings::loss_bound`].
    pub loss_bound: Option<f64>,
}

impl Specimen {
    /// One that is right in all.
    pub fn right(name: &'static str, reflection: impl Pointwise + 'static) -> Self {
        Self {
            name,
            fault: None,
            expect: Expectation::PHYSICAL,
            reflection: Box::new(reflection),
            single: None,
            relative_ior: None,
            components: Vec::new(),
            loss_bound: None,
        }
    }

    /// One with a fault of `property`.
    pub fn broken(
        name: &'static str,
        property: Property,
        reflection: impl Pointwise + 'static,
    ) -> Self {
        Self {
            fault: Some(property),
            ..Self::right(name, reflection)
        }
    }

    /// Checks it.
    ///
    /// # Errors
    /// Never: it always answers.
    pub fn check(&self, settings: Settings, seed_name: &str) -> Result<Report, SubjectFailed> {
        let each = Each(self.reflection.as_ref());
        let mut subject = Subject::batched(self.name, &each);
        let single = self.single.as_deref().map(Each);
        if let Some(single) = &single {
            subject = subject.with_single(single);
        }
        if let Some(ior) = self.relative_ior {
            subject = subject.transmitting(ior);
        }
        let evals: Vec<_> = self
            .components
            .iter()
            .map(|part| move |wi: Vec3<f64>, wo: Vec3<f64>| part.eval(wi, wo))
            .collect();
        let components: Vec<&EvalFn> = evals.iter().map(|e| e as &EvalFn).collect();
        let settings = Settings {
            loss_bound: self.loss_bound,
            ..settings
        };
        Checker::new(&subject, &self.expect, Effort::Quick)
            .settings(settings)
            .components(&components)
            .run(seed_name)
    }

    /// Checks it with quick effort.
    ///
    /// # Errors
    /// Never: it always answers.
    pub fn quick(&self) -> Result<Report, SubjectFailed> {
        self.check(Settings::new(Effort::Quick), self.name)
    }
}

/// Functions that are right, and hard in some way: sharp, grazing, brushed, with edges, with rare large weights, on both sides of a
/// boundary.
pub fn right() -> Vec<Specimen> {
    let ggx = |alpha: f64| Ggx { alpha: [alpha; 2] };
    let one_way = Expectation {
        reciprocal: false,
        ..Expectation::PHYSICAL
    };
    let brushed = Expectation {
        isotropic: false,
        ..Expectation::PHYSICAL
    };
    let boundary = |name, ior| Specimen {
        relative_ior: Some(ior),
        ..Specimen::right(name, Frosted { ior, scaled: true })
    };
    let varnished = Varnished(ggx(0.3));
    vec![
        Specimen::right("white diffuse", Lambertian(1.0)),
        Specimen::right("black", Lambertian(0.0)),
        Specimen::right("Phong, exponent 1", Phong(1.0)),
        Specimen::right("Phong, exponent 30", Phong(30.0)),
        Specimen::right("Phong, exponent 3000", Phong(3000.0)),
        Specimen::right("GGX, α = 1", ggx(1.0)),
        Specimen::right("GGX, α = 0.1", ggx(0.1)),
        Specimen::right("GGX, α = 0.002", ggx(0.002)),
        Specimen::right("GGX, α = 1e-5", ggx(1e-5)),
        Specimen {
            expect: brushed,
            ..Specimen::right("GGX, brushed", Ggx { alpha: [0.4, 0.05] })
        },
        Specimen::right("half a mirror, half GGX", varnished),
        Specimen::right("a mirror", Mirror(1.0)),
        Specimen::right("GGX, α = 0.01, drawn by the cosine", CosineDrawn(ggx(0.01))),
        Specimen::right(
            "a sharp lobe drawn once in a thousand",
            Coated(0.001, ggx(0.003)),
        ),
        Specimen {
            expect: one_way,
            ..Specimen::right("bands with edges", Bands)
        },
        boundary("a frosted boundary", [1.5; 3]),
        boundary("a frosted boundary, dispersive", [0.7, 0.75, 0.8]),
    ]
}

/// Functions with one fault each.
pub fn broken() -> Vec<Specimen> {
    let mut all = broken::values();
    all.extend(broken_sampling::all());
    all
}
