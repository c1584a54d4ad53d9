use super::*;
use proptest::prelude::*;

fn read(bytes: &[u8]) -> Result<Image, ImageError> {
    decode("test.hdr", bytes, bytes.len() as u64, &Limits::default())
}

fn file(header: &str, pixels: &[u8]) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\n{header}").into_bytes();
    bytes.extend_from_slice(pixels);
    bytes
}

/// m = 128, e = 129 + k is 2^k exactly.
fn power(k: i32) -> [u8; 4] {
    [128, 0, 0, (129 + k) as u8]
}

#[test]
fn known_pixels() {
    assert_eq!(from_rgbe([128, 64, 32, 129]), [1.0, 0.5, 0.25]);
    assert_eq!(from_rgbe([0, 0, 0, 0]), [0.0; 3]);
    assert_eq!(
        from_rgbe([255, 255, 255, 0]),
        [0.0; 3],
        "exponent 0 is black"
    );
    assert_eq!(to_rgbe([1.0, 0.5, 0.25]), Ok([128, 64, 32, 129]));
    assert_eq!(to_rgbe([0.0; 3]), Ok([0; 4]));
    // 255.5/256 and above round to 256: the next exponent.
    assert_eq!(to_rgbe([0.999; 3]), Ok([128, 128, 128, 129]));
    assert_eq!(to_rgbe([f32::MAX; 3]), Ok([255, 255, 255, 255]));
    // The smallest exponent is 1; below 2^-128 the mantissa has fewer bits, and below 2^-136 none.
    assert_eq!(to_rgbe([2f32.powi(-131), 0.0, 0.0]), Ok([16, 0, 0, 1]));
    assert_eq!(from_rgbe(to_rgbe([1e-45; 3]).unwrap()), [0.0; 3]);
    assert_eq!(to_rgbe([1.0, f32::NAN, 0.0]), Err(1));
    assert_eq!(to_rgbe([1.0, 0.0, -1e-9]), Err(2));
    assert_eq!(to_rgbe([f32::INFINITY, 0.0, 0.0]), Err(0));
}

/// (1, 1, 1, 1) would be read as a run in a flat scan line.
#[test]
fn the_pixel_that_means_a_run_is_written_as_black() {
    let least = 2f32.powi(-135);
    assert_eq!(to_rgbe([least; 3]), Ok([1; 4]));
    let image = Image {
        width: 2,
        height: 1,
        pixels: vec![[1.0; 3], [least; 3]],
    };
    assert_eq!(
        read(&encode(&image).unwrap()).unwrap().pixels,
        [[1.0; 3], [0.0; 3]]
    );
    let long = Image::filled(8, 1, [least; 3]);
    assert_eq!(read(&encode(&long).unwrap()).unwrap(), long);
}

#[test]
fn every_pixel_value_comes_back() {
    for e in 1..=255u8 {
        for m in 0..=255u8 {
            let rgb = from_rgbe([m, 200, 7, e]);
            assert_eq!(from_rgbe(to_rgbe(rgb).unwrap()), rgb, "{m} {e}");
        }
    }
}

#[test]
fn exposure_and_colour_correction_are_taken_back() {
    let bytes = file(
        "# a comment\nEXPOSURE=2\r\nEXPOSURE= 4.0\nCOLORCORR=1 2 4\nSOFTWARE=x\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n",
        &[128, 128, 128, 132],
    );
    // 8 / (2 · 4) and 1, 1/2, 1/4.
    assert_eq!(read(&bytes).unwrap().pixels, [[1.0, 0.5, 0.25]]);
}

/// Six pixels in the file's order, 2⁰ … 2⁵, and where each orientation puts them.
#[test]
fn all_orientations() {
    let pixels: Vec<u8> = (0..6).flat_map(power).collect();
    let expected: [(&str, usize, [i32; 6]); 8] = [
        ("-Y 2 +X 3", 3, [0, 1, 2, 3, 4, 5]),
        ("-Y 2 -X 3", 3, [2, 1, 0, 5, 4, 3]),
        ("+Y 2 +X 3", 3, [3, 4, 5, 0, 1, 2]),
        ("+Y 2 -X 3", 3, [5, 4, 3, 2, 1, 0]),
        ("+X 3 -Y 2", 3, [0, 2, 4, 1, 3, 5]),
        ("-X 3 -Y 2", 3, [4, 2, 0, 5, 3, 1]),
        ("+X 3 +Y 2", 3, [1, 3, 5, 0, 2, 4]),
        ("-X 3 +Y 2", 3, [5, 3, 1, 4, 2, 0]),
    ];
    for (resolution, width, powers) in expected {
        let image = read(&file(&format!("\n{resolution}\n"), &pixels)).unwrap();
        assert_eq!((image.width, image.height), (width, 2));
        let red: Vec<f32> = image.pixels.iter().map(|p| p[0]).collect();
        assert_eq!(red, powers.map(|k| 2f32.powi(k)), "{resolution}");
    }
}

#[test]
fn old_run_lengths() {
    let mut pixels = power(0).to_vec();
    // 1 + 3 pixels, then 2 + 256 more by two run pixels in a row.
    pixels.extend([1, 1, 1, 3]);
    pixels.extend(power(1));
    pixels.extend([1, 1, 1, 2, 1, 1, 1, 1]);
    let image = read(&file("\n-Y 1 +X 263\n", &pixels)).unwrap();
    assert!(image.pixels[..4].iter().all(|p| p[0] == 1.0));
    assert!(image.pixels[4..].iter().all(|p| p[0] == 2.0));
    let too_long = read(&file("\n-Y 1 +X 100\n", &pixels))
        .unwrap_err()
        .to_string();
    assert!(
        too_long.contains("scan line 0") && too_long.contains("a run longer"),
        "{too_long}"
    );
    let first = read(&file("\n-Y 1 +X 5\n", &[1, 1, 1, 3]))
        .unwrap_err()
        .to_string();
    assert!(first.contains("a run before the first pixel"), "{first}");
    // Runs of no pixels for ever end with the file.
    assert!(read(&file("\n-Y 1 +X 5\n", &[[1, 1, 1, 0]; 20].concat())).is_err());
}

#[test]
fn errors_name_the_place() {
    let fails = |header: &str, pixels: &[u8], words: [&str; 2]| {
        let error = read(&file(header, pixels)).unwrap_err().to_string();
        for word in words {
            assert!(
                error.starts_with("test.hdr: ") && error.contains(word),
                "{error}"
            );
        }
    };
    fails("", &[], ["header line 2", "no end of the line"]);
    fails("\n", &[], ["header line 3", "no end of the line"]);
    fails("\nwhat\n", &[], ["header line 3", "`what`"]);
    fails(
        "\n-Y 1 +X 1 1\n",
        &[0; 4],
        ["header line 3", "-Y 512 +X 1024"],
    );
    fails(
        "\n-Y -1 +X 1\n",
        &[0; 4],
        ["header line 3", "-Y 512 +X 1024"],
    );
    fails("\n-Y 0 +X 1\n", &[0; 4], ["1 × 0", "at least one pixel"]);
    fails(
        "EXPOSURE=0\n\n-Y 1 +X 1\n",
        &[0; 4],
        ["header line 2", "positive"],
    );
    fails(
        "EXPOSURE=nan\n\n-Y 1 +X 1\n",
        &[0; 4],
        ["header line 2", "positive"],
    );
    fails(
        "COLORCORR=1 1\n\n-Y 1 +X 1\n",
        &[0; 4],
        ["header line 2", "three"],
    );
    fails(
        "FORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n",
        &[0; 4],
        ["FORMAT=32-bit_rle_xyze", "not supported"],
    );
    fails(
        "\n-Y 2 +X 2\n",
        &[9; 12],
        ["scan line 1 of 2", "the end of the file at pixel 1"],
    );
    fails("\n-Y 1 +X 9\n", &[2, 2, 0, 8], ["scan line 0", "8 pixels"]);
    fails(
        "\n-Y 1 +X 8\n",
        &[2, 2, 0, 8, 0],
        ["scan line 0", "a run of no pixels"],
    );
    fails(
        "\n-Y 1 +X 8\n",
        &[2, 2, 0, 8, 137, 1],
        ["scan line 0", "9 samples at pixel 0"],
    );
    fails(
        "\n-Y 1 +X 8\n",
        &[2, 2, 0, 8, 8, 1],
        ["scan line 0", "the end of the file"],
    );
    fails(
        "\n-Y 100000 +X 100000\n",
        &[0; 4],
        ["pixels (100000 × 100000)", "exceed the limit"],
    );
    fails(
        "\n-Y 2147483647 +X 2147483647\n",
        &[0; 4],
        ["exceed the limit", "268435456"],
    );
    fails(
        "\n-Y 10000 +X 10000\n",
        &[0; 4],
        ["4 bytes", "10000 scan lines"],
    );
}

#[test]
fn the_image_crate_reads_what_is_written() {
    let image = Image::from_fn(40, 7, |x, y| [x as f32 / 7.0, (y * y) as f32, 0.25]);
    let bytes = encode(&image).unwrap();
    let decoder = image::codecs::hdr::HdrDecoder::new(std::io::Cursor::new(&bytes)).unwrap();
    let theirs = image::DynamicImage::from_decoder(decoder)
        .unwrap()
        .into_rgb32f();
    let ours = read(&bytes).unwrap();
    for (p, q) in ours.pixels.iter().zip(theirs.pixels()) {
        assert_eq!(*p, q.0);
    }
}

/// Widths on both sides of 8, where new run lengths begin; few values, so that runs occur; the pixel that means a run.
fn pictures() -> impl Strategy<Value = Vec<[u8; 4]>> {
    let pixel = prop_oneof![
        3 => Just([1u8, 1, 1, 5]),
        2 => Just([2u8, 2, 3, 130]),
        3 => Just([200u8, 200, 200, 130]),
        2 => any::<[u8; 4]>(),
    ];
    prop::collection::vec(pixel, 1..400)
}

proptest! {
    #[test]
    fn written_pictures_come_back(rgbe in pictures()) {
        let image = Image { width: rgbe.len(), height: 1, pixels: rgbe.iter().map(|&p| from_rgbe(p)).collect() };
        prop_assert_eq!(read(&encode(&image).unwrap()).unwrap(), image);
    }

    /// The mantissa of the largest channel has 8 bits from 128 up: half a step is at most 1/256 of the largest.
    #[test]
    fn rounding_is_to_the_nearest(r in 1e-30f32..1e30, g in 0.0f32..1.0, b in 0.0f32..1.0) {
        let rgb = [r, g * r, b * r];
        let back = from_rgbe(to_rgbe(rgb).unwrap());
        for (v, w) in rgb.into_iter().zip(back) {
            prop_assert!((v - w).abs() <= r / 256.0 * 1.000_01);
        }
    }
}
