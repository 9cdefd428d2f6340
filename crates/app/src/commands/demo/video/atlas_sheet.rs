//! What is in the atlas at one moment?
//!
//! The resident tiles as they are held, side by side, finest level first, each framed in the colour
//! that its level has in the heat map.

use crate::commands::demo::video::colours::of_level;
use anyhow::Context;
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_play::FramePlayer;
use foveal_render::RgbaImage;

/// Pixels of the frame round a tile.
const FRAME: u32 = 2;
/// Pixels between frames.
const GAP: u32 = 4;
/// Highest sheet, over its width.
const HIGHEST: f64 = 0.5;
/// Times that tiles may be shown smaller than they are, on a side.
const SHRUNK: [u32; 6] = [1, 2, 3, 4, 6, 8];
/// Colour between tiles.
const PAPER: [u8; 3] = [24, 26, 30];

/// The sheet.
pub(crate) struct Sheet {
    pub(crate) image: RgbaImage,
    /// Times that tiles are shown smaller than they are, on a side.
    pub(crate) shrunk: u32,
}

/// Where each tile goes, and how high that makes the sheet.
struct Layout {
    places: Vec<[u32; 2]>,
    size: [u32; 2],
}

/// The sheet of `tiles`, about `width` pixels wide.
pub(crate) fn of(player: &mut FramePlayer, tiles: &[Tile], width: u32) -> anyhow::Result<Sheet> {
    let grid = *player.grid();
    let mut tiles = tiles.to_vec();
    tiles.sort_by_key(|tile| (tile.level, grid.rank(*tile)));
    let sizes = |by: u32| -> Vec<[u32; 2]> {
        let shrunk = |tile: &Tile| grid.tile_size(*tile).map(|side| side.div_ceil(by));
        tiles.iter().map(shrunk).collect()
    };
    let fits = |by: &u32| {
        let [_, h] = layout(&sizes(*by), width).size;
        f64::from(h) <= f64::from(width) * HIGHEST
    };
    let by = SHRUNK
        .into_iter()
        .find(fits)
        .unwrap_or(SHRUNK[SHRUNK.len() - 1]);
    let layout = layout(&sizes(by), width);
    let mut image = RgbaImage::black(layout.size);
    fill(&mut image, [0, 0], layout.size, PAPER);
    for (tile, at) in tiles.iter().zip(layout.places) {
        let picture = player.read_tile(*tile)?.context("nothing holds tiles")?;
        let small = shrink(&picture, by);
        let framed = small.size.map(|side| side + 2 * FRAME);
        fill(
            &mut image,
            at,
            framed,
            of_level(tile.level, grid.coarsest()),
        );
        paste(&mut image, at.map(|a| a + FRAME), &small);
    }
    Ok(Sheet { image, shrunk: by })
}

/// Rows from the left; as wide as the widest.
fn layout(sizes: &[[u32; 2]], width: u32) -> Layout {
    let (mut at, mut row_height, mut widest) = ([GAP, GAP], 0, 0);
    let mut places = Vec::with_capacity(sizes.len());
    for size in sizes {
        let [w, h] = size.map(|side| side + 2 * FRAME);
        if at[0] > GAP && at[0] + w + GAP > width {
            at = [GAP, at[1] + row_height + GAP];
            row_height = 0;
        }
        places.push(at);
        at[0] += w + GAP;
        row_height = row_height.max(h);
        widest = widest.max(at[0]);
    }
    Layout {
        places,
        size: [widest.max(1), at[1] + row_height + GAP],
    }
}

/// The picture `by` times smaller, each pixel the mean of what it covers.
fn shrink(image: &RgbaImage, by: u32) -> RgbaImage {
    if by == 1 {
        return image.clone();
    }
    let [w, h] = image.size;
    let mut small = RgbaImage::black(image.size.map(|side| side.div_ceil(by)));
    for y in 0..small.size[1] {
        for x in 0..small.size[0] {
            let (mut sums, mut count) = ([0u32; 3], 0);
            for row in y * by..(y * by + by).min(h) {
                for column in x * by..(x * by + by).min(w) {
                    let pixel = image.pixel([column, row]);
                    (0..3).for_each(|k| sums[k] += u32::from(pixel[k]));
                    count += 1;
                }
            }
            let [r, g, b] = sums.map(|sum| (sum / count) as u8);
            small.set_pixel([x, y], [r, g, b, 255]);
        }
    }
    small
}

fn fill(image: &mut RgbaImage, at: [u32; 2], size: [u32; 2], [r, g, b]: [u8; 3]) {
    for y in at[1]..at[1] + size[1] {
        for x in at[0]..at[0] + size[0] {
            image.set_pixel([x, y], [r, g, b, 255]);
        }
    }
}

fn paste(image: &mut RgbaImage, at: [u32; 2], tile: &RgbaImage) {
    for y in 0..tile.size[1] {
        for x in 0..tile.size[0] {
            image.set_pixel([at[0] + x, at[1] + y], tile.pixel([x, y]));
        }
    }
}
