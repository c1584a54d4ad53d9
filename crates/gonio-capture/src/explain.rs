//! A picture of every step, for eyes.

use crate::outline::Outline;
use crate::response::Response;
use crate::{CaptureError, Panorama, Radiance};
use gonio_image::tonemap::ToneMap;
use gonio_image::{Image, write_file};
use gonio_num::Real;
use gonio_plot::{Axes, Line, ScaleKind, lines};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// Longer side \[pixels] of a picture.
const LARGEST: usize = 1400;
/// Writes numbered pictures into a folder, and `steps.txt`, which says what each shows; or nothing.
#[derive(Debug)]
pub struct Explain {
    folder: Option<PathBuf>,
    count: usize,
    captions: String,
}

impl Explain {
    /// Into `folder`, which is made if it isn't there.
    ///
    /// # Errors
    /// [`CaptureError::Image`] if it can't be made.
    pub fn into_folder(folder: Option<&Path>) -> Result<Self, CaptureError> {
        if let Some(folder) = folder {
            std::fs::create_dir_all(folder).map_err(|source| gonio_image::ImageError::Io {
                file: folder.display().to_string(),
                action: "make this folder",
                source,
            })?;
        }
        Ok(Self {
            folder: folder.map(Path::to_owned),
            count: 0,
            captions: String::from("The steps of gonio env capture, picture by picture.\n"),
        })
    }

    /// The path of the next picture, whose caption is written; `None` if nothing is explained.
    fn next(&mut self, name: &str, caption: &str) -> Result<Option<PathBuf>, CaptureError> {
        self.count += 1;
        let Some(folder) = &self.folder else {
            return Ok(None);
        };
        let file = format!("{:02}-{name}.png", self.count);
        self.captions += &format!("\n{file}\n  {}\n", caption.replace('\n', "\n  "));
        // After each picture: an error in the next step leaves the ones before explained.
        write_file(&folder.join("steps.txt"), self.captions.as_bytes())?;
        Ok(Some(folder.join(file)))
    }

    fn write(
        &mut self,
        name: &str,
        caption: &str,
        draw: impl FnOnce() -> Image,
    ) -> Result<(), CaptureError> {
        if let Some(path) = self.next(name, caption)? {
            draw().write_png(&path, ToneMap::Linear, 0.0)?;
        }
        Ok(())
    }

    /// The response curve: codes to the right, the exposure that makes them upwards, and sRGB's curve to compare with.
    pub(crate) fn response(&mut self, response: &Response) -> Result<(), CaptureError> {
        let caption = format!(
            "The camera's response ({}): which exposure of the sensor makes a code, relative to what makes code 255 in the curve of sRGB, \
             for red, green and blue. Steep parts are noisy; codes above 235 count less and less, above 250 nothing.",
            response.origin()
        );
        let Some(path) = self.next("response", &caption)? else {
            return Ok(());
        };
        let reference = Response::srgb();
        let line = |name: &str, channel: &[f64]| Line {
            name: name.into(),
            points: (1..256).map(|z| [z as f64, channel[z]]).collect(),
        };
        let mut all: Vec<Line> = ["red", "green", "blue"]
            .iter()
            .enumerate()
            .map(|(c, name)| line(name, response.channel(c)))
            .collect();
        all.push(line("sRGB, to compare", reference.channel(1)));
        let axes = Axes {
            subtitle: &format!("{}: the exposure that makes a code", response.origin()),
            x: "code in the photograph, 1 to 255",
            x_ends: [0.0, 255.0],
            x_step: 15.0,
            y: "exposure, relative",
            channels: true,
        };
        let options = gonio_plot::Options {
            title: Some("Response of the camera".into()),
            scale: ScaleKind::Log,
            ..gonio_plot::Options::default()
        };
        let png = lines(&all, &axes, &options)?.png(1.5)?;
        Ok(write_file(&path, &png)?)
    }

    /// The merged photograph; what is clipped in magenta.
    pub(crate) fn radiance(
        &mut self,
        view: usize,
        radiance: &Radiance,
    ) -> Result<(), CaptureError> {
        let caption = format!(
            "Viewpoint {view}: its exposures merged to radiance, brightened for the eye. Magenta: clipped in every exposure, {:.2} % of the picture.",
            100.0 * share(&radiance.clipped)
        );
        self.write(&format!("view{view}-radiance"), &caption, || {
            let (mut shown, k) = developed(&radiance.image);
            for y in 0..shown.height {
                for x in 0..shown.width {
                    if radiance.clipped[y * k * radiance.image.width + x * k] {
                        shown.set(x, y, [1.0, 0.0, 1.0]);
                    }
                }
            }
            shown
        })
    }

    /// The outline over the photograph: places that determined it in green, those that were left out in red.
    pub(crate) fn outline(
        &mut self,
        view: usize,
        photo: &Image,
        outline: &Outline,
    ) -> Result<(), CaptureError> {
        let [x, y] = outline.ball.centre();
        let distance = outline.ball.distance();
        let caption = format!(
            "Viewpoint {view}: the ball at {x:.1}, {y:.1} with a radius of {:.1} pixels, {}. Yellow: its outline and the place of its centre. Dots: \
             the edges that determined it, {:.2} pixels off (RMS); red dots were left out as outliers. An outline beside the rim bends all directions.",
            outline.ball.radius(),
            if distance.is_finite() {
                format!("the camera {distance:.2} radii away")
            } else {
                "the camera taken as infinitely far away".into()
            },
            outline.rms
        );
        self.write(&format!("view{view}-outline"), &caption, || {
            let (mut shown, k) = developed(photo);
            let at = |p: [f64; 2]| p.map(|c| c / k as f64);
            let ring: Vec<[f64; 2]> = (0..=720)
                .map(|i| at(outline.ball.outline(TAU * f64::from(i) / 720.0)))
                .collect();
            for pair in ring.windows(2) {
                line(&mut shown, pair[0], pair[1], [1.0, 0.75, 0.0]);
            }
            for (p, weight) in &outline.places {
                let ink = if *weight > 0.1 {
                    [0.0, 0.9, 0.0]
                } else {
                    [1.0, 0.0, 0.0]
                };
                dot(&mut shown, at(*p), ink);
            }
            let c = at(outline.ball.centre());
            line(
                &mut shown,
                [c[0] - 9.0, c[1]],
                [c[0] + 9.0, c[1]],
                [1.0, 0.75, 0.0],
            );
            line(
                &mut shown,
                [c[0], c[1] - 9.0],
                [c[0], c[1] + 9.0],
                [1.0, 0.75, 0.0],
            );
            shown
        })
    }

    /// A panorama.
    pub(crate) fn panorama(
        &mut self,
        name: &str,
        what: &str,
        image: &Image,
    ) -> Result<(), CaptureError> {
        let caption = format!(
            "{what}, as a panorama: its left and right edge look towards the first camera, its centre away from it, its top up."
        );
        self.write(name, &caption, || developed(image).0)
    }

    /// Confidence in grey, and what is clipped in magenta.
    pub(crate) fn confidence(
        &mut self,
        name: &str,
        what: &str,
        p: &Panorama,
    ) -> Result<(), CaptureError> {
        let caption = format!(
            "How sure {what} is. White: a texel has a pixel of the photograph or more; grey: less, near the ball's rim; black: nobody saw it, or \
             the camera stands there. Magenta: clipped in every exposure."
        );
        self.write(name, &caption, || {
            let mut image = p.image.clone();
            for ((pixel, sure), clipped) in
                image.pixels.iter_mut().zip(&p.confidence).zip(&p.clipped)
            {
                *pixel = if *clipped > 0.0 {
                    [1.0, 0.0, 1.0]
                } else {
                    [sure * sure; 3]
                };
            }
            shrunk(&image).0
        })
    }

    /// The logarithm of the ratio of two panoramas: grey where they agree, red where the second is brighter, blue where darker,
    /// full at a factor of 2; black where one saw nothing.
    pub(crate) fn difference(
        &mut self,
        view: usize,
        a: &Panorama,
        b: &Panorama,
    ) -> Result<(), CaptureError> {
        let caption = format!(
            "Viewpoint {view} against the first, turned and matched in colour. Grey: they agree; red: viewpoint {view} is brighter; blue: darker; full \
             colour at a factor of 2; black: one saw nothing. Cameras and photographers show, and what is near to the ball; doubled \
             edges everywhere mean a wrong outline or rotation."
        );
        self.write(&format!("view{view}-difference"), &caption, || {
            let mut image = a.image.clone();
            for (k, pixel) in image.pixels.iter_mut().enumerate() {
                let (p, q) = (a.image.pixels[k][1], b.image.pixels[k][1]);
                *pixel = if a.confidence[k].min(b.confidence[k]) <= 0.0 || p <= 0.0 || q <= 0.0 {
                    [0.0; 3]
                } else {
                    let r = (Real::ln(q / p) / std::f32::consts::LN_2).clamp(-1.0, 1.0);
                    let grey = 0.4 * (1.0 - r.abs());
                    [grey + 0.8 * r.max(0.0), grey, grey + 0.8 * (-r).max(0.0)]
                };
            }
            shrunk(&image).0
        })
    }
}

fn share(marks: &[bool]) -> f64 {
    marks.iter().filter(|m| **m).count() as f64 / marks.len().max(1) as f64
}

/// Smaller by a whole factor, which is returned too.
fn shrunk(image: &Image) -> (Image, usize) {
    let k = image.width.max(image.height).div_ceil(LARGEST).max(1);
    let small = Image::from_fn(
        (image.width / k).max(1),
        (image.height / k).max(1),
        |x, y| {
            let mut sum = [0.0_f32; 3];
            for j in 0..k {
                for i in 0..k {
                    let p = image.get(
                        (x * k + i).min(image.width - 1),
                        (y * k + j).min(image.height - 1),
                    );
                    for c in 0..3 {
                        sum[c] += p[c];
                    }
                }
            }
            sum.map(|s| s / (k * k) as f32)
        },
    );
    (small, k)
}

/// Smaller, and so bright that nine tenths of what isn't black is below 0.8; above, compressed.
fn developed(image: &Image) -> (Image, usize) {
    let (mut small, k) = shrunk(image);
    let mut green: Vec<f32> = small
        .pixels
        .iter()
        .map(|p| p[1])
        .filter(|g| *g > 0.0)
        .collect();
    if green.is_empty() {
        return (small, k);
    }
    let n = green.len() * 9 / 10;
    let (_, bright, _) = green.select_nth_unstable_by(n, f32::total_cmp);
    let gain = 0.8 / *bright;
    for p in &mut small.pixels {
        // x up to 0.8, then 0.8 + 0.2 (1 − e^(−(x − 0.8)/0.2)): smooth, and below 1.
        *p = p.map(|c| {
            let x = (c * gain).max(0.0);
            if x < 0.8 {
                x
            } else {
                1.0 - 0.2 * Real::exp((0.8 - x) / 0.2)
            }
        });
    }
    (small, k)
}

/// A line two pixels thick.
fn line(canvas: &mut Image, a: [f64; 2], b: [f64; 2], ink: [f32; 3]) {
    let n = (b[0] - a[0])
        .abs()
        .max((b[1] - a[1]).abs())
        .min(1e5)
        .ceil()
        .max(1.0);
    for i in 0..=n as usize {
        let t = i as f64 / n;
        let (x, y) = (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]));
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)] {
            put(canvas, x + dx, y + dy, ink);
        }
    }
}

fn dot(canvas: &mut Image, at: [f64; 2], ink: [f32; 3]) {
    for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
        put(canvas, at[0] + dx, at[1] + dy, ink);
    }
}

fn put(canvas: &mut Image, x: f64, y: f64, ink: [f32; 3]) {
    if x >= 0.0 && y >= 0.0 && x < canvas.width as f64 && y < canvas.height as f64 {
        canvas.set(x as usize, y as usize, ink);
    }
}
