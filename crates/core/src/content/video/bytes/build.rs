//! How do the tiles of a video become a pack?

use super::calibration_table::CALIBRATION;
use super::chunk::{chunk_name, join_chunk, named_chunk};
use super::description::{Description, Loss};
use super::needs::UNDERSTOOD;
use super::pack::{numbers_of, unit_of};
use crate::content::video::calibration::Calibration;
use crate::content::video::grid::tile_grid::Tile;
use crate::pack::{HEADER_BYTES, Header, PackBuilder, PackError, PackHead, SideTable, TableEntry};
use crate::view::surface::{Screen, are_all_faces, is_one_eye};
use serde::Serialize;

/// A description as it is written.
#[derive(Serialize)]
struct Written<'a> {
    #[serde(flatten)]
    description: &'a Description,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    needs: Vec<&'static str>,
}

impl<'a> Written<'a> {
    /// The description with what it needs.
    fn new(description: &'a Description) -> Self {
        let needed = [
            !is_one_eye(&description.eyes),
            !are_all_faces(&description.cube_faces),
            description.pixel_aspect[0] != description.pixel_aspect[1],
            !description.mapping.is_default(),
        ];
        let needs = UNDERSTOOD.into_iter().zip(needed);
        Self {
            description,
            needs: needs.filter_map(|(name, is)| is.then_some(name)).collect(),
        }
    }
}

/// Begins a pack that will have about this description.
#[must_use]
pub fn begin_pack(draft: &Description) -> PackBuilder {
    PackBuilder::new(&serde_json::to_vec(draft).unwrap_or_default())
}

/// Notes the next chunk: the access units of `tile` from `first_frame` on. Returns its bytes, which
/// are written right after the chunk before.
pub fn push_tile(
    builder: &mut PackBuilder,
    tile: Tile,
    first_frame: u32,
    access_units: &[Vec<u8>],
) -> Vec<u8> {
    let chunk = join_chunk(access_units);
    builder.push(chunk_name(tile, first_frame), &chunk);
    chunk
}

/// The bytes before and after the chunks. Every unit of `description` must have been pushed once,
/// or the error says which is missing.
pub fn finish_pack(
    builder: PackBuilder,
    mut description: Description,
    tables: &[SideTable],
) -> Result<PackHead, PackError> {
    description.tables.clear();
    description.check()?;
    let (numbers, grid) = (
        numbers_of(&description)?,
        description.grid(Screen::default()),
    );
    let about = description.clone();
    let unit = |name| {
        let (tile, first_frame) = named_chunk(name);
        unit_of(&numbers, (&about, &grid), tile, first_frame)
    };
    builder.finish(&numbers, unit, tables, |tables| {
        description.tables = tables;
        json_of(&description)
    })
}

/// The same pack with what preparing lost, which only a finished pack shows; as long as before.
pub fn with_loss(head: PackHead, loss: Loss) -> Result<PackHead, PackError> {
    let description = Description {
        loss: Some(loss),
        ..Description::parse(&head.head[HEADER_BYTES..])?
    };
    description.check()?;
    head.described_as(json_of(&description)?)
}

/// The same pack with a calibration behind all other tables, which only a finished pack can be
/// judged for, in the place of an older one. The head no longer mentions an older one's
/// bytes: write the new one's, which end the tail, over them.
///
/// # Errors
/// The older one does not lie behind all other tables, or the description has no room.
pub fn with_calibration(
    mut head: PackHead,
    calibration: &Calibration,
) -> Result<PackHead, PackError> {
    let mut description = Description::parse(&head.head[HEADER_BYTES..])?;
    let is_older = |table: &TableEntry| table.name == CALIBRATION;
    if let Some(at) = description.tables.iter().position(is_older) {
        let older = description.tables.remove(at);
        if older.offset + older.bytes != Header::parse(&head.head)?.file_bytes {
            return Err(PackError::new(
                "side table calibration",
                "tables behind it".to_owned(),
                "the last of all",
            ));
        }
        head = head.without_last(&older)?;
    }
    head.with_table(&calibration.to_table(), |entry| {
        description.tables.push(entry);
        description.check()?;
        json_of(&description)
    })
}

fn json_of(description: &Description) -> Result<Vec<u8>, PackError> {
    let json = serde_json::to_vec(&Written::new(description));
    json.map_err(|e| PackError::new("description", e, "valid JSON"))
}
