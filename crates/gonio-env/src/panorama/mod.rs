//! [`Panorama`]: an environment as a picture, before it is light: read in any layout, turned into any other.

mod load;
mod rows;

use crate::projection::{Convention, Layout, View};
use crate::resample::{self, Filter, NO_ROTATION, Rotation};
use crate::texels::{self, Defects, Remedy};
use crate::{EnvError, luminance};
use gonio_image::{CubeMap, Image};
use std::path::{Path, PathBuf};

pub(crate) use load::{of_bytes, read};
pub use rows::Rows;

/// A picture of an environment, and how it is laid out.
#[derive(Debug, Clone)]
pub struct Panorama {
    image: Image,
    view: View,
    file: Option<PathBuf>,
    pub(crate) defects: Defects,
}

/// What is to be made of a [`Panorama`].
pub struct Conversion<'a> {
    /// The layout.
    pub layout: Layout,
    /// Whose turn of that layout.
    pub convention: Convention,
    /// Rows of the picture, or of a cube's face. As many texels as the old picture has, about, if nothing.
    pub size: Option<usize>,
    /// The environment is turned by this first.
    pub rotation: Rotation,
    /// How new texels are made of old ones.
    pub filter: Filter,
    /// Told the fraction that is done, from any thread.
    pub progress: &'a (dyn Fn(f64) + Sync),
}

impl Conversion<'_> {
    /// To this layout as this program turns it, unrotated, of a matching size.
    pub fn to(layout: Layout) -> Self {
        Self {
            layout,
            convention: Convention::Gonio,
            size: None,
            rotation: NO_ROTATION,
            filter: Filter::Area,
            progress: &|_| {},
        }
    }
}

/// What a conversion kept.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Kept {
    /// Irradiance \[W m⁻²], RGB, on surfaces whose normals are +x, −x, +y, −y, +z, −z, before, turned as asked.
    pub before: [[f64; 3]; 6],
    /// The same after.
    pub after: [[f64; 3]; 6],
}

impl Kept {
    /// After over before, of luminance, on each axis; nothing where no light comes from.
    pub fn ratios(&self) -> [Option<f64>; 6] {
        let l = |e: [f64; 3]| 0.2126 * e[0] + 0.7152 * e[1] + 0.0722 * e[2];
        let mut ratios = [None; 6];
        for (ratio, (before, after)) in ratios.iter_mut().zip(self.before.iter().zip(self.after)) {
            *ratio = (l(*before) > 0.0).then(|| l(after) / l(*before));
        }
        ratios
    }

    /// The largest departure of a ratio from 1.
    pub fn worst(&self) -> f64 {
        let departures = self.ratios().into_iter().flatten().map(|r| (r - 1.0).abs());
        departures.fold(0.0, f64::max)
    }
}

impl Panorama {
    /// The environment that `image` shows.
    ///
    /// # Errors
    /// [`EnvError::Shape`] if the sides are not in the layout's proportion: for a cube exactly so; a lat-long panorama and
    /// the octahedra may have any sides; a disc is square, and two discs are twice as wide as high.
    pub fn new(image: Image, layout: Layout, convention: Convention) -> Result<Self, EnvError> {
        let panorama = Self {
            image,
            view: View::new(layout, convention),
            file: None,
            defects: Defects::default(),
        };
        panorama.check_shape()?;
        Ok(panorama)
    }

    /// The first level of a cube map, as a strip of faces.
    ///
    /// # Errors
    /// [`EnvError::Shape`] if it has no texels.
    pub fn from_cube(cube: &CubeMap, convention: Convention) -> Result<Self, EnvError> {
        let level = cube.levels.first();
        Self::of_faces(level.map_or(&[], <[Image; 6]>::as_slice), convention)
    }

    fn of_faces(faces: &[Image], convention: Convention) -> Result<Self, EnvError> {
        let n = faces.first().map_or(0, |face| face.width);
        let mut strip = Image::new(6 * n, n);
        for (face, image) in faces.iter().enumerate() {
            for (y, row) in image.pixels.chunks_exact(n.max(1)).enumerate() {
                let start = y * 6 * n + face * n;
                strip.pixels[start..start + n].copy_from_slice(row);
            }
        }
        Self::new(strip, Layout::CubeStrip, convention)
    }

    fn check_shape(&self) -> Result<(), EnvError> {
        let (width, height) = (self.image.width, self.image.height);
        let [columns, rows] = self.layout().shape();
        let (fits, expected) = match self.layout() {
            Layout::LatLong | Layout::Octahedral | Layout::EqualAreaOctahedral => (true, ""),
            Layout::Angular | Layout::MirrorBall => {
                (width == height, "a square picture for this layout")
            }
            Layout::DualParaboloid => (
                width == 2 * height,
                "a picture twice as wide as high for this layout",
            ),
            _ => (
                width * rows == height * columns && width.is_multiple_of(columns),
                match self.layout() {
                    Layout::CubeCross => "4 : 3, in whole faces",
                    Layout::CubeCrossVertical => "3 : 4, in whole faces",
                    Layout::CubeStrip => "6 : 1, in whole faces",
                    _ => "1 : 6, in whole faces",
                },
            ),
        };
        let whole = width > 0 && height > 0 && self.image.pixels.len() == width * height;
        match (whole, fits) {
            (true, true) => Ok(()),
            (whole, _) => Err(EnvError::Shape {
                file: self.file.clone(),
                width,
                height,
                expected: if whole {
                    expected
                } else {
                    "at least 1 × 1, and as many pixels as that"
                },
            }),
        }
    }

    /// Refuses or replaces unsound texels; those beside a disc or the faces of a cross are not looked at.
    pub(crate) fn check_texels(&mut self, remedy: Remedy) -> Result<(), EnvError> {
        let layout = self.layout();
        let (width, height) = (self.image.width, self.image.height);
        let shown = |x: usize, y: usize| {
            layout.contains([
                (x as f64 + 0.5) / width as f64,
                (y as f64 + 0.5) / height as f64,
            ])
        };
        let file = self.file.clone();
        self.defects = texels::check(&mut self.image, shown, file.as_deref(), remedy)?;
        Ok(())
    }

    /// The picture.
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// The picture, taken out.
    pub fn into_image(self) -> Image {
        self.image
    }

    /// The layout.
    pub fn layout(&self) -> Layout {
        self.view.layout()
    }

    /// The layout as its convention turns it.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The file it was read from.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// How many texels were replaced when it was read.
    pub fn replaced_texels(&self) -> u64 {
        self.defects.non_finite + self.defects.negative
    }

    /// Rows of a picture of `layout`, or of its faces, that shows about as much detail, at least 1: texels of the same
    /// solid angle in the mean.
    pub fn matching_size(&self, layout: Layout) -> usize {
        let texels = |layout: Layout, width: usize, height: usize| {
            let (w, h) = (width as f64, height as f64);
            match layout.arrangement() {
                Some(a) => w * h * 6.0 / (a.columns * a.rows) as f64,
                // A lat-long panorama spends its texels near the poles: 2/π of them on the equator's density.
                None if layout == Layout::LatLong => w * h * std::f64::consts::FRAC_2_PI,
                None if layout.is_disc() || layout == Layout::DualParaboloid => {
                    w * h * std::f64::consts::FRAC_PI_4
                }
                None => w * h,
            }
        };
        if layout == self.layout() {
            return self.image.height / layout.shape()[1];
        }
        let have = texels(self.layout(), self.image.width, self.image.height);
        let [columns, rows] = layout.shape();
        let each = texels(layout, columns, rows);
        ((have / each).sqrt().round() as usize).max(1)
    }

    /// The environment in another layout, turned, with the irradiance of both.
    pub fn converted(self, to: &Conversion<'_>) -> (Self, Kept) {
        let (file, defects) = (self.file.clone(), self.defects);
        let mut rows = self.into_rows(to);
        let [width, height] = rows.size();
        let mut image = Image::new(width, height);
        rows.make(0, &mut image.pixels);
        let kept = rows.kept();
        let made = Self {
            image,
            view: View::new(to.layout, to.convention),
            file,
            defects,
        };
        (made, kept)
    }

    /// [`Panorama::converted`] without measuring.
    pub fn resampled(self, to: &Conversion<'_>) -> Self {
        let (file, defects) = (self.file.clone(), self.defects);
        let resampler = self.resampler(to);
        let [width, height] = resampler.size();
        let mut image = Image::new(width, height);
        resampler.make(0, 0..width, &mut image.pixels);
        Self {
            image,
            view: View::new(to.layout, to.convention),
            file,
            defects,
        }
    }

    /// The six faces, in their convention's order and turn; nothing if it is no cube.
    pub fn faces(&self) -> Option<[Image; 6]> {
        let arrangement = self.layout().arrangement()?;
        let n = self.image.width / arrangement.columns;
        Some(std::array::from_fn(|k| {
            let cell = arrangement.cell(self.view.faces(), k);
            Image::from_fn(n, n, |x, y| {
                let (x, y) = if cell.turned {
                    (n - 1 - x, n - 1 - y)
                } else {
                    (x, y)
                };
                self.image.get(cell.column * n + x, cell.row * n + y)
            })
        }))
    }

    /// The faces as a cube map, with its smaller levels if `levels`: each texel the mean of its area in the level before,
    /// weighed by solid angle, across the edges of faces. Nothing if it is no cube.
    pub fn cube_map(&self, levels: bool) -> Option<CubeMap> {
        self.clone().into_cube_map(levels)
    }

    /// [`Panorama::cube_map`], of which the picture is not needed any more.
    pub fn into_cube_map(self, levels: bool) -> Option<CubeMap> {
        let mut all = vec![self.faces()?];
        let size = all[0][0].width;
        let convention = self.view.convention();
        let mut before = if self.layout() == Layout::CubeStrip {
            self
        } else {
            drop(self);
            Self::of_faces(&all[0], convention).ok()?
        };
        while levels && before.image.height > 1 {
            let to = Conversion {
                convention,
                size: Some(before.image.height / 2),
                ..Conversion::to(Layout::CubeStrip)
            };
            // Exactly half: the mean of four, and no blur besides.
            before = match resample::halved(&before.image, &before.view) {
                Some(image) => Self { image, ..before },
                None => before.resampled(&to),
            };
            all.push(before.faces()?);
        }
        Some(CubeMap { size, levels: all })
    }

    /// Whether everything that `layout` does not show is black: darker than a thousandth of the mean.
    fn is_black_outside(image: &Image, layout: Layout) -> bool {
        let mean =
            image.pixels.iter().map(|p| luminance(*p)).sum::<f64>() / image.pixels.len() as f64;
        let (width, height) = (image.width as f64, image.height as f64);
        // A rim drawn with antialiasing may reach two texels out.
        let clear = [2.0 / width, 2.0 / height];
        let mut any = false;
        for (k, pixel) in image.pixels.iter().enumerate() {
            let (x, y) = (k % image.width, k / image.width);
            let uv = [(x as f64 + 0.5) / width, (y as f64 + 0.5) / height];
            let outside = [-1.0, 0.0, 1.0].iter().all(|i| {
                [-1.0, 0.0, 1.0].iter().all(|j| {
                    let near = [uv[0] + i * clear[0], uv[1] + j * clear[1]];
                    let on_picture = near.iter().all(|c| (0.0..=1.0).contains(c));
                    !on_picture || !layout.contains(near)
                })
            });
            if outside {
                any = true;
                if luminance(*pixel) > 1e-3 * mean {
                    return false;
                }
            }
        }
        any
    }
}
