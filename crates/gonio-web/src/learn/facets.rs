//! T17 and T18: Fresnel's equations, and the factors of a microfacet model.

use super::within;
use crate::answer::{Answer, colours};
use crate::complaint::Complaint;
use crate::subject::{Angles, Subject};
use gonio_brdf::Brdf;
use gonio_brdf::part::distribution::{Distribution, Shape};
use gonio_brdf::part::fresnel::{conductor, conductor_polarised, schlick};
use gonio_brdf::part::geometry::Half;
use gonio_brdf::part::masking::{Masking, visibility};
use gonio_num::Real;
use serde_json::json;

/// Reflectance of a smooth boundary of index `ior` + i `k` over 0 to 90°, by the full equations and by Schlick's.
pub(super) fn fresnel(ior: f64, k: f64) -> Result<Answer, Complaint> {
    let ior = within("the index of refraction", ior, 0.05, 20.0)?;
    let k = within("the absorption k", k, 0.0, 20.0)?;
    if k == 0.0 && ior < 1.0 {
        let message =
            format!("the index of refraction is {ior}, expected 1 or more without absorption");
        return Err(Complaint::new(message));
    }
    let angles: Vec<f64> = (0..=180).map(|i| 0.5 * f64::from(i)).collect();
    let cosines: Vec<f64> = (angles.iter())
        .map(|a| Real::cos(a.to_radians()).max(0.0))
        .collect();
    let f0 = conductor(1.0, ior, k);
    let full: Vec<f64> = cosines.iter().map(|c| conductor(*c, ior, k)).collect();
    let approximate: Vec<f64> = cosines.iter().map(|c| schlick(*c, f0, 1.0)).collect();
    let polarised = |k2: usize| {
        cosines
            .iter()
            .map(move |c| conductor_polarised(*c, ior, k)[k2] as f32)
    };
    let (mut difference, mut at) = (0.0, 0.0);
    for ((a, full), approximate) in angles.iter().zip(&full).zip(&approximate) {
        if (full - approximate).abs() > difference {
            (difference, at) = ((full - approximate).abs(), *a);
        }
    }
    let single = |values: &[f64]| values.iter().map(|x| *x as f32).collect();
    Ok(Answer::new(
        json!({
            "f0": f0,
            "brewster": (k == 0.0).then(|| Real::atan2(ior, 1.0).to_degrees()),
            "difference": difference,
            "at": at,
        }),
        vec![
            ("angles", single(&angles)),
            ("p", polarised(1).collect()),
            ("s", polarised(0).collect()),
            ("schlick", single(&approximate)),
            ("unpolarised", single(&full)),
        ],
    ))
}

/// D, G, F and f = F G D / (4 cosθi cosθr) of a GGX surface, over the plane of incidence of light at `theta` on the left.
pub(super) fn torrance_sparrow(roughness: f64, ior: f64, theta: f64) -> Result<Answer, Complaint> {
    let roughness = within("the roughness", roughness, 0.01, 1.0)?;
    let ior = within("the index of refraction", ior, 1.0, 10.0)?;
    let theta = within("θ", theta, 0.0, 89.5)?;
    let distribution = Distribution::isotropic(Shape::Ggx, roughness * roughness);
    let text = format!(
        "torrance-sparrow:distribution=ggx,masking=smith-correlated,roughness={roughness},ior={ior},interreflection=none"
    );
    let subject = Subject::open(&text)?;
    let wi = Angles { theta, phi: 180.0 }.direction();
    let (mut angles, mut d, mut g, mut f, mut value) = (vec![], vec![], vec![], vec![], vec![]);
    for i in -178..=178 {
        let angle = 0.5 * f64::from(i);
        let wo = Angles {
            theta: angle,
            phi: 0.0,
        }
        .direction();
        let half = Half::new(wi, wo);
        let v = visibility(Masking::SmithCorrelated, &distribution, wi, wo, &half);
        angles.push(angle as f32);
        d.push(distribution.density_of(&half) as f32);
        g.push((4.0 * wi.z * wo.z * v) as f32);
        f.push(conductor(half.cos, ior, 0.0) as f32);
        value.push(subject.model.eval(wi, wo));
    }
    Ok(Answer::new(
        json!({}),
        vec![
            ("angles", angles),
            ("d", d),
            ("f", f),
            ("g", g),
            ("value", colours(value)),
        ],
    ))
}
