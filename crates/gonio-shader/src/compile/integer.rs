//! Whole numbers of 32 bits: what WGSL defines for them, as functions of one lane. Arithmetic wraps.

use naga::BinaryOperator;

/// The comparison that an operator is, if it is one.
pub(super) fn test(op: BinaryOperator, signed: bool) -> Option<fn(u32, u32) -> bool> {
    use BinaryOperator as B;
    Some(match (op, signed) {
        (B::Equal, _) => |a, b| a == b,
        (B::NotEqual, _) => |a, b| a != b,
        (B::Less, true) => |a, b| (a as i32) < b as i32,
        (B::LessEqual, true) => |a, b| a as i32 <= b as i32,
        (B::Greater, true) => |a, b| a as i32 > b as i32,
        (B::GreaterEqual, true) => |a, b| a as i32 >= b as i32,
        (B::Less, false) => |a, b| a < b,
        (B::LessEqual, false) => |a, b| a <= b,
        (B::Greater, false) => |a, b| a > b,
        (B::GreaterEqual, false) => |a, b| a >= b,
        _ => return None,
    })
}

/// The function of two whole numbers that an operator is. x / 0 is x, x % 0 is 0; a shift counts modulo 32.
pub(super) fn operation(op: BinaryOperator, signed: bool) -> fn(u32, u32) -> u32 {
    use BinaryOperator as B;
    match (op, signed) {
        (B::Divide, true) => |a, b| match b as i32 {
            0 => a,
            b => (a as i32).wrapping_div(b) as u32,
        },
        (B::Divide, false) => |a, b| a.checked_div(b).unwrap_or(a),
        (B::Modulo, true) => |a, b| match b as i32 {
            0 => 0,
            b => (a as i32).wrapping_rem(b) as u32,
        },
        (B::Modulo, false) => |a, b| a.checked_rem(b).unwrap_or(0),
        (B::And, _) => |a, b| a & b,
        (B::InclusiveOr, _) => |a, b| a | b,
        (B::ExclusiveOr, _) => |a, b| a ^ b,
        (B::ShiftLeft, _) => |a, b| a.wrapping_shl(b),
        (B::ShiftRight, true) => |a, b| (a as i32).wrapping_shr(b) as u32,
        (B::ShiftRight, false) => |a, b| a.wrapping_shr(b),
        (B::Subtract, _) => u32::wrapping_sub,
        (B::Multiply, _) => u32::wrapping_mul,
        _ => u32::wrapping_add,
    }
}

/// The lowest bit that is set; −1 if none is.
pub(super) fn first_trailing_bit(x: u32) -> u32 {
    if x == 0 { u32::MAX } else { x.trailing_zeros() }
}

/// The highest bit that is set; −1 if none is.
pub(super) fn first_leading_bit(x: u32) -> u32 {
    if x == 0 {
        u32::MAX
    } else {
        31 - x.leading_zeros()
    }
}

/// The highest bit that differs from the sign; −1 if none does.
pub(super) fn first_leading_bit_signed(x: u32) -> u32 {
    first_leading_bit(if (x as i32) < 0 { !x } else { x })
}

pub(super) fn abs_signed(x: u32) -> u32 {
    (x as i32).wrapping_abs() as u32
}

pub(super) fn sign_signed(x: u32) -> u32 {
    (x as i32).signum() as u32
}

pub(super) fn min_signed(a: u32, b: u32) -> u32 {
    (a as i32).min(b as i32) as u32
}

pub(super) fn max_signed(a: u32, b: u32) -> u32 {
    (a as i32).max(b as i32) as u32
}

/// The number of bits to keep, at most what there is from `offset` on: packed with the offset for [`extract`] and [`mask`].
pub(super) fn field(offset: u32, count: u32) -> u32 {
    let offset = offset.min(32);
    let count = count.min(32 - offset);
    offset | count << 8
}

fn unpack(field: u32) -> (u32, u32) {
    (field & 0xff, field >> 8)
}

/// A field of bits, as an unsigned number.
pub(super) fn extract(x: u32, field: u32) -> u32 {
    let (offset, count) = unpack(field);
    if count == 0 {
        return 0;
    }
    (x << (32 - count - offset)) >> (32 - count)
}

/// A field of bits, as a signed number.
pub(super) fn extract_signed(x: u32, field: u32) -> u32 {
    let (offset, count) = unpack(field);
    if count == 0 {
        return 0;
    }
    ((x << (32 - count - offset)) as i32 >> (32 - count)) as u32
}

/// All bits of a field set.
pub(super) fn mask(field: u32) -> u32 {
    let (offset, count) = unpack(field);
    if count == 0 {
        return 0;
    }
    (u32::MAX >> (32 - count)) << offset
}

/// The bits of `x`, moved to where a field begins.
pub(super) fn place(x: u32, field: u32) -> u32 {
    x.checked_shl(unpack(field).0).unwrap_or(0)
}

/// Byte `k` as a signed number.
pub(super) fn byte_signed(x: u32, k: u32) -> u32 {
    (x >> (8 * k)) as u8 as i8 as i32 as u32
}

/// Byte `k` as an unsigned number.
pub(super) fn byte(x: u32, k: u32) -> u32 {
    u32::from((x >> (8 * k)) as u8)
}

/// Limited to what a signed byte holds.
pub(super) fn clamp_byte_signed(x: u32) -> u32 {
    (x as i32).clamp(-128, 127) as u32
}

/// Limited to what an unsigned byte holds.
pub(super) fn clamp_byte(x: u32) -> u32 {
    x.min(255)
}
