//! Conversions between numbers, whole numbers and patterns of bits, as functions of one lane.

/// Towards zero, saturating; 0 for NaN.
pub(super) fn to_sint(x: f64) -> u32 {
    x as i32 as u32
}

/// Towards zero, saturating; 0 for NaN.
pub(super) fn to_uint(x: f64) -> u32 {
    x as u32
}

pub(super) fn from_sint(i: u32) -> f64 {
    f64::from(i as i32)
}

pub(super) fn from_uint(i: u32) -> f64 {
    f64::from(i)
}

/// The bits of the nearest `f32`.
pub(super) fn to_bits(x: f64) -> u32 {
    (x as f32).to_bits()
}

pub(super) fn from_bits(bits: u32) -> f64 {
    f64::from(f32::from_bits(bits))
}

/// The exponent e of x = m·2ᵉ with |m| in [0.5, 1); 0 for 0 and for what is not finite.
pub(super) fn exponent(x: f64) -> u32 {
    if x == 0.0 || !x.is_finite() {
        return 0;
    }
    // Subnormal numbers are brought into the normal range first.
    let (x, shift) = if x.abs() < f64::MIN_POSITIVE {
        (x * 2f64.powi(64), 64)
    } else {
        (x, 0)
    };
    let biased = (x.to_bits() >> 52) & 0x7ff;
    (biased as i32 - 1022 - shift) as u32
}

/// 2 to the power of half of i, rounded down.
pub(super) fn power_of_half(i: u32) -> f64 {
    2f64.powi((i as i32).clamp(-300, 300) >> 1)
}

/// 2 to the power of what [`power_of_half`] leaves over.
pub(super) fn power_of_rest(i: u32) -> f64 {
    let i = (i as i32).clamp(-300, 300);
    2f64.powi(i - (i >> 1))
}

/// [−1, 1] to 8 bits.
pub(super) fn snorm8(x: f64) -> u32 {
    ((0.5 + 127.0 * x.clamp(-1.0, 1.0)).floor() as i32 as u32) & 0xff
}

/// [0, 1] to 8 bits.
pub(super) fn unorm8(x: f64) -> u32 {
    (0.5 + 255.0 * x.clamp(0.0, 1.0)).floor() as u32
}

/// [−1, 1] to 16 bits.
pub(super) fn snorm16(x: f64) -> u32 {
    ((0.5 + 32767.0 * x.clamp(-1.0, 1.0)).floor() as i32 as u32) & 0xffff
}

/// [0, 1] to 16 bits.
pub(super) fn unorm16(x: f64) -> u32 {
    (0.5 + 65535.0 * x.clamp(0.0, 1.0)).floor() as u32
}

/// The low 8 bits as a number in [−1, 1].
pub(super) fn from_snorm8(i: u32) -> f64 {
    (f64::from(i as u8 as i8) / 127.0).max(-1.0)
}

/// The low 8 bits as a number in [0, 1].
pub(super) fn from_unorm8(i: u32) -> f64 {
    f64::from(i as u8) / 255.0
}

/// The low 16 bits as a number in [−1, 1].
pub(super) fn from_snorm16(i: u32) -> f64 {
    (f64::from(i as u16 as i16) / 32767.0).max(-1.0)
}

/// The low 16 bits as a number in [0, 1].
pub(super) fn from_unorm16(i: u32) -> f64 {
    f64::from(i as u16) / 65535.0
}
