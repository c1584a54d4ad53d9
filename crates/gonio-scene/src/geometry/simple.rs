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
        let count = rays[0].len();
        hits.clear();
        let mut column = Columns::of(count);
        if !self.simple.shapes.is_empty() {
            dispatch(Nearby {
                geometry: self,
                rays: [rays[0].axes(), rays[1].axes()],
                nearest: &mut column,
            });
        }
        let mut nearest: Vec<Nearest> = (0..count).map(|i| column.get(i)).collect();
        self.ask_many::<false>(rays, &mut nearest);
        hits.extend(nearest.iter().map(|n| n.hit().unwrap_or(NOTHING)));
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
                rays: [rays[0].axes(), rays[1].axes()],
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

/// The nearest hits, as a structure of arrays.
struct Columns {
    t: Vec<f32>,
    u: Vec<f32>,
    v: Vec<f32>,
    instance: Vec<u32>,
}

impl Columns {
    fn of(count: usize) -> Self {
        Self {
            t: vec![f32::INFINITY; count],
            u: vec![0.0; count],
            v: vec![0.0; count],
            instance: vec![u32::MAX; count],
        }
    }

    #[inline(always)]
    fn get(&self, i: usize) -> Nearest {
        let mut nearest = Nearest::none(f32::INFINITY);
        nearest.offer(self.t[i], self.instance[i], 0, self.u[i], self.v[i]);
        nearest
    }
}

// The loops below are over plain numbers, one ray after the other, with nothing in them but arithmetic and choices: a compiler turns them
// into vector instructions of any width by itself, better than it does with masks and numbers of two widths in lanes.

/// A ray in the coordinates of a shape.
#[inline(always)]
fn to_object(m: &Affine3<f64>, rays: &[[&[f32]; 3]; 2], i: usize) -> [Vec3<f64>; 2] {
    let [[ox, oy, oz], [dx, dy, dz]] = rays;
    let o = Vec3::new(ox[i], oy[i], oz[i]).to_f64();
    let d = Vec3::new(dx[i], dy[i], dz[i]).to_f64();
    [m.transform_point(o), m.transform_vector(d)]
}

/// The rays, each axis as a slice of `count`, which a compiler then knows.
#[inline(always)]
fn cut(rays: [[&[f32]; 3]; 2], count: usize) -> [[&[f32]; 3]; 2] {
    let [[ox, oy, oz], [dx, dy, dz]] = rays;
    [
        [&ox[..count], &oy[..count], &oz[..count]],
        [&dx[..count], &dy[..count], &dz[..count]],
    ]
}

/// A kind of shape, known when the loop over the rays is compiled.
trait Crossed {
    fn cross(o: Vec3<f64>, d: Vec3<f64>) -> Met<f64>;
}

struct Sphere;
struct Rectangle;
struct Disk;

impl Crossed for Sphere {
    #[inline(always)]
    fn cross(o: Vec3<f64>, d: Vec3<f64>) -> Met<f64> {
        cross_sphere(o, d)
    }
}

impl Crossed for Rectangle {
    #[inline(always)]
    fn cross(o: Vec3<f64>, d: Vec3<f64>) -> Met<f64> {
        cross_flat(false, o, d)
    }
}

impl Crossed for Disk {
    #[inline(always)]
    fn cross(o: Vec3<f64>, d: Vec3<f64>) -> Met<f64> {
        cross_flat(true, o, d)
    }
}

struct Nearby<'a> {
    geometry: &'a Geometry,
    rays: [[&'a [f32]; 3]; 2],
    nearest: &'a mut Columns,
}

impl Nearby<'_> {
    /// Of shapes at the same t the first one stays.
    #[inline(always)]
    fn test<S: Crossed>(&mut self, placed: &Placed, instance: u32) {
        let count = self.nearest.t.len();
        let m = placed.to_object;
        let rays = cut(self.rays, count);
        let (t, u) = (&mut self.nearest.t[..count], &mut self.nearest.u[..count]);
        let (v, which) = (
            &mut self.nearest.v[..count],
            &mut self.nearest.instance[..count],
        );
        for i in 0..count {
            let [o, d] = to_object(&m, &rays, i);
            let met = S::cross(o, d);
            let nearer = met.found & ((met.t as f32) < t[i]);
            t[i] = if nearer { met.t as f32 } else { t[i] };
            u[i] = if nearer { met.x as f32 } else { u[i] };
            v[i] = if nearer { met.y as f32 } else { v[i] };
            which[i] = if nearer { instance } else { which[i] };
        }
    }
}

impl Kernel for Nearby<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const L: usize>(mut self) {
        let geometry = self.geometry;
        for &instance in &geometry.simple.shapes {
            let placed = &geometry.placed[instance as usize];
            match placed.kind {
                Kind::Rectangle => self.test::<Rectangle>(placed, instance),
                Kind::Disk => self.test::<Disk>(placed, instance),
                Kind::Sphere => self.test::<Sphere>(placed, instance),
                Kind::Mesh(_) => {}
            }
        }
    }
}

struct Anything<'a> {
    geometry: &'a Geometry,
    rays: [[&'a [f32]; 3]; 2],
    t_max: &'a [f32],
    occluded: &'a mut [bool],
}

impl Anything<'_> {
    #[inline(always)]
    fn test<S: Crossed>(&mut self, placed: &Placed) {
        let count = self.occluded.len();
        let m = placed.to_object;
        let rays = cut(self.rays, count);
        let end = &self.t_max[..count];
        let occluded = &mut self.occluded[..count];
        for i in 0..count {
            let [o, d] = to_object(&m, &rays, i);
            let met = S::cross(o, d);
            occluded[i] |= met.found & ((met.t as f32) < end[i]);
        }
    }
}

impl Kernel for Anything<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const L: usize>(mut self) {
        let geometry = self.geometry;
        for &instance in &geometry.simple.shapes {
            let placed = &geometry.placed[instance as usize];
            match placed.kind {
                Kind::Rectangle => self.test::<Rectangle>(placed),
                Kind::Disk => self.test::<Disk>(placed),
                Kind::Sphere => self.test::<Sphere>(placed),
                Kind::Mesh(_) => {}
            }
        }
    }
}
