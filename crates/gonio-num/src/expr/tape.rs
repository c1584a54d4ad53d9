//! The tape: the graph of operations that a recording leaves behind.

use super::RecordError;
use super::{Language, names};
use crate::table::{lookup1, lookup2, lookup3};
use crate::{Real, Table1, Table2, Table3};
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

/// Index of a node on its tape.
pub(super) type Id = u32;
/// Index of a loop on its tape.
pub(super) type LoopId = u32;

/// An operation on numbers and truth values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Op {
    Add,
    Sub,
    Mul,
    Div,
    Neg,
    Sqrt,
    Abs,
    Min,
    Max,
    Floor,
    Exp,
    Ln,
    Sin,
    Cos,
    Acos,
    Atan2,
    Less,
    LessEqual,
    And,
    Or,
    Not,
    /// (mask, a, b)
    Select,
    /// Index into [`Graph::tables1`], x.
    Table1(u32),
    /// Index into [`Graph::tables2`], x, y.
    Table2(u32),
    /// Index into [`Graph::tables3`], x, y, z.
    Table3(u32),
}

/// One value. Nodes are compared by their bits, so equal nodes are equal values.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) enum Node {
    /// A literal: the bits of an `f32`, or 0 and 1 for a truth value.
    Literal { bits: u32, truth: bool },
    /// A component of the parameters, counted through all of them.
    Parameter(u32),
    /// An operation on earlier nodes.
    Apply(Op, Rc<[Id]>),
    /// Number of the step of a loop, from 0.
    Step(LoopId),
    /// A loop's state at the start of a step.
    State(LoopId, u32),
    /// A loop's state after its end.
    Outcome(LoopId, u32),
}

/// What a block of the function does, in order.
#[derive(Debug, Clone, Copy)]
pub(super) enum Statement {
    Evaluate(Id),
    Loop(LoopId),
}

/// A bounded loop.
#[derive(Debug, Clone)]
pub(super) struct Loop {
    /// The loop around it.
    pub parent: Option<LoopId>,
    /// Whether its body is being recorded.
    pub open: bool,
    pub count: u32,
    pub initial: Vec<Id>,
    pub step: Id,
    pub state: Vec<Id>,
    pub next: Vec<Id>,
    pub go_on: Id,
    pub outcome: Vec<Id>,
    pub body: Vec<Statement>,
}

/// Nodes, the blocks that they are evaluated in, and the tables that they look values up in.
#[derive(Debug, Clone, Default)]
pub(super) struct Graph {
    pub nodes: Vec<Node>,
    /// The innermost loop that each node depends on.
    pub scopes: Vec<Option<LoopId>>,
    pub loops: Vec<Loop>,
    pub body: Vec<Statement>,
    pub tables1: Vec<&'static Table1>,
    pub tables2: Vec<&'static Table2>,
    pub tables3: Vec<&'static Table3>,
}

impl Graph {
    /// Names of all tables.
    pub fn table_names(&self) -> impl Iterator<Item = &'static str> {
        let names1 = self.tables1.iter().map(|t| t.name);
        let names2 = self.tables2.iter().map(|t| t.name);
        let names3 = self.tables3.iter().map(|t| t.name);
        names1.chain(names2).chain(names3)
    }

    /// How many operations the outputs need; those in a loop count once.
    pub fn operations(&self, outputs: &[Id]) -> usize {
        let used = super::uses::raw_uses(self, outputs);
        let operations = self.nodes.iter().zip(used);
        operations
            .filter(|(node, uses)| matches!(node, Node::Apply(..)) && *uses > 0)
            .count()
    }

    /// The operation on bit patterns: what the interpreter does, and what folds constants.
    pub fn apply(&self, op: Op, arguments: &[u32]) -> u32 {
        let x = |i: usize| f32::from_bits(arguments[i]);
        let number = match op {
            Op::Less => return u32::from(x(0) < x(1)),
            Op::LessEqual => return u32::from(x(0) <= x(1)),
            Op::And => return arguments[0] & arguments[1],
            Op::Or => return arguments[0] | arguments[1],
            Op::Not => return arguments[0] ^ 1,
            Op::Select => {
                return if arguments[0] == 1 {
                    arguments[1]
                } else {
                    arguments[2]
                };
            }
            Op::Add => x(0) + x(1),
            Op::Sub => x(0) - x(1),
            Op::Mul => x(0) * x(1),
            Op::Div => x(0) / x(1),
            Op::Neg => -x(0),
            Op::Sqrt => x(0).sqrt(),
            Op::Abs => x(0).abs(),
            Op::Min => Real::min(x(0), x(1)),
            Op::Max => Real::max(x(0), x(1)),
            Op::Floor => Real::floor(x(0)),
            Op::Exp => Real::exp(x(0)),
            Op::Ln => Real::ln(x(0)),
            Op::Sin => Real::sin(x(0)),
            Op::Cos => Real::cos(x(0)),
            Op::Acos => Real::acos(x(0)),
            Op::Atan2 => Real::atan2(x(0), x(1)),
            Op::Table1(t) => lookup1(self.tables1[t as usize], x(0)),
            Op::Table2(t) => lookup2(self.tables2[t as usize], x(0), x(1)),
            Op::Table3(t) => lookup3(self.tables3[t as usize], x(0), x(1), x(2)),
        };
        number.to_bits()
    }
}

/// A recording in progress.
#[derive(Debug, Default)]
pub(super) struct Tape {
    pub graph: Graph,
    /// Tells expressions of this recording from those of others on the thread.
    pub recording: u32,
    /// The first thing found wrong.
    pub error: Option<RecordError>,
    /// Whether what has no effect on finite numbers is left out.
    simplify: bool,
    known: HashMap<Node, Id>,
    innermost: Option<LoopId>,
}

thread_local! {
    static TAPE: RefCell<Option<Tape>> = const { RefCell::new(None) };
    static RECORDINGS: RefCell<u32> = const { RefCell::new(0) };
}

/// Takes the tape away at the end of a recording, and when its body panics.
pub(super) struct Recording;

impl Recording {
    /// Starts a recording on this thread.
    ///
    /// - `simplify`: whether what has no effect on finite numbers is left out
    pub fn start(simplify: bool) -> Result<Self, RecordError> {
        TAPE.with_borrow_mut(|tape| {
            if tape.is_some() {
                return Err(RecordError::Nested);
            }
            let recording = RECORDINGS.with_borrow_mut(|n| {
                *n += 1;
                *n
            });
            *tape = Some(Tape {
                recording,
                simplify,
                ..Tape::default()
            });
            Ok(Self)
        })
    }

    /// Ends it and gives what it recorded.
    pub fn finish(self) -> Tape {
        TAPE.take()
            .expect("invariant: a tape lies in its place while its recording lives")
    }
}

impl Drop for Recording {
    fn drop(&mut self) {
        TAPE.set(None);
    }
}

/// Runs `f` on this thread's tape.
///
/// # Panics
/// If nothing is being recorded.
pub(super) fn with<T>(f: impl FnOnce(&mut Tape) -> T) -> T {
    TAPE.with_borrow_mut(|tape| {
        f(tape
            .as_mut()
            .expect("expressions exist only inside gonio_num::expr::record"))
    })
}

impl Tape {
    /// The node of a number. All NaNs are one.
    pub fn number(&mut self, x: f32) -> Id {
        let bits = if x.is_nan() { f32::NAN } else { x }.to_bits();
        self.intern(Node::Literal { bits, truth: false }, None)
    }

    /// The node of a truth value.
    pub fn truth(&mut self, b: bool) -> Id {
        let bits = u32::from(b);
        self.intern(Node::Literal { bits, truth: true }, None)
    }

    /// The node of a component of the parameters.
    pub fn parameter(&mut self, component: u32) -> Id {
        self.intern(Node::Parameter(component), None)
    }

    pub fn literal(&self, id: Id) -> Option<u32> {
        match self.graph.nodes[id as usize] {
            Node::Literal { bits, .. } => Some(bits),
            _ => None,
        }
    }

    /// The node of an operation: an earlier one if it was recorded before, a literal if all arguments are.
    ///
    /// It is evaluated in the innermost loop that an argument depends on, so what doesn't change in a loop stays outside.
    pub fn apply(&mut self, op: Op, arguments: &[Id]) -> Id {
        let literals: Vec<u32> = arguments.iter().filter_map(|a| self.literal(*a)).collect();
        if literals.len() == arguments.len() {
            let bits = self.graph.apply(op, &literals);
            return match op {
                Op::Less | Op::LessEqual | Op::And | Op::Or | Op::Not => self.truth(bits == 1),
                _ => self.number(f32::from_bits(bits)),
            };
        }
        if let Some(simpler) = self.simplified(op, arguments) {
            return simpler;
        }
        if self.simplify
            && let Some(simpler) = self.simpler(op, arguments)
        {
            return simpler;
        }
        let mut scope = None;
        for a in arguments {
            scope = self.inner(scope, self.graph.scopes[*a as usize]);
        }
        let count = self.graph.nodes.len();
        let id = self.intern(Node::Apply(op, arguments.into()), scope);
        if id as usize == count {
            self.block(scope).push(Statement::Evaluate(id));
        }
        id
    }

    /// The argument that the operation returns unchanged, whatever the others are. To the bit: x + 0 is not among them,
    /// as −0 + 0 = +0.
    fn simplified(&self, op: Op, arguments: &[Id]) -> Option<Id> {
        let one = |i: usize| self.literal(arguments[i]) == Some(1.0f32.to_bits());
        match op {
            Op::Mul if one(0) => Some(arguments[1]),
            Op::Mul | Op::Div if one(1) => Some(arguments[0]),
            Op::Select => match self.literal(arguments[0]) {
                Some(bits) => Some(arguments[if bits == 1 { 1 } else { 2 }]),
                None if arguments[1] == arguments[2] => Some(arguments[1]),
                None => None,
            },
            _ => None,
        }
    }

    fn intern(&mut self, node: Node, scope: Option<LoopId>) -> Id {
        if let Some(id) = self.known.get(&node) {
            return *id;
        }
        let id = self.graph.nodes.len() as Id;
        self.graph.nodes.push(node.clone());
        self.graph.scopes.push(scope);
        self.known.insert(node, id);
        id
    }

    /// Refuses a value that can't be used where the recording stands.
    ///
    /// # Panics
    /// If it was made inside a loop that has ended.
    pub fn check_use(&self, id: Id) {
        self.inner(None, self.graph.scopes[id as usize]);
    }

    /// The inner one of two scopes of values used together.
    fn inner(&self, a: Option<LoopId>, b: Option<LoopId>) -> Option<LoopId> {
        for scope in [a, b].into_iter().flatten() {
            assert!(
                self.graph.loops[scope as usize].open,
                "a value made inside a loop is used after it: carry it out in the loop's state"
            );
        }
        // Open loops lie in one another, and a loop is numbered after those around it.
        a.max(b)
    }

    fn block(&mut self, scope: Option<LoopId>) -> &mut Vec<Statement> {
        match scope {
            None => &mut self.graph.body,
            Some(l) => &mut self.graph.loops[l as usize].body,
        }
    }

    /// Opens a loop and gives it with the nodes of its step number and state.
    pub fn open_loop(&mut self, count: u32, initial: Vec<Id>) -> (LoopId, Id, Vec<Id>) {
        let id = self.graph.loops.len() as LoopId;
        for i in &initial {
            self.check_use(*i);
        }
        let step = self.intern(Node::Step(id), Some(id));
        let state: Vec<Id> = (0..initial.len() as u32)
            .map(|k| self.intern(Node::State(id, k), Some(id)))
            .collect();
        self.graph.loops.push(Loop {
            parent: self.innermost,
            open: true,
            count,
            initial,
            step,
            state: state.clone(),
            next: Vec::new(),
            go_on: 0,
            outcome: Vec::new(),
            body: Vec::new(),
        });
        self.innermost = Some(id);
        (id, step, state)
    }

    /// Closes the innermost loop and gives the nodes of its outcome.
    pub fn close_loop(&mut self, id: LoopId, next: Vec<Id>, go_on: Id) -> Vec<Id> {
        for value in next.iter().chain([&go_on]) {
            self.check_use(*value);
        }
        let count = next.len() as u32;
        let closed = &mut self.graph.loops[id as usize];
        (closed.next, closed.go_on, closed.open) = (next, go_on, false);
        let parent = closed.parent;
        self.innermost = parent;
        self.block(parent).push(Statement::Loop(id));
        let outcome: Vec<Id> = (0..count)
            .map(|k| self.intern(Node::Outcome(id, k), parent))
            .collect();
        self.graph.loops[id as usize].outcome.clone_from(&outcome);
        outcome
    }

    /// The index of a table, entered if new. A table that can't be used is noted as the recording's error.
    pub fn table1(&mut self, table: &'static Table1) -> Option<u32> {
        if let Some(i) = position(&self.graph.tables1, table) {
            return Some(i);
        }
        self.check_table(table.name, table.data, &[table.data.len()])?;
        self.graph.tables1.push(table);
        Some(self.graph.tables1.len() as u32 - 1)
    }

    /// As [`Tape::table1`].
    pub fn table2(&mut self, table: &'static Table2) -> Option<u32> {
        if let Some(i) = position(&self.graph.tables2, table) {
            return Some(i);
        }
        self.check_table(table.name, table.data, &[table.width, table.height])?;
        self.graph.tables2.push(table);
        Some(self.graph.tables2.len() as u32 - 1)
    }

    /// As [`Tape::table1`].
    pub fn table3(&mut self, table: &'static Table3) -> Option<u32> {
        if let Some(i) = position(&self.graph.tables3, table) {
            return Some(i);
        }
        let sides = [table.width, table.height, table.depth];
        self.check_table(table.name, table.data, &sides)?;
        self.graph.tables3.push(table);
        Some(self.graph.tables3.len() as u32 - 1)
    }

    fn check_table(&mut self, name: &str, data: &[f32], sides: &[usize]) -> Option<()> {
        let product = sides
            .iter()
            .try_fold(1usize, |product, side| product.checked_mul(*side));
        let size_is_right = sides.iter().all(|s| *s >= 2) && product == Some(data.len());
        let problem = if let Err(error) = names::check(Language::Wgsl, name) {
            error
        } else if self.graph.table_names().any(|n| n == name) {
            RecordError::Duplicate { name: name.into() }
        } else if !size_is_right {
            RecordError::TableSize {
                name: name.into(),
                samples: data.len(),
            }
        } else if let Some(index) = data.iter().position(|x| !x.is_finite()) {
            RecordError::TableValue {
                name: name.into(),
                index,
                value: data[index],
            }
        } else {
            return Some(());
        };
        self.error.get_or_insert(problem);
        None
    }
}

/// The place of a table among those entered, which is known by its address.
fn position<T>(tables: &[&'static T], table: &'static T) -> Option<u32> {
    let found = tables.iter().position(|t| std::ptr::eq(*t, table));
    found.map(|i| i as u32)
}
