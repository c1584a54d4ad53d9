//! Pixels: encoding PNG, and drawing a page.

use crate::page::{Page, Raster};
use crate::{PlotError, font};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use resvg::tiny_skia::{
    Color, FilterQuality, Pixmap, PixmapPaint, PremultipliedColorU8, Transform,
};
use resvg::usvg;

/// Pixels of a picture at most: what a screen or a page of print can show.
pub const MOST_PIXELS: u64 = 100_000_000;

/// Opaque sRGB as a PNG file.
pub(crate) fn encode(size: [u32; 2], rgb: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    PngEncoder::new_with_quality(&mut out, CompressionType::Default, FilterType::Adaptive)
        .write_image(rgb, size[0], size[1], ExtendedColorType::Rgb8)
        .expect("invariant: the picture has three bytes a pixel, and memory takes them");
    out
}

/// The page on white, `density` pixels for each of its own along both sides, as a PNG file.
pub(crate) fn draw(page: &Page, density: f64) -> Result<Vec<u8>, PlotError> {
    let failed = |what: &str| PlotError::Drawing(what.into());
    let [w, h] = page.size.map(|x| (x * density).round());
    if !(w >= 1.0 && h >= 1.0 && w * h <= MOST_PIXELS as f64) {
        return Err(PlotError::Option {
            option: "size",
            found: format!("{w} × {h} pixels"),
            expected: format!("1 to {MOST_PIXELS} pixels"),
        });
    }
    let mut canvas = Pixmap::new(w as u32, h as u32).ok_or_else(|| failed("no memory"))?;
    canvas.fill(Color::WHITE);
    for raster in &page.rasters {
        paste(&mut canvas, raster, density).ok_or_else(|| failed("no memory"))?;
    }
    // Ground and pictures are there: the page without them goes on top.
    let options = usvg::Options {
        fontdb: font::database(),
        font_family: "Inter".into(),
        ..usvg::Options::default()
    };
    let tree = usvg::Tree::from_str(&page.document("", "", false), &options)
        .map_err(|e| failed(&e.to_string()))?;
    let scale = Transform::from_scale(density as f32, density as f32);
    resvg::render(&tree, scale, &mut canvas.as_mut());
    let rgb: Vec<u8> = canvas
        .pixels()
        .iter()
        .flat_map(|p| [p.red(), p.green(), p.blue()])
        .collect();
    Ok(encode([w as u32, h as u32], &rgb))
}

fn paste(canvas: &mut Pixmap, raster: &Raster, density: f64) -> Option<()> {
    let mut picture = Pixmap::new(raster.size[0], raster.size[1])?;
    for (to, from) in picture.pixels_mut().iter_mut().zip(raster.rgb.chunks(3)) {
        *to = PremultipliedColorU8::from_rgba(from[0], from[1], from[2], 255)?;
    }
    let [x, y, w, h] = raster.place.map(|x| x * density);
    let scale = [w / f64::from(raster.size[0]), h / f64::from(raster.size[1])].map(|x| x as f32);
    let place = Transform::from_row(scale[0], 0.0, 0.0, scale[1], x as f32, y as f32);
    let paint = PixmapPaint {
        quality: FilterQuality::Bilinear,
        ..PixmapPaint::default()
    };
    canvas.draw_pixmap(0, 0, picture.as_ref(), &paint, place, None);
    Some(())
}
