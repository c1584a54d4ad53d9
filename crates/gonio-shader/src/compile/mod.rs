//! From the validated form of a shader to tapes.
//!
//! Calls are written out, so that arguments, results and pointers cost nothing at run time; recursion doesn't exist in shaders.
//! A branch is a mask: it is run if any lane takes it, and what it writes is written in those lanes. Each loop counts its steps.

mod convert;
mod emit;
mod expression;
mod half;
mod integer;
mod layout;
mod math;
mod matrix;
mod place;
mod region;
mod statement;

use crate::parameter::{Origin, Parameter};
use crate::tape::{File, Tape};
use emit::{Emitter, Kind, Slot, Value};
use layout::Layouts;
use naga::valid::{FunctionInfo, ModuleInfo};
use naga::{
    Arena, Constant, Expression, Function, GlobalVariable, Handle, Module, Override, Span,
    TypeInner,
};
use place::{Place, Var};
use region::{Region, Stores};
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

/// What is wrong, and where in the source.
#[derive(Debug)]
pub(crate) struct Fault {
    pub span: Span,
    pub message: String,
}

impl Fault {
    pub fn new(span: Span, message: impl Into<String>) -> Self {
        let message = message.into();
        Self { span, message }
    }
}

/// What an expression stands for.
#[derive(Debug, Clone)]
enum Bound {
    Value(Value),
    Place(Place),
}

/// A function that is being written out, or the constants of the module.
struct Frame<'m> {
    expressions: &'m Arena<Expression>,
    /// `None` for the constants of the module.
    info: Option<&'m FunctionInfo>,
    bound: Vec<Option<Bound>>,
    arguments: Vec<Bound>,
    locals: Vec<Rc<RefCell<Var>>>,
    /// What the function gives; its registers if it returns from several places.
    result: Option<Value>,
    /// Whether it returns before its end.
    early: bool,
    /// The index of the function's region.
    region: usize,
}

/// Writes one function and all that it calls as a tape.
struct Compiler<'m> {
    module: &'m Module,
    info: &'m ModuleInfo,
    e: Emitter,
    layouts: Layouts<'m>,
    constants: HashMap<Handle<Constant>, Value>,
    overrides: HashMap<Handle<Override>, Value>,
    globals: HashMap<Handle<GlobalVariable>, Rc<RefCell<Var>>>,
    global_frame: Frame<'m>,
    stores: HashMap<Handle<Function>, Rc<Stores>>,
    regions: Vec<Region>,
    /// The functions that are being written out, to refuse recursion.
    active: Vec<Handle<Function>>,
    /// How many calls have been written out.
    calls: usize,
    /// The last statement whose place is known: GLSL's expressions often have none.
    near: Span,
}

/// Compiles the function `entry`, whose arguments are rows of numbers.
pub(crate) fn compile(
    module: &Module,
    info: &ModuleInfo,
    parameters: &[Parameter],
    entry: Handle<Function>,
) -> Result<Tape, Fault> {
    let mut compiler = Compiler {
        module,
        info,
        e: Emitter::default(),
        layouts: Layouts::new(module),
        constants: HashMap::new(),
        overrides: HashMap::new(),
        globals: HashMap::new(),
        global_frame: Frame {
            expressions: &module.global_expressions,
            info: None,
            bound: vec![None; module.global_expressions.len()],
            arguments: Vec::new(),
            locals: Vec::new(),
            result: None,
            early: false,
            region: 0,
        },
        stores: HashMap::new(),
        regions: vec![Region::root()],
        active: Vec::new(),
        calls: 0,
        near: module.functions.get_span(entry),
    };
    compiler.parameters(parameters)?;
    compiler.globals()?;
    compiler.entry(entry)
}

impl<'m> Compiler<'m> {
    /// Gives each parameter its registers.
    fn parameters(&mut self, parameters: &[Parameter]) -> Result<(), Fault> {
        self.e.in_prologue = true;
        for parameter in parameters {
            let ty = match parameter.origin {
                Origin::Override(handle) => self.module.overrides[handle].ty,
                Origin::Global(handle) => self.module.global_variables[handle].ty,
                Origin::Member(handle, _) => self.module.global_variables[handle].ty,
            };
            let kinds = self.layouts.of(ty)?;
            let (first, kinds) = match parameter.origin {
                Origin::Member(_, first) => (first, &kinds[first..first + parameter.components()]),
                _ => (0, &kinds[..]),
            };
            let mut slots = Vec::new();
            for &kind in kinds {
                let number = self.e.fresh(File::Real);
                self.e.tape.parameters.push(number);
                let reg = match kind {
                    Kind::Real => number,
                    Kind::Sint => self.e.int_of(convert::to_sint, number),
                    Kind::Uint => self.e.int_of(convert::to_uint, number),
                    Kind::Bool => {
                        let zero = self.e.lit(0.0);
                        let is_zero = self.e.compare(crate::tape::Compare::Equal, number, zero);
                        self.e.not(is_zero)
                    }
                };
                slots.push(Slot { kind, reg });
            }
            match parameter.origin {
                Origin::Override(handle) => {
                    self.overrides.insert(handle, slots.into());
                }
                Origin::Global(handle) => {
                    self.global(handle, slots.into());
                }
                Origin::Member(handle, _) => {
                    // The members come in order: each call adds its own to the structure.
                    let mut all: Vec<Slot> = match self.globals.get(&handle) {
                        Some(var) => var.borrow().bound.as_deref().unwrap_or_default().to_vec(),
                        None => Vec::new(),
                    };
                    debug_assert_eq!(all.len(), first);
                    all.extend(slots);
                    self.global(handle, all.into());
                }
            }
        }
        self.e.in_prologue = false;
        Ok(())
    }

    /// Makes the global variables.
    fn globals(&mut self) -> Result<(), Fault> {
        for (handle, variable) in self.module.global_variables.iter() {
            if self.globals.contains_key(&handle) {
                continue;
            }
            let span = self.module.global_variables.get_span(handle);
            match variable.space {
                naga::AddressSpace::Private => {}
                // The interface of the wrapping entry point: inputs and outputs are private in GLSL.
                _ => {
                    // It is named where it is used, if it is.
                    continue;
                }
            }
            let Ok(kinds) = self.layouts.of(variable.ty) else {
                continue;
            };
            let init = match variable.init {
                Some(init) => self.global_value(init)?,
                None => kinds.iter().map(|&kind| self.e.zero(kind)).collect(),
            };
            if init.len() != kinds.len() {
                return Err(Fault::new(
                    span,
                    "the initial value has another type than the variable",
                ));
            }
            self.global(handle, init);
        }
        Ok(())
    }

    fn global(&mut self, handle: Handle<GlobalVariable>, init: Value) {
        let written = region::is_written(self.module, handle);
        let var = if written {
            self.e.in_prologue = true;
            let slots = self.e.copied(&init);
            self.e.in_prologue = false;
            Var {
                slots,
                region: 0,
                simple: false,
                settled: false,
                once: false,
                bound: None,
            }
        } else {
            Var {
                slots: Rc::clone(&init),
                region: 0,
                simple: true,
                settled: true,
                once: false,
                bound: Some(init),
            }
        };
        self.globals.insert(handle, Rc::new(RefCell::new(var)));
    }

    /// The value of an expression of the module. Its operations run before everything else.
    fn global_value(&mut self, handle: Handle<Expression>) -> Result<Value, Fault> {
        let empty = Frame {
            expressions: &self.module.global_expressions,
            info: None,
            bound: Vec::new(),
            arguments: Vec::new(),
            locals: Vec::new(),
            result: None,
            early: false,
            region: 0,
        };
        let mut frame = std::mem::replace(&mut self.global_frame, empty);
        let before = std::mem::replace(&mut self.e.in_prologue, true);
        let value = self.value(&mut frame, handle);
        self.e.in_prologue = before;
        self.global_frame = frame;
        value
    }

    fn entry(mut self, entry: Handle<Function>) -> Result<Tape, Fault> {
        let tape = self.write_entry(entry);
        let near = self.near;
        tape.map_err(|fault| match fault.span.is_defined() {
            true => fault,
            false => Fault {
                span: near,
                ..fault
            },
        })
    }

    fn write_entry(&mut self, entry: Handle<Function>) -> Result<Tape, Fault> {
        let function = &self.module.functions[entry];
        let mut arguments = Vec::new();
        let mut outputs: Vec<Rc<RefCell<Var>>> = Vec::new();
        for argument in &function.arguments {
            let inner = &self.module.types[argument.ty].inner;
            if let TypeInner::Pointer { base, .. } = *inner {
                let kinds = self.layouts.of(base)?;
                let zero: Vec<Slot> = kinds.iter().map(|&k| self.e.zero(k)).collect();
                let slots = self.e.copied(&zero);
                let var = Rc::new(RefCell::new(Var {
                    slots,
                    region: 0,
                    simple: false,
                    settled: false,
                    once: false,
                    bound: None,
                }));
                outputs.push(Rc::clone(&var));
                arguments.push(Bound::Place(Place::whole(var)));
            } else {
                let kinds = self.layouts.of(argument.ty)?;
                let value = self.e.fresh_value(&kinds);
                self.e.tape.inputs.extend(value.iter().map(|s| s.reg));
                arguments.push(Bound::Value(value));
            }
        }
        let span = self.module.functions.get_span(entry);
        let result = self.call(entry, arguments, span)?;
        let mut slots: Vec<Slot> = result.as_deref().unwrap_or_default().to_vec();
        for var in outputs {
            slots.extend_from_slice(&var.borrow().slots);
        }
        for slot in slots {
            let reg = match slot.kind {
                Kind::Real => slot.reg,
                Kind::Sint => self.e.real_of(convert::from_sint, slot.reg),
                Kind::Uint => self.e.real_of(convert::from_uint, slot.reg),
                Kind::Bool => {
                    let (one, zero) = (self.e.lit(1.0), self.e.lit(0.0));
                    self.e.select_real(slot.reg, one, zero)
                }
            };
            self.e.tape.outputs.push(reg);
        }
        self.check_size(span)?;
        Ok(std::mem::take(&mut self.e).finish())
    }

    fn check_size(&self, span: Span) -> Result<(), Fault> {
        if self.e.is_full() || self.calls > emit::LARGEST {
            return Err(Fault::new(
                span,
                format!(
                    "the shader is too long: more than {} operations once its calls are written out",
                    emit::LARGEST
                ),
            ));
        }
        Ok(())
    }

    /// The type of an expression.
    fn inner(&self, frame: &Frame<'m>, handle: Handle<Expression>) -> &'m TypeInner {
        match frame.info {
            Some(info) => info[handle].ty.inner_with(&self.module.types),
            None => self.info[handle].inner_with(&self.module.types),
        }
    }
}
