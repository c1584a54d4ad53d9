//! The evaluator: runs a [`Tape`] over registers of any [`ShaderNumber`].

use crate::number::ShaderNumber;
use crate::tape::{Binary, Compare, File, IntBinary, Logic, Op, Reg, Tape, Unary};
use gonio_num::{Mask, Work};

/// The registers of one evaluation, `width` numbers each.
///
/// Constants are written once; what a tape writes before it reads needs no clearing between evaluations.
#[derive(Debug)]
pub(crate) struct Machine<R: ShaderNumber> {
    pub width: usize,
    reals: Vec<R>,
    ints: Vec<R::Int>,
    masks: Vec<R::Mask>,
}

/// A loop that went on for too long: its index in [`Tape::loops`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Endless(pub u32);

impl<R: ShaderNumber> Machine<R> {
    pub fn new(tape: &Tape, width: usize) -> Self {
        let mut machine = Self {
            width,
            reals: vec![R::zero(); tape.reals * width],
            ints: vec![R::int(0); tape.ints * width],
            masks: vec![R::Mask::splat(false); tape.masks * width],
        };
        for &(register, x) in &tape.real_constants {
            machine.reals[register as usize * width..][..width].fill(R::lit(x));
        }
        for &(register, x) in &tape.int_constants {
            machine.ints[register as usize * width..][..width].fill(R::int(x));
        }
        for &(register, x) in &tape.mask_constants {
            machine.masks[register as usize * width..][..width].fill(R::Mask::splat(x));
        }
        machine
    }

    /// The numbers of a register.
    pub fn real(&self, register: Reg) -> &[R] {
        &self.reals[register as usize * self.width..][..self.width]
    }

    /// The numbers of a register.
    pub fn real_mut(&mut self, register: Reg) -> &mut [R] {
        &mut self.reals[register as usize * self.width..][..self.width]
    }

    /// Runs the tape, going back at most as often as makes `steps` operations.
    pub fn run(&mut self, tape: &Tape, steps: u64) -> Result<(), Endless> {
        R::widest(Run {
            machine: self,
            tape,
            steps,
        })
    }
}

struct Run<'a, R: ShaderNumber> {
    machine: &'a mut Machine<R>,
    tape: &'a Tape,
    steps: u64,
}

/// Writes register `$d` of `$to`, number by number.
macro_rules! write {
    ($w:ident; $to:ident[$d:expr] = |$k:ident| $value:expr) => {{
        let d = $d as usize * $w;
        for $k in 0..$w {
            $to[d + $k] = $value;
        }
    }};
}

impl<R: ShaderNumber> Work for Run<'_, R> {
    type Output = Result<(), Endless>;

    // One function: so it is compiled as a whole for each instruction set.
    #[inline(always)]
    fn run(self) -> Result<(), Endless> {
        let w = self.machine.width;
        let reals = &mut self.machine.reals[..];
        let ints = &mut self.machine.ints[..];
        let masks = &mut self.machine.masks[..];
        let ops = &self.tape.ops[..];
        let mut steps = self.steps;
        let mut at = 0;
        macro_rules! unary {
            ($d:expr, $a:expr, |$x:ident| $value:expr) => {{
                let a = $a as usize * w;
                write!(w; reals[$d] = |k| { let $x = reals[a + k]; $value })
            }};
        }
        macro_rules! binary {
            ($from:ident, $to:ident, $d:expr, $a:expr, $b:expr, |$x:ident, $y:ident| $value:expr) => {{
                let (a, b) = ($a as usize * w, $b as usize * w);
                write!(w; $to[$d] = |k| { let ($x, $y) = ($from[a + k], $from[b + k]); $value })
            }};
        }
        while let Some(op) = ops.get(at) {
            at += 1;
            match *op {
                Op::Unary(f, d, a) => match f {
                    Unary::Negate => unary!(d, a, |x| -x),
                    Unary::Abs => unary!(d, a, |x| x.abs()),
                    Unary::Floor => unary!(d, a, |x| x.floor()),
                    Unary::Sqrt => unary!(d, a, |x| x.sqrt()),
                    Unary::Exp => unary!(d, a, |x| x.exp()),
                    Unary::Ln => unary!(d, a, |x| x.ln()),
                    Unary::Sin => unary!(d, a, |x| x.sin()),
                    Unary::Cos => unary!(d, a, |x| x.cos()),
                    Unary::Acos => unary!(d, a, |x| x.acos()),
                },
                Op::Binary(f, d, a, b) => match f {
                    Binary::Add => binary!(reals, reals, d, a, b, |x, y| x + y),
                    Binary::Subtract => binary!(reals, reals, d, a, b, |x, y| x - y),
                    Binary::Multiply => binary!(reals, reals, d, a, b, |x, y| x * y),
                    Binary::Divide => binary!(reals, reals, d, a, b, |x, y| x / y),
                    Binary::Min => binary!(reals, reals, d, a, b, |x, y| x.min(y)),
                    Binary::Max => binary!(reals, reals, d, a, b, |x, y| x.max(y)),
                    Binary::Atan2 => binary!(reals, reals, d, a, b, |x, y| x.atan2(y)),
                },
                Op::MultiplyAdd(d, a, b, c) => {
                    let c = c as usize * w;
                    let (a, b) = (a as usize * w, b as usize * w);
                    write!(w; reals[d] = |k| reals[a + k] * reals[b + k] + reals[c + k]);
                }
                Op::Compare(f, d, a, b) => match f {
                    Compare::Less => binary!(reals, masks, d, a, b, |x, y| x.lt(y)),
                    Compare::LessEqual => binary!(reals, masks, d, a, b, |x, y| x.le(y)),
                    Compare::Equal => {
                        binary!(reals, masks, d, a, b, |x, y| x.le(y) & y.le(x))
                    }
                },
                Op::Select(file, d, m, a, b) => {
                    let m = m as usize * w;
                    let (a, b) = (a as usize * w, b as usize * w);
                    match file {
                        File::Real => {
                            write!(w; reals[d] = |k| R::select(masks[m + k], reals[a + k], reals[b + k]))
                        }
                        File::Int => {
                            write!(w; ints[d] = |k| R::int_select(masks[m + k], ints[a + k], ints[b + k]))
                        }
                        File::Mask => {
                            write!(w; masks[d] = |k| (masks[m + k] & masks[a + k]) | (!masks[m + k] & masks[b + k]))
                        }
                    }
                }
                Op::Copy(file, d, a) => {
                    let (d, a) = (d as usize * w, a as usize * w);
                    match file {
                        File::Real => reals.copy_within(a..a + w, d),
                        File::Int => ints.copy_within(a..a + w, d),
                        File::Mask => masks.copy_within(a..a + w, d),
                    }
                }
                Op::CopyWhere(file, d, m, a) => {
                    let m = m as usize * w;
                    let a = a as usize * w;
                    let to = d as usize * w;
                    match file {
                        File::Real => {
                            write!(w; reals[d] = |k| R::select(masks[m + k], reals[a + k], reals[to + k]))
                        }
                        File::Int => {
                            write!(w; ints[d] = |k| R::int_select(masks[m + k], ints[a + k], ints[to + k]))
                        }
                        File::Mask => {
                            write!(w; masks[d] = |k| (masks[m + k] & masks[a + k]) | (!masks[m + k] & masks[to + k]))
                        }
                    }
                }
                Op::Logic(f, d, a, b) => match f {
                    Logic::And => binary!(masks, masks, d, a, b, |x, y| x & y),
                    Logic::Or => binary!(masks, masks, d, a, b, |x, y| x | y),
                    Logic::AndNot => binary!(masks, masks, d, a, b, |x, y| x & !y),
                    Logic::Equal => binary!(masks, masks, d, a, b, |x, y| (x & y) | !(x | y)),
                },
                Op::Not(d, a) => {
                    let a = a as usize * w;
                    write!(w; masks[d] = |k| !masks[a + k]);
                }
                Op::IntBinary(f, d, a, b) => match f {
                    IntBinary::Add => binary!(ints, ints, d, a, b, |x, y| R::int_zip(
                        x,
                        y,
                        u32::wrapping_add
                    )),
                    IntBinary::Subtract => binary!(ints, ints, d, a, b, |x, y| R::int_zip(
                        x,
                        y,
                        u32::wrapping_sub
                    )),
                    IntBinary::Multiply => binary!(ints, ints, d, a, b, |x, y| R::int_zip(
                        x,
                        y,
                        u32::wrapping_mul
                    )),
                },
                Op::IntMap(f, d, a) => {
                    let a = a as usize * w;
                    write!(w; ints[d] = |k| R::int_map(ints[a + k], f));
                }
                Op::IntZip(f, d, a, b) => {
                    binary!(ints, ints, d, a, b, |x, y| R::int_zip(x, y, f))
                }
                Op::IntTest(f, d, a, b) => {
                    binary!(ints, masks, d, a, b, |x, y| R::int_test(x, y, f))
                }
                Op::ToInt(f, d, a) => {
                    let a = a as usize * w;
                    write!(w; ints[d] = |k| reals[a + k].to_int(f));
                }
                Op::FromInt(f, d, a) => {
                    let a = a as usize * w;
                    write!(w; reals[d] = |k| R::from_int(ints[a + k], f));
                }
                Op::Gather(file, d, base, offset, last) => {
                    for k in 0..w {
                        let index = ints[offset as usize * w + k];
                        for lane in 0..R::LANES {
                            let found = R::lane(index, lane).min(last);
                            if lane > 0 && found == R::lane(index, lane - 1).min(last) {
                                continue;
                            }
                            let from = (base + found) as usize * w + k;
                            let to = d as usize * w + k;
                            let here = R::int_test(index, R::int(found), |i, j| i.min(last) == j);
                            let here = if lane == 0 {
                                R::Mask::splat(true)
                            } else {
                                here
                            };
                            match file {
                                File::Real => reals[to] = R::select(here, reals[from], reals[to]),
                                File::Int => ints[to] = R::int_select(here, ints[from], ints[to]),
                                File::Mask => {
                                    masks[to] = (here & masks[from]) | (!here & masks[to]);
                                }
                            }
                        }
                    }
                }
                Op::Scatter(file, base, offset, a, m, last) => {
                    for k in 0..w {
                        let index = ints[offset as usize * w + k];
                        let active = masks[m as usize * w + k];
                        let from = a as usize * w + k;
                        for lane in 0..R::LANES {
                            let found = R::lane(index, lane).min(last);
                            if lane > 0 && found == R::lane(index, lane - 1).min(last) {
                                continue;
                            }
                            let to = (base + found) as usize * w + k;
                            let here =
                                active & R::int_test(index, R::int(found), |i, j| i.min(last) == j);
                            match file {
                                File::Real => reals[to] = R::select(here, reals[from], reals[to]),
                                File::Int => ints[to] = R::int_select(here, ints[from], ints[to]),
                                File::Mask => {
                                    masks[to] = (here & masks[from]) | (!here & masks[to]);
                                }
                            }
                        }
                    }
                }
                Op::JumpUnless { mask, to } => {
                    let m = mask as usize * w;
                    if !masks[m..m + w].iter().any(|&m| R::any(m)) {
                        at = to as usize;
                    }
                }
                Op::Loop { mask, to, source } => {
                    let m = mask as usize * w;
                    if masks[m..m + w].iter().any(|&m| R::any(m)) {
                        let to = to as usize;
                        let length = (at - to) as u64;
                        if steps < length {
                            return Err(Endless(source));
                        }
                        steps -= length;
                        at = to;
                    }
                }
            }
        }
        Ok(())
    }
}
