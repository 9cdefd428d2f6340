//! What stands in a line of a text file?

use std::borrow::Cow;
use std::str::SplitAsciiWhitespace;

use super::error::Fault;
use foveal_core::units::one_line;

/// A line and its number, counted from 1.
pub(super) struct Line<'a> {
    pub(super) number: usize,
    pub(super) text: Cow<'a, str>,
}

/// The lines of a file; a backslash at the end of one goes on in the next.
pub(super) fn lines(bytes: &[u8]) -> impl Iterator<Item = Line<'_>> {
    let mut rest = bytes.split(|byte| *byte == b'\n').enumerate();
    std::iter::from_fn(move || {
        let (index, first) = rest.next()?;
        let mut text = String::from_utf8_lossy(first);
        while text.trim_end().ends_with('\\') {
            let Some((_, next)) = rest.next() else { break };
            let mut joined = text.into_owned();
            joined.truncate(joined.trim_end().len() - 1);
            joined.push(' ');
            joined.push_str(&String::from_utf8_lossy(next));
            text = Cow::Owned(joined);
        }
        Some(Line {
            number: index + 1,
            text,
        })
    })
}

/// The words of a line, read as what they should be.
pub(super) struct Words<'a> {
    pub(super) line: usize,
    words: SplitAsciiWhitespace<'a>,
}

impl<'a> Words<'a> {
    pub(super) fn of(line: &'a Line<'_>) -> Self {
        Self {
            line: line.number,
            words: line.text.split_ascii_whitespace(),
        }
    }

    /// The next word.
    pub(super) fn next(&mut self) -> Option<&'a str> {
        self.words.next()
    }

    /// All that is left of the line, without blanks at both ends.
    pub(super) fn rest(&self) -> String {
        self.words.clone().collect::<Vec<_>>().join(" ")
    }

    /// How many words are left.
    pub(super) fn left(&self) -> usize {
        self.words.clone().count()
    }

    /// The next word as a finite number, if there is one; `what` names it in the error.
    pub(super) fn number_if_any(&mut self, what: &str) -> Result<Option<f64>, Fault> {
        let Some(word) = self.next() else {
            return Ok(None);
        };
        finite(word)
            .map(Some)
            .map_err(|found| Fault::line(self.line, format!("{what} is {found}")))
    }

    /// The next word as a finite number.
    pub(super) fn number(&mut self, what: &str) -> Result<f64, Fault> {
        self.number_if_any(what)?
            .ok_or_else(|| Fault::line(self.line, format!("{what} is missing")))
    }

    /// The next three words as finite numbers.
    pub(super) fn three(&mut self, what: &str) -> Result<[f64; 3], Fault> {
        Ok([self.number(what)?, self.number(what)?, self.number(what)?])
    }
}

/// The finite number that a word is, or the end of a sentence that says what it is instead.
pub(super) fn finite(word: &str) -> Result<f64, String> {
    match word.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(format!("{}, which is no finite number", shortened(word))),
        Err(_) => Err(format!("{:?}, which is no number", shortened(word))),
    }
}

/// The start of a word, for a message.
pub(super) fn shortened(word: &str) -> String {
    one_line(&word.chars().take(40).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_backslash_joins_lines_and_numbers_go_on() {
        let found: Vec<_> = lines(b"a \\\nb\r\nc")
            .map(|line| (line.number, line.text.trim().to_owned()))
            .collect();
        assert_eq!(found, [(1, "a  b".to_owned()), (3, "c".to_owned())]);
    }

    #[test]
    fn only_finite_numbers_are_numbers() {
        assert_eq!(finite("-1.5e3"), Ok(-1500.0));
        for word in ["nan", "inf", "1e999", "x", "1,5"] {
            assert!(finite(word).is_err(), "{word}");
        }
    }
}
