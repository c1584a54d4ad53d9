//! [`Surfaces`], what is known of many surface points, as structures of arrays.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::placed::{Kind, Placed};
use super::surface::{axes, normal_part, offset_origin, on_triangle, ray_to};
use super::{Geometry, Hit, Ray, Shape, SurfacePoint};
use crate::mesh::TriangleMesh;
use gonio_num::dispatch::{Kernel, dispatch};
use gonio_num::lanes::Lanes;
use gonio_num::{Affine3, DoubleLanes, Real, Vec3, Vectors, vectors::whole_steps};

/// Points of surfaces as [`SurfacePoint`] has them, without texture coordinates and colours.
#[derive(Debug, Clone, Default)]
pub struct Surfaces {
    /// [`SurfacePoint::p`].
    pub p: Vectors,
    /// [`SurfacePoint::error`].
    pub error: Vec<f32>,
    /// [`SurfacePoint::ng`].
    pub ng: Vectors,
    /// [`SurfacePoint::ns`].
    pub ns: Vectors,
    /// [`SurfacePoint::tangent`].
    pub tangent: Vectors,
}

impl Surfaces {
    /// Makes it `count` points.
    pub fn resize(&mut self, count: usize) {
        for v in [&mut self.p, &mut self.ng, &mut self.ns, &mut self.tangent] {
            v.resize(count);
        }
        self.error.resize(whole_steps(count), 0.0);
    }

    /// Puts a point at `i`.
    #[inline]
    pub fn set(&mut self, i: usize, point: &SurfacePoint) {
        self.p.set(i, point.p);
        self.ng.set(i, point.ng);
        self.ns.set(i, point.ns);
        self.tangent.set(i, point.tangent);
        self.error[i] = point.error;
    }

    /// Point `i`, where `hit` is, without texture coordinates and colours.
    #[inline]
    pub fn point(&self, i: usize, hit: &Hit) -> SurfacePoint {
        SurfacePoint {
            p: self.p.get(i),
            error: self.error[i],
            ng: self.ng.get(i),
            ns: self.ns.get(i),
            tangent: self.tangent.get(i),
            bitangent_sign: 1.0,
            uv: [0.0; 2],
            uv1: [0.0; 2],
            colour: [1.0; 4],
            t: hit.t,
            instance: hit.instance,
            primitive: hit.primitive,
        }
    }

    /// [`SurfacePoint::offset_origin`] of each point, for its direction.
    ///
    /// # Panics
    /// If there are fewer directions than points.
    pub fn offset_origins(&self, directions: &Vectors, origins: &mut Vectors) {
        origins.resize(self.p.len());
        dispatch(OffsetOrigins {
            surfaces: self,
            directions: directions.axes(),
            origins: origins.axes_mut(),
        });
    }

    /// From each point the ray in direction `wi` where `infinite` ([`SurfacePoint::spawn_ray`]), else the one to its `target`
    /// ([`SurfacePoint::spawn_ray_to`]).
    ///
    /// - `rays`: origins and directions, written
    /// - `t_max`: where each ends, written
    ///
    /// # Panics
    /// If there are fewer directions or targets than points.
    pub fn spawn_rays(
        &self,
        (wi, target, infinite): (&Vectors, &Vectors, &[bool]),
        rays: [&mut Vectors; 2],
        t_max: &mut Vec<f32>,
    ) {
        let count = self.p.len();
        t_max.resize(count, 0.0);
        let [origins, directions] = rays;
        origins.resize(count);
        directions.resize(count);
        dispatch(SpawnRays {
            surfaces: self,
            wi: wi.axes(),
            target: target.axes(),
            infinite: &infinite[..count],
            rays: [origins.axes_mut(), directions.axes_mut()],
            t_max: &mut t_max[..count],
        });
    }
}

/// Vector `i` of columns.
#[inline(always)]
fn get(v: &[&[f32]; 3], i: usize) -> Vec3<f32> {
    Vec3::new(v[0][i], v[1][i], v[2][i])
}

/// The columns cut to a length, which a compiler then knows.
#[inline(always)]
fn cut<'a>(v: &[&'a [f32]; 3], count: usize) -> [&'a [f32]; 3] {
    [&v[0][..count], &v[1][..count], &v[2][..count]]
}

// Plain loops, which a compiler turns into vector instructions by itself.

struct OffsetOrigins<'a> {
    surfaces: &'a Surfaces,
    directions: [&'a [f32]; 3],
    origins: [&'a mut [f32]; 3],
}

impl Kernel for OffsetOrigins<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const L: usize>(self) {
        let s = self.surfaces;
        let count = s.p.len();
        let (p, ng) = (s.p.axes(), s.ng.axes());
        let (p, ng, error) = (cut(&p, count), cut(&ng, count), &s.error[..count]);
        let wi = cut(&self.directions, count);
        let [x, y, z] = self.origins;
        let (x, y, z) = (&mut x[..count], &mut y[..count], &mut z[..count]);
        for i in 0..count {
            let o = offset_origin(get(&p, i), get(&ng, i), error[i], get(&wi, i));
            x[i] = o.x;
            y[i] = o.y;
            z[i] = o.z;
        }
    }
}

struct SpawnRays<'a> {
    surfaces: &'a Surfaces,
    wi: [&'a [f32]; 3],
    target: [&'a [f32]; 3],
    infinite: &'a [bool],
    rays: [[&'a mut [f32]; 3]; 2],
    t_max: &'a mut [f32],
}

impl Kernel for SpawnRays<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const L: usize>(self) {
        let s = self.surfaces;
        let count = s.p.len();
        let (p, ng) = (s.p.axes(), s.ng.axes());
        let (p, ng, error) = (cut(&p, count), cut(&ng, count), &s.error[..count]);
        let (wi, target) = (cut(&self.wi, count), cut(&self.target, count));
        let infinite = &self.infinite[..count];
        let [[ox, oy, oz], [dx, dy, dz]] = self.rays;
        let (ox, oy, oz) = (&mut ox[..count], &mut oy[..count], &mut oz[..count]);
        let (dx, dy, dz) = (&mut dx[..count], &mut dy[..count], &mut dz[..count]);
        let t_max = &mut self.t_max[..count];
        for i in 0..count {
            let (p, wi, target) = (get(&p, i), get(&wi, i), get(&target, i));
            let endless = infinite[i];
            let way = target - p;
            let toward = Vec3::new(
                if endless { wi.x } else { way.x },
                if endless { wi.y } else { way.y },
                if endless { wi.z } else { way.z },
            );
            let origin = offset_origin(p, get(&ng, i), error[i], toward);
            let ray = ray_to(origin, target);
            ox[i] = origin.x;
            oy[i] = origin.y;
            oz[i] = origin.z;
            dx[i] = if endless { wi.x } else { ray.direction.x };
            dy[i] = if endless { wi.y } else { ray.direction.y };
            dz[i] = if endless { wi.z } else { ray.direction.z };
            t_max[i] = if endless { f32::INFINITY } else { ray.t_max };
        }
    }
}

impl Geometry {
    /// [`Geometry::surface`] of many hits, the same to the bit. Neighbours on one instance are done together, on lanes.
    ///
    /// - `rays`: origins and directions
    /// - `order`: indices of rays; the point of ray `order[i]` is put at `i`
    /// - `hits`: one a ray
    ///
    /// # Panics
    /// If an index is out of range, or a hit isn't one of this geometry.
    pub fn surfaces(
        &self,
        rays: [&Vectors; 2],
        order: &[u32],
        hits: &[Hit],
        surfaces: &mut Surfaces,
    ) {
        surfaces.resize(order.len());
        let mut at = 0;
        while at < order.len() {
            let instance = hits[order[at] as usize].instance;
            let run = order[at..]
                .iter()
                .take_while(|&&k| hits[k as usize].instance == instance)
                .count();
            let placed = &self.placed[instance as usize];
            let local = match (placed.kind, self.shape_of(instance)) {
                (Kind::Mesh(_), Shape::Mesh(mesh)) if mesh.has_own_tangents() => None,
                (Kind::Mesh(_), Shape::Mesh(mesh)) => Some(Local::Triangles(mesh)),
                (Kind::Sphere, _) => Some(Local::Sphere),
                _ => Some(Local::Flat),
            };
            match local.filter(|_| run > 1) {
                Some(local) => dispatch(Run {
                    placed,
                    local,
                    rays,
                    order: &order[at..at + run],
                    hits,
                    surfaces,
                    at,
                }),
                None => {
                    for (i, &k) in order[at..at + run].iter().enumerate() {
                        let k = k as usize;
                        let ray = Ray::new(rays[0].get(k), rays[1].get(k));
                        surfaces.set(at + i, &self.surface(&ray, &hits[k]));
                    }
                }
            }
            at += run;
        }
    }
}

/// Which formula gives a point in the shape's coordinates.
enum Local<'a> {
    Sphere,
    Flat,
    Triangles(&'a TriangleMesh),
}

/// Points on one instance.
struct Run<'a> {
    placed: &'a Placed,
    local: Local<'a>,
    rays: [&'a Vectors; 2],
    order: &'a [u32],
    hits: &'a [Hit],
    surfaces: &'a mut Surfaces,
    /// Where the points are put.
    at: usize,
}

/// A point in the shape's coordinates: itself, and its directions as [`axes`] wants them.
type Place<const L: usize> = [Vec3<DoubleLanes<L>>; 4];

impl Run<'_> {
    /// Number `i` of each lane's hit.
    #[inline(always)]
    fn numbers<const L: usize>(&self, of: &[u32; L]) -> [Lanes<L>; 3] {
        let mut numbers = [Lanes([0.0; L]); 3];
        for lane in 0..L {
            let hit = &self.hits[of[lane] as usize];
            numbers[0].0[lane] = hit.t;
            numbers[1].0[lane] = hit.u;
            numbers[2].0[lane] = hit.v;
        }
        numbers
    }

    #[inline(always)]
    fn vectors<const L: usize>(v: &Vectors, of: &[u32; L]) -> Vec3<Lanes<L>> {
        let [x, y, z] = v.axes();
        let mut r = Vec3::splat(Lanes([0.0; L]));
        for lane in 0..L {
            let k = of[lane] as usize;
            r.x.0[lane] = x[k];
            r.y.0[lane] = y[k];
            r.z.0[lane] = z[k];
        }
        r
    }

    #[inline(always)]
    fn on_sphere<const L: usize>(&self, of: &[u32; L]) -> Place<L> {
        let to_object = Affine3::<DoubleLanes<L>>::lit(self.placed.to_object);
        let o = to_object.transform_point(Self::vectors(self.rays[0], of).to_double());
        let d = to_object.transform_vector(Self::vectors(self.rays[1], of).to_double());
        let [t, _, _] = self.numbers(of);
        let n = (o + d * t.to_double()).normalize();
        let zero = DoubleLanes::zero();
        [n, n, Vec3::splat(zero), Vec3::new(-n.y, n.x, zero)]
    }

    #[inline(always)]
    fn on_triangles<const L: usize>(&self, mesh: &TriangleMesh, of: &[u32; L]) -> Place<L> {
        let mut corners = [Vec3::splat(Lanes([0.0; L])); 3];
        let mut normals = corners;
        let smooth = !mesh.normals.is_empty();
        for lane in 0..L {
            let triangle = mesh.indices[self.hits[of[lane] as usize].primitive as usize];
            for k in 0..3 {
                let i = triangle[k] as usize;
                let p = mesh.positions[i];
                corners[k].x.0[lane] = p.x;
                corners[k].y.0[lane] = p.y;
                corners[k].z.0[lane] = p.z;
                if smooth {
                    let n = mesh.normals[i];
                    normals[k].x.0[lane] = n.x;
                    normals[k].y.0[lane] = n.y;
                    normals[k].z.0[lane] = n.z;
                }
            }
        }
        let [_, u, v] = self.numbers(of);
        let corners = [
            corners[0].to_double(),
            corners[1].to_double(),
            corners[2].to_double(),
        ];
        let (weights, p, ng) = on_triangle(corners, u.to_double(), v.to_double());
        let mut ns = Vec3::zero();
        if smooth {
            let unit = ng.normalize();
            for k in 0..3 {
                ns += normal_part(normals[k].to_double(), weights[k], unit);
            }
        }
        [p, ng, ns, Vec3::zero()]
    }
}

impl Kernel for Run<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const L: usize>(self) {
        let to_world = Affine3::<DoubleLanes<L>>::lit(self.placed.to_world);
        let mut done = 0;
        while done < self.order.len() {
            // Past the end the last one is done again.
            let left = (self.order.len() - done).min(L);
            let mut of = [self.order[self.order.len() - 1]; L];
            of[..left].copy_from_slice(&self.order[done..done + left]);
            let here = self.at + done;
            let [local, ng, ns, tangent] = match self.local {
                Local::Sphere => self.on_sphere(&of),
                Local::Triangles(mesh) => self.on_triangles(mesh, &of),
                Local::Flat => {
                    let [_, x, y] = self.numbers(&of);
                    let zero = DoubleLanes::zero();
                    let p = Vec3::new(x.to_double(), y.to_double(), zero);
                    [p, Vec3::zero(), Vec3::zero(), Vec3::zero()]
                }
            };
            let p = to_world.transform_point(local);
            let error = self.placed.error_at(p).to_single() + Lanes::splat(f32::MIN_POSITIVE);
            // Lanes past the end are written over by the runs that follow.
            error.store(&mut self.surfaces.error[here..]);
            self.surfaces.p.store(here, p.to_single());
            let (ng, ns, tangent) = match &self.placed.flat {
                Some(flat) => flat.over(),
                None => {
                    let world = axes(&to_world, ng, ns, tangent);
                    (
                        world.ng.to_single(),
                        world.ns.to_single(),
                        world.tangent.to_single(),
                    )
                }
            };
            self.surfaces.ng.store(here, ng);
            self.surfaces.ns.store(here, ns);
            self.surfaces.tangent.store(here, tangent);
            done += L;
        }
    }
}
