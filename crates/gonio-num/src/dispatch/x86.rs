//! Kernels under AVX2 and AVX-512: one of the two unsafe modules of the crate.
//!
//! Invariant: a function marked `#[target_feature]` is called only after the processor was found to have **all** the features
//! that it is marked with. Each safe function below asserts this itself, right before its call, so no caller can break it.
#![allow(unsafe_code)]

use super::Kernel;

/// Whether the processor has what [`run_avx2`] needs.
#[inline]
pub(super) fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2")
}

/// Whether the processor has what [`run_avx512`] needs.
#[inline]
pub(super) fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

/// Runs `kernel` over 8 lanes, compiled for AVX2.
///
/// # Panics
/// If the processor has no AVX2.
#[inline]
pub(super) fn run_avx2<K: Kernel>(kernel: K) -> K::Output {
    #[target_feature(enable = "avx2")]
    fn with_features<K: Kernel>(kernel: K) -> K::Output {
        kernel.run::<8>()
    }
    assert!(has_avx2(), "AVX2 code on a processor without AVX2");
    // SAFETY: the processor has AVX2, the one feature enabled, as the assertion above has just found.
    unsafe { with_features(kernel) }
}

/// Runs `kernel` over 16 lanes, compiled for AVX-512.
///
/// # Panics
/// If the processor lacks AVX-512 F, BW, DQ or VL.
#[inline]
pub(super) fn run_avx512<K: Kernel>(kernel: K) -> K::Output {
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
    fn with_features<K: Kernel>(kernel: K) -> K::Output {
        kernel.run::<16>()
    }
    assert!(has_avx512(), "AVX-512 code on a processor without AVX-512");
    // SAFETY: the processor has the four features enabled, as the assertion above has just found.
    unsafe { with_features(kernel) }
}
