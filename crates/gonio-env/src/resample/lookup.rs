//! A picture of any layout, interpolated across its seams.

use crate::Layout;
use crate::projection::{View, disc_from_uv};
use gonio_image::Image;
use gonio_num::Vec3;

/// Bilinear interpolation between texel centres. Taps beyond an edge are those of the face, or of the side, that lies
/// there: a cube and an octahedron have no seams. Beyond the first and last row of a lat-long panorama radiance is constant,
/// as it is when one renders with it; beyond the rim of a disc it is that of the rim.
pub(super) struct Lookup<'a> {
    image: &'a Image,
    view: &'a View,
    /// Columns and rows of a cell: of a face of a cube, of a half of the dual paraboloid, or of the picture.
    cell: [i64; 2],
}

impl<'a> Lookup<'a> {
    pub fn new(image: &'a Image, view: &'a View) -> Self {
        let [columns, rows] = match (view.layout().arrangement(), view.layout()) {
            (Some(a), _) => [a.columns, a.rows],
            (None, Layout::DualParaboloid) => [2, 1],
            _ => [1, 1],
        };
        Self {
            image,
            view,
            cell: [
                (image.width / columns).max(1) as i64,
                (image.height / rows).max(1) as i64,
            ],
        }
    }

    fn at(&self, x: i64, y: i64) -> [f32; 3] {
        let clamp = |c: i64, n: usize| c.clamp(0, n as i64 - 1) as usize;
        let (x, y) = (clamp(x, self.image.width), clamp(y, self.image.height));
        self.image.pixels[y * self.image.width + x]
    }

    /// The texel that holds (u, v); where its centre shows nothing, the one that shows what is there.
    pub fn nearest(&self, uv: [f32; 2]) -> [f32; 3] {
        let [x, y] = self.place(uv);
        let (x, y) = (x.floor() as i64, y.floor() as i64);
        match self.view.layout() {
            Layout::Angular | Layout::MirrorBall => self.at_rim(x, y),
            Layout::DualParaboloid => {
                let half = self.cell[0];
                self.on_discs(x, y, [x.div_euclid(half).clamp(0, 1) * half, 0])
            }
            _ => self.at(x, y),
        }
    }

    fn place(&self, uv: [f32; 2]) -> [f32; 2] {
        [
            uv[0] * self.image.width as f32,
            uv[1] * self.image.height as f32,
        ]
    }

    /// Radiance from the unit direction `d`.
    pub fn bilinear(&self, d: Vec3<f32>) -> [f32; 3] {
        let [x, y] = self.place(self.view.uv(d));
        // The cell that the point is in: its taps may be in others.
        let origin = |c: f32, size: i64, n: usize| {
            let last = n as i64 / size - 1;
            (c as i64 / size).clamp(0, last.max(0)) * size
        };
        let corner = [
            origin(x, self.cell[0], self.image.width),
            origin(y, self.cell[1], self.image.height),
        ];
        let (x, y) = (x - 0.5, y - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (fu, fv) = (x - left, y - top);
        let (left, top) = (left as i64, top as i64);
        let a = self.tap(left, top, corner);
        let b = self.tap(left + 1, top, corner);
        let c = self.tap(left, top + 1, corner);
        let e = self.tap(left + 1, top + 1, corner);
        let mut rgb = [0.0; 3];
        for (k, value) in rgb.iter_mut().enumerate() {
            let high = a[k] * (1.0 - fu) + b[k] * fu;
            let low = c[k] * (1.0 - fu) + e[k] * fu;
            *value = high * (1.0 - fv) + low * fv;
        }
        rgb
    }

    /// The texel in column `x`, row `y` of the picture as the cell at `corner` would go on.
    fn tap(&self, x: i64, y: i64, corner: [i64; 2]) -> [f32; 3] {
        let (i, j) = (x - corner[0], y - corner[1]);
        let out = [i < 0 || i >= self.cell[0], j < 0 || j >= self.cell[1]];
        let (width, height) = (self.image.width as i64, self.image.height as i64);
        match self.view.layout() {
            Layout::LatLong => self.at(x.rem_euclid(width), y),
            Layout::Octahedral | Layout::EqualAreaOctahedral => {
                // An edge is folded upon itself: what lies beyond is its mirror image.
                let (mut x, mut y) = (x, y);
                if out[0] {
                    x = x.clamp(0, width - 1);
                    y = height - 1 - y;
                }
                if out[1] {
                    y = y.clamp(0, height - 1);
                    x = width - 1 - x;
                }
                self.at(x, y)
            }
            Layout::Angular | Layout::MirrorBall => self.at_rim(x, y),
            Layout::DualParaboloid => self.on_discs(x, y, corner),
            _ if !out[0] && !out[1] => self.at(x, y),
            _ if out[0] && out[1] => {
                // Three faces meet: the fourth texel is their mean, and so the same seen from each.
                let inner = |c: i64, size: i64| c.clamp(0, size - 1);
                let (ix, iy) = (
                    corner[0] + inner(i, self.cell[0]),
                    corner[1] + inner(j, self.cell[1]),
                );
                let three = [
                    self.at(ix, iy),
                    self.across(i, iy - corner[1], corner),
                    self.across(ix - corner[0], j, corner),
                ];
                [0, 1, 2].map(|c| (three[0][c] + three[1][c] + three[2][c]) / 3.0)
            }
            _ => self.across(i, j, corner),
        }
    }

    /// The texel beyond one edge of a cube's face: a little over the edge, at the same place along it.
    fn across(&self, i: i64, j: i64, corner: [i64; 2]) -> [f32; 3] {
        let arrangement = self.view.layout().arrangement();
        let Some(arrangement) = arrangement else {
            return self.at(corner[0] + i, corner[1] + j);
        };
        let faces = self.view.faces();
        let (column, row) = (
            (corner[0] / self.cell[0]) as usize,
            (corner[1] / self.cell[1]) as usize,
        );
        let found = (0..6).find_map(|k| {
            let cell = arrangement.cell(faces, k);
            (cell.column == column && cell.row == row).then_some((faces.faces[k], cell.turned))
        });
        let Some((face, turned)) = found else {
            return self.at(corner[0] + i, corner[1] + j);
        };
        let coordinate = |c: i64, n: i64| {
            // Less than half a texel over, so that the place along the edge stays.
            let over = 1.0 + 0.25 / n as f64;
            let s = (2 * c + 1) as f64 / n as f64 - 1.0;
            let s = s.clamp(-over, over);
            if turned { -s } else { s }
        };
        let s = coordinate(i, self.cell[0]);
        let t = coordinate(j, self.cell[1]);
        let d = face.forward + face.right * s + face.down * t;
        self.nearest(self.view.uv(d).map(|c| c as f32))
    }

    /// The texel, or the outermost one of the disc on the way to its centre.
    fn at_rim(&self, x: i64, y: i64) -> [f32; 3] {
        let n = self.image.width as f64;
        let centre = |c: i64| (c as f64 + 0.5) / n;
        let [px, py] = disc_from_uv([centre(x), centre(y)]);
        let r = (px * px + py * py).sqrt();
        if r <= 1.0 {
            return self.at(x, y);
        }
        // A texel whose centre is inside is at most a diagonal away.
        let k = (1.0 - 1.5 / n).max(0.0) / r;
        let place = |p: f64| ((0.5 + 0.5 * p * k) * n).floor() as i64;
        self.at(place(px), place(-py))
    }

    /// The texel of a half of the dual paraboloid, or, outside its disc, the one of the other that shows the same.
    fn on_discs(&self, x: i64, y: i64, corner: [i64; 2]) -> [f32; 3] {
        let of = |c: i64, size: i64| (2 * c + 1) as f64 / size as f64 - 1.0;
        let (px, py) = (of(x - corner[0], self.cell[0]), -of(y, self.cell[1]));
        let q = px * px + py * py;
        if q <= 1.0 {
            return self.at(x, y);
        }
        // The paraboloid goes on beyond the rim: 1/q of the other's coordinates, mirrored. Right at the rim, a little further
        // in, where a texel's centre is inside.
        let k = (1.0 / q).min((1.0 - 1.5 / self.cell[0] as f64) / q.sqrt());
        let other = self.cell[0] - corner[0];
        let place = |p: f64, size: i64| ((p + 1.0) * 0.5 * size as f64).floor() as i64;
        self.at(
            other + place(-px * k, self.cell[0]),
            place(-py * k, self.cell[1]),
        )
    }
}
