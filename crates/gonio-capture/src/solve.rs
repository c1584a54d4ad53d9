//! Dense symmetric systems of a few hundred unknowns.

/// Solves A x = b for a symmetric positive definite A (row-major, n × n) by Cholesky's factorisation A = L Lᵀ.
///
/// `a` and `b` are overwritten, `b` with x. `None` if a pivot is not above rounding: A is singular then.
pub(crate) fn cholesky(a: &mut [f64], b: &mut [f64]) -> Option<()> {
    let n = b.len();
    debug_assert_eq!(a.len(), n * n);
    for j in 0..n {
        let diagonal = a[j * n + j];
        for i in j..n {
            let mut sum = a[i * n + j];
            for k in 0..j {
                sum -= a[i * n + k] * a[j * n + k];
            }
            if i == j {
                // What is left of the pivot after subtraction is rounding below n ε times what it was.
                if sum.is_nan() || sum <= diagonal.abs() * n as f64 * f64::EPSILON {
                    return None;
                }
                a[j * n + j] = sum.sqrt();
            } else {
                a[i * n + j] = sum / a[j * n + j];
            }
        }
    }
    for i in 0..n {
        for k in 0..i {
            b[i] -= a[i * n + k] * b[k];
        }
        b[i] /= a[i * n + i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            b[i] -= a[k * n + i] * b[k];
        }
        b[i] /= a[i * n + i];
    }
    Some(())
}

/// Normal equations of a weighted linear least-squares problem with `N` unknowns: minimises Σ w (row · x − value)².
#[derive(Debug, Clone)]
pub(crate) struct Normal<const N: usize> {
    a: [[f64; N]; N],
    b: [f64; N],
}

impl<const N: usize> Normal<N> {
    pub fn new() -> Self {
        Self {
            a: [[0.0; N]; N],
            b: [0.0; N],
        }
    }

    /// Adds one equation.
    pub fn add(&mut self, row: [f64; N], value: f64, weight: f64) {
        for i in 0..N {
            for j in 0..N {
                self.a[i][j] += weight * row[i] * row[j];
            }
            self.b[i] += weight * row[i] * value;
        }
    }

    /// The solution; `None` if the equations don't determine it.
    pub fn solve(&self) -> Option<[f64; N]> {
        let mut a: Vec<f64> = self.a.iter().flatten().copied().collect();
        let mut x = self.b;
        cholesky(&mut a, &mut x)?;
        Some(x)
    }

    /// The diagonal of the inverse matrix: the variances of the unknowns for weights that are inverse variances.
    pub fn variances(&self) -> Option<[f64; N]> {
        let mut found = [0.0; N];
        for (k, variance) in found.iter_mut().enumerate() {
            let mut a: Vec<f64> = self.a.iter().flatten().copied().collect();
            let mut unit = [0.0; N];
            unit[k] = 1.0;
            cholesky(&mut a, &mut unit)?;
            *variance = unit[k];
        }
        Some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_a_small_system() {
        // [4 2; 2 3] x = [8; 7] has x = (10/8, 12/8).
        let mut b = [8.0, 7.0];
        cholesky(&mut [4.0, 2.0, 2.0, 3.0], &mut b).unwrap();
        assert!(
            (b[0] - 1.25).abs() < 1e-15 && (b[1] - 1.5).abs() < 1e-15,
            "{b:?}"
        );
    }

    #[test]
    fn a_singular_system_has_no_solution() {
        assert!(cholesky(&mut [1.0, 2.0, 2.0, 4.0], &mut [1.0, 2.0]).is_none());
        assert!(cholesky(&mut [f64::NAN], &mut [1.0]).is_none());
    }

    #[test]
    fn a_line_through_three_points() {
        // y = 2 x + 1, and an outlier without weight.
        let mut normal = Normal::new();
        for (x, y, w) in [
            (0.0, 1.0, 1.0),
            (1.0, 3.0, 1.0),
            (2.0, 5.0, 1.0),
            (3.0, 100.0, 0.0),
        ] {
            normal.add([x, 1.0], y, w);
        }
        let [slope, offset] = normal.solve().unwrap();
        assert!((slope - 2.0).abs() < 1e-13 && (offset - 1.0).abs() < 1e-13);
        // Var(slope) = 1 / Σ (x − mean)² = 1/2.
        assert!((normal.variances().unwrap()[0] - 0.5).abs() < 1e-13);
    }
}
