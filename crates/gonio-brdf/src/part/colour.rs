//! Arithmetic on colours `[R; N]`, component by component.

use gonio_num::Real;

/// `x` in every component.
#[inline(always)]
pub(crate) fn grey<R: Real, const N: usize>(x: R) -> [R; N] {
    [x; N]
}

/// a + b.
#[inline(always)]
pub(crate) fn add<R: Real, const N: usize>(a: [R; N], b: [R; N]) -> [R; N] {
    let mut out = a;
    for k in 0..N {
        out[k] = a[k] + b[k];
    }
    out
}

/// a · b.
#[inline(always)]
pub(crate) fn mul<R: Real, const N: usize>(a: [R; N], b: [R; N]) -> [R; N] {
    let mut out = a;
    for k in 0..N {
        out[k] = a[k] * b[k];
    }
    out
}

/// a · s.
#[inline(always)]
pub(crate) fn scale<R: Real, const N: usize>(a: [R; N], s: R) -> [R; N] {
    let mut out = a;
    for x in &mut out {
        *x = *x * s;
    }
    out
}

/// `a` where the mask is true, 0 elsewhere.
#[inline(always)]
pub(crate) fn only_where<R: Real, const N: usize>(mask: R::Mask, a: [R; N]) -> [R; N] {
    let mut out = a;
    for x in &mut out {
        *x = R::select(mask, *x, R::zero());
    }
    out
}

/// Mean of the components.
#[inline(always)]
pub(crate) fn mean<R: Real, const N: usize>(a: [R; N]) -> R {
    let mut sum = R::zero();
    for x in a {
        sum = sum + x;
    }
    sum * R::lit(1.0 / N as f64)
}

/// The largest component.
#[inline(always)]
pub(crate) fn largest<R: Real, const N: usize>(a: [R; N]) -> R {
    let mut out = a[0];
    for x in a {
        out = out.max(x);
    }
    out
}

/// Each component converted by `f`, for changing the number type.
pub(crate) fn cast<R: Real, S: Real, const N: usize>(a: [R; N], f: &impl Fn(R) -> S) -> [S; N] {
    let mut out = [S::zero(); N];
    for (y, x) in out.iter_mut().zip(a) {
        *y = f(x);
    }
    out
}
