//! [`Source`], what the tree knows of one light or of one triangle of it, and [`Summary`], of several.

use super::bounds::LightBounds;
use super::cone::Cone;
use crate::light::emitter::Emitter;
use crate::light::{Light, WHOLE, luminance};
use crate::{Aabb, Geometry, Shape};
use gonio_num::{Real, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// A light, or a triangle of one.
#[derive(Debug, Clone)]
pub(super) struct Source {
    pub light: u32,
    /// Of a mesh, or [`WHOLE`].
    pub primitive: u32,
    pub all: Summary,
    pub centre: Vec3<f32>,
    pub radius: f32,
}

/// Several sources.
#[derive(Debug, Clone, Copy)]
pub(super) struct Summary {
    pub bounds: Aabb,
    pub cone: Cone,
    /// θe, the largest.
    pub spread: f64,
    pub both_sides: bool,
    /// Σ Φ.
    pub power: f64,
    /// Σ of the intensities that the profiles turn the powers into, [`Cone::measure`].
    pub intensity: f64,
}

/// θe of a spot light, whose cone is θo: room for roundings, no more.
const SPOT_SPREAD: f64 = 0.01;

impl Summary {
    fn new(bounds: Aabb, cone: Cone, spread: f64, both_sides: bool, power: f64) -> Self {
        let mut all = Self {
            bounds,
            cone,
            spread,
            both_sides,
            power,
            intensity: 0.0,
        };
        all.intensity = power / all.solid_angle();
        all
    }

    /// The directions that it shines into, weighted by how much \[sr].
    fn solid_angle(&self) -> f64 {
        let one_side = self.cone.measure(self.spread);
        if self.both_sides {
            (2.0 * one_side).min(4.0 * PI)
        } else {
            one_side
        }
    }

    pub fn union(&self, other: &Self) -> Self {
        let both_sides = self.both_sides || other.both_sides;
        let mut theirs = other.cone;
        if both_sides && self.cone.axis.dot(theirs.axis) < 0.0 {
            theirs.axis = -theirs.axis;
        }
        Self {
            bounds: self.bounds.union(&other.bounds),
            cone: self.cone.union(&theirs),
            spread: self.spread.max(other.spread),
            both_sides,
            power: self.power + other.power,
            intensity: self.intensity + other.intensity,
        }
    }

    /// What it costs to have these sources together: power × solid angle × size. Conty Estévez & Kulla 2018, eq. 2, have the box's area
    /// for the size; the square of its diagonal tells sources on a line from those at a point as well.
    pub fn cost(&self) -> f64 {
        let diagonal = self.bounds.diagonal().to_f64();
        self.power * self.solid_angle() * diagonal.length_squared()
    }
}

impl Source {
    fn new(light: u32, primitive: u32, all: Summary, round: Option<f32>) -> Self {
        let radius = round.unwrap_or_else(|| all.bounds.radius());
        Self {
            light,
            primitive,
            centre: all.bounds.centre(),
            radius,
            all,
        }
    }

    /// Adds those of a light, if it is one that has a place.
    ///
    /// - `power`: of all of it, weighted by luminance, > 0
    pub fn push(
        out: &mut Vec<Self>,
        geometry: &Geometry,
        (index, light, emitter): (u32, &Light, Option<&Emitter>),
        power: f64,
    ) {
        match light {
            Light::Point { position, .. } => {
                let at = Aabb::around([*position]);
                let all = Summary::new(at, Cone::ALL, FRAC_PI_2, false, power);
                out.push(Self::new(index, WHOLE, all, None));
            }
            Light::Spot {
                position,
                direction,
                cone,
                ..
            } => {
                let around = Cone {
                    axis: direction.to_f64().normalize(),
                    half: Real::acos(f64::from(cone.cos_outer())),
                };
                let at = Aabb::around([*position]);
                let all = Summary::new(at, around, SPOT_SPREAD, false, power);
                out.push(Self::new(index, WHOLE, all, None));
            }
            Light::Area {
                instance,
                radiance,
                two_sided,
            } => {
                let shape =
                    &geometry.shapes()[geometry.instances()[*instance as usize].shape as usize];
                if let Shape::Mesh(mesh) = shape {
                    let per_area = PI * luminance(*radiance) * if *two_sided { 2.0 } else { 1.0 };
                    for triangle in 0..mesh.indices.len() as u32 {
                        let area = geometry.triangle_area(*instance, triangle);
                        if area > 0.0 {
                            let bounds =
                                Aabb::around(geometry.triangle_corners(*instance, triangle));
                            let cone = facing(
                                geometry.sample_triangle(*instance, triangle, [0.5; 2]).0.ng,
                            );
                            let all =
                                Summary::new(bounds, cone, FRAC_PI_2, *two_sided, per_area * area);
                            out.push(Self::new(index, triangle, all, None));
                        }
                    }
                    return;
                }
                let bounds = geometry.instance_bounds(*instance);
                if matches!(shape, Shape::Sphere) {
                    // Seen from outside it shines to one side, seen from inside to the other: all around, at any rate.
                    let all = Summary::new(bounds, Cone::ALL, FRAC_PI_2, *two_sided, power);
                    out.push(Self::new(
                        index,
                        WHOLE,
                        all,
                        emitter.and_then(Emitter::radius),
                    ));
                } else if let Some((point, _)) = geometry.sample_surface(*instance, [0.5; 2], 0.5) {
                    let all = Summary::new(bounds, facing(point.ng), FRAC_PI_2, *two_sided, power);
                    out.push(Self::new(index, WHOLE, all, None));
                }
            }
            Light::Directional { .. } | Light::Environment(_) => {}
        }
    }
}

fn facing(normal: Vec3<f32>) -> Cone {
    Cone {
        axis: normal.to_f64().normalize(),
        half: 0.0,
    }
}

/// The bounds of several sources.
///
/// - `scale`: a length that intensities are counted by, and the distances below a millionth of which are all one
/// - `brightest`: power
pub(super) fn bounds_of(sources: &[Source], scale: f32, brightest: f64) -> LightBounds<f32> {
    let all = summary(sources);
    let centre = all.bounds.centre();
    let reach = sources
        .iter()
        .map(|s| (s.centre - centre).length() + s.radius)
        .fold(0.0, f32::max);
    // A rounding of each coordinate may have moved the centre, by less than 2⁻²³ of its magnitude.
    let rounding = all.bounds.magnitude() * 4.0 * f32::EPSILON;
    let radius = (reach * (1.0 + 1e-5) + rounding).max(scale * 1e-6);
    // However faint: not so that it could vanish in a product.
    let intensity = ((all.intensity / brightest) as f32).max(1e-20) * scale * scale;
    LightBounds::new(
        (centre, radius),
        &all.cone,
        all.spread,
        intensity,
        all.both_sides,
    )
}

/// Several sources together.
///
/// # Panics
/// If there are none.
pub(super) fn summary(sources: &[Source]) -> Summary {
    let (first, rest) = sources
        .split_first()
        .expect("invariant: a node has a source");
    rest.iter().fold(first.all, |all, s| all.union(&s.all))
}
