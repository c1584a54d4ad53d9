//! How the command fails: one `error:` line, one `help:` line, and an exit code.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::process::ExitCode;

/// Why the command ends without success.
#[derive(Debug, PartialEq)]
pub(crate) struct Failure {
    code: u8,
    message: String,
    help: Option<String>,
}

impl Failure {
    /// A verification failed; the report is already printed.
    pub fn verification(message: impl Into<String>) -> Self {
        Self {
            code: 1,
            message: message.into(),
            help: None,
        }
    }
    /// The arguments make no sense.
    pub fn usage(message: impl Into<String>) -> Self {
        Self {
            code: 2,
            message: message.into(),
            help: None,
        }
    }
    /// A file or another input can't be used.
    pub fn input(message: impl Into<String>) -> Self {
        Self {
            code: 3,
            message: message.into(),
            help: None,
        }
    }
    /// The user stopped it.
    pub fn interrupted(message: impl Into<String>) -> Self {
        Self {
            code: 4,
            message: message.into(),
            help: None,
        }
    }
    /// Says how to go on.
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Prints it to standard error.
    pub fn report(&self) -> ExitCode {
        eprintln!("error: {}", self.message);
        if let Some(help) = &self.help {
            eprintln!("help: {help}");
        }
        ExitCode::from(self.code)
    }
}

/// The message of an error with those that caused it, which its own text may leave out.
pub(crate) fn chain(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        let cause_text = cause.to_string();
        if !text.contains(&cause_text) {
            text = format!("{text}: {cause_text}");
        }
        source = cause.source();
    }
    text
}

/// An error that clap found, in our form.
pub(crate) fn of_arguments(error: &clap::Error) -> Failure {
    let rendered = error.render().to_string();
    let mut lines = rendered.lines().map(str::trim);
    let mut message = lines
        .next()
        .unwrap_or_default()
        .trim_start_matches("error: ")
        .to_owned();
    if error.kind() == ErrorKind::MissingRequiredArgument {
        let missing: Vec<&str> = lines.take_while(|line| !line.is_empty()).collect();
        message = format!("missing {}", missing.join(", "));
    }
    if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        message = "a subcommand is missing".into();
    }
    let suggestion = [
        ContextKind::SuggestedSubcommand,
        ContextKind::SuggestedArg,
        ContextKind::SuggestedValue,
    ]
    .into_iter()
    .find_map(|kind| match error.get(kind) {
        Some(ContextValue::String(s)) => Some(s.clone()),
        Some(ContextValue::Strings(s)) => s.first().cloned(),
        _ => None,
    });
    let help = match suggestion {
        Some(word) => format!("did you mean '{word}'?"),
        None => {
            let words: Vec<String> = std::env::args()
                .skip(1)
                .take_while(|word| !word.starts_with('-'))
                .take(2)
                .filter(|word| COMMANDS.contains(&word.as_str()))
                .collect();
            format!(
                "see '{} --help'",
                [vec!["gonio".to_owned()], words].concat().join(" ")
            )
        }
    };
    Failure::usage(message).with_help(help)
}

/// The words that `--help` may follow.
const COMMANDS: [&str; 14] = [
    "render",
    "brdf",
    "env",
    "measure",
    "diff",
    "list",
    "show",
    "eval",
    "check",
    "info",
    "irradiance",
    "exitance",
    "radiance",
    "flux",
];
