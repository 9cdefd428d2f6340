//! On which line does a key of a rig file stand, and which key stands there?

use std::ops::Range;

use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};
use toml_parser::Source;

use super::error::{NEXT, RigFault, WrongKey};
use crate::nearest::{line_number, nearest};

/// Most words of a rig file in TOML, of which its parser keeps some hundred bytes each: twelve
/// displays with a grid of 65 x 65 points in three colours have a million.
const MOST_WORDS: usize = 1 << 21;

/// How a rig file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RigSyntax {
    Toml,
    Json,
}

/// The text of a rig file.
#[derive(Clone, Copy, Debug)]
pub(super) struct RigText<'a> {
    pub(super) text: &'a str,
    pub(super) syntax: RigSyntax,
}

/// A key by its whole name, and the bytes of its value.
type KeyPlace = (String, Range<usize>);

impl RigText<'_> {
    /// Reads it as entries.
    pub(super) fn parse<T: DeserializeOwned>(&self) -> Result<T, RigFault> {
        if self.syntax == RigSyntax::Toml && Source::new(self.text).lex().nth(MOST_WORDS).is_some()
        {
            let what = format!("it has more than {MOST_WORDS} words: give large grids as files");
            return Err(RigFault::new("", what, NEXT));
        }
        match self.syntax {
            RigSyntax::Toml => toml::from_str(self.text).map_err(|error| {
                let at = error.span().map_or(0, |span| span.start);
                self.wrong_at(at, error.message())
            }),
            RigSyntax::Json => serde_json::from_str(self.text).map_err(|error| {
                let lines = self.text.split_inclusive('\n');
                let before = lines.take(error.line().saturating_sub(1)).map(str::len);
                let at = before.sum::<usize>() + error.column().saturating_sub(1);
                let message = error.to_string();
                let message = message.split(" at line ").next().unwrap_or_default();
                self.wrong_at(at, message)
            }),
        }
    }

    /// What a parser says is wrong at a byte.
    fn wrong_at(&self, at: usize, message: &str) -> RigFault {
        let line = line_number(self.text, at);
        let places = self.places();
        // The innermost, which comes after those that it is in.
        let key = places
            .iter()
            .rev()
            .find(|(_, bytes)| bytes.start <= at && at < bytes.end.max(bytes.start + 1));
        let place = match key {
            Some((key, _)) => format!("line {line}, {key}"),
            None => format!("line {line}"),
        };
        let message = message.replace('\n', " ");
        let mut quoted = message.split('`').skip(1).step_by(2);
        match (message.starts_with("unknown "), quoted.next()) {
            (true, Some(word)) => {
                let known: Vec<&str> = quoted.collect();
                let nearest = nearest(known.iter().copied(), word);
                let word: String = word.chars().take(40).collect();
                let kind = match message.starts_with("unknown field") {
                    true => "key",
                    false => "such word as",
                };
                let what = format!("there is no {kind} {word:?}");
                let next = nearest.map(|it| format!("the nearest is {it:?}; {NEXT}"));
                RigFault::new(&place, what, next.unwrap_or_else(|| NEXT.to_owned()))
            }
            _ => RigFault::new(&place, message, NEXT),
        }
    }

    /// What is wrong with a key's value, with the key's line; of one that is not there, with that
    /// of what it is missing in.
    pub(super) fn fault(&self, wrong: &WrongKey) -> RigFault {
        let places = self.places();
        let mut key = wrong.key.as_str();
        let line = loop {
            if let Some((_, bytes)) = places.iter().find(|(it, _)| it == key) {
                break Some(line_number(self.text, bytes.start));
            }
            match key.rfind(['.', '[']) {
                Some(end) => key = &key[..end],
                None => break None,
            }
        };
        let place = match line {
            Some(line) => format!("line {line}, {}", wrong.key),
            None => wrong.key.clone(),
        };
        RigFault::new(&place, &*wrong.what, NEXT)
    }

    /// All keys; none of what is no such text at all.
    fn places(&self) -> Vec<KeyPlace> {
        let mut places = Vec::new();
        match self.syntax {
            RigSyntax::Toml => {
                if let Ok(table) = DeTable::parse(self.text) {
                    of_table(table.get_ref(), "", &mut places);
                }
            }
            RigSyntax::Json => {
                let mut json = JsonKeys {
                    bytes: self.text.as_bytes(),
                    at: 0,
                    places: &mut places,
                };
                // What is broken has the keys up to there.
                let _ = json.value("", 0);
            }
        }
        places
    }
}

fn joined(of: &str, key: &str) -> String {
    match of {
        "" => key.to_owned(),
        of => format!("{of}.{key}"),
    }
}

fn of_table(table: &DeTable<'_>, of: &str, places: &mut Vec<KeyPlace>) {
    let mut all: Vec<_> = table.iter().collect();
    all.sort_by_key(|(key, _)| key.span().start);
    for (key, value) in all {
        let name = joined(of, key.get_ref());
        // From the key on: what is said of the key stands on its line.
        places.push((name.clone(), key.span().start..value.span().end));
        match value.get_ref() {
            DeValue::Table(table) => of_table(table, &name, places),
            DeValue::Array(all) => {
                for (number, one) in (1..).zip(all.iter()) {
                    if let DeValue::Table(table) = one.get_ref() {
                        let name = format!("{name}[{number}]");
                        places.push((name.clone(), one.span()));
                        of_table(table, &name, places);
                    }
                }
            }
            _ => {}
        }
    }
}

/// Finds the keys of JSON, as far as it is sound.
struct JsonKeys<'a> {
    bytes: &'a [u8],
    at: usize,
    places: &'a mut Vec<KeyPlace>,
}

impl JsonKeys<'_> {
    /// Deeper than any rig file.
    const MOST_DEPTH: usize = 16;

    fn peek(&mut self) -> Option<u8> {
        while self.bytes.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
        self.bytes.get(self.at).copied()
    }

    fn string(&mut self) -> Option<String> {
        let start = self.at;
        self.at += 1;
        loop {
            match self.bytes.get(self.at)? {
                b'\\' => self.at += 2,
                b'"' => break,
                _ => self.at += 1,
            }
        }
        self.at += 1;
        serde_json::from_slice(self.bytes.get(start..self.at)?).ok()
    }

    /// Goes past a value that has a name.
    fn value(&mut self, of: &str, depth: usize) -> Option<()> {
        if depth > Self::MOST_DEPTH {
            return None;
        }
        match self.peek()? {
            b'{' => self.each(b'}', |keys, _| {
                (keys.peek()? == b'"').then_some(())?;
                let start = keys.at;
                let key = keys.string()?;
                let name = joined(of, &key);
                (keys.peek()? == b':').then_some(())?;
                keys.at += 1;
                keys.named(&name, start, depth)
            }),
            b'[' => self.each(b']', |keys, number| match keys.peek()? {
                b'{' => {
                    let start = keys.at;
                    keys.named(&format!("{of}[{number}]"), start, depth)
                }
                _ => keys.value(of, depth + 1),
            }),
            b'"' => self.string().map(|_| ()),
            _ => {
                let is_in = |byte: &u8| byte.is_ascii_alphanumeric() || b"+-.".contains(byte);
                let start = self.at;
                while self.bytes.get(self.at).is_some_and(is_in) {
                    self.at += 1;
                }
                (self.at > start).then_some(())
            }
        }
    }

    /// A value whose name began at `start`; its end is put right once it is known.
    fn named(&mut self, name: &str, start: usize, depth: usize) -> Option<()> {
        let index = self.places.len();
        self.places.push((name.to_owned(), start..self.bytes.len()));
        self.value(name, depth + 1)?;
        self.places[index].1.end = self.at;
        Some(())
    }

    /// Each of what commas part, up to a bracket, counted from 1.
    fn each(&mut self, end: u8, mut one: impl FnMut(&mut Self, usize) -> Option<()>) -> Option<()> {
        self.at += 1;
        for number in 1.. {
            if self.peek()? == end {
                break;
            }
            one(self, number)?;
            match self.peek()? {
                b',' => self.at += 1,
                other => {
                    (other == end).then_some(())?;
                    break;
                }
            }
        }
        self.at += 1;
        Some(())
    }
}
