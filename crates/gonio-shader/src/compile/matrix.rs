//! Matrices: columns one after another.

use super::Compiler;
use super::emit::{Kind, Slot, Value};
use crate::tape::{Reg, Unary};
use naga::TypeInner;

fn real(reg: Reg) -> Slot {
    Slot {
        kind: Kind::Real,
        reg,
    }
}

/// Columns and rows of a matrix; a vector is one column.
fn shape(inner: &TypeInner) -> (usize, usize) {
    match *inner {
        TypeInner::Matrix { columns, rows, .. } => (columns as usize, rows as usize),
        TypeInner::Vector { size, .. } => (1, size as usize),
        _ => (1, 1),
    }
}

impl Compiler<'_> {
    /// A product of which at least one factor is a matrix.
    pub(super) fn multiply_matrix(
        &mut self,
        ta: &TypeInner,
        a: &Value,
        tb: &TypeInner,
        b: &Value,
    ) -> Value {
        if a.len() == 1 || b.len() == 1 {
            let n = a.len().max(b.len());
            let pick = |v: &Value, k: usize| v[if v.len() == 1 { 0 } else { k }].reg;
            return (0..n)
                .map(|k| real(self.e.mul(pick(a, k), pick(b, k))))
                .collect();
        }
        let (mut columns_a, mut rows_a) = shape(ta);
        let (columns_b, rows_b) = shape(tb);
        if matches!(ta, TypeInner::Vector { .. }) {
            // A vector on the left is a row.
            (columns_a, rows_a) = (rows_a, 1);
        }
        debug_assert_eq!(columns_a, rows_b);
        let mut product = Vec::with_capacity(columns_b * rows_a);
        for column in 0..columns_b {
            for row in 0..rows_a {
                let left: Vec<Reg> = (0..columns_a).map(|k| a[k * rows_a + row].reg).collect();
                let right: Vec<Reg> = (0..rows_b).map(|k| b[column * rows_b + k].reg).collect();
                product.push(real(self.sum_of_products(&left, &right)));
            }
        }
        product.into()
    }

    /// Σ aₖ·bₖ, from the first to the last.
    pub(super) fn sum_of_products(&mut self, a: &[Reg], b: &[Reg]) -> Reg {
        let mut sum = self.e.mul(a[0], b[0]);
        for (&a, &b) in a.iter().zip(b).skip(1) {
            sum = self.e.mul_add(a, b, sum);
        }
        sum
    }

    pub(super) fn transpose(&self, inner: &TypeInner, a: &Value) -> Value {
        let (columns, rows) = shape(inner);
        (0..rows)
            .flat_map(|row| (0..columns).map(move |column| (column, row)))
            .map(|(column, row)| a[column * rows + row])
            .collect()
    }

    /// The outer product: column k is a·bₖ.
    pub(super) fn outer(&mut self, a: &Value, b: &Value) -> Value {
        let mut product = Vec::with_capacity(a.len() * b.len());
        for column in b.iter() {
            for row in a.iter() {
                product.push(real(self.e.mul(row.reg, column.reg)));
            }
        }
        product.into()
    }

    /// Of a square matrix, by its first row's minors.
    pub(super) fn determinant(&mut self, a: &[Reg], n: usize) -> Reg {
        if n == 1 {
            return a[0];
        }
        let mut sum: Option<Reg> = None;
        for column in 0..n {
            let minor = self.minor(a, n, column, 0);
            let term = self.e.mul(a[column * n], minor);
            sum = Some(match sum {
                None => term,
                Some(sum) if column % 2 == 1 => self.e.sub(sum, term),
                Some(sum) => self.e.add(sum, term),
            });
        }
        sum.unwrap_or(a[0])
    }

    /// The determinant without one column and one row.
    fn minor(&mut self, a: &[Reg], n: usize, column: usize, row: usize) -> Reg {
        let mut rest = Vec::with_capacity((n - 1) * (n - 1));
        for c in (0..n).filter(|&c| c != column) {
            for r in (0..n).filter(|&r| r != row) {
                rest.push(a[c * n + r]);
            }
        }
        self.determinant(&rest, n - 1)
    }

    /// Of a square matrix: the adjugate over the determinant.
    pub(super) fn inverse(&mut self, a: &[Reg], n: usize) -> Value {
        let determinant = self.determinant(a, n);
        let mut inverse = Vec::with_capacity(n * n);
        for column in 0..n {
            for row in 0..n {
                // Transposed: the minor of (row, column) stands at (column, row).
                let minor = self.minor(a, n, row, column);
                let signed = if (column + row) % 2 == 1 {
                    self.e.unary(Unary::Negate, minor)
                } else {
                    minor
                };
                inverse.push(real(self.e.div(signed, determinant)));
            }
        }
        inverse.into()
    }
}
