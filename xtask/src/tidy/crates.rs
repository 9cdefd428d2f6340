//! Does each crate depend only on the crates it may see?

use serde_json::Value;

use super::{Finding, Tree};

const CORE: &str = "foveal-core";
/// Where the others meet; the browser's bindings are such a place too.
const ENDS: [&str; 2] = ["foveal", "foveal-web"];
/// What plays a pack, and what it may use besides core.
const PLAY: &str = "foveal-play";
const PLAYED_BY: [&str; 2] = ["foveal-media", "foveal-render"];

/// Checks the packages of `cargo metadata --no-deps`, whatever the kind of dependency.
pub(super) fn check(metadata: &Value, tree: &Tree) -> Vec<Finding> {
    let root = metadata["workspace_root"].as_str().unwrap_or_default();
    let mut findings = Vec::new();
    for package in list(&metadata["packages"]) {
        let name = package["name"].as_str().unwrap_or_default();
        let manifest = package["manifest_path"].as_str().unwrap_or_default();
        let manifest = manifest
            .strip_prefix(root)
            .unwrap_or(manifest)
            .trim_start_matches('/');
        for dependency in list(&package["dependencies"]) {
            let used = dependency["name"].as_str().unwrap_or_default();
            if let Some(message) = objection(name, used) {
                let line = line_that_names(tree.text(manifest).unwrap_or_default(), used);
                findings.push(Finding::new(manifest, line, message));
            }
        }
    }
    findings
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

/// Why `name` may not use `used`; nothing when it may.
fn objection(name: &str, used: &str) -> Option<String> {
    let ours = |name: &str| name == "foveal" || name.starts_with("foveal-");
    if !ours(used) || ENDS.contains(&name) || (used == CORE && name != CORE) {
        return None;
    }
    if name == PLAY && PLAYED_BY.contains(&used) {
        return None;
    }
    let allowed = if name == CORE {
        "no other crate of ours"
    } else {
        "only foveal-core"
    };
    Some(format!(
        "{name} depends on {used}, it may on {allowed}: let them meet in the app"
    ))
}

fn line_that_names(manifest: &str, used: &str) -> usize {
    manifest
        .lines()
        .position(|line| line.starts_with(used))
        .map_or(1, |index| index + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn found(name: &str, used: &[&str]) -> Vec<String> {
        let dependencies: Vec<Value> = used.iter().map(|name| json!({ "name": name })).collect();
        let metadata = json!({
            "workspace_root": "/x",
            "packages": [
                { "name": name, "manifest_path": "/x/c/Cargo.toml", "dependencies": dependencies }
            ],
        });
        let tree = Tree::of_texts(&[("c/Cargo.toml", "[dependencies]\nfoveal-render = \"1\"\n")]);
        check(&metadata, &tree)
            .iter()
            .map(ToString::to_string)
            .collect()
    }

    #[test]
    fn middle_crates_see_core_and_not_each_other() {
        assert!(found("foveal-media", &["foveal-core", "png"]).is_empty());
        let findings = found("foveal-media", &["foveal-core", "foveal-render"]);
        assert_eq!(findings.len(), 1);
        assert!(findings[0].starts_with("c/Cargo.toml:2: foveal-media depends on foveal-render"));
        assert_eq!(found("foveal-eval", &["foveal"]).len(), 1);
    }

    #[test]
    fn core_sees_none_of_ours() {
        assert!(found("foveal-core", &["libm"]).is_empty());
        assert_eq!(found("foveal-core", &["foveal-media"]).len(), 1);
        assert!(found("foveal-play", &["foveal-media", "foveal-render"]).is_empty());
        assert_eq!(found("foveal-play", &["foveal-eval"]).len(), 1);
    }

    #[test]
    fn the_app_sees_all() {
        assert!(found("foveal", &["foveal-core", "foveal-media", "foveal-render"]).is_empty());
        assert!(found("foveal-web", &["foveal-core", "foveal-render"]).is_empty());
    }
}
