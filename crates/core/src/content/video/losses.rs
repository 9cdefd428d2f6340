//! How visible is what each cell loses at each level, and what does a whole picture lose?
//!
//! From signatures alone: contrast that the finer steps would add, seen by the eye at that place,
//! pooled as the judge pools ([`visible_loss`](crate::perception::visible_loss)).

use crate::content::video::calibration::{ZONES, ZoneBounds, ZoneLosses};
use crate::content::video::glimpse::Glimpse;
use crate::content::video::grid::level_map::LevelMap;
use crate::content::video::grid::places::{Cells, SharedPlaces};
use crate::content::video::grid::tile_grid::TileGrid;
use crate::content::video::units::VideoUnits;
use crate::perception::eye::share_of_octave;
use crate::perception::glance::Glance;
use crate::perception::measures::contrast::{SIGNATURE_BANDS, Signature};
use crate::perception::parameters::{EyeState, Model, Parameters};
use crate::perception::sensitivity_table::SensitivityTable;
use crate::perception::visible_loss::{LostOctave, SPACE_EXPONENT, Sensed, SensedTable};
use crate::units::{Cpd, Ppd, Radians};
use std::sync::Arc;

/// Octaves that are looked at, from the finest downwards: to below the judge's lowest band for any
/// content of up to 700 pixels per degree.
pub(super) const MOST_OCTAVES: usize = 10;
/// Share of the contrast that a step adds in its finest octave that lower ones change by, beyond
/// those that signatures measure: what texture leaves behind when it is coded and interpolated.
/// Fitted by `foveal evaluate targets`.
const LEAK: f64 = 0.03;
/// The judge has no band below about this octave: log2 of 0.18 cycles per degree.
const LOWEST_OCTAVE: f64 = -2.5;
/// The judge counts the finest octave of the display half, and as an octave finer than it is
/// (Mantiuk et al. 2021: gains and centre frequencies of the pyramid's bands); these two keep half
/// an octave more of it, as the fit asks for.
const FINEST_SHARE: f64 = 0.7;
const FINEST_OCTAVES_UP: f64 = 0.7;

/// What every cell loses at every level.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Losses {
    pub(super) cells: usize,
    /// Sums over the places of a cell of pixels x loss^beta, by level, then by rank of the left
    /// eye's cell, in each zone; nothing is lost at level 0.
    pub(super) sums: Vec<[f64; ZONES]>,
    /// The same over the bound of each place, where zones have their own; else empty.
    pub(super) bounded: Vec<f64>,
    /// Pixels of the display that show a cell, by rank; of cells outside the view, that would.
    pub(super) pixels: Vec<f64>,
    /// Whether a cell is in view, by rank. One outside counts nothing in the whole, but is seen
    /// fading into the picture if it is too coarse.
    pub(super) in_view: Vec<bool>,
    /// All pixels that show a cell in view, in each zone.
    pub(super) shown: [f64; ZONES],
}

impl Losses {
    /// What a pixel may add to the sums of a cell that may lose no more than `bound`.
    #[must_use]
    pub(super) fn of_pixel(bound: f64) -> f64 {
        libm::pow(bound, SPACE_EXPONENT)
    }

    /// Whether a cell may be shown at `level` where no pixel of it may lose more than `most`, as
    /// [`Self::of_pixel`] says of a bound; where zones have their own bounds, of so many times its
    /// zone's.
    pub(super) fn is_within(&self, rank: usize, level: u8, most: f64) -> bool {
        let at = usize::from(level) * self.cells + rank;
        let sum = match self.bounded.is_empty() {
            true => self.sums[at].iter().sum(),
            false => self.bounded[at],
        };
        sum <= self.pixels[rank] * most
    }

    /// What a picture loses against the finest when its cells are shown at these levels.
    #[must_use]
    pub fn of(&self, shown: &LevelMap) -> ZoneLosses {
        let mut all = ZoneLosses {
            pixels: self.shown,
            ..ZoneLosses::default()
        };
        for (rank, level) in shown.levels().iter().enumerate() {
            let of_cell = self.sum(rank, *level);
            all.sums = core::array::from_fn(|zone| all.sums[zone] + of_cell[zone]);
        }
        all
    }

    /// The quality difference of a picture whose cells are shown at these levels, to the finest.
    #[must_use]
    pub fn pooled(&self, shown: &LevelMap) -> f64 {
        self.of(shown).whole()
    }

    /// What a cell adds to the sums at a level.
    #[must_use]
    pub(crate) fn sum(&self, rank: usize, level: u8) -> [f64; ZONES] {
        if self.in_view[rank] {
            self.sums[usize::from(level) * self.cells + rank]
        } else {
            [0.0; ZONES]
        }
    }
}

/// What losses are asked of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around<'a> {
    /// Who looks, through which view.
    pub(super) glance: &'a Glance,
    /// How far a head may turn while the eye stays.
    pub(super) room: Radians,
    /// What no cell may lose, where each zone has its own bound.
    pub(super) bounds: Option<ZoneBounds>,
}

impl<'a> Around<'a> {
    /// What is in view, without bounds.
    fn only(glance: &'a Glance) -> Self {
        Self {
            glance,
            room: Radians(0.0),
            bounds: None,
        }
    }
}

/// Finds losses on one grid. A copy shares what was made for it.
#[derive(Clone, Debug)]
pub struct LossMeter {
    pub(super) cells: Cells,
    table: Arc<SensedTable>,
    parameters: Parameters,
    /// What is sensed of the finest octave where the display shows all of it.
    finest: Sensed,
}

impl LossMeter {
    /// For an eye of these parameters; the published model of the eye has no losses, so the
    /// corrected one stands in. Costs some milliseconds and nine directions a cell, once.
    #[must_use]
    pub fn new(grid: &TileGrid, parameters: &Parameters) -> Self {
        Self::sharing(&SharedPlaces::default(), grid, parameters)
    }

    /// The same, with places of this grid that others use as well.
    pub(super) fn sharing(places: &SharedPlaces, grid: &TileGrid, parameters: &Parameters) -> Self {
        let parameters = match parameters.model {
            Model::Default => parameters.clone(),
            Model::Paper => Parameters {
                acuity: parameters.acuity.clone(),
                sensitivity: parameters.sensitivity.clone(),
                ..Parameters::default()
            },
        };
        let table = SensitivityTable::new(&parameters, EyeState::Steady);
        Self {
            cells: places.dense(grid),
            table: Arc::new(SensedTable::new(&table)),
            parameters,
            finest: Sensed::of(FINEST_SHARE),
        }
    }

    /// The losses of one glance. Costs a few µs a cell in view.
    #[must_use]
    pub fn losses(
        &self,
        grid: &TileGrid,
        content: &dyn VideoUnits,
        frame: u32,
        glance: &Glance,
    ) -> Losses {
        let around = Around::only(glance);
        let mut glimpse = Glimpse::default();
        let mut losses = glimpse.look(self, grid, (content, frame), &around);
        losses.find_all();
        glimpse.into_losses()
    }

    /// What the picture of one glance loses at these levels. Costs less than its losses.
    #[must_use]
    pub fn lost(
        &self,
        grid: &TileGrid,
        (content, frame): (&dyn VideoUnits, u32),
        glance: &Glance,
        shown: &LevelMap,
    ) -> ZoneLosses {
        let mut glimpse = Glimpse::default();
        let mut losses = glimpse.look(self, grid, (content, frame), &Around::only(glance));
        losses.of(shown)
    }

    /// Sensitivity to every octave, from the finest of level 0 downwards, at a place where content
    /// has `ppd` pixels per degree and the display shows frequencies up to `display`.
    pub(super) fn sensed(
        &self,
        eccentricity: Radians,
        ppd: Ppd,
        display: Cpd,
    ) -> [Sensed; MOST_OCTAVES] {
        let raised = self.parameters.octaves_raised(eccentricity);
        let most = self.parameters.display_limit();
        let limit = if most < display { most } else { display };
        let finest = libm::log2(ppd.0 / 4.0);
        let limit = libm::log2(limit.0);
        let row = self.table.row(eccentricity);
        core::array::from_fn(|octave| {
            let frequency = finest - octave as f64;
            let share = share_of_octave(limit - frequency);
            if share == 0.0 || frequency < LOWEST_OCTAVE {
                return Sensed::default();
            }
            // The octave below the limit is the finest.
            if limit - frequency < 1.5 {
                let sensed = row.at(frequency + raised + FINEST_OCTAVES_UP);
                return sensed.times(&match share < 1.0 {
                    true => Sensed::of(share * FINEST_SHARE),
                    false => self.finest,
                });
            }
            row.at(frequency + raised)
        })
    }
}

/// How much is drawn of what a step adds, 0 to 1, where a pixel of the display covers
/// 2^`footprint` level-0 pixels on a side: a view that shows content smaller than it is blends the two levels
/// about its footprint, and nothing finer.
pub(super) fn drawn_share(step: usize, footprint: f64, octaves_a_step: usize) -> f64 {
    (step as f64 + 1.0 - footprint / octaves_a_step as f64).clamp(0.0, 1.0)
}

/// How much is drawn of an octave, 0 the finest of level 0, where a pixel of the display covers
/// 2^`footprint` level-0 pixels on a side. Levels that such a view shows in place of each other
/// differ in lower octaves by the noise that each was coded with.
pub(super) fn octave_share(octave: usize, footprint: f64) -> f64 {
    (octave as f64 + 1.0 - footprint).clamp(0.0, 1.0)
}

/// What a level loses of each octave, from the signatures of the steps that it lacks, finest first,
/// and from how much is drawn of an octave of a step; a step is `octaves_a_step` octaves. Only of
/// the octaves that are asked for.
pub(super) fn lost_octaves(
    signatures: &[Signature],
    octaves_a_step: usize,
    drawn: impl Fn(usize, usize) -> f64,
    asked: [bool; MOST_OCTAVES],
) -> [LostOctave; MOST_OCTAVES] {
    let mut lost = [0.0; MOST_OCTAVES];
    let mut whole = [0.0; MOST_OCTAVES];
    let mut kept = [0.0; MOST_OCTAVES];
    for (step, signature) in signatures.iter().enumerate() {
        kept = [0.0; MOST_OCTAVES];
        let first = step * octaves_a_step;
        for (band, octave) in signature.bands.iter().zip(first..MOST_OCTAVES) {
            // Errors of single steps are of the same detail at different places.
            lost[octave] = libm::hypot(lost[octave], drawn(step, octave) * band.norm);
            if step == 0 || octave + octaves_a_step >= first + SIGNATURE_BANDS {
                whole[octave] = band.after;
            }
            kept[octave] = band.before.min(whole[octave]);
        }
        let leak = LEAK * drawn(step, first) * signature.bands[0].norm;
        let lower = lost.iter_mut().zip(asked).skip(first + SIGNATURE_BANDS);
        for (lost, _) in lower.filter(|(_, asked)| *asked) {
            *lost = libm::hypot(*lost, leak);
        }
    }
    core::array::from_fn(|octave| match lost[octave] {
        lost if lost != 0.0 && asked[octave] => LostOctave::new(lost, kept[octave]),
        _ => LostOctave::default(),
    })
}
