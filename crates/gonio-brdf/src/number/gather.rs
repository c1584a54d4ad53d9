//! Reading a table at an address of its own in each lane: the one unsafe module of the tables.
//!
//! Invariant: every address is limited to `table.len() - 4`, right before the reads, by the function that reads; and functions
//! marked `#[target_feature]` are called only after the processor was found to have the feature, by the function that
//! calls them.
//!
//! Without it the compiler reads number by number, with a check and a branch before each: batches of measured tables then run
//! 1.4 (AVX2) to 4 (AVX-512) times slower.
#![allow(unsafe_code)]

use gonio_num::lanes::Lanes;

/// The last place from which `K` numbers stand in the table at each offset.
///
/// # Panics
/// If there is none.
#[inline(always)]
pub(super) fn last<const K: usize, const M: usize>(table: &[f32], offsets: [u32; M]) -> u32 {
    let mut most = 0;
    for offset in offsets {
        most = most.max(offset);
    }
    let Some(last) = table.len().checked_sub(most as usize + K) else {
        panic!("a table of {} numbers has no {K} at {most}", table.len());
    };
    u32::try_from(last).unwrap_or(u32::MAX)
}

/// The `K` numbers of `table` at `at` + `offset`.
#[inline(always)]
pub(super) fn window<const K: usize>(table: &[f32], at: u32, offset: u32) -> &[f32; K] {
    table[at as usize + offset as usize..]
        .first_chunk()
        .expect("invariant: the place was limited")
}

/// On its own cache lines: what is written and read at once, whole, is then passed on without waiting for the memory.
#[repr(C, align(64))]
struct Aligned<T>(T);

/// For each offset the `K` numbers of `table` at `at` + offset, where `at` is at most [`last`]: the first of all lanes, the second of all
/// lanes, and so on.
///
/// # Panics
/// As [`last`].
#[inline(always)]
pub(super) fn in_lanes<const N: usize, const K: usize, const M: usize>(
    table: &[f32],
    at: &[u32; N],
    offsets: [u32; M],
) -> [[Lanes<N>; K]; M] {
    let last = last::<K, M>(table, offsets);
    let mut limited = Aligned(*at);
    for lane in 0..N {
        limited.0[lane] = limited.0[lane].min(last);
    }
    // The addresses go through memory: else the compiler takes the vector of them apart before its arithmetic, not after.
    std::hint::black_box(&limited);
    let at = &limited.0;
    #[cfg(target_arch = "x86_64")]
    if K == 2 || K == 4 {
        if N == 16 {
            // SAFETY: the addresses are limited above.
            return unsafe { x86::in_16_lanes(table, at, offsets) };
        }
        if N.is_multiple_of(4) {
            // SAFETY: the addresses are limited above.
            return unsafe { x86::by_four(table, at, offsets) };
        }
    }
    number_by_number(table, at, offsets)
}

/// Where there is nothing better.
#[inline(always)]
fn number_by_number<const N: usize, const K: usize, const M: usize>(
    table: &[f32],
    at: &[u32; N],
    offsets: [u32; M],
) -> [[Lanes<N>; K]; M] {
    let mut y = [[Lanes([0.0; N]); K]; M];
    for m in 0..M {
        for lane in 0..N {
            let found = window::<K>(table, at[lane], offsets[m]);
            for k in 0..K {
                y[m][k].0[lane] = found[k];
            }
        }
    }
    y
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use crate::number::written_out;
    use crate::part::colour::each_component;
    use gonio_num::lanes::Lanes;
    use std::arch::x86_64::*;

    /// One load of `K` numbers a lane and offset, and transpositions of four lanes. `K` is 2 or 4.
    ///
    /// # Safety
    /// Each address plus each offset plus `K` must be at most `table.len()`.
    #[inline(always)]
    pub unsafe fn by_four<const N: usize, const K: usize, const M: usize>(
        table: &[f32],
        at: &[u32; N],
        offsets: [u32; M],
    ) -> [[Lanes<N>; K]; M] {
        let mut y = [[Lanes([0.0; N]); K]; M];
        written_out!(M, m => {
            let mut lane = 0;
            while lane + 4 <= N {
                // SAFETY: K numbers stand at each place, as the caller promises.
                let four = unsafe {
                    let start = table.as_ptr().add(offsets[m] as usize);
                    transposed::<K>([
                        start.add(at[lane] as usize),
                        start.add(at[lane + 1] as usize),
                        start.add(at[lane + 2] as usize),
                        start.add(at[lane + 3] as usize),
                    ])
                };
                y[m][0].0[lane..lane + 4].copy_from_slice(&four[0]);
                y[m][1].0[lane..lane + 4].copy_from_slice(&four[1]);
                if K == 4 {
                    y[m][2].0[lane..lane + 4].copy_from_slice(&four[2]);
                    y[m][3].0[lane..lane + 4].copy_from_slice(&four[3]);
                }
                lane += 4;
            }
        });
        y
    }

    /// The first of the numbers at four places, the second of them, and so on, of `K`.
    ///
    /// # Safety
    /// `K` numbers must stand at each.
    #[inline(always)]
    unsafe fn transposed<const K: usize>(places: [*const f32; 4]) -> [[f32; 4]; 4] {
        let [p0, p1, p2, p3] = places;
        // SAFETY: the loads read K numbers, and need no alignment; SSE2 is part of x86-64; and __m128 is as large as four f32, any
        // bits of which are valid.
        unsafe {
            let bits = |r: __m128| std::mem::transmute::<__m128, [f32; 4]>(r);
            if K == 2 {
                let (r01, r23) = (two_pairs(p0, p1), two_pairs(p2, p3));
                let first = bits(_mm_shuffle_ps::<0b10_00_10_00>(r01, r23));
                let second = bits(_mm_shuffle_ps::<0b11_01_11_01>(r01, r23));
                return [first, second, first, second];
            }
            let (r0, r1) = (_mm_loadu_ps(p0), _mm_loadu_ps(p1));
            let (r2, r3) = (_mm_loadu_ps(p2), _mm_loadu_ps(p3));
            let low01 = _mm_unpacklo_ps(r0, r1);
            let low23 = _mm_unpacklo_ps(r2, r3);
            let high01 = _mm_unpackhi_ps(r0, r1);
            let high23 = _mm_unpackhi_ps(r2, r3);
            [
                bits(_mm_movelh_ps(low01, low23)),
                bits(_mm_movehl_ps(low23, low01)),
                bits(_mm_movelh_ps(high01, high23)),
                bits(_mm_movehl_ps(high23, high01)),
            ]
        }
    }

    /// The pairs of numbers at two places.
    ///
    /// # Safety
    /// Two numbers must stand at each.
    #[inline(always)]
    unsafe fn two_pairs(a: *const f32, b: *const f32) -> __m128 {
        // SAFETY: as the caller promises; the loads need no alignment.
        unsafe { _mm_castpd_ps(_mm_loadh_pd(_mm_load_sd(a.cast()), b.cast())) }
    }

    /// As [`by_four`], four transpositions at once if the processor has AVX-512 F. `N` is 16.
    ///
    /// # Safety
    /// Each address plus each offset plus `K` must be at most `table.len()`.
    #[inline(always)]
    pub unsafe fn in_16_lanes<const N: usize, const K: usize, const M: usize>(
        table: &[f32],
        at: &[u32; N],
        offsets: [u32; M],
    ) -> [[Lanes<N>; K]; M] {
        // Both ways end in whole vectors: of single numbers that come from either, the compiler makes a puzzle.
        let mut found = [whole([[0.0; 16]; 4]); M];
        if is_x86_feature_detected!("avx512f") {
            written_out!(M, m => {
                // SAFETY: the places are as the caller promises, and the processor has AVX-512 F as was just found.
                found[m] = unsafe {
                    let start = table.as_ptr().add(offsets[m] as usize);
                    transposed_at_once::<N, K>(start, at)
                };
            });
        } else {
            let mut numbers = [[[0.0; 16]; 4]; M];
            without_avx512::<N, K, M>(table, at, offsets, &mut numbers);
            written_out!(M, m => { found[m] = whole(numbers[m]); });
        }
        let mut y = [[Lanes([0.0; N]); K]; M];
        written_out!(M, m => {
            each_component!(K, k => {
                // SAFETY: a __m512 is as large as 16 f32, any bits of which are valid.
                let lanes = unsafe { std::mem::transmute::<__m512, [f32; 16]>(found[m][k]) };
                y[m][k].0.copy_from_slice(&lanes);
            });
        });
        y
    }

    #[inline(always)]
    fn whole(numbers: [[f32; 16]; 4]) -> [__m512; 4] {
        // SAFETY: 16 f32 are as large as a __m512, any bits of which are valid.
        unsafe { std::mem::transmute::<[[f32; 16]; 4], [__m512; 4]>(numbers) }
    }

    /// [`by_four`] for a processor that calculates with 16 lanes all the same. Not inlined: a kernel has the other way in line.
    #[cold]
    #[inline(never)]
    fn without_avx512<const N: usize, const K: usize, const M: usize>(
        table: &[f32],
        at: &[u32; N],
        offsets: [u32; M],
        found: &mut [[[f32; 16]; 4]; M],
    ) {
        let lanes = super::number_by_number::<N, K, M>(table, at, offsets);
        for m in 0..M {
            for k in 0..K {
                found[m][k].copy_from_slice(&lanes[m][k].0);
            }
        }
    }

    /// The `K` numbers at `start` + each address; the first `K` of the four vectors are what is found.
    ///
    /// # Safety
    /// `K` numbers must stand at each place, and the processor must have AVX-512 F.
    #[inline(always)]
    unsafe fn transposed_at_once<const N: usize, const K: usize>(
        start: *const f32,
        at: &[u32; N],
    ) -> [__m512; 4] {
        // SAFETY: as the caller promises.
        unsafe {
            macro_rules! at {
                ($lane:expr) => {
                    start.add(at[$lane] as usize)
                };
            }
            macro_rules! side_by_side {
                ($a:expr, $b:expr, $c:expr, $d:expr) => {{
                    let r = _mm512_insertf32x4::<1>(_mm512_castps128_ps512($a), $b);
                    _mm512_insertf32x4::<3>(_mm512_insertf32x4::<2>(r, $c), $d)
                }};
            }
            if K == 2 {
                // Lanes k, k + 1, then k + 4, k + 5 and so on.
                macro_rules! pairs {
                    ($k:expr) => {
                        side_by_side!(
                            two_pairs(at!($k), at!($k + 1)),
                            two_pairs(at!($k + 4), at!($k + 5)),
                            two_pairs(at!($k + 8), at!($k + 9)),
                            two_pairs(at!($k + 12), at!($k + 13))
                        )
                    };
                }
                let (r01, r23) = (pairs!(0), pairs!(2));
                let first = _mm512_shuffle_ps::<0b10_00_10_00>(r01, r23);
                let second = _mm512_shuffle_ps::<0b11_01_11_01>(r01, r23);
                [first, second, first, second]
            } else {
                // Lanes k, k + 4, k + 8 and k + 12.
                macro_rules! every_fourth {
                    ($k:expr) => {
                        side_by_side!(
                            _mm_loadu_ps(at!($k)),
                            _mm_loadu_ps(at!($k + 4)),
                            _mm_loadu_ps(at!($k + 8)),
                            _mm_loadu_ps(at!($k + 12))
                        )
                    };
                }
                let (r0, r1) = (every_fourth!(0), every_fourth!(1));
                let (r2, r3) = (every_fourth!(2), every_fourth!(3));
                let low01 = _mm512_castps_pd(_mm512_unpacklo_ps(r0, r1));
                let low23 = _mm512_castps_pd(_mm512_unpacklo_ps(r2, r3));
                let high01 = _mm512_castps_pd(_mm512_unpackhi_ps(r0, r1));
                let high23 = _mm512_castps_pd(_mm512_unpackhi_ps(r2, r3));
                [
                    _mm512_castpd_ps(_mm512_unpacklo_pd(low01, low23)),
                    _mm512_castpd_ps(_mm512_unpackhi_pd(low01, low23)),
                    _mm512_castpd_ps(_mm512_unpacklo_pd(high01, high23)),
                    _mm512_castpd_ps(_mm512_unpackhi_pd(high01, high23)),
                ]
            }
        }
    }
}
