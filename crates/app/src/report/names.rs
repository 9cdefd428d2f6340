//! How do names that break lines stand in a line?
//!
//! A name may hold line ends and tabs, by which it would look like lines of the program's own. All
//! text for people is built of whole names and parts of them, with line ends between its lines; so
//! names that came in by the command line, or lie above the folder in which the program runs, are
//! found in the text again. Names that stand in files are read by `one_line` where they are read.

use crate::report::called::called;
use foveal_core::units::one_line;
use std::borrow::Cow;
use std::path::Path;
use std::sync::OnceLock;

/// The text with the names of the command line in a line each.
pub(super) fn in_lines(text: &str) -> Cow<'_, str> {
    static BREAKING: OnceLock<Vec<String>> = OnceLock::new();
    let breaking = BREAKING.get_or_init(|| {
        let here = std::env::current_dir().unwrap_or_default();
        let here = here.to_string_lossy().into_owned();
        let words = called().words.iter().map(String::as_str);
        breaking_parts(words.chain([here.as_str()]))
    });
    with_parts_in_lines(text, breaking)
}

/// The parts of names that break lines, the longest first: what stands between the marks that join
/// names, and that without its ending, of which names of other files are made.
fn breaking_parts<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut parts: Vec<String> = names
        .filter(|name| breaks(name))
        .flat_map(|name| name.split(['/', '\\', ':', '=']))
        .flat_map(|part| {
            let stem = Path::new(part).file_stem().unwrap_or_default();
            [part.to_owned(), stem.to_string_lossy().into_owned()]
        })
        .filter(|part| breaks(part))
        .collect();
    parts.sort_by_key(|part| std::cmp::Reverse(part.len()));
    parts.dedup();
    parts
}

fn breaks(name: &str) -> bool {
    name.contains(['\n', '\t'])
}

fn with_parts_in_lines<'a>(text: &'a str, parts: &[String]) -> Cow<'a, str> {
    let mut shown = Cow::Borrowed(text);
    for part in parts.iter().filter(|part| text.contains(part.as_str())) {
        shown = Cow::Owned(shown.replace(part.as_str(), &one_line(part)));
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(text: &str, words: &[&str]) -> String {
        with_parts_in_lines(text, &breaking_parts(words.iter().copied())).into_owned()
    }

    #[test]
    fn a_name_forges_no_line_whatever_is_made_of_it() {
        let words = [
            "info",
            "dir/a\nfoveal: all is well\t.foveal",
            "--out=b\nc",
            "trace:d\ne.csv",
        ];
        for (text, expected) in [
            ("x.foveal: ok\n\tindented", "x.foveal: ok\n\tindented"),
            (
                "dir/a\nfoveal: all is well\t.foveal: is no pack\nend",
                "dir/a\\u{a}foveal: all is well\\u{9}.foveal: is no pack\nend",
            ),
            // A picture of it, a file in it, an option and a file behind a kind.
            ("a\nfoveal", "a\\u{a}foveal"),
            (" all is well\t-00001.png", " all is well\\u{9}-00001.png"),
            ("b\nc/frames.csv", "b\\u{a}c/frames.csv"),
            (
                "--gaze trace:d\ne.csv: line 2",
                "--gaze trace:d\\u{a}e.csv: line 2",
            ),
        ] {
            assert_eq!(shown(text, &words), expected);
        }
        assert_eq!(shown("a\nb", &["\n"]), "a\\u{a}b");
        assert!(matches!(
            with_parts_in_lines("a\nb", &breaking_parts(["info"].into_iter())),
            Cow::Borrowed(_)
        ));
    }
}
