//! [`Emitter`], which appends operations to a tape and hands out registers.

use crate::tape::{Binary, Compare, File, IntBinary, Logic, Op, Reg, Tape, Unary};
use std::collections::HashMap;
use std::rc::Rc;

/// Operations, registers and constants of one tape: a bound on memory. A reflection function needs some hundreds.
pub(super) const LARGEST: usize = 1 << 18;

/// What a scalar is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Real,
    Sint,
    Uint,
    Bool,
}

impl Kind {
    pub fn file(self) -> File {
        match self {
            Self::Real => File::Real,
            Self::Sint | Self::Uint => File::Int,
            Self::Bool => File::Mask,
        }
    }
}

/// A scalar in its register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Slot {
    pub kind: Kind,
    pub reg: Reg,
}

/// A value of any type: its scalars, in order.
pub(super) type Value = Rc<[Slot]>;

/// Builds a tape.
#[derive(Debug, Default)]
pub(super) struct Emitter {
    pub ops: Vec<Op>,
    /// What runs before everything else: constants that depend on parameters.
    pub prologue: Vec<Op>,
    /// Whether operations go to the prologue.
    pub in_prologue: bool,
    pub tape: Tape,
    reals: HashMap<u64, Reg>,
    ints: HashMap<u32, Reg>,
    bools: HashMap<bool, Reg>,
    constant_reals: HashMap<Reg, f64>,
    constant_ints: HashMap<Reg, u32>,
    constant_bools: HashMap<Reg, bool>,
}

impl Emitter {
    pub fn push(&mut self, op: Op) {
        if self.in_prologue {
            self.prologue.push(op);
        } else {
            self.ops.push(op);
        }
    }

    /// Whether the tape has outgrown its bound.
    pub fn is_full(&self) -> bool {
        let registers = self.tape.reals + self.tape.ints + self.tape.masks;
        self.ops.len() + self.prologue.len() > LARGEST || registers > LARGEST
    }

    /// A register that nothing else uses.
    pub fn fresh(&mut self, file: File) -> Reg {
        let count = match file {
            File::Real => &mut self.tape.reals,
            File::Int => &mut self.tape.ints,
            File::Mask => &mut self.tape.masks,
        };
        *count += 1;
        (*count - 1) as Reg
    }

    pub fn fresh_slot(&mut self, kind: Kind) -> Slot {
        let reg = self.fresh(kind.file());
        Slot { kind, reg }
    }

    /// Registers for a value, those of each file one after another.
    pub fn fresh_value(&mut self, kinds: &[Kind]) -> Value {
        kinds.iter().map(|&kind| self.fresh_slot(kind)).collect()
    }

    // ---- constants

    pub fn lit(&mut self, x: f64) -> Reg {
        if let Some(&reg) = self.reals.get(&x.to_bits()) {
            return reg;
        }
        let reg = self.fresh_constant(x);
        self.reals.insert(x.to_bits(), reg);
        reg
    }

    fn fresh_constant(&mut self, x: f64) -> Reg {
        let reg = self.fresh(File::Real);
        self.tape.real_constants.push((reg, x));
        self.constant_reals.insert(reg, x);
        reg
    }

    pub fn int(&mut self, x: u32) -> Reg {
        if let Some(&reg) = self.ints.get(&x) {
            return reg;
        }
        let reg = self.fresh_int(x);
        self.ints.insert(x, reg);
        reg
    }

    fn fresh_int(&mut self, x: u32) -> Reg {
        let reg = self.fresh(File::Int);
        self.tape.int_constants.push((reg, x));
        self.constant_ints.insert(reg, x);
        reg
    }

    pub fn bool(&mut self, x: bool) -> Reg {
        if let Some(&reg) = self.bools.get(&x) {
            return reg;
        }
        let reg = self.fresh_bool(x);
        self.bools.insert(x, reg);
        reg
    }

    fn fresh_bool(&mut self, x: bool) -> Reg {
        let reg = self.fresh(File::Mask);
        self.tape.mask_constants.push((reg, x));
        self.constant_bools.insert(reg, x);
        reg
    }

    pub fn zero(&mut self, kind: Kind) -> Slot {
        let reg = match kind.file() {
            File::Real => self.lit(0.0),
            File::Int => self.int(0),
            File::Mask => self.bool(false),
        };
        Slot { kind, reg }
    }

    /// The number of a constant register.
    pub fn constant_real(&self, reg: Reg) -> Option<f64> {
        self.constant_reals.get(&reg).copied()
    }

    /// The whole number of a constant register.
    pub fn constant_int(&self, reg: Reg) -> Option<u32> {
        self.constant_ints.get(&reg).copied()
    }

    /// The truth of a constant register.
    pub fn constant_bool(&self, reg: Reg) -> Option<bool> {
        self.constant_bools.get(&reg).copied()
    }

    /// A constant with the value of another, in a register of its own; `None` if that one is no constant.
    pub fn constant_copy(&mut self, slot: Slot) -> Option<Slot> {
        let reg = match slot.kind.file() {
            File::Real => {
                let x = self.constant_real(slot.reg)?;
                self.fresh_constant(x)
            }
            File::Int => {
                let x = self.constant_int(slot.reg)?;
                self.fresh_int(x)
            }
            File::Mask => {
                let x = self.constant_bool(slot.reg)?;
                self.fresh_bool(x)
            }
        };
        Some(Slot { reg, ..slot })
    }

    // ---- numbers

    pub fn unary(&mut self, f: Unary, a: Reg) -> Reg {
        let d = self.fresh(File::Real);
        self.push(Op::Unary(f, d, a));
        d
    }

    pub fn binary(&mut self, f: Binary, a: Reg, b: Reg) -> Reg {
        let d = self.fresh(File::Real);
        self.push(Op::Binary(f, d, a, b));
        d
    }

    pub fn add(&mut self, a: Reg, b: Reg) -> Reg {
        self.binary(Binary::Add, a, b)
    }

    pub fn sub(&mut self, a: Reg, b: Reg) -> Reg {
        self.binary(Binary::Subtract, a, b)
    }

    pub fn mul(&mut self, a: Reg, b: Reg) -> Reg {
        self.binary(Binary::Multiply, a, b)
    }

    pub fn div(&mut self, a: Reg, b: Reg) -> Reg {
        self.binary(Binary::Divide, a, b)
    }

    /// a·b + c.
    pub fn mul_add(&mut self, a: Reg, b: Reg, c: Reg) -> Reg {
        let d = self.fresh(File::Real);
        self.push(Op::MultiplyAdd(d, a, b, c));
        d
    }

    pub fn compare(&mut self, f: Compare, a: Reg, b: Reg) -> Reg {
        let d = self.fresh(File::Mask);
        self.push(Op::Compare(f, d, a, b));
        d
    }

    /// `a` where the mask is true, `b` elsewhere.
    pub fn select(&mut self, mask: Reg, a: Slot, b: Slot) -> Slot {
        if a.reg == b.reg {
            return a;
        }
        let d = self.fresh_slot(a.kind);
        self.push(Op::Select(a.kind.file(), d.reg, mask, a.reg, b.reg));
        d
    }

    pub fn select_real(&mut self, mask: Reg, a: Reg, b: Reg) -> Reg {
        let slot = |reg| Slot {
            kind: Kind::Real,
            reg,
        };
        self.select(mask, slot(a), slot(b)).reg
    }

    // ---- masks

    pub fn logic(&mut self, f: Logic, a: Reg, b: Reg) -> Reg {
        let d = self.fresh(File::Mask);
        self.push(Op::Logic(f, d, a, b));
        d
    }

    pub fn not(&mut self, a: Reg) -> Reg {
        let d = self.fresh(File::Mask);
        self.push(Op::Not(d, a));
        d
    }

    // ---- whole numbers

    pub fn int_binary(&mut self, f: IntBinary, a: Reg, b: Reg) -> Reg {
        let d = self.fresh(File::Int);
        self.push(Op::IntBinary(f, d, a, b));
        d
    }

    pub fn int_map(&mut self, f: fn(u32) -> u32, a: Reg) -> Reg {
        let d = self.fresh(File::Int);
        self.push(Op::IntMap(f, d, a));
        d
    }

    pub fn int_zip(&mut self, f: fn(u32, u32) -> u32, a: Reg, b: Reg) -> Reg {
        let d = self.fresh(File::Int);
        self.push(Op::IntZip(f, d, a, b));
        d
    }

    pub fn int_test(&mut self, f: fn(u32, u32) -> bool, a: Reg, b: Reg) -> Reg {
        let d = self.fresh(File::Mask);
        self.push(Op::IntTest(f, d, a, b));
        d
    }

    pub fn int_of(&mut self, f: fn(f64) -> u32, a: Reg) -> Reg {
        let d = self.fresh(File::Int);
        self.push(Op::ToInt(f, d, a));
        d
    }

    pub fn real_of(&mut self, f: fn(u32) -> f64, a: Reg) -> Reg {
        let d = self.fresh(File::Real);
        self.push(Op::FromInt(f, d, a));
        d
    }

    // ---- copies

    /// Copies `from` into `to`, only where the mask is true if there is one.
    pub fn copy(&mut self, to: Slot, from: Slot, mask: Option<Reg>) {
        if to.reg == from.reg {
            return;
        }
        let file = to.kind.file();
        self.push(match mask {
            None => Op::Copy(file, to.reg, from.reg),
            Some(m) => Op::CopyWhere(file, to.reg, m, from.reg),
        });
    }

    /// The value in registers of its own, which may change without it.
    pub fn copied(&mut self, value: &[Slot]) -> Value {
        let kinds: Vec<Kind> = value.iter().map(|s| s.kind).collect();
        let own = self.fresh_value(&kinds);
        for (&to, &from) in own.iter().zip(value) {
            self.copy(to, from, None);
        }
        own
    }

    // ---- jumps

    /// A jump whose target is not known yet.
    pub fn jump_unless(&mut self, mask: Reg) -> usize {
        self.push(Op::JumpUnless { mask, to: 0 });
        self.ops.len() - 1
    }

    /// Makes the jumps go to the end of what has been written so far.
    pub fn land(&mut self, jumps: &[usize]) {
        let here = self.ops.len() as u32;
        for &jump in jumps {
            if let Op::JumpUnless { to, .. } = &mut self.ops[jump] {
                *to = here;
            }
        }
    }

    /// The finished tape: the prologue, then the rest.
    pub fn finish(mut self) -> Tape {
        let shift = self.prologue.len() as u32;
        for op in &mut self.ops {
            match op {
                Op::JumpUnless { to, .. } | Op::Loop { to, .. } => *to += shift,
                _ => {}
            }
        }
        self.prologue.append(&mut self.ops);
        self.tape.ops = self.prologue;
        self.tape
    }
}
