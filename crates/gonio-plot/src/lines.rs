//! Lines that somebody else has computed, on two axes.

use crate::canvas::{Canvas, INK, PALETTE, Stroke};
use crate::chart;
use crate::curves::CHANNELS;
use crate::figure::{self, Entry, Figure, MARGIN, dash};
use crate::scale::{Scale, ScaleKind, number};
use crate::{Options, PlotError};

/// A line through points.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// What it shows, for the legend.
    pub name: String,
    /// (x, y), by rising x. A point that is not finite, or not above 0 on a logarithmic axis, leaves a gap.
    pub points: Vec<[f64; 2]>,
}

/// What the axes of [`lines`] mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Axes<'a> {
    /// Words below the title.
    pub subtitle: &'a str,
    /// What the horizontal axis shows, with its unit.
    pub x: &'a str,
    /// Its ends, low < high.
    pub x_ends: [f64; 2],
    /// Between its labels, > 0.
    pub x_step: f64,
    /// What the vertical axis shows, with its unit.
    pub y: &'a str,
    /// Whether the first three lines are the red, green and blue channel of one thing, and drawn so.
    pub channels: bool,
}

/// Lines over one axis. Of the options size, title and scale count; an automatic scale is in proportion.
///
/// # Errors
/// [`PlotError::Count`] unless there are 1 to 8 lines; [`PlotError::Option`], also for ends and steps that make no axis.
pub fn lines(lines: &[Line], axes: &Axes<'_>, options: &Options) -> Result<Figure, PlotError> {
    options.check(lines.len())?;
    let [low, high] = axes.x_ends;
    let steps = (high - low) / axes.x_step;
    if !(high > low && axes.x_step > 0.0 && steps.is_finite() && steps < 200.0) {
        return Err(PlotError::Option {
            option: "x axis",
            found: format!("{low} to {high} in steps of {}", axes.x_step),
            expected: "two different ends, and fewer than 200 steps".into(),
        });
    }
    let shown = |[x, y]: &[f64; 2]| {
        let above = *y > 0.0 || options.scale != ScaleKind::Log;
        x.is_finite() && y.is_finite() && above && (low..=high).contains(x)
    };
    let values = || {
        lines
            .iter()
            .flat_map(|l| l.points.iter().filter(|p| shown(p)))
    };
    let most = values().map(|p| p[1]).fold(0.0, f64::max);
    let positive = values().map(|p| p[1]).filter(|y| *y > 0.0);
    let scale = Scale::new(
        options.scale,
        positive.fold(f64::INFINITY, f64::min),
        most,
        false,
    );
    let size = options.page_size([860.0, 500.0]);
    let canvas = Canvas::new(size);
    let strokes: Vec<Stroke> = (0..lines.len()).map(|k| stroke(axes.channels, k)).collect();
    let legend: Vec<Entry> = lines
        .iter()
        .zip(&strokes)
        .map(|(line, stroke)| Entry::line(*stroke, &line.name))
        .collect();
    let title = options.title.as_deref().unwrap_or("");
    let [x, y, w, h] = figure::header(&canvas, title, axes.subtitle);
    let key = figure::legend_width(&legend, 0.34 * w);
    figure::legend(&canvas, [x + w - key, y + 14.0], key, &legend);
    let room = [x, y, w - key - MARGIN, h];
    let place = chart::numbers(
        &canvas,
        room,
        (axes.x_ends, axes.x_step, axes.x),
        (&scale, axes.y),
    );
    let [left, top, width, height] = place;
    for (line, stroke) in lines.iter().zip(&strokes) {
        for piece in line.points.split(|p| !shown(p)) {
            let at = |[x, y]: &[f64; 2]| {
                [
                    left + width * (x - low) / (high - low),
                    top + height * (1.0 - scale.position(*y)),
                ]
            };
            let corners: Vec<[f64; 2]> = piece.iter().map(at).collect();
            if corners.len() > 1 {
                canvas.line(&corners, *stroke);
            }
        }
    }
    let mut words = format!("{} against {}.", axes.y, axes.x);
    for line in lines {
        if let (Some(first), Some(last)) = (
            line.points.iter().find(|p| shown(p)),
            line.points.iter().rfind(|p| shown(p)),
        ) {
            let [a, b] = [first, last].map(|p| format!("{} at {}", number(p[1]), number(p[0])));
            words += &format!(" {}: {a}, {b}.", line.name);
        }
    }
    Ok(Figure::new(canvas, title, &words, Vec::new()))
}

fn stroke(channels: bool, k: usize) -> Stroke {
    if channels {
        // Each is seen under the next where they are the same.
        return match CHANNELS.get(k) {
            Some((colour, _)) => Stroke::new(*colour, [4.0, 2.6, 1.3][k]),
            None => Stroke {
                dash: dash(k - 2),
                ..Stroke::new(INK, 1.3)
            },
        };
    }
    Stroke {
        dash: dash(k),
        ..Stroke::new(PALETTE[k % PALETTE.len()], 1.8)
    }
}
