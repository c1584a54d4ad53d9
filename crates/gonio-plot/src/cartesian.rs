//! The Cartesian plot: the value against the angle of reflection.

use crate::canvas::{Canvas, INK, Look, Stroke};
use crate::chart::{self, Steps};
use crate::curves::{Curve, Curves};
use crate::figure::{self, Figure, MARGIN, Place};
use crate::options::Channel;
use crate::scale::{ScaleKind, number};
use crate::trace::FLATNESS;
use crate::{Function, Options, PlotError, font};

/// The values of functions against the angle of reflection θr in the plane of incidence.
///
/// Angles are negative on the side that the light comes from; for what transmits, those beyond 90° are below the surface. The rest is as in
/// [`polar`](crate::polar()), but that an automatic scale becomes logarithmic where a linear one shows nothing.
///
/// # Errors
/// [`PlotError::Count`] unless there are 1 to 8 functions; [`PlotError::Option`].
pub fn cartesian(functions: &[Function], options: &Options) -> Result<Figure, PlotError> {
    options.check(functions.len())?;
    let usual: &[f64] = if functions.len() == 1 {
        &[0.0, 30.0, 60.0, 80.0]
    } else {
        &[30.0, 60.0]
    };
    let thetas = options.thetas(usual);
    let several = options.channel == Channel::Rgb && functions.len() > 1;
    let size = options.page_size(if several {
        figure::page_of_panels(functions.len(), 1.5)
    } else {
        [860.0, 500.0]
    });
    let transmits = functions.iter().any(Function::transmits);
    let end = if transmits { 180.0 } else { 90.0 };
    let curves = Curves::new(
        functions,
        options,
        &thetas,
        &|scale, t, x| {
            let across = (t + end) / (2.0 * end);
            [size[0] * across, -size[1] * scale.position(x)]
        },
        ScaleKind::Log,
    );
    let canvas = Canvas::new(size);
    let title = figure::title(functions, options);
    let mut notes: Vec<String> = figure::gaps_note(curves.gaps()).into_iter().collect();
    notes.extend(curves.beyond_note(options));
    if curves.discrete() {
        notes.push(
            "Arrow: a Dirac delta, a discrete direction with the share of the light that goes there."
                .into(),
        );
    }
    let mut subtitle = "In the plane of incidence; dotted: the mirror direction".to_owned();
    if options.phi_deg != 0.0 {
        subtitle += &format!("; φ = {}°", number(options.phi_deg));
    }
    let place = figure::header(&canvas, &title, &subtitle);
    let [x, y, w, h] = figure::footer(&canvas, place, &notes);
    let key = figure::legend_width(&curves.legend, 0.34 * w);
    figure::legend(&canvas, [x + w - key, y + 14.0], key, &curves.legend);
    let room = [x, y, w - key - MARGIN, h];
    if several {
        let places = figure::panels(room, functions.len(), 1.5, 14.0);
        for (k, (f, [x, y, w, h])) in functions.iter().zip(places).enumerate() {
            let look = Look {
                down: -1,
                ..Look::LABEL.bold()
            };
            canvas.text(&font::fitted(&f.name, look.size, true, w), [x, y], look);
            panel(
                &canvas,
                [x, y + 18.0, w, h - 18.0],
                &curves,
                end,
                |c| c.function == k,
                options,
            );
        }
    } else {
        panel(&canvas, room, &curves, end, |_| true, options);
    }
    let words = format!(
        "{} in sr⁻¹ against the angle of reflection in the plane of incidence.{}",
        options.quantity(),
        curves.in_words(functions, options)
    );
    Ok(Figure::new(canvas, &title, &words, notes))
}

fn panel(
    canvas: &Canvas,
    place: Place,
    curves: &Curves,
    end: f64,
    chosen: impl Fn(&Curve) -> bool,
    options: &Options,
) {
    let wide = place[2] > 420.0;
    let x = Steps {
        low: -end,
        high: end,
        step: if wide && end < 100.0 { 15.0 } else { 30.0 },
        fine: if wide && end < 100.0 { 5.0 } else { 15.0 },
    };
    let mut y_words = if curves.any() {
        format!("{} in sr⁻¹", options.quantity())
    } else {
        "share of the light".to_owned()
    };
    if options.channel != Channel::Rgb {
        y_words += &format!(", {}", options.channel.name());
    }
    if curves.scale.kind == ScaleKind::CubeRoot {
        y_words += ", cube root";
    }
    let x_words = if end > 100.0 {
        "angle θr (beyond 90°: inside)"
    } else {
        "angle of reflection θr"
    };
    let [left, top, w, h] = chart::axes(canvas, place, (&x, x_words), (&curves.scale, &y_words));
    let across = |t: f64| left + w * (t + end) / (2.0 * end);
    let bottom = top + h;
    let at = |t: f64, v: f64| [across(t), bottom - h * curves.scale.position(v)];
    for curve in curves.all.iter().filter(|c| chosen(c)) {
        if curve.theta < 90.0 {
            let colour = match options.channel {
                Channel::Rgb => INK,
                _ if curves.coloured_angles => curve.strokes[0].0.colour,
                _ => INK,
            };
            let look = Stroke {
                dash: "1 4",
                ..Stroke::new(colour, 1.0)
            };
            canvas.line(&[at(curve.theta, 0.0), [across(curve.theta), top]], look);
        }
        for (stroke, weights) in &curve.strokes {
            for line in curve.trace.lines(*weights, &at) {
                for piece in above_the_axis(&line, bottom) {
                    canvas.line(piece, *stroke);
                }
            }
        }
    }
    let mut spikes: Vec<_> = curves
        .all
        .iter()
        .filter(|c| chosen(c))
        .flat_map(|c| c.spikes.iter().map(move |spike| (c, *spike)))
        .collect();
    spikes.sort_by(|a, b| a.1.0.total_cmp(&b.1.0));
    for (k, (curve, (t, share))) in spikes.into_iter().enumerate() {
        let colour = match options.channel {
            Channel::Rgb => INK,
            _ => curve.strokes[0].0.colour,
        };
        let share = options.channel.value(share);
        // Beside curves an arrow's height means nothing, so labels take turns.
        let tip = if curves.any() {
            top + h * (0.12 + 0.07 * (k % 3) as f64)
        } else {
            bottom - h * curves.scale.position(share)
        };
        let stroke = Stroke::new(colour, 2.4);
        canvas.arrow([across(t), bottom], [across(t), tip], 12.0, stroke);
        let look = Look::LABEL.centred().rimmed().bold().coloured(colour);
        canvas.text(
            &number(share),
            [across(t), (tip - 10.0).max(top + 8.0)],
            look,
        );
    }
}

/// The pieces of a line that are above the axis, with the points where they come from it and go back: what lies under a logarithmic axis is
/// not drawn as if it were on it.
fn above_the_axis(line: &[[f64; 2]], bottom: f64) -> Vec<&[[f64; 2]]> {
    let above = |p: &[f64; 2]| p[1] < bottom - FLATNESS;
    let mut pieces = Vec::new();
    let mut first = None;
    for k in 0..line.len() {
        match (above(&line[k]), first) {
            (true, None) => first = Some(k.saturating_sub(1)),
            (false, Some(from)) => {
                pieces.push(&line[from..=k]);
                first = None;
            }
            _ => {}
        }
    }
    if let Some(from) = first {
        pieces.push(&line[from..]);
    }
    pieces
}
