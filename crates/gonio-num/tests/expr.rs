//! Recorded functions: valid WGSL, and the same bits as the formula over `f32`.

// Helpers of tests are tests.
#![allow(clippy::unwrap_used)]

use gonio_num::dual::Dual;
use gonio_num::expr::{
    Arguments, Expr, Field, Function, Language, Output, Parameter, RecordError, module, record,
};
use gonio_num::{Frame, Mask, Real, Table1, Table2, Table3, Vec3};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use proptest::prelude::*;

static T1: Table1 = Table1 {
    name: "albedo",
    data: &[0.5, -1.0, 3.0, 3.5, 8.0],
};
static T2: Table2 = Table2 {
    name: "energy",
    width: 3,
    height: 2,
    data: &[0.0, 1.0, 4.0, -2.0, 0.25, 7.0],
};
static T3: Table3 = Table3 {
    name: "lobe",
    width: 3,
    height: 2,
    depth: 3,
    data: &[
        0.5, -1.0, 2.0, 0.25, 3.0, -0.75, 1.5, 0.0, -2.0, 4.0, 0.125, 1.0, -0.5, 2.5, 0.75, -1.25,
        0.3, 0.9,
    ],
};

/// Validates WGSL and translates it to MSL and SPIR-V.
#[track_caller]
fn assert_valid(wgsl: &str) {
    let module = naga::front::wgsl::parse_str(wgsl)
        .unwrap_or_else(|e| panic!("{}\n{wgsl}", e.emit_to_string(wgsl)));
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .unwrap_or_else(|e| panic!("{}\n{wgsl}", e.emit_to_string(wgsl)));
    naga::back::spv::write_vec(&module, &info, &naga::back::spv::Options::default(), None).unwrap();
    naga::back::msl::write_string(
        &module,
        &info,
        &naga::back::msl::Options::default(),
        &naga::back::msl::PipelineOptions::default(),
    )
    .unwrap();
}

fn scalars(names: &[&str]) -> Vec<Parameter> {
    names.iter().map(|n| Parameter::scalar(*n)).collect()
}

fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// f of a GGX microfacet surface with Schlick's Fresnel term, in sr⁻¹.
fn microfacet<R: Real>(wi: Vec3<R>, wo: Vec3<R>, alpha: R, f0: Vec3<R>) -> Vec3<R> {
    let tiny = R::lit(1e-6);
    let above = tiny.lt(wi.z) & tiny.lt(wo.z);
    let (ci, co) = (wi.z.max(tiny), wo.z.max(tiny));
    let h = (wi + wo).normalize();
    let a2 = alpha * alpha;
    let k = h.z * h.z * (a2 - R::one()) + R::one();
    let d = a2 / (R::pi() * k * k);
    let lambda =
        co * (a2 + (R::one() - a2) * ci * ci).sqrt() + ci * (a2 + (R::one() - a2) * co * co).sqrt();
    let m = (R::one() - wi.dot(h).saturate()).pow5();
    let f = f0 + (Vec3::splat(R::one()) - f0) * m;
    Vec3::select(above, f * (d * R::lit(0.5) / lambda), Vec3::zero())
}

fn record_microfacet() -> Function {
    let parameters = [
        Parameter::vector("wi"),
        Parameter::vector("wo"),
        Parameter::scalar("alpha"),
        Parameter::vector("f0"),
    ];
    record("microfacet", &parameters, |p| {
        microfacet(
            p.vector("wi"),
            p.vector("wo"),
            p.scalar("alpha"),
            p.vector("f0"),
        )
    })
    .unwrap()
}

#[test]
fn a_microfacet_model_is_valid_and_exact() {
    let function = record_microfacet();
    assert_valid(&function.wgsl());
    let lines = function.wgsl().lines().count();
    assert!(lines < 40, "{lines} lines\n{}", function.wgsl());
    for i in 0..500u32 {
        let at = |k: u32| ((i * 37 + k * 101) % 257) as f32 / 257.0;
        let wi = Vec3::new(at(1) - 0.5, at(2) - 0.5, at(3) - 0.1).normalize();
        let wo = Vec3::new(at(4) - 0.5, at(5) - 0.5, at(6)).normalize();
        let f0 = Vec3::new(at(7), at(8), at(9));
        let direct = microfacet(wi, wo, at(10), f0).to_array();
        let arguments = [wi.x, wi.y, wi.z, wo.x, wo.y, wo.z, at(10), f0.x, f0.y, f0.z];
        let recorded = function.evaluate(&arguments);
        for k in 0..3 {
            assert!(same(direct[k], recorded[k]), "{direct:?} {recorded:?}");
        }
    }
}

const RESULTS: usize = 47;

/// Every method of `Real`, every operator, frames and nested loops.
fn everything<R: Real>(a: R, b: R, c: R) -> [R; RESULTS] {
    let less = a.lt(b);
    let (sin, cos) = a.sin_cos();
    let root = R::repeat(12, [c.abs(), R::zero()], |i, [x, _]| {
        let next = R::lit(0.5) * (x + c.abs() / x);
        ([next, i], (next - x).abs().gt(R::lit(1e-3)))
    });
    // A swap, an inner loop, and values that don't change inside either.
    let nested = R::repeat(3, [a, b], |i, [x, y]| {
        let [sum] = R::repeat(4, [x], |j, [s]| {
            ([s + j * y * c.exp() + i], R::Mask::splat(true))
        });
        ([y, sum], !y.gt(R::lit(100.0)))
    });
    let none = R::repeat(0, [a], |_, [x]| ([x + R::one()], R::Mask::splat(true)));
    let once = R::repeat(5, [a], |_, [x]| ([x * b], R::Mask::splat(false)));
    let dual = Dual::<R, 1>::variable(a, 0);
    let [slope] = Dual::repeat(3, [dual], |_, [d]| {
        ([d * dual + Real::one()], d.value.lt(c))
    });
    let frame = Frame::from_normal(Vec3::new(a, b, c).normalize());
    [
        a + b,
        a - b,
        a * b,
        a / b,
        -a,
        a.sqrt(),
        a.abs(),
        a.min(b),
        a.max(b),
        a.floor(),
        a.exp(),
        a.ln(),
        a.sin(),
        a.cos(),
        a.acos(),
        a.atan2(b),
        R::from_mask(less),
        R::from_mask(a.le(b)),
        R::from_mask(a.gt(b)),
        R::from_mask(a.ge(b)),
        R::from_mask((less & b.lt(c)) | !a.le(c)),
        R::from_mask(R::Mask::splat(true) & less),
        R::select(less, a - (b - c), a / (b / c)),
        R::table1(&T1, a),
        R::table2(&T2, a, b),
        R::table3(&T3, a, b, c),
        root[0] + root[1],
        nested[0],
        nested[1],
        none[0],
        once[0],
        slope.value,
        slope.partials[0],
        R::lit(0.1) + R::pi() / R::lit(3.0).sqrt(),
        a.clamp(b, c),
        a.saturate() * R::lit(f64::INFINITY),
        a.sq() - R::lit(f64::NEG_INFINITY),
        a.recip() + a.pow5(),
        a.powf(b),
        sin + cos,
        a.tan() - R::lit(-1e-40),
        a.asin(),
        a.copysign(b),
        a.lerp(b, c),
        a.safe_sqrt() * R::lit(f64::NAN),
        frame.to_local(Vec3::new(b, c, a)).x,
        R::table1(&T1, R::lit(0.3)),
    ]
}

fn record_everything() -> Function {
    record("everything", &scalars(&["a", "b", "c"]), |p| {
        everything(p.scalar("a"), p.scalar("b"), p.scalar("c"))
    })
    .unwrap()
}

#[test]
fn every_method_is_valid() {
    assert_valid(&record_everything().wgsl());
}

proptest! {
    #[test]
    fn the_graph_equals_the_formula(
        a in prop_oneof![-3.0f32..3.0, any::<f32>()], b in prop_oneof![-3.0f32..3.0, any::<f32>()], c in -3.0f32..3.0,
    ) {
        thread_local! {
            static FUNCTION: Function = record_everything();
        }
        let recorded = FUNCTION.with(|f| f.evaluate(&[a, b, c]));
        let direct = everything(a, b, c);
        for k in 0..RESULTS {
            prop_assert!(same(recorded[k], direct[k]), "result {k}: {:e}, not {:e}", recorded[k], direct[k]);
        }
    }
}

#[test]
fn the_text_is_readable() {
    let function = record("shade", &scalars(&["x", "y"]), |p| {
        let (x, y) = (p.scalar("x"), p.scalar("y"));
        let shared = (x + y) * (x + y);
        let [sum] = Expr::repeat(8, [Real::zero()], |i, [s]| {
            let next = s + shared * i;
            ([next], next.lt(y.exp()))
        });
        (sum - shared) / (x - (y - Real::lit(0.1)))
    })
    .unwrap();
    assert_valid(&function.wgsl());
    let expected = "\
fn shade(x: f32, y: f32) -> f32 {
    let v1 = exp(y);
    let v2 = x + y;
    let v3 = v2 * v2;
    var state4: f32 = 0.0;
    for (var step5 = 0; step5 < 8; step5++) {
        let v6 = state4;
        let v7 = v6 + v3 * f32(step5);
        state4 = v7;
        if (v7 >= v1) {
            break;
        }
    }
    return (state4 - v3) / (x - (y - 0.1));
}
";
    assert_eq!(function.wgsl(), expected);
}

#[test]
fn outputs_of_every_kind() {
    let parameters = [Parameter::vector("w"), Parameter::scalar("v1")];
    let scalar = record("scalar_of", &parameters, |p| p.vector("w").y).unwrap();
    assert_eq!(scalar.evaluate(&[1.0, 2.0, 3.0, 4.0]), [2.0]);
    let vector = record("vector_of", &parameters, |p| p.vector("w") * p.scalar("v1")).unwrap();
    assert_eq!(vector.evaluate(&[1.0, 2.0, 3.0, 4.0]), [4.0, 8.0, 12.0]);
    let array = record("array_of", &parameters, |p| {
        let v = p.scalar("v1").exp();
        [v, v * v, Real::lit(7.0), v.ln()]
    })
    .unwrap();
    assert!(array.wgsl().contains("array<f32, 4>"));
    let structure = record("structure_of", &parameters, |p| Output::Struct {
        name: "Sampled".into(),
        fields: vec![
            Field::vector("wi", p.vector("w").normalize()),
            Field::scalar("pdf", R1::table1(&T1, p.scalar("v1"))),
        ],
    })
    .unwrap();
    type R1 = Expr;
    assert!(
        structure
            .wgsl()
            .contains("struct Sampled {\n    wi: vec3f,\n    pdf: f32,\n}")
    );
    for f in [&scalar, &vector, &array, &structure] {
        assert_valid(&f.wgsl());
    }
    assert_valid(&module(&[&scalar, &vector, &array, &structure, &record_everything()]).unwrap());
}

#[test]
fn literals_are_exact() {
    for x in [
        0.1f32,
        -0.0,
        1e-45,
        f32::MAX,
        f32::MIN_POSITIVE,
        16777216.0,
        -2.5,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
    ] {
        let function = record("literal", &[], |_| Expr::lit(f64::from(x))).unwrap();
        assert_valid(&function.wgsl());
        assert!(same(function.evaluate(&[])[0], x), "{x:e}");
        if x.is_finite() {
            let text = function.wgsl();
            let text = text.split("return ").nth(1).unwrap();
            let text = text.split(';').next().unwrap();
            assert_eq!(text.parse::<f32>().unwrap().to_bits(), x.to_bits());
        }
    }
}

#[test]
fn common_subexpressions_are_shared_and_constants_folded() {
    let function = record("folded", &scalars(&["x"]), |p| {
        let x = p.scalar("x");
        let unused = x.atan2(x);
        let _ = unused + x;
        x.exp() * x.exp() + (Expr::lit(2.0) / Expr::lit(0.0)).recip() + Expr::one() * x
    })
    .unwrap();
    assert_eq!(function.wgsl().matches("exp(").count(), 1);
    assert!(!function.wgsl().contains("atan2") && !function.wgsl().contains('/'));
    assert_valid(&function.wgsl());
}

#[test]
fn misuse_is_refused() {
    let x = scalars(&["x"]);
    let identity = |p: &Arguments| p.scalar("x");
    let error = record("f", &x, |p| {
        let inner = record("g", &[], |_| Expr::lit(1.0)).unwrap_err();
        assert_eq!(inner, RecordError::Nested);
        p.scalar("x")
    });
    assert!(
        error.is_ok(),
        "a refused inner recording must leave the outer one whole"
    );

    let name = |s: &str| {
        Err(RecordError::Name {
            name: s.into(),
            language: Language::Wgsl,
        })
    };
    let wrong = |s: &str| record(s, &x, identity).map(|f| f.wgsl());
    assert_eq!(wrong("while"), name("while"));
    assert_eq!(wrong("a b"), name("a b"));
    assert_eq!(wrong("x"), Err(RecordError::Duplicate { name: "x".into() }));
    let empty = record("f", &[], |_| Output::Array(Vec::new()));
    assert!(matches!(empty, Err(RecordError::NoOutput { .. })));

    static SHORT: Table1 = Table1 {
        name: "short",
        data: &[1.0],
    };
    static NAN: Table1 = Table1 {
        name: "nans",
        data: &[1.0, f32::NAN],
    };
    static TWIN: Table1 = Table1 {
        name: "albedo",
        data: &[1.0, 2.0],
    };
    static RAGGED: Table2 = Table2 {
        name: "ragged",
        width: 2,
        height: 2,
        data: &[1.0; 5],
    };
    let with =
        |t: &'static Table1| record("f", &x, |p| Expr::table1(t, p.scalar("x"))).unwrap_err();
    assert!(matches!(
        with(&SHORT),
        RecordError::TableSize { samples: 1, .. }
    ));
    assert!(matches!(
        with(&NAN),
        RecordError::TableValue { index: 1, .. }
    ));
    let ragged = record("f", &x, |p| {
        Expr::table2(&RAGGED, p.scalar("x"), p.scalar("x"))
    });
    assert!(matches!(ragged, Err(RecordError::TableSize { .. })));
    let twins = record("f", &x, |p| {
        Expr::table1(&T1, p.scalar("x")) + Expr::table1(&TWIN, p.scalar("x"))
    });
    assert_eq!(
        twins.unwrap_err(),
        RecordError::Duplicate {
            name: "albedo".into()
        }
    );
    let own_name = record("albedo_at", &x, |p| Expr::table1(&T1, p.scalar("x")));
    assert!(matches!(own_name, Err(RecordError::Duplicate { .. })));

    let one = record("one", &x, |p| Expr::table1(&T1, p.scalar("x"))).unwrap();
    let other = record("other", &x, |p| Expr::table1(&TWIN, p.scalar("x"))).unwrap();
    assert!(matches!(
        module(&[&one, &other]),
        Err(RecordError::Duplicate { .. })
    ));
    assert!(matches!(
        module(&[&one, &one]),
        Err(RecordError::Duplicate { .. })
    ));
}

#[test]
#[should_panic(expected = "expressions exist only inside")]
fn expressions_outside_a_recording_panic() {
    let _ = Expr::lit(1.0);
}

#[test]
#[should_panic(expected = "an expression of another recording")]
fn expressions_of_another_recording_panic() {
    let mut kept = None;
    record("f", &[], |_| {
        kept = Some(Expr::lit(1.0));
        Expr::lit(2.0)
    })
    .unwrap();
    let _ = record("g", &[], |_| kept.unwrap() + Expr::lit(1.0));
}

#[test]
#[should_panic(expected = "carry it out in the loop's state")]
fn values_that_leave_a_loop_panic() {
    let _ = record("f", &scalars(&["x"]), |p| {
        let mut kept = p.scalar("x");
        let _ = Expr::repeat(3, [p.scalar("x")], |i, [s]| {
            kept = s + i;
            ([kept], Mask::splat(true))
        });
        kept
    });
}

#[test]
fn a_panic_ends_its_recording() {
    let result = std::panic::catch_unwind(|| {
        let _ = record("f", &[], |p| p.scalar("missing"));
    });
    let message = result.unwrap_err();
    let message = message.downcast_ref::<String>().unwrap();
    assert!(
        message.contains("no scalar parameter is named `missing`"),
        "{message}"
    );
    assert!(record("g", &[], |_| Expr::lit(1.0)).is_ok());
}

#[test]
fn threads_record_side_by_side() {
    let texts: Vec<String> = std::thread::scope(|s| {
        let threads: Vec<_> = (0..8)
            .map(|_| s.spawn(|| record_everything().wgsl()))
            .collect();
        threads.into_iter().map(|t| t.join().unwrap()).collect()
    });
    assert!(texts.iter().all(|t| *t == texts[0]));
}
