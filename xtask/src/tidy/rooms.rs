//! Does a folder hold more Rust files than a reader can keep in mind?

use super::Finding;
use super::tree::Tree;
use std::collections::BTreeMap;

/// Rust files of one folder.
const MOST: usize = 16;
/// Folders that had more when this was first checked, and how many they may have until then.
const KNOWN: [(&str, usize); 2] = [
    ("crates/core/src/selection", 17),
    ("crates/render/src/twin", 17),
];

/// Counts the Rust files directly in each folder of a crate's sources.
pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    of_paths(tree.files().map(|(path, _)| path))
}

fn of_paths<'a>(paths: impl Iterator<Item = &'a str>) -> Vec<Finding> {
    let mut counts = BTreeMap::<&str, usize>::new();
    for path in paths.filter(|path| path.ends_with(".rs")) {
        if let Some((folder, _)) = path.rsplit_once('/')
            && folder.starts_with("crates/")
            && folder.contains("/src")
        {
            *counts.entry(folder).or_default() += 1;
        }
    }
    let finding = |(folder, count): (&str, usize)| {
        let known = KNOWN.iter().find(|(known, _)| *known == folder);
        let most = known.map_or(MOST, |(_, most)| *most);
        let message = match known {
            Some(_) if count <= MOST => "has room again: take it off the list in rooms.rs".into(),
            _ if count <= most => return None,
            _ => format!("{count} Rust files, at most {most}: give some a folder of their own"),
        };
        Some(Finding::new(folder, 1, message))
    };
    counts.into_iter().filter_map(finding).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(folder: &str, files: usize) -> usize {
        let paths: Vec<String> = (0..files).map(|k| format!("{folder}/f{k}.rs")).collect();
        of_paths(paths.iter().map(String::as_str)).len()
    }

    #[test]
    fn a_folder_of_seventeen_files_is_too_full_and_one_of_sixteen_is_not() {
        assert_eq!(found("crates/media/src/read", 17), 1);
        assert_eq!(found("crates/media/src/read", 16), 0);
        assert_eq!(found("crates/media/tests", 40), 0);
    }

    #[test]
    fn a_known_folder_may_not_grow_and_leaves_the_list_once_it_has_room() {
        let (folder, most) = KNOWN[0];
        assert_eq!(found(folder, most + 1), 1);
        assert_eq!(found(folder, most), 0);
        assert_eq!(found(folder, MOST), 1);
    }
}
