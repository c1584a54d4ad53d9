//! The body: values, one element after the other.

use super::Fault;
use super::header::{Element, Encoding, Header, Scalar};
use crate::mesh::TriangleMesh;
use gonio_num::{Real, Vec3};

/// Where the reading stands.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
}

/// Why a value couldn't be read.
enum Bad {
    End,
    Word(String),
}

impl Cursor<'_> {
    fn number(&mut self, scalar: Scalar) -> Result<f64, Bad> {
        if self.encoding == Encoding::Ascii {
            return self.word();
        }
        let size = scalar.bytes();
        let raw = self.bytes.get(self.at..self.at + size).ok_or(Bad::End)?;
        self.at += size;
        let mut b = [0u8; 8];
        b[..size].copy_from_slice(raw);
        if self.encoding == Encoding::BigEndian {
            b[..size].reverse();
        }
        let [b0, b1, b2, b3, ..] = b;
        Ok(match scalar {
            Scalar::I8 => f64::from(b0 as i8),
            Scalar::U8 => f64::from(b0),
            Scalar::I16 => f64::from(i16::from_le_bytes([b0, b1])),
            Scalar::U16 => f64::from(u16::from_le_bytes([b0, b1])),
            Scalar::I32 => f64::from(i32::from_le_bytes([b0, b1, b2, b3])),
            Scalar::U32 => f64::from(u32::from_le_bytes([b0, b1, b2, b3])),
            Scalar::F32 => f64::from(f32::from_le_bytes([b0, b1, b2, b3])),
            Scalar::F64 => f64::from_le_bytes(b),
        })
    }

    fn word(&mut self) -> Result<f64, Bad> {
        let rest = &self.bytes[self.at..];
        let start = rest
            .iter()
            .position(|b| !b.is_ascii_whitespace())
            .ok_or(Bad::End)?;
        let length = rest[start..]
            .iter()
            .position(u8::is_ascii_whitespace)
            .unwrap_or(rest.len() - start);
        let word = &rest[start..start + length];
        self.at += start + length;
        std::str::from_utf8(word)
            .ok()
            .and_then(|w| w.parse().ok())
            .ok_or_else(|| Bad::Word(String::from_utf8_lossy(&word[..length.min(24)]).into()))
    }

    /// Where the reading stands, for people.
    fn place(&self) -> String {
        if self.encoding == Encoding::Ascii {
            let lines = self.bytes[..self.at]
                .iter()
                .filter(|&&b| b == b'\n')
                .count();
            format!("line {}", lines + 1)
        } else {
            format!("byte {}", self.at)
        }
    }

    fn fault(&self, element: &Element, index: u64, property: &str, bad: Bad) -> Fault {
        let place = format!("{} {index}, {property} ({})", element.name, self.place());
        match bad {
            Bad::End => Fault::new(
                place,
                "the end of the file",
                format!("{} elements `{}`", element.count, element.name),
            ),
            Bad::Word(word) => Fault::new(place, format!("{word:?}"), "a number"),
        }
    }

    /// How many numbers a list holds: a whole number that the rest of the file has room for.
    fn list_count(&mut self, count: Scalar, scalar: Scalar) -> Result<usize, Bad> {
        let n = self.number(count)?;
        if n < 0.0 || n.fract() != 0.0 {
            return Err(Bad::Word(format!("a list of {n} values")));
        }
        let each = if self.encoding == Encoding::Ascii {
            2
        } else {
            scalar.bytes()
        };
        // The last number of an ascii file needs no separator.
        let room = (self.bytes.len() - self.at + 1) / each;
        if n > room as f64 {
            return Err(Bad::End);
        }
        Ok(n as usize)
    }
}

/// Reads the body of `bytes` from offset `at` on.
pub(super) fn parse(header: &Header, bytes: &[u8], at: usize) -> Result<TriangleMesh, Fault> {
    let mut cursor = Cursor {
        bytes,
        at,
        encoding: header.encoding,
    };
    let mut mesh = TriangleMesh::default();
    for name in ["vertex", "face"] {
        if !header.elements.iter().any(|e| e.name == name) {
            return Err(Fault::new(
                "the header",
                format!("no element `{name}`"),
                "elements `vertex` and `face`",
            ));
        }
    }
    for element in &header.elements {
        let least = element.least_bytes(header.encoding);
        // The last number of an ascii file needs no separator.
        let room = (bytes.len() - cursor.at) as u64 + 1;
        if element.count.saturating_mul(least) > room || element.count > u64::from(u32::MAX) {
            return Err(Fault::new(
                format!("the header, element `{}`", element.name),
                format!("{} elements in the {} bytes left", element.count, room - 1),
                format!("at least {least} bytes for each"),
            ));
        }
        if least == 0 {
            continue;
        }
        match element.name.as_str() {
            "vertex" => vertices(&mut cursor, element, &mut mesh)?,
            "face" => faces(&mut cursor, element, &mut mesh)?,
            _ => {
                for i in 0..element.count {
                    for p in &element.properties {
                        skip(&mut cursor, p.list, p.scalar)
                            .map_err(|bad| cursor.fault(element, i, &p.name, bad))?;
                    }
                }
            }
        }
    }
    Ok(mesh)
}

fn skip(cursor: &mut Cursor, list: Option<Scalar>, scalar: Scalar) -> Result<(), Bad> {
    let n = match list {
        Some(count) => cursor.list_count(count, scalar)?,
        None => 1,
    };
    for _ in 0..n {
        cursor.number(scalar)?;
    }
    Ok(())
}

/// What a vertex property is: its place among these.
const SLOTS: [&[&str]; 12] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx"],
    &["ny"],
    &["nz"],
    &["u", "s", "texture_u"],
    &["v", "t", "texture_v"],
    &["red", "r", "diffuse_red"],
    &["green", "g", "diffuse_green"],
    &["blue", "b", "diffuse_blue"],
    &["alpha", "a"],
];

fn vertices(cursor: &mut Cursor, element: &Element, mesh: &mut TriangleMesh) -> Result<(), Fault> {
    let mut present = [false; SLOTS.len()];
    let mut full = [1.0; SLOTS.len()];
    let slots: Vec<Option<usize>> = element
        .properties
        .iter()
        .map(|p| {
            let slot = SLOTS.iter().position(|names| names.contains(&&*p.name));
            let slot = slot.filter(|&s| p.list.is_none() && !present[s]);
            if let Some(s) = slot {
                present[s] = true;
                full[s] = p.scalar.full();
            }
            slot
        })
        .collect();
    let all = |range: std::ops::Range<usize>| present[range].iter().all(|&p| p);
    if !all(0..3) {
        return Err(Fault::new(
            "the header, element `vertex`",
            "no x, y and z",
            "properties x, y and z",
        ));
    }
    let (normals, uvs, colours) = (all(3..6), all(6..8), all(8..11));
    let count = element.count as usize;
    mesh.positions.reserve(count);
    let mut values = [0.0f64; SLOTS.len()];
    values[11] = full[11];
    for i in 0..element.count {
        for (p, slot) in element.properties.iter().zip(&slots) {
            match slot {
                Some(s) => match cursor.number(p.scalar) {
                    Ok(x) => values[*s] = x,
                    Err(bad) => return Err(cursor.fault(element, i, &p.name, bad)),
                },
                None => skip(cursor, p.list, p.scalar)
                    .map_err(|bad| cursor.fault(element, i, &p.name, bad))?,
            }
        }
        let f = values.map(|x| x as f32);
        mesh.positions.push(Vec3::new(f[0], f[1], f[2]));
        if normals {
            mesh.normals.push(Vec3::new(f[3], f[4], f[5]));
        }
        if uvs {
            mesh.uvs.push([f[6], 1.0 - f[7]]);
        }
        if colours {
            let channel = |s: usize| linear(values[s], full[s]);
            let alpha = (values[11] / full[11]) as f32;
            mesh.colours
                .push([channel(8), channel(9), channel(10), alpha]);
        }
    }
    Ok(())
}

/// A colour channel as a linear value: whole numbers (full ≠ 1) are decoded by the sRGB transfer function, IEC 61966-2-1.
fn linear(value: f64, full: f64) -> f32 {
    let x = value / full;
    let decoded = if full == 1.0 {
        x
    } else if x <= 0.04045 {
        x / 12.92
    } else {
        Real::powf((x + 0.055) / 1.055, 2.4)
    };
    decoded as f32
}

fn faces(cursor: &mut Cursor, element: &Element, mesh: &mut TriangleMesh) -> Result<(), Fault> {
    let named = |name: &str| name == "vertex_indices" || name == "vertex_index";
    if !element
        .properties
        .iter()
        .any(|p| named(&p.name) && p.list.is_some() && !p.scalar.is_float())
    {
        return Err(Fault::new(
            "the header, element `face`",
            "no list of vertex indices",
            "property list … vertex_indices",
        ));
    }
    mesh.indices.reserve(element.count as usize);
    for i in 0..element.count {
        for p in &element.properties {
            let (Some(count), true) = (p.list, named(&p.name)) else {
                skip(cursor, p.list, p.scalar)
                    .map_err(|bad| cursor.fault(element, i, &p.name, bad))?;
                continue;
            };
            let n = cursor
                .list_count(count, p.scalar)
                .map_err(|bad| cursor.fault(element, i, &p.name, bad))?;
            if n < 3 {
                return Err(Fault::new(
                    format!("face {i} ({})", cursor.place()),
                    format!("a polygon of {n} corners"),
                    "at least 3 corners",
                ));
            }
            let (mut first, mut previous) = (0, 0);
            for k in 0..n {
                let x = cursor
                    .number(p.scalar)
                    .map_err(|bad| cursor.fault(element, i, &p.name, bad))?;
                if !(0.0..f64::from(u32::MAX)).contains(&x) || x.fract() != 0.0 {
                    return Err(Fault::new(
                        format!("face {i} ({})", cursor.place()),
                        format!("vertex index {x}"),
                        "a whole number from 0 up",
                    ));
                }
                let vertex = x as u32;
                match k {
                    0 => first = vertex,
                    1 => {}
                    _ => mesh.indices.push([first, previous, vertex]),
                }
                previous = vertex;
            }
        }
    }
    Ok(())
}
