//! [`Turns`], the running integrals along node rows, and the search in two of them at once.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::nodes::{Nodes, sample_linear};
use gonio_num::lanes::Lanes;
use gonio_num::{DoubleLanes, Real};

/// A line of the cache.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Line([f32; 16]);

/// Columns of which a line holds the running integrals, and then the values, negative, so that every running integral exceeds them.
const NUMBERS: usize = 8;
/// Cells in a line. The last column is the first of the next line: both ends of each cell stand together.
const CELLS: usize = NUMBERS - 1;
/// Lines that one line tells apart, by the running integrals at their beginnings.
const BRANCHES: usize = 16;

/// The running integral of each node row around the circle, from node 0, in units of a cell, in single precision; with the values.
///
/// What is sampled is a row between two node rows. Its running integral is the interpolation of theirs, so it is searched in both at
/// once: in a tree of lines whose nodes are compared as a whole, without branches. So the number of lines that are read is the same
/// for every number, and few of them come from far away: one of each row, and those of the tree, which stay near.
#[derive(Debug)]
pub(super) struct Turns {
    width: usize,
    /// Lines of `CELLS` cells, those of a row together.
    cells: Vec<Line>,
    cells_a_row: usize,
    /// Above them, from the root down: lines of each row, and how many a row has.
    levels: Vec<(Vec<Line>, usize)>,
    /// For each node row the running integral at its end.
    whole: Vec<f32>,
    /// And its mean over the circle.
    means: Vec<f64>,
}

/// A search in every lane, down to the lines that hold what is looked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaf<const L: usize> {
    /// Where between the two rows.
    t: DoubleLanes<L>,
    /// The running integral that is looked for.
    x: DoubleLanes<L>,
    /// The line, counted in its row, and the two lines among all.
    first: [u32; L],
    lines: [[usize; L]; 2],
}

impl<const L: usize> Leaf<L> {
    /// Room for some.
    pub const NONE: Self = Self {
        t: DoubleLanes([0.0; L]),
        x: DoubleLanes([0.0; L]),
        first: [0; L],
        lines: [[0; L]; 2],
    };
}

/// What stands behind the end: no running integral reaches it.
const NEVER: f32 = f32::INFINITY;

impl Turns {
    pub fn new(nodes: &Nodes) -> Self {
        let width = nodes.width;
        let cells_a_row = width.div_ceil(CELLS);
        let mut cells = Vec::with_capacity(cells_a_row * nodes.height);
        let (mut whole, mut means) = (Vec::new(), Vec::new());
        for row in nodes.values.chunks_exact(width) {
            let mut sum = 0.0;
            for line in 0..cells_a_row {
                let mut cell = [NEVER; 16];
                for k in 0..NUMBERS {
                    let i = line * CELLS + k;
                    let value = row[i % width];
                    cell[NUMBERS + k] = -value;
                    if i <= width {
                        cell[k] = sum as f32;
                    }
                    if i < width && k < CELLS {
                        sum += 0.5 * (f64::from(value) + f64::from(row[(i + 1) % width]));
                    }
                }
                cells.push(Line(cell));
            }
            whole.push(sum as f32);
            means.push(sum / width as f64);
        }
        let mut levels = Vec::new();
        let (mut below, mut a_row) = (&cells, cells_a_row);
        while a_row > 1 {
            let mut lines = Vec::with_capacity(a_row.div_ceil(BRANCHES) * nodes.height);
            for row in below.chunks_exact(a_row) {
                for some in row.chunks(BRANCHES) {
                    let mut line = Line([NEVER; BRANCHES]);
                    for (start, first) in line.0.iter_mut().zip(some) {
                        *start = first.0[0];
                    }
                    lines.push(line);
                }
            }
            a_row = a_row.div_ceil(BRANCHES);
            levels.push((lines, a_row));
            below = &levels[levels.len() - 1].0;
        }
        levels.reverse();
        Self {
            width,
            cells,
            cells_a_row,
            levels,
            whole,
            means,
        }
    }

    /// The mean over the circle of each node row.
    pub fn means(&self) -> &[f64] {
        &self.means
    }

    /// Begins to look for the fraction `u` of the row at `t` between two node rows, in every lane: down to the lines of both.
    #[inline(always)]
    pub fn descend<const L: usize>(
        &self,
        rows: &[[u32; L]; 2],
        t: DoubleLanes<L>,
        u: DoubleLanes<L>,
    ) -> Leaf<L> {
        let mut wholes = [Lanes([0.0; L]); 2];
        for k in 0..2 {
            for lane in 0..L {
                wholes[k].0[lane] = self.whole[rows[k][lane] as usize];
            }
        }
        let x = u * t.lerp(wholes[0].to_double(), wholes[1].to_double());
        let mut found = [0; L];
        for (lines, a_row) in &self.levels {
            for lane in 0..L {
                let a = &lines[rows[0][lane] as usize * a_row + found[lane] as usize];
                let b = &lines[rows[1][lane] as usize * a_row + found[lane] as usize];
                let reached = count(&a.0, &b.0, t.0[lane], x.0[lane]).max(1) - 1;
                found[lane] = found[lane] * BRANCHES as u32 + reached;
            }
        }
        let mut lines = [[0; L]; 2];
        for k in 0..2 {
            for lane in 0..L {
                lines[k][lane] = rows[k][lane] as usize * self.cells_a_row + found[lane] as usize;
            }
        }
        Leaf {
            t,
            x,
            first: found,
            lines,
        }
    }

    /// Reads the lines, all at once, so that memory is waited for once.
    #[inline(always)]
    pub fn touch<const L: usize>(&self, leaf: &Leaf<L>) -> u32 {
        let mut sum = 0;
        for k in 0..2 {
            for lane in 0..L {
                sum ^= self.cells[leaf.lines[k][lane]].0[0].to_bits();
            }
        }
        sum
    }

    /// Column, and the place in it, in every lane: the largest column whose running integral, at `t` between the two rows, is at most
    /// `x`.
    ///
    /// Interpolated in double precision they rise as both rows do, roundings included: each is a sum of non-negative products.
    #[inline(always)]
    pub fn end<const L: usize>(&self, leaf: &Leaf<L>) -> (DoubleLanes<L>, DoubleLanes<L>) {
        let (t, x) = (leaf.t, leaf.x);
        let mut columns = [0; L];
        // Of both rows: the running integral at both ends of the cell that is found, and the values there.
        let none = Lanes([0.0; L]);
        let (mut ends, mut values) = ([[none; 2]; 2], [[none; 2]; 2]);
        for lane in 0..L {
            let a = &self.cells[leaf.lines[0][lane]].0;
            let b = &self.cells[leaf.lines[1][lane]].0;
            let first = leaf.first[lane] * CELLS as u32;
            let last = (self.width as u32 - 1 - first).min(CELLS as u32 - 1);
            // The values, none above 0, are all counted.
            let first_of_all = NUMBERS as u32 + 1;
            let k = (count(a, b, t.0[lane], x.0[lane]).max(first_of_all) - first_of_all).min(last);
            columns[lane] = first + k;
            let k = k as usize;
            for (row, line) in [a, b].into_iter().enumerate() {
                for side in 0..2 {
                    ends[row][side].0[lane] = line[k + side];
                    values[row][side].0[lane] = line[NUMBERS + k + side];
                }
            }
        }
        let mut column = DoubleLanes([0.0; L]);
        for lane in 0..L {
            column.0[lane] = f64::from(columns[lane]);
        }
        let start = between(t, ends, 0);
        let end = between(t, ends, 1);
        let (left, right) = (-between(t, values, 0), -between(t, values, 1));
        let wide = start.lt(end);
        let length = DoubleLanes::select(wide, end - start, DoubleLanes::one());
        let inside = ((x - start) / length).saturate();
        let inside = DoubleLanes::select(wide, inside, DoubleLanes::lit(0.5));
        let s = sample_linear(left, right, inside);
        (column, s)
    }
}

/// On one side of a cell, what is at `t` between the two rows.
#[inline(always)]
fn between<const L: usize>(
    t: DoubleLanes<L>,
    rows: [[Lanes<L>; 2]; 2],
    side: usize,
) -> DoubleLanes<L> {
    t.lerp(rows[0][side].to_double(), rows[1][side].to_double())
}

/// How many of the numbers at `t` between two lines are at most `x`.
#[inline(always)]
fn count(a: &[f32; 16], b: &[f32; 16], t: f64, x: f64) -> u32 {
    let at = DoubleLanes::splat(t).lerp(Lanes(*a).to_double(), Lanes(*b).to_double());
    let reached = at.le(DoubleLanes::splat(x));
    let mut count = 0;
    for i in 0..16 {
        count += u32::from(reached.0[i]);
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Beside a peak, in rows of every share of the mass, in trees of no level to three: the cell that a search of all cells finds.
    #[test]
    fn descents_find_the_cell_of_a_plain_search() {
        for (w, h) in [
            (1, 2),
            (2, 2),
            (7, 3),
            (8, 2),
            (113, 2),
            (200, 4),
            (1793, 2),
        ] {
            let values: Vec<f32> = (0..w * h)
                .map(|k| match k % w {
                    x if x == w / 3 => 1e5,
                    x if x % 5 == 0 => 0.0,
                    x => (1 + x % 7 + k / w) as f32,
                })
                .collect();
            let nodes = Nodes::new(w, h, values).unwrap();
            let turns = Turns::new(&nodes);
            // The running integrals as they are defined.
            let running = |row: usize| -> Vec<f64> {
                let row = &nodes.values[row * w..(row + 1) * w];
                let mut sum = 0.0;
                let mut all = vec![0.0];
                for i in 0..w {
                    sum += 0.5 * (f64::from(row[i]) + f64::from(row[(i + 1) % w]));
                    all.push(f64::from(sum as f32));
                }
                all
            };
            for row in 1..h {
                let (above, below) = (running(row - 1), running(row));
                for (t, u) in (0..997).map(|i| (f64::from(i % 13) / 12.0, f64::from(i) / 997.0)) {
                    let at = |i: usize| (1.0 - t) * above[i] + t * below[i];
                    let plain = (0..w).rfind(|&i| at(i) <= u * at(w)).unwrap();
                    let rows = [[row as u32 - 1], [row as u32]];
                    let leaf = turns.descend(&rows, DoubleLanes([t]), DoubleLanes([u]));
                    let (column, s) = turns.end(&leaf);
                    assert_eq!(column.0[0], plain as f64, "{w} {row} {t} {u}");
                    assert!((0.0..=1.0).contains(&s.0[0]), "{w} {row} {t} {u}");
                }
            }
        }
    }
}
