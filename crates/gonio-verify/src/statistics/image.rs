//! Two images with their variances: do they show the same expectation?

use super::hypothesis::{sidak, z_test};

/// The outcome of [`image_z_test`].
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ImageZTest {
    /// Numbers compared.
    pub count: usize,
    /// The fraction whose difference is within chance.
    pub fraction_within: f64,
    /// The smallest p-value, before correction.
    pub smallest_p_value: f64,
    /// Where it is: the index into the slices.
    pub worst: Option<usize>,
    /// The significance each number was held to, after Šidák's correction.
    pub significance: f64,
    /// Mean of (a − b)² / (var a + var b) over the numbers with a variance: near 1 where the variances are right.
    pub mean_square_z: f64,
}

impl ImageZTest {
    /// Whether at least `fraction` of the numbers are within chance; 0.9975 is customary.
    pub fn passed(&self, fraction: f64) -> bool {
        self.fraction_within >= fraction
    }
}

/// A two-sided z-test of each number (pixel and channel) of `a` against `b`; of pixels `[[f32; 3]]` give `as_flattened()`.
///
/// - `variance_a`, `variance_b`: the variances of these estimates (of the mean, not of one sample); zeros for an exact
///   reference
/// - `significance`: the probability that *any* number is called different although all expectations agree; each is
///   held to Šidák's part of it
/// - `tolerance`: an absolute difference that is let pass, for rounding; also all that a number without variance has
///
/// A number that isn't finite is outside. The z-test takes estimates to be normal: a pixel needs some hundred samples,
/// and fireflies make it fail, which is why [`ImageZTest::passed`] leaves room for a few.
///
/// # Panics
/// If the slices differ in length.
pub fn image_z_test(
    a: &[f32],
    variance_a: &[f32],
    b: &[f32],
    variance_b: &[f32],
    significance: f64,
    tolerance: f64,
) -> ImageZTest {
    let count = a.len();
    assert!(
        [variance_a.len(), b.len(), variance_b.len()] == [count; 3],
        "images and variances of {count}, {}, {} and {} numbers can't be compared",
        variance_a.len(),
        b.len(),
        variance_b.len()
    );
    let each = sidak(significance, count.max(1) as u64);
    let (mut within, mut smallest, mut worst) = (0usize, 1.0, None);
    let (mut square_z, mut with_variance) = (0.0, 0u64);
    for i in 0..count {
        let difference = f64::from(a[i]) - f64::from(b[i]);
        let variance = f64::from(variance_a[i]) + f64::from(variance_b[i]);
        let beyond = (difference.abs() - tolerance).max(0.0);
        let p = if difference.is_finite() && variance.is_finite() && variance >= 0.0 {
            z_test(beyond, variance).p_value
        } else {
            0.0
        };
        if variance > 0.0 && difference.is_finite() {
            square_z += difference * difference / variance;
            with_variance += 1;
        }
        within += usize::from(p > each);
        if worst.is_none() || p < smallest {
            (smallest, worst) = (p, Some(i));
        }
    }
    ImageZTest {
        count,
        fraction_within: if count == 0 {
            1.0
        } else {
            within as f64 / count as f64
        },
        smallest_p_value: smallest,
        worst,
        significance: each,
        mean_square_z: if with_variance == 0 {
            f64::NAN
        } else {
            square_z / with_variance as f64
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_radiometry::sequence::Rng;

    /// Means of 64 uniform numbers: expectation 1/2, variance 1/768.
    fn noisy(rng: &mut Rng, n: usize) -> Vec<f32> {
        (0..n)
            .map(|_| ((0..64).map(|_| rng.next_f64()).sum::<f64>() / 64.0) as f32)
            .collect()
    }

    #[test]
    fn noise_passes_and_a_shift_is_caught() {
        let mut rng = Rng::from_name("noise_passes_and_a_shift_is_caught");
        let n = 4096;
        let a = noisy(&mut rng, n);
        let b = noisy(&mut rng, n);
        let v = vec![1.0 / 768.0; n];
        // At 1e-3 for the whole image.
        let t = image_z_test(&a, &v, &b, &v, 1e-3, 0.0);
        assert!(t.passed(1.0), "{t:?}");
        // The mean of 4096 χ²₁: 1 ± 5·√(2/4096).
        assert!((t.mean_square_z - 1.0).abs() < 0.11);
        // One pixel in a hundred off by 10 σ of the difference (0.051).
        let mut shifted = b.clone();
        shifted.iter_mut().step_by(100).for_each(|x| *x += 0.51);
        let t = image_z_test(&a, &v, &shifted, &v, 1e-3, 0.0);
        assert!(
            !t.passed(0.9975) && t.worst.unwrap().is_multiple_of(100),
            "{t:?}"
        );
    }

    #[test]
    fn without_variance_the_numbers_must_agree() {
        let zero = [0.0f32; 2];
        let t = |b: [f32; 2], tolerance| {
            image_z_test(&[1.0, 2.0], &zero, &b, &zero, 1e-3, tolerance).fraction_within
        };
        assert_eq!(t([1.0, 2.0], 0.0), 1.0);
        assert_eq!(t([1.0, 2.000_01], 0.0), 0.5);
        assert_eq!(t([1.0, 2.000_01], 1e-4), 1.0);
        assert_eq!(t([f32::NAN, 2.0], 1e9), 0.5);
    }
}
