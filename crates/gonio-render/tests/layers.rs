//! Layers: what they add up to, and what they show.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use gonio_env::Environment;
use gonio_image::{Image, Layers};
use gonio_num::{Affine3, Vec3};
use gonio_radiometry::sequence::SamplerKind;
use gonio_render::integrator::{Direct, EnvironmentSampling, Path};
use gonio_render::{Film, Integrator, Kept, Names, RenderOptions};
use gonio_scene::{Camera, Light, Scene, SceneBuilder, Shape};
use gonio_verify::statistics::{Moments, welch_t_test};
use support::*;

/// A ball on a floor under a lamp, a point light and a sky; some of it in glass that absorbs, where paths go one at a time.
///
/// - `only`: the lights that shine, of the three
fn scene(only: [bool; 3], absorbs: bool) -> Scene {
    let mut scene = SceneBuilder::new("layers");
    let grey = material("lambertian:reflectance=0.5");
    add(&mut scene, Shape::Rectangle, floor(-1.0, 10.0), grey);
    let gold = material("ggx:metal=gold,roughness=0.4");
    add(&mut scene, Shape::Sphere, Affine3::identity(), gold);
    if absorbs {
        let glass = material("glass:absorption=0.3/0.1/0.2");
        let beside = Affine3::translation(Vec3::new(1.5, -0.3, 0.5));
        add(&mut scene, Shape::Sphere, beside, glass);
    }
    let light = |lit: bool, radiance: [f32; 3]| if lit { radiance } else { [0.0; 3] };
    if only[0] {
        let mut lamp = emitter("lambertian:reflectance=0.2", [9.0, 7.0, 3.0]);
        lamp.emission.group = Some("lamp".into());
        let above = ceiling(3.0, 0.6).then(&Affine3::translation(Vec3::new(-1.5, 0.0, 0.0)));
        add(&mut scene, Shape::Rectangle, above, lamp);
    }
    let point = Light::Point {
        position: Vec3::new(2.0, 4.0, 1.0),
        intensity: light(only[1], [20.0, 10.0, 5.0]),
    };
    scene.light_in(point, "key");
    let sky = Environment::uniform(light(only[2], [0.3, 0.4, 0.5]));
    scene.light(Light::Environment(sky));
    scene.build().unwrap()
}

const ALL: [bool; 3] = [true; 3];

fn camera() -> Camera {
    let eye = Vec3::new(1.0, 3.0, 7.0);
    let up = Vec3::new(0.0, 1.0, 0.0);
    Camera::look_at(eye, Vec3::zero(), up, 40.0).unwrap()
}

fn everything(scene: &Scene) -> Kept {
    Kept {
        position: true,
        material: true,
        direct: true,
        indirect: true,
        groups: scene.lights.groups().len() as u32,
        reweighted: true,
    }
}

fn paths(max_bounces: u32) -> Integrator {
    Integrator::Path(Path {
        max_bounces,
        ..Path::default()
    })
}

fn keeping(scene: &Scene, options: RenderOptions) -> RenderOptions {
    RenderOptions {
        keep: everything(scene),
        ..options
    }
}

fn layers(scene: &Scene, film: &Film) -> Layers {
    film.layers(&Names::of(scene), Vec::new())
}

/// Pixel by pixel, channel by channel, the largest |a − b| / b, of those where b is not 0; ∞ where b is 0 and a is not.
fn distance(a: &Image, b: &Image) -> f32 {
    let pairs = a.pixels.as_flattened().iter().zip(b.pixels.as_flattened());
    pairs.fold(0.0, |worst, (a, b)| match (a - b).abs() {
        0.0 => worst,
        difference => worst.max(difference / b.abs()),
    })
}

fn sum(images: &[Image]) -> Image {
    let mut whole = Image::new(images[0].width, images[0].height);
    for image in images {
        for (w, p) in whole.pixels.iter_mut().zip(&image.pixels) {
            *w = [0, 1, 2].map(|c| w[c] + p[c]);
        }
    }
    whole
}

/// A sample is a sum of at most 2 × 64 + 1 pieces of light, all positive, and so are its shares: each addition rounds by 2⁻²⁴ of the sum at
/// most. The two sums differ by twice that, and the pictures, a few roundings later, hardly more.
const ROUNDING: f32 = 2.0 * (2.0 * 64.0 + 1.0 + 6.0) / (1 << 24) as f32;

/// The numbers of all other layers leave the picture as it is, to the bit; and shares add up to it.
#[test]
fn shares_add_up_to_the_picture() {
    let product = EnvironmentSampling::Product(gonio_env::Candidates::default());
    let integrators = [
        INTEGRATORS[0],
        INTEGRATORS[1],
        Integrator::Direct(Direct {
            environment: product,
            ..Direct::default()
        }),
        Integrator::Path(Path {
            environment: product,
            ..Path::default()
        }),
    ];
    for (absorbs, integrator) in [false, true]
        .into_iter()
        .flat_map(|absorbs| integrators.map(|i| (absorbs, i)))
    {
        let scene = scene(ALL, absorbs);
        assert_eq!(scene.lights.groups(), ["key", "lamp", "default"]);
        let plain = options(integrator, SamplerKind::Sobol, 24, 6);
        let film = picture(&scene, &camera(), &keeping(&scene, plain));
        let whole = picture(&scene, &camera(), &plain);
        assert_eq!(film.pixels(), whole.pixels(), "{integrator:?}");
        let layers = layers(&scene, &film);
        let of = |name: &str| layers.rgb(name).unwrap();
        let by_way = sum(&[of("direct"), of("indirect")]);
        let groups = ["group.lamp", "group.key", "group.default"].map(of);
        let by_group = sum(&groups);
        for (what, shares) in [("ways", by_way), ("groups", by_group)] {
            let found = distance(&shares, &of(""));
            assert!(found <= ROUNDING, "{integrator:?}, {what}: {found}");
        }
        // The control: two groups of three are not all of it.
        assert!(distance(&sum(&groups[..2]), &of("")) > 0.1);
    }
}

/// Direct light is the picture of one reflection, of the same random numbers; indirect light is what more reflections add.
#[test]
fn direct_light_is_that_of_one_reflection() {
    for absorbs in [false, true] {
        let scene = scene(ALL, absorbs);
        let shot = |bounces| {
            let plain = options(paths(bounces), SamplerKind::Sobol, 24, 6);
            picture(&scene, &camera(), &keeping(&scene, plain))
        };
        let direct = layers(&scene, &shot(64)).rgb("direct").unwrap();
        let one = distance(&direct, &shot(1).image());
        assert!(one <= ROUNDING, "{one}");
        assert!(distance(&direct, &shot(2).image()) > 0.1);
        let nothing = layers(&scene, &shot(1)).rgb("indirect").unwrap();
        assert!(nothing.pixels.iter().all(|p| *p == [0.0; 3]));
    }
}

/// T9a: the share of a group is the picture in its light alone, but for chance. The camera sees one small place, so that all pixels
/// estimate nearly the same number.
#[test]
fn the_share_of_a_group_is_the_picture_in_its_light() {
    let camera = Camera::look_at(
        Vec3::new(0.0, 3.0, 5.0),
        Vec3::new(0.4, -1.0, 1.5),
        Vec3::new(0.0, 1.0, 0.0),
        0.3,
    )
    .unwrap();
    let whole = scene(ALL, false);
    for integrator in INTEGRATORS {
        let plain = options(integrator, SamplerKind::Independent, 24, 32);
        let film = picture(&whole, &camera, &keeping(&whole, plain));
        let shares = layers(&whole, &film);
        let moments = |image: &Image, channel: usize| {
            let mut all = Moments::new();
            image
                .pixels
                .iter()
                .for_each(|p| all.push(f64::from(p[channel])));
            all
        };
        for (i, name) in ["group.lamp", "group.key", "group.default"]
            .iter()
            .enumerate()
        {
            let mut only = [false; 3];
            only[i] = true;
            let alone = RenderOptions { seed: 8, ..plain };
            let alone = picture(&scene(only, false), &camera, &alone).image();
            let share = shares.rgb(name).unwrap();
            for c in 0..3 {
                let p = welch_t_test(&moments(&share, c), &moments(&alone, c)).p_value;
                assert!(p > FALSE_POSITIVE, "{} {name}: {p}", integrator.name());
                // The control: a quarter more light.
                let brighter = Image {
                    pixels: alone.pixels.iter().map(|p| p.map(|l| 1.25 * l)).collect(),
                    ..alone.clone()
                };
                let p = welch_t_test(&moments(&share, c), &moments(&brighter, c)).p_value;
                assert!(p < FALSE_POSITIVE, "{} {name}: {p}", integrator.name());
            }
        }
    }
}

/// One sample a pixel: its distance from the camera is the depth, and what it lies on its material.
#[test]
fn positions_and_materials_are_those_of_the_first_surface() {
    for absorbs in [false, true] {
        let scene = scene(ALL, absorbs);
        let plain = options(paths(1), SamplerKind::Sobol, 32, 1);
        let film = picture(&scene, &camera(), &keeping(&scene, plain));
        let layers = layers(&scene, &film);
        let channel = |name: &str| &layers.channel(name).unwrap().samples;
        let mut met = [0; 5];
        for i in 0..32 * 32 {
            let [x, y, z] = ["X", "Y", "Z"].map(|c| channel(&format!("position.{c}")).get(i));
            let (p, depth) = (Vec3::new(x, y, z), channel("depth.Z").get(i));
            let material = channel("material.index").get(i) as usize;
            met[material] += 1;
            if material == 0 {
                assert_eq!((p, depth), (Vec3::zero(), f32::INFINITY));
                continue;
            }
            // Both are of single precision, at distances below 40.
            let eye = Vec3::new(1.0, 3.0, 7.0);
            assert!(
                ((p - eye).length() - depth).abs() < 1e-5 * depth,
                "{p:?} {depth}"
            );
            let on = [
                (p.y + 1.0).abs(),
                (p.length() - 1.0).abs(),
                ((p - Vec3::new(1.5, -0.3, 0.5)).length() - 1.0).abs(),
            ];
            if material < 3 || (absorbs && material == 3) {
                assert!(on[material - 1] < 1e-5, "{p:?} on {material}");
            }
        }
        // Nothing, floor, ball; glass; the lamp.
        assert!(
            met[..3].iter().all(|n| *n > 10) && (met[3] > 10) == absorbs,
            "{met:?}"
        );
    }
}

#[test]
fn groups_that_the_scene_does_not_have_are_an_error() {
    let scene = scene(ALL, false);
    let mut options = keeping(&scene, options(paths(1), SamplerKind::Sobol, 4, 1));
    options.keep.groups = 2;
    let go_on = |_: &_, _: &_| std::ops::ControlFlow::Continue(());
    let error = gonio_render::render(&scene, &camera(), &options, go_on).unwrap_err();
    assert!(
        error.to_string().contains("2 groups of lights, of 3"),
        "{error}"
    );
}
