//! Colours given in other primaries, brought to Rec. 709.

use crate::layers::Chromaticities;

type Matrix = [[f64; 3]; 3];

/// The matrix from linear RGB with these primaries to linear Rec. 709, or nothing if they are the same (to 1e-3, as files
/// round them). `None` also for degenerate primaries, which say nothing.
///
/// RGB → XYZ by SMPTE RP 177-1993; white to D65 by Bradford's linear adaptation (Lam 1985).
pub(crate) fn to_rec709(from: &Chromaticities) -> Option<Matrix> {
    let target = Chromaticities::REC709;
    let same = from
        .flat()
        .iter()
        .zip(target.flat())
        .all(|(a, b)| (a - b).abs() < 1e-3);
    if same {
        return None;
    }
    let to_xyz = rgb_to_xyz(from)?;
    let from_xyz = invert(&rgb_to_xyz(&target)?)?;
    let adapted = product(&adaptation(from.white, target.white)?, &to_xyz);
    let matrix = product(&from_xyz, &adapted);
    matrix
        .iter()
        .flatten()
        .all(|m| m.is_finite())
        .then_some(matrix)
}

/// Applies a matrix to a pixel.
pub(crate) fn apply(m: &Matrix, rgb: [f32; 3]) -> [f32; 3] {
    times(m, rgb.map(f64::from)).map(|c| c as f32)
}

fn xyz_of([x, y]: [f32; 2]) -> [f64; 3] {
    let (x, y) = (f64::from(x), f64::from(y));
    [x / y, 1.0, (1.0 - x - y) / y]
}

fn rgb_to_xyz(c: &Chromaticities) -> Option<Matrix> {
    let (r, g, b) = (xyz_of(c.red), xyz_of(c.green), xyz_of(c.blue));
    let columns = std::array::from_fn(|i| [r[i], g[i], b[i]]);
    let scale = times(&invert(&columns)?, xyz_of(c.white));
    Some(columns.map(|row| std::array::from_fn(|j| row[j] * scale[j])))
}

fn adaptation(from: [f32; 2], to: [f32; 2]) -> Option<Matrix> {
    const BRADFORD: Matrix = [
        [0.8951, 0.2664, -0.1614],
        [-0.7502, 1.7135, 0.0367],
        [0.0389, -0.0685, 1.0296],
    ];
    let (source, target) = (times(&BRADFORD, xyz_of(from)), times(&BRADFORD, xyz_of(to)));
    let scaled: Matrix = std::array::from_fn(|i| BRADFORD[i].map(|m| m * target[i] / source[i]));
    Some(product(&invert(&BRADFORD)?, &scaled))
}

fn times(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2])
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j])
    })
}

fn invert(m: &Matrix) -> Option<Matrix> {
    let cofactor = |i: usize, j: usize| {
        let (a, b) = ((i + 1) % 3, (i + 2) % 3);
        let (c, d) = ((j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant = (0..3).map(|j| m[0][j] * cofactor(0, j)).sum::<f64>();
    if !determinant.is_finite() || determinant.abs() < 1e-12 {
        return None;
    }
    Some(std::array::from_fn(|i| {
        std::array::from_fn(|j| cofactor(j, i) / determinant)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rec709_needs_no_matrix_and_nonsense_gives_none() {
        assert!(to_rec709(&Chromaticities::REC709).is_none());
        let point = [0.3, 0.3];
        assert!(
            to_rec709(&Chromaticities {
                red: point,
                green: point,
                blue: point,
                white: point
            })
            .is_none()
        );
        let zero = [0.0; 2];
        assert!(
            to_rec709(&Chromaticities {
                red: zero,
                green: zero,
                blue: zero,
                white: zero
            })
            .is_none()
        );
    }

    /// ACEScg (AP1, D60) → Rec. 709 (D65) by Bradford, as published with the ACES colour spaces.
    #[test]
    fn acescg_matches_the_published_matrix() {
        let ap1 = Chromaticities {
            red: [0.713, 0.293],
            green: [0.165, 0.830],
            blue: [0.128, 0.044],
            white: [0.32168, 0.33767],
        };
        let published = [
            [1.705_05, -0.621_79, -0.083_26],
            [-0.130_26, 1.140_80, -0.010_55],
            [-0.024_00, -0.128_97, 1.152_97],
        ];
        let matrix = to_rec709(&ap1).unwrap();
        for (row, expected) in matrix.iter().zip(published) {
            for (m, e) in row.iter().zip(expected) {
                assert!((m - e).abs() < 1e-4, "{matrix:?}");
            }
        }
        // White stays white.
        for c in apply(&matrix, [1.0; 3]) {
            assert!((c - 1.0).abs() < 1e-6);
        }
    }
}
