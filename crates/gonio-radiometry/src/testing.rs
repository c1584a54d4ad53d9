//! χ² for the tests of this crate.

/// Deviations above this reject: by chance in 1 of 3.4 million tests each (the normal distribution's upper tail at 5 is
/// 2.9e-7). The crate makes fewer than 4000 of them, so the whole suite rejects a right program once in a thousand choices
/// of its seeds (Šidák), and the seeds are fixed.
pub(crate) const LIMIT: f64 = 5.0;

/// How many standard deviations the χ² statistic lies above its mean, by the normal approximation of Wilson and Hilferty
/// 1931. Cells that expect fewer than 5 are pooled; where even these expect fewer than 5 together, 30 or more counts (chance
/// below 1e-13) are an infinite deviation.
pub(crate) fn chi_squared(observed: &[f64], expected: &[f64]) -> f64 {
    let mut pooled = (0.0, 0.0);
    let (mut statistic, mut cells) = (0.0, 0.0);
    let mut add = |o: f64, e: f64| {
        statistic += (o - e) * (o - e) / e;
        cells += 1.0;
    };
    for (&o, &e) in observed.iter().zip(expected) {
        if e >= 5.0 {
            add(o, e);
        } else {
            pooled = (pooled.0 + o, pooled.1 + e);
        }
    }
    if pooled.1 >= 5.0 {
        add(pooled.0, pooled.1);
    } else if pooled.0 >= 30.0 {
        return f64::INFINITY;
    }
    let freedom = cells - 1.0;
    assert!(freedom >= 1.0, "a χ² test needs two cells that expect 5");
    let spread = 2.0 / (9.0 * freedom);
    ((statistic / freedom).cbrt() - (1.0 - spread)) / spread.sqrt()
}
