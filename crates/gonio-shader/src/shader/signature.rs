//! Which functions of a shader are evaluated, and whether their signatures fit.

use super::{MOST_OUTPUTS, SampleLayout, Settings};
use crate::{Language, ShaderError, ShaderModule};
use naga::{Function, Handle, Scalar, ScalarKind, Type, TypeInner, VectorSize};

/// The names of the functions.
pub(super) struct Names {
    pub eval: String,
    pub pdf: String,
    pub sample: String,
}

/// The names of the functions to look for.
pub(super) fn names(module: &ShaderModule, settings: &Settings) -> Result<Names, ShaderError> {
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

pub(super) fn find_eval(
    module: &ShaderModule,
    name: &str,
) -> Result<Handle<Function>, ShaderError> {
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

pub(super) fn find_pdf(module: &ShaderModule, name: &str) -> Result<Handle<Function>, ShaderError> {
    let expected = match module.language() {
        Language::Wgsl => format!("fn {name}(wi: vec3f, wo: vec3f) -> f32"),
        _ => format!("float {name}(vec3 wi, vec3 wo)"),
    };
    let fits = |f: &Function| takes(module, f, 2) && gives(module, f, true, false);
    choose(module, name, fits, &expected)
}

/// Finds wi, weight, pdf and delta among what the sampling function gives: members of a structure, or arguments.
pub(super) fn sample_layout(
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
