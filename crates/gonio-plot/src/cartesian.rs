//! The Cartesian plot: the value against the angle of reflection.

use crate::canvas::{Canvas, INK, Look, Stroke};
use crate::chart::{self, Steps};
use crate::curves::{Curve, Curves};
use crate::figure::{self, Figure, MARGIN, Place};
use crate::options::Channel;
use crate::scale::{ScaleKind, number};
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
        [1000.0, 760.0]
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
    let mut y_words = format!("{} in sr⁻¹", options.quantity());
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
                // What lies under the axis is not drawn as if it were on it.
                for piece in line.split(|p| p[1] >= bottom - 1e-9 && curves.scale.low > 0.0) {
                    if piece.len() > 1 {
                        canvas.line(piece, *stroke);
                    }
                }
            }
        }
    }
    for curve in curves.all.iter().filter(|c| chosen(c)) {
        for (t, share) in &curve.spikes {
            let colour = match options.channel {
                Channel::Rgb => INK,
                _ => curve.strokes[0].0.colour,
            };
            let tip = top + 0.16 * h;
            let stroke = Stroke::new(colour, 2.4);
            canvas.arrow([across(*t), bottom], [across(*t), tip], 12.0, stroke);
            let look = Look::LABEL.centred().rimmed().bold().coloured(colour);
            let words = number(options.channel.value(*share));
            canvas.text(&words, [across(*t), tip - 10.0], look);
        }
    }
}
