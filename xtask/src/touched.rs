//! Which checks does what differs from the last commit need?

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::steps::{output_of, repository_root, workspace_metadata};

/// The package of the program. Its whole-program tests take minutes.
const PROGRAM: &str = "foveal";
/// Where those tests lie, a file for each part of the program.
const PROGRAM_TESTS: &str = "crates/app/tests/program/";
/// Files that every package is built by.
const OF_ALL: [&str; 4] = [
    "Cargo.toml",
    "Cargo.lock",
    "clippy.toml",
    ".cargo/config.toml",
];

/// Files that differ from the last commit, and the packages they belong to.
pub(crate) struct Touched {
    files: Vec<String>,
    packages: BTreeSet<String>,
}

impl Touched {
    /// Asks git.
    pub(crate) fn since_the_last_commit() -> Result<Self, String> {
        let git = |words: &[&str]| {
            output_of(
                Command::new("git")
                    .current_dir(repository_root())
                    .args(words),
            )
        };
        let changed = git(&["diff", "--name-only", "--no-renames", "HEAD"])?;
        let new = git(&["ls-files", "--others", "--exclude-standard"])?;
        let files = changed.lines().chain(new.lines());
        let files = files.map(str::to_owned).collect();
        Ok(Self::of(files, &folders(&workspace_metadata()?)))
    }

    fn of(files: Vec<String>, folders: &[(String, PathBuf)]) -> Self {
        let mut packages = BTreeSet::new();
        for file in &files {
            let holds = |folder: &Path| Path::new(file).starts_with(folder);
            let within = folders.iter().filter(|(_, folder)| holds(folder));
            // The innermost: xtask has packages of its own within.
            let innermost = within.max_by_key(|(_, folder)| folder.components().count());
            packages.extend(innermost.map(|(name, _)| name.clone()));
            if OF_ALL.contains(&file.as_str()) {
                packages.extend(folders.iter().map(|(name, _)| name.clone()));
            }
        }
        Self { files, packages }
    }

    /// The packages, as arguments of cargo.
    pub(crate) fn packages(&self) -> Vec<String> {
        selected(self.packages.iter())
    }

    /// The tests to run, each as arguments of `cargo test`.
    pub(crate) fn tests(&self) -> Vec<Vec<String>> {
        let others = selected(self.packages.iter().filter(|name| *name != PROGRAM));
        let mut all = Vec::from_iter((!others.is_empty()).then_some(others));
        let program = |words: &[&str]| {
            let words = ["-p", PROGRAM].iter().chain(words);
            words.map(|word| (*word).to_owned()).collect()
        };
        if self.packages.contains(PROGRAM) {
            all.push(program(&["--bins"]));
        }
        for file in &self.files {
            let name = file
                .strip_prefix(PROGRAM_TESTS)
                .and_then(|name| name.strip_suffix(".rs"));
            if let Some(name) = name.filter(|name| !["main", "support", "scenes"].contains(name)) {
                all.push(program(&["--test", "program", &format!("{name}::")]));
            }
        }
        all
    }

    /// Whether the page's own sources differ.
    pub(crate) fn page(&self) -> bool {
        self.files.iter().any(|file| file.starts_with("web/"))
    }

    /// What only `make test` does, and why it may matter.
    pub(crate) fn left_out(&self) -> Vec<(&'static str, &'static str)> {
        let mut left_out = Vec::new();
        let has = |names: &[&str]| names.iter().any(|name| self.packages.contains(*name));
        if !self.packages.is_empty() {
            left_out.push((
                "the program's own tests",
                "they take minutes (those whose file differs were run)",
            ));
        }
        if has(&[
            "foveal-core",
            "foveal-media",
            "foveal-render",
            "foveal-eval",
        ]) {
            left_out.push(("crates that use these", "`make test` checks them"));
        }
        if self.page() || has(&["foveal-core", "foveal-render", "foveal-web"]) {
            left_out.push(("wasm, web-test", "they take minutes, `make test` runs them"));
        }
        left_out
    }
}

/// Names of the workspace's packages, and their folders below its root.
fn folders(metadata: &Value) -> Vec<(String, PathBuf)> {
    let folder = |package: &Value| {
        let manifest = Path::new(package["manifest_path"].as_str()?);
        let folder = manifest
            .parent()?
            .strip_prefix(metadata["workspace_root"].as_str()?);
        Some((
            package["name"].as_str()?.to_owned(),
            folder.ok()?.to_owned(),
        ))
    };
    let packages = metadata["packages"].as_array();
    packages.into_iter().flatten().filter_map(folder).collect()
}

fn selected<'a>(packages: impl Iterator<Item = &'a String>) -> Vec<String> {
    packages
        .flat_map(|name| ["-p".to_owned(), name.clone()])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touched(files: &[&str]) -> Touched {
        let folders = [
            ("foveal-core", "crates/core"),
            ("foveal", "crates/app"),
            ("xtask", "xtask"),
            ("web-bindgen", "xtask/bindgen"),
        ];
        let folders = folders.map(|(name, folder)| (name.to_owned(), folder.into()));
        Touched::of(
            files.iter().map(|file| (*file).to_owned()).collect(),
            &folders,
        )
    }

    #[test]
    fn a_file_belongs_to_the_innermost_package() {
        assert_eq!(
            touched(&["xtask/bindgen/src/main.rs"]).packages(),
            ["-p", "web-bindgen"]
        );
        assert_eq!(
            touched(&["crates/core/src/lib.rs"]).packages(),
            ["-p", "foveal-core"]
        );
        assert!(
            touched(&["README.md", "crates/corelike.rs"])
                .packages()
                .is_empty()
        );
    }

    #[test]
    fn what_every_package_is_built_by_touches_every_package() {
        assert_eq!(touched(&["Cargo.lock"]).packages().len(), 8);
    }

    #[test]
    fn of_the_programs_own_tests_only_those_are_run_whose_file_differs() {
        let tests = touched(&[
            "crates/app/tests/program/score.rs",
            "crates/core/src/lib.rs",
        ]);
        let program = ["-p", "foveal", "--test", "program", "score::"];
        let expected = [
            vec!["-p", "foveal-core"],
            vec!["-p", "foveal", "--bins"],
            program.to_vec(),
        ];
        assert_eq!(tests.tests(), expected);
    }
}
