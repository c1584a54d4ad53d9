//! Reflection functions that are right, written as plainly as they can be.

use super::Pointwise;
use crate::SubjectSample;
use crate::directions::{at_height, azimuth};
use gonio_num::{Frame, Real, Vec3};
use std::f64::consts::{PI, TAU};

type V = Vec3<f64>;

/// Whether both directions are above the horizon.
pub fn above(wi: V, wo: V) -> bool {
    wi.z > 0.0 && wo.z > 0.0
}

/// A sample with the weight and density that `r` itself gives.
pub fn consistent(r: &dyn Pointwise, wi: V, wo: V) -> Option<SubjectSample> {
    let pdf = r.pdf(wi, wo);
    (pdf > 0.0).then(|| SubjectSample {
        wi,
        weight: r.eval(wi, wo).map(|f| f * wi.z.abs() / pdf),
        pdf,
        delta: false,
    })
}

/// ρ/π, drawn by the cosine.
pub struct Lambertian(pub f64);

impl Pointwise for Lambertian {
    fn eval(&self, wi: V, wo: V) -> [f64; 3] {
        let f = if above(wi, wo) { self.0 / PI } else { 0.0 };
        [f, 0.5 * f, 0.25 * f]
    }
    fn pdf(&self, wi: V, wo: V) -> f64 {
        if above(wi, wo) { wi.z / PI } else { 0.0 }
    }
    fn sample(&self, wo: V, u: [f64; 3]) -> Option<SubjectSample> {
        let (sin, cos): (f64, f64) = Real::sin_cos(TAU * u[1]);
        let r = u[0].sqrt();
        consistent(self, V::new(r * cos, r * sin, (1.0 - u[0]).sqrt()), wo)
    }
}

/// (p + 2)/(2π) cosᵖ of the angle between wi and the mirrored wo: reciprocal, with albedo 1 at normal incidence and less
/// elsewhere. The lobe is drawn whole; what falls below the horizon is lost.
pub struct Phong(pub f64);

impl Phong {
    fn cos(wi: V, wo: V) -> f64 {
        wi.dot(V::new(-wo.x, -wo.y, wo.z)).clamp(0.0, 1.0)
    }
}

impl Pointwise for Phong {
    fn eval(&self, wi: V, wo: V) -> [f64; 3] {
        if !above(wi, wo) {
            return [0.0; 3];
        }
        [(self.0 + 2.0) / TAU * Real::powf(Self::cos(wi, wo), self.0); 3]
    }
    fn pdf(&self, wi: V, wo: V) -> f64 {
        if !above(wi, wo) {
            return 0.0;
        }
        (self.0 + 1.0) / TAU * Real::powf(Self::cos(wi, wo), self.0)
    }
    fn sample(&self, wo: V, u: [f64; 3]) -> Option<SubjectSample> {
        let cos: f64 = Real::powf(1.0 - u[0], 1.0 / (self.0 + 1.0));
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (s, c): (f64, f64) = Real::sin_cos(TAU * u[1]);
        let frame = Frame::from_normal(V::new(-wo.x, -wo.y, wo.z));
        consistent(self, frame.to_world(V::new(sin * c, sin * s, cos)), wo)
    }
}

/// A white GGX conductor with height-correlated masking, possibly brushed, drawn by its visible normals.
pub struct Ggx {
    /// Slope scales along x and y.
    pub alpha: [f64; 2],
}

impl Ggx {
    fn lambda(&self, w: V) -> f64 {
        let a2 = (self.alpha[0] * w.x).powi(2) + (self.alpha[1] * w.y).powi(2);
        0.5 * ((1.0 + a2 / (w.z * w.z)).sqrt() - 1.0)
    }
    fn d(&self, h: V) -> f64 {
        let [ax, ay] = self.alpha;
        let e = (h.x / ax).powi(2) + (h.y / ay).powi(2) + h.z * h.z;
        1.0 / (PI * ax * ay * e * e)
    }
}

impl Pointwise for Ggx {
    fn eval(&self, wi: V, wo: V) -> [f64; 3] {
        if !above(wi, wo) {
            return [0.0; 3];
        }
        let h = (wi + wo).normalize();
        let g = 1.0 / (1.0 + self.lambda(wi) + self.lambda(wo));
        [self.d(h) * g / (4.0 * wi.z * wo.z); 3]
    }
    fn pdf(&self, wi: V, wo: V) -> f64 {
        if !above(wi, wo) {
            return 0.0;
        }
        // D_v(h) / (4 wo·h) with D_v = D·max(wo·h, 0) / (cosθo (1 + Λ(wo))).
        let h = (wi + wo).normalize();
        self.d(h) / (4.0 * wo.z * (1.0 + self.lambda(wo)))
    }
    fn sample(&self, wo: V, u: [f64; 3]) -> Option<SubjectSample> {
        if wo.z <= 0.0 {
            return None;
        }
        // Dupuy & Benyoub 2023: a uniform point of the spherical cap opposite to the stretched view.
        let [ax, ay] = self.alpha;
        let v = V::new(ax * wo.x, ay * wo.y, wo.z).normalize();
        let z = 1.0 - u[1] * (1.0 + v.z);
        let sin = (1.0 - z * z).max(0.0).sqrt();
        let (s, c): (f64, f64) = Real::sin_cos(TAU * u[0]);
        let n = V::new(sin * c, sin * s, z) + v;
        let h = V::new(ax * n.x, ay * n.y, n.z).normalize();
        let wi = wo.reflect(h);
        if wi.z <= 0.0 || !wi.is_finite() {
            return None;
        }
        consistent(self, wi, wo)
    }
}

/// An ideal diffuser between two media: whatever arrives leaves evenly to all sides, in equilibrium with radiance n².
/// f = n(ωr)²/(π (1 + η²)), drawn by the cosine on the side chosen by its share n²/(1 + η²); that of the mean index.
pub struct Frosted {
    /// Index of refraction below over that above, each channel.
    pub ior: [f64; 3],
    /// Whether the factor n(ωr)² is there.
    pub scaled: bool,
}

impl Frosted {
    fn share_below(&self) -> f64 {
        let n2 = self.ior.iter().map(|n| n * n).sum::<f64>() / 3.0;
        n2 / (1.0 + n2)
    }
}

impl Pointwise for Frosted {
    fn eval(&self, wi: V, wo: V) -> [f64; 3] {
        if wi.z == 0.0 || wo.z == 0.0 {
            return [0.0; 3];
        }
        self.ior.map(|n| {
            let scale = if wo.z < 0.0 && self.scaled {
                n * n
            } else {
                1.0
            };
            scale / (PI * (1.0 + n * n))
        })
    }
    fn pdf(&self, wi: V, wo: V) -> f64 {
        if wo.z == 0.0 {
            return 0.0;
        }
        let below = self.share_below();
        wi.z.abs() / PI * if wi.z < 0.0 { below } else { 1.0 - below }
    }
    fn sample(&self, wo: V, u: [f64; 3]) -> Option<SubjectSample> {
        let mut wi = Lambertian(1.0).sample(V::new(0.0, 0.0, 1.0), u)?.wi;
        if u[2] < self.share_below() {
            wi.z = -wi.z;
        }
        consistent(self, wi, wo)
    }
}

/// A perfect mirror, reflecting the fraction given.
pub struct Mirror(pub f64);

impl Pointwise for Mirror {
    fn eval(&self, _: V, _: V) -> [f64; 3] {
        [0.0; 3]
    }
    fn pdf(&self, _: V, _: V) -> f64 {
        0.0
    }
    fn sample(&self, wo: V, _: [f64; 3]) -> Option<SubjectSample> {
        (wo.z > 0.0).then(|| SubjectSample {
            wi: V::new(-wo.x, -wo.y, wo.z),
            weight: [self.0; 3],
            pdf: 1.0,
            delta: true,
        })
    }
}

/// Half a mirror and half something else, chosen by the third number.
pub struct Varnished<R>(pub R);

impl<R: Pointwise> Pointwise for Varnished<R> {
    fn eval(&self, wi: V, wo: V) -> [f64; 3] {
        self.0.eval(wi, wo).map(|f| 0.5 * f)
    }
    fn pdf(&self, wi: V, wo: V) -> f64 {
        0.5 * self.0.pdf(wi, wo)
    }
    fn sample(&self, wo: V, u: [f64; 3]) -> Option<SubjectSample> {
        if u[2] < 0.5 {
            let s = Mirror(0.5).sample(wo, u)?;
            return Some(SubjectSample {
                weight: [1.0; 3],
                pdf: 0.5,
                ..s
            });
        }
        let s = self.0.sample(wo, u)?;
        Some(SubjectSample {
            pdf: 0.5 * s.pdf,
            ..s
        })
    }
}

/// `f` drawn by the cosine, whatever its shape: right, but with large weights where it is sharp.
pub struct CosineDrawn<R>(pub R);

impl<R: Pointwise> Pointwise for CosineDrawn<R> {
    fn eval(&self, wi: V, wo: V) -> [f64; 3] {
        self.0.eval(wi, wo)
    }
    fn pdf(&self, wi: V, wo: V) -> f64 {
        Lambertian(1.0).pdf(wi, wo)
    }
    fn sample(&self, wo: V, u: [f64; 3]) -> Option<SubjectSample> {
        let s = Lambertian(1.0).sample(wo, u)?;
        consistent(self, s.wi, wo)
    }
}

/// A diffuse base and, drawn with probability `.0` only, a sharp lobe.
pub struct Coated(pub f64, pub Ggx);

impl Pointwise for Coated {
    fn eval(&self, wi: V, wo: V) -> [f64; 3] {
        let (d, s) = (Lambertian(0.7).eval(wi, wo), self.1.eval(wi, wo));
        [0, 1, 2].map(|k| d[k] + 0.04 * s[k])
    }
    fn pdf(&self, wi: V, wo: V) -> f64 {
        (1.0 - self.0) * Lambertian(0.7).pdf(wi, wo) + self.0 * self.1.pdf(wi, wo)
    }
    fn sample(&self, wo: V, u: [f64; 3]) -> Option<SubjectSample> {
        let s = if u[2] < self.0 {
            self.1.sample(wo, u)?
        } else {
            Lambertian(0.7).sample(wo, u)?
        };
        consistent(self, s.wi, wo)
    }
}

/// Cartoon bands of equal height in z and sectors in φi − φo, with a density that is constant on each cell: edges
/// everywhere, in the function and in the density.
pub struct Bands;

impl Bands {
    const DENSITY: [f64; 8] = [0.5, 2.0, 0.0, 1.0, 1.5, 0.25, 2.5, 0.25];

    /// Which of four bands times two halves.
    fn cell(wi: V, wo: V) -> usize {
        let band = ((wi.z * 4.0) as usize).min(3);
        // At normal incidence φo is that of +x.
        let (sin, cos): (f64, f64) = Real::sin_cos(azimuth(wo));
        let turn = wi.x * sin - wi.y * cos;
        2 * band + usize::from(turn > 0.0)
    }
}

impl Pointwise for Bands {
    fn eval(&self, wi: V, wo: V) -> [f64; 3] {
        if !above(wi, wo) {
            return [0.0; 3];
        }
        [0.25 * Self::DENSITY[Self::cell(wi, wo)] / PI; 3]
    }
    fn pdf(&self, wi: V, wo: V) -> f64 {
        if !above(wi, wo) {
            return 0.0;
        }
        Self::DENSITY[Self::cell(wi, wo)] / TAU
    }
    fn sample(&self, wo: V, u: [f64; 3]) -> Option<SubjectSample> {
        let mut rest = u[0] * 8.0;
        let mut cell = 0;
        while rest >= Self::DENSITY[cell] {
            rest -= Self::DENSITY[cell];
            cell += 1;
        }
        let z = 0.25 * ((cell / 2) as f64 + u[1]);
        let azimuth = azimuth(wo) + PI * u[2] * if cell % 2 == 1 { -1.0 } else { 1.0 };
        consistent(self, at_height(z, azimuth), wo)
    }
}
