//! The sums of a pixel as bytes.

use super::pixel::PixelSums;

/// Numbers of a pixel, in this order: the places of the highest digits (7), the digits of radiance (2 for each of R, G and B), of its
/// square (3 for each) and of depth (2), albedo (3), normal (3), hits, samples. Sums that may be negative are doubled, and those that
/// are negative are 1 less than twice their amount.
pub(crate) const COLUMNS: usize = 32;

/// The number of bytes that each number takes, 0 to 8: enough for the largest in the film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Widths([u8; COLUMNS]);

impl Widths {
    /// The smallest that hold all pixels.
    pub fn of(pixels: &[PixelSums]) -> Self {
        let mut all = [0; COLUMNS];
        for pixel in pixels {
            for (bits, number) in all.iter_mut().zip(columns(pixel)) {
                *bits |= number;
            }
        }
        Self(all.map(|bits: u64| (64 - bits.leading_zeros()).div_ceil(8) as u8))
    }

    /// From a file; nothing unless there are [`COLUMNS`] of 0 to 8.
    pub fn from_slice(widths: &[u8]) -> Option<Self> {
        let widths: [u8; COLUMNS] = widths.try_into().ok()?;
        widths.iter().all(|w| *w <= 8).then_some(Self(widths))
    }

    pub fn as_slice(&self) -> &[u8] {
        &self.0
    }

    /// Bytes of a pixel.
    pub fn bytes(&self) -> usize {
        self.0.iter().map(|w| usize::from(*w)).sum()
    }

    /// Appends the bytes of a pixel.
    pub fn write(&self, pixel: &PixelSums, bytes: &mut Vec<u8>) {
        for (width, number) in self.0.iter().zip(columns(pixel)) {
            bytes.extend_from_slice(&number.to_le_bytes()[..usize::from(*width)]);
        }
    }

    /// The pixel of [`Widths::bytes`] bytes; nothing if they can't be the sums of at most `count` samples.
    pub fn read(&self, bytes: &[u8], count: u32) -> Option<PixelSums> {
        let mut numbers = [0; COLUMNS];
        let mut at = 0;
        for (width, number) in self.0.iter().zip(&mut numbers) {
            let end = at + usize::from(*width);
            let mut whole = [0; 8];
            whole[..usize::from(*width)].copy_from_slice(bytes.get(at..end)?);
            *number = u64::from_le_bytes(whole);
            at = end;
        }
        from_columns(&numbers).filter(|pixel| pixel.is_sound(count))
    }
}

fn columns(pixel: &PixelSums) -> [u64; COLUMNS] {
    let mut all = [0; COLUMNS];
    let numbers = (pixel.tops.iter().map(|t| u64::from(*t)))
        .chain(pixel.radiance.as_flattened().iter().copied())
        .chain(pixel.radiance_squared.as_flattened().iter().copied())
        .chain(pixel.depth)
        .chain(
            pixel
                .albedo
                .iter()
                .chain(&pixel.normal)
                .map(|s| unsigned(*s)),
        )
        .chain([pixel.hits, pixel.samples].map(u64::from));
    for (place, number) in all.iter_mut().zip(numbers) {
        *place = number;
    }
    all
}

fn from_columns(numbers: &[u64; COLUMNS]) -> Option<PixelSums> {
    let mut pixel = PixelSums::default();
    let mut rest = numbers.iter().copied();
    for top in &mut pixel.tops {
        *top = rest.next()?.try_into().ok()?;
    }
    let digits = (pixel.radiance.as_flattened_mut().iter_mut())
        .chain(pixel.radiance_squared.as_flattened_mut())
        .chain(&mut pixel.depth);
    for digit in digits {
        *digit = rest.next()?;
    }
    for sum in pixel.albedo.iter_mut().chain(&mut pixel.normal) {
        *sum = signed(rest.next()?);
    }
    pixel.hits = rest.next()?.try_into().ok()?;
    pixel.samples = rest.next()?.try_into().ok()?;
    Some(pixel)
}

/// 0, −1, 1, −2 … as 0, 1, 2, 3 …: small numbers stay small.
fn unsigned(x: i64) -> u64 {
    ((x << 1) ^ (x >> 63)) as u64
}

fn signed(x: u64) -> i64 {
    (x >> 1) as i64 ^ -((x & 1) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{FilmSample, FirstSurface};

    #[test]
    fn signs_come_back() {
        for x in [0, -1, 1, i64::MAX, i64::MIN, -123_456_789] {
            assert_eq!(signed(unsigned(x)), x);
        }
    }

    #[test]
    fn pixels_come_back() {
        let mut pixels = vec![PixelSums::default(); 3];
        for k in 1..20_u16 {
            let l = 1.0 / f32::from(k);
            pixels[usize::from(k % 2)].add(&FilmSample {
                radiance: [l, l * l, 1e3 * l],
                first: Some(FirstSurface {
                    albedo: [l; 3],
                    normal: [-l, l, 0.0],
                    depth: 7.0 * l,
                    material: 0,
                }),
            });
        }
        let widths = Widths::of(&pixels);
        assert_eq!(Widths::from_slice(widths.as_slice()), Some(widths));
        let mut bytes = Vec::new();
        pixels.iter().for_each(|p| widths.write(p, &mut bytes));
        assert_eq!(bytes.len(), 3 * widths.bytes());
        for (pixel, record) in pixels.iter().zip(bytes.chunks(widths.bytes())) {
            assert_eq!(widths.read(record, 10), Some(*pixel));
            assert_eq!(widths.read(&record[1..], 10), None);
        }
        // More samples than there were taken, and a place that no sum has.
        assert_eq!(widths.read(&bytes, 8), None);
        bytes[0] = 255;
        assert_eq!(widths.read(&bytes, 10), None);
        assert_eq!(Widths::from_slice(&[9; COLUMNS]), None);
        assert_eq!(Widths::from_slice(&[1; 3]), None);
    }
}
