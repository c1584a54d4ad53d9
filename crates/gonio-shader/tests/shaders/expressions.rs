//! Random expressions against their value in Rust.

use super::wgsl;
use proptest::prelude::*;

/// An expression with its value for given x and y.
#[derive(Debug, Clone)]
enum Expression {
    X,
    Y,
    Number(i8),
    Binary(&'static str, Box<Expression>, Box<Expression>),
    Unary(&'static str, Box<Expression>),
    Select(Box<Expression>, Box<Expression>, Box<Expression>),
}

impl Expression {
    fn text(&self) -> String {
        match self {
            Self::X => "x".into(),
            Self::Y => "y".into(),
            // Not alone: the parser would fold what has only constants, in 32 bits.
            Self::Number(n) => format!("(x + ({n}.0))"),
            Self::Binary(op, a, b) if op.len() == 1 => format!("({} {op} {})", a.text(), b.text()),
            Self::Binary(f, a, b) => format!("{f}({}, {})", a.text(), b.text()),
            Self::Unary(f, a) => format!("{f}({})", a.text()),
            Self::Select(a, b, c) => {
                format!("select({}, {}, {} < 0.5)", a.text(), b.text(), c.text())
            }
        }
    }

    fn value(&self, x: f64, y: f64) -> f64 {
        match self {
            Self::X => x,
            Self::Y => y,
            Self::Number(n) => x + f64::from(*n),
            Self::Binary(op, a, b) => {
                let (a, b) = (a.value(x, y), b.value(x, y));
                match *op {
                    "+" => a + b,
                    "-" => a - b,
                    "*" => a * b,
                    "/" => a / b,
                    "min" => {
                        if a < b {
                            a
                        } else {
                            b
                        }
                    }
                    _ => {
                        if a > b {
                            a
                        } else {
                            b
                        }
                    }
                }
            }
            Self::Unary(f, a) => {
                let a = a.value(x, y);
                match *f {
                    "-" => -a,
                    "abs" => a.abs(),
                    "floor" => a.floor(),
                    _ => a.sqrt(),
                }
            }
            Self::Select(a, b, c) => {
                if c.value(x, y) < 0.5 {
                    b.value(x, y)
                } else {
                    a.value(x, y)
                }
            }
        }
    }
}

fn expression() -> impl Strategy<Value = Expression> {
    let leaf = prop_oneof![
        Just(Expression::X),
        Just(Expression::Y),
        (-3i8..4).prop_map(Expression::Number),
    ];
    leaf.prop_recursive(5, 40, 3, |inner| {
        let binary = prop::sample::select(vec!["+", "-", "*", "/", "min", "max"]);
        let unary = prop::sample::select(vec!["-", "abs", "floor", "sqrt"]);
        let boxed = inner.prop_map(Box::new);
        prop_oneof![
            (binary, boxed.clone(), boxed.clone())
                .prop_map(|(f, a, b)| Expression::Binary(f, a, b)),
            (unary, boxed.clone()).prop_map(|(f, a)| Expression::Unary(f, a)),
            (boxed.clone(), boxed.clone(), boxed).prop_map(|(a, b, c)| Expression::Select(a, b, c)),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// The same operations in the same order, and none fused: the same bits.
    #[test]
    fn an_expression_has_the_value_of_rust(e in expression(), x in -3.0f64..3.0, y in -3.0f64..3.0) {
        let text = format!("fn f(x: f32, y: f32) -> f32 {{ return {}; }}", e.text());
        let module = wgsl(&text);
        let program = module.program("f", 0).unwrap();
        let mut found = [0.0];
        program.run(&[], &[x, y], &mut found).unwrap();
        let expected = e.value(x, y);
        prop_assert!(
            found[0] == expected || (found[0].is_nan() && expected.is_nan()),
            "{}: {} instead of {expected}", e.text(), found[0]
        );
    }
}

#[test]
fn constants_of_the_module_are_folded() {
    let module =
        wgsl("const A = 2.0 * 3.0; const B = A + 1.0; fn f(x: f32) -> f32 { return x * B; }");
    assert_eq!(super::call(&module, "f", &[2.0]), [14.0]);
    // One multiplication.
    assert_eq!(module.program("f", 0).unwrap().operations(), 1);
}
