//! What did the judge find of a pack's content?
//!
//! The side table `calibration`; `docs/formats/pack.md` is normative.

use crate::content::policy::calibration::Expectation;
use crate::content::video::calibration::{Calibration, CalibrationRow, ZONES};
use crate::pack::{PackError, SideTable};
use crate::units::counted;

/// Name of the side table.
pub const CALIBRATION: &str = "calibration";
/// Version of its layout.
pub const CALIBRATION_VERSION: u32 = 1;

/// Gazes, frames, then the number of rows.
const HEAD_BYTES: usize = 8;
const ROW_BYTES: usize = 32;
/// Two rules, four parts of the picture, eight densities and sixteen bounds.
const MOST_ROWS: usize = 2 * (1 + ZONES) * 8 * 16;
/// A picture shows every finest pixel, and the coarsest level besides.
const MOST_SHARE: f64 = 2.0;
/// Scores are stored in hundredths.
const HUNDREDTHS: f64 = 100.0;

impl Calibration {
    /// The calibration in the bytes of the side table. Refuses another version, another length than
    /// the head says, and rows that are no calibration.
    pub fn parse(version: u32, bytes: &[u8]) -> Result<Self, PackError> {
        let refused = |found: String, expected: &str| {
            PackError::new(
                &format!("side table {CALIBRATION}"),
                found,
                expected.to_owned(),
            )
        };
        if version != CALIBRATION_VERSION {
            let expected = format!("version {CALIBRATION_VERSION}");
            return Err(refused(format!("version {version}"), &expected));
        }
        let head = bytes.first_chunk::<HEAD_BYTES>();
        let head = head.ok_or_else(|| refused(counted(bytes.len(), "byte"), "at least 8 bytes"))?;
        let [gazes, frames] = [0, 2].map(|at| u16::from_le_bytes([head[at], head[at + 1]]));
        let count = u32::from_le_bytes([head[4], head[5], head[6], head[7]]) as usize;
        let rows = &bytes[HEAD_BYTES..];
        if count > MOST_ROWS || rows.len() != count * ROW_BYTES {
            return Err(refused(
                format!(
                    "{} for {}",
                    counted(bytes.len(), "byte"),
                    counted(count, "row")
                ),
                "32 bytes a row of at most 1024, after 8",
            ));
        }
        let (rows, _) = rows.as_chunks::<ROW_BYTES>();
        let rows: Option<Vec<CalibrationRow>> = rows.iter().map(read_row).collect();
        let rows =
            rows.ok_or_else(|| refused("another rule or zone".to_owned(), "0, 1; 0 to 3"))?;
        if let Some(row) = rows.iter().find(|row| row.pixels_share > MOST_SHARE) {
            let found = format!("{} of the pixels", row.pixels_share);
            return Err(refused(found, "a share of at most 2"));
        }
        let all = Self::new(gazes, frames, rows.clone());
        let all = all.map_err(|expected| refused("other rows".to_owned(), expected))?;
        match all.rows() == rows {
            true => Ok(all),
            false => Err(refused("rows in another order".to_owned(), "each rising")),
        }
    }

    /// The side table.
    #[must_use]
    pub fn to_table(&self) -> SideTable {
        let mut bytes = Vec::with_capacity(HEAD_BYTES + self.rows().len() * ROW_BYTES);
        bytes.extend(self.gazes.to_le_bytes());
        bytes.extend(self.frames.to_le_bytes());
        bytes.extend((self.rows().len() as u32).to_le_bytes());
        self.rows()
            .iter()
            .for_each(|row| write_row(row, &mut bytes));
        SideTable {
            name: CALIBRATION.to_owned(),
            version: CALIBRATION_VERSION,
            bytes,
        }
    }
}

impl CalibrationRow {
    /// The row as the table stores it: scores in hundredths, other numbers in single precision.
    #[must_use]
    pub fn as_told(&self) -> Self {
        let mut bytes = Vec::with_capacity(ROW_BYTES);
        write_row(self, &mut bytes);
        let told = bytes.first_chunk().and_then(read_row);
        told.unwrap_or(*self)
    }
}

fn write_row(row: &CalibrationRow, bytes: &mut Vec<u8>) {
    let hundredths = |jod: f64| (jod * HUNDREDTHS).round();
    bytes.push(u8::from(row.rule == Expectation::Elsewise));
    bytes.push(row.zone.map_or(0, |zone| zone as u8 + 1));
    // A score has no lower end; beyond this one nothing is chosen for it.
    let jod = hundredths(row.jod_mean).clamp(f64::from(i16::MIN), f64::from(i16::MAX));
    bytes.extend((jod as i16).to_le_bytes());
    bytes.extend((hundredths(row.jod_sd).min(f64::from(u16::MAX)) as u16).to_le_bytes());
    bytes.extend([0, 0]);
    for value in [row.ppd, row.bound, row.loss, row.pixels_share] {
        bytes.extend((value as f32).to_le_bytes());
    }
    bytes.extend(row.bytes.to_le_bytes());
}

fn read_row(bytes: &[u8; ROW_BYTES]) -> Option<CalibrationRow> {
    let u16_at = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
    let four = |at: usize| [0, 1, 2, 3].map(|k| bytes[at + k]);
    let f32_at = |at: usize| f64::from(f32::from_le_bytes(four(at)));
    let [low, high] = [24, 28].map(|at| u64::from(u32::from_le_bytes(four(at))));
    Some(CalibrationRow {
        rule: match bytes[0] {
            0 => Expectation::ByLoss,
            1 => Expectation::Elsewise,
            _ => return None,
        },
        zone: match usize::from(bytes[1]) {
            0 => None,
            zone @ 1..=ZONES => Some(zone - 1),
            _ => return None,
        },
        jod_mean: f64::from(u16_at(2) as i16) / HUNDREDTHS,
        jod_sd: f64::from(u16_at(4)) / HUNDREDTHS,
        ppd: f32_at(8),
        bound: f32_at(12),
        loss: f32_at(16),
        pixels_share: f32_at(20),
        bytes: high << 32 | low,
    })
}
