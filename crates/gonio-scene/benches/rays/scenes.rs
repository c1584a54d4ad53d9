//! The two scenes of the benches, and sets of rays.

use gonio_num::{Affine3, Vec3};
use gonio_scene::{Geometry, Instance, Ray, Shape, TriangleMesh};
use std::sync::Arc;

const SIDE: usize = 512;

/// SplitMix64.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
    fn point(&mut self) -> Vec3<f64> {
        let mut one = || 2.0 * self.unit() - 1.0;
        Vec3::new(one(), one(), one())
    }
    fn direction(&mut self) -> Vec3<f64> {
        loop {
            let p = self.point();
            if (1e-3..1.0).contains(&p.length_squared()) {
                return p.normalize();
            }
        }
    }
}

/// Three octaves of bumps on the unit sphere around (0, 1.06, 0).
pub fn sphere_mesh() -> TriangleMesh {
    let (columns, rows) = (1000u32, 501u32);
    let mut mesh = TriangleMesh::default();
    for i in 0..rows {
        let theta = std::f64::consts::PI * f64::from(i) / f64::from(rows - 1);
        for j in 0..columns {
            let phi = std::f64::consts::TAU * f64::from(j) / f64::from(columns);
            let (x, y, z) = (
                theta.sin() * phi.cos(),
                theta.cos(),
                theta.sin() * phi.sin(),
            );
            let r = 1.0
                + 0.06 * (9.0 * x + 1.0).sin() * (11.0 * y).sin() * (10.0 * z + 0.5).sin()
                + 0.02 * (37.0 * x).sin() * (41.0 * y + 0.3).sin() * (43.0 * z).sin()
                + 0.004 * (151.0 * x).sin() * (163.0 * y).sin() * (157.0 * z).sin();
            let p = Vec3::new(x * r, y * r + 1.06, z * r);
            mesh.positions.push(p.to_f32());
        }
    }
    for i in 0..rows - 1 {
        for j in 0..columns {
            let (a, b) = (i * columns + j, i * columns + (j + 1) % columns);
            let (c, d) = (a + columns, b + columns);
            mesh.indices.push([a, b, c]);
            mesh.indices.push([b, d, c]);
        }
    }
    mesh.repair();
    mesh
}

pub fn soup_mesh() -> TriangleMesh {
    let mut random = Random(7);
    let mut mesh = TriangleMesh::default();
    for i in 0..200_000 {
        let centre = random.point() * 1.2 + Vec3::new(0.0, 1.06, 0.0);
        for _ in 0..3 {
            let p = centre + random.point() * 0.02;
            mesh.positions.push(p.to_f32());
        }
        mesh.indices.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh
}

pub fn place(mesh: TriangleMesh) -> Geometry {
    let instance = Instance {
        shape: 0,
        to_world: Affine3::identity(),
        material: 0,
        area_light: None,
    };
    Geometry::build(vec![Shape::Mesh(Arc::new(mesh))], vec![instance]).expect("a sound mesh")
}

/// A camera's rays, by tiles of 8 × 8.
pub fn primary() -> Vec<Ray> {
    let eye = Vec3::new(0.0, 2.2, 6.0);
    let camera = Affine3::look_at(eye, Vec3::new(0.0, 0.9, 0.0), Vec3::new(0.0, 1.0, 0.0));
    let slope = 12f64.to_radians().tan();
    let tiles = SIDE / 8;
    (0..SIDE * SIDE)
        .map(|i| {
            let (tile, inner) = (i / 64, i % 64);
            let x = (tile % tiles) * 8 + inner % 8;
            let y = (tile / tiles) * 8 + inner / 8;
            let at = |k: usize| (k as f64 + 0.5) / SIDE as f64 * 2.0 - 1.0;
            let d = Vec3::new(at(x) * slope, -at(y) * slope, -1.0);
            let d = camera.transform_vector(d).normalize();
            Ray::new(eye.to_f32(), d.to_f32())
        })
        .collect()
}

/// Random points of the bounding cube, random directions.
pub fn incoherent() -> Vec<Ray> {
    let mut random = Random(1);
    (0..SIDE * SIDE)
        .map(|_| {
            let o = random.point() * 1.2 + Vec3::new(0.0, 1.06, 0.0);
            Ray::new(o.to_f32(), random.direction().to_f32())
        })
        .collect()
}

/// From random points of the surface, cosine-distributed around the normal.
pub fn second_bounce(g: &Geometry) -> Vec<Ray> {
    let mut random = Random(2);
    (0..SIDE * SIDE)
        .map(|_| {
            let mut one = || random.unit() as f32;
            let s = g.sample_area(0, [one(), one()], one());
            let outward = (s.p - Vec3::new(0.0, 1.06, 0.0)).dot(s.ng);
            let n = if outward < 0.0 { -s.ng } else { s.ng };
            let d = (random.direction() + n.to_f64()).normalize();
            Ray::new(s.p + n * 1e-4, d.to_f32())
        })
        .collect()
}
