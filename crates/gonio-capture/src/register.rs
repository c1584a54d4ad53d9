//! The rotation between two views of the same surroundings, from the pictures alone.
//!
//! Both panoramas become pyramids of the logarithm of luminance, so that a difference of exposure is a constant. Coarsely,
//! thousands of rotations spread evenly over SO(3) are ranked by the weighted correlation; the best are refined by
//! Gauss–Newton, level by level, with Tukey's weights against what differs between the views: cameras, photographers, glints.

use crate::panorama::Panorama;
use crate::rotation::Rotation;
use crate::{CaptureError, solve};
use gonio_env::Layout;
use gonio_num::{Real, Vec3};
use rayon::prelude::*;
use std::f64::consts::PI;

/// The least correlation of the details of two views of one scene. Views of different scenes stay below 0.2.
pub const LEAST_CORRELATION: f64 = 0.35;
/// Rotations that are ranked: neighbours are about 10° apart.
const ROTATIONS: usize = 12_000;
/// Of these so many are refined.
const CANDIDATES: usize = 16;
/// And of these so many to the end.
const FINALISTS: usize = 4;
/// Rows of the levels: ranked, refined, judged.
const RANKED: usize = 16;
const JUDGED: usize = 64;
const FINEST: usize = 256;

/// How a view is turned against the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Registration {
    /// From the view's frame to the first's.
    pub rotation: Rotation,
    /// Correlation of the details, 1 if they are the same.
    pub correlation: f64,
    /// Standard deviation of the rotation \[rad], of the fit's residuals; 0 if it was given.
    pub sigma: f64,
}

/// One level of a pyramid.
struct Level {
    w: usize,
    h: usize,
    values: Vec<f32>,
    /// Confidence times solid angle.
    weights: Vec<f32>,
}

impl Level {
    fn finest(panorama: &Panorama) -> Self {
        let image = &panorama.image;
        let luminance = |p: &[f32; 3]| 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
        let (mut sum, mut n) = (0.0_f64, 0.0_f64);
        for (p, c) in image.pixels.iter().zip(&panorama.confidence) {
            sum += f64::from(luminance(p) * c);
            n += f64::from(*c);
        }
        let floor = (0.01 * sum / n.max(1e-30)).max(1e-30) as f32;
        Self {
            w: image.width,
            h: image.height,
            values: image
                .pixels
                .iter()
                .map(|p| Real::ln(luminance(p) + floor))
                .collect(),
            weights: panorama
                .confidence
                .iter()
                .enumerate()
                .map(|(k, c)| c * panorama.solid_angle(k) as f32)
                .collect(),
        }
    }

    fn halved(&self) -> Self {
        let (w, h) = (self.w / 2, self.h / 2);
        let mut half = Self {
            w,
            h,
            values: vec![0.0; w * h],
            weights: vec![0.0; w * h],
        };
        for k in 0..w * h {
            let (i, j) = (2 * (k % w), 2 * (k / w));
            for q in [
                j * self.w + i,
                j * self.w + i + 1,
                (j + 1) * self.w + i,
                (j + 1) * self.w + i + 1,
            ] {
                half.values[k] += self.weights[q] * self.values[q];
                half.weights[k] += self.weights[q];
            }
            half.values[k] /= half.weights[k].max(1e-30);
        }
        half
    }

    /// Value and weight a solid angle of a unit direction, bilinear, each neighbour's value as much as it weighs.
    fn at(&self, d: Vec3<f64>) -> (f64, f64) {
        let [u, v] = Layout::LatLong.uv(d.to_f32()).map(f64::from);
        let x = u * self.w as f64 - 0.5;
        let y = (v * self.h as f64 - 0.5).clamp(0.0, (self.h - 1) as f64);
        let i = x.floor();
        let (s, j) = (x - i, y as usize);
        let t = y - j as f64;
        let i = (i + self.w as f64) as usize % self.w;
        let (i2, j2) = ((i + 1) % self.w, (j + 1).min(self.h - 1));
        let (mut value, mut weight) = (0.0, 0.0);
        for (i, j, share) in [
            (i, j, (1.0 - s) * (1.0 - t)),
            (i2, j, s * (1.0 - t)),
            (i, j2, (1.0 - s) * t),
            (i2, j2, s * t),
        ] {
            let k = j * self.w + i;
            let w = share * f64::from(self.weights[k]);
            value += w * f64::from(self.values[k]);
            weight += w;
        }
        (value / weight.max(1e-30), weight)
    }

    fn direction(&self, k: usize) -> Vec3<f64> {
        let uv = [(k % self.w) as f64 + 0.5, (k / self.w) as f64 + 0.5];
        Layout::LatLong.direction([uv[0] / self.w as f64, uv[1] / self.h as f64])
    }

    /// Without what a level of an eighth of the size shows: only details.
    fn details(&self) -> Self {
        let coarse = self.halved().halved().halved();
        let values = (0..self.values.len())
            .map(|k| self.values[k] - coarse.at(self.direction(k)).0 as f32)
            .collect();
        Self {
            w: self.w,
            h: self.h,
            values,
            weights: self.weights.clone(),
        }
    }
}

fn pyramid(panorama: &Panorama) -> Vec<Level> {
    let mut levels = vec![Level::finest(panorama)];
    while let Some(last) = levels.last()
        && last.h > RANKED
        && last.h.is_multiple_of(2)
    {
        let half = last.halved();
        levels.push(half);
    }
    levels.reverse();
    levels
}

/// Weighted correlation of two levels, `b` turned by `r`, over what both saw; −1 if that is less than a third of what `a` saw.
fn correlation(a: &Level, b: &Level, r: Rotation) -> f64 {
    let back = r.inverse();
    let (mut n, mut sa, mut sb, mut saa, mut sbb, mut sab) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let mut all = 0.0;
    for k in 0..a.values.len() {
        let wa = f64::from(a.weights[k]);
        all += wa;
        if wa <= 0.0 {
            continue;
        }
        let d = a.direction(k);
        let db = back.apply(d);
        let (vb, wb) = b.at(db);
        // Weights are per texel: divide by its solid angle to have a confidence.
        let confidence = (wb / texel_angle(b, db)).min(1.0);
        let w = wa * confidence;
        let va = f64::from(a.values[k]);
        n += w;
        sa += w * va;
        sb += w * vb;
        saa += w * va * va;
        sbb += w * vb * vb;
        sab += w * va * vb;
    }
    if n < 0.33 * all || n <= 0.0 {
        return -1.0;
    }
    let covariance = sab - sa * sb / n;
    let variances = (saa - sa * sa / n) * (sbb - sb * sb / n);
    covariance / variances.max(1e-30).sqrt()
}

/// Solid angle of a texel around the unit direction `d`; no smaller than half a texel beside a pole.
fn texel_angle(level: &Level, d: Vec3<f64>) -> f64 {
    let sin = d.x.hypot(d.z).max(0.5 * PI / level.h as f64);
    2.0 * PI * PI / (level.w * level.h) as f64 * sin
}

/// Finds the rotation that makes `view` agree with `reference`.
///
/// # Errors
/// [`CaptureError::DifferentScenes`] if no rotation does.
pub fn register(
    reference: &Panorama,
    view: &Panorama,
    names: [&str; 2],
) -> Result<Registration, CaptureError> {
    let (a, b) = (pyramid(reference), pyramid(view));
    let mut ranked: Vec<(f64, usize)> = (0..ROTATIONS)
        .into_par_iter()
        .map(|k| (correlation(&a[0], &b[0], Rotation::spread(k, ROTATIONS)), k))
        .collect();
    ranked.sort_by(|p, q| q.0.total_cmp(&p.0).then(p.1.cmp(&q.1)));
    let mut chosen: Vec<Rotation> = Vec::new();
    for (_, k) in ranked {
        let r = Rotation::spread(k, ROTATIONS);
        if chosen
            .iter()
            .all(|c| c.inverse().then_inner(r).angle() > 0.26)
        {
            chosen.push(r);
        }
        if chosen.len() == CANDIDATES {
            break;
        }
    }
    let judged = a.iter().position(|l| l.h >= JUDGED).unwrap_or(a.len() - 1);
    // All of them through the coarse levels, the best few of these to the level that judges.
    let mut candidates = refined(&a, &b, chosen, 0..=judged.saturating_sub(1));
    candidates.truncate(FINALISTS);
    let candidates = candidates.into_iter().map(|c| c.1).collect();
    let best = refined(&a, &b, candidates, judged..=judged)
        .first()
        .copied();
    let (correlation, mut rotation) = best.unwrap_or((-1.0, Rotation::IDENTITY));
    if correlation < LEAST_CORRELATION {
        return Err(CaptureError::DifferentScenes {
            file: names[1].into(),
            reference: names[0].into(),
            found: correlation,
            expected: LEAST_CORRELATION,
        });
    }
    let mut sigma = 0.0;
    for level in judged..a.len() {
        if a[level].h > FINEST {
            break;
        }
        if let Some((r, s)) = refine(&a[level], &b[level], rotation) {
            (rotation, sigma) = (r, s);
        }
    }
    Ok(Registration {
        rotation,
        correlation,
        sigma,
    })
}

/// The registration by a rotation that is known, with the correlation that it reaches.
pub fn given(reference: &Panorama, view: &Panorama, rotation: Rotation) -> Registration {
    let (a, b) = (pyramid(reference), pyramid(view));
    let judged = a.iter().position(|l| l.h >= JUDGED).unwrap_or(a.len() - 1);
    Registration {
        rotation,
        correlation: correlation(&a[judged].details(), &b[judged].details(), rotation),
        sigma: 0.0,
    }
}

/// Rotations refined through some levels, and the correlation of the last level's details; the best first.
fn refined(
    a: &[Level],
    b: &[Level],
    rotations: Vec<Rotation>,
    levels: std::ops::RangeInclusive<usize>,
) -> Vec<(f64, Rotation)> {
    let last = *levels.end();
    let (da, db) = (a[last].details(), b[last].details());
    let mut found: Vec<(f64, Rotation)> = rotations
        .into_par_iter()
        .map(|mut r| {
            for level in levels.clone() {
                r = refine(&a[level], &b[level], r).map_or(r, |f| f.0);
            }
            (correlation(&da, &db, r), r)
        })
        .collect();
    found.sort_by(|p, q| q.0.total_cmp(&p.0));
    found
}

/// Gauss–Newton for the rotation and a constant: b(R⁻¹ e^(−ω×) d) − a(d) − o. The rotation and its standard deviation.
fn refine(a: &Level, b: &Level, mut r: Rotation) -> Option<(Rotation, f64)> {
    let step = PI / b.h as f64;
    let mut offset = None;
    let mut sigma = 0.0;
    for _ in 0..12 {
        let back = r.inverse();
        let equations: Vec<([f64; 4], f64, f64)> = (0..a.values.len())
            .filter(|k| a.weights[*k] > 0.0)
            .filter_map(|k| {
                let d = a.direction(k);
                let db = back.apply(d);
                let (here, wb) = b.at(db);
                let w = f64::from(a.weights[k]) * (wb / texel_angle(b, db)).min(1.0);
                if w <= 0.0 {
                    return None;
                }
                let mut row = [0.0, 0.0, 0.0, -1.0];
                let axes = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)];
                for (entry, (x, y, z)) in row.iter_mut().zip(axes) {
                    // e^(−ω×) d = d + d × ω
                    let move_by = d.cross(Vec3::new(x, y, z)) * step;
                    let ahead = b.at(back.apply((d + move_by).normalize())).0;
                    let behind = b.at(back.apply((d - move_by).normalize())).0;
                    *entry = (ahead - behind) / (2.0 * step);
                }
                Some((row, here - f64::from(a.values[k]), w))
            })
            .collect();
        if equations.len() < 32 {
            return None;
        }
        let median = |mut v: Vec<f64>| {
            v.sort_by(f64::total_cmp);
            v[v.len() / 2]
        };
        let o = offset.unwrap_or_else(|| median(equations.iter().map(|e| e.1).collect()));
        let spread =
            (median(equations.iter().map(|e| (e.1 - o).abs()).collect()) / 0.6745).max(1e-4);
        let mut normal = solve::Normal::<4>::new();
        let (mut sum, mut total, mut squares) = (0.0, 0.0, 0.0);
        for (row, value, w) in &equations {
            let u = (value - o) / (4.685 * spread);
            if u.abs() >= 1.0 {
                continue;
            }
            let w = w * (1.0 - u * u).sq();
            normal.add(*row, o - value, w);
            sum += w * (value - o).sq();
            total += w;
            squares += w * w;
        }
        let [x, y, z, change] = normal.solve()?;
        let turn = Vec3::new(x, y, z);
        // Never farther than a texel and a half at a time: the gradient is only known that far.
        let length = turn.length();
        let turn = turn * (1.5 * step / length.max(1.5 * step));
        r = Rotation::of_vector(turn).then_inner(r);
        offset = Some(o + change);
        // Variances for weights that are not inverse variances: scaled by the mean square and by Σw²/Σw.
        let scale = sum / f64::max(total, 1e-30) * squares / f64::max(total, 1e-30);
        sigma = normal.variances()?[..3]
            .iter()
            .map(|v| v * scale)
            .sum::<f64>()
            .sqrt();
        if length < 1e-4 * step {
            break;
        }
    }
    Some((r, sigma))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use gonio_image::Image;
    use gonio_radiometry::sequence::Rng;

    /// Blobs of many sizes and brightnesses in directions that `name` chooses, seen in a frame turned by `r`.
    pub(crate) fn scene(name: &str, height: usize, r: Rotation) -> Panorama {
        let mut rng = Rng::from_name(name);
        let blobs: Vec<(Vec3<f64>, f64, f64)> = (0..60)
            .map(|_| {
                let z = 2.0 * rng.next_f64() - 1.0;
                let (s, c) = Real::sin_cos(2.0 * PI * rng.next_f64());
                let k = (1.0 - z * z).sqrt();
                let d = Vec3::new(k * c, k * s, z);
                (
                    d,
                    Real::exp(2.0 + 4.0 * rng.next_f64()),
                    Real::exp(3.0 * rng.next_f64()),
                )
            })
            .collect();
        let mut image = Image::new(2 * height, height);
        for k in 0..image.pixels.len() {
            let d = r.apply(crate::panorama::direction(&image, k));
            let sum: f64 = blobs
                .iter()
                .map(|(c, n, l)| l * Real::exp(n * (c.dot(d) - 1.0)))
                .sum();
            image.pixels[k] = [(0.3 + sum) as f32; 3];
        }
        let n = image.pixels.len();
        Panorama {
            image,
            confidence: vec![1.0; n],
            sigma: vec![0.01; n],
            clipped: vec![0.0; n],
        }
    }

    /// Interpolation makes residuals of some 1e-3 where the gradient is about 1 a radian and 8,000 texels average: far below
    /// a hundredth of a texel, 0.01 · π/128 = 2.5e-4 rad.
    #[test]
    fn a_large_turn_and_another_exposure_are_found() {
        let turn = Rotation::of_angles(2.0, 0.4, -0.3);
        let reference = scene("register", 128, Rotation::IDENTITY);
        let mut view = scene("register", 128, turn);
        for p in &mut view.image.pixels {
            *p = p.map(|c| 3.0 * c);
        }
        let found = register(&reference, &view, ["a", "b"]).unwrap();
        let error = found.rotation.inverse().then_inner(turn).angle();
        assert!(error < 2.5e-4, "{error} {found:?}");
        // Blobs as narrow as 4° on texels of 2.8°: the details of the two samplings differ, but are the same blobs.
        assert!(found.correlation > 0.8, "{found:?}");
    }

    #[test]
    fn different_scenes_are_refused() {
        let reference = scene("one scene", 64, Rotation::IDENTITY);
        let view = scene("another scene", 64, Rotation::IDENTITY);
        let error = register(&reference, &view, ["a", "b"]).unwrap_err();
        assert!(
            matches!(error, CaptureError::DifferentScenes { .. }),
            "{error}"
        );
    }
}
