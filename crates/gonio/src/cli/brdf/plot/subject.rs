//! What is plotted: a model or a measured file.

use crate::cli::destination;
use crate::cli::failure::Failure;
use crate::cli::terminal::warn;
use gonio_brdf::measured::format::FORMATS;
use gonio_brdf::{Brdf, BrdfError, Model, ModelSpec};
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
        let (spec, file) = match ModelSpec::parse(text) {
            // A name that no model has.
            Err(BrdfError::UnknownModel { .. } | BrdfError::UnknownPreset { .. })
                if path.exists() || is_measured(path) =>
            {
                (ModelSpec::from_pairs("table", [("file", text)])?, true)
            }
            described => (described?, path.exists()),
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

/// Whether the extension is that of a format of measurements.
fn is_measured(path: &Path) -> bool {
    let extension = destination::extension(path);
    FORMATS.iter().any(|f| f.extension == extension)
}
