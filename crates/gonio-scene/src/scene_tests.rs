use super::*;
use crate::SceneBuilder;
use crate::geometry::Shape;
use crate::light::Light;
use crate::material::{AlphaMode, Opacity};
use crate::{Projection, Ray};
use gonio_num::Affine3;

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

/// A ray through a half transparent sphere crosses two layers: (1 − ½)² passes.
#[test]
fn transmittance_multiplies_layers() {
    let mut glass = grey("glass");
    glass.opacity = Opacity {
        mode: AlphaMode::Blend,
        factor: 0.5,
        ..Opacity::default()
    };
    let scene = ball(glass).build().unwrap();
    let ray = Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::new(0.0, 0.0, -1.0));
    assert!(scene.has_transparency() && scene.occluded(&ray));
    assert_eq!(scene.transmittance(&ray), 0.25);
    // Ending inside, then before the sphere.
    assert_eq!(scene.transmittance(&Ray { t_max: 5.0, ..ray }), 0.5);
    assert_eq!(scene.transmittance(&Ray { t_max: 3.5, ..ray }), 1.0);
    let solid = ball(grey("solid")).build().unwrap();
    assert_eq!(solid.transmittance(&ray), 0.0);
    assert!(!solid.has_transparency());
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
