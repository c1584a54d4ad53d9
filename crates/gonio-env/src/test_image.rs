//! The labelled six-axis test image: which way an environment is turned, flipped or mirrored shows at a glance.
//!
//! The six faces of the cube around the viewer have the colours red (+x), cyan (−x), green (+y), magenta (−y), blue (+z)
//! and yellow (−z), and each is labelled with its axis in black letters that read correctly from inside, upright when
//! one looks along it: for the faces above and below, when one came from looking forward (−z). Every channel is 0 or 1,
//! so that any picture format stores the image exactly.

use crate::{Convention, Layout, View};
use gonio_image::Image;
use gonio_num::Vec3;

/// A face of the cube around the viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Face {
    /// What its label says.
    pub label: &'static str,
    /// Where its centre is: the axis.
    pub forward: Vec3<f64>,
    /// Upwards on the face.
    pub up: Vec3<f64>,
    /// Its colour, linear RGB.
    pub colour: [f32; 3],
}

impl Face {
    /// To the right on the face as seen from inside: forward × up.
    pub fn right(&self) -> Vec3<f64> {
        self.forward.cross(self.up)
    }
}

const fn face(label: &'static str, forward: [f64; 3], up: [f64; 3], colour: [f32; 3]) -> Face {
    let [x, y, z] = forward;
    let forward = Vec3::new(x, y, z);
    let [x, y, z] = up;
    Face {
        label,
        forward,
        up: Vec3::new(x, y, z),
        colour,
    }
}

/// The faces, in the order +x, −x, +y, −y, +z, −z.
pub const FACES: [Face; 6] = [
    face("+X", [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]),
    face("-X", [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0]),
    face("+Y", [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
    face("-Y", [0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 1.0]),
    face("+Z", [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
    face("-Z", [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]),
];

/// Columns of a label: two letters of five and a gap.
pub const LABEL_WIDTH: usize = 11;
/// Rows of a label.
pub const LABEL_HEIGHT: usize = 7;
/// Side of a dot of a label on a face that reaches from −1 to 1.
pub const DOT: f64 = 0.1;

/// Rows of five dots from the top; the highest of five bits is on the left.
fn glyph(letter: char) -> [u8; LABEL_HEIGHT] {
    match letter {
        '+' => [0, 0b00100, 0b00100, 0b11111, 0b00100, 0b00100, 0],
        '-' => [0, 0, 0, 0b11111, 0, 0, 0],
        'X' => [
            0b10001, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001, 0b10001,
        ],
        'Y' => [
            0b10001, 0b10001, 0b01010, 0b00100, 0b00100, 0b00100, 0b00100,
        ],
        'Z' => [
            0b11111, 0b00001, 0b00010, 0b00100, 0b01000, 0b10000, 0b11111,
        ],
        _ => [0; LABEL_HEIGHT],
    }
}

/// Whether the label has a dot in `column` (from the left) and `row` (from the top).
pub fn label_dot(label: &str, column: usize, row: usize) -> bool {
    if column >= LABEL_WIDTH || row >= LABEL_HEIGHT || column % 6 == 5 {
        return false;
    }
    let letter = label.chars().nth(column / 6).unwrap_or(' ');
    glyph(letter)[row] & (0b10000 >> (column % 6)) != 0
}

/// The face that a direction meets.
pub fn face_of(d: Vec3<f64>) -> &'static Face {
    let mut best = &FACES[0];
    for face in &FACES[1..] {
        if face.forward.dot(d) > best.forward.dot(d) {
            best = face;
        }
    }
    best
}

/// Radiance of the test environment from direction `d` (any length but zero).
pub fn radiance(d: Vec3<f64>) -> [f32; 3] {
    let face = face_of(d);
    let depth = face.forward.dot(d);
    let x = face.right().dot(d) / depth;
    let y = face.up.dot(d) / depth;
    let column = (x / DOT + 0.5 * LABEL_WIDTH as f64).floor();
    let row = (0.5 * LABEL_HEIGHT as f64 - y / DOT).floor();
    let dot = column >= 0.0 && row >= 0.0 && label_dot(face.label, column as usize, row as usize);
    if dot { [0.0; 3] } else { face.colour }
}

/// The test environment as a picture: `size` rows, or `size` rows of each face of a cube; black where the layout shows
/// nothing. Labels are legible from about 128 rows.
pub fn six_axes(layout: Layout, size: usize) -> Image {
    six_axes_of(&View::new(layout, Convention::Gonio), size)
}

/// [`six_axes`] as a convention turns it.
pub fn six_axes_of(view: &View, size: usize) -> Image {
    let layout = view.layout();
    let [width, height] = layout.shape().map(|n| n * size);
    Image::from_fn(width, height, |x, y| {
        let uv = [
            (x as f64 + 0.5) / width as f64,
            (y as f64 + 0.5) / height as f64,
        ];
        if layout.contains(uv) {
            radiance(view.direction(uv))
        } else {
            [0.0; 3]
        }
    })
}
