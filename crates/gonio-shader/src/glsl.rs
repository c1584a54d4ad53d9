//! What GLSL needs before it is parsed.

use crate::ShaderError;
use crate::source::{Source, erase, identifiers};

/// How many words macros may add to a text. They may be brackets, each inside the one before it.
const LARGEST_EXPANSION: u64 = 20_000;

/// A text whose uniform variables have become plain global ones.
#[derive(Debug)]
pub(crate) struct Prepared {
    pub code: String,
    /// The names of the variables.
    pub names: Vec<String>,
}

/// Makes `uniform float x = 0.3;` a global variable, as which it may have a value and needs no binding. `code` is the text,
/// `plain` the same without comments. Blocks and textures stay as they are.
pub(crate) fn uniforms(code: &str, plain: &str) -> Prepared {
    const TYPES: [&str; 5] = ["float", "int", "uint", "bool", "vec3"];
    let mut prepared = Prepared {
        code: code.to_owned(),
        names: Vec::new(),
    };
    let words: Vec<(usize, &str)> = identifiers(plain).collect();
    for (k, &(at, word)) in words.iter().enumerate() {
        if word != "uniform" {
            continue;
        }
        let mut rest = words[k + 1..]
            .iter()
            .skip_while(|(_, w)| matches!(*w, "highp" | "mediump" | "lowp"));
        let (Some((_, ty)), Some((_, name))) = (rest.next(), rest.next()) else {
            continue;
        };
        if !TYPES.contains(ty) {
            continue;
        }
        erase(&mut prepared.code, at..at + word.len());
        // `layout(…)` before it would have nothing to say.
        let before = plain[..at].trim_end();
        if before.ends_with(')')
            && let Some(open) = before.rfind("layout")
            && before[open..].matches('(').count() == 1
            && !before[open..].contains([';', '{', '}'])
        {
            erase(&mut prepared.code, open..before.len());
        }
        prepared.names.push((*name).to_owned());
    }
    prepared
}

/// A macro: its parameters, and how often each stands in what it becomes.
struct Macro<'a> {
    name: &'a str,
    body: &'a str,
    has_parameters: bool,
}

/// Refuses macros that would make a text too large to be read: each can double the one before it.
pub(crate) fn check_macros(source: &Source, plain: &str) -> Result<(), ShaderError> {
    let mut macros: Vec<Macro<'_>> = Vec::new();
    // Words of the text, each as large as what it becomes; a macro's arguments may be repeated wherever its body names them, so
    // a call counts as its body times the largest of its arguments.
    let mut total: u64 = 0;
    let mut sizes: std::collections::HashMap<&str, (u64, u64)> = std::collections::HashMap::new();
    let mut byte = 0;
    for line in plain.split_inclusive('\n') {
        let start = byte;
        byte += line.len();
        let trimmed = line.trim();
        let directive = trimmed
            .strip_prefix('#')
            .map(str::trim_start)
            .and_then(|d| d.strip_prefix("define"));
        if let Some(definition) = directive {
            if trimmed.ends_with('\\') {
                return Err(source.error_at(start, "a macro of several lines is not supported"));
            }
            let definition = definition.trim_start();
            let len = identifiers(definition)
                .next()
                .map_or(0, |(at, word)| at + word.len());
            let has_parameters = definition[len..].starts_with('(');
            let body = match (has_parameters, definition.find(')')) {
                (true, Some(close)) => &definition[close + 1..],
                _ => &definition[len..],
            };
            macros.push(Macro {
                name: &definition[..len],
                body,
                has_parameters,
            });
        }
    }
    // From the first to the last and again: a macro may name those below it. A cycle is cut by the preprocessor.
    for _ in 0..macros.len().min(64) {
        let mut changed = false;
        for m in &macros {
            let (mut size, mut repeats) = (1u64, 1u64);
            for (_, word) in identifiers(m.body) {
                let (s, r) = match sizes.get(word) {
                    Some(&known) if word != m.name => known,
                    _ => (1, 1),
                };
                size = size.saturating_add(s);
                repeats = repeats.saturating_mul(r).saturating_add(1);
            }
            size = size.saturating_add(m.body.len() as u64);
            let repeats = if m.has_parameters { repeats } else { 1 };
            changed |= sizes.insert(m.name, (size, repeats)) != Some((size, repeats));
        }
        if !changed {
            break;
        }
    }
    // A call in a call in a call: the product of the repeats, as deep as the brackets are.
    let mut open: Vec<u64> = vec![1];
    let mut last_repeat = 1u64;
    let mut at = 0;
    for (start, word) in identifiers(plain) {
        for c in plain[at..start].chars() {
            match c {
                '(' => {
                    let outer = *open.last().unwrap_or(&1);
                    open.push(outer.saturating_mul(last_repeat));
                }
                ')' if open.len() > 1 => {
                    open.pop();
                }
                ';' => open.truncate(1),
                _ => {}
            }
            last_repeat = 1;
        }
        at = start + word.len();
        let (size, repeats) = sizes.get(word).copied().unwrap_or((1, 1));
        last_repeat = repeats;
        let words = size.saturating_mul(*open.last().unwrap_or(&1));
        total = total.saturating_add(words - 1);
        if total > LARGEST_EXPANSION {
            return Err(source.error_at(start, "the macros up to here make too long a text"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Language;
    use std::path::Path;

    fn source(code: &str) -> Source {
        Source {
            path: Path::new("a.glsl").into(),
            language: Language::Glsl,
            text: code.into(),
            code: code.into(),
        }
    }

    #[test]
    fn uniform_variables_become_plain_ones() {
        let code = "layout(binding = 0) uniform float a = 0.3;\nuniform highp vec3 b;\nuniform Block { float c; };\n";
        let p = uniforms(code, code);
        assert_eq!(p.names, ["a", "b"]);
        assert_eq!(p.code.len(), code.len());
        assert_eq!(p.code.lines().next().unwrap().trim(), "float a = 0.3;");
        assert!(p.code.contains("uniform Block"));
    }

    #[test]
    fn macros_that_explode_are_refused() {
        let mut code = String::from("#define A0 x x\n");
        for k in 1..40 {
            code += &format!("#define A{k} A{} A{}\n", k - 1, k - 1);
        }
        code += "float f() { return A39; }\n";
        assert!(check_macros(&source(&code), &code).is_err());
        let nested = format!(
            "#define T(x) ((x)*(x))\nfloat f(float y) {{ return {}y{}; }}",
            "T(".repeat(40),
            ")".repeat(40)
        );
        assert!(check_macros(&source(&nested), &nested).is_err());
        let honest = "#define PI 3.14\n#define SQR(x) ((x)*(x))\nfloat f(float y) { return SQR(SQR(y)) / PI; }";
        assert!(check_macros(&source(honest), honest).is_ok());
    }
}
