//! How the command fails: one `error:` line, one `help:` line, and an exit code.

use super::terminal::{quote, say};
use gonio_brdf::BrdfError;
use gonio_capture::CaptureError;
use gonio_env::EnvError;
use gonio_exec::{ExecError, Fault};
use gonio_ibl::IblError;
use gonio_image::ImageError;
use gonio_render::RenderError;
use gonio_scene::SceneError;
use std::io::ErrorKind;
use std::path::Path;
use std::process::ExitCode;

/// Why the command ends without success.
#[derive(Debug, PartialEq)]
pub(crate) struct Failure {
    code: u8,
    message: String,
    help: Option<String>,
    /// What somebody else said about it, in lines.
    quoted: Vec<String>,
}

impl Failure {
    fn new(code: u8, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
            help: None,
            quoted: Vec::new(),
        }
    }
    /// A verification failed; the report is already printed.
    pub fn verification(message: impl Into<String>) -> Self {
        Self::new(1, message)
    }
    /// The arguments make no sense.
    pub fn usage(message: impl Into<String>) -> Self {
        Self::new(2, message)
    }
    /// A file or another input can't be used.
    pub fn input(message: impl Into<String>) -> Self {
        Self::new(3, message)
    }
    /// The user stopped it.
    pub fn interrupted(message: impl Into<String>) -> Self {
        Self::new(4, message)
    }
    /// The operating system refused to `action` the file `name`.
    pub fn io(name: &str, action: &str, error: &std::io::Error) -> Self {
        Self::input(format!("{name}: cannot {action}: {}", plain(error)))
            .with_help(help_on_file(Path::new(name), error.kind()))
    }
    /// Says how to go on.
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
    /// With words of its help replaced, each pair once.
    pub fn rephrase(mut self, words: &[(&str, &str)]) -> Self {
        if let Some(help) = &mut self.help {
            for (from, to) in words {
                *help = help.replace(from, to);
            }
        }
        self
    }
    /// Says first what the failure is about.
    pub fn about(mut self, what: &str) -> Self {
        self.message = format!("{what}: {}", self.message);
        self
    }
    /// What is wrong, in one line.
    pub fn message(&self) -> &str {
        &self.message
    }
    /// The exit code: 1 a verification failed, 2 usage, 3 input, 4 interrupted.
    pub fn code(&self) -> u8 {
        self.code
    }

    /// Prints it to standard error.
    pub fn report(&self) -> ExitCode {
        for line in &self.quoted {
            quote(line);
        }
        say("error", &self.message);
        if let Some(help) = &self.help {
            say("help", help);
        }
        ExitCode::from(self.code())
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        let message = chain(&error);
        let help = error.help();
        match error {
            SceneError::Environment(e) => e.into(),
            SceneError::Brdf(e) => e.into(),
            SceneError::Image { what, source } => Self::from(source).about(&what),
            SceneError::UnknownMaterial { .. } | SceneError::UnknownCamera { .. } => {
                let mut failure = Self::usage(message);
                failure.help = help;
                failure
            }
            SceneError::Io { path, source } => {
                Self::input(message).with_help(help_on_file(&path, source.kind()))
            }
            SceneError::Description { .. } => {
                Self::input(message).with_help(help.unwrap_or("correct this line".into()))
            }
            SceneError::Unsupported { path, .. } if !path.exists() => {
                let near = nearest_file(&path).map(|near| did_you_mean(&near));
                Self {
                    help: near.or(help),
                    ..Self::input(message)
                }
            }
            SceneError::Limit { .. } => Self::input(message)
                .with_help("the file is damaged, or has to be divided into smaller ones"),
            SceneError::Format { .. } | SceneError::Mesh { .. } => {
                Self::input(message).with_help(help.unwrap_or(DAMAGED.into()))
            }
            _ => Self::input(message).with_help(help.unwrap_or("correct the scene".into())),
        }
    }
}

impl From<EnvError> for Failure {
    fn from(error: EnvError) -> Self {
        let message = chain(&error);
        let help = error.help();
        match error {
            EnvError::Image(e) => e.into(),
            EnvError::UnknownLayout { .. }
            | EnvError::UnknownConvention { .. }
            | EnvError::UnknownWord { .. }
            | EnvError::Parameter { .. } => Self::usage(message).with_help(help.unwrap_or(
                "an environment is a picture, uniform:1, uniform:r/g/b or sky:elevation=40".into(),
            )),
            EnvError::NotFound { file, suggestion } => match (suggestion, nearest_file(&file)) {
                (None, Some(near)) => Self::input(message).with_help(did_you_mean(&near)),
                _ => Self {
                    help,
                    ..Self::input(message)
                },
            },
            _ => Self::input(message)
                .with_help(help.unwrap_or("'gonio env info --help' says what is read".into())),
        }
    }
}

impl From<CaptureError> for Failure {
    fn from(error: CaptureError) -> Self {
        let message = chain(&error);
        let help = error.help();
        match error {
            CaptureError::Image(e) => e.into(),
            CaptureError::Environment(e) => e.into(),
            CaptureError::Parameter { .. } => {
                Self::usage(message).with_help("'gonio env capture --help' explains each option")
            }
            _ => Self {
                help: help.map(str::to_owned),
                ..Self::input(message)
            },
        }
    }
}

impl From<BrdfError> for Failure {
    fn from(error: BrdfError) -> Self {
        let message = chain(&error);
        let help = error.help();
        match error {
            BrdfError::Io { path, source } => {
                Self::input(message).with_help(help_on_file(&path, source.kind()))
            }
            BrdfError::Format { path, .. } if path.is_dir() => {
                Self::input(message).with_help("name one of the files in the folder")
            }
            BrdfError::Format { .. } => Self::input(message).with_help(DAMAGED),
            BrdfError::Shader(error) => {
                let quoted = error.snippet().unwrap_or_default();
                Self {
                    quoted: quoted.lines().map(str::to_owned).collect(),
                    ..Self::input(message)
                }
                .with_help(
                    help.unwrap_or("the book's page on shaders says what a shader may hold".into()),
                )
            }
            BrdfError::Interrupted => {
                Self::interrupted(message).with_help("nothing was written: run it again")
            }
            BrdfError::Parameter { model, .. } => Self::usage(message)
                .with_help(help.unwrap_or(format!("see 'gonio brdf show {model}'"))),
            _ => Self::usage(message)
                .with_help(help.unwrap_or("'gonio brdf list' names the models".into())),
        }
    }
}

impl From<IblError> for Failure {
    fn from(error: IblError) -> Self {
        let message = chain(&error);
        let help = error.help();
        match error {
            IblError::Environment(e) => e.into(),
            IblError::Brdf(e) => e.into(),
            IblError::Image(e) => e.into(),
            IblError::Parameter { .. } | IblError::Model { .. } => {
                Self::usage(message).with_help(help.unwrap_or("--help explains each option".into()))
            }
            _ => Self::input(message).with_help(help.unwrap_or("write elsewhere".into())),
        }
    }
}

impl From<ExecError> for Failure {
    fn from(error: ExecError) -> Self {
        let message = plain(&error);
        let failure = match error.fault {
            Fault::EmptyCommand | Fault::OpenQuote => {
                Self::usage(format!("--exec '{}': {}", error.command, error.fault))
            }
            _ => Self::input(message),
        };
        Self {
            quoted: error.stderr.clone(),
            ..failure.with_help(error.help())
        }
    }
}

impl From<ImageError> for Failure {
    fn from(error: ImageError) -> Self {
        let message = chain(&error);
        match error {
            ImageError::Io {
                file,
                action,
                source,
            } => Self::io(&file, action, &source),
            ImageError::Format { .. } => Self::input(message).with_help(DAMAGED),
            ImageError::Limit { .. } => {
                Self::input(message).with_help("the file is damaged, or has to be made smaller")
            }
            ImageError::Unsupported { .. } => Self::input(message).with_help("convert the picture"),
            _ => Self::input(message),
        }
    }
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        let message = chain(&error);
        match error {
            RenderError::Image(e) => e.into(),
            RenderError::Io {
                path,
                action,
                source,
            } => Self::io(&path.display().to_string(), action, &source),
            RenderError::Part { .. } => {
                Self::input(message).with_help("render this part again, or name the right file")
            }
            RenderError::Merge { .. } => Self::input(message)
                .with_help("'gonio info FILE' tells which samples of what a part has"),
            RenderError::Limit { .. } => Self::usage(message).with_help("choose a smaller --size"),
            _ => Self::usage(message).with_help("--help explains each option"),
        }
    }
}

const DAMAGED: &str = "the file is damaged, or not what its name says: export or download it again";

/// The message of an error with those that caused it, which its own text may leave out.
pub(crate) fn chain(error: &dyn std::error::Error) -> String {
    let mut text = plain(error);
    let mut source = error.source();
    while let Some(cause) = source {
        let cause_text = plain(cause);
        if !text.contains(&cause_text) {
            text = format!("{text}: {cause_text}");
        }
        source = cause.source();
    }
    text
}

/// An error's text without the operating system's number of it.
fn plain(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    while let Some(start) = text.find(" (os error ") {
        let Some(length) = text[start..].find(')') else {
            break;
        };
        text.replace_range(start..=start + length, "");
    }
    text
}

/// What to do about a file that can't be opened, read or written.
fn help_on_file(path: &Path, kind: ErrorKind) -> String {
    match kind {
        ErrorKind::NotFound => match nearest_file(path) {
            Some(near) => did_you_mean(&near),
            None => "check the path: there is no file of this name".into(),
        },
        ErrorKind::PermissionDenied => "check the permissions".into(),
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            "free some space, or write to another disk".into()
        }
        ErrorKind::IsADirectory => "name a file in this folder".into(),
        _ => "check the path and the permissions".into(),
    }
}

/// The question after a slip of the pen.
pub(crate) fn did_you_mean(word: &str) -> String {
    format!("did you mean '{word}'?")
}

/// The candidate that `word` was probably meant to be: at most a quarter of it, and at most three letters, differ.
pub(crate) fn nearest<S: AsRef<str>>(
    word: &str,
    candidates: impl IntoIterator<Item = S>,
) -> Option<String> {
    let most = (word.chars().count() / 4).clamp(1, 3);
    candidates
        .into_iter()
        .map(|c| (strsim::damerau_levenshtein(word, c.as_ref()), c))
        .filter(|(distance, _)| *distance <= most)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, c)| c.as_ref().to_owned())
}

/// Names of a folder that are compared at most.
const MOST_FILES: usize = 10_000;

/// The file beside where `path` should be whose name is most like it.
fn nearest_file(path: &Path) -> Option<String> {
    let folder = path.parent()?;
    let here = folder.as_os_str().is_empty();
    let files = std::fs::read_dir(if here { Path::new(".") } else { folder }).ok()?;
    let names = files
        .take(MOST_FILES)
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let near = nearest(path.file_name()?.to_str()?, names)?;
    Some(folder.join(near).display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exit_codes() {
        let codes = [
            Failure::verification("").code(),
            Failure::usage("").code(),
            Failure::input("").code(),
            Failure::interrupted("").code(),
        ];
        assert_eq!(codes, [1, 2, 3, 4]);
    }

    #[test]
    fn messages_have_no_numbers_of_the_operating_system() {
        let error = std::io::Error::from_raw_os_error(2);
        assert!(error.to_string().contains("os error"));
        assert!(!chain(&error).contains("os error"));
    }

    #[test]
    fn slips_of_the_pen() {
        let names = ["scene.toml", "sunset.hdr"];
        assert_eq!(nearest("scen.toml", names), Some("scene.toml".into()));
        assert_eq!(nearest("scene.tmol", names), Some("scene.toml".into()));
        assert_eq!(nearest("room.toml", names), None);
        assert_eq!(nearest("", names), None);
    }
}
