//! Coherent rays through the tree of a mesh, up to 64 together.
//!
//! Neighbouring rays of a camera visit the same nodes near the root. There one test of a node asks which of its eight children the *beam* around all of
//! the rays may meet, and one test of a child's box asks eight rays at a time which of them do; where few are left, each goes on alone
//! (Wald et al. 2001, "Interactive Rendering with Coherent Ray Tracing"; Reshetov, Soupikov and Hurley 2005, "Multi-Level Ray Tracing Algorithm").
//! A beam's test may let boxes pass that no ray meets, never the reverse; so the answers are those of each ray alone.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::kernel::{Kernel, max, min};
use super::mesh_tree::{MeshTree, Triangles};
use super::nearest::Nearest;
use super::placed::Placed;
use super::tree::{LEAF, Node, WIDTH, leaf_items};
use super::triangle::TriangleRay;
use super::walk::{BoxRay, Visitor, Walk};
use super::{Aabb, Ray};
use gonio_num::{Vec3, Vectors};

/// Rays in a beam: one bit each of a word.
pub(super) const RAYS: usize = 64;
/// Rays that are tested with a box at once.
const ROW: usize = 8;
/// So many rays or fewer go on alone.
const FEW: u32 = 4;

/// What the rays of a beam are asked about.
pub(super) struct Asked<'a> {
    pub(super) tree: &'a MeshTree,
    pub(super) instance: u32,
    pub(super) placed: &'a Placed,
    /// Around the mesh in the rays' coordinates, or around more.
    pub(super) bounds: &'a Aabb,
}

/// A child that some rays may meet.
#[derive(Clone, Copy)]
struct Entry {
    /// Where the beam enters its box, along the beam's axis.
    near: f32,
    /// The node above, and the child's place in it.
    node: u32,
    slot: u32,
    /// The rays that met the node's box.
    rays: u64,
}

/// Rays as boxes see them, those of a row side by side.
#[repr(C, align(64))]
struct Columns {
    origin: [[f32; RAYS]; 3],
    direction: [[f32; RAYS]; 3],
    inverse: [[f32; RAYS]; 3],
    /// The origin as lower planes see it: moved upwards, so that they come earlier.
    low: [[f32; RAYS]; 3],
    /// The origin as upper planes see it.
    high: [[f32; RAYS]; 3],
    /// Where each ends; below 0 if it asks nothing any more.
    t: [f32; RAYS],
}

impl Columns {
    fn new() -> Self {
        Self {
            origin: [[0.0; RAYS]; 3],
            direction: [[0.0; RAYS]; 3],
            inverse: [[0.0; RAYS]; 3],
            low: [[0.0; RAYS]; 3],
            high: [[0.0; RAYS]; 3],
            t: [-1.0; RAYS],
        }
    }

    /// Fills in what follows from origins and directions: the numbers of [`BoxRay::new`].
    #[inline(always)]
    fn prepare(&mut self, bounds: &Aabb) {
        let (least, most) = (bounds.min.to_array(), bounds.max.to_array());
        let mut reach = [0.0f32; RAYS];
        for axis in 0..3 {
            for i in 0..RAYS {
                let o = self.origin[axis][i];
                let r = max((least[axis] - o).abs(), (most[axis] - o).abs());
                reach[i] = max(r, reach[i]);
            }
        }
        for axis in 0..3 {
            for i in 0..RAYS {
                let o = self.origin[axis][i];
                let pad = reach[i] * (1.0 / (1 << 20) as f32) + o.abs() * f32::EPSILON;
                self.inverse[axis][i] = 1.0 / self.direction[axis][i];
                self.low[axis][i] = o + pad;
                self.high[axis][i] = o - pad;
            }
        }
    }

    /// The ray as triangles see it.
    #[inline(always)]
    fn for_triangles(&self, i: usize) -> TriangleRay {
        let at = |c: &[[f32; RAYS]; 3]| Vec3::new(c[0][i], c[1][i], c[2][i]);
        TriangleRay::new(at(&self.origin), at(&self.direction))
    }

    /// The ray as boxes see it: what [`BoxRay::new`] makes of it, to the bit.
    #[inline(always)]
    fn for_boxes(&self, i: usize) -> BoxRay {
        let mut ray = BoxRay {
            inverse: [0.0; 3],
            near: [0.0; 3],
            far: [0.0; 3],
            near_row: [0; 3],
        };
        for axis in 0..3 {
            let (low, high) = (self.low[axis][i], self.high[axis][i]);
            let inverse = self.inverse[axis][i];
            let backwards = inverse < 0.0;
            ray.inverse[axis] = inverse;
            ray.near[axis] = if backwards { high } else { low };
            ray.far[axis] = if backwards { low } else { high };
            ray.near_row[axis] = 2 * axis + usize::from(backwards);
        }
        ray
    }

    /// Which of `rays` meet a child's box.
    #[inline(always)]
    fn meeting(&self, node: &Node, slot: usize, rays: u64) -> u64 {
        let planes: [f32; 6] = std::array::from_fn(|k| node.planes[k][slot]);
        let mut met = 0;
        for row in 0..RAYS / ROW {
            let of_row = rays >> (ROW * row) & 0xff;
            if of_row == 0 {
                continue;
            }
            let first = ROW * row;
            let mut enter = [0.0f32; ROW];
            let mut leave = [0.0f32; ROW];
            leave.copy_from_slice(&self.t[first..first + ROW]);
            for axis in 0..3 {
                let inverse = &self.inverse[axis][first..first + ROW];
                let low = &self.low[axis][first..first + ROW];
                let high = &self.high[axis][first..first + ROW];
                for i in 0..ROW {
                    let a = (planes[2 * axis] - low[i]) * inverse[i];
                    let b = (planes[2 * axis + 1] - high[i]) * inverse[i];
                    enter[i] = max(min(a, b), enter[i]);
                    leave[i] = min(max(a, b), leave[i]);
                }
            }
            let mut mask = 0u64;
            for i in 0..ROW {
                mask |= u64::from(enter[i] <= leave[i]) << i;
            }
            met |= (mask & of_row) << first;
        }
        met
    }
}

/// Around rays that go the same way along one axis, along which each is longest: at distance z along it from their origins the rays lie, along each of the
/// other two axes, within \[low + z · least slope, high + z · largest slope\].
struct Beam {
    /// The axes, the long one last.
    axes: [usize; 3],
    backwards: bool,
    /// Bounds of the origins, moved apart as a [`BoxRay`] moves them.
    low: [f32; 3],
    high: [f32; 3],
    slopes: [[f32; 2]; 2],
}

impl Beam {
    /// The beam around the first of `rays` and those like it, and which they are.
    #[inline(always)]
    fn around(columns: &Columns, rays: u64) -> (Self, u64) {
        let first = rays.trailing_zeros() as usize % RAYS;
        let d: [f32; 3] = std::array::from_fn(|axis| columns.direction[axis][first]);
        let (ax, ay, az) = (d[0].abs(), d[1].abs(), d[2].abs());
        let z = if az >= ax && az >= ay {
            2
        } else if ay >= ax {
            1
        } else {
            0
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let axes = [x, y, z];
        let sign = if d[z] < 0.0 { -1.0 } else { 1.0 };
        let mut like = 0;
        for i in 0..RAYS {
            let [dx, dy, dz] = axes.map(|axis| columns.direction[axis][i]);
            let dz = dz * sign;
            // A component of nearly 0 has no finite inverse.
            let finite = axes
                .iter()
                .all(|&axis| columns.inverse[axis][i].abs() < f32::INFINITY);
            let same = finite && dx.abs() <= dz && dy.abs() <= dz;
            like |= u64::from(same) << i;
        }
        like &= rays;
        let mut beam = Self {
            axes,
            backwards: sign < 0.0,
            low: [f32::INFINITY; 3],
            high: [f32::NEG_INFINITY; 3],
            slopes: [[f32::INFINITY, f32::NEG_INFINITY]; 2],
        };
        for i in 0..RAYS {
            if like >> i & 1 == 0 {
                continue;
            }
            for (k, &axis) in axes.iter().enumerate() {
                beam.low[k] = min(columns.high[axis][i], beam.low[k]);
                beam.high[k] = max(columns.low[axis][i], beam.high[k]);
            }
            let along = columns.inverse[z][i].abs();
            for k in 0..2 {
                let slope = columns.direction[axes[k]][i] * along;
                beam.slopes[k] = [min(slope, beam.slopes[k][0]), max(slope, beam.slopes[k][1])];
            }
        }
        (beam, like)
    }

    /// A bit for each child whose box the beam may meet, and where it enters each, along its axis.
    ///
    /// Its roundings, in units of 2⁻²⁴ of the distance to the corners: two in a slope, of which no magnitude is above 1; one each in z, in
    /// the product, and in the difference of plane and origin. With the seven of the triangle test that is less than the 16 by which the origins
    /// were moved apart.
    #[inline(always)]
    fn boxes(&self, node: &Node) -> (u32, [f32; WIDTH]) {
        let [x, y, z] = self.axes;
        let mut begin = [0.0f32; WIDTH];
        let mut end = [0.0f32; WIDTH];
        if self.backwards {
            for i in 0..WIDTH {
                begin[i] = max(self.low[2] - node.planes[2 * z + 1][i], 0.0);
                end[i] = self.high[2] - node.planes[2 * z][i];
            }
        } else {
            for i in 0..WIDTH {
                begin[i] = max(node.planes[2 * z][i] - self.high[2], 0.0);
                end[i] = node.planes[2 * z + 1][i] - self.low[2];
            }
        }
        let mut slack = [0.0f32; WIDTH];
        slack.copy_from_slice(&end);
        for (k, axis) in [x, y].into_iter().enumerate() {
            let [least, most] = self.slopes[k];
            for i in 0..WIDTH {
                let below = node.planes[2 * axis + 1][i] - self.low[k];
                let above = node.planes[2 * axis][i] - self.high[k];
                let a = below - min(least * begin[i], least * end[i]);
                let b = max(most * begin[i], most * end[i]) - above;
                slack[i] = min(min(a, b), slack[i]);
            }
        }
        let mut mask = 0;
        for i in 0..WIDTH {
            mask |= u32::from(slack[i] >= 0.0) << i;
        }
        (mask & node.valid, begin)
    }
}

/// Searches a mesh with rays that go nearly the same way, each with the best hit so far.
#[inline(always)]
pub(super) fn search<K: Kernel, const ANY: bool>(
    kernel: K,
    asked: &Asked<'_>,
    rays: [&Vectors; 2],
    nearest: &mut [Nearest],
) {
    if asked.tree.tree.nodes.is_empty() {
        return;
    }
    let mut columns = Columns::new();
    let mut stack = Vec::with_capacity(128);
    let nowhere = TriangleRay::new(Vec3::zero(), Vec3::new(0.0, 0.0, 1.0));
    let mut exact = [nowhere; RAYS];
    for (k, nearest) in nearest.chunks_mut(RAYS).enumerate() {
        let all = gather::<ANY>(&mut columns, asked, rays, k * RAYS, nearest);
        if all != 0 {
            columns.prepare(asked.bounds);
            descend::<K, ANY>(
                kernel,
                asked,
                &mut columns,
                &mut exact,
                &mut stack,
                nearest,
                all,
            );
        }
    }
}

/// Puts the rays from `at` on in columns, in the mesh's coordinates; says which ask anything.
#[inline(always)]
fn gather<const ANY: bool>(
    columns: &mut Columns,
    asked: &Asked<'_>,
    rays: [&Vectors; 2],
    at: usize,
    nearest: &[Nearest],
) -> u64 {
    let mut all = 0;
    for (i, nearest) in nearest.iter().enumerate() {
        let mut ray = Ray {
            origin: rays[0].get(at + i),
            direction: rays[1].get(at + i),
            t_max: nearest.t,
        };
        let mut asks = ray.is_valid() && !(ANY && nearest.found());
        if asks && !asked.placed.identity {
            ray = asked.placed.ray_to_mesh(&ray);
            // Overflow or underflow on the way there: nothing can be seen.
            asks = ray.is_valid();
        }
        all |= u64::from(asks) << i;
        let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
        for axis in 0..3 {
            columns.origin[axis][i] = o[axis];
            columns.direction[axis][i] = d[axis];
        }
        columns.t[i] = nearest.t;
    }
    all
}

/// The walk of the rays `all`.
#[inline(always)]
fn descend<K: Kernel, const ANY: bool>(
    kernel: K,
    asked: &Asked<'_>,
    columns: &mut Columns,
    exact: &mut [TriangleRay; RAYS],
    stack: &mut Vec<Entry>,
    nearest: &mut [Nearest],
    all: u64,
) {
    let tree = asked.tree;
    let (beam, together) = Beam::around(columns, all);
    let mut ready = 0u64;
    let mut walk = Walk::new();
    stack.clear();
    if together != 0 {
        expand(kernel, tree, &beam, 0, together, stack);
    }
    // Those that don't go with the beam begin at the root.
    let (mut alone, mut from) = (all & !together, 0);
    loop {
        while alone != 0 {
            let i = alone.trailing_zeros() as usize % RAYS;
            alone &= alone - 1;
            if ready >> i & 1 == 0 {
                exact[i] = columns.for_triangles(i);
                ready |= 1 << i;
            }
            let of_ray = &mut nearest[i];
            let mut visitor =
                Triangles::<K, ANY>::with(kernel, tree, exact[i], asked.instance, of_ray);
            if from & LEAF != 0 {
                let (first, count) = leaf_items(from);
                visitor.leaf(first, count);
            } else {
                let prepared = kernel.prepare_boxes(&columns.for_boxes(i));
                walk.start_at(from);
                while !walk.step(kernel, &tree.tree, &prepared, &mut visitor) {}
            }
            columns.t[i] = if ANY && nearest[i].found() {
                -1.0
            } else {
                nearest[i].t
            };
        }
        let Some(entry) = stack.pop() else {
            return;
        };
        let node = &tree.tree.nodes[entry.node as usize];
        let slot = entry.slot as usize % WIDTH;
        let met = columns.meeting(node, slot, entry.rays);
        let child = node.children[slot];
        if child & LEAF != 0 || met.count_ones() <= FEW {
            (alone, from) = (met, child);
        } else {
            expand(kernel, tree, &beam, child, met, stack);
        }
    }
}

/// Puts the children of a node that the beam may meet on the stack, the nearest last.
#[inline(always)]
fn expand<K: Kernel>(
    kernel: K,
    tree: &MeshTree,
    beam: &Beam,
    node: u32,
    rays: u64,
    stack: &mut Vec<Entry>,
) {
    let of = &tree.tree.nodes[node as usize];
    let (mut hits, begin) = beam.boxes(of);
    let first = stack.len();
    while hits != 0 {
        let slot = hits.trailing_zeros();
        hits &= hits - 1;
        let child = of.children[slot as usize % WIDTH];
        if child & LEAF == 0 {
            kernel.prefetch(&tree.tree.nodes[child as usize]);
        } else if let Some(block) = tree.blocks.get(leaf_items(child).0 as usize) {
            kernel.prefetch(block);
        }
        let entry = Entry {
            near: begin[slot as usize % WIDTH],
            node,
            slot,
            rays,
        };
        let mut k = stack.len();
        stack.push(entry);
        while k > first && stack[k - 1].near < entry.near {
            stack[k] = stack[k - 1];
            k -= 1;
        }
        stack[k] = entry;
    }
}
