//! What a rendering did, for people and for programs.

use super::progress::{percent, quantity};
use gonio_render::{Rejected, RejectedSample, Stop};
use gonio_scene::Scene;
use std::path::PathBuf;

/// What a rendering did. Its names are those of the JSON.
#[derive(serde::Serialize)]
pub(super) struct Summary<'a> {
    pub outputs: Vec<&'a PathBuf>,
    pub width: u32,
    pub height: u32,
    /// Of the pixel that has most.
    pub samples_per_pixel: u32,
    pub mean_samples_per_pixel: f64,
    /// The index of the first sample and that after the last.
    pub samples: [u32; 2],
    /// Of all runs that contributed.
    pub seconds: f64,
    pub rays: u64,
    /// None before there are samples enough for an estimate.
    pub noise: Option<f64>,
    pub stopped_by: Stop,
    pub seed: u64,
    pub scene_hash: &'a str,
    pub rejected_samples: &'a Rejected,
    pub warnings: &'a [String],
    pub notes: &'a [String],
}

impl Summary<'_> {
    /// The warning of samples that could not enter the picture, with the place of the first.
    pub fn rejected(&self, scene: &Scene) -> Option<String> {
        let first = self.rejected_samples.first.as_ref()?;
        let material = first.material.and_then(|m| scene.materials.get(m as usize));
        let why = material.and_then(|m| m.failure());
        let why = why.map_or(String::new(), |e| format!(": {e}"));
        let material = material.map_or("no surface", |m| m.name.as_str());
        Some(format!(
            "{} samples were negative or not finite and count as black; the first: pixel {}, {}, sample {}, material \
             '{material}', radiance {:?}{why}",
            self.rejected_samples.count,
            first.pixel[0],
            first.pixel[1],
            first.sample,
            first.radiance
        ))
    }

    /// The lines that end a rendering.
    pub fn in_words(&self) -> String {
        let most = self.samples_per_pixel;
        let samples = if self.mean_samples_per_pixel < f64::from(most) {
            format!(
                "{:.1} samples in the mean and {most} at most",
                self.mean_samples_per_pixel
            )
        } else {
            format!("{most} sample{} each", if most == 1 { "" } else { "s" })
        };
        let mut text = format!(
            "{}×{} pixels, {samples}, {} rays in {:.1} s ({} rays/s), noise {}\n",
            self.width,
            self.height,
            quantity(self.rays as f64),
            self.seconds,
            quantity(self.rays as f64 / self.seconds.max(1e-9)),
            percent(self.noise.unwrap_or(f64::INFINITY)),
        );
        for path in &self.outputs {
            text += &format!("wrote {}\n", path.display());
        }
        text
    }
}

/// The warning of shares of light that could not enter their layers.
pub(super) fn faulty_shares(rejected: &Rejected) -> Option<String> {
    let count = match rejected.in_layers {
        0 => return None,
        1 => "one share of a sound sample was".to_owned(),
        n => format!("{n} shares of sound samples were"),
    };
    Some(format!(
        "{count} negative or not finite and is in no layer: layers don't quite add up to the picture, and a reflection function is faulty; \
         'gonio brdf check' finds what is wrong with it"
    ))
}

/// The place of a rejected sample, where the scene is not at hand.
///
/// - `materials`: their names
pub(super) fn rejected_in_words(first: &RejectedSample, materials: &[String]) -> String {
    let [x, y] = first.pixel;
    let named = |m: u32| match materials.get(m as usize) {
        Some(name) => format!("material '{name}'"),
        None => format!("material {m}"),
    };
    let material = first.material.map_or("no surface".into(), named);
    format!(
        "pixel {x}, {y}, sample {}, {material}, radiance {:?}",
        first.sample, first.radiance
    )
}
