//! The stack of masks: which lanes are where.

use super::emit::Emitter;
use super::place::Var;
use crate::tape::{File, Logic, Op, Reg};
use naga::{Block, Expression, Function, GlobalVariable, Handle, Module, Statement};

/// What a region of code is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RegionKind {
    /// A function's body; `return` leaves it.
    Function,
    /// A branch.
    Branch,
    /// A case of a switch; `break` leaves it.
    Case,
    /// A loop: the lanes that will go round again.
    Loop,
    /// A loop's body: the lanes that are in it; `continue` leaves it.
    Body,
}

/// A region of code whose lanes are those of its mask.
#[derive(Debug)]
pub(super) struct Region {
    pub kind: RegionKind,
    /// `None`: the lanes of the region around it.
    pub mask: Option<Reg>,
    /// Whether lanes have left since it was last looked at.
    pub left: bool,
    /// Jumps to its end.
    pub exits: Vec<usize>,
}

impl Region {
    pub fn new(kind: RegionKind, mask: Option<Reg>) -> Self {
        Self {
            kind,
            mask,
            left: false,
            exits: Vec::new(),
        }
    }

    /// Where all lanes are.
    pub fn root() -> Self {
        Self::new(RegionKind::Function, None)
    }
}

/// The mask of the lanes that are in the innermost region; `None`: all.
pub(super) fn active(regions: &[Region]) -> Option<Reg> {
    regions.iter().rev().find_map(|r| r.mask)
}

/// The mask that a write to the variable needs: `None` if no lane that still reads it is elsewhere.
pub(super) fn mask_for(regions: &[Region], var: &Var) -> Option<Reg> {
    let inside = &regions[var.region + 1..];
    if inside.iter().any(|r| r.mask.is_some()) {
        active(regions)
    } else {
        None
    }
}

/// Takes the lanes of the innermost region out of all regions down to number `outermost`.
pub(super) fn leave(e: &mut Emitter, regions: &mut [Region], outermost: usize) {
    let Some(current) = active(regions) else {
        return;
    };
    for region in &mut regions[outermost..] {
        let Some(mask) = region.mask.filter(|&m| m != current) else {
            continue;
        };
        region.left = true;
        e.push(Op::Logic(Logic::AndNot, mask, mask, current));
    }
    let own = regions[outermost..].iter().any(|r| r.mask == Some(current));
    if own {
        let nowhere = e.bool(false);
        e.push(Op::Copy(File::Mask, current, nowhere));
    }
    if let Some(region) = regions[outermost..]
        .iter_mut()
        .find(|r| r.mask == Some(current))
    {
        region.left = true;
    }
}

/// How a function writes its variables.
#[derive(Debug, Default)]
pub(super) struct Stores {
    /// Writes of each variable; one that is of a part or through a pointer counts twice.
    pub count: Vec<usize>,
    /// Whether each is written in a branch or loop.
    pub nested: Vec<bool>,
    /// Whether the function returns before its end.
    pub early: bool,
}

impl Stores {
    pub fn of(function: &Function) -> Self {
        let n = function.local_variables.len();
        let mut stores = Self {
            count: vec![0; n],
            nested: vec![false; n],
            early: false,
        };
        stores.block(function, &function.body, false, true);
        stores
    }

    fn write(&mut self, function: &Function, pointer: Handle<Expression>, nested: bool) {
        let whole = matches!(function.expressions[pointer], Expression::LocalVariable(_));
        if let Some(Expression::LocalVariable(handle)) = root(function, pointer) {
            self.count[handle.index()] += if whole { 1 } else { 2 };
            self.nested[handle.index()] |= nested;
        }
    }

    fn block(&mut self, function: &Function, block: &Block, nested: bool, last: bool) {
        for (k, statement) in block.iter().enumerate() {
            let last = last && k + 1 == block.len();
            match statement {
                Statement::Block(inner) => self.block(function, inner, nested, last),
                Statement::If { accept, reject, .. } => {
                    self.block(function, accept, true, false);
                    self.block(function, reject, true, false);
                }
                Statement::Switch { cases, .. } => {
                    for case in cases {
                        self.block(function, &case.body, true, false);
                    }
                }
                Statement::Loop {
                    body, continuing, ..
                } => {
                    self.block(function, body, true, false);
                    self.block(function, continuing, true, false);
                }
                Statement::Return { .. } => self.early |= nested || !last,
                Statement::Store { pointer, .. } => self.write(function, *pointer, nested),
                Statement::Call { arguments, .. } => {
                    for &argument in arguments {
                        // A pointer that is passed on may be written through, as often as the function likes.
                        if let Some(Expression::LocalVariable(handle)) = root(function, argument)
                            && !is_load(function, argument)
                        {
                            self.count[handle.index()] += 2;
                        }
                    }
                }
                _ => {}
            }
        }
    }
}

fn is_load(function: &Function, handle: Handle<Expression>) -> bool {
    matches!(function.expressions[handle], Expression::Load { .. })
}

/// The variable that a pointer points into.
fn root(function: &Function, mut pointer: Handle<Expression>) -> Option<Expression> {
    loop {
        match &function.expressions[pointer] {
            Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => {
                pointer = *base;
            }
            found @ (Expression::LocalVariable(_) | Expression::GlobalVariable(_)) => {
                return Some(found.clone());
            }
            _ => return None,
        }
    }
}

/// Whether any function may write the global variable.
pub(super) fn is_written(module: &Module, handle: Handle<GlobalVariable>) -> bool {
    module
        .functions
        .iter()
        .any(|(_, f)| writes(f, &f.body, handle))
}

fn writes(function: &Function, block: &Block, global: Handle<GlobalVariable>) -> bool {
    let is = |pointer| matches!(root(function, pointer), Some(Expression::GlobalVariable(g)) if g == global);
    block.iter().any(|statement| match statement {
        Statement::Block(inner) => writes(function, inner, global),
        Statement::If { accept, reject, .. } => {
            writes(function, accept, global) || writes(function, reject, global)
        }
        Statement::Switch { cases, .. } => cases.iter().any(|c| writes(function, &c.body, global)),
        Statement::Loop {
            body, continuing, ..
        } => writes(function, body, global) || writes(function, continuing, global),
        Statement::Store { pointer, .. } => is(*pointer),
        Statement::Call { arguments, .. } => arguments.iter().any(|&a| is(a)),
        _ => false,
    })
}
