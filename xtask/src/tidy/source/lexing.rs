//! Which characters of a Rust or WGSL file are code, and which of them ship?
//!
//! Enough of the grammar for line rules: what is not wanted becomes spaces, lines stay where they
//! were.

/// `text` with comments, strings and character literals as spaces.
pub(crate) fn code(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let mut kept = String::with_capacity(text.len());
    let mut at = 0;
    while at < chars.len() {
        let end = skipped_to(&chars, at);
        if end == at {
            kept.push(chars[at]);
            at += 1;
        } else {
            kept.extend(
                chars[at..end]
                    .iter()
                    .map(|&c| if c == '\n' { c } else { ' ' }),
            );
            at = end;
        }
    }
    kept
}

/// Where the comment or literal that starts at `at` ends; `at` when none starts there.
fn skipped_to(chars: &[char], at: usize) -> usize {
    let next = chars.get(at + 1).copied();
    match (chars[at], next) {
        ('/', Some('/')) => position(chars, at, |c| c == '\n').unwrap_or(chars.len()),
        ('/', Some('*')) => comment_end(chars, at),
        ('"', _) => string_end(chars, at + 1),
        ('r', Some('"' | '#')) if !ends_word(chars, at) => {
            raw_string_end(chars, at + 1).unwrap_or(at)
        }
        ('\'', Some('\\')) => {
            position(chars, at + 3, |c| c == '\'').map_or(chars.len(), |end| end + 1)
        }
        ('\'', Some(_)) if chars.get(at + 2) == Some(&'\'') => at + 3,
        _ => at,
    }
}

fn position(chars: &[char], from: usize, wanted: impl Fn(char) -> bool) -> Option<usize> {
    (from..chars.len()).find(|&i| wanted(chars[i]))
}

/// Does the letter at `at` belong to a longer word? The `b` or `c` of a raw string does not count.
fn ends_word(chars: &[char], at: usize) -> bool {
    let before = |i: usize| i.checked_sub(1).map(|i| chars[i]);
    match before(at) {
        Some('b' | 'c') => before(at - 1).is_some_and(is_word),
        Some(c) => is_word(c),
        None => false,
    }
}

/// Block comments nest.
fn comment_end(chars: &[char], start: usize) -> usize {
    let mut depth = 0;
    let mut at = start;
    while at < chars.len() {
        match (chars[at], chars.get(at + 1)) {
            ('/', Some('*')) => {
                depth += 1;
                at += 2;
            }
            ('*', Some('/')) => {
                depth -= 1;
                at += 2;
                if depth == 0 {
                    return at;
                }
            }
            _ => at += 1,
        }
    }
    chars.len()
}

fn string_end(chars: &[char], mut at: usize) -> usize {
    while at < chars.len() {
        match chars[at] {
            '\\' => at += 2,
            '"' => return at + 1,
            _ => at += 1,
        }
    }
    chars.len()
}

/// The end of a raw string whose `#`s begin at `at`; none when it is a raw identifier.
fn raw_string_end(chars: &[char], at: usize) -> Option<usize> {
    let hashes = chars[at..].iter().take_while(|&&c| c == '#').count();
    if chars.get(at + hashes) != Some(&'"') {
        return None;
    }
    let closes = |i: usize| {
        chars[i] == '"'
            && chars[i + 1..]
                .iter()
                .take(hashes)
                .filter(|&&c| c == '#')
                .count()
                == hashes
    };
    let first = at + hashes + 1;
    Some(
        (first..chars.len())
            .find(|&i| closes(i))
            .map_or(chars.len(), |i| i + 1 + hashes),
    )
}

pub(crate) fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The code of `text` without the items under `#[cfg(test)]`.
pub(crate) fn shipped_code(text: &str) -> String {
    let mut chars: Vec<char> = code(text).chars().collect();
    for attribute in ["#[cfg(test)]", "#[cfg(all(test", "#![cfg(test)]"] {
        let wanted: Vec<char> = attribute.chars().collect();
        let mut at = 0;
        while at + wanted.len() <= chars.len() {
            if chars[at..at + wanted.len()] != wanted[..] {
                at += 1;
                continue;
            }
            let end = if attribute.starts_with("#!") {
                chars.len()
            } else {
                item_end(&chars, position(&chars, at, |c| c == ']').unwrap_or(at) + 1)
            };
            chars[at..end]
                .iter_mut()
                .filter(|c| **c != '\n')
                .for_each(|c| *c = ' ');
            at = end;
        }
    }
    chars.into_iter().collect()
}

/// The end of the item that starts at `start`: its closing brace, or its `;`.
fn item_end(chars: &[char], start: usize) -> usize {
    match body_start(chars, start) {
        Some(open) if chars[open] == '{' => {
            let close = closing_brace(chars, open);
            let after = position(chars, close, |c| !c.is_whitespace());
            if after.is_some_and(|i| chars[i] == ';') {
                close + 1
            } else {
                close
            }
        }
        Some(end) => end + 1,
        None => chars.len(),
    }
}

/// The first `{` or `;` from `start` on that stands in no parenthesis or bracket.
pub(crate) fn body_start(chars: &[char], start: usize) -> Option<usize> {
    let mut depth = 0;
    (start..chars.len()).find(|&i| {
        match chars[i] {
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            _ => {}
        }
        depth == 0 && matches!(chars[i], '{' | ';')
    })
}

/// One past the brace that closes the one at `open`.
pub(crate) fn closing_brace(chars: &[char], open: usize) -> usize {
    let mut depth = 0;
    for (i, c) in chars.iter().enumerate().skip(open) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return i + 1;
        }
    }
    chars.len()
}

/// The line, counted from 1, on which the byte `at` of `text` stands.
pub(crate) fn line_of(text: &str, at: usize) -> usize {
    text.as_bytes()[..at]
        .iter()
        .filter(|&&b| b == b'\n')
        .count()
        + 1
}

/// Where `word` stands in `text` with no letter, digit or `_` before it.
pub(crate) fn places_of<'a>(text: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    text.match_indices(word)
        .map(|(at, _)| at)
        .filter(|&at| !text[..at].chars().next_back().is_some_and(is_word))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        text.split_whitespace().map(str::to_owned).collect()
    }

    #[test]
    fn comments_and_literals_are_no_code() {
        let text = r##"a /* b /* c */ d */ e // f
            "g\" h" i 'j' '\'' '\u{7B}' k r#"l " m"# n br"o" p"##;
        assert_eq!(words(&code(text)), ["a", "e", "i", "k", "n", "b", "p"]);
    }

    #[test]
    fn lifetimes_and_raw_identifiers_are_code() {
        let text = "fn f<'a>(x: &'a str, r#type: u8) -> &'a str { x }";
        assert_eq!(code(text), text);
    }

    #[test]
    fn lines_stay_where_they_were() {
        let text = "a\n/* b\n */ c\n\"d\n e\" f\n";
        assert_eq!(code(text).lines().count(), text.lines().count());
        assert_eq!(code(text).lines().nth(2), Some("    c"));
    }

    #[test]
    fn items_under_cfg_test_do_not_ship() {
        let text =
            "use a::b;\n#[cfg(test)]\nuse c::{d, e};\n#[cfg(test)]\nmod tests { f { } }\ng();";
        assert_eq!(words(&shipped_code(text)), ["use", "a::b;", "g();"]);
        let text = "#[cfg(all(test, feature))]\nfn x(a: [u8; 4]) { y }\nz();";
        assert_eq!(words(&shipped_code(text)), ["z();"]);
        assert_eq!(words(&shipped_code("#![cfg(test)]\nz();")), [""; 0]);
    }

    #[test]
    fn a_word_inside_another_is_not_found() {
        let found: Vec<usize> =
            places_of("xcrate:: crate:: _crate:: $crate::", "crate::").collect();
        assert_eq!(found, [9, 27]);
        assert_eq!(line_of("a\nb\nc", 4), 3);
    }
}
