//! How often values are needed, and what follows from fixed parameters.

use super::function::Parameter;
use super::tape::{Graph, Id, LoopId, Node};
use super::vectors::{Value, VectorId, Vectors};
use std::collections::{HashMap, HashSet};

/// For each node how often it is needed.
pub(super) fn raw_uses(graph: &Graph, outputs: &[Id]) -> Vec<usize> {
    let mut uses = vec![0; graph.nodes.len()];
    let mut loops_seen = vec![false; graph.loops.len()];
    let mut pending: Vec<Id> = outputs.to_vec();
    while let Some(id) = pending.pop() {
        uses[id as usize] += 1;
        if uses[id as usize] > 1 {
            continue;
        }
        match &graph.nodes[id as usize] {
            Node::Apply(_, arguments) => pending.extend(arguments.iter()),
            Node::Outcome(l, _) if !loops_seen[*l as usize] => {
                loops_seen[*l as usize] = true;
                let l = &graph.loops[*l as usize];
                pending.extend(l.initial.iter().chain(&l.next).chain([&l.go_on]));
            }
            _ => {}
        }
    }
    uses
}

/// How often a value is needed, and the scope of the last use found: the only one, if there is one use.
pub(super) type Uses = HashMap<Value, (usize, Option<LoopId>)>;

/// The uses of each value, and the vectors of which single components are used.
pub(super) fn uses(vectors: &Vectors<'_>, roots: &[Value]) -> (Uses, HashSet<VectorId>) {
    let mut uses: Uses = HashMap::new();
    let mut lanes_used = HashSet::new();
    let mut loops_seen = HashSet::new();
    let mut pending: Vec<(Value, Option<LoopId>)> = roots.iter().map(|r| (*r, None)).collect();
    while let Some((value, user)) = pending.pop() {
        let entry = uses.entry(value).or_insert((0, None));
        *entry = (entry.0 + 1, user);
        if entry.0 > 1 {
            continue;
        }
        if let Some(l) = vectors.loop_of(value) {
            // A loop is printed once for all that comes out of it.
            if loops_seen.insert(l) {
                let initial = vectors
                    .initial(l)
                    .into_iter()
                    .map(|i| (i, vectors.scope(value)));
                pending.extend(initial);
                pending.extend(vectors.ends(l).into_iter().map(|end| (end, Some(l))));
            }
            continue;
        }
        let scope = vectors.scope(value);
        for o in vectors.operands(value) {
            if let (Value::One(id), Value::Three(v)) = (value, o)
                && vectors.list[v].lanes.contains(&id)
            {
                lanes_used.insert(v);
            }
            pending.push((o, scope));
        }
    }
    (uses, lanes_used)
}

/// Whether each node follows from literals and fixed parameters alone.
pub(super) fn fixed_nodes(graph: &Graph, parameters: &[Parameter]) -> Vec<bool> {
    let mut components = Vec::new();
    for p in parameters {
        components.extend((0..p.width()).map(|_| p.fixed.is_some()));
    }
    let mut fixed: Vec<bool> = Vec::with_capacity(graph.nodes.len());
    for node in &graph.nodes {
        fixed.push(match node {
            Node::Literal { .. } => true,
            Node::Parameter(i) => components[*i as usize],
            Node::Apply(_, arguments) => arguments.iter().all(|a| fixed[*a as usize]),
            Node::Step(_) | Node::State(..) | Node::Outcome(..) => false,
        });
    }
    fixed
}
