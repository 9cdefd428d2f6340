//! What does the chunk of a tile consist of?

use crate::content::video::grid::tile_grid::Tile;
use crate::pack::{ChunkName, PackError, u32_at};
use crate::units::counted;

/// What the chunk of `tile` from `first_frame` on is called before its unit has a number.
#[must_use]
pub fn chunk_name(tile: Tile, first_frame: u32) -> ChunkName {
    let mut name = [0; 10];
    name[..2].copy_from_slice(&[tile.level, tile.face]);
    name[2..4].copy_from_slice(&tile.x.to_le_bytes());
    name[4..6].copy_from_slice(&tile.y.to_le_bytes());
    name[6..].copy_from_slice(&first_frame.to_le_bytes());
    ChunkName(name)
}

/// The tile and the first frame of a chunk that is called so; the other way of [`chunk_name`].
#[must_use]
pub fn named_chunk(ChunkName(name): ChunkName) -> (Tile, u32) {
    let [level, face, x0, x1, y0, y1, first @ ..] = name;
    let tile = Tile {
        level,
        face,
        x: u16::from_le_bytes([x0, x1]),
        y: u16::from_le_bytes([y0, y1]),
    };
    (tile, u32::from_le_bytes(first))
}

/// A chunk of these access units: a table of their lengths, then their bytes.
#[must_use]
pub fn join_chunk(access_units: &[Vec<u8>]) -> Vec<u8> {
    let lengths = access_units.iter().map(|unit| unit.len() as u32);
    let mut chunk: Vec<u8> = lengths.flat_map(u32::to_le_bytes).collect();
    access_units
        .iter()
        .for_each(|unit| chunk.extend_from_slice(unit));
    chunk
}

/// The access units of a chunk that holds `frames` frames: a table of lengths, then the bytes.
pub fn split_chunk(chunk: &[u8], frames: usize) -> Result<Vec<&[u8]>, PackError> {
    let wrong = |found: String| PackError::new("chunk", found, counted(frames, "access unit"));
    let table = frames * 4;
    if chunk.len() < table {
        return Err(wrong(counted(chunk.len(), "byte")));
    }
    let mut rest = &chunk[table..];
    let mut units = Vec::with_capacity(frames);
    for frame in 0..frames {
        let bytes = u32_at(chunk, frame * 4) as usize;
        if bytes > rest.len() {
            return Err(wrong(format!(
                "{} for number {frame}, {} left",
                counted(bytes, "byte"),
                rest.len()
            )));
        }
        let (unit, after) = rest.split_at(bytes);
        units.push(unit);
        rest = after;
    }
    if rest.is_empty() {
        Ok(units)
    } else {
        Err(wrong(counted(rest.len(), "further byte")))
    }
}
