//! Adaptive integration in two dimensions: the box with the largest error is halved until the error is small enough.
//!
//! Each box is integrated by the rules of degree 7 and 5 of Genz and Malik, 17 evaluations; their difference estimates the
//! error, and fourth differences choose the side to halve. Source: Genz and Malik 1980, "An Adaptive Algorithm for
//! Numerical Integration over an N-dimensional Rectangular Region".

use gonio_num::{Real, Vec3};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::TAU;

/// When an adaptive integral stops: as soon as every component's error is at most max(`absolute`, `relative` · |value|).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Absolute error, in the integral's unit.
    pub absolute: f64,
    /// Error relative to the value.
    pub relative: f64,
    /// Evaluations at most; the integral then comes back with `converged` false.
    pub max_evaluations: usize,
}

impl Default for Tolerance {
    /// 1e-10 absolute and relative, a million evaluations.
    fn default() -> Self {
        Self {
            absolute: 1e-10,
            relative: 1e-10,
            max_evaluations: 1_000_000,
        }
    }
}

/// An integral with an estimate of its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integral<const N: usize> {
    /// The value of each component; NaN if the integrand gave a NaN.
    pub value: [f64; N],
    /// An estimate of |value − exact|, far too large for smooth integrands as a rule: it is the error of degree 5, while the
    /// value is of degree 7. Not a bound: a feature that no evaluation hits isn't seen.
    pub error: [f64; N],
    /// Evaluations of the integrand.
    pub evaluations: usize,
    /// Whether the tolerance was met.
    pub converged: bool,
}

/// ∫ f over the box from `low` to `high`, by area.
pub fn rectangle<const N: usize>(
    low: [f64; 2],
    high: [f64; 2],
    tolerance: &Tolerance,
    f: impl FnMut([f64; 2]) -> [f64; N],
) -> Integral<N> {
    integrate(low, high, [1, 1], tolerance, f)
}

/// ∫ f(ω) dω over the hemisphere z ≥ 0. The cosine isn't included.
///
/// ```
/// use gonio_radiometry::quadrature::{Tolerance, adaptive};
/// let lobe = adaptive::hemisphere(&Tolerance::default(), |w| [w.z.powi(100)]);
/// assert!((lobe.value[0] - 2.0 * std::f64::consts::PI / 101.0).abs() < 1e-9);
/// ```
pub fn hemisphere<const N: usize>(
    tolerance: &Tolerance,
    f: impl FnMut(Vec3<f64>) -> [f64; N],
) -> Integral<N> {
    zone(0.0, 1.0, tolerance, f)
}

/// ∫ f(ω) dω over the whole sphere.
pub fn sphere<const N: usize>(
    tolerance: &Tolerance,
    f: impl FnMut(Vec3<f64>) -> [f64; N],
) -> Integral<N> {
    zone(-1.0, 1.0, tolerance, f)
}

/// ∫ f(ω) dω over the zone `z_min` ≤ cosθ ≤ `z_max`, both in [−1, 1].
pub fn zone<const N: usize>(
    z_min: f64,
    z_max: f64,
    tolerance: &Tolerance,
    mut f: impl FnMut(Vec3<f64>) -> [f64; N],
) -> Integral<N> {
    // Boxes as wide as high to begin with, so that no periodic integrand looks constant.
    integrate([z_min, 0.0], [z_max, TAU], [2, 6], tolerance, |[z, phi]| {
        let across = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
        f(Vec3::new(
            across * Real::cos(phi),
            across * Real::sin(phi),
            z,
        ))
    })
}

fn integrate<const N: usize>(
    low: [f64; 2],
    high: [f64; 2],
    parts: [usize; 2],
    tolerance: &Tolerance,
    mut f: impl FnMut([f64; 2]) -> [f64; N],
) -> Integral<N> {
    let mut heap = BinaryHeap::new();
    let mut order = 0;
    let half = [0, 1].map(|k| 0.5 * (high[k] - low[k]) / parts[k] as f64);
    for i in 0..parts[0] {
        for j in 0..parts[1] {
            let centre = [
                low[0] + half[0] * (2 * i + 1) as f64,
                low[1] + half[1] * (2 * j + 1) as f64,
            ];
            heap.push(Cell::new(centre, half, order, &mut f));
            order += 1;
        }
    }
    loop {
        let evaluations = order * POINTS;
        // The worst quarter of the boxes is halved between sums, so that summing anew costs little; a running sum would
        // gather rounding errors.
        let integral = total(&heap, evaluations, tolerance);
        let finite = integral.error.iter().all(|e| e.is_finite());
        if integral.converged || !finite || evaluations + 2 * POINTS > tolerance.max_evaluations {
            return integral;
        }
        for _ in 0..heap.len().div_ceil(4) {
            if order * POINTS + 2 * POINTS > tolerance.max_evaluations {
                break;
            }
            let Some(worst) = heap.pop() else { break };
            for side in [-1.0, 1.0] {
                let axis = worst.split;
                let (mut centre, mut half) = (worst.centre, worst.half);
                half[axis] *= 0.5;
                centre[axis] += side * half[axis];
                heap.push(Cell::new(centre, half, order, &mut f));
                order += 1;
            }
        }
    }
}

/// Sums the cells in the order of their creation.
fn total<const N: usize>(
    heap: &BinaryHeap<Cell<N>>,
    evaluations: usize,
    tolerance: &Tolerance,
) -> Integral<N> {
    let mut value = [Sum::default(); N];
    let mut error = [Sum::default(); N];
    let mut cells: Vec<&Cell<N>> = heap.iter().collect();
    cells.sort_unstable_by_key(|c| c.order);
    for cell in cells {
        for n in 0..N {
            value[n].add(cell.value[n]);
            error[n].add(cell.error[n]);
        }
    }
    let (value, error) = (value.map(Sum::total), error.map(Sum::total));
    let converged = value
        .iter()
        .zip(&error)
        .all(|(v, &e)| e <= tolerance.absolute.max(tolerance.relative * v.abs()));
    Integral {
        value,
        error,
        evaluations,
        converged,
    }
}

/// A compensated sum (Neumaier 1974).
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    sum: f64,
    lost: f64,
}

impl Sum {
    fn add(&mut self, x: f64) {
        let sum = self.sum + x;
        self.lost += if self.sum.abs() >= x.abs() {
            (self.sum - sum) + x
        } else {
            (x - sum) + self.sum
        };
        self.sum = sum;
    }

    fn total(self) -> f64 {
        self.sum + self.lost
    }
}

/// Evaluations a box.
const POINTS: usize = 17;

/// A box with its integral.
struct Cell<const N: usize> {
    centre: [f64; 2],
    half: [f64; 2],
    value: [f64; N],
    error: [f64; N],
    /// The largest component of the error.
    worst: f64,
    /// The side to halve.
    split: usize,
    /// Order of creation, which settles ties.
    order: usize,
}

impl<const N: usize> Cell<N> {
    fn new(
        centre: [f64; 2],
        half: [f64; 2],
        order: usize,
        f: &mut impl FnMut([f64; 2]) -> [f64; N],
    ) -> Self {
        // Nodes √(9/70), √(9/10) on the axes, √(9/10) and √(9/19) on the diagonals; weights for n = 2.
        let near = (9.0f64 / 70.0).sqrt();
        let far = (9.0f64 / 10.0).sqrt();
        let diagonal = (9.0f64 / 19.0).sqrt();
        let mut at = |s: f64, t: f64| f([centre[0] + s * half[0], centre[1] + t * half[1]]);
        let middle = at(0.0, 0.0);
        let axis_near = [
            pair(at(-near, 0.0), at(near, 0.0)),
            pair(at(0.0, -near), at(0.0, near)),
        ];
        let axis_far = [
            pair(at(-far, 0.0), at(far, 0.0)),
            pair(at(0.0, -far), at(0.0, far)),
        ];
        let mut corners = |d: f64| pair(pair(at(-d, -d), at(d, -d)), pair(at(-d, d), at(d, d)));
        let (corner_far, corner_diagonal) = (corners(far), corners(diagonal));
        let area = 4.0 * half[0] * half[1];
        let mut value = [0.0; N];
        let mut error = [0.0; N];
        let mut worst = 0.0;
        let mut differences = [0.0; 2];
        for n in 0..N {
            let sum_near = axis_near[0][n] + axis_near[1][n];
            let sum_far = axis_far[0][n] + axis_far[1][n];
            let degree7 = (-3816.0 * middle[n]
                + 2940.0 * sum_near
                + 1020.0 * sum_far
                + 200.0 * corner_far[n]
                + 1714.75 * corner_diagonal[n])
                / 19683.0;
            let degree5 =
                (-1942.0 * middle[n] + 735.0 * sum_near + 65.0 * sum_far + 50.0 * corner_far[n])
                    / 1458.0;
            value[n] = area * degree7;
            error[n] = area.abs() * (degree7 - degree5).abs();
            worst = error[n].max(worst);
            // Fourth differences along each axis; (9/70)/(9/10) = 1/7.
            for k in 0..2 {
                let second = |sum: f64| sum - 2.0 * middle[n];
                differences[k] += (second(axis_near[k][n]) - second(axis_far[k][n]) / 7.0).abs();
            }
        }
        // Where neither stands out the longer side, which keeps boxes from becoming slivers.
        let close =
            (differences[0] - differences[1]).abs() <= 1e-6 * (differences[0] + differences[1]);
        let split = if close {
            usize::from(half[1].abs() > half[0].abs())
        } else {
            usize::from(differences[1] > differences[0])
        };
        Self {
            centre,
            half,
            value,
            error,
            worst,
            split,
            order,
        }
    }
}

fn pair<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|n| a[n] + b[n])
}

impl<const N: usize> Ord for Cell<N> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.worst
            .total_cmp(&other.worst)
            .then(other.order.cmp(&self.order))
    }
}

impl<const N: usize> PartialOrd for Cell<N> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<const N: usize> PartialEq for Cell<N> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<const N: usize> Eq for Cell<N> {}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn polynomials_of_degree_seven_are_exact_in_one_step() {
        let loose = Tolerance {
            absolute: 1e9,
            ..Tolerance::default()
        };
        for (i, j) in [(0, 0), (2, 4), (6, 0), (0, 6), (3, 4), (1, 6)] {
            let f = |[x, y]: [f64; 2]| [x.powi(i) * y.powi(j)];
            let found = rectangle([0.0, -1.0], [2.0, 3.0], &loose, f);
            let expected = 2f64.powi(i + 1) / f64::from(i + 1)
                * (3f64.powi(j + 1) - (-1f64).powi(j + 1))
                / f64::from(j + 1);
            assert_eq!(found.evaluations, 17);
            assert!((found.value[0] / expected - 1.0).abs() < 1e-12, "{i} {j}");
        }
    }

    #[test]
    fn the_hemisphere_to_ten_digits() {
        let found = hemisphere(&Tolerance::default(), |w| [1.0, w.z, w.x * w.x, w.y]);
        let exact = [2.0 * PI, PI, 2.0 * PI / 3.0, 0.0];
        assert!(found.converged);
        for (value, exact) in found.value.iter().zip(exact) {
            assert!((value - exact).abs() < 1e-10);
        }
        let whole = sphere(&Tolerance::default(), |_| [1.0]);
        assert!((whole.value[0] - 4.0 * PI).abs() < 1e-12);
    }

    /// A lobe of 1/50 rad about a tilted axis, of integral 2π/(p + 1) (1 − 2^-(p+1)) over the sphere for ((1 + cos)/2)ᵖ.
    #[test]
    fn a_narrow_lobe_is_found_and_its_error_bounded() {
        let axis = Vec3::new(0.6, -0.64, 0.48);
        let p = 5000;
        let tolerance = Tolerance {
            absolute: 1e-9,
            relative: 1e-7,
            ..Tolerance::default()
        };
        let found = sphere(&tolerance, |w| [(0.5 + 0.5 * w.dot(axis)).powi(p)]);
        let exact = 4.0 * PI / f64::from(p + 1);
        assert!(found.converged && (found.value[0] - exact).abs() <= found.error[0]);
    }

    /// An edge: a half-plane's area. The estimate must hold, and a budget too small must be reported.
    #[test]
    fn an_edge_converges_slowly_but_honestly() {
        let f = |[x, y]: [f64; 2]| [f64::from(u8::from(x + 0.3 * y < 0.7))];
        let exact = 0.7 - 0.15;
        let tolerance = Tolerance {
            absolute: 1e-3,
            relative: 0.0,
            ..Tolerance::default()
        };
        let found = rectangle([0.0, 0.0], [1.0, 1.0], &tolerance, f);
        assert!(found.converged && (found.value[0] - exact).abs() < 1e-3);
        let small = Tolerance {
            max_evaluations: 100,
            ..tolerance
        };
        let cut = rectangle([0.0, 0.0], [1.0, 1.0], &small, f);
        assert!(!cut.converged && cut.evaluations <= 100);
    }

    #[test]
    fn a_nan_ends_it_at_once() {
        let found = rectangle([0.0, 0.0], [1.0, 1.0], &Tolerance::default(), |[x, _]| {
            [x, if x > 0.9 { f64::NAN } else { 1.0 }]
        });
        assert!(!found.converged && found.value[1].is_nan() && found.evaluations < 100);
        assert!(!found.value[0].is_nan());
    }

    #[test]
    fn an_empty_or_reversed_box_has_its_sign() {
        let one = |_: [f64; 2]| [1.0];
        let area = |low, high| rectangle(low, high, &Tolerance::default(), one).value[0];
        assert_eq!(area([0.0, 0.0], [0.0, 1.0]), 0.0);
        assert!((area([1.0, 0.0], [0.0, 1.0]) + 1.0).abs() < 1e-15);
    }
}
