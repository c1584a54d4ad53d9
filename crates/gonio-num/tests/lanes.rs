//! Lanes do in every lane what `f32` does, to the bit, under every instruction set of this machine.

use gonio_num::dispatch::{InstructionSet, Kernel, dispatch, dispatch_on};
use gonio_num::lanes::{LaneMask, Lanes};
use gonio_num::{Frame, Mask, Real, Table1, Table2, Table3, Vec3, Work};
use proptest::prelude::*;

static T1: Table1 = Table1 {
    name: "t1",
    data: &[0.5, -1.0, 3.0, 3.5, 8.0],
};
static T2: Table2 = Table2 {
    name: "t2",
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

/// How many results [`everything`] gives.
const RESULTS: usize = 47;

/// Two numbers of three.
struct Two<R>([R; 3]);
impl<R: Real> Work for Two<R> {
    type Output = [R; 2];
    #[inline(always)]
    fn run(self) -> [R; 2] {
        let [a, b, c] = self.0;
        [(a * b).exp() + c, (b - c).sin()]
    }
}

/// Every method of `Real`, every operator, vectors, frames and loops.
#[inline(always)]
fn everything<R: Real>(a: R, b: R, c: R) -> [R; RESULTS] {
    let less = a.lt(b);
    let (sin, cos) = a.sin_cos();
    // Newton's root of |c|, ended lane by lane.
    let steps = R::repeat(12, [c.abs(), R::zero()], |i, [x, _]| {
        let next = R::lit(0.5) * (x + c.abs() / x);
        ([next, i], (next - x).abs().gt(R::lit(1e-3)))
    });
    let v = Vec3::new(a, b, c);
    let frame = Frame::from_normal(v.normalize());
    let local = frame.to_local(Vec3::new(b, c, a));
    let tangent = Frame::from_normal_tangent(v.normalize(), Vec3::new(c, a, b)).s;
    let mirrored = v.reflect(frame.n);
    let cross = v.cross(local);
    let smallest = v.min(cross).max(local);
    let apart = R::out_of_line(Two([a, b, c]));
    [
        apart[0],
        apart[1],
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
        R::from_mask(R::Mask::splat(true)),
        R::select(less, a, c),
        R::table1(&T1, a),
        R::table2(&T2, a, b),
        R::table3(&T3, a, b, c),
        steps[0],
        steps[1],
        R::lit(0.1) + R::zero() + R::one() + R::pi(),
        a.clamp(b, c),
        a.saturate(),
        a.sq(),
        a.recip() + a.pow5(),
        a.powf(b),
        sin + cos,
        a.tan(),
        a.asin(),
        a.copysign(b),
        a.lerp(b, c),
        a.safe_sqrt(),
        local.x,
        tangent.y,
        mirrored.z,
        cross.length(),
        smallest.dot(v),
    ]
}

struct Everything<'a> {
    inputs: &'a [[f32; 3]],
}

impl Kernel for Everything<'_> {
    type Output = Vec<[f32; RESULTS]>;
    #[inline(always)]
    fn run<const N: usize>(self) -> Self::Output {
        let mut results = Vec::new();
        for chunk in self.inputs.chunks(N) {
            let mut v = [Lanes::<N>::splat(1.0); 3];
            for (i, input) in chunk.iter().enumerate() {
                for k in 0..3 {
                    v[k].0[i] = input[k];
                }
            }
            let r = everything(v[0], v[1], v[2]);
            for i in 0..chunk.len() {
                let mut lane = [0.0; RESULTS];
                for k in 0..RESULTS {
                    lane[k] = r[k].extract(i);
                }
                results.push(lane);
            }
        }
        results
    }
}

fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

fn available() -> impl Iterator<Item = InstructionSet> {
    InstructionSet::ALL
        .into_iter()
        .filter(|set| set.is_available())
}

/// Ordinary numbers, edges, and any bit pattern.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -4.0f32..4.0,
        2 => 0.0f32..1.0,
        1 => -1e4f32..1e4,
        1 => prop::sample::select(vec![
            0.0, -0.0, 1.0, -1.0, 0.99999994, 0.5, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, f32::MAX, f32::MIN,
            f32::MIN_POSITIVE, 1e-45, -1e-45, 89.0, -104.0, 8388608.0,
        ]),
        1 => any::<u32>().prop_map(f32::from_bits),
    ]
}

proptest! {
    #[test]
    fn lanes_equal_scalars(inputs in prop::collection::vec([number(), number(), number()], 1..40)) {
        for set in available() {
            let results = dispatch_on(set, Everything { inputs: &inputs });
            prop_assert_eq!(results.len(), inputs.len());
            for ([a, b, c], lanes) in inputs.iter().zip(&results) {
                let scalar = everything(*a, *b, *c);
                for k in 0..RESULTS {
                    prop_assert!(
                        same(scalar[k], lanes[k]),
                        "result {k} of ({a:e}, {b:e}, {c:e}) under {}: {:e}, not {:e}", set.name(), lanes[k], scalar[k]
                    );
                }
            }
        }
    }
}

#[test]
fn loops_end_lane_by_lane() {
    // Lane i counts to i.
    let limit = Lanes([0.0f32, 1.0, 2.0, 7.0]);
    let [count] = Lanes::repeat(5, [Lanes::splat(0.0)], |_, [n]| {
        let next = n + Lanes::splat(1.0);
        ([next], next.lt(limit))
    });
    assert_eq!(count.0, [1.0, 1.0, 2.0, 5.0]);
}

#[test]
fn slices_are_loaded_and_stored() {
    let source = [1.0, 2.0, 3.0, 4.0, 5.0];
    assert_eq!(Lanes::<4>::load(&source).0, [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(
        Lanes::<4>::load_or(&source[3..], 9.0).0,
        [4.0, 5.0, 9.0, 9.0]
    );
    let mut target = [0.0; 3];
    Lanes::<4>::load(&source).store(&mut target);
    assert_eq!(target, [1.0, 2.0, 3.0]);
    let mut target = [0.0; 5];
    Lanes::<4>::load(&source).store(&mut target);
    assert_eq!(target, [1.0, 2.0, 3.0, 4.0, 0.0]);
}

#[test]
#[should_panic(expected = "8 lanes can't be loaded from 3 numbers")]
fn a_short_load_is_refused() {
    let _ = Lanes::<8>::load(&[1.0, 2.0, 3.0]);
}

#[test]
fn vectors_are_gathered_and_scattered() {
    let source: Vec<Vec3<f32>> = (0..6)
        .map(|i| Vec3::new(i as f32, 10.0 + i as f32, 20.0 + i as f32))
        .collect();
    let v = Vec3::<Lanes<4>>::gather(&source[3..], Vec3::new(-1.0, -2.0, -3.0));
    assert_eq!(v.y.0, [13.0, 14.0, 15.0, -2.0]);
    assert_eq!(v.extract(2), source[5]);
    let mut target = vec![Vec3::new(0.0, 0.0, 0.0); 3];
    v.scatter(&mut target);
    assert_eq!(target, source[3..]);
}

#[test]
fn masks() {
    let m = LaneMask([true, false, false, false]);
    assert!(m.any() && !m.all() && m.extract(0));
    assert!((m | !m).all());
    assert!(!(m & !m).any());
}

struct Width;
impl Kernel for Width {
    type Output = usize;
    #[inline(always)]
    fn run<const N: usize>(self) -> usize {
        N
    }
}

#[test]
fn dispatch_takes_the_widest() {
    let widest = available().last().unwrap();
    assert_eq!(InstructionSet::detect(), widest);
    assert_eq!(dispatch(Width), widest.lanes());
    for set in available() {
        assert_eq!(dispatch_on(set, Width), set.lanes());
    }
    assert!(InstructionSet::Baseline.is_available());
}

#[test]
fn absent_instructions_are_refused() {
    for set in InstructionSet::ALL {
        if !set.is_available() {
            let result = std::panic::catch_unwind(|| dispatch_on(set, Width));
            assert!(result.is_err(), "{}", set.name());
        }
    }
}
