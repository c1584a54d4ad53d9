//! Pictures that are written while they are made, some rows at a time, and read again before they are put in place.

use crate::atomic::Pending;
use crate::format::{openexr, radiance, raster};
use crate::tonemap::{ToneMap, exposure_scale};
use crate::{ImageError, Limits, srgb};
use std::hash::{DefaultHasher, Hasher};
use std::io::{BufReader, BufWriter, Seek, SeekFrom, Write};
use std::path::Path;

/// What makes rows for [`write_rows`]: it gets the first row's number and room for some whole rows. They are asked for in order, each once.
pub type Fill<'a> = dyn FnMut(usize, &mut [[f32; 3]]) -> Result<(), ImageError> + 'a;

/// How [`write_rows`] stores pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Store {
    /// `.exr`: floats.
    ExrFloat,
    /// `.exr`: half floats, the nearest; beyond 65,504 infinite.
    ExrHalf,
    /// `.hdr`: RGBE.
    Hdr,
    /// `.png`: codes with the sRGB transfer, of the pixels times 2^`exposure_ev`, tone mapped.
    Png {
        /// The curve.
        tonemap: ToneMap,
        /// Stops.
        exposure_ev: f32,
        /// Codes of 16 bits, not 8.
        deep: bool,
    },
}

/// Writes a picture of `width` × `height` whose rows are made when they are needed: `fill` gets the number of the first row and
/// room for some whole rows, in order from the top, each row once.
///
/// No more than some dozen rows are in memory, with PNG the codes besides. EXR and Radiance HDR are read again before they are put in
/// place, and each row must be what was written.
///
/// # Errors
/// What `fill` says; `Parameter` for an empty picture or one that the format cannot hold; `Format` if what was written reads back
/// as something else; `Io`. Nothing is left half-written.
pub fn write_rows(
    path: &Path,
    [width, height]: [usize; 2],
    store: Store,
    fill: &mut Fill<'_>,
) -> Result<(), ImageError> {
    let file = path.display().to_string();
    if width == 0 || height == 0 {
        return Err(ImageError::parameter(format!(
            "{file}: a picture of {width} × {height} cannot be written"
        )));
    }
    let mut pending = Pending::create(path)?;
    let size = [width, height];
    let mut prints = Prints::new(size);
    let mut seen = |y: usize, c: usize, row: &[f32]| prints.add(y, c, row);
    match store {
        Store::ExrFloat | Store::ExrHalf => {
            let half = store == Store::ExrHalf;
            openexr::write_rows(&file, size, half, &mut pending, fill, &mut seen)?;
        }
        Store::Hdr => {
            let mut target = BufWriter::with_capacity(1 << 18, &mut pending);
            radiance::write_rows(&file, size, &mut target, fill, &mut seen)?;
            target
                .flush()
                .map_err(|e| ImageError::io(path, "write it", e))?;
        }
        Store::Png {
            tonemap,
            exposure_ev,
            deep,
        } => {
            let scale = exposure_scale(exposure_ev);
            let shown = |p: [f32; 3]| tonemap.apply(p.map(|c| c * scale));
            let mut rows = vec![[0.0; 3]; width];
            let (mut codes8, mut codes16) = (Vec::new(), Vec::new());
            for y in 0..height {
                fill(y, &mut rows)?;
                let samples = rows.iter().flat_map(|p| shown(*p));
                if deep {
                    codes16.extend(samples.flat_map(|c| srgb::encode16(c).to_ne_bytes()));
                } else {
                    codes8.extend(samples.map(srgb::encode8));
                }
            }
            let codes = if deep { codes16 } else { codes8 };
            let mut target = BufWriter::new(&mut pending);
            raster::encode(path, &mut target, &codes, size, deep)?;
            target
                .flush()
                .map_err(|e| ImageError::io(path, "write it", e))?;
            drop(target);
            return pending.put_in_place();
        }
    }
    check(path, &mut pending, store, &prints)?;
    pending.put_in_place()
}

/// A number for each channel of each row, by which a row that changed is known.
struct Prints {
    size: [usize; 2],
    of: Vec<u64>,
}

impl Prints {
    fn new(size: [usize; 2]) -> Self {
        Self {
            size,
            of: vec![0; 3 * size[1]],
        }
    }

    fn add(&mut self, y: usize, c: usize, row: &[f32]) {
        let mut hasher = DefaultHasher::new();
        for value in row {
            hasher.write_u32(value.to_bits());
        }
        self.of[3 * y + c] = hasher.finish();
    }
}

/// Reads what was written, row by row.
fn check(
    path: &Path,
    pending: &mut Pending,
    store: Store,
    written: &Prints,
) -> Result<(), ImageError> {
    let file = path.display().to_string();
    let io = |e| ImageError::io(path, "read it again", e);
    let limits = Limits {
        max_pixels: u64::MAX,
        max_bytes: u64::MAX,
    };
    let length = pending.seek(SeekFrom::End(0)).map_err(io)?;
    pending.rewind().map_err(io)?;
    let source = BufReader::with_capacity(1 << 18, pending);
    let mut read = Prints::new(written.size);
    let mut seen = |y: usize, c: usize, row: &[f32]| read.add(y, c, row);
    let size = match store {
        Store::Hdr => radiance::read_rows(&file, source, length, &limits, &mut seen)?,
        _ => openexr::read_rows(&file, source, &limits, &mut seen)?,
    };
    let wrong = |found: String, expected: String| {
        Err(ImageError::format(
            &file,
            "what was written",
            found,
            expected,
        ))
    };
    if size != written.size {
        return wrong(format!("{size:?} pixels"), format!("{:?}", written.size));
    }
    match (0..read.of.len()).find(|&k| read.of[k] != written.of[k]) {
        None => Ok(()),
        Some(k) => wrong(format!("another row {}", k / 3), "what was given".into()),
    }
}
