//! [`Matrix3`], a linear map of colours.

use gonio_num::Real;

/// A 3 × 3 matrix, by rows, that maps colours: XYZ to RGB, white to white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Matrix3(pub [[f64; 3]; 3]);

impl Matrix3 {
    /// The matrix that changes nothing.
    pub const IDENTITY: Self = Self::diagonal([1.0, 1.0, 1.0]);

    /// A scale for each component.
    pub const fn diagonal(d: [f64; 3]) -> Self {
        Self([[d[0], 0.0, 0.0], [0.0, d[1], 0.0], [0.0, 0.0, d[2]]])
    }

    /// The matrix whose columns are `c`.
    pub const fn from_columns(c: [[f64; 3]; 3]) -> Self {
        Self([
            [c[0][0], c[1][0], c[2][0]],
            [c[0][1], c[1][1], c[2][1]],
            [c[0][2], c[1][2], c[2][2]],
        ])
    }

    /// `self` first, then `outer`: the product outer · self.
    #[must_use]
    pub fn then(&self, outer: &Self) -> Self {
        let mut m = [[0.0; 3]; 3];
        for (i, row) in m.iter_mut().enumerate() {
            for (j, x) in row.iter_mut().enumerate() {
                *x = (0..3).map(|k| outer.0[i][k] * self.0[k][j]).sum();
            }
        }
        Self(m)
    }

    /// The image of `v`.
    #[inline(always)]
    pub fn apply<R: Real>(&self, v: [R; 3]) -> [R; 3] {
        let mut out = [R::zero(); 3];
        for (x, m) in out.iter_mut().zip(&self.0) {
            *x = R::lit(m[0]) * v[0] + R::lit(m[1]) * v[1] + R::lit(m[2]) * v[2];
        }
        out
    }

    /// The determinant.
    pub fn determinant(&self) -> f64 {
        let m = &self.0;
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
            - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    }

    /// The inverse, from the cofactors; `None` if the determinant is 0 or not finite.
    pub fn inverse(&self) -> Option<Self> {
        let det = self.determinant();
        if det == 0.0 || !det.is_finite() {
            return None;
        }
        let m = &self.0;
        let mut out = [[0.0; 3]; 3];
        for (i, row) in out.iter_mut().enumerate() {
            for (j, x) in row.iter_mut().enumerate() {
                // Cyclic indices give the cofactor its sign.
                let (a, b) = ((j + 1) % 3, (j + 2) % 3);
                let (c, d) = ((i + 1) % 3, (i + 2) % 3);
                *x = (m[a][c] * m[b][d] - m[a][d] * m[b][c]) / det;
            }
        }
        Some(Self(out))
    }
}
