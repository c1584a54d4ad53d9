//! Variables, and places in them.

use super::emit::{Emitter, Slot, Value};
use crate::tape::{IntBinary, Op, Reg};
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

/// A variable.
#[derive(Debug)]
pub(super) struct Var {
    /// Its registers, those of each file one after another.
    pub slots: Value,
    /// The region of the function that it belongs to: the branches inside it mask what is written.
    pub region: usize,
    /// Whether one whole value is written at most, in the function's outermost block: then it needs no registers.
    pub simple: bool,
    /// Whether it is written once, and has been: what is read of it needs no copy.
    pub settled: bool,
    /// Whether it is written once.
    pub once: bool,
    /// What it holds, of a simple one.
    pub bound: Option<Value>,
}

/// An index that is known at run time only.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dimension {
    /// The whole number's register.
    pub index: Reg,
    /// Scalars from one element to the next.
    pub stride: usize,
    /// Number of elements.
    pub count: u32,
}

/// Part of a variable: what a pointer points to.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub var: Rc<RefCell<Var>>,
    pub offset: usize,
    pub len: usize,
    pub dimensions: Vec<Dimension>,
}

impl Place {
    /// The whole variable.
    pub fn whole(var: Rc<RefCell<Var>>) -> Self {
        let len = var.borrow().slots.len();
        Self {
            var,
            offset: 0,
            len,
            dimensions: Vec::new(),
        }
    }

    /// The part from scalar `offset` on, `len` scalars long.
    pub fn part(&self, offset: usize, len: usize) -> Self {
        Self {
            offset: self.offset + offset,
            len,
            ..self.clone()
        }
    }

    /// The element at an index of a register.
    pub fn element(&self, e: &Emitter, index: Reg, count: u32, stride: usize) -> Self {
        if let Some(i) = e.constant_int(index) {
            return self.part(i.min(count - 1) as usize * stride, stride);
        }
        let mut place = self.part(0, stride);
        place.dimensions.push(Dimension {
            index,
            stride,
            count,
        });
        place
    }
}

/// Where the scalars at indices of registers are found: the first register, the offset from it, and the largest such offset.
fn address(
    e: &mut Emitter,
    slots: &[Slot],
    at: usize,
    dimensions: &[Dimension],
    known: &mut HashMap<Vec<u32>, (Reg, u32)>,
) -> (Reg, Reg, u32) {
    let first = slots[at].reg;
    let strides: Vec<u32> = dimensions
        .iter()
        .map(|d| match d.count {
            1 => 0,
            _ => slots[at + d.stride].reg - first,
        })
        .collect();
    if let Some(&(offset, last)) = known.get(&strides) {
        return (first, offset, last);
    }
    let (mut offset, mut last) = (None, 0);
    for (d, &stride) in dimensions.iter().zip(&strides) {
        let end = e.int(d.count - 1);
        let index = e.int_zip(u32::min, d.index, end);
        let step = e.int(stride);
        let scaled = e.int_binary(IntBinary::Multiply, index, step);
        offset = Some(match offset {
            None => scaled,
            Some(sum) => e.int_binary(IntBinary::Add, sum, scaled),
        });
        last += (d.count - 1) * stride;
    }
    let offset = offset.unwrap_or_else(|| e.int(0));
    known.insert(strides, (offset, last));
    (first, offset, last)
}

/// What is at a place whose indices are in registers.
pub(super) fn gather(
    e: &mut Emitter,
    slots: &[Slot],
    offset: usize,
    len: usize,
    dimensions: &[Dimension],
) -> Value {
    let mut known = HashMap::new();
    let mut found = Vec::with_capacity(len);
    for at in offset..offset + len {
        let (first, index, last) = address(e, slots, at, dimensions, &mut known);
        let d = e.fresh_slot(slots[at].kind);
        let file = d.kind.file();
        e.push(Op::Gather(file, d.reg, first, index, last));
        found.push(d);
    }
    found.into()
}

/// Writes a value to a place whose indices are in registers, where the mask is true.
pub(super) fn scatter(
    e: &mut Emitter,
    slots: &[Slot],
    offset: usize,
    dimensions: &[Dimension],
    value: &[Slot],
    mask: Reg,
) {
    let mut known = HashMap::new();
    for (k, from) in value.iter().enumerate() {
        let (first, index, last) = address(e, slots, offset + k, dimensions, &mut known);
        let file = from.kind.file();
        e.push(Op::Scatter(file, first, index, from.reg, mask, last));
    }
}

/// The value with the registers of each file one after another, as indexing needs it.
pub(super) fn contiguous(e: &mut Emitter, value: &Value) -> Value {
    let mut next: HashMap<_, Reg> = HashMap::new();
    let in_order = value.iter().all(|slot| {
        let expected = next.insert(slot.kind.file(), slot.reg + 1);
        expected.is_none_or(|reg| reg == slot.reg)
    });
    if in_order {
        return Rc::clone(value);
    }
    let constant =
        |slot: &Slot| e.constant_real(slot.reg).is_some() && slot.kind == super::emit::Kind::Real;
    if value.iter().all(constant) {
        let copies: Option<Vec<Slot>> = value.iter().map(|&s| e.constant_copy(s)).collect();
        if let Some(copies) = copies {
            return copies.into();
        }
    }
    e.copied(value)
}
