//! `gonio brdf check --self-test`: is the instrument right?

use crate::cli::failure::Failure;
use crate::cli::terminal::{coloured, print};
use gonio_brdf::BrdfError;
use gonio_verify::specimen::{Caught, Specimen, broken, right};

/// Checks what is right and what has a known fault, and says of each what the check made of it.
pub(super) fn run() -> Result<(), Failure> {
    let mut wrong = Vec::new();
    for (title, specimens) in [
        ("What is right passes", right()),
        ("What is wrong is caught", broken()),
    ] {
        print(&format!("{title}\n"))?;
        for specimen in &specimens {
            let caught = Caught::of(specimen).map_err(BrdfError::from)?;
            print(&line(specimen, &caught))?;
            if !caught.as_it_should_be() {
                wrong.push(specimen.name);
            }
        }
        print("\n")?;
    }
    if wrong.is_empty() {
        return print("The instrument is right.");
    }
    let message = format!("the instrument errs on: {}", wrong.join("; "));
    Err(Failure::verification(message)
        .with_help("please report it, with this output and the kind of machine"))
}

/// A mark, what it is, and for a fault on the next line what catches it.
fn line(specimen: &Specimen, caught: &Caught) -> String {
    let (mark, style) = match caught.as_it_should_be() {
        true => ("✓", "32"),
        false => ("✗", "1;31"),
    };
    let mark = match coloured() {
        true => format!("\x1b[{style}m{mark}\x1b[0m"),
        false => mark.to_owned(),
    };
    let by = caught.verdict().map(|v| format!("\n      {}", v.property));
    let others: String = caught.others().iter().map(|p| format!(", {p}")).collect();
    format!(
        "  {mark} {}{}{others}",
        specimen.name,
        by.unwrap_or_default()
    )
}
