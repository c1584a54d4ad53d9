//! The parts that microfacet models are made of: Fresnel reflectance, normal distributions, masking and shadowing,
//! their directional albedo, and measured metals.

pub mod albedo;
pub mod ashikhmin_lobe;
pub mod boundary_loss;
pub mod charlie_albedo;
pub(crate) mod clearcoat;
pub(crate) mod colour;
pub mod dielectric;
pub mod diffuse_and_lobe;
pub mod distribution;
pub(crate) mod facet_pair;
pub mod fresnel;
pub mod geometry;
pub mod gloss;
pub mod interreflection;
pub mod inverse_power;
pub mod low_lobe;
pub mod masking;
pub mod masking_table;
pub mod metal;
pub mod random_walk;
pub mod rough;
pub mod sheen_lobe;
pub mod slopes;
pub(crate) mod special;
mod table_data;
pub mod ward_lobe;
