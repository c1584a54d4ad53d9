//! [`Expr`], the number that records a formula and prints it as shader code.
//!
//! [`record`] runs a formula over [`Real`] once, on expressions instead of numbers. What it did becomes a [`Function`]: a
//! function that is printed in WGSL, GLSL, HLSL, MSL or OSL ([`source()`]), and a graph that [`Function::evaluate`] runs on
//! `f32`, to the bit as the formula itself would. Common subexpressions are shared, constants are folded, and
//! what doesn't change in a loop is moved out of it; in the text, operations on three components become ones on vectors. A shader compiler may fuse and reorder, and its elementary functions
//! are its own: on the GPU expect differences around 10⁻⁵, never equal bits. WGSL also lets a compiler assume that no
//! value is NaN or infinite.
//!
//! ```
//! use gonio_num::expr::{Parameter, record};
//! use gonio_num::{Real, Vec3};
//!
//! /// Schlick's Fresnel reflectance.
//! fn schlick<R: Real>(f0: R, cos: R) -> R {
//!     f0 + (R::one() - f0) * (R::one() - cos).pow5()
//! }
//!
//! let function = record(
//!     "fresnel",
//!     &[Parameter::scalar("f0"), Parameter::vector("wi")],
//!     |p| schlick(p.scalar("f0"), p.vector("wi").z),
//! )?;
//! assert!(function.wgsl().contains("fn fresnel(f0: f32, wi: vec3f) -> f32"));
//! assert_eq!(function.evaluate(&[0.04, 0.0, 0.6, 0.8]), [schlick(0.04f32, 0.8)]);
//! # Ok::<(), gonio_num::expr::RecordError>(())
//! ```

mod evaluate;
mod function;
mod language;
mod names;
mod print;
mod simplify;
mod source;
mod tables;
mod tape;
mod text;
mod uses;
mod vectors;

pub use function::{
    Arguments, Field, FieldValue, Function, Output, Parameter, RecordError, record,
    record_simplified,
};
pub use language::Language;
pub use source::{Source, module, source};

use crate::{LoopState, Mask, Real, Table1, Table2, Table3};
use std::marker::PhantomData;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};
use tape::{Id, Op};

/// A handle on a value of the recording in progress on this thread.
///
/// # Panics
/// Every operation panics outside [`record`], on an expression of another recording, and on a value that was made inside a
/// loop and is used after it without being part of the loop's state.
#[derive(Debug, Clone, Copy)]
pub struct Expr(Handle);

/// A handle on a truth value of the recording in progress; panics as [`Expr`] does.
#[derive(Debug, Clone, Copy)]
pub struct ExprMask(Handle);

#[derive(Debug, Clone, Copy)]
struct Handle {
    id: Id,
    recording: u32,
    /// A tape belongs to its thread, so its handles stay there.
    not_send: PhantomData<*const ()>,
}

impl Handle {
    fn new(id: Id, recording: u32) -> Self {
        Self {
            id,
            recording,
            not_send: PhantomData,
        }
    }

    /// Its index on the tape of `recording`.
    fn id(self, recording: u32) -> Id {
        assert!(
            self.recording == recording,
            "an expression of another recording is used in this one"
        );
        self.id
    }
}

/// Records an operation.
fn apply<const K: usize>(op: Op, arguments: [Handle; K]) -> Handle {
    tape::with(|t| {
        let ids = arguments.map(|a| a.id(t.recording));
        Handle::new(t.apply(op, &ids), t.recording)
    })
}

macro_rules! operators {
    ($type:ident: $($operator:ident $method:ident $op:ident),+) => {$(
        impl $operator for $type {
            type Output = Self;
            fn $method(self, o: Self) -> Self {
                Self(apply(Op::$op, [self.0, o.0]))
            }
        }
    )+};
}
operators!(Expr: Add add Add, Sub sub Sub, Mul mul Mul, Div div Div);
operators!(ExprMask: BitAnd bitand And, BitOr bitor Or);

impl Neg for Expr {
    type Output = Self;
    fn neg(self) -> Self {
        Self(apply(Op::Neg, [self.0]))
    }
}

impl Not for ExprMask {
    type Output = Self;
    fn not(self) -> Self {
        Self(apply(Op::Not, [self.0]))
    }
}

impl Mask for ExprMask {
    fn splat(b: bool) -> Self {
        Self(tape::with(|t| Handle::new(t.truth(b), t.recording)))
    }
}

macro_rules! methods {
    ($($name:ident($($argument:ident),*) $op:ident;)+) => {$(
        fn $name(self $(, $argument: Self)*) -> Self {
            Self(apply(Op::$op, [self.0 $(, $argument.0)*]))
        }
    )+};
}

impl Real for Expr {
    type Mask = ExprMask;

    methods! {
        sqrt() Sqrt;
        abs() Abs;
        min(other) Min;
        max(other) Max;
        floor() Floor;
        exp() Exp;
        ln() Ln;
        sin() Sin;
        cos() Cos;
        acos() Acos;
        atan2(x) Atan2;
    }

    fn lit(x: f64) -> Self {
        Self(tape::with(|t| Handle::new(t.number(x as f32), t.recording)))
    }

    fn lt(self, other: Self) -> ExprMask {
        ExprMask(apply(Op::Less, [self.0, other.0]))
    }

    fn le(self, other: Self) -> ExprMask {
        ExprMask(apply(Op::LessEqual, [self.0, other.0]))
    }

    fn select(mask: ExprMask, a: Self, b: Self) -> Self {
        Self(apply(Op::Select, [mask.0, a.0, b.0]))
    }

    /// Always true: what isn't known yet may be needed.
    fn maybe_any(_: ExprMask) -> bool {
        true
    }

    fn table1(table: &'static Table1, x: Self) -> Self {
        match tape::with(|t| t.table1(table)) {
            Some(index) => Self(apply(Op::Table1(index), [x.0])),
            // The recording fails at its end; until then any number serves.
            None => x,
        }
    }

    fn table2(table: &'static Table2, x: Self, y: Self) -> Self {
        match tape::with(|t| t.table2(table)) {
            Some(index) => Self(apply(Op::Table2(index), [x.0, y.0])),
            None => x,
        }
    }

    fn table3(table: &'static Table3, x: Self, y: Self, z: Self) -> Self {
        match tape::with(|t| t.table3(table)) {
            Some(index) => Self(apply(Op::Table3(index), [x.0, y.0, z.0])),
            None => x,
        }
    }

    /// Records one step of the body as that of a loop.
    fn repeat_state<S: LoopState<Self>>(
        count: u32,
        state: S,
        mut body: impl FnMut(Self, S) -> (S, ExprMask),
    ) -> S {
        // `map` is the one way into a state: it reads the numbers and it replaces them.
        let mut handles = Vec::new();
        let _ = state.map(&mut |x: Self| {
            handles.push(x.0);
            x
        });
        let (id, step, ids, recording) = tape::with(|t| {
            let initial = handles.iter().map(|h| h.id(t.recording)).collect();
            let (id, step, ids) = t.open_loop(count, initial);
            (id, step, ids, t.recording)
        });
        let (next, go_on) = body(
            Self(Handle::new(step, recording)),
            replaced(state, ids, recording),
        );
        let mut handles = Vec::new();
        let _ = next.map(&mut |x: Self| {
            handles.push(x.0);
            x
        });
        let outcome = tape::with(|t| {
            let next = handles.iter().map(|h| h.id(t.recording)).collect();
            t.close_loop(id, next, go_on.0.id(t.recording))
        });
        replaced(state, outcome, recording)
    }
}

/// The state whose numbers are the nodes `ids`.
fn replaced<S: LoopState<Expr>>(state: S, ids: Vec<Id>, recording: u32) -> S {
    let mut ids = ids.into_iter();
    state.map(&mut |_: Expr| {
        let id = ids
            .next()
            .expect("invariant: a loop's state has the same numbers at every step");
        Expr(Handle::new(id, recording))
    })
}
