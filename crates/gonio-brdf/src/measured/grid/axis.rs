//! [`Axis`], one coordinate of a grid: its nodes and what is between and beyond them.

use super::super::search::last_not_above;
use crate::{Index, Number};

/// What an axis is beyond its outermost nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Boundary {
    /// The value of the nearest node.
    Clamped,
    /// Closed on itself, with this period in radians.
    Periodic(f64),
    /// Closed on itself with this period, and the same at x and −x: nodes are in [0, period/2].
    Mirrored(f64),
}

/// In which coordinate values are interpolated linearly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// The angle.
    Linear,
    /// Its square root: the axis of θh in the MERL database, finer near 0. For angles ≥ 0.
    SquareRoot,
}

/// One coordinate of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    nodes: Vec<f64>,
    boundary: Boundary,
    scale: Scale,
    /// The nodes in the scale of interpolation; one more, a period on, if periodic.
    scaled: Vec<f32>,
    /// First node and 1/step in that scale, where all steps are the same.
    uniform: Option<(f64, f64)>,
}

/// Between which nodes a coordinate lies.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Between<R: Number> {
    /// The node below.
    pub low: R::Index,
    /// The node above; the same as `low` on an axis of one node.
    pub high: R::Index,
    /// The weight of the node above, in [0, 1].
    pub t: R,
}

impl Axis {
    /// Nodes in radians, strictly increasing; for `Periodic` within less than a period.
    ///
    /// # Errors
    /// What is wrong with them, in words.
    pub fn new(nodes: Vec<f64>, boundary: Boundary, scale: Scale) -> Result<Self, String> {
        if nodes.is_empty() || nodes.len() >= 1 << 24 {
            return Err(format!("{} nodes", nodes.len()));
        }
        if let Some(k) = nodes.iter().position(|x| !x.is_finite() || x.abs() > 1e3) {
            return Err(format!("node {k} at {}", nodes[k]));
        }
        let scaled_node = |x: f64| match scale {
            Scale::Linear => x,
            Scale::SquareRoot => x.max(0.0).sqrt(),
        };
        let mut scaled: Vec<f64> = nodes.iter().map(|x| scaled_node(*x)).collect();
        let span = nodes[nodes.len() - 1] - nodes[0];
        match boundary {
            Boundary::Clamped => {}
            Boundary::Periodic(period) => {
                if !(period > 0.0 && span < period * (1.0 - 1e-9)) {
                    return Err(format!("nodes over {span} with the period {period}"));
                }
                if scale != Scale::Linear {
                    return Err("a periodic axis that isn't linear".into());
                }
                scaled.push(scaled[0] + period);
            }
            Boundary::Mirrored(period) => {
                if !(period > 0.0 && nodes[0] > -1e-9 && nodes[0] + span < 0.5 * period + 1e-6) {
                    return Err(format!(
                        "nodes from {} to {} where 0 to {} is expected",
                        nodes[0],
                        nodes[0] + span,
                        0.5 * period
                    ));
                }
            }
        }
        let single: Vec<f32> = scaled.iter().map(|x| *x as f32).collect();
        if let Some(k) = single.windows(2).position(|p| p[0] >= p[1]) {
            return Err(format!(
                "{} before {}, where nodes must increase",
                nodes[k],
                nodes.get(k + 1).copied().unwrap_or(nodes[0])
            ));
        }
        let step = (scaled[scaled.len() - 1] - scaled[0]) / (scaled.len() - 1).max(1) as f64;
        let even = scaled
            .iter()
            .enumerate()
            .all(|(k, x)| (x - scaled[0] - k as f64 * step).abs() < 1e-6 * step);
        let uniform = (even && step > 0.0).then(|| (scaled[0], 1.0 / step));
        Ok(Self {
            nodes,
            boundary,
            scale,
            scaled: single,
            uniform,
        })
    }

    /// `n` nodes first, first + step, …
    pub fn regular(first: f64, step: f64, n: usize, boundary: Boundary) -> Result<Self, String> {
        let nodes = (0..n).map(|k| first + k as f64 * step).collect();
        Self::new(nodes, boundary, Scale::Linear)
    }

    /// An axis of one node, on which everything is the same.
    pub fn single() -> Self {
        Self {
            nodes: vec![0.0],
            boundary: Boundary::Clamped,
            scale: Scale::Linear,
            scaled: vec![0.0],
            uniform: None,
        }
    }

    /// Whether it is the same but for rounding, 1e-9 radians.
    pub fn is_like(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        let boundary = match (self.boundary, other.boundary) {
            (Boundary::Periodic(a), Boundary::Periodic(b))
            | (Boundary::Mirrored(a), Boundary::Mirrored(b)) => near(a, b),
            (a, b) => a == b,
        };
        boundary
            && self.scale == other.scale
            && self.len() == other.len()
            && self
                .nodes
                .iter()
                .zip(&other.nodes)
                .all(|(a, b)| near(*a, *b))
    }

    /// The nodes in radians.
    pub fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    /// How many nodes it has.
    #[allow(clippy::len_without_is_empty)] // never empty
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// What is beyond the nodes.
    pub fn boundary(&self) -> Boundary {
        self.boundary
    }

    /// The scale of interpolation.
    pub fn scale(&self) -> Scale {
        self.scale
    }

    /// The nodes around `x`.
    #[inline(always)]
    pub(in super::super) fn around<R: Number>(&self, x: R) -> Between<R> {
        let n = self.nodes.len() as u32;
        let zero = R::Index::splat(0);
        if n == 1 {
            return Between {
                low: zero,
                high: zero,
                t: R::zero(),
            };
        }
        let x = match self.scale {
            Scale::Linear => x,
            Scale::SquareRoot => x.max(R::lit(1e-30)).sqrt(),
        };
        let x = match self.boundary {
            Boundary::Clamped => x,
            Boundary::Periodic(period) => {
                let first = R::lit(f64::from(self.scaled[0]));
                let turns = (x - first) * R::lit(1.0 / period);
                first + (turns - turns.floor()) * R::lit(period)
            }
            Boundary::Mirrored(period) => {
                let turns = x * R::lit(1.0 / period) + R::lit(0.5);
                (turns - turns.floor() - R::lit(0.5)).abs() * R::lit(period)
            }
        };
        // A periodic axis has one interval more, from its last node to its first.
        let intervals = self.scaled.len() as u32 - 1;
        let (low, t) = match self.uniform {
            Some((first, per_step)) => ((x - R::lit(first)) * R::lit(per_step)).cell(intervals + 1),
            None => {
                let low = last_not_above(&self.scaled, zero, intervals, x);
                let [a, b] = R::gather(&self.scaled, low);
                (low, ((x - a) / (b - a)).saturate())
            }
        };
        let next = low.plus(R::Index::splat(1));
        let high = if intervals == n {
            let last = R::from_index(low).ge(R::lit(f64::from(n) - 1.5));
            R::select_index(last, zero, next)
        } else {
            next
        };
        Between { low, high, t }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn at(axis: &Axis, x: f64) -> f64 {
        let b = axis.around(x);
        axis.nodes[b.low as usize] * (1.0 - b.t) + axis.nodes[b.high as usize] * b.t
    }

    #[test]
    fn clamped_axes_keep_their_ends() {
        for nodes in [vec![0.0, 0.5, 1.0, 1.5], vec![0.0, 0.1, 1.0, 1.5]] {
            let axis = Axis::new(nodes, Boundary::Clamped, Scale::Linear).unwrap();
            for k in 0..=30 {
                let x = f64::from(k) * 0.1 - 0.5;
                assert!((at(&axis, x) - x.clamp(0.0, 1.5)).abs() < 1e-6, "{x}");
            }
        }
    }

    #[test]
    fn periodic_axes_close() {
        for nodes in [vec![0.0, 2.0, 4.0], vec![0.0, 1.5, 4.0]] {
            let axis = Axis::new(nodes, Boundary::Periodic(TAU), Scale::Linear).unwrap();
            let b = axis.around(4.0 + 0.25 * (TAU - 4.0) - 3.0 * TAU);
            assert_eq!((b.low, b.high), (2, 0));
            assert!((b.t - 0.25).abs() < 1e-6);
            let b = axis.around(0.0f32);
            assert_eq!((b.low, b.high, b.t), (0, 1, 0.0));
        }
        let shifted = Axis::regular(-3.0, 1.0, 6, Boundary::Periodic(TAU)).unwrap();
        assert!((at(&shifted, TAU - 2.5) + 2.5).abs() < 1e-6);
    }

    #[test]
    fn mirrored_axes_fold() {
        let axis = Axis::regular(0.0, PI / 4.0, 5, Boundary::Mirrored(TAU)).unwrap();
        for x in [0.1, 1.0, 3.0] {
            for same in [x, -x, x + TAU, TAU - x, -x - 2.0 * TAU] {
                assert!((at(&axis, same) - x).abs() < 1e-6, "{same}");
            }
        }
    }

    #[test]
    fn square_roots_are_interpolated() {
        let nodes = vec![0.0, 0.25, 1.0];
        let axis = Axis::new(nodes, Boundary::Clamped, Scale::SquareRoot).unwrap();
        let b = axis.around(0.5625f64);
        assert_eq!((b.low, b.high), (1, 2));
        assert!((b.t - 0.5).abs() < 1e-6);
    }

    #[test]
    fn bad_nodes_are_refused() {
        let new = |nodes: &[f64], boundary| Axis::new(nodes.to_vec(), boundary, Scale::Linear);
        for nodes in [
            &[][..],
            &[1.0, 1.0],
            &[1.0, 0.0],
            &[0.0, f64::NAN],
            &[0.0, 1e9],
        ] {
            assert!(new(nodes, Boundary::Clamped).is_err(), "{nodes:?}");
        }
        assert!(new(&[0.0, TAU], Boundary::Periodic(TAU)).is_err());
        assert!(new(&[0.0, 4.0], Boundary::Mirrored(TAU)).is_err());
        assert!(new(&[-1.0, 1.0], Boundary::Mirrored(TAU)).is_err());
    }
}
