//! Meshes and random numbers that the tests share.

use crate::geometry::{Geometry, Instance, Shape};
use crate::mesh::TriangleMesh;
use gonio_num::{Affine3, Vec3};
use std::sync::Arc;

/// A small generator (SplitMix64), seeded by a test's name.
pub struct Random(u64);

impl Random {
    pub fn named(name: &str) -> Self {
        Self(name.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| {
            (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3)
        }))
    }
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }
    /// In [−1, 1).
    pub fn signed(&mut self) -> f32 {
        2.0 * self.unit() - 1.0
    }
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
    pub fn point(&mut self) -> Vec3<f32> {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }
    pub fn direction(&mut self) -> Vec3<f32> {
        loop {
            let p = self.point();
            let l = p.length_squared();
            if l > 1e-4 && l <= 1.0 {
                return p.normalize();
            }
        }
    }
}

pub fn instance(shape: u32, to_world: Affine3<f32>) -> Instance {
    Instance {
        shape,
        to_world,
        material: 0,
        area_light: None,
    }
}

pub fn one(shape: Shape, to_world: Affine3<f32>) -> Geometry {
    Geometry::build(vec![shape], vec![instance(0, to_world)]).unwrap()
}

pub fn of_mesh(mesh: TriangleMesh) -> Geometry {
    one(Shape::Mesh(Arc::new(mesh)), Affine3::identity())
}

/// Triangles of edge `size` strewn over [−1, 1]³; each fourth lies in a plane across an axis.
pub fn soup(random: &mut Random, count: usize, size: f32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for i in 0..count {
        let centre = random.point();
        let flat = i % 4 == 0;
        let axis = random.below(3);
        for _ in 0..3 {
            let mut p = (centre + random.point() * size).to_array();
            if flat {
                p[axis] = (centre[axis] * 4.0).floor() / 4.0;
            }
            mesh.positions.push(p.into());
        }
        let k = 3 * i as u32;
        mesh.indices.push([k, k + 1, k + 2]);
    }
    mesh
}

/// A closed sphere of radius 1 + bumps, `columns` × `rows` quads, outward winding.
pub fn bumpy_sphere(columns: usize, rows: usize, bump: f32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    let push = |mesh: &mut TriangleMesh, theta: f64, phi: f64| {
        let p = Vec3::new(
            theta.sin() * phi.cos(),
            theta.cos(),
            -(theta.sin() * phi.sin()),
        );
        let r = 1.0
            + f64::from(bump) * (9.0 * p.x + 1.0).sin() * (11.0 * p.y).sin() * (10.0 * p.z).sin();
        mesh.positions.push((p * r).to_f32());
    };
    let (pi, tau) = (std::f64::consts::PI, std::f64::consts::TAU);
    push(&mut mesh, 0.0, 0.0);
    for i in 1..rows {
        for j in 0..columns {
            let theta = pi * i as f64 / rows as f64;
            push(&mut mesh, theta, tau * j as f64 / columns as f64);
        }
    }
    push(&mut mesh, pi, 0.0);
    let last = mesh.positions.len() as u32 - 1;
    let at = |i: usize, j: usize| 1 + ((i - 1) * columns + j % columns) as u32;
    for j in 0..columns {
        mesh.indices.push([0, at(1, j), at(1, j + 1)]);
        for i in 1..rows - 1 {
            let (a, b, c, d) = (at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
            mesh.indices.push([a, c, b]);
            mesh.indices.push([b, c, d]);
        }
        mesh.indices
            .push([last, at(rows - 1, j + 1), at(rows - 1, j)]);
    }
    mesh
}
