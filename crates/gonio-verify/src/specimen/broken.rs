//! Faults of values: of f itself.

use super::{Broken, Frosted, Ggx, Lambertian, Mirror, Phong, Pointwise, Specimen, above};
use crate::directions::azimuth;
use crate::{Expectation, Property, SubjectSample};
use gonio_num::{Real, Vec3};
use std::f64::consts::PI;

type V = Vec3<f64>;

/// Schlick's Fresnel term for the cosine c.
fn schlick(f0: f64, c: f64) -> f64 {
    let m = 1.0 - c.clamp(0.0, 1.0);
    f0 + (1.0 - f0) * m * m * m * m * m
}

fn ggx(alpha: f64) -> Ggx {
    Ggx { alpha: [alpha; 2] }
}

/// A function of the directions above the horizon, drawn by the cosine.
fn diffuse(f: impl Fn(V, V) -> f64 + Send + Sync + 'static) -> Broken<Lambertian> {
    Broken::new(Lambertian(1.0))
        .eval(move |_, wi, wo| [if above(wi, wo) { f(wi, wo) } else { 0.0 }; 3])
}

/// GGX with D written as in textbooks, α²/(π ((n·h)² (α² − 1) + 1)²), in single precision.
struct Textbook(f32);

impl Pointwise for Textbook {
    fn eval(&self, wi: V, wo: V) -> [f64; 3] {
        if !above(wi, wo) {
            return [0.0; 3];
        }
        let (wi, wo) = (wi.to_f32(), wo.to_f32());
        let (n_h, a2) = ((wi + wo).normalize().z, self.0 * self.0);
        let t = n_h * n_h * (a2 - 1.0) + 1.0;
        let d = a2 / (std::f32::consts::PI * t * t);
        let lambda = |w: Vec3<f32>| {
            let tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
            0.5 * ((1.0 + a2 * tan2).sqrt() - 1.0)
        };
        let g = 1.0 / (1.0 + lambda(wi) + lambda(wo));
        [f64::from(d * g / (4.0 * wi.z * wo.z)); 3]
    }
    fn pdf(&self, wi: V, wo: V) -> f64 {
        ggx(f64::from(self.0)).pdf(wi, wo)
    }
    fn sample(&self, wo: V, u: [f64; 3]) -> Option<SubjectSample> {
        ggx(f64::from(self.0)).sample(wo, u)
    }
}

pub(super) fn values() -> Vec<Specimen> {
    let mut all = numbers();
    all.extend(energy());
    all.extend(symmetry());
    all
}

/// Not a number, negative, or where nothing should be.
fn numbers() -> Vec<Specimen> {
    use Property::*;
    vec![
        Specimen::broken(
            "an azimuth from x/sinθ: NaN at the normal",
            Finite,
            diffuse(|_, wo| {
                let sin = (wo.x * wo.x + wo.y * wo.y).sqrt();
                0.5 / PI * (1.0 + 0.0 * wo.x / sin)
            }),
        ),
        Specimen::broken("interreflection at reflectance exactly 1: 0/0", Finite, {
            let rho = 1.0;
            diffuse(move |_, _| rho / PI * (1.0 - rho) / (1.0 - rho))
        }),
        Specimen::broken(
            "tan²θ without a guard: infinite at exactly 90°",
            Finite,
            diffuse(|wi, wo| {
                let tan2 = (1.0 - wo.z * wo.z) / (wo.z * wo.z);
                0.3 / PI * wi.z * (1.0 + 1.0 / tan2).recip() * tan2
            })
            .eval(|_, wi, wo| {
                let tan2 = (1.0 - wo.z * wo.z) / (wo.z * wo.z);
                [if wi.z > 0.0 && wo.z >= 0.0 {
                    0.1 * wi.z * tan2 / (1.0 + tan2)
                } else {
                    0.0
                }; 3]
            }),
        ),
        Specimen::broken(
            "a dip below zero in a hundredth of all directions",
            NonNegative,
            Broken::new(Lambertian(0.5)).eval(|r, wi, wo| {
                let dip = if wi.y > 0.98 && above(wi, wo) {
                    0.5
                } else {
                    0.0
                };
                r.eval(wi, wo).map(|f| f - dip)
            }),
        ),
        Specimen::broken(
            "a specular term subtracted twice: negative at grazing",
            NonNegative,
            diffuse(|wi, wo| 0.5 / PI * (1.0 - 1.2 * schlick(0.04, wi.z.min(wo.z)))),
        ),
        Specimen::broken(
            "|cosθ| where the sign matters: light leaks from below",
            Horizon,
            Broken::new(Lambertian(0.5))
                .eval(|_, _, wo| [if wo.z > 0.0 { 0.5 / PI } else { 0.0 }; 3]),
        ),
        Specimen::broken(
            "1/(cosθi cosθo) without masking: a jump at the horizon",
            Continuity,
            diffuse(|wi, wo| 0.5 / PI + 5e-4 / (wi.z * wo.z).max(1e-200)),
        ),
        Specimen {
            single: Some(Box::new(Textbook(1e-4))),
            ..Specimen::broken(
                "D of α = 1e-4 as textbooks have it, in f32: division by 0",
                SinglePrecision,
                ggx(1e-4),
            )
        },
        Specimen {
            single: Some(Box::new(Textbook(0.003))),
            ..Specimen::broken(
                "D of α = 0.003 as textbooks have it, in f32: cancellation",
                SinglePrecision,
                ggx(0.003),
            )
        },
    ]
}

/// Too much light, or too little.
fn energy() -> Vec<Specimen> {
    use Property::*;
    vec![
        Specimen::broken("albedo 1.01", EnergyConservation, Lambertian(1.01)),
        Specimen::broken("a mirror of 1.01", EnergyConservation, Mirror(1.01)),
        Specimen::broken(
            "diffuse kept at 1 − F0 under a Fresnel lobe: too bright at grazing",
            EnergyConservation,
            Broken::new(ggx(0.3))
                .eval(|r, wi, wo| {
                    let half = (wi + wo).normalize();
                    let d = if above(wi, wo) {
                        (1.0 - 0.04) / PI
                    } else {
                        0.0
                    };
                    r.eval(wi, wo).map(|f| f * schlick(0.04, wi.dot(half)) + d)
                })
                .pdf(|r, wi, wo| 0.5 * r.pdf(wi, wo) + 0.5 * Lambertian(1.0).pdf(wi, wo))
                .sample(|r, wo, u| {
                    let s = if u[2] < 0.5 {
                        r.sample(wo, u)?
                    } else {
                        Lambertian(1.0).sample(wo, u)?
                    };
                    if !above(s.wi, wo) {
                        return None;
                    }
                    let half = (s.wi + wo).normalize();
                    let f = r.eval(s.wi, wo)[0] * schlick(0.04, s.wi.dot(half)) + 0.96 / PI;
                    let pdf = 0.5 * r.pdf(s.wi, wo) + 0.5 * Lambertian(1.0).pdf(s.wi, wo);
                    Some(SubjectSample {
                        weight: [f * s.wi.z / pdf; 3],
                        pdf,
                        ..s
                    })
                }),
        ),
        Specimen::broken(
            "half metal, half dielectric: F0 mixed inside a square, bright between only",
            EnergyConservation,
            {
                let metalness = 0.5;
                diffuse(move |_, _| (1.0 + 0.1 * metalness * (1.0 - metalness)) / PI)
            },
        ),
        Specimen {
            loss_bound: Some(0.01),
            ..Specimen::broken(
                "a white rough metal without interreflection, bounded to a loss of 1 %",
                EnergyLoss,
                ggx(1.0),
            )
        },
        Specimen {
            relative_ior: Some([0.7; 3]),
            ..Specimen::broken(
                "a boundary that forgets n²",
                EnergyConservation,
                Frosted {
                    ior: [0.7; 3],
                    scaled: false,
                },
            )
        },
    ]
}

/// Reciprocity, isotropy, linearity.
fn symmetry() -> Vec<Specimen> {
    use Property::*;
    let parts = || -> Vec<Box<dyn Pointwise>> {
        vec![
            Box::new(Lambertian(0.3)),
            Box::new(Broken::new(Phong(20.0)).eval(|r, wi, wo| r.eval(wi, wo).map(|f| 0.5 * f))),
        ]
    };
    vec![
        Specimen::broken(
            "interreflection by a scale of the viewer's albedo alone",
            Reciprocity,
            Broken::new(ggx(0.8)).eval(|r, wi, wo| {
                // The albedo of this lobe falls by about a tenth towards grazing.
                r.eval(wi, wo).map(|f| f * (1.0 + 0.1 * (1.0 - wo.z)))
            }),
        ),
        Specimen::broken(
            "Oren–Nayar with sinθo tanθi for sin(larger) tan(smaller)",
            Reciprocity,
            diffuse(|wi, wo| {
                let sin = |w: V| (1.0 - w.z * w.z).max(0.0).sqrt();
                let cos: f64 = Real::cos(azimuth(wi) - azimuth(wo));
                let tan = (sin(wi) / wi.z.max(1e-9)).min(1.0);
                0.5 / PI * (0.8 + 0.3 * cos.max(0.0) * sin(wo) * tan)
            }),
        ),
        Specimen::broken(
            "Fresnel of n·v for h·v",
            Reciprocity,
            Broken::new(ggx(0.4)).eval(|r, wi, wo| r.eval(wi, wo).map(|f| f * schlick(0.04, wo.z))),
        ),
        Specimen::broken(
            "f already times cosθi",
            Reciprocity,
            diffuse(|wi, _| 0.8 / PI * wi.z),
        ),
        Specimen::broken(
            "brushed metal that is declared isotropic",
            Isotropy,
            Ggx { alpha: [0.3, 0.29] },
        ),
        Specimen {
            expect: Expectation::PHYSICAL,
            components: parts(),
            ..Specimen::broken(
                "a sum that counts its second part twice",
                Linearity,
                Broken::new(Lambertian(0.3)).eval(|r, wi, wo| {
                    let (d, s) = (r.eval(wi, wo), Phong(20.0).eval(wi, wo));
                    [0, 1, 2].map(|k| d[k] + s[k])
                }),
            )
        },
    ]
}
