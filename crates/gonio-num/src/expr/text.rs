//! The text of a value, and how operators bind.

use super::tape::Op;

/// How tightly the outermost operator of a text binds, the loosest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Binding {
    Choice,
    Logic,
    Comparison,
    Sum,
    Product,
    Sign,
    Atom,
}

/// The text of a value.
#[derive(Debug, Clone)]
pub(super) struct Text {
    pub text: String,
    pub binding: Binding,
    /// Both sides of a comparison, and the sign that is true where it is false.
    denied: Option<[String; 3]>,
}

impl Text {
    pub fn new(text: impl Into<String>, binding: Binding) -> Self {
        let text = text.into();
        Self {
            text,
            binding,
            denied: None,
        }
    }

    pub fn atom(text: impl Into<String>) -> Self {
        Self::new(text, Binding::Atom)
    }

    /// The text as an operand that needs at least this binding.
    pub fn at_least(&self, binding: Binding) -> String {
        if self.binding >= binding {
            self.text.clone()
        } else {
            format!("({})", self.text)
        }
    }

    /// A comparison, which is written with the literal on the right.
    fn comparison(left: &Self, sign: [&str; 2], right: &Self) -> Self {
        let is_literal = |t: &Self| t.text.starts_with(|c: char| c.is_ascii_digit());
        let [mut a, mut b] = [left, right].map(|t| t.at_least(Binding::Sum));
        let [mut sign, mut denied] = sign;
        if is_literal(left) && !is_literal(right) {
            (a, b) = (b, a);
            (sign, denied) = (turned(sign), turned(denied));
        }
        Self {
            text: format!("{a} {sign} {b}"),
            binding: Binding::Comparison,
            denied: Some([a, denied.into(), b]),
        }
    }
}

/// The comparison with its sides exchanged.
fn turned(sign: &str) -> &'static str {
    match sign {
        "<" => ">",
        "<=" => ">=",
        ">" => "<",
        _ => "<=",
    }
}

/// A call of a function.
pub(super) fn call(function: &str, a: &[Text]) -> Text {
    let texts: Vec<&str> = a.iter().map(|t| t.text.as_str()).collect();
    Text::atom(format!("{function}({})", texts.join(", ")))
}

/// Its negation. Nothing is NaN.
pub(super) fn not(a: &Text) -> Text {
    match &a.denied {
        Some(sides) => Text::new(sides.join(" "), Binding::Comparison),
        None => Text::new(format!("!{}", a.at_least(Binding::Atom)), Binding::Sign),
    }
}

/// The text of an operation that is written alike in all languages, for numbers and for vectors.
pub(super) fn simple(op: Op, a: &[Text]) -> Text {
    let infix = |sign: &str, binding: Binding, left: Binding, right: Binding| {
        let text = format!("{} {sign} {}", a[0].at_least(left), a[1].at_least(right));
        Text::new(text, binding)
    };
    // The right operand binds tighter, so that the order of evaluation stays as recorded.
    match op {
        Op::Add | Op::Sub => {
            let sign = if op == Op::Add { "+" } else { "-" };
            // + −x is written − x, and − −x as + x.
            if a[1].binding == Binding::Sign
                && let Some(positive) = a[1].text.strip_prefix('-')
            {
                let sign = if op == Op::Add { "-" } else { "+" };
                let text = format!("{} {sign} {positive}", a[0].at_least(Binding::Sum));
                return Text::new(text, Binding::Sum);
            }
            infix(sign, Binding::Sum, Binding::Sum, Binding::Product)
        }
        Op::Mul => infix("*", Binding::Product, Binding::Product, Binding::Atom),
        Op::Div => infix("/", Binding::Product, Binding::Product, Binding::Atom),
        Op::Less => Text::comparison(&a[0], ["<", ">="], &a[1]),
        Op::LessEqual => Text::comparison(&a[0], ["<=", ">"], &a[1]),
        Op::And => infix(
            "&&",
            Binding::Logic,
            Binding::Comparison,
            Binding::Comparison,
        ),
        Op::Or => infix(
            "||",
            Binding::Logic,
            Binding::Comparison,
            Binding::Comparison,
        ),
        Op::Neg => Text::new(format!("-{}", a[0].at_least(Binding::Atom)), Binding::Sign),
        Op::Not => not(&a[0]),
        Op::Acos => call("acos", a),
        Op::Sqrt => call("sqrt", a),
        Op::Abs => call("abs", a),
        Op::Floor => call("floor", a),
        Op::Exp => call("exp", a),
        Op::Ln => call("log", a),
        Op::Sin => call("sin", a),
        Op::Cos => call("cos", a),
        Op::Min
        | Op::Max
        | Op::Select
        | Op::Atan2
        | Op::Table1(_)
        | Op::Table2(_)
        | Op::Table3(_) => unreachable!("invariant: these are written elsewhere"),
    }
}
