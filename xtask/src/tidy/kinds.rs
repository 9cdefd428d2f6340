//! Do core's choices and packs stay clear of what only one kind of content has?

use std::collections::BTreeMap;

use super::Finding;
use super::known::Breach;
use super::source::file::Scope;
use super::source::modules::Modules;

/// These serve every kind of content alike.
const ROOMS: [&str; 3] = [
    "crates/core/src/selection",
    "crates/core/src/session",
    "crates/core/src/pack",
];
/// What only video is made of.
const OF_VIDEO: [&str; 6] = ["tile", "tiles", "grid", "grids", "picture", "pictures"];
/// What only scenes are made of. (A session calls all its assets a scene.)
const OF_SCENES: [&str; 14] = [
    "mesh",
    "meshes",
    "triangle",
    "triangles",
    "cluster",
    "clusters",
    "meshlet",
    "meshlets",
    "point",
    "points",
    "texture",
    "textures",
    "vertex",
    "vertices",
];
/// Names of the standard library that have such a word in them.
const OF_THE_LIBRARY: [&str; 1] = ["partition_point"];
/// The rooms of core that hold one kind of content each.
const KINDS: [[&str; 2]; 3] = [
    ["content", "video"],
    ["content", "scene"],
    ["content", "mesh"],
];

/// Identifiers and paths of core's general rooms that only one kind has a meaning for, counted for
/// each file.
pub(super) fn check(core: &Modules) -> Vec<Breach> {
    let mut met: BTreeMap<&str, (usize, Vec<String>, usize)> = BTreeMap::new();
    for (_, module) in core.iter().filter(|(_, module)| is_general(&module.file)) {
        for (line, name) in of_one_kind(&module.scope) {
            let (count, names, first) = met.entry(&module.file).or_insert((0, Vec::new(), line));
            *count += 1;
            *first = line.min(*first);
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    met.into_iter()
        .map(|(file, (count, names, line))| {
            let message = format!(
                "{count} times what only one kind has ({}): say what any content has, or move it",
                names.join(", ")
            );
            Breach::new("kinds", file, Finding::new(file, line, message)).counting(count)
        })
        .collect()
}

fn is_general(file: &str) -> bool {
    ROOMS.iter().any(|room| {
        let rest = file.strip_prefix(room);
        rest.is_some_and(|rest| rest.starts_with('/') || rest == ".rs")
    })
}

/// Each such identifier or path, with its line; a path's is that of its file's first name.
fn of_one_kind(scope: &Scope) -> Vec<(usize, String)> {
    let names = scope.names.iter().filter(|name| is_of_one_kind(&name.text));
    let mut found: Vec<_> = names.map(|name| (name.line, name.text.clone())).collect();
    let imports = scope.imports.iter().map(|import| &import.path);
    for path in imports.chain(&scope.paths) {
        let kind = KINDS
            .iter()
            .find(|kind| path.windows(2).any(|pair| pair == *kind));
        if let Some([_, room]) = kind {
            let line = scope.names.iter().find(|name| name.text == *room);
            found.push((line.map_or(1, |name| name.line), path.join("::")));
        }
    }
    found
}

fn is_of_one_kind(identifier: &str) -> bool {
    let is_of_one = |word: &String| {
        let mut all = OF_VIDEO.iter().chain(&OF_SCENES);
        all.any(|of_one| of_one == word)
    };
    !OF_THE_LIBRARY.contains(&identifier) && words(identifier).iter().any(is_of_one)
}

/// The words of `snake_case`, `CamelCase` or `CAPITALS`, in small letters.
fn words(identifier: &str) -> Vec<String> {
    let chars: Vec<char> = identifier.chars().collect();
    let mut words = vec![String::new()];
    for (at, &c) in chars.iter().enumerate() {
        let before = at.checked_sub(1).map_or('_', |before| chars[before]);
        let next_is_small = chars.get(at + 1).is_some_and(|next| next.is_lowercase());
        let starts = c.is_uppercase() && (before.is_lowercase() || next_is_small);
        if starts || c == '_' || before.is_ascii_digit() != c.is_ascii_digit() {
            words.push(String::new());
        }
        if let (false, Some(word)) = (c == '_', words.last_mut()) {
            word.extend(c.to_lowercase());
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tidy::Tree;

    fn told(room: &str, text: &str) -> Vec<String> {
        let file = format!("crates/core/src/{room}/a.rs");
        let root = format!("mod {room};");
        let folder = format!("crates/core/src/{room}/mod.rs");
        let tree = Tree::of_texts(&[
            ("crates/core/src/lib.rs", root.as_str()),
            (&folder, "mod a;"),
            (&file, text),
        ]);
        check(&Modules::of_crate(&tree, "core"))
            .iter()
            .map(Breach::told)
            .collect()
    }

    #[test]
    fn choices_and_packs_name_no_tile_grid_or_picture() {
        for text in [
            "use crate::asset::TileGrid;",
            "fn f(tile: u8) {}",
            "fn f() { g!(x.picture_size) }",
            "const GRID_SIDE: u8 = 1;",
            "struct S { tiles4: u8 }",
            "struct UVGrid;",
        ] {
            for room in ["selection", "session", "pack"] {
                assert_eq!(told(room, text).len(), 1, "{text}");
            }
            assert!(told("perception", text).is_empty(), "{text}");
        }
        assert!(
            told("session", "fn f(tile: u8, x: Tile) -> Grid {}")[0]
                .starts_with("kinds crates/core/src/session/a.rs 3\n")
        );
    }

    #[test]
    fn nor_do_they_name_what_scenes_are_made_of() {
        for text in [
            "fn f(triangles: u64) {}",
            "struct ClusterRef;",
            "const MOST_POINTS: u8 = 1;",
            "fn f() { g(x.texture_bytes) }",
        ] {
            for room in ["selection", "session", "pack"] {
                assert_eq!(told(room, text).len(), 1, "{text}");
            }
            assert!(told("view", text).is_empty(), "{text}");
        }
        assert!(told("session", "fn scene(pointer: u8) { partition_point() }").is_empty());
    }

    #[test]
    fn nor_do_they_name_the_room_of_a_kind() {
        let each = [
            "use crate::content::{video::Level, unit};",
            "fn f() { crate::content::video::f() }",
            "use crate::content::scene::Scene;",
            "use crate::content::mesh::Level;",
        ];
        for text in each {
            assert_eq!(told("session", text).len(), 1, "{text}");
        }
        assert!(told("session", "use crate::content::unit::Level; fn video() {}").is_empty());
    }

    #[test]
    fn other_words_comments_strings_and_tests_are_free() {
        let text = "/// A tile.\nfn reptile(projectiles: u8, gridlock: u8) { f(\"picture\") }
                    #[cfg(test)] mod tests { fn tile() {} }";
        assert!(told("selection", text).is_empty());
    }
}
