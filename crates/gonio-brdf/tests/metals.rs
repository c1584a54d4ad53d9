//! Derives the table of measured metals again from the measured spectra.
//!
//! The spectra are not part of the repository: `GONIO_SPECTRAL` names a folder with `cie1931_2deg_1nm.csv` (nm, x, y, z),
//! `illuminant_D65.csv` (nm, spd) and `ior/NAME.eta.spd`, `ior/NAME.k.spd`. A row that differs is printed as it should stand
//! in `src/part/metal.rs`.

// Helpers of tests are tests, and colours are short arrays walked side by side.
#![allow(clippy::unwrap_used, clippy::needless_range_loop)]

use gonio_brdf::part::metal::METALS;
use std::path::Path;

/// Linear RGB (IEC 61966-2-1) from XYZ.
const FROM_XYZ: [[f64; 3]; 3] = [
    [3.240_454_2, -1.537_138_5, -0.498_531_4],
    [-0.969_266_0, 1.876_010_8, 0.041_556_0],
    [0.055_643_4, -0.204_025_9, 1.057_225_2],
];

/// Rows of numbers, separated by commas or blanks; other lines are headings.
fn rows(path: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    text.lines()
        .filter_map(|line| {
            let parts = line.split([',', ' ']).filter(|p| !p.is_empty());
            parts.map(|p| p.parse().ok()).collect::<Option<Vec<f64>>>()
        })
        .filter(|row| row.len() >= 2)
        .collect()
}

/// Linear interpolation in rows (x, y), constant beyond the ends.
fn interpolate(rows: &[Vec<f64>], x: f64) -> f64 {
    let k = rows.partition_point(|r| r[0] <= x);
    if k == 0 {
        return rows[0][1];
    }
    if k == rows.len() {
        return rows[k - 1][1];
    }
    let (a, b) = (&rows[k - 1], &rows[k]);
    a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0])
}

#[test]
fn metals_are_what_the_spectra_give() {
    let Ok(folder) = std::env::var("GONIO_SPECTRAL") else {
        eprintln!("skipped: GONIO_SPECTRAL names no folder of spectra");
        return;
    };
    let folder = Path::new(&folder);
    let matching = rows(&folder.join("cie1931_2deg_1nm.csv"));
    let d65 = rows(&folder.join("illuminant_D65.csv"));
    let weights: Vec<(f64, [f64; 3])> = matching
        .iter()
        .map(|m| {
            let light = interpolate(&d65, m[0]);
            let weight = FROM_XYZ.map(|r| light * (r[0] * m[1] + r[1] * m[2] + r[2] * m[3]));
            (m[0], weight)
        })
        .collect();
    let mut wrong = Vec::new();
    for metal in METALS {
        let project = |quantity: &str| {
            let spectrum = rows(&folder.join(format!("ior/{}.{quantity}.spd", metal.source)));
            let mut sums = [[0.0; 2]; 3];
            for (lambda_nm, weight) in &weights {
                let x = interpolate(&spectrum, *lambda_nm);
                for c in 0..3 {
                    sums[c][0] += weight[c] * x;
                    sums[c][1] += weight[c];
                }
            }
            sums.map(|[x, one]| x / one)
        };
        let (eta, k) = (project("eta"), project("k"));
        // The table has five decimals.
        let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|c| (a[c] - b[c]).abs() < 1e-5);
        if !near(eta, metal.eta) || !near(k, metal.k) {
            wrong.push(format!(
                "metal({:?}, {:?}, {eta:.5?}, {k:.5?}),",
                metal.name, metal.source
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
