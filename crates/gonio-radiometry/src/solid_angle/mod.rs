//! Solid angles (T2): Ω = A / r² (sr), of the sphere 4π.
//!
//! - [`triangle()`], [`polygon()`], [`rectangle()`], [`cone()`], [`cap()`], [`sphere()`], [`disk()`]: the solid angle of a shape
//! - [`projected`]: solid angles weighted by the cosine, which are irradiances under unit radiance and π times form
//!   factors
//! - [`jacobian`]: how one measure turns into another: angles, area, solid angle, half vectors (T4)

mod cone;
pub mod jacobian;
mod polygon;
pub mod projected;

pub use cone::{cap, cone, cone_of_angle, disk, sphere};
pub use polygon::{polygon, rectangle, triangle, triangle_from};
