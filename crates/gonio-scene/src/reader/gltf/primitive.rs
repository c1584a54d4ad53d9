//! A glTF primitive as a [`TriangleMesh`].

use super::accessor::Arrays;
use crate::reader::tangent;
use crate::{SceneError, TriangleMesh};
use gltf::json::{
    accessor::Type,
    mesh::{Mode, Primitive, Semantic},
    validation::Checked,
};

/// What became of a primitive.
pub(super) enum Read {
    /// Triangles.
    Mesh(TriangleMesh),
    /// Nothing to render: points, lines, or no triangle at all; in words.
    Skipped(String),
}

/// Reads a primitive.
///
/// - `tangents_for`: the set of texture coordinates that tangents follow, if the material has a normal map or is anisotropic and the
///   primitive must therefore have tangents
///
/// Without normals the triangles are flat, as glTF 2.0 section 3.7.2.1 asks.
///
/// # Errors
/// [`SceneError::Format`] for whatever contradicts glTF, with the accessor or the vertex.
pub(super) fn read(
    arrays: &Arrays,
    primitive: &Primitive,
    place: &str,
    tangents_for: Option<u8>,
) -> Result<Read, SceneError> {
    let mode = arrays.checked(&primitive.mode, place, "mode")?;
    if matches!(
        mode,
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip
    ) {
        return Ok(Read::Skipped(format!(
            "{place}: {mode:?} have no surface and are skipped"
        )));
    }
    let attribute = |semantic: Semantic| {
        let found = primitive.attributes.get(&Checked::Valid(semantic));
        found.map(|index| index.value())
    };
    let Some(positions) = attribute(Semantic::Positions) else {
        let found = "no POSITION";
        return Err(SceneError::format(
            arrays.path,
            place,
            found,
            "vertex positions",
        ));
    };
    let positions: Vec<[f32; 3]> = arrays.rows(positions, &[Type::Vec3], 0.0)?;
    let count = positions.len();
    // Optional attributes: as many as positions, or it is an error.
    let same_count = |name: &str, n: usize| {
        if n == count {
            return Ok(());
        }
        let found = format!("{n} {name} for {count} positions");
        Err(SceneError::format(arrays.path, place, found, "as many"))
    };
    let normals: Vec<[f32; 3]> = match attribute(Semantic::Normals) {
        Some(index) => arrays.rows(index, &[Type::Vec3], 0.0)?,
        None => Vec::new(),
    };
    let tangents: Vec<[f32; 4]> = match attribute(Semantic::Tangents) {
        Some(index) if !normals.is_empty() => arrays.rows(index, &[Type::Vec4], 1.0)?,
        _ => Vec::new(),
    };
    let mut uv_sets: [Vec<[f32; 2]>; 2] = Default::default();
    for (set, uvs) in uv_sets.iter_mut().enumerate() {
        if let Some(index) = attribute(Semantic::TexCoords(set as u32)) {
            *uvs = arrays.rows(index, &[Type::Vec2], 0.0)?;
            same_count("texture coordinates", uvs.len())?;
        }
    }
    let [uvs, uvs1] = uv_sets;
    let colours: Vec<[f32; 4]> = match attribute(Semantic::Colors(0)) {
        Some(index) => arrays.rows(index, &[Type::Vec3, Type::Vec4], 1.0)?,
        None => Vec::new(),
    };
    for (name, n) in [
        ("normals", normals.len()),
        ("tangents", tangents.len()),
        ("colours", colours.len()),
    ] {
        if n > 0 {
            same_count(name, n)?;
        }
    }
    let order = match primitive.indices {
        Some(index) => arrays.indices(index.value())?,
        None => (0..count as u32).collect(),
    };
    if let Some(at) = order.iter().position(|&i| i as usize >= count) {
        let place = format!("{place}, index {at}");
        let found = order[at].to_string();
        return Err(SceneError::format(
            arrays.path,
            place,
            found,
            format!("a vertex below {count}"),
        ));
    }
    let mut mesh = TriangleMesh {
        positions: positions.into_iter().map(Into::into).collect(),
        normals: normals.into_iter().map(Into::into).collect(),
        uvs,
        uvs1,
        tangents,
        colours,
        indices: triangles(mode, &order),
    };
    let summary = mesh.check().map_err(|e| named(e, arrays, place))?;
    if summary.triangles == summary.degenerate {
        return Ok(Read::Skipped(format!(
            "{place}: no triangle with an area, skipped"
        )));
    }
    if let (Some(set), true) = (tangents_for, mesh.tangents.is_empty()) {
        tangent::derive(&mut mesh, set);
    }
    Ok(Read::Mesh(mesh))
}

/// The error of a mesh with the file and the primitive in front.
fn named(error: SceneError, arrays: &Arrays, place: &str) -> SceneError {
    match error {
        SceneError::Mesh {
            place: vertex,
            found,
            expected,
        } => SceneError::format(arrays.path, format!("{place}, {vertex}"), found, expected),
        other => other,
    }
}

/// The triangles of a list, strip or fan, all with the winding of the first (glTF 2.0 section 3.7.2.1). An incomplete last
/// triangle is dropped.
fn triangles(mode: Mode, order: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => (0..order.len().saturating_sub(2))
            .map(|i| {
                let odd = i % 2;
                [order[i], order[i + 1 + odd], order[i + 2 - odd]]
            })
            .collect(),
        Mode::TriangleFan => (1..order.len().saturating_sub(1))
            .map(|i| [order[i], order[i + 1], order[0]])
            .collect(),
        _ => order.as_chunks::<3>().0.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_strips_and_fans() {
        let order = [4, 5, 6, 7, 8];
        assert_eq!(triangles(Mode::Triangles, &order), [[4, 5, 6]]);
        assert_eq!(
            triangles(Mode::TriangleStrip, &order),
            [[4, 5, 6], [5, 7, 6], [6, 7, 8]]
        );
        assert_eq!(
            triangles(Mode::TriangleFan, &order),
            [[5, 6, 4], [6, 7, 4], [7, 8, 4]]
        );
        for mode in [Mode::Triangles, Mode::TriangleStrip, Mode::TriangleFan] {
            assert!(triangles(mode, &order[..2]).is_empty());
            assert!(triangles(mode, &[]).is_empty());
        }
    }
}
