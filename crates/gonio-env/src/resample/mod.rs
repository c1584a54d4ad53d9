//! Resampling: one layout into another, with the flux kept.
//!
//! A texel of the new picture is the mean radiance of its area, weighed by solid angle: the old picture is interpolated
//! at a grid of points in the texel, more of them the larger its solid angle is beside that of an old texel. Where that
//! would take more than 8 × 8, the old picture is first halved, again weighed by solid angle. Where a new texel is a whole number of
//! old ones along each side, it is their mean. So no light falls between the
//! samples, and irradiance stays. Where every new texel stands exactly on an old one, texels are copied.
//!
//! The new picture is made in pieces, so it need not be in memory. Memory: 12 bytes for each texel of the old picture, 3 more while
//! it is halved.

mod lookup;
mod meter;

use crate::projection::View;
use gonio_image::Image;
use gonio_num::{Real, Vec3};
use lookup::Lookup;
pub(crate) use meter::{Meter, irradiance};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How a new texel is made of old ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Filter {
    /// The mean of the texel's area, weighed by solid angle: keeps irradiance.
    #[default]
    Area,
    /// The interpolated radiance of the texel's centre.
    Bilinear,
    /// The nearest old texel.
    Nearest,
}

/// The rows of a rotation.
pub type Rotation = [[f64; 3]; 3];

/// No rotation.
pub const NO_ROTATION: Rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The rotation of an environment by angles in degrees: first `roll` about +z (counter-clockwise as one looks forward), then
/// `pitch` about +x (what is in front rises), then `yaw` about +y (counter-clockwise seen from above).
pub fn rotation_deg(yaw: f64, pitch: f64, roll: f64) -> Rotation {
    let [(sy, cy), (sp, cp), (sr, cr)] = [yaw, pitch, roll].map(exact_sin_cos);
    let about_y = [[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]];
    let about_x = [[1.0, 0.0, 0.0], [0.0, cp, -sp], [0.0, sp, cp]];
    let about_z = [[cr, -sr, 0.0], [sr, cr, 0.0], [0.0, 0.0, 1.0]];
    product(&about_y, &product(&about_x, &about_z))
}

fn product(a: &Rotation, b: &Rotation) -> Rotation {
    let mut c = [[0.0; 3]; 3];
    for (row, out) in a.iter().zip(&mut c) {
        for (k, value) in out.iter_mut().enumerate() {
            *value = row[0] * b[0][k] + row[1] * b[1][k] + row[2] * b[2][k];
        }
    }
    c
}

/// Exact at multiples of 90°, so that such turns only move texels.
fn exact_sin_cos(deg: f64) -> (f64, f64) {
    match deg.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => Real::sin_cos(deg.to_radians()),
    }
}

/// Rᵀ d: where the old environment showed what the new one shows in the direction `d`.
fn turned_back(r: &Rotation, d: Vec3<f64>) -> Vec3<f64> {
    let column = |k: usize| r[0][k] * d.x + r[1][k] * d.y + r[2][k] * d.z;
    Vec3::new(column(0), column(1), column(2))
}

/// The most samples of a texel along one side.
const MOST_SAMPLES: usize = 8;

/// What is to be made.
pub(crate) struct Target<'a> {
    pub view: View,
    pub size: usize,
    pub rotation: Rotation,
    pub filter: Filter,
    /// Told the fraction that is done.
    pub progress: &'a (dyn Fn(f64) + Sync),
}

impl Target<'_> {
    /// Columns and rows.
    fn picture(&self) -> [usize; 2] {
        self.view.layout().shape().map(|n| n * self.size)
    }
}

/// A picture that is being turned into another, in pieces of any size and order.
pub(crate) struct Resampler<'a> {
    from: Image,
    from_view: View,
    target: Target<'a>,
    way: Way,
    made: AtomicUsize,
}

/// How a texel is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    /// Of samples of its area.
    Area,
    /// Of so many old texels along a side, which are its area exactly.
    Whole(usize),
    /// By a look-up of its centre.
    Bilinear,
    /// As a copy.
    Nearest,
}

impl<'a> Resampler<'a> {
    /// `from` is used up: where its texels are much smaller than the target's, it is halved.
    pub fn new(mut from: Image, from_view: &View, target: Target<'a>) -> Self {
        let view = &target.view;
        let [width, height] = target.picture();
        let way = match target.filter {
            Filter::Bilinear => Way::Bilinear,
            Filter::Nearest => Way::Nearest,
            Filter::Area if is_aligned(&from, from_view, &target) => Way::Nearest,
            Filter::Area => whole(&from, from_view, &target).map_or(Way::Area, Way::Whole),
        };
        if way == Way::Area {
            // Along a side, of the whole sphere's texels.
            let linear = |image: &Image| {
                let of = |v: &View, w: usize, h: usize| w as f64 * h as f64 * coverage(v);
                (of(from_view, image.width, image.height) / of(view, width, height)).sqrt()
            };
            while linear(&from) > MOST_SAMPLES as f64 / 2.0 {
                match halved(&from, from_view) {
                    Some(smaller) => from = smaller,
                    None => break,
                }
            }
        }
        Self {
            from,
            from_view: *from_view,
            target,
            way,
            made: AtomicUsize::new(0),
        }
    }

    /// Columns and rows of the new picture.
    pub fn size(&self) -> [usize; 2] {
        self.target.picture()
    }

    /// Makes the texels of these columns, in as many rows from `first` on as `texels` has room for.
    pub fn make(&self, first: usize, columns: Range<usize>, texels: &mut [[f32; 3]]) {
        let [width, height] = self.size();
        let lookup = Lookup::new(&self.from, &self.from_view);
        let texel_in = 1.0 / (self.from.width as f64 * self.from.height as f64);
        let rows = texels.par_chunks_exact_mut(columns.len());
        rows.enumerate().for_each(|(k, row)| {
            for (x, texel) in columns.clone().zip(row) {
                let place = Place {
                    x,
                    y: first + k,
                    width,
                    height,
                };
                *texel = self.texel(&lookup, &place, texel_in);
            }
            let made = self.made.fetch_add(columns.len(), Ordering::Relaxed) + columns.len();
            (self.target.progress)(made as f64 / (width as f64 * height as f64));
        });
    }

    fn texel(&self, lookup: &Lookup<'_>, place: &Place, texel_in: f64) -> [f32; 3] {
        let (from_view, target) = (&self.from_view, &self.target);
        match self.way {
            Way::Area => return area(lookup, from_view, target, place, texel_in),
            Way::Whole(side) => {
                return mean(
                    &self.from,
                    from_view,
                    [place.x * side, place.y * side],
                    side,
                );
            }
            Way::Bilinear | Way::Nearest => {}
        }
        match (self.way, place.direction(target, 0.5, 0.5)) {
            (_, None) => [0.0; 3],
            (Way::Nearest, Some((d, _))) => lookup.nearest(from_view.uv(d).map(|c| c as f32)),
            (_, Some((d, _))) => lookup.bilinear(d.to_f32()),
        }
    }
}

/// How many old texels along a side each new one consists of, if nothing but the size changes and it is a whole number.
fn whole(from: &Image, from_view: &View, target: &Target) -> Option<usize> {
    let [width, height] = target.picture();
    let side = from.width / width;
    let same = *from_view == target.view && target.rotation == NO_ROTATION;
    (same && side > 1 && side * width == from.width && side * height == from.height).then_some(side)
}

/// The mean of so many texels along a side, weighed by solid angle; black if they show nothing.
fn mean(image: &Image, view: &View, [left, top]: [usize; 2], side: usize) -> [f32; 3] {
    let (mut sum, mut total) = ([0.0_f64; 3], 0.0);
    for y in top..top + side {
        let weight_at = |x: usize| {
            view.layout().jacobian([
                (x as f64 + 0.5) / image.width as f64,
                (y as f64 + 0.5) / image.height as f64,
            ])
        };
        let of_row = view.layout().rows_weigh_alike().then(|| weight_at(left));
        for x in left..left + side {
            let weight = of_row.unwrap_or_else(|| weight_at(x));
            if weight > 0.0 {
                for (s, l) in sum.iter_mut().zip(image.pixels[y * image.width + x]) {
                    *s += weight * f64::from(l);
                }
                total += weight;
            }
        }
    }
    if total > 0.0 {
        sum.map(|s| (s / total) as f32)
    } else {
        [0.0; 3]
    }
}

/// Share of the picture that shows the sphere.
fn coverage(view: &View) -> f64 {
    match view.layout() {
        layout if layout.is_disc() => std::f64::consts::FRAC_PI_4,
        crate::Layout::DualParaboloid => std::f64::consts::FRAC_PI_4,
        layout => match layout.arrangement() {
            Some(a) => 6.0 / (a.columns * a.rows) as f64,
            None => 1.0,
        },
    }
}

/// A texel of the new picture.
struct Place {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
}

impl Place {
    fn uv(&self, fx: f64, fy: f64) -> [f64; 2] {
        [
            (self.x as f64 + fx) / self.width as f64,
            (self.y as f64 + fy) / self.height as f64,
        ]
    }

    /// Where the old environment shows what a point of the texel shows, and the solid angle there; nothing where nothing
    /// is shown.
    fn direction(&self, target: &Target, fx: f64, fy: f64) -> Option<(Vec3<f64>, f64)> {
        let uv = self.uv(fx, fy);
        let layout = target.view.layout();
        // The dual paraboloid goes on beyond its rims, for who interpolates there.
        if !layout.contains(uv) && layout != crate::Layout::DualParaboloid {
            return None;
        }
        let d = turned_back(&target.rotation, target.view.direction(uv));
        Some((d, layout.jacobian(uv)))
    }
}

fn area(
    lookup: &Lookup<'_>,
    from_view: &View,
    target: &Target,
    place: &Place,
    texel_in: f64,
) -> [f32; 3] {
    let centre = place.direction(target, 0.5, 0.5);
    let samples = centre.map_or(4, |(d, j)| {
        let old = from_view.layout().jacobian(from_view.uv(d));
        // Near a pole old texels shrink without end; an eighth of the mean is small enough.
        let old = old.max(std::f64::consts::FRAC_PI_2) * texel_in;
        let new = j / (place.width as f64 * place.height as f64);
        ((2.0 * (new / old).sqrt()).ceil() as usize).clamp(2, MOST_SAMPLES)
    });
    let (mut sum, mut total) = ([0.0_f64; 3], 0.0);
    for j in 0..samples {
        for i in 0..samples {
            let at = |k: usize| (k as f64 + 0.5) / samples as f64;
            let Some((d, weight)) = place.direction(target, at(i), at(j)) else {
                continue;
            };
            if weight <= 0.0 {
                continue;
            }
            let radiance = lookup.bilinear(d.to_f32());
            for (s, l) in sum.iter_mut().zip(radiance) {
                *s += weight * f64::from(l);
            }
            total += weight;
        }
    }
    if total > 0.0 {
        return sum.map(|s| (s / total) as f32);
    }
    centre.map_or([0.0; 3], |(d, _)| lookup.bilinear(d.to_f32()))
}

/// Whether new texels stand exactly on old ones of the same solid angle: looked at for 256 of them.
fn is_aligned(from: &Image, from_view: &View, target: &Target) -> bool {
    let [width, height] = target.picture();
    let mut seen = false;
    for k in 0..256_usize {
        // Low-discrepancy places: Roberts' R2 sequence.
        let at = |step: f64, n: usize| ((0.5 + k as f64 * step).fract() * n as f64) as usize;
        let place = Place {
            x: at(0.754_877_666_246_692_8, width),
            y: at(0.569_840_290_998_053_3, height),
            width,
            height,
        };
        let Some((d, j)) = place.direction(target, 0.5, 0.5).filter(|(_, j)| *j > 0.0) else {
            continue;
        };
        let uv = from_view.uv(d);
        let off = |c: f64, n: usize| {
            let x = c * n as f64;
            (x - x.floor() - 0.5).abs()
        };
        let old = from_view.layout().jacobian(uv) / (from.width * from.height) as f64;
        let new = j / (width * height) as f64;
        if off(uv[0], from.width) > 1e-6
            || off(uv[1], from.height) > 1e-6
            || (old / new - 1.0).abs() > 1e-6
        {
            return false;
        }
        seen = true;
    }
    seen
}

/// Half the columns and rows, each texel the mean of four weighed by their solid angles; nothing if a face, or the
/// picture, has an odd side.
pub(crate) fn halved(image: &Image, view: &View) -> Option<Image> {
    let layout = view.layout();
    let [columns, rows] = layout.shape();
    if !image.width.is_multiple_of(2 * columns) || !image.height.is_multiple_of(2 * rows) {
        return None;
    }
    let (width, height) = (image.width / 2, image.height / 2);
    let mut half = Image::new(width, height);
    half.pixels
        .par_chunks_mut(width)
        .enumerate()
        .for_each(|(y, row)| {
            for (x, texel) in row.iter_mut().enumerate() {
                *texel = mean(image, view, [2 * x, 2 * y], 2);
            }
        });
    Some(half)
}

/// The normals +x, −x, +y, −y, +z, −z.
pub const SIX_AXES: [Vec3<f64>; 6] = [
    Vec3::new(1.0, 0.0, 0.0),
    Vec3::new(-1.0, 0.0, 0.0),
    Vec3::new(0.0, 1.0, 0.0),
    Vec3::new(0.0, -1.0, 0.0),
    Vec3::new(0.0, 0.0, 1.0),
    Vec3::new(0.0, 0.0, -1.0),
];
