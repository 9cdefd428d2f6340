//! Does any prose use a word that has a plainer one?

use super::source::lexing::{code, is_word};
use super::source::typescript::comments_and_texts;
use super::{Finding, Tree};

/// One entry a line: what is refused, the better word, and the reason, with `; ` between them.
/// A `|` stands between words of which any is meant.
const LIST: &str = "xtask/words.txt";
/// A line that has this is left as it is.
const MARKER: &str = "words: ok";
/// In these, only comments and strings are read.
const RUST: [&str; 2] = ["rs", "wgsl"];
const TYPESCRIPT: [&str; 3] = ["ts", "js", "mjs"];
/// In these, everything is.
const PROSE: [&str; 8] = ["md", "css", "json", "html", "toml", "py", "sh", "cff"];
/// What opens or continues a comment: at the start of a line it is no punctuation.
const COMMENT_SIGNS: [char; 5] = ['/', '!', '*', '#', '>'];

/// A pattern that prose is kept free of.
struct Entry<'a> {
    /// Of each word of the pattern, the forms that it may have.
    words: Vec<Vec<&'a str>>,
    better: &'a str,
    reason: &'a str,
}

/// A word of prose, or a sign that ends a phrase.
struct Token {
    text: String,
    line: usize,
}

/// Checks every file that people read, by the list of the tree.
pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    let Some(list) = tree.text(LIST) else {
        return Vec::new();
    };
    let mut findings = Vec::new();
    let entries = entries(list, &mut findings);
    for (path, file) in tree.files() {
        if let Some(text) = file.text.as_deref().filter(|_| path != LIST) {
            findings.extend(refused(path, text, &entries));
        }
    }
    findings
}

fn entries<'a>(list: &'a str, findings: &mut Vec<Finding>) -> Vec<Entry<'a>> {
    let mut entries = Vec::new();
    for (number, line) in (1..).zip(list.lines()) {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let parts: Vec<&str> = line.split("; ").collect();
        let [pattern, better, reason] = parts[..] else {
            let message = "write `pattern; better word; reason`";
            findings.push(Finding::new(LIST, number, message));
            continue;
        };
        let words = pattern.split(' ').map(|word| word.split('|').collect());
        entries.push(Entry {
            words: words.collect(),
            better,
            reason,
        });
    }
    entries
}

fn refused(path: &str, text: &str, entries: &[Entry<'_>]) -> Vec<Finding> {
    let ending = path.rsplit_once('.').map_or("", |(_, ending)| ending);
    let prose = if RUST.contains(&ending) {
        comments_and_strings(text)
    } else if TYPESCRIPT.contains(&ending) {
        comments_and_texts(text)
    } else if PROSE.contains(&ending) || path == "Makefile" {
        text.to_owned()
    } else {
        return Vec::new();
    };
    let lines: Vec<&str> = text.lines().collect();
    let is_marked = |line: usize| lines.get(line - 1).is_some_and(|l| l.contains(MARKER));
    let tokens = tokens(&prose);
    let mut findings = Vec::new();
    for at in 0..tokens.len() {
        for entry in entries.iter().filter(|entry| entry.starts(&tokens[at..])) {
            let found = &tokens[at..at + entry.words.len()];
            if found.iter().any(|token| is_marked(token.line)) {
                continue;
            }
            let words: Vec<&str> = found.iter().map(|token| token.text.as_str()).collect();
            let message = format!(
                "\"{}\": write {} ({}), or mark the line `{MARKER}`",
                words.join(" "),
                entry.better,
                entry.reason
            );
            findings.push(Finding::new(path, tokens[at].line, message));
        }
    }
    findings
}

impl Entry<'_> {
    fn starts(&self, tokens: &[Token]) -> bool {
        tokens.len() >= self.words.len()
            && self
                .words
                .iter()
                .zip(tokens)
                .all(|(forms, token)| forms.contains(&token.text.as_str()))
    }
}

/// `text` with everything but comments and literals as spaces.
fn comments_and_strings(text: &str) -> String {
    let code = code(text);
    text.chars()
        .zip(code.chars())
        .map(|(c, kept)| if c == kept && c != '\n' { ' ' } else { c })
        .collect()
}

/// The words in small letters, across the ends of lines; what stands in backticks is one sign.
fn tokens(prose: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    for (line, text) in (1..).zip(prose.lines()) {
        let text = text.trim_start().trim_start_matches(COMMENT_SIGNS);
        let is_fence = text.starts_with("``");
        let text = text.trim_end().trim_end_matches('\\').trim_end();
        for (nth, part) in text.split('`').enumerate() {
            if nth % 2 == 1 && !is_fence {
                tokens.push(sign(line));
                continue;
            }
            tokens.extend(tokens_of(part, line));
        }
    }
    tokens
}

fn tokens_of(part: &str, line: usize) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut word = String::new();
    let mut is_name = false;
    for c in part.chars().chain([' ']) {
        if is_word(c) || c == '\'' {
            word.extend(c.to_lowercase());
            continue;
        }
        if !word.is_empty() {
            let text = std::mem::take(&mut word).trim_matches('\'').to_owned();
            // What stands in braces is the name of a value.
            let text = if is_name { String::new() } else { text };
            tokens.push(Token { text, line });
        }
        is_name = c == '{';
        if !c.is_whitespace() {
            tokens.push(sign(line));
        }
    }
    tokens
}

fn sign(line: usize) -> Token {
    Token {
        text: String::new(),
        line,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENTRIES: &str = "# why\n\nquux; foo; it is no word\nis|are zapped; sees; passive\n";

    fn found(path: &str, text: &str) -> Vec<String> {
        let tree = Tree::of_texts(&[(LIST, ENTRIES), (path, text)]);
        check(&tree).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_word_of_the_list_is_refused_with_the_better_one() {
        let all = found("docs/a.md", "Fine.\nHere Quux stands.");
        let message = "\"quux\": write foo (it is no word), or mark the line `words: ok`";
        assert_eq!(all, [format!("docs/a.md:2: {message}")]);
        assert!(found("docs/a.md", "quuxes and my_quux and `quux`").is_empty());
    }

    #[test]
    fn a_phrase_is_found_across_lines_and_not_across_punctuation() {
        for text in [
            "/// It is\n/// zapped.",
            "//! They are zapped",
            "f(\"is \\\n zapped\")",
        ] {
            assert_eq!(found("a.rs", text).len(), 1, "{text}");
        }
        assert!(found("a.rs", "// that is: zapped").is_empty());
        assert_eq!(found("b.html", "<p>it is\n zapped</p>").len(), 1);
    }

    #[test]
    fn in_code_only_comments_and_strings_are_read() {
        assert!(found("a.rs", "let quux = 1; // fine").is_empty());
        assert_eq!(found("a.rs", "let a = \"quux\";").len(), 1);
        assert!(found("a.rs", "let a = \"{quux:?}\";").is_empty());
        assert_eq!(found("a.wgsl", "// quux").len(), 1);
        assert_eq!(found("a.ts", "const quux = `a quux`; // quux").len(), 2);
        assert!(found("a.png", "quux").is_empty());
    }

    #[test]
    fn a_marked_line_is_left_and_a_broken_entry_is_named() {
        assert!(found("a.rs", "// a quux (words: ok)").is_empty());
        assert!(found("a.md", "A quux. <!-- words: ok -->").is_empty());
        let tree = Tree::of_texts(&[(LIST, "quux; foo\n")]);
        assert_eq!(check(&tree).len(), 1);
    }
}
