//! Can ARCHITECTURE.md be read in one go, and does it name every room?

use std::collections::BTreeSet;

use super::Finding;
use super::known::Breach;
use super::source::file::crate_of;
use super::tree::Tree;

const DOCUMENT: &str = "ARCHITECTURE.md";
const MOST_LINES: usize = 150;
const MOST_WORDS: usize = 1_300;
const CODE_MAP: &str = "## Code map";

/// Checks the length of the document, and its code map against the folders of crates.
pub(super) fn check(tree: &Tree) -> Vec<Breach> {
    let text = tree.text(DOCUMENT).unwrap_or_default();
    let lengths = [
        ("lines", text.lines().count(), MOST_LINES),
        ("words", text.split_whitespace().count(), MOST_WORDS),
    ];
    let long = lengths.into_iter().filter(|(_, count, most)| count > most);
    let long = long.map(|(what, count, most)| {
        let message = format!("{count} {what}, at most {most}: leave out what the code says");
        let finding = Finding::new(DOCUMENT, 1, message);
        Breach::new("architecture", what, finding).counting(count)
    });
    let map = code_map(text);
    let unnamed = rooms(tree).into_iter().filter(|room| !names(map, room));
    let unnamed = unnamed.map(|room| {
        let message = format!("the code map does not name `{room}/`: say what it answers");
        Breach::new("architecture", room, Finding::new(DOCUMENT, 1, message))
    });
    long.chain(unnamed).collect()
}

/// The document from the head of its code map to the next head of the same rank.
fn code_map(text: &str) -> &str {
    let map = text.split_once(CODE_MAP).map_or("", |(_, map)| map);
    map.split_once("\n## ").map_or(map, |(map, _)| map)
}

/// Folders that lie directly in the sources of a crate.
fn rooms(tree: &Tree) -> BTreeSet<&str> {
    let sources = tree.files().map(|(path, _)| path);
    sources
        .filter(|path| crate_of(path).is_some())
        .filter_map(|path| {
            let slashes: Vec<usize> = path.match_indices('/').map(|(at, _)| at).collect();
            slashes.get(3).map(|&end| &path[..end])
        })
        .collect()
}

/// Does `map` name the folder itself, and not only a file in it?
fn names(map: &str, folder: &str) -> bool {
    map.match_indices(folder).any(|(at, _)| {
        let after = &map[at + folder.len()..];
        let after = after.strip_prefix('/').unwrap_or(after);
        !after.starts_with(|c: char| c.is_alphanumeric() || "_-./{*".contains(c))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(document: &str) -> Vec<String> {
        let tree = Tree::of_texts(&[
            (DOCUMENT, document),
            ("crates/x/src/lib.rs", ""),
            ("crates/x/src/room/mod.rs", ""),
            ("crates/x/src/room/inner/mod.rs", ""),
            ("crates/x/tests/room/mod.rs", ""),
        ]);
        let found = check(&tree);
        found.iter().map(|breach| breach.key().to_owned()).collect()
    }

    const MAP: &str = "## Code map\n`crates/x/src/room/`\n";

    #[test]
    fn the_document_has_a_most_of_lines_and_of_words() {
        assert!(keys(&format!("{MAP}{}", "x\n".repeat(148))).is_empty());
        assert_eq!(keys(&format!("{MAP}{}", "x\n".repeat(149))), ["lines"]);
        assert!(keys(&format!("{MAP}{}", "x ".repeat(1_296))).is_empty());
        assert_eq!(keys(&format!("{MAP}{}", "x ".repeat(1_297))), ["words"]);
    }

    #[test]
    fn the_code_map_names_each_folder_of_a_crate_s_sources_itself() {
        assert!(keys(MAP).is_empty());
        for other in [
            "## Code map\n`crates/x/src/room/mod.rs` `crates/x/src/rooms/`",
            "## Code map\n\n## Invariants\n`crates/x/src/room/`",
            "`crates/x/src/room/`",
        ] {
            assert_eq!(keys(other), ["crates/x/src/room"], "{other}");
        }
    }
}
