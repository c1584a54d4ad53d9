//! Loops and branches: the same function in Rust, and lanes that take different ways.

use super::wgsl;
use gonio_num::lanes::Lanes;
use gonio_shader::ShaderModule;

type Reference = fn(f64, f64) -> f64;

/// Functions of x and y with every kind of statement, and the same in Rust.
const FUNCTIONS: &[(&str, &str, Reference)] = &[
    (
        "early",
        "fn early(x: f32, y: f32) -> f32 {
            if x < 0.0 { return -1.0; }
            var s = 0.0;
            if y > 1.0 { s = 2.0; if x > 2.0 { return 7.0; } s += 1.0; } else if y > 0.5 { s = 4.0; } else { return x; }
            return s + x;
        }",
        |x, y| {
            if x < 0.0 {
                return -1.0;
            }
            if y > 1.0 {
                if x > 2.0 { 7.0 } else { 3.0 + x }
            } else if y > 0.5 {
                4.0 + x
            } else {
                x
            }
        },
    ),
    (
        "loops",
        "fn loops(x: f32, y: f32) -> f32 {
            var s = 0.0;
            for (var i = 0; i < 20; i++) {
                if f32(i) > y * 5.0 { break; }
                if i % 3 == 1 { continue; }
                var j = 0;
                loop {
                    if j > i { break; }
                    s += x;
                    if s > 40.0 { return s; }
                    continuing { j += 2; }
                }
            }
            var k = 10.0;
            while k > x { k -= 1.5; }
            return s + k;
        }",
        |x, y| {
            let mut s = 0.0;
            for i in 0..20 {
                if f64::from(i) > y * 5.0 {
                    break;
                }
                if i % 3 == 1 {
                    continue;
                }
                let mut j = 0;
                while j <= i {
                    s += x;
                    if s > 40.0 {
                        return s;
                    }
                    j += 2;
                }
            }
            let mut k = 10.0;
            while k > x {
                k -= 1.5;
            }
            s + k
        },
    ),
    (
        "break_if",
        "fn break_if(x: f32, y: f32) -> f32 {
            var a = abs(x) + 1.0;
            loop { a *= 2.0; continuing { a += 0.5; break if a > 50.0 + y; } }
            return a;
        }",
        |x, y| {
            let mut a = x.abs() + 1.0;
            loop {
                a *= 2.0;
                a += 0.5;
                if a > 50.0 + y {
                    return a;
                }
            }
        },
    ),
    (
        "switches",
        "fn switches(x: f32, y: f32) -> f32 {
            var s = 0.0;
            for (var i = 0; i < 4; i++) {
                switch i32(x) + i {
                    case 0: { s += 1.0; }
                    case 1, 2: { if y > 0.5 { break; } s += 10.0; }
                    case 3: { continue; }
                    case 5: { return s; }
                    default: { s += 100.0; }
                }
                s += 0.5;
            }
            return s;
        }",
        |x, y| {
            let mut s = 0.0;
            for i in 0..4 {
                match x as i32 + i {
                    0 => s += 1.0,
                    1 | 2 => {
                        if y <= 0.5 {
                            s += 10.0;
                        }
                    }
                    3 => continue,
                    5 => return s,
                    _ => s += 100.0,
                }
                s += 0.5;
            }
            s
        },
    ),
    (
        "pointers",
        "struct Pair { a: f32, v: vec3f }
        fn change(p: ptr<function, f32>, by: f32) { if by > 1.0 { *p += by; return; } *p *= 2.0; }
        fn turn(q: ptr<function, Pair>) -> f32 { (*q).v.y = (*q).a; (*q).v = (*q).v.zxy; return (*q).v.x; }
        fn pointers(x: f32, y: f32) -> f32 {
            var s = x;
            change(&s, y);
            var p = Pair(s, vec3f(1.0, 2.0, y));
            let t = turn(&p);
            var copy = p;
            copy.v.x = 100.0;
            return t + p.v.x * 3.0 + p.v.y + p.v.z * x + copy.v.x;
        }",
        |x, y| {
            let s = if y > 1.0 { x + y } else { x * 2.0 };
            // v = (1, s, y) turned to (y, 1, s).
            y + y * 3.0 + 1.0 + s * x + 100.0
        },
    ),
    (
        "arrays",
        "const TABLE = array<f32, 5>(1.0, 4.0, 9.0, 16.0, 25.0);
        fn arrays(x: f32, y: f32) -> f32 {
            let i = i32(abs(x));
            var a: array<vec2f, 4>;
            for (var k = 0; k < 4; k++) { a[k] = vec2f(f32(k), x); }
            a[i].y = y;
            a[(i + 1) % 4][i % 2] += 7.0;
            var nested: array<array<f32, 3>, 2>;
            nested[i % 2][i % 3] = 5.0;
            return a[0].x + a[1].y * 2.0 + a[2].x * 3.0 + a[3].y * 4.0 + TABLE[min(i, 4)] + nested[1][2] + nested[0][0];
        }",
        |x, y| {
            // An index beyond the end is that of the last element.
            let i = x.abs() as usize;
            let mut a = [0, 1, 2, 3].map(|k| [f64::from(k), x]);
            a[i.min(3)][1] = y;
            a[(i + 1) % 4][i % 2] += 7.0;
            let table = [1.0, 4.0, 9.0, 16.0, 25.0];
            let mut nested = [[0.0; 3]; 2];
            nested[i % 2][i % 3] = 5.0;
            a[0][0] + a[1][1] * 2.0 + a[2][0] * 3.0 + a[3][1] * 4.0 + table[i.min(4)] + nested[1][2] + nested[0][0]
        },
    ),
    (
        "globals",
        "var<private> seed: u32 = 7u;
        fn next() -> f32 { seed = seed * 747796405u + 2891336453u; return f32(seed >> 8u) / 16777216.0; }
        fn globals(x: f32, y: f32) -> f32 {
            var s = next();
            if x > 0.0 { s += next(); }
            for (var i = 0; i < i32(y); i++) { s += next() * 0.5; }
            return s + next();
        }",
        |x, y| {
            let mut seed = 7u32;
            let mut next = || {
                seed = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
                // Whole numbers become numbers exactly in f64.
                f64::from(seed >> 8) / 16_777_216.0
            };
            let mut s = next();
            if x > 0.0 {
                s += next();
            }
            for _ in 0..y as i32 {
                s += next() * 0.5;
            }
            s + next()
        },
    ),
    (
        "shadowed",
        "fn twice(x: f32) -> f32 { var r = x; if x > 1.0 { r = 1.0; } return r * 2.0; }
        fn shadowed(x: f32, y: f32) -> f32 {
            var s = twice(x) + twice(y);
            for (var i = 0; i < 3; i++) { var t: f32; if i == 1 { t = y; } s += t + twice(s * 0.1); let s = 5.0; }
            return s;
        }",
        |x, y| {
            let twice = |x: f64| if x > 1.0 { 2.0 } else { x * 2.0 };
            let mut s = twice(x) + twice(y);
            for i in 0..3 {
                let t = if i == 1 { y } else { 0.0 };
                // 0.1 is a number of 32 bits in a shader.
                s += t + twice(s * f64::from(0.1f32));
            }
            s
        },
    ),
];

fn module() -> ShaderModule {
    let text: String = FUNCTIONS
        .iter()
        .map(|(_, text, _)| format!("{text}\n"))
        .collect();
    wgsl(&text)
}

fn points() -> Vec<(f64, f64)> {
    let xs = [
        -3.5, -1.0, -0.5, 0.0, 0.25, 1.0, 1.75, 2.0, 2.5, 3.0, 4.5, 6.0, 11.0,
    ];
    let ys = [-1.0, 0.0, 0.3, 0.75, 1.0, 1.25, 2.0, 3.5];
    xs.iter()
        .flat_map(|&x| ys.iter().map(move |&y| (x, y)))
        .collect()
}

#[test]
fn statements_do_what_they_do_in_rust() {
    let module = module();
    for (name, _, reference) in FUNCTIONS {
        let program = module.program(name, 10_000).unwrap();
        for (x, y) in points() {
            let mut found = [0.0];
            program.run(&[], &[x, y], &mut found).unwrap();
            let expected = reference(x, y);
            assert!(
                super::near(found[0], expected, 1e-14),
                "{name}({x}, {y}) = {} instead of {expected}",
                found[0]
            );
        }
    }
}

/// Lanes that go different ways give what each would give alone, to the bit; so do lanes that are split among narrower ones.
#[test]
fn divergent_lanes_are_those_of_single_calls() {
    let module = module();
    let points = points();
    for (name, ..) in FUNCTIONS {
        let program = module.program(name, 10_000).unwrap();
        let single = |x: f64, y: f64| {
            let mut found = [0.0f32];
            program.run(&[], &[x as f32, y as f32], &mut found).unwrap();
            found[0]
        };
        fn lanes<const N: usize>(
            program: &gonio_shader::Program,
            points: &[(f64, f64)],
            single: impl Fn(f64, f64) -> f32,
        ) {
            for group in points.chunks(N) {
                let (mut x, mut y) = (Lanes([0.0; N]), Lanes([0.0; N]));
                for (k, p) in group.iter().enumerate() {
                    (x.0[k], y.0[k]) = (p.0 as f32, p.1 as f32);
                }
                let mut found = [Lanes([0.0; N])];
                program.run(&[], &[x, y], &mut found).unwrap();
                for (k, p) in group.iter().enumerate() {
                    let expected = single(p.0, p.1);
                    assert_eq!(
                        found[0].0[k].to_bits(),
                        expected.to_bits(),
                        "{} of {p:?} on {N} lanes",
                        program.name()
                    );
                }
            }
        }
        lanes::<4>(&program, &points, single);
        lanes::<64>(&program, &points, single);
    }
}

/// Rows that run together give what each gives alone.
#[test]
fn many_calls_are_those_of_single_ones() {
    let module = module();
    let points = points();
    for (name, ..) in FUNCTIONS {
        let program = module.program(name, 10_000).unwrap();
        let inputs: Vec<f64> = points.iter().flat_map(|&(x, y)| [x, y]).collect();
        let mut outputs = vec![0.0; points.len()];
        program.run_many(&[], &inputs, &mut outputs).unwrap();
        for (k, &(x, y)) in points.iter().enumerate() {
            let mut found = [0.0];
            program.run(&[], &[x, y], &mut found).unwrap();
            assert_eq!(found[0].to_bits(), outputs[k].to_bits(), "{name}({x}, {y})");
        }
    }
}

#[test]
fn loops_without_end_are_stopped() {
    let module = wgsl(
        "fn endless(x: f32) -> f32 {
            var a = x;
            while a < 2.0 {
                a = min(a + 1.0, 1.0);
            }
            return a;
        }",
    );
    let program = module.program("endless", 1000).unwrap();
    let mut found = [0.0f64];
    program.run(&[], &[3.0], &mut found).unwrap();
    assert_eq!(found, [3.0]);
    let error = program.run(&[], &[0.0], &mut found).unwrap_err();
    assert!(found[0].is_nan());
    assert_eq!(
        error.to_string(),
        "test.wgsl:3:13: `endless` did not end after 1000 steps, in the loop at line 3"
    );
    // Other lanes end; one that doesn't is enough.
    let mut found = [Lanes::<4>([0.0; 4])];
    let inputs = [Lanes([3.0, 3.0, 0.0, 3.0])];
    assert!(program.run(&[], &inputs, &mut found).is_err());
}
