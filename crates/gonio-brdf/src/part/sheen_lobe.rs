//! The linearly transformed cosine of sheen: what a thin layer of upright fibres reflects.

use super::geometry::{azimuth, turned};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::cosine_hemisphere;
use std::f64::consts::{FRAC_1_PI, TAU};

/// The smallest roughness: smaller ones are taken for this one.
pub const ROUGHNESS_MIN: f64 = 0.01;

/// Reflectance R(μ) of the layer, [0, 0.75]: nearly 0 for a viewer above the fibres, large at grazing angles.
///
/// - `mu`: cosine of the viewer's direction, [0, 1]
/// - `roughness`: [0, 1]
///
/// A Gaussian in μ whose centre, width and floor are rational functions of the roughness.
/// Source: Stephen Hill's fit to the tables of Zeltner et al. 2022, as published in MaterialX 1.39.
#[inline(always)]
pub fn reflectance<R: Real>(mu: R, roughness: R) -> R {
    let l = R::lit;
    let (x, y) = (mu.saturate(), roughness.max(l(ROUGHNESS_MIN)));
    let width = y * (l(0.0206607) + l(1.58491) * y) / (l(0.0379424) + y * (l(1.32227) + y));
    let centre = l(1.7932) - l(0.95943) * y * y;
    let centre = y * (l(-0.193854) + y * (l(-1.14885) + y * centre)) / (l(0.046391) + y);
    let floor = (l(-0.0207818) + l(0.119681) * y) * y;
    let floor = y * (l(0.000654023) + floor) / (l(1.26264) + y * (l(-1.92021) + y));
    let bell = (l(-0.5) * ((x - centre) / width).sq()).exp() / (width * l(TAU.sqrt()));
    // The fit dips to −2e-5.
    (bell + floor).max(R::zero())
}

/// The shape of the reflected light towards one viewer: a density per solid angle, proportional to f cosθi.
///
/// A direction ω has the density cosθ₀/π |M⁻¹|/|M⁻¹ω|³ with ω₀ = M⁻¹ω/|M⁻¹ω|, cosine-distributed, and M⁻¹ = (a 0 b; 0 a 0; 0 0 1) in the
/// frame whose x axis is the viewer's azimuth. Nothing falls below the horizon.
#[derive(Debug, Clone, Copy)]
pub struct SheenLobe<R> {
    azimuth: [R; 2],
    a: R,
    b: R,
}

impl<R: Real> SheenLobe<R> {
    /// For the viewer's direction and a roughness in [0, 1].
    ///
    /// a and b are rational functions. Source: as [`reflectance`].
    #[inline(always)]
    pub fn new(wo: Vec3<R>, roughness: R) -> Self {
        let l = R::lit;
        let (x, y) = (wo.z.saturate(), roughness.max(l(ROUGHNESS_MIN)));
        let a = (l(2.58126) * x + l(0.813703) * y) * y;
        let a = a / (R::one() + l(0.310327) * x * x + l(2.60994) * x * y);
        let below = l(0.0000254053) + l(1.71228) * x - l(1.71506) * x * y + l(1.34174) * y * y;
        let b = (R::one() - x).safe_sqrt() * (y - R::one()) * (y * y * y) / below;
        Self {
            azimuth: azimuth(wo),
            a,
            b,
        }
    }

    /// The density at `wi`, over cosθi: cosθ₀ = cosθi/|M⁻¹ω|, so a²/(π |M⁻¹ω|⁴).
    #[inline(always)]
    pub fn density_over_cos(&self, wi: Vec3<R>) -> R {
        let [cos, sin] = self.azimuth;
        let w = turned(wi, cos, -sin);
        let plain = Vec3::new(self.a * w.x + self.b * w.z, self.a * w.y, w.z);
        let ratio = self.a / plain.length_squared().max(R::lit(1e-18));
        R::lit(FRAC_1_PI) * ratio * ratio
    }

    /// A direction with this density.
    #[inline(always)]
    pub fn sample(&self, u: [R; 2]) -> Vec3<R> {
        let plain = cosine_hemisphere(u);
        let over = self.a.recip();
        let w = Vec3::new((plain.x - self.b * plain.z) * over, plain.y * over, plain.z);
        let [cos, sin] = self.azimuth;
        turned(w.normalize(), cos, sin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_num::Frame;
    use gonio_radiometry::sequence::Rng;
    use gonio_radiometry::warp::around_axis;

    /// The layer that the tables were made from: unit thickness and density, fibres along z with cross section σ = roughness², as an
    /// SGGX microflake medium (Heitz et al. 2015) that mirrors and absorbs nothing. Returns the share of light that leaves upwards and
    /// the mean of its direction (x towards the incident light).
    ///
    /// Projected area √(wᵀSw), S = diag(1, 1, σ²); with A = √S a visible normal is A n, n cosine-distributed around A w.
    fn layer(mu: f64, roughness: f64, walks: u32, name: &str) -> (f64, [f64; 2]) {
        let sigma = roughness * roughness;
        let stretch = |w: Vec3<f64>| Vec3::new(w.x, w.y, sigma * w.z);
        let mut rng = Rng::from_name(name);
        let (mut up, mut mean) = (0.0, [0.0; 2]);
        for _ in 0..walks {
            let mut back = around_axis(0.0, (1.0 - mu * mu).sqrt(), mu); // against the flight
            let mut depth = 0.0;
            for _ in 0..200 {
                let extinction = stretch(back).length();
                let free = -(1.0 - rng.next_f64()).ln() / extinction;
                depth += free * back.z;
                if depth < 0.0 {
                    // The flight goes against `back`.
                    up += 1.0;
                    mean[0] -= back.x;
                    mean[1] -= back.z;
                }
                if !(0.0..=1.0).contains(&depth) {
                    break;
                }
                let around = Frame::from_normal(stretch(back).normalize());
                let n = around.to_world(cosine_hemisphere([rng.next_f64(), rng.next_f64()]));
                back = -back.reflect(stretch(n).normalize());
            }
        }
        (
            up / f64::from(walks),
            [mean[0] / f64::max(up, 1.0), mean[1] / f64::max(up, 1.0)],
        )
    }

    /// The fits against random walks in the layer: reflectance and mean direction. The standard error of 40,000 walks is at most
    /// 2.5e-3 of the reflectance and 4e-3 of the mean; what is allowed beyond four of them is the fit's own error (0.01; 0.025 in
    /// the mean's x and z).
    #[test]
    fn the_fits_are_near_the_fibre_layer() {
        for (mu, roughness) in [
            (0.1, 0.3),
            (0.4, 0.3),
            (0.1, 0.6),
            (0.5, 0.6),
            (0.9, 0.6),
            (0.1, 1.0),
            (0.5, 1.0),
            (1.0, 1.0),
        ] {
            let (share, mean) = layer(mu, roughness, 40_000, &format!("layer {mu} {roughness}"));
            let fit = reflectance(mu, roughness);
            assert!(
                (fit - share).abs() < 0.02,
                "{mu} {roughness}: {fit} {share}"
            );
            let lobe = SheenLobe::new(around_axis(0.0, f64::sqrt(1.0 - mu * mu), mu), roughness);
            let (n, mut moment) = (200, [0.0; 2]);
            for k in 0..n * n {
                let w = lobe.sample([k % n, k / n].map(|i| (f64::from(i) + 0.5) / f64::from(n)));
                moment[0] += w.x / f64::from(n * n);
                moment[1] += w.z / f64::from(n * n);
            }
            for (fit, walked) in moment.into_iter().zip(mean) {
                assert!(
                    (fit - walked).abs() < 0.041,
                    "{mu} {roughness}: {fit} {walked}"
                );
            }
        }
        // The control: another roughness is told apart.
        let (share, _) = layer(0.5, 0.7, 40_000, "layer, control");
        assert!((reflectance(0.5, 0.6) - share).abs() > 0.02, "{share}");
    }

    #[test]
    fn reflectance_is_a_share() {
        for k in 0..=100 {
            for j in 0..=100 {
                let r = reflectance(f64::from(k) / 100.0, f64::from(j) / 100.0);
                assert!((0.0..0.75).contains(&r), "{k} {j}: {r}");
            }
        }
    }
}
