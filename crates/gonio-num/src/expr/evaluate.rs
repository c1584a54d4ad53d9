//! An interpreter of recorded functions.

use super::tape::{Graph, Id, Loop, Node, Statement};

/// The values of `outputs` for the parameters' components `arguments`.
pub(super) fn evaluate(graph: &Graph, arguments: &[f32], outputs: &[Id]) -> Vec<f32> {
    let mut run = Run {
        graph,
        values: vec![0; graph.nodes.len()],
    };
    for (id, node) in graph.nodes.iter().enumerate() {
        match node {
            Node::Literal { bits, .. } => run.values[id] = *bits,
            Node::Parameter(i) => run.values[id] = arguments[*i as usize].to_bits(),
            _ => {}
        }
    }
    run.block(&graph.body);
    outputs
        .iter()
        .map(|id| f32::from_bits(run.values[*id as usize]))
        .collect()
}

struct Run<'a> {
    graph: &'a Graph,
    /// The bits of each node evaluated so far.
    values: Vec<u32>,
}

impl<'a> Run<'a> {
    fn block(&mut self, statements: &'a [Statement]) {
        for statement in statements {
            match *statement {
                Statement::Loop(id) => self.run_loop(&self.graph.loops[id as usize]),
                Statement::Evaluate(id) => {
                    if let Node::Apply(op, arguments) = &self.graph.nodes[id as usize] {
                        let mut bits = [0; 3];
                        for (bits, a) in bits.iter_mut().zip(arguments.iter()) {
                            *bits = self.values[*a as usize];
                        }
                        self.values[id as usize] = self.graph.apply(*op, &bits[..arguments.len()]);
                    }
                }
            }
        }
    }

    fn run_loop(&mut self, the_loop: &'a Loop) {
        let mut state = self.all(&the_loop.initial);
        for step in 0..the_loop.count {
            self.values[the_loop.step as usize] = (step as f32).to_bits();
            self.set(&the_loop.state, &state);
            self.block(&the_loop.body);
            state = self.all(&the_loop.next);
            if self.values[the_loop.go_on as usize] == 0 {
                break;
            }
        }
        self.set(&the_loop.outcome, &state);
    }

    fn all(&self, ids: &[Id]) -> Vec<u32> {
        ids.iter().map(|id| self.values[*id as usize]).collect()
    }

    fn set(&mut self, ids: &[Id], bits: &[u32]) {
        for (id, bits) in ids.iter().zip(bits) {
            self.values[*id as usize] = *bits;
        }
    }
}
