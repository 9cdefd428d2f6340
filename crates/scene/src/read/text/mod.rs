//! What stands in a line of a text file?

pub(in crate::read) mod glued;
pub(in crate::read) mod numbers;

use std::borrow::Cow;

use super::error::Fault;
use foveal_core::units::one_line;
use memchr::memchr2;
use numbers::{number_of, plain_number};

/// A line and its number, counted from 1.
pub(in crate::read) struct Line<'a> {
    pub(in crate::read) number: usize,
    pub(in crate::read) text: Cow<'a, str>,
}

/// The lines of a file, which end in LF, CR or both.
pub(in crate::read) fn single_lines(bytes: &[u8]) -> impl Iterator<Item = Line<'_>> {
    // Looked through once, not line by line.
    let whole = core::str::from_utf8(bytes).ok();
    let mut at = Some(0);
    let mut number = 0;
    std::iter::from_fn(move || {
        let begin = at?;
        number += 1;
        let end = memchr2(b'\n', b'\r', &bytes[begin..]).map(|it| begin + it);
        at = end.map(|end| match bytes[end..] {
            [b'\r', b'\n', ..] => end + 2,
            _ => end + 1,
        });
        let line = begin..end.unwrap_or(bytes.len());
        let text = match whole {
            Some(whole) => Cow::Borrowed(&whole[line]),
            None => text_of(&bytes[line]),
        };
        Some(Line { number, text })
    })
}

/// The same; a backslash at the end of one goes on in the next, unless it is a comment or a name.
pub(in crate::read) fn lines(bytes: &[u8]) -> impl Iterator<Item = Line<'_>> {
    let mut rest = single_lines(bytes);
    std::iter::from_fn(move || {
        let mut line = rest.next()?;
        while line.text.trim_ascii_end().ends_with('\\') && !has_text(&line.text) {
            let Some(next) = rest.next() else { break };
            let mut joined = line.text.into_owned();
            joined.truncate(joined.trim_end().len() - 1);
            joined.push(' ');
            joined.push_str(&next.text);
            line.text = Cow::Owned(joined);
        }
        Some(line)
    })
}

/// Whether a line is a comment or a name, in which a backslash stands for itself: a folder's.
fn has_text(line: &str) -> bool {
    let word = line.split_ascii_whitespace().next().unwrap_or("");
    word.starts_with('#') || ["o", "g", "newmtl", "usemtl", "mtllib"].contains(&word)
}

/// What bytes say: UTF-8, or else each byte a letter of Latin-1, so that names stay different.
fn text_of(bytes: &[u8]) -> Cow<'_, str> {
    match core::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().map(|byte| char::from(*byte)).collect()),
    }
}

/// The bytes of a text in UTF-8 without a mark at its start, whether they were so or UTF-16.
pub(in crate::read) fn utf8_of(bytes: &[u8]) -> Cow<'_, [u8]> {
    let is_sign = |byte: u8| byte.is_ascii_graphic() || byte.is_ascii_whitespace();
    let of_pair: fn([u8; 2]) -> u16 = match bytes {
        [0xef, 0xbb, 0xbf, text @ ..] => return Cow::Borrowed(text),
        [0xff, 0xfe, ..] => u16::from_le_bytes,
        [0xfe, 0xff, ..] => u16::from_be_bytes,
        [a, 0, b, 0, ..] if is_sign(*a) && is_sign(*b) => u16::from_le_bytes,
        [0, a, 0, b, ..] if is_sign(*a) && is_sign(*b) => u16::from_be_bytes,
        _ => return Cow::Borrowed(bytes),
    };
    let words = bytes.as_chunks().0.iter().map(|pair| of_pair(*pair));
    let signs = char::decode_utf16(words).map(|it| it.unwrap_or(char::REPLACEMENT_CHARACTER));
    let text: String = signs.skip_while(|sign| *sign == '\u{feff}').collect();
    Cow::Owned(text.into_bytes())
}

/// The words of a line, read as what they should be.
#[derive(Clone)]
pub(in crate::read) struct Words<'a> {
    pub(in crate::read) line: usize,
    rest: &'a str,
    /// How many numbers had a decimal comma.
    pub(in crate::read) commas: usize,
    /// How many numbers had no blank before them.
    pub(in crate::read) glued: usize,
    /// Whether a word should have been a number, and was not.
    pub(in crate::read) is_broken: bool,
}

impl<'a> Words<'a> {
    pub(in crate::read) fn of(line: &'a Line<'_>) -> Self {
        Self {
            line: line.number,
            rest: &line.text,
            commas: 0,
            glued: 0,
            is_broken: false,
        }
    }

    /// The next word.
    pub(in crate::read) fn next(&mut self) -> Option<&'a str> {
        let [begin, end] = self.first();
        let word = &self.rest[begin..end];
        self.rest = &self.rest[end..];
        (begin < end).then_some(word)
    }

    /// The next word, or none, without taking it.
    pub(in crate::read) fn peek(&self) -> &'a str {
        let [begin, end] = self.first();
        &self.rest[begin..end]
    }

    /// Where the next word begins and ends.
    fn first(&self) -> [usize; 2] {
        let bytes = self.rest.as_bytes();
        let begin = bytes.iter().position(|byte| !byte.is_ascii_whitespace());
        let begin = begin.unwrap_or(bytes.len());
        let length = bytes[begin..].iter().position(u8::is_ascii_whitespace);
        [begin, length.map_or(bytes.len(), |length| begin + length)]
    }

    /// All that is left of the line, without blanks at both ends.
    pub(in crate::read) fn rest(&self) -> String {
        let words: Vec<&str> = self.rest.split_ascii_whitespace().collect();
        words.join(" ")
    }

    /// The same, with blanks as they are.
    pub(in crate::read) fn rest_as_it_is(&self) -> &'a str {
        self.rest.trim_ascii()
    }

    /// Leaves out a comment at the end of the line: from a `#` on that is not within a number, such
    /// as `1.#QNAN`.
    pub(in crate::read) fn leave_out_comment(&mut self) {
        if !self.rest.as_bytes().contains(&b'#') {
            return;
        }
        let is_begin = |(at, _): &(usize, &str)| !self.rest[..*at].ends_with('.');
        if let Some((at, _)) = self.rest.match_indices('#').find(is_begin) {
            self.rest = &self.rest[..at];
        }
    }

    /// The same for a comment that begins with `//`, in lines whose numbers have no slash.
    pub(in crate::read) fn leave_out_slashes(&mut self) {
        let slash = self.rest.as_bytes().iter().position(|it| *it == b'/');
        if let Some(at) = slash.filter(|at| self.rest[*at..].starts_with("//")) {
            self.rest = &self.rest[..at];
        }
    }

    /// The numbers up to the end of the line or a comment. Where some have no blank between them,
    /// they are parted if they are then as many as `fits` asks for.
    pub(in crate::read) fn row(&mut self, fits: impl Fn(usize) -> bool) -> LineNumbers {
        let mut row = LineNumbers::default();
        let mut has_comment = true;
        loop {
            while let Some(number) = self.plain() {
                row.push(number);
            }
            if self.rest.is_empty() {
                return row;
            }
            if has_comment {
                self.leave_out_comment();
                self.leave_out_slashes();
                has_comment = false;
            }
            let before = self.rest;
            let was_broken = self.is_broken;
            let Some(number) = self.any_number() else {
                return row;
            };
            if !was_broken && self.is_broken {
                let words = before.split_ascii_whitespace();
                let found = glued::numbers(words, |more| fits(row.count + more));
                if let Some(found) = found {
                    self.glued += 1;
                    self.is_broken = false;
                    self.rest = "";
                    found.into_iter().for_each(|it| row.push(it));
                    return row;
                }
            }
            row.push(number);
        }
    }

    /// The next three numbers, behind which other words may stand; NaN for each that is not one.
    /// Where some have no blank between them, as of [`Self::row`].
    pub(in crate::read) fn three(&mut self) -> [f64; 3] {
        let before = self.clone();
        let mut next = || self.any_number().unwrap_or(f64::NAN);
        let three = [next(), next(), next()];
        if before.is_broken || !self.is_broken {
            return three;
        }
        let is_begin = |it: char| it.is_ascii_digit() || matches!(it, '+' | '-' | '.');
        let words = before.rest.split_ascii_whitespace();
        let words = words.take_while(|it| it.starts_with(is_begin)).take(3);
        let Some(found) = glued::numbers(words.clone(), |count| count == 3) else {
            return three;
        };
        let taken = words.count();
        *self = before;
        for _ in 0..taken {
            self.next();
        }
        self.glued += 1;
        [found[0], found[1], found[2]]
    }

    /// The next word where it is a number in its plainest form, as nearly all are.
    fn plain(&mut self) -> Option<f64> {
        let bytes = self.rest.as_bytes();
        let begin = bytes.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let (number, length) = plain_number(&bytes[begin..])?;
        self.rest = &self.rest[begin + length..];
        Some(number)
    }

    /// The next word as a number; NaN where it is not a number.
    pub(in crate::read) fn any_number(&mut self) -> Option<f64> {
        if let Some(number) = self.plain() {
            return Some(number);
        }
        let word = self.next()?;
        let number = number_of(word, &mut self.commas);
        self.is_broken |= number.is_none();
        Some(number.unwrap_or(f64::NAN))
    }

    /// The next word as a finite number, if there is one; `what` names it in the error.
    pub(in crate::read) fn number_if_any(&mut self, what: &str) -> Result<Option<f64>, Fault> {
        let Some(word) = self.next() else {
            return Ok(None);
        };
        match number_of(word, &mut self.commas).filter(|it| it.is_finite()) {
            Some(number) => Ok(Some(number)),
            None => {
                let word = shortened(word);
                let what = format!("{what} is {word:?}, which is no finite number");
                Err(Fault::line(self.line, what))
            }
        }
    }

    /// The next word as a finite number.
    pub(in crate::read) fn number(&mut self, what: &str) -> Result<f64, Fault> {
        self.number_if_any(what)?
            .ok_or_else(|| Fault::line(self.line, format!("{what} is missing")))
    }
}

/// The first numbers of a line.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::read) struct LineNumbers {
    values: [f64; MOST_OF_ROW],
    /// How many there are, beyond those that are kept too.
    pub(in crate::read) count: usize,
}

/// More have no meaning in any line.
const MOST_OF_ROW: usize = 8;

impl LineNumbers {
    fn push(&mut self, number: f64) {
        if let Some(value) = self.values.get_mut(self.count) {
            *value = number;
        }
        self.count += 1;
    }

    /// Its number at a place; none where it has fewer.
    pub(in crate::read) fn get(&self, at: usize) -> Option<f64> {
        self.values[..self.count.min(MOST_OF_ROW)].get(at).copied()
    }

    /// The same; NaN where it has fewer.
    pub(in crate::read) fn at(&self, at: usize) -> f64 {
        self.get(at).unwrap_or(f64::NAN)
    }
}

/// The start of a word, for a message.
pub(in crate::read) fn shortened(word: &str) -> String {
    one_line(&word.chars().take(40).collect::<String>())
}

/// A number for people, who read no hundreds of digits.
pub(in crate::read) fn plain(number: f64) -> String {
    match number == 0.0 || (1e-9..1e15).contains(&number.abs()) || !number.is_finite() {
        true => number.to_string(),
        false => format!("{number:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(bytes: &[u8]) -> Vec<(usize, String)> {
        let all = lines(bytes).map(|line| (line.number, line.text.trim().to_owned()));
        all.collect()
    }

    #[test]
    fn a_backslash_joins_lines_and_numbers_go_on() {
        let found = said(b"a \\\nb\r\nc");
        assert_eq!(found, [(1, "a  b".to_owned()), (3, "c".to_owned())]);
        assert_eq!(said(b"# C:\\\nv 1")[1], (2, "v 1".to_owned()));
    }

    #[test]
    fn lines_end_in_lf_cr_or_both() {
        let found = said(b"a\rb\r\n\nc\r");
        let texts = ["a", "b", "", "c", ""];
        let expected: Vec<_> = (1..).zip(texts.map(str::to_owned)).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn utf_16_is_read_with_and_without_its_mark() {
        let text = "v 1 ä";
        let of = |to: fn(u16) -> [u8; 2], mark: &str| -> Vec<u8> {
            let all = format!("{mark}{text}");
            all.encode_utf16().flat_map(to).collect()
        };
        for mark in ["", "\u{feff}"] {
            for to in [u16::to_le_bytes as fn(u16) -> [u8; 2], u16::to_be_bytes] {
                assert_eq!(*utf8_of(&of(to, mark)), *text.as_bytes());
            }
        }
        assert_eq!(*utf8_of(b"\xef\xbb\xbfply"), *b"ply");
        assert_eq!(*utf8_of(b"ply"), *b"ply");
    }

    #[test]
    fn names_that_are_no_utf_8_stay_different() {
        let [one, other] = [&b"usemtl St\xfchle"[..], b"usemtl St\xe4hle"].map(said);
        assert_ne!(one, other);
    }

    #[test]
    fn a_comment_ends_numbers_and_what_c_says_of_none_is_no_comment() {
        let line = Line {
            number: 1,
            text: Cow::Borrowed("-1.#QNAN 2 # 3"),
        };
        let mut words = Words::of(&line);
        words.leave_out_comment();
        assert!(words.any_number().is_some_and(f64::is_nan));
        assert_eq!((words.any_number(), words.any_number()), (Some(2.0), None));
    }
}
