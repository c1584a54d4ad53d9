//! The chart of the directional albedo.

use crate::canvas::{Canvas, INK, Look, MUTED, PALETTE, Stroke};
use crate::chart::{self, Steps};
use crate::curves::{CHANNELS, direction};
use crate::figure::{self, Entry, Figure, MARGIN, dash};
use crate::integral::{self, Albedo};
use crate::options::{Channel, weighted};
use crate::scale::{Scale, ScaleKind, number};
use crate::trace::Trace;
use crate::{Function, Options, PlotError};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// The steepest angle, degrees.
const STEEPEST: f64 = 89.5;
/// Steps before refinement, and the finest ones, degrees.
const STEP: f64 = 4.0;
const FINEST: f64 = 0.5;
/// How far, in pixels, the curve may be from the one through all angles: half its width.
const FLATNESS: f64 = 0.4;

/// The directional albedo of functions against the angle θ of the viewer (by reciprocity: of a beam of light).
///
/// a(θ) = ∫ f cosθi dωi, the fraction of a beam that leaves the surface again; Dirac deltas are included, and for what transmits also what
/// passes to the other side (the part that is reflected is then drawn beside it, dashed). What is missing to 1 is lost; more than 1 isn't
/// physical. The quadrature's error is below 0.002 unless a note says otherwise.
///
/// # Errors
/// [`PlotError::Count`] unless there are 1 to 8 functions; [`PlotError::Option`].
pub fn albedo(functions: &[Function], options: &Options) -> Result<Figure, PlotError> {
    options.check(functions.len())?;
    let size = options.page_size([860.0, 480.0]);
    let weights = options.channel.weights();
    let all: Vec<Curves> = functions
        .iter()
        .map(|f| Curves::new(f, options, size))
        .collect();
    let highest = all.iter().map(|c| c.highest(weights)).fold(0.0, f64::max);
    // A little above 1 is not seen, and makes no axis to 1.5.
    let scale = match highest {
        x if x <= 1.002 => Scale::new(ScaleKind::Linear, 0.0, 1.0, false),
        x => Scale::new(ScaleKind::Linear, 0.0, x, false),
    };

    let canvas = Canvas::new(size);
    let title = figure::title(functions, options);
    let mut notes = Vec::new();
    for (f, c) in functions.iter().zip(&all) {
        if c.error > 2e-3 {
            let error = number(c.error);
            notes.push(format!(
                "{}: the quadrature's steps differ by up to {error}.",
                f.name
            ));
        }
    }
    notes.extend(figure::gaps_note(all.iter().map(|c| c.gaps).sum()));
    let mut subtitle =
        "Directional albedo: the fraction of light that leaves again; what is missing to 1 is lost"
            .to_owned();
    if options.phi_deg != 0.0 {
        subtitle += &format!("; φ = {}°", number(options.phi_deg));
    }
    let place = figure::header(&canvas, &title, &subtitle);
    let [x, y, w, h] = figure::footer(&canvas, place, &notes);
    let entries = legend(functions, options);
    let key = if entries.is_empty() {
        -MARGIN
    } else {
        figure::legend_width(&entries, 0.34 * w)
    };
    figure::legend(&canvas, [x + w - key, y + 14.0], key, &entries);
    let steps = Steps {
        low: 0.0,
        high: 90.0,
        step: 15.0,
        fine: 5.0,
    };
    let mut words = "directional albedo a(θ)".to_owned();
    if options.channel != Channel::Rgb {
        words += &format!(", {}", options.channel.name());
    }
    let room = [x, y, w - key - MARGIN, h];
    let inner = chart::axes(
        &canvas,
        room,
        (&steps, "angle θ from the normal"),
        (&scale, &words),
    );
    let [left, top, w, h] = inner;
    let at = |t: f64, v: f64| [left + w * t / 90.0, top + h * (1.0 - scale.position(v))];
    if let ([one], [weights]) = (&all[..], weights) {
        lost(&canvas, one, *weights, &at);
    }
    let one = [at(0.0, 1.0), at(90.0, 1.0)];
    canvas.line(&one, Stroke::new(INK, 1.4));
    for (k, c) in all.iter().enumerate() {
        for (j, w) in weights.iter().enumerate() {
            let stroke = stroke(functions.len(), options.channel, k, j);
            for line in c.total.lines(*w, &at) {
                canvas.line(&line, stroke);
            }
            if let Some(reflected) = &c.reflected {
                let dashed = Stroke {
                    dash: "5 3",
                    width: 1.4,
                    ..stroke
                };
                for line in reflected.lines(*w, &at) {
                    canvas.line(&line, dashed);
                }
            }
        }
    }
    let description = in_words(functions, &all, options);
    Ok(Figure::new(canvas, &title, &description, notes))
}

/// The albedo of a function by angle.
struct Curves {
    total: Trace,
    /// For what transmits.
    reflected: Option<Trace>,
    error: f64,
    gaps: usize,
}

impl Curves {
    fn new(f: &Function, options: &Options, size: [f64; 2]) -> Self {
        let known: RefCell<BTreeMap<u64, Albedo>> = RefCell::default();
        let at = |t: f64| {
            let known_already = known.borrow().get(&t.to_bits()).copied();
            known_already.unwrap_or_else(|| {
                let a = integral::albedo(f, direction(t, options.phi_deg));
                known.borrow_mut().insert(t.to_bits(), a);
                a
            })
        };
        let weights = options.channel.weights();
        let place = |t: f64, x: f64| [size[0] * t / 90.0, size[1] * x];
        let traced = |eval: &dyn Fn(&[f64]) -> Vec<[f64; 3]>| {
            let mut trace = Trace::new(eval, [0.0, STEEPEST], STEP, &[], FINEST);
            trace.refine(eval, weights, &place, FINEST, FLATNESS);
            trace
        };
        let total = traced(&|all| all.iter().map(|t| at(*t).total).collect());
        let reflected = f
            .transmits()
            .then(|| traced(&|all| all.iter().map(|t| at(*t).reflected).collect()));
        let known = known.into_inner();
        Self {
            total,
            reflected,
            error: known.values().map(|a| a.error).fold(0.0, f64::max),
            gaps: known.values().map(|a| a.gaps).sum(),
        }
    }

    fn highest(&self, weights: &[[f64; 3]]) -> f64 {
        self.total.peak(weights).map_or(0.0, |(_, x)| x)
    }
}

/// Shades what is missing to 1.
fn lost(canvas: &Canvas, c: &Curves, weights: [f64; 3], at: &dyn Fn(f64, f64) -> [f64; 2]) {
    for mut corners in c.total.lines(weights, &|t, x| at(t, x.min(1.0))) {
        corners.push(at(STEEPEST, 1.0));
        corners.push(at(0.0, 1.0));
        canvas.area(&corners, 0x6e7781, 0.12);
    }
    let deepest = c
        .total
        .points
        .iter()
        .map(|(t, colour)| (*t, weighted(weights, *colour)))
        .filter(|(t, x)| (8.0..80.0).contains(t) && x.is_finite())
        .min_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((t, x)) = deepest {
        let (middle, below) = (at(t, 0.5 * (1.0 + x)), at(t, x));
        if below[1] - at(t, 1.0)[1] > 26.0 {
            canvas.text("lost", middle, Look::LABEL.centred().coloured(MUTED));
        }
    }
}

fn stroke(functions: usize, channel: Channel, function: usize, part: usize) -> Stroke {
    let several = functions > 1;
    Stroke {
        colour: match channel {
            Channel::Rgb => CHANNELS[part].0,
            _ => PALETTE[function % PALETTE.len()],
        },
        width: 2.0,
        dash: if several { dash(function) } else { "" },
    }
}

fn legend(functions: &[Function], options: &Options) -> Vec<Entry> {
    let mut entries = Vec::new();
    if functions.len() > 1 {
        entries.push(Entry::heading("Function"));
        for (k, f) in functions.iter().enumerate() {
            let mut stroke = stroke(functions.len(), options.channel, k, 0);
            if options.channel == Channel::Rgb {
                stroke.colour = INK;
            }
            entries.push(Entry::line(stroke, &f.name));
        }
    }
    if options.channel == Channel::Rgb {
        entries.push(Entry::heading("Channel"));
        let lines = CHANNELS.map(|(colour, name)| Entry::line(Stroke::new(colour, 2.0), name));
        entries.extend(lines);
    }
    if functions.iter().any(Function::transmits) {
        let line = Stroke::new(INK, 2.0);
        entries.push(Entry::heading("Both sides"));
        entries.push(Entry::line(line, "reflected and transmitted"));
        entries.push(Entry::line(
            Stroke {
                dash: "5 3",
                width: 1.4,
                ..line
            },
            "reflected alone",
        ));
    }
    entries
}

fn in_words(functions: &[Function], all: &[Curves], options: &Options) -> String {
    let mut text = "Directional albedo against the angle from the normal.".to_owned();
    for (f, c) in functions.iter().zip(all) {
        text += &format!(" {}:", f.name);
        for wanted in [0.0, 45.0, 75.0] {
            let points = c.total.points.iter();
            let near = points.min_by(|a, b| (a.0 - wanted).abs().total_cmp(&(b.0 - wanted).abs()));
            if let Some((t, colour)) = near {
                let value = number(options.channel.value(*colour));
                text += &format!(" {value} at {}°,", number(*t));
            }
        }
        text.pop();
        text.push('.');
    }
    text
}
