//! Numbers of 16 bits (IEEE 754 binary16), which shaders pack into whole numbers.

/// The bits of the nearest 16-bit number, ties to even.
pub(super) fn to_half(x: f64) -> u32 {
    // Through f32, as a shader's number is one.
    let bits = (x as f32).to_bits();
    let sign = (bits >> 16) & 0x8000;
    let magnitude = bits & 0x7fff_ffff;
    if magnitude >= 0x7f80_0000 {
        let nan = magnitude > 0x7f80_0000;
        return sign | 0x7c00 | if nan { 0x0200 } else { 0 };
    }
    // From 65520 on the nearest is infinity.
    if magnitude >= 0x477f_f000 {
        return sign | 0x7c00;
    }
    let (mantissa, shift) = if magnitude >= 0x3880_0000 {
        // Normal: the exponent's bias goes from 127 to 15.
        (magnitude - 0x3800_0000, 13)
    } else {
        // Subnormal: a multiple of 2⁻²⁴.
        let exponent = magnitude >> 23;
        let shift = 126u32.saturating_sub(exponent);
        if shift > 31 {
            return sign;
        }
        ((magnitude & 0x007f_ffff) | 0x0080_0000, shift)
    };
    let kept = mantissa >> shift;
    let rest = mantissa & ((1 << shift) - 1);
    let tie = 1 << (shift - 1);
    let up = rest > tie || (rest == tie && kept & 1 == 1);
    sign | (kept + u32::from(up))
}

/// The number of 16 bits.
pub(super) fn from_half(bits: u32) -> f64 {
    let sign = if bits & 0x8000 != 0 { -1.0 } else { 1.0 };
    let exponent = (bits >> 10) & 0x1f;
    let mantissa = f64::from(bits & 0x3ff);
    sign * match exponent {
        0 => mantissa * 2f64.powi(-24),
        31 if mantissa == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        e => (1024.0 + mantissa) * 2f64.powi(e as i32 - 25),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each number of 16 bits is its own nearest one, and halfway between two the even one is nearest.
    #[test]
    fn every_half_comes_back() {
        for bits in 0..0x7c00u32 {
            let x = from_half(bits);
            assert_eq!(to_half(x), bits);
            assert_eq!(to_half(-x), bits | 0x8000);
            let next = from_half(bits + 1);
            if next.is_finite() {
                let even = if bits & 1 == 0 { bits } else { bits + 1 };
                assert_eq!(to_half(0.5 * (x + next)), even, "{bits:#x}");
            }
        }
        assert_eq!(to_half(f64::INFINITY), 0x7c00);
        assert_eq!(to_half(65520.0), 0x7c00);
        assert_eq!(to_half(65519.0), 0x7bff);
        assert!(from_half(to_half(f64::NAN)).is_nan());
        assert_eq!(to_half(1e-9), 0);
    }
}
