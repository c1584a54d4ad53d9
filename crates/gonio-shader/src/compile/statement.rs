//! Statements: calls, branches, loops.

use super::emit::{Kind, Slot, Value};
use super::place::{Place, Var};
use super::region::{self, Region, RegionKind, Stores};
use super::{Bound, Compiler, Fault, Frame};
use crate::tape::{File, Logic, Op, Reg};
use naga::{Block, Expression, Function, Handle, Span, Statement, SwitchCase, SwitchValue};
use std::cell::RefCell;
use std::rc::Rc;

impl<'m> Compiler<'m> {
    /// Writes out a call. What it gives is in registers that the next call may overwrite only in another step of a loop.
    pub(super) fn call(
        &mut self,
        handle: Handle<Function>,
        arguments: Vec<Bound>,
        span: Span,
    ) -> Result<Option<Value>, Fault> {
        let function = &self.module.functions[handle];
        if self.active.contains(&handle) {
            let name = function.name.as_deref().unwrap_or("a function");
            return Err(Fault::new(
                span,
                format!("`{name}` calls itself: shaders have no recursion"),
            ));
        }
        self.active.push(handle);
        self.calls += 1;
        self.check_size(span)?;
        let stores = match self.stores.get(&handle) {
            Some(stores) => Rc::clone(stores),
            None => {
                let stores = Rc::new(Stores::of(function));
                self.stores.insert(handle, Rc::clone(&stores));
                stores
            }
        };
        let mask = stores.early.then(|| self.own_mask());
        self.regions.push(Region::new(RegionKind::Function, mask));
        let mut frame = Frame {
            expressions: &function.expressions,
            info: Some(&self.info[handle]),
            bound: vec![None; function.expressions.len()],
            arguments,
            locals: Vec::new(),
            result: None,
            early: stores.early,
            region: self.regions.len() - 1,
        };
        if let Some(result) = &function.result
            && stores.early
        {
            let kinds = self.layouts.of(result.ty)?;
            frame.result = Some(self.e.fresh_value(&kinds));
        }
        self.locals(function, &mut frame, &stores)?;
        self.block(&mut frame, &function.body)?;
        self.end_region();
        self.active.pop();
        Ok(frame.result)
    }

    /// A mask of the lanes that are here, which may shrink without that of the region around it.
    fn own_mask(&mut self) -> Reg {
        let here = region::active(&self.regions).unwrap_or_else(|| self.e.bool(true));
        let own = self.e.fresh(File::Mask);
        self.e.push(Op::Copy(File::Mask, own, here));
        own
    }

    fn locals(
        &mut self,
        function: &'m Function,
        frame: &mut Frame<'m>,
        stores: &Stores,
    ) -> Result<(), Fault> {
        for (handle, variable) in function.local_variables.iter() {
            // A type's own place is that of its first use in the file, if any.
            let span = function.local_variables.get_span(handle);
            let kinds = self
                .layouts
                .of(variable.ty)
                .map_err(|fault| Fault { span, ..fault })?;
            let k = handle.index();
            let init: Value = match variable.init {
                Some(init) => self.value(frame, init)?,
                None => kinds.iter().map(|&kind| self.e.zero(kind)).collect(),
            };
            let untouched = stores.count[k] == 0;
            let simple = untouched || (stores.count[k] == 1 && !stores.nested[k]);
            let slots = if simple {
                Rc::clone(&init)
            } else {
                self.e.copied(&init)
            };
            frame.locals.push(Rc::new(RefCell::new(Var {
                slots,
                region: frame.region,
                simple,
                settled: false,
                once: stores.count[k] <= 1,
                bound: simple.then_some(init),
            })));
            self.check_size(span)?;
        }
        Ok(())
    }

    fn end_region(&mut self) {
        let region = self
            .regions
            .pop()
            .expect("invariant: each region that ends has begun");
        self.e.land(&region.exits);
    }

    fn block(&mut self, frame: &mut Frame<'m>, block: &'m Block) -> Result<(), Fault> {
        for (statement, &span) in block.span_iter() {
            if span.is_defined() {
                self.near = span;
            }
            let span = self.near;
            self.check_size(span)?;
            match statement {
                Statement::Emit(range) => {
                    for handle in range.clone() {
                        let bound = self.expression(frame, handle)?;
                        frame.bound[handle.index()] = Some(bound);
                    }
                }
                Statement::Block(inner) => {
                    if self.block_ends(frame, inner)? {
                        return Ok(());
                    }
                }
                Statement::If {
                    condition,
                    accept,
                    reject,
                } => self.branch(frame, *condition, accept, reject)?,
                Statement::Switch { selector, cases } => self.switch(frame, *selector, cases)?,
                Statement::Loop {
                    body,
                    continuing,
                    break_if,
                } => self.repeat(frame, body, continuing, *break_if, span)?,
                Statement::Break => {
                    self.leave_to(&[RegionKind::Case, RegionKind::Loop]);
                    return Ok(());
                }
                Statement::Continue => {
                    self.leave_to(&[RegionKind::Body]);
                    return Ok(());
                }
                Statement::Return { value } => {
                    self.give(frame, *value)?;
                    return Ok(());
                }
                Statement::Store { pointer, value } => {
                    let value = self.value(frame, *value)?;
                    let Bound::Place(place) = self.bound(frame, *pointer)? else {
                        return Err(Fault::new(span, "this cannot be written to"));
                    };
                    self.store(&place, value);
                }
                Statement::Call {
                    function,
                    arguments,
                    result,
                } => {
                    let mut bound = Vec::with_capacity(arguments.len());
                    for &argument in arguments {
                        bound.push(self.bound(frame, argument)?);
                    }
                    let value = self.call(*function, bound, span)?;
                    if let (Some(result), Some(value)) = (result, value) {
                        frame.bound[result.index()] = Some(Bound::Value(value));
                    }
                }
                Statement::Kill => {
                    return Err(Fault::new(
                        span,
                        "`discard` is not supported: a reflection function has a value for all directions",
                    ));
                }
                Statement::ControlBarrier(_)
                | Statement::MemoryBarrier(_)
                | Statement::WorkGroupUniformLoad { .. } => {
                    return Err(Fault::new(
                        span,
                        "barriers and work groups are not supported",
                    ));
                }
                Statement::ImageStore { .. } | Statement::ImageAtomic { .. } => {
                    return Err(Fault::new(span, "textures are not supported"));
                }
                Statement::Atomic { .. } => {
                    return Err(Fault::new(span, "atomic operations are not supported"));
                }
                _ => {
                    return Err(Fault::new(
                        span,
                        "this statement is not supported: a reflection function has directions and parameters only",
                    ));
                }
            }
            self.skip_if_nobody_is_left();
        }
        Ok(())
    }

    /// As [`Compiler::block`]; whether nothing after it is reached.
    fn block_ends(&mut self, frame: &mut Frame<'m>, block: &'m Block) -> Result<bool, Fault> {
        self.block(frame, block)?;
        let ends = matches!(
            block.last(),
            Some(Statement::Return { .. } | Statement::Break | Statement::Continue)
        );
        Ok(ends)
    }

    /// If lanes have left the innermost region, jumps to its end when none is left.
    fn skip_if_nobody_is_left(&mut self) {
        let Some(region) = self.regions.last_mut() else {
            return;
        };
        if let Some(mask) = region.mask
            && region.left
        {
            region.left = false;
            let jump = self.e.jump_unless(mask);
            region.exits.push(jump);
        }
    }

    /// Takes the lanes that are here out of the regions down to the innermost one of these kinds.
    fn leave_to(&mut self, kinds: &[RegionKind]) {
        let outermost = self.regions.iter().rposition(|r| kinds.contains(&r.kind));
        if let Some(outermost) = outermost {
            region::leave(&mut self.e, &mut self.regions, outermost);
        }
    }

    fn give(
        &mut self,
        frame: &mut Frame<'m>,
        value: Option<Handle<Expression>>,
    ) -> Result<(), Fault> {
        if let Some(value) = value {
            let value = self.value(frame, value)?;
            if frame.early {
                let mask = region::active(&self.regions);
                let result = frame.result.clone();
                for (&to, &from) in result.iter().flat_map(|r| r.iter()).zip(value.iter()) {
                    self.e.copy(to, from, mask);
                }
            } else {
                frame.result = Some(value);
            }
        }
        if frame.early {
            region::leave(&mut self.e, &mut self.regions, frame.region);
        }
        Ok(())
    }

    /// Writes a value to a place.
    pub(super) fn store(&mut self, place: &Place, value: Value) {
        let mut var = place.var.borrow_mut();
        if var.simple {
            var.bound = Some(value);
            var.settled = true;
            return;
        }
        let mask = region::mask_for(&self.regions, &var);
        if place.dimensions.is_empty() {
            for (&to, &from) in var.slots[place.offset..].iter().zip(value.iter()) {
                self.e.copy(to, from, mask);
            }
        } else {
            let everywhere = self.e.bool(true);
            super::place::scatter(
                &mut self.e,
                &var.slots,
                place.offset,
                &place.dimensions,
                &value,
                mask.unwrap_or(everywhere),
            );
        }
        var.settled = var.once;
    }

    /// Lanes for which `condition` is true, of those that are here: a mask that may shrink.
    fn lanes_where(&mut self, condition: Reg) -> Reg {
        let own = self.e.fresh(File::Mask);
        self.e.push(match region::active(&self.regions) {
            Some(here) => Op::Logic(Logic::And, own, condition, here),
            None => Op::Copy(File::Mask, own, condition),
        });
        own
    }

    /// Runs a block for the lanes of a mask.
    fn masked(
        &mut self,
        frame: &mut Frame<'m>,
        kind: RegionKind,
        mask: Reg,
        block: &'m Block,
    ) -> Result<(), Fault> {
        if block.is_empty() {
            return Ok(());
        }
        let mut region = Region::new(kind, Some(mask));
        let jump = self.e.jump_unless(mask);
        region.exits.push(jump);
        self.regions.push(region);
        self.block(frame, block)?;
        self.end_region();
        Ok(())
    }

    fn branch(
        &mut self,
        frame: &mut Frame<'m>,
        condition: Handle<Expression>,
        accept: &'m Block,
        reject: &'m Block,
    ) -> Result<(), Fault> {
        let condition = self.scalar(frame, condition)?;
        // Both masks are made first: the branch may leave the regions around it.
        let yes = self.lanes_where(condition.reg);
        let no = (!reject.is_empty()).then(|| {
            let not = self.e.not(condition.reg);
            self.lanes_where(not)
        });
        self.masked(frame, RegionKind::Branch, yes, accept)?;
        if let Some(no) = no {
            self.masked(frame, RegionKind::Branch, no, reject)?;
        }
        Ok(())
    }

    fn switch(
        &mut self,
        frame: &mut Frame<'m>,
        selector: Handle<Expression>,
        cases: &'m [SwitchCase],
    ) -> Result<(), Fault> {
        let selector = self.scalar(frame, selector)?;
        let mut chosen = Vec::with_capacity(cases.len());
        let mut any: Option<Reg> = None;
        for case in cases {
            let value = match case.value {
                SwitchValue::I32(x) => Some(x as u32),
                SwitchValue::U32(x) => Some(x),
                SwitchValue::Default => None,
            };
            chosen.push(value.map(|value| {
                let value = self.e.int(value);
                let is = self.e.int_test(|a, b| a == b, selector.reg, value);
                any = Some(match any {
                    None => is,
                    Some(before) => self.e.logic(Logic::Or, before, is),
                });
                is
            }));
        }
        let none = match any {
            Some(any) => self.e.not(any),
            None => self.e.bool(true),
        };
        let masks: Vec<Reg> = chosen
            .into_iter()
            .map(|is| self.lanes_where(is.unwrap_or(none)))
            .collect();
        let mut falling: Option<Reg> = None;
        for (case, &mask) in cases.iter().zip(&masks) {
            if let Some(falling) = falling {
                self.e.push(Op::Logic(Logic::Or, mask, mask, falling));
            }
            self.masked(frame, RegionKind::Case, mask, &case.body)?;
            falling = case.fall_through.then_some(mask);
        }
        Ok(())
    }

    fn repeat(
        &mut self,
        frame: &mut Frame<'m>,
        body: &'m Block,
        continuing: &'m Block,
        break_if: Option<Handle<Expression>>,
        span: Span,
    ) -> Result<(), Fault> {
        let going = self.own_mask();
        let mut region = Region::new(RegionKind::Loop, Some(going));
        region.exits.push(self.e.jump_unless(going));
        self.regions.push(region);
        let start = self.e.ops.len() as u32;
        let inside = self.own_mask();
        self.regions
            .push(Region::new(RegionKind::Body, Some(inside)));
        self.block(frame, body)?;
        self.end_region();
        self.block(frame, continuing)?;
        if let Some(condition) = break_if {
            let condition = self.scalar(frame, condition)?;
            self.e
                .push(Op::Logic(Logic::AndNot, going, going, condition.reg));
        }
        let source = self.e.tape.loops.len() as u32;
        self.e
            .tape
            .loops
            .push(span.to_range().map_or(0, |r| r.start as u32));
        self.e.push(Op::Loop {
            mask: going,
            to: start,
            source,
        });
        self.end_region();
        Ok(())
    }

    /// A value of one scalar.
    pub(super) fn scalar(
        &mut self,
        frame: &mut Frame<'m>,
        handle: Handle<Expression>,
    ) -> Result<Slot, Fault> {
        let value = self.value(frame, handle)?;
        Ok(value
            .first()
            .copied()
            .unwrap_or_else(|| self.e.zero(Kind::Real)))
    }
}
