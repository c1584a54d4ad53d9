//! Exact quadrature: every texel of the picture, for every axis.

use crate::gather::{Axes, Lights, gather};
use crate::kernel::Kernel;
use crate::nodes::LightTree;
use crate::points::Points;
use gonio_env::Environment;
use gonio_num::Vec3;
use rayon::prelude::*;

/// Rows of points that are summed in single precision before they go into the double one: a fixed number, so that the bits don't
/// depend on the threads.
const ROWS: usize = 4;

/// The mean radiance under the kernel around each axis: quadrature over all texels of a panorama, as they are interpolated, finer than
/// the lobe. For pictures that are no panoramas the finest cells of the tree are the points.
///
/// Rounding: about 1e-6. Quadrature: about 1e-5.
pub fn reference(
    environment: &Environment,
    tree: &LightTree,
    kernel: &Kernel,
    axes: &[Vec3<f32>],
) -> Vec<[f32; 3]> {
    if axes.is_empty() {
        return Vec::new();
    }
    let sums = match environment.lat_long_texels() {
        Some(texels) => {
            let points = Points::of_reference(&texels, kernel.width());
            let chunks = points.rows().div_ceil(ROWS);
            let fill = |chunk: usize, lights: &mut Lights| {
                for row in chunk * ROWS..((chunk + 1) * ROWS).min(points.rows()) {
                    points.each_in_row(row, |d, w, rgb| {
                        let d = d.to_f32();
                        lights.push([d.x, d.y, d.z], rgb, w as f32);
                    });
                }
            };
            sum(kernel, axes, chunks, fill)
        }
        None => {
            let cells = &tree.levels[0].cells;
            let each = 4096;
            let fill = |chunk: usize, lights: &mut Lights| {
                for i in chunk * each..((chunk + 1) * each).min(cells.len()) {
                    lights.push_from(cells, i);
                }
            };
            sum(kernel, axes, cells.len().div_ceil(each), fill)
        }
    };
    sums.iter()
        .map(|s| [0, 1, 2].map(|c| (s[c] / s[3].max(1e-300)) as f32))
        .collect()
}

/// Σ over chunks, in their order.
fn sum(
    kernel: &Kernel,
    axes: &[Vec3<f32>],
    chunks: usize,
    fill: impl Fn(usize, &mut Lights) + Sync,
) -> Vec<[f64; 4]> {
    let mut total = vec![[0.0; 4]; axes.len()];
    let all: Vec<usize> = (0..chunks).collect();
    // As many at a time as memory is asked for.
    for some in all.chunks(64) {
        let parts: Vec<Vec<[f32; 4]>> = some
            .par_iter()
            .map(|chunk| {
                let mut lights = Lights::default();
                fill(*chunk, &mut lights);
                let mut sums = Axes::default();
                sums.set(axes);
                gather(kernel, &lights, &mut sums);
                (0..axes.len()).map(|i| sums.sum(i)).collect()
            })
            .collect();
        for part in parts {
            for (t, p) in total.iter_mut().zip(part) {
                for c in 0..4 {
                    t[c] += f64::from(p[c]);
                }
            }
        }
    }
    total
}
