//! Finding values that no light has: NaN, infinite, negative.

use crate::Image;
use serde::Serialize;

/// One sample of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Found {
    /// Column, from the left.
    pub x: usize,
    /// Row, from the top.
    pub y: usize,
    /// 0 red, 1 green, 2 blue.
    pub channel: usize,
    /// What stands there.
    pub value: f32,
}

/// What [`Image::scan`] counted. Each of the three channels of a pixel counts for itself.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Scan {
    /// Samples that are not a number.
    pub nan: u64,
    /// Samples that are +∞ or −∞.
    pub infinite: u64,
    /// Finite samples below 0.
    pub negative: u64,
    /// The first of all of them, row by row from the top left.
    pub first: Option<Found>,
}

impl Scan {
    /// Nothing was found.
    pub fn is_clean(&self) -> bool {
        self.first.is_none()
    }

    /// NaN and infinite samples together.
    pub fn non_finite(&self) -> u64 {
        self.nan + self.infinite
    }
}

impl Image {
    /// Counts the samples that cannot be a radiance, and tells where the first is.
    pub fn scan(&self) -> Scan {
        let mut scan = Scan::default();
        for (i, pixel) in self.pixels.iter().enumerate() {
            for (channel, &value) in pixel.iter().enumerate() {
                let count = if value.is_nan() {
                    &mut scan.nan
                } else if value.is_infinite() {
                    &mut scan.infinite
                } else if value < 0.0 {
                    &mut scan.negative
                } else {
                    continue;
                };
                *count += 1;
                if scan.first.is_none() {
                    scan.first = Some(Found {
                        x: i % self.width,
                        y: i / self.width,
                        channel,
                        value,
                    });
                }
            }
        }
        scan
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_each_kind_and_names_the_first() {
        let mut image = Image::filled(5, 4, [0.0, 1.0, -0.0]);
        assert!(image.scan().is_clean(), "-0 is 0");
        image.set(3, 2, [1.0, f32::NEG_INFINITY, -2.0]);
        image.set(4, 3, [f32::NAN, f32::NAN, f32::INFINITY]);
        let scan = image.scan();
        assert_eq!((scan.nan, scan.infinite, scan.negative), (2, 2, 1));
        assert_eq!(scan.non_finite(), 4);
        let first = scan.first.unwrap();
        assert_eq!((first.x, first.y, first.channel), (3, 2, 1));
    }
}
