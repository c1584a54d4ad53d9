//! A page that one can read, send and keep: one file, without scripts, fonts or pictures from elsewhere.

use crate::diagram::diagram;
use crate::text::{certainty, escaped, figure, number, outcome};
use crate::{Document, Section};
use gonio_verify::{Effort, Outcome, Property, Verdict, Witness};

const STYLE: &str = include_str!("style.css");

/// The verdicts as a page of HTML, with the figures, the bounds and how sure they are, the witnesses with their directions drawn,
/// the plots, and the command that gives the same again.
///
/// The page needs nothing else: no network, no scripts. It has colours for light and dark, for paper, and for a narrow screen.
/// The same document gives the same bytes.
pub fn html(document: &Document) -> String {
    let sections = &document.sections;
    let passed = document.passed();
    let title = match sections.as_slice() {
        [one] => one.report.subject.clone(),
        many => format!("{} reflection functions", many.len()),
    };
    let (word, class) = if passed {
        ("PASS", "pass")
    } else {
        ("FAIL", "fail")
    };
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{word} · {0}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<header class=\"verdict\">\n\
         <span class=\"badge stamp {class}\">{word}</span>\n<div><p class=\"kicker\">Gonio · is this reflectance right?</p>\n\
         <h1>{0}</h1>\n<p class=\"lead\">{1}</p></div>\n</header>\n",
        escaped(&title),
        lead(document),
    );
    match sections.as_slice() {
        [one] => page += &format!("<section>\n{}</section>\n", body(one)),
        many => {
            page += &contents(many);
            for (k, section) in many.iter().enumerate() {
                let open = if section.report.passed() {
                    ""
                } else {
                    " open=\"\""
                };
                page += &format!(
                    "<section id=\"f{k}\">\n<details{open}>\n<summary>{}<h2>{}</h2></summary>\n{}</details>\n</section>\n",
                    badge(section),
                    escaped(&section.report.subject),
                    body(section)
                );
            }
        }
    }
    page += &format!(
        "<h3>The same again</h3>\n<pre class=\"card\">{}</pre>\n<footer>Made by Gonio {}. Directions: ωi points to the light, ωr to the \
         viewer, both leave the surface; the normal n is +z; f is in sr⁻¹, without the cosine. The random numbers follow from the \
         seed: the same command gives the same page.</footer>\n</main>\n</body>\n</html>\n",
        escaped(&document.command),
        escaped(&document.version),
    );
    page
}

/// The verdict in a sentence.
fn lead(document: &Document) -> String {
    if let [one] = document.sections.as_slice() {
        let verdicts = &one.report.verdicts;
        let named = |o: Outcome| {
            let names: Vec<&str> = verdicts
                .iter()
                .filter(|v| v.outcome == o)
                .map(|v| v.property.name())
                .collect();
            names.join(", ")
        };
        let judged = verdicts
            .iter()
            .filter(|v| !matches!(v.outcome, Outcome::NotApplicable | Outcome::Information))
            .count();
        let mut text = match one.report.failures().count() {
            0 => format!(
                "It is as it declares: none of the {judged} properties that apply is violated."
            ),
            1 => format!(
                "One of the {judged} properties that apply fails: {}.",
                named(Outcome::Fail)
            ),
            n => format!(
                "{n} of the {judged} properties that apply fail: {}.",
                named(Outcome::Fail)
            ),
        };
        let declared = named(Outcome::Declared);
        if !declared.is_empty() {
            text = text.replace("none of", "of").replace(
                "is violated",
                &format!("only what it declares to lack is violated ({declared})"),
            );
        }
        let allowed = named(Outcome::Allowed);
        if !allowed.is_empty() {
            text += &format!(" Violated, but allowed: {allowed}.");
        }
        return escaped(&text);
    }
    let failed: Vec<&str> = document
        .sections
        .iter()
        .filter(|s| !s.report.passed())
        .map(|s| s.report.subject.as_str())
        .collect();
    match failed.len() {
        0 => "All are as they declare.".into(),
        1 => format!("One is not as it declares: {}.", escaped(failed[0])),
        n => format!(
            "{n} are not as they declare: {}.",
            escaped(&failed.join(", "))
        ),
    }
}

fn class(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Pass => "pass",
        Outcome::Fail => "fail",
        Outcome::Declared | Outcome::Allowed => "declared",
        Outcome::Information | Outcome::NotApplicable => "none",
    }
}

fn mark(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Pass => "✓",
        Outcome::Fail => "✗",
        Outcome::Declared | Outcome::Allowed => "!",
        Outcome::Information => "·",
        Outcome::NotApplicable => "–",
    }
}

fn badge(section: &Section) -> &'static str {
    match section.report.passed() {
        true => "<span class=\"badge pass\">PASS</span>",
        false => "<span class=\"badge fail\">FAIL</span>",
    }
}

/// One line a reflection function.
fn contents(sections: &[Section]) -> String {
    let mut rows = String::new();
    for (k, s) in sections.iter().enumerate() {
        let failed: Vec<&str> = s.report.failures().map(|v| v.property.name()).collect();
        rows += &format!(
            "<tr><td>{}</td><td><a href=\"#f{k}\">{}</a></td><td class=\"small\">{}</td></tr>\n",
            badge(s),
            escaped(&s.report.subject),
            escaped(&failed.join(", "))
        );
    }
    format!(
        "<h3>Reflection functions</h3>\n<div class=\"card\"><table class=\"contents\"><tbody>\n{rows}</tbody></table></div>\n"
    )
}

fn body(section: &Section) -> String {
    let mut out = String::new();
    if !section.plots.is_empty() {
        out += "<h3>What it looks like</h3>\n<div class=\"plots\">\n";
        for plot in &section.plots {
            out += &format!(
                "<figure class=\"card\">{}<figcaption>{}</figcaption></figure>\n",
                plot.svg,
                escaped(&plot.caption)
            );
        }
        out += "</div>\n";
    }
    out += "<h3>Verdicts</h3>\n<div class=\"card\"><table class=\"verdicts\">\n<thead><tr><th>Property</th><th>Outcome</th>\
            <th class=\"number\">Figure</th><th class=\"number\">Bound</th><th>What was found, and how sure it is</th></tr></thead>\n<tbody>\n";
    for v in &section.report.verdicts {
        out += &row(v);
    }
    out += "</tbody>\n</table></div>\n";
    out += &witnesses(section);
    out += &facts(section);
    out
}

fn row(v: &Verdict) -> String {
    let mut found = format!(
        "{}<p>{}</p>",
        meaning(v.property),
        escaped(&sentence(&v.detail))
    );
    let sure = certainty(v);
    if !sure.is_empty() {
        found += &format!("<p>{}</p>", escaped(&sentence(&sure)));
    }
    if let Some(note) = &v.note {
        found += &format!("<p>Note: {}</p>", escaped(note));
    }
    let (numbers, bound) = match v.outcome {
        Outcome::NotApplicable => ("–".into(), "–".into()),
        _ => (figure(v), number(v.bound)),
    };
    format!(
        "<tr><th scope=\"row\">{}</th><td class=\"outcome {}\"><b>{} {}</b></td><td class=\"number\" data-label=\"figure\">{numbers}</td>\
         <td class=\"number\" data-label=\"bound\">{bound}</td><td class=\"small\">{found}</td></tr>\n",
        escaped(v.property.name()),
        class(v.outcome),
        mark(v.outcome),
        outcome(v.outcome),
    )
}

/// With a capital letter, if it begins with a word of small Latin letters: `f` and `wi` are symbols.
fn sentence(text: &str) -> String {
    let word: String = text.chars().take_while(char::is_ascii_alphabetic).collect();
    let symbol = ["f", "wi", "wo", "pdf", "weight"].contains(&word.as_str());
    match text.chars().next() {
        Some(c) if c.is_ascii_lowercase() && !symbol => {
            c.to_ascii_uppercase().to_string() + &text[1..]
        }
        _ => text.into(),
    }
}

/// What holds if the property does.
fn meaning(property: Property) -> &'static str {
    match property {
        Property::Finite => {
            "No value is NaN or infinite, whatever the directions and random numbers."
        }
        Property::NonNegative => "f, pdf and weight are never below 0.",
        Property::Horizon => {
            "What only reflects is exactly 0 below the horizon, and draws nothing there."
        }
        Property::Reciprocity => "f(ωi→ωr) = f(ωr→ωi).",
        Property::EnergyConservation => {
            "No more is reflected than arrives: the directional albedo is at most 1."
        }
        Property::Isotropy => "Turning both directions about the normal changes nothing.",
        Property::Linearity => "f is the sum of its parts.",
        Property::PdfIntegral => "∫ pdf is the share of draws that give a direction.",
        Property::SampleDensity => "Drawn directions are distributed as pdf says (χ²).",
        Property::SampleWeight => {
            "weight = f cosθi / pdf, and every direction that reflects can be drawn."
        }
        Property::Continuity => "f cosθi falls to 0 as the light sinks to the horizon.",
        Property::EnergyLoss => "How far the directional albedo falls short of 1.",
        Property::SinglePrecision => "The same function in single precision gives the same values.",
        Property::Declarations => "What is declared as lacking is lacking.",
    }
}

/// The worst place of each property that is violated.
fn witnesses(section: &Section) -> String {
    let mut out = String::new();
    for v in &section.report.verdicts {
        if !v.violated() {
            continue;
        }
        let Some(w) = &v.witness else { continue };
        out += &format!(
            "<article class=\"card witness\">\n{}<div><h4 class=\"{}\">{} {}</h4><p class=\"small\">{}</p>\n<table><tbody>\n{}</tbody></table></div>\n</article>\n",
            diagram(w).unwrap_or_default(),
            class(v.outcome),
            mark(v.outcome),
            escaped(v.property.name()),
            escaped(&sentence(&v.detail)),
            values(w)
        );
    }
    match out.is_empty() {
        true => out,
        false => format!("<h3>Where it is worst</h3>\n{out}"),
    }
}

fn values(w: &Witness) -> String {
    let mut rows = String::new();
    let mut add = |name: &str, value: String| {
        rows += &format!(
            "<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n",
            escaped(name),
            escaped(&value)
        );
    };
    if let Some(wi) = &w.wi {
        add("ωi, to the light", wi.to_string());
    }
    add("ωr, to the viewer", w.wo.to_string());
    if let Some([a, b, c]) = w.u {
        add("random numbers", format!("{a:?}, {b:?}, {c:?}"));
    }
    for value in &w.values {
        // All digits: a witness is there to be reproduced.
        let digits = match value.value == 0.0 {
            true => "0".into(),
            false => format!("{:?}", value.value),
        };
        add(&value.name, digits);
    }
    rows
}

fn facts(section: &Section) -> String {
    let report = &section.report;
    let expectation = &section.expectation;
    let declares: Vec<String> = [
        (expectation.reciprocal, "reciprocal"),
        (expectation.energy_conserving, "energy-conserving"),
        (expectation.isotropic, "isotropic"),
    ]
    .into_iter()
    .map(|(holds, name)| format!("{}{name}", if holds { "" } else { "not " }))
    .collect();
    let effort = match report.effort {
        Effort::Quick => "quick",
        Effort::Standard => "standard",
        Effort::Thorough => "thorough",
    };
    let evaluations: u64 = report.verdicts.iter().map(|v| v.samples).sum();
    let mut pairs = vec![("Function".to_owned(), report.subject.clone())];
    pairs.extend(section.facts.iter().cloned());
    pairs.extend([
        ("Declared".to_owned(), declares.join(", ")),
        (
            "Effort".to_owned(),
            format!("{effort}, {evaluations} evaluations"),
        ),
        ("Seed".to_owned(), format!("“{}”", report.seed_name)),
    ]);
    let items: String = pairs
        .iter()
        .map(|(name, value)| format!("<dt>{}</dt><dd>{}</dd>\n", escaped(name), escaped(value)))
        .collect();
    format!("<h3>What was checked</h3>\n<dl class=\"card\">\n{items}</dl>\n")
}
