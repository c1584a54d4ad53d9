//! Pictures without noise, by Open Image Denoise.

use crate::cli::failure::Failure;
use gonio_image::Image;
use gonio_render::Film;

/// Whether this program can.
pub(super) const IS_THERE: bool = cfg!(feature = "denoise");

/// Fails where this program is built without the library.
pub(super) fn check() -> Result<(), Failure> {
    match IS_THERE {
        true => Ok(()),
        false => Err(Failure::usage(
            "--denoise: this program is built without Open Image Denoise",
        )
        .with_help(
            "install it (openimagedenoise.org), then build gonio with it: OIDN_DIR=/path/to/oidn cargo build --release --features denoise",
        )),
    }
}

/// The mean of all samples without its noise, as a neural network sees it with the help of the layers of albedo and normal (Áfra 2019, Open Image Denoise).
#[cfg(feature = "denoise")]
pub(super) fn denoised(film: &Film) -> Result<Image, Failure> {
    let failed = |what: &str, why: String| {
        Failure::input(format!("Open Image Denoise can't {what}: {why}"))
            .with_help("without --denoise the picture is written as it is")
    };
    let mut image = film.image();
    let flat = |of: fn(&gonio_render::PixelSums) -> [f32; 3]| -> Vec<f32> {
        film.pixels().iter().flat_map(of).collect()
    };
    // What it asks for: reflectances within 0 and 1, normals of any length.
    let albedo = flat(|p| p.albedo().map(|a| a.clamp(0.0, 1.0)));
    let normal = flat(|p| p.normal());
    let device = oidn::Device::new().map_err(|e| failed("start", e.to_string()))?;
    let mut filter =
        oidn::RayTracing::try_new(&device).map_err(|e| failed("start", e.to_string()))?;
    filter
        .image_dimensions(image.width, image.height)
        .hdr(true)
        .albedo_normal(&albedo, &normal);
    filter
        .filter_in_place(image.pixels.as_flattened_mut())
        .map_err(|e| failed("filter the picture", e.to_string()))?;
    Ok(image)
}

/// Fails: [`check`].
#[cfg(not(feature = "denoise"))]
pub(super) fn denoised(film: &Film) -> Result<Image, Failure> {
    check().map(|()| film.image())
}
