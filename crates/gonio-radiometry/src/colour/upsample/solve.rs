//! [`Solver`]: the sigmoid polynomial of a colour.

use super::SigmoidPolynomial;
use crate::colour::lab::f_and_slope;
use crate::colour::{Matrix3, RgbSpace, bradford, white_of};
use crate::spectrum::{Illuminant, Observer, Spectrum, VISIBLE, WavelengthRange};
use gonio_num::Real;
use std::sync::LazyLock;

/// A sigmoid polynomial and how well it fits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// The reflectance.
    pub sigmoid: SigmoidPolynomial,
    /// ΔE*ab (1976) between its colour and the one asked for: below 10⁻⁶ where the family has the colour, as for all of
    /// sRGB; below 10⁻³ where such a colour is darker than 2 × 10⁻⁴, since its spectrum is a spike.
    pub delta_e: f64,
    /// Evaluations of the colour that it took.
    pub evaluations: u32,
}

/// A reflectance sampled at equal steps, as weights towards XYZ.
#[derive(Debug, Clone)]
struct Nodes {
    /// Position in [0, 1] over the visible range.
    t: Vec<f64>,
    /// XYZ relative to the white, adapted to the space, of a unit hat function around the node.
    weights: Vec<[f64; 3]>,
}

/// Solves for the sigmoid polynomial whose colour is a given RGB.
///
/// Gauss–Newton steps with Levenberg's damping in CIELAB, along a straight path of colours from grey, each solved from the one
/// before: near the gamut's corners a single solve from grey would get lost (the paper starts from neighbouring colours for the
/// same reason). Path and first steps use 5 nm; the last steps 1 nm.
///
/// A colour takes about 40 µs (release build, one core) for 11 evaluations on average; the hardest of sRGB take 40.
#[derive(Debug, Clone)]
pub struct Solver {
    space: RgbSpace,
    to_xyz: Matrix3,
    white: [f64; 3],
    coarse: Nodes,
    fine: Nodes,
}

static SRGB: LazyLock<Solver> =
    LazyLock::new(|| Solver::new(&RgbSpace::SRGB, &Illuminant::D65.spectrum()));

/// Largest |coefficient| over the unit range: the sharpest edge is about 1 nm wide.
const MAX_COEFFICIENT: f64 = 1e4;
/// ΔE at which a colour counts as reached.
const REACHED: f64 = 1e-9;

impl Solver {
    /// For colours of `space`, seen under `light` and adapted to the space's white (Bradford).
    pub fn new(space: &RgbSpace, light: &Spectrum) -> Self {
        Self {
            space: *space,
            to_xyz: space.to_xyz(),
            white: space.white_xyz(),
            coarse: nodes(95, space, light),
            fine: nodes(471, space, light),
        }
    }

    /// For sRGB under D65.
    pub fn srgb() -> &'static Self {
        &SRGB
    }

    /// The space whose colours it solves.
    pub fn space(&self) -> &RgbSpace {
        &self.space
    }

    /// The reflectance of colour `rgb` (linear, in [0, 1]³; outside it is clamped, NaN is 0).
    ///
    /// Where the family hasn't the colour (saturated ones of wide gamuts) it is the one of least ΔE that the steps find;
    /// [`Fit::delta_e`] tells.
    pub fn solve(&self, rgb: [f64; 3]) -> Fit {
        let rgb = rgb.map(Real::saturate);
        if rgb[0] == rgb[1] && rgb[1] == rgb[2] {
            return self.fit(SigmoidPolynomial::grey(rgb[0]), rgb, 0);
        }
        // A grey that is neither so dark nor so light that the sigmoid is flat.
        let grey = self.to_xyz.apply(rgb)[1].clamp(1e-6, 0.9);
        let mut state = State::grey(grey);
        let mut evaluations = 0;
        let (mut reached, mut step) = (0.0, 0.5);
        while reached < 1.0 {
            let next = f64::min(reached + step, 1.0);
            let colour = rgb.map(|c| (1.0 - next) * grey + next * c);
            let (trial, error) =
                self.descend(&self.coarse, colour, state, 12, 1e-3, &mut evaluations);
            if error < 1e-3 {
                (state, reached) = (trial, next);
                step *= 2.0;
            } else if step < 1.0 / 256.0 {
                break;
            } else {
                step *= 0.5;
            }
        }
        let (state, _) = self.descend(&self.fine, rgb, state, 60, REACHED, &mut evaluations);
        self.fit(state.sigmoid(), rgb, evaluations)
    }

    /// From a neighbouring colour's reflectance: for tables. Coarse nodes.
    pub(super) fn solve_from(
        &self,
        rgb: [f64; 3],
        start: SigmoidPolynomial,
    ) -> Option<SigmoidPolynomial> {
        let state = State::of(start);
        let (state, error) = self.descend(&self.coarse, rgb, state, 15, 1e-6, &mut 0);
        (error < 1e-3).then(|| state.sigmoid())
    }

    fn fit(&self, sigmoid: SigmoidPolynomial, rgb: [f64; 3], evaluations: u32) -> Fit {
        let target = self.lab(self.to_xyz.apply(rgb));
        let (lab, _) = self.colour(&self.fine, State::of(sigmoid));
        Fit {
            sigmoid,
            delta_e: crate::colour::delta_e_76(lab, target),
            evaluations,
        }
    }

    fn lab(&self, xyz: [f64; 3]) -> [f64; 3] {
        crate::colour::lab_of_xyz(xyz, self.white)
    }

    /// Damped Gauss–Newton steps towards `rgb`; the best state and its ΔE.
    fn descend(
        &self,
        nodes: &Nodes,
        rgb: [f64; 3],
        start: State,
        steps: u32,
        enough: f64,
        evaluations: &mut u32,
    ) -> (State, f64) {
        let target = self.lab(self.to_xyz.apply(rgb));
        let residual = |lab: [f64; 3]| [0, 1, 2].map(|k| lab[k] - target[k]);
        let norm2 = |r: [f64; 3]| r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
        let mut state = start;
        let (lab, mut jacobian) = self.colour(nodes, state);
        let mut r = residual(lab);
        *evaluations += 1;
        let mut damping = 0.0;
        for _ in 0..steps {
            if norm2(r) < enough * enough {
                break;
            }
            let Some(delta) = damped_step(&jacobian, r, damping) else {
                damping = if damping == 0.0 { 1e-9 } else { damping * 16.0 };
                continue;
            };
            let trial = State(
                [0, 1, 2].map(|k| (state.0[k] + delta[k]).clamp(-MAX_COEFFICIENT, MAX_COEFFICIENT)),
            );
            let (lab, trial_jacobian) = self.colour(nodes, trial);
            let trial_r = residual(lab);
            *evaluations += 1;
            if norm2(trial_r) < norm2(r) {
                (state, jacobian, r) = (trial, trial_jacobian, trial_r);
                damping = if damping < 1e-9 { 0.0 } else { damping / 16.0 };
            } else {
                damping = if damping == 0.0 { 1e-6 } else { damping * 16.0 };
            }
        }
        (state, norm2(r).sqrt())
    }

    /// CIELAB of the reflectance and its derivatives by the three coefficients: `jacobian[i][k]` is ∂labᵢ/∂cₖ.
    fn colour(&self, nodes: &Nodes, state: State) -> ([f64; 3], [[f64; 3]; 3]) {
        let [a, b, c] = state.0;
        let mut xyz = [0.0; 3];
        let mut slope = [[0.0; 3]; 3];
        for (&t, w) in nodes.t.iter().zip(&nodes.weights) {
            let x = (a * t + b) * t + c;
            let q = 1.0 / (1.0 + x * x);
            let root = q.sqrt();
            let s = 0.5 + 0.5 * x * root;
            let ds = 0.5 * q * root;
            for i in 0..3 {
                xyz[i] += w[i] * s;
                let d = w[i] * ds;
                slope[i][2] += d;
                slope[i][1] += d * t;
                slope[i][0] += d * t * t;
            }
        }
        let mut f = [0.0; 3];
        for i in 0..3 {
            let (value, derivative) = f_and_slope(xyz[i] / self.white[i]);
            f[i] = value;
            for x in &mut slope[i] {
                *x *= derivative / self.white[i];
            }
        }
        let lab = [
            116.0 * f[1] - 16.0,
            500.0 * (f[0] - f[1]),
            200.0 * (f[1] - f[2]),
        ];
        let mut jacobian = [[0.0; 3]; 3];
        for k in 0..3 {
            jacobian[0][k] = 116.0 * slope[1][k];
            jacobian[1][k] = 500.0 * (slope[0][k] - slope[1][k]);
            jacobian[2][k] = 200.0 * (slope[1][k] - slope[2][k]);
        }
        (lab, jacobian)
    }
}

/// Coefficients over t in [0, 1]: of t², t and 1.
#[derive(Debug, Clone, Copy)]
struct State([f64; 3]);

impl State {
    fn grey(value: f64) -> Self {
        Self::of(SigmoidPolynomial::grey(value))
    }

    /// t = (λ − 360)/470, so λ = 360 + 470 t.
    fn of(sigmoid: SigmoidPolynomial) -> Self {
        let [c0, c1, c2] = sigmoid.coefficients;
        let (l, w) = (VISIBLE.min_nm, VISIBLE.width_nm());
        Self([c0 * w * w, (2.0 * c0 * l + c1) * w, (c0 * l + c1) * l + c2])
    }

    fn sigmoid(self) -> SigmoidPolynomial {
        let [a, b, c] = self.0;
        let (l, w) = (VISIBLE.min_nm, VISIBLE.width_nm());
        let (c0, slope) = (a / (w * w), b / w);
        SigmoidPolynomial::new([c0, slope - 2.0 * c0 * l, (c0 * l - slope) * l + c])
    }
}

/// The step δ of (JᵀJ + μ diag(JᵀJ)) δ = −Jᵀr, or of Jδ = −r if μ = 0; `None` if it isn't finite.
fn damped_step(jacobian: &[[f64; 3]; 3], r: [f64; 3], damping: f64) -> Option<[f64; 3]> {
    let solve = |m: Matrix3, v: [f64; 3]| {
        let delta = m.inverse()?.apply(v.map(|x| -x));
        delta.iter().all(|d| d.is_finite()).then_some(delta)
    };
    if damping == 0.0 {
        return solve(Matrix3(*jacobian), r);
    }
    let column = |i: usize| [jacobian[0][i], jacobian[1][i], jacobian[2][i]];
    let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let mut normal = [[0.0; 3]; 3];
    for (i, row) in normal.iter_mut().enumerate() {
        for (j, x) in row.iter_mut().enumerate() {
            *x = dot(column(i), column(j));
        }
    }
    let mut gradient = [0.0; 3];
    for i in 0..3 {
        normal[i][i] *= 1.0 + damping;
        gradient[i] = dot(column(i), r);
    }
    solve(Matrix3(normal), gradient)
}

/// Weights of `count` hat functions over the visible range: ∫ hat · light · (x̄, ȳ, z̄) dλ, normalised and adapted.
fn nodes(count: usize, space: &RgbSpace, light: &Spectrum) -> Nodes {
    let observer = Observer::cie_1931();
    let adapted = bradford(white_of(light), space.white_xyz());
    let step = VISIBLE.width_nm() / (count - 1) as f64;
    let scale = 1.0 / Spectrum::integrate_product(&[light, &observer.y], VISIBLE);
    let mut nodes = Nodes {
        t: Vec::with_capacity(count),
        weights: Vec::with_capacity(count),
    };
    for i in 0..count {
        let lambda = VISIBLE.min_nm + step * i as f64;
        let hat = |l: f64| (1.0 - (l - lambda).abs() / step).max(0.0);
        let mut xyz = [0.0; 3];
        for range in [[lambda - step, lambda], [lambda, lambda + step]] {
            let range = VISIBLE.intersection(WavelengthRange {
                min_nm: range[0],
                max_nm: range[1],
            });
            let part = Spectrum::integrate_with(&[light, &observer.y], range, |l| {
                let s = light.at(l) * hat(l) * scale;
                observer.at(l).map(|c| s * c)
            });
            for k in 0..3 {
                xyz[k] += part[k];
            }
        }
        nodes.t.push(i as f64 / (count - 1) as f64);
        nodes.weights.push(adapted.apply(xyz));
    }
    nodes
}
