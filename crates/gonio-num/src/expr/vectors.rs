//! Which numbers of a graph are printed three at a time, as vectors.
//!
//! Formulas are recorded number by number. Three operations of one kind on the components of vectors are found again from where
//! vectors must stand, what a function returns and scalar products, down to their operands.

use super::language::Type;
use super::tape::{Graph, Id, LoopId, Node, Op};
use std::collections::{HashMap, HashSet};

/// Index of a vector.
pub(super) type VectorId = usize;

/// A number, or three of them together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Value {
    One(Id),
    Three(VectorId),
}

/// How a vector comes about.
#[derive(Debug, Clone)]
pub(super) enum Form {
    /// It is the parameter whose components begin here.
    Parameter(u32),
    /// It is put together from three numbers.
    Gathered,
    /// An operation on vectors, and on numbers that are the same for each component.
    Apply(Op, Vec<Value>),
}

/// Three numbers that are printed together.
#[derive(Debug, Clone)]
pub(super) struct Vector {
    pub lanes: [Id; 3],
    pub kind: Type,
    pub form: Form,
}

/// The vectors of a function.
#[derive(Debug)]
pub(super) struct Vectors<'a> {
    graph: &'a Graph,
    /// The type of each component of the parameters, and which component of its parameter it is.
    parameters: &'a [(Type, usize)],
    pub list: Vec<Vector>,
    known: HashMap<([Id; 3], Type), VectorId>,
    /// Numbers that are a component of a vector which is computed.
    pub lane_of: HashMap<Id, (VectorId, usize)>,
    /// Scalar products.
    pub dots: HashMap<Id, [VectorId; 2]>,
    /// Numbers that are another number limited from below, then from above: the number, and the limits.
    pub clamps: HashMap<Id, [Id; 3]>,
}

impl<'a> Vectors<'a> {
    /// Finds the vectors that `outputs`, and the scalar products of the nodes in `used`, are made of.
    pub fn find(
        graph: &'a Graph,
        parameters: &'a [(Type, usize)],
        outputs: &[([Id; 3], Type)],
        used: &[usize],
    ) -> Self {
        let mut found = Self {
            graph,
            parameters,
            list: Vec::new(),
            known: HashMap::new(),
            lane_of: HashMap::new(),
            dots: HashMap::new(),
            clamps: HashMap::new(),
        };
        let mut seeds = Vec::new();
        for (lanes, kind) in outputs {
            seeds.push(found.vector(*lanes, *kind));
        }
        for id in 0..graph.nodes.len() as Id {
            if used[id as usize] == 0 {
                continue;
            }
            if let Some([a, b]) = dot(graph, id) {
                let pair = [a, b].map(|lanes| found.vector(lanes, Type::Vector));
                if found.is_worth(pair) {
                    found.dots.insert(id, pair);
                    seeds.extend(pair);
                }
            }
            if let Some(clamp) = clamp(graph, id, used) {
                found.clamps.insert(id, clamp);
            }
        }
        while let Some(vector) = {
            found.take_lanes(&seeds);
            found.cycle(&seeds)
        } {
            found.list[vector].form = Form::Gathered;
        }
        let dots = std::mem::take(&mut found.dots);
        let kept = dots.into_iter().filter(|(_, pair)| found.is_worth(*pair));
        found.dots = kept.collect();
        found.take_lanes(&found.seeds(outputs));
        found
    }

    /// The vectors that must stand: what is returned, and those of scalar products.
    fn seeds(&self, outputs: &[([Id; 3], Type)]) -> Vec<VectorId> {
        let returned = outputs
            .iter()
            .map(|(lanes, kind)| self.known(*lanes, *kind));
        returned
            .chain(self.dots.values().copied().flatten())
            .collect()
    }

    /// Whether a scalar product of these says more than its three products: one of them is a vector for other reasons too, and
    /// neither is put together from literals, or from the components of a colour.
    fn is_worth(&self, pair: [VectorId; 2]) -> bool {
        let odd = |v: &VectorId| {
            self.is_gathered(*v)
                && self.list[*v]
                    .lanes
                    .iter()
                    .all(|id| match self.graph.nodes[*id as usize] {
                        Node::Literal { .. } => true,
                        Node::Parameter(i) => self.parameters[i as usize].0 != Type::Vector,
                        _ => false,
                    })
        };
        pair.iter().any(|v| !self.is_gathered(*v))
            && !pair.iter().any(|v| odd(v) || self.is_of_odd(*v, &odd))
    }

    /// Whether an operand that a vector is computed from is odd.
    fn is_of_odd(&self, v: VectorId, odd: &dyn Fn(&VectorId) -> bool) -> bool {
        match &self.list[v].form {
            Form::Apply(_, operands) => operands.iter().any(|o| match o {
                Value::Three(inner) => {
                    let colour = self.list[*inner]
                        .lanes
                        .iter()
                        .any(|id| matches!(self.graph.nodes[*id as usize], Node::Parameter(_)));
                    colour && odd(inner) || self.is_of_odd(*inner, odd)
                }
                Value::One(_) => false,
            }),
            _ => false,
        }
    }

    /// Whether it consists of literals.
    pub fn is_literal(&self, v: VectorId) -> bool {
        let lanes = self.list[v].lanes.iter();
        let mut nodes = lanes.map(|id| &self.graph.nodes[*id as usize]);
        nodes.all(|node| matches!(node, Node::Literal { .. }))
    }

    /// The vector of these numbers, which was looked for.
    pub fn known(&self, lanes: [Id; 3], kind: Type) -> VectorId {
        self.known[&(lanes, kind)]
    }

    /// Whether it is put together from three numbers.
    fn is_gathered(&self, id: VectorId) -> bool {
        matches!(self.list[id].form, Form::Gathered)
    }

    fn vector(&mut self, lanes: [Id; 3], kind: Type) -> VectorId {
        if let Some(id) = self.known.get(&(lanes, kind)) {
            return *id;
        }
        let form = self.form(lanes, kind);
        let id = self.list.len();
        self.list.push(Vector { lanes, kind, form });
        self.known.insert((lanes, kind), id);
        id
    }

    fn form(&mut self, lanes: [Id; 3], kind: Type) -> Form {
        let graph = self.graph;
        let nodes = lanes.map(|id| &graph.nodes[id as usize]);
        match nodes {
            [Node::Parameter(x), Node::Parameter(y), Node::Parameter(z)] => {
                let whole = self.parameters[*x as usize] == (kind, 0);
                if whole && *y == x + 1 && *z == x + 2 {
                    return Form::Parameter(*x);
                }
                Form::Gathered
            }
            [
                Node::Apply(op, a),
                Node::Apply(op_y, b),
                Node::Apply(op_z, c),
            ] => {
                let [x, y, z] = lanes.map(|id| graph.scopes[id as usize]);
                let same = op == op_y && op == op_z && x == y && x == z;
                if lanes[0] == lanes[1] && lanes[0] == lanes[2] || !same || !by_component(*op) {
                    return Form::Gathered;
                }
                let mut operands = Vec::new();
                for k in 0..a.len() {
                    let triple = [a[k], b[k], c[k]];
                    let equal = triple[0] == triple[1] && triple[0] == triple[2];
                    if !equal && *op == Op::Select && k == 0 {
                        return Form::Gathered;
                    }
                    operands.push(match equal {
                        true => Value::One(triple[0]),
                        false => Value::Three(self.vector(triple, kind)),
                    });
                }
                // Three operations become one, unless their operands are only put together for it.
                let gain = operands.iter().any(|o| match o {
                    Value::One(_) => true,
                    Value::Three(v) => !self.is_gathered(*v),
                });
                match gain {
                    true => Form::Apply(*op, operands),
                    false => Form::Gathered,
                }
            }
            _ => Form::Gathered,
        }
    }

    /// Enters the components of all vectors that are computed.
    fn take_lanes(&mut self, seeds: &[VectorId]) {
        self.lane_of.clear();
        let mut pending = seeds.to_vec();
        let mut seen = HashSet::new();
        while let Some(v) = pending.pop() {
            if !seen.insert(v) {
                continue;
            }
            if let Form::Apply(_, operands) = &self.list[v].form {
                for o in operands {
                    if let Value::Three(v) = o {
                        pending.push(*v);
                    }
                }
                for (k, id) in self.list[v].lanes.into_iter().enumerate() {
                    self.lane_of.entry(id).or_insert((v, k));
                }
            }
        }
    }

    /// A vector that needs itself, if there is one.
    fn cycle(&self, seeds: &[VectorId]) -> Option<VectorId> {
        let mut done = HashSet::new();
        let mut open = HashSet::new();
        // Values to enter, and to leave after those that they need.
        let mut pending: Vec<(Value, bool)> =
            seeds.iter().map(|v| (Value::Three(*v), false)).collect();
        while let Some((value, leave)) = pending.pop() {
            if leave {
                open.remove(&value);
                done.insert(value);
                continue;
            }
            if done.contains(&value) {
                continue;
            }
            if !open.insert(value) {
                continue;
            }
            pending.push((value, true));
            for o in self.operands(value) {
                match o {
                    Value::Three(v)
                        if open.contains(&o) && matches!(self.list[v].form, Form::Apply(..)) =>
                    {
                        return Some(v);
                    }
                    _ if open.contains(&o) => {
                        // A number between two vectors: one of those that are open needs itself.
                        return open.iter().find_map(|o| match o {
                            Value::Three(v) if !self.is_gathered(*v) => Some(*v),
                            _ => None,
                        });
                    }
                    _ => pending.push((o, false)),
                }
            }
        }
        None
    }

    /// What a value is computed from.
    pub fn operands(&self, value: Value) -> Vec<Value> {
        match value {
            Value::One(id) => {
                if let Some((v, _)) = self.lane_of.get(&id) {
                    return vec![Value::Three(*v)];
                }
                if let Some(pair) = self.dots.get(&id) {
                    return pair.map(Value::Three).to_vec();
                }
                if let Some(clamp) = self.clamps.get(&id) {
                    return clamp.map(Value::One).to_vec();
                }
                match &self.graph.nodes[id as usize] {
                    Node::Apply(_, arguments) => arguments.iter().map(|a| Value::One(*a)).collect(),
                    Node::Outcome(l, _) => {
                        let mut all = self.initial(*l);
                        all.extend(self.inputs(*l));
                        all
                    }
                    _ => Vec::new(),
                }
            }
            Value::Three(v) => match &self.list[v].form {
                Form::Parameter(_) => Vec::new(),
                Form::Gathered => self.list[v].lanes.map(Value::One).to_vec(),
                Form::Apply(_, operands) => operands.clone(),
            },
        }
    }

    /// The loop that a value comes out of.
    pub fn loop_of(&self, value: Value) -> Option<LoopId> {
        match value {
            Value::One(id) if !self.lane_of.contains_key(&id) => {
                match self.graph.nodes[id as usize] {
                    Node::Outcome(l, _) => Some(l),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// What a loop begins with.
    pub fn initial(&self, l: LoopId) -> Vec<Value> {
        let initial = self.graph.loops[l as usize].initial.iter();
        initial.map(|id| Value::One(*id)).collect()
    }

    /// What a step of a loop computes: the next state, and whether to go on.
    pub fn ends(&self, l: LoopId) -> Vec<Value> {
        let l = &self.graph.loops[l as usize];
        let ends = l.next.iter().chain([&l.go_on]);
        ends.map(|id| Value::One(*id)).collect()
    }

    /// The loop in which a value is computed.
    pub fn scope(&self, value: Value) -> Option<LoopId> {
        match value {
            Value::One(id) => self.graph.scopes[id as usize],
            Value::Three(v) => {
                let scopes = self.list[v].lanes.map(|id| self.graph.scopes[id as usize]);
                scopes.into_iter().max().flatten()
            }
        }
    }

    /// Whether a scope is the loop `l` or lies in it.
    fn is_inside(&self, mut scope: Option<LoopId>, l: LoopId) -> bool {
        while let Some(s) = scope {
            if s == l {
                return true;
            }
            scope = self.graph.loops[s as usize].parent;
        }
        false
    }

    /// What a loop's body takes from outside, in the order in which it is met.
    pub fn inputs(&self, l: LoopId) -> Vec<Value> {
        let mut pending = self.ends(l);
        let mut seen = HashSet::new();
        let mut inputs = Vec::new();
        while let Some(value) = pending.pop() {
            if !seen.insert(value) {
                continue;
            }
            if self.is_inside(self.scope(value), l) {
                pending.extend(self.operands(value));
            } else {
                inputs.push(value);
            }
        }
        inputs
    }
}

/// Whether the operation can be done on vectors component by component in every language.
fn by_component(op: Op) -> bool {
    matches!(
        op,
        Op::Add
            | Op::Sub
            | Op::Mul
            | Op::Div
            | Op::Neg
            | Op::Sqrt
            | Op::Abs
            | Op::Min
            | Op::Max
            | Op::Floor
            | Op::Exp
            | Op::Ln
            | Op::Select
    )
}

/// The two vectors of a scalar product: (a₀ b₀ + a₁ b₁) + a₂ b₂.
fn dot(graph: &Graph, id: Id) -> Option<[[Id; 3]; 2]> {
    let two = |id: Id, wanted: Op| match &graph.nodes[id as usize] {
        Node::Apply(op, a) if *op == wanted => Some((a[0], a[1])),
        _ => None,
    };
    let (left, z) = two(id, Op::Add)?;
    let (x, y) = two(left, Op::Add)?;
    let [x, y, z] = [two(x, Op::Mul)?, two(y, Op::Mul)?, two(z, Op::Mul)?];
    Some([[x.0, y.0, z.0], [x.1, y.1, z.1]])
}

/// min(max(x, low), high) where nothing else needs the inner one.
fn clamp(graph: &Graph, id: Id, used: &[usize]) -> Option<[Id; 3]> {
    let Node::Apply(Op::Min, outer) = &graph.nodes[id as usize] else {
        return None;
    };
    let Node::Apply(Op::Max, inner) = &graph.nodes[outer[0] as usize] else {
        return None;
    };
    let literal = |id: Id| match graph.nodes[id as usize] {
        Node::Literal { bits, truth: false } => Some(f32::from_bits(bits)),
        _ => None,
    };
    // The order of the limits matters, so only those that are known.
    let ordered = literal(inner[1])? <= literal(outer[1])?;
    let alone = used[outer[0] as usize] == 1
        && graph.scopes[id as usize] == graph.scopes[outer[0] as usize];
    (ordered && alone).then_some([inner[0], inner[1], outer[1]])
}
