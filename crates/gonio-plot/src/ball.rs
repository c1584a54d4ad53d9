//! Balls: lit by a point, and pictures of them that somebody else has rendered.

use crate::canvas::Canvas;
use crate::colours;
use crate::figure::{self, Figure};
use crate::numbers::Factors;
use crate::scale::number;
use crate::{Function, Options, PlotError};
use gonio_image::tonemap::{ToneMap, encode_srgb8};
use gonio_num::{Real, Vec3};
use std::f64::consts::PI;

/// Pixels of a picture along each side for each of the page, so that a PNG of a higher density is sharp.
const DENSITY: f64 = 1.5;
/// Samples of a pixel along each side.
const SAMPLES: usize = 2;
/// Behind the ball, linear.
const GROUND: f32 = 0.018;

/// A picture to be shown beside others.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Its name.
    pub name: String,
    /// Its width and height, at least 1 × 1.
    pub size: [u32; 2],
    /// Red, green and blue of each pixel in sRGB, row by row from the top.
    pub rgb: Vec<u8>,
}

/// Balls of each function under a distant point light, seen from far away, in the colours that they reflect.
///
/// The light comes from the upper left, at the first of [`Options::theta_deg`] from the direction of the viewer (40° unless given). It is as bright
/// as a white Lambertian surface that faces it appears as 1. The tangent of the local frame runs along the circles of latitude about the upright axis,
/// turned by [`Options::phi_deg`]. Khronos PBR Neutral is the tone curve. A Dirac delta shows nothing of a point.
///
/// # Errors
/// [`PlotError::Count`] unless there are 1 to 8 functions; [`PlotError::Option`].
pub fn sphere(functions: &[Function], options: &Options) -> Result<Figure, PlotError> {
    options.check(functions.len())?;
    let theta = options.thetas(&[40.0])[0];
    let side = (picture_side(functions.len(), options) * DENSITY).round() as u32;
    let mut gaps = 0;
    let pictures: Vec<Picture> = functions
        .iter()
        .map(|f| {
            let (rgb, bad) = ball(f, theta, options, side as usize);
            gaps += bad;
            Picture {
                name: f.name.clone(),
                size: [side, side],
                rgb,
            }
        })
        .collect();
    let mut notes: Vec<String> = colours::gaps_note(gaps).into_iter().collect();
    if functions
        .iter()
        .any(|f| !f.draws(Vec3::new(0.0, 0.0, 1.0)).is_empty())
    {
        notes.push(
            "What is a Dirac delta doesn't show a point light: see it under a panorama.".into(),
        );
    }
    let words = format!(
        "Under a distant point light at {}° from the viewer; a white diffuse surface that faces it appears as 1",
        number(theta)
    );
    show(&pictures, options, &words, notes)
}

/// Pictures side by side, with their names: of 1 to 8.
///
/// `words` say what they show.
///
/// # Errors
/// [`PlotError::Count`], [`PlotError::Option`].
pub fn pictures(pictures: &[Picture], options: &Options, words: &str) -> Result<Figure, PlotError> {
    options.check(pictures.len())?;
    show(pictures, options, words, Vec::new())
}

/// The side in pixels of each of `count` square pictures in a plot with these options: how large they are best made.
pub fn picture_side(count: usize, options: &Options) -> f64 {
    let [w, h] = options.page_size(colours::page(count, 0.0));
    let named = if count > 1 { 20.0 } else { 0.0 };
    let place = [0.0, 0.0, w - 2.0 * figure::MARGIN, h - 86.0];
    let [_, _, w, h] = figure::panels(place, count, 1.0, 16.0)[0];
    w.min(h - named).clamp(16.0, 1024.0)
}

fn show(
    pictures: &[Picture],
    options: &Options,
    words: &str,
    notes: Vec<String>,
) -> Result<Figure, PlotError> {
    let canvas = Canvas::new(options.page_size(colours::page(pictures.len(), 0.0)));
    let title = match (&options.title, pictures) {
        (Some(title), _) => title.clone(),
        (None, [one]) => one.name.clone(),
        (None, many) => format!("{} reflection functions", many.len()),
    };
    let place = figure::header(&canvas, &title, words);
    let place = figure::footer(&canvas, place, &notes);
    let names: Vec<&str> = pictures.iter().map(|p| p.name.as_str()).collect();
    let places = figure::panels(place, pictures.len(), 1.0, 16.0);
    let places = colours::named(&canvas, &names, places);
    for (picture, [x, y, w, h]) in pictures.iter().zip(places) {
        let [pw, ph] = picture.size.map(f64::from);
        let scale = (w / pw).min(h / ph);
        canvas.picture(
            [x, y, pw * scale, ph * scale],
            picture.size,
            picture.rgb.clone(),
        );
    }
    let description = format!("{words}: {}.", names.join(", "));
    Ok(Figure::new(canvas, &title, &description, notes))
}

/// The pixels of a ball, and how many of its values are not finite.
fn ball(f: &Function, theta: f64, options: &Options, side: usize) -> (Vec<u8>, usize) {
    let (sin, cos) = Real::sin_cos(theta.to_radians());
    let diagonal = 0.5_f64.sqrt();
    let light = Vec3::new(-sin * diagonal, sin * diagonal, cos);
    let viewer = Vec3::new(0.0, 0.0, 1.0);
    let fine = side * SAMPLES;
    let mut rgb = Vec::with_capacity(side * side * 3);
    let mut gaps = 0;
    // A row of pixels at a time: a batch that is long enough and no picture's worth of directions in memory.
    for row in 0..side {
        let mut at = Vec::new();
        let mut pairs = Vec::new();
        for k in 0..SAMPLES * fine {
            let (i, j) = (k % fine, row * SAMPLES + k / fine);
            let place = |k: usize| (2.0 * (k as f64 + 0.5) / fine as f64 - 1.0) * 1.04;
            let (x, y) = (place(i), -place(j));
            let outside = 1.0 - x * x - y * y;
            if outside <= 0.0 {
                continue;
            }
            let n = Vec3::new(x, y, outside.sqrt());
            let (wi, wo) = (
                local(n, light, options.phi_deg),
                local(n, viewer, options.phi_deg),
            );
            at.push((i / SAMPLES, n.z));
            pairs.push([wi, wo]);
        }
        let mut sums = vec![([0.0_f64; 3], 0.0_f64); side];
        for ((column, _), (value, [wi, _])) in at.iter().zip(f.eval(&pairs).iter().zip(&pairs)) {
            let (sum, count) = &mut sums[*column];
            *count += 1.0;
            for k in 0..3 {
                let light = value[k] * wi.z.max(0.0) * PI;
                if light.is_finite() {
                    sum[k] += light.max(0.0);
                } else {
                    gaps += 1;
                }
            }
        }
        let all = (SAMPLES * SAMPLES) as f64;
        for (sum, count) in sums {
            // The mean of what is shown, not of the light: the rim of a highlight stays smooth.
            let shown = ToneMap::PbrNeutral.apply(sum.map(|x| (x / count.max(1.0)) as f32));
            let inside = (count / all) as f32;
            rgb.extend(encode_srgb8(
                shown.map(|x| x * inside + GROUND * (1.0 - inside)),
            ));
        }
    }
    (rgb, gaps)
}

/// [`crate::numbers::ball_values`].
pub(crate) fn values(
    f: &Function,
    light: Vec3<f64>,
    tangent: f64,
    side: usize,
    factors: Factors,
) -> Vec<[f64; 3]> {
    let viewer = Vec3::new(0.0, 0.0, 1.0);
    let mut at = Vec::new();
    let mut pairs = Vec::new();
    for k in 0..side * side {
        let place = |k: usize| 2.0 * (k as f64 + 0.5) / side as f64 - 1.0;
        let (x, y) = (place(k % side), -place(k / side));
        let outside = 1.0 - x * x - y * y;
        if outside > 0.0 {
            let n = Vec3::new(x, y, outside.sqrt());
            at.push(k);
            pairs.push([local(n, light, tangent), local(n, viewer, tangent)]);
        }
    }
    let reflected = if factors.brdf {
        f.eval(&pairs)
    } else {
        vec![[1.0; 3]; pairs.len()]
    };
    let mut pixels = vec![[f64::NAN; 3]; side * side];
    for ((k, [wi, _]), value) in at.into_iter().zip(pairs).zip(reflected) {
        let light = if factors.light { PI } else { 1.0 };
        let cosine = if factors.cosine { wi.z } else { 1.0 };
        let factor = if wi.z > 0.0 { light * cosine } else { 0.0 };
        pixels[k] = value.map(|x| x * factor);
    }
    pixels
}

/// `w` in the frame of the ball's surface at `n`: x along the circle of latitude, turned by `phi` degrees, z along the normal.
fn local(n: Vec3<f64>, w: Vec3<f64>, phi: f64) -> Vec3<f64> {
    let up = Vec3::new(0.0, 1.0, 0.0);
    let along = up.cross(n);
    let length = along.length();
    let t = if length > 1e-9 {
        along / length
    } else {
        Vec3::new(1.0, 0.0, 0.0)
    };
    let b = n.cross(t);
    let (sin, cos) = Real::sin_cos(phi.to_radians());
    let (x, y) = (w.dot(t), w.dot(b));
    Vec3::new(x * cos + y * sin, y * cos - x * sin, w.dot(n))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(rgb: &[u8], side: usize, x: f64, y: f64) -> [u8; 3] {
        let pixel = |t: f64| ((t / 1.04 + 1.0) * 0.5 * side as f64) as usize;
        let at = 3 * (pixel(-y) * side + pixel(x));
        [rgb[at], rgb[at + 1], rgb[at + 2]]
    }

    /// f = ρ/π under light of irradiance π: ρ cosθ, before the tone curve.
    #[test]
    fn a_lambertian_ball_shows_its_albedo_times_the_cosine() {
        let f = Function::new("", |_, _| [0.5 / PI; 3]);
        let side = 200;
        let (rgb, gaps) = ball(&f, 40.0, &Options::default(), side);
        assert_eq!((rgb.len(), gaps), (3 * side * side, 0));
        let expected = |cos: f64| {
            let shown = ToneMap::PbrNeutral.apply([(0.5 * cos) as f32; 3]);
            encode_srgb8(shown)[0]
        };
        // In the middle the normal is the viewer's direction, at 40° from the light's.
        let middle = code(&rgb, side, 0.0, 0.0)[0];
        assert!(
            middle.abs_diff(expected(Real::cos(40_f64.to_radians()))) <= 2,
            "{middle}"
        );
        // Where the normal points to the light: up and to the left.
        let off = Real::sin(40_f64.to_radians()) * 0.5_f64.sqrt();
        let facing = code(&rgb, side, -off, off)[0];
        assert!(facing.abs_diff(expected(1.0)) <= 1, "{facing}");
        // In the shadow, and beside the ball.
        assert_eq!(code(&rgb, side, 0.65, -0.65), [0; 3]);
        assert_eq!(code(&rgb, side, 1.0, 1.0), encode_srgb8([GROUND; 3]));
    }

    #[test]
    fn the_tangent_runs_along_the_latitude() {
        let n = Vec3::new(0.0, 0.6, 0.8);
        let w = local(n, Vec3::new(1.0, 0.0, 0.0), 0.0);
        assert!((w.x - 1.0).abs() < 1e-12 && w.y.abs() < 1e-12 && w.z.abs() < 1e-12);
        let turned = local(n, Vec3::new(1.0, 0.0, 0.0), 90.0);
        assert!((turned.y + 1.0).abs() < 1e-12);
        assert!((local(n, n, 33.0).z - 1.0).abs() < 1e-12);
    }
}
