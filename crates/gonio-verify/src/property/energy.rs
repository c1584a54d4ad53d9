//! Radiant exitance ≤ irradiance.

use super::furnace::Furnace;
use crate::check::Checker;
use crate::statistics::{normal_quantile, sidak};
use crate::verdict::{Interval, Outcome, Property, Verdict, Witness};

/// One furnace's albedo in one channel.
struct Albedo<'a> {
    furnace: &'a Furnace,
    channel: usize,
    /// Quadrature, with the mean weight of Dirac deltas.
    value: f64,
    low: f64,
    high: f64,
    /// The lower bound by sampling alone.
    sampled_low: f64,
}

fn albedo(furnace: &Furnace, channel: usize, z: f64) -> Albedo<'_> {
    let delta = &furnace.delta[channel];
    let spread = z * delta.variance_of_mean().sqrt();
    let value = furnace.quadrature[channel] + delta.mean();
    let error = furnace.error[channel];
    let sampled = furnace.continuous[channel].mean() + delta.mean();
    let variance = furnace.continuous[channel].variance_of_mean() + delta.variance_of_mean();
    Albedo {
        furnace,
        channel,
        value,
        low: value - error - spread,
        high: value + error + spread,
        // For a long tail of large weights the mean is more often too small than too large: the lower bound is safe.
        sampled_low: sampled - z * (2.0 * variance).sqrt(),
    }
}

/// The largest directional albedo, which may exceed 1 by no more than the bound: a failure needs the lower confidence
/// bound of the quadrature or of the sampling above that.
///
/// The quadrature's error is estimated, not proved; the smallest albedo is information.
pub(super) fn check(c: &Checker, furnaces: &[Furnace]) -> [Verdict; 2] {
    let property = Property::EnergyConservation;
    let rate = c.settings.false_positive_rate;
    let z = normal_quantile(sidak(rate, 6 * furnaces.len() as u64));
    let all: Vec<Albedo> = furnaces
        .iter()
        .flat_map(|f| (0..3).map(move |k| albedo(f, k, z)))
        .collect();
    let by = |key: fn(&Albedo) -> f64| {
        all.iter()
            .max_by(|a, b| key(a).total_cmp(&key(b)))
            .expect("invariant: there is at least one direction")
    };
    let worst = by(|a| a.low.max(a.sampled_low));
    let darkest = by(|a| -a.value);
    let loss = loss(c, darkest);
    let samples = furnaces.iter().map(|f| f.evaluations).sum();
    let bound = 1.0 + c.settings.energy_bound;
    let low = worst.low.max(worst.sampled_low);
    let figure = if worst.sampled_low > worst.low && worst.sampled_low > bound {
        worst.furnace.continuous[worst.channel].mean() + worst.furnace.delta[worst.channel].mean()
    } else {
        worst.value
    };
    let mut v = Verdict::passing(property, figure, bound, samples);
    let by_chance = c.subject.has_sample();
    v.confidence = Some(Interval {
        low,
        high: worst.high.max(low),
        level: if by_chance { 1.0 - rate } else { 1.0 },
    });
    v.false_positive_rate = if by_chance { rate } else { 0.0 };
    let f = worst.furnace;
    let mut witness = Witness::at(f.wo)
        .value("albedo by quadrature", f.quadrature[worst.channel])
        .value("quadrature error", f.error[worst.channel]);
    if by_chance {
        witness = witness
            .value("albedo of Dirac deltas", f.delta[worst.channel].mean())
            .value(
                "albedo by sampling",
                f.continuous[worst.channel].mean() + f.delta[worst.channel].mean(),
            );
    }
    v.witness = Some(witness);
    let theta = |a: &Albedo| crate::verdict::Direction::from(a.furnace.wo).theta_deg;
    v.detail = format!(
        "directional albedo from {:.6} (at {:.1}°) to {:.6} (at {:.1}°)",
        darkest.value,
        theta(darkest),
        figure,
        theta(worst),
    );
    let unsure = all.iter().map(|a| a.high - a.low).fold(0.0, f64::max);
    let mut v = v.judge(low > bound, c.expect.energy_conserving);
    if unsure > 0.02 && v.note.is_none() {
        v.note = Some(format!(
            "an albedo is known within ±{:.3} only",
            0.5 * unsure
        ));
    }
    let not_finite: u64 = furnaces.iter().map(|f| f.not_finite).sum();
    if not_finite > 0 {
        v.note = Some(format!(
            "{not_finite} of the values that were integrated are NaN or infinite, and counted as 0"
        ));
    }
    [v, loss]
}

/// How much of the light is lost at most: 1 − the smallest directional albedo. A failure needs the lower confidence bound above
/// what the settings allow; without that it is information, since most surfaces absorb.
fn loss(c: &Checker, darkest: &Albedo) -> Verdict {
    let f = darkest.furnace;
    let (figure, low) = (1.0 - darkest.value, 1.0 - darkest.high);
    let bound = c.settings.loss_bound.unwrap_or(f64::NAN);
    let mut v = Verdict::passing(Property::EnergyLoss, figure, bound, f.evaluations);
    let by_chance = f.delta_draws > 0;
    let rate = if by_chance {
        c.settings.false_positive_rate
    } else {
        0.0
    };
    v.false_positive_rate = rate;
    v.confidence = Some(Interval {
        low,
        high: 1.0 - darkest.low,
        level: 1.0 - rate,
    });
    v.witness = Some(
        Witness::at(f.wo)
            .value("albedo by quadrature", f.quadrature[darkest.channel])
            .value("quadrature error", f.error[darkest.channel])
            .value("albedo of Dirac deltas", f.delta[darkest.channel].mean()),
    );
    v.detail = format!(
        "the furnace falls short of 1 by at most {figure:.6}, at {:.1}°, in channel {}",
        crate::verdict::Direction::from(f.wo).theta_deg,
        darkest.channel
    );
    if c.settings.loss_bound.is_none() {
        v.outcome = Outcome::Information;
        return v;
    }
    v.judge(low > bound, true)
}
