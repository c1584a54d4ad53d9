//! Sampling by an alias table over the cells (Walker 1974, Vose 1991): a fixed time for any picture, at the price that neighbours in
//! the unit square are not neighbours on the sphere.

use super::nodes::Nodes;
use gonio_num::Vec3;

/// For each cell the probability of staying there, and where to go otherwise.
#[derive(Debug)]
pub(super) struct Alias {
    entries: Vec<(f32, u32)>,
}

/// Bits of a random number in single precision.
const BITS: u32 = 24;
/// Bits for each coordinate within a cell.
const INSIDE: u32 = 14;

impl Alias {
    pub fn new(nodes: &Nodes) -> Self {
        let count = nodes.width * (nodes.height + 1);
        let masses: Vec<f64> = (0..count)
            .map(|k| nodes.cell_mass(k / nodes.width, k % nodes.width))
            .collect();
        let mean = masses.iter().sum::<f64>() / count as f64;
        let mut left: Vec<f64> = masses.iter().map(|m| m / mean).collect();
        let mut entries: Vec<(f32, u32)> = (0..count).map(|k| (1.0, k as u32)).collect();
        let (mut poor, mut rich): (Vec<usize>, Vec<usize>) =
            (0..count).partition(|&k| left[k] < 1.0);
        while let (Some(small), Some(&large)) = (poor.pop(), rich.last()) {
            entries[small] = (left[small] as f32, large as u32);
            left[large] -= 1.0 - left[small];
            if left[large] < 1.0 {
                rich.pop();
                poor.push(large);
            }
        }
        // What is left over by rounding keeps its cell, unless that is dark.
        for k in poor {
            if masses[k] <= 0.0 {
                let brightest = rich.last().copied().unwrap_or(0);
                entries[k] = (0.0, brightest as u32);
            }
        }
        Self { entries }
    }

    /// A unit direction distributed by the density, from `u` in [0, 1)². Both coordinates go into the choice of the cell, since one
    /// alone has too few digits for a large picture and the place in the cell.
    #[inline]
    pub fn sample(&self, nodes: &Nodes, u: [f32; 2]) -> Vec3<f32> {
        let whole = |u: f32| (f64::from(u) * f64::from(1_u32 << BITS)) as u64;
        let joined = (whole(u[1]) << BITS) | whole(u[0]);
        let position = joined as f64 / (1_u64 << (2 * BITS)) as f64 * self.entries.len() as f64;
        let index = (position as usize).min(self.entries.len() - 1);
        let rest = position - index as f64;
        let (stay, other) = self.entries[index];
        let stay = f64::from(stay);
        let (cell, rest) = if rest < stay {
            (index, rest / stay)
        } else {
            (other as usize, (rest - stay) / (1.0 - stay))
        };
        // One number becomes two: its odd and its even bits.
        let digits = (rest * f64::from(1_u32 << (2 * INSIDE))) as u32;
        let inside = [digits, digits >> 1]
            .map(|d| (f64::from(every_other_bit(d)) + 0.5) / f64::from(1_u32 << INSIDE));
        nodes.sample_cell(cell / nodes.width, cell % nodes.width, inside)
    }
}

/// Bits 0, 2, 4, … of the lowest 28, pushed together.
#[inline(always)]
fn every_other_bit(x: u32) -> u32 {
    let mut x = x & 0x0555_5555;
    x = (x | (x >> 1)) & 0x3333_3333;
    x = (x | (x >> 2)) & 0x0f0f_0f0f;
    x = (x | (x >> 4)) & 0x00ff_00ff;
    (x | (x >> 8)) & 0x0000_ffff
}

#[cfg(test)]
mod tests {
    #[test]
    fn bits_are_pushed_together() {
        for x in [0_u32, 1, 2, 5, 0x0fff_ffff, 0x0123_4567] {
            let expected = (0..14).map(|k| ((x >> (2 * k)) & 1) << k).sum::<u32>();
            assert_eq!(super::every_other_bit(x), expected, "{x:x}");
        }
    }
}
