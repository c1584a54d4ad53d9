//! [`Number`], a [`Real`] through which a measured table can be read, and [`Index`], what addresses it.

mod gather;
#[cfg(test)]
mod tests;

use gonio_num::Real;
use gonio_num::dual::Dual;
use gonio_num::expr::Expr;
use gonio_num::lanes::{LaneMask, Lanes};
use gonio_shader::ShaderNumber;
use std::fmt::Debug;

/// Runs the body for `$i` = 0, 1, … `$n` − 1, at most 7, written out.
///
/// Not a loop: of a loop over vectors of lanes a compiler makes vectors across its steps, with a lane of each.
macro_rules! written_out {
    ($n:expr, $i:ident => $body:block) => {
        const { assert!($n <= 8) };
        written_out!(@ $n, $i, $body, 0, 1, 2, 3, 4, 5, 6, 7);
    };
    (@ $n:expr, $i:ident, $body:block, $($k:literal),+) => {
        $(if $n > $k {
            let $i = $k;
            $body
        })+
    };
}
pub(crate) use written_out;

/// Whole numbers from 0 that address a table: `u32`, or one a lane. Arithmetic wraps around at 2³²; [`Number::gather`] limits
/// what comes out of it to the table.
pub trait Index: Copy + Debug {
    /// The same number in every lane.
    fn splat(i: u32) -> Self;
    /// self + i.
    fn plus(self, i: Self) -> Self;
    /// self · factor.
    fn times(self, factor: u32) -> Self;
    /// The smaller of self and `limit`.
    fn least(self, limit: u32) -> Self;
}

/// A function of `K` numbers that has code of its own for single and for double precision.
pub trait Function<const K: usize, const M: usize> {
    /// Its values in single precision.
    fn single(&self, x: [f32; K]) -> [f32; M];
    /// Its values in double precision.
    fn double(&self, x: [f64; K]) -> [f64; M];
}

/// A function in double precision for both.
struct Through<'a, const K: usize, const M: usize>(&'a dyn Fn([f64; K]) -> [f64; M]);

impl<const K: usize, const M: usize> Function<K, M> for Through<'_, K, M> {
    fn single(&self, x: [f32; K]) -> [f32; M] {
        (self.0)(x.map(f64::from)).map(|y| y as f32)
    }

    fn double(&self, x: [f64; K]) -> [f64; M] {
        (self.0)(x)
    }
}

/// A [`Real`] with which models, tables and shaders included, can be evaluated.
///
/// A table in memory is read in three steps, each of them over lanes: [`Number::cell`] finds where a coordinate lies,
/// [`Index`] makes an address of it, [`Number::gather`] fetches the numbers that stand there.
pub trait Number: ShaderNumber {
    /// Calls `f` in each lane: for code too large to be compiled once more for every number of lanes. Derivatives through it are
    /// central differences with step 1e-5.
    fn call<const K: usize, const M: usize>(f: &dyn Function<K, M>, x: [Self; K]) -> [Self; M];

    /// What addresses a table.
    type Index: Index;

    /// The largest whole number ≤ self, limited to 0 … `last`; 0 for a NaN. `last` < 2²³.
    fn index(self, last: u32) -> Self::Index;

    /// The whole number as a real; exact below 2²⁴.
    fn from_index(i: Self::Index) -> Self;

    /// `a` where the mask is true, `b` elsewhere.
    fn select_index(mask: Self::Mask, a: Self::Index, b: Self::Index) -> Self::Index;

    /// For each of `offsets`, the `K` consecutive numbers of `table` that begin at `at` + offset. `at` is limited to the last place from
    /// which all of them stand in the table.
    ///
    /// What is looked up together should stand together: a batch reads two or four numbers fastest by far, faster than one or three;
    /// pad those. And what stands at fixed distances, as the corners of a cell do, should be asked for at once.
    ///
    /// # Panics
    /// If `table` has fewer numbers than the largest offset plus `K`.
    fn gather_each<const K: usize, const M: usize>(
        table: &[f32],
        at: Self::Index,
        offsets: [u32; M],
    ) -> [[Self; K]; M];

    /// The `K` consecutive numbers of `table` that begin at `at`, which is limited to the last place where `K` numbers stand; see
    /// [`Number::gather_each`].
    ///
    /// # Panics
    /// If `table` has fewer than `K` numbers.
    #[inline(always)]
    fn gather<const K: usize>(table: &[f32], at: Self::Index) -> [Self; K] {
        let [found] = Self::gather_each(table, at, [0]);
        found
    }

    /// Between which of the nodes 0 … `nodes` − 1 self lies, and how far: (i, t) with self = i + t and t in [0, 1], where self is
    /// limited to [0, `nodes` − 1] and i to `nodes` − 2; (0, 0) for a NaN. 2 ≤ `nodes` ≤ 2²³.
    #[inline(always)]
    fn cell(self, nodes: u32) -> (Self::Index, Self) {
        let x = self.clamp(Self::zero(), Self::lit(f64::from(nodes - 1)));
        let i = x.index(nodes - 2);
        (i, x - Self::from_index(i))
    }

    /// Applies the opaque function `f` to numbers that are computed in double precision, lane by lane; as [`Number::call`].
    #[inline]
    fn through<const K: usize, const M: usize>(
        x: [Self; K],
        f: &dyn Fn([f64; K]) -> [f64; M],
    ) -> [Self; M] {
        Self::call(&Through(f), x)
    }
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
    #[inline(always)]
    fn least(self, limit: u32) -> Self {
        self.min(limit)
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
        fn gather_each<const K: usize, const M: usize>(
            table: &[f32],
            at: u32,
            offsets: [u32; M],
        ) -> [[Self; K]; M] {
            let at = at.min(gather::last::<K, M>(table, offsets));
            let mut y = [[0.0; K]; M];
            for m in 0..M {
                let found = gather::window::<K>(table, at, offsets[m]);
                for k in 0..K {
                    y[m][k] = <$t>::from(found[k]);
                }
            }
            y
        }
    };
}

impl Number for f64 {
    scalar_index!(f64);

    #[inline]
    fn call<const K: usize, const M: usize>(f: &dyn Function<K, M>, x: [Self; K]) -> [Self; M] {
        f.double(x)
    }
}

impl Number for f32 {
    scalar_index!(f32);

    #[inline]
    fn call<const K: usize, const M: usize>(f: &dyn Function<K, M>, x: [Self; K]) -> [Self; M] {
        f.single(x)
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
    #[inline(always)]
    fn least(self, limit: u32) -> Self {
        let mut r = self;
        for lane in 0..N {
            r.0[lane] = self.0[lane].min(limit);
        }
        r
    }
}

impl<const N: usize> Number for Lanes<N> {
    type Index = LaneIndex<N>;

    #[inline]
    fn call<const K: usize, const M: usize>(f: &dyn Function<K, M>, x: [Self; K]) -> [Self; M] {
        let mut y = [Self([0.0; N]); M];
        for lane in 0..N {
            let mut input = [0.0; K];
            for k in 0..K {
                input[k] = x[k].0[lane];
            }
            let output = f.single(input);
            for m in 0..M {
                y[m].0[lane] = output[m];
            }
        }
        y
    }

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
    fn gather_each<const K: usize, const M: usize>(
        table: &[f32],
        at: LaneIndex<N>,
        offsets: [u32; M],
    ) -> [[Self; K]; M] {
        gather::in_lanes(table, &at.0, offsets)
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

    fn call<const K: usize, const M: usize>(f: &dyn Function<K, M>, x: [Self; K]) -> [Self; M] {
        let values = x.map(|x| x.value);
        let slopes = |k: usize| {
            R::through(values, &|at| {
                let (mut high, mut low) = (at, at);
                high[k] += STEP;
                low[k] -= STEP;
                let (high, low) = (f.double(high), f.double(low));
                std::array::from_fn(|m| (high[m] - low[m]) / (2.0 * STEP))
            })
        };
        chain(x, R::call(f, values), slopes)
    }

    /// What a table holds is constant.
    #[inline(always)]
    fn gather_each<const K: usize, const M: usize>(
        table: &[f32],
        at: R::Index,
        offsets: [u32; M],
    ) -> [[Self; K]; M] {
        R::gather_each::<K, M>(table, at, offsets).map(|found| found.map(Self::constant))
    }
}

/// Step of the central differences.
const STEP: f64 = 1e-5;

/// The duals of the values `y` of a function at `x` with the derivatives `slopes(k)` by `x[k]`.
fn chain<R: Number, const P: usize, const K: usize, const M: usize>(
    x: [Dual<R, P>; K],
    y: [R; M],
    slopes: impl Fn(usize) -> [R; M],
) -> [Dual<R, P>; M] {
    let mut out = y.map(Dual::constant);
    for k in 0..K {
        let slope = slopes(k);
        for m in 0..M {
            for p in 0..P {
                out[m].partials[p] = out[m].partials[p] + slope[m] * x[k].partials[p];
            }
        }
    }
    out
}

impl Number for Expr {
    type Index = u32;

    /// 0: an opaque function can't be recorded. [`crate::record`] refuses models that would call it.
    fn call<const K: usize, const M: usize>(_f: &dyn Function<K, M>, _x: [Self; K]) -> [Self; M] {
        [Self::zero(); M]
    }

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
    fn gather_each<const K: usize, const M: usize>(
        _table: &[f32],
        _at: u32,
        _offsets: [u32; M],
    ) -> [[Self; K]; M] {
        [[Self::zero(); K]; M]
    }
}
