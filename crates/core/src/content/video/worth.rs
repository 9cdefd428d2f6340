//! What is each step of prepared video worth to an eye, without drawing anything?
//!
//! Signature x sensitivity x footprint: what the step adds in each octave, how well the eye sees
//! that octave at this place, and how many square degrees of it there are.

use crate::content::policy::{Policy, PolicyConfig};
use crate::content::video::grid::level_map::LevelMap;
use crate::content::video::grid::places::{CellPlace, CellPlaces, Cells, SharedPlaces, Sighted};
use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::content::video::losses::Losses;
use crate::content::video::units::VideoUnits;
use crate::perception::glance::Glance;
use crate::perception::measures::contrast::Signature;
use crate::perception::measures::saliency::saliency;
use crate::perception::parameters::{EyeState, Parameters};
use crate::perception::spread::SpreadTable;
use crate::perception::step_worth::{LookedPlace, StepWorth};
use crate::units::{Cpd, Ppd, Radians};
use crate::view::axes::angle_between;

/// Gain of every step over every cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Gains {
    cells: usize,
    /// By level (of the step's end), then by rank of the cell.
    steps: Vec<f64>,
}

impl Gains {
    fn zero(grid: &TileGrid) -> Self {
        let cells = grid.tiles_in_level(0) as usize;
        Self {
            cells,
            steps: vec![0.0; cells * usize::from(grid.coarsest())],
        }
    }

    /// What each step is worth through the view that it is worth most to.
    #[must_use]
    pub fn highest(views: Vec<Self>) -> Self {
        let mut views = views.into_iter();
        let first = views.next().unwrap_or(Self {
            cells: 0,
            steps: Vec::new(),
        });
        views.fold(first, |mut highest, view| {
            for (gain, other) in highest.steps.iter_mut().zip(view.steps) {
                *gain = gain.max(other);
            }
            highest
        })
    }

    /// Makes steps that are worth nothing by themselves worth next to nothing where they remove
    /// visible loss: for a score they are bought too, after all others.
    pub(crate) fn rise_where_lost(&mut self, grid: &TileGrid, losses: &Losses) {
        const NEXT_TO_NOTHING: f64 = 1e-9;
        for cell in grid.tiles_of(0) {
            let rank = grid.rank(grid.for_left_eye(cell)) as usize;
            for level in 0..grid.coarsest() {
                let [more, less] = [level + 1, level].map(|level| losses.sum(rank, level));
                let removed = more.iter().sum::<f64>() - less.iter().sum::<f64>();
                let at = usize::from(level) * self.cells + grid.rank(cell) as usize;
                if self.steps[at] <= 0.0 && removed > 0.0 {
                    self.steps[at] = NEXT_TO_NOTHING * removed;
                }
            }
        }
    }

    /// Gain of the step to `level` over a cell.
    #[must_use]
    pub fn step(&self, grid: &TileGrid, cell: Tile, level: u8) -> f64 {
        self.steps[usize::from(level) * self.cells + grid.rank(cell) as usize]
    }

    /// Gain of the step to a tile over all its cells.
    #[must_use]
    pub fn of(&self, grid: &TileGrid, tile: Tile) -> f64 {
        grid.cells_under(tile)
            .map(|cell| self.step(grid, cell, tile.level))
            .sum()
    }

    /// Gain of the step to a tile over those of its cells that are shown coarser.
    #[must_use]
    pub fn over(&self, grid: &TileGrid, tile: Tile, shown: &LevelMap) -> f64 {
        grid.cells_under(tile)
            .filter(|cell| shown.level(grid, *cell) > tile.level)
            .map(|cell| self.step(grid, cell, tile.level))
            .sum()
    }

    /// Share of all that could be gained that is gained where cells are shown at these levels.
    #[must_use]
    pub fn share(&self, grid: &TileGrid, shown: &LevelMap) -> f64 {
        let (mut gained, mut all) = (0.0, 0.0);
        for cell in grid.tiles_of(0) {
            for level in 0..grid.coarsest() {
                let gain = self.step(grid, cell, level).max(0.0);
                all += gain;
                gained += if shown.level(grid, cell) <= level {
                    gain
                } else {
                    0.0
                };
            }
        }
        if all > 0.0 { gained / all } else { 1.0 }
    }
}

/// Chance that the next saccade lands outside what the gaze predicts while a group is shown.
const WANDER: f64 = 0.3;
/// Saccades fall off with amplitude as exp(-e / this), in degrees (Bahill et al. 1975: 86 % are of
/// 15° or less).
const AMPLITUDE_DEG: f64 = 7.6;

/// Values steps under one policy.
#[derive(Clone, Debug)]
pub struct Worth {
    config: PolicyConfig,
    cells: Cells,
    of_steps: StepWorth,
}

/// A part of a cell, as an eye sees it.
#[derive(Clone, Copy)]
struct Looked {
    ppd: Ppd,
    area_deg2: f64,
    place: LookedPlace,
}

impl Worth {
    /// The worth of steps under a policy that spends a budget.
    #[must_use]
    pub fn new(grid: &TileGrid, config: &PolicyConfig) -> Self {
        Self::sharing(&SharedPlaces::default(), grid, config)
    }

    /// The same, with places of this grid that others use as well.
    pub(super) fn sharing(places: &SharedPlaces, grid: &TileGrid, config: &PolicyConfig) -> Self {
        Self {
            config: config.clone(),
            cells: places.few(grid),
            of_steps: StepWorth::new(&config.perception),
        }
    }

    /// The worth of steps to an eye alone: visible error removed, whatever it takes to show it.
    /// For judging what was shown; the share of [`Gains`] is independent of lambda and budget.
    #[must_use]
    pub fn judge(grid: &TileGrid) -> Self {
        let perception = Parameters {
            lambda: 0.0,
            ..Parameters::default()
        };
        let config = PolicyConfig {
            perception,
            ..PolicyConfig::new(Policy::Perceptual)
        };
        Self::new(grid, &config)
    }

    /// Gain of every step for one glance.
    #[must_use]
    pub fn gains(
        &self,
        grid: &TileGrid,
        content: &dyn VideoUnits,
        frame: u32,
        glance: &Glance,
    ) -> Gains {
        let mut gains = Gains::zero(grid);
        let spread = SpreadTable::new(glance.gaze.spread);
        let sighted = Sighted::new(glance);
        let prior = self.prior(grid, content, frame, glance);
        for (rank, cell) in self.cells.iter().enumerate() {
            let looked = self.looked(cell, glance, &sighted, &spread);
            let prior = prior.get(rank).copied().unwrap_or_default();
            if looked.is_empty() && prior == 0.0 {
                continue;
            }
            for level in 0..grid.coarsest() {
                let unit = content.unit(grid.tile_over(cell.cell, level), frame);
                let signature = content.signature(unit).unwrap_or_default();
                let step = Step {
                    scale: f64::from(grid.scale(level)),
                    ratio: f64::from(grid.ratio),
                    signature: &signature,
                };
                let at = |looked: &Looked| self.gain(&step, looked, glance.state);
                let seen: f64 = looked.iter().map(at).sum();
                let ahead = if prior > 0.0 {
                    prior * self.gain_if_looked_at(&step, cell)
                } else {
                    0.0
                };
                gains.steps[usize::from(level) * gains.cells + rank] = seen + ahead;
            }
        }
        gains
    }

    /// The parts of a cell that are in view.
    fn looked(
        &self,
        cell: &CellPlaces,
        glance: &Glance,
        sighted: &Sighted<'_>,
        spread: &SpreadTable,
    ) -> Vec<Looked> {
        let looked = |place: &CellPlace| {
            let apart = glance.eccentricity(place.direction);
            let display = sighted.display_limit(place);
            self.looked_at(&sighted.seen(place), spread.effective(apart), display)
        };
        sighted.places(cell).map(looked).collect()
    }

    fn looked_at(&self, place: &CellPlace, eccentricity: Radians, display: Cpd) -> Looked {
        Looked {
            ppd: place.ppd,
            area_deg2: place.area_deg2,
            place: LookedPlace::at(&self.config.perception, eccentricity, display),
        }
    }

    /// Gain of a step over a part of a cell.
    fn gain(&self, step: &Step<'_>, looked: &Looked, state: EyeState) -> f64 {
        let Looked { place, .. } = looked;
        match self.config.policy {
            Policy::Perceptual => {
                let ppd = Ppd(looked.ppd.0 / step.scale);
                let gain = self.of_steps.gain(step.signature, ppd, place, state);
                gain * self.of_steps.extent(looked.ppd, looked.area_deg2, place)
            }
            // Without content a step counts in full as long as the display shows any of it.
            _ if looked.ppd.0 / step.scale / step.ratio >= 2.0 * place.display.0 => 0.0,
            Policy::Eccentricity => {
                (place.acuity.0 + self.config.perception.pedestal) * looked.area_deg2
            }
            _ => looked.area_deg2,
        }
    }

    /// Gain of a step over a whole cell, should the next fixation be on it.
    fn gain_if_looked_at(&self, step: &Step<'_>, cell: &CellPlaces) -> f64 {
        let gain = |place: &CellPlace| {
            let looked = self.looked_at(place, Radians(0.0), Cpd(f64::INFINITY));
            self.gain(step, &looked, EyeState::Landed)
        };
        cell.places.iter().map(gain).sum::<f64>().max(0.0)
    }

    /// Chance of each cell to hold the next fixation, by saliency; nothing where that is not asked
    /// for or not known.
    fn prior(
        &self,
        grid: &TileGrid,
        content: &dyn VideoUnits,
        frame: u32,
        glance: &Glance,
    ) -> Vec<f64> {
        if !self.config.saliency || self.config.policy != Policy::Perceptual {
            return Vec::new();
        }
        let surface = &grid.surface;
        let drawn = self.cells.iter().map(|cell| {
            let centre = grid.centre(cell.cell);
            let cues = content.cues(content.unit(cell.cell, frame));
            let apart = angle_between(glance.gaze.gaze_in_content, centre).to_degrees();
            let salient = cues.map_or(0.0, |cues| {
                let place = surface.as_if_square(centre);
                saliency(&cues, surface.projection, surface.tangents, place)
            });
            let area: f64 = cell.places.iter().map(|place| place.area_deg2).sum();
            area * salient * libm::exp(-apart / AMPLITUDE_DEG)
        });
        let drawn: Vec<f64> = drawn.collect();
        let all: f64 = drawn.iter().sum();
        let share = if all > 0.0 { WANDER / all } else { 0.0 };
        drawn.iter().map(|drawn| drawn * share).collect()
    }
}

/// A step to a level.
struct Step<'a> {
    /// Level-0 pixels under one of its pixels, on a side.
    scale: f64,
    /// By how much it is finer than the level before, on a side.
    ratio: f64,
    signature: &'a Signature,
}
