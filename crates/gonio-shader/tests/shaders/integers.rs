//! Whole numbers, bits and packing.

use super::{call, wgsl};

#[test]
fn signed_and_unsigned_arithmetic() {
    type Signed = fn(i32, i32) -> i32;
    let signed: &[(&str, Signed)] = &[
        ("a + b", i32::wrapping_add),
        ("a - b", i32::wrapping_sub),
        ("a * b", i32::wrapping_mul),
        ("a / b", |a, b| if b == 0 { a } else { a.wrapping_div(b) }),
        ("a % b", |a, b| if b == 0 { 0 } else { a.wrapping_rem(b) }),
        ("-a", |a, _| a.wrapping_neg()),
        ("~a", |a, _| !a),
        ("a & b", |a, b| a & b),
        ("a | b", |a, b| a | b),
        ("a ^ b", |a, b| a ^ b),
        ("a << (u32(b) & 7u)", |a, b| a << (b & 7)),
        ("a >> (u32(b) & 7u)", |a, b| a >> (b & 7)),
        ("abs(a)", |a, _| a.wrapping_abs()),
        ("sign(a)", |a, _| a.signum()),
        ("min(a, b)", i32::min),
        ("max(a, b)", i32::max),
        ("clamp(a, -2, 3)", |a, _| a.clamp(-2, 3)),
        ("select(0, 1, a < b)", |a, b| i32::from(a < b)),
        ("select(0, 1, a <= b)", |a, b| i32::from(a <= b)),
        ("select(0, 1, a > b)", |a, b| i32::from(a > b)),
        ("select(0, 1, a >= b)", |a, b| i32::from(a >= b)),
        ("select(0, 1, a == b)", |a, b| i32::from(a == b)),
        ("select(0, 1, a != b)", |a, b| i32::from(a != b)),
        ("firstLeadingBit(a)", |a, _| {
            31 - (if a < 0 { !a } else { a }).leading_zeros() as i32
        }),
        ("firstTrailingBit(a)", |a, _| {
            if a == 0 {
                -1
            } else {
                a.trailing_zeros() as i32
            }
        }),
        ("countOneBits(a)", |a, _| a.count_ones() as i32),
        ("countLeadingZeros(a)", |a, _| a.leading_zeros() as i32),
        ("countTrailingZeros(a)", |a, _| a.trailing_zeros() as i32),
        ("extractBits(a, 3u, 5u)", |a, _| (a << 24) >> 27),
        ("extractBits(a, 30u, 9u)", |a, _| a >> 30),
        ("insertBits(a, b, 4u, 3u)", |a, b| {
            (a & !0x70) | ((b & 7) << 4)
        }),
        ("dot(vec2i(a, b), vec2i(b, 2))", |a, b| {
            a.wrapping_mul(b).wrapping_add(b.wrapping_mul(2))
        }),
        ("i32(u32(a) / u32(b | 1))", |a, b| {
            (a as u32 / (b | 1) as u32) as i32
        }),
        ("i32(u32(a) % 7u)", |a, _| (a as u32 % 7) as i32),
        ("i32(u32(a) >> 3u)", |a, _| (a as u32 >> 3) as i32),
        ("i32(reverseBits(u32(a)))", |a, _| {
            (a as u32).reverse_bits() as i32
        }),
        ("select(0, 1, u32(a) < u32(b))", |a, b| {
            i32::from((a as u32) < b as u32)
        }),
        ("i32(bool(a)) + i32(true)", |a, _| i32::from(a != 0) + 1),
    ];
    let mut text = String::new();
    for (k, (expression, _)) in signed.iter().enumerate() {
        text += &format!(
            "fn t{k}(x: f32, y: f32) -> i32 {{ let a = i32(x); let b = i32(y); return {expression}; }}\n"
        );
    }
    let module = wgsl(&text);
    // Whole numbers that f64 passes exactly, the ends included.
    let values = [0, 1, -1, 2, 5, -7, 1000, -123_456, i32::MAX, i32::MIN];
    for (k, (expression, reference)) in signed.iter().enumerate() {
        let program = module.program(&format!("t{k}"), 0).unwrap();
        for a in values {
            for b in values {
                let mut found = [0.0];
                program
                    .run(&[], &[f64::from(a), f64::from(b)], &mut found)
                    .unwrap();
                assert_eq!(
                    found[0],
                    f64::from(reference(a, b)),
                    "{expression} of {a} and {b}"
                );
            }
        }
    }
}

#[test]
fn conversions_saturate_and_bits_are_those_of_f32() {
    let module = wgsl(
        "fn to_i(x: f32) -> i32 { return i32(x); }
         fn to_u(x: f32) -> u32 { return u32(x); }
         fn bits(x: f32) -> f32 { return f32(bitcast<u32>(x) >> 16u); }
         fn back(x: f32) -> f32 { return bitcast<f32>(bitcast<u32>(x) + 1u); }
         fn as_bool(x: f32) -> f32 { return f32(bool(x)); }",
    );
    let of = |name: &str, x: f64| call(&module, name, &[x])[0];
    assert_eq!(of("to_i", -1.9), -1.0);
    assert_eq!(of("to_i", 1e20), f64::from(i32::MAX));
    assert_eq!(of("to_i", f64::NAN), 0.0);
    assert_eq!(of("to_u", -5.0), 0.0);
    assert_eq!(of("to_u", 1e20), f64::from(u32::MAX));
    assert_eq!(of("bits", 1.0), f64::from(0x3f80));
    assert_eq!(of("back", 1.0), 1.0 + f64::from(f32::EPSILON));
    assert_eq!((of("as_bool", 0.0), of("as_bool", -0.5)), (0.0, 1.0));
}

/// What is packed and unpacked again differs by at most half a step.
#[test]
fn packing_comes_back() {
    let module = wgsl(
        "fn s8(v: vec4f) -> vec4f { return unpack4x8snorm(pack4x8snorm(v)); }
         fn u8(v: vec4f) -> vec4f { return unpack4x8unorm(pack4x8unorm(v)); }
         fn s16(v: vec4f) -> vec4f { return vec4f(unpack2x16snorm(pack2x16snorm(v.xy)), unpack2x16snorm(pack2x16snorm(v.zw))); }
         fn u16(v: vec4f) -> vec4f { return vec4f(unpack2x16unorm(pack2x16unorm(v.xy)), unpack2x16unorm(pack2x16unorm(v.zw))); }
         fn half(v: vec4f) -> vec4f { return vec4f(unpack2x16float(pack2x16float(v.xy)), unpack2x16float(pack2x16float(v.zw))); }
         fn bytes(v: vec4f) -> vec4f { return vec4f(unpack4xI8(pack4xI8(vec4i(v * 100.0)))); }",
    );
    let v = [0.3, -0.7, 1.0, -1.0];
    for (name, step) in [
        ("s8", 1.0 / 127.0),
        ("s16", 1.0 / 32767.0),
        ("half", 1.0 / 1024.0),
    ] {
        for (x, found) in v.iter().zip(call(&module, name, &v)) {
            assert!((x - found).abs() <= step / 2.0, "{name}: {x} {found}");
        }
    }
    let v = [0.3, 0.7, 1.0, 0.0];
    for (name, step) in [("u8", 1.0 / 255.0), ("u16", 1.0 / 65535.0)] {
        for (x, found) in v.iter().zip(call(&module, name, &v)) {
            assert!((x - found).abs() <= step / 2.0, "{name}: {x} {found}");
        }
    }
    assert_eq!(
        call(&module, "bytes", &[0.5, -0.5, 0.0, 1.0]),
        [50.0, -50.0, 0.0, 100.0]
    );
}
