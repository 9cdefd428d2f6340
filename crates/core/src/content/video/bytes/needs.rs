//! What must a reader understand to show a pack rightly?
//!
//! A reader passes over fields that it does not know. Where that would show a wrong picture, the
//! description lists the field in `needs`, and a reader that does not know it refuses the pack.

use crate::pack::PackError;
use serde::Deserialize;

/// What this program understands.
pub(super) const UNDERSTOOD: [&str; 4] = ["eyes", "cube_faces", "pixel_aspect", "mapping"];

/// The one field that is read before all others, which a later version may write otherwise.
#[derive(Deserialize)]
struct Needs {
    #[serde(default)]
    needs: Vec<String>,
    #[serde(default)]
    kind: Option<String>,
}

/// Refuses a description that needs what this program does not understand.
pub(super) fn check_needs(json: &[u8]) -> Result<(), PackError> {
    let Needs { needs, kind } = serde_json::from_slice(json)
        .map_err(|e| PackError::new("description", e, "the JSON of docs/formats/pack.md"))?;
    if kind.as_deref() == Some("scene") {
        let expected = "a video: this command does not take the pack of a scene";
        return Err(PackError::new("description.kind", "scene", expected));
    }
    let is_new = |name: &&String| !UNDERSTOOD.contains(&name.as_str());
    match needs.iter().find(is_new) {
        None => Ok(()),
        Some(name) => Err(PackError::new(
            "description.needs",
            name.chars()
                .take(64)
                .flat_map(char::escape_default)
                .collect::<String>(),
            format!(
                "nothing but {}; a newer foveal wrote this pack: update foveal",
                UNDERSTOOD.join(", ")
            ),
        )),
    }
}
