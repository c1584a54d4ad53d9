//! The book's page on the instrument's own calibration.

use gonio_verify::specimen::{Calibration, Caught, broken, right};
use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

/// What the last calibration found.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct Found {
    /// Short suites.
    pub short: Calibration,
    /// Suites of quick effort.
    pub quick: Calibration,
}

/// The file of [`Found`].
pub fn found_file() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/calibration.json"))
}

/// The page's file.
pub fn page_file() -> PathBuf {
    PathBuf::from(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../book/src/calibration.md"
    ))
}

/// The page, with each fault looked at anew.
///
/// # Errors
/// A fault that isn't caught by its property, or a file that can't be read: a page cannot have it.
pub fn page() -> Result<String, Box<dyn Error>> {
    let found: Found = serde_json::from_str(&fs::read_to_string(found_file())?)?;
    let mut text = String::from(
        "# Is the instrument right?\n\n\
         <!-- Written by `cargo run --release -p gonio-verify --example calibrate`; a test holds it true. -->\n\n\
         A verifier is trusted as far as its own errors are known. There are two kinds: it may blame what is right, and it may pass what is \
         wrong. `gonio brdf check --self-test` measures both on your machine.\n\n",
    );
    alarms(&mut text, &found)?;
    faults(&mut text)?;
    Ok(text)
}

/// How often what is right was blamed.
fn alarms(text: &mut String, found: &Found) -> std::fmt::Result {
    let of_each = found.short.runs / right().len() as u64;
    write!(
        text,
        "## What is right passes\n\nA suite is one check of all properties. {} suites over {} right functions, each with a seed of its own: \
         {} of them failed. With a confidence of 95 % a suite fails what is right with a probability below {} (Clopper and Pearson \
         1934).\n\n\
         | suites | number | false alarms | rate below | p-values under 0.01 | median p-value |\n|---|---|---|---|---|---|\n",
        found.short.runs,
        right().len(),
        found.short.failures(),
        scientific(found.short.upper_bound()),
    )?;
    for (name, c) in [("short", &found.short), ("quick effort", &found.quick)] {
        let [count, small] = c.p_count;
        writeln!(
            text,
            "| {name} | {} | {} | {} | {small} of {count} | {:.3} |",
            c.runs,
            c.failures(),
            scientific(c.upper_bound()),
            c.p_median
        )?;
    }
    write!(
        text,
        "\nShort suites make the tests of every effort with fewer looks, at the same designed rate: each of the four statistical verdicts \
         fails by chance with a probability of 1e-6 at most, all others never, their bounds being above what rounding and quadrature \
         make. The p-values are those of the χ² test: were they too often small, it would give false alarms; their median may be \
         above 1/2 a little, since each difference is shortened by the error of the quadrature.\n\nThe functions, {of_each} short suites \
         each:\n\n"
    )?;
    for specimen in right() {
        let alarms = |c: &Calibration| {
            let own = c.alarms.iter().filter(|(name, ..)| name == specimen.name);
            own.count()
        };
        let count = alarms(&found.short) + alarms(&found.quick);
        match count {
            0 => writeln!(text, "- {}", specimen.name)?,
            n => writeln!(text, "- {}: {n} false alarms", specimen.name)?,
        }
    }
    Ok(())
}

/// What is wrong, and what catches it.
fn faults(text: &mut String) -> Result<(), Box<dyn Error>> {
    let all = broken();
    write!(
        text,
        "\n## What is wrong is caught\n\n{} functions with one fault each, of the kinds that renderers have had, and the property that \
         must catch it, with quick effort. Others may see the same fault.\n\n\
         | fault | caught by | figure | bound | others that see it |\n|---|---|---|---|---|\n",
        all.len()
    )?;
    for specimen in all {
        let caught = Caught::of(&specimen)?;
        let verdict = caught.verdict().filter(|_| caught.as_it_should_be());
        let Some(v) = verdict else {
            return Err(format!("not caught: {}\n{}", specimen.name, caught.report).into());
        };
        let others: Vec<&str> = caught.others().iter().map(|p| p.name()).collect();
        let (figure, bound) = match v.p_value {
            Some(p) if p < 1e-12 => ("p < 1e-12".into(), format!("≥ {}", short(v.bound))),
            Some(p) => (format!("p = {}", short(p)), format!("≥ {}", short(v.bound))),
            None => (short(v.figure), format!("≤ {}", short(v.bound))),
        };
        writeln!(
            text,
            "| {} | {} | {figure} | {bound} | {} |",
            specimen.name.replace('|', "\\|"),
            v.property,
            others.join(", ")
        )?;
    }
    Ok(())
}

/// Three digits after the first figure of what is far from 1, four places near it.
fn short(x: f64) -> String {
    match x.abs() {
        a if a == 0.0 || a.is_infinite() => format!("{x}"),
        a if (1e-3..1e4).contains(&a) => {
            let text = format!("{x:.4}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        _ => scientific(x),
    }
}

/// Two digits and an exponent.
fn scientific(x: f64) -> String {
    format!("{x:.1e}").replace(".0e", "e")
}
