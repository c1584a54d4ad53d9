//! Means over an environment: against exact quadrature, closed forms, and themselves.

#![allow(clippy::unwrap_used)]

use gonio_env::{Environment, Layout};
use gonio_ibl::harmonics::directions;
use gonio_ibl::{DEFAULT_TOLERANCE, Family, Kernel, Maps, Method, Target, mirror};
use gonio_image::Image;
use gonio_num::Vec3;

/// A sky with a sun 2° wide, 6000 times as bright as the rest, over a chequered floor.
fn scene(scale: [f32; 2]) -> Environment {
    let (w, h) = (256, 128);
    let sun = Vec3::new(0.5f64, 0.6, -0.3).normalize();
    let image = Image::from_fn(w, h, |x, y| {
        let uv = [(x as f64 + 0.5) / w as f64, (y as f64 + 0.5) / h as f64];
        let d: Vec3<f64> = Layout::LatLong.direction(uv);
        if d.dot(sun) > 0.99939 {
            return [6000.0, 5500.0, 5000.0].map(|c| c * scale[0]);
        }
        let checks = ((x / 8 + y / 8) % 2) as f32;
        let rgb = if d.y > 0.0 {
            [0.4, 0.6, 1.0]
        } else {
            [0.3 * checks, 0.2, 0.1]
        };
        rgb.map(|c| c * scale[1])
    });
    Environment::from_image(image, Layout::LatLong).unwrap()
}

fn kernels() -> Vec<Kernel> {
    let model = |text| Family::parse(text).unwrap();
    vec![
        Kernel::ggx(0.3).unwrap(),
        Kernel::ggx(1.0).unwrap(),
        Kernel::charlie(0.5).unwrap(),
        Kernel::cosine(1.0).unwrap(),
        Kernel::cosine(20.0).unwrap(),
        model("beckmann:f0=1").kernel(0.4).unwrap(),
        model("burley").kernel(0.4).unwrap(),
    ]
}

const TREE: Method = Method::Tree(DEFAULT_TOLERANCE);

/// What a tolerance t allows is a relative error of t²/24 of every cell, at t = 0.3 4e-3 (three times t for narrow lobes: 3e-2), of either sign; over the hundreds
/// of cells of a lobe a tenth of that remains.
#[test]
fn the_tree_agrees_with_exact_quadrature() {
    let env = scene([1.0, 1.0]);
    for kernel in kernels() {
        let maps = Maps::new(&env, kernel.width(), TREE);
        let cube = maps.cube(&kernel, 16, Target::Custom, TREE);
        let error = maps.compare(&kernel, &cube, Target::Custom, 48);
        assert!(
            error.mean < 2e-3 && error.largest < 2e-2,
            "{kernel:?}: {error:?}"
        );
        // Smaller cells, smaller error.
        let fine = maps.cube(&kernel, 16, Target::Custom, Method::Tree(0.1));
        let finer = maps.compare(&kernel, &fine, Target::Custom, 48);
        assert!(
            finer.mean < 0.7 * error.mean + 1e-4,
            "{kernel:?}: {finer:?} {error:?}"
        );
        // Negative control: a kernel a tenth wider is told apart.
        if let Kernel::Ggx { alpha } = kernel
            && alpha < 0.9
        {
            let wide = Kernel::Ggx { alpha: 1.1 * alpha };
            let error = maps.compare(&wide, &cube, Target::Custom, 48);
            assert!(error.mean > 1e-2, "{error:?}");
        }
    }
}

#[test]
fn uniform_light_stays_as_it_is() {
    let radiance = [0.7, 2.0, 123.0];
    let picture = Image::filled(64, 32, radiance);
    let envs = [
        Environment::uniform(radiance),
        Environment::from_image(picture, Layout::LatLong).unwrap(),
        Environment::from_image(Image::filled(32, 32, radiance), Layout::Angular).unwrap(),
    ];
    for env in envs {
        for kernel in kernels() {
            for method in [TREE, Method::Sampling(64)] {
                let maps = Maps::new(&env, kernel.width(), method);
                let cube = maps.cube(&kernel, 4, Target::Gltf, method);
                for t in cube
                    .texels
                    .iter()
                    .chain(&mirror(&env, 4, Target::Gltf).texels)
                {
                    for k in 0..3 {
                        // Sums of up to 1e5 terms in single precision, above and below the line alike.
                        assert!((t[k] / radiance[k] - 1.0).abs() < 2e-5, "{kernel:?}: {t:?}");
                    }
                }
            }
        }
    }
}

/// The diffuse map is irradiance/π, which gonio-env integrates exactly.
#[test]
fn the_diffuse_map_is_irradiance() {
    let env = scene([0.05, 1.0]);
    let kernel = Kernel::cosine(1.0).unwrap();
    let method = Method::Tree(0.1);
    let maps = Maps::new(&env, kernel.width(), method);
    let axes: Vec<Vec<Vec3<f32>>> = directions(20).map(|d| vec![d.to_f32()]).collect();
    for (n, e) in axes.iter().zip(maps.means(&kernel, &axes, method)) {
        let exact = env.irradiance(n[0]);
        for k in 0..3 {
            let found = f64::from(e[0][k]) * std::f64::consts::PI;
            // Points at texel centres instead of interpolated texels: (texel/lobe)²/12 = 5e-5; cells: 0.1²/24 = 4e-4.
            assert!(
                (found / exact[k] - 1.0).abs() < 1e-3,
                "{found} {}",
                exact[k]
            );
        }
    }
}

#[test]
fn means_are_linear_in_light() {
    let kernel = Kernel::ggx(0.4).unwrap();
    let cube = |scale| {
        let env = scene(scale);
        Maps::new(&env, kernel.width(), TREE).cube(&kernel, 8, Target::Custom, TREE)
    };
    let (sun, sky, both) = (cube([1.0, 0.0]), cube([0.0, 1.0]), cube([1.0, 1.0]));
    let (mut worst, mut mean) = (0.0f32, 0.0);
    for i in 0..both.texels.len() {
        for k in 0..3 {
            let sum = sun.texels[i][k] + sky.texels[i][k];
            let e = (sum / both.texels[i][k] - 1.0).abs();
            worst = worst.max(e);
            mean += e / (3 * both.texels.len()) as f32;
        }
    }
    // Cells lie where their light is, so the cells differ: by as much as the error of each.
    assert!(mean < 2e-3 && worst < 2e-2, "{mean} {worst}");
    // A factor is exact but for roundings.
    let (one, two) = (cube([1.0, 1.0]), cube([2.0, 2.0]));
    for (a, b) in one.texels.iter().zip(&two.texels) {
        for k in 0..3 {
            assert!((b[k] / a[k] - 2.0).abs() < 1e-5);
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let kernel = Kernel::ggx(0.2).unwrap();
    let make = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let env = scene([1.0, 1.0]);
            let maps = Maps::new(&env, kernel.width(), TREE);
            maps.cube(&kernel, 16, Target::Unity, TREE)
        })
    };
    assert_eq!(make(1), make(3));
}

/// With many samples the filtered ones agree as well, to the blur of a texel.
#[test]
fn samples_agree_with_the_tree() {
    let env = scene([0.001, 1.0]);
    let kernel = Kernel::ggx(0.6).unwrap();
    let method = Method::Sampling(2048);
    let maps = Maps::new(&env, kernel.width(), method);
    let cube = maps.cube(&kernel, 8, Target::Custom, method);
    let error = maps.compare(&kernel, &cube, Target::Custom, 48);
    assert!(error.mean < 2e-2, "{error:?}");
}

/// A picture turned about the vertical gives the map of the turned axes; Unreal's and Unity's axes are those of the world.
#[test]
fn axes_are_those_of_the_target() {
    let env = scene([1.0, 1.0]);
    let kernel = Kernel::ggx(0.5).unwrap();
    let maps = Maps::new(&env, kernel.width(), TREE);
    let world = maps.cube(&kernel, 1, Target::Custom, TREE).texels;
    // Unity's +z is the world's −z; Unreal's +x (forward) is −z, its +y (right) +x, its +z (up) +y.
    for (target, faces) in [
        (Target::Unity, [0, 1, 2, 3, 5, 4]),
        (Target::Unreal, [5, 4, 0, 1, 2, 3]),
    ] {
        let cube = maps.cube(&kernel, 1, target, TREE).texels;
        for (face, same) in faces.into_iter().enumerate() {
            for k in 0..3 {
                let (a, b) = (cube[face][k], world[same][k]);
                assert!((a / b - 1.0).abs() < 1e-4, "{target:?} {face}: {a} {b}");
            }
        }
    }
}

#[test]
fn bad_arguments_are_named() {
    for bad in [0.0, -1.0, 1.5, f64::NAN] {
        assert!(Kernel::ggx(bad).is_err() && Kernel::charlie(bad).is_err());
    }
    for bad in [-1.0, f64::NAN, 1e9] {
        assert!(Kernel::cosine(bad).is_err());
    }
    let message = |text: &str| {
        Family::parse(text)
            .and_then(|f| f.kernel(0.5))
            .unwrap_err()
            .to_string()
    };
    assert!(
        message("mirror").contains("roughness"),
        "{}",
        message("mirror")
    );
    assert!(message("ggx:anisotropy=0.5").contains("anisotropic"));
    assert!(message("nosuch").contains("nosuch"));
}
