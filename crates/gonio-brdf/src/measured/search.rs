//! Searching sorted tables over lanes.

use crate::{Index, Number};

/// The last of `count` ascending numbers, which stand in `table` from `start` on, that is ≤ `x`: its place, counted from `start`; 0
/// if there is none.
///
/// By halving, with the same number of steps for every lane.
#[inline(always)]
pub(super) fn last_not_above<R: Number>(
    table: &[f32],
    start: R::Index,
    count: u32,
    x: R,
) -> R::Index {
    let mut at = R::Index::splat(0);
    // The answer is one of `rest` numbers from `at` on.
    let mut rest = count;
    while rest > 1 {
        let half = rest / 2;
        let probe = at.plus(R::Index::splat(half));
        let [value] = R::gather(table, start.plus(probe));
        at = R::select_index(value.le(x), probe, at);
        rest -= half;
    }
    at
}

/// The place k of `count` intervals in which `u` in [0, 1) lies, for the ascending ends that stand in `table` from `start` on (`count`
/// + 1 numbers), and how far in it, in [0, 1].
///
/// An interval of no width is never chosen for a u inside [first, last).
#[inline(always)]
pub(super) fn interval<R: Number>(
    table: &[f32],
    start: R::Index,
    count: u32,
    u: R,
) -> (R::Index, R) {
    let k = last_not_above(table, start, count, u);
    let [low, high] = R::gather(table, start.plus(k));
    let t = (u - low) / (high - low).max(R::lit(1e-30));
    (k, t.saturate())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_not_above_is_found() {
        for count in 1..20u32 {
            let table: Vec<f32> = (0..count + 3).map(|k| (k * k) as f32).collect();
            for start in 0..3u32 {
                for x in -1..450 {
                    let x = f64::from(x) + 0.5;
                    let all = &table[start as usize..(start + count) as usize];
                    let expected = all.partition_point(|v| f64::from(*v) <= x).max(1) - 1;
                    let found = last_not_above(&table, start, count, x);
                    assert_eq!(found as usize, expected, "{count} {start} {x}");
                }
            }
        }
    }

    #[test]
    fn intervals_without_width_are_not_chosen() {
        let cdf = [0.0f32, 0.25, 0.25, 1.0];
        assert_eq!(interval(&cdf, 0, 3, 0.0f64), (0, 0.0));
        assert_eq!(interval(&cdf, 0, 3, 0.25f64), (2, 0.0));
        assert_eq!(interval(&cdf, 0, 3, 0.625f64), (2, 0.5));
    }
}
