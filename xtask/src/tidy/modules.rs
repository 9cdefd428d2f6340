//! Does a module of core use only modules to its left?

use super::Finding;
use super::source::lexing::{code, is_word, line_of, places_of};

const SOURCES: &str = "crates/core/src/";
const CRATE: &str = "crate::";
const SUPER: &str = "super::";
const ORDER: [&str; 8] = [
    "units",
    "view",
    "gaze",
    "pack",
    "perception",
    "content",
    "selection",
    "session",
];

/// Checks `use crate::X` and `crate::X::` of one file of core, tests included.
pub(super) fn check(path: &str, text: &str) -> Vec<Finding> {
    let Some(inside) = path
        .strip_prefix(SOURCES)
        .and_then(|p| p.strip_suffix(".rs"))
    else {
        return Vec::new();
    };
    let mut modules: Vec<&str> = inside.split('/').collect();
    modules.pop_if(|last| *last == "mod");
    let own = modules[0];
    if own == "lib" {
        return Vec::new();
    }
    let Some(place) = ORDER.iter().position(|module| *module == own) else {
        let message = format!(
            "core's module {own} has no place in the order {}: give it one",
            ORDER.join(" <- ")
        );
        return vec![Finding::new(path, 1, message)];
    };
    let mut findings = Vec::new();
    for (line, used) in uses(&code(text), modules.len()) {
        if ORDER
            .iter()
            .position(|module| *module == used)
            .is_some_and(|used| used > place)
        {
            let message = format!(
                "{own} uses {used}, after it in {}: move what both need to the left",
                ORDER.join(" <- ")
            );
            findings.push(Finding::new(path, line, message));
        }
    }
    findings
}

/// Each module of the crate's root that a path names, with its line. `depth` is how many `super`
/// lead from this file to the root; modules with braces need more.
fn uses(code: &str, depth: usize) -> Vec<(usize, String)> {
    let supers = places_of(code, SUPER).filter(|at| !code[..*at].ends_with(SUPER));
    let ends = supers.filter_map(|at| {
        let after = code[at..].trim_start_matches(SUPER);
        let end = code.len() - after.len();
        (end - at >= depth * SUPER.len()).then_some(end)
    });
    let crates = places_of(code, CRATE).map(|at| at + CRATE.len());
    let mut found = Vec::new();
    for end in crates.chain(ends) {
        for (offset, name) in first_names(&code[end..]) {
            found.push((line_of(code, end + offset), name));
        }
    }
    found
}

/// The names a path continues with: one, or each of a `{group}`.
fn first_names(after: &str) -> Vec<(usize, String)> {
    let mut depth = 0;
    let mut expects_name = true;
    let mut names = Vec::new();
    for (at, c) in after.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 1 => expects_name = true,
            c if is_word(c) && expects_name => {
                let name = after[at..].chars().take_while(|c| is_word(*c)).collect();
                names.push((at, name));
                expects_name = false;
            }
            c if c.is_whitespace() => continue,
            _ => {}
        }
        if depth == 0 && c != '{' {
            break;
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(path: &str, text: &str) -> Vec<usize> {
        check(path, text)
            .iter()
            .map(|finding| finding.line)
            .collect()
    }

    #[test]
    fn a_use_to_the_left_passes_and_one_to_the_right_does_not() {
        let pack = "crates/core/src/pack/index.rs";
        assert!(lines(pack, "use crate::units::Level;\nuse crate::gaze::Unit;").is_empty());
        assert_eq!(lines(pack, "\nuse crate::selection::Plan;"), [2]);
        assert_eq!(lines(pack, "let x = crate::content::f();"), [1]);
        assert_eq!(lines("crates/core/src/units.rs", "use crate::view;"), [1]);
    }

    #[test]
    fn packs_come_before_what_perception_makes_of_them() {
        let pack = "crates/core/src/pack/index.rs";
        assert!(
            lines(
                pack,
                "use crate::{units::Level, view::Surface, gaze::Sample};"
            )
            .is_empty()
        );
        for right in ["perception", "content", "selection", "session"] {
            assert_eq!(lines(pack, &format!("use crate::{right}::X;")), [1]);
        }
        let content = "crates/core/src/content/video.rs";
        assert!(lines(content, "use crate::{pack::Index, perception::Eye};").is_empty());
        assert_eq!(lines(content, "use crate::selection::Plan;"), [1]);
    }

    #[test]
    fn groups_and_supers_are_followed() {
        let pack = "crates/core/src/pack/index.rs";
        let group =
            "use crate::{\n    units::{Level, content},\n    content::Sample,\n    view,\n};";
        assert_eq!(lines(pack, group), [3]);
        assert_eq!(lines(pack, "use super::super::content::Sample;"), [1]);
        assert!(lines(pack, "use super::gaze::Sample;").is_empty());
        let inner = "mod inner {\n    use super::super::super::content::Sample;\n}";
        assert_eq!(lines(pack, inner), [2]);
        assert_eq!(
            lines("crates/core/src/view/mod.rs", "use super::gaze::Sample;"),
            [1]
        );
    }

    #[test]
    fn words_are_no_uses_and_other_crates_are_free() {
        assert!(lines("crates/core/src/units.rs", "/// [`crate::gaze::Sample`]\n").is_empty());
        assert!(lines("crates/app/src/view.rs", "use crate::selection;").is_empty());
        assert!(lines("crates/core/src/lib.rs", "use crate::selection;").is_empty());
    }

    #[test]
    fn a_module_without_a_place_is_reported() {
        assert_eq!(lines("crates/core/src/sphere.rs", ""), [1]);
    }
}
