//! A process as a subject of checks.

use crate::error::ExecError;
use crate::process::Process;
use gonio_num::Vec3;
use gonio_verify::{Reflection, SubjectFailed, SubjectSample};
use std::sync::{Mutex, PoisonError};

/// A [`Process`] as a [`Reflection`] of [`gonio_verify`].
#[derive(Debug)]
pub struct Remote {
    state: Mutex<State>,
    has_pdf: bool,
    has_sample: bool,
    relative_ior: Option<[f64; 3]>,
}

#[derive(Debug)]
struct State {
    process: Process,
    /// The first error. The conversation is over then.
    error: Option<ExecError>,
}

impl Remote {
    /// Offers what the process says that it offers.
    pub fn new(process: Process) -> Self {
        let hello = process.hello();
        Self {
            has_pdf: hello.pdf,
            has_sample: hello.sample,
            relative_ior: hello.relative_ior,
            state: Mutex::new(State {
                process,
                error: None,
            }),
        }
    }

    /// Ends the conversation.
    ///
    /// # Errors
    /// The first error of the conversation, or what [`Process::finish`] finds.
    pub fn finish(self) -> Result<(), ExecError> {
        let state = self
            .state
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner);
        match state.error {
            Some(error) => Err(error),
            None => state.process.finish(),
        }
    }

    fn with(
        &self,
        ask: impl FnOnce(&mut Process) -> Result<(), ExecError>,
    ) -> Result<(), SubjectFailed> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(error) = &state.error {
            return Err(SubjectFailed::new(error.to_string()));
        }
        ask(&mut state.process).map_err(|error| {
            let failed = SubjectFailed::new(error.to_string());
            state.error = Some(error);
            failed
        })
    }
}

impl Reflection for Remote {
    fn eval(
        &self,
        wi: &[Vec3<f64>],
        wo: &[Vec3<f64>],
        f: &mut [[f64; 3]],
    ) -> Result<(), SubjectFailed> {
        self.with(|process| process.eval(wi, wo, f))
    }

    fn pdf(
        &self,
        wi: &[Vec3<f64>],
        wo: &[Vec3<f64>],
        pdf: &mut [f64],
    ) -> Result<(), SubjectFailed> {
        self.with(|process| process.pdf(wi, wo, pdf))
    }

    fn sample(
        &self,
        wo: &[Vec3<f64>],
        u: &[[f64; 3]],
        samples: &mut [Option<SubjectSample>],
    ) -> Result<(), SubjectFailed> {
        self.with(|process| process.sample(wo, u, samples))
    }

    fn has_pdf(&self) -> bool {
        self.has_pdf
    }

    fn has_sample(&self) -> bool {
        self.has_sample
    }

    fn relative_ior(&self) -> Option<[f64; 3]> {
        self.relative_ior
    }
}
