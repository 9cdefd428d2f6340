//! What is noted of every unit while it is coded, so that it can be valued without decoding?

use foveal_core::content::video::bytes::cue_table::{CUES, CUES_VERSION};
use foveal_core::content::video::bytes::signatures::{SIGNATURES, SIGNATURES_VERSION};
use foveal_core::content::video::grid::tile_grid::TileGrid;
use foveal_core::pack::SideTable;
use foveal_core::perception::measures::saliency::cues_of;
use foveal_core::perception::measures::signature::signature_of;
use foveal_core::view::picture::{Colour, Picture};

/// Rows of the side tables `signatures` and `cues` that are known so far.
pub(super) struct Notes {
    colour: Colour,
    coarsest: u8,
    ratio: u32,
    /// Of each level, in the order of its units: groups, in a group by rank.
    signatures: Vec<Vec<u8>>,
    cues: Vec<u8>,
    /// Bytes of each of those that [`Self::new_rows`] has told, the cues' last.
    told: Vec<usize>,
}

/// What was measured of one unit, as it lies in the tables; empty where a table has no such row.
#[derive(Default)]
pub(super) struct Measured {
    signature: Vec<u8>,
    cues: Vec<u8>,
}

impl Notes {
    pub(super) fn new(grid: &TileGrid, colour: Colour) -> Self {
        Self {
            colour,
            coarsest: grid.coarsest(),
            ratio: grid.ratio,
            signatures: vec![Vec::new(); usize::from(grid.levels)],
            cues: Vec::new(),
            told: vec![0; usize::from(grid.levels) + 1],
        }
    }

    /// What came since the last call: the signatures of each level, then the cues.
    pub(super) fn new_rows(&mut self) -> Vec<Vec<u8>> {
        let all = self.signatures.iter().chain([&self.cues]);
        let rows = all.zip(&mut self.told).map(|(rows, told)| {
            let new = rows[*told..].to_vec();
            *told = rows.len();
            new
        });
        rows.collect()
    }

    /// Takes up what [`Self::new_rows`] told in an earlier run; false where it is not of this grid.
    pub(super) fn take_up(&mut self, rows: &[Vec<u8>]) -> bool {
        let all = self.signatures.iter_mut().chain([&mut self.cues]);
        for (known, new) in all.zip(rows) {
            known.extend_from_slice(new);
        }
        let fits = rows.len() == self.told.len();
        let _ = self.new_rows();
        fits
    }

    /// Measures one tile over one group of frames.
    pub(super) fn measure(&self, level: u8, group: &[Picture]) -> Measured {
        let (Some(first), Some(last)) = (group.first(), group.last()) else {
            return Measured::default();
        };
        let mut measured = Measured::default();
        if level < self.coarsest {
            let signature = signature_of(first, self.colour, self.ratio);
            measured.signature = signature.to_bytes().to_vec();
        }
        if level == 0 {
            measured.cues = cues_of(first, last, self.colour).to_bytes().to_vec();
        }
        measured
    }

    /// Takes the rows of the next unit of `level`.
    pub(super) fn push(&mut self, level: u8, measured: Measured) {
        self.signatures[usize::from(level)].extend(measured.signature);
        self.cues.extend(measured.cues);
    }

    /// The side tables: rows in the order of the units that have one.
    pub(super) fn into_tables(self) -> [SideTable; 2] {
        let signatures = SideTable {
            name: SIGNATURES.to_owned(),
            version: SIGNATURES_VERSION,
            bytes: self.signatures.into_iter().rev().flatten().collect(),
        };
        let cues = SideTable {
            name: CUES.to_owned(),
            version: CUES_VERSION,
            bytes: self.cues,
        };
        [signatures, cues]
    }
}
