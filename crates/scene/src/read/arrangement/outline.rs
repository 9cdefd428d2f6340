//! Which parts of a scene file's text are places, and what is left of it without them?
//!
//! A parser of TOML keeps some fifty times the bytes of a text that says little. Places are many
//! and short: so each is parsed by itself, and the rest of the text without them, comments and
//! empty lines. Whatever is no TOML stays what it is in one of these parts.

use std::borrow::Cow;
use std::ops::Range;

use toml_parser::Source;
use toml_parser::lexer::{Token, TokenKind};

use super::super::error::Fault;
use super::super::place::MOST_PLACES;
use super::keys::{NEXT, line_of};

/// Most words of a text besides places: sixteen for each of as many inputs as fit into a pack.
const MOST_WORDS: usize = 16 * 4096;
/// Deeper than any scene file; the parser refuses what is deeper still.
const MOST_DEPTH: usize = 64;

/// A text without its places.
#[derive(Debug, Default)]
pub(super) struct Outline {
    pub(super) text: String,
    /// Where in `text` something was left out, and how many bytes up to there.
    left_out: Vec<(usize, usize)>,
    pub(super) places: Vec<PlaceText>,
}

/// What is said of one place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PlaceText {
    /// Number of its input, from 1.
    pub(super) input: usize,
    /// Where it stands in the whole text.
    pub(super) bytes: Range<usize>,
    /// Whether it stands in brackets; else below a header of its own.
    pub(super) is_inline: bool,
}

impl Outline {
    /// Where a byte of the outline stands in the whole text.
    pub(super) fn whole(&self, at: usize) -> usize {
        let before = self.left_out.partition_point(|(from, _)| *from <= at);
        at + before.checked_sub(1).map_or(0, |it| self.left_out[it].1)
    }

    /// The outline of a text.
    ///
    /// # Errors
    /// It has more places, or more words besides them, than a scene file can need.
    pub(super) fn of(text: &str) -> Result<Self, Fault> {
        let mut scanner = Scanner {
            source: Source::new(text),
            outline: Self::default(),
            words: 0,
            inputs: 0,
            open: Vec::new(),
            key: None,
            header: None,
            section: None,
            starts_line: true,
        };
        let tokens = scanner.source.lex();
        for token in tokens {
            scanner.take(token)?;
        }
        Ok(scanner.outline)
    }
}

/// A bracket that is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Open {
    /// Of places: their number is counted by what stands between commas.
    Places {
        /// Where the place that is being read begins and ends, as far as it came.
        from: Option<usize>,
        to: usize,
    },
    /// Of inputs.
    Inputs,
    /// Of anything else.
    Other,
}

struct Scanner<'a> {
    source: Source<'a>,
    outline: Outline,
    /// Tokens that went into the outline.
    words: usize,
    /// Inputs that began.
    inputs: usize,
    open: Vec<Open>,
    /// The key that stands before an equals sign.
    key: Option<Token>,
    /// Keys and brackets of a header that is being read.
    header: Option<Vec<Token>>,
    /// Where the text of a place with a header of its own begins.
    section: Option<usize>,
    /// Whether nothing of the line came yet.
    starts_line: bool,
}

impl<'a> Scanner<'a> {
    fn take(&mut self, token: Token) -> Result<(), Fault> {
        let span = token.span();
        if self.places_depth().is_some() {
            return self.take_of_places(token);
        }
        let is_blank = matches!(token.kind(), TokenKind::Whitespace | TokenKind::Comment);
        let begins_header = self.header.is_none()
            && self.open.is_empty()
            && self.starts_line
            && token.kind() == TokenKind::LeftSquareBracket;
        if let (Some(from), true) = (
            self.section,
            begins_header || token.kind() == TokenKind::Eof,
        ) {
            self.section = None;
            self.add_place(from..span.start(), false)?;
        }
        if token.kind() == TokenKind::Newline {
            self.end_line(token);
            return Ok(());
        }
        if self.section.is_some()
            || (is_blank && self.starts_line)
            || token.kind() == TokenKind::Eof
        {
            self.starts_line &= is_blank;
            self.leave_out(span.start()..span.end());
            return Ok(());
        }
        if token.kind() == TokenKind::Comment {
            self.leave_out(span.start()..span.end());
            return Ok(());
        }
        self.starts_line = false;
        if begins_header {
            self.header = Some(Vec::new());
        }
        self.keep(token)?;
        match &mut self.header {
            Some(header) if !is_blank => header.push(token),
            Some(_) => {}
            None => self.follow(token),
        }
        Ok(())
    }

    /// Follows keys and brackets.
    fn follow(&mut self, token: Token) {
        match token.kind() {
            TokenKind::LeftSquareBracket if self.open.len() < MOST_DEPTH => {
                let opened = match self.key_name().as_deref() {
                    Some("place") => Open::Places {
                        from: None,
                        to: token.span().end(),
                    },
                    Some("input") if self.open.is_empty() => Open::Inputs,
                    _ => Open::Other,
                };
                self.open.push(opened);
                self.key = None;
            }
            TokenKind::LeftCurlyBracket if self.open.len() < MOST_DEPTH => {
                self.inputs += usize::from(self.open.last() == Some(&Open::Inputs));
                self.open.push(Open::Other);
                self.key = None;
            }
            TokenKind::RightSquareBracket | TokenKind::RightCurlyBracket => {
                self.open.pop();
            }
            TokenKind::Comma => self.key = None,
            TokenKind::Whitespace | TokenKind::Equals => {}
            _ => self.key = Some(token),
        }
    }

    /// What the key before a value is called.
    fn key_name(&self) -> Option<Cow<'a, str>> {
        self.key.map(|key| self.name_of(key))
    }

    fn name_of(&self, key: Token) -> Cow<'a, str> {
        let mut name = Cow::Borrowed("");
        if let Some(raw) = self.source.get(key) {
            raw.decode_key(&mut name, &mut ());
        }
        name
    }

    fn end_line(&mut self, token: Token) {
        let span = token.span();
        if let Some(header) = self.header.take() {
            self.begin_table(&header, span.end());
        }
        let is_empty = self.starts_line || self.section.is_some_and(|from| from < span.end());
        self.starts_line = true;
        match is_empty {
            true => self.leave_out(span.start()..span.end()),
            false => self.add(token),
        }
        if self.open.is_empty() {
            self.key = None;
        }
    }

    /// What a header says begins behind it.
    fn begin_table(&mut self, header: &[Token], at: usize) {
        use TokenKind::{Dot, LeftSquareBracket, RightSquareBracket};
        let is_bracket = |it: &&Token| matches!(it.kind(), LeftSquareBracket | RightSquareBracket);
        let brackets = header.iter().filter(is_bracket).count();
        let keys = header
            .iter()
            .filter(|it| !is_bracket(it) && it.kind() != Dot);
        let keys: Vec<Cow<'a, str>> = keys.map(|it| self.name_of(*it)).collect();
        if brackets != 4 {
            return;
        }
        let keys: Vec<&str> = keys.iter().map(AsRef::as_ref).collect();
        match keys[..] {
            ["input"] => self.inputs += 1,
            ["input", "place"] => self.section = Some(at),
            _ => {}
        }
    }

    /// How deep the bracket of places lies that is open.
    fn places_depth(&self) -> Option<usize> {
        let is_places = |it: &Open| matches!(it, Open::Places { .. });
        self.open.iter().position(is_places)
    }

    /// What stands in brackets of places goes to these.
    fn take_of_places(&mut self, token: Token) -> Result<(), Fault> {
        let span = token.span();
        let depth = self.open.len() - self.places_depth().unwrap_or(0);
        let places = |it: &&mut Open| matches!(it, Open::Places { .. });
        let Some(Open::Places { from, to }) = self.open.iter_mut().find(places) else {
            return Ok(());
        };
        let is_blank = matches!(
            token.kind(),
            TokenKind::Whitespace | TokenKind::Comment | TokenKind::Newline
        );
        match token.kind() {
            TokenKind::Comma if depth == 1 => {
                let place = from.take().unwrap_or(span.start())..*to;
                self.leave_out(span.start()..span.end());
                return self.add_place(place.start..place.end.max(place.start), true);
            }
            TokenKind::RightSquareBracket if depth == 1 => {
                let last = from.map(|from| from..*to);
                self.open.pop();
                last.map_or(Ok(()), |last| self.add_place(last, true))?;
                return self.keep(token);
            }
            TokenKind::LeftSquareBracket | TokenKind::LeftCurlyBracket => {
                from.get_or_insert(span.start());
                *to = span.end();
                // What is deeper is refused where the place is parsed.
                self.open.push(Open::Other);
            }
            TokenKind::RightSquareBracket | TokenKind::RightCurlyBracket => {
                *to = span.end();
                from.get_or_insert(span.start());
                if depth > 1 {
                    self.open.pop();
                }
            }
            _ if !is_blank && token.kind() != TokenKind::Eof => {
                from.get_or_insert(span.start());
                *to = span.end();
            }
            _ => {}
        }
        self.leave_out(span.start()..span.end());
        Ok(())
    }

    fn add_place(&mut self, bytes: Range<usize>, is_inline: bool) -> Result<(), Fault> {
        if self.outline.places.len() == MOST_PLACES {
            let what = format!("it has more than {MOST_PLACES} places");
            let line = line_of(self.source.input(), bytes.start);
            return Err(Fault::broken(line, what, NEXT));
        }
        self.outline.places.push(PlaceText {
            input: self.inputs,
            bytes,
            is_inline,
        });
        Ok(())
    }

    fn keep(&mut self, token: Token) -> Result<(), Fault> {
        self.words += 1;
        if self.words > MOST_WORDS {
            let what = format!("it has more than {MOST_WORDS} words besides places");
            let line = line_of(self.source.input(), token.span().start());
            return Err(Fault::broken(line, what, NEXT));
        }
        self.add(token);
        Ok(())
    }

    fn add(&mut self, token: Token) {
        let span = token.span();
        let text = self.source.input().get(span.start()..span.end());
        self.outline.text.push_str(text.unwrap_or_default());
    }

    fn leave_out(&mut self, bytes: Range<usize>) {
        let at = self.outline.text.len();
        let before = self.outline.left_out.last().map_or(0, |it| it.1);
        let all = before + bytes.len();
        match self.outline.left_out.last_mut() {
            Some((from, left_out)) if *from == at => *left_out = all,
            _ => self.outline.left_out.push((at, all)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn texts<'a>(text: &'a str, outline: &Outline) -> Vec<(usize, &'a str)> {
        let places = outline.places.iter();
        places
            .map(|it| (it.input, &text[it.bytes.clone()]))
            .collect()
    }

    #[test]
    fn places_are_told_from_the_rest_whatever_way_they_are_written() {
        let text = "# trees\n\nlight = [0, 1, 0] # up\n[[input]]\nfile = \"a#.obj\"\n  place = \
                    [ {}, # one\n{ scale = [1, 2, 3] },\n]\n[[ input ]]\nfile = 'b'\n\
                    [[input.\"place\"]]\nscale = 2\n\n[[input.place]]\n[[input]]\n\
                    \"plac\\u0065\" = [{}]";
        let outline = Outline::of(text).unwrap();
        let expected = [
            (1, "{}"),
            (1, "{ scale = [1, 2, 3] }"),
            (2, "scale = 2\n\n"),
            (2, ""),
            (3, "{}"),
        ];
        assert_eq!(texts(text, &outline), expected);
        assert_eq!(
            outline.text,
            "light = [0, 1, 0] \n[[input]]\nfile = \"a#.obj\"\nplace = []\n[[ input ]]\n\
             file = 'b'\n[[input.\"place\"]]\n[[input.place]]\n[[input]]\n\"plac\\u0065\" = []"
        );
        for word in ["light", "file = 'b'", "[[ input ]]", "plac\\u0065"] {
            let at = outline.text.find(word).unwrap();
            assert_eq!(outline.whole(at), text.find(word).unwrap(), "{word}");
        }
    }

    #[test]
    fn inputs_in_brackets_have_their_places_too() {
        let text = "input = [{ file = 'a', place = [{}, 5,] }, { place = [,], file = 'b' }]";
        let outline = Outline::of(text).unwrap();
        assert_eq!(texts(text, &outline), [(1, "{}"), (1, "5"), (2, "")]);
        let left = "input = [{ file = 'a', place = [] }, { place = [], file = 'b' }]";
        assert_eq!(outline.text, left);
    }

    #[test]
    fn what_is_not_needed_is_not_kept() {
        let blank = "#\n\n \t\n".repeat(100_000);
        let outline = Outline::of(&blank).unwrap();
        assert!(outline.text.is_empty() && outline.left_out.len() == 1);
        for (many, said) in [
            ("place = [", "262144 places"),
            ("a = [", "words besides places"),
        ] {
            let text = format!("[[input]]\n{many}{}", "{},".repeat(300_000));
            let fault = format!("{:?}", Outline::of(&text).unwrap_err());
            assert!(fault.contains(said), "{fault}");
        }
    }

    proptest! {
        #[test]
        fn no_text_panics_and_places_lie_in_order(
            text in "([\\[\\]{}=,.#\n\" ]|place|input|a){0,60}",
        ) {
            let outline = Outline::of(&text).unwrap();
            let mut at = 0;
            for place in &outline.places {
                prop_assert!(at <= place.bytes.start && place.bytes.end <= text.len());
                at = place.bytes.end;
            }
            prop_assert!(outline.whole(outline.text.len()) <= text.len());
        }
    }
}
