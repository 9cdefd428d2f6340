//! Are the sentences of the documents short enough to be read once?
//!
//! Nine of ten sentences of a document have at most 25 words. Tables, code and what programs write
//! do not count.

use super::Finding;

/// Most words of a usual sentence.
const WORDS: usize = 25;
/// Of so many sentences one may be longer.
const ONE_OF: usize = 10;
/// Offenders that are shown.
const SHOWN: usize = 5;
/// Written by programs, or the record of past choices.
const EXEMPT: [&str; 2] = ["docs/commands.md", "docs/decisions/"];
/// Abbreviations whose full stop ends no sentence.
const ABBREVIATIONS: [&str; 8] = ["e.g", "i.e", "et al", "etc", "Fig", "Eq", "vs", "p"];

/// A sentence, and the line that it begins on.
struct Sentence {
    line: usize,
    text: String,
}

impl Sentence {
    fn words(&self) -> usize {
        let is_word = |word: &&str| word.contains(char::is_alphanumeric);
        self.text.split_whitespace().filter(is_word).count()
    }
}

/// Checks README.md and the documents.
pub(super) fn check(path: &str, text: &str) -> Vec<Finding> {
    let is_document = path == "README.md" || path.starts_with("docs/") && path.ends_with(".md");
    if !is_document || EXEMPT.iter().any(|exempt| path.starts_with(exempt)) {
        return Vec::new();
    }
    let sentences = sentences(text);
    let mut long: Vec<&Sentence> = sentences.iter().filter(|it| it.words() > WORDS).collect();
    let most = sentences.len().div_ceil(ONE_OF);
    if long.len() <= most {
        return Vec::new();
    }
    long.sort_by_key(|sentence| std::cmp::Reverse(sentence.words()));
    let share = |sentence: &&Sentence| {
        let begin: Vec<&str> = sentence.text.split_whitespace().take(6).collect();
        let message = format!(
            "{} words from \"{} ..\", and {} of {} sentences have more than {WORDS}: split it",
            sentence.words(),
            begin.join(" "),
            long.len(),
            sentences.len()
        );
        Finding::new(path, sentence.line, message)
    };
    long.iter().take(SHOWN).map(share).collect()
}

/// The sentences of paragraphs and of the items of lists.
fn sentences(text: &str) -> Vec<Sentence> {
    let mut found = Vec::new();
    let mut block = Sentence {
        line: 1,
        text: String::new(),
    };
    let (mut is_code, mut is_generated) = (false, false);
    for (line, text) in (1..).zip(text.lines()) {
        let trimmed = text.trim();
        is_code ^= trimmed.starts_with("```");
        is_generated |= trimmed.starts_with("<!-- measured");
        let skips = is_code || is_generated || trimmed.starts_with("```");
        is_generated &= !trimmed.starts_with("<!-- end");
        let is_item = item(trimmed).is_some();
        let is_indented = text.starts_with("    ") && !is_item && block.text.is_empty();
        let is_apart = trimmed.is_empty() || trimmed.starts_with(['#', '|', '<', '!']);
        if skips || is_apart || is_item {
            split(&block, &mut found);
            block.text.clear();
        }
        if skips || is_apart || is_indented {
            continue;
        }
        if block.text.is_empty() {
            block.line = line;
        }
        block.text.push_str(item(trimmed).unwrap_or(trimmed));
        block.text.push(' ');
    }
    split(&block, &mut found);
    found
}

/// The text of an item of a list.
fn item(line: &str) -> Option<&str> {
    let numbered = line
        .split_once(". ")
        .filter(|(number, _)| !number.is_empty() && number.chars().all(|c| c.is_ascii_digit()));
    let bulleted = line.strip_prefix("* ").or_else(|| line.strip_prefix("- "));
    numbered.map(|(_, rest)| rest).or(bulleted)
}

/// Splits a paragraph after full stops, question marks and exclamation marks. Targets of links are
/// left out, and what stands in backticks is one word.
fn split(block: &Sentence, found: &mut Vec<Sentence>) {
    let plain = plain(&block.text);
    let words: Vec<&str> = plain.split_whitespace().collect();
    let mut sentence: Vec<&str> = Vec::new();
    for (at, word) in words.iter().enumerate() {
        sentence.push(word);
        let bare = word.trim_end_matches([')', '*', '"', '”', ']']);
        let is_end = bare.ends_with(['.', '?', '!']) && !bare.ends_with("..");
        let stem = bare.trim_end_matches('.');
        let is_short = ABBREVIATIONS.contains(&stem.trim_start_matches('('))
            || stem == "al" && at > 0 && words[at - 1] == "et";
        if is_end && !is_short || at + 1 == words.len() {
            found.push(Sentence {
                line: block.line,
                text: sentence.join(" "),
            });
            sentence.clear();
        }
    }
}

/// The text without targets of links; what stands in backticks is one word without full stops.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    for (nth, part) in text.split('`').enumerate() {
        if nth % 2 == 1 {
            plain.push_str("code");
            continue;
        }
        let mut rest = part;
        while let Some((before, after)) = rest.split_once("](") {
            plain.push_str(before);
            plain.push(']');
            rest = after.split_once(')').map_or("", |(_, rest)| rest);
        }
        plain.push_str(rest);
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(text: &str) -> Vec<usize> {
        sentences(text).iter().map(Sentence::words).collect()
    }

    #[test]
    fn sentences_end_at_full_stops_and_with_their_paragraph() {
        assert_eq!(
            counts("One two. Three\nfour five? Six\n\nseven"),
            [2, 3, 1, 1]
        );
        assert_eq!(
            counts("* One two\n* three. Four\n1. Five six"),
            [2, 1, 1, 2]
        );
        assert_eq!(
            counts("By Hu et al. 2019, see p. 3, at 0.5 m. Next."),
            [11, 1]
        );
    }

    #[test]
    fn tables_code_headings_and_generated_parts_do_not_count() {
        let text = "# A b c\n\n| a b | c |\n|---|---|\n\n    a b c d\n\n```\na b. c\n```\n\
                    <!-- measured x -->\nA b c. D.\n<!-- end -->\nOne `a b. c` [two](x.md#a).";
        assert_eq!(counts(text), [3]);
    }

    #[test]
    fn more_than_one_long_sentence_of_ten_is_refused() {
        let long = "word ".repeat(26);
        let text = |longs: usize, shorts: usize| {
            format!(
                "{}{}",
                format!("{long}.\n\n").repeat(longs),
                "One.\n\n".repeat(shorts)
            )
        };
        assert!(check("docs/a.md", &text(1, 9)).is_empty());
        let found = check("docs/a.md", &text(2, 8));
        assert_eq!(found.len(), 2);
        assert!(
            found[0].message.starts_with("26 words from \"word word"),
            "{found:?}"
        );
        for free in [
            "docs/commands.md",
            "docs/decisions/0001-a.md",
            "GLOSSARY.md",
        ] {
            assert!(check(free, &text(9, 1)).is_empty(), "{free}");
        }
    }
}
