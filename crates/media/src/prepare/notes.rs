//! What is noted of every unit while it is coded, so that it can be valued without decoding?

pub(super) mod decoded_groups;

use foveal_core::content::video::bytes::cue_table::{CUES, CUES_VERSION};
use foveal_core::content::video::bytes::signatures::{SIGNATURES, SIGNATURES_VERSION};
use foveal_core::content::video::grid::tile_grid::TileGrid;
use foveal_core::pack::SideTable;
use foveal_core::perception::measures::contrast::Signature;
use foveal_core::perception::measures::cues::Cues;
use foveal_core::perception::measures::saliency::cues_of;
use foveal_core::view::picture::{Colour, Picture};

/// Rows of the side tables `signatures` and `cues` that are known so far.
pub(super) struct Notes {
    colour: Colour,
    /// Of each level, in the order of its units: groups, in a group by rank.
    signatures: Vec<Vec<u8>>,
    cues: Vec<u8>,
    /// Bytes of each of those that [`Self::new_rows`] has returned, the cues' last.
    told: Vec<usize>,
}

impl Notes {
    pub(super) fn new(grid: &TileGrid, colour: Colour) -> Self {
        Self {
            colour,
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

    /// Takes up what [`Self::new_rows`] gave in an earlier run; false where it is not of this grid.
    pub(super) fn take_up(&mut self, rows: &[Vec<u8>]) -> bool {
        let all = self.signatures.iter_mut().chain([&mut self.cues]);
        for (known, new) in all.zip(rows) {
            known.extend_from_slice(new);
        }
        let fits = rows.len() == self.told.len();
        let _ = self.new_rows();
        fits
    }

    /// The cues of one tile over one group of frames; none where a unit has none.
    pub(super) fn cues(&self, level: u8, group: &[Picture]) -> Option<Cues> {
        let (first, last) = (group.first()?, group.last()?);
        (level == 0).then(|| cues_of(first, last, self.colour))
    }

    /// Takes the cues of the next unit.
    pub(super) fn push_cues(&mut self, cues: Option<Cues>) {
        self.cues.extend(cues.iter().flat_map(Cues::to_bytes));
    }

    /// Takes the signatures of the next units of `level`.
    pub(super) fn push_signatures(&mut self, level: u8, signatures: &[Signature]) {
        let rows = signatures.iter().flat_map(Signature::to_bytes);
        self.signatures[usize::from(level)].extend(rows);
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
