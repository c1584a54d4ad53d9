//! Surfaces as lights: a point chosen on one, and the density of its direction per solid angle.
//!
//! - A sphere seen from outside: uniform over the cone it subtends, pdf = 1 / (2π (1 − cos θmax)), sin θmax = r/d.
//! - A rectangle whose edges stay perpendicular: uniform over its solid angle, pdf = 1/Ω (Ureña, Fajardo and King 2013).
//! - Anything else: uniform over its area, pdf = r² / (A |cos θl|).

use super::WHOLE;
use crate::double::Double;
use crate::material::{Emission, Opacity};
use crate::{Geometry, Instance, Material, Shape, SurfacePoint};
use gonio_num::{Frame, Real, Vec3};
use gonio_radiometry::warp::{SphericalRectangle, around_axis};
use std::f64::consts::TAU;

/// An instance that shines.
#[derive(Debug)]
pub(super) struct Emitter {
    instance: u32,
    pub form: Form,
    emission: Emission,
    opacity: Opacity,
    two_sided: bool,
}

/// How directions towards it are chosen.
#[derive(Debug)]
pub(super) enum Form {
    Sphere(Sphere<f64>),
    Rectangle(Rectangle<f64>),
    /// By area.
    Any,
}

/// A point of an emitter as seen from somewhere.
pub(super) struct Seen {
    pub wi: Vec3<f32>,
    /// Where it is.
    pub p: Vec3<f32>,
    /// Radiance from there, as [`Emitter::radiance`].
    pub radiance: [f32; 3],
    /// Per solid angle.
    pub pdf: f32,
}

/// A point of a [`Sphere`] or [`Rectangle`] as seen from somewhere.
pub(super) struct Toward<D: Double> {
    pub wi: Vec3<D>,
    pub p: Vec3<D>,
    /// Geometric normal there.
    pub ng: Vec3<D::Single>,
    /// Per solid angle.
    pub pdf: D::Single,
    /// Whether there is such a point.
    pub found: D::Mask,
}

/// A sphere.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sphere<D> {
    pub centre: Vec3<D>,
    pub radius: D,
}

/// A rectangle whose edges are perpendicular.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rectangle<D: Double> {
    pub corner: Vec3<D>,
    pub edge_x: Vec3<D>,
    pub edge_y: Vec3<D>,
    /// Geometric normal.
    pub ng: Vec3<D::Single>,
}

/// How far inside a sphere's surface still counts as on it, where the cone is a hemisphere: share of r².
const AT_SPHERE: f64 = 1e-6;
/// Deviation from equal lengths and right angles below which a transform is taken for a similarity.
const SIMILAR: f64 = 1e-5;

impl<D: Double> Sphere<D> {
    /// 1 − cos θmax of the cone that it subtends, and whether `eye` is outside of it.
    ///
    /// s² / (1 + √(1 − s²)) with s = r/d keeps its digits for far spheres.
    #[inline(always)]
    fn cone_height(&self, eye: Vec3<D>) -> (D, D::Mask) {
        let d2 = (self.centre - eye).length_squared();
        let r2 = self.radius * self.radius;
        let outside = (r2 * D::lit(1.0 + AT_SPHERE)).lt(d2);
        let s2 = r2 / D::select(outside, d2, r2);
        (s2 / (D::one() + (D::one() - s2).safe_sqrt()), outside)
    }

    #[inline(always)]
    fn cone_pdf(height: D) -> D::Single {
        (D::lit(TAU) * height).recip().single()
    }

    /// A direction of the cone that it subtends, uniform by solid angle, and the nearer point there.
    #[inline(always)]
    pub fn toward(&self, eye: Vec3<D>, u: [D::Single; 2]) -> Toward<D> {
        let (height, outside) = self.cone_height(eye);
        let to = self.centre - eye;
        let below = D::of(u[0]) * height;
        let across = (below * (D::lit(2.0) - below)).safe_sqrt();
        // Around the axis single precision will do: the direction is rounded to it anyway.
        let around = around_axis(u[1], D::Single::one(), D::Single::zero());
        let around = D::of_vector(around) * across;
        let local = Vec3::new(around.x, around.y, D::one() - below);
        let wi = Frame::from_normal(to.normalize()).to_world(local);
        let along = to.dot(wi);
        let past = (to - wi * along).length_squared();
        let t = along - (self.radius * self.radius - past).safe_sqrt();
        let n = (wi * t - to).normalize();
        Toward {
            wi,
            p: self.centre + n * self.radius,
            ng: D::single_vector(n),
            pdf: Self::cone_pdf(height),
            found: outside,
        }
    }
}

impl<D: Double> Rectangle<D> {
    #[inline(always)]
    fn seen_from(&self, eye: Vec3<D>) -> SphericalRectangle<D::Single> {
        SphericalRectangle::new(
            D::single_vector(self.corner - eye),
            D::single_vector(self.edge_x),
            D::single_vector(self.edge_y),
            Vec3::zero(),
        )
    }

    /// A point that is uniform by solid angle.
    ///
    /// Nothing if `eye` lies in the plane, as far as its error lets one say. A point on the rectangle itself may by rounding be on
    /// either side of it, and from just off its front the rectangle fills a hemisphere: its back would seem lit by its front.
    #[inline(always)]
    pub fn toward(&self, eye: Vec3<D>, error: D, u: [D::Single; 2]) -> Toward<D> {
        let normal = self.edge_x.cross(self.edge_y);
        let height = (eye - self.corner).dot(normal);
        let relative = D::single_vector(self.corner - eye);
        let (x, y) = (D::single_vector(self.edge_x), D::single_vector(self.edge_y));
        let seen = SphericalRectangle::new(relative, x, y, Vec3::zero());
        let to = seen.sample(u);
        let distance = to.length();
        let zero = D::Single::zero();
        let some = zero.lt(distance) & zero.lt(seen.solid_angle());
        let wi = to / D::Single::select(some, distance, D::Single::one());
        // On the rectangle itself, not by roundings beside it.
        let from_corner = to - relative;
        let s = (from_corner.dot(x) / x.length_squared()).saturate();
        let t = (from_corner.dot(y) / y.length_squared()).saturate();
        Toward {
            wi: D::of_vector(wi),
            p: self.corner + self.edge_x * D::of(s) + self.edge_y * D::of(t),
            ng: self.ng,
            pdf: seen.density(),
            found: some & (error * normal.length()).lt(height.abs()),
        }
    }
}

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
                Form::Sphere(Sphere {
                    centre: m.origin,
                    radius: m.x.length(),
                })
            }
            Shape::Rectangle if perpendicular(m.x, m.y) => Form::Rectangle(Rectangle {
                corner: m.origin - m.x - m.y,
                edge_x: m.x * 2.0,
                edge_y: m.y * 2.0,
                ng: m
                    .transform_normal(Vec3::new(0.0, 0.0, 1.0))
                    .normalize()
                    .to_f32(),
            }),
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

    /// The radius, of a sphere that is one.
    pub fn radius(&self) -> Option<f32> {
        match &self.form {
            Form::Sphere(sphere) => Some(sphere.radius as f32),
            _ => None,
        }
    }

    /// The radiance of the front, where it is the same all over the surface, and whether the back shines too.
    pub fn even_radiance(&self) -> Option<([f32; 3], bool)> {
        let even = self.emission.is_even() && self.opacity.is_opaque();
        even.then_some((self.emission.radiance, self.two_sided))
    }

    /// A direction from `from` to a point of the emitter; nothing if the choice fell on one that is not to be seen.
    ///
    /// The emitter itself may lie in between: a shadow ray tells.
    ///
    /// - `from`: the point and the bound on its error, as [`SurfacePoint`] has them
    /// - `primitive`: the triangle that the point is to be on, or [`WHOLE`]
    #[inline]
    pub fn sample(
        &self,
        geometry: &Geometry,
        (from, error): (Vec3<f32>, f32),
        primitive: u32,
        u_select: f32,
        u: [f32; 2],
    ) -> Option<Seen> {
        let eye = from.to_f64();
        let toward = match &self.form {
            Form::Sphere(sphere) => Some(sphere.toward(eye, u)).filter(|t| t.found),
            Form::Rectangle(rectangle) => {
                let toward = rectangle.toward(eye, error.into(), u);
                if !toward.found {
                    return None;
                }
                Some(toward)
            }
            Form::Any => None,
        };
        if let Some(toward) = toward {
            let wi = toward.wi.to_f32();
            return Some(Seen {
                wi,
                p: toward.p.to_f32(),
                radiance: self.radiance_toward(geometry, &toward, wi),
                pdf: toward.pdf,
            });
        }
        let (point, pdf_area) = if primitive == WHOLE {
            geometry.sample_surface(self.instance, u, u_select)?
        } else {
            geometry.sample_triangle(self.instance, primitive, u)
        };
        let to = point.p.to_f64() - eye;
        let r2 = to.length_squared();
        let wi = to / r2.sqrt();
        let cos = wi.dot(point.ng.to_f64()).abs();
        let pdf = f64::from(pdf_area) * r2 / cos;
        let wi = wi.to_f32();
        (cos > 0.0 && pdf > 0.0 && pdf.is_finite()).then(|| Seen {
            wi,
            p: point.p,
            radiance: self.radiance(&point, wi),
            pdf: pdf as f32,
        })
    }

    /// The radiance from a point of a sphere or rectangle.
    fn radiance_toward(
        &self,
        geometry: &Geometry,
        toward: &Toward<f64>,
        wi: Vec3<f32>,
    ) -> [f32; 3] {
        if let Some((radiance, two_sided)) = self.even_radiance() {
            let dark = !two_sided && toward.ng.dot(wi) >= 0.0;
            return if dark { [0.0; 3] } else { radiance };
        }
        // The texture coordinates come from the shape's own.
        self.radiance(&geometry.surface_at(self.instance, toward.p), wi)
    }

    /// The density \[sr⁻¹] with which [`Emitter::sample`] chooses the direction from `from` to `hit`, a point of the emitter.
    ///
    /// - `whole`: whether the whole of it was to choose from, not the triangle that `hit` is on
    pub fn pdf(
        &self,
        geometry: &Geometry,
        from: Vec3<f32>,
        hit: &SurfacePoint,
        whole: bool,
    ) -> f32 {
        let eye = from.to_f64();
        match &self.form {
            Form::Sphere(sphere) => {
                let (height, outside) = sphere.cone_height(eye);
                if outside {
                    return Sphere::cone_pdf(height);
                }
            }
            Form::Rectangle(rectangle) => {
                let seen = rectangle.seen_from(eye);
                return if seen.solid_angle() > 0.0 {
                    seen.density()
                } else {
                    0.0
                };
            }
            Form::Any => {}
        }
        let to = hit.p.to_f64() - eye;
        let r2 = to.length_squared();
        let cos = (to / r2.sqrt()).dot(hit.ng.to_f64()).abs();
        let pdf_area = if whole {
            geometry.pdf_area(hit)
        } else {
            (1.0 / geometry.triangle_area(hit.instance, hit.primitive)) as f32
        };
        let pdf = f64::from(pdf_area) * r2 / cos;
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
