//! Is this the same input, made into the same pack by the same program, as before?

use super::error::PrepareError;
use super::plan::PreparationPlan;
use crate::error::MediaError;
use crate::plain_file::first_bytes;
use foveal_core::pack::Identity;
use foveal_core::session::log::sha256_hex;
use std::fmt;
use std::path::Path;
use std::time::SystemTime;

/// Bytes at the beginning of an input that are compared.
const FIRST_BYTES: u64 = 1 << 20;

/// What changes when a file is written to.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct FileStamp {
    bytes: u64,
    modified: Option<SystemTime>,
}

impl fmt::Debug for FileStamp {
    /// The text is a part of what packs are known by, so it stays as it was first written, also
    /// where the type has another name.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_struct("Stamp")
            .field("bytes", &self.bytes)
            .field("modified", &self.modified)
            .finish()
    }
}

impl FileStamp {
    /// The stamp of a file; `None` where there is none under that name.
    pub(super) fn of(input: &Path) -> Option<Self> {
        let there = std::fs::metadata(input).ok()?;
        Some(Self {
            bytes: there.len(),
            modified: there.modified().ok(),
        })
    }
}

/// Hexadecimal digits of a digest that a pack keeps: 128 bits.
const DIGITS: usize = 32;

/// What a pack records of how it was made: the program by name, the rest as digests, so that a
/// published pack gives away no folder.
///
/// # Errors
/// The input cannot be read.
pub fn pack_identity_of(input: &Path, plan: &PreparationPlan) -> Result<Identity, PrepareError> {
    let Identity {
        program,
        input: stamp,
        settings,
    } = identity_of(input, plan)?;
    // What is read by another way is the same file.
    let path = input.canonicalize().unwrap_or_else(|_| input.to_owned());
    let digest = |text: &str| sha256_hex(text.as_bytes())[..DIGITS].to_owned();
    Ok(Identity {
        program,
        input: digest(&format!("{}, {stamp}", path.display())),
        settings: digest(&settings),
    })
}

/// What a pack that was begun must agree in to be gone on with.
pub(super) fn identity_of(input: &Path, plan: &PreparationPlan) -> Result<Identity, PrepareError> {
    let unreadable = |e: std::io::Error| MediaError::Open {
        path: input.to_owned(),
        reason: e.to_string(),
    };
    let first = first_bytes(input, FIRST_BYTES).map_err(unreadable)?;
    let codecs = ffmpeg_next::codec::version();
    let [major, minor, micro] = [codecs >> 16, codecs >> 8 & 255, codecs & 255];
    Ok(Identity {
        program: format!(
            "{}, libavcodec {major}.{minor}.{micro}",
            plan.description.generator
        ),
        input: format!(
            "{}, {:?}, {:08x}",
            plan.description.source.name,
            FileStamp::of(input),
            crc32c::crc32c(&first)
        ),
        settings: plan.what_decides_the_bytes(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_of_a_stamp_stays_as_packs_have_it() {
        let stamp = FileStamp {
            bytes: 7,
            modified: None,
        };
        assert_eq!(format!("{stamp:?}"), "Stamp { bytes: 7, modified: None }");
    }
}
