//! [`Points`], a panorama as points with solid angles: a product of two rules, one for rows and one for columns.
//!
//! What is integrated is the picture as [`Environment::radiance`](gonio_env::Environment::radiance) shows it, linear between the centres of texels, so that its
//! light reaches half a texel farther than a texel's square.

use gonio_env::LatLongTexels;
use gonio_num::{Real, Vec3};
use gonio_radiometry::quadrature::GaussLegendre;
use std::f64::consts::{PI, TAU};

/// Columns of points at most, unless the picture itself has more: 8192 stand 8e-4 rad apart.
const MOST_COLUMNS: usize = 8192;
/// Pictures of fewer columns are divided further, so that the width of their texels is seen where the horizon cuts them.
const FEW_COLUMNS: usize = 512;

/// A row or a column of points.
#[derive(Debug, Clone, Copy)]
struct Node {
    sin: f64,
    cos: f64,
    /// What it stands for: ∫ dφ, or ∫ sin θ dθ.
    weight: f64,
    /// The texels before and after, and the share of the latter.
    texels: [usize; 2],
    share: f32,
}

/// The points of a panorama, each with its solid angle and the interpolated radiance.
pub(crate) struct Points<'a> {
    picture: LatLongTexels<'a>,
    /// From the zenith down.
    rows: Vec<Node>,
    /// From the seam.
    columns: Vec<Node>,
    /// Whether each point is the centre of a texel, and nothing is to be interpolated.
    whole: bool,
    /// World directions of the picture's axes.
    axes: [Vec3<f64>; 3],
}

impl<'a> Points<'a> {
    /// Points for a tree of lights: texels, each divided until a lobe of `width` sees no single points.
    ///
    /// A sum over a grid of step h misses the integral over a GGX lobe by about exp(−2π width/h), and the interpolated picture by the
    /// bend of the lobe over h: both are below 1e-3 at width = 3 h.
    pub fn of_tree(picture: &LatLongTexels<'a>, width: f64) -> Self {
        let split = (3.0 * step(picture) / width).ceil() as usize;
        let most = (MOST_COLUMNS / picture.width).max(1);
        Self::midpoints(picture, split.max(least(picture)).min(most))
    }

    /// Points for exact means: between the centres of texels, where the picture has no bends, two nodes of Gauss and Legendre along
    /// each axis, or more, so that they belong to parts no wider than a sixth of the lobe.
    ///
    /// Two nodes integrate f over h as exactly as h⁵ f⁗/4320; of a GGX lobe f⁗ ≤ 72/width⁴, so that h = width/6 errs by 1.3e-5 of the light of
    /// a single texel, of either sign, and by less over many. The horizon, where the kernel ends with a slope k, costs up to 0.019 k h² of
    /// a part that it cuts, h ≤ 0.012 at 512 columns: 3e-6 k. Pictures too large for that have points at the centres of texels, as fine as those of the others.
    pub fn of_reference(picture: &LatLongTexels<'a>, width: f64) -> Self {
        let parts = (6.0 * step(picture) / width).ceil() as usize;
        let most = MOST_COLUMNS / (2 * picture.width);
        match parts.max(least(picture)).min(most) {
            0 => Self::midpoints(picture, 1),
            parts => Self::gauss(picture, parts),
        }
    }

    /// `split` points along each side of a texel, in the middle of its parts.
    fn midpoints(picture: &LatLongTexels<'a>, split: usize) -> Self {
        let middle = |i: usize| (i as f64 + 0.5) / split as f64;
        let columns = picture.width * split;
        let across = TAU / columns as f64;
        // ∫ sin θ dθ over a part is 2 sin θ sin(half of it).
        let rows = picture.height * split;
        let down = 2.0 * Real::sin(0.5 * PI / rows as f64);
        let rows = (0..rows).map(|i| (middle(i), down));
        let columns = (0..columns).map(|i| (middle(i), across));
        Self::new(picture, rows, columns, split == 1)
    }

    fn gauss(picture: &LatLongTexels<'a>, parts: usize) -> Self {
        let rule = GaussLegendre::new(2);
        // A piece from the centre of one texel to that of the next, in `parts`; weights in texels.
        let nodes = |from: f64, to: f64| {
            let edge = move |k: usize| from + (to - from) * k as f64 / parts as f64;
            let of_part = |k| rule.on(edge(k), edge(k + 1)).collect::<Vec<_>>();
            (0..parts).flat_map(of_part).collect::<Vec<_>>()
        };
        let across = TAU / picture.width as f64;
        let down = PI / picture.height as f64;
        let columns = (0..picture.width).flat_map(|i| nodes(i as f64 + 0.5, i as f64 + 1.5));
        let last = picture.height as f64;
        let centres = (0..picture.height).map(|i| i as f64 + 0.5);
        // Beyond the outermost centres, up to the poles, rows are as they are.
        let mut edges: Vec<f64> = std::iter::once(0.0).chain(centres).collect();
        edges.push(last);
        let rows = edges.windows(2).flat_map(|e| nodes(e[0], e[1]));
        Self::new(
            picture,
            rows.map(|(v, w)| (v, down * w)),
            columns.map(|(u, w)| (u, across * w)),
            false,
        )
    }

    /// Of places along the picture, in texels, and the angles they stand for.
    fn new(
        picture: &LatLongTexels<'a>,
        rows: impl Iterator<Item = (f64, f64)>,
        columns: impl Iterator<Item = (f64, f64)>,
        whole: bool,
    ) -> Self {
        let (w, h) = (picture.width, picture.height);
        let columns = columns.map(|(u, weight)| {
            let phi = TAU * (u / w as f64 - 0.5);
            let x = u - 0.5;
            let at = |k: f64| (k as i64).rem_euclid(w as i64) as usize;
            Node {
                sin: Real::sin(phi),
                cos: Real::cos(phi),
                weight,
                texels: [at(x.floor()), at(x.floor() + 1.0)],
                share: (x - x.floor()) as f32,
            }
        });
        let rows = rows.map(|(v, angle)| {
            let theta = PI * v / h as f64;
            let y = (v - 0.5).clamp(0.0, (h - 1) as f64);
            let above = y as usize;
            Node {
                sin: Real::sin(theta),
                cos: Real::cos(theta),
                weight: angle * Real::sin(theta),
                texels: [above, (above + 1).min(h - 1)],
                share: (y - above as f64) as f32,
            }
        });
        let axis = |x: f64, y: f64, z: f64| picture.to_world(Vec3::new(x, y, z));
        Self {
            picture: *picture,
            rows: rows.collect(),
            columns: columns.collect(),
            whole,
            axes: [
                axis(1.0, 0.0, 0.0),
                axis(0.0, 1.0, 0.0),
                axis(0.0, 0.0, 1.0),
            ],
        }
    }

    /// Rows of points, from the zenith down.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// Points of a row.
    pub fn columns(&self) -> usize {
        self.columns.len()
    }

    /// Whether any point of a row may meet the face around `axis`, which reaches to cos = 1/√3 from it.
    pub fn may_meet(&self, row: usize, axis: Vec3<f64>) -> bool {
        let Node { sin, cos, .. } = self.rows[row];
        let rise = self.axes[1].dot(axis);
        let nearest = cos * rise + sin * (1.0 - rise * rise).max(0.0).sqrt();
        nearest > 0.577
    }

    /// Calls `f` with the direction, solid angle and radiance of each point of a row.
    #[inline(always)]
    pub fn each_in_row(&self, row: usize, mut f: impl FnMut(Vec3<f64>, f64, [f32; 3])) {
        let row = self.rows[row];
        let [ax, ay, az] = self.axes;
        let up = ay * row.cos;
        let t = &self.picture;
        let scale = t.scale;
        let [above, below] = row.texels;
        let upper = &t.texels[above * t.width..(above + 1) * t.width];
        let lower = &t.texels[below * t.width..(below + 1) * t.width];
        for column in &self.columns {
            let d = up + ax * (row.sin * column.sin) - az * (row.sin * column.cos);
            let [left, right] = column.texels;
            let mut rgb = [0.0; 3];
            if self.whole {
                for c in 0..3 {
                    rgb[c] = upper[left][c] * scale[c];
                }
            } else {
                let (s, down) = (column.share, row.share);
                for c in 0..3 {
                    let high = upper[left][c] * (1.0 - s) + upper[right][c] * s;
                    let low = lower[left][c] * (1.0 - s) + lower[right][c] * s;
                    rgb[c] = (high * (1.0 - down) + low * down) * scale[c];
                }
            }
            f(d, row.weight * column.weight, rgb);
        }
    }
}

/// The angle between texels.
fn step(picture: &LatLongTexels<'_>) -> f64 {
    PI / picture.height.min(picture.width.div_ceil(2)) as f64
}

/// Parts of a texel that a small picture has at least.
fn least(picture: &LatLongTexels<'_>) -> usize {
    FEW_COLUMNS.div_ceil(picture.width)
}
