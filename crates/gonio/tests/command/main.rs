//! The `gonio` command, run as a user runs it.

#![allow(clippy::unwrap_used)]

mod arguments;
mod brdf;
mod checkpoint;
mod ci;
mod convert;
mod damaged;
mod diff;
mod divide;
mod environment;
mod exec;
mod explore;
mod export;
mod farm;
mod interrupt;
mod layers;
mod live;
mod measure;
mod plot;
mod prefilter;
mod relight;
mod render;
mod scenes;
mod schema;
mod support;
mod writing;
