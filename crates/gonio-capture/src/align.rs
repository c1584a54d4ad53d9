//! [`align`], exposures of one view brought over each other.
//!
//! Ward 2003, "Fast, Robust Image Registration for Compositing High Dynamic Range Photographs from Hand-Held Exposures": which pixels
//! are brighter than a quantile depends neither on the exposure nor on the response curve. Two such pictures of signs are correlated at shifts of
//! one pixel, from a small picture, where all shifts are tried, to the full one. Unlike Ward's their sign is soft: within a fifth of the pixels around the
//! threshold it grows in proportion, so that noise turns little and a peak is where edges meet. The quantile is the
//! one nearest to the median that neither photograph clips. The ball and its surroundings alone are compared: what is far behind it
//! moves otherwise when the camera does.

use crate::CaptureError;
use crate::photo::Photo;
use gonio_image::{RawData, RawImage};

/// Share of the pixels that may be bright in one and dark in the other. Of simulated exposures of one view up to 0.03 are, at the quantile that
/// is nearest to noise; of two views of one landscape, which are alike in sky and ground, 0.2 and more.
pub const MOST_DIFFERENT: f64 = 0.1;
/// Share of the pixels on each side of the threshold whose sign is soft.
const SOFT: f64 = 0.1;
/// Codes \[1/255] of thresholds: outside a camera has clipped, or has nothing but noise.
const CODES: [f32; 2] = [8.0, 244.0];
/// Quantiles, the nearest to the median first.
const QUANTILES: [f64; 7] = [0.5, 0.38, 0.62, 0.25, 0.75, 0.14, 0.86];
/// Shorter side \[pixels] of the smallest picture.
const SMALLEST: usize = 24;
/// Pixels that are compared at most.
const MOST_PIXELS: usize = 400_000;
/// Codes \[1/255] over which a sign has to be soft to tell anything: below, noise turns it.
const TELLING: f32 = 3.0;
/// Correlation of the signs without which nothing is told.
const LEAST_CORRELATION: f64 = 0.5;
/// Pixels without which nothing is told.
const FEWEST: usize = 64;

/// How a photograph lies against the one before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shift {
    /// Where a place is here, less where it is in the other \[pixels: right, down].
    pub pixels: [i64; 2],
    /// Share of the firm pixels that are bright in one and dark in the other, at the quantile at which it is largest.
    pub different: f64,
}

/// A rectangle of pixels: left, top, width, height.
type Window = [usize; 4];

/// A picture of one number a pixel.
#[derive(Debug, Clone)]
struct Grey {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl Grey {
    /// The green codes of a photograph in a window.
    fn of(photo: &Photo, [left, top, width, height]: Window) -> Self {
        let row = |y: usize| (top + y) * photo.picture.width + left;
        let values = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| photo.code(row(y) + x)[1])
            .collect();
        Self {
            width,
            height,
            values,
        }
    }

    /// Half as large.
    fn halved(&self) -> Self {
        let (width, height) = (self.width / 2, self.height / 2);
        let mut values = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let at = 2 * y * self.width + 2 * x;
                let two = |i: usize| self.values[i] + self.values[i + 1];
                values.push(0.25 * (two(at) + two(at + self.width)));
            }
        }
        Self {
            width,
            height,
            values,
        }
    }

    fn quantile(&self, q: f64) -> f32 {
        let mut all = self.values.clone();
        let n = ((all.len() - 1) as f64 * q) as usize;
        *all.select_nth_unstable_by(n, f32::total_cmp).1
    }

    /// For each pixel −1 to 1: how firmly it is brighter than the threshold.
    fn signs(&self, [threshold, soft]: [f32; 2]) -> Vec<f32> {
        let sign = |v: &f32| ((v - threshold) / soft).clamp(-1.0, 1.0);
        self.values.iter().map(sign).collect()
    }
}

/// A quantile's code in each of two photographs, and over how many codes a sign is soft. `None` if one of them clips it, or is flat.
fn threshold(a: &Grey, b: &Grey, q: f64, coded: bool) -> Option<[[f32; 2]; 2]> {
    let codes = [a, b].map(|g| {
        let [low, middle, high] = [q - SOFT, q, q + SOFT].map(|q| g.quantile(q));
        [middle, 0.5 * (high - low)]
    });
    let inside = |[c, soft]: [f32; 2]| {
        let telling = if coded { TELLING } else { 1e-3 * c.abs() };
        (!coded || (CODES[0]..=CODES[1]).contains(&c)) && soft > telling
    };
    codes.iter().all(|c| inside(*c)).then_some(codes)
}

/// How two pictures of signs agree.
#[derive(Debug, Clone, Copy)]
struct Score {
    /// 1 if they are the same.
    correlation: f64,
    /// Share of the firm pixels that differ.
    different: f64,
    /// Firm pixels.
    firm: usize,
}

/// How the pictures of signs agree if `b` lies at `shift` against `a`.
fn score(a: &[f32], b: &[f32], [w, h]: [usize; 2], [dx, dy]: [i64; 2]) -> Score {
    let stride = (w * h).div_ceil(MOST_PIXELS).max(1);
    // Columns x of `a` for which x + dx is one of `b`.
    let span = |d: i64, n: usize| {
        let n = n as i64;
        let low = (-d).clamp(0, n) as usize;
        (low, ((n - d).clamp(0, n) as usize).max(low))
    };
    let ((x0, x1), (y0, y1)) = (span(dx, w), span(dy, h));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    let (mut different, mut firm) = (0, 0);
    for y in (y0..y1).step_by(stride) {
        let from = ((y as i64 + dy) * w as i64 + x0 as i64 + dx) as usize;
        let (row, other) = (&a[y * w + x0..y * w + x1], &b[from..from + x1 - x0]);
        let (mut rab, mut raa, mut rbb) = (0.0_f32, 0.0_f32, 0.0_f32);
        for (s, t) in row.iter().zip(other) {
            rab += s * t;
            raa += s * s;
            rbb += t * t;
            different += usize::from(s * t <= -1.0);
            firm += usize::from((s * t).abs() >= 1.0);
        }
        ab += f64::from(rab);
        aa += f64::from(raa);
        bb += f64::from(rbb);
    }
    Score {
        correlation: ab / (aa * bb).sqrt().max(1e-30),
        different: different as f64 / firm.max(1) as f64,
        firm,
    }
}

/// How `b` lies against `a`; `None` if their codes don't tell: they have no quantile that neither clips, or are flat.
fn shift(a: &Photo, b: &Photo, window: Window) -> Option<Shift> {
    let coded = a.is_coded() && b.is_coded();
    let mut levels = vec![[Grey::of(a, window), Grey::of(b, window)]];
    while let Some([x, y]) = levels.last()
        && x.width.min(x.height) >= 2 * SMALLEST
    {
        let half = [x.halved(), y.halved()];
        levels.push(half);
    }
    let [x, y] = &levels[0];
    let found = QUANTILES
        .into_iter()
        .find_map(|q| threshold(x, y, q, coded))?;
    let mut at = [0_i64; 2];
    let mut best = None;
    for (k, [x, y]) in levels.iter().rev().enumerate() {
        let size = [x.width, x.height];
        let signs = [x.signs(found[0]), y.signs(found[1])];
        // All shifts of the smallest picture up to a quarter of it, then those beside twice the last.
        let (from, reach) = if k == 0 {
            ([0, 0], (x.width.min(x.height) / 4) as i64)
        } else {
            (at.map(|d| 2 * d), 1)
        };
        let mut here = score(&signs[0], &signs[1], size, from);
        at = from;
        for (dx, dy) in (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| (x, y))) {
            let candidate = [from[0] + dx, from[1] + dy];
            let there = score(&signs[0], &signs[1], size, candidate);
            if there.firm >= FEWEST && there.correlation > here.correlation {
                (here, at) = (there, candidate);
            }
        }
        best = Some(here);
    }
    let best = best.filter(|b| b.firm >= FEWEST)?;
    // Any two landscapes are bright above and dark below: what is no coincidence agrees at every quantile.
    let [x, y] = &levels[0];
    let different = QUANTILES
        .into_iter()
        .filter_map(|q| threshold(x, y, q, coded))
        .map(|[a, b]| score(&x.signs(a), &y.signs(b), [x.width, x.height], at))
        .filter(|s| s.firm >= FEWEST)
        .map(|s| s.different)
        .fold(0.0, f64::max);
    (best.correlation >= LEAST_CORRELATION || different > MOST_DIFFERENT).then_some(Shift {
        pixels: at,
        different,
    })
}

/// The square around a circle, a quarter wider, within a picture.
fn window(circle: Option<[f64; 3]>, [w, h]: [usize; 2]) -> Window {
    let Some([x, y, r]) = circle else {
        return [0, 0, w, h];
    };
    let side = |c: f64, n: usize| {
        let low = (c - 1.25 * r).clamp(0.0, n as f64) as usize;
        let high = (c + 1.25 * r).clamp(0.0, n as f64) as usize;
        (low, high.max(low) - low)
    };
    let ((left, width), (top, height)) = (side(x, w), side(y, h));
    if width < 2 || height < 2 {
        return [0, 0, w, h];
    }
    [left, top, width, height]
}

/// What [`align`] has done.
#[derive(Debug, Clone, PartialEq)]
pub struct Aligned {
    /// Where the ball is in each photograph, less where it is in the reference \[pixels: right, down]; `None` where that can't be told.
    pub shifts: Vec<Option<[i64; 2]>>,
    /// Which photograph is the reference.
    pub reference: usize,
    /// The photographs over each other, if any had to be moved.
    pub photos: Option<Vec<Photo>>,
}

/// Brings the photographs of one view over the one with the most codes that are neither dark nor clipped, by whole pixels.
///
/// - `exposures`: one a photograph
/// - `circle`: the ball, if it is known where it is
///
/// # Errors
/// [`CaptureError::Size`] for photographs of different sizes; [`CaptureError::NotAligned`] for two that don't show the same.
pub fn align(
    photos: &[Photo],
    exposures: &[f64],
    circle: Option<[f64; 3]>,
) -> Result<Aligned, CaptureError> {
    Photo::check_sizes(photos)?;
    let reference = best_exposed(photos);
    let size = [photos[0].picture.width, photos[0].picture.height];
    let window = window(circle, size);
    let mut order: Vec<usize> = (0..photos.len()).collect();
    order.sort_by(|a, b| exposures[*a].total_cmp(&exposures[*b]));
    let at = order.iter().position(|k| *k == reference).unwrap_or(0);
    let mut shifts = vec![None; photos.len()];
    shifts[reference] = Some([0, 0]);
    // Neighbours in exposure share the most codes: from the reference on to the brighter ones, and to the darker ones.
    let (darker, brighter) = (order[..=at].iter().rev(), order[at..].iter());
    for chain in [
        darker.copied().collect::<Vec<usize>>(),
        brighter.copied().collect(),
    ] {
        for pair in chain.windows(2) {
            let Some(before) = shifts[pair[0]] else {
                break;
            };
            let Some(found) = shift(&photos[pair[0]], &photos[pair[1]], window) else {
                break;
            };
            if found.different > MOST_DIFFERENT {
                return Err(CaptureError::NotAligned {
                    file: photos[pair[1]].name.clone(),
                    other: photos[pair[0]].name.clone(),
                    found: found.different,
                    most: MOST_DIFFERENT,
                });
            }
            let [x, y] = found.pixels;
            shifts[pair[1]] = Some([before[0] + x, before[1] + y]);
        }
    }
    let moved = shifts.iter().flatten().any(|s| *s != [0, 0]);
    let photos = moved.then(|| {
        photos
            .iter()
            .zip(&shifts)
            .map(|(photo, shift)| Photo {
                picture: moved_by(&photo.picture, shift.unwrap_or([0, 0])),
                ..photo.clone()
            })
            .collect()
    });
    Ok(Aligned {
        shifts,
        reference,
        photos,
    })
}

/// The photograph with the most codes in the middle.
pub(crate) fn best_exposed(photos: &[Photo]) -> usize {
    let middle = |photo: &Photo| {
        let n = photo.picture.width * photo.picture.height;
        let stride = (n / 50_000).max(1);
        let codes = (0..n).step_by(stride).map(|i| photo.code(i)[1]);
        codes.filter(|c| (32.0..=224.0).contains(c)).count()
    };
    let counts: Vec<usize> = photos.iter().map(middle).collect();
    // The first of equals.
    (0..photos.len())
        .rev()
        .max_by_key(|k| counts[*k])
        .unwrap_or(0)
}

/// The picture whose pixel (x, y) is the other's (x + dx, y + dy), or the nearest that it has.
fn moved_by(picture: &RawImage, [dx, dy]: [i64; 2]) -> RawImage {
    let (w, h) = (picture.width as i64, picture.height as i64);
    let from: Vec<usize> = (0..h)
        .flat_map(|y| (0..w).map(move |x| (x, y)))
        .map(|(x, y)| ((y + dy).clamp(0, h - 1) * w + (x + dx).clamp(0, w - 1)) as usize)
        .collect();
    fn taken<T: Copy>(data: &[T], from: &[usize]) -> Vec<T> {
        from.iter().map(|i| data[*i]).collect()
    }
    let data = match &picture.data {
        RawData::U8(d) => RawData::U8(taken(d, &from)),
        RawData::U16(d) => RawData::U16(taken(d, &from)),
        RawData::F32(d) => RawData::F32(taken(d, &from)),
    };
    RawImage {
        data,
        ..picture.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photo::Exif;
    use gonio_num::Real;
    use gonio_radiometry::sequence::Rng;

    /// Spots, seen from `at`, exposed by `h`, through a curve, with noise.
    fn shot(at: [i64; 2], h: f64, seed: &str) -> Photo {
        of_spots("spots", at, h, seed)
    }

    fn of_spots(scene: &str, at: [i64; 2], h: f64, seed: &str) -> Photo {
        let mut spots = Rng::from_name(scene);
        let spots: Vec<[f64; 3]> = (0..60)
            .map(|_| [200.0, 150.0, 4.0].map(|size| size * spots.next_f64()))
            .collect();
        let mut rng = Rng::from_name(seed);
        let data = (0..200 * 150)
            .map(|i| {
                let (x, y) = ((i % 200 + at[0]) as f64, (i / 200 + at[1]) as f64);
                let spot = |[a, b, light]: &[f64; 3]| {
                    light * Real::exp(-((x - a) * (x - a) + (y - b) * (y - b)) / 150.0)
                };
                let e = h * (0.1 + spots.iter().map(spot).sum::<f64>());
                let noise = 4.0 * (rng.next_f64() - 0.5);
                let code = 255.0 * Real::powf(e.min(1.0), 0.45) + noise;
                let code = code.clamp(0.0, 255.0) as u8;
                [code, code, code, 255]
            })
            .collect();
        let picture = RawImage {
            width: 200,
            height: 150,
            data: RawData::U8(data),
            has_alpha: false,
        };
        Photo::new(seed, picture, Exif::default())
    }

    /// Each seen from another place: the shift is the difference of the places, reversed.
    #[test]
    fn shifts_between_exposures_are_found_and_undone() {
        let photos = [
            shot([0, 0], 0.2, "a"),
            shot([-5, 3], 0.02, "b"),
            shot([7, -2], 1.5, "c"),
        ];
        let found = align(&photos, &[0.2, 0.02, 1.5], None).unwrap();
        assert_eq!(found.reference, 0);
        assert_eq!(found.shifts, [Some([0, 0]), Some([5, -3]), Some([-7, 2])]);
        let moved = found.photos.unwrap();
        let again = align(&moved, &[0.2, 0.02, 1.5], None).unwrap();
        assert_eq!(again.shifts, [Some([0, 0]); 3]);
        assert_eq!(again.photos, None);
    }

    #[test]
    fn photographs_of_something_else_are_refused() {
        let other = of_spots("other spots", [0, 0], 0.5, "other");
        let photos = [shot([0, 0], 0.2, "this"), other];
        let error = align(&photos, &[0.2, 0.5], None).unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("other doesn't show what this shows"),
            "{error}"
        );
    }

    #[test]
    fn flat_photographs_tell_nothing() {
        let flat = |code: u8| {
            let picture = RawImage {
                width: 60,
                height: 60,
                data: RawData::U8(vec![[code, code, code, 255]; 3600]),
                has_alpha: false,
            };
            Photo::new("flat", picture, Exif::default())
        };
        let found = align(&[flat(100), flat(200)], &[1.0, 2.0], None).unwrap();
        assert_eq!(found.shifts, [Some([0, 0]), None]);
        let found = align(&[flat(0), flat(255)], &[1.0, 2.0], None).unwrap();
        assert_eq!(found.shifts, [Some([0, 0]), None]);
    }

    /// The window is around the ball: what moves otherwise behind it doesn't count.
    #[test]
    fn the_ball_alone_counts() {
        let mut mixed = shot([0, 0], 0.3, "still");
        let turned = shot([4, 4], 0.3, "moved");
        let (RawData::U8(d), RawData::U8(e)) = (&mut mixed.picture.data, &turned.picture.data)
        else {
            panic!()
        };
        for (i, (a, b)) in d.iter_mut().zip(e).enumerate() {
            let (x, y) = ((i % 200) as f64 - 60.0, (i / 200) as f64 - 75.0);
            // A tenth of the picture.
            if x * x + y * y < 900.0 {
                *a = *b;
            }
        }
        let photos = [shot([0, 0], 0.2, "before"), mixed];
        let of = |circle| align(&photos, &[0.2, 0.3], circle).unwrap().shifts[1];
        assert_eq!(of(Some([60.0, 75.0, 22.0])), Some([-4, -4]));
        // Negative control: most of the picture stands still.
        assert_eq!(of(None), Some([0, 0]));
    }
}
