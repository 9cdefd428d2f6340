//! Do the page and the documents say of keys what the table says?
//!
//! `FOVEAL_BLESS=1` rewrites what is made of the table.

use foveal_core::view::keys::{HeardIn, KEYS, Row};
use serde_json::Value;
use std::fs;
use std::path::PathBuf;

fn repository(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path)
}

fn read(path: &str) -> String {
    fs::read_to_string(repository(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn expect_file(path: &str, made: &str) {
    if std::env::var("FOVEAL_BLESS").is_ok_and(|value| value == "1") {
        fs::write(repository(path), made).unwrap_or_else(|error| panic!("{path}: {error}"));
    }
    let there = read(path);
    assert!(
        there == made,
        "{path} is not what crates/core/src/view/keys.rs says: run `cargo xtask bless keys`"
    );
}

#[test]
fn the_keys_of_the_page_are_those_of_the_table() {
    let rows = KEYS.iter().filter(|row| row.place == HeardIn::Both);
    let key = |key| format!("    {},\n", serde_json::to_string(key).unwrap());
    let line = |row: &Row| {
        let [shown, says] = [row.shown, row.says].map(|text| Value::from(text).to_string());
        let needs = serde_json::to_string(&row.needs).unwrap();
        let keys: String = row.keys.iter().map(key).collect();
        format!("  {{ shown: {shown}, says: {says}, needs: {needs}, keys: [\n{keys}  ] }},\n")
    };
    let made = format!(
        "// Which keys does the page hear, and what do they do?\n\
         //\n\
         // Made of crates/core/src/view/keys.rs by `cargo xtask bless keys`.\n\n\
         /** The rows of the table, as they are listed. */\n\
         export const KEYS = [\n{}] as const;\n",
        rows.map(line).collect::<String>()
    );
    expect_file("web/src/element/keys.ts", &made);
}

#[test]
fn the_document_of_keys_is_the_table() {
    let names = |row: &Row| {
        let mut names = String::new();
        for name in row.shown.split_whitespace() {
            let glue = if names.ends_with("Shift</kbd>") {
                "+"
            } else {
                " "
            };
            names += &format!("{glue}<kbd>{name}</kbd>");
        }
        names
    };
    let line = |row: &Row| {
        let place = match row.place {
            HeardIn::Both => "window, page",
            HeardIn::Window => "window",
        };
        format!("|{} | {} | {place} |\n", names(row), row.says)
    };
    let made = format!(
        "# Keys\n\n\
         You can use these keys in the window of `foveal view` and in a page. <kbd>H</kbd> lists \
         those that do something there.\n\n\
         | key | | where |\n|---|---|---|\n{}\n\
         In the page F1, F11 and Esc are the browser's: Esc leaves the full screen.\n",
        KEYS.iter().map(line).collect::<String>()
    );
    expect_file("docs/keys.md", &made);
}

#[test]
fn a_key_that_a_document_names_is_in_the_table() {
    let known: Vec<&str> = KEYS
        .iter()
        .flat_map(|row| row.shown.split_whitespace())
        .collect();
    let mut named = 0;
    for path in [
        "README.md",
        "docs/concepts/browser.md",
        "docs/concepts/watching.md",
    ] {
        let text = read(path);
        for rest in text.split("<kbd>").skip(1) {
            let name = rest.split("</kbd>").next().unwrap_or_default();
            assert!(known.contains(&name), "{path}: there is no key {name}");
            named += 1;
        }
    }
    assert!(named > 8, "documents name keys as <kbd>H</kbd>");
}
