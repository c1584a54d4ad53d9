//! [`SphereTable`], sampling of a picture's light, and the choices there are: how a cell is found ([`SamplingMethod`]) and what is
//! weighed in ([`Guide`]).

mod alias;
mod bands;
mod nodes;
mod rows;
mod tree;
mod turns;

use crate::lookup::Taps;
use alias::Alias;
use gonio_num::lanes::Lanes;
use gonio_num::{Real, Vec3};
use nodes::Nodes;
pub(crate) use rows::Begun;
use rows::Rows;
use std::f64::consts::PI;
use std::sync::OnceLock;
use tree::Tree;

/// How a panorama is sampled. The density is the same for all: the luminance of the interpolated picture, exactly.
///
/// | | time | stratified points | memory a texel |
/// |---|---|---|---|
/// | `Inversion` | a search in two rows | stay stratified, rows and columns | 14 bytes |
/// | `Hierarchical` | one step a doubling of the picture | stay near each other | 9 bytes |
/// | `Alias` | fixed | are torn apart | 12 bytes |
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SamplingMethod {
    /// The marginal of θ, then the conditional of φ, both inverted exactly.
    #[default]
    Inversion,
    /// A quad-tree that warps the unit square (Clarberg et al. 2005).
    Hierarchical,
    /// An alias table over the cells (Walker 1974, Vose 1991).
    Alias,
}

/// What directions are drawn by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Guide {
    /// Luminance: for any use.
    Luminance,
    /// Luminance above its mean, max(0, L − L̄): only together with a second strategy that finds the rest, by multiple importance
    /// sampling (Karlík et al. 2019, "MIS compensation", eq. 15 with as many samples of either). Has no density where the picture is
    /// darker than its mean. The same as `Luminance` for a uniform environment, a sky, and a picture of even luminance.
    Compensated,
    /// Luminance times the cosine with this unit normal (world), bounded over patches of about 3°: for a surface that light reaches
    /// from one side. Has no density below the horizon. The same as `Luminance` for a sky and in a [`Proxy`](crate::Proxy), whose
    /// light comes from elsewhere.
    Cosine(Vec3<f32>),
}

/// A density over the sphere, with its sampling.
#[derive(Debug)]
pub(crate) struct SphereTable {
    nodes: Nodes,
    form: Form,
    /// For normals: made when first asked for.
    tree: OnceLock<Tree>,
}

#[derive(Debug)]
enum Form {
    Inversion(Rows),
    Hierarchical,
    Alias(Alias),
}

impl SphereTable {
    /// A table of `width` × `height` node values, each finite and ≥ 0. `None` if all are 0.
    pub fn new(width: usize, height: usize, values: Vec<f32>) -> Option<Self> {
        Self::with_method(width, height, values, SamplingMethod::Inversion)
    }

    /// As [`SphereTable::new`], for a method.
    pub fn with_method(
        width: usize,
        height: usize,
        values: Vec<f32>,
        method: SamplingMethod,
    ) -> Option<Self> {
        let nodes = Nodes::new(width, height, values)?;
        Some(Self {
            form: match method {
                SamplingMethod::Inversion => Form::Inversion(Rows::new(&nodes)),
                SamplingMethod::Hierarchical => Form::Hierarchical,
                SamplingMethod::Alias => Form::Alias(Alias::new(&nodes)),
            },
            nodes,
            tree: OnceLock::new(),
        })
    }

    /// The table of what exceeds the mean; `None` if nothing does.
    pub fn compensated(&self, method: SamplingMethod) -> Option<Self> {
        let nodes = &self.nodes;
        // The mean value: the density is the value times the scale, and integrates to 1.
        let mean = nodes.mean() as f32;
        // Rounding of an even picture is no light.
        let least = 1e-5 * mean;
        let above = |v: &f32| Some(v - mean).filter(|rest| *rest > least).unwrap_or(0.0);
        let values = nodes.values.iter().map(above).collect();
        Self::with_method(nodes.width, nodes.height, values, method)
    }

    /// A unit direction distributed by the density, from `u` in [0, 1)².
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Vec3<f32> {
        match &self.form {
            Form::Inversion(rows) => rows.sample(&self.nodes, u),
            Form::Alias(alias) => alias.sample(&self.nodes, u),
            Form::Hierarchical => self
                .tree()
                .sample(&self.nodes, u, None)
                .unwrap_or_else(|| uniform_direction(u)),
        }
    }

    /// [`SphereTable::sample`] in lanes, if it inverts.
    pub fn inversion(&self) -> Option<Inversion<'_>> {
        match &self.form {
            Form::Inversion(rows) => Some(Inversion {
                nodes: &self.nodes,
                rows,
            }),
            Form::Hierarchical | Form::Alias(_) => None,
        }
    }

    /// Density over the value relative to the largest.
    pub fn scale(&self) -> f64 {
        self.nodes.scale
    }

    /// Density per steradian at the lat-long coordinates `uv`.
    #[inline(always)]
    pub fn density(&self, uv: [f32; 2]) -> f32 {
        self.nodes.density(uv)
    }

    /// Columns and rows of the grid that the density stands on.
    pub fn size(&self) -> [usize; 2] {
        [self.nodes.width, self.nodes.height]
    }

    /// [`SphereTable::density`] in every lane, at lat-long taps of a grid of this [`SphereTable::size`].
    #[inline(always)]
    pub fn densities<const L: usize>(&self, taps: &Taps<L>) -> Lanes<L> {
        self.nodes.densities(taps)
    }

    /// As [`SphereTable::sample`], weighed by the cosine with a normal. Nothing where no light is above the horizon.
    #[inline]
    pub fn sample_about(&self, u: [f32; 2], normal: Vec3<f32>) -> Option<Vec3<f32>> {
        self.tree().sample(&self.nodes, u, Some(normal))
    }

    /// Density per steradian of [`SphereTable::sample_about`] at the lat-long coordinates `uv`.
    #[inline]
    pub fn density_about(&self, uv: [f32; 2], normal: Vec3<f32>) -> f32 {
        self.density(uv) * self.tree().factor(self.nodes.cell_of(uv), normal)
    }

    #[inline(always)]
    fn tree(&self) -> &Tree {
        self.tree.get_or_init(|| Tree::new(&self.nodes))
    }
}

/// Sampling by inversion, in lanes. It comes in two steps, so that [`Inversion::touch`] can read from memory what the second needs, of
/// many points at once.
#[derive(Clone, Copy)]
pub(crate) struct Inversion<'a> {
    nodes: &'a Nodes,
    rows: &'a Rows,
}

impl Inversion<'_> {
    /// The first step, from `u` in [0, 1)².
    #[inline(always)]
    pub fn begin<const L: usize>(self, u: [Lanes<L>; 2]) -> Begun<L> {
        self.rows.begin(self.nodes, u)
    }

    /// Reads what the second step needs; of no other use.
    #[inline(always)]
    pub fn touch<const L: usize>(self, begun: &Begun<L>) -> u32 {
        self.rows.touch(begun)
    }

    /// The second step: a unit direction.
    #[inline(always)]
    pub fn end<const L: usize>(self, begun: &Begun<L>) -> Vec3<Lanes<L>> {
        self.rows.end(self.nodes, begun)
    }
}

/// A unit direction of the uniform density 1 / 4π, from `u` in [0, 1)².
#[inline]
pub(crate) fn uniform_direction(u: [f32; 2]) -> Vec3<f32> {
    let y = 1.0 - 2.0 * u[1];
    // 1 − y² = 4u(1 − u), without cancellation at the zenith.
    let r = (4.0 * u[1] * (1.0 - u[1])).max(0.0).sqrt();
    let (sin, cos) = Real::sin_cos(std::f32::consts::TAU * (u[0] - 0.5));
    Vec3::new(r * sin, y, -r * cos)
}

/// The uniform density over the sphere \[sr⁻¹].
pub(crate) const UNIFORM_DENSITY: f32 = (0.25 / PI) as f32;

#[cfg(test)]
mod tests;
