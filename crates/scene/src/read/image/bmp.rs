//! How is a BMP picture read?
//!
//! Source: Microsoft, "Bitmap Storage" and the structures that it names; IBM, "OS/2 Presentation
//! Manager" for the oldest head.

/// Bytes before the header that gives its own length.
const FILE_HEAD: usize = 14;
/// The oldest head.
const OLDEST: usize = 12;
/// Heads from this one on hold the masks of colours, and from that one on of alpha.
const WITH_MASKS: usize = 52;
const WITH_ALPHA: usize = 56;
/// How texels are packed.
const PLAIN: u32 = 0;
const RUNS_OF_8: u32 = 1;
const RUNS_OF_4: u32 = 2;
const MASKED: u32 = 3;
const MASKED_WITH_ALPHA: u32 = 6;

/// What the head says.
struct Head {
    size: [usize; 2],
    from_top: bool,
    bits: usize,
    packing: u32,
    /// Which bits are red, green, blue and alpha, of texels of 16 and 32 bits.
    masks: [u32; 4],
    palette: Vec<[u8; 3]>,
    texels_at: usize,
}

fn half(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

fn head(bytes: &[u8]) -> Option<Head> {
    if bytes.get(..2)? != b"BM" {
        return None;
    }
    let length = word(bytes, 14)? as usize;
    let is_oldest = length == OLDEST;
    if !is_oldest && !(16..=1 << 16).contains(&length) {
        return None;
    }
    let (columns, rows) = match is_oldest {
        true => (i32::from(half(bytes, 18)?), i32::from(half(bytes, 20)?)),
        false => (word(bytes, 18)? as i32, word(bytes, 22)? as i32),
    };
    let bits = usize::from(half(bytes, if is_oldest { 24 } else { 28 })?);
    let told = |at: usize| match FILE_HEAD + length >= at + 4 {
        true => word(bytes, at),
        false => Some(0),
    };
    let packing = told(30)?;
    let is_whole = matches!(
        (packing, bits),
        (PLAIN, 1 | 2 | 4 | 8 | 16 | 24 | 32)
            | (RUNS_OF_8, 8)
            | (RUNS_OF_4, 4)
            | (MASKED | MASKED_WITH_ALPHA, 16 | 32)
    );
    if !is_whole || columns <= 0 || rows == 0 {
        return None;
    }
    let texels_at = word(bytes, 10)? as usize;
    let has_masks = packing == MASKED || packing == MASKED_WITH_ALPHA;
    let has_alpha = packing == MASKED_WITH_ALPHA || length >= WITH_ALPHA;
    let masks = match (has_masks, bits) {
        (true, _) => {
            let alpha = if has_alpha { word(bytes, 66)? } else { 0 };
            [word(bytes, 54)?, word(bytes, 58)?, word(bytes, 62)?, alpha]
        }
        (false, 16) => [0x7c00, 0x03e0, 0x001f, 0],
        (false, _) => [0x00ff_0000, 0xff00, 0xff, 0xff00_0000],
    };
    let behind = match (has_masks && length < WITH_MASKS, has_alpha) {
        (false, _) => 0,
        (true, false) => 12,
        (true, true) => 16,
    };
    let palette_at = FILE_HEAD + length + behind;
    let entry = if is_oldest { 3 } else { 4 };
    let colours = match (bits, told(46)? as usize) {
        (9.., _) => 0,
        (_, 0) => 1 << bits,
        (_, told) => told.min(1 << bits),
    };
    let room = texels_at.saturating_sub(palette_at) / entry;
    let colours = colours.min(room) * entry;
    let palette = bytes.get(palette_at.min(bytes.len())..)?.get(..colours)?;
    Some(Head {
        size: [columns as usize, rows.unsigned_abs() as usize],
        from_top: rows < 0,
        bits,
        packing,
        masks,
        palette: palette
            .chunks_exact(entry)
            .map(|it| [it[2], it[1], it[0]])
            .collect(),
        texels_at,
    })
}

/// Columns and rows; none of what is no BMP.
pub(super) fn size(bytes: &[u8]) -> Option<[u32; 2]> {
    head(bytes).map(|head| head.size.map(|side| side as u32))
}

/// All texels from the top left, four samples each; none where the file ends too early. Its size
/// must be one that memory is there for.
pub(super) fn decode(bytes: &[u8]) -> Option<Vec<u8>> {
    let head = head(bytes)?;
    let rest = bytes.get(head.texels_at..)?;
    let [columns, rows] = head.size;
    let mut texels = vec![0; 4 * columns * rows];
    let (runs, row_bytes) = match head.packing {
        RUNS_OF_8 | RUNS_OF_4 => (Some(head.runs(rest)?), columns),
        _ => (None, (columns * head.bits).div_ceil(32) * 4),
    };
    let raw = runs.as_deref().unwrap_or(rest);
    // What fills up the last row may be missing.
    let used = match runs {
        Some(_) => columns,
        None => (columns * head.bits).div_ceil(8),
    };
    for (row, told) in texels.chunks_exact_mut(4 * columns).enumerate() {
        let at = if head.from_top { row } else { rows - 1 - row };
        let raw = raw.get(at * row_bytes..)?.get(..used)?;
        for (column, texel) in told.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            *texel = match runs {
                Some(_) => head.coloured(raw[column]),
                None => head.texel(raw, column),
            };
        }
    }
    // An alpha that is 0 everywhere does not count.
    let all = texels.as_chunks_mut::<4>().0;
    if all.iter().all(|it| it[3] == 0) {
        all.iter_mut().for_each(|it| it[3] = 255);
    }
    Some(texels)
}

impl Head {
    /// A number of the palette; what it lacks is black.
    fn coloured(&self, number: u8) -> [u8; 4] {
        let [red, green, blue] = self
            .palette
            .get(usize::from(number))
            .copied()
            .unwrap_or_default();
        [red, green, blue, 255]
    }

    fn texel(&self, row: &[u8], column: usize) -> [u8; 4] {
        match self.bits {
            24 => {
                let at = 3 * column;
                [row[at + 2], row[at + 1], row[at], 255]
            }
            16 | 32 => {
                let bytes = self.bits / 8;
                let raw = &row[bytes * column..][..bytes];
                let all = raw
                    .iter()
                    .rev()
                    .fold(0, |sum, byte| sum << 8 | u32::from(*byte));
                let [red, green, blue, alpha] = self.masks.map(|mask| part(all, mask));
                let alpha = if self.masks[3] == 0 { 255 } else { alpha };
                [red, green, blue, alpha]
            }
            bits => {
                let at = bits * column;
                let shift = 8 - bits - at % 8;
                let mask = ((1_u16 << bits) - 1) as u8;
                self.coloured(row[at / 8] >> shift & mask)
            }
        }
    }

    /// The numbers of all texels in rows as the file has them, out of runs.
    fn runs(&self, bytes: &[u8]) -> Option<Vec<u8>> {
        let [columns, rows] = self.size;
        let mut numbers = vec![0; columns * rows];
        let is_of_4 = self.packing == RUNS_OF_4;
        let (mut x, mut y, mut rest) = (0, 0, bytes);
        let mut put = |x: &mut usize, y: usize, number: u8| {
            if *x < columns && y < rows {
                numbers[y * columns + *x] = number;
            }
            *x += 1;
        };
        let nibble = |byte: u8, odd: bool| if odd { byte & 15 } else { byte >> 4 };
        loop {
            // Some end at the last texel without saying so.
            let is_full = y >= rows || (y + 1 == rows && x >= columns);
            let Some(([count, value], behind)) = rest.split_first_chunk::<2>() else {
                return is_full.then_some(numbers);
            };
            rest = behind;
            match (*count, *value) {
                (0, 0) => (x, y) = (0, y + 1),
                (0, 1) => return Some(numbers),
                (0, 2) => {
                    let ([right, up], behind) = rest.split_first_chunk::<2>()?;
                    (x, y, rest) = (x + usize::from(*right), y + usize::from(*up), behind);
                }
                (0, count) => {
                    let count = usize::from(count);
                    let length = if is_of_4 { count.div_ceil(2) } else { count };
                    let (raw, behind) = rest.split_at_checked(length)?;
                    for at in 0..count {
                        let number = match is_of_4 {
                            true => nibble(raw[at / 2], at % 2 == 1),
                            false => raw[at],
                        };
                        put(&mut x, y, number);
                    }
                    rest = behind.get(length % 2..)?;
                }
                (count, value) => {
                    for at in 0..count {
                        let number = match is_of_4 {
                            true => nibble(value, at % 2 == 1),
                            false => value,
                        };
                        put(&mut x, y, number);
                    }
                }
            }
        }
    }
}

/// The part of a texel that a mask shows, from 0 to 255.
fn part(texel: u32, mask: u32) -> u8 {
    let Some(most) = mask.checked_shr(mask.trailing_zeros()).filter(|it| *it > 0) else {
        return 0;
    };
    let value = (texel & mask) >> mask.trailing_zeros();
    (u64::from(value) * 255 / u64::from(most)) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bmp(length: u32, bits: u16, packing: u32, parts: [&[u8]; 2]) -> Vec<u8> {
        let [head, texels] = parts;
        let mut file = b"BM".to_vec();
        let at = 14 + length + head.len() as u32;
        file.extend(
            [at + texels.len() as u32, 0, at, length]
                .map(u32::to_le_bytes)
                .concat(),
        );
        match length {
            12 => file.extend([3, 2, 1, bits].map(u16::to_le_bytes).concat()),
            _ => {
                file.extend([3_u32, 2].map(u32::to_le_bytes).concat());
                file.extend([1, bits].map(u16::to_le_bytes).concat());
                file.extend([packing, 0, 0, 0, 0, 0].map(u32::to_le_bytes).concat());
            }
        }
        file.extend(head);
        file.extend(texels);
        file
    }

    const RED: [u8; 4] = [255, 0, 0, 255];
    const BLUE: [u8; 4] = [0, 0, 255, 255];

    #[test]
    fn all_kinds_give_the_same_texels() {
        // Blue, red, red; above them red, red, blue.
        let palette: &[u8] = &[0, 0, 255, 0, 255, 0, 0, 0];
        let old: &[u8] = &[0, 0, 255, 255, 0, 0];
        let masks: &[u8] = &[0xf800_u32, 0x07e0, 0x1f].map(u32::to_le_bytes).concat();
        let words = |r: u16, b: u16| [b, r, r, 0, r, r, b, 0].map(u16::to_le_bytes).concat();
        for (what, file) in [
            (
                "1 bit",
                bmp(40, 1, 0, [palette, &[0x80, 0, 0, 0, 0x20, 0, 0, 0]]),
            ),
            (
                "2 bits",
                bmp(40, 2, 0, [palette, &[0x40, 0, 0, 0, 0x04, 0, 0, 0]]),
            ),
            (
                "4 bits",
                bmp(40, 4, 0, [palette, &[0x10, 0, 0, 0, 0, 0x10, 0, 0]]),
            ),
            (
                "8 bits",
                bmp(40, 8, 0, [palette, &[1, 0, 0, 0, 0, 0, 1, 0]]),
            ),
            (
                "8 bits, oldest",
                bmp(12, 8, 0, [old, &[1, 0, 0, 0, 0, 0, 1, 0]]),
            ),
            ("15 bits", bmp(40, 16, 0, [&[], &words(0x7c00, 0x1f)])),
            ("16 bits", bmp(40, 16, 3, [masks, &words(0xf800, 0x1f)])),
            (
                "runs of 8 bits",
                bmp(
                    40,
                    8,
                    1,
                    [palette, &[1, 1, 2, 0, 0, 0, 0, 3, 0, 0, 1, 0, 0, 1]],
                ),
            ),
            (
                "runs of 4 bits",
                bmp(
                    40,
                    4,
                    2,
                    [palette, &[1, 0x10, 2, 0, 0, 2, 0, 1, 0, 0, 0, 1]],
                ),
            ),
        ] {
            let expected = match what {
                // It leaps over the second row, which is of the first colour.
                "runs of 4 bits" => [RED, RED, RED, BLUE, RED, RED],
                _ => [RED, RED, BLUE, BLUE, RED, RED],
            };
            assert_eq!(size(&file), Some([3, 2]), "{what}");
            assert_eq!(
                decode(&file).as_deref(),
                Some(expected.as_flattened()),
                "{what}"
            );
            assert_eq!(decode(&file[..file.len() - 5]), None, "{what}, cut");
        }
    }
}
