//! How is text shown that others wrote?
//!
//! Names of files, packs, logs and senders may hold what a terminal obeys, or what turns the
//! direction of the text around it. All text for people passes here.

use crate::report::names::in_lines;
use std::borrow::Cow;

/// The text with every control character but line ends and tabs, and every mark that turns the
/// direction of text (Unicode Standard Annex 9), as `\u{1b}`; line ends and tabs of names too.
pub(crate) fn visible(text: &str) -> Cow<'_, str> {
    match in_lines(text) {
        Cow::Borrowed(text) => without_marks(text),
        Cow::Owned(text) => Cow::Owned(without_marks(&text).into_owned()),
    }
}

fn without_marks(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_obeyed) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for letter in text.chars() {
        match is_obeyed(letter) {
            true => shown.extend(letter.escape_unicode()),
            false => shown.push(letter),
        }
    }
    Cow::Owned(shown)
}

/// Most characters of a line of a message, and of them those at its end, where it says what to do.
const MOST_OF_LINE: usize = 2000;
const AT_END: usize = 600;
/// Most lines of a message: those of a hundred damaged places, and some.
const MOST_LINES: usize = 200;

/// A message without the middle of lines that are longer than anybody reads, and the lines behind
/// so many: what it quotes may be of any length.
pub(crate) fn bounded(text: &str) -> Cow<'_, str> {
    let is_short = |line: &str| line.len() <= MOST_OF_LINE;
    if text.lines().all(is_short) && text.lines().nth(MOST_LINES).is_none() {
        return Cow::Borrowed(text);
    }
    let lines = text.lines().take(MOST_LINES).map(without_middle);
    let mut shown = lines.collect::<Vec<_>>().join("\n");
    let more = text.lines().skip(MOST_LINES).count();
    if more > 0 {
        shown.push_str(&format!("\n({more} lines more are left out)"));
    }
    Cow::Owned(shown)
}

fn without_middle(line: &str) -> Cow<'_, str> {
    let count = line.chars().count();
    let Some(left_out) = count.checked_sub(MOST_OF_LINE).filter(|it| *it > 0) else {
        return Cow::Borrowed(line);
    };
    let begin: String = line.chars().take(MOST_OF_LINE - AT_END).collect();
    let end: String = line.chars().skip(count - AT_END).collect();
    Cow::Owned(format!("{begin} (.. {left_out} characters ..) {end}"))
}

fn is_obeyed(letter: char) -> bool {
    let turns = matches!(
        letter,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
    );
    turns || (letter.is_control() && !matches!(letter, '\n' | '\t'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_a_terminal_obeys_is_left() {
        assert_eq!(visible("a\u{1b}[2Jb\u{9b}1m"), "a\\u{1b}[2Jb\\u{9b}1m");
        assert_eq!(visible("a\u{202e}gpj.exe"), "a\\u{202e}gpj.exe");
        assert_eq!(visible("bell\u{7}\rover"), "bell\\u{7}\\u{d}over");
        assert!(matches!(visible("two\n\tlines, ünï"), Cow::Borrowed(_)));
    }

    #[test]
    fn a_message_is_bounded_and_keeps_its_begin_and_end() {
        let long = format!("a.obj: {}; export it again", "1".repeat(20_000_000));
        let shown = bounded(&long);
        assert!(shown.len() < 2100 && shown.starts_with("a.obj: 1"));
        assert!(shown.ends_with("; export it again") && shown.contains("19998024 characters"));
        let many = "line\n".repeat(100_000);
        let shown = bounded(&many);
        assert!(shown.lines().count() == 201 && shown.ends_with("(99800 lines more are left out)"));
        assert!(matches!(bounded(&"ü".repeat(900)), Cow::Borrowed(_)));
        assert!(bounded(&"ü".repeat(1900)).chars().count() == 1900);
    }
}
