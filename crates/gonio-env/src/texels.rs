//! Texels that can't be a radiance: found, named, replaced.

use crate::EnvError;
use gonio_image::Image;
use std::path::Path;

/// What was wrong with a picture's texels and has been replaced.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Defects {
    /// Texels with a NaN or an infinite channel.
    pub non_finite: u64,
    /// Other texels with a negative channel.
    pub negative: u64,
}

/// What is done about texels that are NaN, infinite or negative.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Remedy {
    /// The first is an error.
    #[default]
    Refuse,
    /// NaN, −∞ and negative values become 0, +∞ the largest finite value.
    Clamp,
    /// The mean of the sound neighbours.
    Neighbours,
}

fn is_sound(texel: [f32; 3]) -> bool {
    texel.into_iter().all(|c| c.is_finite() && c >= 0.0)
}

/// Looks at the texels for which `shown(x, y)`, and replaces those that are unsound, or refuses the first.
pub(crate) fn check(
    image: &mut Image,
    shown: impl Fn(usize, usize) -> bool,
    file: Option<&Path>,
    remedy: Remedy,
) -> Result<Defects, EnvError> {
    let mut defects = Defects::default();
    let mut unsound = Vec::new();
    let mut largest = 0.0_f32;
    for (i, texel) in image.pixels.iter().enumerate() {
        if is_sound(*texel) {
            largest = texel.iter().copied().fold(largest, f32::max);
            continue;
        }
        let (x, y) = (i % image.width, i / image.width);
        if !shown(x, y) {
            continue;
        }
        let finite = texel.iter().copied().filter(|c| c.is_finite());
        largest = finite.fold(largest, f32::max);
        if texel.iter().all(|c| c.is_finite()) {
            defects.negative += 1;
        } else {
            defects.non_finite += 1;
        }
        unsound.push(i);
    }
    let Some(&first) = unsound.first() else {
        return Ok(defects);
    };
    match remedy {
        Remedy::Refuse => {
            let texel = image.pixels[first];
            let c = texel
                .into_iter()
                .position(|c| !(c.is_finite() && c >= 0.0))
                .unwrap_or(0);
            return Err(EnvError::Texel {
                file: file.map(Path::to_owned),
                x: first % image.width,
                y: first / image.width,
                channel: ['R', 'G', 'B'][c],
                value: texel[c],
                count: defects.non_finite + defects.negative,
            });
        }
        Remedy::Clamp => {
            for c in image.pixels.iter_mut().flatten() {
                if *c == f32::INFINITY {
                    *c = largest;
                } else if !(c.is_finite() && *c >= 0.0) {
                    *c = 0.0;
                }
            }
        }
        Remedy::Neighbours => fill(image, unsound),
    }
    Ok(defects)
}

/// Gives each unsound texel the mean of its sound neighbours of eight, from the rim of a hole inwards; black where a
/// picture has no sound texel at all.
fn fill(image: &mut Image, mut unsound: Vec<usize>) {
    let (width, height) = (image.width, image.height);
    while !unsound.is_empty() {
        let mut filled = Vec::new();
        let mut left = Vec::new();
        for &i in &unsound {
            let (x, y) = (i % width, i / width);
            let (mut sum, mut count) = ([0.0_f64; 3], 0_u32);
            for ny in y.saturating_sub(1)..=(y + 1).min(height - 1) {
                for nx in x.saturating_sub(1)..=(x + 1).min(width - 1) {
                    let texel = image.pixels[ny * width + nx];
                    if is_sound(texel) {
                        count += 1;
                        for (s, c) in sum.iter_mut().zip(texel) {
                            *s += f64::from(c);
                        }
                    }
                }
            }
            if count == 0 {
                left.push(i);
            } else {
                filled.push((i, sum.map(|s| (s / f64::from(count)) as f32)));
            }
        }
        if filled.is_empty() {
            for i in left {
                image.pixels[i] = [0.0; 3];
            }
            return;
        }
        for (i, texel) in filled {
            image.pixels[i] = texel;
        }
        unsound = left;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_are_filled_from_their_rim() {
        let mut image = Image::filled(7, 5, [2.0, 1.0, 0.5]);
        for (x, y) in [(2, 1), (3, 1), (3, 2), (4, 2), (3, 3)] {
            image.set(x, y, [f32::NAN, 1.0, -1.0]);
        }
        let defects = check(&mut image, |_, _| true, None, Remedy::Neighbours).unwrap();
        assert_eq!((defects.non_finite, defects.negative), (5, 0));
        assert_eq!(image, Image::filled(7, 5, [2.0, 1.0, 0.5]));
        let mut lost = Image::filled(2, 2, [f32::NAN; 3]);
        check(&mut lost, |_, _| true, None, Remedy::Neighbours).unwrap();
        assert_eq!(lost, Image::new(2, 2));
    }
}
