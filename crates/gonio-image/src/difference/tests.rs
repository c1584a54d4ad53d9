use super::*;

#[test]
fn equal_pictures_differ_nowhere() {
    let image = Image::from_fn(20, 10, |x, y| [x as f32, y as f32, 0.5]);
    let d = compare(&image, &image).unwrap();
    assert_eq!((d.rmse, d.relative_mse, d.flip_mean), (0.0, 0.0, 0.0));
    assert_eq!(d.psnr_db, f64::INFINITY);
    assert_eq!(d.largest.difference, 0.0);
    assert_eq!(heatmap(&d), Image::filled(20, 10, colormap::magma(0.0)));
}

/// One sample of 4·3·3 = 36 differs by 0.5 from 2: Σ = 0.25, RMSE = √(0.25/36) = 1/12, relative MSE = 0.25/4.01/36, peak 2,
/// PSNR = 20 log₁₀ 24 = 27.604225 dB.
#[test]
fn figures_by_hand() {
    let reference = Image::filled(4, 3, [2.0; 3]);
    let mut picture = reference.clone();
    picture.set(1, 2, [2.0, 2.5, 2.0]);
    let d = compare(&picture, &reference).unwrap();
    assert!((d.rmse - 1.0 / 12.0).abs() < 1e-12);
    assert!((d.relative_mse - 0.25 / 4.01 / 36.0).abs() < 1e-12);
    assert!(
        (d.psnr_db - 27.604_224_834_232_118).abs() < 1e-9,
        "{}",
        d.psnr_db
    );
    let expected = Largest {
        x: 1,
        y: 2,
        channel: 1,
        a: 2.5,
        b: 2.0,
        difference: 0.5,
    };
    assert_eq!(d.largest, expected);
    // The picture and the reference are not exchangeable: the relative error divides by the reference.
    let swapped = compare(&reference, &picture).unwrap();
    assert_eq!(swapped.rmse, d.rmse);
    assert!(swapped.relative_mse < d.relative_mse);
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let fails = |a: &Image, b: &Image, options: &Options, words: &str| {
        let error = compare_with(a, b, options).unwrap_err();
        assert!(matches!(error, ImageError::Parameter { .. }));
        assert!(error.to_string().contains(words), "{error}");
    };
    let defaults = Options::default();
    let grey = Image::filled(3, 2, [0.5; 3]);
    fails(&grey, &Image::new(2, 3), &defaults, "3 × 2 and 2 × 3");
    fails(
        &Image::new(0, 0),
        &Image::new(0, 0),
        &defaults,
        "nothing to compare",
    );
    let mut broken = grey.clone();
    broken.set(2, 1, [0.0, 0.0, f32::NAN]);
    fails(
        &broken,
        &grey,
        &defaults,
        "the first picture has NaN in channel B of pixel (2, 1)",
    );
    broken.set(2, 1, [f32::INFINITY, 0.0, 0.0]);
    fails(
        &grey,
        &broken,
        &defaults,
        "the second picture has inf in channel R of pixel (2, 1)",
    );
    for pixels_per_degree in [0.0, -1.0, 1e9, f64::NAN] {
        let options = Options {
            pixels_per_degree,
            ..defaults
        };
        fails(&grey, &grey, &options, "pixels per degree");
    }
}

#[test]
fn a_single_pixel_can_be_compared() {
    let d = compare(
        &Image::filled(1, 1, [0.2; 3]),
        &Image::filled(1, 1, [0.3; 3]),
    )
    .unwrap();
    assert!(d.flip_mean > 0.0 && d.flip_mean < 1.0);
    assert_eq!(heatmap(&d).pixels.len(), 1);
}
