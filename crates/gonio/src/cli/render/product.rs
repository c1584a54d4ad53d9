//! What a rendering leaves: pictures with how they came to be, and parts.

use crate::cli::destination;
use crate::cli::failure::Failure;
use crate::cli::parse;
use crate::cli::summary::rejected_in_words;
use gonio_image::Image;
use gonio_image::tonemap::ToneMap;
use gonio_render::part::{self, Exposure, Label};
use gonio_render::{Film, Kept};
use std::path::{Path, PathBuf};

/// How pictures are written.
#[derive(clap::Args)]
pub(in crate::cli) struct PictureArguments {
    #[command(flatten)]
    pub tone: ToneArguments,
    /// What PNG and HDR files and previews show: the mean of all samples (mean), or the picture of --reweight-fireflies (reweighted)
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
}

impl PictureArguments {
    /// Fails unless the picture that shall be shown is among the layers that are kept.
    pub fn check_shown(&self, kept: &Kept) -> Result<(), Failure> {
        if self.show == Shown::Reweighted && !kept.reweighted {
            return Err(Failure::usage(
                "--show reweighted: the samples are not told apart by their brightness",
            )
            .with_help("render with --reweight-fireflies"));
        }
        Ok(())
    }

    /// The picture to show.
    pub fn shown(&self, film: &Film) -> Image {
        let reweighted = match self.show {
            Shown::Mean => None,
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
    for path in paths {
        match write(path, label, exposure, how) {
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
) -> Result<(), Failure> {
    let film = &exposure.film;
    match destination::extension(path).as_str() {
        "gonio" => part::write(path, label, exposure)?,
        "exr" => film
            .layers(&label.names, metadata(label, exposure, how.write_time))
            .write_exr(path)?,
        _ => how.tone.write(&how.shown(film), path)?,
    }
    Ok(())
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
