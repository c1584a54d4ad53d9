//! [`Panorama`], what one view saw, unwrapped to a latitude–longitude picture.
//!
//! Texel (i, j) shows the mean radiance of its directions, each looked up where the ball shows it and divided by the ball's
//! reflectance there. Equal steps of direction are unequal steps of the photograph: near the rim a radian is few pixels
//! towards the centre and many around it, dω/dA = 1/(radial · tangential) with the two scales of
//! [`Place`](crate::ball::Place). So a texel takes as many samples along each of its sides as it takes to touch every pixel
//! in the longer direction: none is skipped, and flux is conserved.

use crate::ball::Ball;
use crate::{BallMaterial, Radiance, Rotation};
use gonio_env::Layout;
use gonio_image::Image;
use gonio_num::{Real, Vec3};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Samples along a side of a texel at most.
const MOST_SAMPLES: usize = 24;
/// Pixels between samples: less than the two that a bilinear look-up spans.
const SPACING: f64 = 1.5;

/// How a photograph is unwrapped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unwrap {
    /// Rows of the panorama; it has twice as many columns.
    pub height: usize,
    /// What the ball is made of.
    pub material: BallMaterial,
    /// Width \[pixels] of the outline's inner edge that is left out, because it is mixed with what is behind the ball.
    pub margin: f64,
    /// From the camera's frame to the panorama's.
    pub rotation: Rotation,
    /// Half-angle \[°] of the cone around the camera that shows the camera and its photographer.
    pub camera_deg: f64,
}

/// A panorama with what is known about each texel.
#[derive(Debug, Clone)]
pub struct Panorama {
    /// Mean radiance, lat-long; 0 where nothing was seen.
    pub image: Image,
    /// Confidence in \[0, 1]: share of the texel that was seen, times 0 where the camera stands, times how sharp it is: 1 if a
    /// texel has a pixel or more in each direction, ½ if the picture is magnified twice.
    pub confidence: Vec<f32>,
    /// Standard deviation of the luminance relative to it, of the photograph's noise.
    pub sigma: Vec<f32>,
    /// Share of the texel that is clipped in every exposure.
    pub clipped: Vec<f32>,
}

impl Panorama {
    /// Unwraps the `ball` of a photograph.
    pub fn unwrap(radiance: &Radiance, ball: &Ball, how: &Unwrap) -> Self {
        let (width, height) = (2 * how.height, how.height);
        let rows: Vec<Vec<Texel>> = (0..height)
            .into_par_iter()
            .map(|j| {
                (0..width)
                    .map(|i| texel(radiance, ball, how, i, j))
                    .collect()
            })
            .collect();
        let texels: Vec<Texel> = rows.into_iter().flatten().collect();
        Self {
            image: Image {
                width,
                height,
                pixels: texels.iter().map(|t| t.rgb).collect(),
            },
            confidence: texels.iter().map(|t| t.confidence).collect(),
            sigma: texels.iter().map(|t| t.sigma).collect(),
            clipped: texels.iter().map(|t| t.clipped).collect(),
        }
    }

    /// The unit direction of texel `k`'s centre.
    pub fn direction(&self, k: usize) -> Vec3<f64> {
        direction(&self.image, k)
    }

    /// Solid angle \[sr] of texel `k`.
    pub fn solid_angle(&self, k: usize) -> f64 {
        solid_angle(&self.image, k)
    }
}

/// The unit direction of the centre of texel `k` of a lat-long picture.
pub(crate) fn direction(image: &Image, k: usize) -> Vec3<f64> {
    let (w, h) = (image.width, image.height);
    let uv = [(k % w) as f64 + 0.5, (k / w) as f64 + 0.5];
    Layout::LatLong.direction([uv[0] / w as f64, uv[1] / h as f64])
}

/// Solid angle \[sr] of texel `k` of a lat-long picture: 2π/W (cos θ₀ − cos θ₁), exactly.
pub(crate) fn solid_angle(image: &Image, k: usize) -> f64 {
    let (w, h) = (image.width as f64, image.height as f64);
    let j = (k / image.width) as f64;
    2.0 * PI / w * (Real::cos(PI * j / h) - Real::cos(PI * (j + 1.0) / h))
}

#[derive(Default)]
struct Texel {
    rgb: [f32; 3],
    confidence: f32,
    sigma: f32,
    clipped: f32,
}

fn texel(radiance: &Radiance, ball: &Ball, how: &Unwrap, i: usize, j: usize) -> Texel {
    let (width, height) = (2 * how.height, how.height);
    let side = PI / height as f64;
    let at = |s: f64, t: f64| {
        let uv = [
            (i as f64 + s) / width as f64,
            (j as f64 + t) / height as f64,
        ];
        how.rotation.inverse().apply(Layout::LatLong.direction(uv))
    };
    let middle = at(0.5, 0.5);
    let row_sin = |t: f64| Real::sin((j as f64 + t) * side);
    // Just beside the blind cone the middle may be in it while a corner isn't: then as many samples as there may be.
    let (samples, sharp, pixels) = match ball.place(middle) {
        Some(p) => {
            let longer = (p.radial.max(p.tangential) * side / SPACING).ceil();
            let shorter = p.radial.min(p.tangential) * side;
            let n = if longer.is_finite() {
                longer as usize
            } else {
                MOST_SAMPLES
            };
            let area = p.radial * p.tangential * side * side * row_sin(0.5);
            (n.clamp(2, MOST_SAMPLES), shorter.min(1.0), area)
        }
        None => (MOST_SAMPLES, 0.0, 0.0),
    };
    let mut sum = [0.0; 3];
    let (mut seen, mut all, mut variance, mut clipped) = (0.0, 0.0, 0.0, 0.0);
    for b in 0..samples {
        let share = row_sin((b as f64 + 0.5) / samples as f64);
        for a in 0..samples {
            let d = at(
                (a as f64 + 0.5) / samples as f64,
                (b as f64 + 0.5) / samples as f64,
            );
            all += share;
            let Some(place) = ball.place(d) else { continue };
            if ball.outside(place.pixel) > -how.margin {
                continue;
            }
            let Some(p) = look_up(radiance, place.pixel) else {
                continue;
            };
            let reflected = how.material.reflectance(place.cos);
            for c in 0..3 {
                sum[c] += share * p.rgb[c] / reflected[c];
            }
            variance += share * p.variance;
            clipped += share * p.clipped;
            seen += share;
        }
    }
    if seen <= 0.0 {
        return Texel::default();
    }
    // Of the sharpness at the rim of the seen part nothing is known where the middle isn't seen.
    let confidence = seen / all * sharp * not_the_camera(ball, how, middle);
    Texel {
        rgb: sum.map(|s| (s / seen) as f32),
        confidence: confidence as f32,
        sigma: (variance / seen / pixels.max(1.0)).sqrt() as f32,
        clipped: (clipped / seen) as f32,
    }
}

/// 0 in the cone of the camera, 1 outside 1.3 times its angle.
fn not_the_camera(ball: &Ball, how: &Unwrap, d: Vec3<f64>) -> f64 {
    if how.camera_deg <= 0.0 {
        return 1.0;
    }
    let axis = ball.towards_camera();
    let angle = d.cross(axis).length().atan2(d.dot(axis)).to_degrees();
    let t = ((angle / how.camera_deg - 1.0) / 0.3).saturate();
    t * t * (3.0 - 2.0 * t)
}

struct Pixel {
    rgb: [f64; 3],
    variance: f64,
    clipped: f64,
}

/// Bilinear; `None` outside the photograph.
fn look_up(radiance: &Radiance, [x, y]: [f64; 2]) -> Option<Pixel> {
    let image = &radiance.image;
    let (x, y) = (x - 0.5, y - 0.5);
    let inside =
        x >= 0.0 && y >= 0.0 && x < (image.width - 1) as f64 && y < (image.height - 1) as f64;
    if !inside {
        return None;
    }
    let (i, j) = (x as usize, y as usize);
    let (s, t) = (x - i as f64, y - j as f64);
    let mut found = Pixel {
        rgb: [0.0; 3],
        variance: 0.0,
        clipped: 0.0,
    };
    for (di, dj, w) in [
        (0, 0, (1.0 - s) * (1.0 - t)),
        (1, 0, s * (1.0 - t)),
        (0, 1, (1.0 - s) * t),
        (1, 1, s * t),
    ] {
        let k = (j + dj) * image.width + i + di;
        for c in 0..3 {
            found.rgb[c] += w * f64::from(image.pixels[k][c]);
        }
        found.variance += w * f64::from(radiance.sigma[k]).sq();
        found.clipped += w * f64::from(u8::from(radiance.clipped[k]));
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Projection;

    fn flat(size: usize, value: f32) -> Radiance {
        Radiance {
            image: Image::filled(size, size, [value; 3]),
            sigma: vec![0.1; size * size],
            clipped: vec![false; size * size],
        }
    }

    fn how(material: BallMaterial) -> Unwrap {
        Unwrap {
            height: 32,
            material,
            margin: 1.0,
            rotation: Rotation::IDENTITY,
            camera_deg: 10.0,
        }
    }

    #[test]
    fn solid_angles_fill_the_sphere() {
        let image = Image::new(16, 8);
        let sum: f64 = (0..128).map(|k| solid_angle(&image, k)).sum();
        assert!((sum - 4.0 * PI).abs() < 1e-13);
    }

    /// The photograph of a ball in uniform light of radiance 1 shows its reflectance; divided out it is 1 everywhere seen.
    #[test]
    fn uniform_light_is_uniform_whatever_the_ball() {
        for material in [
            BallMaterial::Perfect,
            BallMaterial::Chrome,
            BallMaterial::F0([0.5; 3]),
        ] {
            let lens = Projection::Perspective {
                focal: 600.0,
                principal: [100.0; 2],
            };
            let ball = Ball::new(lens, [100.0; 2], 80.0);
            let mut photo = flat(200, 1.0);
            for k in 0..200 * 200 {
                let at = [(k % 200) as f64 + 0.5, (k / 200) as f64 + 0.5];
                if let Some(hit) = ball.mirrored(at) {
                    photo.image.pixels[k] = material.reflectance(hit.cos).map(|f| f as f32);
                }
            }
            let found = Panorama::unwrap(&photo, &ball, &how(material));
            let mut seen = 0.0;
            for (k, p) in found.image.pixels.iter().enumerate() {
                if p[1] > 0.0 {
                    seen += found.solid_angle(k);
                    // Bilinear in a reflectance that bends most within the last pixels before the rim.
                    assert!((p[1] - 1.0).abs() < 0.03, "{material} {k} {p:?}");
                }
            }
            assert!(seen > 0.93 * 4.0 * PI, "{seen}");
        }
    }

    #[test]
    fn the_camera_and_the_blind_cone_have_no_confidence() {
        let ball = Ball::new(Projection::Orthographic, [100.0; 2], 90.0);
        let found = Panorama::unwrap(&flat(200, 1.0), &ball, &how(BallMaterial::Perfect));
        for k in 0..found.confidence.len() {
            let d = found.direction(k);
            let from_camera = Real::acos(d.z).to_degrees();
            if from_camera < 9.9 {
                assert_eq!(found.confidence[k], 0.0);
            }
            // A pixel of 90 at the rim: β = acos(√(2/90)) is 81.4°, γ = 163°.
            if from_camera > 168.0 {
                assert_eq!(found.confidence[k], 0.0, "{d:?}");
            }
            if (20.0..120.0).contains(&from_camera) {
                assert_eq!(found.confidence[k], 1.0, "{d:?}");
            }
        }
    }
}
