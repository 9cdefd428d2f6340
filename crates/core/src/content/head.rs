//! What does a log's header record about content?

use crate::content::strict_json::StrictJson;
use crate::content::video::grid::tile_grid::TileGrid;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value};

/// Most cells of a grid that is replayed from outside bytes.
const MOST_CELLS: u32 = 1 << 18;
/// What distinguishes other kinds of content from video, which has no such key.
const KIND: &str = "kind";

/// What was chosen on, of any kind of content: only that kind reads it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct ContentHead(CutRecord);

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
enum CutRecord {
    Video(TileGrid),
    /// An object with its kind in it.
    Other(Map<String, Value>),
}

impl ContentHead {
    /// A video that is cut by this grid.
    #[must_use]
    pub fn of_video(grid: TileGrid) -> Self {
        Self(CutRecord::Video(grid))
    }

    /// Content of another kind, and what that kind says of it.
    #[must_use]
    pub fn of_kind(kind: &str, about: Map<String, Value>) -> Self {
        let mut about = about;
        about.insert(KIND.to_owned(), kind.into());
        Self(CutRecord::Other(about))
    }

    /// The grid of a video; `None` where it is of another kind.
    #[must_use]
    pub fn video(&self) -> Option<&TileGrid> {
        match &self.0 {
            CutRecord::Video(grid) => Some(grid),
            CutRecord::Other(_) => None,
        }
    }

    /// What content of a kind says of itself; `None` where it is of another kind.
    #[must_use]
    pub fn other(&self, kind: &str) -> Option<&Map<String, Value>> {
        match &self.0 {
            CutRecord::Other(about) if about[KIND] == kind => Some(about),
            _ => None,
        }
    }

    /// Whether every number of a video is in range, so that it can be chosen on.
    ///
    /// # Errors
    /// Says which is not.
    pub fn check(&self) -> Result<(), String> {
        let Some(grid) = self.video() else {
            return Ok(());
        };
        grid.check().map_err(|error| format!("grid: {error}"))?;
        let cells = grid.tiles_in_level(0);
        if cells > MOST_CELLS {
            return Err(format!(
                "grid: {cells} cells, at most {MOST_CELLS} are replayed"
            ));
        }
        if let Some(fault) = grid.surface.slant.and_then(|slant| slant.fault()) {
            return Err(fault.to_owned());
        }
        let mut tangents = grid.surface.tangents.iter();
        if tangents.all(|t| (1e-6..=1e6).contains(t)) {
            Ok(())
        } else {
            Err("field, tangents: expected tangents between 1e-6 and 1e6".to_owned())
        }
    }
}

impl<'de> Deserialize<'de> for ContentHead {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let StrictJson(value) = StrictJson::deserialize(deserializer)?;
        match value {
            Value::Object(about) if about.get(KIND).is_some_and(Value::is_string) => {
                Ok(Self(CutRecord::Other(about)))
            }
            video => TileGrid::deserialize(video)
                .map(Self::of_video)
                .map_err(|error| D::Error::custom(format!("grid: {error}"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::scripted::scripted_head;
    use crate::view::surface::Surface;

    fn read(text: &str) -> Result<ContentHead, String> {
        serde_json::from_str(text).map_err(|error| error.to_string())
    }

    #[test]
    fn a_video_reads_back_as_it_was_written_and_no_key_may_stand_twice() {
        let head = scripted_head(Surface::cube(1024));
        let text = serde_json::to_string(&head).unwrap();
        assert_eq!(read(&text).unwrap(), head);
        let twice = text.replacen(
            "\"projection\":",
            "\"projection\":\"flat\",\"projection\":",
            1,
        );
        assert!(read(&twice).unwrap_err().contains("duplicate field"));
        assert!(read("{}").unwrap_err().contains("missing field `surface`"));
        assert!(read("[1]").is_err());
    }

    #[test]
    fn another_kind_reads_back_as_it_was_written_and_is_no_video() {
        let text = "{\"kind\":\"cloud\",\"levels\":3}";
        let head = read(text).unwrap();
        assert_eq!(serde_json::to_string(&head).unwrap(), text);
        assert_eq!((head.video(), head.check()), (None, Ok(())));
        assert_eq!(head.other("cloud").unwrap()["levels"], 3);
        assert_eq!(head.other("sound"), None);
    }
}
