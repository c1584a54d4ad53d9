//! T21: the photograph of a mirrored ball, and where each of its points lies in the panorama.

use crate::answer::{Answer, colours, largest};
use crate::complaint::Complaint;
use crate::light::environment;
use crate::plots::side;
use gonio_env::{Environment, Layout};
use gonio_num::Vec3;
use serde_json::json;

/// Points of the panorama, in columns and rows, that are followed from the ball.
const MESH: [usize; 2] = [128, 64];

/// The ball from afar, the panorama twice as wide, and points of both with their radiance: x, y of the ball in −1 to 1, u, v of the panorama.
pub(super) fn mirror_ball(light: &str, size: usize) -> Result<Answer, Complaint> {
    let size = side(size)?;
    let environment = environment(light)?;
    let ball: Vec<[f64; 3]> = centres(size, size)
        .map(|uv| match Layout::MirrorBall.contains(uv) {
            true => radiance(&environment, Layout::MirrorBall.direction(uv)),
            false => [f64::NAN; 3],
        })
        .collect();
    let panorama =
        centres(2 * size, size).map(|uv| radiance(&environment, Layout::LatLong.direction(uv)));
    let mesh = centres(MESH[0], MESH[1]).flat_map(|uv| {
        let d = Layout::LatLong.direction(uv);
        let [x, y] = Layout::MirrorBall.uv(d);
        let [r, g, b] = radiance(&environment, d);
        [2.0 * x - 1.0, 1.0 - 2.0 * y, uv[0], uv[1], r, g, b].map(|x| x as f32)
    });
    Ok(Answer::new(
        json!({ "largest": largest(&ball) }),
        vec![
            ("ball", colours(ball.iter().copied())),
            ("mesh", mesh.collect()),
            ("panorama", colours(panorama)),
        ],
    ))
}

/// The centres of the texels, in rows from above.
fn centres(width: usize, height: usize) -> impl Iterator<Item = [f64; 2]> {
    (0..height).flat_map(move |y| {
        (0..width).map(move |x| {
            [
                (x as f64 + 0.5) / width as f64,
                (y as f64 + 0.5) / height as f64,
            ]
        })
    })
}

fn radiance(environment: &Environment, d: Vec3<f64>) -> [f64; 3] {
    environment.radiance(d.to_f32()).map(f64::from)
}
