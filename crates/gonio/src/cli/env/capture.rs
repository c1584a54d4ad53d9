//! `gonio env capture`.

use crate::cli::destination;
use crate::cli::failure::Failure;
use crate::cli::parse;
use crate::cli::terminal::{note, print};
use gonio_capture::response::Origin;
use gonio_capture::{
    BallMaterial, Capture, KnownLight, Lens, Options, Photo, Projection, ResponseChoice, Rotation,
};
use indicatif::{ProgressBar, ProgressStyle};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  gonio env capture ball.jpg -o probe.exr --fill\n  \
        gonio env capture 1.jpg 2.jpg 3.jpg -o probe.exr --exposures 1/30,1/125,1/500\n  \
        gonio env capture front.jpg side.jpg -o probe.exr --views 2 --fov 20 --explain steps"
)]
pub(in crate::cli) struct Arguments {
    /// Photographs of the ball (JPEG, PNG, TIFF; EXR, HDR): the exposures of a viewpoint, then those of the next
    #[arg(required = true)]
    photos: Vec<PathBuf>,
    /// The panorama: EXR with layers for confidence, uncertainty and clipping; or HDR
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Viewpoints, with equally many photographs of each
    #[arg(long, value_name = "N", default_value = "1", value_parser = parse::whole(1_usize, 64))]
    views: usize,
    /// Exposure times, 1/30,1/125,…: one a photograph, or one a photograph of a viewpoint [default: EXIF]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = exposure)]
    exposures: Option<Vec<f64>>,
    /// The camera's response: auto, srgb, linear or recover
    #[arg(long, value_name = "CURVE", default_value = "auto", value_parser = response(), conflicts_with = "linear")]
    response: ResponseChoice,
    /// The photographs are linear, as developed from a raw file without a tone curve
    #[arg(long)]
    linear: bool,
    /// Horizontal field of view of the camera [default: EXIF, else far away]
    #[arg(long, value_name = "DEG", value_parser = parse::finite)]
    fov: Option<f32>,
    /// Distance of the camera from the ball's centre, in radii of the ball
    #[arg(long, value_name = "RADII", value_parser = parse::finite, conflicts_with = "fov")]
    distance: Option<f32>,
    /// Outline of the ball in pixels, once for each viewpoint [default: found]
    #[arg(long, value_name = "X,Y,RADIUS", value_parser = circle)]
    ball: Vec<Circle>,
    /// How a further viewpoint's camera is turned against the first's, once for each [default: found]
    #[arg(long, value_name = "YAW,PITCH,ROLL", value_parser = turn, allow_hyphen_values = true)]
    turned: Vec<Turn>,
    /// What the ball is made of, to divide its reflectance out: chrome, steel, perfect, or F0 such as 0.9 or 0.95/0.93/0.88
    #[arg(long, value_name = "MATERIAL", default_value = "chrome", value_parser = material)]
    ball_material: BallMaterial,
    /// Rows of the panorama, which is twice as wide
    #[arg(long, value_name = "ROWS", default_value = "512", value_parser = parse::whole(8_usize, 16_384))]
    size: usize,
    /// Pixels along the outline that are left out, mixed with what is behind the ball
    #[arg(long, value_name = "PIXELS", default_value = "1.5", value_parser = parse::finite)]
    margin: f32,
    /// Half-angle around the camera in which it stands itself
    #[arg(long, value_name = "DEG", default_value = "6", value_parser = parse::finite)]
    camera_cone: f32,
    /// Fill what no viewpoint saw, smoothly
    #[arg(long)]
    fill: bool,
    /// Restore clipped light by a photograph of a grey ball, put where the mirrored ball stood; fills, too
    #[arg(long, value_name = "PHOTO")]
    grey_ball: Vec<PathBuf>,
    /// Outline of the grey ball in pixels [default: found]
    #[arg(long, value_name = "X,Y,RADIUS", value_parser = circle, requires = "grey_ball")]
    grey_ball_at: Option<Circle>,
    /// Restore clipped light by the illuminance on level ground, and write luminance; fills, too
    #[arg(long, value_name = "LX", value_parser = parse::finite, conflicts_with = "grey_ball")]
    lux: Option<f32>,
    /// Write a picture of every step into this folder
    #[arg(long, value_name = "DIR")]
    explain: Option<PathBuf>,
}

#[derive(Clone, Copy)]
struct Circle([f64; 3]);

fn circle(text: &str) -> Result<Circle, String> {
    gonio_capture::ball::parse_circle(text)
        .map(Circle)
        .map_err(|e| e.to_string())
}

#[derive(Clone, Copy)]
struct Turn([f64; 3]);

/// Reads degrees, such as `86,8.6,-2`.
fn turn(text: &str) -> Result<Turn, String> {
    let numbers: Option<Vec<f64>> = text
        .split(',')
        .map(|n| n.trim().parse::<f64>().ok().filter(|x| x.is_finite()))
        .collect();
    match numbers.as_deref() {
        Some(&[yaw, pitch, roll]) => Ok(Turn([yaw, pitch, roll])),
        _ => Err(format!(
            "'{text}' is no rotation: expected yaw,pitch,roll in degrees, such as 86,8.6,-2"
        )),
    }
}

fn material(text: &str) -> Result<BallMaterial, String> {
    text.parse::<BallMaterial>().map_err(|e| e.to_string())
}

fn response() -> impl clap::builder::TypedValueParser<Value = ResponseChoice> {
    parse::words(&[
        (ResponseChoice::Auto, "auto"),
        (ResponseChoice::Srgb, "srgb"),
        (ResponseChoice::Linear, "linear"),
        (ResponseChoice::Recover, "recover"),
    ])
}

/// Reads `1/30` or `0.5` \[s].
fn exposure(text: &str) -> Result<f64, String> {
    let number = |t: &str| t.trim().parse::<f64>().ok();
    let value = match text.split_once('/') {
        Some((a, b)) => number(a).zip(number(b)).map(|(a, b)| a / b),
        None => number(text),
    };
    value
        .filter(|v| *v > 0.0 && v.is_finite())
        .ok_or_else(|| format!("'{text}' is no exposure: expected seconds, such as 1/125 or 0.5"))
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    destination::check_extension(&arguments.output, &["exr", "hdr"], "panoramas")?;
    destination::writable(&arguments.output)?;
    let bar = Steps::new();
    bar.step("reading", 0.0);
    let photos = read(&arguments.photos)?;
    let options = options(arguments)?;
    let capture = gonio_capture::capture(&photos, &options, &mut |step, part| bar.step(step, part));
    bar.bar.finish_and_clear();
    let capture = capture?;
    for text in &capture.notes {
        note(text);
    }
    if destination::extension(&arguments.output) == "hdr" {
        capture.panorama.image.write(&arguments.output)?;
        note(
            "an HDR file has no layers: confidence, uncertainty and clipping are only written to EXR",
        );
    } else {
        capture.write(&arguments.output)?;
    }
    print(&summary(&capture, &arguments.output))
}

fn read(paths: &[PathBuf]) -> Result<Vec<Photo>, Failure> {
    paths.iter().map(|p| Ok(Photo::read(p)?)).collect()
}

fn options(a: &Arguments) -> Result<Options, Failure> {
    let known_light = match (a.lux, &a.grey_ball[..]) {
        (Some(lux), _) => Some(KnownLight::Lux(lux.into())),
        (None, []) => None,
        (None, grey) => Some(KnownLight::GreyBall(
            read(grey)?,
            a.grey_ball_at.map(|c| c.0),
        )),
    };
    Ok(Options {
        views: a.views,
        exposures: a.exposures.clone(),
        response: if a.linear {
            ResponseChoice::Linear
        } else {
            a.response
        },
        lens: match (a.fov, a.distance) {
            (Some(deg), _) => Lens::FieldOfView(f64::from(deg).to_radians()),
            (None, Some(radii)) => Lens::Distance(radii.into()),
            (None, None) => Lens::Unknown,
        },
        balls: a.ball.iter().map(|c| c.0).collect(),
        rotations: a
            .turned
            .iter()
            .map(|t| {
                let [yaw, pitch, roll] = t.0.map(f64::to_radians);
                Rotation::of_angles(yaw, pitch, roll)
            })
            .collect(),
        material: a.ball_material,
        height: a.size,
        margin: a.margin.into(),
        camera_deg: a.camera_cone.into(),
        fill: a.fill,
        known_light,
        explain: a.explain.clone(),
    })
}

/// A bar that appears when a second has passed.
struct Steps {
    bar: ProgressBar,
    start: Instant,
}

impl Steps {
    fn new() -> Self {
        let bar = ProgressBar::new(1000);
        if let Ok(style) = ProgressStyle::with_template("{bar:18.cyan/dim} {msg}") {
            bar.set_style(style.progress_chars("━━─"));
        }
        Self {
            bar,
            start: Instant::now(),
        }
    }

    fn step(&self, what: &str, part: f64) {
        if self.start.elapsed() > Duration::from_secs(1) {
            self.bar.set_message(what.to_owned());
            self.bar.set_position((1000.0 * part) as u64);
        }
    }
}

fn summary(capture: &Capture, output: &Path) -> String {
    let p = &capture.panorama;
    let mut text = String::new();
    let mut line = |label: &str, value: String| {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{label:<12}{value}");
    };
    line(
        "written",
        format!(
            "{}, {} × {} lat-long",
            output.display(),
            p.image.width,
            p.image.height
        ),
    );
    line(
        "response",
        match capture.response.origin() {
            Origin::Recovered(rms) => {
                format!("recovered from the exposures, RMS {:.1} %", 100.0 * rms)
            }
            other => other.to_string(),
        },
    );
    for (v, view) in capture.views.iter().enumerate() {
        let ball = &view.outline.ball;
        let [x, y] = ball.centre();
        let mut told = format!("ball at {x:.1}, {y:.1}, radius {:.1} px", ball.radius());
        if view.outline.rms > 0.0 {
            let _ = write!(told, ", outline within {:.2} px", view.outline.rms);
        }
        match ball.projection() {
            Projection::Orthographic => told.push_str("; camera far away"),
            Projection::Perspective { .. } => {
                let _ = write!(told, "; camera {:.2} radii away", ball.distance());
            }
        }
        line(&format!("view {}", v + 1), told);
        if let Some(r) = view.registration {
            let [yaw, pitch, roll] = r.rotation.angles().map(f64::to_degrees);
            let [red, green, blue] = view.gain;
            line(
                "",
                format!(
                    "turned by yaw {yaw:.2}°, pitch {pitch:.2}°, roll {roll:.2}° (correlation {:.2}); brought to the first by \
                     {red:.3}, {green:.3}, {blue:.3}",
                    r.correlation
                ),
            );
        }
    }
    let (mut unseen, mut clipped) = (0.0, 0.0);
    for k in 0..p.confidence.len() {
        let share = p.solid_angle(k) / (4.0 * std::f64::consts::PI);
        unseen += share
            * f64::from(u8::from(
                p.confidence[k] < gonio_capture::fill::LEAST_CONFIDENCE,
            ));
        clipped += share * f64::from(p.clipped[k]);
    }
    let filled = if capture.filled > 0 { ", filled" } else { "" };
    line(
        "not seen",
        format!("{:.2} % of the sphere{filled}", 100.0 * unseen),
    );
    line("clipped", format!("{:.3} % of the sphere", 100.0 * clipped));
    if let Some(r) = &capture.restored {
        let d = r.direction;
        line(
            "restored",
            format!(
                "radiance {:.4e}, {:.4e}, {:.4e} from ({:.3}, {:.3}, {:.3})",
                r.radiance[0], r.radiance[1], r.radiance[2], d.x, d.y, d.z
            ),
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_are_read() {
        assert_eq!(turn("86, 8.6,-2").unwrap().0, [86.0, 8.6, -2.0]);
        for bad in ["", "1,2", "1,2,3,4", "a,b,c", "1,2,inf"] {
            assert!(turn(bad).is_err_and(|e| e.contains("no rotation")), "{bad}");
        }
    }

    #[test]
    fn exposures_are_read() {
        assert_eq!(exposure("1/125"), Ok(0.008));
        assert_eq!(exposure("2"), Ok(2.0));
        for bad in ["", "0", "1/0", "-1", "1/x", "inf"] {
            assert!(exposure(bad).unwrap_err().contains("no exposure"), "{bad}");
        }
    }
}
