//! [`Shader`], a reflection function written as a shader.

use crate::number::ShaderNumber;
use crate::{Language, Parameter, Program, ShaderError, ShaderModule};
use gonio_num::{Mask, Real, Vec3};
use naga::{Function, Handle, Scalar, ScalarKind, Type, TypeInner, VectorSize};
use std::path::Path;
use std::sync::OnceLock;

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
#[derive(Debug)]
pub struct Shader {
    module: ShaderModule,
    eval: Program,
    pdf: Option<Program>,
    sample: Option<(Program, SampleLayout)>,
    failure: OnceLock<ShaderError>,
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
        let text = String::from_utf8(bytes).map_err(|e| {
            let at = e.utf8_error().valid_up_to();
            ShaderError::new(path, format!("byte {at} is not text in UTF-8"))
        })?;
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
            module,
            eval,
            pdf,
            sample,
            failure: OnceLock::new(),
        })
    }

    /// The parameters that it declares.
    pub fn parameters(&self) -> &[Parameter] {
        self.module.parameters()
    }

    /// Its language.
    pub fn language(&self) -> Language {
        self.module.language()
    }

    /// What was left out of the file.
    pub fn warnings(&self) -> &[String] {
        self.module.warnings()
    }

    /// Whether it has a density of its own.
    pub fn has_pdf(&self) -> bool {
        self.pdf.is_some()
    }

    /// Whether it draws directions itself.
    pub fn has_sample(&self) -> bool {
        self.sample.is_some()
    }

    /// The function that is evaluated.
    pub fn program(&self) -> &Program {
        &self.eval
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
        let n = self.eval.outputs();
        self.run(
            &self.eval,
            parameters,
            &all[..self.eval.inputs()],
            &mut f[..n],
        );
        if n == 1 { [f[0]; 3] } else { f }
    }

    /// The density of its own in sr⁻¹; `None` if it has none.
    ///
    /// # Panics
    /// As [`Shader::eval`].
    pub fn pdf<R: ShaderNumber>(&self, parameters: &[R], wi: Vec3<R>, wo: Vec3<R>) -> Option<R> {
        let program = self.pdf.as_ref()?;
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
        let (program, layout) = self.sample.as_ref()?;
        let mut s = [R::zero(); MOST_OUTPUTS];
        let inputs = [wo.x, wo.y, wo.z, u[0], u[1], u[2]];
        self.run(program, parameters, &inputs, &mut s[..program.outputs()]);
        let [wi, weight] = [layout.wi, layout.weight].map(|k| [s[k], s[k + 1], s[k + 2]]);
        Some(Drawn {
            wi: Vec3::new(wi[0], wi[1], wi[2]),
            weight: if layout.coloured {
                weight
            } else {
                [weight[0]; 3]
            },
            pdf: s[layout.pdf],
            delta: match layout.delta {
                Some(k) => s[k].gt(R::lit(0.5)),
                None => R::Mask::splat(false),
            },
        })
    }
}

/// The most numbers that a sampling function gives: with what may stand beside in its structure.
const MOST_OUTPUTS: usize = 32;

struct Names {
    eval: String,
    pdf: String,
    sample: String,
}

/// The names of the functions to look for.
fn names(module: &ShaderModule, settings: &Settings) -> Result<Names, ShaderError> {
    let prefixed = |prefix: &str, eval: String| Names {
        eval,
        pdf: format!("{prefix}_pdf"),
        sample: format!("{prefix}_sample"),
    };
    let plain = |eval: &str| Names {
        eval: eval.into(),
        pdf: "pdf".into(),
        sample: "sample".into(),
    };
    if let Some(entry) = &settings.entry {
        if entry == "eval" {
            return Ok(plain(entry));
        }
        let prefix = entry.strip_suffix("_eval").unwrap_or(entry);
        let whole = format!("{entry}_eval");
        let eval = if module.named(entry).next().is_none() && module.named(&whole).next().is_some()
        {
            whole
        } else {
            entry.clone()
        };
        return Ok(prefixed(prefix, eval));
    }
    if module.language() == Language::Brdf {
        return Ok(plain("BRDF"));
    }
    if module.named("eval").next().is_some() {
        return Ok(plain("eval"));
    }
    let all = module.module.functions.iter();
    let mut candidates: Vec<&str> = all
        .filter_map(|(_, f)| f.name.as_deref())
        .filter(|n| n.ends_with("_eval"))
        .collect();
    candidates.dedup();
    match candidates.as_slice() {
        [one] => Ok(prefixed(one.trim_end_matches("_eval"), (*one).to_owned())),
        [] => Ok(plain("eval")),
        several => {
            let list: Vec<String> = several.iter().map(|n| format!("`{n}`")).collect();
            Err(ShaderError::new(
                &module.source.path,
                format!(
                    "found {}, expected one function to evaluate",
                    list.join(", ")
                ),
            )
            .with_help(format!("choose one by entry={}", several[0])))
        }
    }
}

fn is_vec3(module: &ShaderModule, ty: Handle<Type>) -> bool {
    matches!(
        module.module.types[ty].inner,
        TypeInner::Vector {
            size: VectorSize::Tri,
            scalar: Scalar::F32
        }
    )
}

fn is_number(module: &ShaderModule, ty: Handle<Type>) -> bool {
    matches!(
        module.module.types[ty].inner,
        TypeInner::Scalar(Scalar::F32)
    )
}

/// Whether the function takes this many vectors of three numbers and nothing else.
fn takes(module: &ShaderModule, f: &Function, vectors: usize) -> bool {
    f.arguments.len() == vectors && f.arguments.iter().all(|a| is_vec3(module, a.ty))
}

fn gives(module: &ShaderModule, f: &Function, number: bool, vector: bool) -> bool {
    f.result
        .as_ref()
        .is_some_and(|r| (number && is_number(module, r.ty)) || (vector && is_vec3(module, r.ty)))
}

/// The function of this name that fits, or the error that none does.
fn choose(
    module: &ShaderModule,
    name: &str,
    fits: impl Fn(&Function) -> bool,
    expected: &str,
) -> Result<Handle<Function>, ShaderError> {
    let mut first = None;
    for handle in module.named(name) {
        if fits(&module.module.functions[handle]) {
            return Ok(handle);
        }
        first = first.or(Some(handle));
    }
    let Some(handle) = first else {
        return Err(module.missing(name));
    };
    let found = module.signature(&module.module.functions[handle]);
    Err(module.error_at_function(handle, format!("found `{found}`, expected `{expected}`")))
}

fn find_eval(module: &ShaderModule, name: &str) -> Result<Handle<Function>, ShaderError> {
    let (vectors, expected) = match module.language() {
        Language::Wgsl => (2, format!("fn {name}(wi: vec3f, wo: vec3f) -> vec3f")),
        Language::Glsl => (2, format!("vec3 {name}(vec3 wi, vec3 wo)")),
        Language::Brdf => (
            5,
            format!("vec3 {name}(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)"),
        ),
    };
    let fits = |f: &Function| takes(module, f, vectors) && gives(module, f, true, true);
    choose(module, name, fits, &expected)
}

fn find_pdf(module: &ShaderModule, name: &str) -> Result<Handle<Function>, ShaderError> {
    let expected = match module.language() {
        Language::Wgsl => format!("fn {name}(wi: vec3f, wo: vec3f) -> f32"),
        _ => format!("float {name}(vec3 wi, vec3 wo)"),
    };
    let fits = |f: &Function| takes(module, f, 2) && gives(module, f, true, false);
    choose(module, name, fits, &expected)
}

/// Finds wi, weight, pdf and delta among what the sampling function gives: members of a structure, or arguments.
fn sample_layout(
    module: &ShaderModule,
    handle: Handle<Function>,
) -> Result<SampleLayout, ShaderError> {
    let types = &module.module.types;
    let f = &module.module.functions[handle];
    let name = f.name.as_deref().unwrap_or("sample");
    let wrong = |why: &str| {
        let found = module.signature(f);
        let expected = match module.language() {
            Language::Wgsl => format!(
                "fn {name}(wo: vec3f, u: vec3f) -> S with a structure S of wi, weight: vec3f and pdf: f32"
            ),
            _ => format!(
                "vec3 {name}(vec3 wo, vec3 u, out vec3 wi, out float pdf) giving the weight, or a structure of wi, weight and pdf"
            ),
        };
        module.error_at_function(
            handle,
            format!("found `{found}`{why}, expected `{expected}`"),
        )
    };
    let ins = f.arguments.iter().take_while(|a| is_vec3(module, a.ty));
    if ins.count() != 2 {
        return Err(wrong(""));
    }
    // (name, type, first number)
    let mut parts: Vec<(&str, Handle<Type>, usize)> = Vec::new();
    let mut at = 0;
    let mut add = |name, ty| -> Result<(), ShaderError> {
        parts.push((name, ty, at));
        at += match types[ty].inner {
            TypeInner::Scalar(_) => 1,
            TypeInner::Vector { size, .. } => size as usize,
            _ => return Err(wrong(" with something else than numbers and vectors")),
        };
        Ok(())
    };
    if let Some(result) = &f.result {
        if let TypeInner::Struct { members, .. } = &types[result.ty].inner {
            for member in members {
                add(member.name.as_deref().unwrap_or(""), member.ty)?;
            }
        } else {
            add("weight", result.ty)?;
        }
    }
    for argument in &f.arguments[2..] {
        let TypeInner::Pointer { base, .. } = types[argument.ty].inner else {
            return Err(wrong(""));
        };
        add(argument.name.as_deref().unwrap_or(""), base)?;
    }
    if at > MOST_OUTPUTS - 3 {
        return Err(wrong(" with too many numbers"));
    }
    let part = |name: &str| parts.iter().find(|(n, ..)| *n == name);
    let (Some(wi), Some(weight), Some(pdf)) = (part("wi"), part("weight"), part("pdf")) else {
        let missing: Vec<&str> = ["wi", "weight", "pdf"]
            .into_iter()
            .filter(|n| part(n).is_none())
            .collect();
        return Err(wrong(&format!(" without {}", missing.join(" and "))));
    };
    let coloured = is_vec3(module, weight.1);
    if !is_vec3(module, wi.1)
        || !is_number(module, pdf.1)
        || !(coloured || is_number(module, weight.1))
    {
        return Err(wrong(""));
    }
    let delta = match part("delta") {
        None => None,
        Some((_, ty, at)) => match types[*ty].inner {
            TypeInner::Scalar(Scalar {
                kind: ScalarKind::Float | ScalarKind::Bool | ScalarKind::Sint | ScalarKind::Uint,
                ..
            }) => Some(*at),
            _ => return Err(wrong("")),
        },
    };
    Ok(SampleLayout {
        wi: wi.2,
        weight: weight.2,
        coloured,
        pdf: pdf.2,
        delta,
    })
}
