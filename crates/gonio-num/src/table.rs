//! [`Table1`] and [`Table2`], the tables that formulas look values up in.

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
