//! The text of a recorded function, in any of the languages.

use super::function::{Parameter, Returned};
use super::language::{Dialect, Type};
use super::tables;
use super::tape::{Graph, Id, Loop, LoopId, Node, Op};
use super::text::{Binding, Text, call, not, simple};
use super::uses::{Uses, fixed_nodes, raw_uses, uses};
use super::vectors::{Form, Value, VectorId, Vectors};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// Longest expression that is written into the one place that uses it, in characters.
const LONGEST_INLINE: usize = 60;
/// Longest expression of a line, if it can be helped.
const LONGEST: usize = 92;

/// What a function's text consists of.
pub(super) struct Printed {
    /// Helpers that the function needs, by name.
    pub declarations: BTreeMap<String, String>,
    /// Places of the fixed parameters that it uses.
    pub fixed: BTreeSet<usize>,
    pub function: String,
}

/// A function to be printed.
pub(super) struct Job<'a> {
    pub dialect: &'static Dialect,
    /// Stands in front of the names of tables, helpers and fixed parameters.
    pub prefix: &'a str,
    pub graph: &'a Graph,
    pub name: &'a str,
    pub parameters: &'a [Parameter],
    pub returned: &'a Returned,
    /// Names that the locals keep off.
    pub taken: BTreeSet<String>,
}

/// Prints the function.
pub(super) fn print(job: Job<'_>) -> Printed {
    let roots = job.returned.ids();
    let used = raw_uses(job.graph, &roots);
    let mut components = Vec::new();
    for p in job.parameters {
        components.extend((0..p.width()).map(|k| (p.kind, k)));
    }
    let vectors = Vectors::find(job.graph, &components, &job.returned.vectors(), &used);
    let roots = job.returned.values(&vectors);
    let (counts, lanes_used) = uses(&vectors, &roots);
    let mut printer = Printer {
        texts: HashMap::new(),
        fixed_nodes: fixed_nodes(job.graph, job.parameters),
        values: 0,
        code: String::new(),
        indent: 1,
        declarations: BTreeMap::new(),
        fixed: BTreeSet::new(),
        counts,
        lanes_used,
        roots: roots.clone(),
        vectors,
        job,
    };
    printer.aliases();
    printer.derived(&roots);
    printer.output(&roots);
    let job = &printer.job;
    let arguments: Vec<String> = job
        .parameters
        .iter()
        .filter(|p| p.fixed.is_none())
        .map(|p| job.dialect.typed(job.dialect.type_name(p.kind), &p.name))
        .collect();
    let returns = job.returned.type_name(job.dialect);
    let mut function = job.dialect.head(job.name, &arguments, &returns);
    function.push_str(&printer.code);
    function.push_str("}\n");
    Printed {
        declarations: printer.declarations,
        fixed: printer.fixed,
        function,
    }
}

struct Printer<'a> {
    job: Job<'a>,
    vectors: Vectors<'a>,
    counts: Uses,
    lanes_used: HashSet<VectorId>,
    /// What is returned.
    roots: Vec<Value>,
    fixed_nodes: Vec<bool>,
    texts: HashMap<Value, Text>,
    values: usize,
    code: String,
    indent: usize,
    declarations: BTreeMap<String, String>,
    fixed: BTreeSet<usize>,
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
            if self.job.taken.insert(name.clone()) {
                return name;
            }
        }
    }

    /// Declares a local value and gives its name.
    fn declare(&mut self, kind: Type, text: &str) -> Text {
        let name = self.local("v");
        let dialect = self.job.dialect;
        self.line(&dialect.value(dialect.type_name(kind), &name, text));
        Text::atom(name)
    }

    /// Where a vector constant is a macro, its components are reached through a local value.
    fn aliases(&mut self) {
        let dialect = self.job.dialect;
        if dialect.has_macros() {
            for place in 0..self.job.parameters.len() {
                let p = &self.job.parameters[place];
                let first = self.first_component(place);
                if p.fixed.is_none() || p.kind == Type::Number || !self.uses_parameter(first) {
                    continue;
                }
                let name = alias(dialect, &p.name);
                let value = format!("{}{}", self.job.prefix, p.name);
                self.line(&dialect.value(dialect.type_name(p.kind), &name, &value));
                self.fixed.insert(place);
            }
        }
    }

    fn first_component(&self, place: usize) -> u32 {
        self.job.parameters[..place]
            .iter()
            .map(|p| p.width() as u32)
            .sum()
    }

    /// Whether a component of the vector parameter that begins at this component is used.
    fn uses_parameter(&self, first: u32) -> bool {
        self.counts.keys().any(|value| match *value {
            Value::One(id) => match self.job.graph.nodes[id as usize] {
                Node::Parameter(i) => (first..first + 3).contains(&i),
                _ => false,
            },
            Value::Three(v) => {
                matches!(self.vectors.list[v].form, Form::Parameter(i) if i == first)
            }
        })
    }

    fn is_fixed(&self, value: Value) -> bool {
        match value {
            Value::One(id) => self.fixed_nodes[id as usize],
            Value::Three(v) => self.vectors.list[v]
                .lanes
                .iter()
                .all(|id| self.fixed_nodes[*id as usize]),
        }
    }

    /// Prints first what follows from the fixed parameters alone.
    fn derived(&mut self, roots: &[Value]) {
        let start = self.code.len();
        let mut pending: Vec<Value> = roots.iter().rev().copied().collect();
        let mut seen = HashSet::new();
        while let Some(value) = pending.pop() {
            if !seen.insert(value) {
                continue;
            }
            if self.is_fixed(value) {
                self.text(value);
                continue;
            }
            let mut next = self.vectors.operands(value);
            if let Some(l) = self.vectors.loop_of(value) {
                next.extend(self.vectors.ends(l));
            }
            pending.extend(next.into_iter().rev());
        }
        if self.code.len() > start {
            self.code
                .insert_str(start, "    // What follows from the parameters alone.\n");
            self.code.push('\n');
        }
    }

    /// The text that stands for a value where it is used; what it needs is printed before.
    fn text(&mut self, value: Value) -> Text {
        if let Some(text) = self.texts.get(&value) {
            return text.clone();
        }
        let text = match value {
            Value::One(id) => self.number(id),
            Value::Three(v) => self.vector(v),
        };
        self.texts.insert(value, text.clone());
        text
    }

    fn number(&mut self, id: Id) -> Text {
        let graph = self.job.graph;
        let dialect = self.job.dialect;
        if let Some((v, lane)) = self.vectors.lane_of.get(&id).copied() {
            let whole = self.text(Value::Three(v)).text;
            return Text::atom(format!("{whole}{}", dialect.components[lane]));
        }
        match &graph.nodes[id as usize] {
            Node::Literal { bits, truth: true } => Text::atom(dialect.literals[*bits as usize]),
            Node::Literal { bits, .. } => self.literal(f32::from_bits(*bits)),
            Node::Parameter(i) => self.component(*i),
            Node::Outcome(l, k) => {
                self.print_loop(*l);
                let outcome = graph.loops[*l as usize].outcome[*k as usize];
                self.texts[&Value::One(outcome)].clone()
            }
            Node::Step(_) | Node::State(..) => {
                unreachable!("invariant: a loop gives these their texts before its body is printed")
            }
            Node::Apply(op, arguments) => {
                let kind = match op {
                    Op::Less | Op::LessEqual | Op::And | Op::Or | Op::Not => Type::Truth,
                    Op::Select => self.kind(arguments[1]),
                    _ => Type::Number,
                };
                let operands = self.vectors.operands(Value::One(id));
                let text = if self.vectors.dots.contains_key(&id) {
                    self.fitting(&operands, &|a, _| call("dot", a))
                } else if self.vectors.clamps.contains_key(&id) {
                    self.fitting(&operands, &|a, _| call("clamp", a))
                } else {
                    self.operation(*op, &operands, kind)
                };
                self.settled(Value::One(id), kind, text)
            }
        }
    }

    fn kind(&self, id: Id) -> Type {
        match &self.job.graph.nodes[id as usize] {
            Node::Literal { truth: true, .. } => Type::Truth,
            Node::Apply(Op::Less | Op::LessEqual | Op::And | Op::Or | Op::Not, _) => Type::Truth,
            Node::Apply(Op::Select, arguments) => self.kind(arguments[1]),
            _ => Type::Number,
        }
    }

    /// A component of the parameters.
    fn component(&mut self, i: u32) -> Text {
        let mut first = 0;
        for place in 0..self.job.parameters.len() {
            let p = &self.job.parameters[place];
            let k = (i - first) as usize;
            if k >= p.width() {
                first += p.width() as u32;
                continue;
            }
            let component = match p.kind {
                Type::Number | Type::Truth => "",
                _ => self.job.dialect.components[k],
            };
            let text = format!("{}{component}", self.parameter(place));
            return Text::atom(text);
        }
        unreachable!("invariant: a component belongs to a parameter")
    }

    /// What a parameter is called inside the function.
    fn parameter(&mut self, place: usize) -> String {
        let p = &self.job.parameters[place];
        if p.fixed.is_none() {
            return p.name.clone();
        }
        self.fixed.insert(place);
        if self.job.dialect.has_macros() && p.kind != Type::Number {
            return alias(self.job.dialect, &p.name);
        }
        format!("{}{}", self.job.prefix, p.name)
    }

    fn vector(&mut self, v: VectorId) -> Text {
        let vector = self.vectors.list[v].clone();
        let operands = self.vectors.operands(Value::Three(v));
        let text = match vector.form {
            Form::Parameter(first) => {
                let place = (0..self.job.parameters.len())
                    .find(|place| self.first_component(*place) == first)
                    .expect("invariant: a vector parameter begins here");
                return Text::atom(self.parameter(place));
            }
            Form::Gathered => {
                let dialect = self.job.dialect;
                self.fitting(&operands, &|a, _| {
                    let [x, y, z] = a else {
                        unreachable!("invariant: a vector has three components")
                    };
                    Text::atom(dialect.vector(vector.kind, [&x.text, &y.text, &z.text]))
                })
            }
            Form::Apply(op, _) => self.operation(op, &operands, vector.kind),
        };
        self.settled(Value::Three(v), vector.kind, text)
    }

    /// The text itself where there is one short use in the same scope; else the name of a local value with it.
    fn settled(&mut self, value: Value, kind: Type, text: Text) -> Text {
        let (count, user) = self.counts.get(&value).copied().unwrap_or_default();
        let short = text.text.chars().count() <= LONGEST_INLINE;
        let by_lane = matches!(value, Value::Three(v) if self.lanes_used.contains(&v));
        if matches!(value, Value::Three(v) if self.vectors.is_literal(v) && !by_lane) {
            return text;
        }
        let short = short || self.roots.contains(&value);
        if count <= 1 && user == self.vectors.scope(value) && short && !by_lane {
            return text;
        }
        self.declare(kind, &text.text)
    }

    /// What `build` makes of the operands' texts. As long as that is too long, the longest of them becomes a local value.
    fn fitting(&mut self, operands: &[Value], build: &dyn Fn(&[Text], &Dialect) -> Text) -> Text {
        let mut texts: Vec<Text> = operands.iter().map(|o| self.text(*o)).collect();
        loop {
            let text = build(&texts, self.job.dialect);
            if text.text.chars().count() <= LONGEST {
                return text;
            }
            let longest = (0..texts.len())
                .filter(|k| texts[*k].text.contains(' '))
                .max_by_key(|k| texts[*k].text.len());
            let Some(k) = longest else { return text };
            let kind = match operands[k] {
                Value::One(id) => self.kind(id),
                Value::Three(v) => self.vectors.list[v].kind,
            };
            let named = self.declare(kind, &texts[k].text);
            self.texts.insert(operands[k], named.clone());
            for (o, text) in operands.iter().zip(&mut texts) {
                if *o == operands[k] {
                    *text = named.clone();
                }
            }
        }
    }

    /// The text of an operation that gives a `kind`.
    fn operation(&mut self, op: Op, operands: &[Value], kind: Type) -> Text {
        let wide = matches!(kind, Type::Vector | Type::Colour);
        // Calls take vectors only, arithmetic also a vector and a number.
        let three = |d: &Dialect, o: usize, a: &[Text]| match operands[o] {
            Value::One(_) if wide => d.vector(kind, [&a[o].text; 3]),
            _ => a[o].text.clone(),
        };
        match op {
            Op::Atan2 => {
                let name = self.helper("atan2", tables::atan2);
                self.fitting(operands, &|a, _| call(&name, a))
            }
            Op::Table1(t) => {
                let table = self.job.graph.tables1[t as usize];
                let name = self.table(table.name, |d, name| tables::table1(d, name, table));
                self.fitting(operands, &|a, _| call(&name, a))
            }
            Op::Table2(t) => {
                let table = self.job.graph.tables2[t as usize];
                let name = self.table(table.name, |d, name| tables::table2(d, name, table));
                self.fitting(operands, &|a, _| call(&name, a))
            }
            Op::Table3(t) => {
                let table = self.job.graph.tables3[t as usize];
                let name = self.table(table.name, |d, name| tables::table3(d, name, table));
                self.fitting(operands, &|a, _| call(&name, a))
            }
            Op::Acos if !self.is_within_one(operands[0]) => self.fitting(operands, &|a, d| {
                let [low, high] = [-1.0, 1.0].map(|x| d.number(x));
                Text::atom(format!("acos(clamp({}, {low}, {high}))", a[0].text))
            }),
            Op::Min | Op::Max => self.fitting(operands, &|a, d| {
                let name = if op == Op::Min { "min" } else { "max" };
                let texts = [three(d, 0, a), three(d, 1, a)];
                Text::atom(format!("{name}({})", texts.join(", ")))
            }),
            Op::Select => self.fitting(operands, &|a, d| {
                let (yes, no) = (three(d, 1, a), three(d, 2, a));
                if d.is_wgsl() {
                    return Text::atom(format!("select({no}, {yes}, {})", a[0].text));
                }
                let mask = a[0].at_least(Binding::Logic);
                let arm = |k: usize| match operands[k] {
                    Value::One(_) if wide => three(d, k, a),
                    _ => a[k].at_least(Binding::Logic),
                };
                let (yes, no) = (arm(1), arm(2));
                Text::new(format!("{mask} ? {yes} : {no}"), Binding::Choice)
            }),
            _ => self.fitting(operands, &|a, _| simple(op, a)),
        }
    }

    /// Whether it is limited to a range in [−1, 1], so that it is the cosine of an angle.
    fn is_within_one(&self, value: Value) -> bool {
        let limit = |id: Id| match self.job.graph.nodes[id as usize] {
            Node::Literal { bits, .. } => f32::from_bits(bits).abs() <= 1.0,
            _ => false,
        };
        match value {
            Value::One(id) => {
                let clamp = self.vectors.clamps.get(&id);
                clamp.is_some_and(|[_, low, high]| limit(*low) && limit(*high))
            }
            Value::Three(_) => false,
        }
    }

    /// The name of a helper function, which is declared.
    fn helper(&mut self, name: &str, text: fn(&Dialect, &str) -> String) -> String {
        let full = match self.job.prefix {
            "" => format!("gonio_{name}"),
            prefix => format!("{prefix}{name}"),
        };
        let text = text(self.job.dialect, &full);
        self.declarations.insert(full.clone(), text);
        full
    }

    /// The name of a table's look-up, which is declared.
    fn table(&mut self, name: &str, text: impl Fn(&Dialect, &str) -> String) -> String {
        let full = format!("{}{name}", self.job.prefix);
        self.declarations
            .entry(full.clone())
            .or_insert_with(|| text(self.job.dialect, &full));
        format!("{full}_at")
    }

    /// A literal that reads back as the same bits.
    fn literal(&mut self, x: f32) -> Text {
        let dialect = self.job.dialect;
        if x.is_finite() {
            let binding = match x.is_sign_negative() {
                true => Binding::Sign,
                false => Binding::Atom,
            };
            return Text::new(dialect.number(x), binding);
        }
        let (name, bits) = match x.is_nan() {
            true => ("nan", "0x7fc00000"),
            false => ("infinity", "0x7f800000"),
        };
        let sign = if x == f32::NEG_INFINITY { "-" } else { "" };
        let text = if dialect.is_wgsl() {
            // WGSL refuses constants that aren't finite, so the bits come from a variable.
            let name = format!("gonio_{name}_bits");
            let declaration = format!("var<private> {name}: u32 = {bits}u;\n");
            self.declarations.insert(name.clone(), declaration);
            format!("{sign}bitcast<f32>({name})")
        } else {
            format!("{sign}{}", dialect.not_finite(bits))
        };
        Text::new(text, Binding::Sign)
    }

    fn print_loop(&mut self, id: LoopId) {
        let graph = self.job.graph;
        let l: &Loop = &graph.loops[id as usize];
        let d = self.job.dialect;
        let number = d.type_name(Type::Number);
        for input in self.vectors.inputs(id) {
            self.text(input);
        }
        let mut variables = Vec::new();
        for initial in &l.initial {
            let initial = self.text(Value::One(*initial)).text;
            let name = self.local("state");
            self.line(&d.variable(number, &name, Some(&initial)));
            variables.push(name);
        }
        let counter = self.local("step");
        let start = match d.is_wgsl() {
            true => format!("var {counter} = 0"),
            false => format!("{} {counter} = 0", d.integer),
        };
        let count = l.count;
        self.line(&format!(
            "for ({start}; {counter} < {count}; {counter}++) {{"
        ));
        self.indent += 1;
        let step = Text::new(format!("{}({counter})", d.to_number), Binding::Atom);
        self.texts.insert(Value::One(l.step), step);
        for (state, variable) in l.state.iter().zip(&variables) {
            if self.counts.contains_key(&Value::One(*state)) {
                let name = self.declare(Type::Number, variable);
                self.texts.insert(Value::One(*state), name);
            }
        }
        let next: Vec<String> = l
            .next
            .iter()
            .map(|next| self.text(Value::One(*next)).text)
            .collect();
        let go_on = match graph.nodes[l.go_on as usize] {
            Node::Literal { bits, .. } => Err(bits == 1),
            _ => Ok(self.text(Value::One(l.go_on))),
        };
        for (next, variable) in next.iter().zip(&variables) {
            self.line(&format!("{variable} = {next};"));
        }
        match go_on {
            Err(true) => {}
            Err(false) => self.line("break;"),
            Ok(go_on) => {
                self.line(&format!("if ({}) {{", not(&go_on).text));
                self.indent += 1;
                self.line("break;");
                self.indent -= 1;
                self.line("}");
            }
        }
        self.indent -= 1;
        self.line("}");
        for (outcome, variable) in l.outcome.iter().zip(variables) {
            self.texts
                .insert(Value::One(*outcome), Text::atom(variable));
        }
    }

    fn output(&mut self, roots: &[Value]) {
        let d = self.job.dialect;
        let texts: Vec<String> = roots.iter().map(|r| self.text(*r).text).collect();
        let returned = self.job.returned;
        if let Some(structure) = &returned.structure {
            let kind = returned.type_name(d);
            let name = match self.job.taken.insert("result".into()) {
                true => "result".into(),
                false => self.local("result"),
            };
            self.line(&d.variable(&kind, &name, None));
            for (field, text) in structure.fields.iter().zip(&texts) {
                self.line(&format!("{name}.{field} = {text};"));
            }
            self.line(&format!("return {name};"));
            self.declarations
                .insert(kind.clone(), returned.declaration(d, &kind));
        } else if returned.is_array {
            let kind = returned.type_name(d);
            self.line(&format!("return {kind}({});", texts.join(", ")));
        } else {
            self.line(&format!("return {};", texts[0]));
        }
    }
}

/// The name of the local value that stands for a macro.
fn alias(d: &Dialect, name: &str) -> String {
    match super::names::is_word(d.language, name) {
        true => format!("the_{name}"),
        false => name.into(),
    }
}
