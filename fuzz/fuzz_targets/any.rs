//! Bytes as a file of any format, told by its content.
#![no_main]

use gonio_brdf::measured::Input;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    gonio_fuzz::read(
        |input: &Input<'_>| {
            gonio_brdf::measured::parse(input.path(), input.bytes()).map(|(_, m)| m)
        },
        bytes,
    )
});
