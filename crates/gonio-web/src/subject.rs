//! [`Subject`], a reflection function by its description, and those that were built last.

use crate::answer::Answer;
use crate::complaint::Complaint;
use crate::{light, picture};
use gonio_brdf::{Brdf, Model, ModelSpec};
use gonio_num::Vec3;
use gonio_plot::{Draw, Function};
use gonio_radiometry::direction::spherical_direction;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::sync::{Arc, Mutex, PoisonError};

/// θ from the normal and φ around it, degrees.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Angles {
    pub theta: f64,
    pub phi: f64,
}

impl Angles {
    /// The unit vector.
    pub fn direction(self) -> Vec3<f64> {
        spherical_direction(self.theta.to_radians(), self.phi.to_radians())
    }
}

/// A function, built.
pub(crate) struct Subject {
    pub text: String,
    pub spec: ModelSpec,
    pub model: Model<f64, 3>,
    relative_ior: Option<[f64; 3]>,
}

/// Functions that are kept: as many as a page shows at once, with one to spare for each.
const KEPT: usize = 16;

/// The last ones, the newest at the end: a slider asks for the same function for several views.
static LAST: Mutex<Vec<Arc<Subject>>> = Mutex::new(Vec::new());

impl Subject {
    /// The function that `text` describes, or the table of the measured file of that name.
    pub fn open(text: &str) -> Result<Arc<Self>, Complaint> {
        let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(at) = last.iter().position(|s| s.text == text) {
            let known = last.remove(at);
            last.push(known.clone());
            return Ok(known);
        }
        let spec = ModelSpec::open(text)?;
        let subject = Arc::new(Self {
            text: text.into(),
            model: spec.build()?,
            relative_ior: spec.declares()?.relative_ior,
            spec,
        });
        if last.len() == KEPT {
            last.remove(0);
        }
        last.push(subject.clone());
        Ok(subject)
    }

    /// It as what is plotted.
    pub fn function(&self) -> Function<'_> {
        let model = &self.model;
        let function =
            Function::new(&self.text, |wi, wo| model.eval(wi, wo)).with_discrete(|wo, u| {
                let s = model.sample(wo, u);
                (s.pdf > 0.0 && s.delta).then_some(Draw {
                    wi: s.wi,
                    weight: s.weight,
                    probability: s.pdf,
                })
            });
        match self.relative_ior {
            Some(ior) => function.transmitting(ior),
            None => function,
        }
    }

    /// An error if a shader stopped ending: what was computed is then no answer.
    pub fn sound(&self) -> Result<(), Complaint> {
        match self.model.failure() {
            Some(error) => Err(error.into()),
            None => Ok(()),
        }
    }
}

/// Forgets what was built: files that it was read from have changed.
pub(crate) fn forget() -> Answer {
    LAST.lock().unwrap_or_else(PoisonError::into_inner).clear();
    light::forget();
    picture::forget();
    Answer::new(json!({}), Vec::new())
}
