//! Does shipped code read files only by the readers that bound what they read?
//!
//! A name that a person gives may lead to a device without an end, or to a pipe without a
//! writer. So files are opened in few places, which refuse such things.

use super::Finding;
use super::source::lexing::{is_word, line_of, places_of, shipped_code};

/// Where files are opened.
const READERS: [&str; 2] = [
    "crates/media/src/plain_file.rs",
    "crates/scene/src/plain_bytes.rs",
];
/// What opens or reads a file, whatever lies there.
const CALLS: [&str; 3] = ["fs::read", "fs::read_to_string", "File::open"];

/// Checks one file of the crates, without its tests.
pub(super) fn check(path: &str, text: &str) -> Vec<Finding> {
    let is_source = path.starts_with("crates/") && path.contains("/src/") && path.ends_with(".rs");
    let is_test = path.contains("/tests/") || path.ends_with("tests.rs");
    if !is_source || is_test || READERS.contains(&path) {
        return Vec::new();
    }
    let code = shipped_code(text);
    let lines: Vec<&str> = text.lines().collect();
    let mut findings = Vec::new();
    for call in CALLS {
        let whole = |at: &usize| !code[at + call.len()..].starts_with(is_word);
        let grouped = grouped_uses(&code, call);
        for at in places_of(&code, call).filter(whole).chain(grouped) {
            let line = line_of(&code, at);
            if names_its_file(lines.get(line - 1).copied().unwrap_or_default(), call) {
                continue;
            }
            let message = format!(
                "`{call}` reads whatever lies there, without an end: read by \
                 foveal_media::plain_file, or within crates/scene by its plain_bytes"
            );
            findings.push(Finding::new(path, line, message));
        }
    }
    findings
}

/// Where `use fs::{.., read, ..}` brings a call in by a group.
fn grouped_uses(code: &str, call: &str) -> Vec<usize> {
    let Some((module, name)) = call.split_once("::") else {
        return Vec::new();
    };
    let group = format!("{module}::{{");
    let names = |at: &usize| {
        let inside = &code[at + group.len()..];
        let inside = inside.split_once('}').map_or(inside, |(inside, _)| inside);
        inside
            .split(',')
            .any(|it| it.split_whitespace().next() == Some(name))
    };
    places_of(code, &group).filter(names).collect()
}

/// Whether a line reads a file that stands in it, as `fs::read_to_string("/proc/cpuinfo")`: one of
/// the system's, at a fixed path.
fn names_its_file(line: &str, call: &str) -> bool {
    let after = line.split_once(call).map(|(_, after)| after);
    after.is_some_and(|after| after.starts_with("(\"/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(path: &str, text: &str) -> Vec<usize> {
        let findings = check(path, text);
        findings.iter().map(|finding| finding.line).collect()
    }

    #[test]
    fn files_that_are_named_are_read_by_the_bounded_readers_alone() {
        let text = "let a = std::fs::read(path)?;\nlet b = fs::read_to_string(path)?;\n\
                    use std::fs::{File, read as all};\nuse std::fs::read;\n\
                    let c = paths.map(std::fs::File::open);\n";
        let mut found = lines("crates/app/src/a.rs", text);
        found.sort_unstable();
        assert_eq!(found, [1, 2, 3, 4, 5]);
        for reader in READERS {
            assert!(lines(reader, text).is_empty());
        }
        for free in [
            "crates/app/src/tests.rs",
            "crates/app/tests/a.rs",
            "xtask/src/a.rs",
        ] {
            assert!(lines(free, text).is_empty(), "{free}");
        }
    }

    #[test]
    fn tests_packs_folders_and_files_of_the_system_are_free() {
        let free = "use std::fs::{File, read_dir}; PackFile::open(path); fs::read_dir(path);
                    fs::read_link(path); File::create(path);
                    std::fs::read_to_string(\"/proc/self/status\");
                    // fs::read(path)
                    #[cfg(test)] mod tests { fn f() { fs::read(path); } }";
        assert!(lines("crates/app/src/a.rs", free).is_empty());
    }
}
