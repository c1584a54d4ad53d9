//! [`Slices`], the directions of the viewer that tables were measured for, and [`Blend`], the place of a direction among them.

use crate::number::written_out;
use crate::{Index, Number};

/// A grid of directions: each azimuth with each elevation, the elevations of one azimuth side by side. There are at least two
/// elevations.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Slices {
    /// Elevations from the normal, increasing, in radians.
    pub theta: Vec<f32>,
    /// Azimuths, increasing, in radians.
    pub phi: Vec<f32>,
}

impl Slices {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.theta.len() * self.phi.len()
    }

    /// The first slice of each pair of neighbours along θ, azimuth by azimuth.
    pub fn pairs(&self) -> impl Iterator<Item = usize> {
        let thetas = self.theta.len();
        (0..self.count()).filter(move |slice| slice % thetas + 1 < thetas)
    }

    /// Where (θ, φ) lies among them.
    #[inline(always)]
    pub fn around<R: Number>(&self, theta: R, phi: R) -> At<R> {
        let (theta, t) = interval(&self.theta, theta);
        let (phi, p) = match self.phi.len() {
            1 => (R::Index::splat(0), R::zero()),
            _ => interval(&self.phi, phi),
        };
        At {
            theta,
            theta_rest: t,
            phi,
            phi_rest: p,
        }
    }

    /// The slices around a place, and their weights. `C` is 1 where there is one azimuth, otherwise 2.
    #[inline(always)]
    pub fn blend<R: Number, const C: usize>(&self, at: At<R>) -> Blend<R, C> {
        let thetas = self.theta.len() as u32;
        let theta = at.theta;
        let along_theta = [R::one() - at.theta_rest, at.theta_rest];
        let mut blend = Blend {
            slice: [theta; C],
            pair: [theta; C],
            weight: [along_theta; C],
        };
        if C == 2 {
            let along_phi = [R::one() - at.phi_rest, at.phi_rest];
            for c in 0..C {
                let row = at.phi.plus(R::Index::splat(c as u32));
                blend.slice[c] = row.times(thetas).plus(theta);
                blend.pair[c] = row.times(thetas - 1).plus(theta);
                blend.weight[c] = [along_phi[c] * along_theta[0], along_phi[c] * along_theta[1]];
            }
        }
        blend
    }
}

/// A place among slices: the interval of each angle, and how far in it, in [0, 1].
#[derive(Debug, Clone, Copy)]
pub(super) struct At<R: Number> {
    pub theta: R::Index,
    pub theta_rest: R,
    pub phi: R::Index,
    pub phi_rest: R,
}

/// The interval of the increasing `nodes`, at least two, that `x` lies in, and how far in it, limited to [0, 1].
#[inline(always)]
fn interval<R: Number>(nodes: &[f32], x: R) -> (R::Index, R) {
    // x is compared with all: there are few, and so no lane waits for another.
    let mut i = R::Index::splat(0);
    let mut low = R::lit(f64::from(nodes[0]));
    let mut high = R::lit(f64::from(nodes[1]));
    for k in 1..nodes.len() - 1 {
        let node = R::lit(f64::from(nodes[k]));
        let above = node.le(x);
        i = R::select_index(above, R::Index::splat(k as u32), i);
        low = R::select(above, node, low);
        high = R::select(above, R::lit(f64::from(nodes[k + 1])), high);
    }
    (i, ((x - low) / (high - low)).saturate())
}

/// `C` pairs of slices, neighbours along θ, with weights that add up to 1.
///
/// Tables have the numbers of both slices of a pair side by side, and those of one pair in one place: what is looked up together is
/// in few cache lines, and directions near each other use the same part of a table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Blend<R: Number, const C: usize> {
    /// The first slice of each pair.
    pub slice: [R::Index; C],
    /// The number of each pair, as [`Slices::pairs`] counts them.
    pub pair: [R::Index; C],
    /// The weights of each pair.
    pub weight: [[R; 2]; C],
}

impl<R: Number, const C: usize> Blend<R, C> {
    /// The weighted sum of one number of each slice at each of `M` nodes, given by their distances from `node`. `table` has `stride` numbers
    /// for each node of `size` for each pair, beginning with that number of both.
    #[inline(always)]
    pub fn one<const M: usize>(
        &self,
        table: &[f32],
        stride: u32,
        size: u32,
        node: R::Index,
        distances: [u32; M],
    ) -> [R; M] {
        let mut sum = [R::zero(); M];
        for c in 0..C {
            let at = self.pair[c].times(size).plus(node).times(stride);
            let found = R::gather_each(table, at, scaled(distances, stride));
            let [w0, w1] = self.weight[c];
            written_out!(M, m => {
                let [a0, a1] = found[m];
                let a = w0 * a0 + w1 * a1;
                sum[m] = if c == 0 { a } else { sum[m] + a };
            });
        }
        sum
    }

    /// The weighted sums of two numbers of each slice, as [`Blend::one`]: `table` has four for each node of `size` for each pair, two of
    /// the first number and two of the second.
    #[inline(always)]
    pub fn two<const M: usize>(
        &self,
        table: &[f32],
        size: u32,
        node: R::Index,
        distances: [u32; M],
    ) -> [[R; 2]; M] {
        let mut sum = [[R::zero(); 2]; M];
        for c in 0..C {
            let at = self.pair[c].times(size).plus(node).times(4);
            let found = R::gather_each(table, at, scaled(distances, 4));
            let [w0, w1] = self.weight[c];
            written_out!(M, m => {
                let [a0, a1, b0, b1] = found[m];
                let a = w0 * a0 + w1 * a1;
                let b = w0 * b0 + w1 * b1;
                sum[m] = if c == 0 {
                    [a, b]
                } else {
                    [sum[m][0] + a, sum[m][1] + b]
                };
            });
        }
        sum
    }

    /// The weighted sum of one number of each slice at each of `M` nodes and its right neighbour: `table` has two numbers for each node
    /// of `size` for each pair.
    #[inline(always)]
    pub fn neighbours<const M: usize>(
        &self,
        table: &[f32],
        size: u32,
        node: R::Index,
        distances: [u32; M],
    ) -> [[R; 2]; M] {
        let mut sum = [[R::zero(); 2]; M];
        for c in 0..C {
            let at = self.pair[c].times(size).plus(node).times(2);
            let found = R::gather_each(table, at, scaled(distances, 2));
            let [w0, w1] = self.weight[c];
            written_out!(M, m => {
                let [a0, a1, b0, b1] = found[m];
                let a = w0 * a0 + w1 * a1;
                let b = w0 * b0 + w1 * b1;
                sum[m] = if c == 0 {
                    [a, b]
                } else {
                    [sum[m][0] + a, sum[m][1] + b]
                };
            });
        }
        sum
    }

    /// The weighted sums of four numbers of each slice at the corners of a cell: at `node`, its right neighbour, and the same `up` nodes
    /// further. `table` has eight for each node of `size` for each pair, four of the first slice and four of the second.
    #[inline(always)]
    pub fn four(&self, table: &[f32], size: u32, node: R::Index, up: u32) -> [[R; 4]; 4] {
        let mut sum = [[R::zero(); 4]; 4];
        let up = 8 * up;
        for c in 0..C {
            let at = self.pair[c].times(size).plus(node).times(8);
            let places = [0, 4, 8, 12, up, up + 4, up + 8, up + 12];
            let found = R::gather_each(table, at, places);
            let [w0, w1] = self.weight[c];
            written_out!(4, m => {
                let [x0, y0, z0, u0] = found[2 * m];
                let [x1, y1, z1, u1] = found[2 * m + 1];
                let x = w0 * x0 + w1 * x1;
                let y = w0 * y0 + w1 * y1;
                let z = w0 * z0 + w1 * z1;
                let u = w0 * u0 + w1 * u1;
                let s = sum[m];
                sum[m] = if c == 0 {
                    [x, y, z, u]
                } else {
                    [s[0] + x, s[1] + y, s[2] + z, s[3] + u]
                };
            });
        }
        sum
    }

    /// The weighted sum of one number of each slice at each of `M` nodes, as [`Blend::one`]: `table` has one for each slice for each
    /// node.
    #[inline(always)]
    pub fn of_slices<const M: usize>(
        &self,
        table: &[f32],
        slices: u32,
        node: R::Index,
        distances: [u32; M],
    ) -> [R; M] {
        let mut sum = [R::zero(); M];
        for c in 0..C {
            let at = node.times(slices).plus(self.slice[c]);
            let found = R::gather_each(table, at, scaled(distances, slices));
            let [w0, w1] = self.weight[c];
            written_out!(M, m => {
                let [a0, a1] = found[m];
                let a = w0 * a0 + w1 * a1;
                sum[m] = if c == 0 { a } else { sum[m] + a };
            });
        }
        sum
    }
}

#[inline(always)]
fn scaled<const M: usize>(mut distances: [u32; M], by: u32) -> [u32; M] {
    for distance in &mut distances {
        *distance *= by;
    }
    distances
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_lie_between_their_slices() {
        let slices = Slices {
            theta: vec![0.0, 0.5, 1.5],
            phi: vec![-3.0, -1.0, 1.0, 3.0],
        };
        let at = |theta: f64, phi: f64| slices.blend::<f64, 2>(slices.around(theta, phi));
        // θ = 0.75 is a quarter of the way from 0.5 to 1.5, φ = 0 half from −1 to 1.
        let blend = at(0.75, 0.0);
        assert_eq!(blend.slice, [4, 7]);
        assert_eq!(blend.weight, [[0.375, 0.125], [0.375, 0.125]]);
        // Beyond the ends the last slice holds.
        let blend = at(1.6, 3.1);
        assert_eq!(blend.slice, [7, 10]);
        assert_eq!(blend.weight, [[0.0, 0.0], [0.0, 1.0]]);
        let blend = at(0.5, -3.1);
        assert_eq!(
            (blend.slice, blend.weight),
            ([1, 4], [[1.0, 0.0], [0.0, 0.0]])
        );
        let blend = at(f64::NAN, f64::NAN);
        assert_eq!(
            (blend.slice, blend.weight),
            ([0, 3], [[1.0, 0.0], [0.0, 0.0]])
        );
    }

    #[test]
    fn sums_are_weighted() {
        let slices = Slices {
            theta: vec![0.0, 1.0, 2.0],
            phi: vec![0.0],
        };
        assert_eq!(slices.pairs().collect::<Vec<_>>(), [0, 1]);
        let blend = slices.blend::<f64, 1>(slices.around(1.25, 0.0));
        // Pair 1, node 1 of 2.
        let table: Vec<f32> = (0..32).map(|k| k as f32).collect();
        assert_eq!(blend.one(&table, 4, 2, 0, [1, 0]), [12.25, 8.25]);
        assert_eq!(blend.two(&table, 2, 1, [0]), [[12.25, 14.25]]);
        assert_eq!(blend.neighbours(&table, 2, 0, [0]), [[4.25, 6.25]]);
        assert_eq!(blend.of_slices(&table, 3, 0, [1]), [4.25]);
        // Nodes 0, 1, 2 and 3 of pair 1 of 4.
        let table: Vec<f32> = (0..64).map(|k| k as f32).collect();
        let corners = blend.four(&table, 4, 0, 2);
        assert_eq!(corners[0], [33.0, 34.0, 35.0, 36.0]);
        assert_eq!(corners[3], [57.0, 58.0, 59.0, 60.0]);
        let slices = Slices {
            theta: vec![0.0, 1.0, 2.0],
            phi: vec![0.0, 1.0],
        };
        assert_eq!(slices.pairs().collect::<Vec<_>>(), [0, 1, 3, 4]);
        let blend = slices.blend::<f64, 2>(slices.around(1.5, 0.5));
        assert_eq!((blend.slice, blend.pair), ([1, 4], [1, 3]));
    }
}
