//! [`Rows`]: a conversion that is made while it is written.

use super::{Conversion, Kept, Panorama};
use crate::projection::View;
use crate::resample::{self, Meter, NO_ROTATION, Resampler, Target};
use crate::{Convention, Layout};
use std::ops::Range;

/// The picture that a conversion makes, row by row: it is never in memory whole.
pub struct Rows<'a> {
    resampler: Resampler<'a>,
    view: View,
    before: [[f64; 3]; 6],
    meter: Meter,
    /// Rows that were made, and not asked for yet.
    band: Vec<[f32; 3]>,
    columns: Range<usize>,
    rows: Range<usize>,
}

/// Rows that are made at a time, where fewer are asked for: enough for the threads to share.
const BAND: usize = 64;

impl Panorama {
    /// The environment in another layout, turned, to be made row by row.
    pub fn into_rows<'a>(self, to: &Conversion<'a>) -> Rows<'a> {
        let before = resample::irradiance(&self.image, &self.view, &to.rotation);
        let view = View::new(to.layout, to.convention);
        let resampler = self.resampler(to);
        let meter = Meter::new(&view, resampler.size(), &NO_ROTATION);
        Rows {
            resampler,
            view,
            before,
            meter,
            band: Vec::new(),
            columns: 0..0,
            rows: 0..0,
        }
    }

    pub(super) fn resampler<'a>(self, to: &Conversion<'a>) -> Resampler<'a> {
        let target = Target {
            view: View::new(to.layout, to.convention),
            size: to
                .size
                .unwrap_or_else(|| self.matching_size(to.layout))
                .max(1),
            rotation: to.rotation,
            filter: to.filter,
            progress: to.progress,
        };
        Resampler::new(self.image, &self.view, target)
    }
}

impl Rows<'_> {
    /// Columns and rows of the picture.
    pub fn size(&self) -> [usize; 2] {
        self.resampler.size()
    }

    /// Its layout.
    pub fn layout(&self) -> Layout {
        self.view.layout()
    }

    /// Whose turn of that layout.
    pub fn convention(&self) -> Convention {
        self.view.convention()
    }

    /// Makes the rows from `first` on that `texels` has room for. Rows are asked for in order, from 0, each once.
    pub fn make(&mut self, first: usize, texels: &mut [[f32; 3]]) {
        let width = self.size()[0];
        self.make_columns(first, 0..width, texels);
    }

    /// Makes rows of one face of a strip of six, as [`Rows::make`] does of the picture. Faces are made one after the other.
    ///
    /// # Panics
    /// If the layout is not [`Layout::CubeStrip`], or there is no such face.
    pub fn make_face(&mut self, face: usize, first: usize, texels: &mut [[f32; 3]]) {
        assert!(
            self.layout() == Layout::CubeStrip && face < 6,
            "face {face} of {}",
            self.layout()
        );
        let n = self.size()[1];
        self.make_columns(first, face * n..(face + 1) * n, texels);
    }

    fn make_columns(&mut self, first: usize, columns: Range<usize>, texels: &mut [[f32; 3]]) {
        let (width, height) = (columns.len(), self.size()[1]);
        let step = self.meter.rows_at_once();
        if self.columns != columns || first == 0 {
            self.columns = columns.clone();
            self.rows = 0..0;
        }
        let mut y = first;
        let mut rest = texels;
        while !rest.is_empty() && y < height {
            let asked = rest.len() / width;
            let ready = self.rows.end.saturating_sub(y);
            let count = if ready > 0 {
                let count = ready.min(asked);
                let from = (y - self.rows.start) * width;
                rest[..count * width].copy_from_slice(&self.band[from..from + count * width]);
                count
            } else if asked >= BAND.min(height - y)
                && (asked.is_multiple_of(step) || y + asked >= height)
            {
                self.resampler.make(y, columns.clone(), rest);
                self.meter.add(y, columns.clone(), rest);
                asked
            } else {
                let rows = BAND.next_multiple_of(step).min(height - y);
                self.rows = y..y + rows;
                self.band.resize(rows * width, [0.0; 3]);
                self.resampler.make(y, columns.clone(), &mut self.band);
                self.meter.add(y, columns.clone(), &self.band);
                continue;
            };
            y += count;
            rest = &mut rest[count * width..];
        }
    }

    /// The irradiance before and, once every row was made, after.
    pub fn kept(&self) -> Kept {
        Kept {
            before: self.before,
            after: self.meter.irradiance(),
        }
    }
}
