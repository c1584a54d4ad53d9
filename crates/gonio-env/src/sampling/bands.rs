//! [`Bands`], the marginal of θ: how likely each band is, and what its inversion needs to know.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::nodes::{BAND_NUMBERS, Band, Nodes};
use gonio_num::DoubleLanes;

/// The bands by their running probability.
#[derive(Debug)]
pub(super) struct Bands {
    /// Running probability at the beginning of each band, from 0 on, then 1.
    starts: Vec<f64>,
    /// For each k of 0..=`guides` the band where the running probability reaches k / `guides`: where searches begin and end (Chen and
    /// Asau 1974, "On Generating Random Variates from an Empirical Distribution").
    guide: Vec<u32>,
    guides: usize,
    entries: Vec<Entry>,
    narrow: bool,
}

/// Numbers of a band: where its running probability starts, how far it goes, and those of the inversion.
const NUMBERS: usize = 2 + BAND_NUMBERS;

/// What is known of a band, in two lines of the cache.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Entry([f64; NUMBERS]);

/// Bands that were chosen, one in each lane.
pub(super) struct Chosen<const L: usize> {
    /// 0 to the number of node rows.
    pub band: [u32; L],
    /// The fraction of the band's probability that is left, in [0, 1].
    pub inside: DoubleLanes<L>,
    pub inversion: Band<DoubleLanes<L>>,
}

impl Bands {
    /// - `row_mean`: the mean of each node row over the circle
    pub fn new(nodes: &Nodes, row_mean: &[f64]) -> Self {
        let height = nodes.height;
        let mut starts = vec![0.0];
        let mut sum = 0.0;
        for k in 0..=height {
            let (above, below) = nodes.rows_of(k);
            sum += nodes.band_mass(k, row_mean[above], row_mean[below]);
            starts.push(sum);
        }
        for b in &mut starts {
            *b /= sum;
        }
        let entry = |k: usize| {
            let (above, below) = nodes.rows_of(k);
            let inversion = nodes.band(k, row_mean[above], row_mean[below]).numbers();
            let mut numbers = [0.0; NUMBERS];
            numbers[..2].copy_from_slice(&[starts[k], starts[k + 1] - starts[k]]);
            numbers[2..].copy_from_slice(&inversion);
            Entry(numbers)
        };
        let entries = (0..=height).map(entry).collect();
        let guides = height.clamp(64, 4096);
        let guide = |k: usize| {
            let v = k as f64 / guides as f64;
            (starts.partition_point(|&b| b <= v) - 1).min(height) as u32
        };
        let guide = (0..=guides).map(guide).collect();
        Self {
            starts,
            guide,
            guides,
            entries,
            narrow: nodes.is_narrow(),
        }
    }

    /// The band where the running probability reaches `v` in [0, 1), in every lane.
    #[inline(always)]
    pub fn choose<const L: usize>(&self, v: DoubleLanes<L>) -> Chosen<L> {
        let band = self.search(v);
        // From an array of structures to a structure of arrays.
        let mut entries = [[0.0; NUMBERS]; L];
        for lane in 0..L {
            entries[lane] = self.entries[band[lane] as usize].0;
        }
        let mut numbers = [DoubleLanes([0.0; L]); NUMBERS];
        for k in 0..NUMBERS {
            for lane in 0..L {
                numbers[k].0[lane] = entries[lane][k];
            }
        }
        let [start, extent, inversion @ ..] = numbers;
        Chosen {
            band,
            inside: (v - start) / extent,
            inversion: Band::of(inversion, self.narrow),
        }
    }

    #[inline(always)]
    fn search<const L: usize>(&self, v: DoubleLanes<L>) -> [u32; L] {
        let mut first = [0; L];
        let scaled = v * DoubleLanes::splat(self.guides as f64);
        for lane in 0..L {
            first[lane] = scaled.0[lane] as u32;
        }
        let (mut low, mut length) = ([0; L], [0; L]);
        for lane in 0..L {
            let k = first[lane] as usize;
            low[lane] = self.guide[k];
            length[lane] = self.guide[k + 1] + 1 - low[lane];
        }
        // Halving without branches, all lanes in step.
        while longest(&length) > 1 {
            for lane in 0..L {
                let half = length[lane] / 2;
                let reached = self.starts[(low[lane] + half) as usize] <= v.0[lane];
                low[lane] += if reached { half } else { 0 };
                length[lane] -= half;
            }
        }
        low
    }
}

#[inline(always)]
fn longest<const L: usize>(lengths: &[u32; L]) -> u32 {
    let mut most = 0;
    for lane in 0..L {
        most = most.max(lengths[lane]);
    }
    most
}
