//! What in each tile of a pack's finest level might draw the eye?
//!
//! The side table `cues`; `docs/formats/pack.md` is normative.

use super::pack::VideoPack;
use crate::pack::PackError;
use crate::pack::unit::UnitId;
use crate::perception::measures::cues::Cues;
use crate::units::counted;

/// Name of the side table.
pub const CUES: &str = "cues";
/// Version of its layout.
pub const CUES_VERSION: u32 = 1;

/// The cues of a pack's finest level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CueTable {
    rows: Vec<u8>,
    /// The first unit of the finest level.
    first: u32,
}

impl CueTable {
    /// The cues in `rows`, the bytes of the side table of `pack`. Refuses another version and
    /// another length than a row for every unit of the finest level.
    pub fn parse(pack: &VideoPack, version: u32, rows: Vec<u8>) -> Result<Self, PackError> {
        let first = pack.unit(pack.grid().tile_at(0, 0), 0).0;
        let expected = (pack.units().len() - first as usize) * Cues::BYTES;
        if version != CUES_VERSION || rows.len() != expected {
            return Err(PackError::new(
                &format!("side table {CUES}"),
                format!("version {version}, {}", counted(rows.len(), "byte")),
                format!("version {CUES_VERSION}, {}", counted(expected, "byte")),
            ));
        }
        Ok(Self { rows, first })
    }

    /// The cues of a unit of the finest level; `None` for others.
    #[must_use]
    pub fn of(&self, unit: UnitId) -> Option<Cues> {
        let row = unit.0.checked_sub(self.first)? as usize;
        let bytes = self.rows.get(row * Cues::BYTES..)?.first_chunk()?;
        Some(Cues::from_bytes(*bytes))
    }
}
