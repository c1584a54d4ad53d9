//! Tables of up to three dimensions that stay on one side of what they stand for.

/// Little-endian `f32`.
pub(crate) const fn bytes_to_numbers<const B: usize, const F: usize>(bytes: &[u8; B]) -> [f32; F] {
    assert!(B == 4 * F, "the file has another size than the tables");
    let mut out = [0.0; F];
    let mut at = 0;
    while at < F {
        let b = [
            bytes[4 * at],
            bytes[4 * at + 1],
            bytes[4 * at + 2],
            bytes[4 * at + 3],
        ];
        out[at] = f32::from_le_bytes(b);
        at += 1;
    }
    out
}

/// A function of the place in a table at half its steps: index 0 … 2(n − 1) along each side.
type Fine<'a> = &'a mut dyn FnMut([usize; 3]) -> f64;

/// The largest difference `sign`·(interpolated − true) at the middle of the edges, faces and insides of the cells around a node.
fn largest_excess(sides: [usize; 3], at: [usize; 3], sign: f64, fine: Fine) -> f64 {
    let mut excess: f64 = 0.0;
    for cell in 0..8usize {
        let bit = |n: usize, axis: usize| n >> axis & 1;
        // Cells beyond the border, and the second of an axis without extent, are left out.
        let low: [usize; 3] = std::array::from_fn(|a| at[a].wrapping_sub(bit(cell, a)));
        let real = (0..3).all(|a| {
            if sides[a] == 1 {
                bit(cell, a) == 0
            } else {
                low[a] < sides[a] - 1
            }
        });
        if !real {
            continue;
        }
        let mut corners = [0.0; 8];
        for (k, corner) in corners.iter_mut().enumerate() {
            let place =
                std::array::from_fn(|a| 2 * low[a] + if sides[a] == 1 { 0 } else { 2 * bit(k, a) });
            *corner = fine(place);
        }
        for middle in 0..27usize {
            let step = [middle % 3, middle / 3 % 3, middle / 9];
            let inside = (0..3).all(|a| sides[a] > 1 || step[a] == 0);
            if !inside || !step.contains(&1) {
                continue;
            }
            let mut between = 0.0;
            for (k, corner) in corners.iter().enumerate() {
                let mut weight = 1.0;
                for a in 0..3 {
                    let t = 0.5 * step[a] as f64;
                    weight *= if bit(k, a) == 1 { t } else { 1.0 - t };
                }
                between += weight * corner;
            }
            let truth = fine(std::array::from_fn(|a| 2 * low[a] + step[a]));
            excess = excess.max(sign * (between - truth));
        }
    }
    excess
}

fn coordinates(sides: [usize; 3], place: [usize; 3]) -> [f64; 3] {
    std::array::from_fn(|a| place[a] as f64 / (2 * sides[a].max(2) - 2) as f64)
}

/// Significant bits of an entry: a step of at most 3e-5 of it, about what the quadrature behind it errs by. Compressed, a table
/// then takes three fifths of the space.
const SIGNIFICANT: u32 = 16;

/// A number of at least 0, single precision, with its first [`SIGNIFICANT`] bits alone: rounded up or down.
fn shortened(value: f32, up: bool) -> f32 {
    let step = 1 << (f32::MANTISSA_DIGITS - SIGNIFICANT);
    // The bits of positive numbers are in the numbers' order, across powers of two as well.
    let bits = value.to_bits();
    f32::from_bits(if up {
        bits.next_multiple_of(step)
    } else {
        bits - bits % step
    })
}

/// The entry at a node such that linear interpolation, at the middle of the cells around it at least, is not below `f`.
pub(crate) fn entry_above(
    sides: [usize; 3],
    at: [usize; 3],
    f: &mut dyn FnMut(f64, f64, f64) -> f64,
) -> f32 {
    entry(sides, at, -1.0, &mut |place| {
        let [x, y, z] = coordinates(sides, place);
        f(x, y, z)
    })
}

/// The entry at a node such that linear interpolation, at the middle of the cells around it at least, is not above `f`.
pub(crate) fn entry_below(
    sides: [usize; 3],
    at: [usize; 3],
    f: &mut dyn FnMut(f64, f64, f64) -> f64,
) -> f32 {
    entry(sides, at, 1.0, &mut |place| {
        let [x, y, z] = coordinates(sides, place);
        f(x, y, z)
    })
}

fn entry(sides: [usize; 3], at: [usize; 3], sign: f64, fine: Fine) -> f32 {
    let excess = largest_excess(sides, at, sign, fine);
    let value = fine(at.map(|i| 2 * i)) - sign * excess;
    shortened(value.max(0.0) as f32, sign < 0.0)
}

/// All entries, x fastest: [`entry_above`] or [`entry_below`], with each value of `f` computed once, on all processors.
pub(crate) fn tabulate(
    sides: [usize; 3],
    above: bool,
    f: &(dyn Fn(f64, f64, f64) -> f64 + Sync),
) -> Vec<f32> {
    let fine_sides = sides.map(|n| 2 * n - 1);
    let [w, h, d] = fine_sides;
    let mut fine = vec![0.0; w * h * d];
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let rows = fine.chunks_mut(w).enumerate();
    let mut shares: Vec<Vec<(usize, &mut [f64])>> = (0..threads).map(|_| Vec::new()).collect();
    for (k, row) in rows {
        shares[k % threads].push((k, row));
    }
    std::thread::scope(|scope| {
        for share in shares {
            scope.spawn(move || {
                for (k, row) in share {
                    for (i, value) in row.iter_mut().enumerate() {
                        let [x, y, z] = coordinates(sides, [i, k % h, k / h]);
                        *value = f(x, y, z);
                    }
                }
            });
        }
    });
    let sign = if above { -1.0 } else { 1.0 };
    let mut out = Vec::with_capacity(sides.iter().product());
    for z in 0..sides[2] {
        for y in 0..sides[1] {
            for x in 0..sides[0] {
                out.push(entry(sides, [x, y, z], sign, &mut |[i, j, k]| {
                    fine[(k * h + j) * w + i]
                }));
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_num::Real;

    #[test]
    fn entries_are_short_and_stay_on_their_side() {
        for k in 0..1000u32 {
            // From 1e-6 to 1, no two with the same bits at the end.
            let value = Real::exp(-13.8 * f64::from(k) / 999.0) as f32;
            let (low, high) = (shortened(value, false), shortened(value, true));
            assert!(low <= value && value <= high, "{low} {value} {high}");
            assert!(high - low <= value * 2f32.powi(1 - SIGNIFICANT as i32));
            for short in [low, high] {
                assert_eq!(short.to_bits() % 256, 0, "{short} has more than 16 bits");
            }
        }
        assert_eq!([shortened(0.0, true), shortened(1.0, true)], [0.0, 1.0]);
    }

    /// A parabola is overshot by its chords by (step/2)² at the middle, and by no more in between.
    #[test]
    fn entries_stay_on_their_side() {
        let sides = [5, 1, 3];
        let f = |x: f64, _: f64, z: f64| 2.0 + x * x + 0.5 * z;
        let above = tabulate(sides, true, &f);
        let below = tabulate(sides, false, &f);
        for z in 0..3 {
            for x in 0..5 {
                let truth = f(x as f64 / 4.0, 0.0, z as f64 / 2.0);
                let k = z * 5 + x;
                assert_eq!(above[k], truth as f32);
                assert_eq!(below[k], (truth - 1.0 / 64.0) as f32);
                let mut f = f;
                assert_eq!(entry_below(sides, [x, 0, z], &mut f), below[k]);
                assert_eq!(entry_above(sides, [x, 0, z], &mut f), above[k]);
            }
        }
    }
}
