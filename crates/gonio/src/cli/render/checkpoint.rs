//! Checkpoints: a rendering that can go on after whatever ended it.

use crate::cli::failure::{Failure, chain};
use crate::cli::parse;
use crate::cli::terminal::warn;
use gonio_render::part::{self, Exposure, Label};
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// How a rendering is made to survive.
#[derive(clap::Args)]
pub(super) struct CheckpointArguments {
    /// Keep all samples so far in this file, from time to time and at the end: what --resume goes on from; {part} stands for the K of --part; removed once a part is written
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// How often the checkpoint is written
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = parse::duration, allow_hyphen_values = true, requires = "checkpoint")]
    checkpoint_every: Duration,
    /// Go on from the checkpoint, if there is one: the picture is the one without interruption, to the bit
    #[arg(long, requires = "checkpoint")]
    resume: bool,
}

/// The file of a rendering's samples so far.
pub(super) struct Checkpoint<'a> {
    path: PathBuf,
    every: Duration,
    resume: bool,
    label: &'a Label,
    last: Instant,
}

impl<'a> Checkpoint<'a> {
    /// In the file `path`.
    pub fn new(path: PathBuf, arguments: &CheckpointArguments, label: &'a Label) -> Self {
        Self {
            path,
            every: arguments.checkpoint_every,
            resume: arguments.resume,
            label,
            last: Instant::now(),
        }
    }

    /// Writes it if it is time. A failure is only a warning: the rendering is worth more, and the older checkpoint stays.
    pub fn keep(&mut self, exposure: &Exposure) {
        if self.last.elapsed() < self.every {
            return;
        }
        if let Err(failure) = self.write(exposure) {
            warn(&format!(
                "{}; the checkpoint before it stays, and the rendering goes on",
                failure.message()
            ));
        }
        // From its end on: writing a large one to a slow disk must not be all that is done.
        self.last = Instant::now();
    }

    /// Writes it.
    pub fn write(&self, exposure: &Exposure) -> Result<(), Failure> {
        Ok(part::write_alone(&self.path, self.label, exposure)?)
    }

    /// Removes it, if it is there.
    pub fn remove(&self) -> Result<(), Failure> {
        match std::fs::remove_file(&self.path) {
            Err(e) if e.kind() != ErrorKind::NotFound => Err(Failure::io(
                &self.path.display().to_string(),
                "remove it",
                &e,
            )),
            _ => Ok(()),
        }
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The samples of an earlier run, to go on from; nothing if there are none.
    pub fn resume(&self, range: &Range<u32>) -> Result<Option<Exposure>, Failure> {
        let name = self.path.display();
        // One that can't be looked at is no missing one.
        let exists = self
            .path
            .try_exists()
            .map_err(|e| Failure::io(&name.to_string(), "look for it", &e))?;
        if !self.resume {
            return match exists {
                false => Ok(None),
                true => Err(
                    Failure::usage(format!("{name}: there is a checkpoint already"))
                        .with_help("--resume goes on from it; to begin anew, remove it"),
                ),
            };
        }
        if !exists {
            return Ok(None);
        }
        let opened = part::open(&self.path)?;
        let found = opened.header.samples();
        if let Some(mismatch) = opened.header.identity.mismatch(&self.label.identity) {
            return Err(
                Failure::input(format!("{name}: a checkpoint of {mismatch}")).with_help(
                    "go on with the command that it was written by, or remove it to begin anew",
                ),
            );
        }
        if found.start != range.start || found.end > range.end {
            return Err(Failure::input(format!(
                "{name}: a checkpoint of the samples {}:{}, expected some of {}:{} from the first on",
                found.start, found.end, range.start, range.end
            ))
            .with_help("ask for at least as many samples, or remove it to begin anew"));
        }
        Ok(Some(opened.read()?))
    }
}

/// Whether a part that is there already has these samples of the same picture, whole; if not, a word on why.
pub(super) fn is_there(
    path: &Path,
    label: &Label,
    range: &Range<u32>,
) -> Result<(), Option<String>> {
    if !path.try_exists().unwrap_or(true) {
        return Err(None);
    }
    let why = |text: String| Some(format!("{} is rendered again: {text}", path.display()));
    let opened = part::open(path).map_err(|e| why(chain(&e)))?;
    let header = &opened.header;
    if let Some(mismatch) = header.identity.mismatch(&label.identity) {
        return Err(why(format!("it is of {mismatch}")));
    }
    if header.samples() != *range || header.of != label.of {
        return Err(why(format!(
            "it has the samples {}:{} of {}",
            header.first,
            header.end,
            header.of.map_or("an open number".into(), |n| n.to_string())
        )));
    }
    // The whole file against its hash.
    opened.read().map(|_| ()).map_err(|e| why(chain(&e)))
}
