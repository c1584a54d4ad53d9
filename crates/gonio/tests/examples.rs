//! The examples do what they say.

#![allow(clippy::unwrap_used, dead_code)]

#[path = "../examples/lamp.rs"]
mod lamp;
#[path = "../examples/own_function.rs"]
mod own_function;
#[path = "../examples/panorama.rs"]
mod panorama;
#[path = "../examples/plots.rs"]
mod plots;
#[path = "../examples/sphere.rs"]
mod sphere;

#[test]
fn the_sphere_is_golden() {
    let film = sphere::sphere(16, 4).unwrap();
    let [r, _, b] = film.image().get(8, 8);
    assert!(r > 1.2 * b && b > 0.0, "{r} {b}");
}

#[test]
fn the_hasty_function_is_found_out() {
    let failed: Vec<String> = own_function::hasty()
        .unwrap()
        .failures()
        .map(|v| v.property.to_string())
        .collect();
    assert_eq!(failed, ["reciprocity"]);
    let report = own_function::careful().unwrap();
    assert!(report.passed(), "{report}");
}

#[test]
fn the_floor_gets_pi_under_uniform_radiance() {
    let sky = gonio::env::Environment::uniform([1.0; 3]);
    for (name, irradiance) in panorama::irradiances(&sky) {
        assert!(
            (irradiance[0] - std::f64::consts::PI).abs() < 1e-12,
            "{name}"
        );
    }
}

#[test]
fn the_lamp_agrees_with_its_closed_form() {
    let (reading, exact) = (lamp::sampled(1 << 14).unwrap(), lamp::closed_form().value());
    let error = reading.standard_error.unwrap()[0];
    // Sampled by solid angle, every sample is nearly the mean; f32 geometry keeps about six digits.
    assert!(
        (reading.value[0] - exact).abs() <= 5.0 * error + 1e-5 * exact,
        "{reading:?} {exact}"
    );
    assert!(error < 0.02 * exact);
}

#[test]
fn the_plots_of_the_book_are_up_to_date() {
    let folder = plots::folder();
    let mut expected = Vec::new();
    for (name, figure) in plots::pictures().unwrap() {
        let file = format!("{name}.svg");
        // A checkout may have other line ends.
        let found = std::fs::read_to_string(folder.join(&file))
            .unwrap_or_default()
            .replace("\r\n", "\n");
        assert!(
            found == figure.svg(),
            "book/src/plots/{file} is not up to date: run `cargo run -p gonio --example plots`"
        );
        expected.push(file);
    }
    expected.sort();
    let mut present: Vec<String> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    present.sort();
    assert_eq!(present, expected);
}
