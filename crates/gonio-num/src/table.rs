//! [`Table1`], [`Table2`] and [`Table3`], the tables that formulas look values up in.

// Loops over an index are what vectorises over lanes.
#![allow(clippy::needless_range_loop)]

use crate::{math, window::window};

/// A one-dimensional table, linearly interpolated by [`Real::table1`](crate::Real::table1).
#[derive(Debug, Clone, Copy)]
pub struct Table1 {
    /// Name in exported shader code: a valid identifier, unique in the program.
    pub name: &'static str,
    /// Samples at x = i / (n − 1), n ≥ 2.
    pub data: &'static [f32],
}

/// A two-dimensional table, bilinearly interpolated by [`Real::table2`](crate::Real::table2).
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

/// A three-dimensional table, trilinearly interpolated by [`Real::table3`](crate::Real::table3).
#[derive(Debug, Clone, Copy)]
pub struct Table3 {
    /// Name in exported shader code: a valid identifier, unique in the program.
    pub name: &'static str,
    /// Samples a row, along x; at least 2.
    pub width: usize,
    /// Rows a slice, along y; at least 2.
    pub height: usize,
    /// Slices, along z; at least 2.
    pub depth: usize,
    /// Samples, x fastest: `data[(k * height + j) * width + i]` stands at x = i / (width − 1), y = j / (height − 1), z = k /
    /// (depth − 1).
    pub data: &'static [f32],
}

/// The lower of the two samples around x in [0, 1] of a table of n, and the weight of the upper one: NaN for a NaN, so that it
/// stays visible.
macro_rules! bracket {
    ($name:ident, $t:ty) => {
        #[inline(always)]
        fn $name(n: usize, x: $t) -> (u32, $t) {
            let f = x.clamp(0.0, 1.0) * (n - 1) as $t;
            let i = (f as u32).min(n as u32 - 2);
            (i, f - i as $t)
        }
    };
}
bracket!(bracket_f32, f32);
bracket!(bracket_f64, f64);

/// The look-ups in one precision.
macro_rules! lookups {
    ($t:ty, $bracket:ident, $along:ident, $lookup1:ident, $lookup2:ident, $lookup3:ident) => {
        /// Linear between the numbers at `at` and `at` + 1.
        #[inline(always)]
        fn $along(data: &[f32], at: u32, t: $t) -> $t {
            let [a, b] = window(data, at);
            <$t>::from(a) * (1.0 - t) + <$t>::from(b) * t
        }

        #[inline(always)]
        pub(crate) fn $lookup1(t: &Table1, x: $t) -> $t {
            let (i, u) = $bracket(t.data.len(), x);
            $along(t.data, i, u)
        }

        #[inline(always)]
        pub(crate) fn $lookup2(t: &Table2, x: $t, y: $t) -> $t {
            let (i, u) = $bracket(t.width, x);
            let (j, v) = $bracket(t.height, y);
            let at = j * t.width as u32 + i;
            let low = $along(t.data, at, u);
            let high = $along(t.data, at + t.width as u32, u);
            low * (1.0 - v) + high * v
        }

        #[inline(always)]
        pub(crate) fn $lookup3(t: &Table3, x: $t, y: $t, z: $t) -> $t {
            let (i, u) = $bracket(t.width, x);
            let (j, v) = $bracket(t.height, y);
            let (k, w) = $bracket(t.depth, z);
            let (row, slice) = (t.width as u32, (t.width * t.height) as u32);
            let at = k * slice + j * row + i;
            let mut values = [0.0; 2];
            for s in 0..2 {
                let at = at + s as u32 * slice;
                let low = $along(t.data, at, u);
                let high = $along(t.data, at + row, u);
                values[s] = low * (1.0 - v) + high * v;
            }
            values[0] * (1.0 - w) + values[1] * w
        }
    };
}
lookups!(f32, bracket_f32, along_f32, lookup1, lookup2, lookup3);
lookups!(
    f64,
    bracket_f64,
    along_f64,
    lookup1_f64,
    lookup2_f64,
    lookup3_f64
);

/// Look-ups over lanes, to the bit those of `f32`. Each step is a loop of its own over the lanes, which is what vectorises.
pub(crate) mod over_lanes {
    use super::*;
    use crate::lanes::Lanes;

    #[inline(always)]
    fn bracket<const N: usize>(n: usize, x: Lanes<N>) -> ([u32; N], Lanes<N>) {
        let (mut at, mut t) = ([0; N], x);
        for i in 0..N {
            let f = x.0[i].clamp(0.0, 1.0) * (n - 1) as f32;
            // `f as u32`, in operations that vectorise: the sum with 2²³ has the whole part in its low bits. A NaN gives some
            // number, which doesn't matter beside its weight.
            let whole = (math::floor(f) + 8_388_608.0).to_bits() & 0x7f_ffff;
            at[i] = whole.min(n as u32 - 2);
            t.0[i] = f - at[i] as f32;
        }
        (at, t)
    }

    #[inline(always)]
    fn along<const N: usize>(data: &[f32], at: [u32; N], t: Lanes<N>) -> Lanes<N> {
        let (mut a, mut b) = (t, t);
        for i in 0..N {
            [a.0[i], b.0[i]] = window(data, at[i]);
        }
        a * (Lanes::splat(1.0) - t) + b * t
    }

    #[inline(always)]
    fn shifted<const N: usize>(at: [u32; N], by: usize) -> [u32; N] {
        let mut r = at;
        for i in 0..N {
            r[i] = at[i] + by as u32;
        }
        r
    }

    #[inline(always)]
    fn lerp<const N: usize>(t: Lanes<N>, a: Lanes<N>, b: Lanes<N>) -> Lanes<N> {
        a * (Lanes::splat(1.0) - t) + b * t
    }

    #[inline(always)]
    pub(crate) fn lookup1<const N: usize>(t: &Table1, x: Lanes<N>) -> Lanes<N> {
        let (at, u) = bracket(t.data.len(), x);
        along(t.data, at, u)
    }

    #[inline(always)]
    pub(crate) fn lookup2<const N: usize>(t: &Table2, x: Lanes<N>, y: Lanes<N>) -> Lanes<N> {
        let (i, u) = bracket(t.width, x);
        let (j, v) = bracket(t.height, y);
        let mut at = i;
        for lane in 0..N {
            at[lane] = j[lane] * t.width as u32 + i[lane];
        }
        let low = along(t.data, at, u);
        lerp(v, low, along(t.data, shifted(at, t.width), u))
    }

    #[inline(always)]
    pub(crate) fn lookup3<const N: usize>(
        t: &Table3,
        x: Lanes<N>,
        y: Lanes<N>,
        z: Lanes<N>,
    ) -> Lanes<N> {
        let (i, u) = bracket(t.width, x);
        let (j, v) = bracket(t.height, y);
        let (k, w) = bracket(t.depth, z);
        let slice = t.width * t.height;
        let mut at = i;
        for lane in 0..N {
            at[lane] = k[lane] * slice as u32 + j[lane] * t.width as u32 + i[lane];
        }
        let mut values = [x; 2];
        for s in 0..2 {
            let at = shifted(at, s * slice);
            let low = along(t.data, at, u);
            values[s] = lerp(v, low, along(t.data, shifted(at, t.width), u));
        }
        lerp(w, values[0], values[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    static RAMP: Table1 = Table1 {
        name: "ramp",
        data: &[1.0, 3.0, 2.0],
    };
    static PLANE: Table2 = Table2 {
        name: "plane",
        width: 3,
        height: 2,
        // x + 10 y, with x in 0..=2 and y in 0..=1
        data: &[0.0, 1.0, 2.0, 10.0, 11.0, 12.0],
    };

    #[test]
    fn tables_interpolate_and_clamp() {
        for (x, y) in [
            (-1.0, 1.0),
            (0.0, 1.0),
            (0.25, 2.0),
            (0.5, 3.0),
            (0.75, 2.5),
            (1.0, 2.0),
            (9.0, 2.0),
        ] {
            assert_eq!(lookup1(&RAMP, x as f32), y as f32);
            assert_eq!(lookup1_f64(&RAMP, x), y);
        }
        assert!(lookup1(&RAMP, f32::NAN).is_nan());
    }

    static BOX: Table3 = Table3 {
        name: "box",
        width: 2,
        height: 2,
        depth: 3,
        // x + 10 y + 100 z, with x and y in 0..=1 and z in 0..=2
        data: &[
            0.0, 1.0, 10.0, 11.0, 100.0, 101.0, 110.0, 111.0, 200.0, 201.0, 210.0, 211.0,
        ],
    };

    #[test]
    fn trilinear_tables_reproduce_linear_functions() {
        for i in 0..=8 {
            for j in 0..=8 {
                for k in 0..=8 {
                    let [x, y, z] = [i, j, k].map(|i| f64::from(i) / 8.0);
                    let truth = x + 10.0 * y + 200.0 * z;
                    assert!((lookup3_f64(&BOX, x, y, z) - truth).abs() < 1e-13);
                    let single = lookup3(&BOX, x as f32, y as f32, z as f32);
                    assert!((single - truth as f32).abs() < 1e-4);
                }
            }
        }
        assert_eq!(lookup3(&BOX, 5.0, -5.0, 9.0), 201.0);
        assert!(lookup3(&BOX, 0.5, 0.5, f32::NAN).is_nan());
    }

    #[test]
    fn bilinear_tables_reproduce_planes() {
        for i in 0..=8 {
            for j in 0..=8 {
                let (x, y) = (f64::from(i) / 8.0, f64::from(j) / 8.0);
                let plane = 2.0 * x + 10.0 * y;
                assert!((lookup2_f64(&PLANE, x, y) - plane).abs() < 1e-14);
                assert!((lookup2(&PLANE, x as f32, y as f32) - plane as f32).abs() < 1e-6);
            }
        }
        assert_eq!(lookup2(&PLANE, 5.0, -5.0), 2.0);
        assert!(lookup2_f64(&PLANE, 0.5, f64::NAN).is_nan());
    }
}
