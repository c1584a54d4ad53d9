//! Tables read by every number type.

use super::*;
use gonio_num::dispatch::{InstructionSet, Kernel, dispatch_on};

const TABLE: [f32; 8] = [1.0, 3.0, 2.0, 8.0, -4.0, 0.5, 0.25, 7.0];

/// The table at x in [0, 7], linear between its nodes.
#[inline(always)]
fn interpolate<R: Number>(x: R) -> R {
    let (i, t) = x.cell(8);
    let [low, high] = R::gather(&TABLE, i);
    t.lerp(low, high)
}

/// Entry 3 below x = 3, entry 6 from there on.
#[inline(always)]
fn chosen<R: Number>(x: R) -> R {
    let high = R::Index::splat(1).plus(R::Index::splat(1)).times(3);
    let i = R::select_index(x.lt(R::lit(3.0)), R::Index::splat(3), high);
    R::gather::<1>(&TABLE, i)[0] + R::from_index(i)
}

#[test]
fn cells_are_limited_and_nan_is_the_first() {
    for (x, i, t) in [
        (0.0, 0, 0.0),
        (2.25, 2, 0.25),
        (7.0, 6, 1.0),
        (7.5, 6, 1.0),
        (1e30, 6, 1.0),
        (f64::INFINITY, 6, 1.0),
        (-0.5, 0, 0.0),
        (f64::NEG_INFINITY, 0, 0.0),
        (f64::NAN, 0, 0.0),
    ] {
        assert_eq!(x.cell(8), (i, t), "{x}");
        assert_eq!((x as f32).cell(8), (i, t as f32), "{x}");
    }
    assert_eq!(interpolate(2.25f64), 0.75 * 2.0 + 0.25 * 8.0);
    assert_eq!(interpolate(7.0f64), 7.0);
    assert_eq!((chosen(2.9f64), chosen(3.0f64)), (11.0, 6.25));
    // The largest that is promised.
    assert_eq!(8_388_607.0f32.index(8_388_607), 8_388_607);
    assert_eq!(
        Lanes::<4>::splat(8_388_607.0).index(8_388_607).0,
        [8_388_607; 4]
    );
    assert_eq!(f32::from_index(8_388_607), 8_388_607.0);
}

#[test]
fn addresses_are_limited_to_the_table() {
    assert_eq!(f32::gather::<3>(&TABLE, 1), [3.0, 2.0, 8.0]);
    assert_eq!(f64::gather::<3>(&TABLE, 6), [0.5, 0.25, 7.0]);
    assert_eq!(f64::gather::<8>(&TABLE, u32::MAX), TABLE.map(f64::from));
    // All of them must stand in the table: at most 2 + 4 + 2.
    let found = f32::gather_each::<2, 2>(&TABLE, 7, [4, 0]);
    assert_eq!(found, [[0.25, 7.0], [2.0, 8.0]]);
    // Arithmetic wraps instead of panicking.
    assert_eq!(u32::MAX.plus(3).times(u32::MAX), 0u32.wrapping_sub(2));
}

#[test]
#[should_panic(expected = "a table of 8 numbers has no 9 at 0")]
fn a_table_that_is_too_short_is_refused() {
    let _ = Lanes::<8>::gather::<9>(&TABLE, LaneIndex::splat(0));
}

/// Every way to read `K` numbers, at addresses within, at the end of and beyond the table.
#[inline(always)]
fn groups<R: Number>(x: R) -> R {
    let i = x.index(40);
    let mut sum = R::zero();
    for found in R::gather::<1>(&TABLE, i) {
        sum = sum + found;
    }
    for (k, found) in R::gather::<2>(&TABLE, i).into_iter().enumerate() {
        sum = sum + found * R::lit(30.0 + k as f64);
    }
    for (k, found) in R::gather::<3>(&TABLE, i).into_iter().enumerate() {
        sum = sum + found * R::lit(10.0 + k as f64);
    }
    for (m, [a, b]) in R::gather_each(&TABLE, i, [5, 0, 2]).into_iter().enumerate() {
        sum = sum + (a - b) * R::lit(1000.0 + m as f64);
    }
    for (k, found) in R::gather::<4>(&TABLE, i.times(3)).into_iter().enumerate() {
        sum = sum + found * R::lit(100.0 + k as f64);
    }
    sum
}

struct Batch<'a> {
    x: &'a [f32],
    result: &'a mut [f32],
}

impl Kernel for Batch<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const N: usize>(self) {
        for (x, result) in self.x.chunks(N).zip(self.result.chunks_mut(N)) {
            let x = Lanes::<N>::load_or(x, 0.0);
            (interpolate(x) + chosen(x) + groups(x)).store(result);
        }
    }
}

#[test]
fn lanes_read_what_single_numbers_read() {
    let x: Vec<f32> = (-20..100)
        .map(|k| k as f32 * 0.1)
        .chain([f32::NAN, 1e30])
        .collect();
    for set in InstructionSet::ALL {
        if !set.is_available() {
            eprintln!("skipped: this machine has no {}", set.name());
            continue;
        }
        let mut result = vec![0.0; x.len()];
        dispatch_on(
            set,
            Batch {
                x: &x,
                result: &mut result,
            },
        );
        for (x, y) in x.iter().zip(result) {
            let single = interpolate(*x) + chosen(*x) + groups(*x);
            assert_eq!(single.to_bits(), y.to_bits(), "{} {x}", set.name());
        }
    }
}

/// Lanes in numbers that no instruction set has, under the build's own: each takes another way through the memory.
#[test]
fn any_number_of_lanes_reads_the_same() {
    fn read<const N: usize>() {
        let x: [f32; N] = std::array::from_fn(|k| k as f32 - 0.5);
        let lanes = groups(Lanes(x));
        for (x, y) in x.into_iter().zip(lanes.0) {
            assert_eq!(groups(x), y, "{N} lanes, {x}");
        }
    }
    read::<1>();
    read::<3>();
    read::<4>();
    read::<8>();
    read::<12>();
    read::<16>();
    read::<32>();
}

#[test]
fn derivatives_are_the_slopes_of_the_cells() {
    let y = interpolate(Dual::<f64, 1>::variable(2.25, 0));
    assert_eq!((y.value, y.partials), (3.5, [6.0]));
}
