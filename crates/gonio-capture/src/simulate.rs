//! Photographs of a ball that were never taken: the evidence for everything else in this crate.
//!
//! A pinhole camera at the origin, or one infinitely far away, sees a sphere; each ray is intersected with it (a quadratic,
//! independent of [`Ball`](crate::Ball)'s trigonometry), mirrored, and brings the radiance of its direction. Then the camera's
//! faults: vignetting, noise, a response curve, clipping, 8 or 16 bits.

use crate::photo::{Exif, Photo};
use crate::{BallMaterial, Projection, Rotation};
use gonio_image::{Image, RawData, RawImage};
use gonio_num::{Real, Vec3};
use gonio_radiometry::sequence::Rng;
use rayon::prelude::*;

/// What stands before the camera.
#[derive(Debug, Clone, Copy)]
pub struct Studio {
    /// Pixels.
    pub size: [usize; 2],
    /// The camera.
    pub projection: Projection,
    /// The ball's centre in the camera's frame, in radii of the ball; for an orthographic camera x and y count.
    pub centre: Vec3<f64>,
    /// Radius \[pixels] of the ball for an orthographic camera.
    pub radius: f64,
    /// From the camera's frame to the world's.
    pub rotation: Rotation,
    /// What the ball is made of; `None` is a diffuse grey ball, lit as `shade` says.
    pub material: Option<BallMaterial>,
    /// Half-angle \[rad], around the direction from the ball to the camera, of a dark figure: the photographer.
    pub photographer: f64,
    /// Rays along a side of each pixel.
    pub rays: usize,
}

/// How the camera turns light into codes.
#[derive(Debug, Clone, Copy)]
pub struct Film<'a> {
    /// Exposures \[s], one a photograph.
    pub exposures: &'a [f64],
    /// The response, from relative exposure to \[0, 1]; increasing.
    pub response: fn(f64) -> f64,
    /// Electrons of a saturated pixel: shot noise is the root of their number. 0 for no noise.
    pub full_well: f64,
    /// Share of light lost in the picture's corners, which grows with the square of the distance from the middle.
    pub vignetting: f64,
    /// 16 bits instead of 8.
    pub deep: bool,
}

impl Studio {
    /// The radiance that arrives at the camera. `light` is the radiance from a direction of the world; `shade` the radiance of a
    /// diffuse ball whose normal that is. Behind the ball stands `light` itself.
    pub fn radiance(
        &self,
        light: &(dyn Fn(Vec3<f64>) -> [f64; 3] + Sync),
        shade: &(dyn Fn(Vec3<f64>) -> [f64; 3] + Sync),
    ) -> Image {
        let [w, h] = self.size;
        let pixels: Vec<[f32; 3]> = (0..w * h)
            .into_par_iter()
            .map(|k| {
                let mut sum = [0.0; 3];
                for r in 0..self.rays * self.rays {
                    let inside = |i: usize| (i as f64 + 0.5) / self.rays as f64;
                    let at = [
                        (k % w) as f64 + inside(r % self.rays),
                        (k / w) as f64 + inside(r / self.rays),
                    ];
                    let seen = self.ray(at, light, shade);
                    for c in 0..3 {
                        sum[c] += seen[c];
                    }
                }
                sum.map(|s| (s / (self.rays * self.rays) as f64) as f32)
            })
            .collect();
        Image {
            width: w,
            height: h,
            pixels,
        }
    }

    fn ray(
        &self,
        [x, y]: [f64; 2],
        light: &dyn Fn(Vec3<f64>) -> [f64; 3],
        shade: &dyn Fn(Vec3<f64>) -> [f64; 3],
    ) -> [f64; 3] {
        let (origin, ray) = match self.projection {
            Projection::Perspective { focal, principal } => {
                let d = Vec3::new((x - principal[0]) / focal, (principal[1] - y) / focal, -1.0);
                (Vec3::new(0.0, 0.0, 0.0), d.normalize())
            }
            Projection::Orthographic => {
                let [w, h] = self.size.map(|n| 0.5 * n as f64);
                let at = Vec3::new((x - w) / self.radius, (h - y) / self.radius, 10.0);
                (at, Vec3::new(0.0, 0.0, -1.0))
            }
        };
        // |o + t r − c|² = 1
        let from = origin - self.centre;
        let b = from.dot(ray);
        let c = from.dot(from) - 1.0;
        let discriminant = b * b - c;
        if discriminant < 0.0 {
            return light(self.rotation.apply(ray));
        }
        let n = (from + ray * (-b - discriminant.sqrt())).normalize();
        let cos = -n.dot(ray);
        let Some(material) = self.material else {
            return shade(self.rotation.apply(n));
        };
        let d = ray + n * (2.0 * cos);
        let towards = match self.projection {
            Projection::Orthographic => Vec3::new(0.0, 0.0, 1.0),
            Projection::Perspective { .. } => (-self.centre).normalize(),
        };
        if d.dot(towards) > Real::cos(self.photographer) && self.photographer > 0.0 {
            return [0.004; 3];
        }
        let (l, f) = (light(self.rotation.apply(d)), material.reflectance(cos));
        [0, 1, 2].map(|c| l[c] * f[c])
    }
}

impl Film<'_> {
    /// Exposes `radiance`, once for each exposure; `name` seeds the noise.
    pub fn expose(&self, radiance: &Image, name: &str) -> Vec<Photo> {
        let (w, h) = (radiance.width, radiance.height);
        let corner = (w * w + h * h) as f64 / 4.0;
        self.exposures
            .iter()
            .enumerate()
            .map(|(shot, exposure)| {
                let name = format!("{name} {shot}");
                let mut rng = Rng::from_name(&name);
                let codes: Vec<[f64; 3]> = radiance
                    .pixels
                    .iter()
                    .enumerate()
                    .map(|(k, p)| {
                        let x = (k % w) as f64 + 0.5 - 0.5 * w as f64;
                        let y = (k / w) as f64 + 0.5 - 0.5 * h as f64;
                        let loss = 1.0 - self.vignetting * (x * x + y * y) / corner;
                        p.map(|l| self.code(f64::from(l) * exposure * loss, &mut rng))
                    })
                    .collect();
                let data = if self.deep {
                    let code = |x: f64| (65535.0 * x + 0.5) as u16;
                    RawData::U16(
                        codes
                            .iter()
                            .map(|&[r, g, b]| [code(r), code(g), code(b), 65535])
                            .collect(),
                    )
                } else {
                    let code = |x: f64| (255.0 * x + 0.5) as u8;
                    RawData::U8(
                        codes
                            .iter()
                            .map(|&[r, g, b]| [code(r), code(g), code(b), 255])
                            .collect(),
                    )
                };
                let picture = RawImage {
                    width: w,
                    height: h,
                    data,
                    has_alpha: false,
                };
                let exif = Exif {
                    time_s: Some(*exposure),
                    ..Exif::default()
                };
                Photo::new(name, picture, exif)
            })
            .collect()
    }

    fn code(&self, light: f64, rng: &mut Rng) -> f64 {
        let noisy = if self.full_well > 0.0 {
            let r = (-2.0 * Real::ln(1.0 - rng.next_f64())).sqrt();
            let normal = r * Real::cos(std::f64::consts::TAU * rng.next_f64());
            // Reading adds the noise of some ten electrons.
            light + normal * (light.max(0.0) / self.full_well + (10.0 / self.full_well).sq()).sqrt()
        } else {
            light
        };
        (self.response)(noisy.clamp(0.0, 1.0)).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Ball;

    /// The colour of a direction is the direction: the photograph of that light tells the mirrored direction of each pixel.
    #[test]
    fn rays_agree_with_the_balls_geometry() {
        let principal = [40.0, 30.0];
        let studio = Studio {
            size: [80, 60],
            projection: Projection::Perspective {
                focal: 100.0,
                principal,
            },
            centre: Vec3::new(0.6, -0.3, -5.0),
            radius: 0.0,
            rotation: Rotation::IDENTITY,
            material: Some(BallMaterial::Perfect),
            photographer: 0.0,
            rays: 1,
        };
        let image = studio.radiance(&|d| d.to_array(), &|_| [0.0; 3]);
        let distance = studio.centre.length();
        let ball = Ball::new(
            studio.projection,
            [40.0 + 100.0 * 0.6 / 5.0, 30.0 + 100.0 * 0.3 / 5.0],
            100.0 / (distance * distance - 1.0).sqrt(),
        );
        assert!((ball.distance() - distance).abs() < 1e-12);
        let mut seen = 0;
        for (k, p) in image.pixels.iter().enumerate() {
            let at = [(k % 80) as f64 + 0.5, (k / 80) as f64 + 0.5];
            if let Some(hit) = ball.mirrored(at) {
                seen += 1;
                let found = Vec3::new(p[0], p[1], p[2]).to_f64();
                // Single precision of the picture.
                assert!((found - hit.direction).length() < 1e-6, "{at:?}");
            }
        }
        assert!(seen > 1000);
    }
}
