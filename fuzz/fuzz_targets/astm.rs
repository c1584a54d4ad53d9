//! Bytes as a file of the format astm.
#![no_main]

use gonio_brdf::measured::format::astm::parse;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read(parse, bytes));
