//! [`Real`], the number type that formulas are generic over, and its scalar implementations.

use crate::table::{lookup1, lookup1_f64, lookup2, lookup2_f64, lookup3, lookup3_f64};
use crate::{Table1, Table2, Table3, math};
use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// The outcome of a comparison of [`Real`]s: `bool` for scalars, one `bool` a lane for batches, a boolean expression
/// for shader code.
pub trait Mask:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// The mask that is `b` everywhere.
    fn splat(b: bool) -> Self;
}

impl Mask for bool {
    #[inline(always)]
    fn splat(b: bool) -> Self {
        b
    }
}

/// What a loop carries from step to step: some numbers of type `R`. An array is one.
pub trait LoopState<R: Real>: Copy {
    /// `a` where the mask is true, `b` elsewhere, number by number.
    fn select(mask: R::Mask, a: Self, b: Self) -> Self;
    /// The state with each number replaced by `f` of it, always in the same order.
    fn map(self, f: &mut impl FnMut(R) -> R) -> Self;
}

impl<R: Real, const K: usize> LoopState<R> for [R; K] {
    #[inline(always)]
    fn select(mask: R::Mask, a: Self, b: Self) -> Self {
        let mut r = a;
        for i in 0..K {
            r[i] = R::select(mask, a[i], b[i]);
        }
        r
    }

    #[inline(always)]
    fn map(self, f: &mut impl FnMut(R) -> R) -> Self {
        let mut r = self;
        for x in &mut r {
            *x = f(*x);
        }
        r
    }
}

/// A piece of a formula that [`Real::out_of_line`] runs.
pub trait Work {
    /// What it gives.
    type Output;
    /// Does it; mark it `#[inline(always)]`.
    fn run(self) -> Self::Output;
}

/// A real number that formulas are written over.
///
/// Implementations: `f32`, `f64`, [`Lanes`](crate::lanes::Lanes), [`Dual`](crate::dual::Dual) and
/// [`Expr`](crate::expr::Expr).
///
/// A formula over `Real` has no `if` on a real: it evaluates both arms and calls [`Real::select`], with each arm guarded
/// (`x.max(ε)` before a root, a logarithm or a division), so that no arm makes a NaN that a derivative would carry on.
/// Inside a kernel neither closures nor `array::map` are called: they don't inherit the instruction set of the
/// `#[target_feature]` function around them.
///
/// Constants are `f64` literals rounded to the type: `R::lit(0.5)`.
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// What a comparison gives.
    type Mask: Mask;

    /// The constant `x`, rounded to this type.
    fn lit(x: f64) -> Self;

    /// √self; NaN below 0.
    fn sqrt(self) -> Self;
    /// |self|.
    fn abs(self) -> Self;
    /// The smaller of the two; `other` if either is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger of the two; `other` if either is NaN.
    fn max(self, other: Self) -> Self;
    /// The largest whole number ≤ self. Derivative 0.
    fn floor(self) -> Self;
    /// eˣ.
    fn exp(self) -> Self;
    /// Natural logarithm; −∞ at 0, NaN below.
    fn ln(self) -> Self;
    /// Sine of an angle in radians; in `f32` accurate for |x| ≤ 8192.
    fn sin(self) -> Self;
    /// Cosine of an angle in radians; in `f32` accurate for |x| ≤ 8192.
    fn cos(self) -> Self;
    /// Angle in [0, π] whose cosine is self; self is clamped to [−1, 1], NaN stays NaN.
    fn acos(self) -> Self;
    /// Angle of the point (x, y) = (`x`, `self`) in [−π, π]; ±0 at the origin.
    fn atan2(self, x: Self) -> Self;

    /// self < other.
    fn lt(self, other: Self) -> Self::Mask;
    /// self ≤ other.
    fn le(self, other: Self) -> Self::Mask;
    /// `a` where the mask is true, `b` elsewhere. Both are always evaluated.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// False only if the mask is known to be false everywhere: a hint for skipping work. Batches and expressions may
    /// always answer true.
    fn maybe_any(mask: Self::Mask) -> bool;

    /// Linear interpolation in `table` at `x`, clamped to [0, 1].
    fn table1(table: &'static Table1, x: Self) -> Self;
    /// Bilinear interpolation in `table` at (`x`, `y`), each clamped to [0, 1].
    fn table2(table: &'static Table2, x: Self, y: Self) -> Self;
    /// Trilinear interpolation in `table` at (`x`, `y`, `z`), each clamped to [0, 1].
    fn table3(table: &'static Table3, x: Self, y: Self, z: Self) -> Self;

    /// Runs `work` in a function of its own, over lanes one for the instruction set of the machine. Everything else becomes part of the
    /// kernel that calls it; this is for what is long and seldom needed, or shared by many kernels.
    #[inline(never)]
    fn out_of_line<W: Work>(work: W) -> W::Output {
        work.run()
    }

    /// [`Real::repeat`] over any [`LoopState`].
    fn repeat_state<S: LoopState<Self>>(
        count: u32,
        state: S,
        body: impl FnMut(Self, S) -> (S, Self::Mask),
    ) -> S;

    /// A bounded loop over a state of `K` numbers: at most `count` times `state = body(i, state)`, going on while the mask
    /// that `body` returns is true. Where it became false the state stays as that last step left it.
    ///
    /// `body` must be a pure function of its arguments and of values from outside the loop: batches run steps that some lanes
    /// no longer need, and a shader's loop is recorded from one call.
    #[inline(always)]
    fn repeat<const K: usize>(
        count: u32,
        state: [Self; K],
        body: impl FnMut(Self, [Self; K]) -> ([Self; K], Self::Mask),
    ) -> [Self; K] {
        Self::repeat_state(count, state, body)
    }

    /// 0.
    #[inline(always)]
    fn zero() -> Self {
        Self::lit(0.0)
    }
    /// 1.
    #[inline(always)]
    fn one() -> Self {
        Self::lit(1.0)
    }
    /// π.
    #[inline(always)]
    fn pi() -> Self {
        Self::lit(std::f64::consts::PI)
    }
    /// self > other.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }
    /// self ≥ other.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }
    /// self limited to [low, high]; low for a NaN.
    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }
    /// self limited to [0, 1]; 0 for a NaN.
    #[inline(always)]
    fn saturate(self) -> Self {
        self.clamp(Self::zero(), Self::one())
    }
    /// self².
    #[inline(always)]
    fn sq(self) -> Self {
        self * self
    }
    /// 1 / self.
    #[inline(always)]
    fn recip(self) -> Self {
        Self::one() / self
    }
    /// self⁵, as Schlick's formula needs it.
    #[inline(always)]
    fn pow5(self) -> Self {
        let s = self * self;
        s * s * self
    }
    /// selfᵉ for self ≥ 0: e^(e·ln self), 0 at self = 0 when e > 0, 1 at e = 0.
    #[inline(always)]
    fn powf(self, e: Self) -> Self {
        let tiny = Self::lit(1e-37);
        let p = (e * self.max(tiny).ln()).exp();
        let at_zero = Self::select(e.le(Self::zero()), Self::one(), Self::zero());
        Self::select(self.lt(tiny), at_zero, p)
    }
    /// sin and cos of the same angle.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        (self.sin(), self.cos())
    }
    /// tan of an angle in radians.
    #[inline(always)]
    fn tan(self) -> Self {
        let (sin, cos) = self.sin_cos();
        sin / cos
    }
    /// Angle in [−π/2, π/2] whose sine is self; self is clamped to [−1, 1].
    #[inline(always)]
    fn asin(self) -> Self {
        Self::lit(std::f64::consts::FRAC_PI_2) - self.acos()
    }
    /// |self| with the sign of `sign` (zero counts as positive).
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        let a = self.abs();
        Self::select(sign.lt(Self::zero()), -a, a)
    }
    /// a at self = 0, b at self = 1, linear between: (1 − t)·a + t·b.
    #[inline(always)]
    fn lerp(self, a: Self, b: Self) -> Self {
        (Self::one() - self) * a + self * b
    }
    /// 1 where the mask is true, 0 elsewhere.
    #[inline(always)]
    fn from_mask(mask: Self::Mask) -> Self {
        Self::select(mask, Self::one(), Self::zero())
    }
    /// √max(self, 0).
    #[inline(always)]
    fn safe_sqrt(self) -> Self {
        self.max(Self::zero()).sqrt()
    }
}

macro_rules! scalar_real {
    ($t:ty, $floor:path, $exp:path, $ln:path, $sin:path, $cos:path, $acos:path, $atan2:path, $lookup1:path, $lookup2:path, $lookup3:path) => {
        impl Real for $t {
            type Mask = bool;
            #[inline(always)]
            fn lit(x: f64) -> Self {
                x as $t
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$t>::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$t>::abs(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn floor(self) -> Self {
                $floor(self)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                $exp(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                $ln(self)
            }
            #[inline(always)]
            fn sin(self) -> Self {
                $sin(self)
            }
            #[inline(always)]
            fn cos(self) -> Self {
                $cos(self)
            }
            #[inline(always)]
            fn acos(self) -> Self {
                $acos(self)
            }
            #[inline(always)]
            fn atan2(self, x: Self) -> Self {
                $atan2(self, x)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn select(mask: bool, a: Self, b: Self) -> Self {
                if mask { a } else { b }
            }
            #[inline(always)]
            fn maybe_any(mask: bool) -> bool {
                mask
            }
            #[inline(always)]
            fn table1(table: &'static Table1, x: Self) -> Self {
                $lookup1(table, x)
            }
            #[inline(always)]
            fn table2(table: &'static Table2, x: Self, y: Self) -> Self {
                $lookup2(table, x, y)
            }
            #[inline(always)]
            fn table3(table: &'static Table3, x: Self, y: Self, z: Self) -> Self {
                $lookup3(table, x, y, z)
            }
            #[inline(always)]
            fn repeat_state<S: LoopState<Self>>(
                count: u32,
                mut state: S,
                mut body: impl FnMut(Self, S) -> (S, bool),
            ) -> S {
                for i in 0..count {
                    let (next, go_on) = body(i as $t, state);
                    state = next;
                    if !go_on {
                        break;
                    }
                }
                state
            }
        }
    };
}

scalar_real!(
    f32,
    math::floor,
    math::exp,
    math::ln,
    math::sin,
    math::cos,
    math::acos,
    math::atan2,
    lookup1,
    lookup2,
    lookup3
);
scalar_real!(
    f64,
    f64::floor,
    libm::exp,
    libm::log,
    libm::sin,
    libm::cos,
    acos_f64,
    atan2_f64,
    lookup1_f64,
    lookup2_f64,
    lookup3_f64
);

/// As [`math::acos`]: clamped, NaN stays NaN.
#[inline(always)]
fn acos_f64(x: f64) -> f64 {
    libm::acos(x.clamp(-1.0, 1.0))
}

/// As [`math::atan2`]: 0 at the origin, whatever the signs of the zeros.
#[inline(always)]
fn atan2_f64(y: f64, x: f64) -> f64 {
    let angle = libm::atan2(y, x);
    if x == 0.0 && y == 0.0 {
        0.0f64.copysign(y)
    } else {
        angle
    }
}
