//! Chromatic adaptation: a colour under one white to the colour that looks alike under another.

use super::Matrix3;

/// Bradford's cone responses. Source: Lam 1985; ICC.1:2022, annex E.
const BRADFORD: Matrix3 = Matrix3([
    [0.8951, 0.2664, -0.1614],
    [-0.7502, 1.7135, 0.0367],
    [0.0389, -0.0685, 1.0296],
]);

/// The adaptation of XYZ from `from_white` to `to_white` (both XYZ) in the cone responses `cones`.
///
/// Each response is scaled by the ratio of the whites': M⁻¹ diag(Mw′ / Mw) M. It maps `from_white` to `to_white`.
///
/// `None` if `cones` is singular or a response to `from_white` is 0.
pub fn von_kries(cones: &Matrix3, from_white: [f64; 3], to_white: [f64; 3]) -> Option<Matrix3> {
    let from = cones.apply(from_white);
    let to = cones.apply(to_white);
    let mut ratio = [0.0; 3];
    for k in 0..3 {
        if from[k] == 0.0 {
            return None;
        }
        ratio[k] = to[k] / from[k];
    }
    Some(
        cones
            .then(&Matrix3::diagonal(ratio))
            .then(&cones.inverse()?),
    )
}

/// The adaptation of XYZ from `from_white` to `to_white` (both XYZ) by Bradford's transform.
///
/// Exactly the identity for equal whites.
///
/// # Panics
/// If `from_white` has a cone response of 0: that of no light that an eye would call white.
pub fn bradford(from_white: [f64; 3], to_white: [f64; 3]) -> Matrix3 {
    if from_white == to_white {
        return Matrix3::IDENTITY;
    }
    von_kries(&BRADFORD, from_white, to_white)
        .expect("a white has positive responses in all three cones")
}
