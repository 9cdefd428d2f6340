//! Which frame of which clip is this tile?
//!
//! Every tile carries its frame number as 4 by 4 blocks, dark or light: twelve bits of the number
//! and four that check them. A block is a quarter of the tile, so it survives compression and
//! reduction as long as a block keeps two pixels.

use foveal_core::view::picture::{Picture, plane_size};

/// Luma of a dark block, of a light one, of the middle between their light, and the least
/// difference from it that counts.
const DARK: u8 = 48;
const LIGHT: u8 = 208;
const MIDDLE: u32 = 150;
const CLEAR: u32 = 30;

/// Blocks on a side of a tile.
const BLOCKS: u32 = 4;

/// Bits of the number; it starts again after 4096 frames.
const BITS: u32 = 12;

/// Frame `frame` of a clip of `size` pixels in which every `tile` by `tile` pixels show the number
/// modulo 4096; tiles that the border cuts show what is left of them.
///
/// Each tile has a tint of its own, and fine texture that [`read_number`] does not mind.
///
/// ```
/// use foveal_media::generate::{numbered_tiles, read_number};
/// let clip = numbered_tiles([256, 128], 64, 1234);
/// assert_eq!(read_number(&clip.crop([64, 0], [64, 64])), Some(1234));
/// ```
///
/// # Panics
/// When `tile` is not a multiple of 8.
#[must_use]
pub fn numbered_tiles(size: [u32; 2], tile: u32, frame: u64) -> Picture {
    assert!(
        tile > 0 && tile.is_multiple_of(8),
        "a tile of {tile} pixels"
    );
    let code = code_of((frame % (1 << BITS)) as u32);
    let mut picture = Picture::filled(size[0], size[1], [0; 3]);
    for p in 0..3 {
        let [w, _] = plane_size(size[0], size[1], p);
        let tile = if p == 0 { tile } else { tile / 2 };
        for (y, row) in (0u32..).zip(picture.planes[p].chunks_exact_mut(w.max(1) as usize)) {
            for (x, sample) in (0u32..).zip(row) {
                *sample = match p {
                    0 => {
                        let [column, row] = [x, y].map(|k| k % tile * BLOCKS / tile);
                        let light = code >> (row * BLOCKS + column) & 1 == 1;
                        let texture = (x ^ y) as u8 & 15;
                        if light {
                            LIGHT + texture
                        } else {
                            DARK - texture
                        }
                    }
                    // Tints change from tile to tile, in steps that the eye can distinguish.
                    _ => 96 + ((x / tile * 37 + y / tile * 59) * p as u32 % 64) as u8,
                };
            }
        }
    }
    picture
}

/// The frame number in a whole tile of a [`numbered_tiles`] clip, at any level that keeps two
/// pixels a block.
///
/// `None` when a block is neither clearly dark nor clearly light, or the check bits disagree: the
/// tile is not from such a clip, is too small, or mixes two frames.
#[must_use]
pub fn read_number(tile: &Picture) -> Option<u32> {
    let [w, h] = [tile.width, tile.height];
    if w < 2 * BLOCKS || h < 2 * BLOCKS || !tile.is_consistent() {
        return None;
    }
    let mut code = 0;
    for block in 0..BLOCKS * BLOCKS {
        let [column, row] = [block % BLOCKS, block / BLOCKS];
        let mean = mean_of_core(tile, [column, row]);
        if mean.abs_diff(MIDDLE) < CLEAR {
            return None;
        }
        code |= u32::from(mean > MIDDLE) << block;
    }
    let number = code & ((1 << BITS) - 1);
    (code_of(number) == code).then_some(number)
}

/// Mean luma of the inner half of a block, where its neighbours do not reach.
fn mean_of_core(tile: &Picture, block: [u32; 2]) -> u32 {
    let size = [tile.width, tile.height];
    let core = |k: usize| {
        let (from, to) = (
            block[k] * size[k] / BLOCKS,
            (block[k] + 1) * size[k] / BLOCKS,
        );
        let margin = (to - from) / 4;
        from + margin..to - margin
    };
    let (mut sum, mut count) = (0, 0);
    for y in core(1) {
        for x in core(0) {
            sum += u32::from(tile.planes[0][(y * tile.width + x) as usize]);
            count += 1;
        }
    }
    sum / count
}

/// Number and check bits. The check is the sum of the number's three digits of four bits and 5, so
/// neither all dark nor all light is a number.
fn code_of(number: u32) -> u32 {
    let digits = (number & 15) + (number >> 4 & 15) * 3 + (number >> 8 & 15) * 5;
    number | ((digits + 5) & 15) << BITS
}
