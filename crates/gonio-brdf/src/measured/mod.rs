//! Measured reflectance: tables in memory, and one file for each format that is read.

pub mod merl;
mod steps;
pub mod tabulated;

pub use tabulated::{Axes, Policy, Tabulated};
