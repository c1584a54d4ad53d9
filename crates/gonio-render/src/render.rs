//! [`render`]: a picture, pass by pass.

use crate::film::Film;
use crate::pass::take_pass;
use crate::{Integrator, PixelFilter, RayCounts, RenderError};
use gonio_radiometry::sequence::SamplerKind;
use gonio_scene::{Camera, Scene};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// When a rendering is finished: at the first target that is reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Samples per pixel.
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
/// A film of no pixels or too many, no samples, or a noise target that is not positive.
pub fn render(
    scene: &Scene,
    camera: &Camera,
    options: &RenderOptions,
    mut progress: impl FnMut(&Progress, &Film) -> ControlFlow<()>,
) -> Result<(Film, Stop), RenderError> {
    let target = options.target;
    if target.samples == 0 {
        return Err(RenderError::Parameter {
            option: "samples",
            found: "0".into(),
            expected: "at least 1 sample per pixel",
        });
    }
    if let Some(noise) = target.noise
        && !(noise > 0.0 && noise.is_finite())
    {
        return Err(RenderError::Parameter {
            option: "noise",
            found: noise.to_string(),
            expected: "a positive relative error such as 0.02",
        });
    }
    let mut film = Film::new(options.width, options.height)?;
    let start = Instant::now();
    let mut rays = RayCounts::default();
    let mut done = 0_u32;
    let mut pass = 1_u32;
    let mut pass_ends = pass;
    let mut piece = 1;
    loop {
        let until = done
            .saturating_add(piece)
            .min(pass_ends)
            .min(target.samples);
        rays += take_pass(scene, camera, options, &mut film, done..until);
        done = until;
        let pass_is_whole = done == pass_ends;
        if pass_is_whole {
            pass = (pass * 2).min(LARGEST_PASS);
            pass_ends = pass_ends.saturating_add(pass);
        }

        let report = Progress {
            samples: done,
            of: target.samples,
            rays,
            elapsed: start.elapsed(),
            noise: film.noise(),
        };
        let asked = progress(&report, &film);
        let quiet = pass_is_whole && target.noise.is_some_and(|n| report.noise <= n);
        let stop = if done == target.samples {
            Stop::Samples
        } else if asked.is_break() {
            Stop::Interrupted
        } else if quiet && done >= LEAST_SAMPLES_FOR_NOISE {
            Stop::Noise
        } else if target.time.is_some_and(|t| report.elapsed >= t) {
            Stop::Time
        } else {
            let left = target.time.map(|t| t.saturating_sub(report.elapsed));
            piece = samples_within(left.unwrap_or(LONGEST_PIECE), done, report.elapsed);
            continue;
        };
        return Ok((film, stop));
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
