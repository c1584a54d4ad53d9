//! [`Dual`], a number with its derivatives: forward-mode differentiation of any formula over [`Real`].

// Loops over an index are what vectorises over lanes.
#![allow(clippy::needless_range_loop)]

use crate::{LoopState, Real, Table1, Table2, Table3};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value and its partial derivatives by `P` variables.
///
/// Arithmetic follows the chain rule, so a formula over [`Real`] evaluated on duals gives, beside its value, its exact
/// derivatives (to rounding). `R` may be a scalar, lanes, a shader expression, or a dual again for second derivatives.
///
/// Where a function has no derivative this type takes one side: |x| has derivative +1 at 0 (as at x > 0), `min` and `max`
/// take the derivative of the argument that they return, `select` that of the arm, a table that of the interval to the right
/// (to the left at 1). `floor` and comparisons have derivative 0. √x at 0 and acos x at ±1 have infinite ones, which would
/// turn into NaN further on: they are limited to 10¹⁸ (√) and 10⁹ (acos), and outside [−1, 1] the clamped acos has 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<R, const P: usize> {
    /// The value.
    pub value: R,
    /// ∂value/∂pᵢ.
    pub partials: [R; P],
}

impl<R: Real, const P: usize> Dual<R, P> {
    /// A constant: all derivatives are 0.
    #[inline(always)]
    pub fn constant(value: R) -> Self {
        Self {
            value,
            partials: [R::zero(); P],
        }
    }

    /// The `index`-th variable: its own derivative is 1.
    ///
    /// # Panics
    /// If index ≥ P.
    #[inline(always)]
    pub fn variable(value: R, index: usize) -> Self {
        assert!(index < P, "there are {P} variables, none has index {index}");
        let mut r = Self::constant(value);
        r.partials[index] = R::one();
        r
    }

    /// `value` with the derivatives times `slope`: the chain rule for a function of one argument.
    #[inline(always)]
    fn chain(self, value: R, slope: R) -> Self {
        let mut partials = self.partials;
        for p in &mut partials {
            *p = *p * slope;
        }
        Self { value, partials }
    }

    /// The chain rule for a function of two arguments.
    #[inline(always)]
    fn chain2(self, o: Self, value: R, by_self: R, by_other: R) -> Self {
        let mut partials = self.partials;
        for i in 0..P {
            partials[i] = self.partials[i] * by_self + o.partials[i] * by_other;
        }
        Self { value, partials }
    }
}

impl<R: Real, const P: usize> Add for Dual<R, P> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        let mut partials = self.partials;
        for i in 0..P {
            partials[i] = self.partials[i] + o.partials[i];
        }
        Self {
            value: self.value + o.value,
            partials,
        }
    }
}

impl<R: Real, const P: usize> Sub for Dual<R, P> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        let mut partials = self.partials;
        for i in 0..P {
            partials[i] = self.partials[i] - o.partials[i];
        }
        Self {
            value: self.value - o.value,
            partials,
        }
    }
}

impl<R: Real, const P: usize> Mul for Dual<R, P> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        self.chain2(o, self.value * o.value, o.value, self.value)
    }
}

impl<R: Real, const P: usize> Div for Dual<R, P> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let quotient = self.value / o.value;
        let mut partials = self.partials;
        for i in 0..P {
            partials[i] = (self.partials[i] - quotient * o.partials[i]) / o.value;
        }
        Self {
            value: quotient,
            partials,
        }
    }
}

impl<R: Real, const P: usize> Neg for Dual<R, P> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let mut partials = self.partials;
        for p in &mut partials {
            *p = -*p;
        }
        Self {
            value: -self.value,
            partials,
        }
    }
}

/// The cell of a table that x lies in.
struct Cell<R> {
    /// Its lower end, in [0, 1].
    low: R,
    /// Its upper end, in [0, 1].
    high: R,
    /// 1 / its width, or 0 if x lies outside [0, 1], where the look-up is constant.
    inverse_width: R,
}

impl<R: Real> Cell<R> {
    #[inline(always)]
    fn around(x: R, n: usize) -> Self {
        let cells = (n - 1) as f64;
        let i = (x.saturate() * R::lit(cells))
            .floor()
            .min(R::lit(cells - 1.0));
        let inside = R::zero().le(x) & x.le(R::one());
        Self {
            low: i / R::lit(cells),
            high: (i + R::one()) / R::lit(cells),
            inverse_width: R::select(inside, R::lit(cells), R::zero()),
        }
    }
}

impl<R: Real, const P: usize> Real for Dual<R, P> {
    type Mask = R::Mask;

    #[inline(always)]
    fn lit(x: f64) -> Self {
        Self::constant(R::lit(x))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        // 0 · ∞ would be NaN at a root of 0 whose argument doesn't change.
        let slope = R::lit(0.5) / root.max(R::lit(5e-19));
        self.chain(root, slope)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        let slope = R::one().copysign(self.value);
        self.chain(self.value.abs(), slope)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.value.lt(other.value), self, other)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self.value.gt(other.value), self, other)
    }

    #[inline(always)]
    fn floor(self) -> Self {
        Self::constant(self.value.floor())
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let e = self.value.exp();
        self.chain(e, e)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), self.value.recip())
    }

    #[inline(always)]
    fn sin(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        self.chain(sin, cos)
    }

    #[inline(always)]
    fn cos(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        self.chain(cos, -sin)
    }

    #[inline(always)]
    fn acos(self) -> Self {
        let x = self.value;
        // (1 − x)(1 + x) keeps its digits where 1 − x² loses them.
        let radicand = (R::one() - x) * (R::one() + x);
        let slope = -radicand.max(R::lit(1e-18)).sqrt().recip();
        let slope = R::select(x.abs().le(R::one()), slope, R::zero());
        self.chain(x.acos(), slope)
    }

    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        let (y, x_value) = (self.value, x.value);
        // Divided by the larger coordinate, so that the squares neither overflow nor vanish; 0 at the origin.
        let size = y.abs().max(x_value.abs());
        let origin = size.le(R::zero());
        let size = R::select(origin, R::one(), size);
        let (sy, sx) = (y / size, x_value / size);
        let scale = (sx * sx + sy * sy).max(R::lit(0.5)) * size;
        self.chain2(x, y.atan2(x_value), sx / scale, -sy / scale)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> R::Mask {
        self.value.lt(other.value)
    }

    #[inline(always)]
    fn le(self, other: Self) -> R::Mask {
        self.value.le(other.value)
    }

    #[inline(always)]
    fn select(mask: R::Mask, a: Self, b: Self) -> Self {
        let mut partials = a.partials;
        for i in 0..P {
            partials[i] = R::select(mask, a.partials[i], b.partials[i]);
        }
        Self {
            value: R::select(mask, a.value, b.value),
            partials,
        }
    }

    #[inline(always)]
    fn maybe_any(mask: R::Mask) -> bool {
        R::maybe_any(mask)
    }

    #[inline(always)]
    fn table1(table: &'static Table1, x: Self) -> Self {
        let cell = Cell::around(x.value, table.data.len());
        let rise = R::table1(table, cell.high) - R::table1(table, cell.low);
        x.chain(R::table1(table, x.value), rise * cell.inverse_width)
    }

    #[inline(always)]
    fn table2(table: &'static Table2, x: Self, y: Self) -> Self {
        let (cx, cy) = (
            Cell::around(x.value, table.width),
            Cell::around(y.value, table.height),
        );
        // Bilinear: along x at fixed y the interpolant is linear in the cell, and the other way round.
        let along_x = R::table2(table, cx.high, y.value) - R::table2(table, cx.low, y.value);
        let along_y = R::table2(table, x.value, cy.high) - R::table2(table, x.value, cy.low);
        let value = R::table2(table, x.value, y.value);
        x.chain2(
            y,
            value,
            along_x * cx.inverse_width,
            along_y * cy.inverse_width,
        )
    }

    #[inline(always)]
    fn table3(table: &'static Table3, x: Self, y: Self, z: Self) -> Self {
        let (vx, vy, vz) = (x.value, y.value, z.value);
        let (cx, cy, cz) = (
            Cell::around(vx, table.width),
            Cell::around(vy, table.height),
            Cell::around(vz, table.depth),
        );
        let at = |x: R, y: R, z: R| R::table3(table, x, y, z);
        let slope_x = (at(cx.high, vy, vz) - at(cx.low, vy, vz)) * cx.inverse_width;
        let slope_y = (at(vx, cy.high, vz) - at(vx, cy.low, vz)) * cy.inverse_width;
        let slope_z = (at(vx, vy, cz.high) - at(vx, vy, cz.low)) * cz.inverse_width;
        let mut partials = x.partials;
        for p in 0..P {
            partials[p] =
                slope_x * x.partials[p] + slope_y * y.partials[p] + slope_z * z.partials[p];
        }
        Self {
            value: at(vx, vy, vz),
            partials,
        }
    }

    #[inline(always)]
    fn repeat_state<S: LoopState<Self>>(
        count: u32,
        state: S,
        mut body: impl FnMut(Self, S) -> (S, R::Mask),
    ) -> S {
        R::repeat_state(count, Parts::<S, P>(state), |i, Parts(state)| {
            let (next, go_on) = body(Self::constant(i), state);
            (Parts(next), go_on)
        })
        .0
    }
}

/// A loop's state of duals, seen as a state of their values and partials.
#[derive(Clone, Copy)]
struct Parts<S, const P: usize>(S);

impl<R: Real, const P: usize, S: LoopState<Dual<R, P>>> LoopState<R> for Parts<S, P> {
    #[inline(always)]
    fn select(mask: R::Mask, a: Self, b: Self) -> Self {
        Self(S::select(mask, a.0, b.0))
    }

    #[inline(always)]
    fn map(self, f: &mut impl FnMut(R) -> R) -> Self {
        Self(self.0.map(&mut |dual: Dual<R, P>| {
            let mut dual = dual;
            dual.value = f(dual.value);
            for p in &mut dual.partials {
                *p = f(*p);
            }
            dual
        }))
    }
}
