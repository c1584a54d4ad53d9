//! [`Rings`], drawing from a tree of rank 3.
//!
//! Turning the light about the normal moves the viewer's direction, in the frame of the light, along a circle about the centre of the
//! disc: in the square, along the border of a smaller square, evenly in azimuth. So for a viewer at distance ρ from the centre, in cells of
//! the finest size, the function of the incoming direction is constant between the cells' borders: over bands of sinθi and steps along
//! the four sides. Of these steps all but the eight at the corners are whole cells, whatever ρ is between two whole numbers k and
//! k + 1; those eight are ρ − k long. Tables of both kinds for each k therefore serve every viewer, exactly.

use super::super::search::interval;
use super::super::views::accumulate;
use super::TensorTree;
use crate::part::geometry::turned;
use crate::{Index, Number};
use gonio_num::Vec3;
use gonio_radiometry::warp::around_axis;
use std::f64::consts::FRAC_PI_4;

/// The finest tree that is drawn from: 2⁻⁹, 300 MiB of tables.
const DEEPEST: u32 = 9;

/// Bands × steps for each whole distance of the viewer.
#[derive(Debug, Clone)]
pub(super) struct Rings {
    /// Bands of sinθi, and whole distances: half of the cells along a side.
    half: u32,
    /// For each k (luminance × ½ Δsin²θi of all whole steps, of all corner steps), each step counted as one cell long.
    totals: Vec<f32>,
    whole: Steps,
    corner: Steps,
}

/// Cumulative probabilities of one kind of step.
#[derive(Debug, Clone)]
struct Steps {
    bands: Vec<f32>,
    along: Vec<f32>,
}

impl Rings {
    /// Of a tree of rank 3; `light` is the luminance of a leaf.
    pub fn new(tree: &TensorTree, light: &impl Fn(u32) -> f64) -> Result<Self, (String, String)> {
        if tree.depth > DEEPEST {
            return Err((
                format!("an isotropic tree with squares of 2^-{}", tree.depth),
                format!("2^-{DEEPEST} at the finest"),
            ));
        }
        let half = 1usize << (tree.depth.max(1) - 1);
        let n = 2.0 * half as f64;
        let value = |band: usize, x: isize, y: isize| {
            let centre = |k: isize| (k as f64 + half as f64 + 0.5) / n;
            let at = [(band as f64 + 0.5) / n, centre(x), centre(y), 0.0];
            light(tree.find(at))
        };
        let empty = || Steps {
            bands: Vec::new(),
            along: Vec::new(),
        };
        let mut this = Self {
            half: half as u32,
            totals: Vec::new(),
            whole: empty(),
            corner: empty(),
        };
        for k in 0..half as isize {
            let whole: Vec<(isize, isize)> = (0..4)
                .flat_map(|side| (-k..k).map(move |m| cell(side, k, m)))
                .collect();
            let corner: Vec<(isize, isize)> = (0..4)
                .flat_map(|side| [cell(side, k, -k - 1), cell(side, k, k)])
                .collect();
            for (cells, steps) in [(&whole, &mut this.whole), (&corner, &mut this.corner)] {
                let mut bands = Vec::with_capacity(half);
                for band in 0..half {
                    let outer = 1.0 - 2.0 * band as f64 / n;
                    let inner = outer - 2.0 / n;
                    let weight = 0.5 * (outer * outer - inner * inner);
                    let masses: Vec<f64> = cells
                        .iter()
                        .map(|(x, y)| value(band, *x, *y) * weight)
                        .collect();
                    bands.push(masses.iter().sum::<f64>());
                    // At k = 0 there are no whole steps; a table of one keeps the places regular.
                    if masses.is_empty() {
                        steps.along.extend([0.0]);
                    } else {
                        accumulate(masses.iter().copied(), &mut steps.along);
                    }
                }
                this.totals.push(bands.iter().sum::<f64>() as f32);
                accumulate(bands.iter().copied(), &mut steps.bands);
            }
        }
        // Two numbers are read at a time.
        this.whole.along.push(0.0);
        Ok(this)
    }

    /// (k, k as a real, ρ − k, ρ) of a viewer's direction.
    #[inline(always)]
    fn place<R: Number>(&self, wo: Vec3<R>) -> (R::Index, R, R, R) {
        let r2 = wo.x * wo.x + wo.y * wo.y;
        let rho = r2.max(R::lit(1e-30)).sqrt() * R::lit(f64::from(self.half));
        let rho = rho.clamp(R::lit(1e-6), R::lit(f64::from(self.half)));
        let k = rho.index(self.half - 1);
        let whole = R::from_index(k);
        (k, whole, rho - whole, rho)
    }

    /// The luminous albedo.
    #[inline(always)]
    pub fn albedo<R: Number>(&self, wo: Vec3<R>) -> R {
        let (k, _, rest, rho) = self.place(wo);
        let [whole, corner] = R::gather(&self.totals, k.times(2));
        R::lit(FRAC_PI_4) * (whole + rest * corner) / rho
    }

    /// Draws a direction with z ≥ 0.
    #[inline(always)]
    pub fn sample<R: Number>(&self, wo: Vec3<R>, u: [R; 3]) -> Vec3<R> {
        let (k, k_real, rest, rho) = self.place(wo);
        let [whole, corner] = R::gather(&self.totals, k.times(2));
        let at_corner = u[2].lt(rest * corner / (whole + rest * corner).max(R::lit(1e-37)));

        // Eight steps at the corners, 8k whole ones; the tables of the distances before this one have Σ (8j + 1) = k (4k − 3) + … places.
        let half = self.half;
        let bands = k.times(half + 1);
        let (band_a, t_a) = interval(&self.corner.bands, bands, half, u[1]);
        let (band_b, t_b) = interval(&self.whole.bands, bands, half, u[1]);
        let last = (1 << 24) - 1;
        let before = (k_real * (R::lit(4.0) * k_real - R::lit(3.0)))
            .max(R::zero())
            .index(last);
        let (step_a, v_a) = {
            let at = k.times(half).plus(band_a).times(9);
            interval(&self.corner.along, at, 8, u[0])
        };
        let (step_b, v_b) = {
            // A row of 8k + 1 numbers for each band.
            let row = (k_real * R::lit(8.0) + R::one()) * R::from_index(band_b);
            let at = before.times(half).plus(row.index(last));
            let end = k_real * R::lit(8.0);
            interval_of(&self.whole.along, at, end, u[0], 8 * half)
        };
        // Where along which side, in cells from its middle, counter-clockwise.
        let two = R::lit(2.0);
        let a = R::from_index(step_a);
        let side_a = (a * R::lit(0.5)).floor();
        let upper = (a - two * side_a).gt(R::lit(0.5));
        let along_a = R::select(
            upper,
            k_real + v_a * rest,
            -k_real - (R::one() - v_a) * rest,
        );
        let b = R::from_index(step_b);
        let side_b = ((b + R::lit(0.5)) / (two * k_real).max(R::one())).floor();
        let along_b = b - side_b * two * k_real - k_real + v_b;
        let side = R::select(at_corner, side_a, side_b);
        let along = R::select(at_corner, along_a, along_b);
        let band = R::select(at_corner, R::from_index(band_a), R::from_index(band_b));
        let t = R::select(at_corner, t_a, t_b);

        let per_band = R::lit(1.0 / f64::from(half));
        let outer = R::one() - band * per_band;
        let inner = (outer - per_band).max(R::zero());
        let s2 = t.lerp(inner * inner, outer * outer);
        let (sin, cos) = (s2.safe_sqrt(), (R::one() - s2).safe_sqrt());
        // The viewer's azimuth in the frame of where light travels to, in turns.
        let turns = (side + R::lit(0.5) * along / rho) * R::lit(0.25);
        let travels = around_axis(-turns, sin, cos);
        let r2 = wo.x * wo.x + wo.y * wo.y;
        let normal = r2.lt(R::lit(1e-30));
        let r = r2.max(R::lit(1e-30)).sqrt();
        let travels = turned(
            travels,
            R::select(normal, R::one(), wo.x / r),
            R::select(normal, R::zero(), wo.y / r),
        );
        Vec3::new(-travels.x, -travels.y, travels.z)
    }
}

/// As [`interval`], over `count` intervals that differ from lane to lane, at most `most`.
#[inline(always)]
fn interval_of<R: Number>(
    table: &[f32],
    start: R::Index,
    count: R,
    u: R,
    most: u32,
) -> (R::Index, R) {
    let mut at = R::Index::splat(0);
    let mut half = most.next_power_of_two() / 2;
    while half > 0 {
        let probe = at.plus(R::Index::splat(half));
        let [value] = R::gather(table, start.plus(probe));
        let inside = R::from_index(probe).lt(count);
        at = R::select_index(inside & value.le(u), probe, at);
        half /= 2;
    }
    let [low, high] = R::gather(table, start.plus(at));
    let t = (u - low) / (high - low).max(R::lit(1e-30));
    (at, t.saturate())
}

/// The cell, counted from the centre, in which lies the point at distance k … k + 1 towards `side` (0 right, 1 up, 2 left, 3 down)
/// and m … m + 1 along it, counter-clockwise.
fn cell(side: usize, k: isize, m: isize) -> (isize, isize) {
    match side {
        0 => (k, m),
        1 => (-m - 1, k),
        2 => (-k - 1, -m - 1),
        _ => (m, -k - 1),
    }
}
