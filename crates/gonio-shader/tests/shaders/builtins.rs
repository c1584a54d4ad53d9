//! Each built-in function against Rust's, on edge values.

use super::{near, wgsl};

type Reference = fn(f64, f64, f64) -> f64;

const NAN: f64 = f64::NAN;
const INFINITY: f64 = f64::INFINITY;

/// What each function of x, y and z is.
const OF_NUMBERS: &[(&str, Reference)] = &[
    ("-x", |x, _, _| -x),
    ("x + y", |x, y, _| x + y),
    ("x - y", |x, y, _| x - y),
    ("x * y", |x, y, _| x * y),
    ("x / y", |x, y, _| x / y),
    ("x % y", |x, y, _| x - y * (x / y).trunc()),
    ("abs(x)", |x, _, _| x.abs()),
    ("min(x, y)", |x, y, _| if x < y { x } else { y }),
    ("max(x, y)", |x, y, _| if x > y { x } else { y }),
    ("clamp(x, 0.25, 0.75)", |x, _, _| {
        if x.is_nan() {
            0.25
        } else {
            x.clamp(0.25, 0.75)
        }
    }),
    ("saturate(x)", |x, _, _| {
        if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) }
    }),
    ("cos(x)", |x, _, _| x.cos()),
    ("sin(x)", |x, _, _| x.sin()),
    ("tan(x)", |x, _, _| x.tan()),
    ("cosh(x)", |x, _, _| x.cosh()),
    ("sinh(x)", |x, _, _| x.sinh()),
    ("tanh(x)", |x, _, _| x.tanh()),
    ("acos(x)", |x, _, _| x.acos()),
    ("asin(x)", |x, _, _| x.asin()),
    ("atan(x)", |x, _, _| x.atan()),
    // At the origin it is 0, whatever the signs of the zeros.
    ("atan2(x, y)", |x, y, _| {
        if x == 0.0 && y == 0.0 { x } else { x.atan2(y) }
    }),
    ("asinh(x)", |x, _, _| x.asinh()),
    ("acosh(x)", |x, _, _| x.acosh()),
    ("atanh(x)", |x, _, _| x.atanh()),
    ("radians(x)", |x, _, _| x.to_radians()),
    ("degrees(x)", |x, _, _| x.to_degrees()),
    ("ceil(x)", |x, _, _| x.ceil()),
    ("floor(x)", |x, _, _| x.floor()),
    ("round(x)", |x, _, _| x.round_ties_even()),
    ("fract(x)", |x, _, _| x - x.floor()),
    ("trunc(x)", |x, _, _| x.trunc()),
    ("modf(x).fract", |x, _, _| x - x.trunc()),
    ("modf(x).whole", |x, _, _| x.trunc()),
    ("frexp(x).fract * exp2(f32(frexp(x).exp))", |x, _, _| x),
    ("ldexp(x, 3i)", |x, _, _| x * 8.0),
    ("ldexp(x, -2i)", |x, _, _| x / 4.0),
    ("exp(x)", |x, _, _| x.exp()),
    ("exp2(x)", |x, _, _| x.exp2()),
    ("log(x)", |x, _, _| x.ln()),
    ("log2(x)", |x, _, _| x.log2()),
    (
        "pow(x, 2.5)",
        |x, _, _| if x < 0.0 { NAN } else { x.powf(2.5) },
    ),
    ("sign(x)", |x, _, _| {
        if x.is_nan() || x == 0.0 {
            x
        } else {
            x.signum()
        }
    }),
    ("fma(x, y, z)", |x, y, z| x * y + z),
    ("mix(x, y, 0.25)", |x, y, _| x * 0.75 + y * 0.25),
    ("mix(x, y, z)", |x, y, z| x * (1.0 - z) + y * z),
    ("step(x, y)", |x, y, _| if y < x { 0.0 } else { 1.0 }),
    ("smoothstep(-1.0, 2.0, x)", |x, _, _| {
        let t = (x + 1.0) / 3.0;
        let t = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
        t * t * (3.0 - 2.0 * t)
    }),
    ("sqrt(x)", |x, _, _| x.sqrt()),
    ("inverseSqrt(x)", |x, _, _| 1.0 / x.sqrt()),
    (
        "select(x, y, z > 0.0)",
        |x, y, z| if z > 0.0 { y } else { x },
    ),
    ("select(0.0, 1.0, x < y)", |x, y, _| f64::from(x < y)),
    ("select(0.0, 1.0, x <= y)", |x, y, _| f64::from(x <= y)),
    ("select(0.0, 1.0, x > y)", |x, y, _| f64::from(x > y)),
    ("select(0.0, 1.0, x >= y)", |x, y, _| f64::from(x >= y)),
    ("select(0.0, 1.0, x == y)", |x, y, _| f64::from(x == y)),
    ("select(0.0, 1.0, x != y)", |x, y, _| f64::from(x != y)),
    ("select(0.0, 1.0, x < 0.0 && y < 0.0)", |x, y, _| {
        f64::from(x < 0.0 && y < 0.0)
    }),
    ("select(0.0, 1.0, x < 0.0 || !(y < 0.0))", |x, y, _| {
        f64::from(x < 0.0 || y.is_nan() || y >= 0.0)
    }),
    ("length(x)", |x, _, _| x.abs()),
    ("distance(x, y)", |x, y, _| (x - y).abs()),
    ("quantizeToF16(x)", |x, _, _| match x {
        _ if x.abs() >= 65520.0 => x.signum() * INFINITY,
        _ if x.is_nan() || x == 0.0 => x,
        // 11 significant bits; the values of the test are normal numbers of 16 bits.
        _ => {
            let unit = 2f64.powi(x.abs().log2().floor() as i32 - 10);
            (x / unit).round_ties_even() * unit
        }
    }),
];

#[test]
fn functions_of_numbers() {
    let mut text = String::new();
    for (k, (expression, _)) in OF_NUMBERS.iter().enumerate() {
        text += &format!("fn t{k}(x: f32, y: f32, z: f32) -> f32 {{ return {expression}; }}\n");
    }
    let module = wgsl(&text);
    let values = [
        0.0, -0.0, 1.0, -1.0, 0.5, -0.5, 1.5, 2.5, -2.5, 0.01, -0.015, 0.75, 3.0, -7.25, 100.0,
        70000.0, INFINITY, -INFINITY, NAN,
    ];
    for (k, (expression, reference)) in OF_NUMBERS.iter().enumerate() {
        let program = module.program(&format!("t{k}"), 0).unwrap();
        for x in values {
            for y in [0.25, -2.0, 0.0, x, INFINITY, NAN] {
                for z in [0.5, -1.0] {
                    let mut found = [0.0];
                    program.run(&[], &[x, y, z], &mut found).unwrap();
                    let expected = reference(x, y, z);
                    // A few roundings of f64, near 1 or relative; exp2 and pow through exp and ln: as many roundings as their
                    // exponent is large, at most 7e4·2⁻⁵³.
                    assert!(
                        near(found[0], expected, 1e-11),
                        "{expression} at x = {x}, y = {y}, z = {z}: {} instead of {expected}",
                        found[0]
                    );
                }
            }
        }
    }
}

/// Where shading languages leave the result undefined, it is what the formula of their definition gives: a check then sees NaN.
#[test]
fn undefined_results_are_not_made_up() {
    let module = wgsl(
        "fn power(x: f32, y: f32) -> f32 { return pow(x, y); }
         fn unit(x: f32) -> f32 { return normalize(vec3f(x, 0.0, 0.0)).x; }",
    );
    for (x, y) in [(-2.0, 2.0), (0.0, 0.0)] {
        assert!(
            super::call(&module, "power", &[x, y])[0].is_nan(),
            "{x} {y}"
        );
    }
    assert_eq!(super::call(&module, "power", &[0.0, 2.0]), [0.0]);
    assert_eq!(super::call(&module, "power", &[0.0, -1.0]), [INFINITY]);
    assert!(super::call(&module, "unit", &[0.0])[0].is_nan());
    assert_eq!(super::call(&module, "unit", &[-3.0]), [-1.0]);
}

type V = [f64; 3];

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn map(a: V, b: V, f: impl Fn(f64, f64) -> f64) -> V {
    [f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2])]
}

#[test]
fn functions_of_vectors() {
    type OfVectors = fn(V, V) -> V;
    let functions: &[(&str, OfVectors)] = &[
        ("vec3f(dot(a, b))", |a, b| [dot(a, b); 3]),
        ("cross(a, b)", |a, b| {
            [
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            ]
        }),
        ("vec3f(length(a))", |a, _| [dot(a, a).sqrt(); 3]),
        ("vec3f(distance(a, b))", |a, b| {
            let d = map(a, b, |x, y| x - y);
            [dot(d, d).sqrt(); 3]
        }),
        ("normalize(a)", |a, _| a.map(|x| x / dot(a, a).sqrt())),
        ("faceForward(a, b, vec3f(0.0, 0.0, 1.0))", |a, b| {
            if b[2] < 0.0 { a } else { a.map(|x| -x) }
        }),
        ("reflect(a, b)", |a, b| {
            map(a, b, |x, n| x - 2.0 * dot(a, b) * n)
        }),
        ("refract(normalize(a), normalize(b), 0.75)", |a, b| {
            let unit = |v: V| v.map(|x| x / dot(v, v).sqrt());
            let (i, n) = (unit(a), unit(b));
            let c = dot(n, i);
            let k = 1.0 - 0.5625 * (1.0 - c * c);
            if k < 0.0 {
                return [0.0; 3];
            }
            map(i, n, |i, n| 0.75 * i - (0.75 * c + k.sqrt()) * n)
        }),
        ("refract(normalize(a), normalize(b), 3.0)", |a, b| {
            let unit = |v: V| v.map(|x| x / dot(v, v).sqrt());
            let (i, n) = (unit(a), unit(b));
            let c = dot(n, i);
            let k = 1.0 - 9.0 * (1.0 - c * c);
            if k < 0.0 {
                return [0.0; 3];
            }
            map(i, n, |i, n| 3.0 * i - (3.0 * c + k.sqrt()) * n)
        }),
        ("mix(a, b, 0.25)", |a, b| {
            map(a, b, |x, y| 0.75 * x + 0.25 * y)
        }),
        ("mix(a, b, vec3f(0.0, 0.5, 1.0))", |a, b| {
            [a[0], 0.5 * (a[1] + b[1]), b[2]]
        }),
        ("a.zyx + b.xxz", |a, b| {
            [a[2] + b[0], a[1] + b[0], a[0] + b[2]]
        }),
        ("vec3f(b.yx, a.z)", |a, b| [b[1], b[0], a[2]]),
        ("2.0 * a / b", |a, b| map(a, b, |x, y| 2.0 * x / y)),
        ("select(a, b, a < b)", |a, b| {
            map(a, b, |x, y| if x < y { y } else { x })
        }),
        (
            "vec3f(select(0.0, 1.0, all(a < b)), select(0.0, 1.0, any(a < b)), 0.0)",
            |a, b| {
                let less = [a[0] < b[0], a[1] < b[1], a[2] < b[2]];
                [
                    f64::from(less.iter().all(|&l| l)),
                    f64::from(less.iter().any(|&l| l)),
                    0.0,
                ]
            },
        ),
        ("a[i32(abs(b.x)) % 3] * vec3f(1.0)", |a, b| {
            [a[b[0].abs() as usize % 3]; 3]
        }),
        // Matrices: columns a, b and the third axis.
        (
            "mat3x3f(a, b, vec3f(0.0, 0.0, 1.0)) * vec3f(1.0, 2.0, 3.0)",
            |a, b| {
                [
                    a[0] + 2.0 * b[0],
                    a[1] + 2.0 * b[1],
                    a[2] + 2.0 * b[2] + 3.0,
                ]
            },
        ),
        (
            "vec3f(1.0, 2.0, 3.0) * mat3x3f(a, b, vec3f(0.0, 0.0, 1.0))",
            |a, b| {
                let row = [1.0, 2.0, 3.0];
                [dot(row, a), dot(row, b), 3.0]
            },
        ),
        ("(mat3x3f(a, b, a) * mat3x3f(b, a, b))[1]", |a, b| {
            let m = [a, b, a];
            let v = a;
            [0, 1, 2].map(|r| m[0][r] * v[0] + m[1][r] * v[1] + m[2][r] * v[2])
        }),
        (
            "transpose(mat3x3f(a, b, vec3f(1.0, 2.0, 3.0)))[1]",
            |a, b| [a[1], b[1], 2.0],
        ),
        (
            "vec3f(determinant(mat3x3f(a, b, vec3f(1.0, 2.0, 3.0))))",
            |a, b| {
                let c = [
                    a[1] * b[2] - a[2] * b[1],
                    a[2] * b[0] - a[0] * b[2],
                    a[0] * b[1] - a[1] * b[0],
                ];
                [dot(c, [1.0, 2.0, 3.0]); 3]
            },
        ),
        ("(2.0 * mat3x3f(a, b, a) + mat3x3f(b, b, b))[0]", |a, b| {
            map(a, b, |x, y| 2.0 * x + y)
        }),
    ];
    let mut text = String::new();
    for (k, (expression, _)) in functions.iter().enumerate() {
        text += &format!("fn t{k}(a: vec3f, b: vec3f) -> vec3f {{ return {expression}; }}\n");
    }
    let module = wgsl(&text);
    let vectors = [
        [1.0, 2.0, 3.0],
        [-0.5, 0.25, 4.0],
        [0.6, 0.0, -0.8],
        [1.0, -1.0, 0.5],
    ];
    for (k, (expression, reference)) in functions.iter().enumerate() {
        for a in vectors {
            for b in vectors {
                let inputs = [a[0], a[1], a[2], b[0], b[1], b[2]];
                let found = super::call(&module, &format!("t{k}"), &inputs);
                let expected = reference(a, b);
                for c in 0..3 {
                    assert!(
                        near(found[c], expected[c], 1e-12),
                        "{expression} of {a:?}, {b:?}: {found:?} instead of {expected:?}"
                    );
                }
            }
        }
    }
}
