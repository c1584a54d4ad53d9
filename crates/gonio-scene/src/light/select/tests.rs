use super::*;
use crate::light::choice::probabilities;
use crate::light::{LightSample, Receiver};
use crate::{Instance, Ray, Scene, SceneBuilder, Shape, TriangleMesh};
use gonio_brdf::ModelSpec;
use gonio_num::{Affine3, Real};
use gonio_radiometry::sequence::Rng;
use std::f64::consts::PI;

const UP: Vec3<f32> = Vec3::new(0.0, 1.0, 0.0);

fn glowing(radiance: f32, double_sided: bool) -> Material {
    let mut material = Material::new(
        "lamp",
        &ModelSpec::parse("lambertian:reflectance=0").unwrap(),
    )
    .unwrap();
    material.emission.radiance = [radiance; 3];
    material.double_sided = double_sided;
    material
}

/// A scene of one glowing shape, and a point at the origin that faces up.
fn lamp(shape: Shape, to_world: Affine3<f32>, radiance: f32, double_sided: bool) -> Scene {
    let mut builder = SceneBuilder::new("lamp");
    let material = builder.material(glowing(radiance, double_sided));
    let shape = builder.shape(shape);
    builder.instance(shape, to_world, material);
    builder.build().unwrap()
}

fn here(p: Vec3<f32>) -> SurfacePoint {
    SurfacePoint {
        p,
        error: 1e-6,
        ng: UP,
        ns: UP,
        tangent: Vec3::new(1.0, 0.0, 0.0),
        bitangent_sign: 1.0,
        uv: [0.0; 2],
        uv1: [0.0; 2],
        colour: [1.0; 4],
        t: 1.0,
        instance: u32::MAX,
        primitive: 0,
    }
}

const CHOICES: [LightChoice; 3] = [LightChoice::Tree, LightChoice::Power, LightChoice::Uniform];

fn sample(scene: &Scene, at: &Receiver, select: f32, u: [f32; 2]) -> Option<LightSample> {
    scene.lights.by(LightChoice::Tree).sample(at, select, u)
}

fn at(p: Vec3<f32>) -> Receiver {
    Receiver::all_around(&here(p))
}

/// Mean and standard error of Li cosθ / pdf at `p` facing up, by `LightSampler::sample`.
fn irradiance(
    scene: &Scene,
    choice: LightChoice,
    p: Vec3<f32>,
    name: &str,
    count: u32,
) -> (f64, f64) {
    let lights = scene.lights.by(choice);
    let mut rng = Rng::from_name(name);
    let (mut sum, mut squares) = (0.0, 0.0);
    let from = here(p);
    for _ in 0..count {
        let (select, u) = (rng.next_f32(), [rng.next_f32(), rng.next_f32()]);
        let value = lights.sample(&at(p), select, u).map_or(0.0, |s| {
            let open = match s.target {
                LightTarget::Point(target) => !scene.occluded(&from.spawn_ray_to(target)),
                LightTarget::Infinite => !scene.occluded(&from.spawn_ray(s.wi)),
            };
            if open {
                f64::from(s.radiance[0]) * f64::from(s.wi.y.max(0.0)) / f64::from(s.pdf)
            } else {
                0.0
            }
        });
        sum += value;
        squares += value * value;
    }
    let n = f64::from(count);
    let mean = sum / n;
    (
        mean,
        ((squares / n - mean * mean).max(0.0) / (n - 1.0)).sqrt(),
    )
}

/// The t-test at 4.5 standard errors (two-sided false-positive rate 7e-6), with room for rounding where the estimator has next
/// to no variance; and its negative control: 5 % more must fail. For every choice of lights.
fn expect(scene: &Scene, p: Vec3<f32>, exact: f64, name: &str) {
    expect_of(scene, p, exact, name, 40_000);
}

fn expect_of(scene: &Scene, p: Vec3<f32>, exact: f64, name: &str, count: u32) {
    for choice in CHOICES {
        let (mean, error) = irradiance(scene, choice, p, name, count);
        let bound = 4.5 * error + 2e-5 * exact;
        assert!(
            (mean - exact).abs() < bound,
            "{name}, {choice:?}: {mean} ± {error}, exact {exact}"
        );
        assert!(
            (mean - 1.05 * exact).abs() > bound,
            "{name}, {choice:?}: the test can't tell 5 %: {mean} ± {error}"
        );
    }
}

/// Form factor of a parallel rectangle, one corner straight above the point: sides a and b, height h.
/// Source: Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-3.
fn corner_factor(a: f64, b: f64, h: f64) -> f64 {
    let (a, b) = (a / h, b / h);
    let (ra, rb) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    (a / ra * Real::atan2(b, ra) + b / rb * Real::atan2(a, rb)) / (2.0 * std::f64::consts::PI)
}

/// The unit square [-1, 1]² turned to face down, scaled to half sides (a, b), at height h.
fn ceiling(a: f32, b: f32, h: f32) -> Affine3<f32> {
    Affine3::from_columns(
        Vec3::new(a, 0.0, 0.0),
        Vec3::new(0.0, 0.0, b),
        Vec3::new(0.0, -1.0, 0.0),
        Vec3::new(0.0, h, 0.0),
    )
}

#[test]
fn rectangle_light_has_the_form_factors_irradiance() {
    let scene = lamp(Shape::Rectangle, ceiling(1.5, 0.8, 1.2), 3.0, false);
    let exact = PI * 3.0 * 4.0 * corner_factor(1.5, 0.8, 1.2);
    expect(&scene, Vec3::zero(), exact, "rectangle light");
}

#[test]
fn mesh_light_has_the_form_factors_irradiance() {
    let mesh = TriangleMesh {
        positions: [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|[x, y]| Vec3::new(x, y, 0.0))
            .to_vec(),
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..TriangleMesh::default()
    };
    let scene = lamp(
        Shape::Mesh(Arc::new(mesh)),
        ceiling(1.5, 0.8, 1.2),
        3.0,
        false,
    );
    let exact = PI * 3.0 * 4.0 * corner_factor(1.5, 0.8, 1.2);
    expect(&scene, Vec3::zero(), exact, "mesh light");
}

/// A coaxial disk: E = π L r² / (r² + h²).
#[test]
fn disk_light_has_the_form_factors_irradiance() {
    let scene = lamp(Shape::Disk, ceiling(0.7, 0.7, 1.0), 2.0, false);
    expect(&scene, Vec3::zero(), PI * 2.0 * 0.49 / 1.49, "disk light");
}

/// A sphere straight above: E = π L sin²θmax = π L (r/d)². A far and small one as well: the cone's height keeps its digits.
#[test]
fn sphere_light_has_the_closed_form_irradiance() {
    for (r, d) in [(0.5_f32, 1.0_f32), (0.01, 50.0), (0.9, 1.0)] {
        let m = Affine3::scale(Vec3::splat(r)).then(&Affine3::translation(Vec3::new(0.0, d, 0.0)));
        let scene = lamp(Shape::Sphere, m, 4.0, false);
        let s = f64::from(r) / f64::from(d);
        expect(
            &scene,
            Vec3::zero(),
            PI * 4.0 * s * s,
            &format!("sphere light {r} {d}"),
        );
    }
}

/// Inside a shining sphere every direction has radiance L: E = π L, wherever.
#[test]
fn inside_a_shining_sphere_irradiance_is_pi() {
    let scene = lamp(Shape::Sphere, Affine3::scale(Vec3::splat(2.0)), 1.0, true);
    // By area, a sample's value deviates by 1.7 times the mean: 5 % needs many.
    expect_of(
        &scene,
        Vec3::new(0.4, 0.3, -0.5),
        PI,
        "inside a sphere",
        250_000,
    );
    let one_sided = lamp(Shape::Sphere, Affine3::scale(Vec3::splat(2.0)), 1.0, false);
    for choice in CHOICES {
        let (mean, _) = irradiance(&one_sided, choice, Vec3::zero(), "outside shines", 100);
        assert_eq!(mean, 0.0);
    }
}

/// An ellipsoid whose axis of revolution is vertical and through the point. Scaling all heights and the receiver's distance
/// turns it into a sphere, but not its solid angle; so against the cone it subtends: E = π L sin²θ of the tangent cone.
#[test]
fn ellipsoid_light_has_its_cones_irradiance() {
    // x²/a² + (y − d)²/c² = 1 from the origin: tangent slope x/y = t with t² = a² / (d² − c²).
    let (a, c, d) = (0.6_f32, 0.2_f32, 1.5_f32);
    let m = Affine3::scale(Vec3::new(a, c, a)).then(&Affine3::translation(Vec3::new(0.0, d, 0.0)));
    let scene = lamp(Shape::Sphere, m, 2.0, false);
    let t2 = f64::from(a * a) / (f64::from(d).powi(2) - f64::from(c).powi(2));
    expect(
        &scene,
        Vec3::zero(),
        PI * 2.0 * t2 / (1.0 + t2),
        "ellipsoid light",
    );
}

#[test]
fn a_one_sided_light_is_dark_from_behind() {
    let scene = lamp(Shape::Rectangle, ceiling(1.0, 1.0, 1.0), 1.0, false);
    for choice in CHOICES {
        let (mean, _) = irradiance(&scene, choice, Vec3::new(0.0, 2.0, 0.0), "behind", 200);
        assert_eq!(mean, 0.0);
    }
    let both = lamp(Shape::Rectangle, ceiling(1.0, 1.0, 1.0), 1.0, true);
    let mut rng = Rng::from_name("behind, both sides");
    let u = [rng.next_f32(), rng.next_f32()];
    let s = sample(&both, &at(Vec3::new(0.0, 2.0, 0.0)), 0.5, u).unwrap();
    assert!(s.wi.y < 0.0 && s.radiance == [1.0; 3]);
}

/// Points on the back of a rectangle that shines to the front, wherever their coordinates are rounded to: no light. The
/// control: a point clear of the plane on the front's side sees it.
#[test]
fn a_rectangle_does_not_light_its_own_back() {
    let mut rng = Rng::from_name("a_rectangle_does_not_light_its_own_back");
    for turn in 0..50 {
        let place = Vec3::new(rng.next_f32(), 0.99 + rng.next_f32(), rng.next_f32());
        let to_world = Affine3::rotation(
            Vec3::new(1.0, 0.0, 0.0),
            if turn == 0 {
                0.5 * PI as f32
            } else {
                6.0 * rng.next_f32()
            },
        )
        .then(&Affine3::translation(place));
        let scene = lamp(Shape::Rectangle, to_world, 1.0, false);
        let normal = to_world.z;
        for _ in 0..200 {
            let along = to_world.x * (1.8 * rng.next_f32() - 0.9)
                + to_world.y * (1.8 * rng.next_f32() - 0.9);
            let back = Ray::new(place + along - normal, normal);
            let point = scene.intersect(&back).unwrap();
            let front = SurfacePoint {
                p: place + along + normal * 0.01,
                ..point
            };
            for _ in 0..10 {
                let u = [rng.next_f32(), rng.next_f32()];
                let select = rng.next_f32();
                let back = Receiver::all_around(&point);
                assert!(sample(&scene, &back, select, u).is_none(), "{point:?}");
                let front = Receiver::all_around(&front);
                assert!(sample(&scene, &front, select, u).is_some());
            }
        }
    }
}

/// Lights of every kind around one point; nothing stands in front of anything.
fn many() -> (Scene, f64) {
    let mut builder = SceneBuilder::new("many");
    let lamp = builder.material(glowing(3.0, false));
    let rectangle = builder.shape(Shape::Rectangle);
    builder.instance(rectangle, ceiling(0.4, 0.2, 1.0), lamp);
    let sphere = builder.shape(Shape::Sphere);
    let at = Vec3::new(2.0, 2.0, 0.0);
    builder.instance(
        sphere,
        Affine3::scale(Vec3::splat(0.3)).then(&Affine3::translation(at)),
        lamp,
    );
    builder.light(Light::Point {
        position: Vec3::new(0.0, 3.0, -3.0),
        intensity: [9.0; 3],
    });
    builder.light(Light::Directional {
        direction: Vec3::new(0.6, -0.8, 0.0),
        irradiance: [0.5; 3],
    });
    builder.environment(Environment::uniform([0.2; 3]));
    let rectangle = 4.0 * corner_factor(0.4, 0.2, 1.0);
    // A sphere wholly above the horizon, at angle θ: E = π L (r/d)² cosθ, here d² = 8, cosθ = 1/√2.
    let ball = 0.09 / 8.0 * std::f64::consts::FRAC_1_SQRT_2;
    // A point at (0, 3, −3): E = I cosθ/r² with r² = 18, cosθ = 1/√2.
    let point = 9.0 / 18.0 * std::f64::consts::FRAC_1_SQRT_2;
    // The lamps hide their share of the sky.
    let exact =
        PI * 3.0 * (rectangle + ball) + point + 0.5 * 0.8 + PI * 0.2 * (1.0 - rectangle - ball);
    (builder.build().unwrap(), exact)
}

#[test]
fn choosing_among_lights_sums_over_them() {
    let (scene, exact) = many();
    // Power leaves 2 % to the rectangle, which sends most of the light: a sample deviates by some 7 times the mean.
    expect_of(&scene, Vec3::zero(), exact, "many lights", 1_000_000);
    for choice in CHOICES {
        let lights = scene.lights.by(choice);
        let total: f64 = (0..scene.lights.len() as u32)
            .map(|i| f64::from(lights.probability(&at(Vec3::zero()), i)))
            .sum();
        assert!((total - 1.0).abs() < 1e-6, "{choice:?}: {total}");
    }
    let delta = scene.lights.each().filter(LightRef::is_delta).count();
    assert_eq!((scene.lights.len(), delta), (5, 2));
}

/// T13's sum: each light by itself, delta lights with one sample.
#[test]
fn each_light_alone_adds_up_too() {
    let (scene, exact) = many();
    let from = here(Vec3::zero());
    let mut rng = Rng::from_name("each light");
    let (mut sum, mut variance) = (0.0, 0.0);
    for light in scene.lights.each() {
        let count = if light.is_delta() { 1 } else { 20_000 };
        let (mut mean, mut squares) = (0.0, 0.0);
        for _ in 0..count {
            let s = light.sample(&from, rng.next_f32(), [rng.next_f32(), rng.next_f32()]);
            let value = s.map_or(0.0, |s| {
                let ray = match s.target {
                    LightTarget::Point(target) => from.spawn_ray_to(target),
                    LightTarget::Infinite => from.spawn_ray(s.wi),
                };
                let seen = if scene.occluded(&ray) {
                    0.0
                } else {
                    f64::from(s.radiance[0])
                };
                seen * f64::from(s.wi.y.max(0.0)) / f64::from(s.pdf)
            });
            mean += value / f64::from(count);
            squares += value * value / f64::from(count);
        }
        sum += mean;
        variance += (squares - mean * mean).max(0.0) / f64::from(count);
    }
    let bound = 4.5 * variance.sqrt() + 2e-5 * exact;
    assert!(
        (sum - exact).abs() < bound,
        "{sum} ± {}, exact {exact}",
        variance.sqrt()
    );
    assert!((sum - 1.05 * exact).abs() > bound);
}

/// What a ray along the sampled direction finds has the density that the sample claims: multiple importance sampling
/// rests on it. The hit's position differs from the sample's by rounding (a few 1e-7 of the distance). Where light leaves at a
/// cosine c, the cosine in the density changes by that over c², so by less than 1e-4 of itself for c ≥ 0.1: 1e-3 has room.
#[test]
fn sampled_and_found_densities_agree() {
    let (scene, _) = many();
    let forms = [
        lamp(Shape::Disk, ceiling(0.7, 0.5, 1.0), 2.0, true),
        lamp(
            Shape::Sphere,
            Affine3::scale(Vec3::new(0.4, 0.2, 0.3)).then(&Affine3::translation(UP)),
            2.0,
            false,
        ),
        lamp(Shape::Sphere, Affine3::scale(Vec3::splat(2.0)), 1.0, true),
        scene,
    ];
    let mut compared = 0;
    let each = |choice| forms.iter().enumerate().map(move |(k, s)| (choice, k, s));
    for (choice, k, scene) in CHOICES.into_iter().flat_map(each) {
        let lights = scene.lights.by(choice);
        let mut rng = Rng::from_name("sampled and found densities agree");
        let from = here(Vec3::zero());
        for _ in 0..2_000 {
            let (select, u) = (rng.next_f32(), [rng.next_f32(), rng.next_f32()]);
            let Some(s) = lights.sample(&at(from.p), select, u) else {
                continue;
            };
            if s.delta {
                continue;
            }
            let found = match (scene.intersect(&Ray::new(from.p, s.wi)), s.target) {
                (Some(hit), LightTarget::Point(p))
                    if (hit.p - p).length() < 1e-3 && hit.ng.dot(s.wi).abs() > 0.1 =>
                {
                    assert_eq!(scene.emitted(&hit, -s.wi), s.radiance);
                    lights.pdf_area(&at(from.p), &hit, s.wi)
                }
                (None, LightTarget::Infinite) => lights.pdf_environment(from.p, s.wi),
                // Past the rim of the light by rounding, or on its far side.
                _ => continue,
            };
            assert!(
                (found / s.pdf - 1.0).abs() < 1e-3,
                "form {k}, {choice:?}: {found} for {}",
                s.pdf
            );
            compared += 1;
        }
    }
    assert!(compared > 15_000, "{compared}");
}

#[test]
fn lights_without_power_are_never_chosen() {
    assert_eq!(
        probabilities(&[0.0, 3.0, f64::NAN, 1.0]),
        [0.0, 0.625, 0.0, 0.375]
    );
    assert_eq!(probabilities(&[]), [0.0; 0]);
    let mut builder = SceneBuilder::new("black");
    builder.light(Light::Point {
        position: UP,
        intensity: [0.0; 3],
    });
    builder.environment(Environment::uniform([0.0; 3]));
    let scene = builder.build().unwrap();
    assert!(scene.lights.is_empty() && scene.lights.len() == 2);
    for choice in CHOICES {
        let lights = scene.lights.by(choice);
        assert!(lights.sample(&at(Vec3::zero()), 0.3, [0.5; 2]).is_none());
        assert_eq!(lights.pdf_environment(Vec3::zero(), UP), 0.0);
    }
}

/// Against a surface that is no light, or whose instance doesn't exist.
#[test]
fn other_surfaces_have_no_density() {
    let (scene, _) = many();
    let hit = here(Vec3::zero());
    for choice in CHOICES {
        let density = |from: Vec3<f32>, hit: &SurfacePoint, wi: Vec3<f32>| {
            scene.lights.by(choice).pdf_area(&at(from), hit, wi)
        };
        assert_eq!(density(UP, &hit, -UP), 0.0);
        let lit = SurfacePoint {
            instance: 0,
            p: UP,
            ng: -UP,
            ..hit
        };
        assert!(density(Vec3::zero(), &lit, UP) > 0.0);
        assert_eq!(density(UP * 2.0, &lit, -UP), 0.0, "from behind");
    }
    let placed: &Instance = &scene.geometry.instances()[0];
    assert_eq!(placed.area_light, Some(2));
}
