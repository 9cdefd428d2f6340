//! Are all rows of a QOI picture there, of which FFmpeg leaves the others black without a word?
//!
//! Source: D. Szablewski, "The Quite OK Image Format", 2021.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use crate::error::MediaError;
use crate::plain_file::open_plain;
use crate::read::still::exr::head::which;

const MAGIC: [u8; 4] = *b"qoif";
/// Bytes of its header.
const HEAD: usize = 14;
/// First bytes of a chunk with all samples of a pixel, three and four; most of the rest is by the
/// two highest bits.
const RGB: u8 = 0xfe;
const RGBA: u8 = 0xff;
const LUMA: u8 = 0b10;
const RUN: u8 = 0b11;
const DAMAGED: &str = "its data go on behind its last pixel: they are damaged";
/// What stands behind the last pixel.
const END: [u8; 8] = [0, 0, 0, 0, 0, 0, 0, 1];

/// Refuses a QOI picture that is not whole.
pub(crate) fn check(path: &Path) -> Result<(), MediaError> {
    let Ok((file, _)) = open_plain(path) else {
        return Ok(());
    };
    let why = why_not_whole(&mut BufReader::new(file));
    why.map_or(Ok(()), |reason| {
        Err(MediaError::NoFrames {
            path: path.to_owned(),
            reason,
        })
    })
}

/// Why a QOI picture is not whole; none where it is, and for other files.
pub fn why_not_whole(file: &mut impl BufRead) -> Option<String> {
    let mut head = [0; HEAD];
    file.read_exact(&mut head).ok()?;
    if !head.starts_with(&MAGIC) {
        return None;
    }
    let side = |at: usize| u32::from_be_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
    let [columns, rows] = [side(4), side(8)].map(u64::from);
    let (mut left, mut bytes) = (columns * rows, file.bytes());
    while left > 0 {
        let Some(Ok(first)) = bytes.next() else {
            let first = rows - left.div_ceil(columns.max(1));
            let lost = first as u32..rows as u32;
            return Some(which(lost.clone(), lost.end - lost.start, lost.end));
        };
        let (more, pixels) = match (first, first >> 6) {
            (RGB, _) => (3, 1),
            (RGBA, _) => (4, 1),
            (_, LUMA) => (1, 1),
            (_, RUN) => (0, u64::from(first & 0x3f) + 1),
            _ => (0, 1),
        };
        // Of a pixel whose bytes are not all there nothing is shown.
        if bytes.by_ref().take(more).filter(Result::is_ok).count() < more {
            continue;
        }
        if pixels > left {
            return Some(DAMAGED.to_owned());
        }
        left -= pixels;
    }
    let end: Vec<u8> = bytes.take(END.len()).map_while(Result::ok).collect();
    // Some writers leave it out.
    let is_end = END.starts_with(&end);
    (!is_end).then(|| DAMAGED.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Of 4 x 3 pixels, in all kinds of chunks.
    fn qoi() -> Vec<u8> {
        let head = [&MAGIC[..], &[0, 0, 0, 4, 0, 0, 0, 3, 4, 0]].concat();
        let pixels = [
            RGB,
            1,
            2,
            3,
            RGBA,
            4,
            5,
            6,
            7,
            0x80,
            9,
            0x40,
            0x01,
            0xc0 | 6,
        ];
        [head, pixels.to_vec(), END.to_vec()].concat()
    }

    #[test]
    fn rows_that_are_not_there_are_named() {
        let whole = qoi();
        let why = |bytes: &[u8]| why_not_whole(&mut &bytes[..]);
        assert_eq!((why(&whole), why(&whole[..whole.len() - 8])), (None, None));
        assert!(
            why(&whole[..whole.len() - 9])
                .unwrap()
                .contains("rows 1 to 2 of its 3 rows")
        );
        assert!(why(&whole[..HEAD + 9]).unwrap().contains("rows 0 to 2"));
        let mut damaged = whole;
        damaged[HEAD] = 0;
        assert!(why(&damaged).is_some_and(|it| it.contains("behind its last pixel")));
        assert_eq!(why(b"qoi"), None);
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(at in any::<prop::sample::Index>(), byte in any::<u8>()) {
            let mut bytes = qoi();
            let at = at.index(bytes.len());
            bytes[at] = byte;
            why_not_whole(&mut &bytes[..]);
            why_not_whole(&mut &bytes[..at]);
        }
    }
}
