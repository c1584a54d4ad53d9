//! Flat triangles, uniform by area.

use gonio_num::Real;

/// Barycentric coordinates (b₀, b₁, b₂) of a point of a triangle, uniform by area: b₀ + b₁ + b₂ = 1, each in [0, 1].
///
/// The square's diagonal is folded onto the triangle's side, which distorts less than the square-root map and needs no
/// root.
///
/// Source: Heitz 2019, "A Low-Distortion Map Between Triangle and Square".
#[inline(always)]
pub fn uniform_triangle<R: Real>(u: [R; 2]) -> [R; 3] {
    let half = R::lit(0.5);
    let upper = u[0].lt(u[1]);
    let b0 = R::select(upper, half * u[0], u[0] - half * u[1]);
    let b1 = R::select(upper, u[1] - half * u[0], half * u[1]);
    [b0, b1, (R::one() - b0 - b1).max(R::zero())]
}

/// Density of [`uniform_triangle`] at the barycentric coordinates `b`, by db₀ db₁: 2 inside, 0 outside. By area it is
/// 1/A for a triangle of area A.
#[inline(always)]
pub fn uniform_triangle_density<R: Real>(b: [R; 3]) -> R {
    let outside = b[0].min(b[1]).min(b[2]).lt(R::zero());
    R::select(outside, R::zero(), R::lit(2.0))
}

/// The u in [0, 1]² that [`uniform_triangle`] maps to `b`.
#[inline(always)]
pub fn uniform_triangle_inverse<R: Real>(b: [R; 3]) -> [R; 2] {
    let upper = b[0].lt(b[1]);
    let sum = b[0] + b[1];
    let two = R::lit(2.0);
    [
        R::select(upper, two * b[0], sum).saturate(),
        R::select(upper, sum, two * b[1]).saturate(),
    ]
}
