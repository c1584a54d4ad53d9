//! What a rendering leaves: pictures with how they came to be, and parts.

use super::denoise;
use crate::cli::destination;
use crate::cli::failure::Failure;
use crate::cli::parse;
use crate::cli::summary::rejected_in_words;
use gonio_image::tonemap::ToneMap;
use gonio_image::{Image, Layers};
use gonio_render::Film;
use gonio_render::film::picture;
use gonio_render::part::{self, Exposure, Label};
use std::path::{Path, PathBuf};

/// How pictures are written.
#[derive(clap::Args)]
pub(in crate::cli) struct PictureArguments {
    #[command(flatten)]
    pub tone: ToneArguments,
    /// A second picture without noise, the layer 'denoised' of EXR files, by Open Image Denoise, guided by albedo and normal: its details are guesses. For
    /// programs that are built with the feature 'denoise'
    #[arg(long)]
    pub denoise: bool,
    /// What PNG and HDR files and previews show: the mean of all samples (mean), or the picture of --reweight-fireflies (reweighted) or of --denoise
    /// (denoised; previews show the mean)
    #[arg(long, value_enum, value_name = "PICTURE", default_value_t = Shown::Mean)]
    pub show: Shown,
    /// Write the time spent into EXR files: two pictures of the same samples are then no longer the same file
    #[arg(long)]
    pub write_time: bool,
}

/// A picture that a film has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(in crate::cli) enum Shown {
    Mean,
    Reweighted,
    Denoised,
}

impl PictureArguments {
    /// Fails unless the picture that shall be shown will be there.
    ///
    /// - `reweighted`: whether samples are told apart by their brightness
    pub fn check(&self, reweighted: bool) -> Result<(), Failure> {
        if self.denoise {
            denoise::check()?;
        }
        if self.show == Shown::Denoised && !self.denoise {
            return Err(
                Failure::usage("--show denoised: nothing is denoised").with_help("add --denoise")
            );
        }
        if self.show == Shown::Reweighted && !reweighted {
            return Err(Failure::usage(
                "--show reweighted: the samples are not told apart by their brightness",
            )
            .with_help("render with --reweight-fireflies"));
        }
        Ok(())
    }

    /// The picture to show while it is taken.
    pub fn shown(&self, film: &Film) -> Image {
        let reweighted = match self.show {
            Shown::Mean | Shown::Denoised => None,
            Shown::Reweighted => film.reweighted(),
        };
        reweighted.unwrap_or_else(|| film.image())
    }
}

/// How light becomes the colours of a screen.
#[derive(clap::Args)]
pub(in crate::cli) struct ToneArguments {
    /// Exposure of PNG files, in stops
    #[arg(long, value_name = "EV", default_value = "0", value_parser = parse::finite, allow_hyphen_values = true)]
    pub exposure: f32,
    /// Tone map of PNG files
    #[arg(long, value_name = "NAME", default_value = "pbr-neutral", value_parser = parse::tone_map())]
    pub tonemap: ToneMap,
}

impl ToneArguments {
    /// Writes a picture in the format of the name's extension, but for EXR.
    pub fn write(&self, image: &Image, path: &Path) -> Result<(), Failure> {
        match destination::extension(path).as_str() {
            "png" => image.write_png(path, self.tonemap, self.exposure)?,
            _ => image.write(path)?,
        }
        Ok(())
    }
}

/// The attribute with the names of the groups of lights: a list in JSON, whose layers add up to the picture.
pub(in crate::cli) const GROUPS: &str = "gonio.groups";

/// The attribute with the names of the materials: a list in JSON; the layer of materials counts them from 1.
pub(in crate::cli) const MATERIALS: &str = "gonio.materials";

fn listed(names: &[String]) -> String {
    serde_json::json!(names).to_string()
}

/// The extension of a part.
pub(in crate::cli) fn is_part(path: &Path) -> bool {
    destination::extension(path) == "gonio"
}

/// Writes each file. One that can't be written is no reason to lose the others; the first failure is given beside those that are written.
pub(in crate::cli) fn write_all<'a>(
    paths: impl IntoIterator<Item = &'a PathBuf>,
    label: &Label,
    exposure: &Exposure,
    how: &PictureArguments,
) -> (Vec<&'a PathBuf>, Option<Failure>) {
    let mut written = Vec::new();
    let mut failure = None;
    let mut denoised = None;
    if how.denoise {
        match denoise::denoised(&exposure.film) {
            Ok(image) => denoised = Some(image),
            Err(e) => failure = Some(e),
        }
    }
    for path in paths {
        match write(path, label, exposure, how, denoised.as_ref()) {
            Ok(()) => written.push(path),
            Err(e) => failure = failure.or(Some(e)),
        }
    }
    (written, failure)
}

fn write(
    path: &Path,
    label: &Label,
    exposure: &Exposure,
    how: &PictureArguments,
    denoised: Option<&Image>,
) -> Result<(), Failure> {
    let film = &exposure.film;
    match destination::extension(path).as_str() {
        "gonio" => part::write(path, label, exposure)?,
        "exr" => {
            let metadata = metadata(label, exposure, how.write_time);
            let mut layers = film.layers(&label.names, metadata);
            if let Some(image) = denoised {
                add(image, &mut layers);
            }
            layers.write_exr(path)?;
        }
        _ => match denoised.filter(|_| how.show == Shown::Denoised) {
            Some(image) => how.tone.write(image, path)?,
            None => how.tone.write(&how.shown(film), path)?,
        },
    }
    Ok(())
}

/// Adds the denoised picture.
fn add(image: &Image, layers: &mut Layers) {
    layers.channels.extend(picture("denoised", image));
    layers.set_metadata(
        "gonio.denoised",
        "denoised.R, G and B: by Open Image Denoise, guided by albedo and normal; biased, and not the same bits on every machine; R, G and B are the mean of all samples",
    );
}

/// How the picture came to be, as text attributes of the file: functions of its samples alone, so that the same samples make the same file,
/// but for the time if that is asked for.
fn metadata(label: &Label, exposure: &Exposure, with_time: bool) -> Vec<(String, String)> {
    let film = &exposure.film;
    let identity = |name: &str| label.identity.get(name).unwrap_or_default().to_owned();
    let mut all = vec![
        ("generator", identity("version")),
        ("gonio.scene", label.scene.clone()),
        ("gonio.sceneHash", identity("scene")),
        ("gonio.camera", identity("camera")),
        ("gonio.integrator", identity("integrator")),
        ("gonio.sampler", identity("sampler")),
        ("gonio.filter", identity("filter")),
        ("gonio.seed", identity("seed")),
        (
            "gonio.samplesPerPixel",
            film.samples_per_pixel().to_string(),
        ),
        (
            "gonio.samples",
            format!("{}:{}", exposure.samples.start, exposure.samples.end),
        ),
        ("gonio.unit", "W m^-2 sr^-1".into()),
        (
            "gonio.colourSpace",
            "linear, Rec.709 primaries, D65 white".into(),
        ),
        ("gonio.clamping", "none".into()),
        (
            "gonio.variance",
            "variance.R, G and B: of the mean of the samples".into(),
        ),
        ("gonio.rejectedSamples", film.rejected().count.to_string()),
    ];
    let noise = film.noise();
    if noise.is_finite() {
        all.push(("gonio.noise", format!("{noise:.6}")));
    }
    if let Some(first) = &film.rejected().first {
        let words = rejected_in_words(first, &label.names.materials);
        all.push(("gonio.firstRejectedSample", words));
    }
    let kept = film.kept();
    if kept.shares() > 0 {
        let count = film.rejected().in_layers.to_string();
        all.push(("gonio.rejectedInLayers", count));
    }
    if kept.direct || kept.indirect {
        let words = "light after at most one reflection, passages through surfaces included; emission that is seen itself is direct";
        all.push(("gonio.direct", words.into()));
    }
    if kept.reweighted {
        let words = "reweighted.R, G and B: biased, fireflies weigh less (Zirr et al. 2018), kappa 8; R, G and B are the mean of all samples";
        all.push(("gonio.reweighted", words.into()));
    }
    if kept.material {
        all.push((MATERIALS, listed(&label.names.materials)));
    }
    if kept.groups > 0 {
        all.push((GROUPS, listed(&label.names.groups)));
    }
    if with_time {
        all.push((
            "gonio.seconds",
            format!("{:.3}", exposure.elapsed.as_secs_f64()),
        ));
    }
    all.into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .collect()
}
