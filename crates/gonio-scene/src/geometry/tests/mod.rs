//! Tests of ray queries as a whole.

mod agreement;
mod leaving;
mod many;
mod placing;
mod sampling;
mod scenes;
mod watertight;
