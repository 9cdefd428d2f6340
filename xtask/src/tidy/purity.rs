//! Does core ask anything of the world, or of the platform's mathematics?

use super::Finding;
use super::source::lexing::{is_word, line_of, places_of, shipped_code};

const SOURCES: &str = "crates/core/src/";
const WORLD: [&str; 6] = ["time", "fs", "net", "thread", "env", "process"];
/// Their last bits differ from one platform to the next; `sqrt`, `abs`, `floor` are exact.
const INEXACT: [&str; 25] = [
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sin_cos", "sinh", "cosh", "tanh",
    "asinh", "acosh", "atanh", "exp", "exp2", "exp_m1", "ln", "ln_1p", "log", "log2", "log10",
    "powf", "cbrt", "hypot",
];

/// Checks one file of core, without its tests.
pub(super) fn check(path: &str, text: &str) -> Vec<Finding> {
    let is_source = path.starts_with(SOURCES) && path.ends_with(".rs");
    let is_test = path.ends_with("/tests.rs") || path.contains("/tests/");
    if !is_source || is_test {
        return Vec::new();
    }
    let code = shipped_code(text);
    let mut findings = Vec::new();
    for module in WORLD {
        for at in world_uses(&code, module) {
            let message = format!(
                "core uses std::{module}: take what it gives as an argument and let the app ask"
            );
            findings.push(Finding::new(path, line_of(&code, at), message));
        }
    }
    for name in INEXACT {
        for at in inexact_uses(&code, name) {
            let message =
                format!("core uses {name}, whose last bits depend on the platform: call libm's");
            findings.push(Finding::new(path, line_of(&code, at), message));
        }
    }
    findings
}

/// Where `.name(`, `f32::name` or `f64::name` stands.
fn inexact_uses(code: &str, name: &str) -> Vec<usize> {
    let call = format!(".{name}(");
    let mut found: Vec<usize> = code.match_indices(&call).map(|(at, _)| at).collect();
    for kind in ["f32", "f64"] {
        let path = format!("{kind}::{name}");
        let whole = |at: &usize| !code[at + path.len()..].starts_with(is_word);
        found.extend(places_of(code, &path).filter(whole));
    }
    found
}

/// Where `std::module` or `std::{.., module, ..}` is named.
fn world_uses(code: &str, module: &str) -> Vec<usize> {
    let mut found: Vec<usize> = places_of(code, "std::{")
        .filter(|&at| {
            let group = &code[at + "std::{".len()..];
            let group = group.split_once(';').map_or(group, |(group, _)| group);
            group.split(',').any(|name| {
                let name = name.trim().trim_end_matches(['}', ' ', '\n']);
                name == module || name.starts_with(&format!("{module}::"))
            })
        })
        .collect();
    let path = format!("std::{module}");
    let whole = |at: &usize| !code[at + path.len()..].starts_with(is_word);
    found.extend(places_of(code, &path).filter(whole));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<usize> {
        let findings = check("crates/core/src/gaze/filter.rs", text);
        let mut lines: Vec<usize> = findings.iter().map(|finding| finding.line).collect();
        lines.sort_unstable();
        lines
    }

    #[test]
    fn core_does_not_ask_for_time_files_or_threads() {
        assert_eq!(
            lines("use std::fmt;\nuse std::time::Instant;\nstd::fs::read(x)"),
            [2, 3]
        );
        assert_eq!(lines("use std::{fmt, thread};"), [1]);
        assert_eq!(lines("use std::{fmt, net::IpAddr};"), [1]);
        assert!(lines("use std::{fmt, mem};\nuse std::timeless;\nuse my_std::fs;").is_empty());
    }

    #[test]
    fn core_takes_its_mathematics_from_libm() {
        assert_eq!(
            lines("let y = x.sin();\nlet z = f64::powf(x, 2.0);\na.map(f64::ln)"),
            [1, 2, 3]
        );
        assert!(lines("libm::sin(x).sqrt().abs(); x.since(); x.cost(1); self.exp").is_empty());
    }

    #[test]
    fn tests_words_and_other_crates_are_free() {
        assert!(lines("// x.sin()\n#[cfg(test)]\nmod tests { fn f() { x.sin(); } }").is_empty());
        assert!(check("crates/core/src/gaze/tests.rs", "x.sin()").is_empty());
        assert!(check("crates/app/src/main.rs", "std::time::Instant::now().sin()").is_empty());
    }
}
