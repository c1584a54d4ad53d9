//! Bytes as a part of a picture: its header, then its pixels.
#![no_main]

use gonio_render::RenderError;
use gonio_render::part::Opened;
use std::path::Path;

/// Pixels beyond which no film is made: its memory is bounded by another limit, that of pictures.
const MOST_PIXELS: u64 = 1 << 12;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let path = Path::new("fuzz.file");
    let opened = match Opened::of(bytes, bytes.len() as u64, path) {
        Ok(opened) => opened,
        Err(error) => return named(&error),
    };
    let header = opened.header.clone();
    let pixels = u64::from(header.width) * u64::from(header.height);
    if pixels > MOST_PIXELS {
        return;
    }
    match opened.read() {
        Ok(exposure) => {
            assert_eq!(exposure.samples, header.samples());
            assert_eq!(exposure.film.pixels().len() as u64, pixels);
        }
        Err(error) => named(&error),
    }
});

/// An error names the file, or the number in its header that no film can have.
fn named(error: &RenderError) {
    match error {
        RenderError::Part { path, .. } => assert_eq!(path, Path::new("fuzz.file")),
        RenderError::Parameter { .. } | RenderError::Limit { .. } => {}
        other => panic!("not an error of the format: {other}"),
    }
}
