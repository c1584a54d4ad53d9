//! [`render`]: a picture, pass by pass.

use crate::film::{Film, Kept};
use crate::pass::take_pass;
use crate::{Exposure, Integrator, PixelFilter, RayCounts, RenderError};
use gonio_radiometry::sequence::SamplerKind;
use gonio_scene::{Camera, Scene};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// When a rendering is finished: at the first target that is reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Samples per pixel: the index after the last one.
    pub samples: u32,
    /// Wall-clock time.
    pub time: Option<Duration>,
    /// Noise, [`Film::noise`]: 0.02 is 2 %.
    pub noise: Option<f64>,
}

/// How a picture is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderOptions {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// When to stop.
    pub target: Target,
    /// How the reflection equation is solved.
    pub integrator: Integrator,
    /// Which sequence the samples come from.
    pub sampler: SamplerKind,
    /// The pixel filter.
    pub filter: PixelFilter,
    /// Seed of the sequence.
    pub seed: u64,
    /// Layers to keep beside those that every film has. They leave the picture as it is, to the bit.
    pub keep: Kept,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            width: 512,
            height: 512,
            target: Target {
                samples: 64,
                time: None,
                noise: None,
            },
            integrator: Integrator::default(),
            sampler: SamplerKind::Sobol,
            filter: PixelFilter::default(),
            seed: 0,
            keep: Kept::NOTHING,
        }
    }
}

/// How far a rendering has come, told after each pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Samples per pixel so far.
    pub samples: u32,
    /// Samples per pixel at which it ends at the latest.
    pub of: u32,
    /// Rays followed so far.
    pub rays: RayCounts,
    /// Time spent so far.
    pub elapsed: Duration,
    /// [`Film::noise`] so far.
    pub noise: f64,
}

/// Why a rendering ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stop {
    /// All samples were taken.
    Samples,
    /// The time was spent.
    Time,
    /// The noise was low enough.
    Noise,
    /// The progress callback asked to stop.
    Interrupted,
}

/// Samples of every pixel in one pass, the unit between two looks at the noise. Passes double from 1, so that a first
/// picture is there at once, up to this many.
const LARGEST_PASS: u32 = 16;
/// A pass that takes longer than this is done in pieces, with a look at the clock and at the user's wishes after each. The
/// noise is judged after whole passes alone: where it ends a rendering does not depend on the machine's speed.
const LONGEST_PIECE: Duration = Duration::from_secs(1);
/// Stopping by noise needs this many samples before it trusts its own estimate.
const LEAST_SAMPLES_FOR_NOISE: u32 = 16;

/// Takes a picture of `scene` through `camera`, on the threads of the current rayon pool.
///
/// `progress` is called after each pass with what was done and the film so far; `ControlFlow::Break` ends the rendering
/// early. The film it leaves is whole: every pixel has the same number of samples.
///
/// The same options give the same bits on any number of threads. A target of time or noise only decides *how many* samples
/// are taken.
///
/// # Errors
/// A film of no pixels or too many, no samples, a noise target that is not positive, or another number of groups of lights than the scene
/// has.
pub fn render(
    scene: &Scene,
    camera: &Camera,
    options: &RenderOptions,
    mut progress: impl FnMut(&Progress, &Film) -> ControlFlow<()>,
) -> Result<(Film, Stop), RenderError> {
    let mut exposure = Exposure::keeping(options.keep, options.width, options.height, 0)?;
    let stop = expose(scene, camera, options, &mut exposure, |report, exposure| {
        progress(report, &exposure.film)
    })?;
    Ok((exposure.film, stop))
}

/// As [`render`], from the last sample of `exposure` on: [`Target::samples`] is the index after the last sample to take, and time is that
/// of `exposure` as well. Whatever `exposure` began from, and however often it was interrupted, the sums are those of its range of samples.
///
/// # Errors
/// As [`render`]; an exposure of another size or of other layers, or one that has more samples than the target.
pub fn expose(
    scene: &Scene,
    camera: &Camera,
    options: &RenderOptions,
    exposure: &mut Exposure,
    mut progress: impl FnMut(&Progress, &Exposure) -> ControlFlow<()>,
) -> Result<Stop, RenderError> {
    check(options, exposure)?;
    options.keep.check(scene.lights.groups().len())?;
    let target = options.target;
    let (start, before) = (Instant::now(), exposure.elapsed);
    let (first, went_on_from) = (exposure.samples.start, exposure.samples.end);
    let mut pass_ends = first.saturating_add(end_of_pass(went_on_from - first));
    let mut piece = 1;
    let quiet = |exposure: &Exposure, noise: f64| {
        let done = exposure.samples.end - first;
        done >= LEAST_SAMPLES_FOR_NOISE
            && done == start_of_pass(done)
            && target.noise.is_some_and(|n| noise <= n)
    };
    let stop = |exposure: &Exposure, noise: f64| {
        if exposure.samples.end == target.samples {
            Some(Stop::Samples)
        } else if quiet(exposure, noise) {
            Some(Stop::Noise)
        } else {
            let late = target.time.is_some_and(|t| exposure.elapsed >= t);
            late.then_some(Stop::Time)
        }
    };
    if !exposure.samples.is_empty()
        && let Some(stop) = stop(exposure, exposure.film.noise())
    {
        return Ok(stop);
    }
    loop {
        let done = exposure.samples.end;
        let until = done
            .saturating_add(piece)
            .min(pass_ends)
            .min(target.samples);
        exposure.rays += take_pass(scene, camera, options, &mut exposure.film, done..until);
        exposure.samples.end = until;
        exposure.elapsed = before + start.elapsed();
        if until == pass_ends {
            pass_ends = first.saturating_add(end_of_pass(until - first));
        }
        let report = Progress {
            samples: until - first,
            of: target.samples - first,
            rays: exposure.rays,
            elapsed: exposure.elapsed,
            noise: exposure.film.noise(),
        };
        let asked = progress(&report, exposure);
        match stop(exposure, report.noise) {
            Some(stop @ Stop::Samples) => return Ok(stop),
            _ if asked.is_break() => return Ok(Stop::Interrupted),
            Some(stop) => return Ok(stop),
            None => {}
        }
        let left = target.time.map(|t| t.saturating_sub(report.elapsed));
        piece = samples_within(
            left.unwrap_or(LONGEST_PIECE),
            until - went_on_from,
            start.elapsed(),
        );
    }
}

fn check(options: &RenderOptions, exposure: &Exposure) -> Result<(), RenderError> {
    let target = options.target;
    let taken = &exposure.samples;
    let fault = |option, found: String, expected| {
        Err(RenderError::Parameter {
            option,
            found,
            expected,
        })
    };
    if target.samples <= taken.start {
        return fault(
            "samples",
            target.samples.to_string(),
            "at least 1 sample per pixel",
        );
    }
    if target.samples < taken.end {
        return fault(
            "samples",
            format!("{}, after {} that are taken", target.samples, taken.end),
            "at least as many as are taken",
        );
    }
    if let Some(noise) = target.noise
        && !(noise > 0.0 && noise.is_finite())
    {
        return fault(
            "noise",
            noise.to_string(),
            "a positive relative error such as 0.02",
        );
    }
    let film = &exposure.film;
    if (film.width(), film.height()) != (options.width, options.height) {
        return fault(
            "size",
            format!("{}×{}", options.width, options.height),
            "the size of the film",
        );
    }
    if film.kept() != options.keep {
        return fault("layers", options.keep.to_string(), "those of the film");
    }
    Ok(())
}

/// The number of samples at the end of the pass in which sample `k` is taken: 1, 3, 7, 15, then 16 more each time.
fn end_of_pass(k: u32) -> u32 {
    const DOUBLING: u32 = LARGEST_PASS - 1;
    if k < DOUBLING {
        (k + 2).next_power_of_two().max(2) - 1
    } else {
        let more = (k - DOUBLING) / LARGEST_PASS + 1;
        DOUBLING.saturating_add(more.saturating_mul(LARGEST_PASS))
    }
}

/// The number of samples at the beginning of that pass: `k` itself, if a pass ends before it.
fn start_of_pass(k: u32) -> u32 {
    const DOUBLING: u32 = LARGEST_PASS - 1;
    if k < DOUBLING {
        end_of_pass(k) / 2
    } else {
        DOUBLING + (k - DOUBLING) / LARGEST_PASS * LARGEST_PASS
    }
}

/// Samples that fit into `left`, and into the longest piece, at the pace of `done` samples in `elapsed`; at least one.
fn samples_within(left: Duration, done: u32, elapsed: Duration) -> u32 {
    let seconds = left.min(LONGEST_PIECE).as_secs_f64();
    // A conversion to an integer saturates, for a pace that is too fast to measure as well.
    ((seconds * f64::from(done) / elapsed.as_secs_f64()) as u32).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_double_up_to_sixteen() {
        let mut ends = vec![0];
        while ends[ends.len() - 1] < 60 {
            let done = ends[ends.len() - 1];
            assert_eq!(start_of_pass(done), done);
            ends.push(end_of_pass(done));
        }
        assert_eq!(ends, [0, 1, 3, 7, 15, 31, 47, 63]);
        // Within a pass as at its beginning.
        for k in 0..60 {
            let end = ends.iter().copied().find(|e| *e > k).unwrap();
            let start = ends.iter().copied().rfind(|e| *e <= k).unwrap();
            assert_eq!((start_of_pass(k), end_of_pass(k)), (start, end), "{k}");
        }
        assert_eq!(end_of_pass(u32::MAX), u32::MAX);
    }

    #[test]
    fn pieces_fit_the_time_that_is_left() {
        let seconds = Duration::from_secs_f64;
        // A hundred samples a second: one second at most.
        assert_eq!(samples_within(seconds(60.0), 200, seconds(2.0)), 100);
        assert_eq!(samples_within(seconds(0.25), 200, seconds(2.0)), 25);
        // Slower than that, and out of time: one.
        assert_eq!(samples_within(seconds(60.0), 1, seconds(9.0)), 1);
        assert_eq!(samples_within(seconds(0.0), 200, seconds(2.0)), 1);
        assert_eq!(samples_within(seconds(60.0), 1, seconds(0.0)), u32::MAX);
    }
}
