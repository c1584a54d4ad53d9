//! [`Stack`], what a walk has still to visit.
//!
//! Its memory isn't cleared first: for short rays that took longer than the rays themselves. Unsafe code for that reason,
//! under one invariant: `items[..len]` is initialised, since `len` grows only by a write to `items[len]`.
#![allow(unsafe_code)]

use std::mem::MaybeUninit;

/// A node or leaf, and where the ray enters its box.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) near: f32,
    pub(super) child: u32,
}

/// The most entries a stack holds without allocation. A million triangles need about 60.
const FIXED: usize = 128;

/// Entries, last in, first out.
pub(super) struct Stack {
    items: [MaybeUninit<Entry>; FIXED],
    len: usize,
    /// What no longer fits: trees of unusual depth.
    spilled: Vec<Entry>,
}

impl Stack {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            items: [const { MaybeUninit::uninit() }; FIXED],
            len: 0,
            spilled: Vec::new(),
        }
    }

    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.len = 0;
        self.spilled.clear();
    }

    #[inline(always)]
    pub(super) fn push(&mut self, entry: Entry) {
        if let Some(slot) = self.items.get_mut(self.len) {
            slot.write(entry);
            self.len += 1;
        } else {
            self.spill(entry);
        }
    }

    #[cold]
    fn spill(&mut self, entry: Entry) {
        self.spilled.push(entry);
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<Entry> {
        if self.len == FIXED
            && let Some(entry) = self.spilled.pop()
        {
            return Some(entry);
        }
        self.len = self.len.checked_sub(1)?;
        // SAFETY: the invariant held for the old length.
        Some(unsafe { self.items[self.len].assume_init() })
    }

    /// Puts the last `count` entries, those beyond memory of its own left out, in the order of falling `near`.
    #[inline(always)]
    pub(super) fn sort_last(&mut self, count: usize) {
        if !self.spilled.is_empty() {
            return;
        }
        let start = self.len.saturating_sub(count);
        for i in start + 1..self.len {
            // SAFETY: i < len, k < len: the invariant.
            unsafe {
                let moved = self.items[i].assume_init();
                let mut k = i;
                while k > start && self.items[k - 1].assume_init_ref().near < moved.near {
                    self.items[k] = self.items[k - 1];
                    k -= 1;
                }
                self.items[k].write(moved);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(near: usize) -> Entry {
        Entry {
            near: near as f32,
            child: near as u32,
        }
    }

    /// Beyond its fixed memory too, the last comes first.
    #[test]
    fn the_last_in_is_the_first_out() {
        for count in [0, 1, FIXED - 1, FIXED, FIXED + 1, 3 * FIXED] {
            let mut stack = Stack::new();
            for round in 0..2 {
                for i in 0..count {
                    stack.push(entry(i));
                }
                for i in (0..count).rev() {
                    assert_eq!(stack.pop().map(|e| e.child), Some(i as u32), "{round}");
                }
                assert!(stack.pop().is_none());
            }
        }
    }

    #[test]
    fn sorting_leaves_the_nearest_on_top_and_the_rest_alone() {
        let mut stack = Stack::new();
        for i in [9, 1, 4, 2, 3, 3] {
            stack.push(entry(i));
        }
        stack.sort_last(4);
        let order: Vec<u32> = std::iter::from_fn(|| stack.pop().map(|e| e.child)).collect();
        assert_eq!(order, [2, 3, 3, 4, 1, 9]);
    }
}
