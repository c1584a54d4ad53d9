//! The parts that microfacet models are made of: Fresnel reflectance, normal distributions, masking and shadowing,
//! their directional albedo, and measured metals.

pub mod albedo;
pub mod ashikhmin_lobe;
pub(crate) mod colour;
pub mod dielectric;
pub mod diffuse_and_lobe;
pub mod distribution;
pub mod fresnel;
pub mod geometry;
pub mod masking;
pub mod metal;
pub mod sheen_lobe;
pub mod slopes;
pub(crate) mod special;
pub mod ward_lobe;
