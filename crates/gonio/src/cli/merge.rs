//! `gonio merge`.

use super::destination;
use super::failure::Failure;
use super::progress;
use super::render::product::{PictureArguments, is_part, write_all};
use super::render::strict;
use super::summary::{faulty_shares, rejected_in_words};
use super::terminal::{print, print_json, warn};
use gonio_render::Parts;
use indicatif::{ProgressBar, ProgressStyle};
use std::path::PathBuf;
use std::time::Duration;

#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    gonio merge samples-*.gonio -o room.exr -o room.png\n  \
    gonio merge part0.gonio part1.gonio -o both.gonio\n\n\
    The picture is the one that a single machine takes, to the bit, whatever the parts and their order. A picture needs all parts; some that\n\
    follow one another make a part again. A checkpoint is a part, too. One film is in memory, whatever the number of parts.")]
pub(super) struct Arguments {
    /// Parts of one picture, in any order
    #[arg(required = true)]
    parts: Vec<PathBuf>,
    /// Where to write: .exr, .hdr, .png or .gonio; may be repeated
    #[arg(short, long = "output", value_name = "FILE", required = true)]
    output: Vec<PathBuf>,
    #[command(flatten)]
    picture: PictureArguments,
    /// Wait until all parts are there: for systems whose jobs don't wait for one another
    #[arg(long)]
    wait: bool,
    /// Exit with 1 if a sample was negative or not finite
    #[arg(long)]
    strict: bool,
    /// Nothing but warnings and errors
    #[arg(short, long)]
    quiet: bool,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
}

/// How often it is looked whether parts are there.
const LOOK_EVERY: Duration = Duration::from_secs(1);

/// Returns when all files are there. Parts appear whole, so they need not be read for it.
fn wait_for(paths: &[PathBuf]) -> Result<(), Failure> {
    progress::listen();
    let mut missing: Vec<&PathBuf> = paths.iter().collect();
    loop {
        missing.retain(|path| !path.exists());
        let Some(first) = missing.first() else {
            return Ok(());
        };
        if progress::stop_requested() {
            return Err(Failure::interrupted(format!(
                "interrupted while {} parts are missing, the first of them {}",
                missing.len(),
                first.display()
            ))
            .with_help("the same command waits for them again"));
        }
        std::thread::sleep(LOOK_EVERY);
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    for path in &arguments.output {
        destination::check_product(path)?;
    }
    if arguments.wait {
        wait_for(&arguments.parts)?;
    }
    let parts = Parts::of(&arguments.parts)?;
    arguments.picture.check(parts.kept().reweighted)?;
    if !arguments.output.iter().all(|path| is_part(path)) {
        parts.require_whole()?;
    }
    let bar = match arguments.quiet {
        true => ProgressBar::hidden(),
        false => ProgressBar::new(arguments.parts.len() as u64),
    };
    if let Ok(style) = ProgressStyle::with_template("{bar:18.cyan/dim} {pos} of {len} parts") {
        bar.set_style(style.progress_chars("━━─"));
    }
    let whole = parts.add(|done| bar.set_position(done as u64))?;
    bar.finish_and_clear();
    let label = parts.label();
    let (written, failure) = write_all(&arguments.output, &label, &whole, &arguments.picture);
    let film = &whole.film;
    let rejected = film.rejected();
    if let Some(first) = &rejected.first {
        warn(&format!(
            "{} samples were negative or not finite and count as black; the first: {}",
            rejected.count,
            rejected_in_words(first, &label.names.materials)
        ));
    }
    if let Some(text) = faulty_shares(rejected) {
        warn(&text);
    }
    let samples = whole.samples.end - whole.samples.start;
    if arguments.json {
        print_json(&serde_json::json!({
            "outputs": written,
            "parts": arguments.parts.len(),
            "width": film.width(),
            "height": film.height(),
            "samples_per_pixel": samples,
            "samples": [whole.samples.start, whole.samples.end],
            "seconds": whole.elapsed.as_secs_f64(),
            "rays": whole.rays.total(),
            "noise": Some(film.noise()).filter(|n| n.is_finite()),
            "scene_hash": label.identity.get("scene"),
            "rejected_samples": rejected.count,
        }))?;
    } else if !arguments.quiet {
        let mut text = format!(
            "{}×{} pixels, samples {}:{} of {} parts\n",
            film.width(),
            film.height(),
            whole.samples.start,
            whole.samples.end,
            arguments.parts.len()
        );
        for path in written {
            text += &format!("wrote {}\n", path.display());
        }
        print(&text)?;
    }
    match failure {
        Some(failure) => Err(failure),
        None => strict(arguments.strict, rejected),
    }
}
