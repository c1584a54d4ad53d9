//! The rules of a mesh: proof and repair.

use super::TriangleMesh;
use crate::SceneError;

/// The largest coordinate a vertex may have: products of three stay far inside single precision.
pub const MAX_COORDINATE: f32 = 1e12;

/// What [`TriangleMesh::check`] found in a sound mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MeshSummary {
    /// Triangles in all.
    pub triangles: usize,
    /// Of those, triangles without area: ray queries and light sampling skip them.
    pub degenerate: usize,
}

/// What [`TriangleMesh::repair`] changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repair {
    /// Triangles dropped because a vertex doesn't exist.
    pub out_of_range: usize,
    /// Triangles dropped because a vertex isn't finite, or lies beyond [`MAX_COORDINATE`].
    pub bad_position: usize,
    /// Triangles dropped because they have no area.
    pub degenerate: usize,
    /// Attribute lists dropped because their length differs from the number of vertices.
    pub attributes: usize,
    /// Attribute values that weren't finite, made neutral.
    pub values: usize,
}

impl Repair {
    /// Whether nothing was changed.
    pub fn is_clean(&self) -> bool {
        *self == Self::default()
    }
}

fn finite<const N: usize>(a: [f32; N]) -> bool {
    a.iter().all(|x| x.is_finite())
}

fn good_position(p: [f32; 3]) -> bool {
    // False for NaN.
    p.iter().all(|x| x.abs() <= MAX_COORDINATE)
}

impl TriangleMesh {
    /// Proves the mesh's rules: positions finite and within [`MAX_COORDINATE`], attributes finite and as many as
    /// vertices, indices in range. Triangles without area are counted, not refused.
    ///
    /// # Errors
    /// [`SceneError::Mesh`] with the first index that breaks a rule.
    pub fn check(&self) -> Result<MeshSummary, SceneError> {
        let count = self.positions.len();
        let fault = |place: String, found: String, expected: String| {
            Err(SceneError::Mesh {
                place,
                found,
                expected,
            })
        };
        if count > u32::MAX as usize {
            return fault(
                "positions".into(),
                count.to_string(),
                format!("at most {}", u32::MAX),
            );
        }
        if let Some(i) = self
            .positions
            .iter()
            .position(|p| !good_position(p.to_array()))
        {
            return fault(
                format!("vertex {i}"),
                format!("position {:?}", self.positions[i].to_array()),
                format!("finite coordinates of magnitude at most {MAX_COORDINATE:e}"),
            );
        }
        // One line for each attribute: name, length, first value that isn't finite.
        let attributes = [
            (
                "normals",
                self.normals.len(),
                self.normals.iter().position(|n| !n.is_finite()),
            ),
            (
                "uvs",
                self.uvs.len(),
                self.uvs.iter().position(|&a| !finite(a)),
            ),
            (
                "uvs1",
                self.uvs1.len(),
                self.uvs1.iter().position(|&a| !finite(a)),
            ),
            (
                "tangents",
                self.tangents.len(),
                self.tangents.iter().position(|&a| !finite(a)),
            ),
            (
                "colours",
                self.colours.len(),
                self.colours.iter().position(|&a| !finite(a)),
            ),
        ];
        for (name, length, bad) in attributes {
            if length != 0 && length != count {
                return fault(
                    name.into(),
                    format!("{length} values"),
                    format!("{count}, one a vertex, or none"),
                );
            }
            if let Some(i) = bad {
                return fault(
                    format!("vertex {i}"),
                    format!("a value of {name} that is not finite"),
                    "finite values".into(),
                );
            }
        }
        for (i, t) in self.indices.iter().enumerate() {
            if let Some(&v) = t.iter().find(|&&v| v as usize >= count) {
                return fault(
                    format!("triangle {i}"),
                    format!("vertex index {v}"),
                    format!("less than {count}, the number of vertices"),
                );
            }
        }
        Ok(MeshSummary {
            triangles: self.indices.len(),
            degenerate: (0..self.indices.len())
                .filter(|&i| self.is_degenerate(i))
                .count(),
        })
    }

    /// Whether a triangle has no area: two corners are the same point, or all three lie on one line.
    ///
    /// # Panics
    /// If the triangle or one of its vertices doesn't exist.
    pub fn is_degenerate(&self, triangle: usize) -> bool {
        self.area_vector(triangle).length_squared() == 0.0
    }

    /// Makes the rules of [`TriangleMesh::check`] true: drops attribute lists of a wrong length, makes values that aren't
    /// finite neutral, drops triangles with missing or bad vertices and triangles without area. Vertices keep their
    /// indices; bad ones, unused by then, become the origin. Says what it changed.
    pub fn repair(&mut self) -> Repair {
        let mut done = Repair::default();
        let count = self.positions.len();
        fn values<T: Copy>(
            list: &mut Vec<T>,
            count: usize,
            good: impl Fn(&T) -> bool,
            neutral: T,
            done: &mut Repair,
        ) {
            if !list.is_empty() && list.len() != count {
                list.clear();
                done.attributes += 1;
            }
            for value in list.iter_mut().filter(|v| !good(v)) {
                *value = neutral;
                done.values += 1;
            }
        }
        values(
            &mut self.normals,
            count,
            |n| n.is_finite(),
            gonio_num::Vec3::zero(),
            &mut done,
        );
        values(&mut self.uvs, count, |&a| finite(a), [0.0; 2], &mut done);
        values(&mut self.uvs1, count, |&a| finite(a), [0.0; 2], &mut done);
        values(
            &mut self.tangents,
            count,
            |&a| finite(a),
            [0.0; 4],
            &mut done,
        );
        values(
            &mut self.colours,
            count,
            |&a| finite(a),
            [1.0; 4],
            &mut done,
        );

        let mut kept = Vec::with_capacity(self.indices.len());
        for i in 0..self.indices.len() {
            let t = self.indices[i];
            if t.iter().any(|&v| v as usize >= count) {
                done.out_of_range += 1;
            } else if self.corners(i).iter().any(|p| !good_position(p.to_array())) {
                done.bad_position += 1;
            } else if self.is_degenerate(i) {
                done.degenerate += 1;
            } else {
                kept.push(t);
            }
        }
        self.indices = kept;
        for p in &mut self.positions {
            if !good_position(p.to_array()) {
                *p = gonio_num::Vec3::zero();
            }
        }
        done
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_num::Vec3;

    fn triangle() -> TriangleMesh {
        TriangleMesh {
            positions: vec![
                Vec3::new(0.0, 0.0, 0.0),
                Vec3::new(1.0, 0.0, 0.0),
                Vec3::new(0.0, 1.0, 0.0),
            ],
            indices: vec![[0, 1, 2]],
            ..Default::default()
        }
    }

    #[test]
    fn a_sound_mesh_is_counted() {
        let mut m = triangle();
        m.indices.push([0, 1, 1]);
        assert_eq!(
            m.check().unwrap(),
            MeshSummary {
                triangles: 2,
                degenerate: 1
            }
        );
        assert_eq!(m.repair().degenerate, 1);
        assert_eq!(m.check().unwrap().degenerate, 0);
    }

    #[test]
    fn faults_name_the_index() {
        let mut m = triangle();
        m.positions[2].y = f32::NAN;
        let e = m.check().unwrap_err().to_string();
        assert!(e.contains("vertex 2") && e.contains("NaN"), "{e}");

        let mut m = triangle();
        m.positions[1].x = 1e30;
        assert!(m.check().unwrap_err().to_string().contains("vertex 1"));

        let mut m = triangle();
        m.indices.push([0, 1, 3]);
        let e = m.check().unwrap_err().to_string();
        assert!(
            e.contains("triangle 1") && e.contains("vertex index 3"),
            "{e}"
        );

        let mut m = triangle();
        m.uvs = vec![[0.0; 2]; 2];
        let e = m.check().unwrap_err().to_string();
        assert!(e.contains("uvs") && e.contains("2 values"), "{e}");

        let mut m = triangle();
        m.normals = vec![Vec3::new(0.0, f32::INFINITY, 0.0); 3];
        assert!(m.check().unwrap_err().to_string().contains("vertex 0"));
    }

    #[test]
    fn repair_leaves_a_sound_mesh_and_says_what_it_did() {
        let mut m = triangle();
        m.positions.push(Vec3::new(f32::NAN, 0.0, 0.0));
        m.indices
            .extend([[0, 1, 3], [0, 1, 9], [0, 0, 1], [2, 1, 0]]);
        m.uvs = vec![[0.0; 2]; 7];
        m.colours = vec![[f32::NAN; 4]; 4];
        let done = m.repair();
        assert_eq!(
            done,
            Repair {
                out_of_range: 1,
                bad_position: 1,
                degenerate: 1,
                attributes: 1,
                values: 4
            }
        );
        assert!(!done.is_clean());
        assert_eq!(m.check().unwrap().triangles, 2);
        assert!(m.repair().is_clean());
    }

    #[test]
    fn appending_fills_missing_attributes() {
        let mut a = triangle();
        let mut b = triangle();
        b.colours = vec![[0.5; 4]; 3];
        a.append(&b);
        assert_eq!(a.indices[1], [3, 4, 5]);
        assert_eq!(a.colours[0], [1.0; 4]);
        assert_eq!(a.colours[3], [0.5; 4]);
        assert_eq!(a.check().unwrap().triangles, 2);
    }
}
