//! How does a pack that was made before get a calibration?

use crate::pack::name_claim::{NameClaim, cannot_begin};
use crate::pack::pack_file::{PackFile, PackFileError};
use crate::plain_file::open_plain;
use foveal_core::content::video::bytes::build::with_calibration;
use foveal_core::content::video::calibration::Calibration;
use foveal_core::pack::{HEADER_BYTES, Header, PackHead};
use std::fs::{self, File};
use std::io::{Error, Read, Seek, SeekFrom, Write, copy};
use std::path::Path;

/// Writes a copy of a pack with this calibration, in the place of one that it has, to a name that
/// was claimed. It is read back before it gets its name; returns its bytes.
///
/// # Errors
/// The pack cannot be read, its description has no room for another table, or the copy cannot be
/// written; then nothing is left behind.
pub fn write_calibrated(
    old: &Path,
    mut claim: NameClaim,
    calibration: &Calibration,
) -> Result<u64, PackFileError> {
    let io = |path: &Path, what: &str, source| PackFileError::Io {
        path: path.to_owned(),
        what: what.to_owned(),
        source,
    };
    let opened = PackFile::open(old)?;
    let (mut from, _) = open_plain(opened.path()).map_err(|e| io(old, "cannot be opened", e))?;
    let head = read_head(&mut from).map_err(|e| io(old, "cannot be read", e))?;
    let format = |source| PackFileError::Format {
        path: old.to_owned(),
        source,
    };
    let tail = Vec::new();
    let parts = with_calibration(PackHead { head, tail }, calibration).map_err(format)?;
    let bytes = Header::parse(&parts.head).map_err(format)?.file_bytes;
    let partial = claim.partial().to_owned();
    let to = claim.take_empty();
    let mut to = to.map_err(|source| cannot_begin(claim.path(), source))?;
    let written = write(&mut from, &mut to, &parts, bytes);
    let ended = written
        .map_err(|e| {
            io(
                claim.path(),
                "cannot be written; nothing was left behind",
                e,
            )
        })
        .and_then(|()| match PackFile::open(&partial)?.verify(|_, _| ()) {
            damage if damage.is_empty() => Ok(()),
            _ => Err(io(
                claim.path(),
                "was written and cannot be read back; check the disk, and the old pack with \
                 foveal verify",
                Error::other("it is damaged"),
            )),
        })
        .and_then(|()| {
            let named = claim.give_name();
            named.map_err(|e| io(claim.path(), "cannot get its name", e))
        });
    if ended.is_err() {
        // A half file is of no use.
        let _ = fs::remove_file(&partial);
    }
    ended.map(|()| bytes)
}

/// Header and description.
fn read_head(from: &mut File) -> Result<Vec<u8>, Error> {
    let mut head = vec![0; HEADER_BYTES];
    from.read_exact(&mut head)?;
    let header = Header::parse(&head).map_err(|error| Error::other(error.to_string()))?;
    head.resize(HEADER_BYTES + header.description_bytes as usize, 0);
    from.read_exact(&mut head[HEADER_BYTES..])?;
    Ok(head)
}

fn write(from: &mut File, to: &mut File, parts: &PackHead, bytes: u64) -> Result<(), Error> {
    let begin = parts.head.len() as u64;
    let kept = bytes - begin - parts.tail.len() as u64;
    to.write_all(&parts.head)?;
    from.seek(SeekFrom::Start(begin))?;
    if copy(&mut from.take(kept), to)? < kept {
        return Err(Error::other("the old pack ended before its time"));
    }
    to.write_all(&parts.tail)?;
    to.sync_all()
}
