//! The colour spaces of ꟻLIP. White is that of linear RGB (1, 1, 1).

use gonio_num::Real;

/// Y_y, C_x, C_z: luminance, red–green, blue–yellow, linear in light.
pub(super) type Opponent = [f32; 3];
/// L\*, a\*, b\* with the Hunt adjustment.
pub(super) type Lab = [f32; 3];

/// Linear Rec. 709 to CIE XYZ, from the primaries to the digits of a fraction, as the reference evaluator has it.
const TO_XYZ: [[f64; 3]; 3] = [
    [
        10_135_552.0 / 24_577_794.0,
        8_788_810.0 / 24_577_794.0,
        4_435_075.0 / 24_577_794.0,
    ],
    [
        2_613_072.0 / 12_288_897.0,
        8_788_810.0 / 12_288_897.0,
        887_015.0 / 12_288_897.0,
    ],
    [
        1_425_312.0 / 73_733_382.0,
        8_788_810.0 / 73_733_382.0,
        70_074_185.0 / 73_733_382.0,
    ],
];

/// XYZ of white.
const WHITE: [f64; 3] = [
    TO_XYZ[0][0] + TO_XYZ[0][1] + TO_XYZ[0][2],
    TO_XYZ[1][0] + TO_XYZ[1][1] + TO_XYZ[1][2],
    TO_XYZ[2][0] + TO_XYZ[2][1] + TO_XYZ[2][2],
];

/// The inverse of [`TO_XYZ`] with columns scaled by white: from X/Xₙ, Y/Yₙ, Z/Zₙ to RGB.
const FROM_RELATIVE_XYZ: [[f64; 3]; 3] = {
    let mut relative = TO_XYZ;
    let mut i = 0;
    while i < 3 {
        let mut j = 0;
        while j < 3 {
            relative[i][j] /= WHITE[i];
            j += 1;
        }
        i += 1;
    }
    invert(relative)
};

const fn invert(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut out = [[0.0; 3]; 3];
    let mut determinant = 0.0;
    let mut i = 0;
    while i < 3 {
        let mut j = 0;
        while j < 3 {
            let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
            out[j][i] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
            if i == 0 {
                determinant += m[0][j] * out[j][0];
            }
            j += 1;
        }
        i += 1;
    }
    let mut k = 0;
    while k < 9 {
        out[k / 3][k % 3] /= determinant;
        k += 1;
    }
    out
}

fn times(m: &[[f64; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = v.map(f64::from);
    m.map(|row| (row[0] * x + row[1] * y + row[2] * z) as f32)
}

/// Relative luminance of linear RGB: Y of CIE XYZ.
pub(super) fn luminance(rgb: [f32; 3]) -> f32 {
    times(&TO_XYZ, rgb)[1]
}

fn relative_xyz(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = times(&TO_XYZ, rgb);
    let [xn, yn, zn] = WHITE.map(|w| w as f32);
    [x / xn, y / yn, z / zn]
}

/// L\*a\*b\* without its cube root (Zhang & Wandell 1997): blurring light is linear in it.
pub(super) fn opponent(rgb: [f32; 3]) -> Opponent {
    let [x, y, z] = relative_xyz(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The inverse of [`opponent`].
pub(super) fn rgb_of_opponent([luma, cx, cz]: Opponent) -> [f32; 3] {
    let y = (luma + 16.0) / 116.0;
    times(&FROM_RELATIVE_XYZ, [y + cx / 500.0, y, y - cz / 200.0])
}

/// L\*a\*b\* (CIE 1976) with a\* and b\* times L\*/100: the darker, the less colourful (Hunt 1952).
pub(super) fn hunt_lab(rgb: [f32; 3]) -> Lab {
    const DELTA: f32 = 6.0 / 29.0;
    let [x, y, z] = relative_xyz(rgb).map(|t| {
        if t > DELTA * DELTA * DELTA {
            Real::powf(t, 1.0 / 3.0)
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    });
    let l = 116.0 * y - 16.0;
    [l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_neutral_and_the_inverse_inverts() {
        let [l, a, b] = hunt_lab([1.0; 3]);
        assert!((l - 100.0).abs() < 1e-3 && a.abs() < 1e-3 && b.abs() < 1e-3);
        assert_eq!(hunt_lab([0.0; 3]).map(|c| c.abs() < 1e-4), [true; 3]);
        let rgb = [0.2, 0.7, 0.05];
        for (c, expected) in rgb_of_opponent(opponent(rgb)).into_iter().zip(rgb) {
            assert!((c - expected).abs() < 1e-5);
        }
    }
}
