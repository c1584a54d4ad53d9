//! The pictures of a report.

use crate::cli::failure::Failure;
use gonio_brdf::{Brdf, Model};
use gonio_num::Vec3;
use gonio_plot::{Draw, Figure, Function, Options, PlotError};
use gonio_report::Plot;
use gonio_verify::Reflection;

/// Width and height of a picture: two stand side by side on a page, and their words are to be read there.
const SIZE: [u32; 2] = [560, 400];

/// A model of the registry, with its Dirac deltas.
pub(super) fn of_model(
    name: &str,
    model: &Model<f64, 3>,
    relative_ior: Option<[f64; 3]>,
) -> Result<Vec<Plot>, Failure> {
    let function = Function::new(name, |wi, wo| model.eval(wi, wo)).with_discrete(|wo, u| {
        let s = model.sample(wo, u);
        (s.pdf > 0.0 && s.delta).then_some(Draw {
            wi: s.wi,
            weight: s.weight,
            probability: s.pdf,
        })
    });
    of(function, relative_ior, "")
}

/// A function that is asked in batches. What it can't answer is missing in the pictures; the one who asked knows why.
pub(super) fn of_reflection(name: &str, reflection: &dyn Reflection) -> Result<Vec<Plot>, Failure> {
    let function = Function::batched(name, |pairs| {
        let (wi, wo): (Vec<Vec3<f64>>, Vec<Vec3<f64>>) =
            pairs.iter().map(|[i, o]| (*i, *o)).unzip();
        let mut f = vec![[0.0; 3]; pairs.len()];
        match reflection.eval(&wi, &wo, &mut f) {
            Ok(()) => f,
            Err(_) => Vec::new(),
        }
    });
    of(
        function,
        reflection.relative_ior(),
        " Dirac deltas are not drawn.",
    )
}

fn of(
    function: Function,
    relative_ior: Option<[f64; 3]>,
    more: &str,
) -> Result<Vec<Plot>, Failure> {
    let function = match relative_ior {
        Some(ior) => function.transmitting(ior),
        None => function,
    };
    let functions = [function];
    let options = Options {
        size: Some(SIZE),
        ..Options::default()
    };
    let mut plots = Vec::new();
    for (figure, caption) in [
        (
            gonio_plot::polar(&functions, &options),
            "The lobes in the plane of incidence. Light comes from the left, at the angle from the normal.",
        ),
        (
            gonio_plot::albedo(&functions, &options),
            "The directional albedo: the fraction of a beam that is reflected, against its angle. Above 1 a surface would give more than it gets.",
        ),
    ] {
        match figure {
            Ok(figure) => plots.push(plot(&figure, caption, more)),
            // A picture that shows nothing is left out.
            Err(PlotError::Nothing { .. }) => {}
            Err(e) => return Err(e.into()),
        }
    }
    Ok(plots)
}

fn plot(figure: &Figure, caption: &str, more: &str) -> Plot {
    let notes: String = figure.notes().iter().map(|n| format!(" {n}")).collect();
    Plot {
        caption: format!("{caption}{more}{notes}"),
        svg: figure.svg().into(),
    }
}
