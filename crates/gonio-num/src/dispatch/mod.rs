//! The choice of instruction set at run time.
//!
//! A portable build may only use the instructions that every processor of its kind has (SSE2 on x86-64), yet most
//! machines have more. So a batch is written as a [`Kernel`], generic over the number of lanes, and
//! [`dispatch`] runs it inside a function compiled for the best instruction set that the machine at hand has. The results
//! have the same bits under each of them.
//!
//! Two rules make a kernel fast; without them it is correct, but several times slower:
//! 1. [`Kernel::run`] and everything that it calls over lanes is `#[inline(always)]`, so that it becomes part of the function that
//!    carries the instruction set. A function that isn't inlined is compiled for the baseline.
//! 2. A kernel calls no closures and no `array::map` on lanes: they are functions of their own, without the
//!    instruction set. A plain `for` loop does.
//!
//! ```
//! use gonio_num::dispatch::{Kernel, dispatch};
//! use gonio_num::{Real, lanes::Lanes};
//!
//! /// √(1 + x²), written once over any number.
//! #[inline(always)]
//! fn hypotenuse<R: Real>(x: R) -> R {
//!     (R::one() + x * x).sqrt()
//! }
//!
//! struct Batch<'a> {
//!     x: &'a [f32],
//!     result: &'a mut [f32],
//! }
//!
//! impl Kernel for Batch<'_> {
//!     type Output = ();
//!     #[inline(always)]
//!     fn run<const N: usize>(self) {
//!         for (x, result) in self.x.chunks(N).zip(self.result.chunks_mut(N)) {
//!             hypotenuse(Lanes::<N>::load_or(x, 0.0)).store(result);
//!         }
//!     }
//! }
//!
//! let x = [0.0, 1.0, 2.0, 3.0, 4.0];
//! let mut result = [0.0; 5];
//! dispatch(Batch { x: &x, result: &mut result });
//! assert_eq!(result[4], hypotenuse(4.0f32));
//! ```

#[cfg(target_arch = "x86_64")]
mod x86;

use crate::Work;
use std::sync::atomic::{AtomicU8, Ordering};

/// Work over lanes that is compiled once for each instruction set.
pub trait Kernel {
    /// What the work gives.
    type Output;

    /// The work, over `N` lanes at a time. Mark it `#[inline(always)]`: see the [module](self).
    fn run<const N: usize>(self) -> Self::Output;
}

/// Lanes of [`InstructionSet::Baseline`]. Eight in pairs of 4-wide registers, because the compiler unrolls loops over 4 lanes before it gets
/// to vectorise them (measured on SSE2: sine runs 2.5 times faster on 8 lanes than on 4); four in WebAssembly, where a page loads the code.
pub const BASELINE_LANES: usize = if cfg!(target_family = "wasm") { 4 } else { 8 };

/// A set of vector instructions that kernels are compiled for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum InstructionSet {
    /// What the program was compiled for, [`BASELINE_LANES`]: SSE2 on x86-64, NEON on AArch64, SIMD128 in WebAssembly, whatever there is
    /// elsewhere.
    Baseline,
    /// AVX2 on x86-64, 8 lanes.
    Avx2,
    /// AVX-512 with its F, BW, DQ and VL parts on x86-64, 16 lanes.
    Avx512,
}

impl InstructionSet {
    /// All of them, the narrowest first.
    pub const ALL: [Self; 3] = [Self::Baseline, Self::Avx2, Self::Avx512];

    /// The widest that this machine has. The processor is asked once a process.
    #[inline]
    pub fn detect() -> Self {
        static FOUND: AtomicU8 = AtomicU8::new(0);
        match FOUND.load(Ordering::Relaxed) {
            0 => {
                let found = Self::ALL.into_iter().rev().find(|set| set.is_available());
                let found = found.unwrap_or(Self::Baseline);
                // Several threads may ask at once: they find the same.
                FOUND.store(found as u8 + 1, Ordering::Relaxed);
                found
            }
            known => Self::ALL[known as usize - 1],
        }
    }

    /// Whether this machine has it. The standard library remembers the processor's answer.
    #[inline]
    pub fn is_available(self) -> bool {
        match self {
            Self::Baseline => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => x86::has_avx2(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => x86::has_avx512(),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }

    /// Its name, as `gonio` reports it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline if cfg!(target_arch = "x86_64") => "SSE2",
            Self::Baseline if cfg!(target_arch = "aarch64") => "NEON",
            Self::Baseline if cfg!(target_feature = "simd128") => "SIMD128",
            Self::Baseline => "portable",
            Self::Avx2 => "AVX2",
            Self::Avx512 => "AVX-512",
        }
    }

    /// How many lanes a kernel runs over at a time.
    pub fn lanes(self) -> usize {
        match self {
            Self::Baseline => BASELINE_LANES,
            Self::Avx2 => 8,
            Self::Avx512 => 16,
        }
    }
}

/// Runs `kernel` under the widest instruction set of this machine.
#[inline]
pub fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    dispatch_on(InstructionSet::detect(), kernel)
}

/// Runs `kernel` under a given instruction set: for tests and benchmarks.
///
/// # Panics
/// If this machine doesn't have it ([`InstructionSet::is_available`]).
#[inline]
pub fn dispatch_on<K: Kernel>(set: InstructionSet, kernel: K) -> K::Output {
    match set {
        InstructionSet::Baseline => kernel.run::<BASELINE_LANES>(),
        wide => dispatch_wide(wide, kernel),
    }
}

/// As [`dispatch_on`], without the code for the baseline where processors that have nothing better are rare: on x86-64. A kernel of much
/// code is then compiled twice instead of three times; whoever asks has another way for the baseline.
///
/// # Panics
/// If the machine doesn't have the instruction set, or it is the baseline on x86-64.
#[inline]
pub fn dispatch_wide<K: Kernel>(set: InstructionSet, kernel: K) -> K::Output {
    assert!(
        set.is_available(),
        "this machine has no {} instructions",
        set.name()
    );
    match set {
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Baseline => panic!("the baseline of x86-64 was left out"),
        #[cfg(not(target_arch = "x86_64"))]
        InstructionSet::Baseline => kernel.run::<BASELINE_LANES>(),
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx2 => x86::run_avx2(kernel),
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx512 => x86::run_avx512(kernel),
        #[cfg(not(target_arch = "x86_64"))]
        InstructionSet::Avx2 | InstructionSet::Avx512 => {
            unreachable!("only x86-64 machines have it")
        }
    }
}

/// Runs `work` over `N` lanes in a function of its own, compiled for the widest instruction set of this machine if that has `N`
/// lanes, else for the baseline.
#[inline(never)]
pub(crate) fn run_with_lanes<const N: usize, W: Work>(work: W) -> W::Output {
    // `const`: the arms for another number of lanes are never compiled.
    #[cfg(target_arch = "x86_64")]
    {
        let set = InstructionSet::detect();
        if const { N == 8 } {
            if set == InstructionSet::Avx2 {
                return x86::run_avx2(Same::<W, N>(work));
            }
        } else if const { N == 16 } && set == InstructionSet::Avx512 {
            return x86::run_avx512(Same::<W, N>(work));
        }
    }
    work.run()
}

/// Work as a kernel that is only run over `N` lanes.
#[cfg(target_arch = "x86_64")]
struct Same<W, const N: usize>(W);

#[cfg(target_arch = "x86_64")]
impl<W: Work, const N: usize> Kernel for Same<W, N> {
    type Output = W::Output;
    #[inline(always)]
    fn run<const L: usize>(self) -> W::Output {
        self.0.run()
    }
}
