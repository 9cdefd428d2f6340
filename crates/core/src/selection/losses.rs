//! How visible is what each cell loses at each level, and what does a whole picture lose?
//!
//! From signatures alone: contrast that the finer steps would add, seen by the eye at that place,
//! pooled as the judge pools ([`visible_loss`](crate::perception::visible_loss)).

use super::content::Content;
use super::level_map::LevelMap;
use super::places::{CellPlaces, Place, Sighted};
use super::policy::Moment;
use crate::asset::signature::{SIGNATURE_BANDS, Signature};
use crate::asset::tile_grid::TileGrid;
use crate::perception::eye::share_of_octave_below;
use crate::perception::parameters::{EyeState, Model, Parameters};
use crate::perception::sensitivity_table::SensitivityTable;
use crate::perception::spread::SpreadTable;
use crate::perception::visible_loss::{LostOctave, SPACE_EXPONENT, Sensed};
use crate::units::Cpd;

/// Most octaves that the steps of a pyramid change.
const MOST_OCTAVES: usize = 16;
/// Share of the contrast that a step adds in its finest octave that lower ones change by, beyond
/// those that signatures tell of: what texture leaves behind when it is coded and interpolated.
/// Fitted by `foveal evaluate targets`.
const LEAK: f64 = 0.03;
/// The judge has no band below about this frequency, in cycles per degree.
const LOWEST_CPD: f64 = 0.18;
/// The judge counts the finest octave of the display half, and as an octave finer than it is
/// (Mantiuk et al. 2021: gains and centre frequencies of the pyramid's bands); these two keep half
/// an octave more of it, as the fit asks for.
const FINEST_SHARE: f64 = 0.7;
const FINEST_OCTAVES_UP: f64 = 0.7;

/// What every cell loses at every level.
#[derive(Clone, Debug, PartialEq)]
pub struct Losses {
    cells: usize,
    /// Sums over the places of a cell of pixels x loss^beta, by level, then by rank of the left
    /// eye's cell; nothing is lost at level 0.
    sums: Vec<f64>,
    /// Pixels of the display that show a cell, by rank.
    pixels: Vec<f64>,
    /// All of them.
    shown: f64,
}

impl Losses {
    /// Whether a cell may be shown at `level` where no cell may lose more than `bound`.
    #[must_use]
    pub fn is_within(&self, rank: usize, level: u8, bound: f64) -> bool {
        let sum = self.sums[usize::from(level) * self.cells + rank];
        sum <= self.pixels[rank] * libm::pow(bound, SPACE_EXPONENT)
    }

    /// The quality difference of a picture whose cells are shown at these levels, to the finest.
    #[must_use]
    pub fn pooled(&self, shown: &LevelMap) -> f64 {
        let at = |(rank, level): (usize, &u8)| self.sums[usize::from(*level) * self.cells + rank];
        self.quality(shown.levels().iter().enumerate().map(at).sum())
    }

    /// The quality difference of a sum over all cells.
    #[must_use]
    pub(super) fn quality(&self, sum: f64) -> f64 {
        if self.shown <= 0.0 {
            return 0.0;
        }
        libm::pow(sum.max(0.0) / self.shown, 1.0 / SPACE_EXPONENT)
    }

    /// What a cell adds to the sum at a level.
    #[must_use]
    pub(super) fn sum(&self, rank: usize, level: u8) -> f64 {
        self.sums[usize::from(level) * self.cells + rank]
    }
}

/// Finds losses on one grid.
#[derive(Clone, Debug)]
pub struct LossMeter {
    cells: Vec<CellPlaces>,
    table: SensitivityTable,
    parameters: Parameters,
}

impl LossMeter {
    /// For an eye of these parameters; the published model of the eye has no losses, so the
    /// corrected one stands in. Costs some milliseconds and nine directions a cell, once.
    #[must_use]
    pub fn new(grid: &TileGrid, parameters: &Parameters) -> Self {
        let parameters = match parameters.model {
            Model::Default => *parameters,
            Model::Paper => Parameters::default(),
        };
        let cells = grid.tiles_of(0).map(|cell| CellPlaces::dense(grid, cell));
        Self {
            cells: cells.collect(),
            table: SensitivityTable::new(&parameters, EyeState::Steady),
            parameters,
        }
    }

    /// The losses of one moment. Costs about 10 µs a cell in view.
    #[must_use]
    pub fn losses(
        &self,
        grid: &TileGrid,
        content: &dyn Content,
        frame: u32,
        moment: &Moment,
    ) -> Losses {
        let cells = grid.tiles_of_left_eye(0).count();
        let mut losses = Losses {
            cells,
            sums: vec![0.0; cells * usize::from(grid.levels)],
            pixels: vec![0.0; cells],
            shown: 0.0,
        };
        let spread = SpreadTable::new(moment.gaze.spread);
        let sighted = Sighted::new(moment);
        for cell in &self.cells {
            let places: Vec<&Place> = sighted.places(cell).collect();
            if places.is_empty() {
                continue;
            }
            let rank = grid.rank(grid.for_left_eye(cell.cell)) as usize;
            let signatures = (0..grid.coarsest()).map(|level| {
                let unit = content.unit(grid.tile_over(cell.cell, level), frame);
                content.signature(unit).unwrap_or_default()
            });
            let signatures: Vec<Signature> = signatures.collect();
            let octaves = lost_octaves(&signatures, grid.ratio.trailing_zeros() as usize);
            for place in places {
                let pixels = sighted.pixels(place);
                losses.pixels[rank] += pixels;
                losses.shown += pixels;
                let sensed = self.sensed(&sighted, &spread, moment, place);
                for (level, octaves) in (1..).zip(&octaves) {
                    let seen = sensed.iter().zip(octaves).map(|(s, o)| s.difference(o));
                    let loss = libm::pow(seen.sum(), SPACE_EXPONENT);
                    losses.sums[level * cells + rank] += pixels * loss;
                }
            }
        }
        losses
    }

    /// Sensitivity at a place to every octave, from the finest of level 0 downwards.
    fn sensed(
        &self,
        sighted: &Sighted<'_>,
        spread: &SpreadTable,
        moment: &Moment,
        place: &Place,
    ) -> [Sensed; MOST_OCTAVES] {
        let eccentricity = spread.effective(moment.eccentricity(place.direction));
        let raised = self.parameters.octaves_raised(eccentricity);
        let display = sighted.display_limit(place);
        let most = self.parameters.display_limit();
        let limit = if most < display { most } else { display };
        let finest = sighted.seen(place).ppd.0 / 4.0;
        core::array::from_fn(|octave| {
            let frequency = libm::ldexp(finest, -(octave as i32));
            let share = share_of_octave_below(Cpd(frequency), limit);
            if share == 0.0 || frequency < LOWEST_CPD {
                return Sensed::default();
            }
            let octaves = libm::log2(frequency) + raised;
            // The octave below the limit is the finest.
            if libm::log2(limit.0 / frequency) < 1.5 {
                let up = octaves + FINEST_OCTAVES_UP;
                return Sensed::new(&self.table, up, share * FINEST_SHARE);
            }
            Sensed::new(&self.table, octaves, share)
        })
    }
}

/// What each level but the finest loses of each octave, from the signatures of its steps, finest
/// first; a step is `octaves_a_step` octaves.
fn lost_octaves(
    signatures: &[Signature],
    octaves_a_step: usize,
) -> Vec<[LostOctave; MOST_OCTAVES]> {
    let mut lost = [0.0; MOST_OCTAVES];
    let mut whole = [0.0; MOST_OCTAVES];
    let level = |(step, signature): (usize, &Signature)| {
        let mut kept = [0.0; MOST_OCTAVES];
        let first = step * octaves_a_step;
        for (band, octave) in signature.bands.iter().zip(first..MOST_OCTAVES) {
            // Errors of single steps are of the same detail at different places.
            lost[octave] = libm::hypot(lost[octave], band.norm);
            if step == 0 || octave + octaves_a_step >= first + SIGNATURE_BANDS {
                whole[octave] = band.after;
            }
            kept[octave] = band.before.min(whole[octave]);
        }
        let leak = LEAK * signature.bands[0].norm;
        for lost in lost.iter_mut().skip(first + SIGNATURE_BANDS) {
            *lost = libm::hypot(*lost, leak);
        }
        core::array::from_fn(|octave| LostOctave::new(lost[octave], kept[octave]))
    };
    signatures.iter().enumerate().map(level).collect()
}
