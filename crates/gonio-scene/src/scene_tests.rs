use super::*;
use crate::SceneBuilder;
use crate::geometry::Shape;
use crate::light::Light;
use crate::material::{AlphaMode, Opacity};
use crate::{Projection, Ray};
use gonio_num::{Affine3, Real};

const UP: Vec3<f32> = Vec3::new(0.0, 1.0, 0.0);

fn grey(name: &str) -> Material {
    Material::new(
        name,
        &ModelSpec::parse("lambertian:reflectance=0.5").unwrap(),
    )
    .unwrap()
}

fn ball(material: Material) -> SceneBuilder {
    let mut builder = SceneBuilder::new("ball");
    let material = builder.material(material);
    let sphere = builder.shape(Shape::Sphere);
    builder.instance(sphere, Affine3::identity(), material);
    builder
}

#[test]
fn nothing_to_render_is_an_error_that_says_so() {
    let error = SceneBuilder::new("void").build().unwrap_err();
    assert!(matches!(error, SceneError::Empty { .. }));
    assert!(
        error.to_string().contains("`void`") && error.help().is_some(),
        "{error}"
    );
    let mut sky = SceneBuilder::new("sky");
    sky.environment(Environment::uniform([1.0; 3]));
    let sky = sky.build().unwrap();
    assert!(sky.warnings.is_empty());
    assert!(sky.intersect(&Ray::new(Vec3::zero(), UP)).is_none());
    assert!(sky.camera_or_framing(1.5).position().is_finite());
}

#[test]
fn the_dark_is_a_warning() {
    let mut scene = ball(grey("a")).build().unwrap();
    assert_eq!(scene.warnings, [NO_LIGHT]);
    scene.set_environment(Some(Environment::uniform([1.0; 3])));
    assert!(scene.warnings.is_empty() && scene.lights.environment().is_some());
    scene.set_environment(None);
    assert_eq!(scene.warnings, [NO_LIGHT]);
}

#[test]
fn materials_are_replaced_by_name() {
    let mut builder = ball(grey("left"));
    builder.material(grey("right"));
    let mut scene = builder.build().unwrap();
    let mirror = ModelSpec::parse("mirror").unwrap();
    assert_eq!(scene.replace_material("right", &mirror).unwrap(), 1);
    assert_eq!(scene.materials[1].spec().name, "mirror");
    assert_eq!(scene.materials[0].spec().name, "lambertian");
    let error = scene.replace_material("rihgt", &mirror).unwrap_err();
    assert_eq!(error.help().unwrap(), "did you mean `right`?");
    assert_eq!(scene.replace_material("*", &mirror).unwrap(), 2);
    assert_eq!(scene.material_names(), ["left", "right"]);
}

#[test]
fn lights_and_materials_are_checked() {
    let bad = [
        Light::Point {
            position: UP,
            intensity: [-1.0, 0.0, 0.0],
        },
        Light::Point {
            position: Vec3::splat(f32::NAN),
            intensity: [1.0; 3],
        },
        Light::Directional {
            direction: Vec3::splat(1.0),
            irradiance: [1.0; 3],
        },
        Light::Directional {
            direction: UP,
            irradiance: [f32::INFINITY; 3],
        },
    ];
    for light in bad {
        let mut builder = ball(grey("a"));
        builder.light(light);
        let error = builder.build().unwrap_err().to_string();
        assert!(error.starts_with("light 0 is "), "{error}");
    }
    let mut builder = ball(grey("a"));
    let disk = builder.shape(Shape::Disk);
    builder.instance(disk, Affine3::identity(), 7);
    let error = builder.build().unwrap_err().to_string();
    assert!(
        error.contains("material of instance 1") && error.contains("below 1"),
        "{error}"
    );
}

/// A point at rest at `p`, from which ways lead in any direction.
fn observer(p: Vec3<f32>) -> SurfacePoint {
    SurfacePoint {
        p,
        error: 0.0,
        ng: UP,
        ns: UP,
        tangent: Vec3::new(1.0, 0.0, 0.0),
        bitangent_sign: 1.0,
        uv: [0.0; 2],
        uv1: [0.0; 2],
        colour: [1.0; 4],
        t: 0.0,
        instance: u32::MAX,
        primitive: u32::MAX,
    }
}

fn veil(mut material: Material, alpha: f32) -> Material {
    material.opacity = Opacity {
        mode: AlphaMode::Blend,
        factor: alpha,
        ..Opacity::default()
    };
    material
}

fn of(name: &str, spec: &str) -> Material {
    Material::new(name, &ModelSpec::parse(spec).unwrap()).unwrap()
}

/// What passes from the point (0, 0, 5) towards −z: to infinity, and to a light at the distance `t`.
fn passes(scene: &Scene, t: Option<f32>) -> [f32; 3] {
    let (eye, wi) = (Vec3::new(0.0, 0.0, 5.0), Vec3::new(0.0, 0.0, -1.0));
    let target = t.map_or(LightTarget::Infinite, |t| LightTarget::Point(eye + wi * t));
    scene.transmittance(&observer(eye), wi, target, &scene.interior_at(eye))
}

/// A ray through a half transparent sphere crosses two layers: (1 − ½)² passes.
#[test]
fn transmittance_multiplies_layers() {
    let scene = ball(veil(grey("veil"), 0.5)).build().unwrap();
    let ray = Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::new(0.0, 0.0, -1.0));
    assert!(scene.has_transparency() && scene.occluded(&ray));
    assert_eq!(passes(&scene, None), [0.25; 3]);
    // Ending inside, then before the sphere.
    assert_eq!(passes(&scene, Some(5.0)), [0.5; 3]);
    assert_eq!(passes(&scene, Some(3.5)), [1.0; 3]);
    let solid = ball(grey("solid")).build().unwrap();
    assert_eq!(passes(&solid, None), [0.0; 3]);
    assert_eq!(passes(&solid, Some(3.5)), [1.0; 3]);
    assert!(!solid.has_transparency());
}

/// A ball whose surface lets half of the light straight through at each face, and whose inside absorbs: ¼ e^(−2σ) of what is behind it, and
/// ½ e^(−σ) of a light in its middle. A veil in it changes the share alone.
#[test]
fn transmittance_within_bodies() {
    let tinted = "glass:ior=1.5,absorption=0/1/2";
    let mut builder = ball(veil(of("tinted", tinted), 0.5));
    let scene = builder.build().unwrap();
    let near = |found: [f32; 3], share: f32, way: f32| {
        let expected = [0.0, 1.0, 2.0].map(|sigma: f32| share * Real::exp(-sigma * way));
        assert!(
            found
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-5),
            "{found:?} {expected:?}"
        );
    };
    near(passes(&scene, None), 0.25, 2.0);
    near(passes(&scene, Some(5.0)), 0.5, 1.0);
    near(passes(&scene, Some(3.5)), 1.0, 0.0);
    builder = ball(veil(of("tinted", tinted), 0.5));
    let disk = builder.shape(Shape::Disk);
    let pane = builder.material(veil(of("pane", "thin-dielectric"), 0.5));
    builder.instance(disk, Affine3::identity(), pane);
    near(passes(&builder.build().unwrap(), None), 0.125, 2.0);
    // Opaque glass stops shadow rays.
    let solid = ball(of("solid", tinted)).build().unwrap();
    assert_eq!(passes(&solid, None), [0.0; 3]);
    assert_eq!(passes(&solid, Some(3.5)), [1.0; 3]);
}

/// Bodies around a point are found whatever else is on the way up: here a body that is passed, an opaque one, and a pane.
#[test]
fn the_bodies_around_a_point() {
    let mut builder = ball(of("inner", "glass:absorption=1"));
    let sphere = builder.shape(Shape::Sphere);
    let place = |builder: &mut SceneBuilder, scale: f32, y: f32, material: Material| {
        let material = builder.material(material);
        let to_world =
            Affine3::scale(Vec3::splat(scale)).then(&Affine3::translation(Vec3::new(0.0, y, 0.0)));
        builder.instance(sphere, to_world, material);
    };
    place(&mut builder, 20.0, 0.0, of("outer", "glass:absorption=0.1"));
    for scale in [2.0, 3.0, 4.0] {
        place(&mut builder, scale, 8.0, of("drop", "glass:ior=1.1"));
    }
    place(&mut builder, 1.5, 8.0, grey("stone"));
    place(&mut builder, 0.5, 0.0, of("pane", "thin-dielectric"));
    let scene = builder.build().unwrap();
    let materials = |p: [f32; 3]| {
        let interior = scene.interior_at(p.into());
        let names = interior.bodies().iter().map(|b| b.material);
        names.collect::<Vec<u32>>()
    };
    assert_eq!(materials([0.0, 0.0, 0.0]), [1, 0]);
    assert_eq!(materials([0.0, 3.0, 0.0]), [1]);
    assert_eq!(materials([0.0, 25.0, 0.0]), [0; 0]);
    // Where nothing absorbs nobody asks.
    let clear = ball(of("clear", "glass")).build().unwrap();
    assert!(!clear.has_absorption());
    assert!(clear.interior_at(Vec3::zero()).bodies().is_empty());
}

#[test]
fn absorption_follows_replaced_materials() {
    let mut scene = ball(grey("a")).build().unwrap();
    assert!(!scene.has_absorption());
    let tinted = ModelSpec::parse("glass:absorption=1").unwrap();
    scene.replace_material("a", &tinted).unwrap();
    assert!(scene.has_absorption());
    assert_eq!(scene.interior_at(Vec3::zero()).bodies().len(), 1);
}

/// Light without extent is never found through smooth glass: a warning names the glass, once, and comes and goes with its causes.
#[test]
fn point_lights_and_smooth_glass_are_a_warning() {
    let light = Light::Point {
        position: UP * 3.0,
        intensity: [1.0; 3],
    };
    let mut builder = ball(of("window", "thin-dielectric"));
    builder.light(light.clone());
    let mut scene = builder.build().unwrap();
    assert_eq!(scene.warnings.len(), 1);
    assert!(
        scene.warnings[0].contains("shine through `window`,"),
        "{:?}",
        scene.warnings
    );
    let matt = ModelSpec::parse("lambertian").unwrap();
    scene.replace_material("window", &matt).unwrap();
    assert!(scene.warnings.is_empty());
    let glass = ModelSpec::parse("glass").unwrap();
    scene.replace_material("window", &glass).unwrap();
    assert_eq!(scene.warnings.len(), 1);
    // A sky is found through glass.
    let mut builder = ball(of("window", "glass"));
    builder.environment(Environment::uniform([1.0; 3]));
    assert!(builder.build().unwrap().warnings.is_empty());
}

/// A tetrahedron with its corners at the origin and the axes' unit points, wound outwards; turned round it is inside out. Open, or of a
/// material that doesn't refract, it may be either way.
#[test]
fn glass_turned_inside_out_is_a_warning() {
    let outwards = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let warnings = |faces: &[[u32; 3]], spec: &str| {
        let mesh = crate::TriangleMesh {
            positions: [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
                .map(|[x, y, z]| Vec3::new(x + 7.0, y, z))
                .to_vec(),
            indices: faces.to_vec(),
            ..crate::TriangleMesh::default()
        };
        let mut builder = SceneBuilder::new("tetrahedron");
        builder.environment(Environment::uniform([1.0; 3]));
        let shape = builder.shape(Shape::Mesh(Arc::new(mesh)));
        let material = builder.material(of("ice", spec));
        builder.instance(shape, Affine3::identity(), material);
        builder.instance(shape, Affine3::identity(), material);
        builder.build().unwrap().warnings
    };
    let inwards = outwards.map(|[a, b, c]| [a, c, b]);
    let found = warnings(&inwards, "glass");
    assert!(
        found.len() == 1 && found[0].contains("`ice` is turned inside out"),
        "{found:?}"
    );
    assert!(warnings(&outwards, "glass").is_empty());
    assert!(warnings(&inwards[..3], "glass").is_empty());
    assert!(warnings(&inwards, "thin-dielectric").is_empty());
    assert!(warnings(&inwards, "lambertian").is_empty());
}

#[test]
fn surfaces_shade_and_emit_as_their_material() {
    let mut lamp = grey("lamp");
    lamp.emission.radiance = [2.0, 1.0, 0.0];
    let scene = ball(lamp).build().unwrap();
    let ray = Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::new(0.0, 0.0, -1.0));
    let point = scene.intersect(&ray).unwrap();
    assert_eq!(scene.emitted(&point, -ray.direction), [2.0, 1.0, 0.0]);
    assert_eq!(
        scene.emitted(&point, ray.direction),
        [0.0; 3],
        "not inwards"
    );
    let shading = scene.shade(&point, -ray.direction);
    assert!((shading.frame.n - Vec3::new(0.0, 0.0, 1.0)).length() < 1e-6);
    assert_eq!(
        scene.shade(&point, ray.direction).frame.n,
        -shading.frame.n,
        "the frame faces the viewer"
    );
}

#[test]
fn the_first_camera_is_the_default() {
    let mut builder = ball(grey("a"));
    let made = Camera::new(
        "one",
        &Affine3::identity(),
        Projection::Pinhole { fov_y_rad: 0.5 },
    )
    .unwrap();
    builder.camera(made.clone());
    assert_eq!(builder.build().unwrap().camera_or_framing(1.0), made);
}
