//! Reading a table at an address of its own in each lane: the one unsafe module of the tables.
//!
//! Invariant: every address is limited to `table.len() - 4`, right before the reads, by the function that reads; and functions
//! marked `#[target_feature]` are called only after the processor was found to have the feature, by the function that
//! calls them.
//!
//! Without it the compiler reads number by number, with a check and a branch before each: batches of measured tables then run
//! 1.4 (AVX2) to 4 (AVX-512) times slower.
#![allow(unsafe_code)]

/// The `K` numbers of `table` at `at`, or the last `K`.
///
/// # Panics
/// If there are fewer than `K`.
#[inline(always)]
pub(super) fn window<const K: usize>(table: &[f32], at: u32) -> &[f32; K] {
    assert!(
        table.len() >= K,
        "a table of {} numbers has no {K}",
        table.len()
    );
    let at = (at as usize).min(table.len() - K);
    table[at..]
        .first_chunk()
        .expect("invariant: K numbers stand from there on")
}

/// The four numbers of `table` at `at`, or the last four, for each lane; the first of all lanes, the second of all lanes, and so on.
///
/// # Panics
/// If there are fewer than four.
#[inline(always)]
pub(super) fn four<const N: usize>(table: &[f32], at: &[u32; N]) -> [[f32; N]; 4] {
    let Some(last) = table.len().checked_sub(4) else {
        panic!("a table of {} numbers has no 4", table.len());
    };
    let last = u32::try_from(last).unwrap_or(u32::MAX);
    let mut limited = *at;
    for lane in 0..N {
        limited[lane] = limited[lane].min(last);
    }
    // The addresses go through memory: else the compiler takes the vector of them apart before its arithmetic, not after.
    std::hint::black_box(&limited);
    #[cfg(target_arch = "x86_64")]
    {
        if N == 16 {
            if is_x86_feature_detected!("avx512f") {
                // SAFETY: the addresses are limited above, and the processor has AVX-512 F as was just found.
                return unsafe { x86::four_in_16_lanes(table, &limited) };
            }
            return x86::four_in_16_lanes_without_avx512(table, &limited);
        }
        if N.is_multiple_of(4) {
            // SAFETY: the addresses are limited above.
            return unsafe { x86::four_by_four(table, &limited) };
        }
    }
    number_by_number(table, &limited)
}

/// Where there is nothing better.
#[inline(always)]
fn number_by_number<const N: usize>(table: &[f32], at: &[u32; N]) -> [[f32; N]; 4] {
    let mut y = [[0.0; N]; 4];
    for lane in 0..N {
        let &[a, b, c, d] = window(table, at[lane]);
        y[0][lane] = a;
        y[1][lane] = b;
        y[2][lane] = c;
        y[3][lane] = d;
    }
    y
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    /// One load of four numbers a lane, and 4×4 transpositions.
    ///
    /// # Safety
    /// Each address plus 4 must be at most `table.len()`.
    #[inline(always)]
    pub unsafe fn four_by_four<const N: usize>(table: &[f32], at: &[u32; N]) -> [[f32; N]; 4] {
        let mut y = [[0.0; N]; 4];
        let start = table.as_ptr();
        let mut lane = 0;
        while lane + 4 <= N {
            // SAFETY: four numbers stand at each address, as the caller promises; SSE2 is part of x86-64; and __m128 is as
            // large as four f32, any bits of which are valid.
            let [a, b, c, d]: [[f32; 4]; 4] = unsafe {
                let r0 = _mm_loadu_ps(start.add(at[lane] as usize));
                let r1 = _mm_loadu_ps(start.add(at[lane + 1] as usize));
                let r2 = _mm_loadu_ps(start.add(at[lane + 2] as usize));
                let r3 = _mm_loadu_ps(start.add(at[lane + 3] as usize));
                let low01 = _mm_unpacklo_ps(r0, r1);
                let low23 = _mm_unpacklo_ps(r2, r3);
                let high01 = _mm_unpackhi_ps(r0, r1);
                let high23 = _mm_unpackhi_ps(r2, r3);
                [
                    std::mem::transmute::<__m128, [f32; 4]>(_mm_movelh_ps(low01, low23)),
                    std::mem::transmute::<__m128, [f32; 4]>(_mm_movehl_ps(low23, low01)),
                    std::mem::transmute::<__m128, [f32; 4]>(_mm_movelh_ps(high01, high23)),
                    std::mem::transmute::<__m128, [f32; 4]>(_mm_movehl_ps(high23, high01)),
                ]
            };
            y[0][lane..lane + 4].copy_from_slice(&a);
            y[1][lane..lane + 4].copy_from_slice(&b);
            y[2][lane..lane + 4].copy_from_slice(&c);
            y[3][lane..lane + 4].copy_from_slice(&d);
            lane += 4;
        }
        y
    }

    /// [`four_by_four`] for a processor that calculates with 16 lanes all the same. Not inlined: a kernel has the other way in
    /// line.
    #[cold]
    #[inline(never)]
    pub fn four_in_16_lanes_without_avx512<const N: usize>(
        table: &[f32],
        at: &[u32; N],
    ) -> [[f32; N]; 4] {
        super::number_by_number(table, at)
    }

    /// As [`four_by_four`], four transpositions at once. `N` is 16.
    ///
    /// # Safety
    /// Each address plus 4 must be at most `table.len()`, and the processor must have AVX-512 F.
    #[inline(always)]
    pub unsafe fn four_in_16_lanes<const N: usize>(table: &[f32], at: &[u32; N]) -> [[f32; N]; 4] {
        let start = table.as_ptr();
        // SAFETY: four numbers stand at each address, and the processor has AVX-512 F, as the caller promises. __m512 is as large as
        // 16 f32, any bits of which are valid.
        let [a, b, c, d]: [[f32; 16]; 4] = unsafe {
            // Lanes k, k + 4, k + 8 and k + 12 side by side.
            macro_rules! every_fourth {
                ($k:expr) => {{
                    let r = _mm512_castps128_ps512(_mm_loadu_ps(start.add(at[$k] as usize)));
                    let r =
                        _mm512_insertf32x4::<1>(r, _mm_loadu_ps(start.add(at[$k + 4] as usize)));
                    let r =
                        _mm512_insertf32x4::<2>(r, _mm_loadu_ps(start.add(at[$k + 8] as usize)));
                    _mm512_insertf32x4::<3>(r, _mm_loadu_ps(start.add(at[$k + 12] as usize)))
                }};
            }
            let r0 = every_fourth!(0);
            let r1 = every_fourth!(1);
            let r2 = every_fourth!(2);
            let r3 = every_fourth!(3);
            let low01 = _mm512_castps_pd(_mm512_unpacklo_ps(r0, r1));
            let low23 = _mm512_castps_pd(_mm512_unpacklo_ps(r2, r3));
            let high01 = _mm512_castps_pd(_mm512_unpackhi_ps(r0, r1));
            let high23 = _mm512_castps_pd(_mm512_unpackhi_ps(r2, r3));
            [
                std::mem::transmute::<__m512d, [f32; 16]>(_mm512_unpacklo_pd(low01, low23)),
                std::mem::transmute::<__m512d, [f32; 16]>(_mm512_unpackhi_pd(low01, low23)),
                std::mem::transmute::<__m512d, [f32; 16]>(_mm512_unpacklo_pd(high01, high23)),
                std::mem::transmute::<__m512d, [f32; 16]>(_mm512_unpackhi_pd(high01, high23)),
            ]
        };
        let same = "invariant: N is 16";
        [
            *a.first_chunk().expect(same),
            *b.first_chunk().expect(same),
            *c.first_chunk().expect(same),
            *d.first_chunk().expect(same),
        ]
    }
}
