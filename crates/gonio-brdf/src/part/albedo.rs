//! Directional albedo of white microfacet surfaces: by quadrature, and as tables for energy compensation.

use super::distribution::{Distribution, Shape};
use super::geometry::Half;
use super::masking::{Masking, smith_g1_over_cos, visibility};
use super::special::GAUSS_LEGENDRE_16;
use gonio_num::{Real, Table1, Table2, Vec3};

/// Samples of a table along √μ, from 0 to 1.
pub const WIDTH: usize = 32;
/// Samples of a table along the roughness √α, from 0 to 1.
pub const HEIGHT: usize = 32;
/// Numbers kept for each distribution and masking: the losses, then their means.
pub const BLOCK: usize = WIDTH * HEIGHT + HEIGHT;

/// Every distribution with every masking, in the order of the tables.
pub const COMBINATIONS: [(Shape, Masking); 9] = [
    (Shape::Beckmann, Masking::VCavity),
    (Shape::Beckmann, Masking::Smith),
    (Shape::Beckmann, Masking::SmithCorrelated),
    (Shape::Ggx, Masking::VCavity),
    (Shape::Ggx, Masking::Smith),
    (Shape::Ggx, Masking::SmithCorrelated),
    (Shape::BlinnPhong, Masking::VCavity),
    (Shape::BlinnPhong, Masking::Smith),
    (Shape::BlinnPhong, Masking::SmithCorrelated),
];

/// Directional albedo E(μ) = ∫ D G/(4 cosθi cosθr) cosθi dωi of an isotropic surface with reflectance 1 at every angle.
///
/// - `alpha`: slope scale, (0, 1]
/// - `mu`: cosine of the viewer's direction, [0, 1]; below 1e-6 it is taken for 1e-6
///
/// Quadrature in the random numbers of an importance sampler, where the integrand is smooth: Gauss–Legendre in panels for the polar one, the
/// trapezoid rule for the periodic one. Accurate to about 1e-5.
pub fn directional_albedo(shape: Shape, masking: Masking, alpha: f64, mu: f64) -> f64 {
    let (panels, turns) = (6, 48);
    let d = Distribution {
        shape,
        alpha_x: alpha,
        alpha_y: alpha,
    };
    let mu = mu.clamp(1e-6, 1.0);
    let wo = Vec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
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
                    sum += du / f64::from(turns) * sample_weight(&d, masking, wo, u0, u1);
                }
            }
        }
    }
    sum
}

/// f·cosθi/pdf of the direction that (u0, u1) draws.
fn sample_weight(d: &Distribution<f64>, masking: Masking, wo: Vec3<f64>, u0: f64, u1: f64) -> f64 {
    let visible = d.shape == Shape::Ggx;
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
    let half = Half { h, cos };
    // The density of ωi over D: G₁(ωr)/(4 cosθr) for visible normals, h.z/(4 cosθ′) for all.
    let pdf_over_d = if visible {
        0.25 * smith_g1_over_cos(d, wo)
    } else {
        0.25 * h.z / cos
    };
    visibility(masking, d, wi, wo, &half) * wi.z / pdf_over_d
}

/// The block of [`BLOCK`] numbers of one distribution and masking: the losses 1 − E at (√μ, √α), row by row, and for each √α
/// the mean loss 2 ∫ (1 − E(μ)) μ dμ of the interpolated row.
pub fn tabulate(shape: Shape, masking: Masking) -> Vec<f32> {
    let (w, h) = (2 * WIDTH - 1, 2 * HEIGHT - 1);
    let mut fine = Vec::with_capacity(w * h);
    for j in 0..h {
        for i in 0..w {
            fine.push(fine_loss(shape, masking, i, j));
        }
    }
    let mut block = Vec::with_capacity(BLOCK);
    for j in 0..HEIGHT {
        for i in 0..WIDTH {
            block.push(entry(i, j, &mut |i, j| fine[j * w + i]));
        }
    }
    for j in 0..HEIGHT {
        block.push(row_mean(&block[j * WIDTH..(j + 1) * WIDTH]));
    }
    block
}

/// One entry of [`tabulate`]: the loss at √μ = i/(`WIDTH` − 1), √α = j/(`HEIGHT` − 1).
pub fn table_entry(shape: Shape, masking: Masking, i: usize, j: usize) -> f32 {
    entry(i, j, &mut |i, j| fine_loss(shape, masking, i, j))
}

/// The loss at half the table's steps; nothing is lost on a smooth surface, nor gained on any.
fn fine_loss(shape: Shape, masking: Masking, i: usize, j: usize) -> f64 {
    if j == 0 {
        return 0.0;
    }
    let root_mu = i as f64 / (2 * WIDTH - 2) as f64;
    let roughness = j as f64 / (2 * HEIGHT - 2) as f64;
    (1.0 - directional_albedo(shape, masking, roughness.powi(2), root_mu.powi(2))).max(0.0)
}

/// The loss at a node, less what bilinear interpolation overshoots in the cells around it: the interpolated table then stays below
/// the true loss (but for 1e-5 or so), and a surface with the compensating lobe never returns more than it gets.
fn entry(i: usize, j: usize, fine: &mut impl FnMut(usize, usize) -> f64) -> f32 {
    let mut overshoot: f64 = 0.0;
    for (ci, cj) in [
        (i.wrapping_sub(1), j.wrapping_sub(1)),
        (i, j.wrapping_sub(1)),
        (i.wrapping_sub(1), j),
        (i, j),
    ] {
        // Cells beyond the border wrapped around to huge numbers.
        if ci >= WIDTH - 1 || cj >= HEIGHT - 1 {
            continue;
        }
        let (x, y) = (2 * ci, 2 * cj);
        let corners = [
            fine(x, y),
            fine(x + 2, y),
            fine(x, y + 2),
            fine(x + 2, y + 2),
        ];
        for (dx, dy) in [(1, 0), (0, 1), (1, 1), (2, 1), (1, 2)] {
            let (u, v) = (0.5 * f64::from(dx), 0.5 * f64::from(dy));
            let between = (1.0 - v) * ((1.0 - u) * corners[0] + u * corners[1])
                + v * ((1.0 - u) * corners[2] + u * corners[3]);
            overshoot = overshoot.max(between - fine(x + dx as usize, y + dy as usize));
        }
    }
    (fine(2 * i, 2 * j) - overshoot).max(0.0) as f32
}

/// 4 ∫₀¹ loss(s) s³ ds with s = √μ, exactly for the linear interpolation of the row.
fn row_mean(row: &[f32]) -> f32 {
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

/// The tables as `examples/tabulate_albedo.rs` writes them: little-endian `f32`, blocks in the order of [`COMBINATIONS`].
static DATA: [[f32; BLOCK]; COMBINATIONS.len()] = decode(include_bytes!("albedo.bin"));

const fn decode<const B: usize>(bytes: &[u8; B]) -> [[f32; BLOCK]; COMBINATIONS.len()] {
    assert!(B == 4 * BLOCK * COMBINATIONS.len());
    let mut out = [[0.0; BLOCK]; COMBINATIONS.len()];
    let mut at = 0;
    while at < B / 4 {
        let b = [
            bytes[4 * at],
            bytes[4 * at + 1],
            bytes[4 * at + 2],
            bytes[4 * at + 3],
        ];
        out[at / BLOCK][at % BLOCK] = f32::from_le_bytes(b);
        at += 1;
    }
    out
}

/// The tabulated losses of one distribution and masking.
#[derive(Debug)]
pub struct Loss {
    directional: Table2,
    mean: Table1,
}

impl Loss {
    /// 1 − E(μ) for reflectance 1, [0, 1].
    ///
    /// - `mu`: cosine, [0, 1]
    /// - `roughness`: √α, [0, 1]
    #[inline(always)]
    pub fn directional<R: Real>(&'static self, mu: R, roughness: R) -> R {
        R::table2(
            &self.directional,
            mu.saturate().max(R::lit(1e-20)).sqrt(),
            roughness,
        )
    }

    /// 1 − E averaged over directions, 2 ∫ (1 − E(μ)) μ dμ.
    #[inline(always)]
    pub fn mean<R: Real>(&'static self, roughness: R) -> R {
        R::table1(&self.mean, roughness)
    }
}

const fn loss(k: usize, name: &'static str, mean_name: &'static str) -> Loss {
    let (losses, means) = DATA[k].split_at(WIDTH * HEIGHT);
    Loss {
        directional: Table2 {
            name,
            width: WIDTH,
            height: HEIGHT,
            data: losses,
        },
        mean: Table1 {
            name: mean_name,
            data: means,
        },
    }
}

static LOSSES: [Loss; COMBINATIONS.len()] = [
    loss(0, "loss_beckmann_v_cavity", "mean_loss_beckmann_v_cavity"),
    loss(1, "loss_beckmann_smith", "mean_loss_beckmann_smith"),
    loss(
        2,
        "loss_beckmann_smith_correlated",
        "mean_loss_beckmann_smith_correlated",
    ),
    loss(3, "loss_ggx_v_cavity", "mean_loss_ggx_v_cavity"),
    loss(4, "loss_ggx_smith", "mean_loss_ggx_smith"),
    loss(
        5,
        "loss_ggx_smith_correlated",
        "mean_loss_ggx_smith_correlated",
    ),
    loss(
        6,
        "loss_blinn_phong_v_cavity",
        "mean_loss_blinn_phong_v_cavity",
    ),
    loss(7, "loss_blinn_phong_smith", "mean_loss_blinn_phong_smith"),
    loss(
        8,
        "loss_blinn_phong_smith_correlated",
        "mean_loss_blinn_phong_smith_correlated",
    ),
];

/// The tables of one distribution and masking.
pub fn losses(shape: Shape, masking: Masking) -> &'static Loss {
    let s = match shape {
        Shape::Beckmann => 0,
        Shape::Ggx => 1,
        Shape::BlinnPhong => 2,
    };
    let m = match masking {
        Masking::VCavity => 0,
        Masking::Smith => 1,
        Masking::SmithCorrelated => 2,
    };
    &LOSSES[3 * s + m]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_of_the_tables() {
        for (k, (shape, masking)) in COMBINATIONS.into_iter().enumerate() {
            assert!(std::ptr::eq(losses(shape, masking), &LOSSES[k]));
        }
    }

    #[test]
    fn committed_tables_are_what_the_quadrature_gives() {
        for (k, (shape, masking)) in COMBINATIONS.into_iter().enumerate() {
            for (i, j) in [(0, 9), (20, 15)] {
                let fresh = table_entry(shape, masking, i, j);
                // Both come from the same arithmetic; libm's functions are the same everywhere.
                assert_eq!(
                    fresh,
                    DATA[k][j * WIDTH + i],
                    "{shape:?} {masking:?} {i} {j}"
                );
            }
            let j = 20;
            let row = &DATA[k][j * WIDTH..(j + 1) * WIDTH];
            assert_eq!(row_mean(row), DATA[k][WIDTH * HEIGHT + j]);
        }
    }

    /// The loss between the table's nodes: never above the truth, and this much below it at most.
    #[test]
    fn interpolation_stays_below_the_truth() {
        for (shape, masking) in COMBINATIONS {
            for (roughness, mu) in [
                (0.31, 0.03),
                (0.47, 0.2),
                (0.72, 0.55),
                (0.9, 0.9),
                (1.0, 0.3),
            ] {
                let e = directional_albedo(shape, masking, roughness * roughness, mu);
                let short = (1.0 - e).max(0.0) - losses(shape, masking).directional(mu, roughness);
                assert!(
                    short > -1e-4 && short < 4e-3,
                    "{shape:?} {masking:?} {roughness} {mu}: {short}"
                );
            }
        }
    }
}
