//! [`Source`], what is converted: a file or a model.

use super::super::format::FORMATS;
use super::super::measurement::{Measurement, Side};
use super::super::prepared::{LoadOptions, Measured, Select};
use crate::{Brdf, BrdfError, Declares, Model, ModelSpec};
use gonio_num::Vec3;
use std::path::Path;

/// What is converted.
#[derive(Debug, Clone)]
pub struct Source {
    name: String,
    of: Of,
}

#[derive(Debug, Clone)]
enum Of {
    Measured(Box<Measured>),
    Model(Box<Model<f64, 3>>, Declares),
}

impl Source {
    /// The file `text`, if there is one of that name, or else the model that it describes.
    ///
    /// # Errors
    /// If the file can't be read, or there is no file and no such model, or the model reflects into single directions only.
    pub fn open(text: &str) -> Result<Self, BrdfError> {
        let path = Path::new(text);
        if path.exists() || looks_like_a_path(text) {
            let options = LoadOptions {
                select: Select::All,
                ..LoadOptions::default()
            };
            let measured = super::super::load(path, options)?;
            return Ok(Self {
                name: text.into(),
                of: Of::Measured(Box::new(measured)),
            });
        }
        let spec = ModelSpec::parse(text)?;
        let declares = spec.declares()?;
        let model: Model<f64, 3> = spec.build()?;
        if model.is_delta() {
            return Err(BrdfError::Unsupported {
                what: format!("`{spec}` reflects into single directions only: a table would be 0"),
            });
        }
        Ok(Self {
            name: spec.to_string(),
            of: Of::Model(Box::new(model), declares),
        })
    }

    /// The file or the description.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the file holds, if it is one.
    pub fn measured(&self) -> Option<&Measured> {
        match &self.of {
            Of::Measured(m) => Some(m),
            Of::Model(..) => None,
        }
    }

    /// The measurement of the file, if it is one.
    pub fn measurement(&self) -> Option<&Measurement> {
        self.measured().map(Measured::measurement)
    }

    /// The sides that it has.
    pub fn sides(&self) -> Vec<Side> {
        match &self.of {
            Of::Measured(m) => m.sides(),
            Of::Model(_, d) if d.relative_ior.is_some() => Side::ALL.to_vec(),
            Of::Model(..) => vec![Side::ReflectionFront],
        }
    }

    /// Whether it depends on the difference of azimuths only, by its layout or its declaration.
    pub fn is_isotropic(&self) -> bool {
        match &self.of {
            Of::Measured(m) => m.is_isotropic(),
            Of::Model(_, d) => d.isotropic,
        }
    }

    /// Linear RGB in sr⁻¹ at directions whose signs say the side.
    pub fn rgb(&self, wi: Vec3<f64>, wo: Vec3<f64>) -> [f64; 3] {
        match &self.of {
            Of::Measured(m) => m.eval(wi, wo),
            Of::Model(m, _) => m.eval(wi, wo),
        }
    }
}

/// Whether a text that names no file was meant to: a model's name has no slash in it, nor the extension of a format.
fn looks_like_a_path(text: &str) -> bool {
    let name = text.split([':', '(']).next().unwrap_or_default();
    let extension = Path::new(text).extension().and_then(|e| e.to_str());
    name.contains('/') || FORMATS.iter().any(|f| extension == Some(f.extension))
}
