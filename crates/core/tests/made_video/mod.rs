//! Video whose units are made up: for what takes many of them, and no picture.

use foveal_core::content::video::Video;
use foveal_core::content::video::bytes::description::Description;
use foveal_core::content::video::bytes::signatures::{SIGNATURES, SIGNATURES_VERSION};
use foveal_core::content::video::bytes::small_pack::{
    open_file, refining_units, small_description, small_pack,
};
use foveal_core::pack::{PackError, SideTable};
use foveal_core::perception::measures::contrast::Signature;
use foveal_core::view::random::Random;
use foveal_core::view::surface::{Projection, Screen};
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
        let groups = vec![4; usize::from(self.levels)];
        Description {
            projection: self.projection,
            ..small_description(self.size, self.tile, &groups, self.frames)
        }
    }

    /// The video, with signatures of its units.
    ///
    /// # Errors
    /// What such a pack cannot be.
    pub(crate) fn build(&self) -> Result<Arc<Video>, PackError> {
        let about = self.description();
        let mut random = Random::new(u64::from(self.frames));
        let rows = refining_units(&about) * Signature::BYTES;
        let rows: Vec<u8> = (0..rows).map(|_| (random.unit() * 256.0) as u8).collect();
        let table = SideTable {
            name: SIGNATURES.to_owned(),
            version: SIGNATURES_VERSION,
            bytes: rows.clone(),
        };
        let file = small_pack(about, &[table], |_, frames| {
            let bytes = 20 + (random.unit() * 200.0) as usize;
            vec![vec![7; bytes]; frames.len()]
        })?;
        let video = Video::new("made", Arc::new(open_file(&file)?.1), Screen::default());
        video.add_table(SIGNATURES, rows)?;
        Ok(Arc::new(video))
    }
}
