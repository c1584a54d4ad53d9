//! Directional albedo of white microfacet surfaces: by quadrature, and as tables for energy compensation.

use super::distribution::{Distribution, Shape};
use super::geometry::Half;
use super::masking::{Masking, smith_g1_over_cos, visibility};
use super::masking_table::{self, alpha_coordinate, tail_at, tail_coordinate};
use super::special::{GAUSS_LEGENDRE_16, integral};
use super::table_data::{self, bytes_to_numbers};
use gonio_num::{Real, Table1, Table2, Table3, Vec3, Work};
use gonio_radiometry::warp::around_axis;
use std::f64::consts::TAU;

/// Samples of a table along √μ, from 0 to 1.
pub const WIDTH: usize = 32;
/// Samples of a table along the roughness √α, from 0 to 1, for a shape without a tail parameter.
pub const HEIGHT: usize = 32;
/// Samples along the fourth root of α for a shape with a tail.
pub const LOW_HEIGHT: usize = 16;
/// Samples along the tail.
pub const DEPTH: usize = 8;

/// How many samples each side of the table of a shape has: along √μ, √α and the tail.
pub const fn sides(shape: Shape) -> [usize; 3] {
    match shape.tail() {
        None => [WIDTH, HEIGHT, 1],
        Some(_) => [WIDTH, LOW_HEIGHT, DEPTH],
    }
}

/// Every distribution with every masking, in the order of the tables.
pub fn combinations() -> impl Iterator<Item = (Shape, Masking)> {
    Shape::ALL.into_iter().flat_map(|shape| {
        Masking::ALL
            .into_iter()
            .map(move |masking| (shape, masking))
    })
}

/// Directional albedo E(μ) = ∫ D G/(4 cosθi cosθr) cosθi dωi of an isotropic surface with reflectance 1 at every angle.
///
/// - `d`: isotropic
/// - `mu`: cosine of the viewer's direction, [0, 1]; below 1e-6 it is taken for 1e-6
///
/// Accurate to about 1e-5, to 1e-4 where a distribution has a long tail.
pub fn directional_albedo(d: &Distribution<f64>, masking: Masking, mu: f64) -> f64 {
    let mu = mu.clamp(1e-6, 1.0);
    let wo = Vec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
    match d.shape() {
        Shape::Beckmann | Shape::Ggx | Shape::BlinnPhong => by_sampling(d, masking, wo),
        _ => over_normals(d, masking, wo),
    }
}

/// Quadrature in the random numbers of an importance sampler, where the integrand is smooth: Gauss–Legendre in panels for the polar one, the
/// trapezoid rule for the periodic one.
fn by_sampling(d: &Distribution<f64>, masking: Masking, wo: Vec3<f64>) -> f64 {
    let (panels, turns) = (6, 48);
    let mut sum = 0.0;
    for panel in 0..panels {
        for (node, weight) in GAUSS_LEGENDRE_16 {
            for side in [-1.0, 1.0] {
                // u = t² (3 − 2t) gathers nodes at both ends, where the integrand bends most.
                let t = (f64::from(panel) + 0.5 * (1.0 + side * node)) / f64::from(panels);
                let u1 = t * t * (3.0 - 2.0 * t);
                let du = 6.0 * t * (1.0 - t) * weight / f64::from(panels);
                for k in 0..turns {
                    // One half turn: the other is its mirror image.
                    let u0 = (f64::from(k) + 0.5) / f64::from(2 * turns);
                    sum += du / f64::from(turns) * sample_weight(d, masking, wo, u0, u1);
                }
            }
        }
    }
    sum
}

/// Quadrature over the normals: over ln tanθh, since tails matter from far below α to the horizon, and φh.
fn over_normals(d: &Distribution<f64>, masking: Masking, wo: Vec3<f64>) -> f64 {
    let turns = 32;
    let least: f64 = 2.0 * Real::ln(d.alpha_x()) - 5.0;
    let panels = ((10.0 - least) * 0.5) as u32;
    let sum: f64 = integral(least, 10.0, panels, |y: f64| {
        let tan = Real::exp(y);
        let cos = 1.0 / (1.0 + tan * tan).sqrt();
        let sin = tan * cos;
        let mut ring = 0.0;
        for k in 0..turns {
            let h = around_axis((f64::from(k) + 0.5) / f64::from(2 * turns), sin, cos);
            let cos_d = wo.dot(h);
            let wi = wo.reflect(h);
            if cos_d > 0.0 && wi.z > 0.0 {
                let half = Half::of(h, cos_d);
                ring += visibility(masking, d, wi, wo, &half) * wi.z * cos_d;
            }
        }
        // dωi = 4 (ωr·h) dωh, dωh = sin²θ cosθ dy dφ, and D is the same all round.
        let density = d.density(Vec3::new(sin, 0.0, cos));
        4.0 * density * ring * TAU / f64::from(turns) * sin * sin * cos
    });
    sum
}

/// f·cosθi/pdf of the direction that (u0, u1) draws.
fn sample_weight(d: &Distribution<f64>, masking: Masking, wo: Vec3<f64>, u0: f64, u1: f64) -> f64 {
    let visible = d.shape() == Shape::Ggx;
    let h = if visible {
        d.sample_visible_ggx(wo, u0, u1)
    } else {
        d.sample_normal(u0, u1)
    };
    let cos = wo.dot(h);
    let wi = wo.reflect(h);
    if cos <= 0.0 || wi.z <= 0.0 {
        return 0.0;
    }
    let half = Half::of(h, cos);
    // Visible normals have the density D G₁(ωr)/(4 cosθr) of ωi; all have that of the normal over 4 cosθ′.
    let density = d.density(h);
    let pdf = if visible {
        0.25 * density * smith_g1_over_cos(d, wo)
    } else {
        0.25 * d.normal_density(h, density) / cos
    };
    density * visibility(masking, d, wi, wo, &half) * wi.z / pdf
}

/// α at the place y in [0, 1] of a shape's table: even in √α, or as that of masking for a shape with a tail.
fn alpha_at(shape: Shape, y: f64) -> f64 {
    if shape.tail().is_some() {
        masking_table::alpha_at(y)
    } else {
        y * y
    }
}

/// The loss 1 − E at a place (√μ, y, tail) of a shape's table; nothing is gained on any surface.
fn loss(shape: Shape, masking: Masking, x: f64, y: f64, z: f64) -> f64 {
    let alpha = alpha_at(shape, y);
    let d = Distribution::new(shape, alpha, alpha, tail_at(shape, z));
    (1.0 - directional_albedo(&d, masking, x * x)).max(0.0)
}

/// The numbers of one distribution and masking: the losses 1 − E over (√μ, α, tail), √μ fastest, and for each (α, tail) the mean
/// loss 2 ∫ (1 − E(μ)) μ dμ of the interpolated row.
///
/// Entries are lowered by what interpolation overshoots around them: the interpolated table then stays below the true loss
/// (but for 1e-5 or so), and a surface with the compensating lobe never returns more than it gets.
pub fn tabulate(shape: Shape, masking: Masking) -> Vec<f32> {
    let mut block = table_data::tabulate(sides(shape), false, &|x, y, z| {
        loss(shape, masking, x, y, z)
    });
    let means: Vec<f32> = block.chunks(WIDTH).map(row_mean).collect();
    block.extend(means);
    block
}

/// One entry of [`tabulate`], at a node.
pub fn table_entry(shape: Shape, masking: Masking, at: [usize; 3]) -> f32 {
    table_data::entry_below(sides(shape), at, &mut |x, y, z| {
        loss(shape, masking, x, y, z)
    })
}

/// 4 ∫₀¹ loss(s) s³ ds with s = √μ, exactly for the linear interpolation of the row.
pub(super) fn row_mean(row: &[f32]) -> f32 {
    let n = row.len() - 1;
    let mut sum = 0.0;
    for i in 0..n {
        let (a, b) = (i as f64 / n as f64, (i + 1) as f64 / n as f64);
        let (fa, fb) = (f64::from(row[i]), f64::from(row[i + 1]));
        let slope = (fb - fa) / (b - a);
        // ∫ (fa + slope (s − a)) s³ ds from a to b.
        let (s4, s5) = (b.powi(4) - a.powi(4), b.powi(5) - a.powi(5));
        sum += (fa - slope * a) * s4 / 4.0 + slope * s5 / 5.0;
    }
    (4.0 * sum) as f32
}

/// Numbers kept for one distribution and masking: the losses, then their means.
const fn size(shape: Shape) -> usize {
    let [w, h, d] = sides(shape);
    (w + 1) * h * d
}

const FLOATS: usize = start(Shape::ALL.len() * Masking::ALL.len());

/// Where the numbers of combination `k` begin.
const fn start(k: usize) -> usize {
    let (mut sum, mut i) = (0, 0);
    while i < k {
        sum += size(Shape::ALL[i / Masking::ALL.len()]);
        i += 1;
    }
    sum
}

/// The tables as `examples/tabulate.rs` writes them: little-endian `f32`, blocks in the order of [`combinations`].
static DATA: [f32; FLOATS] = bytes_to_numbers(include_bytes!("albedo.bin"));

/// The tabulated losses of one distribution and masking.
#[derive(Debug)]
pub struct Loss {
    shape: Shape,
    tables: Tables,
}

#[derive(Debug)]
enum Tables {
    /// Over (√μ, √α), and √α.
    Flat(Table2, Table1),
    /// Over (√μ, ∜α, tail), and (∜α, tail).
    Cube(Table3, Table2),
}

impl Loss {
    /// 1 − E(μ) for reflectance 1, [0, 1].
    ///
    /// - `mu`: cosine, [0, 1]
    /// - `alpha`: slope scale
    /// - `tail`: that of the distribution
    #[inline(always)]
    pub fn directional<R: Real>(&'static self, mu: R, alpha: R, tail: R) -> R {
        let root = mu.saturate().max(R::lit(1e-20)).sqrt();
        match &self.tables {
            Tables::Flat(table, _) => R::table2(table, root, alpha.sqrt()),
            Tables::Cube(table, _) => R::out_of_line(InCube {
                table,
                shape: self.shape,
                at: [root, alpha, tail],
            }),
        }
    }

    /// 1 − E averaged over directions, 2 ∫ (1 − E(μ)) μ dμ.
    #[inline(always)]
    pub fn mean<R: Real>(&'static self, alpha: R, tail: R) -> R {
        match &self.tables {
            Tables::Flat(_, mean) => R::table1(mean, alpha.sqrt()),
            Tables::Cube(_, mean) => R::table2(
                mean,
                alpha_coordinate(alpha),
                tail_coordinate(self.shape, tail),
            ),
        }
    }
}

/// A look-up in the table of a shape with a tail, at √μ, α and the tail.
struct InCube<R> {
    table: &'static Table3,
    shape: Shape,
    at: [R; 3],
}

impl<R: Real> Work for InCube<R> {
    type Output = R;
    #[inline(always)]
    fn run(self) -> R {
        let [root, alpha, tail] = self.at;
        let tail = tail_coordinate(self.shape, tail);
        R::table3(self.table, root, alpha_coordinate(alpha), tail)
    }
}

const fn read(k: usize, name: &'static str, mean_name: &'static str) -> Loss {
    let shape = Shape::ALL[k / Masking::ALL.len()];
    let [width, height, depth] = sides(shape);
    let block = DATA.split_at(start(k)).1.split_at(size(shape)).0;
    let (losses, means) = block.split_at(width * height * depth);
    let tables = if depth == 1 {
        Tables::Flat(
            Table2 {
                name,
                width,
                height,
                data: losses,
            },
            Table1 {
                name: mean_name,
                data: means,
            },
        )
    } else {
        Tables::Cube(
            Table3 {
                name,
                width,
                height,
                depth,
                data: losses,
            },
            Table2 {
                name: mean_name,
                width: height,
                height: depth,
                data: means,
            },
        )
    };
    Loss { shape, tables }
}

macro_rules! losses {
    ($($k:literal $name:literal,)*) => {
        static LOSSES: [Loss; Shape::ALL.len() * Masking::ALL.len()] =
            [$(read($k, concat!("loss_", $name), concat!("mean_loss_", $name)),)*];
    };
}
losses! {
    0 "beckmann_v_cavity", 1 "beckmann_smith", 2 "beckmann_smith_correlated",
    3 "ggx_v_cavity", 4 "ggx_smith", 5 "ggx_smith_correlated",
    6 "blinn_phong_v_cavity", 7 "blinn_phong_smith", 8 "blinn_phong_smith_correlated",
    9 "gaussian_v_cavity", 10 "gaussian_smith", 11 "gaussian_smith_correlated",
    12 "gtr_v_cavity", 13 "gtr_smith", 14 "gtr_smith_correlated",
    15 "student_t_v_cavity", 16 "student_t_smith", 17 "student_t_smith_correlated",
    18 "sgd_v_cavity", 19 "sgd_smith", 20 "sgd_smith_correlated",
    21 "abc_v_cavity", 22 "abc_smith", 23 "abc_smith_correlated",
}

/// The tables of one distribution and masking.
pub fn losses(shape: Shape, masking: Masking) -> &'static Loss {
    &LOSSES[Masking::ALL.len() * shape.index() + masking.index()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_of_the_tables() {
        for (k, (shape, masking)) in combinations().enumerate() {
            assert!(std::ptr::eq(losses(shape, masking), &LOSSES[k]));
            let name = match &LOSSES[k].tables {
                Tables::Flat(t, _) => t.name,
                Tables::Cube(t, _) => t.name,
            };
            let word = Shape::NAMES[shape.index()].replace('-', "_");
            let mask = Masking::NAMES[masking.index()].replace('-', "_");
            assert_eq!(name, format!("loss_{word}_{mask}"));
        }
    }

    #[test]
    fn committed_tables_are_what_the_quadrature_gives() {
        for (k, (shape, masking)) in combinations().enumerate() {
            let [w, h, d] = sides(shape);
            let at = [3, h / 2, d / 2];
            let row = at[2] * h + at[1];
            let block = &DATA[start(k)..][..size(shape)];
            assert_eq!(row_mean(&block[row * w..][..w]), block[w * h * d + row]);
            // Both come from the same arithmetic; libm's functions are the same everywhere. Entries with a tail take long.
            if d == 1 || masking == Masking::Smith {
                let fresh = table_entry(shape, masking, at);
                assert_eq!(fresh, block[row * w + at[0]], "{shape:?} {masking:?}");
            }
        }
    }

    /// Both quadratures agree, but for the kinks of grooves and horizon.
    #[test]
    fn two_quadratures_agree() {
        for (shape, masking) in [
            (Shape::Ggx, Masking::SmithCorrelated),
            (Shape::Beckmann, Masking::VCavity),
        ] {
            for (alpha, mu) in [(0.1f64, 0.9f64), (0.5, 0.3), (1.0, 0.7)] {
                let d = Distribution::isotropic(shape, alpha);
                let wo = Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
                let (a, b) = (by_sampling(&d, masking, wo), over_normals(&d, masking, wo));
                assert!((a - b).abs() < 5e-4, "{shape:?} {alpha} {mu}: {a} {b}");
            }
        }
    }

    /// The loss between the table's nodes: never above the truth but for what the quadrature leaves, and little below it.
    #[test]
    fn interpolation_stays_below_the_truth() {
        for (shape, masking) in combinations() {
            for (y, mu, z) in [(0.31, 0.03, 0.4), (0.72, 0.55, 0.9), (1.0, 0.3, 0.07)] {
                let (alpha, tail) = (alpha_at(shape, y), tail_at(shape, z));
                let d = Distribution::new(shape, alpha, alpha, tail);
                let e = directional_albedo(&d, masking, mu);
                let found = losses(shape, masking).directional(mu, d.alpha_x(), d.tail());
                let short = (1.0 - e).max(0.0) - found;
                assert!(
                    short > -1e-4 && short < 1.2e-2,
                    "{shape:?} {masking:?} {y} {mu} {z}: {short}"
                );
            }
        }
    }
}
