//! Irradiance against fields whose answer is known.

use gonio_env::{Environment, Layout};
use gonio_image::Image;
use gonio_num::Vec3;
use std::f64::consts::PI;

const NORMALS: [Vec3<f32>; 8] = [
    Vec3::new(1.0, 0.0, 0.0),
    Vec3::new(-1.0, 0.0, 0.0),
    Vec3::new(0.0, 1.0, 0.0),
    Vec3::new(0.0, -1.0, 0.0),
    Vec3::new(0.0, 0.0, 1.0),
    Vec3::new(0.0, 0.0, -1.0),
    Vec3::new(0.6, 0.48, 0.64),
    // Not unit: any length will do.
    Vec3::new(-2.0, 0.3, 1.0),
];

/// The picture of a field L(d).
fn picture(layout: Layout, size: usize, field: impl Fn(Vec3<f64>) -> f64) -> Image {
    let width = if layout.is_disc() { size } else { 2 * size };
    Image::from_fn(width, size, |x, y| {
        let uv = [
            (x as f64 + 0.5) / width as f64,
            (y as f64 + 0.5) / size as f64,
        ];
        if layout.contains(uv) {
            [field(layout.direction(uv)) as f32; 3]
        } else {
            [0.0; 3]
        }
    })
}

#[test]
fn uniform_radiance_gives_pi() {
    let env = Environment::uniform([1.0, 0.5, 0.0])
        .rotated_deg(33.0)
        .scaled([1.0, 1.0, 2.0]);
    for n in NORMALS {
        let e = env.irradiance_with_error(n);
        assert_eq!(e.value, [PI, 0.5 * PI, 0.0]);
        assert_eq!(e.error, [0.0; 3]);
    }
}

#[test]
fn a_white_picture_of_any_size_gives_pi() {
    for (width, height) in [(1, 1), (2, 1), (1, 2), (7, 3), (64, 32), (100, 37)] {
        let white = Image::filled(width, height, [1.0; 3]);
        let env = Environment::from_image(white, Layout::LatLong).unwrap();
        for n in NORMALS {
            let e = env.irradiance_with_error(n);
            // Every piece is smooth and narrow: what remains is rounding.
            let off = (e.value[0] - PI).abs();
            assert!(off < 1e-11, "{width} × {height}, {n:?}: {off:e}");
            assert!(
                off <= 10.0 * e.error[0] + 1e-12,
                "error estimate {:e} for {off:e}",
                e.error[0]
            );
        }
        assert!((env.mean_radiance()[0] - 1.0).abs() < 1e-13);
    }
    for layout in [Layout::Angular, Layout::MirrorBall] {
        let env = Environment::from_image(picture(layout, 32, |_| 1.0), layout).unwrap();
        for n in NORMALS {
            let e = env.irradiance_with_error(n);
            // Midpoint rule on 64 rings: (π/64)²/6 ≈ 4e-4 of the value.
            assert!((e.value[0] - PI).abs() < 4e-4 * PI, "{layout} {n:?}: {e:?}");
            assert!(
                (e.value[0] - PI).abs() < 2.0 * e.error[0] + 1e-9,
                "{layout} {n:?}: {e:?}"
            );
        }
    }
}

#[test]
fn a_linear_field_gives_its_closed_form() {
    // L = 1 + a·d: E(n) = π + (2π/3) a·n, since ∫ (a·ω)(n·ω) over the hemisphere of n is (2π/3) a·n.
    let a = Vec3::new(0.3, -0.5, 0.6);
    for (layout, size) in [
        (Layout::LatLong, 128),
        (Layout::Angular, 256),
        (Layout::MirrorBall, 256),
    ] {
        let env =
            Environment::from_image(picture(layout, size, |d| 1.0 + a.dot(d)), layout).unwrap();
        for n in NORMALS {
            let unit = n.to_f64().normalize();
            let expected = PI + 2.0 * PI / 3.0 * a.dot(unit);
            let found = env.irradiance(n)[0];
            // Interpolation error of the picture: h²/8 of the second derivative, h = π/128; the ball's far side, where a
            // texel is √(1/n) rad wide, adds (2/n)² of solid angle.
            assert!(
                (found - expected).abs() < 1e-3,
                "{layout} {n:?}: {found} against {expected}"
            );
        }
        assert!((env.mean_radiance()[0] - 1.0).abs() < 1e-3, "{layout}");
    }
}

#[test]
fn a_white_upper_half_lights_by_view_factor() {
    // E(n) = π (1 + n.y) / 2, the view factor of a tilted plane to the sky.
    for (layout, size, bound) in [
        (Layout::LatLong, 256, 2e-4),
        (Layout::Angular, 256, 2e-2),
        (Layout::MirrorBall, 256, 2e-2),
    ] {
        let env = Environment::from_image(
            picture(layout, size, |d| f64::from(u8::from(d.y > 0.0))),
            layout,
        )
        .unwrap();
        for n in NORMALS {
            let expected = 0.5 * PI * (1.0 + n.to_f64().normalize().y);
            let found = env.irradiance(n)[0];
            assert!(
                (found - expected).abs() < bound,
                "{layout} {n:?}: {found} against {expected}"
            );
        }
    }
}

#[test]
fn it_integrates_what_lookup_shows() {
    // Against a brute-force sum of Environment::radiance, with a bright texel on the horizon of the normals.
    let mut image = picture(Layout::LatLong, 12, |d| 1.0 + d.x * d.y);
    image.set(3, 5, [500.0, 40.0, 3.0]);
    let env = Environment::from_image(image, Layout::LatLong)
        .unwrap()
        .rotated_deg(37.0)
        .scaled([1.0, 2.0, 0.5]);
    let (rows, columns) = (600, 1200);
    for n in NORMALS {
        let unit = n.to_f64().normalize();
        let mut sum = [0.0; 3];
        for j in 0..rows {
            for i in 0..columns {
                let uv = [
                    (f64::from(i) + 0.5) / f64::from(columns),
                    (f64::from(j) + 0.5) / f64::from(rows),
                ];
                let d = Layout::LatLong.direction(uv);
                let cos = unit.dot(d).max(0.0);
                if cos > 0.0 {
                    let l = env.radiance(d.to_f32());
                    let weight = cos * Layout::LatLong.jacobian(uv) / f64::from(rows * columns);
                    for k in 0..3 {
                        sum[k] += f64::from(l[k]) * weight;
                    }
                }
            }
        }
        let e = env.irradiance(n);
        for k in 0..3 {
            // Midpoint rule at a fiftieth of a texel: (1/50)² of the peak's share, and single-precision lookups.
            assert!(
                (e[k] - sum[k]).abs() < 5e-4 * sum[k],
                "{n:?}: {e:?} against {sum:?}"
            );
        }
    }
}

#[test]
fn a_normal_without_direction_is_nan() {
    let picture = Environment::from_image(Image::filled(2, 1, [1.0; 3]), Layout::LatLong).unwrap();
    for env in [Environment::uniform([1.0; 3]), picture] {
        assert!(env.irradiance(Vec3::new(0.0, 0.0, 0.0))[0].is_nan());
        assert!(env.irradiance(Vec3::new(f32::NAN, 0.0, 1.0))[0].is_nan());
    }
}
