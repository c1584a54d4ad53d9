//! Integration over a disc-shaped picture: a midpoint rule on rings around the picture's axis.

use crate::lookup::Map;
use gonio_num::{Real, Vec3};
use std::f64::consts::{PI, TAU};

/// Irradiances of a disc-shaped picture.
pub(super) fn irradiances(map: &Map, normals: &[Vec3<f64>], fineness: usize) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; normals.len()];
    rings(map, fineness, |d, radiance_dw| {
        for (sum, n) in sums.iter_mut().zip(normals) {
            let cos = n.dot(d);
            if cos > 0.0 {
                for k in 0..3 {
                    sum[k] += cos * radiance_dw[k];
                }
            }
        }
    });
    sums
}

/// Mean radiance of a disc-shaped picture.
pub(super) fn mean(map: &Map) -> [f64; 3] {
    rings(map, 2, |_, _| {})
}

/// Visits directions on rings around the picture's axis with radiance × solid angle; returns the mean radiance.
fn rings(map: &Map, fineness: usize, mut visit: impl FnMut(Vec3<f64>, [f64; 3])) -> [f64; 3] {
    let rings = fineness * map.width.max(64);
    let spokes = 2 * rings;
    let turns: Vec<_> = (0..spokes)
        .map(|i| Real::sin_cos(TAU * (i as f64 + 0.5) / spokes as f64))
        .collect();
    let mut total = [0.0; 3];
    for ring in 0..rings {
        let middle = PI * (ring as f64 + 0.5) / rings as f64;
        let (sin, cos) = Real::sin_cos(middle);
        // cos a − cos b = 2 sin((a + b)/2) sin((b − a)/2).
        let solid_angle = 2.0 * sin * Real::sin(0.5 * PI / rings as f64) * TAU / spokes as f64;
        for (s, c) in &turns {
            let d = Vec3::new(sin * c, sin * s, cos);
            let l = map.radiance(d.to_f32()).map(|l| f64::from(l) * solid_angle);
            for k in 0..3 {
                total[k] += l[k];
            }
            visit(d, l);
        }
    }
    total.map(|t| t / (4.0 * PI))
}
