//! `gonio relight`: other lights in a picture that is taken already (T9a: light adds up over lights).

use super::destination;
use super::failure::{Failure, did_you_mean, nearest};
use super::render::product::{GROUPS, ToneArguments};
use super::terminal::{print, print_json, warn};
use gonio_image::{Channel, ChannelData, Image, Layers};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    gonio render room.toml --layers groups -o room.exr\n  \
    gonio relight room.exr --light key=2.0 --light sky=0.5,0.6,1.0 -o evening.exr -o evening.png\n  \
    gonio relight room.exr --light key=0 -o without-key.png\n\n\
    The picture is the sum of its groups' layers, each times its factor: no ray is followed. An EXR\n\
    can be mixed again. The variance, the direct and the indirect light of a mixture are not known:\n\
    their layers are left out.")]
pub(super) struct Arguments {
    /// An EXR with a layer for each group of lights: 'gonio render --layers groups'
    file: PathBuf,
    /// Multiply a group's light by one factor, or by one for each of red, green and blue; may be repeated. Lights that are in no group are in 'default'; groups
    /// that are not named stay
    #[arg(long = "light", value_name = "GROUP=FACTOR", value_parser = change, required = true)]
    lights: Vec<Change>,
    /// Where to write: .exr, .hdr or .png; may be repeated
    #[arg(short, long = "output", value_name = "FILE", required = true)]
    output: Vec<PathBuf>,
    #[command(flatten)]
    tone: ToneArguments,
    /// Nothing but warnings and errors
    #[arg(short, long)]
    quiet: bool,
    /// Print the summary as JSON
    #[arg(long, conflicts_with = "quiet")]
    json: bool,
}

/// A group of lights, and what its light is multiplied by.
#[derive(Debug, Clone, PartialEq)]
struct Change {
    group: String,
    factor: [f32; 3],
}

/// `key=2.0` or `sky=0.5,0.6,1.0`.
fn change(text: &str) -> Result<Change, String> {
    const EXPECTED: &str = "expected GROUP=FACTOR, one number or three for red, green and blue, none below 0: key=2.0 or sky=0.5,0.6,1.0";
    let (group, factors) = text.rsplit_once('=').ok_or(EXPECTED)?;
    let numbers: Option<Vec<f32>> = factors
        .split(',')
        .map(|word| word.trim().parse::<f32>().ok())
        .collect();
    let factor = match numbers.as_deref() {
        Some(&[all]) => [all; 3],
        Some(&[r, g, b]) => [r, g, b],
        _ => return Err(EXPECTED.into()),
    };
    let good = |f: &f32| f.is_finite() && *f >= 0.0;
    if group.is_empty() || !factor.iter().all(good) {
        return Err(EXPECTED.into());
    }
    let group = group.to_owned();
    Ok(Change { group, factor })
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    for path in &arguments.output {
        destination::check(path)?;
    }
    let path = &arguments.file;
    let mut layers = Layers::read_exr(path)?;
    let groups = groups(path, &layers)?;
    let mixture = mixture(&arguments.lights, &groups)?;
    if let Some(text) = missing_light(path, &layers, &groups) {
        warn(&text);
    }
    let left_out = mix(&mut layers, &groups, &mixture)?;
    note_mixture(&mut layers, &arguments.lights);
    for output in &arguments.output {
        match destination::extension(output).as_str() {
            "exr" => layers.write_exr(output)?,
            _ => {
                // Brought to the primaries that such files have.
                let image = layers.to_image().unwrap_or_else(|| Image::new(0, 0));
                arguments.tone.write(&image, output)?;
            }
        }
    }
    if arguments.json {
        let factors: serde_json::Map<_, _> = (groups.iter().zip(&mixture))
            .map(|(group, factor)| (group.name.clone(), serde_json::json!(factor)))
            .collect();
        return print_json(&serde_json::json!({
            "outputs": arguments.output,
            "width": layers.width,
            "height": layers.height,
            "factors": factors,
            "left_out": left_out,
        }));
    }
    if arguments.quiet {
        return Ok(());
    }
    let mut text = format!("{}×{} pixels", layers.width, layers.height);
    for (group, factor) in groups.iter().zip(&mixture) {
        text += &format!(", {} × {}", group.name, said(*factor));
    }
    text += "\n";
    for output in &arguments.output {
        text += &format!("wrote {}\n", output.display());
    }
    print(&text)
}

/// The layer of a group of lights.
struct Group {
    name: String,
    light: Image,
}

/// The prefix of the layers of groups.
const LAYER: &str = "group.";

/// The groups of lights of a picture: those that it says it has, each of which must be there.
fn groups(path: &Path, layers: &Layers) -> Result<Vec<Group>, Failure> {
    let names: Vec<String> = match layers.metadata(GROUPS) {
        Some(listed) => serde_json::from_str(listed).map_err(|e| {
            Failure::input(format!(
                "{}: the attribute {GROUPS} is {listed:?}, expected a list of names: {e}",
                path.display()
            ))
            .with_help("render the picture again, with --layers groups")
        })?,
        None => (layers.channels.iter())
            .filter_map(|c| c.name.strip_prefix(LAYER)?.strip_suffix(".R"))
            .map(str::to_owned)
            .collect(),
    };
    if names.is_empty() {
        return Err(
            Failure::input(format!("{}: no layer of a group of lights", path.display()))
                .with_help("render the picture with --layers groups"),
        );
    }
    names
        .into_iter()
        .map(|name| {
            let light = layers.rgb(&format!("{LAYER}{name}")).ok_or_else(|| {
                Failure::input(format!(
                    "{}: the channels {LAYER}{name}.R, G and B are not all there",
                    path.display()
                ))
                .with_help("a part of the light is lost: render the picture again, with --layers groups")
            })?;
            if let Some(first) = light.scan().first {
                return Err(Failure::input(format!(
                    "{}: the layer {LAYER}{name} has {} at column {}, row {}, expected light: finite, not negative",
                    path.display(),
                    first.value,
                    first.x,
                    first.y
                ))
                .with_help("render the picture again, with --layers groups"));
            }
            Ok(Group { name, light })
        })
        .collect()
}

/// The factor of each group.
fn mixture(changes: &[Change], groups: &[Group]) -> Result<Vec<[f32; 3]>, Failure> {
    let mut all = vec![[1.0; 3]; groups.len()];
    for (i, change) in changes.iter().enumerate() {
        let name = &change.group;
        if changes[..i].iter().any(|c| c.group == *name) {
            return Err(
                Failure::usage(format!("--light: the group '{name}' is there twice"))
                    .with_help("one factor a group"),
            );
        }
        let place = groups.iter().position(|g| g.name == *name).ok_or_else(|| {
            let names: Vec<&str> = groups.iter().map(|g| g.name.as_str()).collect();
            let there = format!("the picture has: {}", names.join(", "));
            Failure::usage(format!("--light: no group of lights is called '{name}'")).with_help(
                match nearest(name, &names) {
                    Some(near) => format!("{} {there}", did_you_mean(&near)),
                    None => there,
                },
            )
        })?;
        all[place] = change.factor;
    }
    Ok(all)
}

/// A share of the light that groups may lack, for all their roundings, to half precision even.
const LOST: f64 = 1e-3;

/// What to know if the groups are not all of the picture's light.
fn missing_light(path: &Path, layers: &Layers, groups: &[Group]) -> Option<String> {
    let total = |image: &Image| {
        let all = image.pixels.as_flattened().iter();
        all.map(|v| f64::from(*v)).sum::<f64>()
    };
    let whole = total(&layers.rgb("")?);
    let sum: f64 = groups.iter().map(|g| total(&g.light)).sum();
    // A picture with NaN has another sum than any.
    let agrees = (sum - whole).abs() <= LOST * whole;
    (!agrees).then(|| {
        format!(
            "{}: the groups add up to {:.2} % of the picture's light; what is mixed is that of the groups",
            path.display(),
            100.0 * sum / whole
        )
    })
}

/// Puts the mixture in the place of the picture, and the light of each group in the mixture in the place of its layer. Returns the layers
/// that are left out, since they are not known of a mixture.
fn mix(
    layers: &mut Layers,
    groups: &[Group],
    mixture: &[[f32; 3]],
) -> Result<Vec<String>, Failure> {
    let mut left_out: Vec<String> = Vec::new();
    layers.channels.retain(|channel| {
        let (layer, _) = channel.name.rsplit_once('.').unwrap_or_default();
        let unknown = ["variance", "direct", "indirect", "reweighted", "denoised"].contains(&layer);
        if unknown && !left_out.iter().any(|l| l == layer) {
            left_out.push(layer.to_owned());
        }
        !unknown
    });
    let count = layers.width * layers.height;
    for (c, component) in ["R", "G", "B"].into_iter().enumerate() {
        let mut whole = vec![0.0_f64; count];
        for (group, factor) in groups.iter().zip(mixture) {
            let light = group
                .light
                .pixels
                .iter()
                .map(|p| f64::from(p[c]) * f64::from(factor[c]));
            let mut mixed = Vec::with_capacity(count);
            for (sum, light) in whole.iter_mut().zip(light) {
                *sum += light;
                mixed.push(light as f32);
            }
            put(layers, &format!("{LAYER}{}.{component}", group.name), mixed)?;
        }
        let picture = whole.into_iter().map(|sum| sum as f32).collect();
        put(layers, component, picture)?;
    }
    Ok(left_out)
}

/// Puts numbers in the place of a channel's, or beside the others if it isn't there.
fn put(layers: &mut Layers, name: &str, samples: Vec<f32>) -> Result<(), Failure> {
    let samples = ChannelData::Float(samples);
    match layers.channels.iter_mut().find(|c| c.name == name) {
        Some(Channel { samples: there, .. }) => *there = samples,
        None => layers.push(name, samples)?,
    }
    Ok(())
}

/// What was mixed, one mixture after another.
const MIXED: &str = "gonio.relight";

fn note_mixture(layers: &mut Layers, changes: &[Change]) {
    let each: Vec<String> = (changes.iter())
        .map(|change| format!("{}={}", change.group, said(change.factor)))
        .collect();
    let mut text = each.join(" ");
    if let Some(before) = layers.metadata(MIXED) {
        text = format!("{before}; {text}");
    }
    layers.set_metadata(MIXED, text);
    layers.set_metadata(
        "gonio.variance",
        "not known: that of a mixture does not follow from its groups'",
    );
    let of_the_picture = ["gonio.noise", "gonio.direct"];
    layers
        .metadata
        .retain(|(name, _)| !of_the_picture.contains(&name.as_str()));
}

/// A factor as `--light` takes it.
fn said([r, g, b]: [f32; 3]) -> String {
    match r == g && g == b {
        true => r.to_string(),
        false => format!("{r},{g},{b}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_read() {
        let known = |group: &str, factor| {
            Ok(Change {
                group: group.into(),
                factor,
            })
        };
        assert_eq!(change("key=2"), known("key", [2.0; 3]));
        assert_eq!(
            change("a-b_c=0.5, 0,1e2"),
            known("a-b_c", [0.5, 0.0, 100.0])
        );
        for text in [
            "",
            "key",
            "=2",
            "key=",
            "key=a",
            "key=-1",
            "key=nan",
            "key=inf",
            "key=1,2",
            "key=1,2,3,4",
        ] {
            assert!(change(text).is_err(), "{text}");
        }
    }

    #[test]
    fn factors_are_said_as_they_are_read() {
        for factor in [[2.0; 3], [0.5, 0.25, 1.0]] {
            let text = format!("key={}", said(factor));
            assert_eq!(change(&text).map(|c| c.factor), Ok(factor));
        }
    }
}
