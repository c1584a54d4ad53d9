//! What every target does with its bytes.

use gonio_brdf::BrdfError;
use gonio_brdf::measured::{Input, Measurement};
use gonio_num::Vec3;
use std::path::Path;

/// Reads bytes and evaluates what comes of them. An error must name the file.
pub fn read(parse: impl Fn(&Input<'_>) -> Result<Measurement, BrdfError>, bytes: &[u8]) {
    match parse(&Input::new(Path::new("fuzz.file"), bytes)) {
        Ok(measurement) => {
            measurement
                .check()
                .expect("what a reader gives is consistent");
            for wo in [Vec3::new(0.0, 0.0, 1.0), Vec3::new(-0.6, 0.0, 0.8)] {
                for wi in [Vec3::new(0.0, 0.8, 0.6), Vec3::new(0.6, 0.0, -0.8)] {
                    let values = measurement.eval(wi, wo);
                    assert_eq!(values.len(), measurement.channels.len());
                }
            }
        }
        Err(BrdfError::Format { path, .. }) => assert_eq!(path, Path::new("fuzz.file")),
        Err(other) => panic!("not an error of the format: {other}"),
    }
}
