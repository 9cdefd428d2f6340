//! Which text do the bytes of another program's file hold?

use super::super::error::{NEXT, RigFault};
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
            Err(RigFault::new(&place, "is no text in UTF-8 or UTF-16", NEXT))
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
