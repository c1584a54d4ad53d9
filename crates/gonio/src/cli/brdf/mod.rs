//! `gonio brdf`.

pub(in crate::cli) mod check;
mod convert;
mod exec;
pub(in crate::cli) mod export;
mod files;
mod info;
mod pictures;
pub(in crate::cli) mod plot;
mod self_test;

use super::failure::Failure;
use super::parse::{self, Angles};
use super::presets;
use super::terminal::{print, print_json, significant, warn};
use gonio_brdf::{Brdf, Model, ModelInfo, ModelSpec, ParameterInfo, registry};
use serde_json::json;
use std::path::PathBuf;

#[derive(clap::Subcommand)]
#[command(after_help = "Example:\n  gonio brdf show torrance-sparrow")]
pub(super) enum Command {
    /// Name every reflection function
    #[command(after_help = "Examples:\n  gonio brdf list\n  gonio brdf list --presets ward")]
    List {
        /// Name presets instead: the sets of every model, or what is in those of one
        #[arg(long, value_name = "MODEL", num_args = 0..=1, default_missing_value = "")]
        presets: Option<String>,
        /// Print it as JSON
        #[arg(long)]
        json: bool,
    },
    /// What a reflection function is: parameters, ranges, paper, declared properties
    #[command(after_help = "Example:\n  gonio brdf show torrance-sparrow")]
    Show {
        /// Its name, or NAME@PRESET
        name: String,
        /// Print it as JSON
        #[arg(long)]
        json: bool,
    },
    /// The value f(ωi→ωr) for a pair of directions, with the cosine and the density of sampling
    #[command(
        after_help = "Example:\n  gonio brdf eval ggx:metal=gold,roughness=0.3 --wi 45,0 --wo 45,180"
    )]
    Eval {
        /// NAME or NAME:key=value,…
        spec: String,
        /// Direction to the light: θ,φ in degrees
        #[arg(long, value_name = "θ,φ", value_parser = parse::angles, allow_hyphen_values = true)]
        wi: Angles,
        /// Direction to the viewer: θ,φ in degrees
        #[arg(long, value_name = "θ,φ", value_parser = parse::angles, allow_hyphen_values = true)]
        wo: Angles,
        /// Print it as JSON
        #[arg(long)]
        json: bool,
    },
    /// What a measured file holds: format, layout, channels, origin, faults
    #[command(after_help = "Example:\n  gonio brdf info gold-paint.binary")]
    Info {
        /// A file of measured reflection, of any format
        file: PathBuf,
        /// Print it as JSON
        #[arg(long)]
        json: bool,
    },
    /// A measured file or a model as a file of another format or layout, and what that costs
    #[command(after_help = convert::help())]
    Convert(Box<convert::Arguments>),
    /// A model as shader code: WGSL, GLSL, HLSL, MSL or OSL
    #[command(after_help = export::help())]
    Export(export::Arguments),
    /// Is it physical? Reciprocity, energy, isotropy, sampling, each with a bound and a witness
    #[command(after_help = check::HELP)]
    Check(check::Arguments),
    /// A picture of one function or of several: lobes, curves, slices, albedo
    #[command(after_help = plot::HELP)]
    Plot(Box<plot::Arguments>),
}

pub(super) fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::List {
            presets: Some(model),
            json,
        } => presets::list(&model, json),
        Command::List {
            presets: None,
            json,
        } => list(json),
        Command::Show { name, json } => show(&name, json),
        Command::Eval { spec, wi, wo, json } => eval(&spec, wi, wo, json),
        Command::Info { file, json } => info::run(&file, json),
        Command::Convert(arguments) => convert::run(*arguments),
        Command::Export(arguments) => export::run(arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Plot(arguments) => plot::run(*arguments),
    }
}

fn list(json: bool) -> Result<(), Failure> {
    if json {
        let all: Vec<_> = registry::models().iter().map(in_json).collect();
        return print_json(&all);
    }
    let width = registry::models()
        .iter()
        .map(|m| m.name.len())
        .max()
        .unwrap_or(0);
    let mut text = String::new();
    for model in registry::models() {
        text += &format!("{:width$}  {}\n", model.name, model.summary);
        for alias in model.aliases {
            let preset: Vec<String> = alias
                .preset
                .iter()
                .map(|(k, v)| format!("{k}={v}"))
                .collect();
            let meaning = match preset.is_empty() {
                true => String::new(),
                false => format!(": {}", preset.join(",")),
            };
            text += &format!("{:width$}  also {}{meaning}\n", "", alias.name);
        }
        for line in presets::counted(model) {
            text += &format!("{:width$}  {line}\n", "");
        }
    }
    print(&text)
}

fn show(name: &str, json: bool) -> Result<(), Failure> {
    let whole = ModelSpec::parse(name)?;
    // A preset may stand for a sum: the model that was named is a part of it.
    let named = name.split(['@', ':', '(']).next().unwrap_or(name);
    let spec = whole.part(named.trim()).unwrap_or(&whole);
    let model = spec.info()?;
    let parameters = spec.parameters()?;
    if json {
        let mut model = in_json(model);
        model["parameters"] = parameters_in_json(parameters.into_iter());
        return print_json(&model);
    }
    let declared = whole.declares()?;
    let mut text = format!(
        "{}\n\n{}\n",
        wrapped(&format!("{}: {}", model.name, model.summary), 2),
        wrapped(&format!("Source: {}", model.paper), 2)
    );
    if !parameters.is_empty() {
        text += "\nParameters\n";
    }
    let width = parameters.iter().map(|p| p.name.len()).max().unwrap_or(0);
    for parameter in parameters {
        let given = spec.values.contains_key(parameter.name);
        let value = match spec.value(parameter.name) {
            Some(value) if given => format!("here {value}"),
            Some(value) => format!("default {value}"),
            None => "no default".into(),
        };
        for (first, line) in [
            (parameter.name, parameter.meaning),
            ("", &format!("{}; {value}", parameter.expected())),
        ] {
            let line = format!("  {first:width$}  {line}");
            text += &format!("{}\n", wrapped(&line, width + 4));
        }
    }
    if name.contains('@') {
        text += &format!("\n{}\n", wrapped(&presets::explained(name, &whole), 2));
    } else {
        let counted = presets::counted(model);
        if !counted.is_empty() {
            text += "\nPresets\n";
        }
        for line in counted {
            text += &format!("{}\n", wrapped(&format!("  {line}"), 4));
        }
    }
    text += "\nDeclared\n";
    for (holds, property) in [
        (declared.reciprocal, "reciprocal"),
        (declared.energy_conserving, "energy-conserving"),
        (declared.isotropic, "isotropic"),
    ] {
        text += &format!("  {}{property}\n", if holds { "" } else { "not " });
    }
    text += &format!("\nCheck it: gonio brdf check {name}\n");
    print(&text)
}

/// Columns that text for people takes at most.
pub(super) const COLUMNS: usize = 80;

/// `text` in lines of at most 80 columns, broken at spaces; the second and later ones are indented.
pub(super) fn wrapped(text: &str, indent: usize) -> String {
    let start = text.len() - text.trim_start().len();
    let mut lines = text[..start].to_owned();
    let mut column = start;
    for (i, word) in text[start..].split(' ').enumerate() {
        let length = word.chars().count();
        if i > 0 && column > indent && column + 1 + length > COLUMNS {
            lines.truncate(lines.trim_end().len());
            lines += "\n";
            lines += &" ".repeat(indent);
            column = indent;
        } else if i > 0 {
            lines.push(' ');
            column += 1;
        }
        lines += word;
        column += length;
    }
    lines
}

fn parameters_in_json(
    parameters: impl Iterator<Item = &'static ParameterInfo>,
) -> serde_json::Value {
    let one = |p: &ParameterInfo| {
        json!({
            "name": p.name,
            "expected": p.expected(),
            "default": p.default_value().map(|v| v.to_string()),
            "meaning": p.meaning,
        })
    };
    parameters.map(one).collect()
}

fn in_json(model: &'static ModelInfo) -> serde_json::Value {
    let declared = ModelSpec::new(model.name)
        .map(|spec| (model.declares)(&spec))
        .ok();
    json!({
        "name": model.name,
        "summary": model.summary,
        "paper": model.paper,
        "aliases": model.aliases.iter().map(|a| a.name).collect::<Vec<_>>(),
        "parameters": parameters_in_json(model.parameters.iter()),
        "presets": presets::in_json(&presets::sets_of(model)),
        "declares": declared.map(|d| json!({
            "reciprocal": d.reciprocal,
            "energy_conserving": d.energy_conserving,
            "isotropic": d.isotropic,
        })),
    })
}

fn eval(text: &str, wi: Angles, wo: Angles, json: bool) -> Result<(), Failure> {
    let spec = ModelSpec::parse(text)?;
    let model: Model<f64, 3> = spec.build()?;
    for line in model.warnings() {
        warn(&line);
    }
    let (i, o) = (wi.direction(), wo.direction());
    let f = model.eval(i, o);
    let f_cos = model.eval_cos(i, o);
    let pdf = model.pdf(i, o);
    if let Some(error) = model.failure() {
        return Err(error.into());
    }
    if json {
        return print_json(&json!({
            "model": spec.to_string(),
            "wi_deg": [wi.theta_deg, wi.phi_deg],
            "wo_deg": [wo.theta_deg, wo.phi_deg],
            "f_per_sr": f,
            "f_cos_per_sr": f_cos,
            "pdf_per_sr": pdf,
        }));
    }
    let colour = |c: [f64; 3]| {
        if c[0] == c[1] && c[1] == c[2] {
            significant(c[0])
        } else {
            let [r, g, b] = c.map(significant);
            format!("{r}  {g}  {b}  (red, green, blue)")
        }
    };
    let mut words = format!(
        "{spec}\n  wi  θ = {}°, φ = {}°\n  wo  θ = {}°, φ = {}°\n  f            {} sr⁻¹\n  f · cosθi    {} sr⁻¹\n  \
         pdf(wi | wo) {} sr⁻¹\n",
        wi.theta_deg,
        wi.phi_deg,
        wo.theta_deg,
        wo.phi_deg,
        colour(f),
        colour(f_cos),
        significant(pdf),
    );
    if model.is_delta() {
        words += "  all its light is in a Dirac delta, whose value at a pair of directions is 0\n";
    }
    print(&words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_broken_at_spaces() {
        let text = wrapped(&"four ".repeat(40), 3);
        assert!(text.lines().count() > 2);
        for (i, line) in text.lines().enumerate() {
            assert!(line.chars().count() <= COLUMNS, "{line}");
            assert_eq!(line.starts_with("   four"), i > 0);
        }
        assert_eq!(wrapped("  name   meaning", 8), "  name   meaning");
        assert_eq!(wrapped("", 2), "");
        let long = "x".repeat(100);
        assert_eq!(wrapped(&long, 2), long);
    }
}
