//! Adaptive integration over rectangles of the sphere in the coordinates (z, φ), where equal areas are equal solid angles.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A rectangle [low₀, high₀] × [low₁, high₁] of (z, φ).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rect {
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl Rect {
    /// Solid angle in sr.
    pub(crate) fn area(&self) -> f64 {
        (self.high[0] - self.low[0]) * (self.high[1] - self.low[1])
    }

    pub(crate) fn centre(&self) -> [f64; 2] {
        [0, 1].map(|k| 0.5 * (self.low[k] + self.high[k]))
    }

    pub(crate) fn split(&self, axis: usize, at: f64) -> [Self; 2] {
        let (mut a, mut b) = (*self, *self);
        a.high[axis] = at;
        b.low[axis] = at;
        [a, b]
    }
}

/// Integrals of `K` functions over one rectangle, with an estimate of their errors.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Estimate<const K: usize> {
    pub value: [f64; K],
    pub error: [f64; K],
}

impl<const K: usize> Estimate<K> {
    fn zero() -> Self {
        Self {
            value: [0.0; K],
            error: [0.0; K],
        }
    }

    fn add(&mut self, o: &Self) {
        for k in 0..K {
            self.value[k] += o.value[k];
            self.error[k] += o.error[k];
        }
    }

    fn worst_error(&self) -> f64 {
        self.error.iter().fold(0.0, |a: f64, e| a.max(*e))
    }
}

/// The outcome of [`integrate`].
#[derive(Debug, Clone)]
pub(crate) struct Integral<const K: usize> {
    /// One estimate for each rectangle given.
    pub cells: Vec<Estimate<K>>,
    /// Their sum.
    pub total: Estimate<K>,
    pub evaluations: u64,
}

/// How many points the rule asks for.
const POINTS: usize = 17;

/// Genz and Malik's rule of degree 7 with the embedded one of degree 5, in two dimensions: the points at which it wants the
/// functions. The centre, ±λ2 and ±λ4 along each axis, the diagonals at λ4, the corners at λ5.
///
/// Source: Genz & Malik 1980, "Remarks on algorithm 006: an adaptive algorithm for numerical integration over an
/// N-dimensional rectangular region".
fn points(r: &Rect) -> [[f64; 2]; POINTS] {
    const L2: f64 = 0.358_568_582_800_318_1; // √(9/70)
    const L4: f64 = 0.948_683_298_050_513_8; // √(9/10)
    const L5: f64 = 0.688_247_201_611_685_3; // √(9/19)
    const AT: [[f64; 2]; POINTS] = [
        [0.0, 0.0],
        [-L2, 0.0],
        [L2, 0.0],
        [0.0, -L2],
        [0.0, L2],
        [-L4, 0.0],
        [L4, 0.0],
        [0.0, -L4],
        [0.0, L4],
        [-L4, -L4],
        [-L4, L4],
        [L4, -L4],
        [L4, L4],
        [-L5, -L5],
        [-L5, L5],
        [L5, -L5],
        [L5, L5],
    ];
    let c = r.centre();
    let half = [0, 1].map(|k| 0.5 * (r.high[k] - r.low[k]));
    AT.map(|[a, b]| [c[0] + a * half[0], c[1] + b * half[1]])
}

/// The rule's estimate from the values at its [`points`], and the axis along which the fourth difference is larger.
fn genz_malik<const K: usize>(f: &[[f64; K]], r: &Rect) -> (Estimate<K>, usize) {
    const SEVEN: [f64; 5] = [
        -3816.0 / 19683.0,
        980.0 / 6561.0,
        1020.0 / 19683.0,
        200.0 / 19683.0,
        6859.0 / (4.0 * 19683.0),
    ];
    const FIVE: [f64; 4] = [-971.0 / 729.0, 245.0 / 486.0, 65.0 / 1458.0, 25.0 / 729.0];
    let half = [0, 1].map(|k| 0.5 * (r.high[k] - r.low[k]));
    let area = r.area();
    let mut estimate = Estimate::zero();
    let mut fourth = [0.0; 2];
    for k in 0..K {
        let centre = f[0][k];
        let mut sums = [0.0; 2];
        for axis in 0..2 {
            let (n, w) = (
                f[1 + 2 * axis][k] + f[2 + 2 * axis][k],
                f[5 + 2 * axis][k] + f[6 + 2 * axis][k],
            );
            sums[0] += n;
            sums[1] += w;
            // λ2² / λ4² = 1/7.
            let d = (n - 2.0 * centre) - (w - 2.0 * centre) / 7.0;
            fourth[axis] += d.abs();
        }
        let diagonals: f64 = f[9..13].iter().map(|v| v[k]).sum();
        let corners: f64 = f[13..17].iter().map(|v| v[k]).sum();
        let seven = SEVEN[0] * centre
            + SEVEN[1] * sums[0]
            + SEVEN[2] * sums[1]
            + SEVEN[3] * diagonals
            + SEVEN[4] * corners;
        let five = FIVE[0] * centre + FIVE[1] * sums[0] + FIVE[2] * sums[1] + FIVE[3] * diagonals;
        estimate.value[k] = area * seven;
        estimate.error[k] = area * (seven - five).abs();
    }
    let axis = match fourth[0].partial_cmp(&fourth[1]) {
        Some(Ordering::Greater) => 0,
        Some(Ordering::Less) => 1,
        _ => usize::from(half[1] > half[0]),
    };
    (estimate, axis)
}

/// A rectangle with its estimate, where to cut it, and the cell it is a piece of.
#[derive(Clone, Copy)]
struct Whole<const K: usize> {
    rect: Rect,
    estimate: Estimate<K>,
    axis: usize,
    owner: usize,
}

struct Region<const K: usize> {
    whole: Whole<K>,
    priority: f64,
    order: u64,
}

impl<const K: usize> PartialEq for Region<K> {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}
impl<const K: usize> Eq for Region<K> {}
impl<const K: usize> PartialOrd for Region<K> {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl<const K: usize> Ord for Region<K> {
    fn cmp(&self, o: &Self) -> Ordering {
        // The older of equals first, so that the order is always the same.
        self.priority
            .total_cmp(&o.priority)
            .then(o.order.cmp(&self.order))
    }
}

/// The most regions halved at once.
const AT_ONCE: usize = 128;

struct Adaptive<F, const K: usize> {
    f: F,
    heap: BinaryHeap<Region<K>>,
    /// Sum of the priorities in the heap.
    error: f64,
    evaluations: u64,
    made: u64,
}

impl<E, F: FnMut(&[[f64; 2]]) -> Result<Vec<[f64; K]>, E>, const K: usize> Adaptive<F, K> {
    /// The rule on each of `rects`, with values that aren't finite taken as 0.
    fn measure(&mut self, rects: &[Rect]) -> Result<Vec<(Estimate<K>, usize)>, E> {
        let at: Vec<[f64; 2]> = rects.iter().flat_map(points).collect();
        self.evaluations += at.len() as u64;
        let mut values = (self.f)(&at)?;
        for v in values.iter_mut().flatten() {
            *v = if v.is_finite() { *v } else { 0.0 };
        }
        let of_each = values.chunks(POINTS).zip(rects);
        Ok(of_each.map(|(f, rect)| genz_malik(f, rect)).collect())
    }

    /// Replaces regions that aren't in the heap by their halves.
    fn halve(&mut self, regions: &[Whole<K>]) -> Result<(), E> {
        let halves: Vec<Rect> = regions
            .iter()
            .flat_map(|r| r.rect.split(r.axis, r.rect.centre()[r.axis]))
            .collect();
        let results = self.measure(&halves)?;
        for (i, whole) in regions.iter().enumerate() {
            let both = &results[2 * i..2 * i + 2];
            for (rect, (mut estimate, axis)) in halves[2 * i..].iter().zip(both.iter().copied()) {
                for k in 0..K {
                    let sum = both[0].0.value[k] + both[1].0.value[k];
                    let change = 0.125 * (sum - whole.estimate.value[k]).abs();
                    estimate.error[k] = estimate.error[k].max(change);
                }
                let priority = estimate.worst_error();
                self.error += priority;
                self.made += 1;
                self.heap.push(Region {
                    whole: Whole {
                        rect: *rect,
                        estimate,
                        axis,
                        owner: whole.owner,
                    },
                    priority,
                    order: self.made,
                });
            }
        }
        Ok(())
    }

    /// The regions of the largest errors that have to be halved even if the errors of all that are taken fell to nothing; one
    /// at least, and no more than a quarter of all, so that a budget isn't spent far from the worst.
    fn worst(&mut self, tolerance: f64, most: u64) -> Vec<Whole<K>> {
        let most = (self.heap.len() / 4).clamp(1, AT_ONCE).min(most as usize);
        let mut taken = Vec::with_capacity(most);
        while taken.len() < most && (taken.is_empty() || self.error > tolerance) {
            let Some(region) = self.heap.pop() else { break };
            self.error -= region.priority;
            taken.push(region.whole);
        }
        taken
    }
}

/// Integrates `f`, which gives its values at some points at once, over each of `cells`, halving the regions of the largest
/// errors until the sum of the errors is at most `tolerance` or `budget` evaluations are spent. Values that aren't finite
/// count as 0.
///
/// Each cell is halved at least once, and the error of a half is at least an eighth of the change that the halving
/// made: two rules that miss the same feature agree with each other, but seldom with their own refinement.
///
/// # Errors
/// If `f` fails.
pub(crate) fn integrate<E, const K: usize>(
    f: impl FnMut(&[[f64; 2]]) -> Result<Vec<[f64; K]>, E>,
    cells: &[Rect],
    tolerance: f64,
    budget: u64,
) -> Result<Integral<K>, E> {
    const HALVING: u64 = 2 * POINTS as u64;
    let mut work = Adaptive {
        f,
        heap: BinaryHeap::new(),
        error: 0.0,
        evaluations: 0,
        made: 0,
    };
    for (chunk, rects) in cells.chunks(AT_ONCE).enumerate() {
        let measured = work.measure(rects)?;
        let whole: Vec<Whole<K>> = rects
            .iter()
            .zip(measured)
            .enumerate()
            .map(|(i, (rect, (estimate, axis)))| Whole {
                rect: *rect,
                estimate,
                axis,
                owner: chunk * AT_ONCE + i,
            })
            .collect();
        work.halve(&whole)?;
    }
    while work.error > tolerance && work.evaluations + HALVING <= budget {
        let affordable = (budget - work.evaluations) / HALVING;
        let regions = work.worst(tolerance, affordable);
        if regions.is_empty() {
            break;
        }
        work.halve(&regions)?;
    }
    let mut sums = vec![Estimate::zero(); cells.len()];
    // A fixed order of summation, by age.
    let mut regions = work.heap.into_vec();
    regions.sort_by_key(|r| r.order);
    for r in &regions {
        sums[r.whole.owner].add(&r.whole.estimate);
    }
    let mut total = Estimate::zero();
    for s in &sums {
        total.add(s);
    }
    Ok(Integral {
        cells: sums,
        total,
        evaluations: work.evaluations,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_num::Real;

    const SQUARE: Rect = Rect {
        low: [-1.0, 0.0],
        high: [1.0, 3.0],
    };

    fn integrated(
        f: impl Fn([f64; 2]) -> [f64; 1],
        cells: &[Rect],
        tolerance: f64,
        budget: u64,
    ) -> Integral<1> {
        let f = |at: &[[f64; 2]]| Ok(at.iter().map(|x| f(*x)).collect());
        let Ok(integral) = integrate::<std::convert::Infallible, 1>(f, cells, tolerance, budget);
        integral
    }

    #[test]
    fn the_rule_is_exact_to_degree_seven() {
        // ∫∫ z^a φ^b over [−1, 1] × [0, 3].
        for a in 0..=7u32 {
            for b in 0..=7 - a {
                let f = |[z, p]: [f64; 2]| [z.powi(a as i32) * p.powi(b as i32)];
                let (e, _) = genz_malik(&points(&SQUARE).map(f), &SQUARE);
                let iz = if a % 2 == 1 {
                    0.0
                } else {
                    2.0 / f64::from(a + 1)
                };
                let ip = 3f64.powi(b as i32 + 1) / f64::from(b + 1);
                // Seventeen terms of size up to 3^8.
                assert!((e.value[0] - iz * ip).abs() < 1e-10, "{a} {b}: {e:?}");
                if a + b <= 5 {
                    assert!(e.error[0] < 1e-10);
                }
            }
        }
        let (e, axis) = genz_malik(&points(&SQUARE).map(|[z, _]| [z.powi(8)]), &SQUARE);
        assert!(e.error[0] > 1e-3 && axis == 0, "the test can fail");
    }

    #[test]
    fn a_sharp_bump_is_found_and_its_error_covers() {
        // A Gaussian of width 0.01: 2π·1e-4 but for e^−1800 outside.
        let bump = |[z, p]: [f64; 2]| {
            let r2 = (z - 0.21).powi(2) + (p - 1.3).powi(2);
            [Real::exp(-r2 / 2e-4)]
        };
        let mut cells = vec![SQUARE];
        for _ in 0..8 {
            cells = cells
                .iter()
                .flat_map(|c| {
                    let axis = usize::from(c.high[1] - c.low[1] > c.high[0] - c.low[0]);
                    c.split(axis, c.centre()[axis])
                })
                .collect();
        }
        let i = integrated(bump, &cells, 1e-9, 100_000);
        let truth = std::f64::consts::TAU * 1e-4;
        assert!((i.total.value[0] - truth).abs() <= i.total.error[0].max(1e-15));
        assert!(i.total.error[0] <= 1e-9);
        assert_eq!(i.cells.len(), 256);
    }

    #[test]
    fn an_edge_is_covered_by_its_error() {
        let disk = |[z, p]: [f64; 2]| [f64::from(z * z + (p - 1.5).powi(2) < 0.81)];
        let i = integrated(disk, &[SQUARE], 1e-3, 200_000);
        let d = (i.total.value[0] - std::f64::consts::PI * 0.81).abs();
        assert!(d <= i.total.error[0] && d < 2e-3, "{d} {:?}", i.total);
    }

    #[test]
    fn what_is_not_finite_counts_as_nothing() {
        let f = |[z, _]: [f64; 2]| [if z > 0.0 { f64::NAN } else { 1.0 }];
        let [a, b] = SQUARE.split(0, 0.0);
        let i = integrated(f, &[a, b], 1e-9, 10_000);
        assert!((i.total.value[0] - 3.0).abs() < 1e-12);
    }
}
