//! [`ShaderNumber`], a [`Real`] that shaders can be evaluated over.

use gonio_num::dispatch::{Kernel, dispatch};
use gonio_num::dual::Dual;
use gonio_num::expr::Expr;
use gonio_num::lanes::{LaneMask, Lanes};
use gonio_num::{Mask, Real, Work};
use std::fmt::Debug;

/// What a shader needs of its numbers beyond [`Real`]: to know whether a mask is true anywhere, and whole numbers of 32 bits,
/// signed or not, wrapping.
pub trait ShaderNumber: Real<Mask: 'static> + 'static {
    /// One pattern of 32 bits a lane.
    type Int: Copy + Debug + 'static;

    /// How many lanes the number has.
    const LANES: usize;

    /// Whether the mask is true in any lane.
    fn any(mask: Self::Mask) -> bool;
    /// The same whole number in every lane.
    fn int(x: u32) -> Self::Int;
    /// The whole number in one lane.
    fn lane(i: Self::Int, lane: usize) -> u32;
    /// `f` in every lane.
    fn int_map(a: Self::Int, f: impl Fn(u32) -> u32) -> Self::Int;
    /// `f` in every lane.
    fn int_zip(a: Self::Int, b: Self::Int, f: impl Fn(u32, u32) -> u32) -> Self::Int;
    /// `f` in every lane.
    fn int_test(a: Self::Int, b: Self::Int, f: impl Fn(u32, u32) -> bool) -> Self::Mask;
    /// `a` where the mask is true, `b` elsewhere.
    fn int_select(mask: Self::Mask, a: Self::Int, b: Self::Int) -> Self::Int;
    /// A whole number or pattern of bits made of a number, in every lane.
    fn to_int(self, f: impl Fn(f64) -> u32) -> Self::Int;
    /// A number made of a whole number or pattern of bits, in every lane. Its derivative is 0.
    fn from_int(i: Self::Int, f: impl Fn(u32) -> f64) -> Self;

    /// Runs `work` under the widest instruction set of the machine, if that makes a difference for this number.
    fn widest<W: Work>(work: W) -> W::Output {
        work.run()
    }

    /// Calls `visitor` with each register's number split into `WIDTH` numbers of a narrower type, if that is faster.
    fn narrow<V: Narrowed<Self>>(visitor: V) -> V::Output {
        visitor.same()
    }
}

/// What is done either with numbers of type `R` or with several narrower ones for each.
pub trait Narrowed<R> {
    /// What it gives.
    type Output;
    /// With the numbers as they are.
    fn same(self) -> Self::Output;
    /// Not at all: nothing can be known of such numbers.
    fn nothing(self) -> Self::Output;
    /// With `width` numbers of type `S` for each, `split` and `join` converting them.
    fn split<S: ShaderNumber>(
        self,
        width: usize,
        split: fn(&R, usize) -> S,
        join: fn(&mut R, usize, S),
    ) -> Self::Output;
}

macro_rules! scalar {
    ($t:ty) => {
        impl ShaderNumber for $t {
            type Int = u32;
            const LANES: usize = 1;
            #[inline(always)]
            fn any(mask: bool) -> bool {
                mask
            }
            #[inline(always)]
            fn int(x: u32) -> u32 {
                x
            }
            #[inline(always)]
            fn lane(i: u32, _lane: usize) -> u32 {
                i
            }
            #[inline(always)]
            fn int_map(a: u32, f: impl Fn(u32) -> u32) -> u32 {
                f(a)
            }
            #[inline(always)]
            fn int_zip(a: u32, b: u32, f: impl Fn(u32, u32) -> u32) -> u32 {
                f(a, b)
            }
            #[inline(always)]
            fn int_test(a: u32, b: u32, f: impl Fn(u32, u32) -> bool) -> bool {
                f(a, b)
            }
            #[inline(always)]
            fn int_select(mask: bool, a: u32, b: u32) -> u32 {
                if mask { a } else { b }
            }
            #[inline(always)]
            fn to_int(self, f: impl Fn(f64) -> u32) -> u32 {
                f(f64::from(self))
            }
            #[inline(always)]
            fn from_int(i: u32, f: impl Fn(u32) -> f64) -> Self {
                f(i) as $t
            }
        }
    };
}
scalar!(f32);
scalar!(f64);

/// Lanes that one step of the evaluator takes at a time.
const CHUNK: usize = 16;

impl<const N: usize> ShaderNumber for Lanes<N> {
    type Int = [u32; N];
    const LANES: usize = N;

    #[inline(always)]
    fn any(mask: LaneMask<N>) -> bool {
        mask.any()
    }
    #[inline(always)]
    fn int(x: u32) -> [u32; N] {
        [x; N]
    }
    #[inline(always)]
    fn lane(i: [u32; N], lane: usize) -> u32 {
        i[lane]
    }
    #[inline(always)]
    fn int_map(a: [u32; N], f: impl Fn(u32) -> u32) -> [u32; N] {
        let mut r = a;
        for lane in 0..N {
            r[lane] = f(a[lane]);
        }
        r
    }
    #[inline(always)]
    fn int_zip(a: [u32; N], b: [u32; N], f: impl Fn(u32, u32) -> u32) -> [u32; N] {
        let mut r = a;
        for lane in 0..N {
            r[lane] = f(a[lane], b[lane]);
        }
        r
    }
    #[inline(always)]
    fn int_test(a: [u32; N], b: [u32; N], f: impl Fn(u32, u32) -> bool) -> LaneMask<N> {
        let mut r = LaneMask([false; N]);
        for lane in 0..N {
            r.0[lane] = f(a[lane], b[lane]);
        }
        r
    }
    #[inline(always)]
    fn int_select(mask: LaneMask<N>, a: [u32; N], b: [u32; N]) -> [u32; N] {
        let mut r = a;
        for lane in 0..N {
            r[lane] = if mask.0[lane] { a[lane] } else { b[lane] };
        }
        r
    }
    #[inline(always)]
    fn to_int(self, f: impl Fn(f64) -> u32) -> [u32; N] {
        let mut r = [0; N];
        for lane in 0..N {
            r[lane] = f(f64::from(self.0[lane]));
        }
        r
    }
    #[inline(always)]
    fn from_int(i: [u32; N], f: impl Fn(u32) -> f64) -> Self {
        let mut r = Self([0.0; N]);
        for lane in 0..N {
            r.0[lane] = f(i[lane]) as f32;
        }
        r
    }

    #[inline(always)]
    fn widest<W: Work>(work: W) -> W::Output {
        /// Work that goes on over the lanes that it has, whatever the instruction set would like.
        struct AsItIs<W>(W);
        impl<W: Work> Kernel for AsItIs<W> {
            type Output = W::Output;
            #[inline(always)]
            fn run<const L: usize>(self) -> W::Output {
                self.0.run()
            }
        }
        dispatch(AsItIs(work))
    }

    #[inline]
    fn narrow<V: Narrowed<Self>>(visitor: V) -> V::Output {
        if const { N > CHUNK && N.is_multiple_of(CHUNK) } {
            visitor.split::<Lanes<CHUNK>>(
                N / CHUNK,
                |all, k| Lanes::load(&all.0[k * CHUNK..]),
                |all, k, part| all.0[k * CHUNK..][..CHUNK].copy_from_slice(&part.0),
            )
        } else {
            visitor.same()
        }
    }
}

impl<R: ShaderNumber, const P: usize> ShaderNumber for Dual<R, P> {
    type Int = R::Int;
    const LANES: usize = R::LANES;

    #[inline(always)]
    fn any(mask: R::Mask) -> bool {
        R::any(mask)
    }
    #[inline(always)]
    fn int(x: u32) -> R::Int {
        R::int(x)
    }
    #[inline(always)]
    fn lane(i: R::Int, lane: usize) -> u32 {
        R::lane(i, lane)
    }
    #[inline(always)]
    fn int_map(a: R::Int, f: impl Fn(u32) -> u32) -> R::Int {
        R::int_map(a, f)
    }
    #[inline(always)]
    fn int_zip(a: R::Int, b: R::Int, f: impl Fn(u32, u32) -> u32) -> R::Int {
        R::int_zip(a, b, f)
    }
    #[inline(always)]
    fn int_test(a: R::Int, b: R::Int, f: impl Fn(u32, u32) -> bool) -> R::Mask {
        R::int_test(a, b, f)
    }
    #[inline(always)]
    fn int_select(mask: R::Mask, a: R::Int, b: R::Int) -> R::Int {
        R::int_select(mask, a, b)
    }
    #[inline(always)]
    fn to_int(self, f: impl Fn(f64) -> u32) -> R::Int {
        self.value.to_int(f)
    }
    #[inline(always)]
    fn from_int(i: R::Int, f: impl Fn(u32) -> f64) -> Self {
        Self::constant(R::from_int(i, f))
    }
}

/// A shader can't be recorded as another: its branches depend on numbers that an expression doesn't know. What is asked of it is NaN.
impl ShaderNumber for Expr {
    type Int = u32;
    const LANES: usize = 1;

    fn any(_mask: Self::Mask) -> bool {
        false
    }
    fn int(x: u32) -> u32 {
        x
    }
    fn lane(i: u32, _lane: usize) -> u32 {
        i
    }
    fn int_map(a: u32, f: impl Fn(u32) -> u32) -> u32 {
        f(a)
    }
    fn int_zip(a: u32, b: u32, f: impl Fn(u32, u32) -> u32) -> u32 {
        f(a, b)
    }
    fn int_test(a: u32, b: u32, f: impl Fn(u32, u32) -> bool) -> Self::Mask {
        Self::Mask::splat(f(a, b))
    }
    fn int_select(_mask: Self::Mask, _a: u32, b: u32) -> u32 {
        b
    }
    fn to_int(self, _f: impl Fn(f64) -> u32) -> u32 {
        0
    }
    fn from_int(i: u32, f: impl Fn(u32) -> f64) -> Self {
        Self::lit(f(i))
    }
    fn narrow<V: Narrowed<Self>>(visitor: V) -> V::Output {
        visitor.nothing()
    }
}
