//! The built-in functions.
//!
//! Where a shading language leaves a result undefined, it is what the defining formula gives in IEEE arithmetic: pow of a negative
//! number, acos beyond 1 and the root of a negative number are NaN, so that a check finds them.

use super::emit::{Kind, Slot, Value};
use super::{Compiler, Fault, convert, half, integer};
use crate::tape::{Binary, Compare, IntBinary, Logic, Reg, Unary};
use naga::{MathFunction as M, Span, TypeInner, VectorSize};
use std::f64::consts;
use std::rc::Rc;

fn real(reg: Reg) -> Slot {
    Slot {
        kind: Kind::Real,
        reg,
    }
}

fn uint(reg: Reg) -> Slot {
    Slot {
        kind: Kind::Uint,
        reg,
    }
}

/// Component `k`; a scalar is the same in all.
fn pick(value: &Value, k: usize) -> Slot {
    value[if value.len() == 1 { 0 } else { k }]
}

impl Compiler<'_> {
    /// A built-in function of arguments that are valid for it.
    pub(super) fn math(
        &mut self,
        fun: M,
        inner: &TypeInner,
        arguments: &[Value],
        span: Span,
    ) -> Result<Value, Fault> {
        let a = &arguments[0];
        let is_real = a[0].kind == Kind::Real;
        Ok(match fun {
            // Of vectors and matrices as a whole.
            M::Dot => {
                let b = &arguments[1];
                if is_real {
                    Rc::new([real(self.dot(a, b))])
                } else {
                    Rc::new([self.dot_int(a, b)])
                }
            }
            M::Outer => self.outer(a, &arguments[1]),
            M::Cross => self.cross(a, &arguments[1]),
            M::Distance => {
                let difference = self.zip(a, &arguments[1], Binary::Subtract);
                Rc::new([real(self.length(&difference))])
            }
            M::Length => Rc::new([real(self.length(a))]),
            M::Normalize => {
                let length = self.length(a);
                self.scaled(a, length, Binary::Divide)
            }
            M::FaceForward => {
                let cosine = self.dot(&arguments[1], &arguments[2]);
                let zero = self.e.lit(0.0);
                let facing = self.e.compare(Compare::Less, cosine, zero);
                self.each(a, |c, x| {
                    let turned = c.e.unary(Unary::Negate, x);
                    c.e.select_real(facing, x, turned)
                })
            }
            M::Reflect => self.reflect(a, &arguments[1]),
            M::Refract => self.refract(a, &arguments[1], arguments[2][0].reg),
            M::Transpose => self.transpose(inner, a),
            M::Determinant | M::Inverse => {
                let n = match a.len() {
                    4 => 2,
                    9 => 3,
                    _ => 4,
                };
                let numbers: Vec<Reg> = a.iter().map(|s| s.reg).collect();
                if fun == M::Determinant {
                    Rc::new([real(self.determinant(&numbers, n))])
                } else {
                    self.inverse(&numbers, n)
                }
            }
            M::Modf => {
                let whole = self.each(a, |c, x| c.trunc(x));
                let fraction = self.zip(a, &whole, Binary::Subtract);
                fraction.iter().chain(whole.iter()).copied().collect()
            }
            M::Frexp => {
                let exponents: Vec<Reg> = a
                    .iter()
                    .map(|s| self.e.int_of(convert::exponent, s.reg))
                    .collect();
                let mut both: Vec<Slot> = Vec::new();
                for (x, &exponent) in a.iter().zip(&exponents) {
                    let back = self.e.int_map(u32::wrapping_neg, exponent);
                    both.push(real(self.ldexp(x.reg, back)));
                }
                both.extend(exponents.into_iter().map(|reg| Slot {
                    kind: Kind::Sint,
                    reg,
                }));
                both.into()
            }
            // Packed numbers.
            M::Pack4x8snorm => self.pack(a, 8, |c, x| c.e.int_of(convert::snorm8, x)),
            M::Pack4x8unorm => self.pack(a, 8, |c, x| c.e.int_of(convert::unorm8, x)),
            M::Pack2x16snorm => self.pack(a, 16, |c, x| c.e.int_of(convert::snorm16, x)),
            M::Pack2x16unorm => self.pack(a, 16, |c, x| c.e.int_of(convert::unorm16, x)),
            M::Pack2x16float => self.pack(a, 16, |c, x| c.e.int_of(half::to_half, x)),
            M::Pack4xI8 | M::Pack4xU8 => self.pack(a, 8, |c, x| c.e.int_map(|i| i & 0xff, x)),
            M::Pack4xI8Clamp => self.pack(a, 8, |c, x| {
                let limited = c.e.int_map(integer::clamp_byte_signed, x);
                c.e.int_map(|i| i & 0xff, limited)
            }),
            M::Pack4xU8Clamp => self.pack(a, 8, |c, x| c.e.int_map(integer::clamp_byte, x)),
            M::Unpack4x8snorm => self.unpack(a, 8, convert::from_snorm8),
            M::Unpack4x8unorm => self.unpack(a, 8, convert::from_unorm8),
            M::Unpack2x16snorm => self.unpack(a, 16, convert::from_snorm16),
            M::Unpack2x16unorm => self.unpack(a, 16, convert::from_unorm16),
            M::Unpack2x16float => self.unpack(a, 16, |i| half::from_half(i & 0xffff)),
            M::Unpack4xI8 => self.bytes(a, integer::byte_signed, Kind::Sint),
            M::Unpack4xU8 => self.bytes(a, integer::byte, Kind::Uint),
            M::Dot4I8Packed => self.dot_bytes(a, &arguments[1], integer::byte_signed, Kind::Sint),
            M::Dot4U8Packed => self.dot_bytes(a, &arguments[1], integer::byte, Kind::Uint),
            // Component by component.
            _ => {
                let n = arguments.iter().map(|v| v.len()).max().unwrap_or(1);
                let mut all = Vec::with_capacity(n);
                for k in 0..n {
                    let x: Vec<Slot> = arguments.iter().map(|v| pick(v, k)).collect();
                    all.push(if fun == M::Ldexp {
                        real(self.ldexp(x[0].reg, x[1].reg))
                    } else if is_real {
                        let x: Vec<Reg> = x.iter().map(|s| s.reg).collect();
                        real(self.of_numbers(fun, &x, span)?)
                    } else {
                        self.of_integers(fun, &x, span)?
                    });
                }
                all.into()
            }
        })
    }

    fn each(&mut self, a: &Value, mut f: impl FnMut(&mut Self, Reg) -> Reg) -> Value {
        a.iter()
            .map(|s| Slot {
                reg: f(self, s.reg),
                ..*s
            })
            .collect()
    }

    fn zip(&mut self, a: &Value, b: &Value, f: Binary) -> Value {
        let n = a.len().max(b.len());
        (0..n)
            .map(|k| real(self.e.binary(f, pick(a, k).reg, pick(b, k).reg)))
            .collect()
    }

    fn scaled(&mut self, a: &Value, by: Reg, f: Binary) -> Value {
        self.each(a, |c, x| c.e.binary(f, x, by))
    }

    fn dot(&mut self, a: &Value, b: &Value) -> Reg {
        let registers = |v: &Value| v.iter().map(|s| s.reg).collect::<Vec<_>>();
        self.sum_of_products(&registers(a), &registers(b))
    }

    fn dot_int(&mut self, a: &Value, b: &Value) -> Slot {
        let mut sum: Option<Reg> = None;
        for (x, y) in a.iter().zip(b.iter()) {
            let product = self.e.int_binary(IntBinary::Multiply, x.reg, y.reg);
            sum = Some(match sum {
                None => product,
                Some(sum) => self.e.int_binary(IntBinary::Add, sum, product),
            });
        }
        Slot {
            reg: sum.unwrap_or(a[0].reg),
            ..a[0]
        }
    }

    fn length(&mut self, a: &Value) -> Reg {
        if a.len() == 1 {
            return self.e.unary(Unary::Abs, a[0].reg);
        }
        let square = self.dot(a, a);
        self.e.unary(Unary::Sqrt, square)
    }

    fn cross(&mut self, a: &Value, b: &Value) -> Value {
        [(1, 2), (2, 0), (0, 1)]
            .into_iter()
            .map(|(i, j)| {
                let left = self.e.mul(a[i].reg, b[j].reg);
                let right = self.e.mul(a[j].reg, b[i].reg);
                real(self.e.sub(left, right))
            })
            .collect()
    }

    /// I − 2 (N·I) N.
    fn reflect(&mut self, i: &Value, n: &Value) -> Value {
        let two = self.e.lit(2.0);
        let cosine = self.dot(n, i);
        let twice = self.e.mul(two, cosine);
        let along = self.scaled(n, twice, Binary::Multiply);
        self.zip(i, &along, Binary::Subtract)
    }

    /// η I − (η (N·I) + √k) N with k = 1 − η² (1 − (N·I)²); 0 where k < 0.
    fn refract(&mut self, i: &Value, n: &Value, eta: Reg) -> Value {
        let (zero, one) = (self.e.lit(0.0), self.e.lit(1.0));
        let cosine = self.dot(n, i);
        let square = self.e.mul(cosine, cosine);
        let sine2 = self.e.sub(one, square);
        let eta2 = self.e.mul(eta, eta);
        let refracted = self.e.mul(eta2, sine2);
        let k = self.e.sub(one, refracted);
        let guarded = self.e.binary(Binary::Max, k, zero);
        let root = self.e.unary(Unary::Sqrt, guarded);
        let along = self.e.mul_add(eta, cosine, root);
        let total = self.e.compare(Compare::Less, k, zero);
        i.iter()
            .zip(n.iter())
            .map(|(i, n)| {
                let scaled = self.e.mul(eta, i.reg);
                let bent = self.e.mul(along, n.reg);
                let t = self.e.sub(scaled, bent);
                real(self.e.select_real(total, zero, t))
            })
            .collect()
    }

    pub(super) fn trunc(&mut self, x: Reg) -> Reg {
        let zero = self.e.lit(0.0);
        let magnitude = self.e.unary(Unary::Abs, x);
        let whole = self.e.unary(Unary::Floor, magnitude);
        let opposite = self.e.unary(Unary::Negate, whole);
        let negative = self.e.compare(Compare::Less, x, zero);
        self.e.select_real(negative, opposite, whole)
    }

    /// To the nearest whole number, ties to even.
    fn round(&mut self, x: Reg) -> Reg {
        let (half, one) = (self.e.lit(0.5), self.e.lit(1.0));
        let below = self.e.unary(Unary::Floor, x);
        let rest = self.e.sub(x, below);
        let above = self.e.add(below, one);
        let halved = self.e.mul(below, half);
        let halved_whole = self.e.unary(Unary::Floor, halved);
        let even = self.e.compare(Compare::Equal, halved, halved_whole);
        let nearer = self.e.compare(Compare::Less, half, rest);
        let tie = self.e.compare(Compare::Equal, half, rest);
        let tie_up = self.e.logic(Logic::AndNot, tie, even);
        let up = self.e.logic(Logic::Or, nearer, tie_up);
        self.e.select_real(up, above, below)
    }

    /// x·2ⁱ, in two factors so that neither overflows before the product does.
    fn ldexp(&mut self, x: Reg, i: Reg) -> Reg {
        let first = self.e.real_of(convert::power_of_half, i);
        let second = self.e.real_of(convert::power_of_rest, i);
        let half = self.e.mul(x, first);
        self.e.mul(half, second)
    }

    /// Polynomial x·(1 + c₁x²·(1 + c₂x²)) near 0, `f` elsewhere: for functions whose formula cancels there.
    fn near_zero(&mut self, x: Reg, c1: f64, c2: f64, f: Reg) -> Reg {
        // At |x| = 0.02 the next term is below 1e-13 of the sum for each of these functions.
        let (bound, one) = (self.e.lit(0.02), self.e.lit(1.0));
        let (c1, c2) = (self.e.lit(c1), self.e.lit(c2));
        let square = self.e.mul(x, x);
        let inner = self.e.mul_add(square, c2, one);
        let scaled = self.e.mul(square, c1);
        let outer = self.e.mul_add(scaled, inner, one);
        let series = self.e.mul(x, outer);
        let magnitude = self.e.unary(Unary::Abs, x);
        let small = self.e.compare(Compare::Less, magnitude, bound);
        self.e.select_real(small, series, f)
    }

    /// |x| with the sign of `sign`.
    fn with_sign(&mut self, x: Reg, sign: Reg) -> Reg {
        let zero = self.e.lit(0.0);
        let opposite = self.e.unary(Unary::Negate, x);
        let negative = self.e.compare(Compare::Less, sign, zero);
        self.e.select_real(negative, opposite, x)
    }

    fn clamp(&mut self, x: Reg, low: Reg, high: Reg) -> Reg {
        let raised = self.e.binary(Binary::Max, x, low);
        self.e.binary(Binary::Min, raised, high)
    }

    /// acos x; NaN outside [−1, 1].
    fn acos(&mut self, x: Reg) -> Reg {
        let (one, nan) = (self.e.lit(1.0), self.e.lit(f64::NAN));
        let angle = self.e.unary(Unary::Acos, x);
        let magnitude = self.e.unary(Unary::Abs, x);
        let inside = self.e.compare(Compare::LessEqual, magnitude, one);
        self.e.select_real(inside, angle, nan)
    }

    /// A function of numbers, component by component.
    fn of_numbers(&mut self, fun: M, x: &[Reg], span: Span) -> Result<Reg, Fault> {
        let zero = self.e.lit(0.0);
        let one = self.e.lit(1.0);
        let a = x[0];
        Ok(match fun {
            M::Abs => self.e.unary(Unary::Abs, a),
            M::Min => self.e.binary(Binary::Min, a, x[1]),
            M::Max => self.e.binary(Binary::Max, a, x[1]),
            M::Clamp => self.clamp(a, x[1], x[2]),
            M::Saturate => self.clamp(a, zero, one),
            M::Sin => self.e.unary(Unary::Sin, a),
            M::Cos => self.e.unary(Unary::Cos, a),
            M::Tan => {
                let sin = self.e.unary(Unary::Sin, a);
                let cos = self.e.unary(Unary::Cos, a);
                self.e.div(sin, cos)
            }
            M::Acos => self.acos(a),
            M::Asin => {
                let right = self.e.lit(consts::FRAC_PI_2);
                let angle = self.acos(a);
                self.e.sub(right, angle)
            }
            M::Atan => self.e.binary(Binary::Atan2, a, one),
            M::Atan2 => self.e.binary(Binary::Atan2, a, x[1]),
            M::Sinh | M::Cosh => {
                let half = self.e.lit(0.5);
                let back = self.e.unary(Unary::Negate, a);
                let (up, down) = (self.e.unary(Unary::Exp, a), self.e.unary(Unary::Exp, back));
                if fun == M::Cosh {
                    let sum = self.e.add(up, down);
                    self.e.mul(half, sum)
                } else {
                    let difference = self.e.sub(up, down);
                    let sinh = self.e.mul(half, difference);
                    self.near_zero(a, 1.0 / 6.0, 1.0 / 20.0, sinh)
                }
            }
            M::Tanh => {
                // (1 − e^(−2|x|)) / (1 + e^(−2|x|)) does not overflow.
                let factor = self.e.lit(-2.0);
                let magnitude = self.e.unary(Unary::Abs, a);
                let exponent = self.e.mul(factor, magnitude);
                let power = self.e.unary(Unary::Exp, exponent);
                let above = self.e.sub(one, power);
                let below = self.e.add(one, power);
                let tanh = self.e.div(above, below);
                let tanh = self.with_sign(tanh, a);
                self.near_zero(a, -1.0 / 3.0, -2.0 / 5.0, tanh)
            }
            M::Asinh => {
                let magnitude = self.e.unary(Unary::Abs, a);
                let square = self.e.mul_add(a, a, one);
                let root = self.e.unary(Unary::Sqrt, square);
                let sum = self.e.add(magnitude, root);
                let ln = self.e.unary(Unary::Ln, sum);
                let asinh = self.with_sign(ln, a);
                self.near_zero(a, -1.0 / 6.0, -9.0 / 20.0, asinh)
            }
            M::Acosh => {
                let square = self.e.mul(a, a);
                let less = self.e.sub(square, one);
                let root = self.e.unary(Unary::Sqrt, less);
                let sum = self.e.add(a, root);
                self.e.unary(Unary::Ln, sum)
            }
            M::Atanh => {
                let half = self.e.lit(0.5);
                let (above, below) = (self.e.add(one, a), self.e.sub(one, a));
                let quotient = self.e.div(above, below);
                let ln = self.e.unary(Unary::Ln, quotient);
                let atanh = self.e.mul(half, ln);
                self.near_zero(a, 1.0 / 3.0, 3.0 / 5.0, atanh)
            }
            M::Radians => {
                let factor = self.e.lit(consts::PI / 180.0);
                self.e.mul(a, factor)
            }
            M::Degrees => {
                let factor = self.e.lit(180.0 / consts::PI);
                self.e.mul(a, factor)
            }
            M::Floor => self.e.unary(Unary::Floor, a),
            M::Ceil => {
                let opposite = self.e.unary(Unary::Negate, a);
                let floor = self.e.unary(Unary::Floor, opposite);
                self.e.unary(Unary::Negate, floor)
            }
            M::Round => self.round(a),
            M::Trunc => self.trunc(a),
            M::Fract => {
                let floor = self.e.unary(Unary::Floor, a);
                self.e.sub(a, floor)
            }
            M::Exp => self.e.unary(Unary::Exp, a),
            M::Exp2 => {
                let factor = self.e.lit(consts::LN_2);
                let exponent = self.e.mul(a, factor);
                self.e.unary(Unary::Exp, exponent)
            }
            M::Log => self.e.unary(Unary::Ln, a),
            M::Log2 => {
                let factor = self.e.lit(consts::LOG2_E);
                let ln = self.e.unary(Unary::Ln, a);
                self.e.mul(ln, factor)
            }
            M::Pow => {
                let ln = self.e.unary(Unary::Ln, a);
                let exponent = self.e.mul(x[1], ln);
                let power = self.e.unary(Unary::Exp, exponent);
                // The same value, of which a derivative would be 0·∞.
                let nothing = self.e.compare(Compare::Equal, a, zero);
                let positive = self.e.compare(Compare::Less, zero, x[1]);
                let both = self.e.logic(Logic::And, nothing, positive);
                self.e.select_real(both, zero, power)
            }
            M::Sign => {
                let minus = self.e.lit(-1.0);
                let positive = self.e.compare(Compare::Less, zero, a);
                let negative = self.e.compare(Compare::Less, a, zero);
                // 0 stays 0, NaN stays NaN.
                let rest = self.e.select_real(negative, minus, a);
                self.e.select_real(positive, one, rest)
            }
            M::Fma => self.e.mul_add(a, x[1], x[2]),
            M::Mix => {
                let rest = self.e.sub(one, x[2]);
                let first = self.e.mul(rest, a);
                self.e.mul_add(x[2], x[1], first)
            }
            M::Step => {
                let below = self.e.compare(Compare::Less, x[1], a);
                self.e.select_real(below, zero, one)
            }
            M::SmoothStep => {
                let (two, three) = (self.e.lit(2.0), self.e.lit(3.0));
                let above = self.e.sub(x[2], a);
                let width = self.e.sub(x[1], a);
                let quotient = self.e.div(above, width);
                let t = self.clamp(quotient, zero, one);
                let twice = self.e.mul(two, t);
                let rest = self.e.sub(three, twice);
                let square = self.e.mul(t, t);
                self.e.mul(square, rest)
            }
            M::Sqrt => self.e.unary(Unary::Sqrt, a),
            M::InverseSqrt => {
                let root = self.e.unary(Unary::Sqrt, a);
                self.e.div(one, root)
            }
            M::QuantizeToF16 => {
                let bits = self.e.int_of(half::to_half, a);
                self.e.real_of(half::from_half, bits)
            }
            _ => return Err(unsupported(fun, span)),
        })
    }

    /// A function of whole numbers, component by component.
    fn of_integers(&mut self, fun: M, x: &[Slot], span: Span) -> Result<Slot, Fault> {
        let a = x[0];
        let signed = a.kind == Kind::Sint;
        let min = if signed {
            integer::min_signed
        } else {
            u32::min
        };
        let max = if signed {
            integer::max_signed
        } else {
            u32::max
        };
        let reg = match fun {
            M::Abs if signed => self.e.int_map(integer::abs_signed, a.reg),
            M::Abs => a.reg,
            M::Sign if signed => self.e.int_map(integer::sign_signed, a.reg),
            M::Sign => self.e.int_map(|i| i.min(1), a.reg),
            M::Min => self.e.int_zip(min, a.reg, x[1].reg),
            M::Max => self.e.int_zip(max, a.reg, x[1].reg),
            M::Clamp => {
                let raised = self.e.int_zip(max, a.reg, x[1].reg);
                self.e.int_zip(min, raised, x[2].reg)
            }
            M::CountTrailingZeros => self.e.int_map(u32::trailing_zeros, a.reg),
            M::CountLeadingZeros => self.e.int_map(u32::leading_zeros, a.reg),
            M::CountOneBits => self.e.int_map(u32::count_ones, a.reg),
            M::ReverseBits => self.e.int_map(u32::reverse_bits, a.reg),
            M::FirstTrailingBit => self.e.int_map(integer::first_trailing_bit, a.reg),
            M::FirstLeadingBit if signed => {
                self.e.int_map(integer::first_leading_bit_signed, a.reg)
            }
            M::FirstLeadingBit => self.e.int_map(integer::first_leading_bit, a.reg),
            M::ExtractBits => {
                let field = self.e.int_zip(integer::field, x[1].reg, x[2].reg);
                let extract = if signed {
                    integer::extract_signed
                } else {
                    integer::extract
                };
                self.e.int_zip(extract, a.reg, field)
            }
            M::InsertBits => {
                let field = self.e.int_zip(integer::field, x[2].reg, x[3].reg);
                let mask = self.e.int_map(integer::mask, field);
                let moved = self.e.int_zip(integer::place, x[1].reg, field);
                let inside = self.e.int_zip(|i, m| i & m, moved, mask);
                let outside = self.e.int_zip(|i, m| i & !m, a.reg, mask);
                self.e.int_zip(|i, j| i | j, inside, outside)
            }
            _ => return Err(unsupported(fun, span)),
        };
        Ok(Slot { reg, ..a })
    }

    fn pack(&mut self, a: &Value, bits: u32, mut f: impl FnMut(&mut Self, Reg) -> Reg) -> Value {
        let mut sum: Option<Reg> = None;
        for (k, slot) in a.iter().enumerate() {
            let part = f(self, slot.reg);
            let shift = self.e.int(k as u32 * bits);
            let moved = self.e.int_zip(u32::wrapping_shl, part, shift);
            sum = Some(match sum {
                None => moved,
                Some(sum) => self.e.int_zip(|i, j| i | j, sum, moved),
            });
        }
        Rc::new([uint(sum.unwrap_or(a[0].reg))])
    }

    fn unpack(&mut self, a: &Value, bits: u32, f: fn(u32) -> f64) -> Value {
        (0..32 / bits)
            .map(|k| {
                let shift = self.e.int(k * bits);
                let part = self.e.int_zip(u32::wrapping_shr, a[0].reg, shift);
                real(self.e.real_of(f, part))
            })
            .collect()
    }

    fn bytes(&mut self, a: &Value, f: fn(u32, u32) -> u32, kind: Kind) -> Value {
        (0..VectorSize::Quad as u32)
            .map(|k| {
                let k = self.e.int(k);
                let reg = self.e.int_zip(f, a[0].reg, k);
                Slot { kind, reg }
            })
            .collect()
    }

    fn dot_bytes(&mut self, a: &Value, b: &Value, f: fn(u32, u32) -> u32, kind: Kind) -> Value {
        let (a, b) = (self.bytes(a, f, kind), self.bytes(b, f, kind));
        Rc::new([self.dot_int(&a, &b)])
    }
}

fn unsupported(fun: M, span: Span) -> Fault {
    Fault::new(
        span,
        format!("the built-in function {fun:?} of this argument is not supported"),
    )
}
