//! The tables: discrete and piecewise constant.

use super::*;
use crate::RadiometryError;
use crate::sequence::Rng;
use crate::warp::*;
use proptest::prelude::*;

const ALMOST_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

#[test]
fn a_discrete_choice_has_its_probabilities() {
    let weights = [0.5f32, 0.0, 3.0, 1e-3, 0.0, 2.0, 0.0];
    let choice = Discrete::new(&weights).unwrap();
    let total: f64 = weights.iter().map(|&w| f64::from(w)).sum();
    assert_eq!((choice.len(), choice.sum()), (7, total));
    let mut rng = Rng::from_name("a_discrete_choice_has_its_probabilities");
    let n = 100_000;
    let mut counts = [0.0; 7];
    for _ in 0..n {
        let u = rng.next_f32();
        let (index, probability, rest) = choice.sample(u);
        counts[index] += 1.0;
        assert_eq!(probability, choice.probability(index));
        assert!((0.0..1.0).contains(&rest) && probability > 0.0);
        assert!((choice.inverse(index, rest) - u).abs() < 1e-7);
    }
    let expected = weights.map(|w| f64::from(w) / total * f64::from(n));
    assert!(chi_squared(&counts, &expected) < LIMIT);
    let mut wrong = expected;
    wrong[0] *= 1.1;
    wrong[2] -= 0.1 * expected[0];
    assert!(chi_squared(&counts, &wrong) > LIMIT);
    for (i, w) in weights.iter().enumerate() {
        assert!((f64::from(choice.probability(i)) - f64::from(*w) / total).abs() < 1e-7);
        assert_eq!(choice.probability(i) == 0.0, *w == 0.0);
    }
    assert_eq!(choice.probability(7), 0.0);
}

/// The remapped number is uniform again.
#[test]
fn what_a_choice_leaves_is_uniform() {
    let choice = Discrete::new(&[1.0, 2.0, 5.0]).unwrap();
    let mut counts = [0.0; 60];
    let mut rng = Rng::from_name("what_a_choice_leaves_is_uniform");
    for _ in 0..60_000 {
        let (index, _, rest) = choice.sample(rng.next_f32());
        counts[index * 20 + (rest * 20.0) as usize] += 1.0;
    }
    let expected: Vec<f64> = (0..60)
        .map(|i| 3000.0 * [0.125, 0.25, 0.625][i / 20])
        .collect();
    assert!(chi_squared(&counts, &expected) < LIMIT);
}

#[test]
fn the_ends_of_the_interval_choose_positive_entries() {
    for weights in [
        &[0.0f32, 1.0, 0.0][..],
        &[1.0],
        &[0.0, 0.0, 2.0],
        &[2.0, 0.0],
        &[1e-38, 1e38, 1e-38],
    ] {
        let choice = Discrete::new(weights).unwrap();
        for u in [
            0.0,
            1e-30,
            0.5,
            ALMOST_ONE,
            1.0,
            f32::NAN,
            -1.0,
            f32::INFINITY,
        ] {
            let (index, probability, rest) = choice.sample(u);
            assert!(weights[index] > 0.0 && probability > 0.0, "{weights:?} {u}");
            assert!((0.0..1.0).contains(&rest));
        }
    }
    // However small, a positive entry keeps a probability, and the others lose no more than that.
    let extreme = Discrete::new(&[1e-38, 1e38, 1e-38]).unwrap();
    let tiny = 0.5f32.powi(32);
    assert_eq!([0, 1, 2].map(|i| extreme.probability(i)), [tiny, 1.0, tiny]);
    assert_eq!(extreme.sample(0.0).0, 0);
}

#[test]
fn sums_beyond_single_precision_are_right() {
    let many = Discrete::new(&vec![1.0; 100_000]).unwrap();
    assert_eq!(many.sum(), 1e5);
    let worst = (0..100_000)
        .map(|i| (f64::from(many.probability(i)) * 1e5 - 1.0).abs())
        .fold(0.0, f64::max);
    // One unit of 2⁻³² in 1e-5.
    assert!(worst < 3e-5, "{worst}");
    let huge = Discrete::new(&[f32::MAX, f32::MAX, f32::MAX]).unwrap();
    assert!((huge.probability(1) - 1.0 / 3.0).abs() < 1e-7);
}

#[test]
fn bad_tables_are_named() {
    use RadiometryError::*;
    let shape = |width, height, found| TableShape {
        width,
        height,
        found,
        max: 1 << 24,
    };
    assert_eq!(Discrete::new(&[]), Err(shape(0, 1, 0)));
    assert_eq!(Piecewise1d::new(&[]), Err(shape(0, 1, 0)));
    assert_eq!(Piecewise2d::new(&[1.0; 5], 2, 3), Err(shape(2, 3, 5)));
    assert_eq!(Piecewise2d::new(&[], 0, 0), Err(shape(0, 0, 0)));
    assert_eq!(
        Piecewise2d::new(&[], usize::MAX, 2),
        Err(shape(usize::MAX, 2, 0))
    );
    assert_eq!(Discrete::new(&[0.0, 0.0]), Err(TableAllZero { entries: 2 }));
    assert_eq!(Piecewise1d::new(&[0.0]), Err(TableAllZero { entries: 1 }));
    assert_eq!(
        Piecewise2d::new(&[0.0; 6], 2, 3),
        Err(TableAllZero { entries: 6 })
    );
    assert_eq!(
        Discrete::new(&[1.0, -2.0]),
        Err(TableEntry {
            x: 1,
            y: 0,
            value: -2.0
        })
    );
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1e-30] {
        let error = Piecewise2d::new(&[1.0, 1.0, 1.0, 1.0, 1.0, bad], 2, 3).unwrap_err();
        assert!(matches!(error, TableEntry { x: 1, y: 2, .. }));
        let text = error.to_string();
        assert!(
            text.contains("(1, 2)") && text.contains(&bad.to_string()),
            "{text}"
        );
    }
    // A negative zero is a zero.
    assert_eq!(Discrete::new(&[-0.0, 1.0]).unwrap().probability(0), 0.0);
}

#[test]
fn a_piecewise_density_is_its_entries_over_their_mean() {
    let entries = [2.0f32, 0.0, 1.0, 5.0];
    let table = Piecewise1d::new(&entries).unwrap();
    assert_eq!(table.integral(), 2.0);
    for (i, f) in entries.iter().enumerate() {
        let x = (i as f32 + 0.5) / 4.0;
        assert!((table.density(x) - f / 2.0).abs() < 1e-6);
    }
    assert_distributed(
        "a_piecewise_density_is_its_entries_over_their_mean",
        |[u, v]| [v, table.sample(u as f32).0.into()],
        |_, x| table.density(x as f32).into(),
        1e-6,
    );
    // Rising in u, over the gap too.
    let mut last = -1.0;
    for i in 0..1000 {
        let (x, density) = table.sample(i as f32 / 1000.0);
        assert!(x > last && density > 0.0);
        last = x;
    }
}

/// A smooth picture with a black row, a black column and a bright spot.
fn picture(width: usize, height: usize) -> Vec<f32> {
    let mut entries: Vec<f32> = (0..width * height)
        .map(|k| {
            let (x, y) = (k % width, k / width);
            if y == 2 || x == 3 {
                0.0
            } else {
                1.0 + (x * y % 5) as f32
            }
        })
        .collect();
    entries[width + 1] = 300.0;
    entries
}

#[test]
fn a_picture_is_sampled_by_its_density() {
    let (width, height) = (12, 8);
    let entries = picture(width, height);
    let table = Piecewise2d::new(&entries, width, height).unwrap();
    assert_eq!((table.width(), table.height()), (width, height));
    let mean = entries.iter().map(|&f| f64::from(f)).sum::<f64>() / entries.len() as f64;
    assert_eq!(table.integral(), mean);
    for (k, f) in entries.iter().enumerate() {
        let p = [(k % width) as f32 + 0.5, (k / width) as f32 + 0.5];
        let density = table.density([p[0] / width as f32, p[1] / height as f32]);
        assert!(
            (f64::from(density) - f64::from(*f) / mean).abs() < 1e-6 * f64::from(density) + 1e-12
        );
    }
    assert_distributed(
        "a_picture_is_sampled_by_its_density",
        |u| table.sample(u.map(|x| x as f32)).0.map(f64::from),
        |x, y| table.density([x as f32, y as f32]).into(),
        1e-6,
    );
}

#[test]
fn thin_tables_work() {
    let one = Piecewise2d::new(&[7.0], 1, 1).unwrap();
    let (p, density) = one.sample([0.25, ALMOST_ONE]);
    assert_eq!((p, density), ([0.25, ALMOST_ONE], 1.0));
    assert_eq!(one.integral(), 7.0);
    let row = Piecewise2d::new(&[0.0, 1.0, 3.0], 3, 1).unwrap();
    let column = Piecewise2d::new(&[0.0, 1.0, 3.0], 1, 3).unwrap();
    for [u, v] in squares("thin_tables_work", 100).map(|u| u.map(|x| x as f32)) {
        let (p, density) = row.sample([u, v]);
        let (q, other) = column.sample([v, u]);
        assert_eq!(([p[0], p[1]], density), ([q[1], q[0]], other));
    }
}

#[test]
fn points_outside_count_as_the_nearest_end() {
    let table = Piecewise2d::new(&[1.0, 2.0, 3.0, 4.0], 2, 2).unwrap();
    assert_eq!(table.density([-1.0, 2.0]), table.density([0.0, 0.9]));
    assert_eq!(table.density([1.0, 1.0]), table.density([0.9, 0.9]));
    for bad in [f32::NAN, f32::INFINITY, -0.5] {
        let (p, density) = table.sample([bad, bad]);
        assert!(p.iter().all(|x| (0.0..1.0).contains(x)) && density > 0.0);
        assert!(
            table
                .inverse([bad, bad])
                .iter()
                .all(|x| (0.0..1.0).contains(x))
        );
    }
}

proptest! {
    #[test]
    fn random_tables_are_exact(
        (width, height, entries) in (1..40usize, 1..20usize).prop_flat_map(|(w, h)| {
            let entry = prop_oneof![Just(0.0f32), 0.0..1.0f32, Just(1e-20f32), 1e3..1e6f32];
            (Just(w), Just(h), prop::collection::vec(entry, w * h))
        }),
        us in prop::collection::vec((0.0..1.0f32, 0.0..1.0f32), 50),
    ) {
        prop_assume!(entries.iter().any(|&f| f > 0.0));
        let table = Piecewise2d::new(&entries, width, height).unwrap();
        let corners = [(0.0, 0.0), (ALMOST_ONE, ALMOST_ONE), (0.0, ALMOST_ONE)];
        for (u, v) in us.into_iter().chain(corners) {
            let (p, density) = table.sample([u, v]);
            prop_assert!(p.iter().all(|x| (0.0..1.0).contains(x)));
            prop_assert_eq!(density, table.density(p));
            let cell = [(p[0] * width as f32) as usize, (p[1] * height as f32) as usize];
            prop_assert!(density > 0.0 && density.is_finite());
            prop_assert!(cell[0] < width && cell[1] < height);
            let back = table.inverse(p);
            // A rounding of p (6e-8) is magnified by the density of its axis, at most width or height.
            prop_assert!((back[0] - u).abs() < 1.3e-7 * (1 + width) as f32);
            prop_assert!((back[1] - v).abs() < 1.3e-7 * (1 + height) as f32);
        }
        let mut sum = 0.0;
        for j in 0..height {
            for i in 0..width {
                let at = [(i as f32 + 0.5) / width as f32, (j as f32 + 0.5) / height as f32];
                let density = f64::from(table.density(at));
                prop_assert_eq!(density > 0.0, entries[j * width + i] > 0.0);
                sum += density;
            }
        }
        prop_assert!((sum / (width * height) as f64 - 1.0).abs() < 1e-6);
    }
}
