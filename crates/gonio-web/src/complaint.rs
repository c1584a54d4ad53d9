//! [`Complaint`], why a request can't be answered.

use gonio_brdf::BrdfError;
use gonio_env::EnvError;
use gonio_plot::PlotError;
use gonio_render::RenderError;
use gonio_scene::SceneError;
use serde::Serialize;

/// The library's error in words, how to go on, and where in a shader it is.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Complaint {
    message: String,
    help: Option<String>,
    place: Option<Place>,
}

/// Line and column, from 1.
#[derive(Debug, Clone, Serialize)]
struct Place {
    line: usize,
    column: usize,
}

impl Complaint {
    pub fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            help: None,
            place: None,
        }
    }

    pub fn with_help(self, help: impl Into<String>) -> Self {
        Self {
            help: Some(help.into()),
            ..self
        }
    }
}

impl From<BrdfError> for Complaint {
    fn from(error: BrdfError) -> Self {
        let place = match &error {
            BrdfError::Shader(shader) => shader.place.as_ref().map(|p| Place {
                line: p.line,
                column: p.column,
            }),
            _ => None,
        };
        Self {
            message: error.to_string(),
            help: error.help(),
            place,
        }
    }
}

impl From<EnvError> for Complaint {
    fn from(error: EnvError) -> Self {
        Self {
            help: error.help(),
            ..Self::new(error.to_string())
        }
    }
}

impl From<PlotError> for Complaint {
    fn from(error: PlotError) -> Self {
        Self::new(error.to_string())
    }
}

impl From<RenderError> for Complaint {
    fn from(error: RenderError) -> Self {
        Self::new(error.to_string())
    }
}

impl From<SceneError> for Complaint {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Brdf(error) => error.into(),
            other => Self {
                help: other.help(),
                ..Self::new(other.to_string())
            },
        }
    }
}
