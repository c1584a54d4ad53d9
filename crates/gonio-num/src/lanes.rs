//! [`Lanes`], several `f32` side by side, one formula for all of them.
//!
//! A `Lanes` is a plain array; each operation is a loop over its lanes that the compiler turns into vector
//! instructions of the function it stands in (see [`dispatch`]). Every operation does in every lane
//! what `f32` does, to the bit.

// Loops over an index are what vectorises: no closure and no iterator stands between the loop and its instruction set.
#![allow(clippy::needless_range_loop)]

use crate::table::over_lanes;
use crate::{LoopState, Mask, Real, Table1, Table2, Table3, Vec3, Work, dispatch, math};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// `N` numbers of type `f32`, calculated with at once. N = 4, 8 and 16 match today's registers.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(16))]
pub struct Lanes<const N: usize>(pub [f32; N]);

/// One truth value a lane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LaneMask<const N: usize>(pub [bool; N]);

impl<const N: usize> Lanes<N> {
    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(x: f32) -> Self {
        Self([x; N])
    }

    /// The first `N` numbers of `source`.
    ///
    /// # Panics
    /// If `source` has fewer than `N`; see [`Lanes::load_or`].
    #[inline(always)]
    pub fn load(source: &[f32]) -> Self {
        assert!(
            source.len() >= N,
            "{N} lanes can't be loaded from {} numbers",
            source.len()
        );
        let mut r = Self([0.0; N]);
        r.0.copy_from_slice(&source[..N]);
        r
    }

    /// The first numbers of `source`, at most `N`, and `fill` in the lanes that it is too short for: the tail of a batch.
    #[inline(always)]
    pub fn load_or(source: &[f32], fill: f32) -> Self {
        if source.len() >= N {
            return Self::load(source);
        }
        let mut r = Self([fill; N]);
        copy_tail(source, &mut r.0);
        r
    }

    /// Writes the lanes to the front of `target`; as many as fit, if it is shorter than `N`.
    #[inline(always)]
    pub fn store(self, target: &mut [f32]) {
        if let Some(front) = target.first_chunk_mut() {
            *front = self.0;
        } else {
            let count = target.len();
            copy_tail(&self.0[..count], target);
        }
        end_of_step();
    }

    /// The number in lane `i`.
    ///
    /// # Panics
    /// If i ≥ N.
    #[inline(always)]
    pub fn extract(self, i: usize) -> f32 {
        self.0[i]
    }
}

/// Copies `from` to the front of `to`. A function of its own: beside it in one function, copies of whole steps would be made by a call as well.
#[cold]
#[inline(never)]
fn copy_tail(from: &[f32], to: &mut [f32]) {
    to[..from.len()].copy_from_slice(from);
}

impl<const N: usize> LaneMask<N> {
    /// Whether it is true in any lane.
    #[inline(always)]
    pub fn any(self) -> bool {
        let mut r = false;
        for i in 0..N {
            r |= self.0[i];
        }
        r
    }

    /// Whether it is true in every lane.
    #[inline(always)]
    pub fn all(self) -> bool {
        !(!self).any()
    }

    /// The truth value in lane `i`.
    ///
    /// # Panics
    /// If i ≥ N.
    #[inline(always)]
    pub fn extract(self, i: usize) -> bool {
        self.0[i]
    }
}

impl<const N: usize> Vec3<Lanes<N>> {
    /// The same vector in every lane.
    #[inline(always)]
    pub fn broadcast(v: Vec3<f32>) -> Self {
        Self::new(Lanes::splat(v.x), Lanes::splat(v.y), Lanes::splat(v.z))
    }

    /// Lane i takes vector i of `source`, and `fill` where `source` is too short: from an array of structures to
    /// a structure of arrays.
    #[inline(always)]
    pub fn gather(source: &[Vec3<f32>], fill: Vec3<f32>) -> Self {
        let mut r = Self::broadcast(fill);
        let count = if source.len() < N { source.len() } else { N };
        for i in 0..count {
            r.x.0[i] = source[i].x;
            r.y.0[i] = source[i].y;
            r.z.0[i] = source[i].z;
        }
        r
    }

    /// Vector i of `target` takes lane i, for as many vectors as `target` has: the inverse of [`Vec3::gather`].
    #[inline(always)]
    pub fn scatter(self, target: &mut [Vec3<f32>]) {
        let count = if target.len() < N { target.len() } else { N };
        for i in 0..count {
            target[i] = self.extract(i);
        }
        end_of_step();
    }

    /// The vector in lane `i`.
    ///
    /// # Panics
    /// If i ≥ N.
    #[inline(always)]
    pub fn extract(self, i: usize) -> Vec3<f32> {
        Vec3::new(self.x.0[i], self.y.0[i], self.z.0[i])
    }
}

/// Keeps the compiler from vectorising the loop *around* a step of a batch: it would take the same lane of many steps
/// together, with shuffles in between, and be up to 1.7 times slower than vectors of lanes. Costs nothing itself.
#[inline(always)]
fn end_of_step() {
    std::hint::black_box(());
}

macro_rules! lanewise {
    ($type:ident: $($operator:ident $method:ident $sign:tt),+) => {$(
        impl<const N: usize> $operator for $type<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, o: Self) -> Self {
                let mut r = self;
                for i in 0..N {
                    r.0[i] = self.0[i] $sign o.0[i];
                }
                r
            }
        }
    )+};
}
lanewise!(Lanes: Add add +, Sub sub -, Mul mul *, Div div /);
lanewise!(LaneMask: BitAnd bitand &, BitOr bitor |);

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let mut r = self;
        for i in 0..N {
            r.0[i] = -self.0[i];
        }
        r
    }
}

impl<const N: usize> Not for LaneMask<N> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        let mut r = self;
        for i in 0..N {
            r.0[i] = !self.0[i];
        }
        r
    }
}

impl<const N: usize> Mask for LaneMask<N> {
    #[inline(always)]
    fn splat(b: bool) -> Self {
        Self([b; N])
    }
}

/// Methods that run a function of one, two or three numbers in each lane.
macro_rules! each_lane {
    ($($name:ident($($argument:ident),*) = $function:path;)+) => {$(
        #[inline(always)]
        fn $name(self $(, $argument: Self)*) -> Self {
            let mut r = self;
            for i in 0..N {
                r.0[i] = $function(self.0[i] $(, $argument.0[i])*);
            }
            r
        }
    )+};
}

impl<const N: usize> Real for Lanes<N> {
    type Mask = LaneMask<N>;

    each_lane! {
        sqrt() = f32::sqrt;
        abs() = f32::abs;
        min(other) = Real::min;
        max(other) = Real::max;
        floor() = math::floor;
        exp() = math::exp;
        ln() = math::ln;
        sin() = math::sin;
        cos() = math::cos;
        acos() = math::acos;
        atan2(x) = math::atan2;
    }

    #[inline(always)]
    fn lit(x: f64) -> Self {
        Self([x as f32; N])
    }

    #[inline(always)]
    fn lt(self, other: Self) -> LaneMask<N> {
        let mut r = LaneMask([false; N]);
        for i in 0..N {
            r.0[i] = self.0[i] < other.0[i];
        }
        r
    }

    #[inline(always)]
    fn le(self, other: Self) -> LaneMask<N> {
        let mut r = LaneMask([false; N]);
        for i in 0..N {
            r.0[i] = self.0[i] <= other.0[i];
        }
        r
    }

    #[inline(always)]
    fn select(mask: LaneMask<N>, a: Self, b: Self) -> Self {
        let mut r = a;
        for i in 0..N {
            r.0[i] = if mask.0[i] { a.0[i] } else { b.0[i] };
        }
        r
    }

    /// Always true: some lane nearly always needs the work, and an early way out would stop vectorisation.
    #[inline(always)]
    fn maybe_any(_: LaneMask<N>) -> bool {
        true
    }

    #[inline(always)]
    fn table1(table: &'static Table1, x: Self) -> Self {
        over_lanes::lookup1(table, x)
    }

    #[inline(always)]
    fn table2(table: &'static Table2, x: Self, y: Self) -> Self {
        over_lanes::lookup2(table, x, y)
    }

    #[inline(always)]
    fn table3(table: &'static Table3, x: Self, y: Self, z: Self) -> Self {
        over_lanes::lookup3(table, x, y, z)
    }

    #[inline(always)]
    fn out_of_line<W: Work>(work: W) -> W::Output {
        dispatch::run_with_lanes::<N, W>(work)
    }

    /// Goes on while any lane does; a lane that has ended keeps its state.
    #[inline(always)]
    fn repeat_state<S: LoopState<Self>>(
        count: u32,
        mut state: S,
        mut body: impl FnMut(Self, S) -> (S, LaneMask<N>),
    ) -> S {
        let mut alive = LaneMask::splat(true);
        for i in 0..count {
            let (next, go_on) = body(Self::splat(i as f32), state);
            state = S::select(alive, next, state);
            alive = alive & go_on;
            if !alive.any() {
                break;
            }
        }
        state
    }
}
