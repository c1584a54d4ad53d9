//! Values that are known from elsewhere.

// Helpers of tests are tests, and colours are short arrays walked side by side.
#![allow(clippy::unwrap_used, clippy::needless_range_loop)]

use gonio_brdf::{Brdf, Model, ModelSpec, ParameterSlot};
use gonio_num::Vec3;
use std::f64::consts::{FRAC_1_PI, PI};

const UP: Vec3<f64> = Vec3::new(0.0, 0.0, 1.0);

fn model(text: &str) -> Model<f64, 3> {
    ModelSpec::parse(text).unwrap().build().unwrap()
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs().max(1.0)
}

fn tilted(theta_deg: f64, phi_deg: f64) -> Vec3<f64> {
    let (t, p) = (theta_deg.to_radians(), phi_deg.to_radians());
    Vec3::new(t.sin() * p.cos(), t.sin() * p.sin(), t.cos())
}

#[test]
fn lambertian_is_reflectance_over_pi() {
    let f = model("lambertian:0.2/0.5/0.8").eval(UP, tilted(60.0, 10.0));
    for (f, rho) in f.into_iter().zip([0.2, 0.5, 0.8]) {
        assert!(near(f, rho * FRAC_1_PI));
    }
}

#[test]
fn a_mirror_reflects_into_the_mirror_direction() {
    let s = model("mirror:0.25").sample(Vec3::new(0.36, 0.48, 0.8), [0.3; 3]);
    assert_eq!(s.wi, Vec3::new(-0.36, -0.48, 0.8));
    assert!(s.delta && s.pdf == 1.0 && s.weight == [0.25; 3]);
    // Glass of index 1.5 reflects 4 % at normal incidence.
    let s = model("mirror:ior=1.5").sample(UP, [0.0; 3]);
    assert!(near(s.weight[0], 0.04));
    assert_eq!(model("mirror").sample(-UP, [0.5; 3]).pdf, 0.0);
}

#[test]
fn phong_at_its_peak_and_at_60_degrees_from_it() {
    let m = model("phong:diffuse=0,specular=1,exponent=4");
    assert!(near(m.eval(UP, UP)[0], 6.0 / (2.0 * PI)));
    assert!(near(
        m.eval(tilted(60.0, 0.0), UP)[0],
        6.0 / (2.0 * PI) / 16.0
    ));
    let published = model("phong:diffuse=0,specular=1,exponent=4,normalisation=published");
    assert!(near(published.eval(tilted(60.0, 0.0), UP)[0], 1.0 / 16.0));
}

#[test]
fn blinn_phong_uses_the_half_vector() {
    let m = model("blinn-phong:diffuse=0,specular=1,exponent=4,normalisation=published");
    // Light at 60°, viewer at the normal: the half vector stands at 30°, cos⁴ = 9/16.
    assert!(near(m.eval(tilted(60.0, 0.0), UP)[0], 9.0 / 16.0));
    // p = 2: 8π (1/2 + 2)/(4·6) = 5π/6 is the albedo at normal incidence.
    let m = model("blinn-phong:diffuse=0,specular=1,exponent=2");
    assert!(near(m.eval(UP, UP)[0], 6.0 / (5.0 * PI)));
    // p = 6: 8/2π times ks.
    let m = model("blinn-phong:diffuse=0,specular=0.5,exponent=6,normalisation=normals");
    assert!(near(m.eval(UP, UP)[0], 2.0 / PI));
}

#[test]
fn oren_nayar_without_roughness_is_lambertian_and_brightens_towards_the_light() {
    for form in ["qualitative", "full"] {
        let smooth = model(&format!("oren-nayar:0.5,sigma_deg=0,form={form}"));
        assert!(near(
            smooth.eval(tilted(50.0, 0.0), tilted(70.0, 40.0))[0],
            0.5 * FRAC_1_PI
        ));
        let rough = model(&format!("oren-nayar:0.5,sigma_deg=30,form={form}"));
        let view = tilted(60.0, 0.0);
        assert!(rough.eval(view, view)[0] > rough.eval(tilted(60.0, 180.0), view)[0]);
    }
    // Eq. 30 by hand: σ² = 0.25 (28.6479°), θi = θr = 60°, Δφ = 0: A = 1 − 0.125/0.58, B = 0.1125/0.34, sinα tanβ = 1.5.
    let m = model(&format!("oren-nayar:1,sigma_deg={}", 0.5f64.to_degrees()));
    let view = tilted(60.0, 0.0);
    let expected = (1.0 - 0.125 / 0.58 + 0.1125 / 0.34 * 1.5) * FRAC_1_PI;
    assert!(near(m.eval(view, view)[0], expected));
}

#[test]
fn torrance_sparrow_at_normal_incidence_is_f0_over_4_pi_alpha_squared() {
    for distribution in ["ggx", "beckmann", "blinn-phong"] {
        for masking in ["smith", "smith-correlated", "v-cavity"] {
            let m = model(&format!(
                "torrance-sparrow:distribution={distribution},masking={masking},alpha=0.5,f0=0.3,interreflection=none"
            ));
            assert!(
                near(m.eval(UP, UP)[0], 0.3 / (4.0 * PI * 0.25)),
                "{distribution} {masking}"
            );
        }
    }
}

#[test]
fn rotation_turns_the_brushed_direction() {
    let along = model("ggx:alpha_x=0.1,alpha_y=0.5");
    let turned = model("ggx:alpha_x=0.1,alpha_y=0.5,rotation_deg=90");
    let (wi, wo) = (tilted(30.0, 20.0), tilted(40.0, 100.0));
    let f = along.eval(wi, wo)[0];
    let g = turned.eval(tilted(30.0, 110.0), tilted(40.0, 190.0))[0];
    assert!((f - g).abs() < 1e-10 * f);
    assert!((turned.eval(wi, wo)[0] - f).abs() > 1e-3 * f);
}

#[test]
fn gltf_ends_are_its_metal_and_its_dielectric() {
    let metal = model("gltf:base_color=0.9/0.6/0.2,metallic=1,roughness=0.5");
    let same = model("ggx:f0=0.9/0.6/0.2,roughness=0.5,masking=smith,interreflection=none");
    let (wi, wo) = (tilted(30.0, 20.0), tilted(40.0, 190.0));
    for (f, g) in metal.eval(wi, wo).into_iter().zip(same.eval(wi, wo)) {
        assert!(near(f, g));
    }
    // At normal incidence: 0.96 c/π + 0.04/(4π α²), α = 1/4.
    let f = model("gltf:base_color=0.5,metallic=0,roughness=0.5").eval(UP, UP)[0];
    assert!(near(f, 0.96 * 0.5 * FRAC_1_PI + 0.04 / (4.0 * PI / 16.0)));
}

/// The layers of glTF over a black base without specular reflection, and the shares that they leave it.
#[test]
fn gltf_layers_by_hand() {
    let (wi, wo) = (tilted(30.0, 20.0), tilted(40.0, 190.0));
    // The coat is a white mirror of facets, in the share 0.04 + 0.96 (1 − cosθr)⁵.
    let coat = model("gltf:base_color=0,specular=0,clearcoat=0.5,clearcoat_roughness=0.4");
    let facets = model("ggx:fresnel=none,roughness=0.4,masking=smith,interreflection=none");
    let k = 0.5 * (0.04 + 0.96 * (1.0 - wo.z).powi(5));
    assert!(near(coat.eval(wi, wo)[0], k * facets.eval(wi, wo)[0]));
    let plain = model("gltf:roughness=0.7");
    let coated = model("gltf:roughness=0.7,clearcoat=0.5,clearcoat_roughness=0.4");
    let mixed = (1.0 - k) * plain.eval(wi, wo)[0] + k * facets.eval(wi, wo)[0];
    assert!(near(coated.eval(wi, wo)[0], mixed));
    // Sheen alone is that of `sheen-charlie`.
    let sheen = model("gltf:base_color=0,specular=0,sheen_color=0.2/0.5/0.9,sheen_roughness=0.6");
    let fibres = model("sheen-charlie:0.2/0.5/0.9,roughness=0.6");
    for (f, g) in sheen.eval(wi, wo).into_iter().zip(fibres.eval(wi, wo)) {
        assert!(near(f, g));
    }
    // A film of the index of air leaves the metal's reflectance F0 at normal incidence.
    let film = model("gltf:metallic=1,base_color=0.5,iridescence=1,iridescence_ior=1");
    let bare = model("gltf:metallic=1,base_color=0.5");
    assert!(near(film.eval(UP, UP)[0], bare.eval(UP, UP)[0]));
    // Anisotropic at normal incidence: F0/(4π αx αy), αx = α + (1 − α) s² = 0.16 + 0.84 · 0.25, αy = 0.16.
    let brushed = model("gltf:metallic=1,base_color=1,roughness=0.4,anisotropy=0.5");
    assert!(near(
        brushed.eval(UP, UP)[0],
        1.0 / (4.0 * PI * 0.37 * 0.16)
    ));
    // It is rougher along x: light and viewer far apart in that azimuth still see a highlight.
    let apart = |azimuth: f64| brushed.eval(tilted(50.0, azimuth), UP)[0];
    assert!(apart(0.0) > 2.0 * apart(90.0));
    let turned = model("gltf:metallic=1,base_color=1,roughness=0.4,anisotropy=0.5,rotation_deg=90");
    assert!(near(turned.eval(tilted(50.0, 90.0), UP)[0], apart(0.0)));
    let directed = model(
        "gltf:metallic=1,base_color=1,roughness=0.4,anisotropy=1,anisotropy_direction=0/0.3/0.5",
    );
    assert!(near(directed.eval(tilted(50.0, 90.0), UP)[0], apart(0.0)));
}

/// Light through glTF's walls and bodies.
#[test]
fn gltf_transmits_by_hand() {
    // A thin wall passes straight on what a mirror of the same facets would reflect: (1 − 0.04) c D V, D V = 1/(4π α²).
    let wall = model("gltf:transmission=0.5,base_color=0.6,roughness=0.5");
    let straight = wall.eval(Vec3::new(0.0, 0.0, -1.0), UP)[0];
    assert!(near(straight, 0.5 * 0.96 * 0.6 / (4.0 * PI / 16.0)));
    let diffuse = model("gltf:base_color=0.6,roughness=0.5");
    let reflected = 0.5 * 0.96 * 0.6 * FRAC_1_PI;
    let lost = diffuse.eval(UP, UP)[0] - wall.eval(UP, UP)[0];
    assert!(near(lost, reflected));
    // A body is Walter's boundary but for its Fresnel reflectance: at normal incidence both have 0.04.
    let body = model("gltf:transmission=1,body=solid,base_color=1,roughness=0.5");
    let glass = model("rough-dielectric:ior=1.5,roughness=0.5,masking=smith,interreflection=none");
    let down = Vec3::new(0.0, 0.0, -1.0);
    for (wi, wo) in [(UP, UP), (down, UP), (UP, down), (down, down)] {
        assert!(near(body.eval(wi, wo)[0], glass.eval(wi, wo)[0]));
    }
    // Beyond the critical angle of 41.8° the inner side reflects all, whatever its specular strength: 50° in the mirror direction.
    let dull = model("gltf:transmission=1,body=solid,base_color=1,roughness=0.5,specular=0");
    let mirror = model("ggx:fresnel=none,roughness=0.5,masking=smith,interreflection=none");
    let (i, o) = (tilted(50.0, 0.0), tilted(50.0, 180.0));
    let flip = |w: Vec3<f64>| Vec3::new(w.x, w.y, -w.z);
    assert!(near(dull.eval(flip(i), flip(o))[0], mirror.eval(i, o)[0]));
    // σ = −ln(c)/d.
    let tinted =
        model("gltf:transmission=1,body=solid,attenuation_color=0.5,attenuation_distance=2");
    assert!(near(tinted.absorption()[1], 2.0f64.ln() / 2.0));
    let thin = model("gltf:transmission=1,attenuation_color=0.5,attenuation_distance=2");
    assert_eq!(thin.absorption(), [0.0; 3]);
}

#[test]
fn toon_is_flat_within_a_band() {
    let m = model("toon:reflectance=0.6,bands=3,specular=0");
    let radiance = |theta: f64| m.eval_cos(tilted(theta, 0.0), UP)[0];
    // cos 20° and cos 30° both round to 3/3; cos 45° = 0.707 to 2/3; cos 85° to 0.
    assert!(near(radiance(20.0), 0.6 * FRAC_1_PI) && near(radiance(30.0), 0.6 * FRAC_1_PI));
    assert!(near(radiance(45.0), 0.4 * FRAC_1_PI));
    assert_eq!(radiance(85.0), 0.0);
}

#[test]
fn toons_rim_is_seen_at_the_silhouette() {
    let m = model("toon:reflectance=0.25,bands=1,specular=0,rim=0.5,rim_deg=30");
    // Seen at 59° from the normal: no rim; at 61°, within 30° of the surface: ρ + rim.
    for (theta, rho) in [(59.0, 0.25), (61.0, 0.75)] {
        let radiance = m.eval_cos(UP, tilted(theta, 0.0))[0];
        assert!(near(radiance, rho * FRAC_1_PI), "{theta}: {radiance}");
    }
}

#[test]
fn a_sum_is_its_parts_with_the_density_of_the_whole() {
    let sum = model("sum(lambertian:0.4, phong:diffuse=0,specular=0.3, mirror:0.2)");
    let parts = [
        model("lambertian:0.4"),
        model("phong:diffuse=0,specular=0.3"),
    ];
    let (wi, wo) = (tilted(30.0, 20.0), tilted(40.0, 190.0));
    let f = parts[0].eval(wi, wo)[0] + parts[1].eval(wi, wo)[0];
    assert!(near(sum.eval(wi, wo)[0], f));
    // The mean weight over all draws is the albedo: 0.4 + 0.2 and the lobe's, at most 0.3.
    let n = 64;
    let mut albedo = 0.0;
    for k in 0..n * n * n {
        let u = [k % n, k / n % n, k / (n * n)].map(|i| (f64::from(i) + 0.5) / f64::from(n));
        albedo += sum.sample(wo, u).weight[0] / f64::from(n * n * n);
    }
    assert!(albedo > 0.8 && albedo < 0.9, "{albedo}");
}

fn value(text: &str, wi: Vec3<f64>, wo: Vec3<f64>) -> [f64; 3] {
    model(text).eval(wi, wo)
}

/// Light and viewer at the normal: no grazing term is left, D = 1/(π α²), G = 1.
#[test]
fn disney_at_the_normal_by_hand() {
    let close = |found: f64, exact: f64| {
        assert!((found - exact).abs() < 1e-12 * exact, "{found} {exact}");
    };
    for version in ["2012", "2015"] {
        // Retro-reflection needs a grazing direction: the body is Lambertian here.
        let f = value(
            &format!("disney:0.3/0.5/0.7,specular=0,roughness=0.6,version={version}"),
            UP,
            UP,
        );
        for (f, c) in f.into_iter().zip([0.3, 0.5, 0.7]) {
            close(f, c / PI);
        }
        let metal = format!("disney:0.3/0.5/0.7,metallic=1,roughness=0.5,version={version}");
        for (f, c) in value(&metal, UP, UP).into_iter().zip([0.3, 0.5, 0.7]) {
            close(f, c / (4.0 * PI * 0.0625));
        }
        // α = 0.001 for a clearcoat of full gloss; D(1) = (α² − 1)/(π ln α² α²).
        let coated = value(&(metal.clone() + ",clearcoat=0.5"), UP, UP)[0];
        let a2: f64 = 1e-6;
        let peak = (a2 - 1.0) / (PI * a2.ln() * a2);
        close(
            coated,
            0.3 / (4.0 * PI * 0.0625) + 0.5 * 0.25 * 0.04 * peak / 4.0,
        );
    }
}

/// A texture can't set what only the other year's model has.
#[test]
fn disney_leaves_the_other_years_parameters_alone() {
    let (wi, wo) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.28, 0.96));
    for (year, own, others) in [
        ("2012", "subsurface", &["ior", "flatness", "spec_trans"][..]),
        ("2015", "flatness", &["subsurface"]),
    ] {
        let spec = ModelSpec::parse(&format!("disney:version={year}")).unwrap();
        let plain: Model<f32, 3> = spec.build().unwrap();
        let (wi, wo) = (wi.to_f32(), wo.to_f32());
        let with = |name: &str| {
            let mut model = plain.clone();
            model.set_parameter(ParameterSlot::find("disney", name).unwrap(), [0.9; 3]);
            model.eval(wi, wo)
        };
        for name in others {
            assert_eq!(with(name), plain.eval(wi, wo), "{year} {name}");
        }
        assert_ne!(with(own), plain.eval(wi, wo), "{year}");
    }
}

/// Without colour all of Disney's dielectric that transmits is Walter's rough one.
#[test]
fn disney_glass_is_rough_glass() {
    let disney = "disney:1,spec_trans=1,ior=1.4,roughness=0.5";
    let glass = "rough-dielectric:ior=1.4,roughness=0.5,masking=smith,interreflection=none";
    let w = [
        Vec3::new(0.6, 0.0, 0.8),
        Vec3::new(0.0, 0.28, 0.96),
        Vec3::new(-0.48, 0.36, -0.8),
        Vec3::new(0.0, -0.6, -0.8),
    ];
    for wi in w {
        for wo in w {
            let (f, g) = (value(disney, wi, wo)[1], value(glass, wi, wo)[1]);
            assert!((f - g).abs() <= 1e-12 * g, "{wi:?} {wo:?}: {f} {g}");
        }
    }
}

/// One slab at a time, OpenPBR is the model of that slab.
#[test]
fn openpbr_of_one_slab_is_that_slab() {
    let (wi, wo) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.28, 0.96));
    for (text, slab) in [
        (
            "openpbr:base_metalness=1,base_color=0.9/0.6/0.3,specular_roughness=0.5",
            "ggx:f0=0.9/0.6/0.3,roughness=0.5",
        ),
        (
            "openpbr:base_metalness=1,base_color=0.9,specular_color=0.5,specular_roughness=0.5",
            "ggx:f0=0.9,f82=0.5,roughness=0.5",
        ),
        (
            "openpbr:specular_weight=0,base_color=0.3/0.5/0.7,base_diffuse_roughness=0.6",
            "eon:0.3/0.5/0.7,roughness=0.6",
        ),
        (
            "openpbr:specular_weight=0,subsurface_weight=1,subsurface_color=0.4",
            "lambertian:0.4",
        ),
        (
            "openpbr:transmission_weight=1,specular_roughness=0.4",
            "rough-dielectric:roughness=0.4",
        ),
        (
            "openpbr:base_weight=0,specular_weight=0,fuzz_weight=1,fuzz_roughness=0.4,fuzz_color=0.8",
            "sheen-ltc:0.8,roughness=0.4",
        ),
    ] {
        let (f, g) = (value(text, wi, wo), value(slab, wi, wo));
        for k in 0..3 {
            // What passes a gloss of no contrast is 1 less the table's rounding.
            assert!((f[k] - g[k]).abs() <= 2e-3 * g[k], "{text}: {f:?} {g:?}");
        }
        // A control: half of it is another value.
        assert!((0.5 * f[0] - g[0]).abs() > 2e-3 * g[0], "{text}");
    }
}
