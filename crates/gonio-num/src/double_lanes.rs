//! [`DoubleLanes`], several `f64` side by side: where single precision would lose what matters.

// Loops over an index are what vectorises: no closure and no iterator stands between the loop and its instruction set.
#![allow(clippy::needless_range_loop)]

use crate::lanes::{LaneMask, Lanes};
use crate::{LoopState, Mask, Real, Table1, Table2, Table3, Vec3, Work, dispatch};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// `N` numbers of double precision, as [`Lanes`] are of single precision, under the same masks. Every operation does in every lane what
/// `f64` does, to the bit; the transcendental functions do it one lane at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(16))]
pub struct DoubleLanes<const N: usize>(pub [f64; N]);

impl<const N: usize> DoubleLanes<N> {
    /// `x` in every lane.
    #[inline(always)]
    pub fn splat(x: f64) -> Self {
        Self([x; N])
    }

    /// Each lane rounded to single precision.
    #[inline(always)]
    pub fn to_single(self) -> Lanes<N> {
        let mut r = Lanes([0.0; N]);
        for i in 0..N {
            r.0[i] = self.0[i] as f32;
        }
        r
    }
}

impl<const N: usize> Lanes<N> {
    /// Each lane in double precision, exactly.
    #[inline(always)]
    pub fn to_double(self) -> DoubleLanes<N> {
        let mut r = DoubleLanes([0.0; N]);
        for i in 0..N {
            r.0[i] = f64::from(self.0[i]);
        }
        r
    }
}

impl<const N: usize> Vec3<Lanes<N>> {
    /// In double precision, exactly.
    #[inline(always)]
    pub fn to_double(self) -> Vec3<DoubleLanes<N>> {
        Vec3::new(self.x.to_double(), self.y.to_double(), self.z.to_double())
    }
}

impl<const N: usize> Vec3<DoubleLanes<N>> {
    /// Rounded to single precision.
    #[inline(always)]
    pub fn to_single(self) -> Vec3<Lanes<N>> {
        Vec3::new(self.x.to_single(), self.y.to_single(), self.z.to_single())
    }
}

macro_rules! lanewise {
    ($($operator:ident $method:ident $sign:tt),+) => {$(
        impl<const N: usize> $operator for DoubleLanes<N> {
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
lanewise!(Add add +, Sub sub -, Mul mul *, Div div /);

impl<const N: usize> Neg for DoubleLanes<N> {
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

macro_rules! each_lane {
    ($($name:ident($($argument:ident),*);)+) => {$(
        #[inline(always)]
        fn $name(self $(, $argument: Self)*) -> Self {
            let mut r = self;
            for i in 0..N {
                r.0[i] = Real::$name(self.0[i] $(, $argument.0[i])*);
            }
            r
        }
    )+};
}

macro_rules! look_up {
    ($($name:ident($table:ty; $($argument:ident),+);)+) => {$(
        #[inline(always)]
        fn $name(table: &'static $table, $($argument: Self),+) -> Self {
            let mut r = Self([0.0; N]);
            for i in 0..N {
                r.0[i] = f64::$name(table, $($argument.0[i]),+);
            }
            r
        }
    )+};
}

impl<const N: usize> Real for DoubleLanes<N> {
    type Mask = LaneMask<N>;

    each_lane! {
        sqrt();
        abs();
        min(other);
        max(other);
        floor();
        exp();
        ln();
        sin();
        cos();
        acos();
        atan2(x);
    }

    #[inline(always)]
    fn lit(x: f64) -> Self {
        Self([x; N])
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

    #[inline(always)]
    fn maybe_any(_: LaneMask<N>) -> bool {
        true
    }

    look_up! {
        table1(Table1; x);
        table2(Table2; x, y);
        table3(Table3; x, y, z);
    }

    #[inline(always)]
    fn out_of_line<W: Work>(work: W) -> W::Output {
        dispatch::run_with_lanes::<N, W>(work)
    }

    #[inline(always)]
    fn repeat_state<S: LoopState<Self>>(
        count: u32,
        mut state: S,
        mut body: impl FnMut(Self, S) -> (S, LaneMask<N>),
    ) -> S {
        let mut alive = LaneMask::splat(true);
        for i in 0..count {
            let (next, go_on) = body(Self::splat(f64::from(i)), state);
            state = S::select(alive, next, state);
            alive = alive & go_on;
            if !alive.any() {
                break;
            }
        }
        state
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dispatch::{InstructionSet, Kernel, dispatch_on};

    /// A bit of everything, with values in which roundings show.
    #[inline(always)]
    fn mixed<R: Real>(x: R) -> R {
        let v = Vec3::new(x, R::lit(0.3) / x, x.sqrt()).normalize();
        let turned = v.cross(Vec3::new(R::one(), x.floor(), -x)).length();
        let some = R::select(
            x.lt(R::lit(2.0)),
            turned,
            turned.min(x.abs()).max(R::lit(0.1)),
        );
        let root = R::repeat(4, [some], |i, [y]| {
            let next = R::lit(0.5) * (y + x / y) + i * R::lit(1e-3);
            ([next], (next * next - x).abs().gt(R::lit(1e-2)))
        });
        root[0] + x.sin() * x.cos() + x.ln().exp() + x.acos() - x.atan2(v.x)
    }

    struct Batch<'a>(&'a [f64], &'a mut [f64]);

    impl Kernel for Batch<'_> {
        type Output = ();
        #[inline(always)]
        fn run<const N: usize>(self) {
            for (x, result) in self.0.chunks_exact(N).zip(self.1.chunks_exact_mut(N)) {
                let mut lanes = DoubleLanes([0.0; N]);
                lanes.0.copy_from_slice(x);
                result.copy_from_slice(&mixed(lanes).0);
            }
        }
    }

    #[test]
    fn each_lane_does_what_a_number_does() {
        let x: Vec<f64> = (1..=64).map(|k| f64::from(k) * 0.0731).collect();
        for set in InstructionSet::ALL.into_iter().filter(|s| s.is_available()) {
            let mut result = vec![0.0; x.len()];
            dispatch_on(set, Batch(&x, &mut result));
            for (x, y) in x.iter().zip(result) {
                assert_eq!(mixed(*x).to_bits(), y.to_bits(), "{} {x}", set.name());
            }
        }
    }

    #[test]
    fn precision_changes_as_a_conversion_does() {
        let single = Lanes::<8>([0.1, -3.0, 1e-40, f32::MAX, 0.0, -0.0, 7.5, 1e30]);
        assert_eq!(single.to_double().to_single(), single);
        assert_eq!(DoubleLanes::<8>::splat(0.1).to_single(), Lanes::splat(0.1));
    }
}
