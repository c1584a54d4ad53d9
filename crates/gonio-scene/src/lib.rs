//! Scenes: shapes, ray queries, materials, lights, cameras, and readers.
//!
//! This crate is floor 4. It knows where surfaces are and what they are made of; it knows nothing of integrators.

mod error;
pub mod geometry;
pub mod mesh;
mod ray;

pub use error::SceneError;
pub use geometry::{Aabb, AreaSample, Geometry, Instance, Shape, SurfacePoint};
pub use mesh::TriangleMesh;
pub use ray::{Hit, Ray};
