//! [`Number`], a [`Real`] through which a measured table can be read.

use gonio_num::Real;
use gonio_num::dual::Dual;
use gonio_num::expr::Expr;
use gonio_num::lanes::Lanes;

/// A [`Real`] with which models, tables included, can be evaluated.
pub trait Number: Real {
    /// Applies the opaque function `f` to numbers that are computed in double precision, lane by lane.
    ///
    /// For what arithmetic over [`Real`] can't express: searching and addressing a table in memory. Derivatives through it are
    /// central differences with step 1e-5.
    fn through<const K: usize, const M: usize>(
        x: [Self; K],
        f: &dyn Fn([f64; K]) -> [f64; M],
    ) -> [Self; M];
}

impl Number for f64 {
    #[inline]
    fn through<const K: usize, const M: usize>(
        x: [Self; K],
        f: &dyn Fn([f64; K]) -> [f64; M],
    ) -> [Self; M] {
        f(x)
    }
}

impl Number for f32 {
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

impl<const N: usize> Number for Lanes<N> {
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
    /// 0: an opaque function can't be recorded. [`crate::record`] refuses models that would call it.
    fn through<const K: usize, const M: usize>(
        _x: [Self; K],
        _f: &dyn Fn([f64; K]) -> [f64; M],
    ) -> [Self; M] {
        [Self::zero(); M]
    }
}
