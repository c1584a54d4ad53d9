//! What a rough boundary between two dielectrics loses when each ray meets one facet only, as tables, and the lobe that gives it
//! back.

use super::albedo::row_mean;
use super::colour::cast;
use super::distribution::{Distribution, Shape};
use super::fresnel::dielectric;
use super::geometry::refracted_about;
use super::masking::{Masking, smith_g1_over_cos, visibility_across, visibility_from_areas};
use super::rough::RoughSurface;
use super::special::GAUSS_LEGENDRE_16;
use super::table_data::{self, bytes_to_numbers};
use gonio_num::{Real, Table2, Table3, Vec3, Work};
use std::f64::consts::FRAC_1_PI;

/// Samples along √μ.
pub const WIDTH: usize = 24;
/// Samples along √α.
pub const HEIGHT: usize = 14;
/// Samples along the contrast of the indices.
pub const DEPTH: usize = 8;
const SIDES: [usize; 3] = [WIDTH, HEIGHT, DEPTH];
/// (m − 1)/(m + 1) of the largest index m.
pub(super) const MOST_CONTRAST: f64 = 0.6;

/// A surface as seen from the rarer or from the denser of its two media.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seen {
    /// D.
    pub shape: Shape,
    /// G.
    pub masking: Masking,
    /// Whether the viewer is in the denser medium.
    pub from_denser: bool,
}

const SHAPES: [Shape; 2] = [Shape::Beckmann, Shape::Ggx];
const MASKINGS: [Masking; 2] = [Masking::Smith, Masking::SmithCorrelated];
const COUNT: usize = 8;

/// The surfaces with a table, in the order of the file.
pub fn surfaces() -> [Seen; COUNT] {
    std::array::from_fn(|k| Seen {
        shape: SHAPES[k / 4],
        masking: MASKINGS[k / 2 % 2],
        from_denser: k % 2 == 1,
    })
}

/// The share of uniform light, in units of n², that leaves towards μ after one facet, reflected or refracted.
///
/// - `eta`: index of the other side over that of the viewer's
/// - `mu`: cosine of the viewer's direction, [0, 1]; below 1e-6 it is taken for 1e-6
///
/// Quadrature in the random numbers of an importance sampler, accurate to about 1e-4.
pub fn directional_albedo(d: &Distribution<f64>, masking: Masking, eta: f64, mu: f64) -> f64 {
    let [reflected, refracted] = directional_shares(d, masking, eta, mu);
    reflected + refracted
}

/// The two parts of [`directional_albedo`]: reflected and refracted.
pub fn directional_shares(d: &Distribution<f64>, masking: Masking, eta: f64, mu: f64) -> [f64; 2] {
    let mu = mu.clamp(1e-6, 1.0);
    let wo = Vec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
    let (panels, turns) = (6, 32);
    let mut sum = [0.0; 2];
    for panel in 0..panels {
        for (node, weight) in GAUSS_LEGENDRE_16 {
            for side in [-1.0, 1.0] {
                // u = t² (3 − 2t) gathers nodes at both ends, where the integrand bends most.
                let t = (f64::from(panel) + 0.5 * (1.0 + side * node)) / f64::from(panels);
                let u1 = t * t * (3.0 - 2.0 * t);
                let du = 6.0 * t * (1.0 - t) * weight / f64::from(panels);
                for k in 0..turns {
                    let u0 = (f64::from(k) + 0.5) / f64::from(2 * turns);
                    let share = leaving(d, masking, eta, wo, [u0, u1]);
                    for (sum, share) in sum.iter_mut().zip(share) {
                        *sum += du / f64::from(turns) * share;
                    }
                }
            }
        }
    }
    sum
}

/// The weights of the normal that u draws, reflected and refracted.
fn leaving(
    d: &Distribution<f64>,
    masking: Masking,
    eta: f64,
    wo: Vec3<f64>,
    u: [f64; 2],
) -> [f64; 2] {
    let visible = d.shape() == Shape::Ggx;
    let h = if visible {
        d.sample_visible_ggx(wo, u[0], u[1])
    } else {
        d.sample_normal(u[0], u[1])
    };
    let cos = wo.dot(h);
    if cos <= 0.0 {
        return [0.0; 2];
    }
    // D(h) cosθ′/p(h), of which both weights are multiples.
    let base = if visible {
        1.0 / smith_g1_over_cos(d, wo)
    } else {
        cos / h.z
    };
    let f = dielectric(cos.min(1.0), eta);
    let up = wo.reflect(h);
    let mut shares = [0.0; 2];
    if up.z > 0.0 {
        shares[0] = base * f * 4.0 * visibility_from_areas(masking, d, up, wo) * up.z;
    }
    if f < 1.0 {
        let down = refracted_about(wo, h, cos, 1.0 / eta);
        if down.z < 0.0 {
            let wi = Vec3::new(down.x, down.y, -down.z);
            shares[1] = base * (1.0 - f) * 4.0 * visibility_across(masking, d, wi, wo) * wi.z;
        }
    }
    shares
}

/// The loss at the place (√μ, √α, contrast) of a table.
fn loss(seen: Seen, x: f64, y: f64, z: f64) -> f64 {
    let d = Distribution::isotropic(seen.shape, y * y);
    let c = z * MOST_CONTRAST;
    let m = (1.0 + c) / (1.0 - c);
    // At no contrast nothing is reflected, and what is refracted goes straight on: the limit is taken a little beside it.
    let m = m.max(1.0 + 1e-6);
    let eta = if seen.from_denser { 1.0 / m } else { m };
    (1.0 - directional_albedo(&d, seen.masking, eta, x * x)).max(0.0)
}

/// The numbers of one surface: the losses over (√μ, √α, contrast), √μ fastest, lowered so that the interpolated table stays below the
/// true loss; then for each (√α, contrast) the mean loss 2 ∫ (1 − E(μ)) μ dμ of the interpolated row.
pub fn tabulate(seen: Seen) -> Vec<f32> {
    let mut block = table_data::tabulate(SIDES, false, &|x, y, z| loss(seen, x, y, z));
    let means: Vec<f32> = block.chunks(WIDTH).map(row_mean).collect();
    block.extend(means);
    block
}

/// One entry of [`tabulate`], at a node.
pub fn table_entry(seen: Seen, at: [usize; 3]) -> f32 {
    table_data::entry_below(SIDES, at, &mut |x, y, z| loss(seen, x, y, z))
}

const SIZE: usize = (WIDTH + 1) * HEIGHT * DEPTH;

/// The tables as `examples/tabulate.rs` writes them: little-endian `f32`, blocks in the order of [`surfaces`].
static DATA: [f32; SIZE * COUNT] = bytes_to_numbers(include_bytes!("boundary.bin"));

const fn directional(k: usize, name: &'static str) -> Table3 {
    let block = DATA.split_at(k * SIZE).1;
    Table3 {
        name,
        width: WIDTH,
        height: HEIGHT,
        depth: DEPTH,
        data: block.split_at(WIDTH * HEIGHT * DEPTH).0,
    }
}

const fn mean(k: usize, name: &'static str) -> Table2 {
    let block = DATA.split_at(k * SIZE + WIDTH * HEIGHT * DEPTH).1;
    Table2 {
        name,
        width: HEIGHT,
        height: DEPTH,
        data: block.split_at(HEIGHT * DEPTH).0,
    }
}

macro_rules! tables {
    ($($k:literal $name:literal,)*) => {
        static LOSSES: [Table3; COUNT] = [$(directional($k, concat!("boundary_loss_", $name)),)*];
        static MEANS: [Table2; COUNT] = [$(mean($k, concat!("mean_boundary_loss_", $name)),)*];
    };
}
tables! {
    0 "beckmann_smith_rarer", 1 "beckmann_smith_denser",
    2 "beckmann_correlated_rarer", 3 "beckmann_correlated_denser",
    4 "ggx_smith_rarer", 5 "ggx_smith_denser",
    6 "ggx_correlated_rarer", 7 "ggx_correlated_denser",
}

/// The first of the two tables of a surface; the second is from the denser medium.
fn first_table(surface: Shape, masking: Masking) -> usize {
    4 * usize::from(surface == Shape::Ggx) + 2 * usize::from(masking == Masking::SmithCorrelated)
}

/// (α_min/α_max)^(5/4): what of the loss of the smoother round surface an anisotropic one has at least, in every direction.
///
/// Found by quadrature over both distributions and maskings, slope scales from 0.03 to 1, ratios from 0.01 to 0.97 and indices from 1/4 to
/// 4: the least quotient of the losses is 0.963 at a ratio of 0.97, 0.438 at 0.5, and 0.087 at 0.1.
#[inline(always)]
fn roundness<R: Real>(alpha_x: R, alpha_y: R) -> R {
    let ratio = alpha_x.min(alpha_y) / alpha_x.max(alpha_y);
    ratio * ratio.sqrt().sqrt()
}

/// The lobe of light that leaves a boundary after several facets, for Beckmann's or the GGX distribution.
///
/// The tables are of round surfaces. In some directions an anisotropic one loses less than even the smoother round one does. So the loss is
/// read at the smaller slope scale and multiplied by (α_min/α_max)^(5/4), which keeps it below the true one: too little is given back,
/// never too much.
#[derive(Debug, Clone, Copy)]
pub struct BoundaryLoss<R: Real> {
    /// The share of it that leaves into the body.
    pub share_inside: R,
    /// 1/(π Σ n² (1 − Ē)) over both sides.
    scale: R,
    /// What the losses of the tables are multiplied by.
    roundness: R,
    /// The place of the indices in the tables, [0, 1].
    contrast: R,
    /// 1 where the body is the denser medium, else 0.
    denser_inside: R,
}

impl<R: Real> BoundaryLoss<R> {
    pub(crate) fn new(surface: &RoughSurface<R>, ior: R) -> Self {
        let denser_inside = R::from_mask(ior.gt(R::one()));
        let m = ior.max(ior.recip());
        let contrast = (m - R::one()) / (m + R::one()) * R::lit(1.0 / MOST_CONTRAST);
        let d = &surface.distribution;
        let roundness = roundness(d.alpha_x(), d.alpha_y());
        let root = d.alpha_x().min(d.alpha_y()).sqrt();
        let first = first_table(d.shape(), surface.masking);
        let from_rarer = R::table2(&MEANS[first], root, contrast);
        let from_denser = R::table2(&MEANS[first + 1], root, contrast);
        let tiny = R::lit(1e-12);
        let inside = denser_inside.lerp(from_rarer, from_denser) * ior * ior + tiny;
        let outside = denser_inside.lerp(from_denser, from_rarer) + tiny;
        Self {
            share_inside: inside / (inside + outside),
            scale: R::lit(FRAC_1_PI) / (roundness * (inside + outside)),
            roundness,
            contrast,
            denser_inside,
        }
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> BoundaryLoss<S> {
        let [share_inside, scale, roundness, contrast, denser_inside] = cast(
            [
                self.share_inside,
                self.scale,
                self.roundness,
                self.contrast,
                self.denser_inside,
            ],
            f,
        );
        BoundaryLoss {
            share_inside,
            scale,
            roundness,
            contrast,
            denser_inside,
        }
    }

    /// What is given back of 1 − E(μ), on the inner (`inside` = 1) or outer (0) side.
    #[inline(always)]
    pub(crate) fn directional(&self, surface: &RoughSurface<R>, mu: R, inside: R) -> R {
        R::out_of_line(LookUp {
            loss: self,
            surface,
            mu,
            inside,
        })
    }

    /// The lobe over n_r², from the losses in both directions.
    #[inline(always)]
    pub(crate) fn value(&self, loss_i: R, loss_o: R) -> R {
        loss_i * loss_o * self.scale
    }
}

struct LookUp<'a, R: Real> {
    loss: &'a BoundaryLoss<R>,
    surface: &'a RoughSurface<R>,
    mu: R,
    inside: R,
}

impl<R: Real> Work for LookUp<'_, R> {
    type Output = R;
    #[inline(always)]
    fn run(self) -> R {
        let d = &self.surface.distribution;
        let first = first_table(d.shape(), self.surface.masking);
        let x = self.mu.saturate().max(R::lit(1e-20)).sqrt();
        let y = d.alpha_x().min(d.alpha_y()).sqrt();
        let z = self.loss.contrast;
        let from_denser = (self.inside - self.loss.denser_inside)
            .abs()
            .lt(R::lit(0.5));
        let rarer = R::table3(&LOSSES[first], x, y, z);
        let denser = R::table3(&LOSSES[first + 1], x, y, z);
        R::select(from_denser, denser, rarer) * self.loss.roundness
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn committed_tables_are_what_the_quadrature_gives() {
        for (k, seen) in surfaces().into_iter().enumerate() {
            assert_eq!(
                2 * (k / 2),
                first_table(seen.shape, seen.masking),
                "{seen:?}"
            );
            let block = &DATA[k * SIZE..][..SIZE];
            let at = [3, 9, 4];
            let row = at[2] * HEIGHT + at[1];
            assert_eq!(
                table_entry(seen, at),
                block[row * WIDTH + at[0]],
                "{seen:?}"
            );
            let mean = block[WIDTH * HEIGHT * DEPTH + row];
            assert_eq!(row_mean(&block[row * WIDTH..][..WIDTH]), mean);
        }
    }

    #[test]
    fn a_smooth_boundary_loses_nothing() {
        for seen in surfaces() {
            let d = Distribution::isotropic(seen.shape, 1e-3);
            for eta in [1.5, 1.0 / 1.5] {
                for mu in [0.2, 0.8] {
                    let e = directional_albedo(&d, seen.masking, eta, mu);
                    assert!((e - 1.0).abs() < 1e-3, "{seen:?} {eta} {mu}: {e}");
                }
            }
        }
    }

    /// Both axes, at the places where the quotient of the losses is least.
    #[test]
    fn an_anisotropic_surface_loses_more_than_it_is_given_back() {
        let mut without = 0.0f64;
        for (shape, alpha, eta, mu) in [
            (Shape::Beckmann, 0.1, 1.05, 0.01),
            (Shape::Beckmann, 0.8, 0.25, 0.1),
            (Shape::Beckmann, 0.3, 4.0, 0.01),
            (Shape::Ggx, 0.6, 1.0 / 1.2, 0.01),
            (Shape::Ggx, 1.0, 1.0 / 1.5, 0.01),
        ] {
            for ratio in [0.97, 0.7, 0.3, 0.1] {
                let loss = |x: f64, y: f64| {
                    let d = Distribution::new(shape, alpha * x, alpha * y, 0.0);
                    1.0 - directional_albedo(&d, Masking::SmithCorrelated, eta, mu)
                };
                let truth = loss(1.0, ratio).min(loss(ratio, 1.0));
                let smoother = loss(ratio, ratio);
                // The quadrature's own error is 1e-4.
                let given = smoother * roundness(1.0, ratio);
                assert!(
                    given < truth + 1e-4,
                    "{shape:?} {eta} {ratio}: {given} {truth}"
                );
                without = without.max(smoother - truth);
            }
        }
        // Without the factor far more would be given back than was lost.
        assert!(without > 0.05, "{without}");
    }

    #[test]
    fn interpolation_stays_below_the_truth() {
        for (k, seen) in surfaces().into_iter().enumerate() {
            for (x, y, z) in [(0.3, 0.5, 0.33), (0.71, 0.9, 0.21), (0.11, 0.77, 0.9)] {
                let found: f64 = Real::table3(&LOSSES[k], x, y, z);
                let short = loss(seen, x, y, z) - found;
                assert!(
                    short > -1e-3 && short < 2e-2,
                    "{seen:?} {x} {y} {z}: {short}"
                );
            }
        }
    }
}
