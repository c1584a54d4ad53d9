//! Smith's masking of distributions for which it has no closed form, as tables.
//!
//! What is tabulated is v = (1 + Λ) t over t = cotθ/(cotθ + σ), √α and the tail, with σ = ρα the scale of masking
//! ([`Distribution::spread`]): it goes smoothly from 1/2 at grazing angles (t = 0) to 1 along the normal (t = 1).

use super::distribution::{Distribution, Shape, Tail};
use super::special::integral;
use super::table_data::{bytes_to_numbers, entry_above};
use gonio_num::{Real, Table2, Table3, Vec3, Work};
use std::f64::consts::TAU;

/// Samples along t.
pub const WIDTH: usize = 36;
/// Samples along √α; the first stands for the smallest slope scale.
pub const HEIGHT: usize = 20;
/// Samples along the tail.
pub const DEPTH: usize = 12;
/// Samples along the tail of the scale-free shape.
pub const LONG_DEPTH: usize = 32;

/// The shapes with a table, in the order of the file.
pub const SHAPES: [Shape; 5] = [
    Shape::Gaussian,
    Shape::StudentT,
    Shape::Gtr,
    Shape::ShiftedGamma,
    Shape::Abc,
];

/// How many samples each side of a shape's table has; a scale-free shape has none along √α, one without a tail none along it.
pub const fn sides(shape: Shape) -> [usize; 3] {
    match shape {
        Shape::Gaussian => [WIDTH, HEIGHT, 1],
        Shape::StudentT => [WIDTH, 1, LONG_DEPTH],
        _ => [WIDTH, HEIGHT, DEPTH],
    }
}

const fn size(shape: Shape) -> usize {
    let [w, h, d] = sides(shape);
    w * h * d
}

/// Where a tail lies between the ends of its range, [0, 1]: evenly in the exponent of `sgd` and `abc`, in 1/√γ for `gtr`, and in
/// 1/√(γ − 3/2) for `student-t`, whose mean slope is infinite at γ = 3/2.
#[inline(always)]
pub(crate) fn tail_coordinate<R: Real>(shape: Shape, tail: R) -> R {
    let Some(Tail {
        range: (low, high), ..
    }) = shape.tail()
    else {
        return R::zero();
    };
    let Some(pole) = pole(shape) else {
        return (tail - R::lit(low)) * R::lit(1.0 / (high - low));
    };
    let (first, last) = (over_root(low, pole), over_root(high, pole));
    let root = (tail - R::lit(pole)).max(R::lit(1e-6)).sqrt().recip();
    (R::lit(first) - root) * R::lit(1.0 / (first - last))
}

/// γ₀ of a shape whose tail is tabulated evenly in 1/√(γ − γ₀).
const fn pole(shape: Shape) -> Option<f64> {
    match shape {
        Shape::Gtr => Some(0.0),
        Shape::StudentT => Some(1.5),
        _ => None,
    }
}

fn over_root(gamma: f64, pole: f64) -> f64 {
    1.0 / (gamma - pole).sqrt()
}

/// The tail at a coordinate: the inverse of `tail_coordinate`.
pub fn tail_at(shape: Shape, x: f64) -> f64 {
    let Some(Tail {
        range: (low, high), ..
    }) = shape.tail()
    else {
        return 0.0;
    };
    let Some(pole) = pole(shape) else {
        return low + x * (high - low);
    };
    let (first, last) = (over_root(low, pole), over_root(high, pole));
    pole + (first - x * (first - last)).powi(-2)
}

/// v of an isotropic distribution by quadrature, to about 1e-6: with A the projected area of the normals at θm that face the direction,
///
/// 1 + Λ = 1/cosθ ∫ D(θm) A(θ, θm) sinθm dθm
///
/// - `t`: cotθ/(cotθ + σ), [0, 1]
pub fn smith_by_quadrature(d: &Distribution<f64>, t: f64) -> f64 {
    if t >= 1.0 {
        return 1.0;
    }
    let alpha = d.alpha_x();
    // 1 − t as cotθ goes to infinity; cot = 0 is approached, not reached.
    let scale = alpha * d.spread();
    let cot = (scale * t / (1.0 - t)).max(1e-9);
    let sin = 1.0 / (1.0 + cot * cot).sqrt();
    let cos = cot * sin;
    let area = |slope: f64| {
        let cos_m = 1.0 / (1.0 + slope * slope).sqrt();
        let sin_m = slope * cos_m;
        let facing = if slope <= cot {
            TAU * cos * cos_m
        } else {
            let phi: f64 = Real::acos(-(cot / slope));
            2.0 * (phi * cos * cos_m + Real::sin(phi) * sin * sin_m)
        };
        // dθm = cos²θm dr
        facing * d.density(Vec3::new(sin_m, 0.0, cos_m)) * sin_m * cos_m * cos_m
    };
    // Over ln r, since a long tail matters from far below α to the horizon; in two ranges, since the facets at which the surface
    // turns away make a kink.
    let kink: f64 = Real::ln(cot);
    let (least, most) = (-30.0, 14.0);
    let mut sum = 0.0;
    for (low, high) in [(least, kink.min(most)), (kink.max(least), most)] {
        let panels = ((high - low) * 0.8 + 1.0) as u32;
        sum += integral(low, high, panels, |y: f64| {
            let slope = Real::exp(y);
            area(slope) * slope
        });
    }
    sum / cos * cot / (cot + scale)
}

/// α at the place y in [0, 1] of a table: even in the fourth root, from [`super::distribution::ALPHA_MIN`] on, where long tails still change.
pub fn alpha_at(y: f64) -> f64 {
    (FIRST_ROOT + y * (1.0 - FIRST_ROOT)).powi(4)
}

/// The place of α in a table: the inverse of [`alpha_at`].
#[inline(always)]
pub(crate) fn alpha_coordinate<R: Real>(alpha: R) -> R {
    (alpha.sqrt().sqrt() - R::lit(FIRST_ROOT)) * R::lit(1.0 / (1.0 - FIRST_ROOT))
}

/// The fourth root of the smallest slope scale.
const FIRST_ROOT: f64 = 0.1;

/// v at the place (x, y, z) of a shape's table, each in [0, 1].
fn truth(shape: Shape, x: f64, y: f64, z: f64) -> f64 {
    let alpha = if sides(shape)[1] == 1 {
        0.3
    } else {
        alpha_at(y)
    };
    let d = Distribution::new(shape, alpha, alpha, tail_at(shape, z));
    smith_by_quadrature(&d, x)
}

/// An entry of a shape's table: v at the node, and what interpolation around it falls short of on top. So masking is never less than
/// it should be, and no surface reflects more than it gets.
pub fn table_entry(shape: Shape, at: [usize; 3]) -> f32 {
    entry_above(sides(shape), at, &mut |x, y, z| truth(shape, x, y, z))
}

/// The whole table of a shape.
pub fn tabulate(shape: Shape) -> Vec<f32> {
    super::table_data::tabulate(sides(shape), true, &|x, y, z| truth(shape, x, y, z))
}

const FLOATS: usize = size(Shape::Gaussian)
    + size(Shape::StudentT)
    + size(Shape::Gtr)
    + size(Shape::ShiftedGamma)
    + size(Shape::Abc);

/// The tables as `examples/tabulate.rs` writes them: little-endian `f32`, in the order of [`SHAPES`].
static DATA: [f32; FLOATS] = bytes_to_numbers(include_bytes!("masking.bin"));

/// The part of [`DATA`] that belongs to the shape at place `k` of [`SHAPES`].
const fn part(k: usize) -> &'static [f32] {
    let mut start = 0;
    let mut i = 0;
    while i < k {
        start += size(SHAPES[i]);
        i += 1;
    }
    DATA.split_at(start).1.split_at(size(SHAPES[k])).0
}

static GAUSSIAN: Table2 = Table2 {
    name: "smith_gaussian",
    width: WIDTH,
    height: HEIGHT,
    data: part(0),
};
static STUDENT_T: Table2 = Table2 {
    name: "smith_student_t",
    width: WIDTH,
    height: LONG_DEPTH,
    data: part(1),
};
static GTR: Table3 = cube("smith_gtr", 2);
static SHIFTED_GAMMA: Table3 = cube("smith_sgd", 3);
static ABC: Table3 = cube("smith_abc", 4);

const fn cube(name: &'static str, k: usize) -> Table3 {
    Table3 {
        name,
        width: WIDTH,
        height: HEIGHT,
        depth: DEPTH,
        data: part(k),
    }
}

/// v of a distribution that has a table; 1 for the others.
///
/// - `t`: w.z/(w.z + ρm), see [`super::masking::cos_over_smith_g1`]
#[inline(always)]
pub fn look_up<R: Real>(d: &Distribution<R>, t: R) -> R {
    R::out_of_line(LookUp(d, t))
}

struct LookUp<'a, R>(&'a Distribution<R>, R);

impl<R: Real> Work for LookUp<'_, R> {
    type Output = R;
    #[inline(always)]
    fn run(self) -> R {
        let Self(d, t) = self;
        let alpha = alpha_coordinate(d.alpha_x().min(d.alpha_y()));
        let tail = tail_coordinate(d.shape(), d.tail());
        match d.shape() {
            Shape::Gaussian => R::table2(&GAUSSIAN, t, alpha),
            Shape::StudentT => R::table2(&STUDENT_T, t, tail),
            Shape::Gtr => R::table3(&GTR, t, alpha, tail),
            Shape::ShiftedGamma => R::table3(&SHIFTED_GAMMA, t, alpha, tail),
            Shape::Abc => R::table3(&ABC, t, alpha, tail),
            Shape::Beckmann | Shape::Ggx | Shape::BlinnPhong => R::one(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadrature_gives_the_closed_form_of_ggx() {
        for alpha in [1e-4, 0.05, 0.5, 1.0] {
            let d = Distribution::isotropic(Shape::Ggx, alpha);
            for k in 0..=20 {
                let t = f64::from(k) / 20.0;
                // a = cotθ/α = t/(1 − t): v = (√(a² + 1) + a)/2 · (1 − t).
                let a: f64 = t / (1.0 - t).max(1e-300);
                let expected = if k == 20 {
                    1.0
                } else {
                    0.5 * ((a * a + 1.0).sqrt() + a) * (1.0 - t)
                };
                let found = smith_by_quadrature(&d, t);
                assert!(
                    (found - expected).abs() < 1e-6,
                    "{alpha} {t}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn committed_tables_are_what_the_quadrature_gives() {
        for (k, shape) in SHAPES.into_iter().enumerate() {
            let [w, h, d] = sides(shape);
            for at in [[5, 0, 0], [17, h / 2, d / 2]] {
                let index = (at[2] * h + at[1]) * w + at[0];
                assert_eq!(table_entry(shape, at), part(k)[index], "{shape:?} {at:?}");
            }
        }
    }

    /// Between the nodes: never below the truth but for what the check at the middle of each cell doesn't see, and little above.
    #[test]
    fn interpolation_is_close_and_on_the_safe_side() {
        for shape in SHAPES {
            for (x, y, z) in [
                (0.03, 0.2, 0.3),
                (0.31, 0.55, 0.72),
                (0.77, 0.93, 0.51),
                (0.1, 0.07, 0.04),
            ] {
                let v = truth(shape, x, y, z);
                let alpha = if sides(shape)[1] == 1 {
                    0.3
                } else {
                    alpha_at(y)
                };
                let d = Distribution::new(shape, alpha, alpha, tail_at(shape, z));
                let over = look_up(&d, x) - v;
                assert!(
                    over > -1e-4 && over < 3e-3,
                    "{shape:?} {x} {y} {z}: {over} of {v}"
                );
            }
        }
    }

    #[test]
    fn tail_coordinates_are_inverse() {
        for shape in SHAPES {
            for x in [0.0, 0.3, 1.0] {
                let back = tail_coordinate(shape, tail_at(shape, x));
                if shape.tail().is_some() {
                    assert!((back - x).abs() < 1e-12, "{shape:?}");
                }
            }
        }
    }
}
