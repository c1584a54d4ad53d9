//! Expressions other than the built-in functions.

use super::emit::{Kind, Slot, Value};
use super::place::{self, Place};
use super::{Bound, Compiler, Fault, Frame, convert, integer};
use crate::tape::{Binary, Compare, IntBinary, Logic, Unary};
use naga::{
    BinaryOperator, Constant, Expression, Handle, Literal, Override, RelationalFunction,
    ScalarKind, TypeInner, UnaryOperator,
};
use std::rc::Rc;

impl<'m> Compiler<'m> {
    /// What an expression stands for, compiled before or at this place.
    pub(super) fn bound(
        &mut self,
        frame: &mut Frame<'m>,
        handle: Handle<Expression>,
    ) -> Result<Bound, Fault> {
        if let Some(bound) = &frame.bound[handle.index()] {
            return Ok(bound.clone());
        }
        let bound = self.expression(frame, handle)?;
        frame.bound[handle.index()] = Some(bound.clone());
        Ok(bound)
    }

    /// The value of an expression.
    pub(super) fn value(
        &mut self,
        frame: &mut Frame<'m>,
        handle: Handle<Expression>,
    ) -> Result<Value, Fault> {
        match self.bound(frame, handle)? {
            Bound::Value(value) => Ok(value),
            Bound::Place(_) => Err(Fault::new(
                frame.expressions.get_span(handle),
                "a pointer is used as a value",
            )),
        }
    }

    /// Compiles an expression.
    pub(super) fn expression(
        &mut self,
        frame: &mut Frame<'m>,
        handle: Handle<Expression>,
    ) -> Result<Bound, Fault> {
        let span = frame.expressions.get_span(handle);
        let unsupported = |what: &str| Err(Fault::new(span, format!("{what} not supported")));
        let value: Value = match &frame.expressions[handle] {
            Expression::Literal(literal) => Rc::new([self.literal(*literal, span)?]),
            Expression::Constant(constant) => self.constant(*constant)?,
            Expression::Override(parameter) => self.override_value(*parameter, span)?,
            Expression::ZeroValue(ty) => {
                let kinds = self.layouts.of(*ty)?;
                kinds.iter().map(|&kind| self.e.zero(kind)).collect()
            }
            Expression::Compose { components, .. } => {
                let mut all = Vec::new();
                for &component in components {
                    all.extend_from_slice(&self.value(frame, component)?);
                }
                all.into()
            }
            Expression::Access { base, index } => return self.access(frame, *base, *index, span),
            Expression::AccessIndex { base, index } => {
                let bound = self.bound(frame, *base)?;
                let inner = self.pointee(frame, *base);
                let (offset, len) = self.layouts.component(inner, *index, span)?;
                match bound {
                    Bound::Value(value) => value[offset..offset + len].into(),
                    Bound::Place(place) => return Ok(Bound::Place(place.part(offset, len))),
                }
            }
            Expression::Splat { size, value } => {
                let slot = self.scalar(frame, *value)?;
                vec![slot; *size as usize].into()
            }
            Expression::Swizzle {
                size,
                vector,
                pattern,
            } => {
                let vector = self.value(frame, *vector)?;
                pattern[..*size as usize]
                    .iter()
                    .map(|&c| vector[c as usize])
                    .collect()
            }
            Expression::FunctionArgument(index) => {
                return Ok(frame.arguments[*index as usize].clone());
            }
            Expression::GlobalVariable(global) => match self.globals.get(global) {
                Some(var) => return Ok(Bound::Place(Place::whole(Rc::clone(var)))),
                None => {
                    let variable = &self.module.global_variables[*global];
                    let name = variable.name.as_deref().unwrap_or("this variable");
                    // Textures and the like say so themselves.
                    self.layouts.of(variable.ty)?;
                    return unsupported(&format!("`{name}` is a resource of a pipeline, which is"));
                }
            },
            Expression::LocalVariable(local) => {
                let var = Rc::clone(&frame.locals[local.index()]);
                return Ok(Bound::Place(Place::whole(var)));
            }
            Expression::Load { pointer } => match self.bound(frame, *pointer)? {
                Bound::Place(place) => self.load(&place),
                Bound::Value(value) => value,
            },
            Expression::Unary { op, expr } => {
                let value = self.value(frame, *expr)?;
                value.iter().map(|&slot| self.unary(*op, slot)).collect()
            }
            Expression::Binary { op, left, right } => {
                let (a, b) = (self.value(frame, *left)?, self.value(frame, *right)?);
                let (ta, tb) = (self.inner(frame, *left), self.inner(frame, *right));
                match *op {
                    BinaryOperator::Multiply
                        if matches!(ta, TypeInner::Matrix { .. })
                            || matches!(tb, TypeInner::Matrix { .. }) =>
                    {
                        self.multiply_matrix(ta, &a, tb, &b)
                    }
                    _ => {
                        let n = a.len().max(b.len());
                        let pick = |v: &Value, k: usize| if v.len() == 1 { v[0] } else { v[k] };
                        (0..n)
                            .map(|k| self.binary(*op, pick(&a, k), pick(&b, k)))
                            .collect()
                    }
                }
            }
            Expression::Select {
                condition,
                accept,
                reject,
            } => {
                let condition = self.value(frame, *condition)?;
                let (a, b) = (self.value(frame, *accept)?, self.value(frame, *reject)?);
                let one = condition.len() == 1;
                (0..a.len())
                    .map(|k| {
                        let mask = condition[if one { 0 } else { k }].reg;
                        self.e.select(mask, a[k], b[k])
                    })
                    .collect()
            }
            Expression::Relational { fun, argument } => {
                let value = self.value(frame, *argument)?;
                self.relational(*fun, &value)
            }
            Expression::Math {
                fun,
                arg,
                arg1,
                arg2,
                arg3,
            } => {
                let mut arguments = vec![self.value(frame, *arg)?];
                let inner = self.inner(frame, *arg);
                for argument in [arg1, arg2, arg3].into_iter().flatten() {
                    arguments.push(self.value(frame, *argument)?);
                }
                self.math(*fun, inner, &arguments, span)?
            }
            Expression::As {
                expr,
                kind,
                convert,
            } => {
                let value = self.value(frame, *expr)?;
                if convert.is_some_and(|width| width != 4 && *kind != ScalarKind::Bool) {
                    return unsupported("numbers of 16 or 64 bits are");
                }
                let to = match kind {
                    ScalarKind::Float | ScalarKind::AbstractFloat => Kind::Real,
                    ScalarKind::Sint | ScalarKind::AbstractInt => Kind::Sint,
                    ScalarKind::Uint => Kind::Uint,
                    ScalarKind::Bool => Kind::Bool,
                };
                let bits = convert.is_none();
                value.iter().map(|&s| self.convert(s, to, bits)).collect()
            }
            Expression::CallResult(_) => return unsupported("this call is"),
            Expression::Derivative { .. } => {
                return unsupported(
                    "derivatives (dpdx, dFdx, fwidth, …) need neighbouring pixels: they are",
                );
            }
            Expression::ImageSample { .. }
            | Expression::ImageLoad { .. }
            | Expression::ImageQuery { .. } => return unsupported("textures are"),
            Expression::AtomicResult { .. } => return unsupported("atomic operations are"),
            Expression::ArrayLength(_) => {
                return unsupported("an array whose length is not a constant is");
            }
            _ => return unsupported("this expression is"),
        };
        Ok(Bound::Value(value))
    }

    /// The type of a value, or of what a pointer points to.
    fn pointee(&self, frame: &Frame<'m>, handle: Handle<Expression>) -> &'m TypeInner {
        match self.inner(frame, handle) {
            TypeInner::Pointer { base, .. } => &self.module.types[*base].inner,
            other => other,
        }
    }

    fn access(
        &mut self,
        frame: &mut Frame<'m>,
        base: Handle<Expression>,
        index: Handle<Expression>,
        span: naga::Span,
    ) -> Result<Bound, Fault> {
        let bound = self.bound(frame, base)?;
        let index = self.scalar(frame, index)?;
        let inner = self.pointee(frame, base);
        let (count, stride) = self.layouts.elements(inner, span)?;
        Ok(match bound {
            Bound::Place(place) => Bound::Place(place.element(&self.e, index.reg, count, stride)),
            Bound::Value(value) => Bound::Value(match self.e.constant_int(index.reg) {
                Some(i) => {
                    let from = i.min(count - 1) as usize * stride;
                    value[from..from + stride].into()
                }
                None => {
                    let slots = place::contiguous(&mut self.e, &value);
                    let dimension = place::Dimension {
                        index: index.reg,
                        stride,
                        count,
                    };
                    place::gather(&mut self.e, &slots, 0, stride, &[dimension])
                }
            }),
        })
    }

    fn load(&mut self, place: &Place) -> Value {
        let var = place.var.borrow();
        let slots = var.bound.as_ref().unwrap_or(&var.slots);
        if !place.dimensions.is_empty() {
            let slots = place::contiguous(&mut self.e, slots);
            return place::gather(
                &mut self.e,
                &slots,
                place.offset,
                place.len,
                &place.dimensions,
            );
        }
        let part = &slots[place.offset..place.offset + place.len];
        if var.bound.is_some() || var.settled {
            part.into()
        } else {
            self.e.copied(part)
        }
    }

    fn constant(&mut self, handle: Handle<Constant>) -> Result<Value, Fault> {
        if let Some(value) = self.constants.get(&handle) {
            return Ok(Rc::clone(value));
        }
        let value = self.global_value(self.module.constants[handle].init)?;
        // An array that is indexed stands in registers of its own, once.
        let value = if value.len() > 4 {
            place::contiguous(&mut self.e, &value)
        } else {
            value
        };
        self.constants.insert(handle, Rc::clone(&value));
        Ok(value)
    }

    fn override_value(
        &mut self,
        handle: Handle<Override>,
        span: naga::Span,
    ) -> Result<Value, Fault> {
        if let Some(value) = self.overrides.get(&handle) {
            return Ok(Rc::clone(value));
        }
        let parameter = &self.module.overrides[handle];
        let Some(init) = parameter.init else {
            let name = parameter.name.as_deref().unwrap_or("this override");
            return Err(Fault::new(span, format!("`{name}` has no value")));
        };
        let value = self.global_value(init)?;
        self.overrides.insert(handle, Rc::clone(&value));
        Ok(value)
    }

    fn literal(&mut self, literal: Literal, span: naga::Span) -> Result<Slot, Fault> {
        let (kind, reg) = match literal {
            Literal::F32(x) => (Kind::Real, self.e.lit(f64::from(x))),
            Literal::AbstractFloat(x) => (Kind::Real, self.e.lit(x)),
            Literal::I32(x) => (Kind::Sint, self.e.int(x as u32)),
            Literal::U32(x) => (Kind::Uint, self.e.int(x)),
            Literal::AbstractInt(x) => (Kind::Sint, self.e.int(x as u32)),
            Literal::Bool(x) => (Kind::Bool, self.e.bool(x)),
            _ => {
                return Err(Fault::new(
                    span,
                    "numbers of 16 or 64 bits are not supported: use f32, i32 or u32 (float, int or uint)",
                ));
            }
        };
        Ok(Slot { kind, reg })
    }

    fn unary(&mut self, op: UnaryOperator, a: Slot) -> Slot {
        let reg = match (op, a.kind) {
            (UnaryOperator::Negate, Kind::Real) => self.e.unary(Unary::Negate, a.reg),
            (UnaryOperator::Negate, _) => self.e.int_map(u32::wrapping_neg, a.reg),
            (_, Kind::Bool) => self.e.not(a.reg),
            _ => self.e.int_map(|x| !x, a.reg),
        };
        Slot { reg, ..a }
    }

    fn binary(&mut self, op: BinaryOperator, a: Slot, b: Slot) -> Slot {
        use BinaryOperator as B;
        let truth = |reg| Slot {
            kind: Kind::Bool,
            reg,
        };
        let same = |reg| Slot { reg, kind: a.kind };
        match a.kind {
            Kind::Real => match op {
                B::Add => same(self.e.add(a.reg, b.reg)),
                B::Subtract => same(self.e.sub(a.reg, b.reg)),
                B::Multiply => same(self.e.mul(a.reg, b.reg)),
                B::Divide => same(self.e.div(a.reg, b.reg)),
                B::Modulo => same(self.remainder(a.reg, b.reg)),
                B::Less => truth(self.e.compare(Compare::Less, a.reg, b.reg)),
                B::LessEqual => truth(self.e.compare(Compare::LessEqual, a.reg, b.reg)),
                B::Greater => truth(self.e.compare(Compare::Less, b.reg, a.reg)),
                B::GreaterEqual => truth(self.e.compare(Compare::LessEqual, b.reg, a.reg)),
                B::NotEqual => {
                    let equal = self.e.compare(Compare::Equal, a.reg, b.reg);
                    truth(self.e.not(equal))
                }
                _ => truth(self.e.compare(Compare::Equal, a.reg, b.reg)),
            },
            Kind::Bool => truth(match op {
                B::And | B::LogicalAnd => self.e.logic(Logic::And, a.reg, b.reg),
                B::InclusiveOr | B::LogicalOr => self.e.logic(Logic::Or, a.reg, b.reg),
                B::ExclusiveOr | B::NotEqual => {
                    let equal = self.e.logic(Logic::Equal, a.reg, b.reg);
                    self.e.not(equal)
                }
                _ => self.e.logic(Logic::Equal, a.reg, b.reg),
            }),
            Kind::Sint | Kind::Uint => {
                let direct = match op {
                    B::Add => Some(IntBinary::Add),
                    B::Subtract => Some(IntBinary::Subtract),
                    B::Multiply => Some(IntBinary::Multiply),
                    _ => None,
                };
                if let Some(direct) = direct {
                    return same(self.e.int_binary(direct, a.reg, b.reg));
                }
                let signed = a.kind == Kind::Sint;
                if let Some(test) = integer::test(op, signed) {
                    return truth(self.e.int_test(test, a.reg, b.reg));
                }
                same(self.e.int_zip(integer::operation(op, signed), a.reg, b.reg))
            }
        }
    }

    /// x − y·trunc(x/y), as WGSL defines `%`.
    fn remainder(&mut self, x: u32, y: u32) -> u32 {
        let quotient = self.e.div(x, y);
        let whole = self.trunc(quotient);
        let product = self.e.mul(y, whole);
        self.e.sub(x, product)
    }

    fn relational(&mut self, fun: RelationalFunction, value: &Value) -> Value {
        let truth = |reg| Slot {
            kind: Kind::Bool,
            reg,
        };
        match fun {
            RelationalFunction::All | RelationalFunction::Any => {
                let logic = if fun == RelationalFunction::All {
                    Logic::And
                } else {
                    Logic::Or
                };
                let mut all = value[0].reg;
                for slot in &value[1..] {
                    all = self.e.logic(logic, all, slot.reg);
                }
                Rc::new([truth(all)])
            }
            RelationalFunction::IsNan | RelationalFunction::IsInf => value
                .iter()
                .map(|slot| {
                    let x = slot.reg;
                    let number = self.e.compare(Compare::Equal, x, x);
                    if fun == RelationalFunction::IsNan {
                        return truth(self.e.not(number));
                    }
                    // ∞ − ∞ is no number.
                    let difference = self.e.binary(Binary::Subtract, x, x);
                    let finite = self.e.compare(Compare::Equal, difference, difference);
                    truth(self.e.logic(Logic::AndNot, number, finite))
                })
                .collect(),
        }
    }

    fn convert(&mut self, a: Slot, to: Kind, bits: bool) -> Slot {
        let e = &mut self.e;
        let slot = |reg| Slot { kind: to, reg };
        match (a.kind, to) {
            (Kind::Real, Kind::Real)
            | (Kind::Bool, Kind::Bool)
            | (Kind::Sint | Kind::Uint, Kind::Sint | Kind::Uint) => slot(a.reg),
            (Kind::Real, Kind::Sint | Kind::Uint) if bits => {
                slot(e.int_of(convert::to_bits, a.reg))
            }
            (Kind::Real, Kind::Sint) => slot(e.int_of(convert::to_sint, a.reg)),
            (Kind::Real, Kind::Uint) => slot(e.int_of(convert::to_uint, a.reg)),
            (_, Kind::Real) if bits && a.kind != Kind::Bool => {
                slot(e.real_of(convert::from_bits, a.reg))
            }
            (Kind::Sint, Kind::Real) => slot(e.real_of(convert::from_sint, a.reg)),
            (Kind::Uint, Kind::Real) => slot(e.real_of(convert::from_uint, a.reg)),
            (Kind::Real, Kind::Bool) => {
                let zero = e.lit(0.0);
                let is_zero = e.compare(Compare::Equal, a.reg, zero);
                slot(e.not(is_zero))
            }
            (Kind::Sint | Kind::Uint, Kind::Bool) => {
                let zero = e.int(0);
                slot(e.int_test(|x, y| x != y, a.reg, zero))
            }
            (Kind::Bool, Kind::Real) => {
                let (one, zero) = (e.lit(1.0), e.lit(0.0));
                slot(e.select_real(a.reg, one, zero))
            }
            (Kind::Bool, Kind::Sint | Kind::Uint) => {
                let (one, zero) = (e.int(1), e.int(0));
                e.select(a.reg, slot(one), slot(zero))
            }
        }
    }
}
