//! Guards the speed of lanes: one microfacet formula and the elementary functions, over `f32` and over lanes under each
//! instruction set of this machine. Read the throughput column (items a second).

use divan::{Bencher, counter::ItemsCount};
use gonio_num::dispatch::{InstructionSet, Kernel, dispatch_on};
use gonio_num::{Real, lanes::Lanes};
use std::fmt;

const COUNT: usize = 4096;

/// f cosθi of a GGX microfacet surface with Schlick's Fresnel term: a typical load of the reflection models.
#[inline(always)]
fn microfacet<R: Real>(x: R, y: R) -> R {
    let alpha = R::lit(0.3);
    let (ci, co) = (x, y);
    let si = (R::one() - ci * ci).safe_sqrt();
    let so = (R::one() - co * co).safe_sqrt();
    // Directions in one plane, on either side of the normal.
    let (hx, hz) = (si - so, ci + co);
    let length = (hx * hx + hz * hz).max(R::lit(1e-12)).sqrt();
    let cos_h = hz / length;
    let cos_d = ((hx * si + hz * ci) / length).saturate();
    let a2 = alpha * alpha;
    let k = cos_h * cos_h * (a2 - R::one()) + R::one();
    let d = a2 / (R::pi() * k * k);
    let li = (ci * ci * (R::one() - a2) + a2).sqrt();
    let lo = (co * co * (R::one() - a2) + a2).sqrt();
    let v = R::lit(0.5) / (ci * lo + co * li).max(R::lit(1e-12));
    let f = R::lit(0.04) + R::lit(0.96) * (R::one() - cos_d).pow5();
    R::select(
        R::lit(1e-6).lt(ci) & R::lit(1e-6).lt(co),
        f * d * v * ci,
        R::zero(),
    )
}

/// A formula of two numbers that is the same source over any [`Real`].
trait Formula {
    fn of<R: Real>(x: R, y: R) -> R;
}

macro_rules! formulas {
    ($($name:ident($x:ident, $y:ident) = $f:expr;)+) => {$(
        struct $name;
        impl Formula for $name {
            #[inline(always)]
            fn of<R: Real>($x: R, $y: R) -> R {
                $f
            }
        }
    )+};
}
formulas! {
    Microfacet(x, y) = microfacet(x, y);
    Exp(x, _y) = x.exp();
    Ln(x, _y) = x.ln();
    Sin(x, _y) = x.sin();
    Acos(x, _y) = x.acos();
    Atan2(x, y) = x.atan2(y);
}

struct Batch<'a, F> {
    x: &'a [f32],
    y: &'a [f32],
    result: &'a mut [f32],
    formula: F,
}

impl<F: Formula> Kernel for Batch<'_, F> {
    type Output = ();
    #[inline(always)]
    fn run<const N: usize>(self) {
        let _ = self.formula;
        let inputs = self.x.chunks_exact(N).zip(self.y.chunks_exact(N));
        for ((x, y), result) in inputs.zip(self.result.chunks_exact_mut(N)) {
            F::of(Lanes::<N>::load(x), Lanes::<N>::load(y)).store(result);
        }
    }
}

/// How a batch is run.
#[derive(Clone, Copy)]
enum Way {
    Scalar,
    Lanes(InstructionSet),
}

impl fmt::Display for Way {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scalar => f.write_str("f32"),
            Self::Lanes(set) => write!(f, "{} lanes, {}", set.lanes(), set.name()),
        }
    }
}

fn ways() -> Vec<Way> {
    let sets = InstructionSet::ALL.into_iter().filter(|s| s.is_available());
    std::iter::once(Way::Scalar)
        .chain(sets.map(Way::Lanes))
        .collect()
}

fn run<F: Formula + Copy>(bencher: Bencher, way: Way, formula: F) {
    let ramp = |step: usize| -> Vec<f32> {
        (0..COUNT)
            .map(|i| (i * step % COUNT) as f32 / COUNT as f32 + 1e-3)
            .collect()
    };
    let (x, y) = (ramp(1), ramp(37));
    let mut result = vec![0.0; COUNT];
    bencher
        .counter(ItemsCount::new(COUNT))
        .bench_local(|| match way {
            Way::Scalar => {
                let (x, y) = (divan::black_box(&x), divan::black_box(&y));
                for i in 0..COUNT {
                    // One number at a time, as a path tracer calls it: not to be vectorised behind our back.
                    result[i] = divan::black_box(F::of(x[i], y[i]));
                }
            }
            Way::Lanes(set) => dispatch_on(
                set,
                Batch {
                    x: divan::black_box(&x),
                    y: divan::black_box(&y),
                    result: divan::black_box(&mut result),
                    formula,
                },
            ),
        });
}

macro_rules! benches {
    ($($name:ident $formula:ident),+) => {$(
        impl Clone for $formula {
            fn clone(&self) -> Self {
                *self
            }
        }
        impl Copy for $formula {}

        #[divan::bench(args = ways())]
        fn $name(bencher: Bencher, way: Way) {
            run(bencher, way, $formula);
        }
    )+};
}
benches!(microfacet_formula Microfacet, exp Exp, ln Ln, sin Sin, acos Acos, atan2 Atan2);

fn main() {
    divan::main();
}
