//! Wavefront OBJ.
//!
//! Our own reader rather than a library's, for two reasons: its errors name the line, and it reads each file in one pass
//! without building a second mesh.
//!
//! Read are `v` (with w ignored, or with a colour r g b), `vt`, `vn`, `f` (polygons of any size, taken as convex and cut into
//! a fan; indices from 1, or negative from the end), `o`, `g`, `usemtl` and `mtllib`. Lines, points, smoothing groups, curves
//! and surfaces are passed over. Texture coordinates are turned to v downwards; colours are taken as linear.

use super::TriangleMesh;
use crate::SceneError;
use gonio_num::Vec3;
use std::collections::HashMap;
use std::path::Path;

/// A run of faces under one object name, group name and material.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjPart {
    /// The name after `o`, else after `g`; empty if there is none.
    pub name: String,
    /// The name after `usemtl`, if any.
    pub material: Option<String>,
    /// Its faces, checked.
    pub mesh: TriangleMesh,
}

/// What an OBJ file holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ObjFile {
    /// The parts that have faces, in the order of their first face.
    pub parts: Vec<ObjPart>,
    /// The material libraries named, as written.
    pub libraries: Vec<String>,
}

impl ObjFile {
    /// All parts as one mesh.
    pub fn merged(&self) -> TriangleMesh {
        let mut all = TriangleMesh::default();
        for part in &self.parts {
            all.append(&part.mesh);
        }
        all
    }
}

/// Statements that don't concern surfaces made of polygons.
const PASSED_OVER: &[&str] = &[
    "s",
    "l",
    "p",
    "vp",
    "mg",
    "cstype",
    "deg",
    "bmat",
    "step",
    "curv",
    "curv2",
    "surf",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "maplib",
    "usemap",
    "call",
    "csh",
];

/// Reads an OBJ file.
///
/// # Errors
/// [`SceneError::Io`] if it can't be read; [`SceneError::Format`], with the line, if it can't be understood, holds a number
/// that isn't finite, an index that is out of range, or no face at all.
pub fn read(path: &Path) -> Result<ObjFile, SceneError> {
    let bytes = std::fs::read(path).map_err(|e| SceneError::io(path, e))?;
    parse(&bytes, path)
}

/// Reads an OBJ file that is in memory; `path` is for errors.
///
/// # Errors
/// As [`read`], but for input and output.
pub fn parse(bytes: &[u8], path: &Path) -> Result<ObjFile, SceneError> {
    let mut reader = Reader::default();
    let mut joined = String::new();
    let mut lines = bytes.split(|&b| b == b'\n').enumerate().peekable();
    while let Some((number, raw)) = lines.next() {
        let line = reader.text(raw, number + 1, path)?;
        // A backslash at the end of a line joins the next to it.
        if let Some(start) = line.strip_suffix('\\')
            && lines.peek().is_some()
        {
            joined.push_str(start);
            joined.push(' ');
            continue;
        }
        let fault = |(found, expected): Fault| {
            SceneError::format(path, format!("line {}", number + 1), found, expected)
        };
        if joined.is_empty() {
            reader.statement(line).map_err(fault)?;
        } else {
            joined.push_str(line);
            let whole = std::mem::take(&mut joined);
            reader.statement(&whole).map_err(fault)?;
        }
    }
    reader.finish(path)
}

/// What was found, and what was expected.
type Fault = (String, String);

#[derive(Default)]
struct Reader {
    positions: Vec<Vec3<f32>>,
    colours: Vec<[f32; 4]>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<Vec3<f32>>,
    object: String,
    group: String,
    material: Option<String>,
    parts: Vec<Building>,
    /// Part by name and material.
    known: HashMap<(String, Option<String>), usize>,
    /// The part that faces go to; none after a change of name or material.
    current: Option<usize>,
    libraries: Vec<String>,
}

/// A part that still grows: corners of a face that share all indices share a vertex.
struct Building {
    part: ObjPart,
    vertices: HashMap<[u32; 3], u32>,
}

/// The index of an attribute that a corner doesn't have.
const ABSENT: u32 = u32::MAX;

impl Reader {
    fn text<'a>(&self, raw: &'a [u8], number: usize, path: &Path) -> Result<&'a str, SceneError> {
        // Comments and names may be in any encoding; numbers can't be.
        let raw = match raw.iter().position(|&b| b == b'#') {
            Some(i) => &raw[..i],
            None => raw,
        };
        std::str::from_utf8(raw).map(str::trim).map_err(|_| {
            SceneError::format(
                path,
                format!("line {number}"),
                "bytes that are not UTF-8 text",
                "an OBJ statement",
            )
        })
    }

    fn statement(&mut self, line: &str) -> Result<(), Fault> {
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match keyword {
            "" => {}
            "v" => {
                let (n, a) = numbers::<7>(rest)?;
                if n < 3 || n == 5 || n == 7 {
                    return Err((
                        format!("{n} numbers"),
                        "v x y z [w] or v x y z r g b".into(),
                    ));
                }
                self.positions.push(Vec3::new(a[0], a[1], a[2]));
                if n == 6 {
                    self.colours.resize(self.positions.len() - 1, [1.0; 4]);
                    self.colours.push([a[3], a[4], a[5], 1.0]);
                }
            }
            "vt" => {
                let (n, a) = numbers::<3>(rest)?;
                if n < 1 {
                    return Err(("no number".into(), "vt u [v [w]]".into()));
                }
                self.uvs.push([a[0], 1.0 - a[1]]);
            }
            "vn" => {
                let (n, a) = numbers::<3>(rest)?;
                if n != 3 {
                    return Err((format!("{n} numbers"), "vn x y z".into()));
                }
                self.normals.push(Vec3::new(a[0], a[1], a[2]));
            }
            "f" | "fo" => self.face(rest)?,
            "o" => {
                self.object = rest.trim().to_owned();
                self.current = None;
            }
            "g" => {
                self.group = rest.trim().to_owned();
                self.current = None;
            }
            "usemtl" => {
                let name = rest.trim();
                self.material = (!name.is_empty()).then(|| name.to_owned());
                self.current = None;
            }
            "mtllib" => self.libraries.push(rest.trim().to_owned()),
            other if PASSED_OVER.contains(&other) => {}
            other => {
                let shown: String = other.chars().take(24).collect();
                return Err((
                    format!("{shown:?}"),
                    "an OBJ statement (v, vt, vn, f, …)".into(),
                ));
            }
        }
        Ok(())
    }

    fn face(&mut self, rest: &str) -> Result<(), Fault> {
        let at = self.part();
        let mut corners = 0;
        let (mut first, mut previous) = (0, 0);
        for word in rest.split_whitespace() {
            let key = self.corner(word)?;
            let building = &mut self.parts[at];
            let mesh = &mut building.part.mesh;
            let vertex = match building.vertices.get(&key) {
                Some(&v) => v,
                None => {
                    let v = mesh.positions.len() as u32;
                    mesh.positions.push(self.positions[key[0] as usize]);
                    // An attribute that starts late is filled up with its neutral value, and so is one that a corner lacks.
                    let before = v as usize;
                    if let Some(uv) = self.uvs.get(key[1] as usize) {
                        mesh.uvs.resize(before, [0.0; 2]);
                        mesh.uvs.push(*uv);
                    }
                    if let Some(n) = self.normals.get(key[2] as usize) {
                        mesh.normals.resize(before, Vec3::zero());
                        mesh.normals.push(*n);
                    }
                    if let Some(c) = self.colours.get(key[0] as usize) {
                        mesh.colours.resize(before, [1.0; 4]);
                        mesh.colours.push(*c);
                    }
                    building.vertices.insert(key, v);
                    v
                }
            };
            match corners {
                0 => first = vertex,
                1 => {}
                _ => mesh.indices.push([first, previous, vertex]),
            }
            previous = vertex;
            corners += 1;
        }
        if corners < 3 {
            return Err((
                format!("a face of {corners} corners"),
                "at least 3 corners".into(),
            ));
        }
        Ok(())
    }

    /// The part that faces go to now.
    fn part(&mut self) -> usize {
        if let Some(i) = self.current {
            return i;
        }
        let name = match (self.object.as_str(), self.group.as_str()) {
            (object, "") => object.to_owned(),
            ("", group) => group.to_owned(),
            (object, group) => format!("{object}/{group}"),
        };
        let parts = &mut self.parts;
        let i = *self
            .known
            .entry((name.clone(), self.material.clone()))
            .or_insert_with(|| {
                parts.push(Building {
                    part: ObjPart {
                        name,
                        material: self.material.clone(),
                        mesh: TriangleMesh::default(),
                    },
                    vertices: HashMap::new(),
                });
                parts.len() - 1
            });
        self.current = Some(i);
        i
    }

    /// Indices from 0 of `v`, `v/t`, `v//n` or `v/t/n`.
    fn corner(&self, word: &str) -> Result<[u32; 3], Fault> {
        let lists = [
            ("v", self.positions.len()),
            ("vt", self.uvs.len()),
            ("vn", self.normals.len()),
        ];
        let shape = || {
            (
                format!("{word:?}"),
                "a corner: v, v/vt, v//vn or v/vt/vn".to_owned(),
            )
        };
        let mut key = [ABSENT; 3];
        for (k, text) in word.split('/').enumerate() {
            let &(name, count) = lists.get(k).ok_or_else(shape)?;
            if text.is_empty() && k > 0 {
                continue;
            }
            let i: i64 = text.parse().map_err(|_| shape())?;
            let from_zero = if i > 0 { i - 1 } else { count as i64 + i };
            if i == 0 || from_zero < 0 || from_zero >= (count as i64).min(i64::from(ABSENT)) {
                let range = match count {
                    0 => format!("no {name} index: no `{name}` precedes it"),
                    _ => format!("1 to {count} or −{count} to −1: {count} `{name}` precede it"),
                };
                return Err((format!("{name} index {i}"), range));
            }
            key[k] = from_zero as u32;
        }
        Ok(key)
    }

    fn finish(self, path: &Path) -> Result<ObjFile, SceneError> {
        let mut file = ObjFile {
            parts: Vec::with_capacity(self.parts.len()),
            libraries: self.libraries,
        };
        for Building { mut part, .. } in self.parts {
            let mesh = &mut part.mesh;
            let count = mesh.positions.len();
            if !mesh.uvs.is_empty() {
                mesh.uvs.resize(count, [0.0; 2]);
            }
            if !mesh.normals.is_empty() {
                mesh.normals.resize(count, Vec3::zero());
            }
            if !mesh.colours.is_empty() {
                mesh.colours.resize(count, [1.0; 4]);
            }
            mesh.check().map_err(|e| e.in_file(path))?;
            file.parts.push(part);
        }
        if file.parts.is_empty() {
            return Err(SceneError::format(
                path,
                "the whole file",
                "no face",
                "at least one `f` statement",
            ));
        }
        Ok(file)
    }
}

/// Up to N finite numbers, and how many there are.
fn numbers<const N: usize>(rest: &str) -> Result<(usize, [f32; N]), Fault> {
    let mut out = [0.0; N];
    let mut n = 0;
    for word in rest.split_whitespace() {
        let Some(slot) = out.get_mut(n) else {
            return Err((
                "more numbers than that".into(),
                format!("at most {N} numbers"),
            ));
        };
        *slot = match word.parse::<f32>() {
            Ok(x) if x.is_finite() => x,
            _ => {
                let shown: String = word.chars().take(24).collect();
                return Err((format!("{shown:?}"), "a finite number".into()));
            }
        };
        n += 1;
    }
    Ok((n, out))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good(text: &str) -> ObjFile {
        parse(text.as_bytes(), Path::new("a.obj")).unwrap()
    }

    fn bad(text: &str) -> String {
        parse(text.as_bytes(), Path::new("a.obj"))
            .unwrap_err()
            .to_string()
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn polygons_become_fans() {
        let f = good(&format!("{SQUARE}f 1 2 3 4\n"));
        assert_eq!(f.parts[0].mesh.indices, [[0, 1, 2], [0, 2, 3]]);
        assert!(f.parts[0].mesh.normals.is_empty() && f.parts[0].mesh.uvs.is_empty());
    }

    #[test]
    fn attributes_negative_indices_colours_and_joined_lines() {
        let f = good(
            "v 0 0 0 1 0 0\r\nv 1 0 0 0 1 0\r\nv 0 1 0 0 0 1 # blue\r\n\
             vt 0 0\nvt 1 0.25\nvn 0 0 1\nf -3/-2/-1 2/2/1 \\\n 3//1\n",
        );
        let m = &f.parts[0].mesh;
        assert_eq!(m.uvs, [[0.0, 1.0], [1.0, 0.75], [0.0, 0.0]]);
        assert_eq!(m.normals, [Vec3::new(0.0, 0.0, 1.0); 3]);
        assert_eq!(m.colours[2], [0.0, 0.0, 1.0, 1.0]);
    }

    #[test]
    fn corners_are_shared_only_with_all_their_attributes() {
        let f = good(&format!(
            "{SQUARE}vt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/1 3/2 4/1\n"
        ));
        assert_eq!(f.parts[0].mesh.positions.len(), 5);
    }

    #[test]
    fn parts_are_split_by_name_and_material_and_can_be_merged() {
        let f = good(&format!(
            "mtllib x.mtl\n{SQUARE}o floor\nusemtl red\nf 1 2 3\no wall\nf 1 3 4\nusemtl blue\nf 2 3 4\n\
             o floor\nusemtl red\nf 4 3 2\n"
        ));
        let names: Vec<_> = f
            .parts
            .iter()
            .map(|p| (p.name.as_str(), p.material.as_deref()))
            .collect();
        assert_eq!(
            names,
            [
                ("floor", Some("red")),
                ("wall", Some("red")),
                ("wall", Some("blue"))
            ]
        );
        assert_eq!(f.parts[0].mesh.indices.len(), 2);
        assert_eq!(f.libraries, ["x.mtl"]);
        let all = f.merged();
        assert_eq!(all.indices.len(), 4);
        all.check().unwrap();
    }

    #[test]
    fn faults_name_the_line_and_what_was_expected() {
        let cases = [
            (format!("{SQUARE}f 1 2 9\n"), "line 5", "v index 9"),
            (format!("{SQUARE}f 1 2 0\n"), "line 5", "v index 0"),
            (format!("{SQUARE}f 1 2 -5\n"), "line 5", "v index -5"),
            (format!("{SQUARE}f 1/1 2/1 3/1\n"), "line 5", "vt index 1"),
            (format!("{SQUARE}f 1 2\n"), "line 5", "2 corners"),
            (format!("{SQUARE}f 1 2 x\n"), "line 5", "\"x\""),
            (format!("{SQUARE}f 1///4 2 3\n"), "line 5", "1///4"),
            ("v 0 0 nan\nf 1 1 1\n".into(), "line 1", "a finite number"),
            ("v 0 0 1e99\n".into(), "line 1", "a finite number"),
            ("v 0 0\n".into(), "line 1", "2 numbers"),
            ("v 0 0 0 0 0 0 0 0\n".into(), "line 1", "at most 7"),
            ("<html>\n".into(), "line 1", "an OBJ statement"),
            (SQUARE.into(), "the whole file", "no face"),
            (String::new(), "the whole file", "no face"),
            ("v 1e20 0 0\nv 0 0 0\nf 1 2 2\n".into(), "vertex 0", "1e12"),
        ];
        for (text, place, what) in cases {
            let e = bad(&text);
            assert!(
                e.contains("a.obj") && e.contains(place) && e.contains(what),
                "{text:?} gave: {e}"
            );
        }
        let e = parse(b"v 0 0 \xff\n", Path::new("a.obj")).unwrap_err();
        assert!(e.to_string().contains("line 1"));
    }

    #[test]
    fn a_missing_file_is_named() {
        let e = read(Path::new("/nowhere/none.obj")).unwrap_err();
        assert!(e.to_string().contains("none.obj"));
    }
}
