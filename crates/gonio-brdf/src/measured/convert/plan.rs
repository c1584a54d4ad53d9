//! [`Plan`], the layout and the channels that a source is resampled to.

use super::super::build::{Layout, Progress, tabulate};
use super::super::channel::{Channel, rgb, wavelengths, xyz};
use super::super::format::{Format, merl, utia};
use super::super::grid::{Axis, Boundary, Parameterization, Scale};
use super::super::klems::Basis;
use super::super::measurement::{Data, Measurement, Side};
use super::Target;
use super::source::Source;
use crate::BrdfError;
use crate::part::geometry::turned;
use gonio_num::{Real, Vec3};
use gonio_radiometry::colour::upsample::{Solver, UnboundedRgb};
use gonio_radiometry::colour::{Matrix3, RgbSpace, bradford};
use gonio_radiometry::direction::spherical_direction;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The layouts that can be asked for, with their usual resolutions.
pub const TARGETS: &[Shape] = &[
    Shape::new("half-difference", "θh × θd × φd", &[90, 45, 36]),
    Shape::new(
        "half-difference-anisotropic",
        "θh × φh × θd × φd",
        &[48, 24, 24, 18],
    ),
    Shape::new("spherical", "θi × θo × (φo − φi)", &[31, 31, 36]),
    Shape::new(
        "spherical-anisotropic",
        "θi × φi × θo × φo",
        &[13, 24, 13, 24],
    ),
    Shape::new("klems-full", "145 patches", &[]),
    Shape::new("klems-half", "73 patches", &[]),
    Shape::new("klems-quarter", "41 patches", &[]),
    Shape::new("tensor-tree-3", "levels", &[6]),
    Shape::new("tensor-tree-4", "levels", &[4]),
];

/// A layout that can be asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Its name.
    pub name: &'static str,
    /// What its resolution counts.
    pub counts: &'static str,
    /// The usual resolution.
    pub usual: &'static [usize],
}

impl Shape {
    const fn new(name: &'static str, counts: &'static str, usual: &'static [usize]) -> Self {
        Self {
            name,
            counts,
            usual,
        }
    }
}

/// How colours are written.
#[derive(Debug, Clone, PartialEq)]
enum Colours {
    /// The channels of the source's file as they are.
    AsTheyAre(Vec<Channel>),
    Rgb,
    Xyz,
    Luminance,
    /// Smooth spectra with the colours of the source, at these wavelengths.
    Upsampled(Vec<f64>),
}

/// What a source is resampled to.
#[derive(Debug)]
pub(super) struct Plan {
    layout: Layout,
    colours: Colours,
    sides: Vec<Side>,
    /// The mean over azimuths is taken.
    turn: bool,
    /// The mean of both orders of the directions is taken.
    exchange: bool,
    /// The mean of both sides of the plane of incidence is taken.
    mirror: bool,
}

impl Plan {
    pub fn new(source: &Source, format: &Format, target: &Target) -> Result<Self, BrdfError> {
        if format.name == "rgl" {
            return Err(unsupported(format!(
                "{}: a file of the format rgl holds an adaptive table, which is copied from a file that has one and not made of anything else; \
                 gonio holds every other layout, merl and utia hold RGB on regular angles, radiance patches and trees",
                source.name()
            )));
        }
        let isotropic = source.is_isotropic();
        let own = source
            .measurement()
            .and_then(|m| match &m.components[0].data {
                Data::Grid(g) => Some(g.parameterization().name()),
                _ => None,
            });
        let usual = match (format.name, isotropic) {
            ("merl", _) => "half-difference",
            ("utia", _) => "spherical-anisotropic",
            ("radiance", _) => "klems-full",
            ("pbrt", _) | ("astm", true) => "spherical",
            ("astm", false) => "spherical-anisotropic",
            (_, true) => own.unwrap_or("half-difference"),
            (_, false) => own.unwrap_or("half-difference-anisotropic"),
        };
        let name = target.parameterization.as_deref().unwrap_or(usual);
        let shape = TARGETS.iter().find(|t| t.name == name).ok_or_else(|| {
            let all: Vec<_> = TARGETS.iter().map(|t| t.name).collect();
            unsupported(format!("no layout `{name}`: known are {}", all.join(", ")))
        })?;
        let fits = match format.name {
            "merl" => name == "half-difference",
            "utia" => name == "spherical-anisotropic",
            "pbrt" => name == "spherical",
            "astm" => name.starts_with("spherical"),
            "radiance" => name.starts_with("klems") || name.starts_with("tensor"),
            _ => true,
        };
        if !fits {
            return Err(unsupported(format!(
                "a file of the format {} can't hold the layout {name}",
                format.name
            )));
        }
        let resolution = resolution(format, shape, target)?;
        let layout = layout(format, name, &resolution)?;
        let (mut exchange, mut mirror) = (false, false);
        let mut layout_is_isotropic = name == "tensor-tree-3";
        if let Layout::Grid(p, _) = &layout {
            layout_is_isotropic = p.is_isotropic();
            exchange = p.is_half();
            mirror = format.name == "pbrt";
        }
        let sides = match format.name {
            "radiance" | "gonio" if !exchange => source.sides(),
            _ => vec![Side::ReflectionFront],
        };
        if !sides.iter().any(|s| source.sides().contains(s)) {
            let names: Vec<_> = source.sides().iter().map(|s| s.name()).collect();
            return Err(unsupported(format!(
                "{} has {} only, and this format and layout hold the reflection on the front",
                source.name(),
                names.join(", ")
            )));
        }
        Ok(Self {
            layout,
            colours: colours(source, format),
            sides,
            turn: layout_is_isotropic && !isotropic,
            exchange,
            mirror,
        })
    }

    /// Evaluates the source all over the layout.
    pub fn carry_out(
        &self,
        source: &Source,
        progress: &mut Progress<'_>,
    ) -> Result<Measurement, BrdfError> {
        let channels = self.channels();
        let mut part = vec![0.0; channels.len()];
        let paint = Paint::new(&self.colours);
        let mut f = |wi: Vec3<f64>, wo: Vec3<f64>, out: &mut [f64]| {
            let turns: usize = if self.turn { 8 } else { 1 };
            let mut count = 0.0;
            for turn in 0..turns {
                let (sin, cos) = Real::sin_cos(TAU * turn as f64 / turns as f64);
                let (a, b) = (turned(wi, cos, sin), turned(wo, cos, sin));
                let flipped = |w: Vec3<f64>| Vec3::new(w.x, -w.y, w.z);
                let mut add = |a: Vec3<f64>, b: Vec3<f64>| {
                    paint.at(source, a, b, &mut part);
                    for (sum, x) in out.iter_mut().zip(&part) {
                        *sum += x;
                    }
                    count += 1.0;
                };
                add(a, b);
                if self.exchange {
                    add(b, a);
                }
                if self.mirror {
                    add(flipped(a), flipped(b));
                }
            }
            for sum in out.iter_mut() {
                *sum /= count;
            }
        };
        tabulate(&self.layout, &channels, &self.sides, &mut f, progress)
    }

    fn channels(&self) -> Vec<Channel> {
        match &self.colours {
            Colours::AsTheyAre(channels) => channels.clone(),
            Colours::Rgb => rgb(),
            Colours::Xyz => xyz(),
            Colours::Luminance => vec![Channel::Luminance],
            Colours::Upsampled(nm) => nm.iter().map(|nm| Channel::Wavelength(*nm)).collect(),
        }
    }
}

/// The source's colours in the plan's channels.
struct Paint<'a> {
    colours: &'a Colours,
    to_xyz: Matrix3,
}

impl<'a> Paint<'a> {
    fn new(colours: &'a Colours) -> Self {
        let space = RgbSpace::SRGB;
        // Relative to equal energy, as the channels X, Y and Z are.
        let to_xyz = space.to_xyz().then(&bradford(space.white_xyz(), [1.0; 3]));
        Self { colours, to_xyz }
    }

    fn at(&self, source: &Source, wi: Vec3<f64>, wo: Vec3<f64>, out: &mut [f64]) {
        match self.colours {
            Colours::AsTheyAre(_) => {
                if let Some(measurement) = source.measurement() {
                    out.copy_from_slice(&measurement.eval(wi, wo));
                }
            }
            Colours::Rgb => out.copy_from_slice(&source.rgb(wi, wo)),
            Colours::Xyz => out.copy_from_slice(&self.to_xyz.apply(source.rgb(wi, wo))),
            Colours::Luminance => out[0] = source.rgb(wi, wo)[0],
            Colours::Upsampled(nm) => {
                let spectrum = UnboundedRgb::solve(Solver::srgb(), source.rgb(wi, wo));
                for (x, nm) in out.iter_mut().zip(nm) {
                    *x = spectrum.at(*nm);
                }
            }
        }
    }
}

fn unsupported(what: String) -> BrdfError {
    BrdfError::Unsupported { what }
}

/// Whether the source is grey: a file by its channels, a model at some directions.
fn is_grey(source: &Source) -> bool {
    if let Some(measured) = source.measured() {
        return measured.is_grey();
    }
    (0..24).all(|k| {
        let t = f64::from(k);
        let wi = spherical_direction(0.06 * t, 0.4 * t);
        let [r, g, b] = source.rgb(wi, spherical_direction(1.4 - 0.05 * t, 3.1 + 0.3 * t));
        (r - g).abs() <= 1e-12 * r.abs() && (r - b).abs() <= 1e-12 * r.abs()
    })
}

fn colours(source: &Source, format: &Format) -> Colours {
    let channels = source.measurement().map(|m| m.channels.clone());
    match (format.name, channels) {
        ("merl" | "utia", _) => Colours::Rgb,
        ("pbrt", Some(channels)) if wavelengths(&channels).len() == channels.len() => {
            Colours::AsTheyAre(channels)
        }
        ("pbrt", _) => Colours::Upsampled((0..=30).map(|k| f64::from(400 + 10 * k)).collect()),
        ("radiance", _) if is_grey(source) => Colours::Luminance,
        ("radiance", _) => Colours::Xyz,
        (_, Some(channels)) => Colours::AsTheyAre(channels),
        (_, None) if is_grey(source) => Colours::Luminance,
        (_, None) => Colours::Rgb,
    }
}

/// The resolution that is asked for, or the usual one.
fn resolution(format: &Format, shape: &Shape, target: &Target) -> Result<Vec<usize>, BrdfError> {
    let usual = match (format.name, shape.name) {
        ("merl", _) => &merl::DATABASE[..],
        ("pbrt", _) => &[31, 31, 37],
        _ => shape.usual,
    };
    let Some(asked) = &target.resolution else {
        return Ok(usual.to_vec());
    };
    let wrong = || {
        unsupported(format!(
            "a resolution of {asked:?} for {}: expected {} numbers ({}), such as {usual:?}",
            shape.name,
            usual.len(),
            shape.counts
        ))
    };
    if usual.is_empty() || format.name == "utia" {
        return Err(unsupported(format!(
            "a resolution of {asked:?}: this format and layout have only one"
        )));
    }
    let scaled = |n: &usize| ((n * asked[0]) as f64 / usual[0] as f64).round().max(2.0) as usize;
    let all: Vec<usize> = match asked.len() {
        n if n == usual.len() => asked.clone(),
        // One number is the first; the others keep their ratios to it.
        1 => usual.iter().map(scaled).collect(),
        _ => return Err(wrong()),
    };
    let cells = all.iter().try_fold(1usize, |n, k| n.checked_mul(*k));
    if all.iter().any(|n| *n < 1 || *n > 4096) || cells.is_none_or(|n| n > 1 << 28) {
        return Err(wrong());
    }
    Ok(all)
}

fn layout(format: &Format, name: &str, n: &[usize]) -> Result<Layout, BrdfError> {
    let axis = |nodes: Vec<f64>, boundary, scale| {
        Axis::new(nodes, boundary, scale).map_err(|e| unsupported(format!("a layout with {e}")))
    };
    let linear = |nodes, boundary| axis(nodes, boundary, Scale::Linear);
    let centres = |n: usize, size: f64| -> Vec<f64> {
        (0..n).map(|k| (k as f64 + 0.5) / n as f64 * size).collect()
    };
    let theta_h = |n: usize| {
        let nodes = centres(n, 1.0).iter().map(|x| x * x * FRAC_PI_2).collect();
        axis(nodes, Boundary::Clamped, Scale::SquareRoot)
    };
    let steps = |n: usize, size: f64| -> Vec<f64> {
        let last = (n.max(2) - 1) as f64;
        (0..n.max(2)).map(|k| k as f64 / last * size).collect()
    };
    let elevations = |n: usize| linear(steps(n, FRAC_PI_2), Boundary::Clamped);
    let turn = |n: usize| {
        let nodes = (0..n).map(|k| k as f64 / n as f64 * TAU).collect();
        linear(nodes, Boundary::Periodic(TAU))
    };
    let difference = |d: usize, phi: usize| {
        Ok::<_, BrdfError>((
            linear(centres(d, FRAC_PI_2), Boundary::Clamped)?,
            linear(centres(phi, PI), Boundary::Periodic(PI))?,
        ))
    };
    let patches = |name: &str| {
        let basis = Basis::known(name).ok_or_else(|| unsupported(format!("no basis {name}")))?;
        Ok::<_, BrdfError>(Layout::Klems(basis.clone(), basis))
    };
    Ok(match (format.name, name) {
        ("utia", _) => Layout::Grid(
            Parameterization::SphericalAnisotropic,
            utia::axes().map_err(unsupported)?,
        ),
        ("pbrt", _) => Layout::Grid(
            Parameterization::Spherical,
            vec![
                elevations(n[0])?,
                elevations(n[1])?,
                linear(steps(n[2], PI), Boundary::Mirrored(TAU))?,
            ],
        ),
        ("merl", _) => {
            let dims = [n[0], n[1], n[2]];
            let axes = merl::axes(dims).map_err(unsupported)?;
            Layout::Grid(Parameterization::HalfDifference, axes)
        }
        (_, "half-difference") => {
            let (d, phi) = difference(n[1], n[2])?;
            let axes = vec![theta_h(n[0])?, d, phi];
            Layout::Grid(Parameterization::HalfDifference, axes)
        }
        (_, "half-difference-anisotropic") => {
            let (d, phi) = difference(n[2], n[3])?;
            let axes = vec![theta_h(n[0])?, turn(n[1])?, d, phi];
            Layout::Grid(Parameterization::HalfDifferenceAnisotropic, axes)
        }
        (_, "spherical") => Layout::Grid(
            Parameterization::Spherical,
            vec![elevations(n[0])?, elevations(n[1])?, turn(n[2])?],
        ),
        (_, "spherical-anisotropic") => Layout::Grid(
            Parameterization::SphericalAnisotropic,
            vec![
                elevations(n[0])?,
                turn(n[1])?,
                elevations(n[2])?,
                turn(n[3])?,
            ],
        ),
        (_, "klems-full") => patches("LBNL/Klems Full")?,
        (_, "klems-half") => patches("LBNL/Klems Half")?,
        (_, "klems-quarter") => patches("LBNL/Klems Quarter")?,
        (_, tree) => Layout::TensorTree {
            rank: if tree == "tensor-tree-3" { 3 } else { 4 },
            depth: n[0] as u32,
            tolerance: 1e-3,
        },
    })
}
