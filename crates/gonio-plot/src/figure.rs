//! [`Figure`], a finished plot, and the parts that every plot has: title, legend, notes.

use crate::canvas::{Canvas, DASHES, INK, LABEL, Look, MUTED, SMALL, Stroke, TITLE};
use crate::page::Page;
use crate::{Function, Options, PlotError, font, png};

/// A finished plot.
#[derive(Debug)]
pub struct Figure {
    page: Page,
    svg: String,
    notes: Vec<String>,
}

impl Figure {
    pub(crate) fn new(canvas: Canvas, title: &str, description: &str, notes: Vec<String>) -> Self {
        let page = canvas.finish();
        let mut words = description.to_owned();
        for note in &notes {
            words += &format!(" {note}");
        }
        Self {
            svg: page.document(title, words.trim(), true),
            page,
            notes,
        }
    }

    /// The plot as a self-contained SVG file: on a white ground of its own, with a title and a description for those who can't see it.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// The plot as a PNG file, `density` pixels for each pixel of its size along both sides. The fonts are embedded: its text is
    /// there on a machine without any.
    ///
    /// # Errors
    /// [`PlotError::Option`] if it had no or more than [`MOST_PIXELS`](crate::MOST_PIXELS) pixels; [`PlotError::Drawing`].
    pub fn png(&self, density: f64) -> Result<Vec<u8>, PlotError> {
        png::draw(&self.page, density)
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [f64; 2] {
        self.page.size
    }

    /// What a reader has to know: values that were not finite, parts that could not be drawn.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }
}

/// Room at the edges.
pub(crate) const MARGIN: f64 = 18.0;

/// A rectangle: left, top, width, height.
pub(crate) type Place = [f64; 4];

/// The words at the top: what was asked for, or the functions' name.
pub(crate) fn title(functions: &[Function], options: &Options) -> String {
    match (&options.title, functions) {
        (Some(title), _) => title.clone(),
        (None, [one]) => one.name.clone(),
        (None, many) => format!("{} reflection functions", many.len()),
    }
}

/// Draws title and subtitle; returns what is left of the page below them.
pub(crate) fn header(canvas: &Canvas, title: &str, subtitle: &str) -> Place {
    let [w, h] = canvas.size();
    let room = w - 2.0 * MARGIN;
    let mut y = MARGIN;
    for line in font::wrapped(title, TITLE, true, room, 2) {
        canvas.text(&line, [MARGIN, y], Look::TITLE);
        y += 1.3 * TITLE;
    }
    for line in font::wrapped(subtitle, SMALL + 0.5, false, room, 2) {
        let look = Look {
            size: SMALL + 0.5,
            ..Look::SMALL.top()
        };
        canvas.text(&line, [MARGIN, y], look);
        y += 1.35 * SMALL;
    }
    y += 10.0;
    [MARGIN, y, room, (h - y - MARGIN).max(40.0)]
}

/// Draws notes at the bottom of `place`; returns what is left above them.
pub(crate) fn footer(canvas: &Canvas, place: Place, notes: &[String]) -> Place {
    let [x, y, w, h] = place;
    let mut lines: Vec<String> = Vec::new();
    for note in notes {
        lines.extend(font::wrapped(note, SMALL, false, w, 2));
    }
    if lines.is_empty() {
        return place;
    }
    let height = 1.35 * SMALL * lines.len() as f64;
    for (k, line) in lines.iter().enumerate() {
        let at = y + h - height + 1.35 * SMALL * (k as f64 + 0.4);
        canvas.text(line, [x, at], Look::SMALL);
    }
    [x, y, w, h - height - 6.0]
}

/// A line of a legend.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    /// Nothing: a heading.
    pub stroke: Option<Stroke>,
    pub words: String,
}

impl Entry {
    pub fn heading(words: impl Into<String>) -> Self {
        Self {
            stroke: None,
            words: words.into(),
        }
    }

    pub fn line(stroke: Stroke, words: impl Into<String>) -> Self {
        Self {
            stroke: Some(stroke),
            words: words.into(),
        }
    }
}

const SAMPLE: f64 = 30.0;
const GAP: f64 = 8.0;

/// The width that a legend takes: what its words need, within bounds.
pub(crate) fn legend_width(entries: &[Entry], most: f64) -> f64 {
    // A reader's font may be a little wider than ours.
    let need = |e: &Entry| {
        let indent = if e.stroke.is_some() {
            SAMPLE + GAP
        } else {
            0.0
        };
        indent + 1.06 * font::width(&e.words, LABEL, e.stroke.is_none())
    };
    entries.iter().map(need).fold(60.0, f64::max).min(most)
}

/// Draws a legend from the corner on, names in as many lines as they need.
pub(crate) fn legend(canvas: &Canvas, [x, y]: [f64; 2], width: f64, entries: &[Entry]) {
    let mut y = y;
    for (k, entry) in entries.iter().enumerate() {
        let Some(stroke) = entry.stroke else {
            if k > 0 {
                y += 10.0;
            }
            for line in font::wrapped(&entry.words, SMALL, true, width, 3) {
                let look = Look {
                    size: SMALL,
                    colour: MUTED,
                    ..Look::LABEL.bold()
                };
                canvas.text(&line, [x, y], look);
                y += 1.4 * SMALL;
            }
            y += 4.0;
            continue;
        };
        canvas.line(&[[x, y], [x + SAMPLE, y]], stroke);
        let room = width - SAMPLE - GAP;
        for line in font::wrapped(&entry.words, LABEL, false, room, 4) {
            canvas.text(&line, [x + SAMPLE + GAP, y], Look::LABEL.coloured(INK));
            y += 1.25 * LABEL;
        }
        y += 4.0;
    }
}

/// The size of a page for `count` panels whose widths are `aspect` times their heights.
pub(crate) fn page_of_panels(count: usize, aspect: f64) -> [f64; 2] {
    let columns = match count {
        1 => 1,
        2 | 4 => 2,
        3 | 5 | 6 => 3,
        _ => 4,
    };
    let wide = if columns == 4 { 280.0 } else { 340.0 };
    let rows = count.div_ceil(columns);
    [
        columns as f64 * (wide + 14.0) + 180.0,
        rows as f64 * (wide / aspect + 34.0) + 90.0,
    ]
}

/// Rectangles for `count` panels in `place`, as square as they can be, row by row.
pub(crate) fn panels(place: Place, count: usize, aspect: f64, gap: f64) -> Vec<Place> {
    let [x, y, w, h] = place;
    let size = |columns: usize| {
        let rows = count.div_ceil(columns);
        let cell = [
            (w - gap * (columns - 1) as f64) / columns as f64,
            (h - gap * (rows - 1) as f64) / rows as f64,
        ];
        (cell, cell[0].min(cell[1] * aspect))
    };
    let best = (1..=count.max(1)).max_by(|a, b| {
        // With as few columns as do as well.
        size(*a).1.total_cmp(&size(*b).1).then(b.cmp(a))
    });
    let columns = best.unwrap_or(1);
    let ([cw, ch], _) = size(columns);
    (0..count)
        .map(|k| {
            let (row, column) = ((k / columns) as f64, (k % columns) as f64);
            [x + column * (cw + gap), y + row * (ch + gap), cw, ch]
        })
        .collect()
}

/// The dash of the `k`-th thing of a kind.
pub(crate) fn dash(k: usize) -> &'static str {
    DASHES[k % DASHES.len()]
}

/// The note on values that are not finite.
pub(crate) fn gaps_note(gaps: usize) -> Option<String> {
    match gaps {
        0 => None,
        1 => Some("1 value was not finite: it is left out.".into()),
        n => Some(format!("{n} values were not finite: they are left out.")),
    }
}
