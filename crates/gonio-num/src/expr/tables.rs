//! WGSL text of tables and their look-ups.

use crate::{Table1, Table2, Table3};
use std::fmt::Write;

/// Samples a line.
const COLUMNS: usize = 8;

fn samples(name: &str, data: &[f32]) -> String {
    let count = data.len();
    let mut text = format!("var<private> {name}: array<f32, {count}> = array<f32, {count}>(\n");
    for row in data.chunks(COLUMNS) {
        let row: Vec<String> = row.iter().map(|x| format!("{x:?}f")).collect();
        let _ = writeln!(text, "    {},", row.join(", "));
    }
    text.push_str(");\n");
    text
}

/// The samples and `fn NAME_at(x: f32) -> f32`, in the operations of [`Real::table1`](crate::Real::table1).
pub(super) fn table1(t: &Table1) -> String {
    let (name, last) = (t.name, t.data.len() - 1);
    format!(
        "{}
// Linear interpolation in {name}, x clamped to [0, 1].
fn {name}_at(x: f32) -> f32 {{
    let p = clamp(x, 0.0f, 1.0f) * {last}.0f;
    let i = min(u32(p), {}u);
    let w = p - f32(i);
    return {name}[i] * (1.0f - w) + {name}[i + 1u] * w;
}}
",
        samples(name, t.data),
        last - 1
    )
}

/// The samples and `fn NAME_at(x: f32, y: f32) -> f32`, in the operations of [`Real::table2`](crate::Real::table2).
pub(super) fn table2(t: &Table2) -> String {
    let (name, width) = (t.name, t.width);
    format!(
        "{}
// Bilinear interpolation in {name}, x and y clamped to [0, 1].
fn {name}_at(x: f32, y: f32) -> f32 {{
    let p = clamp(x, 0.0f, 1.0f) * {}.0f;
    let q = clamp(y, 0.0f, 1.0f) * {}.0f;
    let i = min(u32(p), {}u);
    let j = min(u32(q), {}u);
    let u = p - f32(i);
    let v = q - f32(j);
    let k = j * {width}u + i;
    let low = {name}[k] * (1.0f - u) + {name}[k + 1u] * u;
    let high = {name}[k + {width}u] * (1.0f - u) + {name}[k + {}u] * u;
    return low * (1.0f - v) + high * v;
}}
",
        samples(name, t.data),
        width - 1,
        t.height - 1,
        width - 2,
        t.height - 2,
        width + 1
    )
}

/// The samples and `fn NAME_at(x: f32, y: f32, z: f32) -> f32`, in the operations of
/// [`Real::table3`](crate::Real::table3).
pub(super) fn table3(t: &Table3) -> String {
    let (name, row, slice) = (t.name, t.width, t.width * t.height);
    let [x, y, z] = [t.width, t.height, t.depth].map(|n| n - 1);
    format!(
        "{}
// Trilinear interpolation in {name}, x, y and z clamped to [0, 1].
fn {name}_at(x: f32, y: f32, z: f32) -> f32 {{
    let p = clamp(x, 0.0f, 1.0f) * {x}.0f;
    let q = clamp(y, 0.0f, 1.0f) * {y}.0f;
    let r = clamp(z, 0.0f, 1.0f) * {z}.0f;
    let i = min(u32(p), {}u);
    let j = min(u32(q), {}u);
    let k = min(u32(r), {}u);
    let u = p - f32(i);
    let v = q - f32(j);
    let w = r - f32(k);
    var at = k * {slice}u + j * {row}u + i;
    var values = array<f32, 2>(0.0f, 0.0f);
    for (var s = 0; s < 2; s++) {{
        let low = {name}[at] * (1.0f - u) + {name}[at + 1u] * u;
        let high = {name}[at + {row}u] * (1.0f - u) + {name}[at + {}u] * u;
        values[s] = low * (1.0f - v) + high * v;
        at += {slice}u;
    }}
    return values[0] * (1.0f - w) + values[1] * w;
}}
",
        samples(name, t.data),
        x - 1,
        y - 1,
        z - 1,
        row + 1
    )
}
