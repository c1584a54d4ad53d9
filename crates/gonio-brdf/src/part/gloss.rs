//! What a rough dielectric reflects before light enters it, as a table: the share that a layer keeps from what lies under it.

use super::boundary_loss::{MOST_CONTRAST, directional_shares};
use super::distribution::{Distribution, Shape};
use super::masking::Masking;
use super::table_data::{self, bytes_to_numbers};
use gonio_num::{Real, Table3, Work};

/// Samples along √μ.
pub const WIDTH: usize = 32;
/// Samples along √α.
pub const HEIGHT: usize = 14;
/// Samples along the contrast of the indices.
pub const DEPTH: usize = 8;
const SIDES: [usize; 3] = [WIDTH, HEIGHT, DEPTH];
const SIZE: usize = WIDTH * HEIGHT * DEPTH;

/// The reflected share at the place (√μ, √α, contrast), for a viewer in the rarer or the denser medium.
fn share(from_denser: bool, x: f64, y: f64, z: f64) -> f64 {
    let d = Distribution::isotropic(Shape::Ggx, y * y);
    let c = z * MOST_CONTRAST;
    let m = ((1.0 + c) / (1.0 - c)).max(1.0 + 1e-6);
    let eta = if from_denser { 1.0 / m } else { m };
    directional_shares(&d, Masking::SmithCorrelated, eta, x * x)[0].min(1.0)
}

/// The shares over (√μ, √α, contrast), √μ fastest, for a viewer in the rarer medium and then for one in the denser; raised so that the
/// interpolated table stays above the truth.
pub fn tabulate() -> Vec<f32> {
    [false, true]
        .into_iter()
        .flat_map(|denser| table_data::tabulate(SIDES, true, &|x, y, z| share(denser, x, y, z)))
        .map(|x| x.min(1.0))
        .collect()
}

/// One entry of [`tabulate`], at a node.
pub fn table_entry(from_denser: bool, at: [usize; 3]) -> f32 {
    table_data::entry_above(SIDES, at, &mut |x, y, z| share(from_denser, x, y, z)).min(1.0)
}

/// The tables as `examples/tabulate.rs` writes them: little-endian `f32`.
static DATA: [f32; 2 * SIZE] = bytes_to_numbers(include_bytes!("gloss.bin"));

const fn table(k: usize, name: &'static str) -> Table3 {
    Table3 {
        name,
        width: WIDTH,
        height: HEIGHT,
        depth: DEPTH,
        data: DATA.split_at(k * SIZE).1.split_at(SIZE).0,
    }
}

static FROM_RARER: Table3 = table(0, "gloss_from_rarer");
static FROM_DENSER: Table3 = table(1, "gloss_from_denser");

/// E(μ) of a rough dielectric's reflection: the directional albedo of f = F D G/(4 cosθi cosθr) with the GGX distribution, Smith's
/// correlated masking and the Fresnel reflectance of an index η in [¼, 4], light that meets one facet only. Never below the truth by more
/// than the table's rounding: what is left for a layer below, 1 − E, keeps the energy.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gloss<R> {
    /// √α of both slope scales.
    roots: [R; 2],
    isotropic: bool,
    contrast: R,
    from_denser: R,
}

impl<R: Real> Gloss<R> {
    /// Of a distribution and the index of the far side over that of the viewer's.
    pub fn new(d: &Distribution<R>, isotropic: bool, ior: R) -> Self {
        let m = ior.max(ior.recip());
        Self {
            roots: [d.alpha_x().sqrt(), d.alpha_y().sqrt()],
            isotropic,
            contrast: (m - R::one()) / (m + R::one()) * R::lit(1.0 / MOST_CONTRAST),
            from_denser: R::from_mask(ior.lt(R::one())),
        }
    }

    pub fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Gloss<S> {
        Gloss {
            roots: [f(self.roots[0]), f(self.roots[1])],
            isotropic: self.isotropic,
            contrast: f(self.contrast),
            from_denser: f(self.from_denser),
        }
    }

    /// E(μ); of two slope scales the larger of both values.
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
        let at = |y: R| {
            let rarer = R::table3(&FROM_RARER, x, y, gloss.contrast);
            let denser = R::table3(&FROM_DENSER, x, y, gloss.contrast);
            gloss.from_denser.lerp(rarer, denser)
        };
        let first = at(gloss.roots[0]);
        if gloss.isotropic {
            return first;
        }
        first.max(at(gloss.roots[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::super::fresnel::dielectric;
    use super::*;

    #[test]
    fn committed_tables_are_what_the_quadrature_gives() {
        for (k, denser) in [(0, false), (1, true)] {
            let at = [3, 9, 4];
            let index = (at[2] * HEIGHT + at[1]) * WIDTH + at[0];
            assert_eq!(table_entry(denser, at), DATA[k * SIZE + index]);
        }
    }

    /// The smoothest surface reflects what Fresnel's equations say, and a table of linear pieces lies above that by no more than the
    /// square of its step times the curvature.
    #[test]
    fn a_smooth_surface_is_a_mirror_of_glass() {
        let d = Distribution::isotropic(Shape::Ggx, 1e-4);
        for ior in [1.5, 1.0 / 1.5, 2.4] {
            let gloss = Gloss::new(&d, true, ior);
            for mu in [0.9, 0.8, 1.0] {
                let (found, exact) = (gloss.albedo(mu), dielectric(mu, ior));
                assert!(
                    found > exact - 1e-4 && found < exact + 2e-2,
                    "{ior} {mu}: {found} {exact}"
                );
            }
        }
    }

    #[test]
    fn interpolation_stays_above_the_truth() {
        for denser in [false, true] {
            let table = if denser { &FROM_DENSER } else { &FROM_RARER };
            for (x, y, z) in [(0.3, 0.5, 0.33), (0.71, 0.9, 0.21), (0.11, 0.77, 0.9)] {
                let found: f64 = Real::table3(table, x, y, z);
                let over = found - share(denser, x, y, z);
                assert!(over > -1e-3 && over < 3e-2, "{denser} {x} {y} {z}: {over}");
            }
        }
    }
}
