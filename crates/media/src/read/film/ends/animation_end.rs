//! Does a GIF or an animated PNG end before it should, of which FFmpeg says nothing?

use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use foveal_core::units::counted;

use crate::plain_file::open_plain;

/// What begins every PNG.
const PNG: [u8; 8] = *b"\x89PNG\r\n\x1a\n";
/// Bytes of a chunk's length, name and checksum.
const CHUNK: u64 = 12;

/// Why the animation at `path` is not whole; none where nothing is missing, or it is no GIF or PNG.
pub(crate) fn cut_animation(path: &Path) -> Option<String> {
    let (file, _) = open_plain(path).ok()?;
    why_cut(&mut BufReader::new(file))
}

/// The same of its bytes, of which the heads of parts are read.
pub fn why_cut(file: &mut (impl Read + Seek)) -> Option<String> {
    let mut head = [0; 8];
    file.read_exact(&mut head).ok()?;
    match &head {
        &PNG => png(file),
        [b'G', b'I', b'F', ..] => {
            let end = file.seek(SeekFrom::End(0)).ok()?;
            file.seek(SeekFrom::Start(10)).ok()?;
            match gif(file, end, &mut |_, _| {}) {
                // The parts of a whole picture are all there, or reading fails.
                None => Some("it ends within a picture".to_owned()),
                Some(false) => Some("something in it is no part of a picture".to_owned()),
                Some(true) => None,
            }
        }
        _ => None,
    }
}

/// What a GIF says of its screen and of where its pictures lie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct GifSays {
    /// Columns and rows of its screen, and those that its pictures reach.
    pub(crate) screen: [u32; 2],
    pub(crate) reached: [u32; 2],
    /// Whether each of its pictures lies on all that they reach.
    pub(crate) is_covered: bool,
    /// Colours of its palette, and which of them it gives to places without a picture.
    pub(crate) colours: usize,
    pub(crate) background: usize,
    /// Pictures that have no palette, as neither they nor the file have one.
    pub(crate) without_palette: u64,
}

/// The same of a GIF; none of another file.
pub(crate) fn gif_says(file: &mut (impl Read + Seek)) -> Option<GifSays> {
    let end = file.seek(SeekFrom::End(0)).ok()?;
    file.seek(SeekFrom::Start(0)).ok()?;
    let mut head = [0; 12];
    file.read_exact(&mut head).ok()?;
    if !head.starts_with(b"GIF8") {
        return None;
    }
    file.seek(SeekFrom::Start(10)).ok()?;
    let side = |k: usize| u32::from(u16::from_le_bytes([head[k], head[k + 1]]));
    let screen = [side(6), side(8)];
    let colours = table(head[10]) as usize / 3;
    let (mut reached, mut without_palette) = ([0; 2], 0);
    // The place of all pictures; none where they lie in several.
    let mut common: Option<Option<[u32; 4]>> = None;
    // Those before a damaged part count.
    let _ = gif(file, end, &mut |place, has_palette| {
        let [x, y, w, h] = place;
        reached = [reached[0].max(x + w), reached[1].max(y + h)];
        without_palette += u64::from(!has_palette && colours == 0);
        let is_same = common.is_none_or(|it| it == Some(place));
        common = Some(is_same.then_some(place));
    });
    let whole = [0, 1].map(|k| screen[k].max(reached[k]));
    Some(GifSays {
        screen,
        reached,
        is_covered: common == Some(Some([0, 0, whole[0], whole[1]])),
        colours,
        background: usize::from(head[11]),
        without_palette,
    })
}

/// Why the GIF at `path` shows nothing: none of its pictures has a palette; none for other files.
pub(crate) fn gif_without_palette(path: &Path) -> Option<String> {
    let (file, _) = open_plain(path).ok()?;
    let says = gif_says(&mut BufReader::new(file))?;
    (says.without_palette > 0).then(|| {
        format!(
            "it has {} without a palette: nothing says which colours its pixels have",
            counted(says.without_palette, "picture")
        )
    })
}

/// What an animated PNG lacks.
fn png(file: &mut (impl Read + Seek)) -> Option<String> {
    let end = file.seek(SeekFrom::End(0)).ok()?;
    let mut at = file.seek(SeekFrom::Start(PNG.len() as u64)).ok()?;
    let (mut told, mut begun, mut has_data, mut next) = (None, 0_u32, false, 0_u32);
    let mut gap = false;
    while at < end {
        let mut head = [0; 16];
        let length = (end - at).min(16) as usize;
        file.read_exact(&mut head[..length]).ok()?;
        let word = |k: usize| u32::from_be_bytes([head[k], head[k + 1], head[k + 2], head[k + 3]]);
        let after = at + CHUNK + u64::from(word(0));
        let is_cut = after > end;
        match &head[4..8] {
            b"IEND" => break,
            b"acTL" => told = Some(word(8)),
            b"fcTL" => {
                gap |= word(8) != next;
                next = word(8).wrapping_add(1);
                begun = begun.saturating_add(1);
                has_data = false;
            }
            b"fdAT" => {
                gap |= word(8) != next;
                next = word(8).wrapping_add(1);
                has_data = !is_cut;
            }
            b"IDAT" => has_data = !is_cut,
            _ => {}
        }
        if is_cut {
            break;
        }
        at = file.seek(SeekFrom::Start(after)).ok()?;
    }
    let told = told?;
    let whole = begun - u32::from(begun > 0 && !has_data);
    if whole < told {
        return Some(format!(
            "it announces {} and holds {whole}",
            counted(u64::from(told), "picture")
        ));
    }
    gap.then(|| "parts are missing between others".to_owned())
}

/// Goes through a GIF from the flags of its screen on, up to its end mark or the end of the file
/// between two pictures; none where it ends within one, false where something is no part of one.
/// Reports the left edge, upper edge, width and height of each picture, and whether it has a
/// palette of its own.
fn gif(
    file: &mut (impl Read + Seek),
    end: u64,
    tell: &mut dyn FnMut([u32; 4], bool),
) -> Option<bool> {
    let flags = byte(file)?;
    skip(file, 2 + table(flags), end)?;
    loop {
        match byte(file) {
            // Nothing is missing of what came.
            None | Some(b';') => return Some(true),
            Some(b'!') => {
                byte(file)?;
            }
            Some(b',') => {
                let mut place = [0; 8];
                file.read_exact(&mut place).ok()?;
                let side = |k: usize| u32::from(u16::from_le_bytes([place[k], place[k + 1]]));
                let flags = byte(file)?;
                tell([side(0), side(2), side(4), side(6)], table(flags) > 0);
                skip(file, table(flags) + 1, end)?;
            }
            Some(_) => return Some(false),
        }
        loop {
            match byte(file)? {
                0 => break,
                length => skip(file, u64::from(length), end)?,
            }
        }
    }
}

/// Bytes of the colours that follow these flags.
fn table(flags: u8) -> u64 {
    match flags & 0x80 {
        0 => 0,
        _ => 3 << ((flags & 7) + 1),
    }
}

fn byte(file: &mut impl Read) -> Option<u8> {
    let mut one = [0];
    file.read_exact(&mut one).ok()?;
    Some(one[0])
}

fn skip(file: &mut (impl Read + Seek), bytes: u64, end: u64) -> Option<()> {
    file.seek_relative(bytes as i64).ok()?;
    (file.stream_position().ok()? <= end).then_some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Cursor;

    fn chunk(name: &[u8; 4], inside: &[u8]) -> Vec<u8> {
        let length = (inside.len() as u32).to_be_bytes();
        [&length[..], name, inside, &[0; 4]].concat()
    }

    /// An animated PNG of three pictures that announces so many.
    fn apng(told: u32) -> Vec<u8> {
        let mut bytes = [&PNG[..], &chunk(b"IHDR", &[0; 13])].concat();
        bytes.extend(chunk(b"acTL", &[told.to_be_bytes(), [0; 4]].concat()));
        let mut next = 0_u32;
        for number in 0..3 {
            bytes.extend(chunk(
                b"fcTL",
                &[&next.to_be_bytes()[..], &[0; 22]].concat(),
            ));
            next += 1;
            match number {
                0 => bytes.extend(chunk(b"IDAT", &[1; 20])),
                _ => {
                    let data = [&next.to_be_bytes()[..], &[1; 20]].concat();
                    bytes.extend(chunk(b"fdAT", &data));
                    next += 1;
                }
            }
        }
        [bytes, chunk(b"IEND", &[])].concat()
    }

    fn gif_of_two() -> Vec<u8> {
        let mut bytes = b"GIF89a\x04\0\x04\0\x80\0\0".to_vec();
        bytes.extend([0; 6]);
        for _ in 0..2 {
            bytes.extend(b"!\xf9\x04\0\x0a\0\0\0,");
            bytes.extend([0, 0, 0, 0, 4, 0, 4, 0, 0, 2, 5, 1, 2, 3, 4, 5, 0]);
        }
        bytes.push(b';');
        bytes
    }

    fn told(bytes: &[u8]) -> Option<String> {
        why_cut(&mut Cursor::new(bytes))
    }

    #[test]
    fn an_animated_png_is_whole_with_all_the_pictures_that_it_tells_of() {
        let whole = apng(3);
        assert_eq!(told(&whole), None);
        assert!(told(&apng(5)).unwrap().contains("5 pictures and holds 3"));
        // Without its end mark nothing is missing.
        assert_eq!(told(&whole[..whole.len() - 12]), None);
        for cut in 13..60 {
            assert!(
                told(&whole[..whole.len() - cut])
                    .unwrap()
                    .contains("holds 2")
            );
        }
        // A still is none.
        let still = [&PNG[..], &chunk(b"IHDR", &[0; 13]), &[0, 0, 9, 9]].concat();
        assert_eq!(told(&still), None);
    }

    #[test]
    fn a_gif_is_whole_where_it_ends_between_pictures() {
        let whole = gif_of_two();
        assert_eq!(told(&whole), None);
        assert_eq!(told(&whole[..whole.len() - 1]), None);
        for cut in 2..16 {
            assert!(told(&whole[..whole.len() - cut]).is_some(), "{cut}");
        }
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(
            at in any::<prop::sample::Index>(), byte in any::<u8>(), is_gif in any::<bool>(),
        ) {
            let mut bytes = if is_gif { gif_of_two() } else { apng(3) };
            let at = at.index(bytes.len());
            bytes[at] = byte;
            let _ = told(&bytes);
            let _ = told(&bytes[..at]);
        }
    }
}
