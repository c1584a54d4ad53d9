//! Image-based light.
#![allow(clippy::needless_range_loop)]
pub mod bundle;
pub mod cube;
mod dfg;
mod error;
mod filter;
mod gather;
pub mod harmonics;
mod kernel;
pub mod lights;
mod maps;
mod nodes;
mod reference;
mod sampling;
mod target;
pub use dfg::Dfg;
pub use error::IblError;
pub use filter::{DEFAULT_TOLERANCE, Filter};
pub use harmonics::Harmonics;
pub use kernel::{Kernel, ModelKernel};
pub use maps::{Family, MapError, Maps, Method, mirror};
pub use nodes::LightTree;
pub use reference::reference;
pub use target::{TableLayout, Target};
