//! Measured tables, on tables made from models whose truth is known.

// Helpers of tests are tests, and colours are short arrays walked side by side.
#![allow(clippy::unwrap_used, clippy::needless_range_loop)]

mod adaptive;
mod bad_input;
mod conversion;
mod formats;
mod layouts;
mod orientation;
mod rgl;
mod support;
