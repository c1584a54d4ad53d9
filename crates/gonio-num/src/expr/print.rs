//! WGSL text of a recorded function.

use super::tape::{Graph, Id, Loop, LoopId, Node, Op, Statement};
use super::{Field, FieldValue, Output, Parameter};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Longest expression that is written into the one place that uses it, in characters.
const LONGEST_INLINE: usize = 60;

/// How tightly the outermost operator of a text binds, the loosest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Logic,
    Sum,
    Product,
    Sign,
    Atom,
}

/// The text of a value.
#[derive(Debug, Clone)]
struct Text {
    text: String,
    binding: Binding,
}

impl Text {
    fn atom(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            binding: Binding::Atom,
        }
    }

    /// The text as an operand that needs at least this binding.
    fn at_least(&self, binding: Binding) -> String {
        if self.binding >= binding {
            self.text.clone()
        } else {
            format!("({})", self.text)
        }
    }
}

/// Declarations that the function needs, by name, and the function itself.
pub(super) struct Printed {
    pub declarations: BTreeMap<String, String>,
    pub function: String,
}

/// Prints the function; `taken` are the names that its locals keep off.
pub(super) fn print(
    graph: &Graph,
    name: &str,
    parameters: &[Parameter],
    output: &Output,
    taken: BTreeSet<String>,
) -> Printed {
    let outputs = output.ids();
    let mut printer = Printer {
        graph,
        components: parameters.iter().flat_map(Parameter::components).collect(),
        uses: uses(graph, &outputs),
        texts: vec![None; graph.nodes.len()],
        taken,
        values: 0,
        code: String::new(),
        indent: 1,
        declarations: BTreeMap::new(),
    };
    printer.block(&graph.body, None);
    let result = printer.output(output);
    let mut function = format!("fn {name}(");
    for (i, p) in parameters.iter().enumerate() {
        let comma = if i == 0 { "" } else { ", " };
        let _ = write!(function, "{comma}{}: {}", p.name(), p.wgsl_type());
    }
    let _ = write!(
        function,
        ") -> {} {{\n{}    return {result};\n}}\n",
        output.wgsl_type(),
        printer.code
    );
    Printed {
        declarations: printer.declarations,
        function,
    }
}

/// For each node how often the result needs it, and the scope of the last use found: the only one, if there is one use.
fn uses(graph: &Graph, outputs: &[Id]) -> Vec<(usize, Option<LoopId>)> {
    let mut uses = vec![(0, None); graph.nodes.len()];
    let mut loops_seen = vec![false; graph.loops.len()];
    let mut pending: Vec<(Id, Option<LoopId>)> = outputs.iter().map(|o| (*o, None)).collect();
    while let Some((id, user)) = pending.pop() {
        uses[id as usize].0 += 1;
        uses[id as usize].1 = user;
        if uses[id as usize].0 > 1 {
            continue;
        }
        match &graph.nodes[id as usize] {
            Node::Apply(_, arguments) => {
                let scope = graph.scopes[id as usize];
                pending.extend(arguments.iter().map(|a| (*a, scope)));
            }
            Node::Outcome(l, _) if !loops_seen[*l as usize] => {
                loops_seen[*l as usize] = true;
                let l_ref = &graph.loops[*l as usize];
                pending.extend(l_ref.initial.iter().map(|i| (*i, l_ref.parent)));
                let inside = l_ref.next.iter().chain([&l_ref.go_on]);
                pending.extend(inside.map(|n| (*n, Some(*l))));
            }
            _ => {}
        }
    }
    uses
}

struct Printer<'a> {
    graph: &'a Graph,
    components: Vec<String>,
    uses: Vec<(usize, Option<LoopId>)>,
    texts: Vec<Option<Text>>,
    taken: BTreeSet<String>,
    values: usize,
    code: String,
    indent: usize,
    declarations: BTreeMap<String, String>,
}

impl Printer<'_> {
    fn line(&mut self, text: &str) {
        for _ in 0..self.indent {
            self.code.push_str("    ");
        }
        self.code.push_str(text);
        self.code.push('\n');
    }

    /// An unused name for a local value.
    fn local(&mut self, prefix: &str) -> String {
        loop {
            self.values += 1;
            let name = format!("{prefix}{}", self.values);
            if self.taken.insert(name.clone()) {
                return name;
            }
        }
    }

    fn block(&mut self, statements: &[Statement], scope: Option<LoopId>) {
        for statement in statements {
            match *statement {
                Statement::Loop(id) => self.print_loop(id),
                Statement::Evaluate(id) => {
                    let (count, user) = self.uses[id as usize];
                    if count == 0 {
                        continue;
                    }
                    let text = self.expression(id);
                    let text = if count == 1
                        && user == scope
                        && text.text.chars().count() <= LONGEST_INLINE
                    {
                        text
                    } else {
                        let name = self.local("v");
                        self.line(&format!("let {name} = {};", text.text));
                        Text::atom(name)
                    };
                    self.texts[id as usize] = Some(text);
                }
            }
        }
    }

    fn print_loop(&mut self, id: LoopId) {
        let l: &Loop = &self.graph.loops[id as usize];
        if l.outcome.iter().all(|o| self.uses[*o as usize].0 == 0) {
            return;
        }
        let mut variables = Vec::new();
        for initial in &l.initial {
            let name = self.local("state");
            let initial = self.text(*initial).text;
            self.line(&format!("var {name}: f32 = {initial};"));
            variables.push(name);
        }
        let counter = self.local("step");
        self.line(&format!(
            "for (var {counter} = 0u; {counter} < {}u; {counter}++) {{",
            l.count
        ));
        self.indent += 1;
        self.texts[l.step as usize] = Some(Text::atom(format!("f32({counter})")));
        for (state, variable) in l.state.iter().zip(&variables) {
            if self.uses[*state as usize].0 > 0 {
                let name = self.local("v");
                self.line(&format!("let {name} = {variable};"));
                self.texts[*state as usize] = Some(Text::atom(name));
            }
        }
        self.block(&l.body, Some(id));
        for (next, variable) in l.next.iter().zip(&variables) {
            let next = self.text(*next).text;
            self.line(&format!("{variable} = {next};"));
        }
        match self.graph.nodes[l.go_on as usize] {
            Node::Literal { bits: 1, .. } => {}
            Node::Literal { .. } => self.line("break;"),
            _ => {
                let go_on = self.text(l.go_on).text;
                self.line(&format!("if !({go_on}) {{"));
                self.indent += 1;
                self.line("break;");
                self.indent -= 1;
                self.line("}");
            }
        }
        self.indent -= 1;
        self.line("}");
        for (outcome, variable) in l.outcome.iter().zip(variables) {
            self.texts[*outcome as usize] = Some(Text::atom(variable));
        }
    }

    /// The text that stands for a value where it is used.
    fn text(&mut self, id: Id) -> Text {
        match &self.graph.nodes[id as usize] {
            Node::Literal { bits, truth: true } => Text::atom((*bits == 1).to_string()),
            Node::Literal { bits, .. } => self.number(f32::from_bits(*bits)),
            Node::Parameter(i) => Text::atom(&self.components[*i as usize]),
            _ => self.texts[id as usize]
                .clone()
                .expect("invariant: a value is printed before its users"),
        }
    }

    /// A literal that reads back as the same bits.
    fn number(&mut self, x: f32) -> Text {
        let (name, bits) = if x.is_nan() {
            ("gonio_nan_bits", 0x7fc0_0000u32)
        } else if x.is_infinite() {
            ("gonio_infinity_bits", 0x7f80_0000)
        } else {
            let binding = if x.is_sign_negative() {
                Binding::Sign
            } else {
                Binding::Atom
            };
            return Text {
                text: format!("{x:?}f"),
                binding,
            };
        };
        // WGSL refuses constants that aren't finite, so the bits come from a variable.
        self.declarations.insert(
            name.into(),
            format!("var<private> {name}: u32 = {bits:#x}u;\n"),
        );
        let sign = if x == f32::NEG_INFINITY { "-" } else { "" };
        Text {
            text: format!("{sign}bitcast<f32>({name})"),
            binding: Binding::Sign,
        }
    }

    /// The text of an operation, from those of its arguments.
    fn expression(&mut self, id: Id) -> Text {
        let Node::Apply(op, arguments) = &self.graph.nodes[id as usize] else {
            unreachable!("only operations are evaluated in a block")
        };
        let a: Vec<Text> = arguments.iter().map(|a| self.text(*a)).collect();
        let infix = |sign: &str, binding: Binding, left: Binding, right: Binding| Text {
            text: format!("{} {sign} {}", a[0].at_least(left), a[1].at_least(right)),
            binding,
        };
        let call = |function: &str| {
            let texts: Vec<&str> = a.iter().map(|t| t.text.as_str()).collect();
            Text::atom(format!("{function}({})", texts.join(", ")))
        };
        // The right operand binds tighter, so that the order of evaluation stays as recorded.
        match op {
            Op::Add => infix("+", Binding::Sum, Binding::Sum, Binding::Product),
            Op::Sub => infix("-", Binding::Sum, Binding::Sum, Binding::Product),
            Op::Mul => infix("*", Binding::Product, Binding::Product, Binding::Atom),
            Op::Div => infix("/", Binding::Product, Binding::Product, Binding::Atom),
            Op::Less => infix("<", Binding::Logic, Binding::Sum, Binding::Sum),
            Op::LessEqual => infix("<=", Binding::Logic, Binding::Sum, Binding::Sum),
            Op::And => infix("&", Binding::Logic, Binding::Atom, Binding::Atom),
            Op::Or => infix("|", Binding::Logic, Binding::Atom, Binding::Atom),
            Op::Neg => Text {
                text: format!("-{}", a[0].at_least(Binding::Atom)),
                binding: Binding::Sign,
            },
            Op::Not => Text {
                text: format!("!{}", a[0].at_least(Binding::Atom)),
                binding: Binding::Sign,
            },
            Op::Sqrt => call("sqrt"),
            Op::Abs => call("abs"),
            Op::Min => call("min"),
            Op::Max => call("max"),
            Op::Floor => call("floor"),
            Op::Exp => call("exp"),
            Op::Ln => call("log"),
            Op::Sin => call("sin"),
            Op::Cos => call("cos"),
            Op::Acos => Text::atom(format!("acos(clamp({}, -1.0f, 1.0f))", a[0].text)),
            Op::Atan2 => {
                // WGSL leaves the angle of the origin open.
                self.declarations.insert("gonio_atan2".into(), ATAN2.into());
                call("gonio_atan2")
            }
            Op::Select => Text::atom(format!(
                "select({}, {}, {})",
                a[2].text, a[1].text, a[0].text
            )),
            Op::Table1(t) => {
                let table = self.graph.tables1[*t as usize];
                let text = super::tables::table1(table);
                self.declarations.insert(table.name.into(), text);
                call(&format!("{}_at", table.name))
            }
            Op::Table2(t) => {
                let table = self.graph.tables2[*t as usize];
                let text = super::tables::table2(table);
                self.declarations.insert(table.name.into(), text);
                call(&format!("{}_at", table.name))
            }
            Op::Table3(t) => {
                let table = self.graph.tables3[*t as usize];
                let text = super::tables::table3(table);
                self.declarations.insert(table.name.into(), text);
                call(&format!("{}_at", table.name))
            }
        }
    }

    fn output(&mut self, output: &Output) -> String {
        let ids = output.ids();
        let texts: Vec<String> = ids.iter().map(|id| self.text(*id).text).collect();
        match output {
            Output::Scalar(_) => texts[0].clone(),
            Output::Vector(_) | Output::Array(_) => {
                format!("{}({})", output.wgsl_type(), texts.join(", "))
            }
            Output::Struct { name, fields } => {
                let mut declaration = format!("struct {name} {{\n");
                let mut texts = texts.into_iter();
                let mut arguments = Vec::new();
                for Field { name, value } in fields {
                    let kind = match value {
                        FieldValue::Scalar(_) => {
                            arguments.extend(texts.next());
                            "f32"
                        }
                        FieldValue::Vector(_) => {
                            let components: Vec<String> = texts.by_ref().take(3).collect();
                            arguments.push(format!("vec3<f32>({})", components.join(", ")));
                            "vec3<f32>"
                        }
                    };
                    let _ = writeln!(declaration, "    {name}: {kind},");
                }
                declaration.push_str("}\n");
                self.declarations.insert(name.clone(), declaration);
                format!("{name}({})", arguments.join(", "))
            }
        }
    }
}

const ATAN2: &str = "\
// The angle of (x, y); 0 at the origin.
fn gonio_atan2(y: f32, x: f32) -> f32 {
    return select(atan2(y, x), 0.0f, (x == 0.0f) & (y == 0.0f));
}
";
