//! Light that every exposure clipped, put back.
//!
//! What is missing is taken as one radiance X, in each channel, added to every clipped texel: of a clear sky that is the sun.
//! A grey ball's picture tells it. With E(n) the irradiance of the panorama as it is, and C(n) that of unit radiance from
//! the clipped texels, a diffuse ball shows
//!
//! ```text
//! O(n) = ρ/π (E(n) + X C(n)) = a E(n) + b C(n)       X = b / a
//! ```
//!
//! whatever its albedo and the exposure of its photograph: both are in a. A given illuminance on the ground tells it too, if
//! the panorama's luminance is known: X = (E_v / k − Y(E)) / Y(C), with k cd m⁻² for a unit of the panorama.

use crate::ball::Ball;
use crate::panorama::{direction, solid_angle};
use crate::{CaptureError, Radiance, solve};
use gonio_image::Image;
use gonio_num::{Real, Vec3};

/// Normals that are compared, on a grid over the ball's outline.
const GRID: usize = 40;
/// Rows to which the panorama is shrunk for its irradiance.
const COARSE: usize = 64;
/// Least cosine between a normal and the view: nearer the rim a rough ball shines.
const LEAST_COSINE: f64 = 0.3;

/// What was put back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Restored {
    /// Radiance added to clipped texels.
    pub radiance: [f64; 3],
    /// Its standard deviation, from the scatter of the fit; 0 for a given illuminance.
    pub sigma: [f64; 3],
    /// Solid angle \[sr] that is clipped.
    pub solid_angle: f64,
    /// Mean direction of what is clipped.
    pub direction: Vec3<f64>,
}

/// A light as a list of directions with radiance times solid angle.
struct Lights(Vec<(Vec3<f64>, [f64; 3])>);

impl Lights {
    fn irradiance(&self, n: Vec3<f64>) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (d, power) in &self.0 {
            let cos = d.dot(n).max(0.0);
            for c in 0..3 {
                sum[c] += cos * power[c];
            }
        }
        sum
    }

    /// A panorama, shrunk.
    fn of(image: &Image) -> Self {
        let k = (image.height / COARSE).max(1);
        let mut lights = Vec::new();
        for j in (0..image.height).step_by(k) {
            for i in (0..image.width).step_by(k) {
                let (mut towards, mut power) = (Vec3::new(0.0, 0.0, 0.0), [0.0; 3]);
                for y in j..(j + k).min(image.height) {
                    for x in i..(i + k).min(image.width) {
                        let q = y * image.width + x;
                        let omega = solid_angle(image, q);
                        towards += direction(image, q) * omega;
                        for (sum, l) in power.iter_mut().zip(image.pixels[q]) {
                            *sum += omega * f64::from(l);
                        }
                    }
                }
                lights.push((towards.normalize(), power));
            }
        }
        Self(lights)
    }

    /// Unit radiance from what is clipped, texel by texel.
    fn of_clipped(image: &Image, clipped: &[f32]) -> Self {
        let lit = clipped.iter().enumerate().filter(|(_, c)| **c > 0.0);
        Self(
            lit.map(|(k, c)| {
                (
                    direction(image, k),
                    [f64::from(*c) * solid_angle(image, k); 3],
                )
            })
            .collect(),
        )
    }

    fn power(&self) -> f64 {
        self.0.iter().map(|l| l.1[0]).sum()
    }

    fn towards(&self) -> Vec3<f64> {
        let zero = Vec3::new(0.0, 0.0, 0.0);
        self.0
            .iter()
            .fold(zero, |s, (d, p)| s + *d * p[0])
            .normalize()
    }
}

fn error(reason: impl Into<String>, help: &'static str) -> CaptureError {
    CaptureError::Restore {
        reason: reason.into(),
        help,
    }
}

fn nothing_clipped() -> CaptureError {
    error(
        "no texel is clipped in all exposures, so nothing is missing",
        "leave --grey-ball out",
    )
}

/// Puts back what a grey ball's photograph tells. The ball stands where the mirrored one stood, seen by the first camera.
///
/// # Errors
/// [`CaptureError::Restore`] if nothing is clipped, or the ball's shading doesn't determine it.
pub fn by_grey_ball(
    image: &mut Image,
    clipped: &[f32],
    photo: &Radiance,
    ball: &Ball,
) -> Result<Restored, CaptureError> {
    let missing = Lights::of_clipped(image, clipped);
    if missing.0.is_empty() {
        return Err(nothing_clipped());
    }
    let seen = Lights::of(image);
    let mut rows: Vec<([f64; 3], [f64; 3], [f64; 3])> = Vec::new();
    let [cx, cy] = ball.centre();
    for k in 0..GRID * GRID {
        let at = |i: usize| (2.0 * (i as f64 + 0.5) / GRID as f64 - 1.0) * ball.radius();
        let pixel = [cx + at(k % GRID), cy + at(k / GRID)];
        let Some(n) = ball.normal(pixel) else {
            continue;
        };
        if n.dot(ball.towards_camera()) < LEAST_COSINE {
            continue;
        }
        let (x, y) = (pixel[0].max(0.0) as usize, pixel[1].max(0.0) as usize);
        if x >= photo.image.width || y >= photo.image.height {
            continue;
        }
        let q = y * photo.image.width + x;
        if !photo.clipped[q] {
            let observed = photo.image.pixels[q].map(f64::from);
            rows.push((seen.irradiance(n), missing.irradiance(n), observed));
        }
    }
    let mut found = Restored {
        radiance: [0.0; 3],
        sigma: [0.0; 3],
        solid_angle: missing.power(),
        direction: missing.towards(),
    };
    for c in 0..3 {
        let (x, sigma) = ratio(&rows, c).ok_or_else(|| {
            error(
                "the grey ball's shading doesn't tell the clipped light from the rest",
                "photograph the grey ball so that light and shadow are both seen on it",
            )
        })?;
        (found.radiance[c], found.sigma[c]) = (x.max(0.0), sigma);
    }
    add(image, clipped, found.radiance);
    Ok(found)
}

/// X = b/a of O = a E + b C with Tukey's weights against spots, and its standard deviation.
fn ratio(rows: &[([f64; 3], [f64; 3], [f64; 3])], c: usize) -> Option<(f64, f64)> {
    if rows.len() < 30 {
        return None;
    }
    let mut weights = vec![1.0; rows.len()];
    let mut found = None;
    for _ in 0..10 {
        let mut normal = solve::Normal::<2>::new();
        for ((e, m, o), w) in rows.iter().zip(&weights) {
            normal.add([e[c], m[c]], o[c], *w);
        }
        let [a, b] = normal.solve()?;
        let residuals: Vec<f64> = rows
            .iter()
            .map(|(e, m, o)| o[c] - a * e[c] - b * m[c])
            .collect();
        let mut sizes: Vec<f64> = residuals.iter().map(|r| r.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let spread = (sizes[sizes.len() / 2] / 0.6745).max(1e-12);
        for (w, r) in weights.iter_mut().zip(&residuals) {
            let u = r / (4.685 * spread);
            *w = if u.abs() < 1.0 {
                (1.0 - u * u).sq()
            } else {
                0.0
            };
        }
        let [va, vb] = normal.variances()?;
        if a.is_nan() || a <= 0.0 {
            return None;
        }
        let x = b / a;
        found = Some((x, spread / a * (vb + x * x * va).max(0.0).sqrt()));
    }
    found
}

/// Puts back what an illuminance on level ground tells, and scales the panorama to luminance \[cd m⁻²].
///
/// - `lux`: illuminance \[lx] of an upward surface
/// - `unit`: luminance \[cd m⁻²] of a unit of the panorama, if known
///
/// If nothing is clipped, the panorama is only scaled, and `unit` isn't needed.
///
/// # Errors
/// [`CaptureError::Restore`] if something is clipped and `unit` isn't known, or the panorama without it is too bright already.
pub fn by_illuminance(
    image: &mut Image,
    clipped: &[f32],
    lux: f64,
    unit: Option<f64>,
) -> Result<Option<Restored>, CaptureError> {
    let up = Vec3::new(0.0, 1.0, 0.0);
    let luminance = |e: [f64; 3]| 0.2126 * e[0] + 0.7152 * e[1] + 0.0722 * e[2];
    let seen = luminance(Lights::of(image).irradiance(up));
    let missing = Lights::of_clipped(image, clipped);
    if missing.0.is_empty() {
        if seen <= 0.0 {
            return Err(error(
                "the panorama lights no level ground",
                "leave --lux out",
            ));
        }
        scale(image, lux / seen);
        return Ok(None);
    }
    let unit = unit.ok_or_else(|| {
        error(
            "an illuminance tells what is clipped only if the photographs' exposure is known in EXIF: time, F-number and ISO",
            "use photographs with EXIF data, or a grey ball: --grey-ball PHOTO",
        )
    })?;
    let from = luminance(missing.irradiance(up));
    if from <= 0.0 {
        return Err(error(
            "what is clipped stands below the horizon, where no illuminance of level ground tells it",
            "use a grey ball: --grey-ball PHOTO",
        ));
    }
    let x = (lux / unit - seen) / from;
    if x.is_nan() || x < 0.0 {
        return Err(error(
            format!(
                "without the clipped light the panorama gives {:.0} lx already, more than {lux} lx",
                seen * unit
            ),
            "check the illuminance, and the EXIF data of the photographs",
        ));
    }
    let found = Restored {
        radiance: [x; 3],
        sigma: [0.0; 3],
        solid_angle: missing.power(),
        direction: missing.towards(),
    };
    add(image, clipped, found.radiance);
    scale(image, unit);
    Ok(Some(Restored {
        radiance: [x * unit; 3],
        ..found
    }))
}

fn add(image: &mut Image, clipped: &[f32], radiance: [f64; 3]) {
    for (p, share) in image.pixels.iter_mut().zip(clipped) {
        for c in 0..3 {
            p[c] += (f64::from(*share) * radiance[c]) as f32;
        }
    }
}

fn scale(image: &mut Image, k: f64) {
    for p in &mut image.pixels {
        *p = p.map(|c| (f64::from(c) * k) as f32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Projection;
    use gonio_env::{Environment, Layout};

    /// A sky, dim below, with a sun of radiance 1,500 in some texels; the same clipped at 4; and which texels those are.
    fn skies() -> (Image, Image, Vec<f32>) {
        let mut truth = Image::new(128, 64);
        for k in 0..truth.pixels.len() {
            let d = direction(&truth, k);
            let sky = 0.6 + 0.4 * d.y as f32;
            truth.pixels[k] = [0.7 * sky, 0.8 * sky, sky];
            if d.dot(Vec3::new(0.5, 0.6, 0.6245)) > 0.9985 {
                truth.pixels[k] = [1_500.0, 1_200.0, 900.0];
            }
        }
        let clipped = truth
            .pixels
            .iter()
            .map(|p| f32::from(u8::from(p[0] > 10.0)))
            .collect();
        let mut cut = truth.clone();
        for p in &mut cut.pixels {
            *p = p.map(|c| c.min(4.0));
        }
        (truth, cut, clipped)
    }

    #[test]
    fn a_grey_ball_brings_the_sun_back() {
        let (truth, mut cut, clipped) = skies();
        let sky = Environment::from_image(truth.clone(), Layout::LatLong).unwrap();
        let ball = Ball::new(Projection::Orthographic, [20.0; 2], 19.0);
        let mut photo = Radiance {
            image: Image::new(40, 40),
            sigma: vec![0.0; 1600],
            clipped: vec![false; 1600],
        };
        // The exact irradiance, of the interpolated sky, times 0.18/π, in another exposure and with a tint.
        for k in 0..1600 {
            let at = [(k % 40) as f64 + 0.5, (k / 40) as f64 + 0.5];
            if let Some(n) = ball.normal(at) {
                let e = sky.irradiance(n.to_f32());
                photo.image.pixels[k] = [0, 1, 2].map(|c| (0.1 * e[c] * [1.0, 0.9, 0.8][c]) as f32);
            }
        }
        let found = by_grey_ball(&mut cut, &clipped, &photo, &ball).unwrap();
        // A normal is up to half a pixel of 19 off, 2.6 % of a radius and of the sun's cosine, at random: over 800 normals a few
        // thousandths. The bilinear sky has the sun's radiance in half a texel around it too, in both alike.
        for (x, t) in found.radiance.iter().zip([1_500.0, 1_200.0, 900.0]) {
            assert!((x / t - 1.0).abs() < 0.05, "{found:?}");
        }
        assert!(found.direction.dot(Vec3::new(0.5, 0.6, 0.6245)) > 0.9999);
        // Negative control: the clipped sky has a quarter of the irradiance, or less.
        let (_, dark, _) = skies();
        let e = |i: &Image| Lights::of(i).irradiance(found.direction)[1];
        assert!((e(&cut) / e(&truth) - 1.0).abs() < 0.05 && e(&dark) / e(&truth) < 0.4);
    }

    #[test]
    fn an_illuminance_brings_the_sun_back() {
        let (truth, cut, clipped) = skies();
        let up = Vec3::new(0.0, 1.0, 0.0);
        let e = Lights::of(&truth).irradiance(up);
        let lux = 20.0 * (0.2126 * e[0] + 0.7152 * e[1] + 0.0722 * e[2]);
        let mut found = cut.clone();
        let restored = by_illuminance(&mut found, &clipped, lux, Some(20.0))
            .unwrap()
            .unwrap();
        let e = Lights::of(&found).irradiance(up);
        let back = 0.2126 * e[0] + 0.7152 * e[1] + 0.0722 * e[2];
        // Single precision of the texels.
        assert!((back / lux - 1.0).abs() < 1e-5, "{restored:?}");
        // What can't be, and what isn't known, are errors.
        for (lux, unit) in [(0.1, Some(20.0)), (lux, None)] {
            assert!(by_illuminance(&mut cut.clone(), &clipped, lux, unit).is_err());
        }
        // Nothing clipped: only scaled.
        let mut plain = Image::filled(32, 16, [1.0; 3]);
        assert_eq!(
            by_illuminance(&mut plain, &[0.0; 512], 10.0 * std::f64::consts::PI, None).unwrap(),
            None
        );
        // Cosines at texels' centres, of rows Δ high, give π / cos(Δ/2): with Δ = π/16 0.48 % too much.
        let expected = 10.0 * Real::cos(std::f64::consts::PI / 32.0);
        assert!((f64::from(plain.pixels[7][1]) / expected - 1.0).abs() < 1e-6);
    }

    #[test]
    fn nothing_clipped_needs_no_grey_ball() {
        let mut plain = Image::filled(32, 16, [1.0; 3]);
        let photo = Radiance {
            image: Image::new(9, 9),
            sigma: vec![0.0; 81],
            clipped: vec![false; 81],
        };
        let ball = Ball::new(Projection::Orthographic, [4.0; 2], 4.0);
        assert!(by_grey_ball(&mut plain, &[0.0; 512], &photo, &ball).is_err());
    }
}
