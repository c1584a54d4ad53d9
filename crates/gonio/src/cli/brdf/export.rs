//! `gonio brdf export`.

use crate::cli::destination;
use crate::cli::failure::{Failure, did_you_mean, nearest};
use crate::cli::terminal::print;
use gonio_brdf::ModelSpec;
use gonio_brdf::export::{Export, Style, obstacle};
use gonio_brdf::record::FunctionKind;
use gonio_image::write_file;
use gonio_num::expr::Language;
use std::path::PathBuf;

#[derive(clap::Args)]
pub(in crate::cli) struct Arguments {
    /// NAME, NAME@PRESET or NAME:key=value,…
    pub spec: String,
    /// The language [default: by the extension of FILE]
    #[arg(long, value_name = "LANGUAGE", value_parser = languages())]
    lang: Option<String>,
    /// Functions to write, joined by commas
    #[arg(long, value_name = "FUNCTIONS", value_delimiter = ',', default_value = "eval,pdf,sample", value_parser = functions())]
    with: Vec<String>,
    /// What all names begin with, so that several models can live in one shader [default: the model's name]
    #[arg(long, value_name = "PREFIX")]
    name: Option<String>,
    /// The file to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

fn languages() -> Vec<&'static str> {
    Language::ALL.map(Language::name).to_vec()
}

fn functions() -> Vec<&'static str> {
    FunctionKind::ALL.map(FunctionKind::name).to_vec()
}

pub(super) fn run(arguments: Arguments) -> Result<(), Failure> {
    let language = language(&arguments)?;
    if let Some(file) = &arguments.output {
        destination::writable(file)?;
    }
    let spec = ModelSpec::parse(&arguments.spec)?;
    if let Some((what, instead)) = obstacle(&spec) {
        return Err(Failure::usage(what).with_help(instead));
    }
    let functions: Vec<FunctionKind> = FunctionKind::ALL
        .into_iter()
        .filter(|f| arguments.with.iter().any(|name| name == f.name()))
        .collect();
    let name = arguments
        .name
        .clone()
        .unwrap_or_else(|| usual_name(&arguments.spec));
    if let Some(why) = language.refuses(&name) {
        let title = language.name().to_uppercase();
        return Err(
            Failure::usage(format!("'{name}' can't begin names in {title}: {why}")).with_help(
                "--name takes ASCII letters, digits and single underscores, as in --name gold",
            ),
        );
    }
    let text = Export::new(&spec)?.text(&Style {
        language,
        functions: &functions,
        name: &name,
        command: &command(&arguments, language, &functions),
    })?;
    let Some(file) = &arguments.output else {
        return print(&text);
    };
    write_file(file, text.as_bytes())?;
    let written: Vec<String> = functions
        .iter()
        .map(|f| format!("{name}_{}", f.name()))
        .collect();
    print(&format!(
        "{}: {} in {}, {} lines\n",
        file.display(),
        written.join(", "),
        language.name().to_uppercase(),
        text.lines().count()
    ))
}

/// The language that was given, or that of the file's extension.
fn language(arguments: &Arguments) -> Result<Language, Failure> {
    if let Some(name) = &arguments.lang {
        return Ok(Language::from_name(name).expect("invariant: the parser takes no other names"));
    }
    let all = languages().join(", ");
    let Some(file) = &arguments.output else {
        return Err(Failure::usage(
            "which language? neither --lang nor a file to tell it by was given",
        )
        .with_help(format!("add --lang with one of {all}")));
    };
    let extension = destination::extension(file);
    if let Some(language) = Language::from_extension(&extension) {
        return Ok(language);
    }
    let message = match extension.as_str() {
        "" => format!(
            "{}: the name has no extension to tell the language by",
            file.display()
        ),
        other => format!("{}: .{other} is no shading language's", file.display()),
    };
    let known = Language::ALL.into_iter().flat_map(Language::extensions);
    Err(
        Failure::usage(message).with_help(match nearest(&extension, known) {
            Some(near) => did_you_mean(&format!(".{near}")),
            None => format!("name it as in ggx.glsl, or add --lang with one of {all}"),
        }),
    )
}

/// The model's name as it was written, as a name in code.
fn usual_name(spec: &str) -> String {
    let end = spec.find([':', '(', '@']).unwrap_or(spec.len());
    spec[..end].trim().replace('-', "_")
}

/// The command that makes this text again.
fn command(arguments: &Arguments, language: Language, functions: &[FunctionKind]) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || ":=.,/@_+-".contains(c);
    let spec = arguments.spec.trim();
    let mut command = match spec.chars().all(plain) {
        true => format!("gonio brdf export {spec} --lang {}", language.name()),
        false => format!(
            "gonio brdf export '{}' --lang {}",
            spec.replace('\n', " "),
            language.name()
        ),
    };
    if functions.len() < FunctionKind::ALL.len() {
        let names: Vec<&str> = functions.iter().map(|f| f.name()).collect();
        command += &format!(" --with {}", names.join(","));
    }
    if let Some(name) = &arguments.name {
        command += &format!(" --name {name}");
    }
    command
}

/// What the help ends with.
pub(in crate::cli) fn help() -> String {
    let mut text = "Languages, and extensions of FILE that tell them:\n".to_owned();
    for language in Language::ALL {
        let extensions = language.extensions().join(" .");
        text += &format!("  {:<6} .{extensions}\n", language.name());
    }
    text + "\nExamples:\n  gonio brdf export ggx:roughness=0.3 --lang glsl\n  \
            gonio brdf export ward@gold-paint --lang hlsl --with eval --name gold_paint\n  \
            gonio brdf export disney:base_color=#c03020,metallic=0 -o disney.metal\n\n\
            The parameters stand at the top, to be changed there; one that is 0 must be given to be among them.\n\
            The functions take directions in the local frame, whose +z is the normal."
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_brdf::registry;

    #[test]
    fn every_model_has_a_name_that_every_language_takes() {
        // What can't be exported needs none: "shader" is a word of OSL.
        for info in registry::models().iter().filter(|m| m.recordable) {
            let aliases = info.aliases.iter().map(|a| a.name);
            for name in std::iter::once(info.name).chain(aliases) {
                for language in Language::ALL {
                    assert_eq!(language.refuses(&usual_name(name)), None, "{name}");
                }
            }
        }
        assert_eq!(usual_name(" sum(a, b)"), "sum");
        assert_eq!(usual_name("ward-duer@gold-paint:alpha=1"), "ward_duer");
    }
}
