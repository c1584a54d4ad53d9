//! The difference of two functions.

use crate::canvas::{Canvas, GRID, INK, Look, MUTED, Stroke};
use crate::colours::{self, BAR};
use crate::curves::direction;
use crate::figure::{self, Figure, Place};
use crate::scale::number;
use crate::{Channel, Function, Options, PlotError, slice};
use gonio_num::{Real, Vec3};
use std::f64::consts::PI;

/// Values along the diameter of a hemisphere.
const CELLS: usize = 241;

/// By how much the second function differs from the first: (f₂ − f₁) / max(|f₁|, |f₂|), from −1 (nothing there) to 1.
///
/// One panel for each angle of incidence (45° unless given): the hemisphere of directions of reflection seen from above, the light coming from
/// the left, the distance from the centre in proportion to θr. Then the slice of half and difference angles as in [`slice`](crate::slice()).
/// The largest difference of each is marked and printed. The number that is compared is that of [`Options::channel`], the luminance for all three.
///
/// # Errors
/// [`PlotError::Count`] unless there are two functions; [`PlotError::Nothing`] if both are 0 everywhere; [`PlotError::Option`].
pub fn difference(functions: &[Function], options: &Options) -> Result<Figure, PlotError> {
    let [first, second] = functions else {
        return Err(PlotError::Count {
            found: functions.len(),
            expected: "2 to compare",
        });
    };
    options.check(2)?;
    let thetas = options.thetas(&[45.0]);
    let mut panels: Vec<Panel> = thetas
        .iter()
        .map(|theta| hemisphere(first, second, *theta, options))
        .collect();
    panels.push(of_slices(first, second, options));
    if panels.iter().all(|p| p.both_nothing) {
        return Err(slice::nothing(first));
    }
    let most = panels
        .iter()
        .filter_map(|p| p.largest)
        .map(|(_, d)| d.abs())
        .fold(0.0, f64::max);
    let end = round_up(most);

    let canvas = Canvas::new(options.page_size(colours::page(panels.len(), BAR)));
    let title = match &options.title {
        Some(title) => title.clone(),
        None => format!("{} against {}", second.name, first.name),
    };
    let gaps = panels.iter().map(|p| p.gaps).sum();
    let mut notes: Vec<String> = colours::gaps_note(gaps).into_iter().collect();
    if most == 0.0 {
        notes.push("They are the same in every direction that was looked at.".into());
    }
    let mut subtitle =
        "Relative difference (f₂ − f₁) / max(|f₁|, |f₂|); red: the second is larger".to_owned();
    if options.channel != Channel::Rgb {
        subtitle += &format!("; {}", options.channel.name());
    }
    let place = figure::header(&canvas, &title, &subtitle);
    let [x, y, w, h] = figure::footer(&canvas, place, &notes);
    let places = figure::panels([x, y, w - BAR, h], panels.len(), 1.0, 16.0);
    for (panel, place) in panels.iter().zip(places) {
        panel.draw(&canvas, place, end);
    }
    let colour = |p: f64| colours::of_difference(2.0 * p - 1.0);
    let ticks: Vec<(f64, String)> = [-1.0, -0.5, 0.0, 0.5, 1.0]
        .map(|t: f64| (0.5 + 0.5 * t, percent(t * end)))
        .into();
    let bar = [x + w - BAR + 12.0, y + 44.0, (h - 120.0).clamp(60.0, 360.0)];
    colours::bar(&canvas, bar, &colour, &ticks, "difference");
    let mut words = subtitle;
    for panel in &panels {
        words += &format!(" {}: {}.", panel.name, panel.in_words());
    }
    Ok(Figure::new(canvas, &title, &words, notes))
}

/// The differences over a range of directions.
struct Panel {
    name: String,
    /// Nothing where there are no directions.
    cells: Vec<Option<f64>>,
    side: usize,
    /// Index and difference.
    largest: Option<(usize, f64)>,
    /// Where that is, in words.
    place: String,
    gaps: usize,
    both_nothing: bool,
    is_slice: bool,
}

fn hemisphere(first: &Function, second: &Function, theta: f64, options: &Options) -> Panel {
    let wi = direction(-theta, options.phi_deg);
    let angles: Vec<Option<[f64; 2]>> = (0..CELLS * CELLS).map(angles).collect();
    let pairs: Vec<Option<[Vec3<f64>; 2]>> = angles
        .iter()
        .map(|at| {
            let [theta, phi] = (*at)?;
            let phi = phi + options.phi_deg;
            Some([wi, direction(theta, phi)])
        })
        .collect();
    let name = format!("Light at θi = {}°", number(theta));
    let mut panel = Panel::new(name, CELLS, first, second, &pairs, options);
    if let Some((k, _)) = panel.largest
        && let Some([theta, phi]) = angles[k]
    {
        panel.place = format!("θr = {}°, φr = {}°", number(theta), number(phi));
    }
    panel
}

fn of_slices(first: &Function, second: &Function, options: &Options) -> Panel {
    let pairs = slice::pairs(options);
    let name = format!("Slice at φd = {}°", number(options.phi_d_deg));
    let mut panel = Panel::new(name, slice::CELLS, first, second, &pairs, options);
    panel.is_slice = true;
    if let Some((k, _)) = panel.largest {
        let [h, d] = slice::angles(k).map(number);
        panel.place = format!("θh = {h}°, θd = {d}°");
    }
    panel
}

/// θr and φr in degrees of a cell of the hemisphere; nothing outside the horizon.
fn angles(index: usize) -> Option<[f64; 2]> {
    let middle = (CELLS - 1) as f64 / 2.0;
    let (x, y) = (
        ((index % CELLS) as f64 - middle) / middle,
        (middle - (index / CELLS) as f64) / middle,
    );
    let theta = 90.0 * (x * x + y * y).sqrt();
    (theta < 89.9).then(|| [theta, Real::atan2(y, x) * 180.0 / PI])
}

impl Panel {
    fn new(
        name: String,
        side: usize,
        first: &Function,
        second: &Function,
        pairs: &[Option<[Vec3<f64>; 2]>],
        options: &Options,
    ) -> Self {
        let (a, b) = (slice::values(first, pairs), slice::values(second, pairs));
        let value = |c: [f64; 3]| options.channel.value(c);
        let both_nothing = a.iter().chain(&b).all(|c| value(*c) == 0.0);
        let cells: Vec<Option<f64>> = pairs
            .iter()
            .zip(a.iter().zip(&b))
            .map(|(pair, (a, b))| pair.map(|_| relative(value(*a), value(*b))))
            .collect();
        let mut largest: Option<(usize, f64)> = None;
        for (k, d) in cells.iter().enumerate() {
            if let Some(d) = d.filter(|d| d.is_finite() && *d != 0.0)
                && largest.is_none_or(|(_, best)| d.abs() > best.abs())
            {
                largest = Some((k, d));
            }
        }
        Self {
            name,
            gaps: cells.iter().flatten().filter(|d| !d.is_finite()).count(),
            cells,
            side,
            largest,
            place: String::new(),
            both_nothing,
            is_slice: false,
        }
    }

    fn in_words(&self) -> String {
        match self.largest {
            None => "no difference".into(),
            Some((_, d)) => format!("largest {} at {}", percent(d), self.place),
        }
    }

    fn draw(&self, canvas: &Canvas, [x, y, w, h]: Place, end: f64) {
        let look = Look {
            down: -1,
            ..Look::LABEL.bold()
        };
        canvas.text(&self.name, [x, y], look);
        canvas.text(&self.in_words(), [x, y + 18.0], Look::SMALL.top());
        let room = [x, y + 38.0, w, h - 38.0];
        let inner = if self.is_slice {
            slice::axes(canvas, room)
        } else {
            round(canvas, room)
        };
        let ground = if self.is_slice {
            colours::BELOW
        } else {
            [255; 3]
        };
        let colours = self.cells.iter().flat_map(|d| match d {
            Some(d) => colours::of_difference(d / end),
            None => ground,
        });
        canvas.picture(inner, [self.side as u32; 2], colours.collect());
        if let Some((k, _)) = self.largest {
            let last = (self.side - 1) as f64;
            let at = [
                inner[0] + inner[2] * (k % self.side) as f64 / last,
                inner[1] + inner[3] * (k / self.side) as f64 / last,
            ];
            for (width, colour) in [(3.6, 0xffffff), (1.6, INK)] {
                for s in [-5.0, 5.0] {
                    let line = [[at[0] - 5.0, at[1] - s], [at[0] + 5.0, at[1] + s]];
                    canvas.line(&line, Stroke::new(colour, width));
                }
            }
        }
    }
}

/// Rings and labels of a hemisphere; returns the square around it.
fn round(canvas: &Canvas, [x, y, w, h]: Place) -> Place {
    let radius = (0.5 * w - 34.0).min(0.5 * h - 26.0).max(20.0);
    let centre = [x + radius + 34.0, y + radius + 8.0];
    let at = |share: f64, degrees: f64| {
        let (sin, cos) = Real::sin_cos(degrees.to_radians());
        [
            centre[0] + radius * share * cos,
            centre[1] - radius * share * sin,
        ]
    };
    for k in 1..=3 {
        let share = f64::from(k) / 3.0;
        let ring: Vec<[f64; 2]> = (0..=120).map(|j| at(share, f64::from(3 * j))).collect();
        let colour = if k == 3 { INK } else { GRID };
        canvas.line(&ring, Stroke::new(colour, if k == 3 { 1.2 } else { 0.8 }));
        let [x, y] = at(share, 270.0);
        let words = format!("{}°", 30 * k);
        let below = if k == 3 { 12.0 } else { 0.0 };
        canvas.text(&words, [x, y + below], Look::SMALL.centred().rimmed());
    }
    let arrow = Stroke::new(MUTED, 1.8);
    canvas.arrow(at(1.18, 180.0), at(1.02, 180.0), 9.0, arrow);
    [
        centre[0] - radius,
        centre[1] - radius,
        2.0 * radius,
        2.0 * radius,
    ]
}

/// (b − a) / max(|a|, |b|); 0 if both are 0.
fn relative(a: f64, b: f64) -> f64 {
    let size = a.abs().max(b.abs());
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else if size == 0.0 {
        0.0
    } else {
        (b - a) / size
    }
}

/// The end of the scale for differences up to `most`.
fn round_up(most: f64) -> f64 {
    let ends = [
        1e-12, 1e-9, 1e-6, 1e-5, 1e-4, 1e-3, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5,
    ];
    ends.into_iter().find(|e| most <= *e).unwrap_or(1.0)
}

fn percent(share: f64) -> String {
    let sign = if share > 0.0 { "+" } else { "" };
    format!("{sign}{} %", number(100.0 * share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_relative_to_the_larger() {
        assert_eq!(relative(1.0, 2.0), 0.5);
        assert_eq!(relative(2.0, 1.0), -0.5);
        assert_eq!((relative(0.0, 3.0), relative(3.0, 0.0)), (1.0, -1.0));
        assert_eq!(relative(0.0, 0.0), 0.0);
        assert!(relative(f64::NAN, 0.0).is_nan());
        assert_eq!(percent(-0.25), "−25 %");
    }

    #[test]
    fn the_hemisphere_is_seen_from_above() {
        let middle = CELLS / 2;
        assert_eq!(angles(middle * CELLS + middle).unwrap()[0], 0.0);
        // Towards the right: the mirror's side. Upwards: counter-clockwise.
        let [theta, phi] = angles(middle * CELLS + CELLS - 20).unwrap();
        assert!(theta > 70.0 && phi == 0.0);
        let [_, phi] = angles(10 * CELLS + middle).unwrap();
        assert!((phi - 90.0).abs() < 1e-9);
        assert_eq!(angles(0), None);
    }

    /// The largest difference is found where it was put.
    #[test]
    fn a_planted_difference_is_found() {
        let spot = direction(40.0, 0.0);
        let plain = Function::new("plain", |_, _| [0.3; 3]);
        let spotted = Function::new("spotted", move |_, wo: Vec3<f64>| {
            [if wo.dot(spot) > 0.9995 { 0.2 } else { 0.3 }; 3]
        });
        let options = Options::default();
        let panel = hemisphere(&plain, &spotted, 30.0, &options);
        let (k, d) = panel.largest.unwrap();
        let [theta, phi] = angles(k).unwrap();
        assert!((d + 1.0 / 3.0).abs() < 1e-12, "{d}");
        // Within the spot, arccos 0.9995 ≈ 1.8°.
        assert!(direction(theta, phi).dot(spot) > 0.9995, "{theta} {phi}");
        let same = hemisphere(&plain, &plain, 30.0, &options);
        assert_eq!(same.largest, None);
    }
}
