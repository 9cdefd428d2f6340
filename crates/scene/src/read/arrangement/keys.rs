//! Which keys has a scene file, and where is what is wrong in it?

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::super::error::Fault;
use super::super::text::shortened;
use crate::nearest::{line_number, nearest};

/// What to do about a scene file that is wrong.
pub(super) const NEXT: &str = "docs/formats/scene.md says what a scene file says";

/// The keys of a table, and those of the tables in it.
pub(super) struct Keys {
    pub(super) names: &'static [&'static str],
    pub(super) tables: &'static [(&'static str, Keys)],
}

/// The keys of a scene file.
pub(super) const KEYS: Keys = Keys {
    names: &["background", "light", "input"],
    tables: &[("input", INPUT)],
};
const INPUT: Keys = Keys {
    names: &["file", "name", "up", "place"],
    tables: &[("place", PLACE)],
};
/// The keys of a place.
pub(super) const PLACE: Keys = Keys {
    names: &["translation", "rotation_deg", "scale"],
    tables: &[],
};
/// Those of a table that holds places alone.
pub(super) const PLACES: Keys = Keys {
    names: &["place"],
    tables: &[("place", PLACE)],
};

/// The line of a byte of a text, which may be a part of a whole.
pub(super) type LineOf<'a> = &'a dyn Fn(usize) -> String;

impl Keys {
    /// Refuses what is no TOML, and keys that there are not.
    pub(super) fn check_text(&self, text: &str, line: LineOf<'_>) -> Result<(), Fault> {
        let table = DeTable::parse(text).map_err(|error| wrong(&error, line))?;
        self.check(table.get_ref(), line)
    }

    fn check(&self, table: &DeTable<'_>, line: LineOf<'_>) -> Result<(), Fault> {
        for (key, value) in table {
            let name = key.get_ref().as_ref();
            if !self.names.contains(&name) {
                let nearest = nearest(self.names.iter().copied(), name);
                let what = format!("there is no key {:?}", shortened(name));
                let next = match nearest {
                    Some(nearest) => format!("the nearest is {nearest:?}; {NEXT}"),
                    None => NEXT.to_owned(),
                };
                return Err(Fault::broken(line(key.span().start), what, next));
            }
            if let Some((_, keys)) = self.tables.iter().find(|(table, _)| *table == name) {
                keys.check_all(value, line)?;
            }
        }
        Ok(())
    }

    /// Checks a table, or each of several; anything else is refused by its type later.
    fn check_all(&self, value: &Spanned<DeValue<'_>>, line: LineOf<'_>) -> Result<(), Fault> {
        match value.get_ref() {
            DeValue::Table(table) => self.check(table, line),
            DeValue::Array(all) => all.iter().try_for_each(|it| match it.get_ref() {
                DeValue::Table(table) => self.check(table, line),
                _ => Ok(()),
            }),
            _ => Ok(()),
        }
    }
}

/// What a parser says is wrong, with its line.
pub(super) fn wrong(error: &toml::de::Error, line: LineOf<'_>) -> Fault {
    let line = line(error.span().map_or(0, |span| span.start));
    Fault::broken(line, error.message().replace('\n', " "), NEXT)
}

pub(super) fn line_of(text: &str, byte: usize) -> String {
    format!("line {}", line_number(text, byte))
}
