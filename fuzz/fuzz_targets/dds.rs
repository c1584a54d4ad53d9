//! Bytes as a DDS file.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read_texture(bytes));
