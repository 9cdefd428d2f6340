//! Does every function that the table of papers names exist?

use super::source::lexing::is_word;
use super::{Finding, Tree};

const TABLE: &str = "docs/papers.md";
const ITEMS: [&str; 7] = ["fn", "struct", "enum", "trait", "const", "static", "type"];

/// Checks each `path::name` in backticks of the table's rows.
pub(super) fn check(path: &str, text: &str, tree: &Tree) -> Vec<Finding> {
    if path != TABLE {
        return Vec::new();
    }
    let rows = (1..)
        .zip(text.lines())
        .filter(|(_, line)| line.trim_start().starts_with('|'));
    let named = rows.flat_map(|(number, row)| {
        row.split('`')
            .skip(1)
            .step_by(2)
            .map(move |word| (number, word))
    });
    named
        .filter(|(_, word)| !exists(word, tree))
        .map(|(number, word)| {
            let message = format!("`{word}` is not in the code: correct the row");
            Finding::new(path, number, message)
        })
        .collect()
}

/// Does some source define what `word` names? Words that are no `path::name` need no definition.
fn exists(word: &str, tree: &Tree) -> bool {
    let Some((place, name)) = word.trim_end_matches("()").rsplit_once("::") else {
        return true;
    };
    if !word
        .chars()
        .all(|c| c.is_ascii_alphanumeric() || "_:/.-()".contains(c))
    {
        return true;
    }
    tree.files()
        .filter(|(path, _)| path.ends_with(".rs") || path.ends_with(".wgsl"))
        .filter_map(|(path, file)| Some((path, file.text.as_deref()?)))
        .any(|(path, text)| defines(text, name) && belongs(path, text, place))
}

/// Is the file `path` the one that `place` means: by its path, its module, or a type it defines?
fn belongs(path: &str, text: &str, place: &str) -> bool {
    if place.contains('/') || place.ends_with(".rs") || place.ends_with(".wgsl") {
        let (file, inner) = place.split_once("::").unwrap_or((place, ""));
        let is_file = path == file || path.ends_with(&format!("/{file}"));
        return is_file
            && inner
                .split("::")
                .all(|part| part.is_empty() || text.contains(part));
    }
    let last = place.rsplit("::").next().unwrap_or(place);
    let stem = path.rsplit_once('.').map_or(path, |(stem, _)| stem);
    let crate_folder = last.trim_start_matches("foveal_");
    stem.split('/')
        .any(|part| part == last || part == crate_folder)
        || defines(text, last)
        || text.contains(&format!("mod {last} "))
}

fn defines(text: &str, name: &str) -> bool {
    ITEMS.iter().any(|item| {
        let start = format!("{item} {name}");
        text.match_indices(&start)
            .any(|(at, _)| !text[at + start.len()..].starts_with(is_word))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(table: &str) -> Vec<usize> {
        let tree = Tree::of_texts(&[(
            "crates/core/src/perception/acuity.rs",
            "pub struct Model;\nimpl Model { pub fn limit() {} }\nfn mar() {}\n\
             mod tests { fn falls_with_eccentricity() {} }",
        )]);
        check(TABLE, table, &tree)
            .iter()
            .map(|finding| finding.line)
            .collect()
    }

    #[test]
    fn rows_that_name_code_pass() {
        let table = "| eq 1 | `perception::acuity::mar` | `Model::limit()` | `w * x` |\n\
                     | `crates/core/src/perception/acuity.rs::mar` | `acuity::Model` |\n\
                     | `acuity.rs::tests::falls_with_eccentricity` \
                     `foveal_core::perception::mar` |";
        assert!(lines(table).is_empty(), "{:?}", lines(table));
    }

    #[test]
    fn rows_that_name_what_is_gone_do_not() {
        assert_eq!(lines("text `acuity::gone`\n| a |\n| `acuity::gone` |"), [3]);
        assert_eq!(
            lines("| `acuity::ma` |"),
            [1],
            "a part of a name is no name"
        );
        assert_eq!(
            lines("| `selection::mar` |"),
            [1],
            "another module's function"
        );
        assert_eq!(lines("| `crates/core/src/gaze.rs::mar` |"), [1]);
        assert_eq!(lines("| `Gone::limit` |"), [1]);
    }
}
