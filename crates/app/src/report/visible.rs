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
}
