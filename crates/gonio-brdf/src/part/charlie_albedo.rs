//! What the sheen of [`SheenCharlie`] leaves to the layer below it: 1 less its directional albedo, as a table.

use super::special::integral;
use super::table_data::{self, bytes_to_numbers};
use crate::Brdf;
use crate::model::sheen_charlie::{ALPHA_MIN, SheenCharlie, Visibility};
use gonio_num::{Real, Table2, Vec3};
use gonio_radiometry::warp::around_axis;
use std::f64::consts::TAU;

/// Samples along √μ, from 0 to 1.
pub const WIDTH: usize = 32;
/// Samples along √α, from 0 to 1.
pub const HEIGHT: usize = 24;
const SIDES: [usize; 3] = [WIDTH, HEIGHT, 1];

/// Directional albedo E(μ) of white sheen with the paper's visibility, by quadrature: accurate to about 1e-5.
///
/// - `alpha`: the paper's roughness r, [1e-3, 1]; smaller ones are taken for 1e-3
/// - `mu`: cosine of the viewer's direction, [0, 1]; below 1e-6 it is taken for 1e-6
pub fn directional_albedo(alpha: f64, mu: f64) -> f64 {
    let mu = mu.clamp(1e-6, 1.0);
    let sheen = SheenCharlie::<f64, 1> {
        color: [1.0],
        alpha: alpha.max(ALPHA_MIN),
        visibility: Visibility::Charlie,
    };
    let wo = Vec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
    // Nodes gather at grazing angles, where all the light is for a small α: μ = t², μ dμ = 2t³ dt.
    integral(0.0, 1.0, 8, |t: f64| {
        let z = t * t;
        let sin = (1.0 - z * z).max(0.0).sqrt();
        // Half a turn: the other is its mirror image.
        let ring: f64 = integral(0.0, 0.5, 4, |turn: f64| {
            sheen.eval(around_axis(turn, sin, z), wo)[0]
        });
        2.0 * TAU * ring * 2.0 * t * z
    })
}

/// The loss 1 − E at the place (√μ, √α).
fn rest(x: f64, y: f64) -> f64 {
    (1.0 - directional_albedo(y * y, x * x)).max(0.0)
}

/// 1 − E over (√μ, √α), √μ fastest, lowered so that the interpolated table stays below the truth: sheen over a scaled layer then never
/// returns more than it gets.
pub fn tabulate() -> Vec<f32> {
    table_data::tabulate(SIDES, false, &|x, y, _| rest(x, y))
}

/// One entry of [`tabulate`], at a node.
pub fn table_entry(at: [usize; 2]) -> f32 {
    table_data::entry_below(SIDES, [at[0], at[1], 0], &mut |x, y, _| rest(x, y))
}

/// The table as `examples/tabulate.rs` writes it: little-endian `f32`.
static DATA: [f32; WIDTH * HEIGHT] = bytes_to_numbers(include_bytes!("charlie_albedo.bin"));

static TABLE: Table2 = Table2 {
    name: "below_charlie_sheen",
    width: WIDTH,
    height: HEIGHT,
    data: &DATA,
};

/// 1 − E(μ) of white sheen, [0, 1].
///
/// - `mu`: cosine of the viewer's or the light's direction, [0, 1]
/// - `alpha`: [1e-3, 1]
#[inline(always)]
pub fn share_below<R: Real>(mu: R, alpha: R) -> R {
    let root = mu.saturate().max(R::lit(1e-20)).sqrt();
    R::table2(&TABLE, root, alpha.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_committed_table_is_what_the_quadrature_gives() {
        for at in [[1, 20], [9, 11], [31, 3]] {
            assert_eq!(table_entry(at), DATA[at[1] * WIDTH + at[0]], "{at:?}");
        }
    }

    #[test]
    fn interpolation_stays_below_the_truth() {
        for (mu, roughness) in [
            (0.03, 0.31),
            (0.2, 0.5),
            (0.55, 0.72),
            (0.9, 1.0),
            (0.01, 0.1),
        ] {
            let found: f64 = share_below(mu, roughness * roughness);
            let short = rest(f64::sqrt(mu), roughness) - found;
            assert!(
                short > -1e-4 && short < 2e-2,
                "{mu} {roughness}: {short} of {found}"
            );
        }
    }
}
