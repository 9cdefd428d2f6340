//! What does each unit of a pack add to the next coarser level?
//!
//! The side table `signatures`; `docs/formats/pack.md` is normative.

use super::pack::VideoPack;
use crate::pack::PackError;
use crate::pack::unit::UnitId;
use crate::perception::measures::contrast::Signature;
use crate::units::counted;

/// Name of the side table.
pub const SIGNATURES: &str = "signatures";
/// Version of its layout and meaning. Version 1 had no norms; 1 and 2 described the first picture
/// of a unit before it was coded. Both are read.
pub const SIGNATURES_VERSION: u32 = 3;

/// The first version that was measured on decoded pictures.
const FIRST_DECODED: u32 = 3;

/// The signatures of a pack.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signatures {
    rows: Vec<u8>,
    /// Bytes of a row: version 1 has shorter ones.
    row: usize,
    /// Whether they describe decoded pictures of both levels, and so of the noise of coding.
    tell_of_noise: bool,
    /// The first unit that has one: those of the coarsest level refine nothing.
    first: u32,
}

impl Signatures {
    /// The signatures in `rows`, the bytes of the side table of `pack`. Refuses a version that it
    /// does not know and another length than a row for every unit finer than the coarsest level.
    pub fn parse(pack: &VideoPack, version: u32, rows: Vec<u8>) -> Result<Self, PackError> {
        let first = pack.first_refining_unit().0;
        let row = match version {
            1 => Signature::BYTES_V1,
            _ => Signature::BYTES,
        };
        let expected = (pack.units().len() - first as usize) * row;
        if !(1..=SIGNATURES_VERSION).contains(&version) || rows.len() != expected {
            return Err(PackError::new(
                &format!("side table {SIGNATURES}"),
                format!("version {version}, {}", counted(rows.len(), "byte")),
                format!(
                    "version 1 to {SIGNATURES_VERSION}, {}",
                    counted(expected, "byte")
                ),
            ));
        }
        Ok(Self {
            rows,
            row,
            tell_of_noise: version >= FIRST_DECODED,
            first,
        })
    }

    /// Whether they include the noise of coding.
    #[must_use]
    pub fn tell_of_noise(&self) -> bool {
        self.tell_of_noise
    }

    /// The signature of a unit; `None` for the coarsest level.
    #[must_use]
    pub fn of(&self, unit: UnitId) -> Option<Signature> {
        let row = unit.0.checked_sub(self.first)? as usize;
        let rest = self.rows.get(row * self.row..)?;
        if self.row == Signature::BYTES_V1 {
            return Some(Signature::from_bytes_v1(*rest.first_chunk()?));
        }
        Some(Signature::from_bytes(*rest.first_chunk()?))
    }
}
