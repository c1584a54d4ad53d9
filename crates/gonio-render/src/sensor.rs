//! Radiometric sensors: irradiance, radiant exitance, radiance and flux of a scene, each with its standard error.
//!
//! Readings are means of independent samples of an [`Integrator`], so the standard error is the sample standard deviation
//! over √n, and a 95 % confidence interval is about two of them on each side.
//!
//! A sensor may be inside a body of glass or water: readings are then of the radiance there, n² times that outside where nothing is lost, and
//! what the body absorbs on the way is taken off.

use crate::integrator::Vertex;
use crate::{Integrator, RayCounts, RenderError};
use gonio_brdf::{Model, ModelSpec};
use gonio_num::{Frame, Vec3};
use gonio_radiometry::sequence::{SampleStream, SamplerKind};
use gonio_radiometry::warp;
use gonio_scene::{Interior, Ray, Scene, SurfacePoint};
use gonio_verify::statistics::Moments;
use rayon::prelude::*;
use std::borrow::Cow;
use std::f64::consts::PI;

/// A reading with its unit.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Reading {
    /// The quantity: "irradiance", say.
    pub quantity: &'static str,
    /// Its unit: "W m⁻²", say.
    pub unit: &'static str,
    /// Red, green and blue.
    pub value: [f64; 3],
    /// Standard error of each, when the reading was sampled; none for a closed form.
    pub standard_error: Option<[f64; 3]>,
    /// Samples taken; 0 for a closed form.
    pub samples: u64,
    /// Samples that were not finite or negative. They count as no light.
    pub rejected: u64,
}

/// How a reading is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorOptions {
    /// How the reflection equation is solved behind the sensor.
    pub integrator: Integrator,
    /// Samples, at least 2.
    pub samples: u64,
    /// Seed of the independent sequence.
    pub seed: u64,
}

impl Default for SensorOptions {
    /// Path tracing, 65 536 samples, seed 0.
    fn default() -> Self {
        Self {
            integrator: Integrator::default(),
            samples: 1 << 16,
            seed: 0,
        }
    }
}

/// A flat, one-sided detector in the shape of a parallelogram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parallelogram {
    /// One corner.
    pub corner: Vec3<f32>,
    /// One side.
    pub side_u: Vec3<f32>,
    /// The other side. The detector looks along side_u × side_v.
    pub side_v: Vec3<f32>,
}

/// Irradiance E = ∫ L(ω) cosθ dω at point `p` of a surface with unit normal `n` \[W m⁻²] (7).
///
/// Estimated as the reflection of a white Lambertian receiver, whose BRDF is 1/π: E = π Lr. So every light is sampled as
/// in a picture, indirect light included.
///
/// # Errors
/// Fewer than 2 samples, or a normal that has no direction.
pub fn irradiance(
    scene: &Scene,
    p: Vec3<f32>,
    n: Vec3<f32>,
    options: &SensorOptions,
) -> Result<Reading, RenderError> {
    let n = unit("normal", n)?;
    let receiver = white_receiver();
    let estimate = mean(options, |stream| {
        received(scene, &receiver, p, n, options, stream)
    })?;
    Ok(estimate.reading("irradiance", "W m⁻²", PI))
}

/// Radiant exitance M = ∫ L(ω) cosθ dω leaving the surface at point `p` into the side of unit normal `n` \[W m⁻²]: what it
/// emits, reflects, and lets through.
///
/// The surface is the one that rays toward `p` meet, started on the side of `n` at `distance` from it; choose it smaller
/// than the gap to whatever else is near.
///
/// # Errors
/// Fewer than 2 samples, a normal that has no direction, or a distance that is not positive.
pub fn radiant_exitance(
    scene: &Scene,
    p: Vec3<f32>,
    n: Vec3<f32>,
    distance: f32,
    options: &SensorOptions,
) -> Result<Reading, RenderError> {
    let n = unit("normal", n)?;
    if !(distance > 0.0 && distance.is_finite()) {
        return Err(RenderError::Parameter {
            option: "distance",
            found: distance.to_string(),
            expected: "a positive number",
        });
    }
    let frame = Frame::from_normal(n);
    let estimate = mean(options, |stream| {
        let away = frame.to_world(warp::cosine_hemisphere(stream.next_2d()));
        let ray = Ray {
            origin: p + away * distance,
            direction: -away,
            t_max: 2.0 * distance,
        };
        arriving(scene, &ray, &scene.interior_at(ray.origin), options, stream)
    })?;
    Ok(estimate.reading("radiant exitance", "W m⁻²", PI))
}

/// Radiance L that arrives at `origin` from `direction` \[W m⁻² sr⁻¹].
///
/// # Errors
/// Fewer than 2 samples, or a direction of length 0.
pub fn radiance(
    scene: &Scene,
    origin: Vec3<f32>,
    direction: Vec3<f32>,
    options: &SensorOptions,
) -> Result<Reading, RenderError> {
    let ray = Ray {
        origin,
        direction: unit("direction", direction)?,
        t_max: f32::INFINITY,
    };
    let interior = scene.interior_at(origin);
    let estimate = mean(options, |stream| {
        arriving(scene, &ray, &interior, options, stream)
    })?;
    Ok(estimate.reading("radiance", "W m⁻² sr⁻¹", 1.0))
}

/// Radiant flux Φ = ∫∫ L cosθ dω dA that `detector` receives on the side it looks to \[W].
///
/// # Errors
/// Fewer than 2 samples, or a detector without area.
pub fn flux(
    scene: &Scene,
    detector: &Parallelogram,
    options: &SensorOptions,
) -> Result<Reading, RenderError> {
    let across = detector.side_u.to_f64().cross(detector.side_v.to_f64());
    let area = across.length();
    let n = unit("detector's area", across.to_f32())?;
    let receiver = white_receiver();
    let estimate = mean(options, |stream| {
        let [u, v] = stream.next_2d();
        let p = detector.corner + detector.side_u * u + detector.side_v * v;
        received(scene, &receiver, p, n, options, stream)
    })?;
    Ok(estimate.reading("radiant flux", "W", PI * area))
}

/// The radiance that arrives along a ray.
fn arriving(
    scene: &Scene,
    ray: &Ray,
    interior: &Interior,
    options: &SensorOptions,
    stream: &mut SampleStream,
) -> [f32; 3] {
    let mut counts = RayCounts::default();
    options
        .integrator
        .radiance(scene, ray, interior, stream, &mut counts)
        .radiance
}

/// The receiver's radiance: irradiance / π.
fn received(
    scene: &Scene,
    receiver: &Model<f32, 3>,
    p: Vec3<f32>,
    n: Vec3<f32>,
    options: &SensorOptions,
    stream: &mut SampleStream,
) -> [f32; 3] {
    let frame = Frame::from_normal(n);
    let point = on_detector(scene, p, &frame);
    let interior = scene.interior_at(point.offset_origin(n));
    let vertex = Vertex {
        bounds_a_body: false,
        point,
        frame,
        model: Cow::Borrowed(receiver),
        transmits: false,
        wo: Vec3::new(0.0, 0.0, 1.0),
        wo_world: n,
        albedo: [1.0; 3],
        material: 0,
        distance: 0.0,
        foreshortens: true,
    };
    options
        .integrator
        .reflected(scene, vertex, &interior, stream, &mut RayCounts::default())
}

/// A point of a detector. Detectors often lie on a surface of the scene, up to rounding: rays start far enough from it not
/// to meet it, 1e-5 of the scene's extent.
fn on_detector(scene: &Scene, p: Vec3<f32>, frame: &Frame<f32>) -> SurfacePoint {
    let radius = scene.bounds().radius();
    let extent = if radius.is_finite() {
        radius.max(p.length())
    } else {
        p.length()
    };
    SurfacePoint {
        p,
        error: 1e-5 * extent,
        ng: frame.n,
        ns: frame.n,
        tangent: frame.s,
        bitangent_sign: 1.0,
        uv: [0.0; 2],
        uv1: [0.0; 2],
        colour: [1.0; 4],
        t: 0.0,
        instance: u32::MAX,
        primitive: u32::MAX,
    }
}

fn white_receiver() -> Model<f32, 3> {
    ModelSpec::from_pairs("lambertian", [("reflectance", "1")])
        .and_then(|spec| spec.build())
        .expect("invariant: a white Lambertian is a valid model")
}

/// `v` at length 1.
///
/// # Errors
/// Names `option` if `v` is zero or not finite.
pub fn unit(option: &'static str, v: Vec3<f32>) -> Result<Vec3<f32>, RenderError> {
    let v = v.to_f64();
    let length = v.length();
    if length > 0.0 && length.is_finite() {
        Ok((v / length).to_f32())
    } else {
        Err(RenderError::Parameter {
            option,
            found: format!("({}, {}, {})", v.x, v.y, v.z),
            expected: "a finite vector that is not zero",
        })
    }
}

/// The moments of each channel over samples.
#[derive(Default, Clone, Copy)]
struct Estimate {
    channels: [Moments; 3],
    rejected: u64,
}

impl Estimate {
    /// The mean times `factor`, with its standard error.
    fn reading(&self, quantity: &'static str, unit: &'static str, factor: f64) -> Reading {
        Reading {
            quantity,
            unit,
            value: self.channels.map(|c| factor * c.mean()),
            standard_error: Some(self.channels.map(|c| factor * c.variance_of_mean().sqrt())),
            samples: self.channels[0].count(),
            rejected: self.rejected,
        }
    }
}

/// Samples summed by one thread before the sums are added, in order: the bits do not depend on the number of threads.
const CHUNK: u64 = 1024;

fn mean(
    options: &SensorOptions,
    sample: impl Fn(&mut SampleStream) -> [f32; 3] + Sync,
) -> Result<Estimate, RenderError> {
    // A sample's index is a 32-bit number.
    if !(2..=u64::from(u32::MAX)).contains(&options.samples) {
        return Err(RenderError::Parameter {
            option: "samples",
            found: options.samples.to_string(),
            expected: "2 to 4294967295",
        });
    }
    let chunks: Vec<Estimate> = (0..options.samples.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut part = Estimate::default();
            for k in chunk * CHUNK..((chunk + 1) * CHUNK).min(options.samples) {
                let mut stream =
                    SampleStream::new(SamplerKind::Independent, options.seed, 0, k as u32);
                let mut l = sample(&mut stream);
                if l.iter().any(|l| !(l.is_finite() && *l >= 0.0)) {
                    part.rejected += 1;
                    l = [0.0; 3];
                }
                for (channel, l) in part.channels.iter_mut().zip(l) {
                    channel.push(f64::from(l));
                }
            }
            part
        })
        .collect();
    let mut total = Estimate::default();
    for part in chunks {
        total.rejected += part.rejected;
        for (sum, channel) in total.channels.iter_mut().zip(part.channels) {
            *sum = sum.merge(channel);
        }
    }
    Ok(total)
}
