//! [`Filter`], the mean of an environment's light under a kernel, for many axes.
//!
//! Axes are taken in blocks. For each block the [`LightTree`] is descended: a cell is taken whole where the kernel hardly bends over
//! it, seen from any axis of the block, else its four parts are looked at. What results is a short list of cells, fine around the
//! lobe and coarse in its tail, which is summed for all axes of the block in lanes. It is a quadrature, not a sample: without noise,
//! positive, exact for uniform light, and the same for any number of threads.
//!
//! Source: the descent is that of Barnes & Hut 1986, "A hierarchical O(N log N) force-calculation algorithm".

use crate::gather::{Axes, Lights, gather};
use crate::kernel::Kernel;
use crate::nodes::LightTree;
use gonio_num::Vec3;
use rayon::prelude::*;

/// Entries of the table of cell sizes, along t = √(chord/2).
const ENTRIES: usize = 512;

/// How coarse the cells may be: the error of a cell relative to the kernel there is about a 24th of its square, of either sign. A
/// narrow lobe meets more cells, whose errors cancel, and is given up to three times as much.
pub const DEFAULT_TOLERANCE: f64 = 0.3;

/// Share of the kernel's mean over the hemisphere that is added to the kernel itself when an error is called small: light that
/// the tail adds is small against the light of the lobe.
const FLOOR: f64 = 0.5;

/// A kernel that is ready to filter.
#[derive(Debug)]
pub struct Filter<'a> {
    tree: &'a LightTree,
    kernel: &'a Kernel,
    /// For ranges of entries of length 2^k, from each entry, the smallest squared edge \[rad²] of a cell that may be taken whole.
    smallest: Vec<Vec<f32>>,
}

impl<'a> Filter<'a> {
    /// `tolerance`: [`DEFAULT_TOLERANCE`], smaller for more exact and slower.
    pub fn new(tree: &'a LightTree, kernel: &'a Kernel, tolerance: f64) -> Self {
        let mean = kernel.mean();
        let narrow = 1.0 / (1.0 + (kernel.width() / 0.1).powi(2));
        let tolerance = tolerance * (1.0 + 2.0 * narrow);
        let chord = |i: f64| 2.0 * (i / ENTRIES as f64).powi(2);
        let finest: Vec<f32> = (0..ENTRIES)
            .map(|i| allowed(kernel, mean, chord(i as f64 + 0.5), tolerance) as f32)
            .collect();
        let mut smallest = vec![finest];
        while (1 << smallest.len()) <= ENTRIES {
            let half = 1 << (smallest.len() - 1);
            let last = &smallest[smallest.len() - 1];
            let next = (0..=ENTRIES - 2 * half)
                .map(|i| last[i].min(last[i + half]))
                .collect();
            smallest.push(next);
        }
        Self {
            tree,
            kernel,
            smallest,
        }
    }

    /// Smallest squared edge allowed where the chord lies between `near` and `far`.
    #[inline(always)]
    fn allowed(&self, near: f32, far: f32) -> f32 {
        let entry = |chord: f32| ((chord.max(0.0) * 0.5).sqrt() * ENTRIES as f32) as usize;
        let (a, b) = (entry(near).min(ENTRIES - 1), entry(far).min(ENTRIES - 1));
        let k = (b - a + 1).ilog2() as usize;
        self.smallest[k][a].min(self.smallest[k][b + 1 - (1 << k)])
    }

    /// The mean radiance under the kernel around each axis (unit, world), in blocks of neighbours: an axis is as fast as the
    /// axes beside it in the list are near.
    pub fn apply(&self, blocks: &[Vec<Vec3<f32>>]) -> Vec<Vec<[f32; 3]>> {
        blocks
            .par_iter()
            .map_init(
                || (Lights::default(), Axes::default(), Vec::new()),
                |(lights, axes, stack), block| self.block(block, lights, axes, stack),
            )
            .collect()
    }

    fn block(
        &self,
        block: &[Vec3<f32>],
        lights: &mut Lights,
        axes: &mut Axes,
        stack: &mut Vec<(u32, u32)>,
    ) -> Vec<[f32; 3]> {
        let zero = Vec3::new(0.0, 0.0, 0.0);
        let sum = block.iter().fold(zero, |s, a| s + *a);
        let centre = if sum.length() > 0.0 {
            sum.normalize()
        } else {
            block[0]
        };
        let radius = block
            .iter()
            .map(|a| (*a - centre).length())
            .fold(0.0, f32::max);
        self.descend(centre, radius, lights, stack);
        axes.set(block);
        gather(self.kernel, lights, axes);
        (0..block.len())
            .map(|i| {
                let [r, g, b, w] = axes.sum(i);
                if w > 0.0 {
                    [r / w, g / w, b / w]
                } else {
                    // No cell has weight: the kernel vanishes in single precision. The sphere's mean is then as good as any.
                    self.tree.mean.map(|c| c as f32)
                }
            })
            .collect()
    }

    /// Lists the cells for axes within `radius` (chord) of `centre`.
    fn descend(
        &self,
        centre: Vec3<f32>,
        radius: f32,
        lights: &mut Lights,
        stack: &mut Vec<(u32, u32)>,
    ) {
        lights.clear();
        stack.clear();
        let top = self.tree.levels.len() - 1;
        stack.extend((0..6).map(|face| (top as u32, face)));
        while let Some((level, index)) = stack.pop() {
            let (level, index) = (level as usize, index as usize);
            let cells = &self.tree.levels[level].cells;
            let area = cells.w[index];
            if area <= 0.0 {
                continue;
            }
            let d = Vec3::new(cells.x[index], cells.y[index], cells.z[index]) - centre;
            let distance = d.length();
            // A cell reaches as far as its diagonal from the light within it.
            let reach = radius + 1.5 * area.sqrt();
            if distance - reach > std::f32::consts::SQRT_2 {
                continue;
            }
            if level == 0 || area <= self.allowed(distance - reach, distance + reach) {
                lights.push_from(cells, index);
                continue;
            }
            let size = self.tree.levels[level].size;
            let (face, rest) = (index / (size * size), index % (size * size));
            let (x, y) = (rest % size, rest / size);
            let first = (face * 2 * size + 2 * y) * 2 * size + 2 * x;
            let below = level as u32 - 1;
            for part in [first, first + 1, first + 2 * size, first + 2 * size + 1] {
                stack.push((below, part as u32));
            }
        }
    }
}

/// Squared edge of a cell that may be taken whole at a chord: the mean over a square of edge s differs from the value at its centre by
/// s²/24 ∇²K, which must be small against K. With q the squared chord, ∇²K = 4 q K″ + 4 K′.
fn allowed(kernel: &Kernel, mean: f64, chord: f64, tolerance: f64) -> f64 {
    let q = (chord * chord).min(2.0);
    // Derivatives by differences over a small part of q, or of the lobe's width where q is smaller still.
    let h = (0.02 * q)
        .max(1e-3 * kernel.width() * kernel.width())
        .min(0.04);
    // Beyond q = 2 the kernel is 0: the differences see the bend at the horizon.
    let (low, high) = ((q - h).max(0.0), q + h);
    let at = 0.5 * (low + high);
    let half = 0.5 * (high - low);
    let (a, m, b) = (kernel.value(low), kernel.value(at), kernel.value(high));
    let first = (b - a) / (2.0 * half);
    let second = (b - 2.0 * m + a) / (half * half);
    let bend = (4.0 * q * second).abs() + (4.0 * first).abs();
    let size = tolerance * tolerance * (m + FLOOR * mean) / bend.max(1e-30);
    size.min(1.0)
}
