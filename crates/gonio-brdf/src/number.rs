//! [`Number`], a [`Real`] through which a measured table can be read.

use gonio_num::Real;

/// A [`Real`] with which models, tables included, can be evaluated.
pub trait Number: Real {
    /// Applies the opaque function `f` to numbers that are computed in double precision, lane by lane.
    ///
    /// For what arithmetic over [`Real`] can't express: searching and addressing a table in memory.
    fn through<const K: usize, const M: usize>(
        x: [Self; K],
        f: impl Fn([f64; K]) -> [f64; M],
    ) -> [Self; M];
}

impl Number for f64 {
    #[inline]
    fn through<const K: usize, const M: usize>(
        x: [Self; K],
        f: impl Fn([f64; K]) -> [f64; M],
    ) -> [Self; M] {
        f(x)
    }
}

impl Number for f32 {
    #[inline]
    fn through<const K: usize, const M: usize>(
        x: [Self; K],
        f: impl Fn([f64; K]) -> [f64; M],
    ) -> [Self; M] {
        let mut input = [0.0; K];
        for (a, b) in input.iter_mut().zip(x) {
            *a = f64::from(b);
        }
        let output = f(input);
        let mut y = [0.0; M];
        for (a, b) in y.iter_mut().zip(output) {
            *a = b as f32;
        }
        y
    }
}
