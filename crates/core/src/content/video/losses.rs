//! How visible is what each cell loses at each level, and what does a whole picture lose?
//!
//! From signatures alone: contrast that the finer steps would add, seen by the eye at that place,
//! pooled as the judge pools ([`visible_loss`](crate::perception::visible_loss)).

use crate::content::video::calibration::{ZONES, ZoneBounds, ZoneLosses, zone_of};
use crate::content::video::grid::level_map::LevelMap;
use crate::content::video::grid::places::{APART_DEG, CellPlace, Cells, SharedPlaces, Sighted};
use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::content::video::units::VideoUnits;
use crate::perception::eye::share_of_octave;
use crate::perception::glance::Glance;
use crate::perception::measures::contrast::{SIGNATURE_BANDS, Signature};
use crate::perception::parameters::{EyeState, Model, Parameters};
use crate::perception::sensitivity_table::SensitivityTable;
use crate::perception::spread::SpreadTable;
use crate::perception::visible_loss::{LostOctave, SPACE_EXPONENT, Sensed, SensedTable};
use crate::units::Radians;
use std::sync::Arc;

/// Octaves that are looked at, from the finest downwards: to below the judge's lowest band for any
/// content of up to 700 pixels per degree.
const MOST_OCTAVES: usize = 10;
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
#[derive(Clone, Debug, PartialEq)]
pub struct Losses {
    cells: usize,
    /// Sums over the places of a cell of pixels x loss^beta, by level, then by rank of the left
    /// eye's cell, in each zone; nothing is lost at level 0.
    sums: Vec<[f64; ZONES]>,
    /// The same over the bound of each place, where zones have their own; else empty.
    bounded: Vec<f64>,
    /// Pixels of the display that show a cell, by rank; of cells outside the view, that would.
    pixels: Vec<f64>,
    /// Whether a cell is in view, by rank. One outside counts nothing in the whole, but is seen
    /// fading into the picture if it is too coarse.
    in_view: Vec<bool>,
    /// All pixels that show a cell in view, in each zone.
    shown: [f64; ZONES],
}

impl Losses {
    /// Whether a cell may be shown at `level` where no cell may lose more than `bound`; where zones
    /// have their own bounds, more than that many times its zone's.
    #[must_use]
    pub fn is_within(&self, rank: usize, level: u8, bound: f64) -> bool {
        let at = usize::from(level) * self.cells + rank;
        let sum = match self.bounded.is_empty() {
            true => self.sums[at].iter().sum(),
            false => self.bounded[at],
        };
        sum <= self.pixels[rank] * libm::pow(bound, SPACE_EXPONENT)
    }

    /// Whether a cell is not in view: what is seen of it is how it fades into the picture, or what
    /// a turning head shows at its border, and for that it may be one level coarser than it might
    /// be in view.
    #[must_use]
    pub fn is_beside(&self, rank: usize) -> bool {
        !self.in_view[rank]
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
pub struct Around<'a> {
    /// Who looks, through which view.
    pub glance: &'a Glance,
    /// How far a head may turn while the eye stays.
    pub room: Radians,
    /// What no cell may lose, where each zone has its own bound.
    pub bounds: Option<ZoneBounds>,
}

impl<'a> Around<'a> {
    /// What is in view, without bounds.
    #[must_use]
    pub fn only(glance: &'a Glance) -> Self {
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
    cells: Cells,
    table: Arc<SensedTable>,
    parameters: Parameters,
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
        self.losses_around(grid, content, frame, &Around::only(glance))
    }

    /// The same with what a head that turns brings into view, as far as it decides which levels are
    /// within a bound: only what is in view counts in the whole.
    #[must_use]
    pub fn losses_around(
        &self,
        grid: &TileGrid,
        content: &dyn VideoUnits,
        frame: u32,
        around: &Around<'_>,
    ) -> Losses {
        let Around {
            glance,
            room,
            bounds,
        } = *around;
        let cells = grid.tiles_of_left_eye(0).count();
        let mut losses = Losses {
            cells,
            sums: vec![[0.0; ZONES]; cells * usize::from(grid.levels)],
            bounded: match bounds {
                Some(_) => vec![0.0; cells * usize::from(grid.levels)],
                None => Vec::new(),
            },
            pixels: vec![0.0; cells],
            in_view: vec![false; cells],
            shown: [0.0; ZONES],
        };
        let spread = SpreadTable::new(glance.gaze.spread);
        let sighted = Sighted::new(glance);
        let near = Sighted::up_to(glance, Radians(border_of(grid).0 + room.0));
        for cell in &*self.cells {
            let mut places: Vec<&CellPlace> = sighted.places(cell).collect();
            let in_view = !places.is_empty();
            if !in_view {
                places.extend(near.places(cell));
            }
            if places.is_empty() {
                continue;
            }
            let rank = grid.rank(grid.for_left_eye(cell.cell)) as usize;
            losses.in_view[rank] |= in_view;
            let octaves = octaves_of(grid, (content, frame), cell.cell, (&places, &sighted));
            for place in places {
                let pixels = sighted.pixels(place);
                losses.pixels[rank] += pixels;
                let eccentricity = glance.eccentricity(place.direction);
                let zone = zone_of(eccentricity);
                losses.shown[zone] += if in_view { pixels } else { 0.0 };
                let bound = bounds.map(|bounds| bounds.at(spread.effective(eccentricity)));
                let of_bound = bound.map(|bound| libm::pow(bound, -SPACE_EXPONENT));
                let sensed = self.sensed(&sighted, &spread, glance, place);
                for (level, octaves) in (1..).zip(&octaves) {
                    let seen = sensed.iter().zip(octaves).map(|(s, o)| s.difference(o));
                    let seen: f64 = seen.sum();
                    if seen > 0.0 {
                        let loss = pixels * libm::pow(seen, SPACE_EXPONENT);
                        losses.sums[level * cells + rank][zone] += loss;
                        if let Some(of_bound) = of_bound {
                            losses.bounded[level * cells + rank] += loss * of_bound;
                        }
                    }
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
        glance: &Glance,
        place: &CellPlace,
    ) -> [Sensed; MOST_OCTAVES] {
        let eccentricity = spread.effective(glance.eccentricity(place.direction));
        let raised = self.parameters.octaves_raised(eccentricity);
        let display = sighted.display_limit(place);
        let most = self.parameters.display_limit();
        let limit = if most < display { most } else { display };
        let finest = libm::log2(sighted.seen(place).ppd.0 / 4.0);
        let limit = libm::log2(limit.0);
        core::array::from_fn(|octave| {
            let frequency = finest - octave as f64;
            let share = share_of_octave(limit - frequency);
            if share == 0.0 || frequency < LOWEST_OCTAVE {
                return Sensed::default();
            }
            // The octave below the limit is the finest.
            if limit - frequency < 1.5 {
                let up = frequency + raised + FINEST_OCTAVES_UP;
                return self.table.at(up, eccentricity, share * FINEST_SHARE);
            }
            self.table.at(frequency + raised, eccentricity, share)
        })
    }
}

/// What each level but the finest loses of each octave of a cell that is seen at these places.
fn octaves_of(
    grid: &TileGrid,
    (content, frame): (&dyn VideoUnits, u32),
    cell: Tile,
    (places, sighted): (&[&CellPlace], &Sighted<'_>),
) -> Vec<[LostOctave; MOST_OCTAVES]> {
    let signatures = (0..grid.coarsest()).map(|level| {
        let unit = content.unit(grid.tile_over(cell, level), frame);
        content.signature(unit).unwrap_or_default()
    });
    let signatures: Vec<Signature> = signatures.collect();
    let octaves_a_step = grid.ratio.trailing_zeros() as usize;
    let footprints = places.iter().map(|place| sighted.footprint(place));
    let footprint = footprints.fold(f64::INFINITY, f64::min);
    let is_noisy = content.tells_of_noise();
    lost_octaves(&signatures, octaves_a_step, |step, octave| match is_noisy {
        true => octave_share(octave, footprint),
        false => drawn_share(step, footprint, octaves_a_step),
    })
}

/// How far outside the view a cell is seen fading into it, or lies in view between its places.
fn border_of(grid: &TileGrid) -> Radians {
    Radians(grid.fade().0 + Radians::from_degrees(APART_DEG / 2.0).0)
}

/// How much is drawn of what a step adds, 0 to 1, where a pixel of the display covers `footprint`
/// level-0 pixels on a side: a view that shows content smaller than it is blends the two levels
/// about its footprint, and nothing finer.
fn drawn_share(step: usize, footprint: f64, octaves_a_step: usize) -> f64 {
    (step as f64 + 1.0 - libm::log2(footprint) / octaves_a_step as f64).clamp(0.0, 1.0)
}

/// How much is drawn of an octave, 0 the finest of level 0, where a pixel of the display covers
/// `footprint` level-0 pixels on a side. Levels that such a view shows in place of each other
/// differ in lower octaves by the noise that each was coded with.
fn octave_share(octave: usize, footprint: f64) -> f64 {
    (octave as f64 + 1.0 - libm::log2(footprint)).clamp(0.0, 1.0)
}

/// What each level but the finest loses of each octave, from the signatures of its steps, finest
/// first, and from how much is drawn of an octave of a step; a step is `octaves_a_step` octaves.
fn lost_octaves(
    signatures: &[Signature],
    octaves_a_step: usize,
    drawn: impl Fn(usize, usize) -> f64,
) -> Vec<[LostOctave; MOST_OCTAVES]> {
    let mut lost = [0.0; MOST_OCTAVES];
    let mut whole = [0.0; MOST_OCTAVES];
    let level = |(step, signature): (usize, &Signature)| {
        let mut kept = [0.0; MOST_OCTAVES];
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
        for lost in lost.iter_mut().skip(first + SIGNATURE_BANDS) {
            *lost = libm::hypot(*lost, leak);
        }
        core::array::from_fn(|octave| match lost[octave] {
            0.0 => LostOctave::default(),
            lost => LostOctave::new(lost, kept[octave]),
        })
    };
    signatures.iter().enumerate().map(level).collect()
}
