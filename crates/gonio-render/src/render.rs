//! [`render`]: a picture, pass by pass.

use crate::adaptive::{self, Active, Goal};
use crate::film::{Film, Kept};
use crate::integrator::EnvironmentSampling;
use crate::integrator::worth::Worth;
use crate::pass::{Wanted, take_pass};
use crate::{Exposure, Integrator, PixelFilter, RayCounts, RenderError, Screen};
use gonio_radiometry::sequence::SamplerKind;
use gonio_scene::{Camera, Scene};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// When a rendering is finished: at the first target that is reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Samples per pixel: the index after the last one. Where they are taken adaptively without a target of noise, their mean.
    pub samples: u32,
    /// Wall-clock time.
    pub time: Option<Duration>,
    /// Noise, [`Film::noise`]: 0.02 is 2 %.
    pub noise: Option<f64>,
    /// Whether samples go, after 32 of all pixels, where they are needed. With a target of noise: to the pixels alone whose neighbourhood is
    /// noisier than the target. Without: to those where one more sample takes most from the mean squared relative error, twice as many each
    /// time, until `samples` are taken in the mean. A pixel's own samples have no part in whether it goes on, which would make the
    /// picture too dark (Kirk & Arvo 1991).
    pub adaptive: bool,
}

/// Samples that one pixel may have where only their mean is given.
const MOST_OF_ONE: u32 = 1 << 20;

impl Target {
    fn goal(&self) -> Option<Goal> {
        match self.noise {
            _ if !self.adaptive => None,
            Some(noise) => Some(Goal::Noise(noise)),
            None => Some(Goal::Mean(self.samples)),
        }
    }

    /// Samples that one pixel may have.
    fn most(&self) -> u32 {
        match self.goal() {
            Some(Goal::Mean(_)) => MOST_OF_ONE,
            _ => self.samples,
        }
    }
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
    /// How the samples of different pixels relate to each other.
    pub screen: Screen,
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
                adaptive: false,
            },
            integrator: Integrator::default(),
            sampler: SamplerKind::Sobol,
            screen: Screen::INDEPENDENT,
            filter: PixelFilter::default(),
            seed: 0,
            keep: Kept::NOTHING,
        }
    }
}

/// How far a rendering has come, told after each pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Samples per pixel so far; their mean, where that is the target.
    pub samples: u32,
    /// Samples per pixel at which it ends at the latest.
    pub of: u32,
    /// Rays followed so far.
    pub rays: RayCounts,
    /// Time spent so far.
    pub elapsed: Duration,
    /// [`Film::noise`] so far, where it is a target: it takes a look at every pixel.
    pub noise: Option<f64>,
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

/// Samples of every pixel in one pass, the unit between two looks at the noise. A pass takes as many samples as there are, so that a first
/// picture is there at once, up to this many: the numbers of samples after passes are those that Sobol' points are most even at.
const LARGEST_PASS: u32 = adaptive::PASS;
/// A pass that takes longer than this is done in pieces, with a look at the clock and at the user's wishes after each. The
/// noise is judged after whole passes alone: where it ends a rendering does not depend on the machine's speed.
const LONGEST_PIECE: Duration = Duration::from_secs(1);
/// Stopping by noise needs this many samples before it trusts its own estimate.
const LEAST_SAMPLES_FOR_NOISE: u32 = adaptive::BASE;

/// Takes a picture of `scene` through `camera`, on the threads of the current rayon pool.
///
/// `progress` is called after each pass with what was done and the film so far; `ControlFlow::Break` ends the rendering
/// early. The film it leaves is whole: every pixel has the same number of samples, if they are not taken adaptively.
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
    let (first, taken_before) = (exposure.samples.start, exposure.film.samples());
    let mut all = taken_before;
    let pixels = u64::from(options.width) * u64::from(options.height);
    let stop = |exposure: &Exposure, noise: Option<f64>, next: &Next| {
        let whole = matches!(next, Next::Pass { begun: false, .. });
        if matches!(next, Next::Nothing) {
            Some(Stop::Samples)
        } else if whole
            && exposure.samples.end - first >= LEAST_SAMPLES_FOR_NOISE
            && (target.noise.zip(noise)).is_some_and(|(target, noise)| noise <= target)
        {
            Some(Stop::Noise)
        } else {
            let late = target.time.is_some_and(|t| exposure.elapsed >= t);
            late.then_some(Stop::Time)
        }
    };
    let mut next = next_pass(exposure, &target);
    if !exposure.samples.is_empty()
        && let Some(stop) = stop(exposure, target.noise.map(|_| exposure.film.noise()), &next)
    {
        return Ok(stop);
    }
    let worth = Worth::learn(scene, camera, options);
    let mut piece = 1;
    while let Next::Pass { active, left, .. } = &next {
        let count = piece.min(*left);
        let done = exposure.samples.end;
        let wanted = match active {
            None => Wanted::All(done..done + count),
            Some(pixels) => Wanted::Of {
                pixels,
                first,
                count,
                end: target.most(),
            },
        };
        exposure.rays += take_pass(
            scene,
            camera,
            options,
            &mut exposure.film,
            &wanted,
            worth.as_ref(),
        );
        // To look at all pixels takes its time.
        if active.is_none() {
            exposure.samples.end = done + count;
            all += pixels * u64::from(count);
        } else {
            exposure.samples.end = first + exposure.film.samples_per_pixel();
            all = exposure.film.samples();
        }
        exposure.elapsed = before + start.elapsed();
        let share = match active {
            None => 1.0,
            Some(pixels) => pixels.iter().filter(|p| **p).count() as f64 / pixels.len() as f64,
        };
        let report = Progress {
            samples: match target.goal() {
                Some(Goal::Mean(_)) => (all / pixels) as u32,
                _ => exposure.samples.end - first,
            },
            of: target.samples - first,
            rays: exposure.rays,
            elapsed: exposure.elapsed,
            noise: target.noise.map(|_| exposure.film.noise()),
        };
        let asked = progress(&report, exposure);
        next = match next {
            Next::Pass { active, left, .. } if count < left => Next::Pass {
                active,
                left: left - count,
                begun: true,
            },
            _ => next_pass(exposure, &target),
        };
        match stop(exposure, report.noise, &next) {
            Some(stop @ Stop::Samples) => return Ok(stop),
            _ if asked.is_break() => return Ok(Stop::Interrupted),
            Some(stop) => return Ok(stop),
            None => {}
        }
        let left = target.time.map(|t| t.saturating_sub(report.elapsed));
        let taken = (all - taken_before) as f64 / pixels as f64;
        piece = samples_within(
            left.unwrap_or(LONGEST_PIECE),
            taken / share,
            start.elapsed(),
        );
    }
    Ok(Stop::Samples)
}

/// What a rendering does next.
#[derive(Debug)]
enum Next {
    /// All samples are taken.
    Nothing,
    Pass {
        /// The pixels that take part; none named: all of them.
        active: Option<Vec<bool>>,
        /// Samples to its end.
        left: u32,
        /// Whether some of it is done.
        begun: bool,
    },
}

/// What comes next is a function of the film and the target: an interruption leaves no trace.
fn next_pass(exposure: &Exposure, target: &Target) -> Next {
    let taken = &exposure.samples;
    let done = taken.end - taken.start;
    let most = target.most() - taken.start;
    if let Some(goal) = target.goal().filter(|_| done >= adaptive::BASE) {
        let Active {
            pixels,
            left,
            begun,
        } = adaptive::active(&exposure.film, goal, most);
        if !pixels.contains(&true) {
            return Next::Nothing;
        }
        return Next::Pass {
            active: Some(pixels),
            left,
            begun,
        };
    }
    let end = end_of_pass(done).min(target.samples - taken.start);
    if end == done {
        return Next::Nothing;
    }
    Next::Pass {
        active: None,
        left: end - done,
        begun: done > 0 && !ends_a_pass(done),
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
    if target.most() < taken.end {
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
    if target.adaptive && taken.start > 0 {
        return fault(
            "adaptive",
            format!("samples from {} on", taken.start),
            "all of them: which pixels go on depends on the samples before",
        );
    }
    if target.adaptive && !options.screen.is_independent() {
        return fault(
            "adaptive",
            "pixels that share a sequence".into(),
            "pixels that are independent of each other",
        );
    }
    if let Integrator::Path(path) = options.integrator
        && matches!(path.environment, EnvironmentSampling::Product(_))
        && path.light_candidates > 1
    {
        return fault(
            "light_candidates",
            format!(
                "{} beside product sampling of the environment",
                path.light_candidates
            ),
            "1: product sampling has candidates of its own",
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

/// The number of samples at the end of the pass in which sample `k` is taken: 1, 2, 4, 8, 16, then 16 more each time.
fn end_of_pass(k: u32) -> u32 {
    if k < LARGEST_PASS {
        (k + 1).next_power_of_two()
    } else {
        (k / LARGEST_PASS + 1).saturating_mul(LARGEST_PASS)
    }
}

/// Whether a pass ends with `done` samples.
fn ends_a_pass(done: u32) -> bool {
    done > 0 && end_of_pass(done - 1) == done
}

/// Samples that fit into `left`, and into the longest piece, at the pace of `done` samples in `elapsed`; at least one.
fn samples_within(left: Duration, done: f64, elapsed: Duration) -> u32 {
    let seconds = left.min(LONGEST_PIECE).as_secs_f64();
    // A conversion to an integer saturates, for a pace that is too fast to measure as well.
    ((seconds * done / elapsed.as_secs_f64()) as u32).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_double_up_to_sixteen() {
        let mut ends = vec![0];
        while ends[ends.len() - 1] < 60 {
            let done = ends[ends.len() - 1];
            ends.push(end_of_pass(done));
        }
        assert_eq!(ends, [0, 1, 2, 4, 8, 16, 32, 48, 64]);
        // Within a pass as at its beginning.
        for k in 0..60 {
            let end = ends.iter().copied().find(|e| *e > k).unwrap();
            assert_eq!(end_of_pass(k), end, "{k}");
            assert_eq!(ends_a_pass(k), k > 0 && ends.contains(&k), "{k}");
        }
        assert!(end_of_pass(u32::MAX) >= u32::MAX - LARGEST_PASS);
    }

    #[test]
    fn pieces_fit_the_time_that_is_left() {
        let seconds = Duration::from_secs_f64;
        // A hundred samples a second: one second at most.
        assert_eq!(samples_within(seconds(60.0), 200.0, seconds(2.0)), 100);
        assert_eq!(samples_within(seconds(0.25), 200.0, seconds(2.0)), 25);
        // Slower than that, and out of time: one.
        assert_eq!(samples_within(seconds(60.0), 1.0, seconds(9.0)), 1);
        assert_eq!(samples_within(seconds(0.0), 200.0, seconds(2.0)), 1);
        assert_eq!(samples_within(seconds(60.0), 1.0, seconds(0.0)), u32::MAX);
    }
}
