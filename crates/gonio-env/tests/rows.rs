//! A conversion made row by row is the conversion made at once; a whole number of texels is averaged exactly.

use gonio_env::test_image::six_axes;
use gonio_env::{Convention, Conversion, Layout, Panorama, rotation_deg};
use gonio_image::Image;

fn labelled() -> Panorama {
    Panorama::new(
        six_axes(Layout::LatLong, 64),
        Layout::LatLong,
        Convention::Gonio,
    )
    .expect("a panorama")
}

/// However many rows are asked for: fewer than are made at a time, as many, more, and a rest.
#[test]
fn rows_are_those_of_the_whole_picture() {
    for (layout, size) in [(Layout::Octahedral, 150), (Layout::CubeStrip, 70)] {
        let conversion = Conversion {
            size: Some(size),
            rotation: rotation_deg(20.0, 10.0, 5.0),
            ..Conversion::to(layout)
        };
        let (whole, kept) = labelled().converted(&conversion);
        for count in [1, 7, 64, 65, 150] {
            let mut rows = labelled().into_rows(&conversion);
            let [width, height] = rows.size();
            let mut image = Image::new(width, height);
            for first in (0..height).step_by(count) {
                let end = (first + count).min(height);
                rows.make(first, &mut image.pixels[first * width..end * width]);
            }
            assert_eq!(&image, whole.image(), "{layout}, {count} rows");
            assert_eq!(rows.kept(), kept);
        }
    }
}

#[test]
fn faces_are_made_one_after_the_other() {
    let conversion = Conversion {
        size: Some(33),
        convention: Convention::OpenGl,
        ..Conversion::to(Layout::CubeStrip)
    };
    let (whole, kept) = labelled().converted(&conversion);
    let faces = whole.faces().expect("a cube");
    let mut rows = labelled().into_rows(&conversion);
    for (k, face) in faces.iter().enumerate() {
        let mut image = Image::new(33, 33);
        for (first, texels) in image.pixels.chunks_mut(10 * 33).enumerate() {
            rows.make_face(k, 10 * first, texels);
        }
        assert_eq!(&image, face, "face {k}");
    }
    for (found, expected) in rows
        .kept()
        .after
        .iter()
        .flatten()
        .zip(kept.after.iter().flatten())
    {
        // The same terms in another order: 4 parts of 33 · 6 · 33 texels, each rounded to 2⁻⁵³.
        assert!(
            (found / expected - 1.0).abs() < 1e-11,
            "{found} for {expected}"
        );
    }
}

/// Rows of a panorama weigh sin θ; nothing of a neighbour comes in.
#[test]
fn a_whole_number_of_texels_is_their_mean() {
    let old = Image::from_fn(24, 12, |x, y| {
        [(x + 10 * y) as f32, (y % 3) as f32, (x / 3) as f32]
    });
    let panorama =
        Panorama::new(old.clone(), Layout::LatLong, Convention::Gonio).expect("a panorama");
    let to = |rotation| Conversion {
        size: Some(4),
        rotation,
        ..Conversion::to(Layout::LatLong)
    };
    let made = panorama.clone().resampled(&to(rotation_deg(0.0, 0.0, 0.0)));
    assert_eq!((made.image().width, made.image().height), (8, 4));
    for y in 0..4 {
        for x in 0..8 {
            let (mut sum, mut total) = ([0.0; 3], 0.0);
            for j in 3 * y..3 * y + 3 {
                let weight = f64::sin(std::f64::consts::PI * (j as f64 + 0.5) / 12.0);
                for i in 3 * x..3 * x + 3 {
                    for (s, c) in sum.iter_mut().zip(old.get(i, j)) {
                        *s += weight * f64::from(c);
                    }
                    total += weight;
                }
            }
            for (found, sum) in made.image().get(x, y).into_iter().zip(sum) {
                // Rounded to single precision once.
                let expected = sum / total;
                assert!(
                    (f64::from(found) - expected).abs() <= 6e-8 * expected,
                    "({x}, {y}): {found} for {expected}"
                );
            }
        }
    }
    // Turned, it is another picture.
    let turned = panorama.resampled(&to(rotation_deg(7.0, 0.0, 0.0)));
    assert_ne!(turned.image(), made.image());
}
