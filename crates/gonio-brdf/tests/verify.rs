//! Every model is held to what it declares, by `gonio-verify`.

// Helpers of tests are tests, and colours are short arrays walked side by side.
#![allow(clippy::unwrap_used, clippy::needless_range_loop)]

mod common;

use gonio_brdf::{CheckOptions, Declares, ModelSpec, check, check_with, registry};
use gonio_verify::{Effort, Outcome, Property};

fn passes(text: &str) {
    let spec = ModelSpec::parse(text).unwrap();
    let report = check(&spec, Effort::Quick).unwrap();
    assert!(report.passed(), "{report}");
}

#[test]
fn defaults_of_every_model() {
    for info in registry::models() {
        if let Some(spec) = common::base(info) {
            passes(&spec.to_string());
        }
    }
}

#[test]
fn microfacets_of_every_kind() {
    for distribution in ["ggx", "beckmann", "blinn-phong"] {
        for (masking, more) in [
            ("v-cavity", "roughness=0.6,metal=copper"),
            ("smith", "alpha_x=0.15,alpha_y=0.6,rotation_deg=30"),
            (
                "smith-correlated",
                "roughness=0.9,ior=1.5,interreflection=none",
            ),
        ] {
            passes(&format!(
                "torrance-sparrow:distribution={distribution},masking={masking},{more}"
            ));
        }
    }
}

/// Variants and corners: anisotropic, coloured, nearly smooth, rough, and one preset of each kind.
#[test]
fn the_catalogue_away_from_its_defaults() {
    for text in [
        "eon:1/0.5/0.1,roughness=1,albedo=polynomial",
        "burley:0.6,roughness=0",
        "lafortune:diffuse=0.1,specular=0.3,cx=-1.05,cy=-0.9,cz=0.8,exponent=40,specular_2=0.2/0/0.1,cx_2=1,cz_2=1,\
         specular_3=0.1,cx_3=-1/-0.9/-0.8,exponent_3=8",
        "lafortune:normalisation=published,cx=-1.02,cz=0.98,exponent=100",
        "ward:diffuse=0.2,specular=0.6,alpha_x=0.1,alpha_y=0.4,rotation_deg=30",
        "ward-duer:alpha=0.3,normalisation=bounded,diffuse=0,specular=1",
        "ashikhmin-shirley:diffuse=1,specular=0.1/0.5/0.9,nu=20,nv=400",
        "ashikhmin-shirley:ior=1.5,scale=0.5,diffuse_term=lambertian",
        "ashikhmin-premoze:diffuse=0.5,specular=0.2,nu=3,nv=30",
        "bagher:diffuse=0.1,alpha_squared=0.001/0.04/0.5,p=0.2/1/1.9,f0=0.5,f1=0.1/0.3/-0.2",
        "low-microfacet:diffuse=0,specular=0.5,b=20,c=0.3,ior=3",
        "low-smooth:diffuse=0.2,specular=2/1/0.1,b=9,c=0.05",
        "sheen-charlie:alpha=0.05,visibility=neubelt",
        "sheen-ltc:roughness=0.1",
        "retro-reflective:metal=silver,alpha_x=0.15,alpha_y=0.4,rotation_deg=30",
        "toon:rim=0.5,rim_deg=40,bands=4",
        "mix(0.2/0.5/0.9, mirror:0.9, sum(eon:0.3, ward:diffuse=0,specular=0.2))",
        "gltf:metallic=0.4,anisotropy=0.8,rotation_deg=30,roughness=0.4",
        "gltf:metallic=1,base_color=0.9/0.6/0.3,iridescence=1,iridescence_thickness_nm=550,roughness=0.3",
        "gltf:transmission=0.7,roughness=0.3,base_color=0.9/0.5/0.2",
        "gltf:transmission=1,body=solid,roughness=0.4,ior=1.5,base_color=1",
        "gltf:transmission=0.6,body=solid,roughness=0.6,ior=1.8,metallic=0.2,specular=0.5,anisotropy=0.7",
        "gltf:sheen_color=0.9/0.5/0.2,sheen_roughness=0.5,base_color=0,roughness=0.7",
        "gltf:clearcoat=1,clearcoat_roughness=0.2,base_color=0.5/0.1/0.1,roughness=0.6",
        "gltf:clearcoat=0.8,clearcoat_roughness=0.3,sheen_color=0.5,sheen_roughness=0.4,transmission=0.5,body=solid,iridescence=0.5",
        "gltf:clearcoat=0.8,clearcoat_roughness=0.3,sheen_color=0.5,sheen_roughness=0.4,transmission=0.5,roughness=0.2",
        "gltf:clearcoat=1,clearcoat_roughness=0.4,clearcoat_normal=0.3/-0.2/0.9,anisotropy=0.6,rotation_deg=40",
        "blinn-phong@pearl-paint",
        "ward@ngan/black-oxidized-steel",
        "cook-torrance@low-e2/green-fabric",
        "low-microfacet@nickel",
        "low-smooth@yellow-plastic",
    ] {
        passes(text);
    }
}

/// Functions so steep that single precision can't have more digits, however it computes them: a masking that was fitted until it
/// vanishes at the horizon, and a needle of slope scale 6e-4. They aren't blamed for it.
#[test]
fn what_is_steep_has_few_digits() {
    for text in [
        "bagher@alum-bronze",
        "ward:anisotropy=0.6791,roughness=0.0246",
    ] {
        let spec = ModelSpec::parse(text).unwrap();
        let report = check_with(&spec, &CheckOptions::new(Effort::Quick)).unwrap();
        assert!(report.passed(), "{report}");
    }
}

/// Production models, lobe by lobe and all at once.
#[test]
fn layers_and_production_models() {
    for text in [
        "coat(roughness=0, lambertian:1)",
        "coat(roughness=0.5, anisotropy=0.8, ior=2, color=0.9/0.5/0.1, weight=0.7, darkening=0.5, ggx:metal=gold,roughness=0.3)",
        "coat(layering=albedo-scaling, ior=1.8, eon:1)",
        "coat(roughness=0.3, mirror:1)",
        "coat(color=0.5/0.7/0.9, rough-dielectric:roughness=0.4,ior=1.33)",
        "coat(weight=0.5, mix(0.5, lambertian:0.2, coat(roughness=0.8, lambertian:1)))",
        "disney-2012:0.8/0.3/0.1,roughness=0.5,subsurface=0.5,sheen=1,clearcoat=1,clearcoat_gloss=0,specular_tint=1",
        "disney:0.8/0.3/0.1,metallic=1,roughness=0.4,anisotropic=0.9,rotation_deg=20",
        "disney:0.9/0.5/0.2,spec_trans=0.7,roughness=0.4,metallic=0.2,clearcoat=1,clearcoat_gloss=0.5,sheen=0.5",
        "disney:1,spec_trans=1,roughness=0.2,ior=1.33",
        "openpbr:base_metalness=1,specular_color=0.6,specular_roughness=0.6,specular_roughness_anisotropy=0.7",
        "openpbr:base_color=1,base_diffuse_roughness=1,coat_weight=1,coat_roughness=0.4,coat_color=0.9/0.6/0.2,fuzz_weight=0.5,fuzz_roughness=0.2",
        "openpbr:transmission_weight=1,specular_roughness=0.4,transmission_color=0.9/0.5/0.2,coat_weight=0.5,fuzz_weight=1",
        "openpbr:transmission_weight=0.5,transmission_depth=2,transmission_color=0.1/0.5/0.9,thin_film_weight=1,specular_roughness=0.5",
        "openpbr:thin_film_weight=0.7,thin_film_thickness=0.4,base_metalness=0.5,subsurface_weight=0.5,specular_weight=2",
        "openpbr:geometry_thin_walled=on,transmission_weight=0.5,transmission_color=0.8/0.4/0.9,subsurface_weight=0.6,\
         subsurface_scatter_anisotropy=0.4,specular_roughness=0.5,fuzz_weight=0.3,coat_weight=0.3,coat_roughness=0.5",
    ] {
        passes(text);
    }
}

/// White under layers that only reflect stays white, but for what their tables stand above the truth, and never gets brighter.
#[test]
fn white_furnace_of_layers() {
    for text in [
        "coat(layering=albedo-scaling, roughness=0.3, lambertian:1)",
        "coat(layering=albedo-scaling, roughness=0.8, ior=2, lambertian:1)",
        "openpbr:base_color=1,specular_roughness=0.5",
        "openpbr:base_color=1,specular_ior=2,specular_roughness=1,coat_weight=1,coat_roughness=0.6,fuzz_weight=1",
        "openpbr:base_color=1,base_metalness=1,specular_roughness=0.7",
    ] {
        let report = check(&ModelSpec::parse(text).unwrap(), Effort::Quick).unwrap();
        assert!(report.passed(), "{report}");
        let verdict = report.verdict(Property::EnergyConservation).unwrap();
        assert!(verdict.figure > 0.99, "{report}");
    }
}

/// A white furnace: with F = 1 and interreflection the albedo of every direction is 1 but for the tables' accuracy, and
/// never more.
#[test]
fn white_furnace() {
    for text in [
        "ggx:fresnel=none,roughness=0.55",
        "ggx:fresnel=none,roughness=1,masking=smith",
        "beckmann:fresnel=none,roughness=0.85",
        "cook-torrance:fresnel=none,roughness=0.7",
    ] {
        let report = check(&ModelSpec::parse(text).unwrap(), Effort::Quick).unwrap();
        assert!(report.passed(), "{report}");
        let verdict = report.verdict(Property::EnergyConservation).unwrap();
        assert!(verdict.figure > 0.998, "{report}");
    }
}

#[test]
fn what_is_declared_costs_and_is_seen() {
    for (text, property) in [
        (
            "phong:normalisation=published,exponent=1,specular=1",
            Property::EnergyConservation,
        ),
        ("toon", Property::Reciprocity),
        ("ggx:anisotropy=0.8", Property::Isotropy),
        ("gltf:roughness=0", Property::EnergyConservation),
        (
            "gltf:sheen_color=1,sheen_roughness=0",
            Property::EnergyConservation,
        ),
        ("gltf:clearcoat=1,base_color=0", Property::Reciprocity),
        (
            "gltf:metallic=1,anisotropy=0.7,roughness=0.3",
            Property::Isotropy,
        ),
        ("burley:1,roughness=1", Property::EnergyConservation),
        (
            "ward-duer:alpha=0.3,specular=1,diffuse=0",
            Property::EnergyConservation,
        ),
        ("sheen-ltc:roughness=0.3", Property::Reciprocity),
        (
            "sheen-charlie:visibility=charlie-softened",
            Property::Reciprocity,
        ),
        ("gooch", Property::Reciprocity),
        (
            "disney:1,roughness=0.1,sheen=1",
            Property::EnergyConservation,
        ),
        ("openpbr", Property::Reciprocity),
        (
            "coat(layering=albedo-scaling, lambertian:0.5)",
            Property::Reciprocity,
        ),
        ("bagher@white-paint", Property::EnergyConservation),
        (
            "low-microfacet:specular=300,diffuse=0",
            Property::EnergyConservation,
        ),
        (
            "low-smooth:specular=3000,diffuse=0",
            Property::EnergyConservation,
        ),
    ] {
        let report = check(&ModelSpec::parse(text).unwrap(), Effort::Quick).unwrap();
        assert!(report.passed(), "{report}");
        assert_eq!(
            report.verdict(property).unwrap().outcome,
            Outcome::Declared,
            "{report}"
        );
    }
}

#[test]
fn declarations_follow_the_parameters() {
    let declares = |text: &str| ModelSpec::parse(text).unwrap().declares().unwrap();
    assert_eq!(declares("lambertian:0.5"), Declares::physical(0.5));
    assert!(declares("phong:diffuse=0.5,specular=0.5").energy_conserving);
    assert!(!declares("phong:diffuse=0.6,specular=0.5").energy_conserving);
    assert!(!declares("phong:normalisation=published,exponent=0").energy_conserving);
    assert!(declares("sum(lambertian:0.5, mirror:0.5)").energy_conserving);
    assert!(!declares("sum(lambertian:0.5, mirror:0.6)").energy_conserving);
    assert!(declares("scaled(0.5, sum(lambertian:1, mirror:1))").energy_conserving);
    assert!(!declares("scaled(0.5, toon)").reciprocal);
    assert!(!declares("ggx:alpha_x=0.1,alpha_y=0.2").isotropic);
    assert!(!declares("torrance-sparrow:distribution=blinn-phong").energy_conserving);
    assert!(declares("gltf:metallic=1").energy_conserving);
    assert!(declares("gltf:transmission=1,body=solid").energy_conserving);
    assert!(!declares("gltf:transmission=0.9").energy_conserving);
    assert!(!declares("gltf:metallic=1,clearcoat=0.1").reciprocal);
    assert!(declares("gltf:metallic=1,sheen_color=1,sheen_roughness=0.3").energy_conserving);
    assert!(!declares("gltf:metallic=1,sheen_color=1").energy_conserving);
    assert_eq!(
        declares("gltf:transmission=1,ior=1.3").relative_ior,
        Some([1.0; 3])
    );
    assert_eq!(
        declares("gltf:transmission=1,ior=1.3,body=solid").relative_ior,
        Some([1.3; 3])
    );
    assert_eq!(declares("gltf:body=solid").relative_ior, None);
    assert_eq!(declares("eon:0.7"), Declares::physical(0.7));
    assert!(declares("burley:1,roughness=0.39").energy_conserving);
    assert!(!declares("burley:1,roughness=0.41").energy_conserving);
    assert!(declares("lafortune:diffuse=0.4,specular=0.3,specular_2=0.3").energy_conserving);
    assert!(!declares("ward-duer:specular=0.1").energy_conserving);
    assert!(declares("ward-duer:specular=0.1,normalisation=bounded").energy_conserving);
    assert!(!declares("ashikhmin-shirley:nu=10,nv=20").isotropic);
    assert!(declares("ashikhmin-shirley:diffuse=1,specular=1").energy_conserving);
    assert!(!declares("sheen-ltc").reciprocal && declares("sheen-charlie").reciprocal);
    assert!(declares("retro-reflective:metal=gold").energy_conserving);
    assert!(!declares("bagher").energy_conserving && declares("bagher").reciprocal);
    // C = 2: the lobe's bound is A π/(1 + B).
    assert!(declares("low-smooth:diffuse=0.5,specular=1.7,b=10,c=2").energy_conserving);
    assert!(!declares("low-smooth:diffuse=0.5,specular=1.8,b=10,c=2").energy_conserving);
    // C = 2, B = 1: 4/π 2π (2 (1 − 1/2) − ln 2) A = 2.455 A.
    assert!(declares("low-microfacet:diffuse=0.5,specular=0.203,b=1,c=2").energy_conserving);
    assert!(!declares("low-microfacet:diffuse=0.5,specular=0.204,b=1,c=2").energy_conserving);
}
