//! The sRGB transfer function, exact (IEC 61966-2-1:1999).
//!
//! linear = s / 12.92 for s ≤ 0.04045, ((s + 0.055) / 1.055)^2.4 above; and its inverse. Computed in `f64` with portable
//! functions: the same bits on every machine.

use gonio_num::Real;
use std::sync::OnceLock;

/// The linear value of the sRGB-encoded `s`; odd-symmetric below 0, unbounded above 1, NaN stays NaN.
pub fn decode(s: f64) -> f64 {
    let a = s.abs();
    // A NaN stays one on this branch; `Real::powf` would make it 0.
    let linear = if a.is_nan() || a <= 0.040_45 {
        a / 12.92
    } else {
        Real::powf((a + 0.055) / 1.055, 2.4)
    };
    if s < 0.0 { -linear } else { linear }
}

/// The sRGB encoding of the `linear` value; odd-symmetric below 0, unbounded above 1, NaN stays NaN.
pub fn encode(linear: f64) -> f64 {
    let a = linear.abs();
    let s = if a.is_nan() || a <= 0.003_130_8 {
        a * 12.92
    } else {
        1.055 * Real::powf(a, 1.0 / 2.4) - 0.055
    };
    if linear < 0.0 { -s } else { s }
}

/// The linear value of an 8-bit sRGB code, in [0, 1].
pub fn decode8(code: u8) -> f32 {
    static TABLE: OnceLock<[f32; 256]> = OnceLock::new();
    TABLE.get_or_init(|| std::array::from_fn(|i| decode(i as f64 / 255.0) as f32))[code as usize]
}

/// The linear value of a 16-bit sRGB code, in [0, 1].
pub fn decode16(code: u16) -> f32 {
    decode(f64::from(code) / 65535.0) as f32
}

/// The nearest 8-bit sRGB code. Clamps to [0, 1]; NaN gives 0.
pub fn encode8(linear: f32) -> u8 {
    // `as` clamps, and takes NaN to 0.
    (encode(f64::from(linear)) * 255.0 + 0.5) as u8
}

/// The nearest 16-bit sRGB code. Clamps to [0, 1]; NaN gives 0.
pub fn encode16(linear: f32) -> u16 {
    (encode(f64::from(linear)) * 65535.0 + 0.5) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_comes_back() {
        for code in 0..=255u8 {
            assert_eq!(encode8(decode8(code)), code);
        }
        for code in 0..=65535u16 {
            assert_eq!(encode16(decode16(code)), code);
        }
    }

    #[test]
    fn known_values() {
        // 0.5 encoded: ((0.5 + 0.055) / 1.055)^2.4 = 0.2140411404822325.
        assert!((decode(0.5) - 0.214_041_140_482_232_5).abs() < 1e-12);
        assert!((encode(0.18) - 0.461_356_129_500_441_6).abs() < 1e-12);
        assert_eq!(decode(0.0), 0.0);
        assert_eq!(decode(1.0), 1.0);
        assert!((encode(1.0) - 1.0).abs() < 1e-12);
        assert_eq!(encode(-0.001), -encode(0.001));
        assert!((encode(0.001) - 0.012_92).abs() < 1e-15);
    }

    #[test]
    fn out_of_range_is_clamped_only_in_codes() {
        assert_eq!(encode8(-1.0), 0);
        assert_eq!(encode8(7.0), 255);
        assert_eq!(encode8(f32::INFINITY), 255);
        assert_eq!(encode8(f32::NAN), 0);
        assert!(encode(2.0) > 1.3);
        assert!(encode(f64::NAN).is_nan() && decode(f64::NAN).is_nan());
    }
}
