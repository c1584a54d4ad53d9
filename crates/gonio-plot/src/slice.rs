//! The image slice: f against half and difference angle.

use crate::canvas::Canvas;
use crate::chart::{self, Steps};
use crate::colours::{self, BAR};
use crate::figure::{self, Figure, Place};
use crate::scale::{Scale, ScaleKind, number};
use crate::{Channel, Function, Options, PlotError};
use gonio_num::{Real, Vec3};

/// Values along each side of a slice.
pub(crate) const CELLS: usize = 181;
/// The steepest angles, degrees: at 90° itself both directions would lie in the horizon.
const STEEPEST: f64 = 89.9;

/// The image slice of functions: f by the angle θh of the half vector, from left to right, and the angle θd between it and the light, from
/// the bottom up, at φd of [`Options::phi_d_deg`] (Rusinkiewicz 1998, "A New Change of Variables for Efficient BRDF Representation"; shown so
/// for the MERL materials by Burley 2012, §3).
///
/// A highlight is at the left edge, the Fresnel effect at the top left, retro-reflection along the bottom, grazing directions at the right and
/// at the top. The colour is false, or with [`Channel::Rgb`] the function's own, on one scale for all: logarithmic for one
/// number, the cube root for colours, unless [`Options::scale`] says otherwise. It holds 98 % of the
/// values, 95 % of those of colours; the others are shown as its end. Values stand at every half degree, the first at 0.
///
/// # Errors
/// [`PlotError::Count`] unless there are 1 to 8 functions; [`PlotError::Nothing`] for one that is 0 everywhere, as a mirror is;
/// [`PlotError::Option`].
pub fn slice(functions: &[Function], options: &Options) -> Result<Figure, PlotError> {
    options.check(functions.len())?;
    let pairs = pairs(options);
    let sampled: Vec<Vec<[f64; 3]>> = functions.iter().map(|f| values(f, &pairs)).collect();
    for (f, values) in functions.iter().zip(&sampled) {
        if values.iter().all(|c| *c == [0.0; 3]) {
            return Err(nothing(f));
        }
    }
    let scale = scale(&sampled, options);
    let canvas = Canvas::new(options.page_size(colours::page(functions.len(), BAR)));
    let title = figure::title(functions, options);
    let gaps = sampled.iter().flatten().filter(|c| !finite(c)).count();
    let mut notes: Vec<String> = colours::gaps_note(gaps).into_iter().collect();
    if pairs.iter().any(Option::is_none) {
        notes.push("Grey: one of the directions lies below the horizon.".into());
    }
    let mut subtitle = format!("Slice at φd = {}°", number(options.phi_d_deg));
    if options.phi_deg != 0.0 {
        subtitle += &format!(", φh = {}°", number(options.phi_deg));
    }
    match options.channel {
        Channel::Rgb => subtitle += ", colour as reflected, brightness on the scale",
        one => subtitle += &format!(", {}", one.name()),
    }
    if !scale.words().is_empty() {
        subtitle += &format!(", {} scale", scale.words());
    }
    let place = figure::header(&canvas, &title, &subtitle);
    let [x, y, w, h] = figure::footer(&canvas, place, &notes);
    let places = figure::panels([x, y, w - BAR, h], functions.len(), 1.0, 16.0);
    let names: Vec<&str> = functions.iter().map(|f| f.name.as_str()).collect();
    let mut top = [y, 0.0];
    for (place, values) in colours::named(&canvas, &names, places)
        .into_iter()
        .zip(&sampled)
    {
        let inner = axes(&canvas, place);
        if top[1] == 0.0 {
            top = [inner[1], inner[3]];
        }
        let colours = pairs.iter().zip(values).map(|(pair, value)| match pair {
            Some(_) => colours::of_value(options.channel, &scale, *value),
            None => colours::BELOW,
        });
        picture(&canvas, inner, colours);
    }
    let at = [x + w - BAR + 12.0, top[0] + 14.0, (top[1] - 14.0).max(60.0)];
    colours::scale_bar(&canvas, at, options.channel, &scale);
    let words = format!(
        "f in sr⁻¹ by the half angle from left to right and the difference angle from the bottom up.{}",
        in_words(functions, &sampled, options)
    );
    Ok(Figure::new(canvas, &title, &words, notes))
}

/// Why a function that is 0 everywhere isn't drawn.
pub(crate) fn nothing(f: &Function) -> PlotError {
    let up = Vec3::new(0.6, 0.0, 0.8);
    PlotError::Nothing {
        name: f.name.clone(),
        reason: if f.draws(up).is_empty() {
            "it is 0 everywhere"
        } else {
            "all its light is in Dirac deltas, which only the polar, Cartesian, albedo and sphere plots can show"
        },
    }
}

/// The axes in the largest square of `place`; returns it.
pub(crate) fn axes(canvas: &Canvas, [x, y, w, h]: Place) -> Place {
    let steps = || Steps {
        low: 0.0,
        high: 90.0,
        step: if w.min(h) > 330.0 { 15.0 } else { 30.0 },
        fine: if w.min(h) > 330.0 { 15.0 } else { 30.0 },
    };
    let side = (w - chart::LEFT - chart::RIGHT).min(h - chart::BELOW - chart::ABOVE);
    let place = [
        x,
        y,
        side + chart::LEFT + chart::RIGHT,
        side + chart::BELOW + chart::ABOVE,
    ];
    let (x, y) = (steps(), steps());
    chart::degrees(
        canvas,
        place,
        (&x, "half angle θh"),
        (&y, "difference angle θd"),
    )
}

/// Puts the colours of a slice, in the order of [`pairs`], into a square.
pub(crate) fn picture(canvas: &Canvas, place: Place, colours: impl Iterator<Item = [u8; 3]>) {
    let size = [CELLS as u32; 2];
    canvas.picture(place, size, colours.flatten().collect());
}

/// The directions of each cell, row by row from the top, where θd is largest; nothing where one of them is below the horizon.
pub(crate) fn pairs(options: &Options) -> Vec<Option<[Vec3<f64>; 2]>> {
    let angle = |k: usize| (STEEPEST * k as f64 / (CELLS - 1) as f64).to_radians();
    let mut all = Vec::with_capacity(CELLS * CELLS);
    for row in (0..CELLS).rev() {
        for column in 0..CELLS {
            let [wi, wo] = pair(angle(column), angle(row), options);
            all.push((wi.z > 0.0 && wo.z > 0.0).then_some([wi, wo]));
        }
    }
    all
}

/// θh and θd in degrees of the cell at an index of [`pairs`].
pub(crate) fn angles(index: usize) -> [f64; 2] {
    let step = STEEPEST / (CELLS - 1) as f64;
    let (row, column) = (CELLS - 1 - index / CELLS, index % CELLS);
    [column as f64 * step, row as f64 * step]
}

/// wi and wo for a half vector at θh in the plane of [`Options::phi_deg`] and a difference vector at θd and φd. φd is counted from the plane
/// of the half vector and the normal.
fn pair(theta_h: f64, theta_d: f64, options: &Options) -> [Vec3<f64>; 2] {
    let (sin_h, cos_h) = Real::sin_cos(theta_h);
    let (sin_d, cos_d) = Real::sin_cos(theta_d);
    let (sin, cos) = Real::sin_cos(options.phi_d_deg.to_radians());
    let (sin_phi, cos_phi) = Real::sin_cos(options.phi_deg.to_radians());
    let turned = |x: f64, y: f64, z: f64| {
        // About y by θh, then about z by φh.
        let (x, z) = (x * cos_h + z * sin_h, z * cos_h - x * sin_h);
        Vec3::new(x * cos_phi - y * sin_phi, x * sin_phi + y * cos_phi, z)
    };
    let (x, y) = (sin_d * cos, sin_d * sin);
    [turned(x, y, cos_d), turned(-x, -y, cos_d)]
}

/// f of each cell, 0 where there is no pair.
pub(crate) fn values(f: &Function, pairs: &[Option<[Vec3<f64>; 2]>]) -> Vec<[f64; 3]> {
    let there: Vec<[Vec3<f64>; 2]> = pairs.iter().flatten().copied().collect();
    let mut found = f.eval(&there).into_iter();
    let one = |pair: &Option<_>| match pair {
        Some(_) => found.next().unwrap_or([f64::NAN; 3]),
        None => [0.0; 3],
    };
    pairs.iter().map(one).collect()
}

fn finite(colour: &[f64; 3]) -> bool {
    colour.iter().all(|x| x.is_finite())
}

/// The share of a slice's values that its scale is to hold, of one number and of colours; the few above it, at grazing angles, are shown as its
/// end.
const HELD: [f64; 2] = [0.98, 0.95];

/// The scale of all slices.
fn scale(sampled: &[Vec<[f64; 3]>], options: &Options) -> Scale {
    let (mut least, mut most) = (f64::INFINITY, 0.0);
    for values in sampled {
        let weights = options.channel.weights();
        let held = HELD[usize::from(weights.len() > 1)];
        let numbers = weights.iter().flat_map(|w| {
            let all = values.iter();
            all.map(|colour| crate::options::weighted(*w, *colour))
        });
        let mut numbers: Vec<f64> = numbers.filter(|x| *x > 0.0 && x.is_finite()).collect();
        numbers.sort_by(f64::total_cmp);
        if let (Some(first), Some(last)) = (numbers.first(), numbers.len().checked_sub(1)) {
            least = first.min(least);
            most = numbers[(held * last as f64) as usize].max(most);
        }
    }
    let kind = match (options.scale, options.channel) {
        // Near to what a display's transfer does: the colours look as they would.
        (ScaleKind::Auto, Channel::Rgb) => ScaleKind::CubeRoot,
        (ScaleKind::Auto, _) => ScaleKind::Log,
        (kind, _) => kind,
    };
    Scale::new(kind, least, most, false)
}

fn in_words(functions: &[Function], sampled: &[Vec<[f64; 3]>], options: &Options) -> String {
    let mut text = String::new();
    for (f, values) in functions.iter().zip(sampled) {
        let values = values.iter().map(|c| options.channel.value(*c));
        let most = values
            .enumerate()
            .filter(|(_, x)| x.is_finite())
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((k, x)) = most {
            let [h, d] = angles(k).map(number);
            text += &format!(
                " {}: largest value {} sr⁻¹ at θh {h}°, θd {d}°.",
                f.name,
                number(x)
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the definition: the half vector is between both, θd between it and the light.
    #[test]
    fn pairs_have_their_half_and_difference_angles() {
        let options = Options {
            phi_deg: 25.0,
            phi_d_deg: 70.0,
            ..Options::default()
        };
        for (k, pair) in pairs(&options).iter().enumerate().step_by(97) {
            let Some([wi, wo]) = pair else { continue };
            let [theta_h, theta_d] = angles(k).map(f64::to_radians);
            let h = (*wi + *wo).normalize();
            assert!((h.z - Real::cos(theta_h)).abs() < 1e-9, "{k}");
            assert!((h.dot(*wi) - Real::cos(theta_d)).abs() < 1e-9, "{k}");
        }
    }

    #[test]
    fn at_phi_d_of_90_no_direction_is_below_the_horizon() {
        assert!(pairs(&Options::default()).iter().all(Option::is_some));
        let across = Options {
            phi_d_deg: 0.0,
            ..Options::default()
        };
        // θh + θd > 90°: half of the square.
        let below = pairs(&across).iter().filter(|p| p.is_none()).count();
        let half = CELLS * CELLS / 2;
        assert!(below.abs_diff(half) < CELLS, "{below}");
    }

    #[test]
    fn orientation() {
        // The first row is the top, the first column the left.
        assert_eq!(angles(0).map(f64::round), [0.0, 90.0]);
        assert_eq!(angles(CELLS * CELLS - 1).map(f64::round), [90.0, 0.0]);
    }
}
