//! Faults of sampling: of `sample` and `pdf`, beside an f that is right.

use super::{Broken, Ggx, Lambertian, Phong, Pointwise, Specimen, above, consistent};
use crate::{Property, SubjectSample};
use gonio_num::{Frame, Real, Vec3};
use std::f64::consts::{PI, TAU};

type V = Vec3<f64>;

fn ggx(alpha: f64) -> Ggx {
    Ggx { alpha: [alpha; 2] }
}

pub(super) fn all() -> Vec<Specimen> {
    let mut all = density();
    all.extend(weight());
    all.extend(below());
    all
}

/// The density of visible normals, that of D·cosθh, and half vectors drawn by the latter.
fn visible(r: &Ggx, wi: V, wo: V) -> f64 {
    r.pdf(wi, wo) * 4.0 * wo.dot((wi + wo).normalize())
}

fn by_slopes(alpha: f64, wo: V, u: [f64; 3]) -> Option<V> {
    let tan2 = alpha * alpha * u[0] / (1.0 - u[0]);
    let z = (1.0 + tan2).sqrt().recip();
    let (s, c): (f64, f64) = Real::sin_cos(TAU * u[1]);
    let sin = (1.0 - z * z).max(0.0).sqrt();
    let wi = wo.reflect(V::new(sin * c, sin * s, z));
    (wo.z > 0.0 && wi.z > 0.0).then_some(wi)
}

/// Diffuse and a lobe, half of the draws each.
struct Half {
    /// The share of the lobe that the density has.
    share: f64,
    /// Whether the number that chooses is used again to place the direction.
    reuse: bool,
}

impl Pointwise for Half {
    fn eval(&self, wi: V, wo: V) -> [f64; 3] {
        let (d, s) = (Lambertian(0.5).eval(wi, wo), ggx(0.3).eval(wi, wo));
        [0, 1, 2].map(|k| d[k] + 0.2 * s[k])
    }
    fn pdf(&self, wi: V, wo: V) -> f64 {
        self.share * ggx(0.3).pdf(wi, wo) + (1.0 - self.share) * Lambertian(0.5).pdf(wi, wo)
    }
    fn sample(&self, wo: V, u: [f64; 3]) -> Option<SubjectSample> {
        let chosen = if self.reuse { u[0] } else { u[2] };
        let s = if chosen < 0.5 {
            ggx(0.3).sample(wo, u)?
        } else {
            Lambertian(0.5).sample(wo, u)?
        };
        consistent(self, s.wi, wo)
    }
}

fn density() -> Vec<Specimen> {
    use Property::*;
    vec![
        Specimen::broken(
            "a density 5 % too large",
            PdfIntegral,
            Broken::new(ggx(0.3)).pdf(|r, wi, wo| 1.05 * r.pdf(wi, wo)),
        ),
        Specimen::broken(
            "the density of half vectors: 1/(4 ωo·ωh) forgotten",
            PdfIntegral,
            Broken::new(ggx(0.3)).pdf(|r, wi, wo| {
                if above(wi, wo) {
                    visible(r, wi, wo)
                } else {
                    0.0
                }
            }),
        ),
        Specimen::broken(
            "D cosθh drawn, the density of visible normals given",
            SampleDensity,
            Broken::new(ggx(0.5)).sample(|r, wo, u| consistent(r, by_slopes(0.5, wo, u)?, wo)),
        ),
        Specimen::broken(
            "drawn with α = 0.32, weighed with 0.3",
            SampleDensity,
            Broken::new(ggx(0.3)).sample(|r, wo, u| {
                let s = ggx(0.32).sample(wo, u)?;
                consistent(r, s.wi, wo)
            }),
        ),
        Specimen::broken(
            "wi and wo exchanged in the density",
            SampleDensity,
            Broken::new(ggx(0.3)).pdf(|r, wi, wo| r.pdf(wo, wi)),
        ),
        Specimen::broken(
            "a lobe chosen with 0.5, weighed with 0.6",
            SampleDensity,
            Half {
                share: 0.6,
                reuse: false,
            },
        ),
        Specimen::broken(
            "the number that chose the lobe used again",
            SampleDensity,
            Half {
                share: 0.5,
                reuse: true,
            },
        ),
        Specimen::broken(
            "a lobe cut by the horizon, drawn until it is above, density as before",
            SampleDensity,
            Broken::new(Phong(4.0)).sample(|r, wo, mut u| {
                for _ in 0..16 {
                    if let Some(s) = r.sample(wo, u) {
                        return Some(s);
                    }
                    u = u.map(|u| (u * 7919.0 + 0.123).fract());
                }
                None
            }),
        ),
    ]
}

fn weight() -> Vec<Specimen> {
    use Property::*;
    vec![
        Specimen::broken(
            "weight without its cosine",
            SampleWeight,
            reweighed(|s| 1.0 / s.wi.z.max(1e-9)),
        ),
        Specimen::broken(
            "weight with the cosine twice",
            SampleWeight,
            reweighed(|s| s.wi.z),
        ),
        Specimen::broken(
            "weights cut at 2, against fireflies",
            SampleWeight,
            Broken::new(Lambertian(1.0))
                .eval(|_, wi, wo| ggx(0.3).eval(wi, wo))
                .sample(|_, wo, u| {
                    let s = Lambertian(1.0).sample(wo, u)?;
                    let f = ggx(0.3).eval(s.wi, wo)[0];
                    Some(SubjectSample {
                        weight: [(f * PI).min(2.0); 3],
                        ..s
                    })
                }),
        ),
        Specimen::broken(
            "wi and wo exchanged in the weight of a sample",
            SampleWeight,
            Broken::new(ggx(0.5)).sample(|r, wo, u| {
                let s = r.sample(wo, u)?;
                let f = r.eval(s.wi, wo)[0];
                Some(SubjectSample {
                    weight: [f * wo.z / s.pdf; 3],
                    ..s
                })
            }),
        ),
        Specimen::broken(
            "a diffuse part that is never drawn",
            SampleWeight,
            Broken::new(Phong(50.0))
                .eval(|r, wi, wo| {
                    let d = if above(wi, wo) { 0.2 / PI } else { 0.0 };
                    r.eval(wi, wo).map(|f| 0.5 * f + d)
                })
                .pdf(|r, wi, wo| Some(r.pdf(wi, wo)).filter(|p| *p > 0.05).unwrap_or(0.0))
                .sample(|r, wo, u| {
                    let s = r.sample(wo, u).filter(|s| s.pdf > 0.05)?;
                    let f = 0.5 * r.eval(s.wi, wo)[0] + 0.2 / PI;
                    Some(SubjectSample {
                        weight: [f * s.wi.z / s.pdf; 3],
                        ..s
                    })
                }),
        ),
    ]
}

fn reweighed(factor: impl Fn(&SubjectSample) -> f64 + Send + Sync + 'static) -> Broken<Lambertian> {
    Broken::new(Lambertian(0.4)).sample(move |r, wo, u| {
        let s = r.sample(wo, u)?;
        let factor = factor(&s);
        Some(SubjectSample {
            weight: s.weight.map(|w| w * factor),
            ..s
        })
    })
}

/// Below the horizon, and at the ends of the random numbers.
fn below() -> Vec<Specimen> {
    use Property::*;
    vec![
        Specimen::broken(
            "√(1 − u) with u rounded to 1: NaN",
            Finite,
            Broken::new(Phong(10.0)).sample(|r, wo, u| {
                let mut s = r.sample(wo, u)?;
                if u[0] > 1.0 - 1e-7 {
                    s.weight = [f64::NAN; 3];
                }
                Some(s)
            }),
        ),
        Specimen::broken(
            "draws below the horizon, kept",
            Horizon,
            Broken::new(Phong(8.0)).pdf(whole_lobe).sample(|r, wo, u| {
                let cos: f64 = Real::powf(1.0 - u[0], 1.0 / 9.0);
                let sin = (1.0 - cos * cos).max(0.0).sqrt();
                let (s, c): (f64, f64) = Real::sin_cos(TAU * u[1]);
                let frame = Frame::from_normal(V::new(-wo.x, -wo.y, wo.z));
                let wi = frame.to_world(V::new(sin * c, sin * s, cos));
                let pdf = whole_lobe(r, wi, wo);
                (pdf > 0.0).then(|| SubjectSample {
                    wi,
                    weight: r.eval(wi, wo).map(|f| f * wi.z.abs() / pdf),
                    pdf,
                    delta: false,
                })
            }),
        ),
        Specimen::broken(
            "a density below the horizon that is never drawn",
            Horizon,
            Broken::new(Phong(8.0)).pdf(whole_lobe),
        ),
    ]
}

/// The density of Phong's lobe of exponent 8, whole.
fn whole_lobe(_: &Phong, wi: V, wo: V) -> f64 {
    if wo.z <= 0.0 {
        return 0.0;
    }
    let cos = wi.dot(V::new(-wo.x, -wo.y, wo.z)).clamp(0.0, 1.0);
    9.0 / TAU * Real::powf(cos, 8.0)
}
