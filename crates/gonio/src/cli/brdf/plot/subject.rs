//! What is plotted: a model or a measured file.

use crate::cli::failure::Failure;
use crate::cli::terminal::warn;
use gonio_brdf::{Brdf, Model, ModelSpec};
use gonio_plot::{Draw, Function};
use std::path::Path;

/// A function by its description.
pub(super) struct Subject {
    pub name: String,
    pub spec: ModelSpec,
    pub model: Model<f64, 3>,
    relative_ior: Option<[f64; 3]>,
}

impl Subject {
    /// The model that `text` describes, or else the measured file of that name.
    ///
    /// # Errors
    /// If there is neither, or the file can't be read.
    pub fn open(text: &str) -> Result<Self, Failure> {
        let path = Path::new(text);
        let spec = ModelSpec::open(text)?;
        let model: Model<f64, 3> = spec.build()?;
        for line in model.warnings() {
            warn(&line);
        }
        let name = match path.file_name() {
            Some(name) if path.exists() => name.to_string_lossy().into_owned(),
            _ => text.trim().into(),
        };
        Ok(Self {
            name,
            model,
            relative_ior: spec.declares()?.relative_ior,
            spec,
        })
    }

    /// It as what is plotted.
    pub fn function(&self) -> Function<'_> {
        let model = &self.model;
        let function =
            Function::new(&self.name, |wi, wo| model.eval(wi, wo)).with_discrete(|wo, u| {
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
}
