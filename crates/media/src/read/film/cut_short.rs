//! Does a file end before it says that it does?
//!
//! FFmpeg reads some files to where they break off and reports a normal end. Other containers
//! report the cut by themselves.

use crate::plain_file::{first_bytes, last_bytes};
use crate::read::film::animation_end::cut_animation;
use std::path::Path;

/// Identifiers of the two elements that every Matroska file begins with (RFC 8794, RFC 9559).
pub(crate) const EBML: u64 = 0x1A45_DFA3;
pub(crate) const SEGMENT: u64 = 0x1853_8067;
/// Bytes of a packet of a transport stream, and from one to the next: with a time before each, and
/// with a checksum behind each, too. The first of them is always the same.
const PACKET: usize = 188;
const PACKET_STEPS: [usize; 3] = [188, 192, 204];
const SYNC: u8 = 0x47;
/// Bytes that are looked at for packets at the end, and packets that must be there.
const LAST_BYTES: u64 = 4096;
const LEAST_PACKETS: usize = 8;
/// The file's first element is shorter than this, bytes.
const MOST_HEADER_BYTES: u64 = 4096;

/// Why the file of a format, by FFmpeg's name of it, is not whole; none where nothing says so.
pub(crate) fn why_cut(path: &Path, bytes: u64, format: &str) -> Option<String> {
    match format {
        "apng" | "gif" => cut_animation(path),
        "mpegts" => ends_within_packet(&last_bytes(path, LAST_BYTES).unwrap_or_default())
            .then(|| "it ends within a packet".to_owned()),
        _ => is_cut_matroska(path, bytes).then(|| "it ends too early".to_owned()),
    }
}

/// Whether bytes at the end of a transport stream end within a packet; false where no packets are
/// seen in them.
fn ends_within_packet(last: &[u8]) -> bool {
    let begins = |at: usize| last.get(at) == Some(&SYNC);
    // Of packets that begin a step apart up to the end, the last.
    let last_of = |step: usize| {
        let first = (0..step).find(|at| (*at..last.len()).step_by(step).all(begins));
        first.map(|at| at + (last.len() - 1 - at) / step * step)
    };
    let steps = PACKET_STEPS
        .iter()
        .filter(|step| last.len() > **step * LEAST_PACKETS);
    let found = steps.filter_map(|step| last_of(*step)).next();
    found.is_some_and(|at| last.len() - at < PACKET)
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

    #[test]
    fn a_stream_ends_within_a_packet_or_between_two() {
        for (step, before) in [(188, 0), (192, 4), (204, 0)] {
            let packet = |number: u8| {
                let mut bytes = vec![number; step];
                bytes[before] = SYNC;
                bytes
            };
            let whole: Vec<u8> = (0..20).flat_map(packet).collect();
            assert!(!ends_within_packet(&whole), "{step}");
            for cut in [20, 60, 150, 187] {
                assert!(
                    ends_within_packet(&whole[..whole.len() - cut]),
                    "{step} {cut}"
                );
            }
        }
        assert!(!ends_within_packet(&[9; 4000]) && !ends_within_packet(&[SYNC; 3]));
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
