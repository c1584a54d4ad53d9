//! Simulated photographs of a known panorama, captured, and compared with it.
#![allow(dead_code, reason = "each test file uses a part")]
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use gonio_capture::simulate::{Film, Studio};
use gonio_capture::{
    Ball, BallMaterial, Capture, CaptureError, KnownLight, Lens, Options, Photo, Projection,
    Rotation, capture,
};
use gonio_env::{Environment, Layout};
use gonio_image::Image;
use gonio_num::{Real, Vec3};
use gonio_radiometry::sequence::Rng;
use std::f64::consts::PI;
use std::path::Path;

/// Rows of the captured panoramas.
pub const ROWS: usize = 128;

/// A panorama with a sun, whose texels are at most `most`.
pub fn sunset(most: f32) -> Environment {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/preview/sunset.hdr");
    let mut image = Image::read(&file).unwrap();
    for p in &mut image.pixels {
        *p = p.map(|c| c.min(most));
    }
    // Turned so that the sun stands beside the camera, not behind the ball.
    Environment::from_image(image, Layout::LatLong)
        .unwrap()
        .rotated_deg(110.0)
}

/// The tame sunset with a sun of 4° across, high beside the camera, of radiance 1500: more irradiance than all the rest.
pub fn sunny() -> Environment {
    let sky = sunset(8.0);
    let towards = Vec3::new(0.6, 0.5, 0.6245);
    let image = Image::from_fn(1024, 512, |x, y| {
        let d = Layout::LatLong.direction([(x as f64 + 0.5) / 1024.0, (y as f64 + 0.5) / 512.0]);
        if d.dot(towards) > Real::cos(2.0_f64.to_radians()) {
            [1500.0; 3]
        } else {
            sky.radiance(d.to_f32())
        }
    });
    Environment::from_image(image, Layout::LatLong).unwrap()
}

pub fn light(env: &Environment) -> impl Fn(Vec3<f64>) -> [f64; 3] + Sync {
    |d| env.radiance(d.to_f32()).map(f64::from)
}

/// What a diffuse ball of albedo 0.18 shows at each normal: the sum over blocks of 8 × 8 texels, each from the mean direction of its
/// power.
pub fn shading(env: &Environment) -> impl Fn(Vec3<f64>) -> [f64; 3] + Sync {
    let (width, height) = (1024, 512);
    let mut lamps = Vec::new();
    for block in 0..width / 8 * height / 8 {
        let (mut towards, mut power) = (Vec3::new(0.0, 0.0, 0.0), [0.0; 3]);
        for q in 0..64 {
            let x = block % (width / 8) * 8 + q % 8;
            let y = block / (width / 8) * 8 + q / 8;
            let uv = [
                (x as f64 + 0.5) / width as f64,
                (y as f64 + 0.5) / height as f64,
            ];
            let d = Layout::LatLong.direction(uv);
            let omega = Layout::LatLong.jacobian(uv) / (width * height) as f64;
            let l = env
                .radiance(d.to_f32())
                .map(|l| f64::from(l) * omega * 0.18 / PI);
            towards += d * l[1];
            power = [0, 1, 2].map(|c| power[c] + l[c]);
        }
        lamps.push((towards.normalize(), power));
    }
    move |n| {
        let mut sum = [0.0; 3];
        for (d, power) in &lamps {
            let cos = d.dot(n).max(0.0);
            sum = [0, 1, 2].map(|c| sum[c] + cos * power[c]);
        }
        sum
    }
}

/// A ball beside the middle of the picture, from `distance` radii away.
pub fn near(distance: f64, size: [usize; 2]) -> Studio {
    // The ball's radius is a third of the picture's height.
    let radius = size[1] as f64 / 3.0;
    let focal = radius * (distance * distance - 1.0).sqrt();
    let direction = Vec3::new(30.0 / focal, 20.0 / focal, -1.0).normalize();
    Studio {
        size,
        projection: Projection::Perspective {
            focal,
            principal: size.map(|n| 0.5 * n as f64),
        },
        centre: direction * distance,
        radius: 0.0,
        rotation: Rotation::IDENTITY,
        material: Some(BallMaterial::Chrome),
        photographer: 0.0,
        rays: 3,
    }
}

/// The ball that a studio has.
pub fn ball(studio: &Studio) -> Ball {
    let c = studio.centre;
    match studio.projection {
        Projection::Perspective { focal, principal } => Ball::new(
            studio.projection,
            [
                principal[0] - focal * c.x / c.z,
                principal[1] + focal * c.y / c.z,
            ],
            focal / (c.dot(c) - 1.0).sqrt(),
        ),
        Projection::Orthographic => {
            let [w, h] = studio.size.map(|n| 0.5 * n as f64);
            Ball::new(
                studio.projection,
                [w + studio.radius * c.x, h - studio.radius * c.y],
                studio.radius,
            )
        }
    }
}

pub fn lens(studio: &Studio) -> Lens {
    match studio.projection {
        Projection::Orthographic => Lens::Unknown,
        Projection::Perspective { focal, .. } => {
            Lens::FieldOfView(2.0 * Real::atan2(0.5 * studio.size[0] as f64, focal))
        }
    }
}

/// A curve with the toe and shoulder of a camera: a power of 1/2.2, bent so that it reaches 1 level.
pub fn camera_curve(x: f64) -> f64 {
    let y = Real::powf(x, 1.0 / 2.2);
    y * (1.15 - 0.15 * y * y)
}

pub fn identity(x: f64) -> f64 {
    x
}

/// Linear 16-bit photographs without any fault.
pub fn perfect_film(exposures: &[f64]) -> Film<'_> {
    Film {
        exposures,
        response: identity,
        full_well: 0.0,
        vignetting: 0.0,
        deep: true,
    }
}

/// 8-bit codes through a curve, with noise and vignetting.
pub fn real_film(exposures: &[f64]) -> Film<'_> {
    Film {
        exposures,
        response: camera_curve,
        full_well: 20_000.0,
        vignetting: 0.1,
        deep: false,
    }
}

/// How far a capture is from the truth.
#[derive(Debug, Clone, Copy)]
pub struct Errors {
    /// Angle \[°] between the direction that a pixel of the ball shows and where the capture puts it: median and 95 %, over
    /// directions evenly spread that the ball shows.
    pub direction: [f64; 2],
    /// Relative error of luminance of texels that are sure: median and 95 %.
    pub radiance: [f64; 2],
    /// Largest relative error of irradiance over 26 normals.
    pub irradiance: f64,
}

/// Compares a capture by `studios`, one a viewpoint, with the environment they stood in. Radiance is relative: the factor between them
/// is the median ratio.
pub fn compare(found: &Capture, studios: &[Studio], env: &Environment) -> Errors {
    let mut rng = Rng::from_name("directions of a comparison");
    let mut angles = Vec::new();
    for (studio, view) in studios.iter().zip(&found.views) {
        let (truth, ours) = (ball(studio), view.outline.ball);
        let turn = view.registration.map_or(Rotation::IDENTITY, |r| r.rotation);
        let back = studio.rotation.inverse();
        let enough = angles.len() + 4000;
        while angles.len() < enough {
            let z = 2.0 * rng.next_f64() - 1.0;
            let (s, c) = Real::sin_cos(2.0 * PI * rng.next_f64());
            let k = (1.0 - z * z).sqrt();
            let d = Vec3::new(k * c, k * s, z);
            let Some(place) = truth.place(back.apply(d)) else {
                continue;
            };
            let Some(hit) = ours.mirrored(place.pixel) else {
                continue;
            };
            let put = turn.apply(hit.direction);
            angles.push(put.cross(d).length().atan2(put.dot(d)).to_degrees());
        }
    }
    let p = &found.panorama;
    let mut ratios = Vec::new();
    for k in 0..p.confidence.len() {
        if p.confidence[k] > 0.5 && p.clipped[k] <= 0.0 {
            ratios.push(luminance(p.image.pixels[k]) / luminance(texel(env, p.image.height, k)));
        }
    }
    let gain = quantile(&mut ratios, 0.5);
    let mut relative: Vec<f64> = ratios.iter().map(|r| (r / gain - 1.0).abs()).collect();
    let captured = Environment::from_image(p.image.clone(), Layout::LatLong).unwrap();
    let mut irradiance = 0.0_f64;
    for k in 0..27 {
        let n = Vec3::new(
            (k % 3) as f32 - 1.0,
            (k / 3 % 3) as f32 - 1.0,
            (k / 9) as f32 - 1.0,
        );
        if k != 13 {
            let (a, b) = (captured.irradiance(n)[1], env.irradiance(n)[1]);
            irradiance = irradiance.max((a / gain / b - 1.0).abs());
        }
    }
    Errors {
        direction: [quantile(&mut angles, 0.5), quantile(&mut angles, 0.95)],
        radiance: [quantile(&mut relative, 0.5), quantile(&mut relative, 0.95)],
        irradiance,
    }
}

/// Mean radiance of texel `k` of a lat-long picture of `height` rows.
fn texel(env: &Environment, height: usize, k: usize) -> [f32; 3] {
    const N: usize = 6;
    let width = 2 * height;
    let mut sum = [0.0; 3];
    for q in 0..N * N {
        let at = |i: usize, q: usize| i as f64 + (q as f64 + 0.5) / N as f64;
        let uv = [
            at(k % width, q % N) / width as f64,
            at(k / width, q / N) / height as f64,
        ];
        let l = env.radiance(Layout::LatLong.direction(uv).to_f32());
        for c in 0..3 {
            sum[c] += l[c] / (N * N) as f32;
        }
    }
    sum
}

pub fn luminance(p: [f32; 3]) -> f64 {
    f64::from(0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2])
}

pub fn quantile(values: &mut [f64], q: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * q) as usize]
}

pub fn options(studio: &Studio) -> Options {
    Options {
        lens: lens(studio),
        height: ROWS,
        camera_deg: 0.0,
        fill: true,
        ..Options::default()
    }
}

pub fn taken(photos: &[Photo], options: &Options) -> Result<Capture, CaptureError> {
    capture(photos, options, &mut |_, _| {})
}

/// Real photographs, between which the camera was knocked by some pixels; and the studio as the one that the others are moved to sees it.
pub fn knocked(studio: &Studio, env: &Environment, exposures: &[f64]) -> (Vec<Photo>, Studio) {
    const PLACES: [[f64; 2]; 4] = [[0.0, 0.0], [5.0, -3.0], [-4.0, 2.0], [1.0, 6.0]];
    let moved: Vec<Studio> = PLACES
        .iter()
        .map(|[x, y]| Studio {
            projection: match studio.projection {
                Projection::Perspective { focal, principal } => Projection::Perspective {
                    focal,
                    principal: [principal[0] + x, principal[1] + y],
                },
                Projection::Orthographic => Projection::Orthographic,
            },
            ..*studio
        })
        .collect();
    let photos: Vec<Photo> = exposures
        .iter()
        .zip(&moved)
        .flat_map(|(exposure, studio)| {
            let seen = studio.radiance(&light(env), &|_| [0.0; 3]);
            real_film(&[*exposure]).expose(&seen, &format!("knocked {exposure}"))
        })
        .collect();
    let reference = gonio_capture::align::align(&photos, exposures, None)
        .unwrap()
        .reference;
    (photos, moved[reference])
}

/// A row of the table: what was done, and how far off it was.
pub fn table() -> Vec<(&'static str, Errors)> {
    const STOPS: [f64; 4] = [1.0, 0.125, 0.015_625, 0.001_953];
    let env = sunset(400.0);
    let studio = near(8.0, [720, 540]);
    let photo = studio.radiance(&light(&env), &|_| [0.0; 3]);
    let linear = Options {
        response: gonio_capture::ResponseChoice::Linear,
        ..options(&studio)
    };
    let one = [1.0 / 500.0];
    let ideal = perfect_film(&one).expose(&photo, "ideal");
    let exposed = real_film(&STOPS).expose(&photo, "exposed");
    let mut rows = Vec::new();
    let mut row_in =
        |env: &Environment, name, photos: &[Photo], options: &Options, studios: &[Studio]| {
            let found = taken(photos, options).unwrap();
            for note in &found.notes {
                eprintln!("{name}: {note}");
            }
            rows.push((name, compare(&found, studios, env)));
        };
    let sunny = sunny();
    // The sun clipped in the only exposure, and brought back.
    let bright = studio.radiance(&light(&sunny), &|_| [0.0; 3]);
    let film = Film {
        response: identity,
        deep: true,
        vignetting: 0.0,
        ..real_film(&[0.1])
    };
    let burnt = film.expose(&bright, "burnt");
    row_in(
        &sunny,
        "a sun that every exposure clips",
        &burnt,
        &linear,
        &[studio],
    );
    let grey = Studio {
        material: None,
        rays: 1,
        ..near(8.0, [180, 135])
    };
    // Before an even backdrop, that the ball stands out.
    let ball_photo = grey.radiance(&|_| [0.001; 3], &shading(&sunny));
    let ball_shot = film.expose(&ball_photo, "grey");
    let restored = Options {
        known_light: Some(KnownLight::GreyBall(ball_shot, None)),
        ..linear.clone()
    };
    row_in(
        &sunny,
        "the same, restored by a grey ball",
        &burnt,
        &restored,
        &[studio],
    );

    let mut row = |name, photos: &[Photo], options: &Options, studios: &[Studio]| {
        row_in(&env, name, photos, options, studios);
    };
    row("linear 16 bit, without faults", &ideal, &linear, &[studio]);
    row(
        "4 × 8 bit: response curve, noise, vignetting of 10 %",
        &exposed,
        &options(&studio),
        &[studio],
    );
    row(
        "the same, vignetting of none",
        &Film {
            vignetting: 0.0,
            ..real_film(&STOPS)
        }
        .expose(&photo, "even"),
        &options(&studio),
        &[studio],
    );

    let (shaken, where_it_stood) = knocked(&studio, &env, &STOPS);
    row(
        "the same as above, the camera knocked by 6 pixels between exposures",
        &shaken,
        &options(&studio),
        &[where_it_stood],
    );

    // Two viewpoints, a quarter turn apart, each with its photographer.
    let first = Studio {
        photographer: 0.25,
        ..studio
    };
    let second = Studio {
        rotation: Rotation::of_angles(1.5, 0.15, 0.05),
        ..first
    };
    let mut both = real_film(&STOPS).expose(&first.radiance(&light(&env), &|_| [0.0; 3]), "first");
    let alone = both.clone();
    both.extend(real_film(&STOPS).expose(&second.radiance(&light(&env), &|_| [0.0; 3]), "second"));
    let marked = Options {
        camera_deg: 6.0,
        ..options(&studio)
    };
    row(
        "one viewpoint with a photographer of 29°",
        &alone,
        &marked,
        &[first],
    );
    row(
        "two viewpoints, each with one",
        &both,
        &Options {
            views: 2,
            ..marked.clone()
        },
        &[first, second],
    );

    // What must show.
    let found = ball(&studio);
    let [x, y] = found.centre();
    row(
        "wrong: the ball's centre 5 pixels off",
        &ideal,
        &Options {
            balls: vec![[x + 5.0, y, found.radius()]],
            ..linear.clone()
        },
        &[studio],
    );
    row(
        "wrong: the second of two viewpoints turned 5° too far",
        &both,
        &Options {
            views: 2,
            rotations: vec![second.rotation.then_inner(Rotation::of_vector(Vec3::new(
                0.0,
                5.0_f64.to_radians(),
                0.0,
            )))],
            ..marked.clone()
        },
        &[first, second],
    );
    row(
        "wrong: the camera taken as far away",
        &ideal,
        &Options {
            lens: Lens::Distance(1000.0),
            ..linear.clone()
        },
        &[studio],
    );
    row(
        "wrong: a perfect mirror instead of chrome",
        &ideal,
        &Options {
            material: BallMaterial::Perfect,
            ..linear
        },
        &[studio],
    );
    // Geometry first, then light: the sun's two rows before what is wrong.
    rows[..8].rotate_left(2);
    rows
}
