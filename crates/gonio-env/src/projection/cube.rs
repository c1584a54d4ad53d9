//! The cube: six faces, each a central projection, laid out on one picture.
//!
//! A face shows the directions that meet it: with s to the right and t downwards, both in [−1, 1],
//!
//! ```text
//! d ∝ forward + s · right + t · down,   dω / (ds dt) = (1 + s² + t²)^(−3/2)
//! ```
//!
//! | [`Arrangement`] | picture | where the faces stand |
//! |---|---|---|
//! | `CROSS` | 4 : 3 | left, front, right, back in the middle row; above and below the front the other two |
//! | `CROSS_VERTICAL` | 3 : 4 | left, front, right in the second row; the back below, turned by 180° |
//! | `STRIP` | 6 : 1 | in their order from the left |
//! | `STRIP_VERTICAL` | 1 : 6 | in their order from the top |
//!
//! Which axis a face looks along, and which way its picture runs, is its [`Faces`]. Source: Greene 1986, "Environment
//! Mapping and Other Applications of World Projections".

use gonio_num::{Real, Vec3};

/// A face of a cube: three axes at right angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Face {
    /// Towards the middle of the face.
    pub forward: Vec3<f64>,
    /// Where columns grow.
    pub right: Vec3<f64>,
    /// Where rows grow.
    pub down: Vec3<f64>,
}

/// The faces in their order, and which of them are in the middle of a cross and at its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Faces {
    /// In the order of a strip, of separate files, and of KTX2 and DDS.
    pub faces: [Face; 6],
    /// The one in the middle of a cross: 4 or 5; the back is the other.
    pub front: usize,
}

const fn face(forward: [i8; 3], right: [i8; 3], down: [i8; 3]) -> Face {
    const fn vector(a: [i8; 3]) -> Vec3<f64> {
        Vec3::new(a[0] as f64, a[1] as f64, a[2] as f64)
    }
    Face {
        forward: vector(forward),
        right: vector(right),
        down: vector(down),
    }
}

/// Faces that read unmirrored from inside, +x, −x, +y, −y, +z, −z, upright for who looks forward along −z; the faces above
/// and below as they come in sight from there.
pub const INSIDE: Faces = Faces {
    faces: [
        face([1, 0, 0], [0, 0, 1], [0, -1, 0]),
        face([-1, 0, 0], [0, 0, -1], [0, -1, 0]),
        face([0, 1, 0], [1, 0, 0], [0, 0, -1]),
        face([0, -1, 0], [1, 0, 0], [0, 0, 1]),
        face([0, 0, 1], [-1, 0, 0], [0, -1, 0]),
        face([0, 0, -1], [1, 0, 0], [0, -1, 0]),
    ],
    front: 5,
};

/// The faces that OpenGL, Vulkan and Direct3D look up, in the same order: a left-handed world with +y up, +z in front. In
/// a right-handed world they are mirror images. Source: OpenGL 4.6 core specification, table 8.19.
pub const LOOKED_UP: Faces = Faces {
    faces: [
        face([1, 0, 0], [0, 0, -1], [0, -1, 0]),
        face([-1, 0, 0], [0, 0, 1], [0, -1, 0]),
        face([0, 1, 0], [1, 0, 0], [0, 0, 1]),
        face([0, -1, 0], [1, 0, 0], [0, 0, -1]),
        face([0, 0, 1], [1, 0, 0], [0, -1, 0]),
        face([0, 0, -1], [-1, 0, 0], [0, -1, 0]),
    ],
    front: 4,
};

/// Where a face of a [`Faces`] stands: column and row in units of a face, and whether it is turned by 180°.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cell {
    /// From the left.
    pub column: usize,
    /// From the top.
    pub row: usize,
    /// Turned by 180°.
    pub turned: bool,
}

/// How six faces stand on a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Arrangement {
    /// Columns of faces.
    pub columns: usize,
    /// Rows of faces.
    pub rows: usize,
    /// For the faces +x, −x, +y, −y, front, back.
    cells: [Cell; 6],
}

const fn cell(column: usize, row: usize) -> Cell {
    Cell {
        column,
        row,
        turned: false,
    }
}

impl Arrangement {
    /// A cross that lies: 4 × 3 faces.
    pub const CROSS: Self = Self {
        columns: 4,
        rows: 3,
        cells: [
            cell(2, 1),
            cell(0, 1),
            cell(1, 0),
            cell(1, 2),
            cell(1, 1),
            cell(3, 1),
        ],
    };
    /// A cross that stands: 3 × 4 faces.
    pub const CROSS_VERTICAL: Self = Self {
        columns: 3,
        rows: 4,
        cells: [
            cell(2, 1),
            cell(0, 1),
            cell(1, 0),
            cell(1, 2),
            cell(1, 1),
            Cell {
                column: 1,
                row: 3,
                turned: true,
            },
        ],
    };
    /// 6 × 1 faces.
    pub const STRIP: Self = Self {
        columns: 6,
        rows: 1,
        cells: [
            cell(0, 0),
            cell(1, 0),
            cell(2, 0),
            cell(3, 0),
            cell(4, 0),
            cell(5, 0),
        ],
    };
    /// 1 × 6 faces.
    pub const STRIP_VERTICAL: Self = Self {
        columns: 1,
        rows: 6,
        cells: [
            cell(0, 0),
            cell(0, 1),
            cell(0, 2),
            cell(0, 3),
            cell(0, 4),
            cell(0, 5),
        ],
    };

    /// Where face `k` of `faces` stands.
    pub fn cell(&self, faces: &Faces, k: usize) -> Cell {
        // A strip keeps the order of the faces; in a cross the front is in the middle.
        let crossed = self.columns.min(self.rows) > 1 && faces.front == 5;
        match k {
            4 | 5 if crossed => self.cells[9 - k],
            _ => self.cells[k],
        }
    }
}

/// Right and down, in [−1, 1] within the cell, of picture coordinates.
#[inline(always)]
fn within<R: Real>(uv: [R; 2], arrangement: &Arrangement, cell: Cell) -> [R; 2] {
    let two = R::lit(2.0);
    let place = |c: R, count: usize, at: usize| {
        two * (c * R::lit(count as f64) - R::lit(at as f64)) - R::one()
    };
    let s = place(uv[0], arrangement.columns, cell.column);
    let t = place(uv[1], arrangement.rows, cell.row);
    if cell.turned {
        [R::zero() - s, R::zero() - t]
    } else {
        [s, t]
    }
}

#[inline(always)]
fn inside<R: Real>([s, t]: [R; 2]) -> R::Mask {
    s.abs().le(R::one()) & t.abs().le(R::one())
}

#[inline(always)]
fn vector<R: Real>(v: Vec3<f64>) -> Vec3<R> {
    Vec3::new(R::lit(v.x), R::lit(v.y), R::lit(v.z))
}

/// The unit direction shown at (u, v). Where no face stands it is the front of the faces' order.
#[inline(always)]
pub fn direction<R: Real>(uv: [R; 2], arrangement: &Arrangement, faces: &Faces) -> Vec3<R> {
    let mut d = vector::<R>(faces.faces[5].forward);
    for (k, face) in faces.faces.iter().enumerate() {
        let [s, t] = within(uv, arrangement, arrangement.cell(faces, k));
        let on_face =
            vector::<R>(face.forward) + vector::<R>(face.right) * s + vector::<R>(face.down) * t;
        let here = inside([s, t]);
        d = Vec3::new(
            R::select(here, on_face.x, d.x),
            R::select(here, on_face.y, d.y),
            R::select(here, on_face.z, d.z),
        );
    }
    d * d.dot(d).sqrt().recip()
}

/// Where the direction `d` is shown: at least 2e-6 of a face away from its edges.
#[inline(always)]
pub fn uv<R: Real>(d: Vec3<R>, arrangement: &Arrangement, faces: &Faces) -> [R; 2] {
    let half = R::lit(0.5);
    let mut best = R::zero();
    let mut uv = [half, half];
    for (k, face) in faces.faces.iter().enumerate() {
        let depth = d.dot(vector(face.forward));
        let nearer = depth.gt(best);
        best = R::select(nearer, depth, best);
        let over = depth.max(R::lit(1e-30)).recip();
        let cell = arrangement.cell(faces, k);
        let sign = R::lit(if cell.turned { -0.5 } else { 0.5 });
        // Not quite to the edge, where in single precision the next cell could begin.
        let most = R::lit(0.5 - 2e-6);
        let s = (d.dot(vector(face.right)) * over * sign)
            .max(R::zero() - most)
            .min(most)
            + half;
        let t = (d.dot(vector(face.down)) * over * sign)
            .max(R::zero() - most)
            .min(most)
            + half;
        let u = (s + R::lit(cell.column as f64)) * R::lit(1.0 / arrangement.columns as f64);
        let v = (t + R::lit(cell.row as f64)) * R::lit(1.0 / arrangement.rows as f64);
        uv = [R::select(nearer, u, uv[0]), R::select(nearer, v, uv[1])];
    }
    uv
}

/// dω / (du dv) \[sr]: 4 · columns · rows · (1 + s² + t²)^(−3/2) on a face, 0 elsewhere.
#[inline(always)]
pub fn jacobian<R: Real>(uv: [R; 2], arrangement: &Arrangement) -> R {
    let scale = R::lit(4.0 * (arrangement.columns * arrangement.rows) as f64);
    let mut j = R::zero();
    for cell in arrangement.cells {
        let [s, t] = within(uv, arrangement, cell);
        let q = R::one() + s * s + t * t;
        j = R::select(inside([s, t]), scale / (q * q.sqrt()), j);
    }
    j
}

/// Whether a face stands at (u, v).
#[inline(always)]
pub fn contains<R: Real>(uv: [R; 2], arrangement: &Arrangement) -> R::Mask {
    let [first, others @ ..] = arrangement.cells;
    let mut any = inside(within(uv, arrangement, first));
    for cell in others {
        any = any | inside(within(uv, arrangement, cell));
    }
    any
}
