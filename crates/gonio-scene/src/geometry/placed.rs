//! [`Placed`], an instance ready for queries.

use super::surface::{Axes, Local};
use super::{Aabb, Instance, Ray, Shape};
use crate::SceneError;
use gonio_num::{Affine3, Real, Vec3};

/// Half a unit in the last place, relative: the rounding of single precision, 2⁻²⁴.
pub(crate) const HALF_ULP: f64 = 1.0 / (1u64 << 24) as f64;

/// An instance ready for queries: both maps, in double precision.
#[derive(Debug, Clone)]
pub(crate) struct Placed {
    pub(crate) kind: Kind,
    pub(crate) to_world: Affine3<f64>,
    pub(crate) to_object: Affine3<f64>,
    /// Whether world and object coordinates are the same: rays then keep their bits.
    pub(crate) identity: bool,
    /// −1 for a map that mirrors, else 1.
    pub(crate) handedness: f32,
    /// The directions at every point, for a flat shape.
    pub(super) flat: Option<Axes>,
    /// The box in the world, with room for the roundings of a ray's change of coordinates.
    pub(crate) bounds: Aabb,
    /// Largest coordinate of the shape in its own coordinates, times the most that a vector grows from there to the world (a
    /// bound: the Frobenius norm).
    pub(crate) object_magnitude: f64,
}

/// Which test an instance takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// With the index of its tree.
    Mesh(u32),
    Sphere,
    Rectangle,
    Disk,
}

impl Placed {
    /// # Errors
    /// [`SceneError::Instance`] if the map isn't finite, can't be inverted, or leads out of single precision.
    pub(crate) fn new(
        index: usize,
        instance: &Instance,
        shape: &Shape,
        own: &Aabb,
        kind: Kind,
    ) -> Result<Self, SceneError> {
        let fault = |message: &str| SceneError::Instance {
            instance: index,
            message: message.into(),
        };
        let m = instance.to_world;
        if ![m.x, m.y, m.z, m.origin].iter().all(|c| c.is_finite()) {
            return Err(fault("its transform holds a value that is not finite"));
        }
        let to_world = m.to_f64();
        let to_object = to_world
            .inverse()
            .ok_or_else(|| fault("its transform flattens space (a scale of 0?)"))?;
        let growth = [to_world.x, to_world.y, to_world.z]
            .iter()
            .map(|c| c.length_squared())
            .sum::<f64>()
            .sqrt();
        let object_magnitude = f64::from(own.magnitude()) * growth;
        let identity = m == Affine3::identity();
        let mut bounds = shape.world_bounds(own, &to_world);
        if !bounds.is_empty() {
            let magnitude = object_magnitude + f64::from(bounds.magnitude());
            if magnitude.is_nan() || magnitude > f64::from(crate::mesh::MAX_COORDINATE) {
                return Err(fault(&format!(
                    "it reaches beyond {:e} from the origin",
                    crate::mesh::MAX_COORDINATE
                )));
            }
            if !identity {
                bounds = bounds.padded((8.0 * HALF_ULP * magnitude) as f32);
            }
        }
        let handedness = if to_world.determinant() < 0.0 {
            -1.0
        } else {
            1.0
        };
        let mut placed = Self {
            kind,
            to_world,
            to_object,
            identity,
            handedness,
            flat: None,
            bounds,
            object_magnitude,
        };
        if matches!(kind, Kind::Rectangle | Kind::Disk) {
            placed.flat = Some(placed.axes(&Local::flat(0.0, 0.0)));
        }
        Ok(placed)
    }

    /// Origin and direction of a ray in the shape's coordinates.
    #[inline(always)]
    pub(crate) fn ray_to_object(&self, ray: &Ray) -> (Vec3<f64>, Vec3<f64>) {
        (
            self.to_object.transform_point(ray.origin.to_f64()),
            self.to_object.transform_vector(ray.direction.to_f64()),
        )
    }

    /// A ray in the shape's coordinates, rounded to single precision; t counts as in the world.
    #[inline(always)]
    pub(crate) fn ray_to_mesh(&self, ray: &Ray) -> Ray {
        let (origin, direction) = self.ray_to_object(ray);
        Ray {
            origin: origin.to_f32(),
            direction: direction.to_f32(),
            t_max: ray.t_max,
        }
    }

    /// A bound on the rounding errors around a surface point p in the world: of p itself, of an origin moved off it, and of
    /// that origin in object coordinates. Each is at most √3 half units of the largest coordinate.
    ///
    /// 4 half units ≥ √3 for each of the two roundings in the world; the smallest normal number, which a caller adds in single
    /// precision, keeps it above 0.
    #[inline(always)]
    pub(crate) fn error_at<R: Real>(&self, p: Vec3<R>) -> R {
        let world = p.x.abs().max(p.y.abs()).max(p.z.abs());
        let object = if self.identity {
            0.0
        } else {
            self.object_magnitude
        };
        R::lit(4.0 * HALF_ULP) * (world + R::lit(object))
    }
}
