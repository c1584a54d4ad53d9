//! Scenes: shapes, ray queries, materials, lights, cameras, and readers.
//!
//! This crate is floor 4. It knows where surfaces are and what they are made of; it knows nothing of integrators.

pub mod camera;
mod double;
mod error;
mod files;
pub mod geometry;
mod interior;
pub mod light;
pub mod material;
pub mod mesh;
mod ray;
mod reader;
mod scene;
mod scene_builder;
pub mod texture;

pub use camera::{Camera, Projection};
pub use error::SceneError;
pub use files::{Files, Told, Watch};
pub use geometry::{Aabb, AreaSample, Geometry, Instance, Shape, SurfacePoint, Surfaces};
pub use interior::{Body, Interior};
pub use light::{
    Light, LightChoice, LightRef, LightSample, LightSampler, LightSamples, LightTarget, Lights,
    NO_GROUP, Receiver, SpotCone,
};
pub use material::{Material, Shading, facing_frame};
pub use mesh::TriangleMesh;
pub use ray::{Hit, Ray};
pub use scene::{LoadOptions, Scene};
pub use scene_builder::SceneBuilder;
pub use texture::Texture;
