//! [`ConversionReport`], what a conversion cost.

use super::super::channel::luminance;
use super::super::format::Format;
use super::super::measurement::{Measurement, Side};
use super::super::prepared::Measured;
use super::read_back;
use super::source::Source;
use crate::BrdfError;
use crate::part::geometry::turned;
use gonio_num::{Real, Vec3};
use gonio_radiometry::direction::spherical_direction;
use gonio_radiometry::sequence::Rng;
use gonio_radiometry::warp::around_axis;
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// Pairs of directions that are compared.
const PAIRS: u32 = 6000;
/// Elevations of the viewer for which albedos are compared, in degrees.
const ALBEDO_DEG: [f64; 4] = [0.0, 30.0, 60.0, 80.0];

/// The largest difference that was met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Worst {
    /// Direction to the light.
    pub wi: Vec3<f64>,
    /// Direction to the viewer.
    pub wo: Vec3<f64>,
    /// Luminance before, sr⁻¹.
    pub before: f64,
    /// Luminance after.
    pub after: f64,
}

/// How far the luminance of the file is from that of the source, over random pairs of directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Pairs compared: a half uniform, a quarter near the mirror direction, a quarter with light from more than 75°.
    pub pairs: u32,
    /// Root of the mean squared difference, sr⁻¹.
    pub rms: f64,
    /// The same over the root of the mean squared value.
    pub relative_rms: f64,
    /// The relative one where each pair counts by cosθi cosθo, as it does in what is seen.
    pub weighted_relative_rms: f64,
    /// Where cosθi cosθo times the difference is largest.
    pub worst: Option<Worst>,
}

/// The directional albedo before and after, linear RGB.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Albedo {
    /// Elevation of the viewer in degrees.
    pub theta_deg: f64,
    /// Of the source.
    pub before: [f64; 3],
    /// Of the file.
    pub after: [f64; 3],
}

/// What a conversion did.
#[derive(Debug, Clone, PartialEq)]
pub struct ConversionReport {
    /// The format's name.
    pub format: &'static str,
    /// The layout, for people.
    pub layout: String,
    /// Its size, for people.
    pub size: String,
    /// The channels by name.
    pub channels: Vec<String>,
    /// Whether the numbers were copied rather than resampled.
    pub copied: bool,
    /// Bytes of the file.
    pub bytes: u64,
    /// The difference of the file, read again, from the source.
    pub difference: Difference,
    /// Albedos, by Riemann sums over 96 × 192 directions.
    pub albedo: Vec<Albedo>,
    /// Negative values of the source, which count as 0.
    pub negative: u64,
    /// Missing values of the source, which were filled.
    pub missing: u64,
    /// What the file doesn't have and the source has.
    pub lost: Vec<String>,
    /// What was done to the numbers.
    pub notes: Vec<String>,
}

/// Reads the file that was made and compares it with its source.
pub(super) fn compare(
    source: &Source,
    path: &Path,
    format: &Format,
    written: &Measurement,
    copied: bool,
) -> Result<ConversionReport, BrdfError> {
    let after = read_back(path)?;
    let component = &after.measurement().components[0];
    let found = source.measured().map(Measured::found);
    let channels = &after.measurement().channels;
    Ok(ConversionReport {
        format: format.name,
        layout: component.data.name(),
        size: component.data.size(),
        channels: channels.iter().map(ToString::to_string).collect(),
        copied,
        bytes: std::fs::metadata(path).map_or(0, |m| m.len()),
        difference: difference(source, &after),
        albedo: albedos(source, &after),
        negative: found.map_or(0, |f| f.negative),
        missing: found.map_or(0, |f| f.missing),
        lost: lost(source, written, &after),
        notes: after.found().notes.clone(),
    })
}

/// A pair of directions on the front, kind by kind.
fn pair(rng: &mut Rng, k: u32) -> (Vec3<f64>, Vec3<f64>) {
    let mut uniform = |least: f64, most: f64| {
        let z = least + (most - least) * rng.next_f64();
        around_axis(rng.next_f64(), (1.0 - z * z).sqrt(), z)
    };
    let wo = uniform(0.01, 1.0);
    match k % 4 {
        0 => {
            let off = uniform(0.01, 1.0) * 0.2;
            let z = (wo.z + off.z - 0.1).max(0.01);
            (Vec3::new(off.x - wo.x, off.y - wo.y, z).normalize(), wo)
        }
        1 => (uniform(0.01, 0.26), wo),
        _ => (uniform(0.01, 1.0), wo),
    }
}

/// The pair with the signs of a side.
fn on_side(side: Side, (wi, wo): (Vec3<f64>, Vec3<f64>)) -> (Vec3<f64>, Vec3<f64>) {
    let put = |w: Vec3<f64>, front: bool| Vec3::new(w.x, w.y, if front { w.z } else { -w.z });
    (put(wi, side.from_front()), put(wo, side.to_front()))
}

fn difference(source: &Source, after: &Measured) -> Difference {
    let mut rng = Rng::from_name("conversion");
    let sides = after.sides();
    let mut sums = [[0.0; 2]; 2];
    let mut worst: Option<(f64, Worst)> = None;
    for k in 0..PAIRS {
        let side = sides[k as usize % sides.len()];
        let (wi, wo) = on_side(side, pair(&mut rng, k / sides.len() as u32));
        let [before, after] = [source.rgb(wi, wo), after.eval(wi, wo)].map(luminance);
        let weight = (wi.z * wo.z).abs();
        for (sum, w) in sums.iter_mut().zip([1.0, weight]) {
            sum[0] += w * w * (before - after) * (before - after);
            sum[1] += w * w * before * before;
        }
        let size = weight * (before - after).abs();
        if worst.is_none_or(|(largest, _)| size > largest) {
            let here = Worst {
                wi,
                wo,
                before,
                after,
            };
            worst = Some((size, here));
        }
    }
    let relative = |[error, size]: [f64; 2]| (error / size.max(1e-300)).sqrt();
    Difference {
        pairs: PAIRS,
        rms: (sums[0][0] / f64::from(PAIRS)).sqrt(),
        relative_rms: relative(sums[0]),
        weighted_relative_rms: relative(sums[1]),
        worst: worst.map(|(_, w)| w),
    }
}

fn albedos(source: &Source, after: &Measured) -> Vec<Albedo> {
    const ROWS: u32 = 96;
    const COLUMNS: u32 = 192;
    let side = after.sides()[0];
    let of_viewer = |theta_deg: f64| {
        let wo = spherical_direction(theta_deg * PI / 180.0, 0.4);
        let (mut before, mut now) = ([0.0; 3], [0.0; 3]);
        for row in 0..ROWS {
            // Even steps of sin²θ are even projected solid angles.
            let s2 = (f64::from(row) + 0.5) / f64::from(ROWS);
            for column in 0..COLUMNS {
                let turn = (f64::from(column) + 0.5) / f64::from(COLUMNS);
                let wi = around_axis(turn, s2.sqrt(), (1.0 - s2).sqrt());
                let (wi, wo) = on_side(side, (wi, wo));
                let pair = [source.rgb(wi, wo), after.eval(wi, wo)];
                for (sum, f) in [&mut before, &mut now].into_iter().zip(pair) {
                    for k in 0..3 {
                        sum[k] += f[k] * 0.5 * TAU / f64::from(ROWS * COLUMNS);
                    }
                }
            }
        }
        Albedo {
            theta_deg,
            before,
            after: now,
        }
    };
    ALBEDO_DEG.into_iter().map(of_viewer).collect()
}

/// What of the source the file doesn't have.
fn lost(source: &Source, written: &Measurement, after: &Measured) -> Vec<String> {
    let mut lost = Vec::new();
    let sides = after.sides();
    for side in source.sides() {
        if !sides.contains(&side) {
            lost.push(format!("the component {}", side.name()));
        }
    }
    if after.is_isotropic() && !source.is_isotropic() {
        lost.push(format!(
            "anisotropy: turning the surface changed the source by up to {:.0} % of its mean",
            100.0 * anisotropy(source)
        ));
    }
    if after.is_reciprocal() {
        let worst = unreciprocal(source);
        if worst > 1e-6 {
            lost.push(format!(
                "the order of the directions: exchanging them changed the source by up to {worst:.2e} of its value"
            ));
        }
    }
    let Some(original) = source.measurement() else {
        return lost;
    };
    let kept = &after.measurement().channels;
    let gone = original.channels.iter().filter(|c| !kept.contains(c));
    let gone: Vec<String> = gone.map(ToString::to_string).collect();
    if !gone.is_empty() {
        let shown = if gone.len() > 6 {
            format!("{}, … {}", gone[..3].join(", "), gone[gone.len() - 1])
        } else {
            gone.join(", ")
        };
        lost.push(format!("{} channels as they were: {shown}", gone.len()));
    }
    let uncertain = |m: &Measurement| m.components.iter().any(|c| c.uncertainty.is_some());
    if uncertain(original) && !uncertain(after.measurement()) {
        lost.push("the uncertainties".into());
    }
    let is = after.measurement().metadata.entries();
    let was = written.metadata.entries();
    let gone: Vec<&str> = was
        .iter()
        .map(|(key, _)| *key)
        .filter(|key| !matches!(*key, "provenance" | "quantity" | "unit"))
        .filter(|key| !is.iter().any(|(other, _)| other == key))
        .collect();
    if !gone.is_empty() {
        lost.push(format!("metadata: {}", gone.join(", ")));
    }
    lost
}

/// The largest change of luminance when both directions turn about the normal, over the mean.
fn anisotropy(source: &Source) -> f64 {
    let mut rng = Rng::from_name("anisotropy");
    let (mut worst, mut sum) = (0.0f64, 0.0);
    for k in 0..500 {
        let (wi, wo) = pair(&mut rng, k);
        let a = luminance(source.rgb(wi, wo));
        let (sin, cos) = Real::sin_cos(TAU * rng.next_f64());
        let b = luminance(source.rgb(turned(wi, cos, sin), turned(wo, cos, sin)));
        worst = worst.max((a - b).abs());
        sum += a;
    }
    worst / (sum / 500.0).max(1e-300)
}

/// The largest relative change of luminance when the directions are exchanged.
fn unreciprocal(source: &Source) -> f64 {
    let mut rng = Rng::from_name("reciprocity");
    let mut worst = 0.0f64;
    for k in 0..500 {
        let (wi, wo) = pair(&mut rng, k);
        let [a, b] = [source.rgb(wi, wo), source.rgb(wo, wi)].map(luminance);
        worst = worst.max((a - b).abs() / a.max(b).max(1e-9));
    }
    worst
}
