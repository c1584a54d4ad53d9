//! `gonio brdf`.

use super::failure::{Failure, chain};
use super::parse::{self, Angles};
use super::{print, print_json};
use gonio_brdf::{Brdf, Model, ModelInfo, ModelSpec, registry};
use gonio_verify::{Effort, Report};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

#[derive(clap::Subcommand)]
pub(super) enum Command {
    /// Name every reflection function
    #[command(after_help = "Example:\n  gonio brdf list")]
    List {
        /// Print it as JSON
        #[arg(long)]
        json: bool,
    },
    /// What a reflection function is: parameters, ranges, paper, declared properties
    #[command(after_help = "Example:\n  gonio brdf show torrance-sparrow")]
    Show {
        /// Its name
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
    /// Is it physical? Reciprocity, energy, isotropy, sampling, each with a bound and a witness
    #[command(
        after_help = "Examples:\n  gonio brdf check all\n  gonio brdf check phong:exponent=20 --effort thorough\n\n\
        Exits with 1 if a property fails that is not declared to be missing."
    )]
    Check {
        /// NAME, NAME:key=value,…, or all
        spec: String,
        /// How hard to look
        #[arg(long, value_enum, default_value_t = EffortName::Standard)]
        effort: EffortName,
        /// Print the reports as JSON
        #[arg(long)]
        json: bool,
    },
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
pub(super) enum EffortName {
    /// A second or less
    Quick,
    /// Seconds
    Standard,
    /// A minute
    Thorough,
}

impl From<EffortName> for Effort {
    fn from(name: EffortName) -> Self {
        match name {
            EffortName::Quick => Self::Quick,
            EffortName::Standard => Self::Standard,
            EffortName::Thorough => Self::Thorough,
        }
    }
}

pub(super) fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::List { json } => list(json),
        Command::Show { name, json } => show(&name, json),
        Command::Eval { spec, wi, wo, json } => eval(&spec, wi, wo, json),
        Command::Check { spec, effort, json } => check(&spec, effort.into(), json),
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
            text += &format!("{:width$}  also {}: {}\n", "", alias.name, preset.join(","));
        }
    }
    print(&text);
    Ok(())
}

fn show(name: &str, json: bool) -> Result<(), Failure> {
    let spec = parse_spec(name)?;
    let model = spec.info().map_err(of_spec)?;
    if json {
        return print_json(&in_json(model));
    }
    let declared = spec.declares().map_err(of_spec)?;
    let mut text = format!(
        "{}: {}\n\nSource: {}\n",
        model.name, model.summary, model.paper
    );
    if !model.parameters.is_empty() {
        text += "\nParameters\n";
    }
    let width = model
        .parameters
        .iter()
        .map(|p| p.name.len())
        .max()
        .unwrap_or(0);
    for parameter in model.parameters {
        let value = spec
            .value(parameter.name)
            .map_or("none".into(), |v| v.to_string());
        text += &format!(
            "  {:width$}  {}\n  {:width$}  {}; here {value}\n",
            parameter.name,
            parameter.meaning,
            "",
            parameter.expected()
        );
    }
    text += "\nDeclared\n";
    for (holds, property) in [
        (declared.reciprocal, "reciprocal"),
        (declared.energy_conserving, "energy-conserving"),
        (declared.isotropic, "isotropic"),
    ] {
        text += &format!("  {}{property}\n", if holds { "" } else { "not " });
    }
    text += &format!("\nCheck it: gonio brdf check {spec}\n");
    print(&text);
    Ok(())
}

fn in_json(model: &ModelInfo) -> serde_json::Value {
    let declared = ModelSpec::new(model.name)
        .map(|spec| (model.declares)(&spec))
        .ok();
    json!({
        "name": model.name,
        "summary": model.summary,
        "paper": model.paper,
        "aliases": model.aliases.iter().map(|a| a.name).collect::<Vec<_>>(),
        "parameters": model.parameters.iter().map(|p| json!({
            "name": p.name,
            "expected": p.expected(),
            "default": p.default_value().map(|v| v.to_string()),
            "meaning": p.meaning,
        })).collect::<Vec<_>>(),
        "declares": declared.map(|d| json!({
            "reciprocal": d.reciprocal,
            "energy_conserving": d.energy_conserving,
            "isotropic": d.isotropic,
        })),
    })
}

fn eval(text: &str, wi: Angles, wo: Angles, json: bool) -> Result<(), Failure> {
    let spec = parse_spec(text)?;
    let model: Model<f64, 3> = spec.build().map_err(of_spec)?;
    let (i, o) = (wi.direction(), wo.direction());
    let f = model.eval(i, o);
    let f_cos = model.eval_cos(i, o);
    let pdf = model.pdf(i, o);
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
            format!("{:.9}", c[0])
        } else {
            format!("{:.9}  {:.9}  {:.9}  (red, green, blue)", c[0], c[1], c[2])
        }
    };
    print(&format!(
        "{spec}\n  wi  θ = {}°, φ = {}°\n  wo  θ = {}°, φ = {}°\n  f            {} sr⁻¹\n  f · cosθi    {} sr⁻¹\n  \
         pdf(wi | wo) {pdf:.9} sr⁻¹",
        wi.theta_deg,
        wi.phi_deg,
        wo.theta_deg,
        wo.phi_deg,
        colour(f),
        colour(f_cos),
    ));
    if model.is_delta() {
        print("  all its light is in a Dirac delta, whose value at a pair of directions is 0");
    }
    Ok(())
}

fn check(text: &str, effort: Effort, json: bool) -> Result<(), Failure> {
    let specs = if text == "all" {
        gonio_brdf::showcase()
    } else {
        vec![parse_spec(text)?]
    };
    let bar = ProgressBar::new(specs.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:32.cyan/dim} {pos}/{len} {msg}") {
        bar.set_style(style.progress_chars("━━─"));
    }
    let mut reports: Vec<Report> = Vec::new();
    for spec in &specs {
        bar.set_message(spec.to_string());
        bar.tick();
        let report = gonio_brdf::check(spec, effort).map_err(of_spec)?;
        if !json {
            bar.suspend(|| print(&format!("{report}\n")));
        }
        reports.push(report);
        bar.inc(1);
    }
    bar.finish_and_clear();
    if json {
        print_json(&reports)?;
    }
    let failed: Vec<&str> = reports
        .iter()
        .filter(|r| !r.passed())
        .map(|r| r.subject.as_str())
        .collect();
    if failed.is_empty() {
        if !json && reports.len() > 1 {
            print(&format!("{} reflection functions passed", reports.len()));
        }
        Ok(())
    } else {
        Err(Failure::verification(format!(
            "not as declared: {}",
            failed.join(", ")
        )))
    }
}

fn parse_spec(text: &str) -> Result<ModelSpec, Failure> {
    ModelSpec::parse(text).map_err(of_spec)
}

fn of_spec(error: gonio_brdf::BrdfError) -> Failure {
    Failure::usage(chain(&error))
        .with_help("'gonio brdf list' names the models, 'gonio brdf show NAME' their parameters")
}
