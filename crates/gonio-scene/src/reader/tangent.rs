//! Tangents for normal maps and anisotropy, derived from texture coordinates.
//!
//! A normal map stores normals in the frame (tangent, bitangent, normal) whose tangent points along growing u. A mesh
//! without tangents gets them here, in the way of MikkTSpace (Mikkelsen 2008, "Simulation of Wrinkled Surfaces Revisited"):
//! each corner adds its triangle's ∂p/∂u, projected onto the vertex's tangent plane, unit length, weighted by the corner's
//! angle. Triangles whose texture is mirrored never share a tangent with others: a vertex between them is split.

use crate::TriangleMesh;
use gonio_num::{Real, Vec3};

/// Gives `mesh` tangents for the texture coordinates `uv_set` (0 or 1); nothing changes if it lacks those.
///
/// The bitangent is w · (normal × tangent), along growing v *upwards* in the picture, as glTF's normal maps expect: their
/// green channel points up while v points down. Vertices without a usable triangle get the tangent 0: the shading frame is
/// then any.
pub(crate) fn derive(mesh: &mut TriangleMesh, uv_set: u8) {
    let uvs = if uv_set == 0 { &mesh.uvs } else { &mesh.uvs1 };
    if uvs.len() != mesh.positions.len() || uvs.is_empty() {
        return;
    }
    let smooth = mesh.normals.len() == mesh.positions.len();
    let mut sums = vec![[Vec3::<f64>::zero(); 2]; mesh.positions.len()];
    let mut used = vec![[false; 2]; mesh.positions.len()];
    let mut side_of = Vec::with_capacity(mesh.indices.len());
    for (triangle, corners) in mesh.indices.iter().enumerate() {
        let p = mesh.corners(triangle).map(Vec3::to_f64);
        let uv = corners.map(|i| uvs[i as usize].map(f64::from));
        let (along_u, mirrored) = gradient(p, uv);
        let side = usize::from(mirrored);
        side_of.push(side);
        let face = mesh.area_vector(triangle);
        for k in 0..3 {
            let vertex = corners[k] as usize;
            used[vertex][side] = true;
            let given = if smooth {
                mesh.normals[vertex].to_f64()
            } else {
                face
            };
            let normal = if given.length() > 0.0 {
                given.normalize()
            } else {
                continue;
            };
            let flat = along_u - normal * normal.dot(along_u);
            let weight = angle(p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
            if flat.length() > 0.0 && weight > 0.0 {
                sums[vertex][side] += flat.normalize() * weight;
            }
        }
    }
    // Vertices on both sides of a mirror seam get a twin for the mirrored side.
    let mut twin = vec![None; mesh.positions.len()];
    for vertex in 0..twin.len() {
        if used[vertex] == [true; 2] {
            twin[vertex] = Some(copy_vertex(mesh, vertex));
        }
    }
    for (corners, &side) in mesh.indices.iter_mut().zip(&side_of) {
        if side == 1 {
            for corner in corners {
                *corner = twin[*corner as usize].unwrap_or(*corner);
            }
        }
    }
    let tangent = |sum: Vec3<f64>, side: usize| {
        let unit = if sum.length() > 1e-12 {
            sum.normalize().to_f32()
        } else {
            Vec3::zero()
        };
        // v points down, the bitangent up: an unmirrored texture has w = +1 with the bitangent along −v.
        [unit.x, unit.y, unit.z, if side == 0 { 1.0 } else { -1.0 }]
    };
    let mut tangents: Vec<[f32; 4]> = (0..twin.len())
        .map(|vertex| {
            let side = usize::from(!used[vertex][0]);
            tangent(sums[vertex][side], side)
        })
        .collect();
    tangents.extend(
        (0..twin.len())
            .filter(|&v| twin[v].is_some())
            .map(|v| tangent(sums[v][1], 1)),
    );
    mesh.tangents = tangents;
}

/// ∂p/∂u of a triangle (of any length), and whether its texture is mirrored: whether, seen from the front with u to the right,
/// v grows upwards.
fn gradient(p: [Vec3<f64>; 3], uv: [[f64; 2]; 3]) -> (Vec3<f64>, bool) {
    let (e1, e2) = (p[1] - p[0], p[2] - p[0]);
    let (u1, v1) = (uv[1][0] - uv[0][0], uv[1][1] - uv[0][1]);
    let (u2, v2) = (uv[2][0] - uv[0][0], uv[2][1] - uv[0][1]);
    let determinant = u1 * v2 - u2 * v1;
    // Counter-clockwise in space and in (u, v down) means mirrored: counter-clockwise in (u, v down) is clockwise to the eye.
    let along_u = (e1 * v2 - e2 * v1) * 1.0_f64.copysign(determinant);
    (along_u, determinant > 0.0)
}

/// Angle between two edges \[rad]; 0 if one has no length.
fn angle(a: Vec3<f64>, b: Vec3<f64>) -> f64 {
    let lengths = a.length() * b.length();
    if lengths > 0.0 {
        Real::acos(a.dot(b) / lengths)
    } else {
        0.0
    }
}

/// Appends a copy of a vertex with all its attributes, and returns its index.
fn copy_vertex(mesh: &mut TriangleMesh, vertex: usize) -> u32 {
    fn again<T: Copy>(list: &mut Vec<T>, vertex: usize) {
        if let Some(&value) = list.get(vertex) {
            list.push(value);
        }
    }
    let index = mesh.positions.len() as u32;
    again(&mut mesh.positions, vertex);
    again(&mut mesh.normals, vertex);
    again(&mut mesh.uvs, vertex);
    again(&mut mesh.uvs1, vertex);
    again(&mut mesh.colours, vertex);
    index
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit square in the xy plane, facing +z, with the picture upright on it: u along +x, v along −y.
    fn square() -> TriangleMesh {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        TriangleMesh {
            positions: corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
            normals: vec![Vec3::new(0.0, 0.0, 1.0); 4],
            uvs: corners.map(|[x, y]| [x, 1.0 - y]).to_vec(),
            indices: vec![[0, 1, 2], [0, 2, 3]],
            ..TriangleMesh::default()
        }
    }

    #[test]
    fn an_upright_picture_has_its_tangent_along_x_and_bitangent_along_y() {
        let mut mesh = square();
        derive(&mut mesh, 0);
        assert_eq!(mesh.positions.len(), 4);
        for t in &mesh.tangents {
            // w (n × t) = z × x = +y: up in the picture.
            assert_eq!(*t, [1.0, 0.0, 0.0, 1.0]);
        }
    }

    #[test]
    fn a_mirrored_picture_has_the_other_sign() {
        let mut mesh = square();
        for uv in &mut mesh.uvs {
            uv[0] = 1.0 - uv[0];
        }
        derive(&mut mesh, 0);
        for t in &mesh.tangents {
            // u along −x; the bitangent stays up: −(z × −x) = +y.
            assert_eq!(*t, [-1.0, 0.0, 0.0, -1.0]);
        }
    }

    /// Two squares that mirror the picture at x = 1 share two vertices: these are split and the tangents stay ±x.
    #[test]
    fn a_mirror_seam_is_split() {
        let mut mesh = square();
        mesh.positions
            .extend([Vec3::new(2.0, 0.0, 0.0), Vec3::new(2.0, 1.0, 0.0)]);
        mesh.normals.extend([Vec3::new(0.0, 0.0, 1.0); 2]);
        mesh.uvs.extend([[0.0, 1.0], [0.0, 0.0]]);
        mesh.indices.extend([[1, 4, 5], [1, 5, 2]]);
        derive(&mut mesh, 0);
        assert_eq!(mesh.positions.len(), 8);
        assert_eq!(mesh.uvs.len(), 8);
        mesh.check().unwrap();
        for (k, corners) in mesh.indices.iter().enumerate() {
            let expected = if k < 2 {
                [1.0, 0.0, 0.0, 1.0]
            } else {
                [-1.0, 0.0, 0.0, -1.0]
            };
            for &c in corners {
                assert_eq!(mesh.tangents[c as usize], expected);
            }
        }
    }

    #[test]
    fn degenerate_textures_and_triangles_give_zero_not_nan() {
        let mut mesh = square();
        mesh.uvs = vec![[0.5, 0.5]; 4];
        mesh.indices.push([1, 1, 2]);
        derive(&mut mesh, 0);
        assert!(mesh.tangents.iter().flatten().all(|x| x.is_finite()));
        let mut bare = square();
        derive(&mut bare, 1);
        assert!(
            bare.tangents.is_empty(),
            "no second texture coordinates, no tangents"
        );
    }
}
