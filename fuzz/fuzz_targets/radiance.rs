//! Bytes as a file of the format radiance.
#![no_main]

use gonio_brdf::measured::format::radiance::parse;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read(parse, bytes));
