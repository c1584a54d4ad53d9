//! [`Number`], a [`Real`] through which a measured table can be read, and [`Index`], what addresses it.

mod gather;
#[cfg(test)]
mod tests;

use crate::part::colour::each_component;
use gonio_num::Real;
use gonio_num::dual::Dual;
use gonio_num::expr::Expr;
use gonio_num::lanes::{LaneMask, Lanes};
use std::fmt::Debug;

/// Whole numbers from 0 that address a table: `u32`, or one a lane. Arithmetic wraps around at 2³²; [`Number::gather`] limits
/// what comes out of it to the table.
pub trait Index: Copy + Debug {
    /// The same number in every lane.
    fn splat(i: u32) -> Self;
    /// self + i.
    fn plus(self, i: Self) -> Self;
    /// self · factor.
    fn times(self, factor: u32) -> Self;
}

/// A [`Real`] with which models, tables included, can be evaluated.
///
/// A table in memory is read in three steps, each of them over lanes: [`Number::cell`] finds where a coordinate lies,
/// [`Index`] makes an address of it, [`Number::gather`] fetches the numbers that stand there.
pub trait Number: Real {
    /// What addresses a table.
    type Index: Index;

    /// The largest whole number ≤ self, limited to 0 … `last`; 0 for a NaN. `last` < 2²³.
    fn index(self, last: u32) -> Self::Index;

    /// The whole number as a real; exact below 2²⁴.
    fn from_index(i: Self::Index) -> Self;

    /// `a` where the mask is true, `b` elsewhere.
    fn select_index(mask: Self::Mask, a: Self::Index, b: Self::Index) -> Self::Index;

    /// The `K` consecutive numbers of `table` that begin at `at`; `at` is limited to the last place where `K` numbers stand.
    ///
    /// What is looked up together should stand together. `K` = 4 is what a batch reads fastest by far: four numbers cost it less
    /// than one does otherwise. Pad three to four, and read eight in two halves.
    ///
    /// # Panics
    /// If `table` has fewer than `K` numbers.
    fn gather<const K: usize>(table: &[f32], at: Self::Index) -> [Self; K];

    /// Between which of the nodes 0 … `nodes` − 1 self lies, and how far: (i, t) with self = i + t and t in [0, 1], where self is
    /// limited to [0, `nodes` − 1] and i to `nodes` − 2; (0, 0) for a NaN. 2 ≤ `nodes` ≤ 2²³.
    #[inline(always)]
    fn cell(self, nodes: u32) -> (Self::Index, Self) {
        let x = self.clamp(Self::zero(), Self::lit(f64::from(nodes - 1)));
        let i = x.index(nodes - 2);
        (i, x - Self::from_index(i))
    }

    /// Applies the opaque function `f` to numbers that are computed in double precision, lane by lane.
    ///
    /// For what arithmetic over [`Real`] can't express: searching and addressing a table in memory. Derivatives through it are
    /// central differences with step 1e-5.
    fn through<const K: usize, const M: usize>(
        x: [Self; K],
        f: &dyn Fn([f64; K]) -> [f64; M],
    ) -> [Self; M];
}

impl Index for u32 {
    #[inline(always)]
    fn splat(i: u32) -> Self {
        i
    }
    #[inline(always)]
    fn plus(self, i: Self) -> Self {
        self.wrapping_add(i)
    }
    #[inline(always)]
    fn times(self, factor: u32) -> Self {
        self.wrapping_mul(factor)
    }
}

macro_rules! scalar_index {
    ($t:ty) => {
        type Index = u32;
        #[inline(always)]
        fn index(self, last: u32) -> u32 {
            // Saturating: negative numbers and NaN become 0.
            (self as u32).min(last)
        }
        #[inline(always)]
        fn from_index(i: u32) -> Self {
            i as $t
        }
        #[inline(always)]
        fn select_index(mask: bool, a: u32, b: u32) -> u32 {
            if mask { a } else { b }
        }
        #[inline(always)]
        fn gather<const K: usize>(table: &[f32], at: u32) -> [Self; K] {
            let found = gather::window::<K>(table, at);
            let mut y = [0.0; K];
            for k in 0..K {
                y[k] = <$t>::from(found[k]);
            }
            y
        }
    };
}

impl Number for f64 {
    scalar_index!(f64);

    #[inline]
    fn through<const K: usize, const M: usize>(
        x: [Self; K],
        f: &dyn Fn([f64; K]) -> [f64; M],
    ) -> [Self; M] {
        f(x)
    }
}

impl Number for f32 {
    scalar_index!(f32);

    #[inline]
    fn through<const K: usize, const M: usize>(
        x: [Self; K],
        f: &dyn Fn([f64; K]) -> [f64; M],
    ) -> [Self; M] {
        let mut input = [0.0; K];
        for k in 0..K {
            input[k] = f64::from(x[k]);
        }
        let output = f(input);
        let mut y = [0.0; M];
        for m in 0..M {
            y[m] = output[m] as f32;
        }
        y
    }
}

/// One whole number a lane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LaneIndex<const N: usize>(pub [u32; N]);

impl<const N: usize> Index for LaneIndex<N> {
    #[inline(always)]
    fn splat(i: u32) -> Self {
        Self([i; N])
    }
    #[inline(always)]
    fn plus(self, i: Self) -> Self {
        let mut r = self;
        for lane in 0..N {
            r.0[lane] = self.0[lane].wrapping_add(i.0[lane]);
        }
        r
    }
    #[inline(always)]
    fn times(self, factor: u32) -> Self {
        let mut r = self;
        for lane in 0..N {
            r.0[lane] = self.0[lane].wrapping_mul(factor);
        }
        r
    }
}

impl<const N: usize> Number for Lanes<N> {
    type Index = LaneIndex<N>;

    #[inline(always)]
    fn index(self, last: u32) -> LaneIndex<N> {
        /// From here to 2²⁴ an `f32` is a whole number, and the low bits of its pattern count them.
        const WHOLE: f32 = 8_388_608.0;
        // Not a conversion: `as` saturates, which a compiler makes of branches, lane by lane.
        let mut r = LaneIndex([0; N]);
        for lane in 0..N {
            let x = Real::clamp(self.0[lane], 0.0, last as f32);
            let nearest = (x + WHOLE) - WHOLE;
            let below = nearest - if nearest > x { 1.0 } else { 0.0 };
            r.0[lane] = (below + WHOLE).to_bits() & 0x007f_ffff;
        }
        r
    }

    #[inline(always)]
    fn from_index(i: LaneIndex<N>) -> Self {
        let mut r = Self([0.0; N]);
        for lane in 0..N {
            r.0[lane] = i.0[lane] as f32;
        }
        r
    }

    #[inline(always)]
    fn select_index(mask: LaneMask<N>, a: LaneIndex<N>, b: LaneIndex<N>) -> LaneIndex<N> {
        let mut r = a;
        for lane in 0..N {
            r.0[lane] = if mask.0[lane] { a.0[lane] } else { b.0[lane] };
        }
        r
    }

    #[inline(always)]
    fn gather<const K: usize>(table: &[f32], at: LaneIndex<N>) -> [Self; K] {
        let mut y = [Self([0.0; N]); K];
        if K == 4 {
            let found = gather::four(table, &at.0);
            each_component!(K, k => { y[k].0 = found[k]; });
        } else {
            for lane in 0..N {
                let found = gather::window::<K>(table, at.0[lane]);
                for k in 0..K {
                    y[k].0[lane] = found[k];
                }
            }
        }
        y
    }

    #[inline]
    fn through<const K: usize, const M: usize>(
        x: [Self; K],
        f: &dyn Fn([f64; K]) -> [f64; M],
    ) -> [Self; M] {
        let mut y = [Self([0.0; N]); M];
        for lane in 0..N {
            let mut input = [0.0f32; K];
            for k in 0..K {
                input[k] = x[k].0[lane];
            }
            let output = f32::through(input, f);
            for m in 0..M {
                y[m].0[lane] = output[m];
            }
        }
        y
    }
}

impl<R: Number, const P: usize> Number for Dual<R, P> {
    type Index = R::Index;

    #[inline(always)]
    fn index(self, last: u32) -> R::Index {
        self.value.index(last)
    }

    /// A whole number's derivative is 0: within a cell it is constant.
    #[inline(always)]
    fn from_index(i: R::Index) -> Self {
        Self::constant(R::from_index(i))
    }

    #[inline(always)]
    fn select_index(mask: R::Mask, a: R::Index, b: R::Index) -> R::Index {
        R::select_index(mask, a, b)
    }

    /// What a table holds is constant.
    #[inline(always)]
    fn gather<const K: usize>(table: &[f32], at: R::Index) -> [Self; K] {
        let found = R::gather::<K>(table, at);
        let mut y = [Self::constant(R::zero()); K];
        for k in 0..K {
            y[k].value = found[k];
        }
        y
    }

    fn through<const K: usize, const M: usize>(
        x: [Self; K],
        f: &dyn Fn([f64; K]) -> [f64; M],
    ) -> [Self; M] {
        const STEP: f64 = 1e-5;
        let mut values = [R::zero(); K];
        for k in 0..K {
            values[k] = x[k].value;
        }
        let mut y = [Self::constant(R::zero()); M];
        let output = R::through(values, f);
        for m in 0..M {
            y[m].value = output[m];
        }
        for k in 0..K {
            let slope = R::through(values, &|at: [f64; K]| {
                let (mut high, mut low) = (at, at);
                high[k] += STEP;
                low[k] -= STEP;
                let (high, low) = (f(high), f(low));
                let mut slope = high;
                for m in 0..M {
                    slope[m] = (high[m] - low[m]) / (2.0 * STEP);
                }
                slope
            });
            for m in 0..M {
                for p in 0..P {
                    y[m].partials[p] = y[m].partials[p] + slope[m] * x[k].partials[p];
                }
            }
        }
        y
    }
}

impl Number for Expr {
    type Index = u32;

    fn index(self, _last: u32) -> u32 {
        0
    }

    fn from_index(_i: u32) -> Self {
        Self::zero()
    }

    fn select_index(_mask: Self::Mask, _a: u32, b: u32) -> u32 {
        b
    }

    /// 0: memory can't be recorded. [`crate::record`] refuses models that would read it.
    fn gather<const K: usize>(_table: &[f32], _at: u32) -> [Self; K] {
        [Self::zero(); K]
    }

    /// 0: an opaque function can't be recorded. [`crate::record`] refuses models that would call it.
    fn through<const K: usize, const M: usize>(
        _x: [Self; K],
        _f: &dyn Fn([f64; K]) -> [f64; M],
    ) -> [Self; M] {
        [Self::zero(); M]
    }
}
