//! How is a TGA picture read?
//!
//! Source: Truevision, "TGA File Format Specification", version 2.0, 1991. Nothing in its first
//! bytes says what it is: they count as its head where all of that makes sense.

const HEAD_BYTES: usize = 18;
/// Kinds of pictures; 8 more where runs are packed.
const MAPPED: u8 = 1;
const COLOURED: u8 = 2;
const GREY: u8 = 3;
const PACKED: u8 = 8;
/// Bits of the last byte of the head: from the right, from the top, and what is in no file.
const FROM_RIGHT: u8 = 0x10;
const FROM_TOP: u8 = 0x20;
const UNUSED: u8 = 0xc0;

/// What the head says.
struct Head {
    kind: u8,
    is_packed: bool,
    size: [usize; 2],
    /// Bytes of a texel.
    texel_bytes: usize,
    /// The first number of the palette, and bytes of each of its colours.
    palette: (usize, usize),
    palette_at: usize,
    texels_at: usize,
    directions: u8,
}

fn head(bytes: &[u8]) -> Option<Head> {
    let head = bytes.get(..HEAD_BYTES)?;
    let half = |at: usize| usize::from(u16::from_le_bytes([head[at], head[at + 1]]));
    let [has_palette, kind, depth, directions] = [head[1], head[2], head[16], head[17]];
    let fits = match kind & !PACKED {
        MAPPED => has_palette == 1 && matches!(depth, 8 | 16) && half(5) > 0,
        COLOURED => matches!(depth, 15 | 16 | 24 | 32),
        GREY => matches!(depth, 8 | 16),
        _ => false,
    };
    let colour_bits = head[7];
    let palette_fits = has_palette == 0 || matches!(colour_bits, 15 | 16 | 24 | 32);
    let size = [half(12), half(14)];
    let is_sane = has_palette <= 1 && directions & UNUSED == 0 && !size.contains(&0);
    let colour_bytes = usize::from(colour_bits).div_ceil(8);
    let palette_at = HEAD_BYTES + usize::from(head[0]);
    let palette_bytes = match has_palette {
        1 => half(5) * colour_bytes,
        _ => 0,
    };
    let texels_at = palette_at + palette_bytes;
    let is_one = fits && palette_fits && is_sane && texels_at < bytes.len();
    is_one.then_some(Head {
        kind: kind & !PACKED,
        is_packed: kind & PACKED != 0,
        size,
        texel_bytes: usize::from(depth).div_ceil(8),
        palette: (half(3), colour_bytes),
        palette_at,
        texels_at,
        directions,
    })
}

/// Columns and rows; none of what is no TGA.
pub(super) fn size(bytes: &[u8]) -> Option<[u32; 2]> {
    head(bytes).map(|head| head.size.map(|side| side as u32))
}

/// All texels from the top left, four samples each; none where the file ends too early. Its size
/// must be one that memory is there for.
pub(super) fn decode(bytes: &[u8]) -> Option<Vec<u8>> {
    let head = head(bytes)?;
    let [columns, rows] = head.size;
    let raw = raw_texels(&head, bytes.get(head.texels_at..)?, columns * rows)?;
    let palette = &bytes[head.palette_at..head.texels_at];
    let mut texels = Vec::with_capacity(4 * columns * rows);
    for row in 0..rows {
        let row = match head.directions & FROM_TOP {
            0 => rows - 1 - row,
            _ => row,
        };
        for column in 0..columns {
            let column = match head.directions & FROM_RIGHT {
                0 => column,
                _ => columns - 1 - column,
            };
            let at = (row * columns + column) * head.texel_bytes;
            texels.extend(head.texel(&raw[at..at + head.texel_bytes], palette)?);
        }
    }
    // An alpha that is 0 everywhere does not count.
    if texels.as_chunks::<4>().0.iter().all(|it| it[3] == 0) {
        texels
            .as_chunks_mut()
            .0
            .iter_mut()
            .for_each(|[_, _, _, alpha]| *alpha = 255);
    }
    Some(texels)
}

/// Whether all texels have an alpha of their own that is 0.
pub(super) fn is_clear(bytes: &[u8]) -> bool {
    let Some(head) = head(bytes).filter(|it| it.kind == COLOURED && it.texel_bytes == 4) else {
        return false;
    };
    let rest = bytes.get(head.texels_at..).unwrap_or_default();
    let raw = raw_texels(&head, rest, head.size[0] * head.size[1]);
    raw.is_some_and(|raw| raw.as_chunks::<4>().0.iter().all(|it| it[3] == 0))
}

impl Head {
    fn texel(&self, raw: &[u8], palette: &[u8]) -> Option<[u8; 4]> {
        match self.kind {
            GREY => Some([raw[0], raw[0], raw[0], raw.get(1).copied().unwrap_or(255)]),
            MAPPED => {
                let number = raw
                    .iter()
                    .rev()
                    .fold(0, |sum, byte| sum << 8 | usize::from(*byte));
                let (first, length) = self.palette;
                let at = number.checked_sub(first)? * length;
                Some(colour(palette.get(at..at + length)?))
            }
            _ => Some(colour(raw)),
        }
    }
}

/// Blue comes first; of two bytes each part has five bits, and the last bit is unused.
fn colour(raw: &[u8]) -> [u8; 4] {
    match *raw {
        [blue, green, red, alpha] => [red, green, blue, alpha],
        [blue, green, red] => [red, green, blue, 255],
        [low, high] => {
            let all = u16::from_le_bytes([low, high]);
            let part = |shift: u16| ((all >> shift & 31) * 255 / 31) as u8;
            [part(10), part(5), part(0), 255]
        }
        _ => [0; 4],
    }
}

/// The bytes of all texels in the order of the file.
fn raw_texels(head: &Head, bytes: &[u8], texels: usize) -> Option<Vec<u8>> {
    let all = texels * head.texel_bytes;
    if !head.is_packed {
        return Some(bytes.get(..all)?.to_vec());
    }
    let mut raw = Vec::with_capacity(all);
    let mut rest = bytes;
    while raw.len() < all {
        let (packet, behind) = rest.split_first()?;
        let count = usize::from(packet & 0x7f) + 1;
        let length = match packet & 0x80 {
            0 => count * head.texel_bytes,
            _ => head.texel_bytes,
        };
        let (texels, behind) = behind.split_at_checked(length)?;
        let times = if packet & 0x80 == 0 { 1 } else { count };
        (0..times).for_each(|_| raw.extend(texels));
        rest = behind;
    }
    // A run may go beyond the last texel.
    raw.truncate(all);
    Some(raw)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tga(kind: u8, depth: u8, directions: u8, rest: &[u8]) -> Vec<u8> {
        let mut file = vec![0; HEAD_BYTES];
        (file[2], file[16], file[17]) = (kind, depth, directions);
        (file[12], file[14]) = (2, 2);
        if kind & 7 == MAPPED {
            (file[1], file[5], file[7]) = (1, 2, 24);
        }
        file.extend(rest);
        file
    }

    const RED: [u8; 4] = [255, 0, 0, 255];
    const BLUE: [u8; 4] = [0, 0, 255, 255];

    #[test]
    fn all_kinds_give_the_same_texels() {
        let [red, blue] = [[0, 0, 255], [255, 0, 0]];
        // Red, red; blue, red: from the bottom.
        let plain = [blue, red, red, red].concat();
        let from_top = [red, red, blue, red].concat();
        let packed = [&[0, 255, 0, 0][..], &[0x82, 0, 0, 255]].concat();
        let beyond = [&[0, 255, 0, 0][..], &[0x8f, 0, 0, 255]].concat();
        let mapped = [&red[..], &blue, &[1, 0, 0, 0]].concat();
        let short = [0x1f, 0, 0, 0x7c, 0, 0x7c, 0, 0x7c];
        let clear = [255, 0, 0, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255, 0];
        let from_right = [red, blue, red, red].concat();
        for (what, file) in [
            ("plain", tga(2, 24, 0, &plain)),
            ("from the top", tga(2, 24, FROM_TOP, &from_top)),
            ("from the right", tga(2, 24, FROM_RIGHT, &from_right)),
            ("packed", tga(10, 24, 0, &packed)),
            ("a run beyond", tga(10, 24, 0, &beyond)),
            ("with a palette", tga(1, 8, 0, &mapped)),
            ("of 15 bits", tga(2, 16, 0, &short)),
            ("without any alpha", tga(2, 32, 8, &clear)),
        ] {
            assert_eq!(size(&file), Some([2, 2]), "{what}");
            let texels = decode(&file).unwrap();
            assert_eq!(texels, [RED, RED, BLUE, RED].concat(), "{what}");
            for end in 0..file.len() - 1 {
                assert_eq!(decode(&file[..end]), None, "{what} cut at {end}");
            }
        }
        let grey = tga(3, 8, FROM_TOP, &[1, 2, 3, 4]);
        assert_eq!(decode(&grey).unwrap()[4..8], [2, 2, 2, 255]);
    }

    #[test]
    fn what_names_a_colour_that_is_not_there_is_none() {
        let file = tga(1, 8, 0, &[0, 0, 255, 255, 0, 0, 1, 2, 0, 0]);
        assert_eq!(decode(&file), None);
        assert_eq!(size(b"text that is longer than a head of one"), None);
    }
}
