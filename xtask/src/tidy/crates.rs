//! Does each crate depend only on the crates it may see?

use serde_json::Value;

use super::{Finding, Tree};

const APP: &str = "foveal";
const CORE: &str = "foveal-core";
/// What judges: nothing that it judges may hear from it.
const EVAL: &str = "foveal-eval";
const RENDER: &str = "foveal-render";
/// With which [`EVAL`] may use [`RENDER`], since it computes on the same device.
const FEATURE: &str = "gpu";
/// Where the others meet; the browser's bindings are such a place too.
const ENDS: [&str; 2] = [APP, "foveal-web"];
/// What plays a pack, and what it may use besides core.
const PLAY: &str = "foveal-play";
const PLAYED_BY: [&str; 2] = ["foveal-media", "foveal-render"];

/// Checks the packages of `cargo metadata --no-deps`, whatever the kind of dependency.
pub(super) fn check(metadata: &Value, tree: &Tree) -> Vec<Finding> {
    let root = metadata["workspace_root"].as_str().unwrap_or_default();
    let mut findings = Vec::new();
    for package in list(&metadata["packages"]) {
        let manifest = package["manifest_path"].as_str().unwrap_or_default();
        let manifest = manifest
            .strip_prefix(root)
            .unwrap_or(manifest)
            .trim_start_matches('/');
        for dependency in list(&package["dependencies"]) {
            if let Some(message) = objection(package, dependency) {
                let used = name_of(dependency);
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

fn name_of(value: &Value) -> &str {
    value["name"].as_str().unwrap_or_default()
}

/// Why a package may not have a dependency; nothing when it may.
fn objection(package: &Value, dependency: &Value) -> Option<String> {
    let (name, used) = (name_of(package), name_of(dependency));
    let ours = used == APP || used.starts_with("foveal-");
    if !ours || used == CORE {
        return None;
    }
    if used == EVAL && name != APP {
        return Some(format!(
            "{name} depends on {used}, only the app may: what judges feeds nothing"
        ));
    }
    if ENDS.contains(&name) || (name == PLAY && PLAYED_BY.contains(&used)) {
        return None;
    }
    if (name, used) == (EVAL, RENDER) {
        let message = format!(
            "{name} depends on {used} without its feature {FEATURE}: make it optional, and \
             dep:{used} part of {FEATURE} alone"
        );
        return (!is_behind_feature(package, dependency)).then_some(message);
    }
    let allowed = match name {
        CORE => "no other crate of ours",
        _ => "only foveal-core",
    };
    Some(format!(
        "{name} depends on {used}, it may on {allowed}: let them meet in the app"
    ))
}

/// Is a dependency there with [`FEATURE`] only, and that not by itself?
fn is_behind_feature(package: &Value, dependency: &Value) -> bool {
    let wanted = format!("dep:{}", name_of(dependency));
    let features = package["features"].as_object().into_iter().flatten();
    let naming = |what: &str| -> Vec<&str> {
        let named = features
            .clone()
            .filter(|(_, parts)| list(parts).any(|part| part == what));
        named.map(|(feature, _)| feature.as_str()).collect()
    };
    let is_optional = dependency["optional"] == Value::Bool(true);
    is_optional && naming(&wanted) == [FEATURE] && naming(FEATURE).is_empty()
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

    /// Findings where eval uses render with these features.
    fn of_eval(optional: bool, features: &Value) -> usize {
        let dependency = json!({ "name": "foveal-render", "optional": optional });
        let package = json!({
            "name": "foveal-eval", "manifest_path": "/x/c/Cargo.toml",
            "dependencies": [dependency], "features": features,
        });
        let metadata = json!({ "workspace_root": "/x", "packages": [package] });
        check(&metadata, &Tree::of_texts(&[("c/Cargo.toml", "")])).len()
    }

    #[test]
    fn eval_sees_render_with_its_feature_gpu_and_never_without() {
        let behind = json!({ "gpu": ["dep:wgpu", "dep:foveal-render"], "other": [] });
        assert_eq!(of_eval(true, &behind), 0);
        assert_eq!(of_eval(false, &behind), 1);
        assert_eq!(of_eval(true, &json!({ "gpu": [] })), 1);
        let by_itself = json!({ "default": ["gpu"], "gpu": ["dep:foveal-render"] });
        assert_eq!(of_eval(true, &by_itself), 1);
        let render = ["dep:foveal-render"];
        let by_another = json!({ "gpu": render, "foveal-render": render });
        assert_eq!(of_eval(true, &by_another), 1);
        assert_eq!(
            found("foveal-eval", &["foveal-core", "foveal-media"]).len(),
            1
        );
    }

    #[test]
    fn the_app_alone_sees_eval() {
        assert!(found("foveal", &["foveal-eval"]).is_empty());
        for name in ["foveal-core", "foveal-media", "foveal-render", "foveal-web"] {
            let findings = found(name, &["foveal-eval"]);
            assert_eq!(findings.len(), 1, "{name}");
            assert!(findings[0].contains("only the app may"), "{findings:?}");
        }
    }

    #[test]
    fn core_sees_none_of_ours() {
        assert!(found("foveal-core", &["libm"]).is_empty());
        // Its own tests use a feature of it.
        assert!(found("foveal-core", &["foveal-core"]).is_empty());
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
