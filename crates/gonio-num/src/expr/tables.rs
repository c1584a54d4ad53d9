//! The text of tables and of their look-ups, and of what languages leave open.

use super::language::{Constants, Dialect, Type};
use crate::{Table1, Table2, Table3};
use std::fmt::Write;

/// Samples a line.
const COLUMNS: usize = 8;

/// A table's samples, as a constant of the module; nothing if the look-up holds them.
fn samples(d: &Dialect, name: &str, data: &[f32]) -> String {
    let count = data.len();
    let rows = rows(d, data, 1);
    match d.constants {
        Constants::Const => format!("const {name} = array<f32, {count}>(\n{rows}\n);\n\n"),
        Constants::Keyword(word) if d.array_calls => {
            format!("{word} float {name}[{count}] = float[{count}](\n{rows}\n);\n\n")
        }
        Constants::Keyword(word) => {
            format!("{word} float {name}[{count}] = {{\n{rows}\n}};\n\n")
        }
        Constants::Macro => String::new(),
    }
}

/// The samples as a local array, in a language that has no constants of a module.
fn local_samples(d: &Dialect, name: &str, data: &[f32]) -> String {
    match d.constants {
        Constants::Macro => {
            let rows = rows(d, data, 2);
            format!("    float {name}[{}] = {{\n{rows}\n    }};\n", data.len())
        }
        _ => String::new(),
    }
}

fn rows(d: &Dialect, data: &[f32], indent: usize) -> String {
    let rows: Vec<String> = data
        .chunks(COLUMNS)
        .map(|row| {
            let row: Vec<String> = row.iter().map(|x| d.number(*x)).collect();
            format!("{}{}", "    ".repeat(indent), row.join(", "))
        })
        .collect();
    rows.join(",\n")
}

/// The body of a function, line by line.
struct Body<'a> {
    d: &'a Dialect,
    text: String,
}

impl Body<'_> {
    fn number(&mut self, name: &str, text: &str) {
        let kind = self.d.type_name(Type::Number);
        let line = self.d.value(kind, name, text);
        let _ = writeln!(self.text, "    {line}");
    }

    fn integer(&mut self, name: &str, text: &str) {
        let line = self.d.value(self.d.integer, name, text);
        let _ = writeln!(self.text, "    {line}");
    }

    /// Where `x` lies among `last` + 1 nodes: the cell `i`, and the place `w` in it.
    fn cell(&mut self, x: &str, last: usize, [p, i, w]: [&str; 3]) {
        let d = self.d;
        let [zero, one, end] = [0.0, 1.0, last as f32].map(|x| d.number(x));
        self.number(p, &format!("clamp({x}, {zero}, {one}) * {end}"));
        let before = d.number(last as f32 - 1.0);
        self.integer(i, &format!("{}(min({p}, {before}))", d.to_integer));
        self.number(w, &format!("{p} - {}({i})", d.to_number));
    }

    fn mix(&self, a: &str, b: &str, t: &str) -> String {
        let one = self.d.number(1.0);
        format!("{a} * ({one} - {t}) + {b} * {t}")
    }

    fn function(self, name: &str, parameters: &[(&str, bool)], result: &str) -> String {
        let d = self.d;
        let number = d.type_name(Type::Number);
        let parameters: Vec<String> = parameters
            .iter()
            .map(|(p, whole)| d.typed(if *whole { d.integer } else { number }, p))
            .collect();
        let head = d.head(name, &parameters, number);
        format!("{head}{}    return {result};\n}}\n", self.text)
    }
}

/// The samples and `NAME_at(x)`, in the operations of [`Real::table1`](crate::Real::table1).
pub(super) fn table1(d: &Dialect, name: &str, t: &Table1) -> String {
    let mut body = Body {
        d,
        text: local_samples(d, name, t.data),
    };
    body.cell("x", t.data.len() - 1, ["p", "i", "w"]);
    let result = body.mix(&format!("{name}[i]"), &format!("{name}[i + 1]"), "w");
    let function = body.function(&format!("{name}_at"), &[("x", false)], &result);
    format!(
        "{}// Linear interpolation in {name}, x clamped to [0, 1].\n{function}",
        samples(d, name, t.data)
    )
}

/// The look-up between four neighbours in rows of `width`, of which `k` is the first.
fn bilinear(body: &mut Body<'_>, name: &str, width: usize) -> String {
    let low = body.mix(&format!("{name}[k]"), &format!("{name}[k + 1]"), "u");
    let above = format!("{name}[k + {}]", width + 1);
    let high = body.mix(&format!("{name}[k + {width}]"), &above, "u");
    body.number("low", &low);
    body.number("high", &high);
    body.mix("low", "high", "v")
}

/// The samples and `NAME_at(x, y)`, in the operations of [`Real::table2`](crate::Real::table2).
pub(super) fn table2(d: &Dialect, name: &str, t: &Table2) -> String {
    let mut body = Body {
        d,
        text: local_samples(d, name, t.data),
    };
    body.cell("x", t.width - 1, ["p", "i", "u"]);
    body.cell("y", t.height - 1, ["q", "j", "v"]);
    body.integer("k", &format!("j * {} + i", t.width));
    let result = bilinear(&mut body, name, t.width);
    let parameters = [("x", false), ("y", false)];
    let function = body.function(&format!("{name}_at"), &parameters, &result);
    format!(
        "{}// Bilinear interpolation in {name}, x and y clamped to [0, 1].\n{function}",
        samples(d, name, t.data)
    )
}

/// The samples and `NAME_at(x, y, z)`, in the operations of [`Real::table3`](crate::Real::table3).
pub(super) fn table3(d: &Dialect, name: &str, t: &Table3) -> String {
    let slice = t.width * t.height;
    let mut inner = Body {
        d,
        text: local_samples(d, name, t.data),
    };
    let between = bilinear(&mut inner, name, t.width);
    let parameters = [("k", true), ("u", false), ("v", false)];
    let inner = inner.function(&format!("{name}_slice"), &parameters, &between);
    let mut body = Body {
        d,
        text: String::new(),
    };
    body.cell("x", t.width - 1, ["p", "i", "u"]);
    body.cell("y", t.height - 1, ["q", "j", "v"]);
    body.cell("z", t.depth - 1, ["r", "l", "w"]);
    body.integer("k", &format!("l * {slice} + j * {} + i", t.width));
    body.number("near", &format!("{name}_slice(k, u, v)"));
    body.number("far", &format!("{name}_slice(k + {slice}, u, v)"));
    let result = body.mix("near", "far", "w");
    let parameters = [("x", false), ("y", false), ("z", false)];
    let function = body.function(&format!("{name}_at"), &parameters, &result);
    format!(
        "{}// Bilinear interpolation in a slice of {name}.\n{inner}\n\
         // Trilinear interpolation in {name}, x, y and z clamped to [0, 1].\n{function}",
        samples(d, name, t.data)
    )
}

/// The angle of a point, which is left open at the origin.
pub(super) fn atan2(d: &Dialect, name: &str) -> String {
    let number = d.type_name(Type::Number);
    let zero = d.number(0.0);
    let parameters = [d.typed(number, "y"), d.typed(number, "x")];
    let origin = format!("x == {zero} && y == {zero}");
    let angle = format!("{}(y, x)", d.atan2);
    let result = match d.is_wgsl() {
        true => format!("select({angle}, {zero}, {origin})"),
        false => format!("{origin} ? {zero} : {angle}"),
    };
    format!(
        "// The angle of (x, y); 0 at the origin.\n{}    return {result};\n}}\n",
        d.head(name, &parameters, number)
    )
}
