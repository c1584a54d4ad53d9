//! `gonio farm`: a rendering in parts as a job of an existing system, with the merge as a step that depends on them.

mod hyperqueue;
mod kubernetes;
mod openjd;
mod slurm;

use super::failure::Failure;
use super::terminal::print;
use super::{destination, parse};
use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};

/// The system that runs the job.
#[derive(Subcommand)]
pub(super) enum Command {
    /// A template for Open Job Description, which render farms run
    Openjd(Arguments),
    /// Array scripts for Slurm, and a script that submits them
    Slurm(Arguments),
    /// A job file for HyperQueue
    Hyperqueue(Arguments),
    /// Manifests of an indexed Job and of one that merges, for Kubernetes
    Kubernetes {
        #[command(flatten)]
        arguments: Arguments,
        /// The container image that has gonio
        #[arg(long, value_name = "IMAGE")]
        container: String,
        /// The persistent volume claim with the scene, shared by all machines; it is mounted at /work, and the scene's path is one in it
        #[arg(long, value_name = "CLAIM")]
        claim: String,
    },
}

#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    gonio farm slurm room.toml --parts 64 -o job -- --spp 4096\n  \
    gonio farm openjd room.toml --parts 16 -o job --picture room.exr --picture room.png\n\n\
    Nothing is run or submitted: the last line says how to. Each part is restartable, keeps a checkpoint beside it, and is not rendered\n\
    again if it is there. All machines must see the scene and the folder under the same paths.")]
pub(super) struct Arguments {
    /// The scene
    scene: PathBuf,
    /// Parts of about as many samples
    #[arg(long, value_name = "N", value_parser = parse::whole(1_u32, 100_000), allow_hyphen_values = true)]
    parts: u32,
    /// The folder for the job, the parts and the picture
    #[arg(short, long = "output", value_name = "DIR", default_value = "farm")]
    output: PathBuf,
    /// The picture's name in that folder; may be repeated [default: picture.exr]
    #[arg(long, value_name = "FILE")]
    picture: Vec<PathBuf>,
    /// Processors of each part
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = parse::whole(1_u32, 4096), allow_hyphen_values = true)]
    cpus: u32,
    /// How the command is called on the machines
    #[arg(long, value_name = "COMMAND", default_value = "gonio")]
    gonio: String,
    /// Options of 'gonio render', after --
    #[arg(last = true, value_name = "OPTIONS")]
    options: Vec<String>,
}

pub(super) fn run(command: &Command) -> Result<(), Failure> {
    let (files, submit) = match command {
        Command::Openjd(arguments) => openjd::files(&Job::of(arguments)?),
        Command::Slurm(arguments) => slurm::files(&Job::of(arguments)?),
        Command::Hyperqueue(arguments) => hyperqueue::files(&Job::of(arguments)?),
        Command::Kubernetes {
            arguments,
            container,
            claim,
        } => kubernetes::files(&Job::in_volume(arguments)?, container, claim),
    };
    let arguments = command.arguments();
    let folder = &arguments.output;
    std::fs::create_dir_all(folder)
        .map_err(|e| Failure::io(&folder.display().to_string(), "make it", &e))?;
    let mut text = String::new();
    for (name, content) in files {
        let path = folder.join(name);
        gonio_image::write_file(&path, content.as_bytes())?;
        text += &format!("wrote {}\n", path.display());
    }
    print(&format!("{text}submit it: {submit}\n"))
}

impl Command {
    fn arguments(&self) -> &Arguments {
        match self {
            Self::Openjd(arguments)
            | Self::Slurm(arguments)
            | Self::Hyperqueue(arguments)
            | Self::Kubernetes { arguments, .. } => arguments,
        }
    }
}

/// The files of a job by name, and the command that submits it.
type Files = (Vec<(&'static str, String)>, String);

/// A rendering in parts, as every system needs it.
struct Job {
    /// A name that every system takes: lower case letters, digits and hyphens.
    name: String,
    parts: u32,
    cpus: u32,
    gonio: String,
    scene: String,
    folder: String,
    /// Where the job was written: what relative names in options begin from.
    here: String,
    options: Vec<String>,
    pictures: Vec<String>,
}

impl Job {
    /// With the paths that this machine has.
    fn of(arguments: &Arguments) -> Result<Self, Failure> {
        let absolute = |path: &Path| {
            std::path::absolute(path)
                .map(|p| p.display().to_string())
                .map_err(|e| Failure::io(&path.display().to_string(), "find its place", &e))
        };
        if !arguments.scene.is_file() {
            return Err(Failure::input(format!(
                "{}: there is no such scene",
                arguments.scene.display()
            ))
            .with_help("check the path"));
        }
        // Machines begin in other folders.
        let mut options = arguments.options.clone();
        for option in &mut options {
            if Path::new(option.as_str()).exists() {
                *option = absolute(Path::new(option.as_str()))?;
            }
        }
        let here = absolute(Path::new("."))?;
        let (scene, folder) = (absolute(&arguments.scene)?, absolute(&arguments.output)?);
        Self::new(arguments, scene, folder, here, options)
    }

    /// With paths in a volume that is mounted at /work.
    fn in_volume(arguments: &Arguments) -> Result<Self, Failure> {
        let within = |path: &Path| match path.is_relative() {
            true => Ok(format!("{VOLUME}/{}", path.display())),
            false => Err(Failure::usage(format!(
                "{}: expected a path in the volume, such as scenes/room.toml",
                path.display()
            ))
            .with_help("the volume of --claim is mounted at /work; name paths in it")),
        };
        let (scene, folder) = (within(&arguments.scene)?, within(&arguments.output)?);
        let options = arguments.options.clone();
        Self::new(arguments, scene, folder, VOLUME.into(), options)
    }

    fn new(
        arguments: &Arguments,
        scene: String,
        folder: String,
        here: String,
        options: Vec<String>,
    ) -> Result<Self, Failure> {
        let words = ["gonio", "render", &scene]
            .into_iter()
            .chain(options.iter().map(String::as_str));
        let understood = super::Arguments::try_parse_from(words).map_err(|e| {
            super::usage::of_arguments::<super::Arguments>(&e).about("options of 'gonio render'")
        })?;
        let super::Command::Render(render) = &understood.command else {
            unreachable!("invariant: the words begin with `render`");
        };
        render.check_for_parts(arguments.parts)?;
        let pictures = match arguments.picture.is_empty() {
            true => vec![PathBuf::from("picture.exr")],
            false => arguments.picture.clone(),
        };
        for picture in &pictures {
            destination::check_extension(picture, &["exr", "hdr", "png"], "pictures")?;
        }
        let place = |picture: &PathBuf| format!("{folder}/{}", picture.display());
        Ok(Self {
            name: name(&arguments.scene),
            parts: arguments.parts,
            cpus: arguments.cpus,
            gonio: arguments.gonio.clone(),
            pictures: pictures.iter().map(place).collect(),
            scene,
            folder,
            here,
            options,
        })
    }

    /// The arguments of the part that `index` stands for.
    fn render(&self, index: &str, progress: Option<&str>) -> Vec<String> {
        let mut all: Vec<String> = vec!["render".into(), self.scene.clone()];
        all.extend(self.options.iter().cloned());
        let folder = &self.folder;
        all.extend([
            "--part".into(),
            format!("{index}/{}", self.parts),
            "-o".into(),
            format!("{folder}/part-{{part}}.gonio"),
            "--checkpoint".into(),
            format!("{folder}/part-{{part}}.checkpoint"),
            "--resume".into(),
            "--threads".into(),
            self.cpus.to_string(),
        ]);
        if let Some(progress) = progress {
            all.extend(["--progress".into(), progress.into()]);
        }
        all
    }

    /// The arguments that put the parts together.
    fn merge(&self) -> Vec<String> {
        let mut all: Vec<String> = vec!["merge".into()];
        all.extend((0..self.parts).map(|k| format!("{}/part-{k}.gonio", self.folder)));
        for picture in &self.pictures {
            all.extend(["-o".into(), picture.clone()]);
        }
        all
    }
}

/// Where a volume is mounted.
const VOLUME: &str = "/work";

/// The scene's name in lower case letters, digits and hyphens, at most 40 of them.
fn name(scene: &Path) -> String {
    let stem = scene.file_stem().unwrap_or_default().to_string_lossy();
    let letters = stem
        .to_lowercase()
        .replace(|c: char| !c.is_ascii_alphanumeric(), "-");
    let short: String = letters.chars().take(40).collect();
    format!("gonio-{}", short.trim_matches('-'))
        .trim_matches('-')
        .to_owned()
}

/// A word as a POSIX shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./:=,@%+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

/// Words as one line of a POSIX shell.
fn line(words: &[String]) -> String {
    let words: Vec<String> = words.iter().map(|w| quoted(w)).collect();
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_every_system_takes() {
        assert_eq!(name(Path::new("a/My Room_2.toml")), "gonio-my-room-2");
        assert_eq!(name(Path::new("__.toml")), "gonio");
        assert!(name(Path::new(&"x".repeat(200))).len() <= 46);
    }

    #[test]
    fn shells_take_words_as_they_are() {
        assert_eq!(quoted("a/b-{part}.gonio"), "'a/b-{part}.gonio'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!(quoted(""), "''");
        assert_eq!(quoted("--spp=4"), "--spp=4");
    }
}
