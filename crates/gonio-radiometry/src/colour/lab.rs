//! CIELAB and colour differences.

use gonio_num::Real;

/// (6/29)³: below it f is linear.
const EPSILON: f64 = 216.0 / 24389.0;
/// (29/3)³.
const KAPPA: f64 = 24389.0 / 27.0;

/// f(t) of CIELAB and its derivative.
pub(crate) fn f_and_slope(t: f64) -> (f64, f64) {
    if t > EPSILON {
        let root = libm_cbrt(t);
        (root, root / (3.0 * t))
    } else {
        ((KAPPA * t + 16.0) / 116.0, KAPPA / 116.0)
    }
}

/// ∛t for t > 0, the same bits everywhere: e^(ln t / 3) and one step of Newton's.
fn libm_cbrt(t: f64) -> f64 {
    let y = Real::exp(Real::ln(t) / 3.0);
    y - (y * y * y - t) / (3.0 * y * y)
}

/// CIELAB (L*, a*, b*) of XYZ relative to `white` (XYZ, same scale).
///
/// L* = 116 f(Y/Yn) − 16, a* = 500 (f(X/Xn) − f(Y/Yn)), b* = 200 (f(Y/Yn) − f(Z/Zn)). Source: ISO/CIE 11664-4.
pub fn lab_of_xyz(xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = [0, 1, 2].map(|k| f_and_slope(xyz[k] / white[k]).0);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// XYZ of CIELAB relative to `white`: the inverse of [`lab_of_xyz`].
pub fn xyz_of_lab(lab: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let y = (lab[0] + 16.0) / 116.0;
    let f = [y + lab[1] / 500.0, y, y - lab[2] / 200.0];
    [0, 1, 2].map(|k| {
        let cube = f[k] * f[k] * f[k];
        let t = if cube > EPSILON {
            cube
        } else {
            (116.0 * f[k] - 16.0) / KAPPA
        };
        t * white[k]
    })
}

/// ΔE*ab of 1976: the distance in CIELAB.
pub fn delta_e_76(a: [f64; 3], b: [f64; 3]) -> f64 {
    ((a[0] - b[0]).sq() + (a[1] - b[1]).sq() + (a[2] - b[2]).sq()).sqrt()
}

/// ΔE₀₀: the difference of two CIELAB colours, about 1 where an attentive eye just sees it.
///
/// With k_L = k_C = k_H = 1. Symmetric. Source: ISO/CIE 11664-6; notation of Sharma, Wu and Dalal 2005.
pub fn delta_e_2000(a: [f64; 3], b: [f64; 3]) -> f64 {
    let degrees = |d: f64| d.to_radians();
    let chroma = |p: f64, q: f64| (p * p + q * q).sqrt();
    let pow7 = |c: f64| c.sq() * c.pow5();
    let weight = |c: f64| (pow7(c) / (pow7(c) + 25f64.sq() * 25f64.pow5())).sqrt();

    let mean_c = 0.5 * (chroma(a[1], a[2]) + chroma(b[1], b[2]));
    let g = 0.5 * (1.0 - weight(mean_c));
    let polar = |lab: [f64; 3]| {
        let a1 = (1.0 + g) * lab[1];
        let h = Real::atan2(lab[2], a1).to_degrees();
        (chroma(a1, lab[2]), if h < 0.0 { h + 360.0 } else { h })
    };
    let ((c1, h1), (c2, h2)) = (polar(a), polar(b));

    let grey = c1 * c2 == 0.0;
    let dh = if grey {
        0.0
    } else if (h2 - h1).abs() <= 180.0 {
        h2 - h1
    } else if h2 > h1 {
        h2 - h1 - 360.0
    } else {
        h2 - h1 + 360.0
    };
    let delta_l = b[0] - a[0];
    let delta_c = c2 - c1;
    let delta_h = 2.0 * (c1 * c2).sqrt() * Real::sin(degrees(0.5 * dh));

    let mean_l = 0.5 * (a[0] + b[0]);
    let mean_c = 0.5 * (c1 + c2);
    let mean_h = if grey {
        h1 + h2
    } else if (h1 - h2).abs() <= 180.0 {
        0.5 * (h1 + h2)
    } else if h1 + h2 < 360.0 {
        0.5 * (h1 + h2 + 360.0)
    } else {
        0.5 * (h1 + h2 - 360.0)
    };
    let cos = |d: f64| Real::cos(degrees(d));
    let t =
        1.0 - 0.17 * cos(mean_h - 30.0) + 0.24 * cos(2.0 * mean_h) + 0.32 * cos(3.0 * mean_h + 6.0)
            - 0.20 * cos(4.0 * mean_h - 63.0);
    let theta = 30.0 * Real::exp(-((mean_h - 275.0) / 25.0).sq());
    let l50 = (mean_l - 50.0).sq();
    let s_l = 1.0 + 0.015 * l50 / (20.0 + l50).sqrt();
    let s_c = 1.0 + 0.045 * mean_c;
    let s_h = 1.0 + 0.015 * mean_c * t;
    let rotation = -Real::sin(degrees(2.0 * theta)) * 2.0 * weight(mean_c);
    let [l, c, h] = [delta_l / s_l, delta_c / s_c, delta_h / s_h];
    (l * l + c * c + h * h + rotation * c * h).max(0.0).sqrt()
}
