//! Measured reflectance: tables in memory, and one file for each format that is read.

mod cells;
mod choice;
pub mod merl;
mod tabulated;

pub use tabulated::{Axes, Tabulated};
