//! Bytes as a part of a picture.
#![no_main]

use gonio_render::RenderError;
use gonio_render::part::Opened;
use std::path::Path;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let opened = Opened::of(bytes, bytes.len() as u64, Path::new("fuzz.file"));
    // A film of an absurd size is refused before it is made.
    match opened.and_then(Opened::read) {
        Ok(exposure) => {
            let Some(count) = exposure.samples.end.checked_sub(exposure.samples.start) else {
                panic!("samples {:?}", exposure.samples);
            };
            for pixel in exposure.film.pixels() {
                assert!(pixel.samples() <= count);
                assert!(pixel.mean().iter().all(|m| m.is_finite() && *m >= 0.0));
            }
        }
        Err(RenderError::Part { path, .. }) => assert_eq!(path, Path::new("fuzz.file")),
        Err(RenderError::Limit { .. } | RenderError::Parameter { .. }) => {}
        Err(other) => panic!("not an error of the format: {other}"),
    }
});
