//! Round trips, Jacobians, and where each layout puts the six axes.

use super::*;
use proptest::prelude::*;
use std::f64::consts::PI;

const AXES: [(Vec3<f64>, &str); 6] = [
    (Vec3::new(1.0, 0.0, 0.0), "+x"),
    (Vec3::new(-1.0, 0.0, 0.0), "-x"),
    (Vec3::new(0.0, 1.0, 0.0), "+y"),
    (Vec3::new(0.0, -1.0, 0.0), "-y"),
    (Vec3::new(0.0, 0.0, 1.0), "+z"),
    (Vec3::new(0.0, 0.0, -1.0), "-z"),
];

fn near(a: Vec3<f64>, b: Vec3<f64>, tolerance: f64) -> bool {
    (a - b).length() <= tolerance
}

#[test]
fn the_axes_stand_where_the_conventions_put_them() {
    // Derived by hand from the conventions. Half-way between centre and rim of the ball's photograph the surface
    // leans 45°: r = sin 45° there shows what stands at right angles to the camera.
    let h = 0.5 * 0.5_f64.sqrt();
    let expected = [
        (
            Layout::LatLong,
            [
                [0.75, 0.5],
                [0.25, 0.5],
                [0.5, 0.0],
                [0.5, 1.0],
                [1.0, 0.5],
                [0.5, 0.5],
            ],
        ),
        (
            Layout::Angular,
            [
                [0.75, 0.5],
                [0.25, 0.5],
                [0.5, 0.25],
                [0.5, 0.75],
                [1.0, 0.5],
                [0.5, 0.5],
            ],
        ),
        (
            Layout::MirrorBall,
            [
                [0.5 + h, 0.5],
                [0.5 - h, 0.5],
                [0.5, 0.5 - h],
                [0.5, 0.5 + h],
                [0.5, 0.5],
                [1.0, 0.5],
            ],
        ),
        (
            Layout::CubeCross,
            [
                [0.625, 0.5],
                [0.125, 0.5],
                [0.375, 1.0 / 6.0],
                [0.375, 5.0 / 6.0],
                [0.875, 0.5],
                [0.375, 0.5],
            ],
        ),
        (
            Layout::CubeCrossVertical,
            [
                [5.0 / 6.0, 0.375],
                [1.0 / 6.0, 0.375],
                [0.5, 0.125],
                [0.5, 0.625],
                [0.5, 0.875],
                [0.5, 0.375],
            ],
        ),
        (
            Layout::CubeStrip,
            [0.5, 1.5, 2.5, 3.5, 4.5, 5.5].map(|k| [k / 6.0, 0.5]),
        ),
        (
            Layout::CubeStripVertical,
            [0.5, 1.5, 2.5, 3.5, 4.5, 5.5].map(|k| [0.5, k / 6.0]),
        ),
        (
            Layout::Octahedral,
            [
                [1.0, 0.5],
                [0.0, 0.5],
                [0.5, 0.0],
                [0.5, 1.0],
                [1.0, 0.0],
                [0.5, 0.5],
            ],
        ),
        (
            Layout::EqualAreaOctahedral,
            [
                [1.0, 0.5],
                [0.0, 0.5],
                [0.5, 0.0],
                [0.5, 1.0],
                [1.0, 0.0],
                [0.5, 0.5],
            ],
        ),
        (
            Layout::DualParaboloid,
            [
                [0.5, 0.5],
                [0.0, 0.5],
                [0.25, 0.0],
                [0.25, 1.0],
                [0.75, 0.5],
                [0.25, 0.5],
            ],
        ),
    ];
    for (layout, places) in expected {
        for ((d, name), place) in AXES.iter().zip(places) {
            let uv = layout.uv(*d);
            assert!(
                (uv[0] - place[0]).abs() < 1e-15 && (uv[1] - place[1]).abs() < 1e-15,
                "{layout} shows {name} at {uv:?}, expected {place:?}"
            );
            assert!(near(layout.direction(place), *d, 1e-14), "{layout} {name}");
        }
    }
}

#[test]
fn a_rendered_mirrored_ball_gives_the_photograph_back() {
    // The law of reflection on the ball, computed from its geometry alone.
    for (x, y) in [
        (0.0, 0.0),
        (0.3, -0.2),
        (-0.7, 0.7),
        (0.0, 0.99),
        (-0.999, 0.0),
    ] {
        let n = Vec3::new(x, y, f64::sqrt(1.0 - x * x - y * y));
        let reflected = Vec3::new(0.0, 0.0, 1.0).reflect(n);
        assert!(near(
            Layout::MirrorBall.direction(uv_from_disc([x, y])),
            reflected,
            1e-15
        ));
    }
}

#[test]
fn the_jacobian_integrates_to_the_sphere() {
    for layout in Layout::ALL {
        // Midpoint rule on n² cells, of which a cube's faces have whole numbers. Smooth or falling to 0 at the ends, its error
        // is O(n⁻²); a disc with an edge is a count of cells, whose error is O(n^-1.3) for a circle.
        let n = 1500;
        let mut sum = 0.0;
        for j in 0..n {
            for i in 0..n {
                let uv = [
                    (f64::from(i) + 0.5) / f64::from(n),
                    (f64::from(j) + 0.5) / f64::from(n),
                ];
                sum += layout.jacobian(uv);
            }
        }
        let relative = sum / f64::from(n * n) / (4.0 * PI) - 1.0;
        let bound = if matches!(layout, Layout::MirrorBall | Layout::DualParaboloid) {
            2e-4
        } else {
            1e-5
        };
        assert!(relative.abs() < bound, "{layout}: {relative:e}");
        // Negative control: a Jacobian without its factor 2 is far outside.
        assert!((0.5 * (relative + 1.0) - 1.0).abs() > bound);
    }
}

#[test]
fn outside_the_disc_is_nothing() {
    for layout in [Layout::Angular, Layout::MirrorBall, Layout::DualParaboloid] {
        for uv in [[0.0, 0.0], [1.0, 0.0], [0.99, 0.99], [0.01, 0.1]] {
            assert!(!layout.contains::<f64>(uv));
            assert_eq!(layout.jacobian::<f64>(uv), 0.0);
        }
        assert!(layout.contains::<f64>(if layout.is_disc() {
            [0.5, 0.001]
        } else {
            [0.25, 0.001]
        }));
    }
    for uv in [[0.1, 0.1], [0.6, 0.1], [0.9, 0.9]] {
        assert!(!Layout::CubeCross.contains::<f64>(uv));
        assert_eq!(Layout::CubeCross.jacobian::<f64>(uv), 0.0);
    }
    assert!(Layout::LatLong.contains::<f64>([0.0, 0.0]));
    assert!(!Layout::LatLong.contains::<f64>([1.01, 0.0]));
}

#[test]
fn the_lat_long_seam_and_poles_are_whole() {
    // Both sides of the seam show +z.
    for u in [0.0, 1.0] {
        assert!(near(
            Layout::LatLong.direction([u, 0.5]),
            Vec3::new(0.0, 0.0, 1.0),
            1e-15
        ));
    }
    // Signed zeros at the poles keep to u = 1/2.
    for z in [0.0_f32, -0.0] {
        for x in [0.0_f32, -0.0] {
            assert_eq!(Layout::LatLong.uv(Vec3::new(x, 1.0, z)), [0.5, 0.0]);
            assert_eq!(Layout::LatLong.uv(Vec3::new(x, -1.0, z))[0], 0.5);
        }
    }
}

#[test]
fn names_are_read_back() {
    for layout in Layout::ALL {
        assert_eq!(layout.to_string().parse::<Layout>().unwrap(), layout);
    }
    let error = "latlon".parse::<Layout>().unwrap_err();
    assert!(error.to_string().contains("latlon"), "{error}");
    assert!(error.help().unwrap().contains("lat-long"));
}

fn any_direction() -> impl Strategy<Value = Vec3<f64>> {
    (-1.0_f64..1.0, 0.0..std::f64::consts::TAU).prop_map(|(y, phi)| {
        let r = (1.0 - y * y).sqrt();
        Vec3::new(r * Real::cos(phi), y, r * Real::sin(phi))
    })
}

proptest! {
    #[test]
    fn directions_survive_the_picture(d in any_direction()) {
        for layout in Layout::ALL {
            let uv = layout.uv(d);
            prop_assert!((0.0..=1.0).contains(&uv[0]) && (0.0..=1.0).contains(&uv[1]), "{} {:?}", layout, uv);
            // Worst is the ball's far side, where dr/dθ vanishes: error √ε of the double's 1e-16.
            prop_assert!(near(layout.direction(uv), d, 1e-7), "{}", layout);
            let back = layout.direction(layout.uv(d.to_f32()));
            // The same in single precision: √6e-8.
            prop_assert!(near(back.to_f64(), d, 1e-3), "{} in f32", layout);
        }
    }

    #[test]
    fn the_jacobian_is_the_derivative(u in 0.02_f64..0.98, v in 0.02_f64..0.98) {
        for layout in Layout::ALL {
            let [x, y] = disc_from_uv([u, v]);
            if layout.is_disc() && x * x + y * y > 0.98 {
                continue;
            }
            // Differences don't reach over edges of cells, folds and rims.
            let near = |c: f64| (c - c.round()).abs() < 1e-3;
            let [columns, rows] = layout.shape();
            let at_edge = layout.arrangement().is_some() && (near(u * columns as f64) || near(v * rows as f64));
            let folds = [x, y, 1.0 - x.abs() - y.abs()];
            let at_fold = matches!(layout, Layout::Octahedral | Layout::EqualAreaOctahedral)
                && folds.iter().any(|c| c.abs() < 1e-3);
            let rim = layout == Layout::DualParaboloid && layout.jacobian([u, v]) < 8.1;
            if at_edge || at_fold || rim {
                continue;
            }
            if !layout.contains([u, v]) {
                prop_assert_eq!(layout.jacobian([u, v]), 0.0);
                continue;
            }
            // Area of the parallelogram of central differences; their error is O(h²) ≈ 1e-8 times third derivatives.
            let h = 1e-5;
            let du = (layout.direction([u + h, v]) - layout.direction([u - h, v])) * (0.5 / h);
            let dv = (layout.direction([u, v + h]) - layout.direction([u, v - h])) * (0.5 / h);
            let area = du.cross(dv).length();
            let j = layout.jacobian([u, v]);
            prop_assert!((area - j).abs() <= 1e-5 * (1.0 + j), "{}: {} against {}", layout, j, area);
        }
    }
}
