//! Charts with two straight axes: plotters' mesh, at a place that is known to the pixel.

use crate::canvas::{
    Canvas, FAINT, GRID, INK, LABEL, MUTED, SMALL, Stroke, done, style, text_style, unit,
};
use crate::figure::Place;
use crate::scale::{Scale, number};
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::ChartBuilder;

/// Room for the labels left of a chart and below it.
pub(crate) const LEFT: f64 = 66.0;
pub(crate) const BELOW: f64 = 46.0;
/// Room for halves of labels above a chart and right of it.
pub(crate) const ABOVE: f64 = 8.0;
pub(crate) const RIGHT: f64 = 14.0;

/// A straight axis in whole steps.
pub(crate) struct Steps {
    pub low: f64,
    pub high: f64,
    /// Between lines with a label.
    pub step: f64,
    /// Between lines without.
    pub fine: f64,
}

impl Steps {
    fn values(&self, step: f64) -> Vec<f64> {
        let (first, last) = (
            (self.low / step).ceil() as i64,
            (self.high / step).floor() as i64,
        );
        (first..=last).map(|k| k as f64 * step).collect()
    }
}

/// Draws the axes of a chart in `place` with what they mean; returns the rectangle between them.
pub(crate) fn axes(
    canvas: &Canvas,
    place: Place,
    (x, x_words): (&Steps, &str),
    (y, y_words): (&Scale, &str),
) -> Place {
    let (x, y) = (Axis::of_steps(x), Axis::of_scale(y));
    draw(canvas, place, (x, x_words), (y, y_words), true)
}

/// As [`axes`], with steps along both and no lines between: for a picture.
pub(crate) fn degrees(
    canvas: &Canvas,
    place: Place,
    (x, x_words): (&Steps, &str),
    (y, y_words): (&Steps, &str),
) -> Place {
    let (x, y) = (Axis::of_steps(x), Axis::of_steps(y));
    draw(canvas, place, (x, x_words), (y, y_words), false)
}

/// As [`axes`], with numbers along the first: its ends, the step between labels, and what it means.
pub(crate) fn numbers(
    canvas: &Canvas,
    place: Place,
    (ends, step, x_words): ([f64; 2], f64, &str),
    (y, y_words): (&Scale, &str),
) -> Place {
    let x = Steps {
        low: ends[0],
        high: ends[1],
        step,
        fine: step,
    };
    let labelled = x.values(step).into_iter();
    let x = Axis {
        labelled: labelled.map(|v| (v, number(v))).collect(),
        ..Axis::of_steps(&x)
    };
    draw(
        canvas,
        place,
        (x, x_words),
        (Axis::of_scale(y), y_words),
        true,
    )
}

fn angle(degrees: f64) -> String {
    let whole = degrees.round() as i64;
    let sign = if whole < 0 { "−" } else { "" };
    format!("{sign}{}°", whole.abs())
}

/// An axis for plotters: where its lines are, and what is written at those with a label.
struct Axis {
    low: f64,
    high: f64,
    labelled: Vec<(f64, String)>,
    lines: Vec<f64>,
}

impl Axis {
    fn of_steps(x: &Steps) -> Self {
        let labelled = x.values(x.step).into_iter();
        Self {
            low: x.low,
            high: x.high,
            labelled: labelled.map(|v| (v, angle(v))).collect(),
            lines: x.values(x.fine),
        }
    }

    /// Positions from 0 to 1.
    fn of_scale(y: &Scale) -> Self {
        let ticks = y.ticks();
        let labelled = ticks.iter().filter(|t| !t.label.is_empty());
        Self {
            low: 0.0,
            high: 1.0,
            labelled: labelled.map(|t| (t.position, t.label.clone())).collect(),
            lines: ticks.iter().map(|t| t.position).collect(),
        }
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (value - self.low) / (self.high - self.low);
        from + (f64::from(to - from) * share).round() as i32
    }

    fn key_points<H: KeyPointHint>(&self, hint: H) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            self.lines.clone()
        } else {
            self.labelled.iter().map(|(v, _)| *v).collect()
        }
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        let found = self.labelled.iter().find(|(v, _)| v == value);
        found.map_or(String::new(), |(_, label)| label.clone())
    }
}

fn draw(
    canvas: &Canvas,
    place: Place,
    (x, x_words): (Axis, &str),
    (y, y_words): (Axis, &str),
    lines: bool,
) -> Place {
    let [left, top, w, h] = place;
    let inner = [
        left + LEFT,
        top + ABOVE,
        w - LEFT - RIGHT,
        h - BELOW - ABOVE,
    ];
    let area = canvas.part([left, inner[1], LEFT + inner[2], inner[3] + BELOW]);
    let chart = ChartBuilder::on(&area)
        .x_label_area_size(unit(BELOW))
        .y_label_area_size(unit(LEFT))
        .build_cartesian_2d(x, y);
    if let Ok(mut chart) = chart {
        let mut mesh = chart.configure_mesh();
        if !lines {
            mesh.disable_mesh();
        }
        let drawn = mesh
            .bold_line_style(style(Stroke::new(GRID, 1.0)))
            .light_line_style(style(Stroke::new(FAINT, 1.0)))
            .axis_style(style(Stroke::new(INK, 1.2)))
            .label_style(text_style(SMALL, MUTED))
            .axis_desc_style(text_style(LABEL, INK))
            .set_all_tick_mark_size(unit(5.0))
            .x_desc(x_words)
            .y_desc(y_words)
            .draw();
        done(drawn);
    }
    inner
}
