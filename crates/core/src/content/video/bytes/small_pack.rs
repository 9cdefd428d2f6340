//! What is a small pack of video that a test reads, damages or plays?

use super::build::{begin_pack, finish_pack, push_tile};
use super::codec::Codec;
use super::description::{Description, Source};
use super::pack::VideoPack;
use super::rate::QualityScale;
use crate::content::video::grid::tile_grid::{Cut, Tile};
use crate::pack::{HEADER_BYTES, Header, PackError, SideTable};
use crate::view::picture::{Colour, Matrix};
use crate::view::surface::{Mapping, Projection, Screen};
use std::ops::Range;

/// Describes flat video of `size` pixels at 25 frames a second, in PNG tiles of side `tile`. Each
/// level halves the sides of the one before and has an entry in `groups`, the finest first: frames
/// in a group.
#[must_use]
pub fn small_description(size: [u32; 2], tile: u32, groups: &[u32], frames: u32) -> Description {
    Description {
        generator: String::new(),
        projection: Projection::Flat,
        size,
        eyes: 1,
        cube_faces: 6,
        mapping: Mapping::Gnomonic,
        pixel_aspect: [1, 1],
        front_deg: 0.0,
        cut: Cut::Tile(tile),
        levels: groups.len() as u8,
        ratio: 2,
        codec: Codec::Png,
        quality: vec![0; groups.len()],
        quality_scale: QualityScale::default(),
        quality_by_tile: false,
        bit_rates: Vec::new(),
        groups: groups.to_vec(),
        frames,
        frame_rate: [25, 1],
        colour: Colour {
            matrix: Matrix::Bt601,
            full_range: true,
            chroma_left: false,
        },
        source: Source {
            name: String::new(),
            size,
            bytes: 1,
            codec: String::new(),
        },
        identity: None,
        loss: None,
        last_frame_s: None,
        remarks: Vec::new(),
        repairs: Default::default(),
        tables: Vec::new(),
    }
}

/// Units finer than the coarsest level: the rows of a table of signatures.
#[must_use]
pub fn refining_units(about: &Description) -> usize {
    let grid = about.grid(Screen::default());
    let finer = (0..grid.coarsest()).zip(&about.groups);
    let units =
        finer.map(|(level, group)| grid.tiles_in_level(level) * about.frames.div_ceil(*group));
    units.sum::<u32>() as usize
}

/// The file of a pack, coarsest level first. `units` makes the access units of a tile's group,
/// which has these frames.
///
/// # Errors
/// What such a pack cannot be.
pub fn small_pack(
    about: Description,
    tables: &[SideTable],
    mut units: impl FnMut(Tile, Range<u32>) -> Vec<Vec<u8>>,
) -> Result<Vec<u8>, PackError> {
    let grid = about.grid(Screen::default());
    let mut builder = begin_pack(&about);
    let mut chunks = Vec::new();
    for (level, group) in (0..about.levels).zip(&about.groups).rev() {
        for first in (0..about.frames).step_by(*group as usize) {
            let frames = first..(first + group).min(about.frames);
            for tile in grid.tiles_of(level) {
                let units = units(tile, frames.clone());
                chunks.extend(push_tile(&mut builder, tile, first, &units));
            }
        }
    }
    let parts = finish_pack(builder, about, tables)?;
    Ok([parts.head, chunks, parts.tail].concat())
}

/// Header and pack of a whole file, which is as long as its header says.
///
/// # Errors
/// The file is no pack of video.
pub fn open_file(file: &[u8]) -> Result<(Header, VideoPack), PackError> {
    let header = Header::parse(file)?;
    let description = &file[HEADER_BYTES..][..header.description_bytes as usize];
    let index = &file[header.index_offset as usize..][..header.index_bytes as usize];
    let pack = VideoPack::parse(&header, description, index)?;
    Ok((header, pack))
}
