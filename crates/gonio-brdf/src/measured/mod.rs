//! Measured reflectance (T19): what files hold, and how it is evaluated and drawn from.
//!
//! [`load`] reads a file of any known [`format`](mod@format) by its content. What it holds is a [`Measurement`]: for each [`Side`] numbers in one of a few
//! layouts ([`Data`]), what they stand for ([`Channel`]: colours, wavelengths, bands), and where they come from ([`Metadata`]).
//! Made ready it is a [`Measured`]: negative and missing values replaced as asked and counted ([`Found`]), colours projected to linear
//! RGB ([`ToRgb`]), sampling prepared.
//!
//! | layout | between the values | drawn from |
//! |---|---|---|
//! | [`Grid`] over half and difference angles | linear | half vectors, by cells |
//! | [`Grid`] over directions | linear | incoming directions, by cells |
//! | [`Klems`] | constant in a patch | f·cosθi exactly |
//! | [`TensorTree`] | constant in a square | f·cosθi exactly |
//! | [`Adaptive`] | linear | half vectors, by luminance |
//!
//! To add a layout: a variant of [`Data`] with its entries there, and its prepared form in `prepared.rs`. To add a format: a file in
//! `format`, and a line in [`format::FORMATS`].

mod adaptive;
mod build;
mod channel;
mod convert;
mod file;
pub mod format;
mod grid;
mod input;
mod klems;
mod load;
mod measurement;
mod metadata;
mod output;
mod prepared;
mod repair;
mod samples;
mod search;
pub mod tensor_file;
mod tree;
mod values;
mod views;

pub(crate) use adaptive::AdaptiveTable;
pub use adaptive::{Adaptive, Nodes, Tables};
pub use build::{Layout, Progress, Sampled, tabulate};
pub use channel::{Channel, ToRgb, wavelengths};
pub use convert::{
    Albedo, ConversionReport, Difference, Shape, Source, TARGETS, Target, Worst, convert,
};
pub use grid::{Axis, Boundary, Grid, Parameterization, Scale};
pub use input::Input;
pub use klems::{Basis, Klems};
pub use load::{load, parse, read};
pub use measurement::{Component, Data, Measurement, Side};
pub use metadata::{Found, Metadata, Repair};
pub use prepared::{LoadOptions, Measured, Missing, Select};
pub use tree::TensorTree;
pub use values::Values;
