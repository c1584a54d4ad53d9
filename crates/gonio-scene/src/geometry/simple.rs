//! Ray queries of many rays at once, in scenes of so few shapes that no tree is worth its walk: each shape is tested with all rays.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::nearest::Nearest;
use super::placed::{Kind, Placed};
use super::shape::{Met, cross_flat, cross_sphere};
use super::{Geometry, Hit};
use gonio_num::dispatch::{Kernel, dispatch};
use gonio_num::{Affine3, Vec3, Vectors};

/// What of a scene is searched without the tree over its instances.
#[derive(Debug, Default)]
pub(super) struct Simple {
    /// Instances with which every ray is tested, no meshes, in their order.
    pub(super) shapes: Vec<u32>,
    /// Instances of meshes, with their trees, which every ray asks.
    pub(super) meshes: Vec<(u32, u32)>,
    /// Whether those, and the spheres that have a tree of their own, are the whole scene. Otherwise there are none of them.
    pub(super) few: bool,
}

/// The most work a ray may make, in units of a test of a plane. A walk through a tree takes the time of about forty.
const MOST_WORK: usize = 32;
/// A sphere's test, in those units.
const SPHERE: usize = 2;
/// The most meshes, each of which every ray asks.
const MOST_MESHES: usize = 2;
/// Spheres from which on they have a tree of their own, if they are too many to be tested one by one.
const MANY_SPHERES: usize = 8;

impl Simple {
    /// What is simple, and the spheres that want a tree.
    pub(super) fn of(placed: &[Placed]) -> (Self, Vec<u32>) {
        let (mut flat, mut spheres, mut meshes) = (Vec::new(), Vec::new(), Vec::new());
        for (i, placed) in placed.iter().enumerate() {
            let instance = i as u32;
            match placed.kind {
                // A mesh without triangles has no box, and no tree to ask.
                _ if placed.bounds.is_empty() => {}
                Kind::Mesh(tree) => meshes.push((instance, tree)),
                Kind::Sphere => spheres.push(instance),
                Kind::Rectangle | Kind::Disk => flat.push(instance),
            }
        }
        let apart = flat.len() + SPHERE * spheres.len() > MOST_WORK && spheres.len() > MANY_SPHERES;
        if !apart {
            flat.append(&mut spheres);
            flat.sort_unstable();
        }
        let is_sphere = |i: &&u32| placed[**i as usize].kind == Kind::Sphere;
        let work = flat.len() + (SPHERE - 1) * flat.iter().filter(is_sphere).count();
        let few = work <= MOST_WORK && meshes.len() <= MOST_MESHES;
        let simple = if few {
            Self {
                shapes: flat,
                meshes,
                few,
            }
        } else {
            Self::default()
        };
        (simple, spheres)
    }
}

/// Where a ray that meets nothing ends up.
const NOTHING: Hit = Hit {
    t: f32::INFINITY,
    instance: u32::MAX,
    primitive: 0,
    u: 0.0,
    v: 0.0,
};

impl Geometry {
    /// [`Geometry::intersect`] of many endless rays, the same to the bit. A ray that hits nothing gets a hit at infinity.
    ///
    /// - `rays`: origins and directions
    pub fn intersect_many(&self, rays: [&Vectors; 2], hits: &mut Vec<Hit>) {
        hits.clear();
        hits.resize(rays[0].len(), NOTHING);
        if !self.simple.shapes.is_empty() {
            dispatch(Nearby {
                geometry: self,
                rays: rays.map(Vectors::axes),
                hits,
            });
        }
        if !self.has_trees() {
            return;
        }
        let mut nearest: Vec<Nearest> = hits.iter().map(Nearest::of).collect();
        self.ask_many::<false>(rays, &mut nearest);
        for (hit, nearest) in hits.iter_mut().zip(&nearest) {
            *hit = nearest.hit().unwrap_or(NOTHING);
        }
    }

    /// [`Geometry::occluded`] of many rays, the same to the bit.
    ///
    /// - `rays`: origins and directions
    /// - `t_max`: where each ends
    ///
    /// # Panics
    /// If there are fewer ends than rays.
    pub fn occluded_many(&self, rays: [&Vectors; 2], t_max: &[f32], occluded: &mut Vec<bool>) {
        let count = rays[0].len();
        occluded.clear();
        occluded.resize(count, false);
        if !self.simple.shapes.is_empty() {
            dispatch(Anything {
                geometry: self,
                rays: rays.map(Vectors::axes),
                t_max: &t_max[..count],
                occluded,
            });
        }
        if !self.has_trees() {
            return;
        }
        // What is known to be hidden asks nothing: its ray ends where it begins.
        let end = |(t, hidden): (&f32, &bool)| Nearest::none(if *hidden { 0.0 } else { *t });
        let mut nearest: Vec<Nearest> = t_max.iter().zip(&*occluded).map(end).collect();
        self.ask_many::<true>(rays, &mut nearest);
        for (occluded, nearest) in occluded.iter_mut().zip(&nearest) {
            *occluded |= nearest.found();
        }
    }
}

// The loops below are over plain numbers, one ray after the other, with nothing in them but arithmetic and choices: a compiler turns them
// into vector instructions of any width by itself, better than it does with masks and numbers of two widths in lanes.

/// As many rays as fit a vector register, in double precision: they stay in registers while one shape after the other is tested. Behind the
/// last they have no direction, and meet nothing.
struct Block<const W: usize> {
    origin: [[f64; W]; 3],
    direction: [[f64; W]; 3],
}

impl<const W: usize> Block<W> {
    #[inline(always)]
    fn of(rays: &[[&[f32]; 3]; 2], at: usize, count: usize) -> Self {
        let mut columns = [[[0.0; W]; 3]; 2];
        for k in 0..2 {
            for axis in 0..3 {
                let source = &rays[k][axis][at..at + count];
                let mut whole = [0.0; W];
                if let Ok(all) = <[f32; W]>::try_from(source) {
                    whole = all;
                } else {
                    whole[..count].copy_from_slice(source);
                }
                for i in 0..W {
                    columns[k][axis][i] = f64::from(whole[i]);
                }
            }
        }
        let [origin, direction] = columns;
        Self { origin, direction }
    }

    #[inline(always)]
    fn ray(&self, i: usize) -> [Vec3<f64>; 2] {
        let [ox, oy, oz] = &self.origin;
        let [dx, dy, dz] = &self.direction;
        [
            Vec3::new(ox[i], oy[i], oz[i]),
            Vec3::new(dx[i], dy[i], dz[i]),
        ]
    }
}

/// A kind of shape, known when the loop over the rays is compiled.
trait Crossed {
    /// - `m`: from the ray's coordinates to the shape's
    fn cross(m: &Affine3<f64>, ray: [Vec3<f64>; 2]) -> Met<f64>;
}

struct Sphere;
struct Rectangle;
struct Disk;

impl Crossed for Sphere {
    #[inline(always)]
    fn cross(m: &Affine3<f64>, [o, d]: [Vec3<f64>; 2]) -> Met<f64> {
        cross_sphere(m.transform_point(o), m.transform_vector(d))
    }
}

impl Crossed for Rectangle {
    #[inline(always)]
    fn cross(m: &Affine3<f64>, [o, d]: [Vec3<f64>; 2]) -> Met<f64> {
        cross_flat(false, m, o, d)
    }
}

impl Crossed for Disk {
    #[inline(always)]
    fn cross(m: &Affine3<f64>, [o, d]: [Vec3<f64>; 2]) -> Met<f64> {
        cross_flat(true, m, o, d)
    }
}

struct Nearby<'a> {
    geometry: &'a Geometry,
    rays: [[&'a [f32]; 3]; 2],
    hits: &'a mut [Hit],
}

/// The nearest hits of a block.
#[derive(Clone, Copy)]
struct Columns<const W: usize> {
    t: [f32; W],
    u: [f32; W],
    v: [f32; W],
    instance: [u32; W],
}

impl<const W: usize> Columns<W> {
    /// Of shapes at the same t the first one stays.
    #[inline(always)]
    fn test<S: Crossed>(self, block: &Block<W>, placed: &Placed, instance: u32) -> Self {
        // Written as a whole: what is written in part goes through memory.
        let (m, mut next) = (placed.to_object, self);
        for i in 0..W {
            let met = S::cross(&m, block.ray(i));
            let nearer = met.found & ((met.t as f32) < self.t[i]);
            next.t[i] = if nearer { met.t as f32 } else { self.t[i] };
            next.u[i] = if nearer { met.x as f32 } else { self.u[i] };
            next.v[i] = if nearer { met.y as f32 } else { self.v[i] };
            next.instance[i] = if nearer { instance } else { self.instance[i] };
        }
        next
    }
}

impl Nearby<'_> {
    #[inline(always)]
    fn by<const W: usize>(self) {
        let geometry = self.geometry;
        for (k, hits) in self.hits.chunks_mut(W).enumerate() {
            let block = Block::<W>::of(&self.rays, k * W, hits.len());
            let mut nearest = Columns {
                t: [NOTHING.t; W],
                u: [NOTHING.u; W],
                v: [NOTHING.v; W],
                instance: [NOTHING.instance; W],
            };
            for &instance in &geometry.simple.shapes {
                let placed = &geometry.placed[instance as usize];
                nearest = match placed.kind {
                    Kind::Rectangle => nearest.test::<Rectangle>(&block, placed, instance),
                    Kind::Disk => nearest.test::<Disk>(&block, placed, instance),
                    Kind::Sphere => nearest.test::<Sphere>(&block, placed, instance),
                    Kind::Mesh(_) => nearest,
                }
            }
            for (i, hit) in hits.iter_mut().enumerate() {
                *hit = Hit {
                    t: nearest.t[i],
                    instance: nearest.instance[i],
                    primitive: 0,
                    u: nearest.u[i],
                    v: nearest.v[i],
                };
            }
        }
    }
}

impl Kernel for Nearby<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const L: usize>(self) {
        // Half as many numbers of double precision fit a register.
        if L == 16 {
            self.by::<8>();
        } else {
            self.by::<4>();
        }
    }
}

struct Anything<'a> {
    geometry: &'a Geometry,
    rays: [[&'a [f32]; 3]; 2],
    t_max: &'a [f32],
    occluded: &'a mut [bool],
}

/// Whether the rays of a block, which end at `t_max`, meet a shape; as numbers of the width of t, which suits vector instructions.
#[inline(always)]
fn test_any<S: Crossed, const W: usize>(
    block: &Block<W>,
    placed: &Placed,
    t_max: &[f32; W],
    met: &mut [u32; W],
) {
    let m = placed.to_object;
    for i in 0..W {
        let crossed = S::cross(&m, block.ray(i));
        met[i] |= u32::from(crossed.found & ((crossed.t as f32) < t_max[i]));
    }
}

impl Anything<'_> {
    #[inline(always)]
    fn by<const W: usize>(self) {
        let geometry = self.geometry;
        for (k, occluded) in self.occluded.chunks_mut(W).enumerate() {
            let (at, count) = (k * W, occluded.len());
            let block = Block::<W>::of(&self.rays, at, count);
            let mut t_max = [0.0; W];
            t_max[..count].copy_from_slice(&self.t_max[at..at + count]);
            let mut met = [0; W];
            for &instance in &geometry.simple.shapes {
                let placed = &geometry.placed[instance as usize];
                match placed.kind {
                    Kind::Rectangle => {
                        test_any::<Rectangle, W>(&block, placed, &t_max, &mut met);
                    }
                    Kind::Disk => test_any::<Disk, W>(&block, placed, &t_max, &mut met),
                    Kind::Sphere => test_any::<Sphere, W>(&block, placed, &t_max, &mut met),
                    Kind::Mesh(_) => {}
                }
            }
            for (occluded, met) in occluded.iter_mut().zip(&met) {
                *occluded = *met != 0;
            }
        }
    }
}

impl Kernel for Anything<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const L: usize>(self) {
        if L == 16 {
            self.by::<8>();
        } else {
            self.by::<4>();
        }
    }
}
