//! Densities that are constant in each cell of a table: [`Piecewise1d`] and [`Piecewise2d`].

use super::cdf::{self, Cdf};
use crate::RadiometryError;

/// A density over [0, 1) that is constant in each of n equal cells, ∝ the table's entries.
#[derive(Debug, Clone, PartialEq)]
pub struct Piecewise1d {
    starts: Box<[u32]>,
    last: u32,
    sum: f64,
}

impl Piecewise1d {
    /// The density ∝ `entries`.
    ///
    /// # Errors
    /// [`RadiometryError::TableShape`] for none or more than 2²⁴ entries, [`RadiometryError::TableEntry`] for one that is
    /// negative or not finite, [`RadiometryError::TableAllZero`] if all are zero.
    pub fn new(entries: &[f32]) -> Result<Self, RadiometryError> {
        cdf::check(entries, entries.len(), 1)?;
        let mut starts = vec![0; entries.len()].into_boxed_slice();
        let (sum, last) = cdf::accumulate(entries.iter().map(|&f| f.into()), &mut starts);
        if sum == 0.0 {
            return Err(RadiometryError::TableAllZero {
                entries: entries.len(),
            });
        }
        Ok(Self { starts, last, sum })
    }

    fn cdf(&self) -> Cdf<'_> {
        Cdf {
            starts: &self.starts,
            last: self.last,
        }
    }

    fn density_of_cell(&self, cell: usize) -> f32 {
        (self.cdf().units(cell) as f64 / cdf::UNITS as f64 * self.starts.len() as f64) as f32
    }

    /// The x in [0, 1) that u in [0, 1) maps to, and the density there, which is positive. Continuous and rising in u, but
    /// for jumps over cells of zero.
    pub fn sample(&self, u: f32) -> (f32, f32) {
        let (cell, within) = self.cdf().find(u.into());
        (
            cdf::coordinate(cell, within, self.starts.len()),
            self.density_of_cell(cell),
        )
    }

    /// The density at x in [0, 1); x outside counts as the nearest end.
    pub fn density(&self, x: f32) -> f32 {
        self.density_of_cell(cdf::cell_of(x, self.starts.len()).0)
    }

    /// The u in [0, 1) that maps to x.
    pub fn inverse(&self, x: f32) -> f32 {
        let (cell, within) = cdf::cell_of(x, self.starts.len());
        self.cdf().point(cell, within)
    }

    /// The integral over [0, 1) of the function whose values are the entries: their mean.
    pub fn integral(&self) -> f64 {
        self.sum / self.starts.len() as f64
    }
}

/// A density over [0, 1)² that is constant in each cell of a table, ∝ its entries: first the row by the marginal
/// density, then the column by the row's conditional density.
///
/// Densities are exactly those that are sampled (see `sample`); they differ from entry / [`integral`](Self::integral) by
/// rounding to 2⁻³² of a row and of the rows.
///
/// ```
/// use gonio_radiometry::warp::Piecewise2d;
/// let table = Piecewise2d::new(&[0.0, 1.0, 1.0, 2.0], 2, 2)?;
/// let (p, density) = table.sample([0.5, 0.5]);
/// assert_eq!(density, table.density(p));
/// assert_eq!(table.integral(), 1.0);
/// # Ok::<(), gonio_radiometry::RadiometryError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Piecewise2d {
    width: usize,
    /// Starts of the cells of each row, row-major.
    starts: Box<[u32]>,
    /// The last positive cell of each row.
    last: Box<[u32]>,
    row_starts: Box<[u32]>,
    last_row: u32,
    sum: f64,
}

impl Piecewise2d {
    /// The density ∝ `entries`, row-major: `entries[j * width + i]` is the cell [i, i + 1)/width × [j, j + 1)/height.
    ///
    /// # Errors
    /// [`RadiometryError::TableShape`] if the number of entries isn't width × height or a side isn't in 1 … 2²⁴,
    /// [`RadiometryError::TableEntry`] for one that is negative or not finite, [`RadiometryError::TableAllZero`] if all are
    /// zero.
    pub fn new(entries: &[f32], width: usize, height: usize) -> Result<Self, RadiometryError> {
        cdf::check(entries, width, height)?;
        let mut starts = vec![0; entries.len()].into_boxed_slice();
        let mut last = Vec::with_capacity(height);
        let mut sums = Vec::with_capacity(height);
        let rows = entries
            .chunks_exact(width)
            .zip(starts.chunks_exact_mut(width));
        for (row, row_starts) in rows {
            let (sum, row_last) = cdf::accumulate(row.iter().map(|&f| f.into()), row_starts);
            sums.push(sum);
            last.push(row_last);
        }
        let mut row_starts = vec![0; height].into_boxed_slice();
        let (sum, last_row) = cdf::accumulate(sums.iter().copied(), &mut row_starts);
        if sum == 0.0 {
            return Err(RadiometryError::TableAllZero {
                entries: entries.len(),
            });
        }
        Ok(Self {
            width,
            starts,
            last: last.into_boxed_slice(),
            row_starts,
            last_row,
            sum,
        })
    }

    /// Cells along x.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Cells along y.
    pub fn height(&self) -> usize {
        self.row_starts.len()
    }

    fn rows(&self) -> Cdf<'_> {
        Cdf {
            starts: &self.row_starts,
            last: self.last_row,
        }
    }

    fn columns(&self, row: usize) -> Cdf<'_> {
        Cdf {
            starts: &self.starts[row * self.width..][..self.width],
            last: self.last[row],
        }
    }

    fn density_of_cell(&self, column: usize, row: usize) -> f32 {
        let units = self.rows().units(row) as f64 * self.columns(row).units(column) as f64;
        let cells = self.starts.len() as f64;
        (units / (cdf::UNITS as f64 * cdf::UNITS as f64) * cells) as f32
    }

    /// The point (x, y) of [0, 1)² that u in [0, 1)² maps to (u₀ to x, u₁ to y), and the density there, by area, which is
    /// positive and equals [`density`](Self::density) of the point. Rows, columns and cells of zero are never chosen.
    pub fn sample(&self, u: [f32; 2]) -> ([f32; 2], f32) {
        let (row, down) = self.rows().find(u[1].into());
        let (column, right) = self.columns(row).find(u[0].into());
        let x = cdf::coordinate(column, right, self.width);
        let y = cdf::coordinate(row, down, self.height());
        ([x, y], self.density_of_cell(column, row))
    }

    /// The density at the point p of [0, 1)²; coordinates outside count as the nearest end.
    pub fn density(&self, p: [f32; 2]) -> f32 {
        let (column, _) = cdf::cell_of(p[0], self.width);
        let (row, _) = cdf::cell_of(p[1], self.height());
        self.density_of_cell(column, row)
    }

    /// The u in [0, 1)² that maps to p.
    pub fn inverse(&self, p: [f32; 2]) -> [f32; 2] {
        let (column, right) = cdf::cell_of(p[0], self.width);
        let (row, down) = cdf::cell_of(p[1], self.height());
        [
            self.columns(row).point(column, right),
            self.rows().point(row, down),
        ]
    }

    /// The integral over [0, 1)² of the function whose values are the entries: their mean.
    pub fn integral(&self) -> f64 {
        self.sum / self.starts.len() as f64
    }
}
