//! Which part of a message says where, which what, and which what to do next?

use foveal_core::units::one_line;
use std::path::Path;

/// A message, in its parts.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Message {
    pub(super) place: Option<String>,
    pub(super) what: String,
    pub(super) next: Option<String>,
}

impl Message {
    /// The parts of an error and its causes; `words` are those of the command line, which places
    /// are known by.
    pub(super) fn of(error: &anyhow::Error, words: &[String]) -> Self {
        let (mut what, mut next) = (Vec::new(), Vec::new());
        for link in links(error, in_a_line) {
            let (said, advice) = advice_apart(&link);
            what.push(said.to_owned());
            next.extend(advice);
        }
        let (place, what) = place_apart(&what.join(": "), words);
        Self {
            place,
            what,
            next: (!next.is_empty()).then(|| next.join("; ")),
        }
    }
}

/// An error and its causes in one text, each once.
pub(super) fn whole(error: &anyhow::Error) -> String {
    links(error, drawn).join(": ")
}

/// Whether an error or one of its causes says what to do next.
pub(super) fn advises(error: &anyhow::Error) -> bool {
    links(error, in_a_line)
        .iter()
        .any(|link| advice_apart(link).1.is_some())
}

/// A text without the system's numbers of errors, whose words stand before them.
pub(crate) fn without_numbers(text: &str) -> String {
    const BEFORE: &str = " (os error ";
    let mut parts = text.split(BEFORE);
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let number = part.split_once(')');
        let is_number = |it: &str| !it.is_empty() && it.bytes().all(|it| it.is_ascii_digit());
        match number.filter(|(number, _)| is_number(number)) {
            Some((_, rest)) => plain.push_str(rest),
            None => plain = [&plain, BEFORE, part].concat(),
        }
    }
    plain
}

/// A cause, which may come from elsewhere.
type Cause = dyn std::error::Error;

/// The messages of an error and its causes, without those that another has said already.
fn links(error: &anyhow::Error, said: fn(&&Cause) -> String) -> Vec<String> {
    let mut links: Vec<String> = Vec::new();
    for cause in error.chain().map(|cause| without_numbers(&said(&cause))) {
        if !links.iter().any(|link| link.contains(&cause)) {
            links.push(cause);
        }
    }
    links
}

/// What a cause says, with the drawing of the place that is wrong in a TOML file. Keys that it
/// quotes may hold line ends, which are no lines of the message.
fn drawn(cause: &&Cause) -> String {
    let text = cause.to_string();
    let quoted = cause
        .downcast_ref::<toml::de::Error>()
        .map(|it| it.message());
    match quoted.and_then(|quoted| text.trim_end().strip_suffix(quoted)) {
        Some(drawing) => format!("{drawing}{}", one_line(quoted.unwrap_or_default())),
        None => text,
    }
}

/// What a cause says, without the drawing of the place that is wrong in a TOML file.
fn in_a_line(cause: &&Cause) -> String {
    let text = cause.to_string();
    match cause.downcast_ref::<toml::de::Error>() {
        Some(wrong) => {
            let place = text.lines().next().unwrap_or_default();
            format!("{place}: {}", one_line(wrong.message()))
        }
        None => text,
    }
}

/// What a message says before and after its last semicolon. Lines that are indented go on with a
/// list; another line is advice too.
fn advice_apart(message: &str) -> (&str, Option<String>) {
    let mut lines = message.lines();
    let first = lines.next().unwrap_or_default();
    let rest: Vec<&str> = lines.filter(|line| !line.starts_with(' ')).collect();
    let (what, advice) = match first.rsplit_once("; ") {
        // A semicolon within parentheses divides no sentence.
        Some((what, advice)) if advice.matches(')').count() == advice.matches('(').count() => {
            (what, Some(advice))
        }
        _ => (first, None),
    };
    let advice: Vec<&str> = advice.into_iter().chain(rest).collect();
    (what, (!advice.is_empty()).then(|| advice.join("; ")))
}

/// What stands before the colons of a message, as far as it is a place, and the rest.
fn place_apart(message: &str, words: &[String]) -> (Option<String>, String) {
    let (mut places, mut rest) = (Vec::new(), message);
    while let Some((before, after)) = rest.split_once(": ") {
        let first = places.is_empty();
        if !(is_numbered(before) || first && is_named(before, words)) {
            break;
        }
        places.push(before);
        rest = after;
    }
    if !places.is_empty() {
        return (Some(places.join(": ")), rest.to_owned());
    }
    let place = if message.starts_with("--") {
        message
            .split([' ', ':', ',', ';'])
            .next()
            .map(str::to_owned)
    } else {
        let mentioned = words.iter().filter(|word| mentions(message, word));
        mentioned.max_by_key(|word| word.len()).cloned()
    };
    (place, message.to_owned())
}

/// A place within a file, as `line 3, column yaw_deg`.
fn is_numbered(text: &str) -> bool {
    let mut words = text.split([' ', ',']);
    let kind = words.next().unwrap_or_default();
    let numbered = words.next().is_some_and(|word| word.parse::<u64>().is_ok());
    numbered && matches!(kind, "line" | "row" | "frame" | "picture" | "level")
}

/// An option, a word of the command line, something within a folder that is one, or whatever lies
/// in the file system; a number may follow, as `gaze.csv, line 3`.
fn is_named(text: &str, words: &[String]) -> bool {
    let name = match text.split_once(", ") {
        Some((name, within)) if is_numbered(within) => name,
        _ => text,
    };
    let within = |word: &String| {
        let inside = name.strip_prefix(word.as_str());
        inside.is_some_and(|inside| inside.is_empty() || inside.starts_with(['/', '.']))
    };
    let part = |word: &String| word.len() > name.len() && word.ends_with(&format!(":{name}"));
    let option = name.starts_with("--") && !name.contains(" is ");
    option
        || Path::new(name).is_absolute()
        || Path::new(name).exists()
        || words.iter().any(|word| within(word) || part(word))
}

/// Whether a message names a word of the command line; short ones may stand there by chance.
fn mentions(message: &str, word: &str) -> bool {
    word.len() > 3 && !word.starts_with('-') && message.contains(word)
}

#[cfg(test)]
mod tests {
    use super::{Message, whole};
    use anyhow::anyhow;

    fn parts(error: &anyhow::Error) -> [Option<String>; 3] {
        let words = ["info", "my clip.foveal", "trace:gaze.csv", "out"].map(str::to_owned);
        let Message { place, what, next } = Message::of(error, &words);
        [place, Some(what), next]
    }

    fn said<const N: usize>(texts: [&str; N]) -> [Option<String>; N] {
        texts.map(|text| (!text.is_empty()).then(|| text.to_owned()))
    }

    #[test]
    fn a_message_falls_into_where_what_and_next() {
        for (message, expected) in [
            (
                "my clip.foveal: has no cues; prepare it again",
                ["my clip.foveal", "has no cues", "prepare it again"],
            ),
            (
                "gaze.csv: line 3, column yaw_deg: found \"x\", expected a number",
                [
                    "gaze.csv: line 3, column yaw_deg",
                    "found \"x\", expected a number",
                    "",
                ],
            ),
            (
                "--jobs is 0; give 1 to 256",
                ["--jobs", "--jobs is 0", "give 1 to 256"],
            ),
            (
                "out/frame_00001.png: cannot be written",
                ["out/frame_00001.png", "cannot be written", ""],
            ),
            (
                "--gaze osc:1: no gaze came (2 skipped; 1 late); start the sender",
                [
                    "--gaze osc:1",
                    "no gaze came (2 skipped; 1 late)",
                    "start the sender",
                ],
            ),
            (
                "no window can be opened: no display",
                ["", "no window can be opened: no display", ""],
            ),
        ] {
            assert_eq!(parts(&anyhow!(message)), said(expected), "{message}");
        }
    }

    #[test]
    fn causes_add_to_what_and_to_next_once() {
        let cause = anyhow!("line 2: no number; give one");
        let error = cause.context("gaze.csv");
        assert_eq!(
            parts(&error),
            said(["gaze.csv: line 2", "no number", "give one"])
        );
        let error = anyhow!("is full").context("out: is full");
        assert_eq!(whole(&error), "out: is full");
    }

    #[test]
    fn a_list_stays_out_and_a_second_line_is_advice() {
        let error = anyhow!("out: broken; copy it again\n  at 3\nthen go on");
        assert_eq!(
            parts(&error),
            said(["out", "broken", "copy it again; then go on"])
        );
    }
}
