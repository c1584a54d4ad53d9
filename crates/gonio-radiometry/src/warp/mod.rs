//! Warps: maps from the unit square to points and directions, each with its density and its inverse.
//!
//! For each family `X`: `X(u)` maps u in [0, 1]² (a uniform u gives a sample of density `X_density`), `X_density(w)` is
//! the density at a point or direction, 0 outside the domain, and `X_inverse(w)` is the u that maps to w (in [0, 1]²; for
//! a w outside the domain it is unspecified, but finite). Densities of directions are per solid angle (sr⁻¹).
//!
//! Directions are unit vectors around +z. u = 0 and u = 1 are valid and give finite points of the domain; the density
//! there may be 0 where it vanishes on the domain's border (a cosine at the horizon).
//!
//! These are generic over [`Real`]: one source for `f32`, `f64`, lanes, duals and shader code. The tables
//! ([`Discrete`], [`Piecewise1d`], [`Piecewise2d`]) search, so they are for scalars: data in `f32`, sums in `f64`.

mod cdf;
mod cone;
mod cosine;
mod discrete;
mod disk;
mod piecewise;
mod sphere;
mod spherical_rectangle;
mod spherical_triangle;
mod triangle;

pub use cone::{
    uniform_cap, uniform_cap_density, uniform_cap_inverse, uniform_cone, uniform_cone_density,
    uniform_cone_inverse,
};
pub use cosine::{
    cosine_hemisphere, cosine_hemisphere_density, cosine_hemisphere_inverse,
    cosine_power_hemisphere, cosine_power_hemisphere_density, cosine_power_hemisphere_inverse,
};
pub use discrete::Discrete;
pub use disk::{uniform_disk, uniform_disk_density, uniform_disk_inverse};
pub use piecewise::{Piecewise1d, Piecewise2d};
pub use sphere::{
    uniform_hemisphere, uniform_hemisphere_density, uniform_hemisphere_inverse, uniform_sphere,
    uniform_sphere_density, uniform_sphere_inverse,
};
pub use spherical_rectangle::SphericalRectangle;
pub use spherical_triangle::{
    spherical_triangle, spherical_triangle_density, spherical_triangle_inverse,
};
pub use triangle::{uniform_triangle, uniform_triangle_density, uniform_triangle_inverse};

use gonio_num::{Real, Vec3};
use std::f64::consts::TAU;

/// The vector of azimuth 2π `u`, with the given z and the given distance from the z axis: unit if they are the cosine and
/// sine of θ.
#[inline(always)]
pub fn around_axis<R: Real>(u: R, sin_theta: R, cos_theta: R) -> Vec3<R> {
    let (sin_phi, cos_phi) = (u * R::lit(TAU)).sin_cos();
    Vec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}

/// The u in [0, 1] whose azimuth 2πu is that of `w`; 0 on the z axis.
#[inline(always)]
fn azimuth_inverse<R: Real>(w: Vec3<R>) -> R {
    let turns = w.y.atan2(w.x + R::zero()) * R::lit(1.0 / TAU);
    R::select(turns.lt(R::zero()), turns + R::one(), turns).saturate()
}

#[cfg(test)]
mod tests;
