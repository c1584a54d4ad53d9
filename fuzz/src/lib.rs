//! What every target does with its bytes.

use gonio_brdf::BrdfError;
use gonio_brdf::measured::{Input, Measurement};
use gonio_image::{CubeMap, Image, ImageError, Limits};
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

/// Reads bytes as a cube map and as a picture. What is read has the size that it says; an error names the file.
pub fn read_texture(bytes: &[u8]) {
    let limits = Limits {
        max_pixels: 1 << 20,
        max_bytes: 1 << 24,
    };
    let named = |error: &ImageError| assert!(error.to_string().starts_with("<memory>"), "{error}");
    match CubeMap::decode(bytes, &limits) {
        Ok(cube) => {
            for (level, faces) in cube.levels.iter().enumerate() {
                for face in faces {
                    assert_eq!(face.width, (cube.size >> level).max(1));
                    assert_eq!(face.pixels.len(), face.width * face.height);
                }
            }
        }
        Err(error) => named(&error),
    }
    match Image::decode(bytes, &limits) {
        Ok(image) => assert_eq!(image.pixels.len(), image.width * image.height),
        Err(error) => named(&error),
    }
}
