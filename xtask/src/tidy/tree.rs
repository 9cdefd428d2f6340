//! Which files would a commit hold, and what is in them?

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::steps::output_of;

/// Larger files are reported by size and not read.
pub(super) const LARGEST_FILE: u64 = 1 << 20;

/// A file of the tree.
pub(super) struct File {
    pub(super) bytes: u64,
    /// Nothing where the file is no UTF-8 or is larger than [`LARGEST_FILE`].
    pub(super) text: Option<String>,
}

/// Every tracked file and every new one that git does not ignore, by its path with `/`.
#[derive(Default)]
pub(super) struct Tree {
    files: BTreeMap<String, File>,
}

impl Tree {
    /// The tree of the git checkout at `root`.
    pub(super) fn of(root: &Path) -> Result<Self, String> {
        let listed = output_of(Command::new("git").current_dir(root).args([
            "ls-files",
            "-z",
            "--cached",
            "--others",
            "--exclude-standard",
        ]))
        .map_err(|e| format!("{e}; tidy reads a git checkout"))?;
        let mut files = BTreeMap::new();
        for path in listed.split('\0').filter(|path| !path.is_empty()) {
            // A file that is tracked and gone is a deletion not yet committed.
            let Ok(about) = fs::metadata(root.join(path)) else {
                continue;
            };
            if !about.is_file() {
                continue;
            }
            let text = if about.len() <= LARGEST_FILE {
                let bytes =
                    fs::read(root.join(path)).map_err(|e| format!("{path} cannot be read: {e}"))?;
                String::from_utf8(bytes).ok()
            } else {
                None
            };
            files.insert(
                path.to_owned(),
                File {
                    bytes: about.len(),
                    text,
                },
            );
        }
        Ok(Self { files })
    }

    #[cfg(test)]
    pub(super) fn of_texts(files: &[(&str, &str)]) -> Self {
        let file = |text: &str| File {
            bytes: text.len() as u64,
            text: Some(text.to_owned()),
        };
        Self {
            files: files
                .iter()
                .map(|(path, text)| ((*path).to_owned(), file(text)))
                .collect(),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.files.len()
    }

    pub(super) fn files(&self) -> impl Iterator<Item = (&str, &File)> {
        self.files.iter().map(|(path, file)| (path.as_str(), file))
    }

    pub(super) fn text(&self, path: &str) -> Option<&str> {
        self.files.get(path)?.text.as_deref()
    }

    /// Is `path` a file of the tree, or a folder that holds one?
    pub(super) fn has(&self, path: &str) -> bool {
        let path = path.trim_end_matches('/');
        let folder = format!("{path}/");
        path.is_empty()
            || self.files.contains_key(path)
            || self
                .files
                .range(folder.clone()..)
                .next()
                .is_some_and(|(f, _)| f.starts_with(&folder))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tree_has_its_files_and_their_folders_and_nothing_else() {
        let tree = Tree::of_texts(&[("docs/formats/pack.md", ""), ("docs-old.md", "")]);
        for path in [
            "docs",
            "docs/",
            "docs/formats",
            "docs/formats/pack.md",
            "docs-old.md",
        ] {
            assert!(tree.has(path), "{path}");
        }
        for path in [
            "doc",
            "docs/format",
            "docs/formats/pack",
            "docs/formats/pack.md/x",
        ] {
            assert!(!tree.has(path), "{path}");
        }
    }
}
