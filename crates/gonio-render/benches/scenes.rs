//! Path tracing of two whole scenes, in samples a second (divan's "items/s"), at 128 × 128 pixels and 8 samples a pixel, with
//! paths of at most seven reflections:
//!
//! - `ibl`: a golden sphere on a plane, lit by a panorama of 1024 × 512 with a sun of 1° radius;
//! - `cornell`: a box with two boxes in it, lit by a rectangle.
//!
//! `cargo bench -p gonio-render` uses all threads; to compare on a busy machine, one thread on one core:
//! `RAYON_NUM_THREADS=1 taskset -c 0 cargo bench -p gonio-render`.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use gonio_brdf::ModelSpec;
use gonio_env::{Environment, Layout};
use gonio_image::Image;
use gonio_num::{Affine3, Vec3};
use gonio_radiometry::sequence::SamplerKind;
use gonio_render::integrator::Path;
use gonio_render::{Integrator, Kept, PixelFilter, RenderOptions, Screen, Target, render};
use gonio_scene::{Camera, Material, Scene, SceneBuilder, Shape, TriangleMesh};
use std::ops::ControlFlow;
use std::sync::Arc;

fn main() {
    divan::main();
}

const SIDE: u32 = 128;
const SAMPLES: u32 = 8;

fn material(spec: &str) -> Material {
    let parsed = ModelSpec::parse(spec).expect("a model of the registry");
    Material::new(spec, &parsed).expect("a sound model")
}

fn camera(eye: [f32; 3], target: [f32; 3], fov_y_deg: f32) -> Camera {
    let up = Vec3::new(0.0, 1.0, 0.0);
    Camera::look_at(eye.into(), target.into(), up, fov_y_deg).expect("two points")
}

/// A rectangle around `centre` with half edges `x` and `y`, facing x × y.
fn rectangle(centre: [f32; 3], x: [f32; 3], y: [f32; 3]) -> Affine3<f32> {
    let (x, y): (Vec3<f32>, Vec3<f32>) = (x.into(), y.into());
    Affine3::from_columns(x, y, x.cross(y).normalize(), centre.into())
}

/// A sky that is white at the horizon and blue above, brown ground, and a sun with a glow around it.
fn panorama() -> Environment {
    let (width, height) = (1024, 512);
    let sun = Vec3::new(0.55, 0.62, 0.56).normalize();
    let rim = 1f64.to_radians().cos();
    let image = Image::from_fn(width, height, |x, y| {
        let at = [
            (x as f64 + 0.5) / width as f64,
            (y as f64 + 0.5) / height as f64,
        ];
        let d = Layout::LatLong.direction(at);
        let up = d.y.max(0.0).sqrt();
        let toward = d.dot(sun);
        let glow = (-(1.0 - toward) / 0.003).exp();
        let shine = f64::from(u8::from(toward > rim));
        std::array::from_fn(|c| {
            let sky = (1.0 - up) * [0.9, 0.85, 0.8][c] + up * [0.18, 0.35, 0.8][c];
            let base = if d.y > 0.0 {
                sky
            } else {
                [0.20, 0.16, 0.12][c]
            };
            let sunlight = shine * [6000.0, 5400.0, 4500.0][c] + glow * [3.0, 2.7, 2.2][c];
            (base + sunlight) as f32
        })
    });
    Environment::from_image(image, Layout::LatLong).expect("finite radiance")
}

/// A golden sphere on a plane under the sun.
fn ibl() -> (Scene, Camera) {
    let mut scene = SceneBuilder::new("ibl");
    let plane = scene.shape(Shape::Rectangle);
    let grey = scene.material(material("lambertian:reflectance=0.5"));
    let floor = rectangle([0.0; 3], [20.0, 0.0, 0.0], [0.0, 0.0, -20.0]);
    scene.instance(plane, floor, grey);
    let sphere = scene.shape(Shape::Sphere);
    let gold = scene.material(material("torrance-sparrow:metal=gold,alpha=0.2"));
    let above = Affine3::translation(Vec3::new(0.0, 1.0, 0.0));
    scene.instance(sphere, above, gold);
    scene.environment(panorama());
    let scene = scene.build().expect("a sound scene");
    (scene, camera([0.0, 2.2, 6.0], [0.0, 0.9, 0.0], 32.0))
}

/// The cube \[−1, 1]³, faces outwards.
fn cube() -> Shape {
    let mut mesh = TriangleMesh::default();
    for axis in 0..3 {
        for side in [-1.0f32, 1.0] {
            let first = mesh.positions.len() as u32;
            for [a, b] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
                let mut p = [0.0; 3];
                p[axis] = side;
                p[(axis + 1) % 3] = a * side;
                p[(axis + 2) % 3] = b;
                mesh.positions.push(p.into());
            }
            for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
                mesh.indices.push([first + a, first + b, first + c]);
            }
        }
    }
    Shape::Mesh(Arc::new(mesh))
}

/// The Cornell box.
fn cornell() -> (Scene, Camera) {
    let mut scene = SceneBuilder::new("cornell");
    let wall = scene.shape(Shape::Rectangle);
    let white_spec = "lambertian:reflectance=0.885809/0.698859/0.666422";
    let white = scene.material(material(white_spec));
    let green = scene.material(material("lambertian:reflectance=0.105421/0.37798/0.076425"));
    let red = scene.material(material(
        "lambertian:reflectance=0.570068/0.0430135/0.0443706",
    ));
    let mut lamp = material(white_spec);
    lamp.emission.radiance = [18.387, 13.9873, 6.75357];
    let lamp = scene.material(lamp);

    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    scene.instance(wall, rectangle([0.0, -1.0, 0.0], z, x), white);
    scene.instance(wall, rectangle([0.0, 1.0, 0.0], x, z), white);
    scene.instance(wall, rectangle([0.0, 0.0, -1.0], x, y), white);
    scene.instance(wall, rectangle([1.0, 0.0, 0.0], z, y), green);
    scene.instance(wall, rectangle([-1.0, 0.0, 0.0], y, z), red);
    let light = rectangle([0.0, 0.99, 0.01], [0.23, 0.0, 0.0], [0.0, 0.0, 0.19]);
    scene.instance(wall, light, lamp);

    let cube = scene.shape(cube());
    let standing = |c: f32, s: f32, half: f32, centre: [f32; 3]| {
        Affine3::from_columns(
            Vec3::new(c, 0.0, s),
            Vec3::new(0.0, half, 0.0),
            Vec3::new(-s, 0.0, c),
            centre.into(),
        )
    };
    let small = standing(0.286_891, 0.087_711_5, 0.3, [0.335, -0.7, 0.38]);
    let large = standing(0.284_91, -0.093_949_1, 0.61, [-0.33, -0.4, -0.28]);
    scene.instance(cube, small, white);
    scene.instance(cube, large, white);
    let scene = scene.build().expect("a sound scene");
    (scene, camera([0.0, 0.0, 3.9], [0.0; 3], 39.3077))
}

fn options(side: u32, samples: u32) -> RenderOptions {
    RenderOptions {
        width: side,
        height: side,
        target: Target {
            samples,
            time: None,
            noise: None,
            adaptive: false,
        },
        integrator: Integrator::Path(Path {
            max_bounces: 7,
            roulette_after: 4,
            ..Path::default()
        }),
        sampler: SamplerKind::Sobol,
        screen: Screen::INDEPENDENT,
        filter: PixelFilter::Box,
        seed: 0,
        keep: Kept::NOTHING,
    }
}

#[divan::bench(args = ["ibl", "cornell"], sample_count = 9)]
fn path(bencher: Bencher, name: &str) {
    let (scene, camera) = if name == "ibl" { ibl() } else { cornell() };
    let options = options(SIDE, SAMPLES);
    bencher
        .counter(ItemsCount::new(SIDE * SIDE * SAMPLES))
        .bench(|| {
            let seen = |_: &_, _: &_| ControlFlow::Continue(());
            render(black_box(&scene), &camera, &options, seen).expect("sound options")
        });
}
