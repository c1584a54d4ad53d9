//! Vectors and frames in single precision.

use gonio_num::{Frame, Real, Vec3};
use proptest::prelude::*;

type V = Vec3<f32>;

/// Rounding of three products and sums of numbers up to 1 stays below 4 units of 2⁻²⁴; 1e-6 is four times that.
const TOLERANCE: f32 = 1e-6;

#[track_caller]
fn assert_orthonormal(f: &Frame<f32>) {
    for (what, value, exact) in [
        ("s·s", f.s.dot(f.s), 1.0),
        ("t·t", f.t.dot(f.t), 1.0),
        ("n·n", f.n.dot(f.n), 1.0),
        ("s·t", f.s.dot(f.t), 0.0),
        ("t·n", f.t.dot(f.n), 0.0),
        ("n·s", f.n.dot(f.s), 0.0),
        ("(s×t)·n", f.s.cross(f.t).dot(f.n), 1.0),
    ] {
        assert!(
            (value - exact).abs() <= TOLERANCE,
            "{what} = {value}: {f:?}"
        );
    }
}

fn unit() -> impl Strategy<Value = V> {
    [-1.0f64..1.0, -1.0f64..1.0, -1.0f64..1.0]
        .prop_map(Vec3::from)
        .prop_filter("not zero", |v| v.length() > 0.01)
        .prop_map(|v: Vec3<f64>| v.normalize().to_f32())
}

/// A unit vector at a small angle to −z.
fn near_the_south_pole() -> impl Strategy<Value = V> {
    (-12.0f64..-0.5, 0.0f64..std::f64::consts::TAU).prop_map(|(exponent, phi)| {
        let sin = 10f64.powf(exponent);
        Vec3::new(
            sin * Real::cos(phi),
            sin * Real::sin(phi),
            -(1.0 - sin * sin).sqrt(),
        )
        .to_f32()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn frames_are_orthonormal(n in prop_oneof![unit(), near_the_south_pole()]) {
        assert_orthonormal(&Frame::from_normal(n));
    }

    #[test]
    fn frames_with_a_tangent_are_orthonormal(
        n in unit(), tangent in unit(), toward_n in 0.0f32..20.0, size in -15.0f32..15.0,
    ) {
        // Tangents from right across the normal to along it, of many lengths.
        let weight = Real::powf(2.0f32, -toward_n);
        let tangent = (n * (1.0 - weight) + tangent * weight) * Real::powf(10.0f32, size);
        let frame = Frame::from_normal_tangent(n, tangent);
        assert_orthonormal(&frame);
        prop_assert!(frame.s.dot(tangent) >= -1e-3 * tangent.length());
    }

    #[test]
    fn local_and_world_are_inverse(n in unit(), v in unit()) {
        let f = Frame::from_normal(n);
        prop_assert!((f.to_world(f.to_local(v)) - v).length() < 1e-6);
        prop_assert!((f.to_local(f.to_world(v)) - v).length() < 1e-6);
        prop_assert!((f.to_local(n) - V::new(0.0, 0.0, 1.0)).length() < 1e-6);
    }

    #[test]
    fn reflection_keeps_length_and_angle(w in unit(), axis in unit()) {
        let r = w.reflect(axis);
        prop_assert!((r.length() - 1.0).abs() < 2e-6);
        prop_assert!((r.dot(axis) - w.dot(axis)).abs() < 1e-6);
        prop_assert!((r.reflect(axis) - w).length() < 4e-6);
    }

    #[test]
    fn cross_products_are_perpendicular(a in unit(), b in unit()) {
        let c = a.cross(b);
        prop_assert!(c.dot(a).abs() < 1e-6 && c.dot(b).abs() < 1e-6);
        let sin2 = 1.0 - a.to_f64().dot(b.to_f64()).powi(2);
        prop_assert!((f64::from(c.length_squared()) - sin2).abs() < 1e-6);
    }
}

#[test]
fn frames_at_the_poles() {
    for z in [1.0f32, -1.0] {
        for zero in [0.0f32, -0.0] {
            let n = V::new(zero, -zero, z);
            assert_orthonormal(&Frame::from_normal(n));
        }
    }
    let equator = V::new(0.6, 0.8, -0.0);
    assert_orthonormal(&Frame::from_normal(equator));
}

#[test]
fn tangents_without_a_direction_fall_back() {
    let n = V::new(0.6, 0.0, -0.8);
    let fallback = Frame::from_normal(n).s;
    for tangent in [
        V::zero(),
        n,
        -n * 3.0,
        n * 1e-30,
        V::splat(1e-30),
        V::splat(1e30),
    ] {
        let frame = Frame::from_normal_tangent(n, tangent);
        assert_orthonormal(&frame);
        assert_eq!(frame.s, fallback, "{tangent:?}");
    }
}

#[test]
fn reflection_about_the_normal() {
    let w = V::new(0.6, 0.0, 0.8);
    assert_eq!(w.reflect(V::new(0.0, 0.0, 1.0)), V::new(-0.6, 0.0, 0.8));
}

#[test]
#[should_panic(expected = "not 3")]
fn a_fourth_coordinate_panics() {
    let _ = V::zero()[3];
}
