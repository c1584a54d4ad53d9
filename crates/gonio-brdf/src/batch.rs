//! Many directions at once: the same formulas over lanes, under the widest instruction set of the machine.
//!
//! Directions are structures of arrays. Results have the same bits as those of a single call in `f32`, on any machine.
//! A batch is several times faster than single calls for the closed-form models; `Sum` and `Scaled` dispatch for each
//! group of lanes, and a `Table` of cells reads its memory lane by lane.

use crate::model::Visitor;
use crate::{Brdf, Model};
use gonio_num::dispatch::{InstructionSet, Kernel, dispatch_on};
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

/// Draws a direction for each wo from three numbers in [0, 1).
///
/// # Panics
/// If the lengths differ.
pub fn sample<const N: usize>(
    model: &Model<f32, N>,
    wo: Directions<'_>,
    u: [&[f32]; 3],
    result: Samples<'_, N>,
) {
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
        && let Some((adaptive, factor)) = table.batched()
    {
        adaptive.eval_batch(set, factor, [wi, wo], three(result));
        return;
    }
    dispatch_on(
        set,
        Eval {
            model,
            wi,
            wo,
            result,
        },
    );
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
        && let Some((adaptive, _)) = table.batched()
    {
        adaptive.pdf_batch(set, [wi, wo], result);
        return;
    }
    dispatch_on(
        set,
        Pdf {
            model,
            wi,
            wo,
            result,
        },
    );
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
        && let Some((adaptive, factor)) = table.batched()
    {
        let result = Samples {
            wi: result.wi,
            weight: three(result.weight),
            pdf: result.pdf,
            delta: result.delta,
        };
        adaptive.sample_batch(set, factor, wo, u, result);
        return;
    }
    dispatch_on(
        set,
        Draw {
            model,
            wo,
            u,
            result,
        },
    );
}

/// The slices of three colour components.
fn three<T, const N: usize>(slices: [T; N]) -> [T; 3] {
    let mut slices = slices.into_iter();
    std::array::from_fn(|_| slices.next().expect("invariant: a measurement has three"))
}

// A kernel splats the model's numbers over the lanes once, then chooses the model once, outside the loop.
macro_rules! kernel {
    ($name:ident) => {
        impl<const N: usize> Kernel for $name<'_, N> {
            type Output = ();
            #[inline(always)]
            fn run<const L: usize>(self) {
                let lanes: Model<Lanes<L>, N> = self.model.cast(&Lanes::splat);
                lanes.visit(self);
            }
        }
    };
}

struct Eval<'a, const N: usize> {
    model: &'a Model<f32, N>,
    wi: Directions<'a>,
    wo: Directions<'a>,
    result: [&'a mut [f32]; N],
}
kernel!(Eval);

impl<const L: usize, const N: usize> Visitor<Lanes<L>, N> for Eval<'_, N> {
    #[inline(always)]
    fn visit<B: Brdf<Lanes<L>, N>>(self, model: &B) {
        let mut at = 0;
        while at < self.wo.len() {
            let f = model.eval(self.wi.load(at), self.wo.load(at));
            for k in 0..N {
                f[k].store(&mut self.result[k][at..]);
            }
            at += L;
        }
    }
}

struct Pdf<'a, const N: usize> {
    model: &'a Model<f32, N>,
    wi: Directions<'a>,
    wo: Directions<'a>,
    result: &'a mut [f32],
}
kernel!(Pdf);

impl<const L: usize, const N: usize> Visitor<Lanes<L>, N> for Pdf<'_, N> {
    #[inline(always)]
    fn visit<B: Brdf<Lanes<L>, N>>(self, model: &B) {
        let mut at = 0;
        while at < self.wo.len() {
            model
                .pdf(self.wi.load(at), self.wo.load(at))
                .store(&mut self.result[at..]);
            at += L;
        }
    }
}

struct Draw<'a, const N: usize> {
    model: &'a Model<f32, N>,
    wo: Directions<'a>,
    u: [&'a [f32]; 3],
    result: Samples<'a, N>,
}
kernel!(Draw);

impl<const L: usize, const N: usize> Visitor<Lanes<L>, N> for Draw<'_, N> {
    #[inline(always)]
    fn visit<B: Brdf<Lanes<L>, N>>(self, model: &B) {
        let mut at = 0;
        while at < self.wo.len() {
            let u = [
                Lanes::load_or(&self.u[0][at..], 0.0),
                Lanes::load_or(&self.u[1][at..], 0.0),
                Lanes::load_or(&self.u[2][at..], 0.0),
            ];
            let s = model.sample(self.wo.load(at), u);
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
