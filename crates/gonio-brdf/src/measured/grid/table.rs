//! [`GridTable`], a grid ready to be evaluated and drawn from over any number.

use super::super::channel::{ToRgb, luminance};
use super::super::metadata::Gamut;
use super::super::values::Values;
use super::super::views::{Cells, Chart, Views};
use super::parameterization::radians;
use super::{Axis, Boundary, Grid, Parameterization, Scale};
use crate::{Index, Number};
use gonio_num::Vec3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// A grid ready to be evaluated: its colours, linear RGB or grey, and its sampling.
#[derive(Debug, Clone)]
pub(in super::super) struct GridTable {
    parameterization: Parameterization,
    /// Four, the last of one node if isotropic.
    axes: [Axis; 4],
    colours: Values,
    /// Numbers of `colours` for each node: 1 grey, 3 RGB, 4 RGB and one unused, which is faster to read.
    stride: u32,
    views: Views,
}

/// Numbers of the densities that sampling may take: 32 MiB.
const MOST_DENSITIES: usize = 8 << 20;
/// Elevations of the viewer in degrees for which densities of half vectors are made: closer where highlights are cut off by the horizon.
const HALF_VIEWS_DEG: [f64; 24] = [
    0.0, 6.0, 12.0, 18.0, 24.0, 30.0, 36.0, 42.0, 48.0, 54.0, 60.0, 65.0, 70.0, 74.0, 77.0, 79.5,
    81.5, 83.0, 84.5, 86.0, 87.25, 88.25, 89.0, 89.75,
];

impl GridTable {
    /// The colours of a grid whose values are all finite and not negative.
    pub fn new(grid: &Grid, to_rgb: &ToRgb, gamut: &mut Gamut) -> Self {
        let weights = &to_rgb.weights;
        let grey = weights.iter().all(|w| w[0] == w[1] && w[1] == w[2]);
        let as_they_are = match (grid.channels(), grey) {
            (1, true) => weights[0] == [1.0; 3],
            (3, false) => (0..3).all(|k| {
                let mut unit = [0.0; 3];
                unit[k] = 1.0;
                weights[k] == unit
            }),
            _ => false,
        };
        // A mapped table is read where it is; one in memory is worth rearranging.
        let (colours, stride) = if as_they_are && grid.values().is_mapped() {
            (grid.values().clone(), grid.channels() as u32)
        } else {
            let mut colours = Vec::with_capacity(grid.cells() * 4);
            let mut values = vec![0.0; grid.channels()];
            for cell in grid.values().chunks_exact(grid.channels()) {
                for (value, x) in values.iter_mut().zip(cell) {
                    *value = f64::from(*x);
                }
                let rgb = gamut.clip(to_rgb.apply(&values));
                colours.extend([rgb[0] as f32, rgb[1] as f32, rgb[2] as f32, 0.0]);
            }
            (colours.into(), 4)
        };
        let mut axes = grid.axes().to_vec();
        axes.resize_with(4, Axis::single);
        let axes: [Axis; 4] = axes.try_into().expect("invariant: resized to 4");
        let parameterization = grid.parameterization();
        let interpolate = |wi: Vec3<f64>, wo: Vec3<f64>| {
            luminance(interpolate(
                parameterization,
                &axes,
                &colours,
                stride,
                wi,
                wo,
            ))
        };
        let views = views(grid, &interpolate);
        Self {
            parameterization,
            axes,
            colours,
            stride,
            views,
        }
    }

    /// Linear RGB at a pair of directions above the horizon.
    #[inline(always)]
    pub fn eval<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; 3] {
        interpolate(
            self.parameterization,
            &self.axes,
            &self.colours,
            self.stride,
            wi,
            wo,
        )
    }

    /// Density per solid angle of drawing `wi` for `wo`.
    #[inline(always)]
    pub fn pdf<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        self.views.pdf(wi, wo)
    }

    /// Draws a direction; below the horizon where that gives nothing.
    #[inline(always)]
    pub fn sample<R: Number>(&self, wo: Vec3<R>, u: [R; 3]) -> Vec3<R> {
        self.views.sample(wo, u)
    }

    /// The luminous albedo, roughly.
    #[inline(always)]
    pub fn albedo<R: Number>(&self, wo: Vec3<R>) -> R {
        self.views.albedo(wo)
    }
}

#[inline(always)]
fn interpolate<R: Number>(
    parameterization: Parameterization,
    axes: &[Axis; 4],
    colours: &[f32],
    stride: u32,
    wi: Vec3<R>,
    wo: Vec3<R>,
) -> [R; 3] {
    let x = parameterization.coordinates(wi, wo);
    if parameterization.is_isotropic() && stride == 4 {
        let [r, g, b, _] = corners::<R, 3, 4>(axes, colours, stride, x);
        [r, g, b]
    } else {
        others(parameterization, axes, colours, stride, x)
    }
}

/// Tables of four angles, and those that are read where they are. Called, not inlined, so that kernels stay small.
#[inline(never)]
fn others<R: Number>(
    parameterization: Parameterization,
    axes: &[Axis; 4],
    colours: &[f32],
    stride: u32,
    x: [R; 4],
) -> [R; 3] {
    match (parameterization.is_isotropic(), stride) {
        (true, 1) => grey(corners::<R, 3, 1>(axes, colours, stride, x)),
        (true, _) => corners::<R, 3, 3>(axes, colours, stride, x),
        (false, 1) => grey(corners::<R, 4, 1>(axes, colours, stride, x)),
        (false, _) => corners::<R, 4, 3>(axes, colours, stride, x),
    }
}

#[inline(always)]
fn grey<R: Number>([x]: [R; 1]) -> [R; 3] {
    [x; 3]
}

/// `K` numbers of each of the 2ᴰ nodes around `x`, weighted and added.
#[inline(always)]
fn corners<R: Number, const D: usize, const K: usize>(
    axes: &[Axis; 4],
    table: &[f32],
    stride: u32,
    x: [R; 4],
) -> [R; K] {
    // Pairs of axes first: the sixteen corners are four times four.
    let (front, back) = (pair(&axes[0], &axes[1], x[0], x[1]), {
        if D == 4 {
            pair(&axes[2], &axes[3], x[2], x[3])
        } else {
            let b = axes[2].around(x[2]);
            let zero = R::Index::splat(0);
            let ends = [b.low, b.high, zero, zero];
            (ends, [R::one() - b.t, b.t, R::zero(), R::zero()])
        }
    });
    let inner = (axes[2].len() * axes[3].len()) as u32;
    let mut sum = [R::zero(); K];
    for a in 0..4 {
        let base = front.0[a].times(inner);
        let mut part = [R::zero(); K];
        for b in 0..if D == 4 { 4 } else { 2 } {
            let found = R::gather::<K>(table, base.plus(back.0[b]).times(stride));
            for k in 0..K {
                part[k] = part[k] + back.1[b] * found[k];
            }
        }
        for k in 0..K {
            sum[k] = sum[k] + front.1[a] * part[k];
        }
    }
    sum
}

/// The four nodes around (x, y) of two axes, and their weights.
#[inline(always)]
fn pair<R: Number>(first: &Axis, second: &Axis, x: R, y: R) -> ([R::Index; 4], [R; 4]) {
    let (a, b) = (first.around(x), second.around(y));
    let n = second.len() as u32;
    let (low, high) = (a.low.times(n), a.high.times(n));
    let (one, s, t) = (R::one(), a.t, b.t);
    (
        [
            low.plus(b.low),
            low.plus(b.high),
            high.plus(b.low),
            high.plus(b.high),
        ],
        [(one - s) * (one - t), (one - s) * t, s * (one - t), s * t],
    )
}

/// The densities to draw from for a grid.
fn views(grid: &Grid, f: &impl Fn(Vec3<f64>, Vec3<f64>) -> f64) -> Views {
    let axes = grid.axes();
    match grid.parameterization() {
        Parameterization::HalfDifference => {
            let cells = Cells {
                chart: Chart::Half,
                edges: rings(&axes[0], 128),
                columns: 48,
                isotropic: true,
            };
            Views::new(&cells, half_elevations(), Axis::single(), f)
        }
        Parameterization::HalfDifferenceAnisotropic => {
            let cells = Cells {
                chart: Chart::Half,
                edges: rings(&axes[0], 64),
                columns: axes[1].len().clamp(24, 64),
                isotropic: false,
            };
            let phi = Axis::regular(0.0, TAU / 24.0, 24, Boundary::Periodic(TAU))
                .expect("invariant: increasing within a period");
            Views::new(&cells, half_elevations(), phi, f)
        }
        Parameterization::Spherical => {
            let cells = Cells {
                chart: Chart::Incoming,
                edges: rings(&axes[0], 180),
                columns: refined(columns_of(&axes[2]), 48).min(360),
                isotropic: true,
            };
            let most = MOST_DENSITIES / ((cells.edges.len() - 1) * cells.columns);
            Views::new(&cells, thinned(&axes[1], most), Axis::single(), f)
        }
        Parameterization::SphericalAnisotropic => {
            let columns = columns_of(&axes[1]).clamp(1, 144);
            let cells = Cells {
                chart: Chart::Incoming,
                edges: rings(&axes[0], 90),
                columns: refined(columns, 24),
                isotropic: false,
            };
            let most = MOST_DENSITIES / ((cells.edges.len() - 1) * cells.columns);
            let phi = thinned(&axes[3], (most / axes[2].len().min(24)).max(4));
            let theta = thinned(&axes[2], (most / phi.len()).max(4));
            Views::new(&cells, theta, phi, f)
        }
    }
}

fn half_elevations() -> Axis {
    let nodes = HALF_VIEWS_DEG.iter().map(|deg| radians(*deg)).collect();
    Axis::new(nodes, Boundary::Clamped, Scale::Linear).expect("invariant: increasing")
}

/// sin²θ of rings that begin and end at the axis's nodes, cut finer until there are at least 24, and at most about `most`.
fn rings(axis: &Axis, most: usize) -> Vec<f64> {
    let mut theta = vec![0.0];
    theta.extend(
        axis.nodes()
            .iter()
            .copied()
            .filter(|t| *t > 1e-6 && *t < FRAC_PI_2 - 1e-6),
    );
    theta.push(FRAC_PI_2);
    while theta.len() > most.max(2) {
        // Every second inner edge goes; both ends stay.
        let last = theta.len() - 1;
        theta = (0..=last)
            .filter(|k| k % 2 == 0 || *k == last)
            .map(|k| theta[k])
            .collect();
    }
    while theta.len() <= 24 {
        theta = theta
            .windows(2)
            .flat_map(|p| [p[0], 0.5 * (p[0] + p[1])])
            .chain([FRAC_PI_2])
            .collect();
    }
    let mut edges: Vec<f64> = theta
        .iter()
        .map(|t| gonio_num::Real::sin(*t).powi(2))
        .collect();
    edges.dedup_by(|b, a| *b as f32 <= *a as f32);
    if let Some(last) = edges.last_mut() {
        *last = 1.0;
    }
    edges
}

/// Steps of a whole turn in the axis's spacing.
fn columns_of(axis: &Axis) -> usize {
    match axis.boundary() {
        Boundary::Mirrored(_) => 2 * (axis.len() - 1).max(1),
        _ => axis.len(),
    }
}

/// `n` or the smallest multiple of it that is at least `least`.
fn refined(n: usize, least: usize) -> usize {
    n * least.div_ceil(n).max(1)
}

/// The axis with at most about `most` of its nodes, evenly chosen, the ends kept.
fn thinned(axis: &Axis, most: usize) -> Axis {
    let step = axis.len().div_ceil(most.max(2));
    if step <= 1 {
        return axis.clone();
    }
    let last = axis.len() - 1;
    let keep_last = axis.boundary() == Boundary::Clamped;
    let nodes = (0..=last)
        .filter(|k| k % step == 0 || (keep_last && *k == last))
        .map(|k| axis.nodes()[k])
        .collect();
    Axis::new(nodes, axis.boundary(), axis.scale()).unwrap_or_else(|_| axis.clone())
}
