//! Tables of how much a rough surface reflects: the second factor of the split sum.
//!
//! With Schlick's F = F₀ + (1 − F₀) Fc, Fc = (1 − cosθ′)⁵, the directional albedo is linear in F₀:
//!
//! ```text
//! E(μ, roughness) = ∫ f cosθ dω = F₀ (whole − bias) + bias,    whole = ∫ f₁ cosθ dω,   bias = ∫ f₁ Fc cosθ dω
//! ```
//!
//! f₁ the model with F = 1. Source: Karis 2013, "Real Shading in Unreal Engine 4"; the multiple-scattering form (bias, whole):
//! Fdez-Agüera 2019, "A Multiple-Scattering Microfacet Model for Real-Time Image Based Lighting", and Filament.

use crate::IblError;
use gonio_brdf::part::distribution::{Distribution, Shape};
use gonio_brdf::part::geometry::Half;
use gonio_brdf::part::masking::{Masking, smith_g1_over_cos, visibility};
use gonio_brdf::{Brdf, Model, ModelSpec, Value};
use gonio_num::dispatch::{Kernel, dispatch};
use gonio_num::lanes::Lanes;
use gonio_num::{Real, Vec3};
use rayon::prelude::*;

/// A table over cosine and roughness.
#[derive(Debug, Clone, PartialEq)]
pub struct Dfg {
    /// Columns, by μ = n·v: (x + ½)/width unless they were given.
    pub width: usize,
    /// Rows, by perceptual roughness: (y + ½)/height unless they were given.
    pub height: usize,
    /// (bias, whole) of each entry, row after row from roughness 0.
    pub values: Vec<[f32; 2]>,
}

/// Columns or rows at most.
const MOST: usize = 4096;

/// Quadrature in the sampler's numbers: steps along the first, which turns around, and midpoints along the second, crowded at both
/// ends. Rules of higher order lose: where the mirrored direction is on the horizon the integrand has an edge, nearly along a ring.
const RINGS: usize = 64;
const TURNS: usize = 12;

impl Dfg {
    /// The table of a microfacet model, `model` naming it without roughness and reflectance: `ggx`, `beckmann`,
    /// `torrance-sparrow:distribution=gtr,gamma=1.8,masking=smith`, `sheen-charlie`.
    ///
    /// For a model with Fresnel reflectance both columns have meaning; for sheen, which has none, `whole` is its albedo.
    ///
    /// # Errors
    /// [`IblError::Model`] for a model without the parameter `roughness`; sizes that are 0 or above 4096.
    pub fn new(model: &str, width: usize, height: usize) -> Result<Self, IblError> {
        let middles = |n: usize| -> Vec<f64> {
            // As many as are refused, but no more memory than that.
            let n = n.min(MOST + 1);
            (0..n).map(|x| (x as f64 + 0.5) / n as f64).collect()
        };
        Self::at(model, &middles(width), &middles(height))
    }

    /// The table whose columns are at these cosines and whose rows are at these perceptual roughnesses, each in (0, 1].
    ///
    /// # Errors
    /// As [`Dfg::new`].
    pub fn at(model: &str, cosines: &[f64], roughnesses: &[f64]) -> Result<Self, IblError> {
        let (width, height) = (cosines.len(), roughnesses.len());
        for (name, n) in [("table width", width), ("table height", height)] {
            if !(1..=MOST).contains(&n) {
                return Err(IblError::parameter(
                    name,
                    n,
                    "a whole number from 1 to 4096",
                ));
            }
        }
        for (name, numbers) in [("cosine", cosines), ("roughness", roughnesses)] {
            if let Some(bad) = numbers.iter().find(|c| !(**c > 0.0 && **c <= 1.0)) {
                return Err(IblError::parameter(name, bad, "a number in (0, 1]"));
            }
        }
        let base = ModelSpec::parse(model)?;
        let names: Vec<&str> = base.parameters()?.iter().map(|p| p.name).collect();
        if !names.contains(&"roughness") {
            return Err(IblError::Model {
                model: model.to_owned(),
                reason: "no parameter `roughness` to make a table over".to_owned(),
            });
        }
        let rows: Result<Vec<Vec<[f32; 2]>>, IblError> = roughnesses
            .par_iter()
            .map(|&roughness| {
                let mut spec = base.clone();
                spec.set_text("roughness", &roughness.to_string())?;
                let own = |key: &str| base.values.contains_key(key);
                if names.contains(&"f0") && !own("f0") && !own("fresnel") {
                    spec.set_text("f0", "1")?;
                }
                if names.contains(&"interreflection") && !own("interreflection") {
                    spec.set_text("interreflection", "none")?;
                }
                Ok(match facets(&base) {
                    Some(masking) => ggx_row(roughness, masking, cosines),
                    None => row(&spec.build()?, cosines),
                })
            })
            .collect();
        Ok(Self {
            width,
            height,
            values: rows?.into_iter().flatten().collect(),
        })
    }

    /// (bias, whole) at column x, row y.
    ///
    /// # Panics
    /// Outside the table.
    pub fn get(&self, x: usize, y: usize) -> [f32; 2] {
        assert!(x < self.width && y < self.height, "entry outside the table");
        self.values[y * self.width + x]
    }
}

/// The nodes: three numbers in [0, 1)³ for the sampler, and weights whose sum is 1.
fn nodes() -> Vec<([f64; 3], f64)> {
    let mut nodes = Vec::with_capacity(RINGS * TURNS);
    for ring in 0..RINGS {
        // s ↦ s² (3 − 2s) crowds rings at both ends, where a sampler's map has its steep places.
        let s = (ring as f64 + 0.5) / RINGS as f64;
        // Each ring is turned against the last, so that an edge does not meet all of them alike.
        let shift = (ring as f64 * 0.618_033_988_749_894_9).fract();
        for k in 0..TURNS {
            let turn = (k as f64 + shift) / TURNS as f64;
            // The number that chooses a part takes each of eight strata in turn.
            let part = ((nodes.len() * 5) % 8) as f64 / 8.0 + 0.0625;
            let u = [turn, s * s * (3.0 - 2.0 * s), part];
            nodes.push((u, 6.0 * s * (1.0 - s) / (RINGS * TURNS) as f64));
        }
    }
    // The midpoint rule of 6 s (1 − s) misses 1 by 1/2n².
    let sum: f64 = nodes.iter().map(|n| n.1).sum();
    for n in &mut nodes {
        n.1 /= sum;
    }
    nodes
}

/// The masking, if the description is of GGX facets and says nothing else: such tables are made in lanes.
fn facets(spec: &ModelSpec) -> Option<Masking> {
    let only = |key: &String| key == "distribution" || key == "masking";
    if spec.name != "torrance-sparrow" || !spec.values.keys().all(only) {
        return None;
    }
    let word = |key: &str| match spec.value(key) {
        Some(Value::Choice(word)) => Some(word),
        _ => None,
    };
    if Shape::from_name(&word("distribution")?)? != Shape::Ggx {
        return None;
    }
    Masking::from_name(&word("masking")?)
}

fn ggx_row(roughness: f64, masking: Masking, cosines: &[f64]) -> Vec<[f32; 2]> {
    let mu: Vec<f32> = cosines.iter().map(|c| *c as f32).collect();
    let mut found = vec![[0.0; 2]; mu.len()];
    dispatch(GgxRow {
        alpha: roughness * roughness,
        masking,
        nodes: &nodes(),
        mu: &mu,
        found: &mut found,
    });
    found
}

/// [`row`] of GGX facets, lanes over cosines.
struct GgxRow<'a> {
    alpha: f64,
    masking: Masking,
    nodes: &'a [([f64; 3], f64)],
    mu: &'a [f32],
    found: &'a mut [[f32; 2]],
}

impl Kernel for GgxRow<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const N: usize>(self) {
        let d = Distribution::isotropic(Shape::Ggx, Lanes::<N>::lit(self.alpha.max(1e-6)));
        let mut at = 0;
        while at < self.mu.len() {
            let mu = Lanes::<N>::load_or(&self.mu[at..], 1.0);
            let sin = (Lanes::splat(1.0) - mu * mu).safe_sqrt();
            let wo = Vec3::new(sin, Lanes::splat(0.0), mu);
            let over = Lanes::splat(4.0) / smith_g1_over_cos(&d, wo);
            let (mut bias, mut whole) = (Lanes::<N>::splat(0.0), Lanes::<N>::splat(0.0));
            for (u, w) in self.nodes {
                let h = d.sample_visible_ggx(wo, Lanes::lit(u[0]), Lanes::lit(u[1]));
                let cos = wo.dot(h);
                let wi = wo.reflect(h);
                // f cosθi over the density D G₁(ωr)/(4 cosθr) of ωi.
                let v = visibility(self.masking, &d, wi, wo, &Half::of(h, cos));
                let above = wi.z.gt(Lanes::splat(0.0)) & cos.gt(Lanes::splat(0.0));
                let f = Lanes::select(above, Lanes::lit(*w) * v * wi.z * over, Lanes::splat(0.0));
                whole = whole + f;
                bias = bias + f * (Lanes::splat(1.0) - cos.saturate()).pow5();
            }
            for lane in 0..N.min(self.mu.len() - at) {
                self.found[at + lane] = [bias.0[lane], whole.0[lane]];
            }
            at += N;
        }
    }
}

fn row(model: &Model<f64, 3>, cosines: &[f64]) -> Vec<[f32; 2]> {
    let nodes = nodes();
    cosines
        .iter()
        .map(|&mu| {
            let wo = Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
            let (mut bias, mut whole) = (0.0, 0.0);
            for (u, w) in &nodes {
                let s = model.sample(wo, *u);
                let f = w * s.weight[0];
                // cos²θ′ = (1 + ωi·ωr)/2.
                let facet = (0.5 * (1.0 + s.wi.dot(wo))).clamp(0.0, 1.0).sqrt();
                whole += f;
                bias += f * (1.0 - facet).powi(5);
            }
            [bias as f32, whole as f32]
        })
        .collect()
}
