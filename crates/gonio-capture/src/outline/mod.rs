//! The ball's outline in a photograph.
//!
//! First the circle of a small picture whose circumference is an edge nearly everywhere (`search.rs`). Near the rim a ball
//! squeezes everything into lines that run along it, so that circle may be one of these. In the full picture the edges along
//! many normals tell (`rim.rs`): the outline is the outermost of the curves that nearly all normals have an edge on. Last, the
//! cone of rays (an ellipse; a circle for an orthographic camera) through these edges, by Gauss–Newton with Tukey's weights.

mod edges;
mod rim;
mod search;

use crate::ball::{Ball, Projection};
use crate::{CaptureError, solve};
use edges::Plane;
use gonio_image::Image;
use gonio_num::Real;
use std::f64::consts::TAU;

/// Longer side \[pixels] of the picture that is searched.
const SEARCHED: usize = 420;
/// Edges that take part in the search.
const MOST_EDGES: usize = 9000;
/// The least share of a ball's outline that is an edge, beyond chance.
pub const LEAST_COVERAGE: f64 = 0.45;

/// What is known of the camera besides the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lens {
    /// Nothing: taken as infinitely far away.
    Unknown,
    /// Horizontal field of view \[rad].
    FieldOfView(f64),
    /// Distance of the camera from the ball's centre, in radii of the ball; > 1.
    Distance(f64),
}

/// A ball's outline.
#[derive(Debug, Clone)]
pub struct Outline {
    /// The ball.
    pub ball: Ball,
    /// Share of the outline that is an edge, beyond chance; 1 if the outline was given.
    pub coverage: f64,
    /// RMS distance \[pixels] of the places that determined it; 0 if it was given.
    pub rms: f64,
    /// Standard deviation \[pixels] of the centre's x and y and of the radius; 0 if it was given.
    pub sigma: [f64; 3],
    /// The places with the weights that they had, 0 to 1.
    pub places: Vec<([f64; 2], f64)>,
}

/// Luminance above a floor, so that the logarithm of shadows is not all noise.
fn brightness(image: &Image) -> Plane {
    let mut values: Vec<f32> = image
        .pixels
        .iter()
        .map(|p| 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2])
        .collect();
    let stride = (values.len() / 10_000).max(1);
    let mut some: Vec<f32> = values.iter().copied().step_by(stride).collect();
    let middle = some.len() / 2;
    let (_, median, _) = some.select_nth_unstable_by(middle, f32::total_cmp);
    let floor = (0.03 * *median).max(1e-20);
    for v in &mut values {
        *v += floor;
    }
    Plane {
        width: image.width,
        height: image.height,
        values,
    }
}

/// Finds the outline of the ball in a picture of linear radiance.
///
/// # Errors
/// [`CaptureError::NoBall`], [`CaptureError::Parameter`] for a lens that can't be.
pub fn find(image: &Image, lens: Lens, file: &str) -> Result<Outline, CaptureError> {
    let size = [image.width, image.height];
    let none = |found: f64| CaptureError::NoBall {
        file: file.into(),
        found: found.max(0.0),
        expected: LEAST_COVERAGE,
    };
    let plane = brightness(image);
    let shrink = size[0].max(size[1]).div_ceil(SEARCHED);
    let mut small = plane.shrunk(shrink);
    for v in &mut small.values {
        *v = Real::ln(*v);
    }
    let found = search::find(
        &edges::find(&small, MOST_EDGES),
        [small.width, small.height],
    );
    let Some((circle, coverage)) = found else {
        return Err(none(0.0));
    };
    if coverage < LEAST_COVERAGE {
        return Err(none(coverage));
    }
    let k = shrink as f64;
    let centre = circle.centre.map(|c| c * k);
    let (mut ball, _) = of_circle(lens, size, [centre[0], centre[1], circle.radius * k])?;
    let mut places = rim::outermost(&plane, &ball, 2.0 * k);
    let mut fitted = None;
    for _ in 0..5 {
        let Some(fit) = fit(ball, &places) else { break };
        ball = placed(lens, size, fit.ball);
        fitted = Some((fit, places));
        places = rim::nearest(&plane, &ball);
    }
    let (fit, places) = fitted.ok_or_else(|| none(coverage))?;
    Ok(Outline {
        ball,
        coverage,
        rms: fit.rms,
        sigma: fit.sigma,
        places: places.into_iter().zip(fit.weights).collect(),
    })
}

/// The outline that is the given circle (x, y, radius) in the picture.
///
/// # Errors
/// [`CaptureError::Parameter`] if the circle is outside the picture, or for a lens that can't be.
pub fn given(circle: [f64; 3], lens: Lens, size: [usize; 2]) -> Result<Outline, CaptureError> {
    let [x, y, r] = circle;
    let inside = x + r > 0.0 && y + r > 0.0 && x - r < size[0] as f64 && y - r < size[1] as f64;
    if !inside || r < 2.0 {
        return Err(CaptureError::parameter(
            "ball",
            format!("{x},{y},{r}"),
            "a circle in the picture, with a radius of 2 pixels or more",
        ));
    }
    let (ball, places) = of_circle(lens, size, circle)?;
    Ok(Outline {
        ball,
        coverage: 1.0,
        rms: 0.0,
        sigma: [0.0; 3],
        places: places.into_iter().map(|p| (p, 1.0)).collect(),
    })
}

/// The ball whose outline is nearest to a circle, and some points of the circle.
fn of_circle(
    lens: Lens,
    size: [usize; 2],
    [x, y, r]: [f64; 3],
) -> Result<(Ball, Vec<[f64; 2]>), CaptureError> {
    let points: Vec<[f64; 2]> = (0..64)
        .map(|k| {
            let (s, c) = Real::sin_cos(TAU * f64::from(k) / 64.0);
            [x + r * c, y + r * s]
        })
        .collect();
    match lens {
        Lens::FieldOfView(fov) if !(fov > 0.0 && fov < 3.0) => {
            return Err(CaptureError::parameter(
                "field of view",
                format!("{:.3}°", fov.to_degrees()),
                "an angle above 0° and below 170°",
            ));
        }
        Lens::Distance(d) if !(d > 1.05 && d.is_finite()) => {
            return Err(CaptureError::parameter(
                "distance",
                d,
                "the distance from the ball's centre in radii of the ball, 1.05 or more",
            ));
        }
        _ => {}
    }
    let mut ball = placed(lens, size, Ball::new(Projection::Orthographic, [x, y], r));
    // The focal length that a distance asks for depends on the radius, and that on the ball's place in the picture.
    for _ in 0..8 {
        let Some(fit) = fit(ball, &points) else {
            break;
        };
        ball = placed(lens, size, fit.ball);
    }
    Ok((ball, points))
}

/// The ball as the lens sees it.
fn placed(lens: Lens, size: [usize; 2], ball: Ball) -> Ball {
    let focal = match lens {
        Lens::Unknown => return ball,
        Lens::FieldOfView(fov) => 0.5 * size[0] as f64 / Real::tan(0.5 * fov),
        // tan α = 1/√(D² − 1) = radius / focal
        Lens::Distance(d) => ball.radius() * (d * d - 1.0).sqrt(),
    };
    let principal = size.map(|n| 0.5 * n as f64);
    Ball::new(
        Projection::Perspective { focal, principal },
        ball.centre(),
        ball.radius(),
    )
}

struct Fit {
    ball: Ball,
    weights: Vec<f64>,
    rms: f64,
    sigma: [f64; 3],
}

/// Minimises Σ ρ(distance from the outline) over centre and radius, with Tukey's biweight ρ at 4.685 times the spread.
fn fit(mut ball: Ball, points: &[[f64; 2]]) -> Option<Fit> {
    if points.len() < 16 {
        return None;
    }
    let mut weights = vec![1.0; points.len()];
    let mut last = None;
    for _ in 0..25 {
        let residuals: Vec<f64> = points.iter().map(|p| ball.outside(*p)).collect();
        let mut sizes: Vec<f64> = residuals.iter().map(|r| r.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        // The median of |r| of a normal distribution is 0.6745 σ. Never below a hundredth of a pixel.
        let spread = (sizes[sizes.len() / 2] / 0.6745).max(0.01);
        let mut normal = solve::Normal::<3>::new();
        let (mut sum, mut total) = (0.0, 0.0);
        for ((p, r), w) in points.iter().zip(&residuals).zip(&mut weights) {
            let u = r / (4.685 * spread);
            *w = if u.abs() < 1.0 {
                (1.0 - u * u).sq()
            } else {
                0.0
            };
            let derivative = |moved: Ball| (moved.outside(*p) - r) / H;
            const H: f64 = 1e-4;
            let [x, y] = ball.centre();
            let row = [
                derivative(Ball::new(ball.projection(), [x + H, y], ball.radius())),
                derivative(Ball::new(ball.projection(), [x, y + H], ball.radius())),
                derivative(Ball::new(ball.projection(), [x, y], ball.radius() + H)),
            ];
            normal.add(row, -r, *w);
            sum += *w * r * r;
            total += *w;
        }
        let [dx, dy, dr] = normal.solve()?;
        let [x, y] = ball.centre();
        let radius = ball.radius() + dr;
        if !(radius > 1.0 && radius.is_finite()) {
            return None;
        }
        ball = Ball::new(ball.projection(), [x + dx, y + dy], radius);
        let rms = (sum / f64::max(total, 1e-30)).sqrt();
        let sigma = normal.variances()?.map(|v| rms * v.max(0.0).sqrt());
        last = Some((rms, sigma));
        if dx.abs() + dy.abs() + dr.abs() < 1e-6 {
            break;
        }
    }
    let (rms, sigma) = last?;
    Some(Fit {
        ball,
        weights,
        rms,
        sigma,
    })
}
