//! What a rough dielectric reflects before light enters it, as a table: the share that a layer keeps from what lies under it.

use super::boundary_loss::{MOST_CONTRAST, directional_shares};
use super::distribution::{Distribution, Shape};
use super::masking::Masking;
use super::table_data::{self, bytes_to_numbers};
use gonio_num::{Real, Table3, Work};

/// Samples along √μ.
pub const WIDTH: usize = 32;
/// Samples along √α.
pub const HEIGHT: usize = 24;
/// Samples along the contrast of the indices.
pub const DEPTH: usize = 16;
const SIDES: [usize; 3] = [WIDTH, HEIGHT, DEPTH];

/// The reflected share at the place (√μ, √α, contrast).
fn share(x: f64, y: f64, z: f64) -> f64 {
    let d = Distribution::isotropic(Shape::Ggx, y * y);
    let c = z * MOST_CONTRAST;
    let eta = ((1.0 + c) / (1.0 - c)).max(1.0 + 1e-6);
    directional_shares(&d, Masking::SmithCorrelated, eta, x * x)[0].min(1.0)
}

/// The shares over (√μ, √α, contrast), √μ fastest, raised so that the interpolated table stays above the truth.
pub fn tabulate() -> Vec<f32> {
    let table = table_data::tabulate(SIDES, true, &share);
    table.into_iter().map(|x| x.min(1.0)).collect()
}

/// One entry of [`tabulate`], at a node.
pub fn table_entry(at: [usize; 3]) -> f32 {
    table_data::entry_above(SIDES, at, &mut share).min(1.0)
}

static TABLE: Table3 = Table3 {
    name: "gloss",
    width: WIDTH,
    height: HEIGHT,
    depth: DEPTH,
    data: &DATA,
};

/// The table as `examples/tabulate.rs` writes it: little-endian `f32`.
static DATA: [f32; WIDTH * HEIGHT * DEPTH] = bytes_to_numbers(include_bytes!("gloss.bin"));

/// E(μ) of a rough dielectric's reflection: the directional albedo of f = F D G/(4 cosθi cosθr) with the GGX distribution, Smith's
/// correlated masking and the Fresnel reflectance of an index η in [1, 4], light that meets one facet only. Never below the truth by more
/// than the table's rounding: what is left for a layer below, 1 − E, keeps the energy.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gloss<R> {
    /// √α of both slope scales.
    roots: [R; 2],
    contrast: R,
}

impl<R: Real> Gloss<R> {
    /// Of a distribution and the index of the far side over that of the viewer's, at least 1.
    pub fn new(d: &Distribution<R>, ior: R) -> Self {
        Self {
            roots: [d.alpha_x().sqrt(), d.alpha_y().sqrt()],
            contrast: (ior - R::one()) / (ior + R::one()) * R::lit(1.0 / MOST_CONTRAST),
        }
    }

    pub fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Gloss<S> {
        Gloss {
            roots: [f(self.roots[0]), f(self.roots[1])],
            contrast: f(self.contrast),
        }
    }

    /// E(μ), [0, 1]; of two slope scales the larger of both values.
    #[inline(always)]
    pub fn albedo(&self, mu: R) -> R {
        R::out_of_line(LookUp(self, mu))
    }
}

struct LookUp<'a, R>(&'a Gloss<R>, R);

impl<R: Real> Work for LookUp<'_, R> {
    type Output = R;
    #[inline(always)]
    fn run(self) -> R {
        let Self(gloss, mu) = self;
        let x = mu.saturate().max(R::lit(1e-20)).sqrt();
        let [a, b] = gloss.roots;
        let first = R::table3(&TABLE, x, a, gloss.contrast);
        first.max(R::table3(&TABLE, x, b, gloss.contrast))
    }
}

#[cfg(test)]
mod tests {
    use super::super::fresnel::dielectric;
    use super::*;

    #[test]
    fn the_committed_table_is_what_the_quadrature_gives() {
        let at = [3, 9, 4];
        let index = (at[2] * HEIGHT + at[1]) * WIDTH + at[0];
        assert_eq!(table_entry(at), DATA[index]);
    }

    /// The smoothest surface reflects what Fresnel's equations say; a table of linear pieces lies above that by the square of half its
    /// step times half the curvature, 1e-3 here, at each end of a piece.
    #[test]
    fn a_smooth_surface_is_a_mirror_of_glass() {
        let d = Distribution::isotropic(Shape::Ggx, 1e-4);
        for ior in [1.0, 1.33, 1.5, 2.4] {
            let gloss = Gloss::new(&d, ior);
            for mu in [0.3, 0.7, 1.0] {
                let (found, exact) = (gloss.albedo(mu), dielectric(mu, ior));
                let over = found - exact;
                assert!(over > -1e-6 && over < 6e-3, "{ior} {mu}: {found} {exact}");
            }
        }
    }

    #[test]
    fn interpolation_stays_above_the_truth() {
        for (x, y, z) in [(0.3, 0.5, 0.33), (0.71, 0.9, 0.21), (0.11, 0.77, 0.9)] {
            let found: f64 = Real::table3(&TABLE, x, y, z);
            let over = found - share(x, y, z);
            assert!(over > -1e-3 && over < 1e-2, "{x} {y} {z}: {over}");
        }
    }
}
