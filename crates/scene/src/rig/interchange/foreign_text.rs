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

/// The same with the ends of the elements in which it breaks off, and without a last tag or an
/// element of text that is not whole.
pub(super) fn closed<'a>(text: Cow<'a, str>, notes: &mut Vec<String>) -> Cow<'a, str> {
    let Some((end, open)) = open_at_end(&text) else {
        return text;
    };
    let line = line_number(&text, end);
    let mut whole = text[..end].to_owned();
    for name in open.iter().rev() {
        whole.push_str("</");
        whole.push_str(name);
        whole.push('>');
    }
    let times = counted(open.len(), "element");
    notes.push(format!(
        "it breaks off in line {line}, within {times}: what stands before that is read"
    ));
    Cow::Owned(whole)
}

/// Where a document breaks off, and the elements that are open there; none where it has its end, or
/// is none.
fn open_at_end(text: &str) -> Option<(usize, Vec<&str>)> {
    let sections = [
        ("<!--", "-->"),
        ("<![CDATA[", "]]>"),
        ("<?", "?>"),
        ("<!", ">"),
    ];
    let mut open: Vec<(&str, usize)> = Vec::new();
    let (mut at, mut has_begun) = (0, false);
    let mut end = loop {
        let Some(begin) = text[at..].find('<').map(|it| at + it) else {
            break text.len();
        };
        let rest = &text[begin..];
        let section = sections.iter().find(|(start, _)| rest.starts_with(start));
        let length = match section {
            Some((_, end)) => rest.find(end).map(|it| it + end.len()),
            None => tag_length(rest),
        };
        let Some(length) = length else {
            break begin;
        };
        at = begin + length;
        if section.is_some() {
            continue;
        }
        let inside = &rest[1..length - 1];
        if let Some(name) = inside.strip_prefix('/') {
            // Elsewhere it is broken otherwise.
            if open.pop().map(|it| it.0) != Some(name.trim()) {
                return None;
            }
        } else if !inside.ends_with('/') {
            open.push((inside.split(char::is_whitespace).next()?, begin));
        }
        has_begun = true;
        if open.is_empty() {
            return None;
        }
    };
    // Of a text that breaks off, the rest is unknown.
    if end == text.len()
        && text[at..].contains(|it: char| !it.is_whitespace())
        && let Some((_, begin)) = open.pop()
    {
        end = begin;
    }
    let open: Vec<&str> = open.into_iter().map(|it| it.0).collect();
    (has_begun && !open.is_empty()).then_some((end, open))
}

/// Bytes of a tag up to its end, which no text in quotes is.
fn tag_length(text: &str) -> Option<usize> {
    let mut quote = None;
    for (at, byte) in text.bytes().enumerate() {
        match (quote, byte) {
            (Some(open), _) if open == byte => quote = None,
            (Some(_), _) => {}
            (None, b'"' | b'\'') => quote = Some(byte),
            (None, b'>') => return Some(at + 1),
            (None, _) => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_that_breaks_off_is_closed_where_it_does() {
        let whole = "<?xml version='1.0'?><a x='>'><!-- < --><b/><c>text</c></a>\n";
        let told = |text: &str| {
            let mut notes = Vec::new();
            (closed(text.into(), &mut notes).into_owned(), notes.len())
        };
        assert_eq!(told(whole), (whole.to_owned(), 0));
        for (cut, right) in [
            ("<a x='>'><b/><c>te", "<a x='>'><b/></a>"),
            ("<a x='>'><b/><c>text</", "<a x='>'><b/><c>text</c></a>"),
            ("<a><b y='1", "<a></a>"),
            ("<a><!-- ", "<a></a>"),
        ] {
            assert_eq!(told(cut), (right.to_owned(), 1));
        }
        for other in ["", "<a", "text", "<a></b>", "<a/> <b>"] {
            assert_eq!(told(other), (other.to_owned(), 0));
        }
        for cut in 0..whole.len() {
            told(&whole[..cut]);
        }
    }
}
