//! Arithmetic on colours `[R; N]`, component by component.

use gonio_num::Real;

/// Runs the body once for each component, `$c` = 0, 1, … `$n` − 1, written out for the first four.
///
/// Not a loop: a compiler vectorises a loop over the components of lanes along its three steps, a quarter of a register at a
/// time, instead of along the lanes.
macro_rules! each_component {
    ($n:ident, $c:ident => $body:block) => {
        if $n > 0 {
            let $c = 0;
            $body
        }
        if $n > 1 {
            let $c = 1;
            $body
        }
        if $n > 2 {
            let $c = 2;
            $body
        }
        if $n > 3 {
            let $c = 3;
            $body
        }
        for $c in 4..$n {
            $body
        }
    };
}
pub(crate) use each_component;

/// `x` in every component.
#[inline(always)]
pub(crate) fn grey<R: Real, const N: usize>(x: R) -> [R; N] {
    [x; N]
}

/// a + b.
#[inline(always)]
pub(crate) fn add<R: Real, const N: usize>(a: [R; N], b: [R; N]) -> [R; N] {
    let mut out = a;
    each_component!(N, k => { out[k] = a[k] + b[k]; });
    out
}

/// a · b.
#[inline(always)]
pub(crate) fn mul<R: Real, const N: usize>(a: [R; N], b: [R; N]) -> [R; N] {
    let mut out = a;
    each_component!(N, k => { out[k] = a[k] * b[k]; });
    out
}

/// a · s.
#[inline(always)]
pub(crate) fn scale<R: Real, const N: usize>(a: [R; N], s: R) -> [R; N] {
    let mut out = a;
    each_component!(N, k => { out[k] = a[k] * s; });
    out
}

/// `a` where the mask is true, 0 elsewhere.
#[inline(always)]
pub(crate) fn only_where<R: Real, const N: usize>(mask: R::Mask, a: [R; N]) -> [R; N] {
    let mut out = a;
    each_component!(N, k => { out[k] = R::select(mask, a[k], R::zero()); });
    out
}

/// Mean of the components.
#[inline(always)]
pub(crate) fn mean<R: Real, const N: usize>(a: [R; N]) -> R {
    let mut sum = R::zero();
    each_component!(N, k => { sum = sum + a[k]; });
    sum * R::lit(1.0 / N as f64)
}

/// The largest component.
#[inline(always)]
pub(crate) fn largest<R: Real, const N: usize>(a: [R; N]) -> R {
    let mut out = a[0];
    each_component!(N, k => { out = out.max(a[k]); });
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
