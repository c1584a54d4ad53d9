//! Cumulative sums in fixed point, which the tables share.
//!
//! The unit interval is cut into 2³² units; cell i owns the units from its start to the next cell's. So
//! - the probability that is reported is exactly the one that is sampled: its number of units / 2³²;
//! - the resolution is the same along the whole table, where an `f32` sum would lose its small cells near 1;
//! - an entry of zero owns nothing, and any positive entry, however small, owns at least one unit.
//!
//! A cell's probability differs from its entry / sum by at most 2⁻³² a cell that was widened before it, in practice 2⁻³².

use crate::RadiometryError;

/// Units in the unit interval.
pub(super) const UNITS: u64 = 1 << 32;

/// The most cells along one axis of a table: positions are told apart by `f32` numbers.
pub(super) const MAX_CELLS: usize = 1 << 24;

/// Checks a table's shape and entries.
pub(super) fn check(entries: &[f32], width: usize, height: usize) -> Result<(), RadiometryError> {
    let sides = 1..=MAX_CELLS;
    let shaped = sides.contains(&width)
        && sides.contains(&height)
        && width.checked_mul(height) == Some(entries.len());
    if !shaped {
        return Err(RadiometryError::TableShape {
            width,
            height,
            found: entries.len(),
            max: MAX_CELLS,
        });
    }
    match entries.iter().position(|&f| !(f.is_finite() && f >= 0.0)) {
        Some(i) => Err(RadiometryError::TableEntry {
            x: i % width,
            y: i / width,
            value: entries[i],
        }),
        None => Ok(()),
    }
}

/// The starts of the cells of one table, in units, and the last cell that owns any.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cdf<'a> {
    /// Start of each cell; cells past `last` have no meaning.
    pub starts: &'a [u32],
    /// The last cell with a positive entry.
    pub last: u32,
}

/// Fills `starts` from the entries, which are finite, not negative and as many. Returns their sum and the last positive
/// cell; a sum of zero leaves `starts` at zero.
pub(super) fn accumulate(
    entries: impl Iterator<Item = f64> + Clone,
    starts: &mut [u32],
) -> (f64, u32) {
    let total: f64 = entries.clone().sum();
    let mut last = 0;
    let mut positive = 0;
    for (i, f) in entries.clone().enumerate() {
        if f > 0.0 {
            last = i as u32;
            positive += 1;
        }
    }
    starts.fill(0);
    if positive == 0 {
        return (0.0, 0);
    }
    // The units that may still be given while each positive cell to come gets one.
    let mut sum = 0.0;
    let mut least = 0u64;
    for (start, f) in starts.iter_mut().zip(entries).take(last as usize + 1) {
        let exact = (sum / total * UNITS as f64) as u64;
        let begin = exact.clamp(least, UNITS - positive);
        *start = begin as u32;
        least = begin;
        if f > 0.0 {
            least += 1;
            positive -= 1;
            sum += f;
        }
    }
    (total, last)
}

impl Cdf<'_> {
    /// The cell that owns the point `u` of [0, 1), and where in it the point lies, in [0, 1).
    pub(super) fn find(&self, u: f64) -> (usize, f64) {
        // NaN and negative numbers count as 0, numbers from 1 up as the last unit.
        let scaled = u * UNITS as f64;
        let unit = scaled as u32;
        let starts = &self.starts[..=self.last as usize];
        let cell = starts.partition_point(|&s| s <= unit).max(1) - 1;
        let within = scaled.clamp(0.0, UNITS as f64) - f64::from(starts[cell]);
        // Below 1 by more than an f32 rounding, so that no later rounding leaves the cell.
        (
            cell,
            (within / self.units(cell) as f64).clamp(0.0, 1.0 - 1.0 / 33_554_432.0),
        )
    }

    /// The units that the cell owns.
    pub(super) fn units(&self, cell: usize) -> u64 {
        let last = self.last as usize;
        if cell > last {
            0
        } else if cell == last {
            UNITS - u64::from(self.starts[cell])
        } else {
            u64::from(self.starts[cell + 1]) - u64::from(self.starts[cell])
        }
    }

    /// The point of [0, 1) at the fraction `within` of the cell: the inverse of [`find`](Self::find).
    pub(super) fn point(&self, cell: usize, within: f64) -> f32 {
        let start = if cell > self.last as usize {
            UNITS
        } else {
            self.starts[cell].into()
        };
        let u = (start as f64 + within * self.units(cell) as f64) / UNITS as f64;
        (u as f32).min(LARGEST_BELOW_ONE)
    }
}

/// 1 − 2⁻²⁴.
pub(super) const LARGEST_BELOW_ONE: f32 = 1.0 - 1.0 / 16_777_216.0;

/// The cell of `n` that the coordinate `x` of [0, 1) lies in, and where in it; x outside counts as the nearest end.
pub(super) fn cell_of(x: f32, n: usize) -> (usize, f64) {
    // Exact: 24 bits times at most 25 bits.
    let scaled = (f64::from(x) * n as f64).max(0.0);
    let cell = (scaled as usize).min(n - 1);
    (cell, (scaled - cell as f64).min(1.0))
}

/// The coordinate in [0, 1) at the fraction `within` of the cell, rounded so that [`cell_of`] names that cell.
pub(super) fn coordinate(cell: usize, within: f64, n: usize) -> f32 {
    let mut x = (((cell as f64 + within) / n as f64) as f32).min(LARGEST_BELOW_ONE);
    if cell_of(x, n).0 > cell {
        x = x.next_down();
    } else if cell_of(x, n).0 < cell {
        x = x.next_up();
    }
    x
}
