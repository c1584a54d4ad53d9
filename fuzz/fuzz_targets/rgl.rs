//! Bytes as a file of the format rgl.
#![no_main]

use gonio_brdf::measured::format::rgl::parse;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read(parse, bytes));
