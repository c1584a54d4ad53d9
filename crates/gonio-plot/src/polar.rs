//! The polar plot: lobes in the plane of incidence.

use crate::canvas::{Canvas, FAINT, GRID, INK, Look, MUTED, Stroke};
use crate::curves::{Curve, Curves};
use crate::figure::{self, Figure, MARGIN, Place};
use crate::options::Channel;
use crate::scale::{Scale, ScaleKind, number};
use crate::{Function, Options, PlotError};
use gonio_num::Real;

/// Room around the rim for the angles.
const RIM: f64 = 30.0;

/// The lobes of functions in the plane of incidence.
///
/// Light arrives at each angle of [`Options::theta_deg`] (0, 30, 60 and 80° for one function, 30 and 60° for more), from the left. The
/// distance of a curve from the centre is f in sr⁻¹ towards the direction of reflection at that angle, on an axis as
/// [`Options::scale`] says; with [`Options::cosine`] it is f |cosθr|, the shape of the intensity, which for a Lambertian surface is a
/// circle. A Dirac delta, whose value is none, is an arrow with the share of light that goes there. The lower half shows what passes to
/// the other side.
///
/// A curve is drawn to within a tenth of a pixel: it is evaluated where it bends, and in the neighbourhood of the mirror's, the refracted and
/// the light's own direction down to 0.002°.
///
/// # Errors
/// [`PlotError::Count`] unless there are 1 to 8 functions; [`PlotError::Option`].
pub fn polar(functions: &[Function], options: &Options) -> Result<Figure, PlotError> {
    options.check(functions.len())?;
    let usual: &[f64] = if functions.len() == 1 {
        &[0.0, 30.0, 60.0, 80.0]
    } else {
        &[30.0, 60.0]
    };
    let thetas = options.thetas(usual);
    let transmits = functions.iter().any(Function::transmits) || thetas.iter().any(|t| *t > 90.0);
    let several = options.channel == Channel::Rgb && functions.len() > 1;
    let size = options.page_size(match (several, transmits) {
        (true, below) => figure::page_of_panels(functions.len(), if below { 1.0 } else { 1.7 }),
        (_, true) => [820.0, 660.0],
        _ => [820.0, 470.0],
    });
    // Points are placed as on the largest circle that can be: curves are flat enough on a smaller one.
    let radius = 0.5 * size[0].max(size[1]);
    let curves = Curves::new(
        functions,
        options,
        &thetas,
        &|scale, t, x| on_circle([0.0, 0.0], t, radius * scale.position(x)),
        ScaleKind::CubeRoot,
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
    let place = figure::header(&canvas, &title, &subtitle(options, &curves));
    let [x, y, w, h] = figure::footer(&canvas, place, &notes);
    let key = figure::legend_width(&curves.legend, 0.34 * w);
    figure::legend(&canvas, [x + w - key, y + 14.0], key, &curves.legend);
    let room = [x, y, w - key - MARGIN, h];
    if several {
        let aspect = if transmits { 1.0 } else { 1.8 };
        let places = figure::panels(room, functions.len(), aspect, 14.0);
        for (k, (f, [x, y, w, h])) in functions.iter().zip(places).enumerate() {
            let look = Look {
                down: -1,
                ..Look::LABEL.bold()
            };
            canvas.text(
                &crate::font::fitted(&f.name, look.size, true, w),
                [x, y],
                look,
            );
            panel(
                &canvas,
                [x, y + 18.0, w, h - 18.0],
                &curves,
                transmits,
                |c| c.function == k,
                options,
            );
        }
    } else {
        panel(&canvas, room, &curves, transmits, |_| true, options);
    }
    let words = format!(
        "Polar plot of {} in sr⁻¹ in the plane of incidence.{}",
        options.quantity(),
        curves.in_words(functions, options)
    );
    Ok(Figure::new(canvas, &title, &words, notes))
}

fn subtitle(options: &Options, curves: &Curves) -> String {
    let mut text = String::new();
    if curves.any() {
        text += &format!("{} in sr⁻¹", options.quantity());
        match curves.scale.words() {
            "" => text += ", radius in proportion",
            words => text += &format!(", radius {words}"),
        }
        text += match options.channel {
            Channel::Luminance => "; luminance",
            Channel::Red => "; red",
            Channel::Green => "; green",
            Channel::Blue => "; blue",
            Channel::Rgb => "",
        };
    }
    if options.phi_deg != 0.0 {
        text += &format!("; plane of incidence at φ = {}°", number(options.phi_deg));
    }
    text.trim_start_matches("; ").to_owned()
}

/// The place at a distance from the centre, at an angle from the upward normal, clockwise.
fn on_circle(centre: [f64; 2], t: f64, radius: f64) -> [f64; 2] {
    let (sin, cos) = Real::sin_cos(t.to_radians());
    [centre[0] + radius * sin, centre[1] - radius * cos]
}

fn panel(
    canvas: &Canvas,
    [x, y, w, h]: Place,
    curves: &Curves,
    transmits: bool,
    chosen: impl Fn(&Curve) -> bool,
    options: &Options,
) {
    let below = 26.0;
    let radius = if transmits {
        (0.5 * w - RIM).min(0.5 * h - 0.8 * RIM)
    } else {
        (0.5 * w - RIM).min(h - 0.8 * RIM - below)
    }
    .max(20.0);
    let centre = if transmits {
        [x + 0.5 * w, y + 0.5 * h]
    } else {
        let spare = (h - radius - 0.8 * RIM - below).max(0.0);
        [x + 0.5 * w, y + 0.8 * RIM + radius + 0.4 * spare]
    };
    let round = Round {
        canvas,
        centre,
        radius,
        transmits,
    };
    round.grid(&curves.scale, curves.any());
    let chosen: Vec<&Curve> = curves.all.iter().filter(|c| chosen(c)).collect();
    let mut thetas: Vec<f64> = Vec::new();
    for curve in &chosen {
        if !thetas.contains(&curve.theta) {
            thetas.push(curve.theta);
            let own = curve.strokes[0].0.colour;
            round.light(
                curve.theta,
                if curves.coloured_angles { own } else { MUTED },
            );
        }
    }
    for curve in &chosen {
        round.curve(
            curve,
            &curves.scale,
            chosen.len() <= 4 && curve.strokes.len() == 1,
        );
    }
    round.surface();
    for curve in &chosen {
        round.spikes(curve, options.channel);
    }
    if curves.any() {
        round.values(&curves.scale);
    }
}

/// A circle, or its upper half, to draw in.
struct Round<'a> {
    canvas: &'a Canvas,
    centre: [f64; 2],
    radius: f64,
    transmits: bool,
}

impl Round<'_> {
    fn at(&self, t: f64, share: f64) -> [f64; 2] {
        on_circle(self.centre, t, self.radius * share)
    }

    fn end(&self) -> f64 {
        if self.transmits { 180.0 } else { 90.0 }
    }

    fn arc(&self, from: f64, to: f64, share: f64) -> Vec<[f64; 2]> {
        // An arc of angle a is r(1 − cos(a/2)) from its chord: a twentieth of a pixel at most.
        let step = (2.0 * Real::acos(1.0 - 0.05 / (self.radius * share).max(1.0))).to_degrees();
        let steps = ((to - from) / step).ceil().max(2.0) as usize;
        (0..=steps)
            .map(|k| self.at(from + (to - from) * k as f64 / steps as f64, share))
            .collect()
    }

    /// Rings of equal values, a spoke every 30° with its angle, a tick every 10°.
    fn grid(&self, scale: &Scale, values: bool) {
        let end = self.end();
        if self.transmits {
            self.canvas.area(&self.arc(90.0, 270.0, 1.0), 0xf3f6f9, 1.0);
        }
        for tick in scale.ticks() {
            if tick.position > 0.02 && (values || tick.position == 1.0) {
                let colour = if tick.label.is_empty() { FAINT } else { GRID };
                let ring = self.arc(-end, end, tick.position);
                self.canvas.line(&ring, Stroke::new(colour, 1.0));
            }
        }
        let tens = (end / 10.0) as i32;
        for k in -tens..=tens {
            if self.transmits && k == -tens {
                continue;
            }
            let t = f64::from(10 * k);
            let spoke = k % 3 == 0;
            let inner = if spoke { 0.0 } else { 1.0 - 5.0 / self.radius };
            let line = [self.at(t, inner), self.at(t, 1.0)];
            self.canvas.line(&line, Stroke::new(GRID, 1.0));
            if spoke {
                // From the nearer normal, outside or inside.
                let shown = if k.abs() > 9 { 18 - k.abs() } else { k.abs() };
                let words = format!("{}°", shown * 10);
                let at = self.at(t, 1.0 + 15.0 / self.radius);
                self.canvas.text(&words, at, Look::SMALL.centred());
            }
        }
    }

    /// Where the light comes from.
    fn light(&self, theta: f64, colour: u32) {
        let look = Stroke {
            dash: "1 4",
            ..Stroke::new(colour, 1.2)
        };
        let (rim, tip) = (self.at(-theta, 1.0), self.at(-theta, 0.9));
        self.canvas
            .line(&[self.at(-theta, 0.88), self.at(-theta, 0.0)], look);
        self.canvas.arrow(rim, tip, 9.0, Stroke::new(colour, 1.6));
    }

    fn curve(&self, curve: &Curve, scale: &Scale, filled: bool) {
        for (stroke, weights) in &curve.strokes {
            let place = |t: f64, x: f64| self.at(t, scale.position(x));
            for mut line in curve.trace.lines(*weights, &place) {
                // What only reflects ends at the horizon.
                if !self.transmits {
                    line.insert(0, self.centre);
                    line.push(self.centre);
                }
                if filled {
                    self.canvas.area(&line, stroke.colour, 0.06);
                }
                self.canvas.line(&line, *stroke);
            }
        }
    }

    fn spikes(&self, curve: &Curve, channel: Channel) {
        for (t, share) in &curve.spikes {
            let colour = match channel {
                Channel::Rgb => INK,
                _ => curve.strokes[0].0.colour,
            };
            let stroke = Stroke::new(colour, 2.4);
            self.canvas
                .arrow(self.centre, self.at(*t, 0.76), 12.0, stroke);
            let words = number(channel.value(*share));
            let at = self.at(*t, 0.76 + 16.0 / self.radius);
            let look = Look::LABEL.centred().rimmed().bold().coloured(colour);
            self.canvas.text(&words, at, look);
        }
    }

    /// The horizon and the normal.
    fn surface(&self) {
        let horizon = [self.at(-90.0, 1.0), self.at(90.0, 1.0)];
        self.canvas.line(&horizon, Stroke::new(INK, 1.4));
        if self.transmits {
            let [x, y] = self.at(90.0, 1.0);
            let look = Look::SMALL.right().rimmed();
            self.canvas.text("inside", [x - 6.0, y + 13.0], look);
        }
    }

    /// The values of the rings, below the horizon.
    fn values(&self, scale: &Scale) {
        let mut last = f64::INFINITY;
        for tick in scale.ticks().iter().rev().filter(|t| !t.label.is_empty()) {
            let [x, y] = self.at(-90.0, tick.position);
            let half = 0.5 * crate::font::width(&tick.label, Look::SMALL.size, false);
            let from_rim = self.centre[0] - x;
            if last - from_rim < half + 10.0 || (scale.low == 0.0 && tick.position == 0.0) {
                continue;
            }
            last = from_rim - half;
            let look = Look::SMALL.centred().rimmed();
            self.canvas.text(&tick.label, [x, y + 13.0], look);
        }
        if !self.transmits {
            let [x, y] = self.at(90.0, 1.0);
            self.canvas.text("sr⁻¹", [x, y + 13.0], Look::SMALL.right());
        }
    }
}
