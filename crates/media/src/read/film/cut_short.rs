//! Does a file end before it says that it does?
//!
//! FFmpeg reads some files to where they break off and reports a normal end. Other containers
//! report the cut by themselves.

use crate::plain_file::first_bytes;
use crate::read::film::animation_end::cut_animation;
use std::path::Path;

/// Identifiers of the two elements that every Matroska file begins with (RFC 8794, RFC 9559).
pub(crate) const EBML: u64 = 0x1A45_DFA3;
pub(crate) const SEGMENT: u64 = 0x1853_8067;
/// The file's first element is shorter than this, bytes.
const MOST_HEADER_BYTES: u64 = 4096;

/// Why the file of a format, by FFmpeg's name of it, is not whole; none where nothing says so.
pub(crate) fn why_cut(path: &Path, bytes: u64, format: &str) -> Option<String> {
    match format {
        "apng" | "gif" => cut_animation(path),
        _ => is_cut_matroska(path, bytes).then(|| "it ends too early".to_owned()),
    }
}

/// Whether the file is Matroska and shorter than its header says; false where it cannot be read.
fn is_cut_matroska(path: &Path, bytes: u64) -> bool {
    let head = first_bytes(path, MOST_HEADER_BYTES).unwrap_or_default();
    declared_matroska_bytes(&head).is_some_and(|declared| declared > bytes)
}

/// Length of the Matroska file that begins with `head`; None for other files and unknown lengths.
fn declared_matroska_bytes(head: &[u8]) -> Option<u64> {
    let (id, size, after) = element(head, 0)?;
    if id != EBML {
        return None;
    }
    let (id, size, start) = element(head, after.checked_add(size?)?)?;
    if id != SEGMENT {
        return None;
    }
    start.checked_add(size?)
}

/// Identifier, size and start of the contents of the element at `at`; no size where it is unknown.
fn element(head: &[u8], at: u64) -> Option<(u64, Option<u64>, u64)> {
    let rest = head.get(usize::try_from(at).ok()?..)?;
    let (id, id_length) = number(rest)?;
    let (marked, length) = number(&rest[id_length..])?;
    let value = marked & !(1 << (7 * length));
    let is_unknown = value == (1 << (7 * length)) - 1;
    Some((
        id,
        (!is_unknown).then_some(value),
        at + (id_length + length) as u64,
    ))
}

/// An EBML number with its length marker, and its length in bytes.
fn number(bytes: &[u8]) -> Option<(u64, usize)> {
    let length = bytes.first()?.leading_zeros() as usize + 1;
    let digits = bytes.get(..length).filter(|_| length <= 8)?;
    Some((
        digits
            .iter()
            .fold(0, |sum, &byte| (sum << 8) | u64::from(byte)),
        length,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_declared_length_is_the_segment_and_all_before_it() {
        let head = [
            0x1A, 0x45, 0xDF, 0xA3, 0x82, 7, 7, 0x18, 0x53, 0x80, 0x67, 0x40, 200, 1,
        ];
        assert_eq!(declared_matroska_bytes(&head), Some(13 + 200));
        let mut streamed = head;
        streamed[11..13].copy_from_slice(&[0x7F, 0xFF]);
        assert_eq!(declared_matroska_bytes(&streamed), None);
        assert_eq!(declared_matroska_bytes(b"RIFF"), None);
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(tail in prop::collection::vec(any::<u8>(), 0..40)) {
            let _ = declared_matroska_bytes(&tail);
            let mut head = vec![0x1A, 0x45, 0xDF, 0xA3];
            head.extend(&tail);
            let _ = declared_matroska_bytes(&head);
        }
    }
}
