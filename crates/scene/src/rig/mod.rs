//! What does a rig file say: which displays stand round the eyes, and how is each fed?
//!
//! Normative: docs/formats/panels.md.

mod checked;
mod distortion;
mod entries;
mod error;
mod pfm;
mod places;
#[cfg(test)]
mod tests;

use std::path::Path;

use foveal_core::view::panel::rig::Rig;

pub use error::RigError;

use error::{NEXT, RigFault};
use places::{RigSyntax, RigText};

/// Most bytes of a rig file.
const MOST_BYTES: u64 = 1 << 24;

/// Reads a rig file: TOML, or JSON where its name ends in `.json`. Files that it names lie in its
/// folder.
///
/// Refused are files that break their format, say what cannot be, or have keys that there are not;
/// the error names line and key.
pub fn read_rig(path: &Path) -> Result<Rig, RigError> {
    let ending = path.extension().and_then(|ending| ending.to_str());
    let syntax = match ending.map(str::to_ascii_lowercase).as_deref() {
        Some("toml") => RigSyntax::Toml,
        Some("json") => RigSyntax::Json,
        _ => {
            let what = "is no rig file that can be read; give one that ends in .toml or .json";
            return Err(RigFault::new("", what, NEXT).in_file(path));
        }
    };
    let failed = |error: std::io::Error| {
        let what = format!("cannot be read: {error}");
        RigFault::new("", what, "check the path and the permissions").in_file(path)
    };
    let about = std::fs::metadata(path).map_err(failed)?;
    if !about.is_file() || about.len() > MOST_BYTES {
        let what = format!("is no file of at most {MOST_BYTES} bytes");
        return Err(RigFault::new("", what, NEXT).in_file(path));
    }
    let bytes = std::fs::read(path).map_err(failed)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let read = |name: &str| -> Result<Vec<u8>, String> { beside(folder, name) };
    parse_rig(&bytes, syntax, &read).map_err(|fault| fault.in_file(path))
}

/// The bytes of a file that lies in a folder, or why not.
fn beside(folder: &Path, name: &str) -> Result<Vec<u8>, String> {
    /// Of a map of 16,384 x 16,384 pixels would be 3 GB; of the largest displays 400 MB.
    const MOST: u64 = 1 << 29;
    let only_names = |path: &Path| {
        let mut parts = path.components();
        parts.all(|part| matches!(part, std::path::Component::Normal(_)))
    };
    if name.is_empty() || !only_names(Path::new(name)) {
        return Err("names no file in the rig file's folder".to_owned());
    }
    let path = folder.join(name);
    let about = std::fs::metadata(&path).map_err(|error| format!("cannot be read: {error}"))?;
    if !about.is_file() || about.len() > MOST {
        return Err(format!("is no file of at most {MOST} bytes"));
    }
    std::fs::read(&path).map_err(|error| format!("cannot be read: {error}"))
}

fn parse_rig(
    bytes: &[u8],
    syntax: RigSyntax,
    read: &dyn Fn(&str) -> Result<Vec<u8>, String>,
) -> Result<Rig, RigFault> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let place = format!("byte {}", error.valid_up_to());
        RigFault::new(&place, "is no text in UTF-8", NEXT)
    })?;
    let text = RigText { text, syntax };
    let said: entries::RigEntries = text.parse()?;
    checked::rig(&said, read).map_err(|wrong| text.fault(&wrong))
}

/// Reads any bytes as TOML and as JSON, without the files that they name; `true` if they are a rig.
/// Panics if that rig breaks what it promises: for fuzzing and tests.
pub fn read_any_rig(bytes: &[u8]) -> bool {
    let nothing = |_: &str| Err("is not there".to_owned());
    let both = [RigSyntax::Toml, RigSyntax::Json];
    let mut is_one = false;
    for rig in both
        .into_iter()
        .filter_map(|syntax| parse_rig(bytes, syntax, &nothing).ok())
    {
        is_one = true;
        for panel in &rig.panels {
            assert!(panel.view.field.is_open() && !panel.id.contains('/'));
            assert!(panel.corners().iter().all(|it| it.is_finite()));
        }
    }
    is_one
}

/// Reads any bytes as a portable float map; `true` if they are one of 4 x 3 pixels: for fuzzing and
/// tests.
pub fn read_any_pfm(bytes: &[u8]) -> bool {
    pfm::read(bytes, [4, 3]).is_ok()
}

/// The JSON Schema of rig files, as docs/formats/tiled-view.schema.json has it.
#[must_use]
pub fn rig_schema() -> String {
    let schema = schemars::schema_for!(entries::RigEntries);
    let mut text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    text.push('\n');
    text
}
