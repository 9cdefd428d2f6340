//! What is wrong with the bytes of a pack?

use crate::units::one_line;
use thiserror::Error;

/// Why bytes are no pack, or a damaged one: which field, what was found, what was expected.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}", self.in_words())]
pub struct PackError {
    /// The field of the format, as `docs/formats/pack.md` names it.
    pub field: String,
    /// What the bytes say.
    pub found: String,
    /// What they should say.
    pub expected: String,
}

impl PackError {
    fn in_words(&self) -> String {
        let Self {
            field,
            found,
            expected,
        } = self;
        match field.as_str() {
            "magic" => format!("is not a Foveal pack: it begins with {found}"),
            _ => format!("{field}: found {found}, expected {expected}"),
        }
    }

    pub(crate) fn new(field: &str, found: impl ToString, expected: impl ToString) -> Self {
        Self {
            field: field.to_owned(),
            found: one_line(&found.to_string()),
            expected: one_line(&expected.to_string()),
        }
    }

    fn checksum(field: &str, found: u32, expected: u32) -> Self {
        Self::new(
            field,
            format!("CRC32C {found:08x}"),
            format!("{expected:08x} (damaged bytes)"),
        )
    }
}

/// Checks `bytes` against the CRC32C that was written for them; `field` names them in the error.
pub fn check_crc(field: &str, bytes: &[u8], expected: u32) -> Result<(), PackError> {
    check_crc_of(field, crc32c::crc32c(bytes), expected)
}

/// Compares a CRC32C with the one that was written; `field` names what it is of in the error.
pub(super) fn check_crc_of(field: &str, found: u32, expected: u32) -> Result<(), PackError> {
    if found == expected {
        Ok(())
    } else {
        Err(PackError::checksum(field, found, expected))
    }
}

pub(crate) fn u32_at(bytes: &[u8], at: usize) -> u32 {
    let mut word = [0; 4];
    word.copy_from_slice(&bytes[at..at + 4]);
    u32::from_le_bytes(word)
}

pub(crate) fn u64_at(bytes: &[u8], at: usize) -> u64 {
    let mut word = [0; 8];
    word.copy_from_slice(&bytes[at..at + 8]);
    u64::from_le_bytes(word)
}
