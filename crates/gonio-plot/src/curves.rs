//! The curves of polar and Cartesian plots: functions at angles of incidence, in the plane of incidence.

use crate::canvas::{INK, PALETTE, Stroke};
use crate::figure::{Entry, dash};
use crate::function::Spike;
use crate::options::{Channel, weighted};
use crate::scale::{Scale, ScaleKind, number};
use crate::trace::{FLATNESS, Place, Trace};
use crate::{Function, Options};
use gonio_num::{Real, Vec3};

/// Steps of a curve before it is refined, degrees.
const STEP: f64 = 0.5;
/// Lobes are looked for down to this width, degrees: a tenth of the half width of one of roughness 0.02, 2 arctan(α) ≈ 0.046°.
const FINEST: f64 = 2e-3;
/// Jumps are located this well, degrees.
const JUMP: f64 = 1e-6;
/// How near to the horizon the curves of what only reflects go, degrees: beyond it every function is 0.
const HORIZON: f64 = 1e-3;

/// The curve of a function at an angle of incidence.
pub(crate) struct Curve {
    /// Which function.
    pub function: usize,
    /// Angle of incidence, degrees.
    pub theta: f64,
    /// Value by the angle of reflection in degrees: negative on the side of the light, beyond 90 below the surface.
    pub trace: Trace,
    /// Angle, and share of each channel, of the discrete directions in the plane of incidence.
    pub spikes: Vec<(f64, [f64; 3])>,
    /// How each number of the colour is drawn.
    pub strokes: Vec<(Stroke, [f64; 3])>,
}

/// Curves that share an axis.
pub(crate) struct Curves {
    pub all: Vec<Curve>,
    pub scale: Scale,
    pub legend: Vec<Entry>,
    /// Whether the angles of incidence have colours of their own.
    pub coloured_angles: bool,
}

/// The direction at `t` degrees from the normal, in the plane of azimuth `phi` degrees.
pub(crate) fn direction(t: f64, phi: f64) -> Vec3<f64> {
    let (sin, cos) = Real::sin_cos(t.to_radians());
    let (sin_phi, cos_phi) = Real::sin_cos(phi.to_radians());
    Vec3::new(sin * cos_phi, sin * sin_phi, cos)
}

/// The angle of a direction in the plane of azimuth `phi`, degrees in (−180, 180]; nothing if it leaves the plane.
fn angle_in_plane(w: Vec3<f64>, phi: f64) -> Option<f64> {
    let (sin_phi, cos_phi) = Real::sin_cos(phi.to_radians());
    let across = w.y * cos_phi - w.x * sin_phi;
    let along = w.x * cos_phi + w.y * sin_phi;
    (across.abs() < 1e-6).then(|| Real::atan2(along, w.z).to_degrees())
}

impl Curves {
    /// The curves of `functions` at `thetas`. `place` says where a value at an angle is drawn on a scale, in pixels; `auto` what a scale
    /// becomes for which proportion shows nothing.
    pub fn new(
        functions: &[Function],
        options: &Options,
        thetas: &[f64],
        place: &dyn Fn(&Scale, f64, f64) -> [f64; 2],
        auto: ScaleKind,
    ) -> Self {
        let weights = options.channel.weights();
        let mut all = Vec::new();
        for (k, f) in functions.iter().enumerate() {
            for (j, &theta) in thetas.iter().enumerate() {
                all.push(Curve {
                    function: k,
                    theta,
                    trace: Trace::new(
                        &values(f, options, theta),
                        range(f),
                        STEP,
                        &narrow(f, options, theta),
                        FINEST,
                    ),
                    spikes: spikes(f, options, theta),
                    strokes: strokes(functions.len(), thetas.len(), options.channel, k, j),
                });
            }
        }
        let mut scale = scale(&all, weights, options.scale, auto);
        for _ in 0..3 {
            for curve in &mut all {
                let eval = values(&functions[curve.function], options, curve.theta);
                let place: &Place = &|t, x| place(&scale, t, x);
                curve.trace.refine(&eval, weights, place, JUMP, FLATNESS);
            }
            // A summit that was found only now may need a longer axis.
            let better = self::scale(&all, weights, options.scale, auto);
            if better == scale {
                break;
            }
            scale = better;
        }
        Self {
            legend: legend(functions, thetas, options),
            coloured_angles: functions.len() == 1 && options.channel != Channel::Rgb,
            all,
            scale,
        }
    }

    /// How many values aren't finite.
    pub fn gaps(&self) -> usize {
        self.all.iter().map(|c| c.trace.gaps()).sum()
    }

    /// Whether any has a value above 0.
    pub fn any(&self) -> bool {
        let mut strokes = self.all.iter().map(|c| (c, &c.strokes));
        strokes.any(|(c, s)| s.iter().any(|(_, w)| c.trace.peak(&[*w]).is_some()))
    }

    /// The note on values that are beyond the end of the axis.
    pub fn beyond_note(&self, options: &Options) -> Option<String> {
        let peaks = self.all.iter();
        let (t, most) = peaks
            .filter_map(|c| c.trace.peak(options.channel.weights()))
            .max_by(|a, b| a.1.total_cmp(&b.1))?;
        (most > self.scale.high * (1.0 + 1e-9)).then(|| {
            format!(
                "Near the horizon values reach {} sr⁻¹, at {}°: they are cut off.",
                number(most),
                number(t)
            )
        })
    }

    /// Whether there are discrete directions.
    pub fn discrete(&self) -> bool {
        self.all.iter().any(|c| !c.spikes.is_empty())
    }

    /// Each curve in words, for those who can't see the picture.
    pub fn in_words(&self, functions: &[Function], options: &Options) -> String {
        let mut text = String::new();
        for c in &self.all {
            let name = &functions[c.function].name;
            let from = format!(" {name}, light from {}°:", number(c.theta));
            match c.trace.peak(options.channel.weights()) {
                Some((t, x)) => {
                    text += &format!("{from} largest value {} sr⁻¹ at {}°.", number(x), number(t));
                }
                None => text += &format!("{from} no value above 0."),
            }
            for (t, share) in &c.spikes {
                let share = number(options.channel.value(*share));
                text += &format!(" Dirac delta at {}°, share {share}.", number(*t));
            }
        }
        text
    }
}

/// f, with the cosine if asked for, by the angle of reflection.
fn values<'f>(
    f: &'f Function,
    options: &Options,
    theta: f64,
) -> impl Fn(&[f64]) -> Vec<[f64; 3]> + 'f {
    let (phi, cosine) = (options.phi_deg, options.cosine);
    let wi = direction(-theta, phi);
    move |at: &[f64]| {
        let pairs: Vec<_> = at.iter().map(|t| [wi, direction(*t, phi)]).collect();
        let mut values = f.eval(&pairs);
        if cosine {
            for (value, [_, wo]) in values.iter_mut().zip(&pairs) {
                *value = value.map(|x| x * wo.z.abs());
            }
        }
        values
    }
}

fn range(f: &Function) -> [f64; 2] {
    if f.transmits() {
        [-180.0, 180.0]
    } else {
        [-90.0 + HORIZON, 90.0 - HORIZON]
    }
}

fn narrow(f: &Function, options: &Options, theta: f64) -> Vec<f64> {
    let wi = direction(-theta, options.phi_deg);
    let lobes = f.lobes(wi).into_iter();
    lobes
        .filter_map(|w| angle_in_plane(w, options.phi_deg))
        .chain([0.0])
        .collect()
}

fn spikes(f: &Function, options: &Options, theta: f64) -> Vec<(f64, [f64; 3])> {
    let wi = direction(-theta, options.phi_deg);
    let in_plane = |s: &Spike| Some((angle_in_plane(s.wo, options.phi_deg)?, s.share));
    f.spikes(wi).iter().filter_map(in_plane).collect()
}

/// Directions nearer to the horizon than this, degrees, make no axis longer than three times what the others need: there a function may grow
/// without bound, and nothing else would be seen.
const GRAZING: f64 = 5.0;

/// The axis on which all can be read.
fn scale(all: &[Curve], weights: &[[f64; 3]], kind: ScaleKind, auto: ScaleKind) -> Scale {
    let grazing = |t: f64| (t.abs() - 90.0).abs() < GRAZING;
    let range_of = |curve: &Curve, all_angles: bool| {
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for (t, colour) in &curve.trace.points {
            if grazing(*t) && !all_angles {
                continue;
            }
            for w in weights {
                let x = weighted(*w, *colour);
                if x > 0.0 && x.is_finite() {
                    (least, most) = (least.min(x), most.max(x));
                }
            }
        }
        (least, most)
    };
    let ranges: Vec<(f64, f64)> = all.iter().map(|c| range_of(c, false)).collect();
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let most = largest(&mut ranges.iter().map(|r| r.1));
    let with_grazing = largest(&mut all.iter().map(|c| range_of(c, true).1));
    let peaks = ranges.iter().map(|r| r.1).filter(|x| *x > 0.0);
    let lowest = peaks.fold(f64::INFINITY, f64::min);
    let thin = lowest < 0.2 * most
        || all
            .iter()
            .zip(&ranges)
            .any(|(c, (_, peak))| *peak > 0.0 && c.trace.width_above(weights, 0.1 * peak) < 30.0);
    // Grazing directions, where a cosine takes everything to 0, don't make the axis begin lower either.
    let least = ranges.iter().map(|r| r.0).fold(f64::INFINITY, f64::min);
    let kind = match kind {
        ScaleKind::Auto if thin => auto,
        ScaleKind::Auto => ScaleKind::Linear,
        kind => kind,
    };
    let end = if kind == ScaleKind::Log || with_grazing < 3.0 * most || most == 0.0 {
        with_grazing
    } else {
        most
    };
    Scale::new(kind, least, end, false)
}

/// Red, green and blue that differ to all eyes by their lightness, too.
pub(crate) const CHANNELS: [(u32, &str); 3] =
    [(0xc6262e, "red"), (0x2f9e44, "green"), (0x1c4fd6, "blue")];

/// The `function`-th function at the `angle`-th angle.
fn strokes(
    functions: usize,
    angles: usize,
    channel: Channel,
    function: usize,
    angle: usize,
) -> Vec<(Stroke, [f64; 3])> {
    let stroke = |colour, pattern| Stroke {
        colour,
        width: 1.8,
        dash: dash(pattern),
    };
    let weights = channel.weights();
    if channel == Channel::Rgb {
        let colours = CHANNELS.iter().zip(weights);
        return colours
            .zip([4.0, 2.6, 1.3])
            .map(|(((colour, _), w), width)| {
                // Each is seen under the next where they are the same.
                let stroke = Stroke {
                    width,
                    ..stroke(*colour, angle)
                };
                (stroke, *w)
            })
            .collect();
    }
    let look = match (functions, angles) {
        (1, _) => stroke(PALETTE[angle % PALETTE.len()], angle),
        (_, 1) => stroke(PALETTE[function % PALETTE.len()], function),
        _ => stroke(PALETTE[function % PALETTE.len()], angle),
    };
    vec![(look, weights[0])]
}

fn legend(functions: &[Function], thetas: &[f64], options: &Options) -> Vec<Entry> {
    let several = functions.len() > 1;
    let mut entries = Vec::new();
    if options.channel == Channel::Rgb {
        entries.push(Entry::heading("Channel"));
        for (colour, name) in CHANNELS {
            entries.push(Entry::line(Stroke::new(colour, 2.2), name));
        }
    } else if several {
        entries.push(Entry::heading("Function"));
        for (k, f) in functions.iter().enumerate() {
            let (mut stroke, _) = strokes(functions.len(), thetas.len(), options.channel, k, 0)[0];
            stroke.width = 2.2;
            entries.push(Entry::line(stroke, &f.name));
        }
    }
    entries.push(Entry::heading("Angle of incidence"));
    for (j, theta) in thetas.iter().enumerate() {
        let words = format!("θi = {}°", number(*theta));
        let alone = !several && options.channel != Channel::Rgb;
        let colour = if alone {
            PALETTE[j % PALETTE.len()]
        } else {
            INK
        };
        let stroke = Stroke {
            colour,
            width: 2.2,
            dash: if several && thetas.len() == 1 {
                ""
            } else {
                dash(j)
            },
        };
        entries.push(Entry::line(stroke, words));
    }
    if several && thetas.len() == 1 {
        // Nothing to tell apart: the words are enough.
        entries.truncate(entries.len() - 2);
        entries.push(Entry::heading(format!("θi = {}°", number(thetas[0]))));
    }
    entries
}
