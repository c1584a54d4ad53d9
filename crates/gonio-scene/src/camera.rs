//! [`Camera`]: where an image is seen from, and the ray through each point of its film.
//!
//! A camera looks along its local −z with +x to the right and +y up. The film is the unit square with (0, 0) at the top
//! left, whatever the image's size; `aspect` is the image's width divided by its height, and the field of view is the
//! vertical one, so a wider image shows more at its sides.

use crate::{Aabb, Ray, SceneError};
use gonio_num::dispatch::{Kernel, dispatch};
use gonio_num::lanes::Lanes;
use gonio_num::{Affine3, Real, Vec3, Vectors};
use gonio_radiometry::warp;

/// How a camera projects the scene onto its film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// All rays pass through one point: a perspective image, sharp at every distance.
    Pinhole {
        /// Vertical field of view \[rad], in (0, π).
        fov_y_rad: f32,
    },
    /// An ideal thin lens: perspective, sharp at the focus distance only.
    ///
    /// A point at distance z (along the viewing axis) is blurred over a disk whose diameter, measured in the plane of
    /// focus, is 2·`lens_radius`·|z − f| / z with f = `focus_distance`.
    ThinLens {
        /// Vertical field of view \[rad], in (0, π).
        fov_y_rad: f32,
        /// Radius of the lens's aperture \[scene units], ≥ 0; 0 is a pinhole.
        lens_radius: f32,
        /// Distance of the plane in focus, along the viewing axis \[scene units], > 0.
        focus_distance: f32,
    },
    /// Parallel rays along the viewing axis.
    Orthographic {
        /// Half the height of the region seen \[scene units], > 0.
        half_height: f32,
    },
}

/// A camera: a rigid placement and a [`Projection`].
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// The name its file gives it, or empty.
    pub name: String,
    /// Camera to world: a rotation and a translation, without scale.
    pub to_world: Affine3<f32>,
    /// The projection.
    pub projection: Projection,
    /// The width-to-height ratio that its file asks for, if any; [`Camera::ray`] takes the image's own.
    pub aspect: Option<f32>,
}

/// Vertical field of view of [`Camera::framing`]: long enough a lens to keep objects' proportions.
const FRAMING_FOV_DEG: f64 = 30.0;
/// Direction from which [`Camera::framing`] looks, to the right of +z and above the horizon.
const FRAMING_AZIMUTH_DEG: f64 = 28.0;
const FRAMING_ELEVATION_DEG: f64 = 18.0;
/// Share of the half width and half height that the framed bounds may take.
const FRAMING_FILL: f64 = 0.88;

impl Camera {
    /// A camera at `to_world` with the given projection.
    ///
    /// Scale and shear of `to_world` are dropped, as glTF 2.0 section 3.10 asks: the viewing axis keeps its direction, and the up
    /// direction its part across that axis. A mirroring transform gives a camera that isn't mirrored.
    ///
    /// # Errors
    /// [`SceneError::Parameter`] if a number is not finite or outside its range, or if `to_world` leaves no axis.
    pub fn new(
        name: impl Into<String>,
        to_world: &Affine3<f32>,
        projection: Projection,
    ) -> Result<Self, SceneError> {
        projection.check()?;
        let name = name.into();
        let to_world = rigid(to_world).ok_or_else(|| SceneError::Parameter {
            name: "camera transform".into(),
            found: "a singular or non-finite matrix".into(),
            expected: "an invertible one".into(),
        })?;
        Ok(Self {
            name,
            to_world,
            projection,
            aspect: None,
        })
    }

    /// A pinhole camera at `eye` that looks at `target`.
    ///
    /// - `fov_y_deg`: vertical field of view \[°], in (0, 180)
    ///
    /// # Errors
    /// [`SceneError::Parameter`] if `eye` and `target` coincide, or a number is not finite or out of range.
    pub fn look_at(
        eye: Vec3<f32>,
        target: Vec3<f32>,
        up: Vec3<f32>,
        fov_y_deg: f32,
    ) -> Result<Self, SceneError> {
        let placed = look_at(eye, target, up).ok_or_else(|| SceneError::Parameter {
            name: "camera".into(),
            found: format!(
                "eye {:?} and target {:?}",
                eye.to_array(),
                target.to_array()
            ),
            expected: "two different finite points".into(),
        })?;
        let projection = Projection::Pinhole {
            fov_y_rad: fov_y_deg.to_radians(),
        };
        Self::new("", &placed, projection)
    }

    /// A pinhole camera that shows the whole of `bounds` with a margin, from a little to the right of +z and a little above.
    ///
    /// The eye is the nearest point from which every corner of the box lies within 88 % of the film's half width and half
    /// height: each of the four inner frustum planes touches a corner or more, and the eye is where they meet, so the box is
    /// centred in whichever direction is the tighter. A box that is empty or a single point is framed as a box of size 1.
    ///
    /// - `aspect`: image width / height, > 0
    pub fn framing(bounds: &Aabb, aspect: f32) -> Self {
        let (low, high) = (bounds.min.to_f64(), bounds.max.to_f64());
        let usable =
            low.is_finite() && high.is_finite() && (high - low).length() > 0.0 && low.x <= high.x;
        let (low, high) = if usable {
            (low, high)
        } else {
            let centre = if low.is_finite() && high.is_finite() {
                (low + high) * 0.5
            } else {
                Vec3::zero()
            };
            (centre - Vec3::splat(0.5), centre + Vec3::splat(0.5))
        };
        let centre = (low + high) * 0.5;
        let (azimuth, elevation) = (
            FRAMING_AZIMUTH_DEG.to_radians(),
            FRAMING_ELEVATION_DEG.to_radians(),
        );
        let (sin_a, cos_a) = Real::sin_cos(azimuth);
        let (sin_e, cos_e) = Real::sin_cos(elevation);
        let back = Vec3::new(sin_a * cos_e, sin_e, cos_a * cos_e);
        let right = Vec3::new(0.0, 1.0, 0.0).cross(back).normalize();
        let up = back.cross(right);

        let half = (FRAMING_FOV_DEG * 0.5).to_radians();
        let slope_y = Real::tan(half) * FRAMING_FILL;
        let slope_x = slope_y * f64::from(aspect);
        // With the eye at e on the axis of x and d along `back`, a corner (x, z) is inside if |x − e| ≤ slope·(d − z):
        // e + slope·d ≥ x + slope·z and slope·d − e ≥ slope·z − x for all corners.
        let mut upper = [f64::NEG_INFINITY; 2];
        let mut lower = [f64::NEG_INFINITY; 2];
        for corner in 0..8 {
            let pick = |bit: u32, a: f64, b: f64| if corner >> bit & 1 == 0 { a } else { b };
            let p = Vec3::new(
                pick(0, low.x, high.x),
                pick(1, low.y, high.y),
                pick(2, low.z, high.z),
            ) - centre;
            let z = p.dot(back);
            for (k, (x, slope)) in [(p.dot(right), slope_x), (p.dot(up), slope_y)]
                .into_iter()
                .enumerate()
            {
                upper[k] = upper[k].max(x + slope * z);
                lower[k] = lower[k].max(slope * z - x);
            }
        }
        let distance =
            ((upper[0] + lower[0]) / (2.0 * slope_x)).max((upper[1] + lower[1]) / (2.0 * slope_y));
        let eye = centre
            + right * ((upper[0] - lower[0]) * 0.5)
            + up * ((upper[1] - lower[1]) * 0.5)
            + back * distance;
        Self {
            name: String::new(),
            to_world: Affine3 {
                x: right.to_f32(),
                y: up.to_f32(),
                z: back.to_f32(),
                origin: eye.to_f32(),
            },
            projection: Projection::Pinhole {
                fov_y_rad: FRAMING_FOV_DEG.to_radians() as f32,
            },
            aspect: None,
        }
    }

    /// The ray that brings light to a point of the film, unit direction, pointing away from the camera.
    ///
    /// - `film`: point of the film in \[0, 1]², (0, 0) at the top left
    /// - `aspect`: image width / height
    /// - `lens_u`: two numbers in \[0, 1) that choose the point of the lens; unused but by a thin lens
    ///
    /// Pinhole: direction ∝ (2u − 1)·a·t x + (1 − 2v)·t y − z with t = tan(fov/2). Thin lens: from a point of the lens
    /// (concentric disk map) to where the pinhole's ray meets the plane of focus.
    pub fn ray(&self, film: [f32; 2], aspect: f32, lens_u: [f32; 2]) -> Ray {
        let (origin, direction) = self.axis::<f32>(self.slope(), aspect, film, lens_u);
        Ray {
            origin,
            direction,
            t_max: f32::INFINITY,
        }
    }

    /// Whether rays start from different points of a lens, so that the numbers that choose one matter.
    pub fn has_lens(&self) -> bool {
        matches!(self.projection, Projection::ThinLens { .. })
    }

    /// [`Camera::ray`] for many points of the film, the same to the bit.
    ///
    /// - `film`, `lens_u`: one pair a ray
    /// - `rays`: origins and directions, written
    ///
    /// # Panics
    /// If there are fewer numbers than points.
    pub fn rays(
        &self,
        film: [&[f32]; 2],
        aspect: f32,
        lens_u: [&[f32]; 2],
        rays: [&mut Vectors; 2],
    ) {
        let count = film[0].len();
        let [origin, direction] = rays;
        origin.resize(count);
        direction.resize(count);
        dispatch(Rays {
            camera: self,
            film: film.map(|f| &f[..count]),
            aspect,
            lens_u,
            origin,
            direction,
        });
    }

    /// tan(fov/2); 0 where there is none.
    fn slope(&self) -> f32 {
        match self.projection {
            Projection::Pinhole { fov_y_rad } | Projection::ThinLens { fov_y_rad, .. } => {
                Real::tan(0.5 * fov_y_rad)
            }
            Projection::Orthographic { .. } => 0.0,
        }
    }

    /// Origin and direction of a ray.
    #[inline(always)]
    fn axis<R: Real>(
        &self,
        slope: f32,
        aspect: f32,
        film: [R; 2],
        lens_u: [R; 2],
    ) -> (Vec3<R>, Vec3<R>) {
        let of = |x: f32| R::lit(f64::from(x));
        let (x, y) = (
            R::lit(2.0) * film[0] - R::one(),
            R::one() - R::lit(2.0) * film[1],
        );
        let (t, aspect) = (of(slope), of(aspect));
        let towards = Vec3::new(x * t * aspect, y * t, -R::one());
        let (origin, direction) = match self.projection {
            Projection::Pinhole { .. } => (Vec3::zero(), towards),
            Projection::ThinLens {
                lens_radius,
                focus_distance,
                ..
            } => {
                let [a, b] = warp::uniform_disk(lens_u);
                let lens = Vec3::new(a * of(lens_radius), b * of(lens_radius), R::zero());
                (lens, towards * of(focus_distance) - lens)
            }
            Projection::Orthographic { half_height } => (
                Vec3::new(x * of(half_height) * aspect, y * of(half_height), R::zero()),
                Vec3::new(R::zero(), R::zero(), -R::one()),
            ),
        };
        let to_world = Affine3::<R>::lit(self.to_world.to_f64());
        (
            to_world.transform_point(origin),
            to_world.transform_vector(direction).normalize(),
        )
    }

    /// Position of the camera (of the lens's centre, of the film's centre if orthographic), in the world.
    pub fn position(&self) -> Vec3<f32> {
        self.to_world.origin
    }

    /// The unit direction in which the camera looks, in the world.
    pub fn forward(&self) -> Vec3<f32> {
        -self.to_world.z
    }

    /// Vertical field of view \[°]; nothing for an orthographic camera.
    pub fn fov_y_deg(&self) -> Option<f32> {
        match self.projection {
            Projection::Pinhole { fov_y_rad } | Projection::ThinLens { fov_y_rad, .. } => {
                Some(fov_y_rad.to_degrees())
            }
            Projection::Orthographic { .. } => None,
        }
    }
}

impl Projection {
    /// # Errors
    /// [`SceneError::Parameter`] if a number is not finite or outside its range.
    fn check(&self) -> Result<(), SceneError> {
        let in_range =
            |name: &str, value: f32, low: f32, inclusive: bool, high: f32, expected: &str| {
                let above = if inclusive { value >= low } else { value > low };
                if above && value < high && value.is_finite() {
                    Ok(())
                } else {
                    Err(SceneError::Parameter {
                        name: name.into(),
                        found: value.to_string(),
                        expected: expected.into(),
                    })
                }
            };
        let fov = |fov_y_rad: f32| {
            let name = "camera's vertical field of view [°]";
            in_range(
                name,
                fov_y_rad.to_degrees(),
                0.0,
                false,
                180.0,
                "a number between 0 and 180",
            )
        };
        match *self {
            Self::Pinhole { fov_y_rad } => fov(fov_y_rad),
            Self::ThinLens {
                fov_y_rad,
                lens_radius,
                focus_distance,
            } => {
                fov(fov_y_rad)?;
                in_range(
                    "lens radius",
                    lens_radius,
                    0.0,
                    true,
                    f32::INFINITY,
                    "a number ≥ 0",
                )?;
                in_range(
                    "focus distance",
                    focus_distance,
                    0.0,
                    false,
                    f32::INFINITY,
                    "a number > 0",
                )
            }
            Self::Orthographic { half_height } => in_range(
                "half height",
                half_height,
                0.0,
                false,
                f32::INFINITY,
                "a number > 0",
            ),
        }
    }
}

/// Camera to world for an eye that looks at a target; nothing if they coincide. Where `up` is along the view, another is taken.
pub(crate) fn look_at(eye: Vec3<f32>, target: Vec3<f32>, up: Vec3<f32>) -> Option<Affine3<f32>> {
    if !(eye.is_finite() && target.is_finite() && up.is_finite()) {
        return None;
    }
    let back = (eye - target).to_f64();
    if back.length() <= 0.0 {
        return None;
    }
    let frame = upright(back.normalize(), up.to_f64());
    Some(Affine3 {
        x: frame[0].to_f32(),
        y: frame[1].to_f32(),
        z: frame[2].to_f32(),
        origin: eye,
    })
}

/// Right, up and back, orthonormal and right-handed, of a viewer whose back is `back` (unit) and whose up is near `up`.
fn upright(back: Vec3<f64>, up: Vec3<f64>) -> [Vec3<f64>; 3] {
    let across = up.cross(back);
    let right = if across.length() > 1e-6 * up.length() {
        across.normalize()
    } else {
        let other = if back.y.abs() < 0.9 {
            Vec3::new(0.0, 1.0, 0.0)
        } else {
            Vec3::new(0.0, 0.0, -back.y)
        };
        other.cross(back).normalize()
    };
    [right, back.cross(right), back]
}

/// The rigid part of a transform: its z axis and origin kept, its y axis made perpendicular.
fn rigid(m: &Affine3<f32>) -> Option<Affine3<f32>> {
    let (y, z) = (m.y.to_f64(), m.z.to_f64());
    if !(y.is_finite() && z.is_finite() && m.origin.is_finite() && z.length() > 0.0) {
        return None;
    }
    let [right, up, back] = upright(z.normalize(), y);
    Some(Affine3 {
        x: right.to_f32(),
        y: up.to_f32(),
        z: back.to_f32(),
        origin: m.origin,
    })
}

struct Rays<'a> {
    camera: &'a Camera,
    film: [&'a [f32]; 2],
    aspect: f32,
    lens_u: [&'a [f32]; 2],
    origin: &'a mut Vectors,
    direction: &'a mut Vectors,
}

impl Kernel for Rays<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const L: usize>(self) {
        let slope = self.camera.slope();
        let mut at = 0;
        while at < self.origin.len() {
            let film = [
                Lanes::<L>::load_or(&self.film[0][at..], 0.5),
                Lanes::<L>::load_or(&self.film[1][at..], 0.5),
            ];
            let lens = [
                Lanes::<L>::load_or(&self.lens_u[0][at..], 0.5),
                Lanes::<L>::load_or(&self.lens_u[1][at..], 0.5),
            ];
            let (origin, direction) = self.camera.axis(slope, self.aspect, film, lens);
            self.origin.store(at, origin);
            self.direction.store(at, direction);
            at += L;
        }
    }
}

#[cfg(test)]
#[path = "camera_tests.rs"]
mod tests;
