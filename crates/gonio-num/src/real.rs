//! [`Real`], the number type that formulas are generic over, and its scalar implementations.

use crate::math;
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

/// A one-dimensional table, linearly interpolated by [`Real::table1`].
#[derive(Debug, Clone, Copy)]
pub struct Table1 {
    /// Name in exported shader code: a valid identifier, unique in the program.
    pub name: &'static str,
    /// Samples at x = i / (n − 1), n ≥ 2.
    pub data: &'static [f32],
}

/// A two-dimensional table, bilinearly interpolated by [`Real::table2`].
#[derive(Debug, Clone, Copy)]
pub struct Table2 {
    /// Name in exported shader code: a valid identifier, unique in the program.
    pub name: &'static str,
    /// Samples a row, along x; at least 2.
    pub width: usize,
    /// Rows, along y; at least 2.
    pub height: usize,
    /// Row-major samples: `data[j * width + i]` stands at x = i / (width − 1), y = j / (height − 1).
    pub data: &'static [f32],
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
    /// The smaller of the two; `other` if `self` is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger of the two; `other` if `self` is NaN.
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
    /// Angle in [0, π] whose cosine is self; self is clamped to [−1, 1].
    fn acos(self) -> Self;
    /// Angle of the point (x, y) = (`x`, `self`) in [−π, π]; 0 at the origin.
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

    /// A bounded loop over a state of `K` numbers: at most `count` times `state = body(i, state)`, going on while the mask
    /// that `body` returns is true. Where it became false the state stays as that last step left it.
    fn repeat<const K: usize>(
        count: u32,
        state: [Self; K],
        body: impl FnMut(Self, [Self; K]) -> ([Self; K], Self::Mask),
    ) -> [Self; K];

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
    /// self limited to [low, high].
    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }
    /// self limited to [0, 1].
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
        self.sin() / self.cos()
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

/// Index and weight of the lower of the two samples around x in [0, 1] of a table of n, and the look-ups with them.
macro_rules! lookups {
    ($t:ty, $bracket:ident, $lookup1:ident, $lookup2:ident) => {
        #[inline(always)]
        fn $bracket(n: usize, x: $t) -> (usize, $t) {
            let f = x.clamp(0.0, 1.0) * (n - 1) as $t;
            // A NaN becomes index 0 with weight NaN, so it stays visible.
            let i = (f as usize).min(n - 2);
            (i, f - i as $t)
        }

        #[inline(always)]
        pub(crate) fn $lookup1(t: &Table1, x: $t) -> $t {
            let (i, w) = $bracket(t.data.len(), x);
            <$t>::from(t.data[i]) * (1.0 - w) + <$t>::from(t.data[i + 1]) * w
        }

        #[inline(always)]
        pub(crate) fn $lookup2(t: &Table2, x: $t, y: $t) -> $t {
            let (i, u) = $bracket(t.width, x);
            let (j, v) = $bracket(t.height, y);
            let row = j * t.width + i;
            let (low, high) = (&t.data[row..], &t.data[row + t.width..]);
            let low = <$t>::from(low[0]) * (1.0 - u) + <$t>::from(low[1]) * u;
            let high = <$t>::from(high[0]) * (1.0 - u) + <$t>::from(high[1]) * u;
            low * (1.0 - v) + high * v
        }
    };
}
lookups!(f32, bracket_f32, lookup1, lookup2);
lookups!(f64, bracket_f64, lookup1_f64, lookup2_f64);

macro_rules! scalar_real {
    ($t:ty, $floor:path, $exp:path, $ln:path, $sin:path, $cos:path, $acos:path, $atan2:path, $lookup1:path, $lookup2:path) => {
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
            fn repeat<const K: usize>(
                count: u32,
                mut state: [Self; K],
                mut body: impl FnMut(Self, [Self; K]) -> ([Self; K], bool),
            ) -> [Self; K] {
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
    lookup2
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
    lookup2_f64
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
