//! Reading a few numbers of a table that stand side by side: one of the two unsafe modules of the crate.
//!
//! Invariant: the place is limited to the last one where `K` numbers stand before memory is read, so the read never leaves the
//! slice. What a checked access would add is a branch a lane, which keeps a compiler from reading for all lanes together:
//! microfacets with their table look-ups are sampled 1.4 times faster without (`cargo bench -p gonio-brdf`, `ggx:metal=gold`).
#![allow(unsafe_code)]

/// The `K` numbers of `table` that begin at `at`, or at the last place where `K` numbers stand.
///
/// # Panics
/// If `table` has fewer than `K` numbers.
#[inline(always)]
pub fn window<const K: usize>(table: &[f32], at: u32) -> [f32; K] {
    assert!(
        table.len() >= K,
        "the table has fewer numbers than are read"
    );
    let at = (at as usize).min(table.len() - K);
    // SAFETY: at + K ≤ table.len(), as the line above has limited it; f32 and [f32; K] have the same alignment.
    unsafe { table.as_ptr().add(at).cast::<[f32; K]>().read() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_limited_to_the_table() {
        let table = [1.0, 2.0, 3.0, 4.0];
        assert_eq!(window::<2>(&table, 1), [2.0, 3.0]);
        assert_eq!(window::<2>(&table, 2), [3.0, 4.0]);
        assert_eq!(window::<2>(&table, 3), [3.0, 4.0]);
        assert_eq!(window::<4>(&table, u32::MAX), table);
    }

    #[test]
    #[should_panic(expected = "fewer numbers")]
    fn a_table_that_is_too_short_is_refused() {
        let _ = window::<3>(&[1.0, 2.0], 0);
    }
}
