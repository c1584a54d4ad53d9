//! Sums over many lights for many axes: lanes over axes, lights one after another, so that the bits are the same for any width.

use crate::kernel::{Charlie, Cosine, Diffuse, Ggx, Kernel, ModelKernel, Weight};
use gonio_num::dispatch::{self, dispatch};
use gonio_num::lanes::Lanes;
use gonio_num::{Real, Vec3};

/// Lights as a structure of arrays: unit directions, mean radiances, solid angles.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lights {
    pub x: Vec<f32>,
    pub y: Vec<f32>,
    pub z: Vec<f32>,
    pub r: Vec<f32>,
    pub g: Vec<f32>,
    pub b: Vec<f32>,
    /// Solid angle \[sr].
    pub w: Vec<f32>,
}

impl Lights {
    pub fn clear(&mut self) {
        for v in [
            &mut self.x,
            &mut self.y,
            &mut self.z,
            &mut self.r,
            &mut self.g,
            &mut self.b,
            &mut self.w,
        ] {
            v.clear();
        }
    }

    #[inline(always)]
    pub fn push(&mut self, d: [f32; 3], rgb: [f32; 3], w: f32) {
        self.x.push(d[0]);
        self.y.push(d[1]);
        self.z.push(d[2]);
        self.r.push(rgb[0]);
        self.g.push(rgb[1]);
        self.b.push(rgb[2]);
        self.w.push(w);
    }

    /// Copies light `i` of `other`.
    #[inline(always)]
    pub fn push_from(&mut self, other: &Self, i: usize) {
        self.push(
            [other.x[i], other.y[i], other.z[i]],
            [other.r[i], other.g[i], other.b[i]],
            other.w[i],
        );
    }

    pub fn len(&self) -> usize {
        self.w.len()
    }
}

/// Axes and, for each, Σ K Ω L of three channels and Σ K Ω.
#[derive(Debug, Default)]
pub(crate) struct Axes {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    sums: [Vec<f32>; 4],
}

impl Axes {
    pub fn set(&mut self, axes: &[Vec3<f32>]) {
        self.x.clear();
        self.y.clear();
        self.z.clear();
        for a in axes {
            self.x.push(a.x);
            self.y.push(a.y);
            self.z.push(a.z);
        }
        for s in &mut self.sums {
            s.clear();
            s.resize(axes.len(), 0.0);
        }
    }

    /// Σ K Ω L and Σ K Ω of axis `i`.
    pub fn sum(&self, i: usize) -> [f32; 4] {
        [
            self.sums[0][i],
            self.sums[1][i],
            self.sums[2][i],
            self.sums[3][i],
        ]
    }
}

/// Sums `lights` for each of `axes`, over what those held before.
pub(crate) fn gather(kernel: &Kernel, lights: &Lights, axes: &mut Axes) {
    match kernel {
        Kernel::Ggx { alpha } => dispatch(Sum(Ggx::new(*alpha), lights, axes)),
        Kernel::Charlie { alpha } => dispatch(Sum(Charlie::new(*alpha), lights, axes)),
        Kernel::Cosine { exponent: 1.0 } => dispatch(Sum(Diffuse, lights, axes)),
        Kernel::Cosine { exponent } => dispatch(Sum(Cosine::new(*exponent), lights, axes)),
        Kernel::Model(model) => dispatch(SumTable(model, lights, axes)),
    }
}

/// What a kernel over lanes does with one more light.
#[inline(always)]
fn add<const N: usize>(acc: &mut [Lanes<N>; 4], k: Lanes<N>, lights: &Lights, i: usize) {
    let k = k * Lanes::splat(lights.w[i]);
    acc[0] = acc[0] + k * Lanes::splat(lights.r[i]);
    acc[1] = acc[1] + k * Lanes::splat(lights.g[i]);
    acc[2] = acc[2] + k * Lanes::splat(lights.b[i]);
    acc[3] = acc[3] + k;
}

/// |n − ω|².
#[inline(always)]
fn chord2<const N: usize>(n: Vec3<Lanes<N>>, lights: &Lights, i: usize) -> Lanes<N> {
    let dx = n.x - Lanes::splat(lights.x[i]);
    let dy = n.y - Lanes::splat(lights.y[i]);
    let dz = n.z - Lanes::splat(lights.z[i]);
    dx * dx + dy * dy + dz * dz
}

struct Sum<'a, W>(W, &'a Lights, &'a mut Axes);

impl<W: Weight> dispatch::Kernel for Sum<'_, W> {
    type Output = ();

    #[inline(always)]
    fn run<const N: usize>(self) {
        let Sum(weight, lights, axes) = self;
        let count = lights.len();
        let mut at = 0;
        while at < axes.x.len() {
            let n = axis::<N>(axes, at);
            let mut acc = [Lanes::<N>::splat(0.0); 4];
            for i in 0..count {
                let k = weight.weight(chord2(n, lights, i));
                add(&mut acc, k, lights, i);
            }
            put(axes, at, &acc);
            at += N;
        }
    }
}

struct SumTable<'a>(&'a ModelKernel, &'a Lights, &'a mut Axes);

impl dispatch::Kernel for SumTable<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const N: usize>(self) {
        let SumTable(table, lights, axes) = self;
        let count = lights.len();
        let mut at = 0;
        while at < axes.x.len() {
            let n = axis::<N>(axes, at);
            let mut acc = [Lanes::<N>::splat(0.0); 4];
            for i in 0..count {
                let q = chord2(n, lights, i);
                let mut k = q;
                for lane in 0..N {
                    // The table ends with the horizon, where cos θ is 0.
                    k.0[lane] = table.look_up(q.0[lane]);
                }
                let above = q.lt(Lanes::splat(2.0));
                add(
                    &mut acc,
                    Lanes::select(above, k, Lanes::splat(0.0)),
                    lights,
                    i,
                );
            }
            put(axes, at, &acc);
            at += N;
        }
    }
}

#[inline(always)]
fn axis<const N: usize>(axes: &Axes, at: usize) -> Vec3<Lanes<N>> {
    Vec3::new(
        Lanes::load_or(&axes.x[at..], 0.0),
        Lanes::load_or(&axes.y[at..], 0.0),
        Lanes::load_or(&axes.z[at..], 0.0),
    )
}

#[inline(always)]
fn put<const N: usize>(axes: &mut Axes, at: usize, acc: &[Lanes<N>; 4]) {
    for c in 0..4 {
        let before = Lanes::<N>::load_or(&axes.sums[c][at..], 0.0);
        (before + acc[c]).store(&mut axes.sums[c][at..]);
    }
}
