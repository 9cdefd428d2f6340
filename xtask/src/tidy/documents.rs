//! Does every path and link that a document names exist?

use super::{Finding, Tree};

/// Paths that begin so are the repository's, whatever their ending.
const OWN_FOLDERS: [&str; 4] = ["crates/", "docs/", "xtask/", "scripts/"];

/// Checks links of every Markdown file, and paths in backticks of those that describe the code.
pub(super) fn check(path: &str, text: &str, tree: &Tree) -> Vec<Finding> {
    if !path.ends_with(".md") {
        return Vec::new();
    }
    let describes = matches!(path, "README.md" | "ARCHITECTURE.md" | "CONTRIBUTING.md")
        || path.starts_with("docs/");
    let folder = path.rsplit_once('/').map_or("", |(folder, _)| folder);
    let made = made_folders(tree);
    let mut findings = Vec::new();
    let mut fenced = false;
    for (number, line) in (1..).zip(text.lines()) {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        }
        if fenced {
            continue;
        }
        let (code, prose) = split_code(line);
        for named in code.iter().filter_map(|word| repository_path(word)) {
            let is_made = made.iter().any(|folder| named.starts_with(folder.as_str()));
            if describes && !is_made && !tree.has(named) && !tree.has(&joined(folder, named)) {
                let message = format!("`{named}` does not exist: correct the path or the sentence");
                findings.push(Finding::new(path, number, message));
            }
        }
        for target in link_targets(&prose).filter(|target| !tree.has(&joined(folder, target))) {
            let message = format!("the link to {target} leads nowhere: correct it");
            findings.push(Finding::new(path, number, message));
        }
    }
    findings
}

/// Folders that builds and runs make: git ignores them from the root on.
fn made_folders(tree: &Tree) -> Vec<String> {
    let ignored = tree.text(".gitignore").unwrap_or_default().lines();
    ignored
        .filter_map(|line| line.strip_prefix('/'))
        .map(|folder| format!("{}/", folder.trim_end_matches('/')))
        .collect()
}

/// The words in backticks, and the line without them.
fn split_code(line: &str) -> (Vec<&str>, String) {
    let parts: Vec<&str> = line.split('`').collect();
    let code = parts.iter().skip(1).step_by(2).copied().collect();
    let prose: Vec<&str> = parts.iter().step_by(2).copied().collect();
    (code, prose.join("`"))
}

/// The path of the repository that `word` looks like, without `::item`, `:line` or `#part`.
fn repository_path(word: &str) -> Option<&str> {
    let path = word.split([':', '#']).next().unwrap_or(word);
    let is_address = word.contains("://") || word.starts_with(['/', '-', '~', '.']);
    let is_pattern = word.contains(|c: char| c.is_whitespace() || "*<>{}$()…=,|@".contains(c));
    if is_address || is_pattern || !path.contains('/') {
        return None;
    }
    let name = path.rsplit('/').next().unwrap_or(path);
    let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
    let has_ending = ending.len() <= 6
        && ending.starts_with(|c: char| c.is_ascii_alphabetic())
        && ending.chars().all(|c| c.is_ascii_alphanumeric())
        // Packs are made by users; none is in the repository.
        && ending != "foveal";
    (has_ending || OWN_FOLDERS.iter().any(|folder| path.starts_with(folder))).then_some(path)
}

/// Targets of `[text](target)` and `[label]: target` that are files.
fn link_targets(prose: &str) -> impl Iterator<Item = &str> {
    let inline = prose
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next());
    let label = prose
        .trim_start()
        .strip_prefix('[')
        .and_then(|rest| rest.split_once("]: "));
    let targets = inline.chain(label.map(|(_, target)| target));
    targets
        .map(|target| {
            target
                .split_whitespace()
                .next()
                .unwrap_or("")
                .trim_matches(['<', '>'])
        })
        .filter(|target| !target.contains("://") && !target.starts_with("mailto:"))
        .map(|target| target.split('#').next().unwrap_or(""))
        .filter(|target| !target.is_empty())
}

/// `path` as seen from `folder`, with `.` and `..` resolved as far as the root.
fn joined(folder: &str, path: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in folder.split('/').chain(path.split('/')) {
        match part {
            "" | "." => {}
            ".." if parts.pop().is_some() => {}
            part => parts.push(part),
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(path: &str, text: &str) -> Vec<String> {
        let tree = Tree::of_texts(&[
            (".gitignore", "/target\n/demo\n"),
            ("crates/core/src/units.rs", ""),
            ("docs/formats/pack.md", ""),
            ("docs/papers.md", ""),
        ]);
        check(path, text, &tree)
            .iter()
            .map(ToString::to_string)
            .collect()
    }

    #[test]
    fn paths_that_exist_pass_and_stale_ones_do_not() {
        let good = "See `crates/core/src/units.rs`, `crates/core/`,\n\
                    `crates/core/src/units.rs::Ppd`,\n\
                    `docs/papers.md:3` and `formats/pack.md`.";
        assert!(
            found("docs/a.md", good).is_empty(),
            "{:?}",
            found("docs/a.md", good)
        );
        let stale = found(
            "README.md",
            "fine\nsee `crates/core/src/gone.rs` and `web/src/main.ts`",
        );
        assert_eq!(stale.len(), 2);
        assert!(stale[0].starts_with("README.md:2: `crates/core/src/gone.rs` does not exist"));
        assert_eq!(found("docs/a.md", "`scripts/nothing`").len(), 1);
    }

    #[test]
    fn other_words_with_a_slash_are_no_paths() {
        let text = "`1/60`, `application/json`, `0.5/1.5`, `target/release/foveal.exe`, `and/or`,\n\
                    `demo/report.json`, `out/a.foveal`, `/usr/share/x.json`, `crates/*/src`,\n\
                    `crates/<name>/src`, `https://a.b/c.html`, `foveal select a/b.png`\n\
                    ```\nweb/gone.ts `web/gone.ts`\n```\n";
        assert!(
            found("README.md", text).is_empty(),
            "{:?}",
            found("README.md", text)
        );
        assert!(found("CHANGELOG.md", "`web/gone.ts`").is_empty());
    }

    #[test]
    fn relative_links_resolve_from_their_document() {
        let good = "[a](../README.md) [b](formats/pack.md#x \"t\") [c](#here) [d](https://e.f/g)";
        assert_eq!(
            found("docs/a.md", good).len(),
            1,
            "only README.md is missing"
        );
        assert!(
            found(
                "docs/formats/b.md",
                "[a](../papers.md) [b](pack.md)\n[c]: ./pack.md"
            )
            .is_empty()
        );
        let stale = found("STYLE.md", "x\n![p](docs/gone.png)");
        assert_eq!(
            stale,
            ["STYLE.md:2: the link to docs/gone.png leads nowhere: correct it"]
        );
        assert_eq!(found("docs/a.md", "[c]: gone.md").len(), 1);
    }
}
