//! Many directions at once: the same formulas over lanes, under the widest instruction set of the machine.
//!
//! Directions are structures of arrays. Results have the same bits as those of a single call in `f32`, on any machine.
//! A batch is several times faster than single calls for the closed-form models. A model made of others has a batch of each part
//! evaluated for a group of directions at a time, and `Table` reads its memory lane by lane, but for adaptive
//! tables, which have batches of their own.
//!
//! The functions of three components that a renderer calls, [`eval_and_pdf`] and [`sample`], are compiled with this crate; the generic ones
//! with whoever calls them, which takes minutes.

#![cfg_attr(any(fuzzing, test), allow(unused_variables))]

use crate::model::{Castable, Composite, Visitor};
use crate::{Brdf, Model, Sample};
use gonio_num::dispatch::{InstructionSet, Kernel, dispatch_wide};
use gonio_num::lanes::Lanes;
use gonio_num::{Real, Vec3};

/// Directions as a structure of arrays, all of the same length.
#[derive(Debug, Clone, Copy)]
pub struct Directions<'a> {
    /// First coordinates.
    pub x: &'a [f32],
    /// Second coordinates.
    pub y: &'a [f32],
    /// Third coordinates.
    pub z: &'a [f32],
}

impl Directions<'_> {
    /// Number of directions.
    pub fn len(&self) -> usize {
        self.z.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.z.is_empty()
    }

    #[inline(always)]
    fn load<const L: usize>(&self, at: usize) -> Vec3<Lanes<L>> {
        // Past the end every function is 0: (0, 0, 0) is not above the horizon.
        Vec3::new(
            Lanes::load_or(&self.x[at..], 0.0),
            Lanes::load_or(&self.y[at..], 0.0),
            Lanes::load_or(&self.z[at..], 0.0),
        )
    }

    fn check(&self, n: usize) {
        assert!(
            self.x.len() == n && self.y.len() == n && self.z.len() == n,
            "directions and results must have the same length"
        );
    }
}

/// Where [`sample`] writes, all slices of the same length.
#[derive(Debug)]
pub struct Samples<'a, const N: usize> {
    /// Coordinates of the directions to the light.
    pub wi: [&'a mut [f32]; 3],
    /// f·|cosθi|/pdf, one slice a colour component.
    pub weight: [&'a mut [f32]; N],
    /// Densities per solid angle; 0 where nothing was drawn.
    pub pdf: &'a mut [f32],
    /// Whether the direction is discrete.
    pub delta: &'a mut [bool],
}

/// f(wi→wo) in sr⁻¹ without the cosine, for each pair; `result` has one slice a colour component.
///
/// # Panics
/// If the lengths differ.
pub fn eval<const N: usize>(
    model: &Model<f32, N>,
    wi: Directions<'_>,
    wo: Directions<'_>,
    result: [&mut [f32]; N],
) {
    eval_on(InstructionSet::detect(), model, wi, wo, result);
}

/// The density in sr⁻¹ of sampling wi given wo, for each pair.
///
/// # Panics
/// If the lengths differ.
pub fn pdf<const N: usize>(
    model: &Model<f32, N>,
    wi: Directions<'_>,
    wo: Directions<'_>,
    result: &mut [f32],
) {
    pdf_on(InstructionSet::detect(), model, wi, wo, result);
}

/// [`eval`] and [`pdf`] at once, the same to the bit, for less than both cost.
///
/// # Panics
/// If the lengths differ.
#[inline(never)]
pub fn eval_and_pdf(
    model: &Model<f32, 3>,
    wi: Directions<'_>,
    wo: Directions<'_>,
    result: [&mut [f32]; 3],
    pdf: &mut [f32],
) {
    eval_and_pdf_on(InstructionSet::detect(), model, wi, wo, result, pdf);
}

/// Draws a direction for each wo from three numbers in [0, 1).
///
/// # Panics
/// If the lengths differ.
#[inline(never)]
pub fn sample(model: &Model<f32, 3>, wo: Directions<'_>, u: [&[f32]; 3], result: Samples<'_, 3>) {
    sample_on(InstructionSet::detect(), model, wo, u, result);
}

/// As [`eval`], under a given instruction set.
///
/// # Panics
/// If the lengths differ or the machine doesn't have the instruction set.
pub fn eval_on<const N: usize>(
    set: InstructionSet,
    model: &Model<f32, N>,
    wi: Directions<'_>,
    wo: Directions<'_>,
    result: [&mut [f32]; N],
) {
    wi.check(wo.len());
    wo.check(wo.len());
    for r in &result {
        assert_eq!(
            r.len(),
            wo.len(),
            "results must have the directions' length"
        );
    }
    if let Model::Table(table) = model
        && let Some((all, factor)) = table.batched()
    {
        all.eval_batch(set, factor, [wi, wo], three(result));
        return;
    }
    run(set, model, Eval { wi, wo, result });
}

/// As [`pdf`], under a given instruction set.
///
/// # Panics
/// If the lengths differ or the machine doesn't have the instruction set.
pub fn pdf_on<const N: usize>(
    set: InstructionSet,
    model: &Model<f32, N>,
    wi: Directions<'_>,
    wo: Directions<'_>,
    result: &mut [f32],
) {
    wi.check(result.len());
    wo.check(result.len());
    if let Model::Table(table) = model
        && let Some((all, _)) = table.batched()
    {
        all.pdf_batch(set, [wi, wo], result);
        return;
    }
    run(set, model, Pdf { wi, wo, result });
}

/// As [`eval_and_pdf`], under a given instruction set.
///
/// # Panics
/// If the lengths differ or the machine doesn't have the instruction set.
pub fn eval_and_pdf_on<const N: usize>(
    set: InstructionSet,
    model: &Model<f32, N>,
    wi: Directions<'_>,
    wo: Directions<'_>,
    result: [&mut [f32]; N],
    pdf: &mut [f32],
) {
    wi.check(pdf.len());
    wo.check(pdf.len());
    for r in &result {
        assert_eq!(
            r.len(),
            pdf.len(),
            "results must have the directions' length"
        );
    }
    if let Model::Table(table) = model
        && let Some((all, factor)) = table.batched()
    {
        all.eval_batch(set, factor, [wi, wo], three(result));
        all.pdf_batch(set, [wi, wo], pdf);
        return;
    }
    let batch = EvalAndPdf {
        wi,
        wo,
        result,
        pdf,
    };
    run(set, model, batch);
}

/// As [`sample`], under a given instruction set.
///
/// # Panics
/// If the lengths differ or the machine doesn't have the instruction set.
pub fn sample_on<const N: usize>(
    set: InstructionSet,
    model: &Model<f32, N>,
    wo: Directions<'_>,
    u: [&[f32]; 3],
    result: Samples<'_, N>,
) {
    let n = wo.len();
    wo.check(n);
    let same = u.iter().all(|u| u.len() == n)
        && result.wi.iter().all(|r| r.len() == n)
        && result.weight.iter().all(|r| r.len() == n)
        && result.pdf.len() == n
        && result.delta.len() == n;
    assert!(
        same,
        "directions, numbers and results must have the same length"
    );
    if let Model::Table(table) = model
        && let Some((all, factor)) = table.batched()
    {
        let result = Samples {
            wi: result.wi,
            weight: three(result.weight),
            pdf: result.pdf,
            delta: result.delta,
        };
        all.sample_batch(set, factor, wo, u, result);
        return;
    }
    run(set, model, Draw { wo, u, result });
}

/// The slices of three colour components.
fn three<T, const N: usize>(slices: [T; N]) -> [T; 3] {
    let mut slices = slices.into_iter();
    std::array::from_fn(|_| {
        slices
            .next()
            .expect("invariant: a table with batches has three")
    })
}

/// The model, of which a compiler knows nothing from one step to the next. Otherwise it makes a loop of its own for every combination
/// of a model's choices, which never change in the loop: much code for nothing measurable.
#[inline(always)]
fn opaque<B>(model: &B) -> &B {
    std::hint::black_box(model)
}

/// What is done over lanes, with a model in its own type.
trait Batch<const N: usize> {
    fn run<const L: usize, B: Brdf<Lanes<L>, N>>(self, model: &B);
}

/// A batch on an instruction set. The model is chosen first and the instruction set then, so that each model's loop is a function
/// of its own.
struct On<T>(InstructionSet, T);

/// One direction after the other, for the oldest processors of a kind whose others have more: their lanes wouldn't be worth the code.
struct Singly<'a, const N: usize>(&'a Model<f32, N>);

/// Whether models are evaluated over lanes at all. In WebAssembly they aren't: a page loads a tenth less code for it.
const LANES: bool = cfg!(not(target_family = "wasm"));

/// Whether lanes under this instruction set are worth the code.
fn has_lanes(set: InstructionSet) -> bool {
    set != InstructionSet::Baseline || cfg!(not(target_arch = "x86_64"))
}

impl<const N: usize, const L: usize> Brdf<Lanes<L>, N> for Singly<'_, N> {
    fn eval(&self, wi: Vec3<Lanes<L>>, wo: Vec3<Lanes<L>>) -> [Lanes<L>; N] {
        let mut f = [Lanes::splat(0.0); N];
        for lane in 0..L {
            let one = self.0.eval(wi.extract(lane), wo.extract(lane));
            for k in 0..N {
                f[k].0[lane] = one[k];
            }
        }
        f
    }

    fn pdf(&self, wi: Vec3<Lanes<L>>, wo: Vec3<Lanes<L>>) -> Lanes<L> {
        let mut pdf = Lanes::splat(0.0);
        for lane in 0..L {
            pdf.0[lane] = self.0.pdf(wi.extract(lane), wo.extract(lane));
        }
        pdf
    }

    fn eval_and_pdf(&self, wi: Vec3<Lanes<L>>, wo: Vec3<Lanes<L>>) -> ([Lanes<L>; N], Lanes<L>) {
        let (mut f, mut pdf) = ([Lanes::splat(0.0); N], Lanes::splat(0.0));
        for lane in 0..L {
            let (one, density) = self.0.eval_and_pdf(wi.extract(lane), wo.extract(lane));
            for k in 0..N {
                f[k].0[lane] = one[k];
            }
            pdf.0[lane] = density;
        }
        (f, pdf)
    }

    fn sample(&self, wo: Vec3<Lanes<L>>, u: [Lanes<L>; 3]) -> Sample<Lanes<L>, N> {
        let mut s = Sample::<Lanes<L>, N>::none();
        for lane in 0..L {
            let one = self.0.sample(wo.extract(lane), u.map(|u| u.0[lane]));
            s.wi.x.0[lane] = one.wi.x;
            s.wi.y.0[lane] = one.wi.y;
            s.wi.z.0[lane] = one.wi.z;
            for k in 0..N {
                s.weight[k].0[lane] = one.weight[k];
            }
            s.pdf.0[lane] = one.pdf;
            s.delta.0[lane] = one.delta;
        }
        s
    }

    fn albedo_estimate(&self, wo: Vec3<Lanes<L>>) -> Lanes<L> {
        let mut estimate = Lanes::splat(0.0);
        for lane in 0..L {
            estimate.0[lane] = self.0.albedo_estimate(wo.extract(lane));
        }
        estimate
    }
}

/// Runs a batch of a model.
fn run<T: Batch<N>, const N: usize>(set: InstructionSet, model: &Model<f32, N>, batch: T) {
    // Programs that fuzz readers, and the tests beside the code, would take minutes more to compile with lanes that they have no use for.
    #[cfg(not(any(fuzzing, test)))]
    if LANES && has_lanes(set) {
        model.visit(On(set, batch));
        return;
    }
    batch.run::<8, _>(&Singly(model));
}

impl<T: Batch<N>, const N: usize> Visitor<f32, N> for On<T> {
    fn visit<B: Castable<f32, N>>(self, model: &B) {
        dispatch_wide(self.0, Chosen(model, self.1));
    }

    fn visit_composite<C: Composite<f32, N>>(self, model: &C) {
        let part = |model| Part { set: self.0, model };
        self.1.run(&model.with(&Group::splat, &part));
    }
}

/// Directions that a composite passes to its parts at a time: enough that the choice of the part and of the instruction set costs
/// little beside the work.
type Group = Lanes<64>;

/// A part of a composite: each call is a batch of one group.
struct Part<'a, const N: usize> {
    set: InstructionSet,
    model: &'a Model<f32, N>,
}

fn directions(w: &Vec3<Group>) -> Directions<'_> {
    Directions {
        x: &w.x.0,
        y: &w.y.0,
        z: &w.z.0,
    }
}

impl<const N: usize> Brdf<Group, N> for Part<'_, N> {
    fn eval(&self, wi: Vec3<Group>, wo: Vec3<Group>) -> [Group; N] {
        let mut f = [Group::splat(0.0); N];
        let result = f.each_mut().map(|f| &mut f.0[..]);
        eval_on(
            self.set,
            self.model,
            directions(&wi),
            directions(&wo),
            result,
        );
        f
    }

    fn pdf(&self, wi: Vec3<Group>, wo: Vec3<Group>) -> Group {
        let mut pdf = Group::splat(0.0);
        let (wi, wo) = (directions(&wi), directions(&wo));
        pdf_on(self.set, self.model, wi, wo, &mut pdf.0);
        pdf
    }

    fn eval_and_pdf(&self, wi: Vec3<Group>, wo: Vec3<Group>) -> ([Group; N], Group) {
        let mut f = [Group::splat(0.0); N];
        let mut pdf = Group::splat(0.0);
        let result = f.each_mut().map(|f| &mut f.0[..]);
        let (wi, wo) = (directions(&wi), directions(&wo));
        eval_and_pdf_on(self.set, self.model, wi, wo, result, &mut pdf.0);
        (f, pdf)
    }

    fn sample(&self, wo: Vec3<Group>, u: [Group; 3]) -> Sample<Group, N> {
        let mut s = Sample::<Group, N>::none();
        let result = Samples {
            wi: [&mut s.wi.x.0, &mut s.wi.y.0, &mut s.wi.z.0],
            weight: s.weight.each_mut().map(|w| &mut w.0[..]),
            pdf: &mut s.pdf.0,
            delta: &mut s.delta.0,
        };
        let u = [&u[0].0[..], &u[1].0, &u[2].0];
        sample_on(self.set, self.model, directions(&wo), u, result);
        s
    }

    fn albedo_estimate(&self, wo: Vec3<Group>) -> Group {
        let mut result = Group::splat(0.0);
        let wo = directions(&wo);
        let work = Estimate {
            wo,
            result: &mut result.0,
        };
        run(self.set, self.model, work);
        result
    }

    fn transmits(&self) -> bool {
        self.model.transmits()
    }

    fn relative_ior(&self) -> [Group; N] {
        self.model.relative_ior().map(Group::splat)
    }

    fn absorption(&self) -> [Group; N] {
        self.model.absorption().map(Group::splat)
    }
}

/// A batch with its model: a kernel splats the model's numbers over the lanes once.
struct Chosen<'a, B, T, const N: usize>(&'a B, T);

impl<B: Castable<f32, N>, T: Batch<N>, const N: usize> Kernel for Chosen<'_, B, T, N> {
    type Output = ();
    #[inline(always)]
    fn run<const L: usize>(self) {
        self.1.run(&self.0.over(&Lanes::<L>::splat));
    }
}

struct Eval<'a, const N: usize> {
    wi: Directions<'a>,
    wo: Directions<'a>,
    result: [&'a mut [f32]; N],
}

impl<const N: usize> Batch<N> for Eval<'_, N> {
    #[inline(always)]
    fn run<const L: usize, B: Brdf<Lanes<L>, N>>(self, model: &B) {
        let mut at = 0;
        while at < self.wo.len() {
            let f = opaque(model).eval(self.wi.load(at), self.wo.load(at));
            for k in 0..N {
                f[k].store(&mut self.result[k][at..]);
            }
            at += L;
        }
    }
}

struct Pdf<'a> {
    wi: Directions<'a>,
    wo: Directions<'a>,
    result: &'a mut [f32],
}

impl<const N: usize> Batch<N> for Pdf<'_> {
    #[inline(always)]
    fn run<const L: usize, B: Brdf<Lanes<L>, N>>(self, model: &B) {
        let mut at = 0;
        while at < self.wo.len() {
            opaque(model)
                .pdf(self.wi.load(at), self.wo.load(at))
                .store(&mut self.result[at..]);
            at += L;
        }
    }
}

struct EvalAndPdf<'a, const N: usize> {
    wi: Directions<'a>,
    wo: Directions<'a>,
    result: [&'a mut [f32]; N],
    pdf: &'a mut [f32],
}

impl<const N: usize> Batch<N> for EvalAndPdf<'_, N> {
    #[inline(always)]
    fn run<const L: usize, B: Brdf<Lanes<L>, N>>(self, model: &B) {
        let mut at = 0;
        while at < self.wo.len() {
            let (f, pdf) = opaque(model).eval_and_pdf(self.wi.load(at), self.wo.load(at));
            for k in 0..N {
                f[k].store(&mut self.result[k][at..]);
            }
            pdf.store(&mut self.pdf[at..]);
            at += L;
        }
    }
}

struct Estimate<'a> {
    wo: Directions<'a>,
    result: &'a mut [f32],
}

impl<const N: usize> Batch<N> for Estimate<'_> {
    #[inline(always)]
    fn run<const L: usize, B: Brdf<Lanes<L>, N>>(self, model: &B) {
        let mut at = 0;
        while at < self.wo.len() {
            opaque(model)
                .albedo_estimate(self.wo.load(at))
                .store(&mut self.result[at..]);
            at += L;
        }
    }
}

struct Draw<'a, const N: usize> {
    wo: Directions<'a>,
    u: [&'a [f32]; 3],
    result: Samples<'a, N>,
}

impl<const N: usize> Batch<N> for Draw<'_, N> {
    #[inline(always)]
    fn run<const L: usize, B: Brdf<Lanes<L>, N>>(self, model: &B) {
        let mut at = 0;
        while at < self.wo.len() {
            let u = [
                Lanes::load_or(&self.u[0][at..], 0.0),
                Lanes::load_or(&self.u[1][at..], 0.0),
                Lanes::load_or(&self.u[2][at..], 0.0),
            ];
            let s = opaque(model).sample(self.wo.load(at), u);
            let wi = s.wi.to_array();
            for k in 0..3 {
                wi[k].store(&mut self.result.wi[k][at..]);
            }
            for k in 0..N {
                s.weight[k].store(&mut self.result.weight[k][at..]);
            }
            s.pdf.store(&mut self.result.pdf[at..]);
            let delta = Lanes::<L>::from_mask(s.delta);
            for (lane, d) in self.result.delta[at..].iter_mut().take(L).enumerate() {
                *d = delta.0[lane] != 0.0;
            }
            at += L;
        }
    }
}
