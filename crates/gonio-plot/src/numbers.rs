//! What the plots are drawn from, as numbers: for programs that draw for themselves.

use crate::curves::{Curves, direction};
use crate::mesh::{Closeness, Mesh};
use crate::scale::{Scale, ScaleKind};
use crate::{Channel, Function, Options, PlotError, ball, integral, slice};
use gonio_num::{Real, Vec3};

/// Light that leaves in one discrete direction: a mirror's.
pub use crate::function::Spike;

/// A lobe: f for light from one direction, over the directions of reflection.
#[derive(Debug, Clone, PartialEq)]
pub struct LobeSurface {
    /// Unit vectors to the viewer, local frame; one a corner.
    pub directions: Vec<Vec3<f64>>,
    /// f \[sr⁻¹] there, times |cosθr| if asked for.
    pub values: Vec<[f64; 3]>,
    /// Three corners each, counterclockwise seen from outside. There are no cracks.
    pub triangles: Vec<[u32; 3]>,
    /// What leaves in discrete directions.
    pub spikes: Vec<Spike>,
}

/// The surface that [`lobe3d`](crate::lobe3d()) draws, in proportion or by the cube root: triangles are small where it bends.
///
/// - `wi`: to the light, unit
/// - `kind`: how the values will be drawn, which decides where the surface bends; [`ScaleKind::Auto`] stands for the cube root, which
///   bends more than proportion does
/// - `quick`: for a picture that is about to change: about half the triangles, and a needle's tip may be blunt
pub fn lobe_surface(
    f: &Function,
    wi: Vec3<f64>,
    cosine: bool,
    kind: ScaleKind,
    quick: bool,
) -> LobeSurface {
    let kind = match kind {
        ScaleKind::Auto => ScaleKind::CubeRoot,
        kind => kind,
    };
    let value = |c: [f64; 3]| Channel::Luminance.value(c);
    let radius = |largest: f64, c: [f64; 3]| {
        let r = Scale::new(kind, largest * 1e-4, largest, false).position(value(c));
        if r.is_finite() { r } else { 0.0 }
    };
    let closeness = if quick {
        Closeness::QUICK
    } else {
        Closeness::FINE
    };
    let mesh = Mesh::new(f, wi, cosine, &radius, &value, closeness);
    let (directions, values) = mesh.corners.into_iter().unzip();
    LobeSurface {
        directions,
        values,
        triangles: mesh.triangles,
        spikes: f.spikes(wi),
    }
}

/// f in the plane of incidence.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneCurve {
    /// Angle of reflection in degrees, and f \[sr⁻¹] there, times |cosθr| if asked for. Positive angles are on the side away from the light,
    /// where a mirror reflects; beyond ±90° is below the surface, for what transmits.
    pub points: Vec<(f64, [f64; 3])>,
    /// Angle, and share of the light, of discrete directions in the plane.
    pub spikes: Vec<(f64, [f64; 3])>,
}

/// The curve that [`polar`](crate::polar()) and [`cartesian`](crate::cartesian()) draw, with a point wherever it bends.
///
/// - `theta`: angle of incidence, degrees, in [0, 180), not 90
/// - `phi`: azimuth of the plane of incidence, degrees: light comes from `phi` + 180
///
/// # Errors
/// [`PlotError::Option`] for other angles.
pub fn plane_curve(
    f: &Function,
    theta: f64,
    phi: f64,
    cosine: bool,
) -> Result<PlaneCurve, PlotError> {
    /// The side of the square in which the curve is to look smooth, pixels.
    const SIDE: f64 = 600.0;
    let options = Options {
        theta_deg: vec![theta],
        phi_deg: phi,
        cosine,
        ..Options::default()
    };
    options.check(1)?;
    let place = |scale: &Scale, t: f64, x: f64| [SIDE * t / 180.0, SIDE * scale.position(x)];
    let functions = std::slice::from_ref(f);
    let mut curves = Curves::new(functions, &options, &[theta], &place, ScaleKind::CubeRoot);
    let curve = curves.all.swap_remove(0);
    Ok(PlaneCurve {
        points: curve.trace.points,
        spikes: curve.spikes,
    })
}

/// The directional albedo at one angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionalAlbedo {
    /// The share of a beam that is reflected.
    pub reflected: [f64; 3],
    /// With what passes to the other side, in units of n².
    pub total: [f64; 3],
    /// How far the last two steps of the quadrature are apart.
    pub error: f64,
    /// Values that were not finite, taken as 0.
    pub gaps: usize,
}

/// a(ω) = ∫ f |cosθi| dωi at `theta` and `phi` degrees, as [`albedo`](crate::albedo()) draws it.
pub fn directional_albedo(f: &Function, theta: f64, phi: f64) -> DirectionalAlbedo {
    let a = integral::albedo(f, direction(theta, phi));
    DirectionalAlbedo {
        reflected: a.reflected,
        total: a.total,
        error: a.error,
        gaps: a.gaps,
    }
}

/// The cells along each side of a slice.
pub const SLICE_SIDE: usize = slice::CELLS;

/// f \[sr⁻¹] in each cell of the picture that [`slice()`](crate::slice()) draws, [`SLICE_SIDE`] a side, row by row from θd = 90° down to 0, θh growing to the right;
/// NaN where one of the directions is below the horizon.
pub fn slice_values(f: &Function, phi_d: f64) -> Vec<[f64; 3]> {
    let options = Options {
        phi_d_deg: phi_d,
        ..Options::default()
    };
    let pairs = slice::pairs(&options);
    let mut values = slice::values(f, &pairs);
    for (value, pair) in values.iter_mut().zip(&pairs) {
        if pair.is_none() {
            *value = [f64::NAN; 3];
        }
    }
    values
}

/// f \[sr⁻¹] for light from `wi`, times |cosθr| if asked for, over the directions of reflection seen from above: `side`² pixels, row by row from
/// the top, azimuthal equidistant; NaN beside the disc, which fills the picture. The radius is proportional to θr, 90° at the rim; φ = 0 is
/// to the right, φ = 90° up.
pub fn hemisphere_values(f: &Function, wi: Vec3<f64>, cosine: bool, side: usize) -> Vec<[f64; 3]> {
    let mut at = Vec::new();
    let mut pairs = Vec::new();
    for k in 0..side * side {
        let place = |k: usize| 2.0 * (k as f64 + 0.5) / side as f64 - 1.0;
        let (x, y) = (place(k % side), -place(k / side));
        let radius = (x * x + y * y).sqrt();
        if radius < 1.0 {
            let wo = direction(90.0 * radius, Real::atan2(y, x).to_degrees());
            at.push(k);
            pairs.push([wi, wo]);
        }
    }
    let mut pixels = vec![[f64::NAN; 3]; side * side];
    for ((k, [_, wo]), value) in at.into_iter().zip(&pairs).zip(f.eval(&pairs)) {
        let factor = if cosine { wo.z.abs() } else { 1.0 };
        pixels[k] = value.map(|x| x * factor);
    }
    pixels
}

/// Which factors of the reflection equation Lr = L f cosθ take part; the others are 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Factors {
    /// L, the light: π, so that a white Lambertian surface that faces it appears as 1.
    pub light: bool,
    /// f, the reflection function.
    pub brdf: bool,
    /// cosθi, the light's foreshortening.
    pub cosine: bool,
}

impl Factors {
    /// The whole equation.
    pub const ALL: Self = Self {
        light: true,
        brdf: true,
        cosine: true,
    };
}

/// A ball under light from one direction, seen from far away: L f cosθ of each of `side`² pixels, row by row from the top; NaN beside the
/// ball, which fills the picture. As [`sphere`](crate::sphere()) draws it, without a tone curve, one value a pixel.
///
/// - `light`: to the light, unit; x to the right, y up, z to the viewer. What it doesn't reach is 0.
/// - `tangent`: the local frame's x is along the circle of latitude, turned by so many degrees
pub fn ball_values(
    f: &Function,
    light: Vec3<f64>,
    tangent: f64,
    side: usize,
    factors: Factors,
) -> Vec<[f64; 3]> {
    ball::values(f, light, tangent, side, factors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn paint() -> Function<'static> {
        Function::new("paint", |wi: Vec3<f64>, wo: Vec3<f64>| {
            [if wi.z > 0.0 && wo.z > 0.0 {
                0.5 / PI
            } else {
                0.0
            }; 3]
        })
    }

    #[test]
    fn numbers_of_a_lambertian_surface() {
        let f = paint();
        let wi = direction(-45.0, 0.0);
        let lobe = lobe_surface(&f, wi, false, ScaleKind::Auto, false);
        assert!(lobe.values.iter().all(|v| *v == [0.5 / PI; 3]));
        assert!(lobe.directions.len() > 100 && lobe.spikes.is_empty());
        let with_cosine = lobe_surface(&f, wi, true, ScaleKind::Auto, true);
        for (w, v) in with_cosine.directions.iter().zip(&with_cosine.values) {
            assert!((v[0] - 0.5 / PI * w.z).abs() < 1e-15);
        }
        let curve = plane_curve(&f, 45.0, 0.0, false).unwrap();
        assert!(curve.points.windows(2).all(|w| w[0].0 < w[1].0));
        assert!(curve.points.iter().all(|(_, v)| *v == [0.5 / PI; 3]));
        assert!(plane_curve(&f, 90.0, 0.0, false).is_err());
        // The quadrature stops when two steps agree to 5e-4.
        let a = directional_albedo(&f, 30.0, 0.0);
        assert!((a.total[0] - 0.5).abs() < 5e-4 && a.gaps == 0, "{a:?}");
        let slice = slice_values(&f, 0.0);
        assert_eq!(slice.len(), SLICE_SIDE * SLICE_SIDE);
        // At φd = 0 one direction is at θh + θd from the normal.
        assert!(slice[SLICE_SIDE - 1][0].is_nan() && slice[0][0] > 0.0);
    }

    /// A function of φr alone tells which way the picture lies.
    #[test]
    fn a_hemisphere_lies_as_it_says() {
        let f = Function::new("", |_, wo: Vec3<f64>| [wo.x, wo.y, wo.z]);
        let side = 90;
        let all = hemisphere_values(&f, direction(0.0, 0.0), false, side);
        // The pixel in row 44 and column 67 is at (0.5, 0.011): θr = 45°, φr = 1.3°.
        let [x, y, z] = all[44 * side + 67];
        let half = 0.5_f64.sqrt();
        assert!((x - half).abs() < 0.02 && (z - half).abs() < 0.02 && y > 0.0);
        let [x, y, _] = all[22 * side + 44];
        assert!(y > 0.65 && x.abs() < 0.02);
        assert!(all[0][0].is_nan());
    }

    /// In the middle the normal is the viewer's direction; light from 60° off is there with cos 60° = 1/2.
    #[test]
    fn factors_of_a_ball_multiply() {
        let f = paint();
        let light = direction(60.0, 0.0);
        let side = 101;
        let middle = side * side / 2;
        let of = |light_on, brdf, cosine| {
            let factors = Factors {
                light: light_on,
                brdf,
                cosine,
            };
            ball_values(&f, light, 0.0, side, factors)[middle][0]
        };
        let expected = |light: bool, brdf: bool, cosine: bool| {
            let factor = |on: bool, x: f64| if on { x } else { 1.0 };
            factor(light, PI) * factor(brdf, 0.5 / PI) * factor(cosine, 0.5)
        };
        for k in 0..8 {
            let (a, b, c) = (k & 1 > 0, k & 2 > 0, k & 4 > 0);
            assert!((of(a, b, c) - expected(a, b, c)).abs() < 1e-12, "{k}");
        }
        let all = ball_values(&f, light, 0.0, side, Factors::ALL);
        assert!(all[0][0].is_nan());
        // The left is in the shadow.
        assert_eq!(all[side * (side / 2) + 3][0], 0.0);
    }
}
