//! RGB9E5: three mantissas of 9 bits without a leading one, and the exponent that they share.
//!
//! A channel is m · 2^(e − 24): m in 0…511 from bit 0 (red), 9 (green) and 18 (blue), e in 0…31 from bit 27.
//! Source: the OpenGL extension EXT_texture_shared_exponent.

/// 511/512 · 2¹⁶.
pub(super) const LARGEST: f32 = 65_408.0;
/// The step of the smallest exponent, 2⁻²⁴.
pub(super) const SMALLEST: f32 = 1.0 / 16_777_216.0;

/// 2^n for −126 ≤ n ≤ 127.
fn power_of_two(n: i32) -> f32 {
    f32::from_bits(((n + 127) as u32) << 23)
}

pub(super) fn decode(code: u32) -> [f32; 3] {
    let step = power_of_two((code >> 27) as i32 - 24);
    let channel = |shift: u32| (code >> shift & 0x1ff) as f32 * step;
    [channel(0), channel(9), channel(18)]
}

/// The nearest code of three finite numbers ≥ 0; those above the largest become it.
pub(super) fn encode(rgb: [f32; 3]) -> u32 {
    let mut bounded = [0.0_f32; 3];
    for (to, from) in bounded.iter_mut().zip(rgb) {
        *to = from.clamp(0.0, LARGEST);
    }
    let high = bounded[0].max(bounded[1]).max(bounded[2]);
    // The exponent with 2^(e − 16) ≤ high < 2^(e − 15); numbers below 2⁻¹⁶ have e = 0.
    let binary = (high.to_bits() >> 23) as i32 - 127;
    let mut exponent = (binary + 16).clamp(0, 31);
    let mantissa = |c: f32, e: i32| (c * power_of_two(24 - e) + 0.5).floor() as u32;
    if mantissa(high, exponent) == 512 {
        exponent += 1;
    }
    let [r, g, b] = [bounded[0], bounded[1], bounded[2]];
    mantissa(r, exponent)
        | mantissa(g, exponent) << 9
        | mantissa(b, exponent) << 18
        | (exponent as u32) << 27
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_worked_out_by_hand() {
        // 1 = 256 · 2^(16 − 24).
        assert_eq!(encode([1.0, 0.0, 0.5]), 256 | 128 << 18 | 16 << 27);
        assert_eq!(decode(encode([1.0, 0.0, 0.5])), [1.0, 0.0, 0.5]);
        assert_eq!(encode([0.0; 3]), 0);
        assert_eq!(decode(encode([1e9, LARGEST, 0.0])), [LARGEST, LARGEST, 0.0]);
        assert_eq!(decode(u32::MAX), [LARGEST; 3]);
        // 511.6 rounds to 512, which takes the next exponent.
        assert_eq!(decode(encode([511.6, 0.0, 0.0])), [512.0, 0.0, 0.0]);
    }

    #[test]
    fn every_code_of_one_channel_is_its_own_nearest() {
        for e in 0..32_u32 {
            for m in 0..512 {
                let value = decode(m | e << 27);
                assert_eq!(decode(encode(value)), value, "{m} {e}");
            }
        }
    }
}
