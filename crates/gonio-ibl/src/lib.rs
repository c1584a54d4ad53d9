//! Image-based light.
#![allow(clippy::needless_range_loop)]
pub mod cube;
mod error;
mod filter;
mod gather;
mod kernel;
mod nodes;
mod reference;
pub use error::IblError;
pub use filter::{DEFAULT_TOLERANCE, Filter};
pub use kernel::{Kernel, ModelKernel};
pub use nodes::LightTree;
pub use reference::reference;
