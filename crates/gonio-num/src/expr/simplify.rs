//! What has no effect on finite numbers: left out of text that people read.

use super::tape::{Id, Node, Op, Tape};

impl Tape {
    /// A value that an operation on `arguments` equals for finite numbers, but for the sign of a zero and the last digit of a mean of equals.
    pub(super) fn simpler(&mut self, op: Op, arguments: &[Id]) -> Option<Id> {
        let is = |t: &Self, k: usize, x: f32| t.number_of(arguments[k]) == Some(x);
        let all = |t: &Self, k: usize, b: bool| t.literal(arguments[k]) == Some(u32::from(b));
        match op {
            Op::Mul | Op::Div if is(self, 0, 0.0) => Some(self.number(0.0)),
            Op::Mul if is(self, 1, 0.0) => Some(self.number(0.0)),
            Op::Add if is(self, 0, 0.0) => Some(arguments[1]),
            Op::Add | Op::Sub if is(self, 1, 0.0) => Some(arguments[0]),
            Op::Sub if is(self, 0, 0.0) => Some(self.apply(Op::Neg, &[arguments[1]])),
            Op::Mul if is(self, 1, 1.0 / 3.0) => self.thrice(arguments[0]),
            Op::Mul if is(self, 0, -1.0) => Some(self.apply(Op::Neg, &[arguments[1]])),
            Op::Add => {
                let negated = self.argument_of(Op::Neg, arguments[1])?;
                Some(self.apply(Op::Sub, &[arguments[0], negated]))
            }
            Op::Neg => match self.arguments_of(Op::Sub, arguments[0]) {
                Some([a, b]) => Some(self.apply(Op::Sub, &[b, a])),
                None => self.argument_of(Op::Neg, arguments[0]),
            },
            Op::Not => self.argument_of(Op::Not, arguments[0]),
            Op::And if all(self, 0, false) || all(self, 1, false) => Some(self.truth(false)),
            Op::Or if all(self, 0, true) || all(self, 1, true) => Some(self.truth(true)),
            Op::And if all(self, 0, true) => Some(arguments[1]),
            Op::And if all(self, 1, true) => Some(arguments[0]),
            Op::Or if all(self, 0, false) => Some(arguments[1]),
            Op::Or if all(self, 1, false) => Some(arguments[0]),
            Op::And | Op::Or | Op::Min | Op::Max if arguments[0] == arguments[1] => {
                Some(arguments[0])
            }
            Op::Select => {
                let mask = self.argument_of(Op::Not, arguments[0])?;
                Some(self.apply(Op::Select, &[mask, arguments[2], arguments[1]]))
            }
            Op::Max => {
                let low = self.number_of(arguments[1])?;
                (self.least(arguments[0])? >= low).then_some(arguments[0])
            }
            Op::Min => {
                let high = self.number_of(arguments[1])?;
                (self.most(arguments[0])? <= high).then_some(arguments[0])
            }
            _ => None,
        }
    }

    /// x of (x + x) + x.
    fn thrice(&self, id: Id) -> Option<Id> {
        let [twice, x] = self.arguments_of(Op::Add, id)?;
        (self.arguments_of(Op::Add, twice)? == [x, x]).then_some(x)
    }

    fn number_of(&self, id: Id) -> Option<f32> {
        match self.graph.nodes[id as usize] {
            Node::Literal { bits, truth: false } => Some(f32::from_bits(bits)),
            _ => None,
        }
    }

    /// The argument of the operation `op` that a node is, if it is one.
    fn argument_of(&self, op: Op, id: Id) -> Option<Id> {
        match &self.graph.nodes[id as usize] {
            Node::Apply(found, arguments) if *found == op => Some(arguments[0]),
            _ => None,
        }
    }

    fn arguments_of(&self, op: Op, id: Id) -> Option<[Id; 2]> {
        match &self.graph.nodes[id as usize] {
            Node::Apply(found, arguments) if *found == op => Some([arguments[0], arguments[1]]),
            _ => None,
        }
    }

    /// A bound from below that a value was given: by a limit, a root or an absolute value.
    fn least(&self, id: Id) -> Option<f32> {
        if let Some(x) = self.number_of(id) {
            return Some(x);
        }
        match &self.graph.nodes[id as usize] {
            Node::Apply(Op::Max, a) => self.number_of(a[1]).or_else(|| self.number_of(a[0])),
            Node::Apply(Op::Min, a) => Some(self.least(a[0])?.min(self.number_of(a[1])?)),
            Node::Apply(Op::Sqrt | Op::Abs | Op::Exp, _) => Some(0.0),
            Node::Apply(Op::Mul, a) if a[0] == a[1] => Some(0.0),
            _ => None,
        }
    }

    /// As [`Tape::least`], from above.
    fn most(&self, id: Id) -> Option<f32> {
        if let Some(x) = self.number_of(id) {
            return Some(x);
        }
        match &self.graph.nodes[id as usize] {
            Node::Apply(Op::Min, a) => self.number_of(a[1]).or_else(|| self.number_of(a[0])),
            Node::Apply(Op::Max, a) => Some(self.most(a[0])?.max(self.number_of(a[1])?)),
            _ => None,
        }
    }
}
