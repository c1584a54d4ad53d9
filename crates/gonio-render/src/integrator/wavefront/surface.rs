//! [`Vertices`], the surface points of a wave, ready to reflect.

use super::{Group, Plan};
use crate::integrator::vertex::Vertex;
use gonio_brdf::{Brdf, Model, batch::Directions};
use gonio_num::dispatch::{Kernel, dispatch};
use gonio_num::lanes::Lanes;
use gonio_num::{Frame, Real, Vec3, Vectors};
use gonio_radiometry::sequence::{SampleStreams, SamplerKind};
use gonio_scene::{Hit, Ray, Receiver, Surfaces, facing_frame};

/// Surface points in the order of their materials, with local frames.
pub(super) struct Vertices<'a> {
    plan: &'a Plan<'a>,
    /// The materials that are met, in their order.
    pub groups: Vec<Group>,
    pub surfaces: Surfaces,
    /// Direction to the viewer, world.
    pub wo_world: Vectors,
    /// Direction to the viewer, local.
    pub wo: Vectors,
    /// The local frame.
    pub s: Vectors,
    pub t: Vectors,
    pub n: Vectors,
    /// The side from which light counts, as [`Receiver::normal`](gonio_scene::Receiver::normal); empty where lights don't ask for it.
    pub receiving: Vectors,
    /// Of the groups whose material is not the same all over, the points one by one; where each group's begin.
    uneven: Vec<Vertex<'a>>,
    starts: Vec<usize>,
    pub streams: SampleStreams,
}

/// How a group reflects.
pub(super) enum Reflects<'v, 'a> {
    /// By one function.
    Evenly(&'a Model<f32, 3>),
    /// By another one at each point.
    Unevenly(&'v [Vertex<'a>]),
}

impl Reflects<'_, '_> {
    /// Whether the group's point number `k` reflects into single directions alone.
    #[inline]
    pub fn is_delta(&self, k: usize) -> bool {
        match self {
            Self::Evenly(model) => model.is_delta(),
            Self::Unevenly(points) => points[k].model.is_delta(),
        }
    }
}

impl<'a> Vertices<'a> {
    pub fn new(plan: &'a Plan<'a>) -> Self {
        Self {
            plan,
            groups: Vec::new(),
            surfaces: Surfaces::default(),
            wo_world: Vectors::default(),
            wo: Vectors::default(),
            s: Vectors::default(),
            t: Vectors::default(),
            n: Vectors::default(),
            receiving: Vectors::default(),
            uneven: Vec::new(),
            starts: Vec::new(),
            streams: SampleStreams::new(SamplerKind::default()),
        }
    }

    /// Finds what is known of the points where the rays in `order` ended.
    ///
    /// - `rays`: origins and directions
    pub fn find(&mut self, rays: [&Vectors; 2], order: &[u32], hits: &[Hit]) {
        let geometry = &self.plan.scene.geometry;
        geometry.surfaces(rays, order, hits, &mut self.surfaces);
        let count = order.len();
        for v in [
            &mut self.wo_world,
            &mut self.wo,
            &mut self.s,
            &mut self.t,
            &mut self.n,
        ] {
            v.resize(count);
        }
        for (i, &k) in order.iter().enumerate() {
            self.wo_world.set(i, -rays[1].get(k as usize));
        }
        self.uneven.clear();
        self.starts.clear();
        dispatch(Frames {
            surfaces: &self.surfaces,
            wo_world: &self.wo_world,
            wo: &mut self.wo,
            frame: [&mut self.s, &mut self.t, &mut self.n],
        });
        let groups = std::mem::take(&mut self.groups);
        for group in &groups {
            self.starts.push(self.uneven.len());
            match self.plan.models[group.material as usize] {
                Some(model) if model.transmits() => {
                    // Its frame stays on the outer side.
                    for i in group.range.clone() {
                        if self.surfaces.ng.get(i).dot(self.wo_world.get(i)) < 0.0 {
                            let ng = self.surfaces.ng.get(i);
                            let (ns, tangent) =
                                (self.surfaces.ns.get(i), self.surfaces.tangent.get(i));
                            let frame = facing_frame(ns, ng, tangent, self.wo_world.get(i), true);
                            self.set_frame(i, &frame);
                        }
                    }
                }
                Some(_) => {}
                None => {
                    for i in group.range.clone() {
                        let k = order[i] as usize;
                        let ray = Ray::new(rays[0].get(k), rays[1].get(k));
                        let point = geometry.surface(&ray, &hits[k]);
                        let wo = -ray.direction;
                        let shading = self.plan.scene.shade(&point, wo);
                        let vertex = Vertex::new(self.plan.scene, point, wo, shading);
                        self.s.set(i, vertex.frame.s);
                        self.t.set(i, vertex.frame.t);
                        self.n.set(i, vertex.frame.n);
                        self.wo.set(i, vertex.wo);
                        self.uneven.push(vertex);
                    }
                }
            }
        }
        self.groups = groups;
        self.find_receiving_sides();
    }

    fn find_receiving_sides(&mut self) {
        let asked = self.plan.lights().asks_for_normals();
        let mut receiving = std::mem::take(&mut self.receiving);
        receiving.resize(if asked { self.len() } else { 0 });
        if asked {
            for (group, reflects) in self.each_group() {
                for (k, i) in group.range.clone().enumerate() {
                    let transmits = match &reflects {
                        Reflects::Evenly(model) => model.transmits(),
                        Reflects::Unevenly(points) => points[k].transmits,
                    };
                    let side = if transmits {
                        Vec3::zero()
                    } else {
                        self.facing_normal(i)
                    };
                    receiving.set(i, side);
                }
            }
        }
        self.receiving = receiving;
    }

    fn set_frame(&mut self, i: usize, frame: &Frame<f32>) {
        self.s.set(i, frame.s);
        self.t.set(i, frame.t);
        self.n.set(i, frame.n);
        self.wo.set(i, frame.to_local(self.wo_world.get(i)));
    }

    pub fn len(&self) -> usize {
        self.wo.len()
    }

    /// How each group reflects.
    pub fn each_group<'v>(&'v self) -> impl Iterator<Item = (&'v Group, Reflects<'v, 'a>)> {
        self.groups.iter().zip(&self.starts).map(|(group, &start)| {
            let reflects = match self.plan.models[group.material as usize] {
                Some(model) => Reflects::Evenly(model),
                None => Reflects::Unevenly(&self.uneven[start..start + group.range.len()]),
            };
            (group, reflects)
        })
    }

    /// Whether each of the surfaces here reflects by one function, and lets nothing through.
    pub fn are_even(&self) -> bool {
        let plain = |g: &Group| {
            let model = self.plan.models[g.material as usize];
            model.is_some_and(|model| !model.transmits())
        };
        self.groups.iter().all(plain)
    }

    /// Whether anything here lets light through.
    pub fn transmit(&self) -> bool {
        self.each_group().any(|(_, reflects)| match reflects {
            Reflects::Evenly(model) => model.transmits(),
            Reflects::Unevenly(vertices) => vertices.iter().any(|v| v.transmits),
        })
    }

    pub fn albedo(&self, group: &Group, i: usize) -> [f32; 3] {
        let place = self.groups.partition_point(|g| g.material < group.material);
        match self.plan.models[group.material as usize] {
            Some(_) => self.plan.scene.materials[group.material as usize].albedo(),
            None => self.uneven[self.starts[place] + i - group.range.start].albedo,
        }
    }

    /// Local directions of `wi`, zero where no surface that only reflects admits it: on the other side of the true surface.
    pub fn to_local(&self, wi: &Vectors, local: &mut Vectors) {
        local.resize(self.len());
        dispatch(ToLocal {
            vertices: self,
            wi,
            local,
        });
        for (group, reflects) in self.each_group() {
            let (Reflects::Evenly(model), range) = (reflects, &group.range) else {
                continue;
            };
            if !model.transmits() {
                continue;
            }
            for i in range.clone() {
                let (w, frame) = (wi.get(i), self.frame(i));
                let l = frame.to_local(w);
                let admitted = w.dot(self.surfaces.ng.get(i)) * l.z > 0.0;
                local.set(i, if admitted { l } else { Vec3::zero() });
            }
        }
    }

    /// World directions of `local`.
    pub fn to_world(&self, local: &Vectors, world: &mut Vectors) {
        world.resize(self.len());
        dispatch(ToWorld {
            vertices: self,
            local,
            world,
        });
    }

    fn frame(&self, i: usize) -> Frame<f32> {
        Frame {
            s: self.s.get(i),
            t: self.t.get(i),
            n: self.n.get(i),
        }
    }

    #[inline(always)]
    fn frames<const L: usize>(&self, at: usize) -> Frame<Lanes<L>> {
        Frame {
            s: self.s.load(at),
            t: self.t.load(at),
            n: self.n.load(at),
        }
    }

    /// Vertex `i` as lights see it.
    pub fn receiver(&self, i: usize) -> Receiver {
        Receiver {
            p: self.surfaces.p.get(i),
            error: 0.0,
            normal: if self.receiving.is_empty() {
                Vec3::zero()
            } else {
                self.receiving.get(i)
            },
        }
    }

    /// The normal of the frame, on the viewer's side.
    pub fn facing_normal(&self, i: usize) -> Vec3<f32> {
        let n = self.n.get(i);
        if self.wo.get(i).z < 0.0 { -n } else { n }
    }
}

/// A range of directions.
pub(super) fn directions(v: &Vectors, range: std::ops::Range<usize>) -> Directions<'_> {
    let [x, y, z] = v.axes().map(|axis| &axis[range.clone()]);
    Directions { x, y, z }
}

/// Local frames, for functions that reflect alone.
struct Frames<'a> {
    surfaces: &'a Surfaces,
    wo_world: &'a Vectors,
    wo: &'a mut Vectors,
    frame: [&'a mut Vectors; 3],
}

impl Kernel for Frames<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const L: usize>(self) {
        let Self {
            surfaces,
            wo_world,
            wo,
            frame: [s, t, n],
        } = self;
        let mut at = 0;
        while at < wo.len() {
            let toward = wo_world.load::<L>(at);
            let frame = facing_frame(
                surfaces.ns.load::<L>(at),
                surfaces.ng.load::<L>(at),
                surfaces.tangent.load::<L>(at),
                toward,
                false,
            );
            s.store(at, frame.s);
            t.store(at, frame.t);
            n.store(at, frame.n);
            wo.store(at, frame.to_local(toward));
            at += L;
        }
    }
}

struct ToLocal<'a> {
    vertices: &'a Vertices<'a>,
    wi: &'a Vectors,
    local: &'a mut Vectors,
}

impl Kernel for ToLocal<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const L: usize>(self) {
        let v = self.vertices;
        let mut at = 0;
        while at < v.len() {
            let wi = self.wi.load::<L>(at);
            let ng = v.surfaces.ng.load::<L>(at);
            let same_side = wi.dot(ng) * v.wo_world.load::<L>(at).dot(ng);
            let admitted = same_side.gt(Lanes::zero());
            let local = v.frames::<L>(at).to_local(wi);
            self.local
                .store(at, Vec3::select(admitted, local, Vec3::zero()));
            at += L;
        }
    }
}

struct ToWorld<'a> {
    vertices: &'a Vertices<'a>,
    local: &'a Vectors,
    world: &'a mut Vectors,
}

impl Kernel for ToWorld<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const L: usize>(self) {
        let mut at = 0;
        while at < self.vertices.len() {
            let frames = self.vertices.frames::<L>(at);
            self.world.store(at, frames.to_world(self.local.load(at)));
            at += L;
        }
    }
}
