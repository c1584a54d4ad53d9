//! Ray queries of many rays at once, in scenes of so few shapes that no tree is worth its walk: each shape is tested with all rays.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::nearest::Nearest;
use super::placed::{Kind, Placed};
use super::shape::{Met, cross_flat, cross_sphere};
use super::{Geometry, Hit, Ray};
use gonio_num::dispatch::{Kernel, dispatch};
use gonio_num::{Affine3, Vec3, Vectors};

/// The shapes of a scene that are no meshes, and the meshes, where both are few.
#[derive(Debug, Default)]
pub(super) struct Simple {
    /// Instances of spheres, rectangles and disks, in their order.
    shapes: Vec<u32>,
    /// Instances of meshes, with their trees.
    pub(super) meshes: Vec<(u32, u32)>,
    /// Whether they are few.
    few: bool,
}

/// The most work a ray may make, in units of a test of a plane. A walk through a tree takes the time of about forty.
const MOST_WORK: usize = 32;
/// A sphere's test, in those units.
const SPHERE: usize = 2;
/// The most meshes, each of which every ray asks.
const MOST_MESHES: usize = 2;

impl Simple {
    pub(super) fn of(placed: &[Placed]) -> Self {
        let mut simple = Self::default();
        let mut work = 0;
        for (i, placed) in placed.iter().enumerate() {
            // A mesh without triangles has no box, and no tree to ask.
            if placed.bounds.is_empty() {
                continue;
            }
            match placed.kind {
                Kind::Mesh(tree) => simple.meshes.push((i as u32, tree)),
                Kind::Sphere => work += SPHERE,
                Kind::Rectangle | Kind::Disk => work += 1,
            }
            if !matches!(placed.kind, Kind::Mesh(_)) {
                simple.shapes.push(i as u32);
            }
            if work > MOST_WORK || simple.meshes.len() > MOST_MESHES {
                return Self::default();
            }
        }
        // A mesh alone is best asked by itself.
        simple.few = !simple.shapes.is_empty();
        simple
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
        hits.resize(count, NOTHING);
        if !self.simple.few {
            for (i, hit) in hits.iter_mut().enumerate() {
                let ray = Ray::new(rays[0].get(i), rays[1].get(i));
                *hit = self.intersect(&ray).unwrap_or(NOTHING);
            }
            return;
        }
        let column = || vec![0.0; count];
        let mut nearest = Columns {
            t: vec![f32::INFINITY; count],
            u: column(),
            v: column(),
            instance: vec![u32::MAX; count],
        };
        dispatch(Nearby {
            geometry: self,
            rays: [rays[0].axes(), rays[1].axes()],
            nearest: &mut nearest,
        });
        for (i, hit) in hits.iter_mut().enumerate() {
            *hit = Hit {
                t: nearest.t[i],
                instance: nearest.instance[i],
                primitive: 0,
                u: nearest.u[i],
                v: nearest.v[i],
            };
        }
        if self.simple.meshes.is_empty() {
            return;
        }
        for (i, hit) in hits.iter_mut().enumerate() {
            let ray = Ray::new(rays[0].get(i), rays[1].get(i));
            let nearest = if hit.t < f32::INFINITY {
                Nearest::of(hit)
            } else {
                Nearest::none(f32::INFINITY)
            };
            *hit = self
                .nearest_of_meshes(&ray, nearest)
                .hit()
                .unwrap_or(NOTHING);
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
        let ray = |i: usize| Ray {
            origin: rays[0].get(i),
            direction: rays[1].get(i),
            t_max: t_max[i],
        };
        if !self.simple.few {
            for (i, occluded) in occluded.iter_mut().enumerate() {
                *occluded = self.occluded(&ray(i));
            }
            return;
        }
        dispatch(Anything {
            geometry: self,
            rays: [rays[0].axes(), rays[1].axes()],
            t_max: &t_max[..count],
            occluded,
        });
        if self.simple.meshes.is_empty() {
            return;
        }
        for (i, occluded) in occluded.iter_mut().enumerate() {
            *occluded = *occluded || self.occluded_by_meshes(&ray(i));
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
