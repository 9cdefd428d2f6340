//! Does one loop play for the program and for the page?

use super::Finding;
use super::known::Breach;
use super::source::lexing::{is_word, line_of, places_of, shipped_code};
use super::tree::Tree;

/// What the loop of `crates/play` owns: those who show what it plays name none of it.
const PARTS: [&str; 4] = ["DecodePool", "TileStore", "Scheduler", "Rules"];
const SHOWING: [&str; 2] = ["crates/app/src/", "crates/web/src/"];
/// Where the loop takes its step, once in each.
const STEPPING: [&str; 2] = ["crates/play/src/", "crates/web/src/"];
const STEP: &str = "session.step(";

/// Finds parts of the loop where they are only shown, and counts its steps once there is a loop.
pub(super) fn check(tree: &Tree) -> Vec<Breach> {
    let mut breaches = Vec::new();
    for folder in SHOWING {
        for (path, code) in sources(tree, folder) {
            breaches.extend(parts_named(path, &code));
        }
    }
    if tree.has(STEPPING[0]) {
        breaches.extend(STEPPING.iter().filter_map(|folder| steps(tree, folder)));
    }
    breaches
}

/// The shipped code of each source of a folder.
fn sources<'a>(tree: &'a Tree, folder: &'a str) -> impl Iterator<Item = (&'a str, String)> {
    let is_source = move |path: &str| {
        let is_test = path.contains("/tests/") || path.ends_with("/tests.rs");
        path.starts_with(folder) && path.ends_with(".rs") && !is_test
    };
    let files = tree.files().filter(move |(path, _)| is_source(path));
    files.filter_map(|(path, file)| Some((path, shipped_code(file.text.as_deref()?))))
}

fn parts_named(path: &str, code: &str) -> Vec<Breach> {
    let named = PARTS.iter().filter_map(|part| {
        let ends = |at: &usize| !code[at + part.len()..].starts_with(is_word);
        Some((part, places_of(code, part).find(ends)?))
    });
    named
        .map(|(part, at)| {
            let message =
                format!("names {part}, which belongs to the loop: ask crates/play for it");
            let finding = Finding::new(path, line_of(code, at), message);
            Breach::new("one-loop", format!("{path} {part}"), finding)
        })
        .collect()
}

/// The breach where a folder's sources do not step a session exactly once.
fn steps(tree: &Tree, folder: &str) -> Option<Breach> {
    let mut places = Vec::new();
    for (path, code) in sources(tree, folder) {
        let calls = places_of(&code, "session").filter(|at| is_step(&code[*at..]));
        places.extend(calls.map(|at| format!("{path}:{}", line_of(&code, at))));
    }
    if places.len() == 1 {
        return None;
    }
    let message = format!(
        "`{STEP}` stands in {} places, and in exactly one it should: {}",
        places.len(),
        places.join(", ")
    );
    let finding = Finding::new(folder, 1, message);
    Some(Breach::new("one-loop", format!("{folder} steps"), finding).counting(places.len()))
}

/// Does `code` begin with a step, on one line or over several?
fn is_step(code: &str) -> bool {
    let mut code = code.chars().filter(|c| !c.is_whitespace());
    STEP.chars().all(|c| code.next() == Some(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(files: &[(&str, &str)]) -> Vec<String> {
        let found = check(&Tree::of_texts(files));
        found.iter().map(|breach| breach.key().to_owned()).collect()
    }

    #[test]
    fn who_shows_what_is_played_names_no_part_of_the_loop() {
        for part in PARTS {
            let text = format!("use foveal_play::{part};\nfn f(x: {part}) {{}}");
            let app = keys(&[("crates/app/src/a.rs", &text)]);
            assert_eq!(app, [format!("crates/app/src/a.rs {part}")]);
            assert_eq!(keys(&[("crates/web/src/a.rs", &text)]).len(), 1);
            assert!(keys(&[("crates/media/src/a.rs", &text)]).is_empty());
            assert!(keys(&[("crates/app/src/tests.rs", &text)]).is_empty());
        }
        let free = "// Rules\nstruct MyRules; fn f(x: RulesOfPlay) { g(\"Rules\") }
                    #[cfg(test)] mod tests { use Rules; }";
        assert!(keys(&[("crates/app/src/a.rs", free)]).is_empty());
    }

    #[test]
    fn a_session_takes_its_step_in_one_place_of_play_and_one_of_the_page() {
        let once = "fn f() { self.session\n    .step(now) }";
        let found = |play: &str, web: &str| {
            keys(&[("crates/play/src/a.rs", play), ("crates/web/src/a.rs", web)])
        };
        assert!(found(once, once).is_empty());
        let twice = format!("{once} {once}");
        assert_eq!(found(&twice, once), ["crates/play/src/ steps"]);
        assert_eq!(
            found(once, "fn f() { my_session.step() }"),
            ["crates/web/src/ steps"]
        );
    }

    #[test]
    fn steps_are_not_counted_before_there_is_a_loop() {
        assert!(keys(&[("crates/web/src/a.rs", "fn f() {}")]).is_empty());
    }
}
