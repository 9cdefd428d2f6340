//! Where does a second film begin behind the first, which FFmpeg passes over?
//!
//! `cat` joins files end to end. Readers of some containers then go on, others stop.

use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use foveal_core::units::counted;

use crate::plain_file::open_plain;

/// Bytes that are read of what begins there.
const HEAD: usize = 16;
/// What an FLV, an ASF and a PNG begin with.
const FLV: &[u8] = b"FLV\x01";
const ASF: &[u8] = b"\x30\x26\xb2\x75\x8e\x66\xcf\x11\xa6\xd9\0\xaa\0\x62\xce\x6c";
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";
/// Bytes of an FLV's header with the length that follows it, and of a tag with its own.
const FLV_HEAD: u64 = 13;
const FLV_TAG: u64 = 15;
/// Kinds of tags: sound, pictures, and what describes them.
const FLV_KINDS: [u8; 3] = [8, 9, 18];
/// Most parts of a file.
const MOST_PARTS: u32 = 1 << 24;

/// What is said of a film behind the end of the one at `path`, by FFmpeg's name of its format.
pub(crate) fn behind_end(path: &Path, bytes: u64, format: &str) -> Option<String> {
    if !["flv", "asf", "apng"].contains(&format) {
        return None;
    }
    let (file, _) = open_plain(path).ok()?;
    let from = second_film(&mut BufReader::new(file))?;
    let left = counted(bytes.saturating_sub(from), "byte");
    Some(format!(
        "another film is joined to it: {left} from byte {from} on are not shown; cut them off with \
         `dd if=FILE of=PART bs=1M iflag=skip_bytes skip={from}`"
    ))
}

/// Where a second film of the same format begins, of which the heads of parts are read.
pub fn second_film(file: &mut (impl Read + Seek)) -> Option<u64> {
    let head = head_at(file, 0)?;
    let begin = [FLV, ASF, PNG]
        .into_iter()
        .find(|it| head.starts_with(it))?;
    let mut at = match begin {
        FLV => FLV_HEAD,
        ASF => asf_part(file, 0)?,
        _ => PNG.len() as u64,
    };
    for _ in 0..MOST_PARTS {
        let head = head_at(file, at)?;
        if head.starts_with(begin) {
            return Some(at);
        }
        let length = match begin {
            FLV => flv_part(&head)?,
            ASF => asf_part(file, at)?,
            _ => png_part(&head)?,
        };
        at = at.checked_add(length)?;
    }
    None
}

/// Up to so many bytes at a place; zeros where there are fewer, none where there is none.
fn head_at(file: &mut (impl Read + Seek), at: u64) -> Option<[u8; HEAD]> {
    file.seek(SeekFrom::Start(at)).ok()?;
    let mut head = Vec::new();
    file.by_ref()
        .take(HEAD as u64)
        .read_to_end(&mut head)
        .ok()?;
    let mut all = [0; HEAD];
    all[..head.len()].copy_from_slice(&head);
    (!head.is_empty()).then_some(all)
}

fn flv_part(head: &[u8; HEAD]) -> Option<u64> {
    let length = u32::from_be_bytes([0, head[1], head[2], head[3]]);
    FLV_KINDS
        .contains(&(head[0] & 0x1f))
        .then_some(u64::from(length) + FLV_TAG)
}

fn png_part(head: &[u8; HEAD]) -> Option<u64> {
    let length = u32::from_be_bytes(*head.first_chunk()?);
    head[4..8]
        .iter()
        .all(u8::is_ascii_alphabetic)
        .then_some(u64::from(length) + 12)
}

fn asf_part(file: &mut (impl Read + Seek), at: u64) -> Option<u64> {
    file.seek(SeekFrom::Start(at + 16)).ok()?;
    let mut length = [0; 8];
    file.read_exact(&mut length).ok()?;
    Some(u64::from_le_bytes(length)).filter(|it| *it >= 24)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Cursor;

    fn films() -> [Vec<u8>; 3] {
        let tag = [
            &[9, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0][..],
            b"abc",
            &[0, 0, 0, 14],
        ]
        .concat();
        let flv = [&b"FLV\x01\x05\0\0\0\x09\0\0\0\0"[..], &tag, &tag].concat();
        let part = |name: &[u8]| [name, &28u64.to_le_bytes(), b"abcd"].concat();
        let asf = [part(ASF), part(&[7; 16])].concat();
        let png = [PNG, b"\0\0\0\x02IDATab\0\0\0\0", b"\0\0\0\0IEND\0\0\0\0"].concat();
        [flv, asf, png]
    }

    fn found(bytes: &[u8]) -> Option<u64> {
        second_film(&mut Cursor::new(bytes))
    }

    #[test]
    fn a_second_film_is_found_where_the_first_ends() {
        for film in films() {
            assert_eq!(found(&film), None);
            assert_eq!(found(&film[..film.len() - 2]), None);
            assert_eq!(found(&[&film[..], b"rest"].concat()), None);
            let joined = [&film[..], &film].concat();
            assert_eq!(found(&joined), Some(film.len() as u64));
        }
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(at in any::<prop::sample::Index>(), byte in any::<u8>()) {
            for film in films() {
                let mut bytes = [&film[..], &film].concat();
                let at = at.index(bytes.len());
                bytes[at] = byte;
                found(&bytes);
                found(&bytes[..at]);
            }
        }
    }
}
