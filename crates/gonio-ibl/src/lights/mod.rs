//! N directional lights that stand for an environment.
//!
//! The panorama is cut into regions; each becomes a light from the centre of its flux, with all of its flux. The cuts are along rows or
//! columns of texels:
//!
//! - median cut (Debevec 2005, "A Median Cut Algorithm for Light Probe Sampling"): the region with the most flux is cut along its
//!   longer side into halves of equal flux;
//! - variance (Viriyothai & Debevec 2009, "Variance Minimization Light Probe Sampling"): the region with the largest variance
//!   Σ E |ω − ω̄|² is cut where the variances of the halves add up to the least.
//!
//! For unit vectors Σ E |ω − ω̄|² = Σ E − |Σ E ω|²/Σ E: sums over rectangles are all that is needed, and a table gives them.

mod sums;

use crate::{Filter, IblError, Kernel, LightTree};
use gonio_env::Environment;
use gonio_num::Vec3;
use serde::Serialize;
use std::f64::consts::PI;
use std::str::FromStr;
use sums::{Grid, Rectangle};

/// How regions are cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cut {
    /// Debevec 2005.
    Median,
    /// Viriyothai & Debevec 2009.
    Variance,
}

impl FromStr for Cut {
    type Err = IblError;

    fn from_str(text: &str) -> Result<Self, IblError> {
        match text {
            "median" => Ok(Self::Median),
            "variance" => Ok(Self::Variance),
            _ => Err(IblError::parameter(
                "method",
                format!("\"{text}\""),
                "median or variance",
            )),
        }
    }
}

/// A light from infinitely far away.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DirectionalLight {
    /// Unit vector towards it (world).
    pub direction: [f64; 3],
    /// Irradiance \[W m⁻²] of each channel on a surface that faces it.
    pub irradiance: [f64; 3],
    /// Solid angle \[sr] of the region that it stands for.
    pub solid_angle: f64,
}

/// Lights, and how well they stand for the environment.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Extraction {
    /// The lights, the brightest first.
    pub lights: Vec<DirectionalLight>,
    /// Mean over normals of the error of irradiance, relative to the mean irradiance.
    pub mean_error: f64,
    /// Largest error, relative to the mean irradiance.
    pub largest_error: f64,
    /// The normal at which that is.
    pub worst_normal: [f64; 3],
}

/// Most lights.
pub const MOST_LIGHTS: usize = 4096;

/// Normals at which irradiance is compared.
const NORMALS: usize = 256;

/// Extracts `count` lights. Fewer come back if there are not so many texels with light.
///
/// # Errors
/// If `count` is 0 or above [`MOST_LIGHTS`], and for a black environment.
pub fn extract(environment: &Environment, count: usize, cut: Cut) -> Result<Extraction, IblError> {
    if !(1..=MOST_LIGHTS).contains(&count) {
        return Err(IblError::parameter(
            "lights",
            count,
            "a whole number from 1 to 4096",
        ));
    }
    if environment.is_black() {
        return Err(IblError::parameter("environment", "black", "some light"));
    }
    let grid = Grid::new(environment);
    let mut regions = vec![grid.whole()];
    while regions.len() < count {
        let key = |r: &Rectangle| match cut {
            Cut::Median => grid.flux(r),
            Cut::Variance => grid.variance(r),
        };
        // The region to cut next: the largest that can be cut.
        let Some(next) = (0..regions.len())
            .filter(|i| regions[*i].can_be_cut() && grid.flux(&regions[*i]) > 0.0)
            .max_by(|a, b| key(&regions[*a]).total_cmp(&key(&regions[*b])))
        else {
            break;
        };
        let region = regions.swap_remove(next);
        let (a, b) = match cut {
            Cut::Median => grid.cut_at_median(&region),
            Cut::Variance => grid.cut_for_variance(&region),
        };
        regions.extend([a, b]);
    }
    let mut lights: Vec<DirectionalLight> = regions.iter().filter_map(|r| grid.light(r)).collect();
    let bright = |l: &DirectionalLight| crate::nodes::luminance(l.irradiance);
    lights.sort_by(|a, b| bright(b).total_cmp(&bright(a)));
    Ok(compare(environment, lights))
}

/// The error of irradiance over normals.
fn compare(environment: &Environment, lights: Vec<DirectionalLight>) -> Extraction {
    let tree = LightTree::new(environment, 0.2);
    let kernel = Kernel::Cosine { exponent: 1.0 };
    let filter = Filter::new(&tree, &kernel, 0.15);
    let normals: Vec<Vec3<f64>> = crate::harmonics::directions(NORMALS).collect();
    let blocks: Vec<Vec<Vec3<f32>>> = normals.iter().map(|n| vec![n.to_f32()]).collect();
    let truth: Vec<[f32; 3]> = filter.apply(&blocks).into_iter().flatten().collect();
    let (mut sum, mut whole) = (0.0, 0.0);
    let (mut largest, mut worst) = (0.0, normals[0]);
    for (n, t) in normals.iter().zip(&truth) {
        let mut e = [0.0; 3];
        for l in &lights {
            let [x, y, z] = l.direction;
            let cos = n.dot(Vec3::new(x, y, z)).max(0.0);
            for k in 0..3 {
                e[k] += l.irradiance[k] * cos;
            }
        }
        let t = t.map(|c| f64::from(c) * PI);
        let error = (0..3).map(|k| (e[k] - t[k]).abs()).sum::<f64>() / 3.0;
        sum += error;
        whole += (t[0] + t[1] + t[2]) / 3.0;
        if error > largest {
            (largest, worst) = (error, *n);
        }
    }
    let mean = whole / NORMALS as f64;
    Extraction {
        lights,
        mean_error: sum / whole,
        largest_error: largest / mean,
        worst_normal: [worst.x, worst.y, worst.z],
    }
}
