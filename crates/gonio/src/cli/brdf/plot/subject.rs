//! What is plotted: a model or a measured file.

use crate::cli::destination;
use crate::cli::failure::Failure;
use crate::cli::terminal::warn;
use gonio_brdf::measured::format::FORMATS;
use gonio_brdf::{Brdf, Model, ModelSpec};
use gonio_plot::{Draw, Function};
use std::path::Path;

/// A function by its description.
pub(super) struct Subject {
    pub name: String,
    pub spec: ModelSpec,
    model: Model<f64, 3>,
    relative_ior: Option<[f64; 3]>,
}

impl Subject {
    /// The measured file `text`, if there is one of that name, or else the model that it describes.
    ///
    /// # Errors
    /// If there is neither, or the file can't be read.
    pub fn open(text: &str) -> Result<Self, Failure> {
        let path = Path::new(text);
        let extension = destination::extension(path);
        let measured = FORMATS.iter().any(|f| f.extension == extension);
        let file = path.exists() || (measured && !text.contains(['(', '=']));
        let spec = if file {
            ModelSpec::from_pairs("table", [("file", text)])?
        } else {
            ModelSpec::parse(text)?
        };
        let model: Model<f64, 3> = spec.build()?;
        for line in model.warnings() {
            warn(&line);
        }
        let name = match path.file_name() {
            Some(name) if file => name.to_string_lossy().into_owned(),
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
