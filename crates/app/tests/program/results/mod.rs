//! Is what every command prints under `--json` what docs/formats/results.md says, to the key?

mod benches;
mod document;
mod errors;
mod eye;
mod packs;
mod scenes;
mod units;

use crate::support::foveal;
use document::{Document, Place, TOLD};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Whether these results of a command and its table in the document have the same keys: each that
/// was printed is documented, and each that is documented was printed.
pub(crate) fn agrees(command: &str, results: &[&Value]) {
    let document = Document::read();
    let documented = document.keys(command);
    let mut missing: BTreeSet<&Place> = documented.keys().collect();
    let renamed: BTreeMap<String, String> = document
        .old_names
        .iter()
        .filter(|[of, ..]| of == command)
        .map(|[_, key, old]| (old.clone(), key.clone()))
        .collect();
    let mut old: BTreeSet<&String> = renamed.keys().collect();
    for (place, whole) in results.iter().flat_map(|result| places(result)) {
        let found = matching(&documented, &place, whole);
        let renamed = renamed.iter().find(|(old, key)| {
            let new = place
                .iter()
                .map(|name| if name == *old { *key } else { name });
            let new: Place = new.cloned().collect();
            new != place && matching(&documented, &new, whole).is_some()
        });
        assert!(
            found.is_some() || renamed.is_some(),
            "{command}: results.md lacks {}",
            told(&place)
        );
        missing.retain(|key| found.iter().flatten().all(|found| key != found));
        old.retain(|name| renamed.is_none_or(|(found, _)| name != &found));
    }
    let missing: Vec<String> = missing.into_iter().map(told).collect();
    assert!(missing.is_empty(), "{command}: no run printed {missing:?}");
    assert!(old.is_empty(), "{command}: no run printed the old {old:?}");
}

/// The documented keys that a printed one is: itself, or, where nothing stands within it, all
/// that could stand there. None at all is no match.
fn matching<'a>(
    documented: &'a BTreeMap<Place, String>,
    place: &Place,
    whole: bool,
) -> Option<Vec<&'a Place>> {
    let same = |(found, name): (&String, &String)| found == "*" || found == name;
    let begins = |key: &Place| key.len() >= place.len() && key.iter().zip(place).all(same);
    let mut fitting = documented.keys().filter(|key| begins(key)).peekable();
    fitting.peek()?;
    let exact: Vec<&Place> = documented
        .keys()
        .filter(|key| key.len() == place.len() && begins(key))
        .collect();
    match exact.is_empty() {
        false => Some(exact),
        true => (!whole).then(Vec::new),
    }
}

/// Every place in a result, and whether a value stands there: nothing does in null or in an empty
/// array.
fn places(value: &Value) -> Vec<(Place, bool)> {
    fn walk(value: &Value, at: &Place, found: &mut Vec<(Place, bool)>) {
        let below = |name: &str| [&at[..], &[name.to_owned()]].concat();
        match value {
            Value::Object(keys) => keys
                .iter()
                .for_each(|(key, value)| walk(value, &below(key), found)),
            Value::Array(values) if values.is_empty() => found.push((below("[]"), false)),
            Value::Array(values) => values
                .iter()
                .for_each(|value| walk(value, &below("[]"), found)),
            Value::Null => found.push((at.clone(), false)),
            _ => found.push((at.clone(), true)),
        }
    }
    let mut found = Vec::new();
    walk(value, &Place::new(), &mut found);
    found
}

fn told(place: &Place) -> String {
    place.join(".").replace(".[]", "[]")
}

#[test]
fn no_unit_contradicts_the_ending_of_its_key() {
    let document = Document::read();
    // What commands print of a scene in the place of what they print of a video.
    let of_scenes = ["run through a scene", "verified scene"];
    assert_eq!(
        document.unused_objects(),
        [&["error"][..], &of_scenes].concat()
    );
    for command in document.commands() {
        for (place, unit) in document.keys(command) {
            let mut names = place.iter().rev().filter(|name| *name != "[]");
            let own = units::unit_of(names.next().unwrap());
            // The median of `clock_ms` has the unit of what it is the median of.
            let outer = || names.next().and_then(|name| units::unit_of(name));
            let known = own.or_else(|| (unit == TOLD).then(outer).flatten());
            let key = told(&place);
            match (known, unit == TOLD) {
                (Some(known), false) => assert_eq!(known, unit, "{command}: {key}"),
                // These give the unit next to the number.
                (None, true) if ["score", "bench scene"].contains(&command) => {}
                (None, true) => panic!("{command}: {key}: in which unit?"),
                _ => {}
            }
        }
    }
}

#[test]
fn every_command_that_has_results_is_documented_and_checked() {
    let document = Document::read();
    let mut commands = BTreeSet::new();
    let mut open = vec![Vec::<String>::new()];
    while let Some(words) = open.pop() {
        let mut arguments: Vec<&str> = words.iter().map(String::as_str).collect();
        arguments.push("--help");
        let help = foveal(&arguments).stdout;
        if help.lines().any(|line| line.trim().starts_with("--json")) {
            commands.insert(words.join(" "));
        }
        // The first list has a column of tasks before the names.
        let (begin, indent) = match words.is_empty() {
            true => ("<COMMAND>\n\n", 10),
            false => ("Commands:\n", 2),
        };
        let inner = help.split_once(begin).map_or("", |(_, list)| list);
        for line in inner.lines().take_while(|line| !line.trim().is_empty()) {
            // A description may go on in the next line.
            let name = line.get(indent..).filter(|line| !line.starts_with(' '));
            let name = name.and_then(|line| line.split(' ').next());
            let known = name.filter(|name| *name != "help");
            open.extend(known.map(|name| [&words[..], &[name.to_owned()]].concat()));
        }
    }
    let commands: BTreeSet<&str> = commands.iter().map(String::as_str).collect();
    assert_eq!(document.commands(), commands);
    // Runs that other tests need anyhow are checked there.
    let spaced = |text: &str| text.split_whitespace().collect::<String>();
    let tests = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/program");
    let mut sources = String::new();
    for folder in [tests.to_owned(), format!("{tests}/results")] {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_file() {
                sources += &spaced(&std::fs::read_to_string(path).unwrap());
            }
        }
    }
    for command in commands {
        let call = format!("agrees(\"{command}\"");
        assert!(sources.contains(&spaced(&call)), "no test says {call}, ..)");
    }
}
