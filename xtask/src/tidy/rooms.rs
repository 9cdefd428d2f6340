//! Does a folder hold more Rust files than a reader can keep in mind?

use std::collections::BTreeMap;

use super::Finding;
use super::known::Breach;
use super::source::file::crate_of;
use super::tree::Tree;

/// Rust files of one folder.
const MOST: usize = 16;

/// Counts the Rust files directly in each folder of a crate's sources.
pub(super) fn check(tree: &Tree) -> Vec<Breach> {
    of_paths(tree.files().map(|(path, _)| path))
}

fn of_paths<'a>(paths: impl Iterator<Item = &'a str>) -> Vec<Breach> {
    let mut counts = BTreeMap::<&str, usize>::new();
    for path in paths.filter(|path| crate_of(path).is_some()) {
        if let Some((folder, _)) = path.rsplit_once('/') {
            *counts.entry(folder).or_default() += 1;
        }
    }
    let full = counts.into_iter().filter(|(_, count)| *count > MOST);
    full.map(|(folder, count)| {
        let message = format!("{count} Rust files, at most {MOST}: give some their own folder");
        Breach::new("rooms", folder, Finding::new(folder, 1, message)).counting(count)
    })
    .collect()
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
    fn files_of_folders_inside_do_not_count() {
        let outer = (0..16).map(|k| format!("crates/x/src/f{k}.rs"));
        let inner = (0..16).map(|k| format!("crates/x/src/a/f{k}.rs"));
        let paths: Vec<String> = outer.chain(inner).collect();
        assert!(of_paths(paths.iter().map(String::as_str)).is_empty());
    }
}
