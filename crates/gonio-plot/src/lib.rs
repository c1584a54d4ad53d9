//! Plots of reflection functions: closures in, SVG and PNG out. It knows no BRDF, so it draws anybody's.
//!
//! A [`Function`] is f(ωi→ωr) as a closure, [`Options`] say what is shown, and each kind of plot is a function that returns a
//! [`Figure`], which is an SVG text and can be turned into PNG:
//!
//! | plot | shows |
//! |---|---|
//! | [`polar()`] | the lobes in the plane of incidence |
//! | [`cartesian()`] | the value against the angle of reflection |
//! | [`albedo()`] | the directional albedo against the angle of incidence |
//! | [`slice()`] | a picture of f by half and difference angle |
//! | [`lobe3d()`] | the lobe in space |
//! | [`sphere()`] | a ball under a point light |
//! | [`difference()`] | by how much the second of two functions differs from the first |
//! | [`pictures()`] | pictures that somebody else has rendered, side by side |
//! | [`lines()`] | lines that somebody else has computed, on two axes |
//!
//! [`numbers`] has what they are drawn from, for programs that draw for themselves.
//!
//! The same functions and options give the same bytes of SVG on every machine and for any number of threads.

mod albedo;
mod ball;
mod canvas;
mod cartesian;
mod chart;
mod colours;
mod curves;
mod depth;
mod difference;
mod error;
mod figure;
mod font;
mod function;
mod integral;
mod lines;
mod lobe3d;
mod mesh;
pub mod numbers;
mod options;
mod page;
mod png;
mod polar;
mod scale;
mod slice;
mod trace;

pub use albedo::albedo;
pub use ball::{Picture, picture_side, pictures, sphere};
pub use cartesian::cartesian;
pub use difference::difference;
pub use error::PlotError;
pub use figure::Figure;
pub use function::{Draw, Function};
pub use lines::{Axes, Line, lines};
pub use lobe3d::lobe3d;
pub use options::{Channel, MOST_ANGLES, MOST_FUNCTIONS, Options};
pub use png::MOST_PIXELS;
pub use polar::polar;
pub use scale::ScaleKind;
pub use slice::slice;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
