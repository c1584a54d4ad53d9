//! A picture of every step, for eyes.

use crate::outline::Outline;
use crate::response::Response;
use crate::{CaptureError, Panorama, Radiance};
use gonio_image::Image;
use gonio_image::tonemap::ToneMap;
use gonio_num::Real;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// Longer side \[pixels] of a picture.
const LARGEST: usize = 1400;
const PAPER: [f32; 3] = [0.96, 0.96, 0.96];
const GRID: [f32; 3] = [0.72, 0.72, 0.72];
const INKS: [[f32; 3]; 3] = [[0.75, 0.03, 0.02], [0.01, 0.35, 0.03], [0.02, 0.08, 0.7]];

/// Writes numbered pictures into a folder; or nothing.
#[derive(Debug)]
pub struct Explain {
    folder: Option<PathBuf>,
    count: usize,
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
        })
    }

    fn write(&mut self, name: &str, draw: impl FnOnce() -> Image) -> Result<(), CaptureError> {
        self.count += 1;
        if let Some(folder) = &self.folder {
            let path = folder.join(format!("{:02}-{name}.png", self.count));
            draw().write_png(&path, ToneMap::Linear, 0.0)?;
        }
        Ok(())
    }

    /// The response curve: codes to the right, the logarithm of the exposure upwards, five decades.
    pub(crate) fn response(&mut self, response: &Response) -> Result<(), CaptureError> {
        self.write("response", || {
            const DECADES: f64 = 5.0;
            let (w, h) = (640, 480);
            let mut canvas = Image::filled(w, h, PAPER);
            for k in 0..=5 {
                let y = k as f64 / 5.0 * (h - 1) as f64;
                line(&mut canvas, [0.0, y], [w as f64, y], GRID);
                let x = k as f64 / 5.0 * (w - 1) as f64;
                line(&mut canvas, [x, 0.0], [x, h as f64], GRID);
            }
            for (c, ink) in INKS.iter().enumerate() {
                let channel = response.channel(c);
                let top = Real::ln(channel[255]);
                let at = |z: usize| {
                    let down = (top - Real::ln(channel[z].max(1e-12))) / std::f64::consts::LN_10;
                    [
                        z as f64 / 255.0 * (w - 1) as f64,
                        down / DECADES * (h - 1) as f64,
                    ]
                };
                for z in 1..256 {
                    line(&mut canvas, at(z - 1), at(z), *ink);
                }
            }
            canvas
        })
    }

    /// The merged photograph; what is clipped in magenta.
    pub(crate) fn radiance(
        &mut self,
        view: usize,
        radiance: &Radiance,
    ) -> Result<(), CaptureError> {
        self.write(&format!("view{view}-radiance"), || {
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
        self.write(&format!("view{view}-outline"), || {
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
    pub(crate) fn panorama(&mut self, name: &str, image: &Image) -> Result<(), CaptureError> {
        self.write(name, || developed(image).0)
    }

    /// Confidence in grey, and what is clipped in magenta.
    pub(crate) fn confidence(&mut self, name: &str, p: &Panorama) -> Result<(), CaptureError> {
        self.write(name, || {
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
        name: &str,
        a: &Panorama,
        b: &Panorama,
    ) -> Result<(), CaptureError> {
        self.write(name, || {
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
