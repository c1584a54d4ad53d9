//! Sampling of environment × reflection × cosine, by resampled importance sampling.
//!
//! Candidates are drawn from the light and from the reflection function, and one of them is kept with a probability in proportion to
//! how much it carries (Talbot, Cline & Egbert 2005, "Importance resampling for global illumination"). With m_L candidates of
//! density p_L and m_R of density p_R, each weighs
//!
//! wᵢ = p̂(ωᵢ) / (m_L p_L(ωᵢ) + m_R p_R(ωᵢ)),  p̂ the luminance of L f |cosθ|,
//!
//! which is the balance heuristic over both strategies, and the kept one estimates ∫ L f |cosθ| V dω by
//!
//! L f |cosθ| V / p̂ · Σ wᵢ.
//!
//! It is unbiased as long as one of the strategies can draw every direction that carries light (Bitterli et al. 2020, §3, with the
//! weights of Veach's balance heuristic for the candidates' mixture): the expectation over the choice is Σ wᵢ/p̂ᵢ · L f |cosθ| V, that of
//! the balance heuristic. One shadow ray serves all candidates.

use crate::Environment;
use gonio_num::Vec3;

/// A direction that the reflection function has drawn, or light has and the reflection function has judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflected {
    /// f·|cosθ| \[sr⁻¹].
    pub f_cos: [f32; 3],
    /// Density with which the reflection function draws the direction \[sr⁻¹].
    pub pdf: f32,
}

/// How many candidates are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Candidates {
    /// From the environment.
    pub light: u32,
    /// From the reflection function.
    pub reflection: u32,
}

impl Default for Candidates {
    /// Four of each.
    fn default() -> Self {
        Self {
            light: 4,
            reflection: 4,
        }
    }
}

/// The candidate that was kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProductSample {
    /// Towards the light; world, unit.
    pub wi: Vec3<f32>,
    /// L f |cosθ| Σw / p̂ \[W m⁻² sr⁻¹]: the reflected radiance that it estimates if nothing stands in its way.
    pub contribution: [f32; 3],
}

impl Environment {
    /// Draws one direction at `p` by the product of light, reflection and cosine. Nothing if no candidate carries light.
    ///
    /// - `judge`: f·|cosθ| and density of the reflection function for a world direction
    /// - `draw`: a direction from the reflection function, from three numbers; nothing where it draws none
    /// - `numbers`: three independent numbers, uniform in \[0, 1), a call
    ///
    /// `judge` and `draw` have to agree on the density; directions that `draw` can't find but `judge` gives light to are the light's
    /// alone, and right all the same. Part of a reflection function that only reflects into single directions has no place here.
    pub fn sample_product(
        &self,
        p: Vec3<f32>,
        candidates: Candidates,
        judge: impl Fn(Vec3<f32>) -> Reflected,
        draw: impl Fn([f32; 3]) -> Option<(Vec3<f32>, Reflected)>,
        mut numbers: impl FnMut() -> [f32; 3],
    ) -> Option<ProductSample> {
        let (of_light, of_reflection) = (candidates.light as f32, candidates.reflection as f32);
        let mut kept: Option<(Vec3<f32>, [f32; 3], f32)> = None;
        let mut sum = 0.0_f32;
        // One number serves all decisions: what is left of it after each is uniform again (reservoir of one).
        let mut decide = numbers()[0];
        let mut consider =
            |wi: Vec3<f32>, radiance: [f32; 3], light_pdf: f32, reflected: Reflected| {
                let density = of_light * light_pdf + of_reflection * reflected.pdf;
                let carried = [0, 1, 2].map(|c| radiance[c] * reflected.f_cos[c]);
                let target = crate::luminance(carried) as f32;
                let weight = target / density;
                // A NaN is no candidate either.
                if !(weight > 0.0 && weight.is_finite()) {
                    return;
                }
                sum += weight;
                let share = weight / sum;
                if decide < share || kept.is_none() {
                    decide = (decide / share).min(ONE_BELOW);
                    kept = Some((wi, carried, target));
                } else {
                    decide = ((decide - share) / (1.0 - share)).min(ONE_BELOW);
                }
            };
        for _ in 0..candidates.light {
            let [u, v, _] = numbers();
            let s = self.sample_from(p, [u, v]);
            if s.pdf > 0.0 {
                consider(s.wi, s.radiance, s.pdf, judge(s.wi));
            }
        }
        for _ in 0..candidates.reflection {
            if let Some((wi, reflected)) = draw(numbers()) {
                let (radiance, light_pdf) = self.radiance_and_pdf_from(p, wi);
                consider(wi, radiance, light_pdf, reflected);
            }
        }
        let (wi, carried, target) = kept?;
        let factor = sum / target;
        Some(ProductSample {
            wi,
            contribution: carried.map(|c| c * factor),
        })
    }
}

/// The largest number below 1.
const ONE_BELOW: f32 = 1.0 - f32::EPSILON / 2.0;
