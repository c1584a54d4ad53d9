//! Curves: a function of one number, evaluated where it bends.

use crate::options::weighted;

/// How far, in pixels, a curve may be from the straight lines that draw it: too little to be seen.
pub(crate) const FLATNESS: f64 = 0.05;

/// Halvings in which a piece counts as straight only if its middle is where a straight line's would be: as long as a piece is much wider than a
/// lobe, both ends and the middle may lie in line by chance.
const SURE: u32 = 3;

/// Points of a curve at most.
const MOST_POINTS: usize = 40_000;

/// Colours for many arguments at once.
pub(crate) type Eval<'a> = dyn Fn(&[f64]) -> Vec<[f64; 3]> + 'a;
/// Where a value at an argument is drawn, in pixels.
pub(crate) type Place<'a> = dyn Fn(f64, f64) -> [f64; 2] + 'a;

/// A curve's points, in the order of their arguments.
#[derive(Debug, Clone, Default)]
pub(crate) struct Trace {
    /// Argument and colour.
    pub points: Vec<(f64, [f64; 3])>,
}

impl Trace {
    /// The curve from `from` to `to` at every `step`, and ever more closely around `narrow`, down to `finest`: so that a lobe as narrow as
    /// that isn't missed.
    pub fn new(eval: &Eval, [from, to]: [f64; 2], step: f64, narrow: &[f64], finest: f64) -> Self {
        let steps = ((to - from) / step).ceil().max(1.0) as usize;
        let even = (0..=steps).map(|k| from + (to - from) * k as f64 / steps as f64);
        let mut at: Vec<f64> = even.collect();
        for &centre in narrow {
            at.push(centre);
            let mut offset = finest;
            while offset < step {
                at.extend([centre - offset, centre + offset]);
                offset *= 1.5;
            }
        }
        at.retain(|t| (from..=to).contains(t));
        at.sort_by(f64::total_cmp);
        at.dedup_by(|b, a| *b - *a < 0.1 * finest);
        let values = eval(&at);
        Self {
            points: at.into_iter().zip(values).collect(),
        }
    }

    /// Halves the curve where it is farther than `flatness`, in pixels, from straight lines when drawn by `place`, until it isn't, or steps are
    /// `finest`: there it jumps.
    pub fn refine(
        &mut self,
        eval: &Eval,
        weights: &[[f64; 3]],
        place: &Place,
        finest: f64,
        flatness: f64,
    ) {
        // Whether the piece from each point to the next has to be looked at.
        let mut open = vec![true; self.points.len()];
        for round in 0_u32.. {
            let pieces = self.points.windows(2).zip(&open);
            let middles: Vec<f64> = pieces
                .filter(|(w, open)| **open && w[1].0 - w[0].0 > finest)
                .map(|(w, _)| 0.5 * (w[0].0 + w[1].0))
                .collect();
            if middles.is_empty() || self.points.len() > MOST_POINTS {
                return;
            }
            let values = eval(&middles);
            let mut new = middles.into_iter().zip(values).peekable();
            let old = std::mem::take(&mut self.points);
            let looked_at = std::mem::take(&mut open);
            for (k, &point) in old.iter().enumerate() {
                self.points.push(point);
                let Some(&next) = old.get(k + 1) else {
                    open.push(false);
                    break;
                };
                if !looked_at[k] || next.0 - point.0 <= finest {
                    open.push(false);
                    continue;
                }
                let Some(middle) = new.next() else { break };
                let bent = weights.iter().any(|w| {
                    distance_of_middle(place, *w, point, middle, next, round < SURE) > flatness
                });
                open.push(bent);
                self.points.push(middle);
                open.push(bent);
            }
        }
    }

    /// The largest finite value, and where it is.
    pub fn peak(&self, weights: &[[f64; 3]]) -> Option<(f64, f64)> {
        let mut best: Option<(f64, f64)> = None;
        for (t, colour) in &self.points {
            for w in weights {
                let x = weighted(*w, *colour);
                if x > 0.0 && x.is_finite() && best.is_none_or(|(_, b)| x > b) {
                    best = Some((*t, x));
                }
            }
        }
        best
    }

    /// Over how much of its argument the curve is above `share` of `peak`.
    pub fn width_above(&self, weights: &[[f64; 3]], level: f64) -> f64 {
        let above = |p: &(f64, [f64; 3])| weights.iter().any(|w| weighted(*w, p.1) > level);
        let pieces = self.points.windows(2);
        pieces
            .filter(|w| above(&w[0]) && above(&w[1]))
            .map(|w| w[1].0 - w[0].0)
            .sum()
    }

    /// How many values aren't finite.
    pub fn gaps(&self) -> usize {
        let finite = |c: &[f64; 3]| c.iter().all(|x| x.is_finite());
        self.points.iter().filter(|(_, c)| !finite(c)).count()
    }

    /// The curve of one number of the colour as lines to be drawn: a new one after each gap, with the fewest points whose straight lines
    /// stay within half of [`FLATNESS`] of all.
    pub fn lines(&self, weights: [f64; 3], place: &Place) -> Vec<Vec<[f64; 2]>> {
        let mut lines: Vec<Vec<[f64; 2]>> = vec![Vec::new()];
        for &(t, colour) in &self.points {
            let x = weighted(weights, colour);
            let p = place(t, x);
            if x.is_finite() && p[0].is_finite() && p[1].is_finite() {
                if let Some(last) = lines.last_mut() {
                    last.push(p);
                }
            } else if lines.last().is_some_and(|l| !l.is_empty()) {
                lines.push(Vec::new());
            }
        }
        lines.retain(|l| l.len() > 1);
        lines.iter().map(|l| simplified(l)).collect()
    }
}

/// How far the middle of a piece is from its straight line or, if it is to be `sure` or the piece may turn back on itself as a needle does
/// at its tip, from the middle of that line; infinite if a gap begins or ends in the piece.
///
/// A parabola through a, m and b, with m at δ from the middle of ab, has its vertex between a and b if 4δ > |ab|; here 8δ, as no curve is
/// a parabola.
fn distance_of_middle(
    place: &Place,
    weights: [f64; 3],
    a: (f64, [f64; 3]),
    m: (f64, [f64; 3]),
    b: (f64, [f64; 3]),
    sure: bool,
) -> f64 {
    let at = |p: (f64, [f64; 3])| place(p.0, weighted(weights, p.1));
    let (pa, pm, pb) = (at(a), at(m), at(b));
    let [na, nm, nb] = [pa, pm, pb].map(|p| p[1].is_nan());
    match na || nm || nb {
        true if na == nm && nm == nb => 0.0,
        true => f64::INFINITY,
        false => {
            let middle = [0, 1].map(|k| 0.5 * (pa[k] + pb[k]));
            let off = distance(pm, middle, middle);
            if sure || 8.0 * off > distance(pa, pb, pb) {
                off
            } else {
                distance(pm, pa, pb)
            }
        }
    }
}

/// The fewest of the points, roughly, whose straight lines stay near all of them (Ramer 1972; Douglas & Peucker 1973).
fn simplified(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut keep = vec![false; points.len()];
    let mut pending = vec![(0, points.len() - 1)];
    while let Some((first, last)) = pending.pop() {
        keep[first] = true;
        keep[last] = true;
        let mut worst = (first, 0.5 * FLATNESS);
        for k in first + 1..last {
            let d = distance(points[k], points[first], points[last]);
            if d > worst.1 {
                worst = (k, d);
            }
        }
        if worst.0 != first {
            pending.push((first, worst.0));
            pending.push((worst.0, last));
        }
    }
    let kept = points.iter().zip(keep).filter(|(_, keep)| *keep);
    kept.map(|(p, _)| *p).collect()
}

/// How far `p` is from the straight line between `a` and `b`.
pub(crate) fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let (px, py) = (p[0] - a[0], p[1] - a[1]);
    let squared = dx * dx + dy * dy;
    let along = if squared > 0.0 {
        ((px * dx + py * dy) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let (x, y) = (px - along * dx, py - along * dy);
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_num::Real;

    const GREY: [f64; 3] = [1.0, 0.0, 0.0];

    /// A peak as narrow as that of a surface of roughness 0.02: half of its height 0.01° from its middle.
    fn peak(t: f64) -> [f64; 3] {
        let x = (t - 12.345) / 0.01;
        [1.0 / (1.0 + x * x); 3]
    }

    /// The distance of the true curve from the lines that draw it, at many arguments between the points.
    fn error(lines: &[Vec<[f64; 2]>], place: &Place, f: impl Fn(f64) -> f64, at: &[f64]) -> f64 {
        let pieces: Vec<_> = lines.iter().flat_map(|l| l.windows(2)).collect();
        at.iter()
            .map(|&t| {
                let p = place(t, f(t));
                pieces
                    .iter()
                    .map(|w| distance(p, w[0], w[1]))
                    .fold(f64::INFINITY, f64::min)
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn a_needle_is_drawn_to_a_tenth_of_a_pixel() {
        let eval = |at: &[f64]| at.iter().map(|t| peak(*t)).collect::<Vec<_>>();
        // 500 pixels high, polar: the worst case, as the lobe's width is a hair's.
        let place = |t: f64, x: f64| {
            let (sin, cos) = Real::sin_cos(t.to_radians());
            [500.0 * x * sin, -500.0 * x * cos]
        };
        let mut trace = Trace::new(&eval, [-90.0, 90.0], 0.5, &[12.3], 1e-4);
        trace.refine(&eval, &[GREY], &place, 1e-6, FLATNESS);
        let lines = trace.lines(GREY, &place);
        let near: Vec<f64> = (0..4000).map(|k| 12.245 + f64::from(k) * 5.03e-5).collect();
        let far: Vec<f64> = (0..4000).map(|k| -90.0 + f64::from(k) * 0.0449).collect();
        let f = |t: f64| peak(t)[0];
        let worst = error(&lines, &place, f, &near).max(error(&lines, &place, f, &far));
        // Once FLATNESS for the bends that halving finds and half of it for thinning out.
        assert!(worst < 1.5 * FLATNESS, "{worst}");
        let count: usize = lines.iter().map(Vec::len).sum();
        assert!(count < 400, "{count}");
        let (t, top) = trace.peak(&[GREY]).unwrap();
        assert!((t - 12.345).abs() < 1e-3 && top > 0.999, "{t} {top}");
    }

    #[test]
    fn a_polygon_of_90_corners_would_miss_it() {
        let at: Vec<f64> = (0..=90).map(|k| f64::from(k) * 2.0 - 90.0).collect();
        let most = at.iter().map(|t| peak(*t)[0]).fold(0.0, f64::max);
        assert!(most < 1e-3, "{most}");
    }

    #[test]
    fn steps_and_gaps_are_found() {
        let f = |t: f64| match t {
            t if t < 1.0 / 3.0 => 0.25,
            t if t < 2.0 / 3.0 => 1.0,
            _ => f64::NAN,
        };
        let eval = |at: &[f64]| at.iter().map(|t| [f(*t); 3]).collect::<Vec<_>>();
        let place = |t: f64, x: f64| [100.0 * t, 100.0 * x];
        let mut trace = Trace::new(&eval, [0.0, 1.0], 0.1, &[], 0.1);
        trace.refine(&eval, &[GREY], &place, 1e-7, FLATNESS);
        let lines = trace.lines(GREY, &place);
        assert_eq!(lines.len(), 1, "{lines:?}");
        let line = &lines[0];
        assert_eq!(line.len(), 4, "{line:?}");
        let near = |x: f64, expected: f64| (x - expected).abs() < 1e-4;
        let (step, end) = (line[1][0], line[3][0]);
        assert!(
            near(step, 100.0 / 3.0) && near(end, 200.0 / 3.0),
            "{line:?}"
        );
        assert!(trace.gaps() > 0);
    }
}
