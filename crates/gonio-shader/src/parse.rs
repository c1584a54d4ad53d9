//! naga, kept at arm's length: one call, on a stack of its own, whose panics are errors.

use crate::ShaderError;
use crate::source::{Language, Source};
use naga::front::{glsl, wgsl};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage, Span};

/// Bytes of stack. The parser, the validator and the compiler call themselves for each level of nesting and each sign of a long
/// expression: this is several times what the deepest text that [`Source::check_nesting`] lets through was seen to need.
const STACK: usize = 512 << 20;

/// Runs `work` on a large stack. A panic in it becomes an error: naga is not free of them on odd input.
pub(crate) fn on_large_stack<T: Send>(
    source: &Source,
    work: impl FnOnce() -> T + Send,
) -> Result<T, ShaderError> {
    // Where there are no threads, as in a browser, one stack has to do: what it is too small for ends the program, and the page begins
    // another one.
    if cfg!(target_family = "wasm") {
        return Ok(work());
    }
    let fail = |what: &str| ShaderError::new(&source.path, what);
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new()
            .name("shader parser".into())
            .stack_size(STACK)
            .spawn_scoped(scope, work)
            .map_err(|e| fail(&format!("no thread can be started to read it: {e}")))?;
        // The thread ends by itself; what it panicked with says nothing to a user.
        thread.join().map_err(|_| {
            fail("the parser could not cope with it: a fault of the parser, in a shader that is probably wrong")
        })
    })
}

/// Parses and validates.
pub(crate) fn parse(source: &Source) -> Result<(Module, ModuleInfo), ShaderError> {
    on_large_stack(source, || {
        let module = match source.language {
            Language::Wgsl => parse_wgsl(source)?,
            Language::Glsl | Language::Brdf => parse_glsl(source)?,
        };
        validate(source, module)
    })?
}

fn error_at(source: &Source, span: Option<Span>, message: String) -> ShaderError {
    match span.and_then(Span::to_range) {
        Some(range) => source.error_at(range.start, message),
        None => ShaderError::new(&source.path, message),
    }
}

/// A message of naga's in the middle of a sentence.
fn lowered(message: &str) -> String {
    let message = message.trim().trim_end_matches('.');
    let mut chars = message.chars();
    match (chars.next(), chars.clone().next()) {
        (Some(first), Some(second)) if first.is_uppercase() && second.is_lowercase() => {
            first.to_lowercase().chain(chars).collect()
        }
        _ => message.to_owned(),
    }
}

/// A message of the validator's in the words of a shader: without its internal numbers.
fn readable(message: &str) -> String {
    let mut text = lowered(message);
    for scalar in ["Float", "Sint", "Uint", "Bool"] {
        let name = match scalar {
            "Float" => "f32",
            "Sint" => "i32",
            "Uint" => "u32",
            _ => "bool",
        };
        let width = if scalar == "Bool" { 1 } else { 4 };
        let long = format!("Scalar {{ kind: {scalar}, width: {width} }}");
        text = text.replace(&long, name);
        text = text.replace(&format!("Scalar({name})"), name);
        for (size, word) in [(2, "Bi"), (3, "Tri"), (4, "Quad")] {
            let long = format!("Vector {{ size: {word}, scalar: {name} }}");
            text = text.replace(&long, &format!("vec{size}<{name}>"));
        }
    }
    // Numbers of expressions and types, such as `[12]`.
    let mut short = String::with_capacity(text.len());
    let mut rest = text.as_str();
    while let Some(open) = rest.find('[') {
        let after = &rest[open + 1..];
        let digits = after.find(|c: char| !c.is_ascii_digit()).unwrap_or(0);
        if digits > 0 && after[digits..].starts_with(']') {
            short.push_str(&rest[..open]);
            rest = &after[digits + 1..];
        } else {
            short.push_str(&rest[..=open]);
            rest = after;
        }
    }
    short.push_str(rest);
    let short = short.replace("Some()", "").replace(" (of type ", " (");
    let words: Vec<&str> = short.split_whitespace().collect();
    words.join(" ")
}

/// The names that the GLSL parser gives to signs.
const SIGNS: [(&str, &str); 10] = [
    ("LeftParen", "`(`"),
    ("RightParen", "`)`"),
    ("LeftBrace", "`{`"),
    ("RightBrace", "`}`"),
    ("LeftBracket", "`[`"),
    ("RightBracket", "`]`"),
    ("Semicolon", "`;`"),
    ("Comma", "`,`"),
    ("Colon", "`:`"),
    ("Assign", "`=`"),
];

fn parse_wgsl(source: &Source) -> Result<Module, ShaderError> {
    wgsl::parse_str(&source.code).map_err(|e| {
        let mut message = lowered(e.message());
        let mut labels = e.labels();
        let first = labels.next();
        if let Some((_, label)) = first
            && !label.is_empty()
            && !message.contains(lowered(label).as_str())
        {
            message = format!("{message}: {}", lowered(label));
        }
        let error = error_at(source, first.map(|(span, _)| span), message);
        let note = e.notes().next().map(lowered);
        match note {
            Some(note) => error.with_help(note),
            None => error,
        }
    })
}

fn parse_glsl(source: &Source) -> Result<Module, ShaderError> {
    let options = glsl::Options::from(ShaderStage::Fragment);
    let parsed = glsl::Frontend::default().parse(&options, &source.code);
    parsed.map_err(|e| match e.errors.first() {
        Some(first) => {
            let mut message = lowered(&first.kind.to_string());
            for (name, sign) in SIGNS {
                message = message.replace(name, sign);
            }
            let error = error_at(source, Some(first.meta), message);
            if error.message.starts_with("unknown function") {
                error.with_help(
                    "a function can call those that are defined above it, and never itself",
                )
            } else {
                error
            }
        }
        None => ShaderError::new(&source.path, "it cannot be parsed"),
    })
}

fn validate(source: &Source, module: Module) -> Result<(Module, ModuleInfo), ShaderError> {
    // There is no pipeline: bindings mean nothing, nor does uniform control flow.
    let flags = ValidationFlags::EXPRESSIONS | ValidationFlags::BLOCKS | ValidationFlags::CONSTANTS;
    let info = Validator::new(flags, Capabilities::all()).validate(&module);
    match info {
        Ok(info) => Ok((module, info)),
        Err(e) => {
            // The innermost cause says what is wrong, the shortest span where.
            let mut cause: &dyn std::error::Error = e.as_inner();
            while let Some(inner) = cause.source() {
                cause = inner;
            }
            let spans = e.spans().filter_map(|(span, _)| span.to_range());
            let span = spans.min_by_key(|range| range.len()).map(Span::from);
            let cause = cause.to_string();
            // What naga says of functions in the wrong order names no function.
            let message = if cause.contains("has not been processed yet") {
                "a function calls one that is defined below it, or itself: shaders have no recursion".into()
            } else {
                readable(&cause)
            };
            Err(error_at(source, span, message))
        }
    }
}
