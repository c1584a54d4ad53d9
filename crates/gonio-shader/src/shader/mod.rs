//! [`Shader`], a reflection function written as a shader.

mod signature;

use crate::number::ShaderNumber;
use crate::{Language, Parameter, Program, ShaderError, ShaderModule};
use gonio_num::{Mask, Real, Vec3};
use signature::{find_eval, find_pdf, names, sample_layout};
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// How a shader is to be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Settings {
    /// The name of the function to evaluate. `None`: `eval`, or the only one that ends in `_eval`; `BRDF` in a `.brdf` file.
    pub entry: Option<String>,
    /// How many operations the loops of one evaluation may make.
    pub steps: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            entry: None,
            steps: 10_000_000,
        }
    }
}

/// A direction drawn by a shader.
#[derive(Debug, Clone, Copy)]
pub struct Drawn<R: Real> {
    /// Direction to the light.
    pub wi: Vec3<R>,
    /// f·|cosθi| / pdf.
    pub weight: [R; 3],
    /// Density per solid angle in sr⁻¹, or the probability of a discrete direction.
    pub pdf: R,
    /// Whether `wi` is a discrete direction.
    pub delta: R::Mask,
}

/// A reflection function written as a shader.
///
/// It is raw: what the shader gives is what is returned, below the horizon, negative or NaN. After an evaluation that did not end
/// within its steps everything is NaN, at once, and [`Shader::failure`] says why.
///
/// A clone shares what was compiled, not the failure.
#[derive(Debug)]
pub struct Shader {
    parts: Arc<Parts>,
    failure: OnceLock<ShaderError>,
}

/// What was compiled.
#[derive(Debug)]
struct Parts {
    module: ShaderModule,
    eval: Program,
    pdf: Option<Program>,
    sample: Option<(Program, SampleLayout)>,
}

impl Clone for Shader {
    fn clone(&self) -> Self {
        Self {
            parts: Arc::clone(&self.parts),
            failure: OnceLock::new(),
        }
    }
}

/// Which output of the sampling function is what.
#[derive(Debug, Clone, Copy)]
struct SampleLayout {
    wi: usize,
    weight: usize,
    /// Whether the weight is a colour.
    coloured: bool,
    pdf: usize,
    delta: Option<usize>,
}

impl Shader {
    /// Reads a file.
    ///
    /// # Errors
    /// If it can't be read, or as [`Shader::new`].
    pub fn load(path: &Path, settings: &Settings) -> Result<Self, ShaderError> {
        let text = read_text(path)?;
        Self::new(path, None, &text, settings)
    }

    /// Reads a text; `path` names it in errors, and its extension tells the language if that is `None`.
    ///
    /// # Errors
    /// What is wrong with it, and where: syntax, a missing function, a signature, what is not supported.
    pub fn new(
        path: &Path,
        language: Option<Language>,
        text: &str,
        settings: &Settings,
    ) -> Result<Self, ShaderError> {
        let module = ShaderModule::new(path, language, text)?;
        let names = names(&module, settings)?;
        let eval = find_eval(&module, &names.eval)?;
        let pdf = match module.named(&names.pdf).next() {
            Some(_) => Some(find_pdf(&module, &names.pdf)?),
            None => None,
        };
        let sample = match module.named(&names.sample).next() {
            Some(handle) => Some((handle, sample_layout(&module, handle)?)),
            None => None,
        };
        let compile = |handle| module.compile(handle, settings.steps);
        let eval = compile(eval)?;
        let pdf = pdf.map(compile).transpose()?;
        let sample = match sample {
            Some((handle, layout)) => Some((compile(handle)?, layout)),
            None => None,
        };
        Ok(Self {
            parts: Arc::new(Parts {
                module,
                eval,
                pdf,
                sample,
            }),
            failure: OnceLock::new(),
        })
    }

    /// The parameters that it declares.
    pub fn parameters(&self) -> &[Parameter] {
        self.parts.module.parameters()
    }

    /// Its file, or the name it was given.
    pub fn path(&self) -> &Path {
        &self.parts.module.source.path
    }

    /// Its language.
    pub fn language(&self) -> Language {
        self.parts.module.language()
    }

    /// What was left out of the file.
    pub fn warnings(&self) -> &[String] {
        self.parts.module.warnings()
    }

    /// Whether it has a density of its own.
    pub fn has_pdf(&self) -> bool {
        self.parts.pdf.is_some()
    }

    /// Whether it draws directions itself.
    pub fn has_sample(&self) -> bool {
        self.parts.sample.is_some()
    }

    /// The function that is evaluated.
    pub fn program(&self) -> &Program {
        &self.parts.eval
    }

    /// The first evaluation that did not end, if there was one.
    pub fn failure(&self) -> Option<&ShaderError> {
        self.failure.get()
    }

    /// The defaults of all components of all parameters, in order.
    pub fn defaults(&self) -> Vec<f64> {
        let all = self.parameters().iter();
        all.flat_map(|p| p.default[..p.components()].to_vec())
            .collect()
    }

    fn run<R: ShaderNumber>(
        &self,
        program: &Program,
        parameters: &[R],
        inputs: &[R],
        outputs: &mut [R],
    ) {
        if self.failure.get().is_some() {
            outputs.fill(R::lit(f64::NAN));
            return;
        }
        if let Err(error) = program.run(parameters, inputs, outputs) {
            self.failure.get_or_init(|| error);
        }
    }

    fn arguments<R: ShaderNumber>(wi: Vec3<R>, wo: Vec3<R>) -> [R; 15] {
        let (o, i) = (R::zero(), R::one());
        // What a .brdf file's function takes beyond the two: the normal and two tangents.
        [
            wi.x, wi.y, wi.z, wo.x, wo.y, wo.z, o, o, i, i, o, o, o, i, o,
        ]
    }

    /// f in sr⁻¹ without the cosine; a grey function gives the same three times. `parameters` has each component of each parameter.
    ///
    /// # Panics
    /// If there are more or fewer parameters than the shader has.
    pub fn eval<R: ShaderNumber>(&self, parameters: &[R], wi: Vec3<R>, wo: Vec3<R>) -> [R; 3] {
        let all = Self::arguments(wi, wo);
        let mut f = [R::zero(); 3];
        let n = self.parts.eval.outputs();
        self.run(
            &self.parts.eval,
            parameters,
            &all[..self.parts.eval.inputs()],
            &mut f[..n],
        );
        if n == 1 { [f[0]; 3] } else { f }
    }

    /// The density of its own in sr⁻¹; `None` if it has none.
    ///
    /// # Panics
    /// As [`Shader::eval`].
    pub fn pdf<R: ShaderNumber>(&self, parameters: &[R], wi: Vec3<R>, wo: Vec3<R>) -> Option<R> {
        let program = self.parts.pdf.as_ref()?;
        let mut pdf = [R::zero()];
        let all = Self::arguments(wi, wo);
        self.run(program, parameters, &all[..6], &mut pdf);
        Some(pdf[0])
    }

    /// A direction that it draws itself; `None` if it draws none.
    ///
    /// # Panics
    /// As [`Shader::eval`].
    pub fn sample<R: ShaderNumber>(
        &self,
        parameters: &[R],
        wo: Vec3<R>,
        u: [R; 3],
    ) -> Option<Drawn<R>> {
        let (program, layout) = self.parts.sample.as_ref()?;
        let mut s = [R::zero(); MOST_OUTPUTS];
        let inputs = [wo.x, wo.y, wo.z, u[0], u[1], u[2]];
        self.run(program, parameters, &inputs, &mut s[..program.outputs()]);
        Some(layout.drawn(&s))
    }

    /// [`Shader::eval`] for each pair of directions.
    ///
    /// # Errors
    /// If an evaluation does not end within its steps.
    ///
    /// # Panics
    /// If the slices differ in length, or as [`Shader::eval`].
    pub fn eval_many<R: ShaderNumber>(
        &self,
        parameters: &[R],
        wi: &[Vec3<R>],
        wo: &[Vec3<R>],
        f: &mut [[R; 3]],
    ) -> Result<(), ShaderError> {
        let program = &self.parts.eval;
        let values = pairs(program, parameters, wi, wo)?;
        let n = program.outputs();
        assert_eq!(f.len(), wi.len(), "as many results as directions");
        for (f, values) in f.iter_mut().zip(values.chunks(n)) {
            *f = [values[0], values[(n - 1).min(1)], values[n - 1]];
        }
        Ok(())
    }

    /// [`Shader::pdf`] for each pair of directions; 0 if it has none.
    ///
    /// # Errors
    /// As [`Shader::eval_many`].
    ///
    /// # Panics
    /// As [`Shader::eval_many`].
    pub fn pdf_many<R: ShaderNumber>(
        &self,
        parameters: &[R],
        wi: &[Vec3<R>],
        wo: &[Vec3<R>],
        pdf: &mut [R],
    ) -> Result<(), ShaderError> {
        match &self.parts.pdf {
            Some(program) => pdf.copy_from_slice(&pairs(program, parameters, wi, wo)?),
            None => pdf.fill(R::zero()),
        }
        Ok(())
    }

    /// [`Shader::sample`] for each direction; nothing if it draws none.
    ///
    /// # Errors
    /// As [`Shader::eval_many`].
    ///
    /// # Panics
    /// As [`Shader::eval_many`].
    pub fn sample_many<R: ShaderNumber>(
        &self,
        parameters: &[R],
        wo: &[Vec3<R>],
        u: &[[R; 3]],
    ) -> Result<Vec<Drawn<R>>, ShaderError> {
        let Some((program, layout)) = &self.parts.sample else {
            return Ok(Vec::new());
        };
        assert_eq!(wo.len(), u.len(), "as many numbers as directions");
        let inputs: Vec<R> = wo
            .iter()
            .zip(u)
            .flat_map(|(wo, u)| [wo.x, wo.y, wo.z, u[0], u[1], u[2]])
            .collect();
        let n = program.outputs();
        let mut values = vec![R::zero(); n * wo.len()];
        program.run_many(parameters, &inputs, &mut values)?;
        Ok(values.chunks(n).map(|s| layout.drawn(s)).collect())
    }
}

/// The text of a shader's file.
///
/// # Errors
/// If it can't be read, is too large, or is no text.
pub fn read_text(path: &Path) -> Result<String, ShaderError> {
    let failed = |e: std::io::Error| ShaderError::new(path, e.to_string());
    let size = std::fs::metadata(path).map_err(failed)?.len();
    if size > crate::source::LARGEST_SOURCE as u64 {
        let largest = crate::source::LARGEST_SOURCE;
        return Err(ShaderError::new(
            path,
            format!("found {size} bytes, expected a shader of at most {largest}"),
        ));
    }
    let bytes = std::fs::read(path).map_err(failed)?;
    String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        ShaderError::new(path, format!("byte {at} is not text in UTF-8"))
    })
}

/// What a function of two directions gives for each pair.
fn pairs<R: ShaderNumber>(
    program: &Program,
    parameters: &[R],
    wi: &[Vec3<R>],
    wo: &[Vec3<R>],
) -> Result<Vec<R>, ShaderError> {
    assert_eq!(
        wi.len(),
        wo.len(),
        "as many directions to the light as to the viewer"
    );
    let n = program.inputs();
    let mut inputs = Vec::with_capacity(n * wi.len());
    for (wi, wo) in wi.iter().zip(wo) {
        inputs.extend_from_slice(&Shader::arguments(*wi, *wo)[..n]);
    }
    let mut values = vec![R::zero(); program.outputs() * wi.len()];
    program.run_many(parameters, &inputs, &mut values)?;
    Ok(values)
}

impl SampleLayout {
    /// The drawn direction among what the function gave.
    fn drawn<R: Real>(&self, s: &[R]) -> Drawn<R> {
        let layout = self;
        let weight_length = if layout.coloured { 3 } else { 1 };
        let wi = [s[layout.wi], s[layout.wi + 1], s[layout.wi + 2]];
        let weight = &s[layout.weight..layout.weight + weight_length];
        let weight = [
            weight[0],
            weight[(weight_length - 1).min(1)],
            weight[weight_length - 1],
        ];
        Drawn {
            wi: Vec3::new(wi[0], wi[1], wi[2]),
            weight,
            pdf: s[layout.pdf],
            delta: match layout.delta {
                Some(k) => s[k].gt(R::lit(0.5)),
                None => R::Mask::splat(false),
            },
        }
    }
}

/// The most numbers that a sampling function gives: with what may stand beside in its structure.
const MOST_OUTPUTS: usize = 32;
