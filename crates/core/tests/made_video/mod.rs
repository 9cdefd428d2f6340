//! Video whose units are made up: for what takes many of them, and no picture.

use foveal_core::content::video::Video;
use foveal_core::content::video::bytes::build::{begin_pack, finish_pack, push_tile};
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::bytes::description::{Description, Source};
use foveal_core::content::video::bytes::pack::VideoPack;
use foveal_core::content::video::bytes::rate::QualityScale;
use foveal_core::content::video::bytes::signatures::{SIGNATURES, SIGNATURES_VERSION};
use foveal_core::content::video::grid::tile_grid::Cut;
use foveal_core::pack::{HEADER_BYTES, Header, PackError, SideTable};
use foveal_core::perception::measures::contrast::Signature;
use foveal_core::view::picture::{Colour, Matrix};
use foveal_core::view::random::Random;
use foveal_core::view::surface::{Mapping, Projection, Screen};
use std::sync::Arc;

/// How a made video is cut.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Made {
    projection: Projection,
    size: [u32; 2],
    tile: u32,
    levels: u8,
    /// In groups of four.
    frames: u32,
}

impl Made {
    /// Ten frames with faces of this size in tiles of this side, up to one that covers them.
    pub(crate) fn new(projection: Projection, size: [u32; 2], tile: u32) -> Self {
        let across = size[0].max(size[1]).div_ceil(tile);
        Self {
            projection,
            size,
            tile,
            levels: (across.next_power_of_two().trailing_zeros() + 1) as u8,
            frames: 10,
        }
    }

    fn description(&self) -> Description {
        Description {
            generator: String::new(),
            projection: self.projection,
            size: self.size,
            eyes: 1,
            cube_faces: 6,
            mapping: Mapping::Gnomonic,
            pixel_aspect: [1, 1],
            front_deg: 0.0,
            cut: Cut::Tile(self.tile),
            levels: self.levels,
            ratio: 2,
            codec: Codec::Png,
            quality: vec![0; usize::from(self.levels)],
            quality_scale: QualityScale::default(),
            quality_by_tile: false,
            bit_rates: Vec::new(),
            groups: vec![4; usize::from(self.levels)],
            frames: self.frames,
            frame_rate: [25, 1],
            colour: Colour {
                matrix: Matrix::Bt601,
                full_range: true,
                chroma_left: false,
            },
            source: Source {
                name: String::new(),
                size: self.size,
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

    /// The video, with signatures of its units.
    ///
    /// # Errors
    /// What such a pack cannot be.
    pub(crate) fn build(&self) -> Result<Arc<Video>, PackError> {
        let description = self.description();
        let grid = description.grid(Screen::default());
        let mut random = Random::new(u64::from(self.frames));
        let mut builder = begin_pack(&description);
        for level in 0..self.levels {
            for first in (0..self.frames).step_by(4) {
                let frames = (self.frames - first).min(4);
                for tile in grid.tiles_of(level) {
                    let bytes = 20 + (random.unit() * 200.0) as usize;
                    let units: Vec<Vec<u8>> = (0..frames).map(|_| vec![7; bytes]).collect();
                    push_tile(&mut builder, tile, first, &units);
                }
            }
        }
        let coarsest = grid.tiles_in_level(grid.coarsest());
        let groups = self.frames.div_ceil(4);
        let tiles: u32 = (0..self.levels)
            .map(|level| grid.tiles_in_level(level))
            .sum();
        let rows = ((tiles - coarsest) * groups) as usize * Signature::BYTES;
        let rows: Vec<u8> = (0..rows).map(|_| (random.unit() * 256.0) as u8).collect();
        let table = SideTable {
            name: SIGNATURES.to_owned(),
            version: SIGNATURES_VERSION,
            bytes: rows.clone(),
        };
        let parts = finish_pack(builder, description, &[table])?;
        let header = Header::parse(&parts.head)?;
        let index = &parts.tail[..parts.tail.len() - rows.len()];
        let pack = VideoPack::parse(&header, &parts.head[HEADER_BYTES..], index)?;
        let video = Video::new("made", Arc::new(pack), Screen::default());
        video.add_table(SIGNATURES, rows)?;
        Ok(Arc::new(video))
    }
}
