//! The triangle test: watertight, the same bits on every processor.
//!
//! In two steps. The first takes eight triangles at once in single precision and rejects: corners are moved and sheared so
//! that the ray is the +z axis, and the signs of the three edge functions tell whether it passes inside (Woop, Benthin and
//! Wald 2013, "Watertight Ray/Triangle Intersection"). Two triangles that share an edge compute the very same two products
//! for it, so they never disagree about the side: no ray slips between them. No product is fused with a sum, so these
//! signs are the same for every instruction set.
//!
//! The second step takes the few that pass, one by one: where an edge function is exactly 0 its sign comes from double
//! precision; t and the barycentric weights are computed in double precision, so t is right to its last bit and has the
//! right sign even for a ray that starts a rounding error above a huge triangle.

use gonio_num::Vec3;

/// Triangles a block.
pub(crate) const LANES: usize = 8;
/// The id of a lane without a triangle.
pub(crate) const VACANT: u32 = u32::MAX;

/// Eight triangles side by side. 320 bytes, five cache lines.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(crate) struct TriangleBlock {
    /// `corners[corner][axis][lane]`; NaN in a vacant lane, which no test then passes.
    pub(crate) corners: [[[f32; LANES]; 3]; 3],
    /// Index of the triangle in its mesh.
    pub(crate) id: [u32; LANES],
}

impl TriangleBlock {
    pub(crate) fn vacant() -> Self {
        Self {
            corners: [[[f32::NAN; LANES]; 3]; 3],
            id: [VACANT; LANES],
        }
    }

    pub(crate) fn set(&mut self, lane: usize, corners: [Vec3<f32>; 3], id: u32) {
        for (k, corner) in corners.iter().enumerate() {
            for axis in 0..3 {
                self.corners[k][axis][lane] = corner[axis];
            }
        }
        self.id[lane] = id;
    }
}

/// A ray, prepared for triangles.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TriangleRay {
    /// The axes in the order x, y, z of the sheared space; the ray is longest along the last.
    pub(crate) axes: [usize; 3],
    /// The origin in that order.
    pub(crate) origin: [f32; 3],
    /// x and y a step along z, and t a step along z.
    pub(crate) shear: [f32; 3],
    /// The same in double precision.
    exact: [f64; 3],
}

/// A triangle that the ray meets.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crossing {
    pub(crate) t: f32,
    pub(crate) u: f32,
    pub(crate) v: f32,
}

impl TriangleRay {
    /// `direction` must be finite and not zero.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3<f32>, direction: Vec3<f32>) -> Self {
        let (o, d) = (origin.to_array(), direction.to_array());
        let (ax, ay, az) = (d[0].abs(), d[1].abs(), d[2].abs());
        let z = if az >= ax && az >= ay {
            2
        } else if ay >= ax {
            1
        } else {
            0
        };
        // The cyclic order keeps the orientation for a positive z and turns it for a negative one; both signs of the edge
        // functions are accepted, so it needn't be turned back.
        let x = if z == 2 { 0 } else { z + 1 };
        let y = if x == 2 { 0 } else { x + 1 };
        let exact_inverse = 1.0 / f64::from(d[z]);
        let exact = [
            f64::from(d[x]) * exact_inverse,
            f64::from(d[y]) * exact_inverse,
            exact_inverse,
        ];
        Self {
            axes: [x, y, z],
            origin: [o[x], o[y], o[z]],
            shear: [exact[0] as f32, exact[1] as f32, exact[2] as f32],
            exact,
        }
    }

    /// The second step, for a triangle that passed the first. `None` where it is missed after all: beside an edge that
    /// single precision couldn't tell, edge-on, or with t outside (0, ∞).
    #[inline(always)]
    pub(crate) fn cross(&self, block: &TriangleBlock, lane: usize) -> Option<Crossing> {
        let mut x = [0.0f32; 3];
        let mut y = [0.0f32; 3];
        let mut exact_x = [0.0f64; 3];
        let mut exact_y = [0.0f64; 3];
        let mut exact_z = [0.0f64; 3];
        for k in 0..3 {
            let p = [
                block.corners[k][self.axes[0]][lane],
                block.corners[k][self.axes[1]][lane],
                block.corners[k][self.axes[2]][lane],
            ];
            let z = p[2] - self.origin[2];
            x[k] = (p[0] - self.origin[0]) - self.shear[0] * z;
            y[k] = (p[1] - self.origin[1]) - self.shear[1] * z;
            let z = f64::from(p[2]) - f64::from(self.origin[2]);
            exact_x[k] = (f64::from(p[0]) - f64::from(self.origin[0])) - self.exact[0] * z;
            exact_y[k] = (f64::from(p[1]) - f64::from(self.origin[1])) - self.exact[1] * z;
            exact_z[k] = z;
        }
        // Products of two single-precision numbers are exact in double precision, so these signs are right where single
        // precision gave 0, and agree with single precision elsewhere up to rounding.
        let e = [
            x[2] * y[1] - y[2] * x[1],
            x[0] * y[2] - y[0] * x[2],
            x[1] * y[0] - y[1] * x[0],
        ];
        let mut edges = [f64::from(e[0]), f64::from(e[1]), f64::from(e[2])];
        if e[0] == 0.0 || e[1] == 0.0 || e[2] == 0.0 {
            let (x, y) = (
                [f64::from(x[0]), f64::from(x[1]), f64::from(x[2])],
                [f64::from(y[0]), f64::from(y[1]), f64::from(y[2])],
            );
            edges = [
                x[2] * y[1] - y[2] * x[1],
                x[0] * y[2] - y[0] * x[2],
                x[1] * y[0] - y[1] * x[0],
            ];
        }
        let negative = edges[0] < 0.0 || edges[1] < 0.0 || edges[2] < 0.0;
        let positive = edges[0] > 0.0 || edges[1] > 0.0 || edges[2] > 0.0;
        if negative == positive {
            return None;
        }
        let sign = if negative { -1.0 } else { 1.0 };
        let (x, y) = (exact_x, exact_y);
        let mut weights = [
            sign * (x[2] * y[1] - y[2] * x[1]),
            sign * (x[0] * y[2] - y[0] * x[2]),
            sign * (x[1] * y[0] - y[1] * x[0]),
        ];
        for w in &mut weights {
            *w = if *w > 0.0 { *w } else { 0.0 };
        }
        let mut sum = weights[0] + weights[1] + weights[2];
        if sum <= 0.0 {
            // Very nearly edge-on: the signs of single precision decided, so its weights do too.
            weights = [sign * edges[0], sign * edges[1], sign * edges[2]];
            sum = weights[0] + weights[1] + weights[2];
        }
        let z = weights[0] * exact_z[0] + weights[1] * exact_z[1] + weights[2] * exact_z[2];
        let inverse = 1.0 / sum;
        let t = (z * inverse * self.exact[2]) as f32;
        // False for NaN.
        if t > 0.0 && t < f32::INFINITY {
            Some(Crossing {
                t,
                u: (weights[1] * inverse) as f32,
                v: (weights[2] * inverse) as f32,
            })
        } else {
            None
        }
    }
}
