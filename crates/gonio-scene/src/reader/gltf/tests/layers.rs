//! Material extensions: what they set and what textures drive, and the errors.

use super::*;
use crate::SurfacePoint;
use gonio_brdf::Model;
use gonio_brdf::model::gltf::Gltf;

/// A picture of one texel: red 0.2, green 0.8, blue 1, alpha 0.4.
const TEXEL: &str = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR4nGMwPvM/DQAFmQJl1UAWGwAAAABJRU5ErkJggg==";

fn painted(extensions: Value, more: Value) -> Value {
    document(|d| {
        d["materials"][0] = json!({
            "name": "paint",
            "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0, "roughnessFactor": 0.25},
            "extensions": extensions
        });
        let material = d["materials"][0].as_object_mut().unwrap();
        material.extend(more.as_object().unwrap().clone());
        d["extensionsUsed"] = extensions.as_object().unwrap().keys().cloned().collect();
        d["textures"] = json!([{"source": 0}]);
        d["images"] = json!([{"uri": TEXEL}]);
    })
}

fn scene(extensions: Value) -> Scene {
    let document = painted(extensions, json!({}));
    Folder::new().load(&document, &sound()).unwrap()
}

/// The description of the only material, without the base's parameters, and the model as a point of the triangle has it.
fn read(extensions: Value) -> (String, Gltf<f32, 3>) {
    let scene = scene(extensions);
    assert!(
        scene
            .warnings
            .iter()
            .all(|w| !w.contains("KHR_") && !w.contains("material")),
        "{:?}",
        scene.warnings
    );
    let mut spec = scene.materials[0].spec().clone();
    for key in ["base_color", "metallic", "roughness"] {
        spec.values.remove(key);
    }
    let (point, wo) = seen(&scene);
    let Model::Gltf(model) = scene.shade(&point, wo).model.into_owned() else {
        panic!("{spec}");
    };
    (spec.to_string(), model)
}

/// A point of the triangle, and the direction to the viewer above it.
fn seen(scene: &Scene) -> (SurfacePoint, Vec3<f32>) {
    let wo = Vec3::new(0.0, 0.0, 1.0);
    let ray = Ray::new(Vec3::new(0.25, 0.25, 1.0), -wo);
    (scene.intersect(&ray).unwrap(), wo)
}

fn near(a: f32, b: f32) {
    assert!((a - b).abs() < 1e-5, "{a} {b}");
}

#[test]
fn nothing_is_added_where_the_strength_is_0() {
    let (spec, model) = read(json!({
        "KHR_materials_anisotropy": {"anisotropyRotation": 1}, "KHR_materials_clearcoat": {"clearcoatRoughnessFactor": 0.5},
        "KHR_materials_iridescence": {}, "KHR_materials_sheen": {"sheenRoughnessFactor": 0.5},
        "KHR_materials_transmission": {}, "KHR_materials_volume": {"thicknessFactor": 1}
    }));
    assert_eq!(spec, "gltf");
    assert!(!model.anisotropy.on && !model.coat.on && !model.film.on);
    assert!(!model.sheen.on && !model.passage.on);
}

#[test]
fn clearcoat_and_sheen() {
    let (spec, model) = read(json!({
        "KHR_materials_clearcoat": {
            "clearcoatFactor": 0.5, "clearcoatTexture": {"index": 0},
            "clearcoatRoughnessFactor": 0.625, "clearcoatRoughnessTexture": {"index": 0}
        },
        "KHR_materials_sheen": {
            "sheenColorFactor": [1, 0.5, 0.25], "sheenColorTexture": {"index": 0},
            "sheenRoughnessFactor": 1, "sheenRoughnessTexture": {"index": 0}
        }
    }));
    assert_eq!(
        spec,
        "gltf:clearcoat=0.5,clearcoat_roughness=0.625,sheen_color=1/0.5/0.25,sheen_roughness=1"
    );
    near(model.coat.strength, 0.1);
    near(model.coat.distribution.alpha_x(), 0.25);
    // sRGB: 0.8 is 0.603827 and 0.2 is 0.033105.
    let [r, g, b] = model.sheen.fibres.color;
    near(r, 0.033_105);
    near(g, 0.301_914);
    near(b, 0.25);
    near(model.sheen.fibres.alpha, 0.16);
}

/// A coat has the normal of the mesh, or its own map's, where a map bends the base's.
#[test]
fn a_coat_has_its_own_normal() {
    let coat = |values: Value, base: Value| {
        let extensions = json!({"KHR_materials_clearcoat": values});
        let folder = Folder::new();
        let scene = folder.load(&painted(extensions, base), &sound()).unwrap();
        let (hit, wo) = seen(&scene);
        let shading = scene.shade(&hit, wo);
        let Model::Gltf(model) = &*shading.model else {
            panic!("{:?}", shading.model);
        };
        (
            model.coat.frame.map(|f| shading.frame.to_world(f.n)),
            shading.frame.n,
        )
    };
    let map = json!({"normalTexture": {"index": 0}});
    let same = json!({"clearcoatFactor": 1, "clearcoatNormalTexture": {"index": 0}});
    // The texel bends towards (−0.6, 0.6, 1) of the tangent frame, whose axes are those of the triangle.
    let bent = Vec3::new(-0.6, 0.6, 1.0).normalize();
    let (own, base) = coat(json!({"clearcoatFactor": 1}), map.clone());
    assert!((base - bent).length() < 1e-2 && (own.unwrap().z - 1.0).abs() < 1e-5);
    let (own, base) = coat(same.clone(), json!({}));
    assert!((own.unwrap() - bent).length() < 1e-2 && base.z == 1.0);
    // The same map for both, or none: one normal.
    assert!(coat(same, map).0.is_none());
    assert!(coat(json!({"clearcoatFactor": 1}), json!({})).0.is_none());
}

#[test]
fn anisotropy_by_factor_and_texture() {
    let plain = json!({"KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": std::f32::consts::FRAC_PI_2}});
    let (spec, model) = read(plain);
    assert_eq!(spec, "gltf:anisotropy=0.5,rotation_deg=90");
    // α = 1/16: αx = α + (1 − α)/4.
    near(model.distribution.alpha_x(), 0.0625 + 0.9375 * 0.25);
    near(model.distribution.alpha_y(), 0.0625);
    let textured = json!({"KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyTexture": {"index": 0}}});
    let (_, model) = read(textured);
    near(model.distribution.alpha_x(), 0.0625 + 0.9375 * 0.25);
    // The texel points along (−0.6, 0.6): there the surface is rougher than across.
    let f = |x: f32, y: f32| {
        let wi = Vec3::new(x, y, 1.0).normalize();
        gonio_brdf::Brdf::eval(&model, wi, Vec3::new(0.0, 0.0, 1.0))[0]
    };
    assert!(f(-0.8, 0.8) > 1.1 * f(0.8, 0.8));
    near(f(-0.8, 0.8), f(0.8, -0.8));
}

#[test]
fn iridescence_between_its_thicknesses() {
    let film = |more: Value| {
        let mut values = json!({"iridescenceFactor": 1, "iridescenceIor": 1.5});
        values
            .as_object_mut()
            .unwrap()
            .extend(more.as_object().unwrap().clone());
        read(json!({"KHR_materials_iridescence": values}))
    };
    let (spec, model) = film(json!({"iridescenceTexture": {"index": 0}}));
    assert_eq!(
        spec,
        "gltf:iridescence=1,iridescence_ior=1.5,iridescence_thickness_nm=400"
    );
    near(model.film.strength, 0.2);
    // Green is 0.8: 100 + 0.8 · 500, and from the other end 600 − 0.8 · 500.
    for (least, most, expected) in [(100, 600, 500.0), (600, 100, 200.0), (0, 0, 0.0)] {
        let (_, model) = film(json!({
            "iridescenceThicknessMinimum": least, "iridescenceThicknessMaximum": most,
            "iridescenceThicknessTexture": {"index": 0}
        }));
        assert!(
            (model.film.thickness_nm - expected).abs() < 1e-3,
            "{least} {most}"
        );
    }
}

#[test]
fn walls_and_bodies() {
    use gonio_brdf::Brdf;
    let wall = json!({
        "KHR_materials_transmission": {"transmissionFactor": 0.5, "transmissionTexture": {"index": 0}},
        "KHR_materials_volume": {"attenuationColor": [0.5, 0.5, 0.5], "attenuationDistance": 2},
        "KHR_materials_ior": {"ior": 1.25}
    });
    let (spec, model) = read(wall.clone());
    assert_eq!(spec, "gltf:ior=1.25,transmission=0.5");
    near(model.passage.share, 0.1);
    assert!(Brdf::<f32, 3>::transmits(&model) && model.relative_ior() == [1.0; 3]);
    assert!(!scene(wall.clone()).has_absorption());

    let mut body = wall;
    body["KHR_materials_volume"]["thicknessFactor"] = json!(0.01);
    let (spec, model) = read(body.clone());
    assert_eq!(
        spec,
        "gltf:attenuation_color=0.5,attenuation_distance=2,body=solid,ior=1.25,transmission=0.5"
    );
    assert_eq!(model.relative_ior(), [1.25; 3]);
    near(model.absorption()[0], 0.5 * std::f32::consts::LN_2);
    assert!(scene(body.clone()).has_absorption());
    // Without a distance nothing is absorbed.
    body["KHR_materials_volume"] =
        json!({"thicknessFactor": 1, "attenuationColor": [0.5, 0.5, 0.5]});
    assert_eq!(read(body).1.absorption(), [0.0; 3]);
}

#[test]
fn what_is_left_out_is_said() {
    let emissive = json!({"emissiveFactor": [1, 1, 1]});
    let coat = json!({
        "KHR_materials_clearcoat": {"clearcoatFactor": 1},
        "KHR_materials_dispersion": {"dispersion": 0.1}, "KHR_materials_sheen": {"sheenColorFactor": [2, 0, 0]}
    });
    let folder = Folder::new();
    let scene = folder.load(&painted(coat, emissive), &sound()).unwrap();
    let all = scene.warnings.join("\n");
    for says in [
        "material 0 (paint): its emission isn't darkened",
        "KHR_materials_dispersion is not mapped: 1 material is",
        "sheen_color = [2.0, 0.0, 0.0] is limited to 0…1",
    ] {
        assert!(all.contains(says), "{says}: {all}");
    }
}

#[test]
fn values_of_the_wrong_kind_are_refused_by_place() {
    for (says, extensions) in [
        (
            "material 0 (paint), KHR_materials_clearcoat: found clearcoatFactor \"much\", expected a number",
            json!({"KHR_materials_clearcoat": {"clearcoatFactor": "much"}}),
        ),
        (
            "sheenColorFactor [1,2], expected three numbers",
            json!({"KHR_materials_sheen": {"sheenColorFactor": [1, 2]}}),
        ),
        (
            "anisotropyStrength 1e+300",
            json!({"KHR_materials_anisotropy": {"anisotropyStrength": 1e300}}),
        ),
        (
            "KHR_materials_iridescence: 3, expected an object",
            json!({"KHR_materials_iridescence": 3}),
        ),
        (
            "iridescenceTexture {\"index\":\"a\"}",
            json!({"KHR_materials_iridescence": {"iridescenceFactor": 1, "iridescenceTexture": {"index": "a"}}}),
        ),
        (
            "clearcoatNormalTexture 5",
            json!({"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatNormalTexture": 5}}),
        ),
        (
            "texture 4",
            json!({"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatTexture": {"index": 4}}}),
        ),
        (
            "attenuationDistance 0, expected a number > 0",
            json!({
                "KHR_materials_transmission": {"transmissionFactor": 1},
                "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 0}
            }),
        ),
        (
            "thicknessFactor -1",
            json!({"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume": {"thicknessFactor": -1}}),
        ),
    ] {
        let folder = Folder::new();
        let error = folder
            .load(&painted(extensions, json!({})), &sound())
            .unwrap_err();
        let error = error.to_string();
        assert!(
            error.contains(says) && error.contains("a.glb"),
            "{says}: {error}"
        );
    }
}
