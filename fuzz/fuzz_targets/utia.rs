//! Bytes as a file of the format utia. All files have one length: shorter input is repeated up to it.
#![no_main]

use gonio_brdf::measured::format::utia::parse;

const LENGTH: usize = 6 * 48 * 6 * 48 * 3 * 8;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    match bytes {
        // As it is, too short.
        [] | [0, ..] => gonio_fuzz::read(parse, bytes),
        _ => {
            let repeated: Vec<u8> = bytes.iter().copied().cycle().take(LENGTH).collect();
            gonio_fuzz::read(parse, &repeated);
        }
    }
});
