//! Which level does each policy give each part of the picture?

use crate::content::policy::{EdgeRule, Policy, PolicyConfig};
use crate::content::video::grid::cells::{
    CellBounds, Probe, level_of_footprint, probes, probes_under,
};
use crate::content::video::grid::level_map::LevelMap;
use crate::content::video::grid::neighbours::neighbours;
use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::content::video::rules::distance::{acuity_thresholds, angle_to_cell, distance_levels};
use crate::content::video::rules::known_acuity::KnownAcuity;
use crate::content::video::rules::still::turns_with_head;
use crate::content::video::units::VideoUnits;
use crate::gaze::sample::GazeSample;
use crate::perception::acuity::AcuityModel;
use crate::perception::glance::Glance;
use crate::units::{Ppd, Radians};
use crate::view::axes::{angle_between, direction_between};
use crate::view::eye_view::EyeView;
use glam::DVec3;
use sha2::{Digest, Sha256};

pub mod distance;
pub(crate) mod known_acuity;
pub mod steady;
mod still;
pub mod target;
mod together;

/// What was chosen for one frame: the same for both eyes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selection {
    /// The level at which each cell is shown.
    pub levels: LevelMap,
    /// The tiles that takes, coarsest first.
    pub tiles: Vec<Tile>,
}

/// What a choice is made for.
#[derive(Clone, Copy)]
pub(crate) struct Occasion<'a> {
    /// What is shown, where a rule asks it.
    pub(crate) content: Option<&'a dyn VideoUnits>,
    /// Its frame.
    pub(crate) frame: u32,
    /// Who looks, through one view.
    pub(crate) glance: &'a Glance,
}

/// SHA-256 of the places of tiles, in hexadecimal: what a log keeps of them.
#[must_use]
pub fn places_hash(tiles: &[Tile]) -> String {
    let mut hash = Sha256::new();
    for tile in tiles {
        hash.update([tile.level, tile.face]);
        hash.update(tile.x.to_le_bytes());
        hash.update(tile.y.to_le_bytes());
    }
    let bytes = hash.finalize();
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Chooses levels on one grid by one policy.
#[derive(Clone, Debug)]
pub struct Rules {
    grid: TileGrid,
    config: PolicyConfig,
    cells: Vec<CellBounds>,
    thresholds: Vec<Radians>,
    /// How far outside the view `acuity` looks, as the head may turn there while the eye stays.
    head_room: Radians,
}

impl Rules {
    /// A selector; costs 81 directions a cell, once.
    #[must_use]
    pub fn new(grid: TileGrid, config: PolicyConfig) -> Self {
        let cells = grid
            .tiles_of_left_eye(0)
            .map(|cell| CellBounds::new(&grid, cell))
            .collect();
        let thresholds = if config.thresholds.is_empty() {
            acuity_thresholds(&grid, &config.acuity)
        } else {
            config.thresholds.clone()
        };
        Self {
            grid,
            config,
            cells,
            thresholds,
            head_room: Radians(0.0),
        }
    }

    /// From now on a head that turns by up to `head_room` under a steady eye finds levels there, a
    /// level coarser than `acuity` would choose.
    pub(crate) fn set_head_room(&mut self, head_room: Radians) {
        self.head_room = head_room;
    }

    /// From now on chooses for another eye, as far as `acuity` does.
    pub(crate) fn set_acuity(&mut self, acuity: AcuityModel) {
        self.config.acuity = acuity;
    }

    /// The grid it chooses on.
    #[must_use]
    pub fn grid(&self) -> &TileGrid {
        &self.grid
    }

    /// The choice for one glance, without content. A pure function; about 1 ms for a 16K cube under
    /// `acuity`.
    ///
    /// # Panics
    /// `viewport` needs a view, and a noise threshold content: see [`Self::select_of`].
    #[must_use]
    pub fn select(&self, glance: &Glance) -> Selection {
        self.select_of(None, 0, glance)
    }

    /// [`Self::select`] for a frame of content, whose cues say which cells are noisy.
    ///
    /// # Panics
    /// `viewport` needs a view, and a noise threshold content with cues.
    #[must_use]
    pub fn select_of(
        &self,
        content: Option<&dyn VideoUnits>,
        frame: u32,
        glance: &Glance,
    ) -> Selection {
        let occasion = Occasion {
            content,
            frame,
            glance,
        };
        let mut levels = self.levels_of(&occasion, &mut KnownAcuity::default(), |_| true);
        let tiles = levels.cover(&self.grid);
        Selection { levels, tiles }
    }

    /// The level that each cell needs; the tiles that show it may be finer. Cells whose rank is not
    /// `asked` for may get any level. What is found of the eye's acuity is kept for other views.
    pub(crate) fn levels_of(
        &self,
        occasion: &Occasion<'_>,
        known: &mut KnownAcuity,
        asked: impl Fn(usize) -> bool,
    ) -> LevelMap {
        let Occasion {
            content,
            frame,
            glance,
        } = *occasion;
        match self.config.policy {
            Policy::Full => LevelMap::filled(&self.grid, 0),
            Policy::Coarsest => LevelMap::filled(&self.grid, self.grid.coarsest()),
            Policy::Viewport => self.viewport(glance),
            Policy::Grid => self.kastner_grid(content, frame, &glance.gaze),
            Policy::Distance | Policy::Sampled => self.by_distance(glance),
            Policy::Acuity => self.acuity(glance, known, asked),
            Policy::Uniform | Policy::Eccentricity | Policy::Perceptual => {
                panic!(
                    "{:?} spends a budget: a Refiner chooses",
                    self.config.policy
                )
            }
        }
    }

    /// The selector of a viewer who may look up to `slack` away from the gaze: its levels are
    /// as fine or finer. What `acuity` makes of it, it takes from the glance's spread.
    pub(crate) fn loosened(&self, slack: Radians) -> Self {
        let wider = |angle: Radians| Radians(angle.0 + slack.0);
        let mut loose = self.clone();
        loose.thresholds = self.thresholds.iter().copied().map(wider).collect();
        loose.config.margin = wider(self.config.margin);
        // A single cell under the gaze becomes all that the gaze is near.
        loose.config.edge_margin = wider(match self.config.edge_rule {
            EdgeRule::Conservative => self.config.edge_margin,
            EdgeRule::Single => Radians(0.0),
        });
        loose.config.edge_rule = EdgeRule::Conservative;
        loose
    }

    /// Refines the cells that a window looks at, which may show less than the space between two
    /// probes of a cell.
    fn refine_under(&self, view: &EyeView, levels: &mut LevelMap, level_at: impl Fn(&Probe) -> u8) {
        if view.field.at_eye.is_none() {
            return;
        }
        for (cell, probe) in probes_under(&self.grid, view) {
            levels.refine(&self.grid, cell, level_at(&probe));
        }
    }

    /// An acuity matrix by neighbourhood (Kastner 2016, framework 2, section 4.2).
    fn kastner_grid(
        &self,
        content: Option<&dyn VideoUnits>,
        frame: u32,
        gaze: &GazeSample,
    ) -> LevelMap {
        let grid = &self.grid;
        let mut levels = LevelMap::filled(grid, grid.coarsest());
        let middle = grid.levels / 2;
        let finest = self.cells_at_gaze(gaze.gaze_in_content);
        for cell in &finest {
            levels.refine(grid, *cell, 0);
            neighbours(grid, *cell)
                .into_iter()
                .for_each(|next| levels.refine(grid, next, middle));
        }
        let lowest = |cell: &Tile| levels.level(grid, *cell) == grid.coarsest();
        let counted = grid.tiles_of_left_eye(0).filter(lowest);
        let mut noisy: Vec<Tile> = counted.take(self.config.noisy_cells as usize).collect();
        if let Some(threshold) = self.config.noise_threshold {
            let above = |cell: &Tile| rgb_variance(content, *cell, frame) > threshold;
            noisy.extend(grid.tiles_of(0).filter(above));
        }
        noisy
            .into_iter()
            .for_each(|cell| levels.refine(grid, cell, middle));
        levels
    }

    /// Framework 1 of Kastner 2016, section 4.1.3.
    fn by_distance(&self, glance: &Glance) -> LevelMap {
        let gaze = glance.gaze.gaze_in_content;
        let view = glance.view.as_ref();
        distance_levels(&self.grid, &self.cells, &self.thresholds, gaze, view)
    }

    fn cells_at_gaze(&self, gaze: DVec3) -> Vec<Tile> {
        let surface = &self.grid.surface;
        let under = surface.locate(gaze);
        let under = under.map(|(face, place)| self.grid.cell_at(face, place));
        if under.is_none() && !surface.projection.surrounds() {
            return Vec::new();
        }
        match self.config.edge_rule {
            EdgeRule::Single => under.into_iter().collect(),
            EdgeRule::Conservative => {
                let margin = self.config.edge_margin.0 + 1e-9;
                let near = |cell: &Tile| angle_to_cell(&self.grid, *cell, gaze).0 <= margin;
                let cells = self.grid.tiles_of_left_eye(0);
                let mut cells: Vec<Tile> = cells.filter(near).collect();
                if cells.is_empty() {
                    cells.extend(under);
                }
                cells
            }
        }
    }

    fn acuity_level(&self, bounds: &CellBounds, glance: &Glance) -> u8 {
        let gaze = &glance.gaze;
        if glance.is_magnified() {
            return self.magnified_level(bounds, glance);
        }
        let floor = |nearest| self.floor_level(bounds, nearest, glance);
        let finest = floor(bounds.least_eccentricity(gaze.gaze_in_content));
        if finest == self.grid.coarsest() {
            return finest;
        }
        // Its middle is one of the places that must be allowed.
        if self.allowed_level(glance, bounds.middle()) == finest {
            return finest;
        }
        let nearest = bounds.nearest_probe(&self.grid, gaze.gaze_in_content);
        let found = self.allowed_level(glance, &nearest);
        let eccentricity = glance.eccentricity(nearest.direction).0 - CellBounds::NEAREST_WITHIN.0;
        if floor(Radians(eccentricity.max(0.0))) == found {
            return found;
        }
        probes(&self.grid, bounds.cell)
            .map(|probe| self.allowed_level(glance, &probe))
            .min()
            .unwrap_or(0)
    }

    /// No place of a cell at `nearest` or farther from the gaze is allowed a finer level than this.
    fn floor_level(&self, bounds: &CellBounds, nearest: Radians, glance: &Glance) -> u8 {
        let ppd = bounds.least_ppd();
        let best = self
            .config
            .acuity
            .best_acuity(self.beyond_disc(nearest, &glance.gaze));
        let display = glance.view.filter(|_| self.turns(glance));
        let limit = display.map_or(0.0, |view| ppd.0 / view.most_ppd().0);
        let footprint = (ppd.0 / (2.0 * best.0)).max(limit);
        level_of_footprint(&self.grid, footprint.min(self.disc_footprint(nearest, ppd)))
    }

    fn allowed_level(&self, glance: &Glance, probe: &Probe) -> u8 {
        let footprint = self.acuity_footprint(glance, probe);
        level_of_footprint(&self.grid, footprint.max(self.display_limit(glance, probe)))
    }

    /// Level-0 pixels that a texel may span at a place before this eye could notice: the density of
    /// the content over twice the highest frequency that is resolved there.
    ///
    /// Eccentricity counts from the edge of the safety disc and the gaze's spread: an eye that is
    /// off by that much still sees no coarser texel than the model allows.
    fn acuity_footprint(&self, glance: &Glance, probe: &Probe) -> f64 {
        let Some([gaze, direction]) = glance.seen([glance.gaze.gaze_in_content, probe.direction])
        else {
            return f64::MAX;
        };
        let ppd = seen_ppd(glance, probe);
        let eccentricity = angle_between(gaze, direction);
        let beyond = self.beyond_disc(eccentricity, &glance.gaze);
        let disc = self.disc_footprint(eccentricity, ppd);
        let acuity = &self.config.acuity;
        let acuity = match acuity.is_round() {
            true => acuity.best_acuity(beyond),
            false => {
                // The nearest to the gaze that an eye off by the disc's radius could look along.
                let toward = toward(gaze, direction, eccentricity, beyond);
                acuity.acuity(toward, direction)
            }
        };
        (ppd.0 / (2.0 * acuity.0)).min(disc)
    }

    fn beyond_disc(&self, eccentricity: Radians, gaze: &GazeSample) -> Radians {
        Radians((eccentricity.0 - self.config.safety_disc.0 - gaze.spread.0).max(0.0))
    }

    /// The footprint that keeps the safety disc at the finest level: 1 inside, and outside no more
    /// than the reconstruction can fade from before it reaches the disc.
    fn disc_footprint(&self, eccentricity: Radians, ppd: Ppd) -> f64 {
        let disc = self.config.safety_disc;
        if disc.0 <= 0.0 {
            return f64::MAX;
        }
        let outside = Radians((eccentricity.0 - disc.0).max(0.0)).to_degrees();
        1.0 + outside * ppd.0 / self.grid.blend_pixels()
    }

    /// Whether the picture turns with a head inside the content.
    fn turns(&self, glance: &Glance) -> bool {
        turns_with_head(&self.grid, glance)
    }

    /// The footprint under which the display shows no difference; the safety disc is exempt. On a
    /// sphere that of the display's densest corner, so that a head that nods under a steady eye
    /// changes nothing.
    fn display_limit(&self, glance: &Glance, probe: &Probe) -> f64 {
        let eccentricity = glance.eccentricity(probe.direction);
        let limit = glance.view.map_or(0.0, |view| match self.turns(glance) {
            true => probe.ppd.0 / view.most_ppd().0,
            false => view.footprint(probe.ppd, probe.direction),
        });
        limit.min(self.disc_footprint(eccentricity, seen_ppd(glance, probe)))
    }
}

/// Mean variance of red, green and blue of a cell over the group of a frame, in squared code
/// values: the variance determinant of Kastner 2016, section 4.2.1. Cues hold its root.
fn rgb_variance(content: Option<&dyn VideoUnits>, cell: Tile, frame: u32) -> f64 {
    let cues = content.and_then(|content| content.cues(content.unit(cell, frame)));
    assert!(cues.is_some(), "a noise threshold was given no cues");
    cues.map_or(0.0, |cues| cues.deviation * cues.deviation)
}

/// The direction on the way from `gaze` to `direction` that is `left` from the latter.
fn toward(gaze: DVec3, direction: DVec3, eccentricity: Radians, left: Radians) -> DVec3 {
    if left >= eccentricity {
        return gaze;
    }
    if left.0 <= 0.0 {
        return direction;
    }
    direction_between(gaze, direction, 1.0 - left.0 / eccentricity.0)
}

/// Density of the content at the eye, in the direction of a probe.
fn seen_ppd(glance: &Glance, probe: &Probe) -> Ppd {
    let view = glance.view.as_ref();
    view.map_or(probe.ppd, |view| view.seen_ppd(probe.ppd, probe.direction))
}

mod in_view;
#[cfg(test)]
mod in_view_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod together_tests;
