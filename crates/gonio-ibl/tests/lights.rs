//! Directional lights that stand for an environment.

#![allow(clippy::unwrap_used)]

use gonio_env::{Environment, Layout};
use gonio_ibl::lights::{Cut, extract};
use gonio_image::Image;
use gonio_num::Vec3;

fn scene() -> Environment {
    let image = Image::from_fn(128, 64, |x, y| match (x, y) {
        (90..93, 20..23) => [500.0, 400.0, 300.0],
        _ => [0.3, 0.5, 1.0 - y as f32 / 80.0],
    });
    Environment::from_image(image, Layout::LatLong).unwrap()
}

#[test]
fn flux_is_kept_and_more_lights_are_nearer() {
    let env = scene();
    for cut in [Cut::Median, Cut::Variance] {
        let errors: Vec<f64> = [1, 8, 64, 256]
            .into_iter()
            .map(|n| {
                let found = extract(&env, n, cut).unwrap();
                assert_eq!(found.lights.len(), n);
                let flux: f64 = found.lights.iter().map(|l| l.irradiance[1]).sum();
                // Texels as constants against interpolated ones: the sun's edges are averaged alike, to (Δ/2)² = 6e-4.
                let exact = env.mean_radiance()[1] * 4.0 * std::f64::consts::PI;
                assert!(
                    (flux / exact - 1.0).abs() < 2e-3,
                    "{cut:?} {n}: {flux} {exact}"
                );
                let area: f64 = found.lights.iter().map(|l| l.solid_angle).sum();
                assert!((area - 4.0 * std::f64::consts::PI).abs() < 1e-9);
                found.mean_error
            })
            .collect();
        assert!(
            errors[0] > errors[1] && errors[1] > errors[2],
            "{cut:?} {errors:?}"
        );
        assert!(errors[3] < 0.02, "{cut:?} {errors:?}");
    }
}

/// One light of a picture with one bright texel is there, also when the picture is turned.
#[test]
fn a_single_light_is_found() {
    let image = Image::from_fn(64, 32, |x, y| {
        [if (x, y) == (40, 9) { 1.0 } else { 0.0 }; 3]
    });
    let texel: Vec3<f64> = Layout::LatLong.direction([40.5 / 64.0, 9.5 / 32.0]);
    for deg in [0.0, 90.0] {
        let env = Environment::from_image(image.clone(), Layout::LatLong)
            .unwrap()
            .rotated_deg(deg);
        let found = extract(&env, 4, Cut::Variance).unwrap();
        assert_eq!(found.lights.len(), 1);
        let [x, y, z] = found.lights[0].direction;
        let d = Vec3::new(x, y, z);
        // About +y, counter-clockwise from above: +x goes to −z.
        let expected = if deg > 0.0 {
            Vec3::new(texel.z, texel.y, -texel.x)
        } else {
            texel
        };
        assert!((d - expected).length() < 1e-9, "{deg}: {d:?} {expected:?}");
    }
}

#[test]
fn bad_counts_and_darkness_are_refused() {
    let env = scene();
    for n in [0, 5000] {
        assert!(extract(&env, n, Cut::Median).is_err());
    }
    assert!(extract(&Environment::uniform([0.0; 3]), 4, Cut::Median).is_err());
    assert!("mean".parse::<Cut>().is_err());
}
