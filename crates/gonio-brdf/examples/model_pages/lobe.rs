//! A model's lobes in the plane of incidence: what their picture shows.

use gonio_brdf::{Brdf, Model};
use gonio_num::{Real, Vec3};

/// Angles of the viewers from the normal, in degrees.
pub const VIEWERS: [f64; 3] = [10.0, 45.0, 75.0];
/// The curves are evaluated so many times a degree.
const PER_DEGREE: i32 = 10;

/// What one viewer sees of light from each direction of the plane of incidence.
pub struct Lobe {
    /// Angle of the light in degrees, positive on the viewer's side of the normal, beyond 90 below the surface; and f |cosθi|
    /// in sr⁻¹, the mean of the colours.
    pub curve: Vec<(f64, f64)>,
    /// Angle of the light, and share of it that is scattered to the viewer, of each discrete direction.
    pub discrete: Vec<(f64, f64)>,
}

impl Lobe {
    /// The lobe that the viewer at `viewer` degrees sees.
    pub fn new(model: &Model<f64, 3>, viewer: f64) -> Self {
        let wo = direction(viewer);
        let end = if model.transmits() { 270 } else { 90 };
        let curve = (-90 * PER_DEGREE..=end * PER_DEGREE)
            .map(|k| f64::from(k) / f64::from(PER_DEGREE))
            .map(|degrees| (degrees, mean(model.eval_cos(direction(degrees), wo))))
            .collect();
        Self {
            curve,
            discrete: discrete(model, wo),
        }
    }

    /// The largest value of the curve.
    pub fn peak(&self) -> f64 {
        self.curve.iter().map(|at| at.1).fold(0.0, f64::max)
    }

    /// The angle, in degrees, over which the curve is above `value`.
    fn width_above(&self, value: f64) -> f64 {
        self.curve.iter().filter(|at| at.1 > value).count() as f64 / f64::from(PER_DEGREE)
    }
}

/// The direction at `degrees` from the normal in the plane of incidence.
pub fn direction(degrees: f64) -> Vec3<f64> {
    let (sin, cos) = Real::sin_cos(degrees.to_radians());
    Vec3::new(sin, 0.0, cos)
}

fn mean(c: [f64; 3]) -> f64 {
    (c[0] + c[1] + c[2]) / 3.0
}

/// The discrete directions in the plane of incidence, found by drawing: `u[2]` chooses among parts, and a few `u[0]` and `u[1]`
/// serve a model that chooses by them.
fn discrete(model: &Model<f64, 3>, wo: Vec3<f64>) -> Vec<(f64, f64)> {
    let mut found: Vec<(f64, f64)> = Vec::new();
    for k in 0..1024_u32 {
        let middle = |part: u32, of: u32| (f64::from(part) + 0.5) / f64::from(of);
        let u = [middle(k % 4, 4), middle(k / 4 % 4, 4), middle(k / 16, 64)];
        let s = model.sample(wo, u);
        if s.pdf <= 0.0 || !s.delta {
            continue;
        }
        let mut degrees = Real::atan2(s.wi.x, s.wi.z).to_degrees();
        if degrees < -90.0 {
            degrees += 360.0;
        }
        // The same direction, but for rounding.
        if found.iter().all(|at| (at.0 - degrees).abs() > 1e-6) {
            found.push((degrees, mean(s.weight) * s.pdf));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

/// The radial axis of a picture.
#[derive(Clone, Copy)]
pub struct Axis {
    /// The value at the outer ring; 0 where there is nothing but discrete directions.
    pub most: f64,
    /// Whether the radius is the cube root of the value, not the value.
    pub cube_root: bool,
}

impl Axis {
    /// The axis on which all `lobes` can be read: linear, unless one is tiny or thin beside another.
    pub fn new(lobes: &[Lobe]) -> Self {
        let peaks = lobes.iter().map(Lobe::peak).filter(|&p| p > 0.0);
        let (low, high) = peaks.fold((f64::INFINITY, 0.0), |(low, high), p| {
            (p.min(low), p.max(high))
        });
        if high == 0.0 {
            return Self {
                most: 0.0,
                cube_root: false,
            };
        }
        let thin = lobes
            .iter()
            .any(|lobe| lobe.peak() > 0.0 && lobe.width_above(0.1 * lobe.peak()) < 30.0);
        Self {
            most: round_up(high),
            cube_root: low < 0.2 * high || thin,
        }
    }

    /// The radius of `value` as a fraction of the outer ring's.
    pub fn radius(self, value: f64) -> f64 {
        let fraction = (value / self.most).max(0.0);
        if self.cube_root {
            Real::powf(fraction, 1.0 / 3.0)
        } else {
            fraction
        }
    }

    /// The values of the rings, the outer one first.
    pub fn rings(self) -> Vec<f64> {
        let mut rings = vec![self.most];
        if self.most == 0.0 {
            rings.clear();
        } else if self.cube_root {
            // Not so near the outer ring that their labels touch.
            let mut value = round_down_to_decade(self.most * 0.6);
            while self.radius(value) > 0.15 {
                rings.push(value);
                value /= 10.0;
            }
        } else {
            // 1.5, 3 and 6 in thirds, 5 in fifths, the others in quarters.
            let lead = self.most / round_down_to_decade(self.most);
            let parts = match (lead * 2.0).round() as u32 {
                3 | 6 | 12 => 3_u32,
                10 => 5,
                _ => 4,
            };
            rings.extend(
                (1..parts)
                    .rev()
                    .map(|k| self.most * f64::from(k) / f64::from(parts)),
            );
        }
        rings
    }
}

/// The largest power of ten that is not above `value` > 0.
fn round_down_to_decade(value: f64) -> f64 {
    let mut decade = 1.0;
    // A billionth more, so that 1000 is found in spite of rounding.
    while decade > value * (1.0 + 1e-9) {
        decade /= 10.0;
    }
    while decade * 10.0 <= value * (1.0 + 1e-9) {
        decade *= 10.0;
    }
    decade
}

/// The smallest of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten that is not below `value` > 0.
fn round_up(value: f64) -> f64 {
    let decade = round_down_to_decade(value);
    [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]
        .into_iter()
        .map(|lead| lead * decade)
        .find(|&round| round >= value * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}
