use super::*;
use crate::texture::{Bitmap, Filter, Transfer};
use gonio_image::{RawData, RawImage};
use std::sync::Arc;

const UP: Vec3<f32> = Vec3::new(0.0, 0.0, 1.0);

fn material(spec: &str) -> Material {
    Material::new("m", &ModelSpec::parse(spec).unwrap()).unwrap()
}

/// A texture of two texels side by side.
fn two(left: [u8; 4], right: [u8; 4], transfer: Transfer) -> Texture {
    let image = RawImage {
        width: 2,
        height: 1,
        data: RawData::U8(vec![left, right]),
        has_alpha: true,
    };
    let mut texture = Texture::new(Arc::new(Bitmap::new("two", image)), transfer);
    texture.filter = Filter::Nearest;
    texture
}

/// A point of a surface that faces +z with its tangent along +x.
fn point(u: f32) -> SurfacePoint {
    SurfacePoint {
        p: Vec3::zero(),
        error: 0.0,
        ng: UP,
        ns: UP,
        tangent: Vec3::new(1.0, 0.0, 0.0),
        bitangent_sign: 1.0,
        uv: [u, 0.5],
        uv1: [1.0 - u, 0.5],
        colour: [1.0, 0.5, 0.25, 0.5],
        t: 1.0,
        instance: 0,
        primitive: 0,
    }
}

fn reflectance(shading: &Shading) -> [f32; 3] {
    shading.model.eval(UP, UP).map(|f| f * std::f32::consts::PI)
}

fn near(a: [f32; 3], b: [f32; 3], tolerance: f32) {
    assert!(
        a.iter().zip(b).all(|(x, y)| (x - y).abs() <= tolerance),
        "{a:?} is not {b:?}"
    );
}

#[test]
fn textures_and_vertex_colours_multiply_the_parameter() {
    let mut m = material("lambertian:reflectance=0.8");
    assert!(
        matches!(
            m.shade(&point(0.2), UP).model,
            std::borrow::Cow::Borrowed(_)
        ),
        "nothing is copied without textures"
    );
    let texture = two([255, 0, 0, 255], [0, 255, 51, 255], Transfer::Linear);
    m.bind_texture("reflectance", TextureInput::new(texture, Channels::Rgb))
        .unwrap();
    near(
        reflectance(&m.shade(&point(0.2), UP)),
        [0.8, 0.0, 0.0],
        1e-6,
    );
    near(
        reflectance(&m.shade(&point(0.7), UP)),
        [0.0, 0.8, 0.16],
        1e-6,
    );
    near(m.shade(&point(0.7), UP).albedo, [0.0, 0.8, 0.16], 1e-6);
    m.bind_vertex_colour("reflectance").unwrap();
    near(
        reflectance(&m.shade(&point(0.7), UP)),
        [0.0, 0.4, 0.04],
        1e-6,
    );
    assert_eq!(m.driven_parameters().collect::<Vec<_>>(), ["reflectance"]);
    m.replace_model(&ModelSpec::parse("lambertian:reflectance=0.3").unwrap())
        .unwrap();
    near(reflectance(&m.shade(&point(0.7), UP)), [0.3; 3], 1e-6);
}

/// Values outside a parameter's range are limited: a reflectance of 255/255 · 3 − 1 is at most 1, of 0 · 3 − 1 at least 0.
#[test]
fn textured_values_stay_in_range() {
    let mut m = material("lambertian:reflectance=1");
    let mut input = TextureInput::new(two([255; 4], [0; 4], Transfer::Linear), Channels::Green);
    input.scale = [3.0; 3];
    input.offset = [-1.0; 3];
    m.bind_texture("reflectance", input).unwrap();
    near(reflectance(&m.shade(&point(0.2), UP)), [1.0; 3], 1e-6);
    near(reflectance(&m.shade(&point(0.7), UP)), [0.0; 3], 0.0);
}

#[test]
fn unknown_parameters_are_guessed() {
    let texture = || TextureInput::new(two([0; 4], [0; 4], Transfer::Linear), Channels::Rgb);
    let error = material("lambertian")
        .bind_texture("reflectence", texture())
        .unwrap_err();
    assert!(error.to_string().contains("reflectence"), "{error}");
    assert!(
        error.help().unwrap().contains("reflectance"),
        "{:?}",
        error.help()
    );
    let error = material("torrance-sparrow")
        .bind_texture("distribution", texture())
        .unwrap_err();
    assert!(error.to_string().contains("distribution"), "{error}");
}

#[test]
fn a_normal_map_tilts_the_frame() {
    let mut m = material("lambertian");
    // 255, 128, 255 is (1, 0.004, 1): 45° towards the tangent. The flat texel (128, 128, 255) leaves the normal, but for
    // the quarter of a degree that 128/255 misses ½ by.
    m.normal_map = Some(NormalMap {
        texture: two([255, 128, 255, 255], [128, 128, 255, 255], Transfer::Linear),
        scale: 1.0,
    });
    let h = std::f32::consts::FRAC_1_SQRT_2;
    near(
        m.shade(&point(0.2), UP).frame.n.to_array(),
        [h, 0.0, h],
        5e-3,
    );
    near(
        m.shade(&point(0.7), UP).frame.n.to_array(),
        [0.0, 0.0, 1.0],
        6e-3,
    );
    // From behind all of it turns round.
    near(
        m.shade(&point(0.2), -UP).frame.n.to_array(),
        [-h, 0.0, -h],
        5e-3,
    );
    if let Some(map) = &mut m.normal_map {
        map.scale = 0.0;
    }
    near(
        m.shade(&point(0.2), UP).frame.n.to_array(),
        [0.0, 0.0, 1.0],
        1e-6,
    );
    // A map of nothing, (127.5, 127.5, 127.5), has no direction: the surface's own normal.
    m.normal_map = Some(NormalMap {
        texture: two([0; 4], [0; 4], Transfer::Linear),
        scale: 0.0,
    });
    let n = m.shade(&point(0.2), UP).frame.n;
    assert!(n.is_finite() && n.dot(UP) > 0.0);
}

/// The green channel points along the bitangent: up in the picture, whose sign is the surface's.
#[test]
fn green_follows_the_bitangent() {
    let mut m = material("lambertian");
    m.normal_map = Some(NormalMap {
        texture: two([128, 255, 255, 255], [0; 4], Transfer::Linear),
        scale: 1.0,
    });
    let mut p = point(0.2);
    assert!(m.shade(&p, UP).frame.n.y > 0.7);
    p.bitangent_sign = -1.0;
    assert!(m.shade(&p, UP).frame.n.y < -0.7);
}

#[test]
fn a_grazing_viewer_of_a_steep_normal_gets_no_nan() {
    let mut m = material("gltf:roughness=0.2,metallic=1");
    m.normal_map = Some(NormalMap {
        texture: two([0, 128, 140, 255], [255, 128, 140, 255], Transfer::Linear),
        scale: 1.0,
    });
    for u in [0.2, 0.7] {
        for x in [-1.0_f32, 1.0] {
            let wo = Vec3::new(x, 0.0, 0.01).normalize();
            let shading = m.shade(&point(u), wo);
            let local = shading.frame.to_local(wo);
            assert!(local.z > 0.0, "{local:?}");
            let f = shading.model.eval_cos(UP, local);
            assert!(f.iter().all(|x| x.is_finite()));
        }
    }
}

#[test]
fn emission_has_sides_and_texture() {
    let mut m = material("lambertian");
    assert!(!m.emission.is_lit());
    m.emission.radiance = [2.0, 2.0, 4.0];
    assert_eq!(m.emitted(&point(0.2), UP), [2.0, 2.0, 4.0]);
    assert_eq!(m.emitted(&point(0.2), -UP), [0.0; 3]);
    m.double_sided = true;
    assert_eq!(m.emitted(&point(0.2), -UP), [2.0, 2.0, 4.0]);
    m.emission.texture = Some(two([255, 0, 0, 255], [0, 255, 255, 255], Transfer::Srgb));
    assert_eq!(m.emitted(&point(0.7), UP), [0.0, 2.0, 4.0]);
    assert_eq!(m.emission.mean(), [1.0, 1.0, 2.0]);
    m.emission.vertex_colour = true;
    assert_eq!(m.emitted(&point(0.7), UP), [0.0, 1.0, 1.0]);
}

#[test]
fn opacity_by_mode() {
    let mut opacity = Opacity {
        factor: 0.8,
        ..Opacity::default()
    };
    assert_eq!(opacity.at(&point(0.2)), 1.0);
    opacity.mode = AlphaMode::Blend;
    assert_eq!(opacity.at(&point(0.2)), 0.8);
    opacity.texture = Some(TextureInput::new(
        two([0, 0, 0, 255], [0, 0, 0, 51], Transfer::Srgb),
        Channels::Alpha,
    ));
    assert!(
        (opacity.at(&point(0.7)) - 0.16).abs() < 1e-6,
        "alpha is not decoded from sRGB"
    );
    opacity.vertex_alpha = true;
    assert!((opacity.at(&point(0.2)) - 0.4).abs() < 1e-6);
    opacity.mode = AlphaMode::Mask(0.4);
    assert_eq!(
        (opacity.at(&point(0.2)), opacity.at(&point(0.7))),
        (1.0, 0.0)
    );
}

/// A Lambertian surface reflects its reflectance; a mirror its own.
#[test]
fn albedo_is_what_comes_back() {
    near(
        material("lambertian:reflectance=0.2/0.5/0.9")
            .shade(&point(0.2), UP)
            .albedo,
        [0.2, 0.5, 0.9],
        1e-5,
    );
    near(
        material("mirror:reflectance=0.7")
            .shade(&point(0.2), UP)
            .albedo,
        [0.7; 3],
        1e-5,
    );
}

/// Clear glass takes nothing away, its scaling of radiance aside; an absorption coefficient is no share of light, whatever drives it.
#[test]
fn glass_is_white() {
    for spec in ["glass", "glass:ior=0.7", "thin-dielectric"] {
        near(material(spec).shade(&point(0.2), UP).albedo, [1.0; 3], 1e-5);
    }
    // F = 0.04 is reflected, and 0.96 · ½ passes; the share of samples that chose to reflect is off by half of one of 64.
    near(
        material("glass:transmittance=0.5")
            .shade(&point(0.2), UP)
            .albedo,
        [0.52; 3],
        0.01,
    );
    let texture = || two([255, 0, 0, 255], [0, 255, 51, 255], Transfer::Linear);
    let mut m = material("glass:absorption=100");
    m.bind_texture("absorption", TextureInput::new(texture(), Channels::Rgb))
        .unwrap();
    near(m.shade(&point(0.2), UP).albedo, [1.0; 3], 1e-5);
    assert!(m.absorbs());
    m.bind_texture("transmittance", TextureInput::new(texture(), Channels::Rgb))
        .unwrap();
    near(m.shade(&point(0.2), UP).albedo, [1.0, 0.0, 0.0], 1e-6);
}

/// The frame of what transmits stays on the outer side; that of what reflects turns to the viewer. In both, a bent normal keeps the
/// viewer on the side of the true surface that it sees.
#[test]
fn the_frame_of_glass_stays_outside() {
    let mut p = point(0.2);
    for (ns, wo) in [
        (UP, UP),
        (UP, -UP),
        (Vec3::new(0.0, 0.8, 0.6), Vec3::new(0.0, -0.8, 0.6)),
        (Vec3::new(0.0, 0.8, 0.6), Vec3::new(0.0, 0.8, -0.6)),
        (Vec3::new(0.0, 0.8, 0.6), Vec3::new(0.0, 0.999, -0.04)),
    ] {
        p.ns = ns;
        let wo = wo.normalize();
        for (spec, transmits) in [
            ("glass", true),
            ("thin-dielectric", true),
            ("lambertian", false),
        ] {
            let material = material(spec);
            let shading = material.shade(&p, wo);
            assert_eq!(shading.transmits, transmits);
            let z = shading.frame.to_local(wo).z;
            let side = if transmits { wo.z } else { 1.0 };
            assert!(
                z * side > 0.0 && z.abs() > 0.9e-3,
                "{spec} {ns:?} {wo:?}: {z}"
            );
        }
    }
}

/// A sum transmits if a part does, and its frame is that of glass.
#[test]
fn a_sum_with_glass_transmits() {
    let m = material("sum(lambertian:reflectance=0.2, glass:transmittance=0.5,reflectance=0.5)");
    assert!(m.transmits() && !m.absorbs());
    let shading = m.shade(&point(0.2), -UP);
    assert!(shading.transmits && shading.frame.n == UP);
}
