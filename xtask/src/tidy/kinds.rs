//! Does a kind of content stay in its own folders?
//!
//! Core's choices and packs name nothing that only one kind has. What else serves all kinds names
//! none of them: each is registered once in a crate, and what differs stands in a table of facts.

use std::collections::{BTreeMap, BTreeSet};

use super::Finding;
use super::known::Breach;
use super::source::file::Scope;
use super::source::modules::Modules;
use super::tree::Tree;

/// Each folder is a kind, but for what chooses among all of them.
const KINDS: &str = "crates/core/src/content/";
const NO_KIND: &str = "policy";
/// Kinds of assets, which programs open apart. All others are units of a scene.
const ASSETS: [&str; 2] = ["scene", "video"];
/// How else a kind is called: its room where it is drawn, and variants of [`ENUMS`].
const ALSO: [(&str, &[&str]); 4] = [
    ("images", &["pages", "Image"]),
    ("mesh", &["meshes"]),
    ("points", &["Cloud"]),
    ("video", &["tiles", "Picture"]),
];
/// What has a variant for each kind.
const ENUMS: [&str; 4] = ["UnitKind", "Payload", "PayloadView", "Shape"];
/// What a path has before the room of a kind.
const BEFORE: [&str; 3] = ["content", "crate", "foveal_render"];

/// These serve every kind of content alike.
const CHOOSING: [&str; 3] = [
    "crates/core/src/selection",
    "crates/core/src/session",
    "crates/core/src/pack",
];
/// These serve every kind of unit of a scene alike.
const OF_ALL_UNITS: [&str; 9] = [
    "crates/core/src/content/scene",
    "crates/render/src/asset_drawer",
    "crates/render/src/drawer",
    "crates/render/src/drawn_scene",
    "crates/render/src/scene",
    "crates/render/src/scene_drawer",
    "crates/play/src",
    "crates/web/src",
    "crates/app/src",
];
/// What may name kinds of units all the same, and why.
const ALLOWED: [(&str, &str); 9] = [
    (
        "crates/core/src/content/scene/kind.rs",
        "the table of facts",
    ),
    (
        "crates/core/src/content/scene/description.rs",
        "the shapes of objects",
    ),
    (
        "crates/core/src/content/scene/object_table.rs",
        "parses objects",
    ),
    ("crates/core/src/content/scene/pack.rs", "parses units"),
    (
        "crates/core/src/content/scene/whole.rs",
        "parses whole packs",
    ),
    (
        "crates/core/src/content/scene/scripted.rs",
        "builds a scene for tests",
    ),
    (
        "crates/app/src/commands/bench/scene/building.rs",
        "times the building and parsing of meshes",
    ),
    (
        "crates/app/src/commands/bench/scene/points.rs",
        "compares clouds with a sample of their points",
    ),
    (
        "crates/app/src/commands/bench/scene/degenerate.rs",
        "builds clouds of equal points",
    ),
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

/// What names a kind though it serves all, counted for each file.
pub(super) fn check(tree: &Tree, crates: &BTreeMap<&str, Modules>) -> Vec<Breach> {
    let kinds = kinds(tree);
    let mut met: BTreeMap<&str, (usize, Vec<String>, usize)> = BTreeMap::new();
    for (_, module) in crates.values().flat_map(Modules::iter) {
        for (line, name) in named(&kinds, &module.file, &module.scope) {
            let (count, names, first) = met.entry(&module.file).or_insert((0, Vec::new(), line));
            *count += 1;
            *first = line.min(*first);
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    let idle = ALLOWED
        .iter()
        .filter(|(file, _)| tree.has(file) && !met.contains_key(file));
    let idle = idle.map(|(file, reason)| {
        let message = format!("names no kind any more: take it off the list ({reason})");
        Breach::new(
            "kinds",
            format!("{file} idle"),
            Finding::new(file, 1, message),
        )
    });
    let idle: Vec<Breach> = idle.collect();
    let is_allowed = |file: &str| ALLOWED.iter().any(|(allowed, _)| *allowed == file);
    let breaches = met.into_iter().filter(|(file, _)| !is_allowed(file));
    let breaches = breaches.map(|(file, (count, names, line))| {
        let message = format!(
            "{count} times what only one kind has ({}): say what any content has, or move it",
            names.join(", ")
        );
        Breach::new("kinds", file, Finding::new(file, line, message)).counting(count)
    });
    breaches.chain(idle).collect()
}

/// A kind of content, with all that its rooms and variants are called.
struct Kind<'a> {
    folder: &'a str,
    names: Vec<String>,
}

impl<'a> Kind<'a> {
    fn new(folder: &'a str) -> Self {
        let also = ALSO.iter().filter(|(kind, _)| *kind == folder);
        let also = also.flat_map(|(_, names)| names.iter().map(|name| (*name).to_owned()));
        let names = [folder.to_owned(), capitalised(folder)];
        Self {
            folder,
            names: names.into_iter().chain(also).collect(),
        }
    }
}

fn kinds(tree: &Tree) -> Vec<Kind<'_>> {
    let inside = tree
        .files()
        .filter_map(|(path, _)| path.strip_prefix(KINDS));
    let folders = inside.filter_map(|path| Some(path.split_once('/')?.0));
    let folders: BTreeSet<&str> = folders.filter(|it| *it != NO_KIND).collect();
    folders.into_iter().map(Kind::new).collect()
}

fn capitalised(word: &str) -> String {
    let (first, rest) = word.split_at(word.len().min(1));
    first.to_uppercase() + rest
}

fn is_in(file: &str, rooms: &[&str]) -> bool {
    rooms.iter().any(|room| {
        let rest = file.strip_prefix(room);
        rest.is_some_and(|rest| rest.starts_with('/') || rest == ".rs")
    })
}

/// Each identifier and path that names a kind though its file serves all, with its line; a path's
/// is that of the first name in its file that is its last.
fn named(kinds: &[Kind<'_>], file: &str, scope: &Scope) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let chooses = is_in(file, &CHOOSING);
    if chooses {
        let names = scope.names.iter().filter(|name| is_of_one_kind(&name.text));
        found.extend(names.map(|name| (name.line, name.text.clone())));
    } else if !is_in(file, &OF_ALL_UNITS) {
        return found;
    }
    let imports = scope.imports.iter().map(|import| &import.path);
    for path in imports.chain(&scope.paths) {
        let of_kinds = kinds
            .iter()
            .filter(|kind| chooses || !ASSETS.contains(&kind.folder));
        let name = of_kinds.flat_map(|kind| &kind.names).find(|name| {
            let mut pairs = path.windows(2);
            pairs.any(|pair| {
                let before = pair[0].as_str();
                pair[1] == **name && (BEFORE.contains(&before) || ENUMS.contains(&before))
            })
        });
        if let Some(name) = name {
            let line = scope.names.iter().find(|it| it.text == *name);
            found.push((line.map_or(1, |it| it.line), path.join("::")));
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

    fn told(room: &str, text: &str) -> Vec<String> {
        let file = format!("crates/core/src/{room}/a.rs");
        let root = format!("mod {room};");
        let folder = format!("crates/core/src/{room}/mod.rs");
        told_of(
            "core",
            &[
                ("crates/core/src/lib.rs", root.as_str()),
                (&folder, "mod a;"),
                (&file, text),
            ],
        )
    }

    /// What is found in a crate's files, where there are meshes, scenes, terrain and video.
    fn told_of(name: &str, files: &[(&str, &str)]) -> Vec<String> {
        let kinds = ["mesh", "scene", "terrain", "video"];
        let kinds = kinds.map(|kind| format!("{KINDS}{kind}/mod.rs"));
        let all = kinds.iter().map(|path| (path.as_str(), ""));
        let all: Vec<(&str, &str)> = all.chain(files.iter().copied()).collect();
        let tree = Tree::of_texts(&all);
        let crates = BTreeMap::from([(name, Modules::of_crate(&tree, name))]);
        check(&tree, &crates).iter().map(Breach::told).collect()
    }

    #[test]
    fn what_serves_all_units_names_no_folder_room_or_variant_of_a_kind() {
        for text in [
            "use foveal_core::content::terrain::Height;",
            "use foveal_core::content::{mesh::payload, unit};",
            "fn f(x: UnitKind) -> bool { matches!(x, UnitKind::Terrain) }",
            "fn f(x: Payload) { match x { Payload::Mesh(_) => {} _ => {} } }",
            "use foveal_render::meshes::unit_bytes;",
        ] {
            for name in ["app", "play", "web"] {
                let file = format!("crates/{name}/src/lib.rs");
                assert_eq!(told_of(name, &[(&file, text)]).len(), 1, "{text}");
            }
        }
        let in_render = |file: &str, text| {
            let file = format!("crates/render/src/{file}.rs");
            let root = ("crates/render/src/lib.rs", "mod kinds; mod scene;");
            told_of("render", &[root, (&file, text)]).len()
        };
        let text = "use crate::meshes::layer::MeshLayer; use crate::terrain::layer::A;";
        assert_eq!([in_render("scene", text), in_render("kinds", text)], [1, 0]);
    }

    #[test]
    fn programs_open_assets_apart_and_units_are_named_where_a_reason_is_given() {
        let open = "fn f(x: Opened) { match x { Opened::Scene(_) => {} _ => {} } }
                    use foveal_core::content::{scene::Scene, video::Video};
                    fn g() { UnitKind::ALL; }";
        assert!(told_of("play", &[("crates/play/src/lib.rs", open)]).is_empty());
        let parses = |file: &str, text| {
            let file = format!("crates/core/src/content/scene/{file}.rs");
            let root = ("crates/core/src/lib.rs", "mod content;");
            let content = ("crates/core/src/content.rs", "mod scene;");
            let scene = (
                "crates/core/src/content/scene.rs",
                "mod kind; mod worth; mod pack;",
            );
            told_of("core", &[root, content, scene, (&file, text)])
        };
        let text = "fn f() { UnitKind::Mesh; }";
        assert_eq!(parses("worth", text).len(), 1);
        assert!(parses("pack", text).is_empty());
        let idle = parses("pack", "fn f() {}");
        assert!(idle[0].contains("names no kind any more"), "{idle:?}");
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
