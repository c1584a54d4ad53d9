//! The same source over every number type: lanes give the bits of `f32`, dual numbers the Jacobian.

use super::*;
use crate::warp::*;
use gonio_num::dual::Dual;
use gonio_num::lanes::Lanes;
use gonio_num::{Frame, Real};

const TRIANGLE: [Vec3<f64>; 3] = [
    Vec3::new(1.0, 0.0, 0.0),
    Vec3::new(0.0, 0.6, 0.8),
    Vec3::new(-0.48, 0.6, 0.64),
];

fn triangle<R: Real>() -> [Vec3<R>; 3] {
    let [a, b, c] = TRIANGLE;
    [Vec3::lit(a), Vec3::lit(b), Vec3::lit(c)]
}

const CORNER: Vec3<f64> = Vec3::new(0.4, -0.2, 0.9);
const NORMAL: Vec3<f64> = Vec3::new(0.36, 0.48, 0.8);

fn rectangle<R: Real>() -> SphericalRectangle<R> {
    let frame = Frame::from_normal(NORMAL);
    let (ex, ey) = (Vec3::lit(frame.s), Vec3::lit(frame.t * 1.7));
    SphericalRectangle::new(Vec3::lit(CORNER), ex, ey, Vec3::zero())
}

fn rectangle_map<R: Real>(u: [R; 2]) -> Vec3<R> {
    rectangle().sample(u).normalize()
}

fn rectangle_density<R: Real>(_w: Vec3<R>) -> R {
    rectangle().density()
}

fn rectangle_inverse<R: Real>(w: Vec3<R>) -> [R; 2] {
    let distance = R::lit(CORNER.dot(NORMAL)) / w.dot(Vec3::lit(NORMAL));
    rectangle().inverse(w * distance)
}

/// Runs `$check!(name, map, density of the direction, inverse of the direction)` for each warp to directions. The three
/// are expressions in `$u` and `$w`, which the macro types.
macro_rules! each_warp {
    ($check:ident, $u:ident, $w:ident) => {
        $check!(
            "hemisphere",
            $u,
            $w,
            uniform_hemisphere($u),
            uniform_hemisphere_density($w),
            uniform_hemisphere_inverse($w)
        );
        $check!(
            "sphere",
            $u,
            $w,
            uniform_sphere($u),
            uniform_sphere_density($w),
            uniform_sphere_inverse($w)
        );
        $check!(
            "cosine",
            $u,
            $w,
            cosine_hemisphere($u),
            cosine_hemisphere_density($w),
            cosine_hemisphere_inverse($w)
        );
        $check!(
            "cone",
            $u,
            $w,
            uniform_cone($u, Real::lit(0.3)),
            uniform_cone_density($w, Real::lit(0.3)),
            uniform_cone_inverse($w, Real::lit(0.3))
        );
        $check!(
            "power",
            $u,
            $w,
            cosine_power_hemisphere($u, Real::lit(12.5)),
            cosine_power_hemisphere_density($w, Real::lit(12.5)),
            cosine_power_hemisphere_inverse($w, Real::lit(12.5))
        );
        $check!(
            "triangle",
            $u,
            $w,
            spherical_triangle($u, triangle()),
            spherical_triangle_density($w, triangle()),
            spherical_triangle_inverse($w, triangle())
        );
        $check!(
            "rectangle",
            $u,
            $w,
            rectangle_map($u),
            rectangle_density($w),
            rectangle_inverse($w)
        );
    };
}

macro_rules! lanes_agree {
    ($name:literal, $u:ident, $w:ident, $map:expr, $density:expr, $inverse:expr) => {{
        let all: Vec<[f32; 2]> = squares($name, 256)
            .map(|u| u.map(|x| x as f32))
            .chain([[0.0, 0.0], [1.0, 1.0], [0.5, 0.5], [0.0, 1.0]])
            .chain([[0.25, 0.0], [1.0, 0.0], [0.5, 0.0], [0.75, 1.0]])
            .collect();
        for chunk in all.chunks_exact(8) {
            let (direction, density, inverse) = {
                let $u: [Lanes<8>; 2] = [0, 1].map(|k| Lanes(std::array::from_fn(|i| chunk[i][k])));
                let $w = $map;
                ($w, $density, $inverse)
            };
            for (i, &$u) in chunk.iter().enumerate() {
                let $w = $map;
                let one: [f32; 6] = {
                    let (d, [a, b]) = ($density, $inverse);
                    [$w.x, $w.y, $w.z, d, a, b]
                };
                let lane = direction.extract(i);
                let inverse = inverse.map(|x| x.extract(i));
                let batch = [
                    lane.x,
                    lane.y,
                    lane.z,
                    density.extract(i),
                    inverse[0],
                    inverse[1],
                ];
                assert_eq!(
                    one.map(f32::to_bits),
                    batch.map(f32::to_bits),
                    "{} at {:?}",
                    $name,
                    $u
                );
            }
        }
    }};
}

#[test]
fn lanes_give_the_same_bits() {
    each_warp!(lanes_agree, u, w);
}

macro_rules! jacobian_is_inverse_density {
    ($name:literal, $u:ident, $w:ident, $map:expr, $density:expr, $inverse:expr) => {{
        for point in squares($name, 300) {
            let stretched = {
                let $u: [Dual<f64, 2>; 2] = [0, 1].map(|k| Dual::variable(point[k], k));
                let $w = $map;
                let along =
                    |k: usize| Vec3::new($w.x.partials[k], $w.y.partials[k], $w.z.partials[k]);
                along(0).cross(along(1)).length()
            };
            let $u: [f64; 2] = point;
            let $w = $map;
            let density: f64 = $density;
            // Rounding, magnified near the poles and vertices where a derivative is large.
            let product = stretched * density;
            assert!(
                (product - 1.0).abs() < 1e-9,
                "{} at {point:?}: {product}",
                $name
            );
        }
    }};
}

#[test]
fn derivatives_give_the_inverse_density() {
    each_warp!(jacobian_is_inverse_density, u, w);
}
