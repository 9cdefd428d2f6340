//! What failed, where, and what is to be done next?
//!
//! Messages have one form, `where: what; what to do next`, and may have causes behind them; so
//! every error gives these three parts, whatever raised it.

mod causes;
mod message;

use crate::report::called::Called;
use crate::report::visible::bounded;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use message::Message;
pub(crate) use message::without_numbers;
use serde::Serialize;
use std::borrow::Cow;

/// The parts of a failure, as `--json` prints them.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Fault {
    /// What is wrong, in a sentence.
    what: String,
    /// The file and the place in it, the option, or else the command.
    #[serde(rename = "where")]
    place: String,
    /// What to do about it.
    next: String,
}

impl Fault {
    /// The parts of what made a command fail.
    pub(crate) fn of(error: &anyhow::Error, called: &Called) -> Self {
        let Message { place, what, next } = Message::of(error, &called.words);
        let unknown = || match &place {
            Some(place) if !place.starts_with("--") => {
                format!("put that right there; {}", help(called))
            }
            _ => help(called),
        };
        let next = next
            .or_else(|| causes::advice(error).map(str::to_owned))
            .unwrap_or_else(unknown);
        Self {
            what,
            place: place.unwrap_or_else(|| called.command.clone()),
            next,
        }
        .bounded()
    }

    /// None of its parts is longer than a message is.
    fn bounded(self) -> Self {
        let of = |text: String| {
            let short = match bounded(&text) {
                Cow::Borrowed(_) => None,
                Cow::Owned(short) => Some(short),
            };
            short.unwrap_or(text)
        };
        Self {
            what: of(self.what),
            place: of(self.place),
            next: of(self.next),
        }
    }

    /// The parts of a command line that cannot be read.
    pub(crate) fn of_usage(error: &clap::Error, called: &Called) -> Self {
        let text = error.to_string();
        let tips = text
            .lines()
            .filter_map(|line| line.trim().strip_prefix("tip: "));
        let tips: Vec<&str> = tips.collect();
        let word = wrong_word(error);
        let is_group = error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
        // Every command knows `--json`; only what groups commands does not.
        let is_misplaced =
            error.kind() == ErrorKind::UnknownArgument && word.as_deref() == Some("--json");
        let what = if is_group {
            "no command is given".to_owned()
        } else if is_misplaced {
            "no command stands before '--json'".to_owned()
        } else {
            let first = text.split("\n\n").next().unwrap_or_default();
            let first = first.strip_prefix("error: ").unwrap_or(first);
            first.split_whitespace().collect::<Vec<_>>().join(" ")
        };
        Self {
            what,
            place: word
                .filter(|_| !(is_group || is_misplaced))
                .unwrap_or_else(|| called.command.clone()),
            next: match tips.is_empty() {
                true => help(called),
                false => tips.join("; "),
            },
        }
        .bounded()
    }
}

/// What to do where nothing better is known.
fn help(called: &Called) -> String {
    format!("see `{} --help`", called.command)
}

/// The option or word that an error is about.
fn wrong_word(error: &clap::Error) -> Option<String> {
    let kinds = [ContextKind::InvalidArg, ContextKind::InvalidSubcommand];
    kinds.into_iter().find_map(|kind| match error.get(kind)? {
        ContextValue::String(word) => Some(word.clone()),
        ContextValue::Strings(words) => Some(words.join(", ")),
        _ => None,
    })
}

/// The whole error for people: each cause once, and what to do where the messages do not say but
/// their cause does.
pub(crate) fn told(error: &anyhow::Error) -> String {
    let text = message::whole(error);
    match causes::advice(error) {
        Some(advice) if !message::advises(error) => format!("{text}; {advice}"),
        _ => text,
    }
}
