//! Arguments that make no sense, in the command's own form of an error.

use super::failure::{Failure, did_you_mean, nearest};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, CommandFactory};

/// An error that clap found.
pub(crate) fn of_arguments<C: CommandFactory>(error: &clap::Error) -> Failure {
    let command = C::command();
    // Words that are not Unicode are no subcommands, and no reason to panic.
    let words: Vec<String> = std::env::args_os()
        .skip(1)
        .map(|word| word.to_string_lossy().into_owned())
        .collect();
    Failure::usage(message(error)).with_help(help(error, &command, &words))
}

fn message(error: &clap::Error) -> String {
    let context = |kind| match error.get(kind) {
        Some(ContextValue::String(s)) => s.as_str(),
        _ => "",
    };
    match error.kind() {
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand | ErrorKind::MissingSubcommand => {
            return "a subcommand is missing".into();
        }
        ErrorKind::InvalidSubcommand => {
            return format!(
                "unknown subcommand '{}'",
                context(ContextKind::InvalidSubcommand)
            );
        }
        ErrorKind::UnknownArgument => {
            let word = context(ContextKind::InvalidArg);
            return match word.starts_with('-') {
                true => format!("unknown option '{word}'"),
                false => format!("one word too many: '{word}'"),
            };
        }
        _ => {}
    }
    let rendered = error.render().to_string();
    let mut lines = rendered.lines().map(str::trim);
    let first = lines.next().unwrap_or_default();
    if error.kind() == ErrorKind::MissingRequiredArgument {
        let missing: Vec<&str> = lines.take_while(|line| !line.is_empty()).collect();
        return format!("missing: {}", missing.join(", "));
    }
    first.trim_start_matches("error: ").to_owned()
}

fn help(error: &clap::Error, command: &Command, words: &[String]) -> String {
    let suggestion = [
        ContextKind::SuggestedArg,
        ContextKind::SuggestedSubcommand,
        ContextKind::SuggestedValue,
    ]
    .into_iter()
    .find_map(|kind| match error.get(kind) {
        Some(ContextValue::String(s)) => Some(s.clone()),
        // The likeliest comes last.
        Some(ContextValue::Strings(s)) => s.last().cloned(),
        _ => None,
    });
    if error.kind() == ErrorKind::InvalidSubcommand
        && let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand)
        && let Some(path) = subcommand_elsewhere(command, word)
    {
        return did_you_mean(&path);
    }
    if let Some(word) = suggestion {
        return did_you_mean(&word);
    }
    if let Some(ContextValue::Strings(values)) = error.get(ContextKind::ValidValue)
        && !values.is_empty()
    {
        let given = match error.get(ContextKind::InvalidValue) {
            Some(ContextValue::String(given)) => given.as_str(),
            _ => "",
        };
        return match nearest(given, values) {
            Some(near) => did_you_mean(&near),
            None => format!("it is one of {}", values.join(", ")),
        };
    }
    format!("see '{} --help'", path_of(command, words).join(" "))
}

/// `gonio brdf list` for the word `list`: where the subcommands of this name are, one level down.
fn subcommand_elsewhere(command: &Command, word: &str) -> Option<String> {
    let all: Vec<String> = command
        .get_subcommands()
        .filter_map(|group| {
            let found = group.find_subcommand(word)?;
            Some(format!("gonio {} {}", group.get_name(), found.get_name()))
        })
        .collect();
    (!all.is_empty()).then(|| all.join("' or '"))
}

/// The command's name and the subcommands that the words begin with.
fn path_of<'a>(command: &'a Command, words: &[String]) -> Vec<&'a str> {
    let mut path = vec![command.get_name()];
    let mut here = command;
    for word in words {
        match here.find_subcommand(word) {
            Some(next) => {
                path.push(next.get_name());
                here = next;
            }
            None => break,
        }
    }
    path
}
