//! Does the citation name the version that the workspace has?

use super::{Finding, Tree};

const CITATION: &str = "CITATION.cff";

/// Compares the version of the citation with the one in the root's `Cargo.toml`.
pub(super) fn check(path: &str, text: &str, tree: &Tree) -> Vec<Finding> {
    if path != CITATION {
        return Vec::new();
    }
    let manifest = tree.text("Cargo.toml").unwrap_or_default();
    let Some((_, wanted)) = value_after(manifest, "version = ") else {
        return Vec::new();
    };
    match value_after(text, "version: ") {
        Some((_, found)) if found == wanted => Vec::new(),
        found => {
            let (line, found) = found.unwrap_or((1, "missing"));
            let message = format!("version is {found}, the workspace's is {wanted}: write that");
            vec![Finding::new(CITATION, line, message)]
        }
    }
}

/// Number of the first line that begins so, and what follows there, without quotes.
fn value_after<'a>(text: &'a str, key: &str) -> Option<(usize, &'a str)> {
    let mut lines = (1..).zip(text.lines());
    lines.find_map(|(number, line)| {
        let value = line.strip_prefix(key)?.trim().trim_matches('"');
        Some((number, value))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(citation: &str) -> Vec<String> {
        let manifest = "[workspace.package]\nversion = \"0.3.0\"\n";
        let tree = Tree::of_texts(&[("Cargo.toml", manifest)]);
        let findings = check(CITATION, citation, &tree);
        findings.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_citation_names_the_version_of_the_workspace() {
        assert!(found("cff-version: 1.2.0\nversion: 0.3.0\n").is_empty());
        assert!(found("cff-version: 1.2.0\nversion: \"0.3.0\"\n").is_empty());
    }

    #[test]
    fn a_citation_of_another_version_or_of_none_is_found() {
        let wanted = "CITATION.cff:2: version is 0.2.9, the workspace's is 0.3.0: write that";
        assert_eq!(found("cff-version: 1.2.0\nversion: 0.2.9\n"), [wanted]);
        let wanted = "CITATION.cff:1: version is missing, the workspace's is 0.3.0: write that";
        assert_eq!(found("cff-version: 1.2.0\n"), [wanted]);
    }
}
