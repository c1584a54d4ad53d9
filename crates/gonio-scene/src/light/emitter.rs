//! Surfaces as lights: a point chosen on one, and the density of its direction per solid angle.
//!
//! - A sphere seen from outside: uniform over the cone it subtends, pdf = 1 / (2π (1 − cos θmax)), sin θmax = r/d.
//! - A rectangle whose edges stay perpendicular: uniform over its solid angle, pdf = 1/Ω (Ureña, Fajardo and King 2013).
//! - Anything else: uniform over its area, pdf = r² / (A |cos θl|).

use crate::material::{Emission, Opacity};
use crate::{Geometry, Hit, Instance, Material, Ray, Shape, SurfacePoint};
use gonio_num::{Frame, Vec3};
use gonio_radiometry::warp::{SphericalRectangle, uniform_cap};
use std::f64::consts::TAU;

/// An instance that shines.
#[derive(Debug)]
pub(super) struct Emitter {
    instance: u32,
    form: Form,
    emission: Emission,
    opacity: Opacity,
    two_sided: bool,
}

/// How directions towards it are chosen.
#[derive(Debug)]
enum Form {
    Sphere {
        centre: Vec3<f64>,
        radius: f64,
    },
    Rectangle {
        corner: Vec3<f64>,
        edge_x: Vec3<f64>,
        edge_y: Vec3<f64>,
    },
    /// By area.
    Any,
}

/// A point of an emitter as seen from somewhere.
pub(super) struct Seen {
    pub wi: Vec3<f32>,
    pub point: SurfacePoint,
    /// Per solid angle.
    pub pdf: f32,
}

/// How far inside a sphere's surface still counts as on it, where the cone is a hemisphere: share of r².
const AT_SPHERE: f64 = 1e-6;
/// Deviation from equal lengths and right angles below which a transform is taken for a similarity.
const SIMILAR: f64 = 1e-5;

impl Emitter {
    pub fn new(geometry: &Geometry, instance: u32, material: &Material) -> Self {
        let placed: &Instance = &geometry.instances()[instance as usize];
        let m = placed.to_world.to_f64();
        let perpendicular =
            |a: Vec3<f64>, b: Vec3<f64>| a.dot(b).abs() <= SIMILAR * a.length() * b.length();
        let equal =
            |a: Vec3<f64>, b: Vec3<f64>| (a.length() - b.length()).abs() <= SIMILAR * a.length();
        let form = match &geometry.shapes()[placed.shape as usize] {
            Shape::Sphere
                if equal(m.x, m.y)
                    && equal(m.x, m.z)
                    && perpendicular(m.x, m.y)
                    && perpendicular(m.y, m.z)
                    && perpendicular(m.z, m.x) =>
            {
                Form::Sphere {
                    centre: m.origin,
                    radius: m.x.length(),
                }
            }
            Shape::Rectangle if perpendicular(m.x, m.y) => Form::Rectangle {
                corner: m.origin - m.x - m.y,
                edge_x: m.x * 2.0,
                edge_y: m.y * 2.0,
            },
            _ => Form::Any,
        };
        Self {
            instance,
            form,
            emission: material.emission.clone(),
            opacity: material.opacity.clone(),
            two_sided: material.double_sided,
        }
    }

    /// A direction from `from` to a point of the emitter; nothing if the choice fell on one that is not to be seen.
    ///
    /// The emitter itself may lie in between: a shadow ray tells.
    ///
    /// - `from`: the point and the bound on its error, as [`SurfacePoint`] has them
    ///
    /// Nothing if `from` lies in the plane of a rectangle, as far as its error lets one say. A point on the rectangle itself
    /// may by rounding be on either side of it, and from just off its front the rectangle fills a hemisphere: its back
    /// would seem lit by its front.
    #[inline]
    pub fn sample(
        &self,
        geometry: &Geometry,
        (from, error): (Vec3<f32>, f32),
        u_select: f32,
        u: [f32; 2],
    ) -> Option<Seen> {
        let eye = from.to_f64();
        let at = |wi: Vec3<f64>, t: f64, x: f64, y: f64| {
            let ray = Ray::new(from, wi.to_f32());
            let hit = Hit {
                t: t as f32,
                instance: self.instance,
                primitive: 0,
                u: x as f32,
                v: y as f32,
            };
            geometry.surface(&ray, &hit)
        };
        match &self.form {
            Form::Sphere { centre, radius } => {
                if let Some(height) = cone_height(eye, *centre, *radius) {
                    let to = *centre - eye;
                    let local = uniform_cap(u.map(f64::from), height);
                    let wi = Frame::from_normal(to.normalize()).to_world(local);
                    let along = to.dot(wi);
                    let across2 = (to - wi * along).length_squared();
                    let t = along - (radius * radius - across2).max(0.0).sqrt();
                    let point = at(wi, t, 0.0, 0.0);
                    return Some(Seen {
                        wi: wi.to_f32(),
                        point,
                        pdf: cone_pdf(height),
                    });
                }
            }
            Form::Rectangle {
                corner,
                edge_x,
                edge_y,
            } => {
                let height = (eye - *corner).dot(edge_x.cross(*edge_y).normalize());
                if height.abs() <= f64::from(error) {
                    return None;
                }
                let seen = SphericalRectangle::new(*corner, *edge_x, *edge_y, eye);
                let p = seen.sample(u.map(f64::from));
                let to = p - eye;
                let distance = to.length();
                if !(distance > 0.0 && seen.solid_angle() > 0.0) {
                    return None;
                }
                let coordinate = |edge: Vec3<f64>| {
                    (2.0 * (p - *corner).dot(edge) / edge.length_squared() - 1.0).clamp(-1.0, 1.0)
                };
                let wi = to / distance;
                let point = at(wi, distance, coordinate(*edge_x), coordinate(*edge_y));
                return Some(Seen {
                    wi: wi.to_f32(),
                    point,
                    pdf: seen.density() as f32,
                });
            }
            Form::Any => {}
        }
        let (point, pdf_area) = geometry.sample_surface(self.instance, u, u_select)?;
        let to = point.p.to_f64() - eye;
        let r2 = to.length_squared();
        let wi = to / r2.sqrt();
        let cos = wi.dot(point.ng.to_f64()).abs();
        let pdf = f64::from(pdf_area) * r2 / cos;
        (cos > 0.0 && pdf > 0.0 && pdf.is_finite()).then(|| Seen {
            wi: wi.to_f32(),
            point,
            pdf: pdf as f32,
        })
    }

    /// The density \[sr⁻¹] with which [`Emitter::sample`] chooses the direction from `from` to `hit`, a point of the emitter.
    pub fn pdf(&self, geometry: &Geometry, from: Vec3<f32>, hit: &SurfacePoint) -> f32 {
        let eye = from.to_f64();
        match &self.form {
            Form::Sphere { centre, radius } => {
                if let Some(height) = cone_height(eye, *centre, *radius) {
                    return cone_pdf(height);
                }
            }
            Form::Rectangle {
                corner,
                edge_x,
                edge_y,
            } => {
                let seen = SphericalRectangle::new(*corner, *edge_x, *edge_y, eye);
                return if seen.solid_angle() > 0.0 {
                    seen.density() as f32
                } else {
                    0.0
                };
            }
            Form::Any => {}
        }
        let to = hit.p.to_f64() - eye;
        let r2 = to.length_squared();
        let cos = (to / r2.sqrt()).dot(hit.ng.to_f64()).abs();
        let pdf = f64::from(geometry.pdf_area(hit)) * r2 / cos;
        if cos > 0.0 && pdf.is_finite() {
            pdf as f32
        } else {
            0.0
        }
    }

    /// The radiance \[W m⁻² sr⁻¹] that leaves `point` towards −`wi`, multiplied by the opacity there.
    pub fn radiance(&self, point: &SurfacePoint, wi: Vec3<f32>) -> [f32; 3] {
        if !self.two_sided && point.ng.dot(wi) >= 0.0 {
            return [0.0; 3];
        }
        let alpha = self.opacity.at(point);
        self.emission.at(point).map(|r| r * alpha)
    }
}

/// 1 − cos θmax of the cone that a sphere subtends; nothing from inside it.
///
/// s² / (1 + √(1 − s²)) with s = r/d keeps its digits for far spheres.
fn cone_height(eye: Vec3<f64>, centre: Vec3<f64>, radius: f64) -> Option<f64> {
    let d2 = (centre - eye).length_squared();
    let r2 = radius * radius;
    (d2 > r2 * (1.0 + AT_SPHERE)).then(|| {
        let s2 = r2 / d2;
        s2 / (1.0 + (1.0 - s2).sqrt())
    })
}

fn cone_pdf(height: f64) -> f32 {
    (1.0 / (TAU * height)) as f32
}
