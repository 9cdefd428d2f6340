//! What does docs/formats/results.md say of the keys of every command?

use std::collections::{BTreeMap, BTreeSet};

/// Where a key stands: names from outside in, `[]` for the values of an array, `*` for any name.
pub(super) type Place = Vec<String>;

/// One row of a table.
#[derive(Clone, Debug)]
struct Row {
    key: Place,
    unit: String,
}

/// The document, strictly read.
#[derive(Debug)]
pub(super) struct Document {
    commands: BTreeMap<String, Vec<Row>>,
    objects: BTreeMap<String, Vec<Row>>,
    /// Command, key and the name that the key had before.
    pub(super) old_names: BTreeSet<[String; 3]>,
}

const TEXT: &str = include_str!("../../../../../docs/formats/results.md");
const HEADER: [&str; 4] = ["key", "unit", "meaning", "when"];
/// Whose unit another key gives.
pub(super) const TOLD: &str = "as given";
const UNITS: [&str; 38] = [
    TOLD,
    "1/degree²",
    "1/minute",
    "JOD",
    "Hz",
    "Mbit/s",
    "MiB",
    "Mpx",
    "Mpx/s",
    "arcmin",
    "bit/s",
    "bytes",
    "cd/m²",
    "cells",
    "count",
    "cycles/degree",
    "dB",
    "degrees",
    "degrees/s",
    "dioptres",
    "frame number",
    "frames",
    "frames/s",
    "m",
    "mm",
    "ms",
    "number",
    "path",
    "pixels",
    "pixels/degree",
    "ratio",
    "s",
    "samples",
    "share",
    "text",
    "thresholds",
    "tiles",
    "true or false",
];

impl Document {
    pub(super) fn read() -> Self {
        let mut document = Self {
            commands: BTreeMap::new(),
            objects: BTreeMap::new(),
            old_names: BTreeSet::new(),
        };
        let (mut part, mut name) = ("", "");
        for line in TEXT.lines() {
            if let Some(title) = line.strip_prefix("# ") {
                (part, name) = (title, "");
            } else if let Some(title) = line.strip_prefix("## ") {
                name = title;
            } else if line.starts_with("| ") {
                let cells = cells(line);
                match part {
                    "Commands" => rows_of(&mut document.commands, name, &cells),
                    "Objects" => rows_of(&mut document.objects, name, &cells),
                    "Old names" if cells.len() == 3 && cells[0] != "command" => {
                        let of = [cells[0].to_owned(), code(cells[1]), code(cells[2])];
                        assert!(document.old_names.insert(of), "twice: {line}");
                    }
                    _ => {}
                }
            }
        }
        document
    }

    /// The commands that have a table.
    pub(super) fn commands(&self) -> BTreeSet<&str> {
        self.commands.keys().map(String::as_str).collect()
    }

    /// Every key of a command, or of an object, with its unit.
    pub(super) fn keys(&self, name: &str) -> BTreeMap<Place, String> {
        let rows = self.commands.get(name).or(self.objects.get(name));
        let rows = rows.unwrap_or_else(|| panic!("results.md has no table {name:?}"));
        let mut keys = BTreeMap::new();
        for row in rows {
            let Some(object) = reference(&row.unit) else {
                let other = keys.insert(row.key.clone(), row.unit.clone());
                let same = other.is_none_or(|unit: String| unit == row.unit || row.unit == TOLD);
                assert!(same, "{name}: two units of {:?}", row.key);
                continue;
            };
            for (key, unit) in self.keys(object) {
                keys.insert([&row.key[..], &key].concat(), unit);
            }
        }
        keys
    }

    /// The objects that no table refers to.
    pub(super) fn unused_objects(&self) -> Vec<&str> {
        let tables = self.commands.values().chain(self.objects.values());
        let used: BTreeSet<&str> = tables
            .flatten()
            .filter_map(|row| reference(&row.unit))
            .collect();
        let names = self.objects.keys().map(String::as_str);
        names.filter(|name| !used.contains(name)).collect()
    }
}

fn cells(line: &str) -> Vec<&str> {
    let inner = line.strip_prefix('|').and_then(|l| l.strip_suffix('|'));
    let inner = inner.unwrap_or_else(|| panic!("no row of a table: {line}"));
    inner.split('|').map(str::trim).collect()
}

/// The text between backticks.
fn code(cell: &str) -> String {
    let text = cell.strip_prefix('`').and_then(|c| c.strip_suffix('`'));
    text.unwrap_or_else(|| panic!("no key: {cell}")).to_owned()
}

fn rows_of(tables: &mut BTreeMap<String, Vec<Row>>, name: &str, cells: &[&str]) {
    assert!(!name.is_empty(), "a table without a heading: {cells:?}");
    if cells == HEADER {
        let other = tables.insert(name.to_owned(), Vec::new());
        assert!(other.is_none(), "two tables of {name}");
        return;
    }
    assert!(
        cells.len() == 4 && cells.iter().all(|cell| !cell.is_empty()),
        "{name}: {cells:?}"
    );
    let unit = cells[1].to_owned();
    assert!(
        UNITS.contains(&cells[1]) || reference(&unit).is_some(),
        "{name}: no unit: {unit}"
    );
    let row = Row {
        key: place(&code(cells[0])),
        unit,
    };
    tables.get_mut(name).expect("a header first").push(row);
}

/// The table that a unit in brackets refers to.
fn reference(unit: &str) -> Option<&str> {
    let (name, rest) = unit.strip_prefix('[')?.split_once("](#")?;
    assert_eq!(rest, format!("{})", name.replace(' ', "-")), "{unit}");
    Some(name)
}

/// Names from outside in; `.` is the object itself.
fn place(key: &str) -> Place {
    let mut place = Place::new();
    for name in key.split('.').filter(|name| !name.is_empty()) {
        let arrays = name.matches("[]").count();
        place.push(name.trim_end_matches("[]").to_owned());
        place.extend(std::iter::repeat_n("[]".to_owned(), arrays));
    }
    place
}
