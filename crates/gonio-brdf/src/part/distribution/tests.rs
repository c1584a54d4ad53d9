use super::*;

/// ∫ f dh over the hemisphere: `rings` midpoints of t = tanθ/(1 + tanθ), which spreads the peak, times `turns` of φ.
pub(in crate::part) fn hemisphere_sum(rings: u32, turns: u32, f: impl Fn(Vec3<f64>) -> f64) -> f64 {
    let mut sum = 0.0;
    for i in 0..rings {
        let t = (f64::from(i) + 0.5) / f64::from(rings);
        let tan = t / (1.0 - t);
        let cos = 1.0 / (1.0 + tan * tan).sqrt();
        let sin = tan * cos;
        let d_theta = cos * cos / (1.0 - t).powi(2) / f64::from(rings);
        for j in 0..turns {
            let h = around_axis((f64::from(j) + 0.5) / f64::from(turns), sin, cos);
            sum += f(h) * sin * d_theta;
        }
    }
    sum * std::f64::consts::TAU / f64::from(turns)
}

/// Every shape, with tails from one end of their ranges to the other.
pub(in crate::part) fn all(alpha_x: f64, alpha_y: f64) -> Vec<Distribution<f64>> {
    let mut all = Vec::new();
    for shape in Shape::ALL {
        let tails = match shape.tail() {
            Some(Tail {
                range: (low, high), ..
            }) => vec![low, 1.0, 0.5 * (low + high), high],
            None => vec![0.0],
        };
        for tail in tails {
            all.push(Distribution::new(shape, alpha_x, alpha_y, tail));
        }
    }
    all
}

#[test]
fn names_and_places_agree() {
    for (k, shape) in Shape::ALL.into_iter().enumerate() {
        assert_eq!(shape.index(), k);
        assert_eq!(Shape::from_name(Shape::NAMES[k]), Some(shape));
    }
    assert_eq!(Shape::from_name("gauss"), None);
}

#[test]
fn projected_area_is_one() {
    for (ax, ay) in [(0.1, 0.1), (0.5, 0.2), (1.0, 1.0)] {
        for d in all(ax, ay) {
            // What the midpoint rule misses of the heaviest tail, which ends at the horizon as cos^-0.8, and of the sharpest
            // centre, α² = 0.01 wide.
            let tolerance = match d.shape {
                Shape::StudentT if d.tail < 2.0 => 2e-3,
                Shape::ShiftedGamma => 5e-5,
                _ => 1e-5,
            };
            let turns = if d.alpha_x == d.alpha_y { 1 } else { 128 };
            let sum = hemisphere_sum(8000, turns, |h| d.density(h) * h.z);
            assert!((sum - 1.0).abs() < tolerance, "{d:?}: {sum}");
            // A step of the density falls into one of the rings.
            let tolerance = if d.shape == Shape::ShiftedGamma {
                2e-4
            } else {
                tolerance
            };
            let sum = hemisphere_sum(8000, turns, |h| d.normal_density(h, d.density(h)));
            assert!((sum - 1.0).abs() < tolerance, "{d:?}: {sum}");
        }
    }
}

/// As many of the normals lie in a polar cap as the density says. Each row of the 400 × 400 draws may be off by one.
#[test]
fn samples_have_the_density_that_is_stated() {
    for (ax, ay) in [(0.5, 0.3), (0.05, 0.05)] {
        for d in all(ax, ay) {
            let n = 400;
            let u = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
            let turns = if d.alpha_x == d.alpha_y { 1 } else { 128 };
            for cos in [0.999, 0.97, 0.8] {
                let mut inside = 0;
                for i in 0..n {
                    for j in 0..n {
                        let h = d.sample_normal(u(i), u(j));
                        assert!((h.length() - 1.0).abs() < 1e-12);
                        inside += u32::from(h.z > cos);
                    }
                }
                let found = f64::from(inside) / f64::from(n * n);
                let expected = hemisphere_sum(4000, turns, |h| {
                    f64::from(h.z > cos) * d.normal_density(h, d.density(h))
                });
                assert!(
                    (found - expected).abs() < 4e-3,
                    "{d:?} {cos}: {found} {expected}"
                );
            }
        }
    }
}

#[test]
fn what_is_drawn_covers_what_is_wanted() {
    // The weights D h.z / p of normals that are drawn by another density than D h.z are at most e times their mean, but for
    // the masses of the two ranges that the shifted gamma's proposal only estimates.
    for alpha in [1e-3, 0.1, 0.5, 1.0] {
        for d in all(alpha, alpha) {
            for k in 0..200 {
                let h = d.sample_normal(0.25, (f64::from(k) + 0.5) / 200.0);
                let density = d.density(h);
                let weight = density * h.z / d.normal_density(h, density);
                assert!(weight < 4.0, "{d:?} {h:?}: {weight}");
            }
        }
    }
}

/// σ by quadrature is what the closed forms of masking have towards grazing angles.
#[test]
fn spread_is_that_of_the_closed_forms() {
    for alpha in [1e-4, 0.2, 1.0] {
        for (shape, tail) in [(Shape::Ggx, 0.0), (Shape::Gtr, 2.0), (Shape::StudentT, 2.0)] {
            let d = Distribution::new(shape, alpha, alpha, tail);
            // `gtr` is a little below α = 1 where that is its end.
            assert!(
                (d.mean_slope() / alpha - 1.0).abs() < 2e-3,
                "{shape:?} {alpha}"
            );
            assert!((d.spread() - 1.0).abs() < 2e-3);
        }
        let d = Distribution::new(Shape::StudentT, alpha, alpha, 5.0);
        assert!((d.mean_slope() / (alpha * d.spread()) - 1.0).abs() < 1e-6);
        // Beckmann: E[r] = α √π/2, σ = 2 E[r]/π = α/√π.
        let d = Distribution::new(Shape::Beckmann, alpha, alpha, 0.0);
        assert!((d.mean_slope() / alpha * std::f64::consts::PI.sqrt() - 1.0).abs() < 1e-6);
    }
}

#[test]
fn special_tails_are_other_shapes() {
    let h = Vec3::new(0.3, 0.1, 0.9).normalize();
    let ggx = Distribution::new(Shape::Ggx, 0.4, 0.4, 0.0).density(h);
    for shape in [Shape::Gtr, Shape::StudentT] {
        let d = Distribution::new(shape, 0.4, 0.4, 2.0);
        assert!((d.density(h) / ggx - 1.0).abs() < 1e-13, "{shape:?}");
    }
    let brushed = Distribution::new(Shape::StudentT, 0.4, 0.2, 2.0).density(h);
    let expected = Distribution::new(Shape::Ggx, 0.4, 0.2, 0.0).density(h);
    assert!((brushed / expected - 1.0).abs() < 1e-13);
    // Student's t tends to the Gaussian as 1/γ: (1 + e/(γ − 1))^−γ against exp(−e) for e of order 1.
    let normal = Distribution::new(Shape::Beckmann, 0.4, 0.4, 0.0).density(h);
    let t = Distribution::new(Shape::StudentT, 0.4, 0.4, 40.0).density(h);
    assert!((t / normal - 1.0).abs() < 0.05);
}

#[test]
fn shifted_gamma_by_hand() {
    // a = 0.25, p = 0.5: Γ(1/2, 1/4) = √π erfc(1/2) = 0.849 891 (Abramowitz & Stegun 6.5.17 with erfc(0.5) = 0.479 500 1).
    let d = Distribution::new(Shape::ShiftedGamma, 0.5, 0.5, 0.5);
    let gamma = std::f64::consts::PI.sqrt() * 0.479_500_122_186_953_5;
    let up = Vec3::new(0.0, 0.0, 1.0);
    let x = 0.25f64;
    let expected = (-x).exp() * x.powf(-0.5) / (std::f64::consts::PI * 0.25 * gamma);
    assert!(
        (d.density(up) / expected - 1.0).abs() < 1e-9,
        "{}",
        d.density(up) / expected
    );
}

#[test]
fn out_of_range_is_the_nearest_end() {
    let d = Distribution::new(Shape::StudentT, 0.0, 2.0, 0.0);
    assert_eq!((d.alpha_x(), d.alpha_y(), d.tail()), (ALPHA_MIN, 1.0, 1.6));
    let d = Distribution::new(Shape::Gtr, 0.25, 0.04, 1.0);
    assert!((d.alpha_x() - 0.1).abs() < 1e-15 && d.alpha_x() == d.alpha_y());
    assert_eq!(d.tail(), 1.0 + CONTRAST);
}
