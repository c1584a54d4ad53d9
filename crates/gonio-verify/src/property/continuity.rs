//! Whether the light that a surface reflects fades as its source sets.

use super::{rng, with_colour};
use crate::check::Checker;
use crate::directions::{at_height, azimuth};
use crate::reflection::SubjectFailed;
use crate::search::{typical, worst_pair};
use crate::subject::Pair;
use crate::verdict::{Property, Verdict, Witness};
use gonio_num::Vec3;

/// What a decay leaves of f·|cosθi| at the last height at most. A jump leaves all of it; the slowest decay of a published
/// model, the square root of cosθi (Ward 1992), a hundredth.
const DECAYED: f64 = 0.9;

/// The largest limit of f·|cosθi| at the horizon of the light, for a viewer in any direction.
///
/// Below its horizon a surface gets no light from that side, so a limit other than 0 is a jump: under a setting sun the surface
/// goes dark at once. It is no matter of taste. With reciprocity such a limit J(ωo) over a set of viewers makes f(ωo→ωi) grow
/// as J/cosθi at grazing ωi, and the directional albedo there as ∫ J cosθo dωo / cosθi, beyond every bound: so what is
/// reciprocal and conserves energy has no jump, and what is declared to lack either may have one.
///
/// No fault is: f that grows without bound, if f·|cosθi| falls to 0 (Ward's first model: 1/√cosθi); a jump at a viewer's horizon
/// (no cosine is due there, an edge-on surface may be bright); a single direction, a set of measure 0.
///
/// A failure involves no chance: f·|cosθi| at two heights, the second far nearer to the horizon, is about the same.
pub(super) fn check(c: &Checker) -> Result<Verdict, SubjectFailed> {
    let property = Property::Continuity;
    let region = c.subject.region();
    let eval = |pairs: &[Pair]| c.subject.eval(pairs);
    let scale = typical(eval, region, &mut rng(c, property, "typical"))?;
    let heights = c.settings.sinking();
    let sunk = |wi: Vec3<f64>, height: f64| at_height(height.copysign(wi.z), azimuth(wi));
    let reflected = |pairs: &[Pair], height: f64| -> Result<Vec<[f64; 3]>, SubjectFailed> {
        let low: Vec<Pair> = pairs
            .iter()
            .map(|(wi, wo)| (sunk(*wi, height), *wo))
            .collect();
        let mut f = eval(&low)?;
        for x in f.iter_mut().flatten() {
            *x *= height;
        }
        Ok(f)
    };
    let figure = |pairs: &[Pair]| {
        let (first, last) = (reflected(pairs, heights[0])?, reflected(pairs, heights[1])?);
        let jump = |(first, last): (&[f64; 3], &[f64; 3])| {
            let channel = |k: usize| match last[k].abs() >= DECAYED * first[k].abs() {
                // What isn't finite is another property's business.
                true if last[k].is_finite() && first[k].is_finite() => last[k].abs(),
                _ => 0.0,
            };
            channel(0).max(channel(1)).max(channel(2))
        };
        Ok(first.iter().zip(&last).map(jump).collect())
    };
    let worst = worst_pair(
        &mut rng(c, property, "pairs"),
        region,
        c.settings.pairs / 4 + 1,
        c.settings.nudge(),
        figure,
    )?;
    let bound = c.settings.continuity_bound * scale;
    let mut v = Verdict::passing(property, worst.figure, bound, 2 * worst.evaluations);
    let pair = [(worst.wi, worst.wo)];
    let mut witness = Witness::pair(sunk(worst.wi, heights[1]), worst.wo);
    for height in heights {
        let name = format!("f·|cosθi| at cosθi = {height:e}");
        witness = with_colour(witness, &name, reflected(&pair, height)?[0]);
    }
    v.witness = (worst.figure > 0.0).then_some(witness);
    v.detail = format!(
        "f·|cosθi| at the light's horizon: {:.3e} sr⁻¹, beside a typical f of {scale:.3e} sr⁻¹",
        worst.figure
    );
    let declared = c.expect.reciprocal && c.expect.energy_conserving;
    Ok(v.judge(worst.figure > bound, declared))
}
