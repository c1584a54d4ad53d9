//! Pictures of light: pixel buffers, their files, tone mapping, and differences.
//!
//! An [`Image`] is linear RGB with Rec. 709 primaries. [`Layers`] are any number of named channels with string
//! metadata, as OpenEXR stores them. A [`RawImage`] is what a PNG or JPEG file holds, alpha included and undecoded, as
//! textures need it.
//!
//! | format | in | out |
//! |---|---|---|
//! | OpenEXR | half, float and uint; every layer; scan lines and tiles; all its usual compressions; strings | half, float, uint; many layers; strings; none, RLE, ZIP, PIZ |
//! | Radiance HDR | flat, old and new run lengths; exposure; all eight orientations | new run lengths |
//! | PNG | 1 to 16 bits, grey, palette, alpha | 8 and 16 bits, sRGB transfer |
//! | JPEG | baseline and progressive, EXIF orientation | no |
//! | TIFF | 8 and 16 bits, float; grey, RGB, alpha; uncompressed, LZW, deflate, PackBits, JPEG | no |
//! | KTX2 | one picture or a cube, with levels: half, float, RGB9E5, R11G11B10, BC6H, 8-bit codes; plain, Zstandard, ZLIB | half, float, RGB9E5, BC6H |
//! | DDS | the same, plain; headers with and without DX10 | half, float, RGB9E5, BC6H, with DX10 |
//!
//! A reader decides by what the file holds, not by its name. It never alters values: what to do about a NaN is the
//! caller's choice, and [`Image::scan`] finds it. [`Limits`] are checked before memory is taken. A writer makes a
//! temporary file in the same folder and renames it, so no reader ever sees half a picture.
//!
//! ```
//! use gonio_image::{Image, Layers, tonemap::ToneMap};
//!
//! let folder = std::env::temp_dir().join(format!("gonio-image-doc-{}", std::process::id()));
//! std::fs::create_dir_all(&folder)?;
//! let ramp = Image::from_fn(64, 32, |x, _| [x as f32 / 8.0; 3]);
//! ramp.write(&folder.join("ramp.exr"))?;
//! assert_eq!(Image::read(&folder.join("ramp.exr"))?, ramp);
//!
//! let mut layers = Layers::from_image(&ramp);
//! layers.push_rgb("albedo", &Image::filled(64, 32, [0.5; 3]))?;
//! layers.set_metadata("samples", "256");
//! layers.write_exr(&folder.join("layers.exr"))?;
//! assert_eq!(Layers::read_exr(&folder.join("layers.exr"))?.metadata("samples"), Some("256"));
//!
//! ramp.write_png(&folder.join("ramp.png"), ToneMap::PbrNeutral, -1.0)?;
//! let difference = gonio_image::difference::compare(&ramp, &ramp)?;
//! assert_eq!(difference.flip_mean, 0.0);
//! std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod atomic;
pub mod colormap;
mod contain;
mod cube;
pub mod difference;
mod error;
mod format;
mod image;
mod layers;
mod limits;
mod raw;
mod rows;
mod scan;
pub mod srgb;
pub mod tonemap;

pub use atomic::{
    rewrite_with as rewrite_file_with, write as write_file, write_with as write_file_with,
};
pub use cube::CubeMap;
pub use error::ImageError;
pub use exr::prelude::f16;
pub use format::{FileFormat, TexelFormat};
pub use image::Image;
pub use layers::{Channel, ChannelData, Chromaticities, Compression, Layers};
pub use limits::Limits;
pub use raw::{RawData, RawImage};
pub use rows::{Fill, Store, write_rows};
pub use scan::{Found, Scan};
