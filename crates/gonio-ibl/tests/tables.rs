//! Tables of reflectance against quadrature of the model itself and against its known albedo.

#![allow(clippy::unwrap_used)]

use gonio_brdf::part::albedo::directional_albedo;
use gonio_brdf::part::distribution::{Distribution, Shape};
use gonio_brdf::part::masking::Masking;
use gonio_brdf::{Brdf, Model, ModelSpec};
use gonio_ibl::Dfg;
use gonio_num::Vec3;
use gonio_radiometry::quadrature::GaussLegendre;
use std::f64::consts::PI;

#[test]
fn whole_is_the_albedo_of_white_facets() {
    let table = Dfg::new("ggx", 16, 16).unwrap();
    for y in 0..16 {
        let roughness = (y as f64 + 0.5) / 16.0;
        let d = Distribution::isotropic(Shape::Ggx, roughness * roughness);
        for x in 0..16 {
            let mu = (x as f64 + 0.5) / 16.0;
            let exact = directional_albedo(&d, Masking::SmithCorrelated, mu);
            let found = f64::from(table.get(x, y)[1]);
            // 768 nodes; where the mirrored direction dips below the horizon the integrand has an edge: an error of one node on the
            // wrong side of it. Tables of gonio-brdf are within 1e-5.
            assert!(
                (found - exact).abs() < 1.0 / 768.0,
                "μ {mu} roughness {roughness}: {found} {exact}"
            );
        }
    }
}

/// Both columns by a fine product rule over directions, which knows nothing of sampling.
#[test]
fn both_columns_agree_with_quadrature() {
    for model in [
        "ggx",
        "beckmann",
        "torrance-sparrow:distribution=ggx,masking=smith",
    ] {
        let table = Dfg::new(model, 4, 2).unwrap();
        for (y, roughness) in [0.25, 0.75].into_iter().enumerate() {
            let separator = if model.contains(':') { ',' } else { ':' };
            let text = format!("{model}{separator}roughness={roughness},f0=1,interreflection=none");
            let f: Model<f64, 3> = ModelSpec::parse(&text).unwrap().build().unwrap();
            for x in 0..4 {
                let mu = (x as f64 + 0.5) / 4.0;
                let wo = Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
                let [bias, whole] = integrate(&f, wo);
                let found = table.get(x, y).map(f64::from);
                // The table's 768 nodes, as above; the rule's 400 × 400 within 2e-4.
                assert!(
                    (found[1] - whole).abs() < 2e-3,
                    "{model} {mu} {roughness}: {found:?} {whole}"
                );
                assert!(
                    (found[0] - bias).abs() < 1e-3,
                    "{model} {mu} {roughness}: {found:?} {bias}"
                );
                // Negative control: the neighbour's entry.
                let other = table.get((x + 2) % 4, 1 - y).map(f64::from);
                assert!((other[1] - whole).abs() + (other[0] - bias).abs() > 2e-3);
            }
        }
    }
}

fn integrate(f: &Model<f64, 3>, wo: Vec3<f64>) -> [f64; 2] {
    let rule = GaussLegendre::new(400);
    let mut sum = [0.0; 2];
    for (z, w) in rule.on(0.0, 1.0) {
        let r = (1.0 - z * z).sqrt();
        for k in 0..400 {
            let phi = PI * (f64::from(k) + 0.5) / 400.0;
            let wi = Vec3::new(
                r * gonio_num::Real::cos(phi),
                r * gonio_num::Real::sin(phi),
                z,
            );
            let value = f.eval(wi, wo)[0] * z * w * 2.0 * PI / 400.0;
            let facet = (0.5 * (1.0 + wi.dot(wo))).max(0.0).sqrt();
            sum[0] += value * (1.0 - facet).powi(5);
            sum[1] += value;
        }
    }
    sum
}

/// Unity's table ends at roughness 0 and along the surface: where a mirror reflects Fc = (1 − μ)⁵, and all of it. The table's 768 nodes, as above.
#[test]
fn a_table_from_end_to_end_has_its_limits() {
    let nodes = gonio_ibl::Target::Unity.table().nodes(9);
    let cosines: Vec<f64> = nodes.iter().map(|c| c * c).collect();
    let table = Dfg::at("ggx", &cosines, &nodes).unwrap();
    for (x, mu) in cosines.iter().enumerate().skip(1) {
        let [bias, whole] = table.get(x, 0).map(f64::from);
        assert!((whole - 1.0).abs() < 2e-3, "{mu}: {whole}");
        assert!((bias - (1.0 - mu).powi(5)).abs() < 2e-3, "{mu}: {bias}");
    }
    assert!(
        table
            .values
            .iter()
            .flatten()
            .all(|v| (0.0..=1.001).contains(v))
    );
}

#[test]
fn bad_tables_are_refused() {
    assert!(Dfg::new("lambertian", 4, 4).is_err());
    assert!(Dfg::new("ggx", 0, 4).is_err() && Dfg::new("ggx", 4, 5000).is_err());
    for bad in [0.0, f64::NAN, 1.5] {
        assert!(Dfg::at("ggx", &[bad], &[0.5]).is_err());
        assert!(Dfg::at("ggx", &[0.5], &[bad]).is_err());
    }
    assert!(Dfg::new("ggx", usize::MAX, 4).is_err() && Dfg::at("ggx", &[], &[0.5]).is_err());
}
