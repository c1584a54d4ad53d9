//! Statistical tests with their p-values.

mod moments;

pub use moments::Moments;
