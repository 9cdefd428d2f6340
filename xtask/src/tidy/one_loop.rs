//! Does one loop play for the program and for the page?

use super::Finding;
use super::known::Breach;
use super::source::lexing::{is_word, line_of, places_of, shipped_code};
use super::tree::Tree;

/// What the loop of `crates/play` owns: those who show what it plays name none of it.
const PARTS: [&str; 4] = ["DecodePool", "TileStore", "Scheduler", "Rules"];
const SHOWING: [&str; 2] = ["crates/app/src/", "crates/web/src/"];
/// What moves a session on: the loop alone.
const STEP: &str = "session.step(";

/// Finds parts of the loop, and its steps, where they are only shown.
pub(super) fn check(tree: &Tree) -> Vec<Breach> {
    let mut breaches = Vec::new();
    for folder in SHOWING {
        for (path, code) in sources(tree, folder) {
            breaches.extend(parts_named(path, &code));
            breaches.extend(steps(path, &code));
        }
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

/// A breach for each step that a source takes by itself.
fn steps(path: &str, code: &str) -> Vec<Breach> {
    let calls = places_of(code, "session").filter(|at| is_step(&code[*at..]));
    let breach = |at| {
        let message = format!("`{STEP}` moves a session on: have a player of crates/play do it");
        let finding = Finding::new(path, line_of(code, at), message);
        Breach::new("one-loop", format!("{path} steps"), finding)
    };
    calls.map(breach).collect()
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
    fn only_a_player_moves_a_session_on() {
        let step = "fn f() { self.session\n    .step(now) }";
        let other = "fn f() { my_session.step() }";
        assert!(keys(&[("crates/play/src/a.rs", step)]).is_empty());
        assert!(keys(&[("crates/web/src/a.rs", other)]).is_empty());
        for path in ["crates/web/src/a.rs", "crates/app/src/a.rs"] {
            assert_eq!(keys(&[(path, step)]), [format!("{path} steps")]);
        }
    }
}
