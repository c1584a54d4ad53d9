//! `gonio diff`.

use crate::support::{Place, panorama};
use gonio::image::Image;

#[test]
fn equal_pictures() {
    let place = Place::new();
    place.picture("a.exr", &panorama());
    let said = place.good(&["diff", "a.exr", "a.exr"]);
    assert!(
        said.out.contains("none: the pictures are equal") && said.out.contains("infinite"),
        "{said:?}"
    );
    let json = place.json(&["diff", "a.exr", "a.exr", "--json"]);
    assert_eq!(json["rmse"], 0.0);
}

#[test]
fn the_largest_difference_is_found_and_shown() {
    let place = Place::new();
    let mut other = panorama();
    other.set(3, 2, [2.0, 1.5, 1.25]);
    place.picture("a.exr", &panorama());
    place.picture("b.exr", &other);
    let text = place
        .good(&["diff", "b.exr", "a.exr", "--heatmap", "where.png"])
        .out;
    assert!(
        text.contains("0.250000 at column 3, row 2, blue: 1.25 against 1"),
        "{text}"
    );
    for word in ["RMSE", "relative MSE", "PSNR", "FLIP"] {
        assert!(text.contains(word), "{text}");
    }
    let heat = place.image("where.png");
    assert_eq!((heat.width, heat.height), (16, 8));
    let json = place.json(&["diff", "b.exr", "a.exr", "--json"]);
    assert_eq!(
        (&json["largest"]["x"], &json["largest"]["y"]),
        (&3.into(), &2.into())
    );
    // RMSE over 16 · 8 pixels of three channels.
    let expected = 0.25 / (16.0 * 8.0 * 3.0_f64).sqrt();
    assert!(
        (json["rmse"].as_f64().unwrap() - expected).abs() < 1e-6,
        "{json}"
    );
}

#[test]
fn pictures_of_different_sizes_cannot_be_compared() {
    let place = Place::new();
    place.picture("a.png", &Image::filled(4, 4, [0.5; 3]));
    place.picture("b.png", &Image::filled(4, 5, [0.5; 3]));
    place.bad(
        &["diff", "a.png", "b.png", "--heatmap", "c.png"],
        3,
        &["a.png", "b.png", "same size"],
    );
}
