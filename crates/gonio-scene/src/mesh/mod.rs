//! Triangle meshes: the data, its rules, and readers.
//!
//! Texture coordinates follow glTF: (0, 0) is the upper left corner of the image and v grows downwards. Readers of
//! formats with v upwards turn it.

mod check;
pub mod obj;
pub mod ply;

pub use check::{MAX_COORDINATE, MeshSummary, Repair};

use gonio_num::Vec3;

/// Triangles over shared vertices.
///
/// Attributes are given for each vertex, or not at all (an empty list). [`TriangleMesh::check`] proves the rules,
/// [`TriangleMesh::repair`] makes them true.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TriangleMesh {
    /// Vertices \[m\], finite, no coordinate beyond [`MAX_COORDINATE`].
    pub positions: Vec<Vec3<f32>>,
    /// Shading normals, of any length; or empty. A zero normal means: the triangle's own.
    pub normals: Vec<Vec3<f32>>,
    /// First texture coordinates, v downwards; or empty.
    pub uvs: Vec<[f32; 2]>,
    /// Second texture coordinates, v downwards; or empty.
    pub uvs1: Vec<[f32; 2]>,
    /// Tangents (x, y, z) and the sign w of the bitangent w · (normal × tangent), as in glTF; or empty.
    pub tangents: Vec<[f32; 4]>,
    /// Linear RGBA colours; or empty.
    pub colours: Vec<[f32; 4]>,
    /// Three vertices a triangle, counter-clockwise seen from outside.
    pub indices: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// Number of triangles, degenerate ones included.
    pub fn triangle_count(&self) -> usize {
        self.indices.len()
    }

    /// The three corners of a triangle.
    ///
    /// # Panics
    /// If the triangle or one of its vertices doesn't exist.
    #[inline(always)]
    pub fn corners(&self, triangle: usize) -> [Vec3<f32>; 3] {
        let [a, b, c] = self.indices[triangle];
        [
            self.positions[a as usize],
            self.positions[b as usize],
            self.positions[c as usize],
        ]
    }

    /// (b − a) × (c − a) of a triangle in double precision: twice its area, along its geometric normal.
    ///
    /// # Panics
    /// If the triangle or one of its vertices doesn't exist.
    pub fn area_vector(&self, triangle: usize) -> Vec3<f64> {
        let [a, b, c] = self.corners(triangle).map(Vec3::to_f64);
        (b - a).cross(c - a)
    }

    /// Whether tangents are given, or follow from texture coordinates.
    pub fn has_own_tangents(&self) -> bool {
        !self.tangents.is_empty() || !self.uvs.is_empty()
    }

    /// Whether the mesh is closed and its triangles' fronts face what it encloses.
    ///
    /// Taken for closed is a mesh whose area vectors add up to nothing, to 1e-4 of its area: that needs no shared vertices. Then
    /// its volume, ⅙ Σ a·(b × c), is negative if the fronts face inwards.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn is_inside_out(&self) -> bool {
        let Some(&origin) = self.positions.first() else {
            return false;
        };
        let (mut sum, mut area, mut volume) = (Vec3::<f64>::zero(), 0.0, 0.0);
        for triangle in 0..self.indices.len() {
            let vector = self.area_vector(triangle);
            let corner = self.corners(triangle)[0].to_f64() - origin.to_f64();
            sum += vector;
            area += vector.length();
            // a·(b × c) with the origin at the first vertex, which for triangle abc is a·((b − a) × (c − a)).
            volume += corner.dot(vector);
        }
        sum.length() < 1e-4 * area && volume < 0.0
    }

    /// Adds another mesh's triangles. An attribute that only one of the two has is filled up with its neutral value:
    /// normal 0, texture coordinate (0, 0), tangent 0, colour white.
    pub fn append(&mut self, other: &TriangleMesh) {
        let (before, added) = (self.positions.len(), other.positions.len());
        fn join<T: Copy>(a: &mut Vec<T>, b: &[T], before: usize, added: usize, neutral: T) {
            if a.is_empty() && b.is_empty() {
                return;
            }
            a.resize(before, neutral);
            a.extend_from_slice(b);
            a.resize(before + added, neutral);
        }
        join(
            &mut self.normals,
            &other.normals,
            before,
            added,
            Vec3::zero(),
        );
        join(&mut self.uvs, &other.uvs, before, added, [0.0; 2]);
        join(&mut self.uvs1, &other.uvs1, before, added, [0.0; 2]);
        join(&mut self.tangents, &other.tangents, before, added, [0.0; 4]);
        join(&mut self.colours, &other.colours, before, added, [1.0; 4]);
        self.positions.extend_from_slice(&other.positions);
        let base = before as u32;
        self.indices
            .extend(other.indices.iter().map(|t| t.map(|i| i + base)));
    }
}
