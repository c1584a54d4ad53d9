//! How types become rows of scalars.

use super::Fault;
use super::emit::{Kind, LARGEST};
use naga::{ArraySize, Handle, Module, Scalar, ScalarKind, Span, Type, TypeInner};
use std::collections::HashMap;
use std::rc::Rc;

/// The scalars of each type, in order: vectors by component, matrices by column, structures by member, arrays by element.
pub(super) struct Layouts<'m> {
    module: &'m Module,
    known: HashMap<Handle<Type>, Rc<[Kind]>>,
}

impl<'m> Layouts<'m> {
    pub fn new(module: &'m Module) -> Self {
        let known = HashMap::new();
        Self { module, known }
    }

    /// The scalars of a type.
    pub fn of(&mut self, ty: Handle<Type>) -> Result<Rc<[Kind]>, Fault> {
        if let Some(kinds) = self.known.get(&ty) {
            return Ok(Rc::clone(kinds));
        }
        let span = self.module.types.get_span(ty);
        let kinds = self.of_inner(&self.module.types[ty].inner, span)?;
        self.known.insert(ty, Rc::clone(&kinds));
        Ok(kinds)
    }

    /// As [`Layouts::of`], of a type that may stand in no list.
    pub fn of_inner(&mut self, inner: &TypeInner, span: Span) -> Result<Rc<[Kind]>, Fault> {
        let mut kinds = Vec::new();
        match *inner {
            TypeInner::Scalar(scalar) => kinds.push(kind(scalar, span)?),
            TypeInner::Vector { size, scalar } => {
                kinds.resize(size as usize, kind(scalar, span)?);
            }
            TypeInner::Matrix {
                columns,
                rows,
                scalar,
            } => kinds.resize(columns as usize * rows as usize, kind(scalar, span)?),
            TypeInner::Array { base, size, .. } => {
                let ArraySize::Constant(count) = size else {
                    return Err(Fault::new(
                        span,
                        "an array whose length is not a constant is not supported",
                    ));
                };
                let element = self.of(base)?;
                let count = count.get() as usize;
                if element.len().saturating_mul(count) > LARGEST {
                    return Err(Fault::new(
                        span,
                        format!(
                            "an array of {count} elements is too large: a shader may have at most {LARGEST} numbers"
                        ),
                    ));
                }
                for _ in 0..count {
                    kinds.extend_from_slice(&element);
                }
            }
            TypeInner::Struct { ref members, .. } => {
                for member in members {
                    kinds.extend_from_slice(&self.of(member.ty)?);
                    if kinds.len() > LARGEST {
                        return Err(Fault::new(
                            span,
                            format!(
                                "the structure is too large: a shader may have at most {LARGEST} numbers"
                            ),
                        ));
                    }
                }
            }
            TypeInner::Image { .. }
            | TypeInner::Sampler { .. }
            | TypeInner::BindingArray { .. } => {
                return Err(Fault::new(
                    span,
                    "textures are not supported: a reflection function has directions and parameters only",
                ));
            }
            TypeInner::Atomic(_) => {
                return Err(Fault::new(span, "atomic numbers are not supported"));
            }
            TypeInner::Pointer { .. } | TypeInner::ValuePointer { .. } => {
                return Err(Fault::new(
                    span,
                    "pointers to pointers, and pointers in structures, are not supported",
                ));
            }
            TypeInner::AccelerationStructure { .. } | TypeInner::RayQuery { .. } => {
                return Err(Fault::new(span, "ray queries are not supported"));
            }
            TypeInner::CooperativeMatrix { .. } => {
                return Err(Fault::new(span, "cooperative matrices are not supported"));
            }
        }
        Ok(kinds.into())
    }

    /// Where component `index` of a composite type begins, and its type if that stands in a list.
    pub fn component(
        &mut self,
        inner: &TypeInner,
        index: u32,
        span: Span,
    ) -> Result<(usize, usize), Fault> {
        let index = index as usize;
        Ok(match *inner {
            TypeInner::Vector { .. } | TypeInner::ValuePointer { .. } => (index, 1),
            TypeInner::Matrix { rows, .. } => (index * rows as usize, rows as usize),
            TypeInner::Array { base, .. } => {
                let stride = self.of(base)?.len();
                (index * stride, stride)
            }
            TypeInner::Struct { ref members, .. } => {
                let mut before = 0;
                for member in &members[..index] {
                    before += self.of(member.ty)?.len();
                }
                (before, self.of(members[index].ty)?.len())
            }
            _ => return Err(Fault::new(span, "this value has no components")),
        })
    }

    /// The number of components of a type that may be indexed by a number known at run time only, and the scalars of each.
    pub fn elements(&mut self, inner: &TypeInner, span: Span) -> Result<(u32, usize), Fault> {
        Ok(match *inner {
            TypeInner::Vector { size, .. }
            | TypeInner::ValuePointer {
                size: Some(size), ..
            } => (size as u32, 1),
            TypeInner::Matrix { columns, rows, .. } => (columns as u32, rows as usize),
            TypeInner::Array {
                base,
                size: ArraySize::Constant(count),
                ..
            } => (count.get(), self.of(base)?.len()),
            _ => return Err(Fault::new(span, "this value cannot be indexed")),
        })
    }
}

/// What a scalar type is.
pub(super) fn kind(scalar: Scalar, span: Span) -> Result<Kind, Fault> {
    match (scalar.kind, scalar.width) {
        (ScalarKind::Float, 4) | (ScalarKind::AbstractFloat, _) => Ok(Kind::Real),
        (ScalarKind::Sint, 4) | (ScalarKind::AbstractInt, _) => Ok(Kind::Sint),
        (ScalarKind::Uint, 4) => Ok(Kind::Uint),
        (ScalarKind::Bool, _) => Ok(Kind::Bool),
        _ => Err(Fault::new(
            span,
            "numbers of 16 or 64 bits are not supported: use f32, i32 or u32 (float, int or uint)",
        )),
    }
}
