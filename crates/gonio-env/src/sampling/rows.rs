//! Sampling by inversion: the marginal of θ, then the conditional of φ. It keeps stratified points stratified.
//!
//! The running integral of an interpolated row is the interpolation of its neighbours' running integrals, so one such table a node
//! row is all that is stored.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::bands::Bands;
use super::nodes::{Nodes, U_MAX, U_MIN};
use super::turns::{Leaf, Turns};
use gonio_num::lanes::Lanes;
use gonio_num::{DoubleLanes, Real, Vec3};

/// The marginal of θ and the conditionals of φ.
#[derive(Debug)]
pub(super) struct Rows {
    bands: Bands,
    turns: Turns,
}

impl Rows {
    pub fn new(nodes: &Nodes) -> Self {
        let turns = Turns::new(nodes);
        Self {
            bands: Bands::new(nodes, turns.means()),
            turns,
        }
    }

    /// A unit direction distributed by the density, from `u` in [0, 1)².
    ///
    /// u\[1\] chooses θ from the zenith down, u\[0\] the longitude; both maps are continuous but for the turn.
    #[inline]
    pub fn sample(&self, nodes: &Nodes, u: [f32; 2]) -> Vec3<f32> {
        let begun = self.begin::<1>(nodes, u.map(|u| Lanes([u])));
        self.end(nodes, &begun).extract(0)
    }

    /// [`Rows::sample`] in every lane, in two steps: between them [`Rows::touch`] may read what [`Rows::end`] needs, of several.
    #[inline(always)]
    pub fn begin<const L: usize>(&self, nodes: &Nodes, u: [Lanes<L>; 2]) -> Begun<L> {
        let (least, most) = (DoubleLanes::lit(U_MIN), DoubleLanes::lit(U_MAX));
        let chosen = self.bands.choose(u[1].to_double().clamp(least, most));
        let (t, sin_cos) = chosen.inversion.invert(chosen.inside);
        let mut rows = [[0; L]; 2];
        for lane in 0..L {
            rows[0][lane] = chosen.band[lane].max(1) - 1;
            rows[1][lane] = chosen.band[lane].min(nodes.height as u32 - 1);
        }
        let u = u[0].to_double().clamp(least, most);
        let leaf = self.turns.descend(&rows, t, u);
        Begun { sin_cos, leaf }
    }

    /// Reads what [`Rows::end`] needs, so that memory is waited for once.
    #[inline(always)]
    pub fn touch<const L: usize>(&self, begun: &Begun<L>) -> u32 {
        self.turns.touch(&begun.leaf)
    }

    /// The second step: the directions.
    #[inline(always)]
    pub fn end<const L: usize>(&self, nodes: &Nodes, begun: &Begun<L>) -> Vec3<Lanes<L>> {
        let (column, s) = self.turns.end(&begun.leaf);
        nodes.directions(column, s, begun.sin_cos)
    }
}

/// Directions half drawn: θ is known, and where in memory the rest is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Begun<const L: usize> {
    sin_cos: [DoubleLanes<L>; 2],
    leaf: Leaf<L>,
}

impl<const L: usize> Begun<L> {
    /// Room for some.
    pub const NONE: Self = Self {
        sin_cos: [DoubleLanes([0.0; L]); 2],
        leaf: Leaf::NONE,
    };
}
