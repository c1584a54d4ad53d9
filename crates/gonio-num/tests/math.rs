//! The single-precision functions against double precision, over dense grids of bit patterns and at the edges.

use gonio_num::math;

/// Distance of `got` from the exact value in units in the last place of the exact value.
fn ulp(got: f32, exact: f64) -> f64 {
    let rounded = exact as f32;
    if got == rounded || (got.is_nan() && rounded.is_nan()) {
        // Never more than half a unit, and infinities have no distance.
        return 0.0;
    }
    if !got.is_finite() || !rounded.is_finite() {
        return f64::INFINITY;
    }
    let exponent = exact.abs().max(f64::from(f32::MIN_POSITIVE)).log2().floor();
    (f64::from(got) - exact).abs() / (exponent - 23.0).exp2()
}

/// The largest error over every `step`-th bit pattern from `low` to `high` (both of one sign), and where it is.
fn worst(f: fn(f32) -> f32, exact: fn(f64) -> f64, low: f32, high: f32, step: usize) -> (f64, f32) {
    let (a, b) = (low.to_bits(), high.to_bits());
    let mut worst = (0.0, low);
    for bits in (a.min(b)..=a.max(b)).step_by(step) {
        let x = f32::from_bits(bits);
        let error = ulp(f(x), exact(f64::from(x)));
        if error > worst.0 {
            worst = (error, x);
        }
    }
    worst
}

#[track_caller]
fn assert_within(
    bound: f64,
    f: fn(f32) -> f32,
    exact: fn(f64) -> f64,
    (low, high): (f32, f32),
    step: usize,
) {
    let (error, x) = worst(f, exact, low, high, step);
    assert!(error <= bound, "{error} ulp at {x:e}");
}

const TINY: f32 = f32::from_bits(1);

#[test]
fn exp_is_accurate() {
    assert_within(1.0, math::exp, libm::exp, (TINY, 89.0), 1511);
    assert_within(1.0, math::exp, libm::exp, (-TINY, -87.33), 1511);
    // Subnormal results are rounded once more.
    assert_within(1.5, math::exp, libm::exp, (-87.33, -105.0), 13);
    assert_within(1.0, math::exp, libm::exp, (0.25, 0.75), 17);
}

#[test]
fn ln_is_accurate() {
    assert_within(1.0, math::ln, libm::log, (TINY, f32::MAX), 2503);
    assert_within(1.0, math::ln, libm::log, (0.5, 2.0), 23);
    assert_within(1.0, math::ln, libm::log, (TINY, f32::MIN_POSITIVE), 11);
}

#[test]
fn sine_and_cosine_are_accurate() {
    for (f, exact) in [
        (math::sin as fn(f32) -> f32, libm::sin as fn(f64) -> f64),
        (math::cos, libm::cos),
    ] {
        assert_within(2.4, f, exact, (TINY, 8192.0), 1511);
        assert_within(2.4, f, exact, (-TINY, -8192.0), 1511);
        assert_within(2.4, f, exact, (0.5, 8.0), 37);
    }
}

#[test]
fn multiples_of_an_eighth_turn_are_accurate() {
    // Where the reduced argument is smallest, and where it is largest, the reduction is hardest.
    for n in 1..10_430 {
        let x = (f64::from(n) * std::f64::consts::FRAC_PI_4) as f32;
        for bits in x.to_bits() - 20..=x.to_bits() + 20 {
            let x = f32::from_bits(bits);
            let error = ulp(math::sin(x), libm::sin(f64::from(x)));
            assert!(error <= 2.4, "sine: {error} ulp at {x}");
            let error = ulp(math::cos(x), libm::cos(f64::from(x)));
            assert!(error <= 2.4, "cosine: {error} ulp at {x}");
        }
    }
}

#[test]
fn acos_is_accurate() {
    assert_within(1.3, math::acos, libm::acos, (TINY, 1.0), 1009);
    assert_within(1.3, math::acos, libm::acos, (-TINY, -1.0), 1009);
    assert_within(1.3, math::acos, libm::acos, (0.49, 1.0), 7);
}

#[test]
fn atan2_is_accurate() {
    // Points on rays all around the origin, at three distances.
    let mut worst = (0.0, 0.0, 0.0);
    for i in 0..200_000 {
        let angle = f64::from(i) * 1e-5 * std::f64::consts::PI;
        for distance in [1e-30, 1.0, 3e38] {
            let (y, x) = (
                (distance * libm::sin(angle)) as f32,
                (distance * libm::cos(angle)) as f32,
            );
            let error = ulp(math::atan2(y, x), libm::atan2(f64::from(y), f64::from(x)));
            if error > worst.0 {
                worst = (error, y, x);
            }
        }
    }
    assert!(worst.0 <= 1.8, "{worst:?}");
}

#[test]
fn floor_is_exact() {
    for bits in (0..=u32::MAX).step_by(1009) {
        let x = f32::from_bits(bits);
        let (got, exact) = (math::floor(x), x.floor());
        assert!(
            got.to_bits() == exact.to_bits() || (got.is_nan() && exact.is_nan()),
            "{x:e}: {got:e}"
        );
    }
    for x in [
        -1.0f32, -0.5, -0.0, 0.0, 0.5, 0.99999994, 1.0, 8388607.5, -8388607.5,
    ] {
        assert_eq!(math::floor(x).to_bits(), x.floor().to_bits(), "{x}");
    }
}

#[test]
fn edges() {
    let inf = f32::INFINITY;
    assert_eq!(math::exp(0.0), 1.0);
    assert_eq!(math::exp(-0.0), 1.0);
    assert_eq!(math::exp(inf), inf);
    assert_eq!(math::exp(-inf), 0.0);
    assert_eq!(math::exp(f32::MAX), inf);
    assert_eq!(math::exp(88.722_84), inf);
    assert!(math::exp(88.722_83) < inf);
    assert_eq!(math::exp(-103.97), TINY);
    assert_eq!(math::exp(-103.98), 0.0);
    assert!(math::exp(f32::NAN).is_nan());

    assert_eq!(math::ln(1.0).to_bits(), 0.0f32.to_bits());
    assert_eq!(math::ln(0.0), -inf);
    assert_eq!(math::ln(-0.0), -inf);
    assert_eq!(math::ln(inf), inf);
    for x in [-TINY, -1.0, -inf, f32::NAN] {
        assert!(math::ln(x).is_nan(), "{x}");
    }

    for f in [math::sin, math::cos] {
        for x in [inf, -inf, f32::NAN] {
            assert!(f(x).is_nan(), "{x}");
        }
        for x in [1e5f32, 5e6, 1e10, 1e30, f32::MAX] {
            assert!(f(x).abs() <= 1.0 && f(-x).abs() <= 1.0, "{x}");
        }
    }
    assert_eq!(math::sin(0.0), 0.0);
    assert_eq!(math::cos(0.0), 1.0);

    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};
    assert_eq!(math::acos(1.0), 0.0);
    assert_eq!(math::acos(-1.0), PI);
    assert_eq!(math::acos(0.0), FRAC_PI_2);
    assert_eq!(math::acos(1.5), 0.0);
    assert_eq!(math::acos(-inf), PI);
    assert!(math::acos(f32::NAN).is_nan());

    for (y, x, angle) in [
        (0.0, 1.0, 0.0),
        (0.0, -1.0, PI),
        (-0.0, -1.0, -PI),
        (1.0, 0.0, FRAC_PI_2),
        (-1.0, -0.0, -FRAC_PI_2),
        (0.0, 0.0, 0.0),
        (0.0, -0.0, 0.0),
        (1.0, 1.0, FRAC_PI_4),
        (inf, inf, FRAC_PI_4),
        (inf, -inf, PI - FRAC_PI_4),
        (inf, 1.0, FRAC_PI_2),
        (-1.0, -inf, -PI),
        (TINY, TINY, FRAC_PI_4),
    ] {
        let got = math::atan2(y, x);
        assert!(ulp(got, f64::from(angle)) <= 1.0, "atan2({y}, {x}) = {got}");
        assert_eq!(got.is_sign_negative(), angle.is_sign_negative());
    }
    assert!(math::atan2(f32::NAN, 1.0).is_nan());
    assert!(math::atan2(1.0, f32::NAN).is_nan());
    assert!(math::atan2(f32::NAN, f32::NAN).is_nan());
}

#[test]
fn known_bits() {
    // Pinned: other values on some machine would mean that its pictures differ.
    let bits = [
        math::exp(1.0),
        math::exp(-20.7),
        math::ln(10.0),
        math::ln(0.3),
        math::sin(1.0),
        math::sin(-4321.5),
        math::cos(2.0),
        math::acos(0.3),
        math::acos(-0.9),
        math::atan2(-0.7, -0.2),
    ]
    .map(f32::to_bits);
    let expected = [
        0x402d_f854,
        0x308c_ac89,
        0x4013_5d8e,
        0xbf9a_1bc8,
        0x3f57_6aa5,
        0x3f78_b46b,
        0xbed5_1132,
        0x3fa2_0fb0,
        0x402c_323b,
        0xbfec_af2e,
    ];
    assert_eq!(bits, expected);
}
