//! Which numbers in the head of a file are wrong, so that FFmpeg would draw or time it wrong, and
//! which are right?

use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use crate::plain_file::{first_bytes, open_plain};
use crate::read::film::corrected::bytes::Corrections;
use crate::read::film::corrected::mp4_edits::edits;
use crate::read::film::corrected::mp4_says::times_of_zero;
use crate::read::film::ends::animation_end::{GifSays, gif_says};

/// Most sides of a GIF.
const MOST_SIDE: u32 = u16::MAX as u32;
/// Where a GIF says how large its screen is, and what its background, and where its palette lies;
/// where a WebP says how long it is.
const SCREEN: u64 = 6;
const BACKGROUND: u64 = 11;
const PALETTE: u64 = 13;
const RIFF_LENGTH: u64 = 4;
/// Most parts of a WebP.
const MOST_PARTS: u32 = 4096;

/// Those of the file at `path`; none where it cannot be read.
pub(crate) fn corrections_of(path: &Path) -> Corrections {
    let Ok((mut file, _)) = open_plain(path) else {
        return Corrections::default();
    };
    // A GIF is read through; of others a few words here and there are.
    let is_gif = first_bytes(path, 4).is_ok_and(|it| it == b"GIF8");
    match is_gif {
        true => corrections(&mut BufReader::new(file)),
        false => corrections(&mut file),
    }
}

/// Those of any file, of which the heads of parts are read.
pub fn corrections(file: &mut (impl Read + Seek)) -> Corrections {
    let mut head = [0; 12];
    let is_read = file.seek(SeekFrom::Start(0)).is_ok() && file.read_exact(&mut head).is_ok();
    let found = match (is_read, &head[..4], &head[4..8], &head[8..]) {
        (true, b"GIF8", ..) => screen(file),
        (true, b"RIFF", told, b"WEBP") => {
            let told = told.first_chunk().map_or(0, |it| u32::from_le_bytes(*it));
            riff_length(file, told)
        }
        (true, _, b"ftyp" | b"moov" | b"mdat" | b"wide" | b"free" | b"skip", _) => {
            let mut found = times_of_zero(file);
            let edits = edits(file);
            found.bytes.extend(edits.bytes);
            found.told.extend(edits.told);
            Some(found)
        }
        _ => None,
    };
    found.unwrap_or_default()
}

/// The screen of a GIF that does not hold all of its pictures, as large as they are.
fn screen(file: &mut (impl Read + Seek)) -> Option<Corrections> {
    let says = gif_says(file)?;
    let (told, reached) = (says.screen, says.reached);
    let right = [0, 1].map(|k| told[k].max(reached[k]).min(MOST_SIDE));
    let mut corrections = Corrections::default();
    if right != told && !right.contains(&0) {
        let bytes = right.map(|side| (side as u16).to_le_bytes()).concat();
        corrections.bytes.push((SCREEN, bytes));
        corrections.told.push(format!(
            "its screen of {}x{} pixels does not hold its pictures: {}x{} are shown",
            told[0], told[1], right[0], right[1]
        ));
    }
    let clear = clear_background(file, &says);
    corrections
        .bytes
        .extend(clear.map(|it| (BACKGROUND, vec![it])));
    Some(corrections)
}

/// A background that is clear, as browsers show it, of a GIF whose pictures leave places free;
/// else one that is black. FFmpeg paints them with a colour of the palette.
fn clear_background(file: &mut (impl Read + Seek), says: &GifSays) -> Option<u8> {
    if says.is_covered || says.colours == 0 {
        return None;
    }
    // A colour that the palette does not have is clear.
    if says.colours < 256 {
        return (says.background < says.colours).then_some(u8::MAX);
    }
    let mut palette = [0; 3 * 256];
    file.seek(SeekFrom::Start(PALETTE)).ok()?;
    file.read_exact(&mut palette).ok()?;
    let mut colours = palette.chunks_exact(3);
    let black = colours.position(|it| it == [0; 3])?;
    u8::try_from(black).ok()
}

/// The length of a WebP that says that it is longer, and whose parts end with the file.
fn riff_length(file: &mut (impl Read + Seek), told: u32) -> Option<Corrections> {
    let end = file.seek(SeekFrom::End(0)).ok()?;
    let mut at = 12_u64;
    for _ in 0..MOST_PARTS {
        if at >= end {
            break;
        }
        let mut head = [0; 8];
        file.seek(SeekFrom::Start(at)).ok()?;
        file.read_exact(&mut head).ok()?;
        let length = u64::from(u32::from_le_bytes(*head[4..].first_chunk()?));
        at += 8 + length + length % 2;
    }
    // The last byte may only pad it to an even length.
    let is_whole = at == end || at == end + 1;
    let right = u32::try_from(at.checked_sub(8)?).ok()?;
    let is_wrong = u64::from(told) > end.checked_sub(8)? + 1;
    (is_whole && is_wrong).then(|| Corrections {
        bytes: vec![(RIFF_LENGTH, right.to_le_bytes().to_vec())],
        told: vec![format!(
            "it says that it is {told} bytes long, and all of it is there in {right}"
        )],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Cursor;

    fn gif(screen: [u8; 2], pictures: &[[u8; 4]]) -> Vec<u8> {
        let mut bytes = b"GIF89a".to_vec();
        bytes.extend([screen[0], 0, screen[1], 0, 0, 0, 0]);
        for [x, y, w, h] in pictures {
            bytes.extend([b',', *x, 0, *y, 0, *w, 0, *h, 0, 0, 2, 1, 7, 0]);
        }
        bytes.push(b';');
        bytes
    }

    fn webp(told: u32) -> Vec<u8> {
        let body = b"WEBPVP8L\x03\0\0\0abc\0";
        [&b"RIFF"[..], &told.to_le_bytes(), body].concat()
    }

    fn found(bytes: &[u8]) -> Vec<(u64, Vec<u8>)> {
        corrections(&mut Cursor::new(bytes)).bytes
    }

    #[test]
    fn a_screen_holds_all_pictures_and_a_length_is_that_of_the_file() {
        let pictures = [[0, 0, 9, 8], [5, 0, 7, 3]];
        assert_eq!(found(&gif([12, 8], &pictures)), []);
        assert_eq!(found(&gif([0, 0], &pictures)), [(6, vec![12, 0, 8, 0])]);
        assert_eq!(found(&gif([4, 20], &pictures)), [(6, vec![12, 0, 20, 0])]);
        assert_eq!(found(&gif([0, 0], &[])), []);
        // With a palette of two colours, of which one is painted where no picture lies.
        let mut free = gif([12, 8], &pictures[..1]);
        free[10] = 0x80;
        free.splice(13..13, [9; 6]);
        assert_eq!(found(&free), [(11, vec![255])]);
        free.splice(6..8, [9, 0]);
        assert_eq!(found(&free), []);
        assert_eq!(found(&webp(16)), []);
        assert_eq!(found(&webp(400)), [(4, vec![16, 0, 0, 0])]);
        // One that is cut stays so.
        assert_eq!(found(&webp(400)[..22]), []);
    }

    #[test]
    fn bytes_are_corrected_wherever_reading_begins() {
        let corrections = Corrections {
            bytes: vec![(3, vec![7, 8])],
            told: Vec::new(),
        };
        for from in 0..6 {
            let mut bytes = [0; 8][from..].to_vec();
            corrections.correct(from as u64, &mut bytes);
            assert_eq!(bytes, [0, 0, 0, 7, 8, 0, 0, 0][from..]);
        }
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(
            at in any::<prop::sample::Index>(), byte in any::<u8>(), is_gif in any::<bool>(),
        ) {
            let mut bytes = if is_gif { gif([2, 2], &[[0, 1, 2, 3]]) } else { webp(99) };
            let at = at.index(bytes.len());
            bytes[at] = byte;
            found(&bytes);
            found(&bytes[..at]);
        }
    }
}
