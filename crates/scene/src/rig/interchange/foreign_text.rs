//! Which text do the bytes of another program's file hold?

use super::super::error::{NEXT, RigFault};
use crate::nearest::line_number;
use foveal_core::units::counted;
use std::borrow::Cow;

/// Bytes at the start in which XML says its encoding.
const DECLARED_WITHIN: usize = 200;

/// Text in UTF-8 or UTF-16, with or without a mark at its start; in another encoding where an XML
/// declaration says that it is Latin-1.
pub(super) fn text_of(bytes: &[u8]) -> Result<Cow<'_, str>, RigFault> {
    let of_pairs = |from: fn([u8; 2]) -> u16| {
        let (pairs, _) = bytes[2..].as_chunks::<2>();
        let words = pairs.iter().map(|pair| from(*pair));
        let letters = char::decode_utf16(words).map(|it| it.unwrap_or(char::REPLACEMENT_CHARACTER));
        Ok(Cow::Owned(letters.collect()))
    };
    match bytes {
        [0xff, 0xfe, ..] => return of_pairs(u16::from_le_bytes),
        [0xfe, 0xff, ..] => return of_pairs(u16::from_be_bytes),
        _ => {}
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(Cow::Borrowed(text.trim_start_matches('\u{feff}'))),
        Err(_) if is_latin(bytes) => {
            Ok(Cow::Owned(bytes.iter().map(|it| char::from(*it)).collect()))
        }
        Err(error) => {
            let place = format!("byte {}", error.valid_up_to());
            Err(RigFault::new(
                &place,
                "is not text in UTF-8 or UTF-16",
                NEXT,
            ))
        }
    }
}

/// Whether an XML declaration says Latin-1, or the one of Windows that has the same letters.
fn is_latin(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(DECLARED_WITHIN)];
    let start = String::from_utf8_lossy(start).to_ascii_lowercase();
    let declaration = start.split("?>").next().unwrap_or_default();
    let known = ["iso-8859-1", "windows-1252", "us-ascii"];
    declaration.starts_with("<?xml") && known.iter().any(|it| declaration.contains(it))
}

/// The text of an XML document, and what was mended. Bytes that are not UTF-8 are read as Latin-1:
/// old programs write that and declare nothing, or something else.
pub(super) fn xml_text_of(bytes: &[u8]) -> Result<(Cow<'_, str>, Vec<String>), RigFault> {
    let mut notes = Vec::new();
    let begins = bytes.iter().find(|it| !it.is_ascii_whitespace());
    let text = match text_of(bytes) {
        Err(_) if begins == Some(&b'<') => {
            notes.push("its text is not UTF-8 as declared: it is read as Latin-1".to_owned());
            Cow::Owned(bytes.iter().map(|it| char::from(*it)).collect())
        }
        text => text?,
    };
    let text = mended(text, &mut notes);
    Ok((text, notes))
}

/// The same without anything that no document may hold; lines stay lines.
fn mended<'a>(text: Cow<'a, str>, notes: &mut Vec<String>) -> Cow<'a, str> {
    let is_odd = |it: char| it.is_control() && !it.is_whitespace();
    let begins_late =
        text.starts_with(char::is_whitespace) && text.trim_start().starts_with("<?xml");
    let odd = text.chars().filter(|it| is_odd(*it)).count();
    let bare = bare_ampersands(&text);
    if !begins_late && odd == 0 && bare.is_empty() {
        return text;
    }
    let mut text = text.into_owned();
    if let Some(first) = bare.first() {
        notes.push(format!(
            "{} without an entity, read as written, the first in line {}",
            counted(bare.len() as u64, "ampersand"),
            line_number(&text, *first)
        ));
    }
    for at in bare.iter().rev() {
        text.replace_range(*at..at + 1, "&amp;");
    }
    if odd > 0 {
        let found = counted(odd as u64, "control character");
        notes.push(format!("{found} in its text are left out"));
        text = text.replace(is_odd, " ");
    }
    if begins_late && let Some(end) = text.find("?>") {
        notes.push("empty lines before its XML declaration are passed over".to_owned());
        let blank = |it: char| if it == '\n' { it } else { ' ' };
        let declaration: String = text[..end + 2].chars().map(blank).collect();
        text.replace_range(..end + 2, &declaration);
    }
    Cow::Owned(text)
}

/// Where an `&` begins none of the entities that every document has. None in a document with
/// entities or raw sections of its own.
fn bare_ampersands(text: &str) -> Vec<usize> {
    let begins_entity = |rest: &str| {
        let name = rest
            .get(1..)
            .and_then(|it| it.split_once(';'))
            .map(|it| it.0);
        name.is_some_and(|name| {
            let is_number = name.strip_prefix('#').is_some_and(|digits| {
                let hex = digits.strip_prefix('x');
                let all =
                    |it: &str, of: fn(&char) -> bool| !it.is_empty() && it.chars().all(|c| of(&c));
                hex.map_or_else(
                    || all(digits, char::is_ascii_digit),
                    |hex| all(hex, char::is_ascii_hexdigit),
                )
            });
            is_number || ["amp", "lt", "gt", "quot", "apos"].contains(&name)
        })
    };
    // Declared entities are refused, not mended.
    if text.contains("<!DOCTYPE") || text.contains("<![CDATA[") {
        return Vec::new();
    }
    let all = text.match_indices('&').map(|(at, _)| at);
    all.filter(|at| !begins_entity(&text[*at..])).collect()
}

/// The same without a declaration of the document's type, if that has nothing but names in it;
/// lines stay lines.
pub(super) fn without_doctype(text: &str) -> Cow<'_, str> {
    let doctype = text.find("<!DOCTYPE").and_then(|begin| {
        let length = text[begin..].find('>')?;
        let all = begin..begin + length + 1;
        (!text[all.clone()].contains('[')).then_some(all)
    });
    let Some(doctype) = doctype else {
        return Cow::Borrowed(text);
    };
    let blank = text[doctype.clone()].chars();
    let blank: String = blank
        .map(|it| if it == '\n' { '\n' } else { ' ' })
        .collect();
    let mut text = text.to_owned();
    text.replace_range(doctype, &blank);
    Cow::Owned(text)
}
