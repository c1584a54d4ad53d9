//! Dual numbers against central differences in double precision.

use gonio_num::dual::Dual;
use gonio_num::lanes::Lanes;
use gonio_num::{Real, Table1, Table2, Table3, Vec3};
use proptest::prelude::*;

static T1: Table1 = Table1 {
    name: "t1",
    data: &[0.5, -1.0, 3.0, 3.5, 8.0],
};
static T2: Table2 = Table2 {
    name: "t2",
    width: 4,
    height: 3,
    data: &[
        0.0, 1.0, 4.0, 2.0, -2.0, 0.25, 7.0, 3.0, 1.0, 1.5, 2.5, -4.0,
    ],
};
static T3: Table3 = Table3 {
    name: "lobe",
    width: 3,
    height: 2,
    depth: 3,
    data: &[
        0.5, -1.0, 2.0, 0.25, 3.0, -0.75, 1.5, 0.0, -2.0, 4.0, 0.125, 1.0, -0.5, 2.5, 0.75, -1.25,
        0.3, 0.9,
    ],
};

const RESULTS: usize = 37;

/// Every differentiable method, at arguments that keep off the kinks.
#[inline(always)]
fn everything<R: Real>(x: R, y: R) -> [R; RESULTS] {
    let (sin, cos) = x.sin_cos();
    // A number of steps that depends on x would make the sum jump.
    let root = R::repeat(9, [R::one(), R::zero()], |i, [r, sum]| {
        let next = R::lit(0.5) * (r + (x + R::lit(3.0)) / r);
        ([next, sum + i * next], i.lt(R::lit(5.0)))
    });
    let v = Vec3::new(x, y, x * y).normalize();
    [
        x + y,
        x - y,
        x * y,
        x / y,
        -x,
        x.abs().sqrt(),
        x.abs(),
        x.min(y),
        x.max(y),
        x + x.floor(),
        x.exp(),
        x.abs().ln(),
        x.sin(),
        x.cos(),
        (x * R::lit(0.3)).acos(),
        x.atan2(y),
        R::select(x.lt(y), x * x, y * y * y),
        R::select(x.le(y), x * y, x / y),
        R::table1(&T1, x.sq() * R::lit(0.1)),
        R::table2(&T2, x.sq() * R::lit(0.1), y.sq() * R::lit(0.1)),
        R::table3(
            &T3,
            x.sq() * R::lit(0.1),
            y.sq() * R::lit(0.1),
            y.sq() * R::lit(0.1),
        ),
        root[0],
        root[1],
        R::lit(0.1) * x,
        x.clamp(R::lit(-1.5), R::lit(1.5)),
        (x * R::lit(0.5)).saturate(),
        x.sq(),
        x.recip(),
        x.pow5(),
        x.abs().powf(y),
        sin * cos,
        x.tan(),
        (x * R::lit(0.3)).asin(),
        x.copysign(y),
        x.lerp(y, y * y),
        x.safe_sqrt(),
        v.x + v.y * R::lit(2.0),
    ]
}

/// Both partial derivatives by a fourth-order central difference with step h: error O(h⁴) + O(ε/h).
fn differences(x: f64, y: f64) -> [[f64; 2]; RESULTS] {
    const H: f64 = 2e-4;
    let at = |dx: f64, dy: f64| everything(x + dx * H, y + dy * H);
    let rows = [
        [at(1.0, 0.0), at(-1.0, 0.0), at(2.0, 0.0), at(-2.0, 0.0)],
        [at(0.0, 1.0), at(0.0, -1.0), at(0.0, 2.0), at(0.0, -2.0)],
    ];
    std::array::from_fn(|k| {
        rows.each_ref()
            .map(|[p, m, pp, mm]| (8.0 * (p[k] - m[k]) - (pp[k] - mm[k])) / (12.0 * H))
    })
}

/// Whether a point lies within `margin` of a kink or pole of some method, where differences mean nothing.
fn near_a_kink(x: f64, y: f64, margin: f64) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() < margin;
    let whole = |a: f64| near(a, a.round());
    let grid = |a: f64, cells: f64| whole(a * a * 0.1 * cells) || a * a * 0.1 > 1.0 - margin;
    near(x, 0.0)
        || near(y, 0.0)
        || near(x, y)
        || whole(x)
        || near(x.abs(), 1.5)
        || near(x, 2.0)
        || near(x.abs(), std::f64::consts::FRAC_PI_2)
        || grid(x, 4.0)
        || grid(x, 3.0)
        || grid(y, 2.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn duals_equal_central_differences(x in -2.9f64..2.9, y in -2.9f64..2.9) {
        prop_assume!(!near_a_kink(x, y, 0.02));
        let dual = everything(Dual::<f64, 2>::variable(x, 0), Dual::variable(y, 1));
        let value = everything(x, y);
        let expected = differences(x, y);
        for k in 0..RESULTS {
            prop_assert!(
                dual[k].value == value[k] || (dual[k].value.is_nan() && value[k].is_nan()),
                "value {k}: {} {}", dual[k].value, value[k]
            );
            for i in 0..2 {
                let (got, expected) = (dual[k].partials[i], expected[k][i]);
                // safe_sqrt of a negative number stands at its floor of 0, where no difference exists.
                if value[k].is_nan() { continue; }
                prop_assert!(
                    (got - expected).abs() <= 1e-6 * (1.0 + expected.abs()),
                    "derivative {i} of {k} at ({x}, {y}): {got}, not {expected}"
                );
            }
        }
    }
}

#[test]
fn wrong_derivatives_are_seen() {
    // The negative control of the test above: a slope off by 1e-5 fails its criterion.
    let expected = differences(0.7, 1.3)[10][0];
    let wrong = Real::exp(0.7f64) * (1.0 + 1e-5);
    assert!((wrong - expected).abs() > 1e-6 * (1.0 + expected.abs()));
}

#[test]
fn second_derivatives_by_duals_of_duals() {
    type Second = Dual<Dual<f64, 1>, 1>;
    let x: Second = Dual::variable(Dual::variable(0.7, 0), 0);
    let f = x.sin() * x.exp();
    // (sin x eˣ)″ = 2 cos x eˣ
    let exact = 2.0 * Real::cos(0.7f64) * Real::exp(0.7f64);
    assert!((f.partials[0].partials[0] - exact).abs() < 1e-14);
    let [r] = Real::repeat(5, [x], |_, [s]| ([s * x], x.gt(Real::zero())));
    assert!((r.partials[0].partials[0] - 30.0 * 0.7f64.powi(4)).abs() < 1e-12);
}

#[test]
fn duals_of_lanes_equal_duals_of_scalars() {
    let (xs, ys) = ([0.3f32, -1.2, 2.2, 0.9], [1.7f32, 0.4, -0.6, 2.1]);
    let lanes = everything(
        Dual::<Lanes<4>, 2>::variable(Lanes(xs), 0),
        Dual::variable(Lanes(ys), 1),
    );
    for i in 0..4 {
        let scalar = everything(Dual::<f32, 2>::variable(xs[i], 0), Dual::variable(ys[i], 1));
        for k in 0..RESULTS {
            assert_eq!(
                lanes[k].partials[0].0[i].to_bits(),
                scalar[k].partials[0].to_bits(),
                "{k}"
            );
        }
    }
}

#[test]
fn edges_stay_finite() {
    let zero = Dual::<f64, 1>::variable(0.0, 0);
    assert_eq!(Dual::<f64, 1>::lit(0.0).sqrt().partials, [0.0]);
    assert!(zero.sqrt().partials[0].is_finite());
    assert!(zero.safe_sqrt().partials[0].is_finite());
    assert_eq!(zero.atan2(zero).value, 0.0);
    assert!(zero.atan2(zero).partials[0].is_finite());
    for x in [1.0, -1.0] {
        assert!(Dual::<f64, 1>::variable(x, 0).acos().partials[0].is_finite());
    }
    assert_eq!(Dual::<f64, 1>::variable(1.5, 0).acos().partials, [0.0]);
    assert_eq!(zero.abs().partials, [1.0]);
    // Tables: one side at their ends, constant outside.
    let slope = |x| {
        Real::repeat(1, [R1::variable(x, 0)], |_, [x]| {
            ([R1::table1(&T1, x)], true)
        })[0]
            .partials[0]
    };
    type R1 = Dual<f64, 1>;
    assert_eq!(slope(0.0), -6.0);
    assert_eq!(slope(1.0), 18.0);
    assert_eq!(slope(0.25), 16.0);
    assert_eq!(slope(-0.1), 0.0);
    assert_eq!(slope(1.1), 0.0);
    // Far and near points have angles too.
    for scale in [1e-200, 1e200] {
        let x = Dual::<f64, 1>::variable(scale, 0);
        let angle = Dual::constant(scale).atan2(x);
        assert!((angle.partials[0] * scale + 0.5).abs() < 1e-14);
    }
}
