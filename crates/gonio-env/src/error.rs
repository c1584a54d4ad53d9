//! [`EnvError`], what can go wrong with an environment.

use crate::{Convention, Layout};
use std::path::PathBuf;

/// Why an environment could not be made.
///
/// The message says what is wrong and where; [`EnvError::help`] says how to go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EnvError {
    /// The file could not be read as a picture.
    #[error(transparent)]
    Image(#[from] gonio_image::ImageError),
    /// The file is not there.
    #[error("{}: no such file", file.display())]
    NotFound {
        /// The file.
        file: PathBuf,
        /// A word that was probably meant, if the text resembles one.
        suggestion: Option<&'static str>,
    },
    /// A texel is NaN, infinite or negative.
    #[error(
        "{}: texel ({x}, {y}) has {channel} = {value}, expected a finite number ≥ 0 ({count} such texel(s) in all)",
        name(file)
    )]
    Texel {
        /// The file, if the picture came from one.
        file: Option<PathBuf>,
        /// Column, from 0 at the left.
        x: usize,
        /// Row, from 0 at the top.
        y: usize,
        /// R, G or B.
        channel: char,
        /// What stands there.
        value: f32,
        /// How many texels are like this.
        count: u64,
    },
    /// The picture's size does not fit its layout.
    #[error("{}: {width} × {height} pixels, expected {expected}", name(file))]
    Shape {
        /// The file, if the picture came from one.
        file: Option<PathBuf>,
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// What was expected.
        expected: &'static str,
    },
    /// A file that should be a face of a cube is no square of the others' size.
    #[error("{}: {width} × {height} pixels, expected a face of {expected} × {expected}", file.display())]
    Faces {
        /// The file.
        file: PathBuf,
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// The side that was expected.
        expected: usize,
    },
    /// A folder, or a name with `{face}` in it, that does not lead to six faces.
    #[error("{}: {found}, expected the six faces of a cube", place.display())]
    MissingFaces {
        /// The folder or the name.
        place: PathBuf,
        /// What is there instead.
        found: String,
    },
    /// The layout can't be told from the picture.
    #[error(
        "{}: {width} × {height} pixels{}: the layout can't be told from the picture",
        name(file),
        if *disc { ", black outside a disc" } else { "" }
    )]
    AmbiguousLayout {
        /// The file, if the picture came from one.
        file: Option<PathBuf>,
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Whether the picture is square and black outside the inscribed disc, so an angular map or a mirrored ball.
        disc: bool,
    },
    /// A word that names no layout.
    #[error("unknown layout \"{found}\"")]
    UnknownLayout {
        /// The word.
        found: String,
    },
    /// A word that names no convention.
    #[error("unknown convention \"{found}\"")]
    UnknownConvention {
        /// The word.
        found: String,
        /// The convention that was probably meant.
        suggestion: Option<&'static str>,
    },
    /// A key that a description does not have.
    #[error("unknown key \"{found}\" of {of}")]
    UnknownWord {
        /// What is described.
        of: &'static str,
        /// The key.
        found: String,
        /// A key that was probably meant.
        suggestion: Option<&'static str>,
        /// Every key.
        known: &'static [&'static str],
    },
    /// A number out of range.
    #[error("{name} = {found}, expected {expected}")]
    Parameter {
        /// What the number is.
        name: &'static str,
        /// What was given.
        found: String,
        /// What is allowed.
        expected: &'static str,
    },
}

fn name(file: &Option<PathBuf>) -> String {
    match file {
        Some(file) => file.display().to_string(),
        None => "environment picture".to_owned(),
    }
}

/// The word of `candidates` that `word` was probably meant to be: within two edits, ignoring case.
pub(crate) fn suggest(word: &str, candidates: &[&'static str]) -> Option<&'static str> {
    let word = word.to_ascii_lowercase();
    candidates
        .iter()
        .map(|c| (strsim::damerau_levenshtein(&word, c), *c))
        .filter(|(distance, _)| *distance <= 2)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, c)| c)
}

impl EnvError {
    /// How to go on, as one sentence for a `help:` line, where there is a way.
    pub fn help(&self) -> Option<String> {
        match self {
            EnvError::Image(_) => None,
            EnvError::NotFound { suggestion, .. } => Some(match suggestion {
                Some(word) => format!("did you mean \"{word}\"?"),
                None => "an environment is \"uniform:1\", \"uniform:r/g/b\", \"sky:elevation=40\", or a picture (.hdr, .exr, .png, .jpg, .tif, .ktx2, .dds)".to_owned(),
            }),
            EnvError::Texel { .. } => Some(
                "replace them: `--env-sanitize` makes NaN and negative 0, infinite the largest finite value; `--repair` takes \
                 their neighbours"
                    .to_owned(),
            ),
            EnvError::Shape { .. } => None,
            EnvError::Faces { .. } => Some("the six faces of a cube are squares of one size".to_owned()),
            EnvError::MissingFaces { .. } => Some(
                "they are px.exr … nz.exr (or .hdr, .png, .jpg, .tif, all alike), posx … negz, or right, left, top, bottom, \
                 front, back; or name one file that shows everything"
                    .to_owned(),
            ),
            EnvError::AmbiguousLayout { disc: true, .. } => {
                Some("say which it is: `--env-layout angular` or `--env-layout mirror-ball`".to_owned())
            }
            EnvError::AmbiguousLayout { .. } => Some(
                "a lat-long panorama is twice as wide as high; say what this is: `--env-layout lat-long`, `angular` or \
                 `mirror-ball`, `octahedral`, `equal-area-octahedral`, `dual-paraboloid`, or a cube: 4:3, 3:4, 6:1 or 1:6"
                    .to_owned(),
            ),
            EnvError::UnknownLayout { found } => {
                let names = Layout::ALL.map(Layout::name);
                Some(match suggest(found, &names) {
                    Some(word) => format!("did you mean \"{word}\"? Layouts are {}", names.join(", ")),
                    None => format!("layouts are {}", names.join(", ")),
                })
            }
            EnvError::UnknownConvention { suggestion, .. } => {
                let names = Convention::ALL.map(Convention::name).join(", ");
                Some(match suggestion {
                    Some(word) => format!("did you mean \"{word}\"? Conventions are {names}"),
                    None => format!("conventions are {names}"),
                })
            }
            EnvError::UnknownWord {
                suggestion, known, ..
            } => Some(match suggestion {
                Some(word) => format!("did you mean \"{word}\"? Keys are {}", known.join(", ")),
                None => format!("keys are {}", known.join(", ")),
            }),
            EnvError::Parameter { .. } => None,
        }
    }
}
