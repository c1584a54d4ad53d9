//! The sums of a pixel as bytes.

use super::Film;
use super::kept::Kept;
use super::levels::{self, Levels};
use super::pixel::{DEPTH, PixelSums, RADIANCE, SQUARES};
use super::triple::{Nearest, Triple};

/// Numbers of a pixel in every film, in this order: the places of the highest digits (7), the digits of radiance (2 for each of R, G and
/// B), of its square (3 for each) and of depth (2), albedo (3), normal (3), hits, samples. Sums that may be negative are doubled, and those
/// that are negative are 1 less than twice their amount.
const COMMON: usize = 32;
/// Numbers of sums of three more numbers: places (3), digits (2 for each).
const OF_TRIPLE: usize = 9;
/// Numbers of the material: squared distance, index.
const OF_MATERIAL: usize = 2;
/// Numbers of the levels of brightness: three for each.
const OF_LEVELS: usize = 3 * levels::COUNT;

/// Numbers of a pixel in a film that keeps these layers: first those of every film, then those of the position and of each share, then those
/// of the material, then those of the levels of brightness.
pub(crate) fn columns_of(kept: &Kept) -> usize {
    let with = |kept: bool, count: usize| if kept { count } else { 0 };
    COMMON
        + OF_TRIPLE * kept.triples()
        + with(kept.material, OF_MATERIAL)
        + with(kept.reweighted, OF_LEVELS)
}

/// The number of bytes that each number takes, 0 to 8: enough for the largest in the film.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Widths {
    kept: Kept,
    bytes: Vec<u8>,
}

/// Everything that is known of a pixel, as it comes from a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Record {
    sums: PixelSums,
    triples: Vec<Triple>,
    nearest: Option<Nearest>,
    levels: Option<Levels>,
}

impl Widths {
    /// The smallest that hold all pixels.
    pub fn of(film: &Film) -> Self {
        let mut all = vec![0; columns_of(&film.kept)];
        for pixel in 0..film.pixels.len() {
            for (bits, number) in all.iter_mut().zip(film.numbers(pixel)) {
                *bits |= number;
            }
        }
        let width = |bits: u64| (64 - bits.leading_zeros()).div_ceil(8) as u8;
        Self {
            kept: film.kept,
            bytes: all.into_iter().map(width).collect(),
        }
    }

    /// From a file; nothing unless there are [`columns_of`] of 0 to 8.
    pub fn from_slice(kept: Kept, bytes: &[u8]) -> Option<Self> {
        let good = bytes.len() == columns_of(&kept) && bytes.iter().all(|w| *w <= 8);
        let bytes = bytes.to_vec();
        good.then_some(Self { kept, bytes })
    }

    pub fn as_slice(&self) -> &[u8] {
        &self.bytes
    }

    /// Bytes of a pixel.
    pub fn bytes(&self) -> usize {
        self.bytes.iter().map(|w| usize::from(*w)).sum()
    }

    /// Appends the bytes of pixel `index` of the film that the widths are of.
    pub fn write(&self, film: &Film, index: usize, bytes: &mut Vec<u8>) {
        for (width, number) in self.bytes.iter().zip(film.numbers(index)) {
            bytes.extend_from_slice(&number.to_le_bytes()[..usize::from(*width)]);
        }
    }

    /// Reads the pixel of [`Widths::bytes`] bytes into `record`; nothing if they can't be the sums of at most `count` samples.
    pub fn read(&self, bytes: &[u8], count: u32, record: &mut Record) -> Option<()> {
        let mut at = 0;
        let mut numbers = self.bytes.iter().map_while(|width| {
            let end = at + usize::from(*width);
            let mut whole = [0; 8];
            whole[..usize::from(*width)].copy_from_slice(bytes.get(at..end)?);
            at = end;
            Some(u64::from_le_bytes(whole))
        });
        record.sums = common(&mut numbers)?;
        record
            .triples
            .resize(self.kept.triples(), Triple::default());
        for triple in &mut record.triples {
            for top in &mut triple.tops {
                *top = numbers.next()?.try_into().ok()?;
            }
            for digit in triple.digits.as_flattened_mut() {
                *digit = numbers.next()?;
            }
        }
        record.nearest = None;
        if self.kept.material {
            let mut next = || numbers.next()?.try_into().ok();
            let (distance, material) = (next()?, next()?);
            record.nearest = Some(Nearest { distance, material });
        }
        record.levels = None;
        if self.kept.reweighted {
            let levels = record.levels.insert(Levels::default());
            for sum in levels.0.as_flattened_mut() {
                *sum = numbers.next()?;
            }
        }
        record.is_sound(count).then_some(())
    }
}

impl Record {
    fn is_sound(&self, count: u32) -> bool {
        let samples = self.sums.samples;
        self.sums.is_sound(count)
            && self.triples.iter().all(|t| t.is_sound(samples))
            && self.nearest.is_none_or(|n| n.is_sound())
            && self.levels.is_none_or(|l| l.is_sound(samples))
    }
}

impl Film {
    /// Adds what a file has of pixel `index`, of a film that keeps the same layers.
    pub(crate) fn merge_pixel(&mut self, index: usize, record: &Record) {
        self.pixels[index].merge(&record.sums);
        let each = self.kept.triples();
        let own = &mut self.triples[index * each..(index + 1) * each];
        for (sum, other) in own.iter_mut().zip(&record.triples) {
            sum.merge(other);
        }
        if let (Some(own), Some(other)) = (self.nearest.get_mut(index), record.nearest) {
            own.merge(other);
        }
        if let (Some(own), Some(other)) = (self.levels.get_mut(index), &record.levels) {
            own.merge(other);
        }
    }

    /// The numbers of pixel `index`, in the order of [`columns_of`].
    fn numbers(&self, index: usize) -> impl Iterator<Item = u64> + '_ {
        let pixel = &self.pixels[index];
        let each = self.kept.triples();
        let triples = &self.triples[index * each..(index + 1) * each];
        let of_triple = |t: &'_ Triple| {
            let [[a, b], [c, d], [e, f]] = t.digits;
            let [x, y, z] = t.tops.map(u64::from);
            [x, y, z, a, b, c, d, e, f]
        };
        let of_material = |n: &Nearest| [n.distance, n.material].map(u64::from);
        numbers(pixel)
            .chain(triples.iter().flat_map(of_triple))
            .chain(self.nearest.get(index).into_iter().flat_map(of_material))
            .chain((self.levels.get(index).into_iter()).flat_map(|l| l.0.as_flattened().to_vec()))
    }
}

/// Of the sums that are binned, those of a file in its order, with their number of digits.
const OF_FILE: [(usize, usize); 7] = [
    (RADIANCE, 2),
    (RADIANCE + 1, 2),
    (RADIANCE + 2, 2),
    (SQUARES, 3),
    (SQUARES + 1, 3),
    (SQUARES + 2, 3),
    (DEPTH, 2),
];

/// The numbers that every film has.
fn numbers(pixel: &PixelSums) -> impl Iterator<Item = u64> + '_ {
    let tops = OF_FILE.iter().map(|&(sum, _)| u64::from(pixel.tops[sum]));
    let digits_of = |&(sum, count): &(usize, usize)| pixel.digits_of(sum).into_iter().take(count);
    tops.chain(OF_FILE.iter().flat_map(digits_of))
        .chain(pixel.surface.map(unsigned))
        .chain([pixel.hits, pixel.samples].map(u64::from))
}

fn common(rest: &mut impl Iterator<Item = u64>) -> Option<PixelSums> {
    let mut pixel = PixelSums::default();
    for (sum, _) in OF_FILE {
        pixel.tops[sum] = rest.next()?.try_into().ok()?;
    }
    for (sum, count) in OF_FILE {
        let mut digits = [0; 3];
        for digit in &mut digits[..count] {
            *digit = rest.next()?;
        }
        pixel.set_digits(sum, digits);
    }
    for sum in &mut pixel.surface {
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
    use crate::film::{FilmSample, FirstSurface, Place, Rejected};

    #[test]
    fn signs_come_back() {
        for x in [0, -1, 1, i64::MAX, i64::MIN, -123_456_789] {
            assert_eq!(signed(unsigned(x)), x);
        }
    }

    #[test]
    fn pixels_come_back() {
        let all = Kept {
            position: true,
            material: true,
            direct: true,
            indirect: true,
            groups: 2,
            reweighted: true,
        };
        for kept in [Kept::NOTHING, all] {
            let mut film = Film::keeping(kept, 3, 1).unwrap();
            let row = &mut film.rows_mut()[0];
            for k in 1..20_u16 {
                let l = 1.0 / f32::from(k);
                let sample = FilmSample {
                    radiance: [l, l * l, 1e3 * l],
                    first: Some(FirstSurface {
                        albedo: [l; 3],
                        normal: [-l, l, 0.0],
                        position: [-l, 1e6 * l, 0.0],
                        depth: 7.0 * l,
                        material: u32::from(k),
                    }),
                };
                let shares = [sample.radiance, [l; 3], [0.0; 3], [1e9 * l; 3]];
                let place = Place {
                    pixel: [u32::from(k % 2), 0],
                    index: 0,
                    off_centre: l,
                };
                row.add(
                    &sample,
                    &shares[..kept.shares()],
                    &place,
                    &mut Rejected::default(),
                );
            }
            let widths = Widths::of(&film);
            assert_eq!(
                Widths::from_slice(kept, widths.as_slice()),
                Some(widths.clone())
            );
            let mut bytes = Vec::new();
            (0..3).for_each(|i| widths.write(&film, i, &mut bytes));
            assert_eq!(bytes.len(), 3 * widths.bytes());
            let mut again = Film::keeping(kept, 3, 1).unwrap();
            let mut found = Record::default();
            for (i, record) in bytes.chunks(widths.bytes()).enumerate() {
                assert_eq!(widths.read(record, 10, &mut found), Some(()));
                again.merge_pixel(i, &found);
                assert_eq!(widths.read(&record[1..], 10, &mut found), None);
            }
            assert_eq!(again.pixels, film.pixels);
            assert_eq!(again.triples, film.triples);
            assert_eq!(again.nearest, film.nearest);
            assert_eq!(again.levels, film.levels);
            // More samples than there were taken, and a place that no sum has.
            assert_eq!(widths.read(&bytes, 8, &mut found), None);
            bytes[0] = 255;
            assert_eq!(widths.read(&bytes, 10, &mut found), None);
            assert_eq!(Widths::from_slice(kept, &vec![9; columns_of(&kept)]), None);
            assert_eq!(Widths::from_slice(kept, &[1; 3]), None);
        }
    }
}
