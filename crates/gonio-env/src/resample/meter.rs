//! Irradiance of a picture on the six axes, measured while the picture passes by.

use super::{Rotation, SIX_AXES, turned_back};
use crate::Layout;
use crate::projection::View;
use gonio_image::Image;
use gonio_num::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Rows of a face, or of another picture, that are enough to measure with: cosines of neighbours then differ by 0.4 % at most, and
/// what that does to a sum is its square.
const ROWS: usize = 512;

/// Sums up flux: of each texel its radiance times the solid angle of what it shows. The cosines are those of blocks of texels
/// where there are more than enough, of parts of a texel where there are few.
pub(crate) struct Meter {
    view: View,
    /// The axes as they lay before the picture was turned.
    axes: [Vec3<f64>; 6],
    size: [usize; 2],
    /// A side of a block of texels.
    block: usize,
    /// Parts of a texel along a side.
    parts: usize,
    sums: [[f64; 3]; 6],
    solid_angle: f64,
}

impl Meter {
    /// For a picture of these columns and rows, which is turned by `rotation`.
    pub fn new(view: &View, [width, height]: [usize; 2], rotation: &Rotation) -> Self {
        let layout = view.layout();
        let [columns, rows] = layout.shape();
        let cell = (width / columns).min(height / rows).max(1);
        let mut block = 1;
        while cell / block > ROWS
            && width.is_multiple_of(2 * block * columns)
            && height.is_multiple_of(2 * block * rows)
        {
            block *= 2;
        }
        // Texels that a rim cuts are in parts, too.
        let cut = layout.is_disc() || layout == Layout::DualParaboloid;
        let parts = match block {
            1 => (ROWS / 2).div_ceil(cell).max(if cut { 4 } else { 1 }),
            _ => 1,
        };
        Self {
            view: *view,
            axes: SIX_AXES.map(|axis| turned_back(rotation, axis)),
            size: [width, height],
            block,
            parts,
            sums: [[0.0; 3]; 6],
            solid_angle: 0.0,
        }
    }

    /// Rows come in multiples of this.
    pub fn rows_at_once(&self) -> usize {
        self.block
    }

    /// Adds whole blocks: these columns of some rows from `first` on.
    pub fn add(&mut self, first: usize, columns: Range<usize>, texels: &[[f32; 3]]) {
        let bands = texels.par_chunks(self.block * columns.len());
        let sums = bands.enumerate().map(|(k, band)| {
            let mut sums = Sums::default();
            for x in columns.clone().step_by(self.block) {
                let corner = [x, first + k * self.block];
                let texels = &band[x - columns.start..];
                match self.block {
                    1 => self.add_parts(corner, texels[0], &mut sums),
                    _ => self.add_block(corner, texels, columns.len(), &mut sums),
                }
            }
            sums
        });
        // In order of the rows: the same sum for any number of threads.
        for band in sums.collect::<Vec<_>>() {
            for (sum, part) in self
                .sums
                .iter_mut()
                .flatten()
                .zip(band.flux.iter().flatten())
            {
                *sum += part;
            }
            self.solid_angle += band.solid_angle;
        }
    }

    fn add_parts(&self, [x, y]: [usize; 2], texel: [f32; 3], sums: &mut Sums) {
        let share = 1.0 / self.parts as f64;
        for j in 0..self.parts {
            for i in 0..self.parts {
                let at = |k: usize| (k as f64 + 0.5) * share;
                let uv = self.uv([x as f64 + at(i), y as f64 + at(j)]);
                let weight = self.view.layout().jacobian(uv);
                if weight > 0.0 {
                    let weight = weight * share * share;
                    let flux = texel.map(|l| weight * f64::from(l));
                    sums.add(&self.axes, self.view.direction(uv), weight, flux);
                }
            }
        }
    }

    fn add_block(&self, [x, y]: [usize; 2], texels: &[[f32; 3]], stride: usize, sums: &mut Sums) {
        let (mut flux, mut solid_angle) = ([0.0; 3], 0.0);
        for (j, row) in texels.chunks(stride).take(self.block).enumerate() {
            let layout = self.view.layout();
            let weight_at =
                |i: usize| layout.jacobian(self.uv([(x + i) as f64 + 0.5, (y + j) as f64 + 0.5]));
            let of_row = layout.rows_weigh_alike().then(|| weight_at(0));
            for (i, texel) in row.iter().take(self.block).enumerate() {
                let weight = of_row.unwrap_or_else(|| weight_at(i));
                if weight > 0.0 {
                    solid_angle += weight;
                    for (f, l) in flux.iter_mut().zip(texel) {
                        *f += weight * f64::from(*l);
                    }
                }
            }
        }
        if solid_angle > 0.0 {
            let half = 0.5 * self.block as f64;
            let uv = self.uv([x as f64 + half, y as f64 + half]);
            sums.add(&self.axes, self.view.direction(uv), solid_angle, flux);
        }
    }

    fn uv(&self, at: [f64; 2]) -> [f64; 2] {
        [at[0] / self.size[0] as f64, at[1] / self.size[1] as f64]
    }

    /// Irradiance \[W m⁻²] of what was added, as if it were the whole sphere: the sphere's 4π are shared out among it.
    pub fn irradiance(&self) -> [[f64; 3]; 6] {
        let scale = 4.0 * std::f64::consts::PI / self.solid_angle;
        self.sums.map(|sum| sum.map(|s| s * scale))
    }
}

#[derive(Default)]
struct Sums {
    flux: [[f64; 3]; 6],
    solid_angle: f64,
}

impl Sums {
    fn add(&mut self, axes: &[Vec3<f64>; 6], d: Vec3<f64>, solid_angle: f64, flux: [f64; 3]) {
        self.solid_angle += solid_angle;
        for (sum, axis) in self.flux.iter_mut().zip(axes) {
            let cosine = axis.dot(d).max(0.0);
            for (s, f) in sum.iter_mut().zip(flux) {
                *s += cosine * f;
            }
        }
    }
}

/// Irradiance \[W m⁻²] on the six axes of a whole picture after the rotation.
pub(crate) fn irradiance(image: &Image, view: &View, rotation: &Rotation) -> [[f64; 3]; 6] {
    let mut meter = Meter::new(view, [image.width, image.height], rotation);
    meter.add(0, 0..image.width, &image.pixels);
    meter.irradiance()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::resample::NO_ROTATION;
    use crate::{Convention, test_image};

    /// However the picture comes: whole, in bands, in faces, in blocks of texels or in parts.
    #[test]
    fn the_way_a_picture_comes_does_not_matter() {
        for (layout, size) in [(Layout::LatLong, 2048), (Layout::CubeStrip, 1024)] {
            let view = View::new(layout, Convention::Gonio);
            let image = test_image::six_axes(layout, size);
            let [width, height] = [image.width, image.height];
            let whole = irradiance(&image, &view, &NO_ROTATION);
            let mut meter = Meter::new(&view, [width, height], &NO_ROTATION);
            assert!(meter.rows_at_once() > 1);
            let cell = width / layout.shape()[0];
            for start in (0..width).step_by(cell) {
                for first in (0..height).step_by(64) {
                    let rows = first..first + 64;
                    let texels: Vec<_> = rows
                        .flat_map(|y| image.pixels[y * width + start..][..cell].to_vec())
                        .collect();
                    meter.add(first, start..start + cell, &texels);
                }
            }
            let small = test_image::six_axes(layout, size / 8);
            let coarse = irradiance(&small, &view, &NO_ROTATION);
            for ((whole, bands), coarse) in whole
                .iter()
                .flatten()
                .zip(meter.irradiance().iter().flatten())
                .zip(coarse.iter().flatten())
            {
                assert!(
                    (whole / bands - 1.0).abs() < 1e-12,
                    "{layout}: {bands} for {whole}"
                );
                // Letters' edges move by half a texel of 0.7° (lat-long) or of 0.35° to 0.7° (cube): 1 % of what they show.
                assert!(
                    (whole / coarse - 1.0).abs() < 1e-2,
                    "{layout}: {coarse} for {whole}"
                );
            }
        }
    }
}
