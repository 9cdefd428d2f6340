//! Which level does each policy give each part of the picture?

use super::greedy::Misfit;
use super::level_map::LevelMap;
use super::need::{CellBounds, Probe, level_of_footprint, probes};
use super::neighbours::neighbours;
use crate::asset::tile_grid::{Tile, TileGrid};
use crate::gaze::sample::GazeSample;
use crate::perception::acuity::AcuityModel;
use crate::perception::parameters::{EyeState, Model, Parameters};
use crate::units::{Ppd, Radians};
use crate::view::axes::{angle_between, direction_between};
use crate::view::eye_view::EyeView;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// How levels are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Policy {
    /// Every finest tile: the baseline of all ratios.
    Full,
    /// Only the coarsest level: the other end.
    Coarsest,
    /// What is in view plus a margin at display density, the rest coarsest: what the industry
    /// ships.
    Viewport,
    /// Kastner 2016 on panoramas: the gaze's cell finest, its neighbours middle, the rest coarsest.
    Grid,
    /// The coarsest level that still meets the eye's limit everywhere in a cell.
    Acuity,
    /// UNI: everything in view is raised evenly, one level at a time.
    Uniform,
    /// ECC: acuity plus a pedestal, per byte: no content, no popping.
    Eccentricity,
    /// OURS: what a step is worth to the eye, per byte (Chen et al. 2022, corrected).
    Perceptual,
}

impl Policy {
    /// Whether this policy spends a budget on units of known size, step by step: then a
    /// [`Refiner`](super::refine::Refiner) chooses, else a [`Selector`].
    #[must_use]
    pub fn spends_a_budget(self) -> bool {
        matches!(self, Self::Uniform | Self::Eccentricity | Self::Perceptual)
    }
}

/// Which cells the `grid` policy shows at the finest level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EdgeRule {
    /// Every cell within the margin of the gaze, borders included.
    #[default]
    Conservative,
    /// Only the cell that the gaze is in.
    Single,
}

/// A policy with its parameters; written into session logs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolicyConfig {
    /// The rule.
    pub policy: Policy,
    /// The eye of `acuity`.
    pub acuity: AcuityModel,
    /// `acuity`: radius round the gaze within which everything is finest and beyond which
    /// eccentricity counts.
    pub safety_disc: Radians,
    /// `viewport`: what is kept fine around the view.
    pub margin: Radians,
    /// `grid`: which cells are finest.
    pub edge_rule: EdgeRule,
    /// `grid`: how near a cell must be to the gaze to be finest.
    pub edge_margin: Radians,
    /// `grid`: how many cells of the lowest level, in index order, count as noisy and are promoted
    /// to the middle level.
    pub noisy_cells: u32,
    /// `perceptual`, `eccentricity`: what a step is worth.
    #[serde(default)]
    pub perception: Parameters,
    /// `perceptual`: whether saliency says what to fetch outside the region that gaze predicts.
    #[serde(default)]
    pub saliency: bool,
}

impl PolicyConfig {
    /// A policy with its default parameters.
    #[must_use]
    pub fn new(policy: Policy) -> Self {
        Self {
            policy,
            acuity: AcuityModel::LINEAR,
            safety_disc: Radians(0.0),
            margin: Radians::from_degrees(10.0),
            edge_rule: EdgeRule::Conservative,
            edge_margin: Radians(0.0),
            noisy_cells: 0,
            perception: Parameters::default(),
            saliency: false,
        }
    }

    /// What happens when the best step does not fit into what a frame may spend: the corrected
    /// greedy stops and saves up for it, as what is left counts for the next frame; the published
    /// one (Chen et al. 2022) goes on with the next and so spends what it would need
    /// (docs/decisions/0004-what-does-not-fit-is-skipped.md).
    pub(super) fn misfit(&self) -> Misfit {
        match self.perception.model {
            Model::Paper => Misfit::Skip,
            Model::Default => Misfit::Stop,
        }
    }
}

/// What selection knows of the viewer at one display time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Where the eye looks when the picture is shown.
    pub gaze: GazeSample,
    /// What shows the picture; without it nothing is cut to the display's density.
    pub view: Option<EyeView>,
    /// What the eye does, as far as the worth of a step depends on it.
    pub state: EyeState,
}

/// What was chosen for one frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selection {
    /// The level at which each cell is shown.
    pub levels: LevelMap,
    /// The tiles that takes, coarsest first.
    pub tiles: Vec<Tile>,
}

/// Chooses levels on one grid by one policy.
#[derive(Clone, Debug)]
pub struct Selector {
    grid: TileGrid,
    config: PolicyConfig,
    cells: Vec<CellBounds>,
}

impl Selector {
    /// A selector; costs 81 directions a cell, once.
    #[must_use]
    pub fn new(grid: TileGrid, config: PolicyConfig) -> Self {
        let cells = grid
            .tiles_of(0)
            .map(|cell| CellBounds::new(&grid, cell))
            .collect();
        Self {
            grid,
            config,
            cells,
        }
    }

    /// The grid it chooses on.
    #[must_use]
    pub fn grid(&self) -> &TileGrid {
        &self.grid
    }

    /// The choice for one moment. A pure function; about 1 ms for a 16K cube under `acuity`.
    ///
    /// # Panics
    /// `viewport` needs a view.
    #[must_use]
    pub fn select(&self, moment: &Moment) -> Selection {
        let mut levels = match self.config.policy {
            Policy::Full => LevelMap::filled(&self.grid, 0),
            Policy::Coarsest => LevelMap::filled(&self.grid, self.grid.coarsest()),
            Policy::Viewport => self.viewport(moment),
            Policy::Grid => self.kastner_grid(&moment.gaze),
            Policy::Acuity => self.acuity(moment),
            Policy::Uniform | Policy::Eccentricity | Policy::Perceptual => {
                panic!(
                    "{:?} spends a budget: a Refiner chooses",
                    self.config.policy
                )
            }
        };
        let tiles = levels.cover(&self.grid);
        Selection { levels, tiles }
    }

    fn viewport(&self, moment: &Moment) -> LevelMap {
        let view = moment.view.as_ref();
        assert!(
            view.is_some(),
            "the viewport policy chooses by what is in view"
        );
        let margin = self.config.margin;
        LevelMap::from_cells(&self.grid, |cell| {
            let Some(view) = view else {
                return self.grid.coarsest();
            };
            let seen =
                probes(&self.grid, cell).filter(|probe| in_view(view, probe.direction, margin));
            let level = seen
                .map(|probe| level_of_footprint(&self.grid, display_footprint(view, &probe)))
                .min();
            level.unwrap_or(self.grid.coarsest())
        })
    }

    /// An acuity matrix by neighbourhood (Kastner 2016, framework 2, section 4.2).
    fn kastner_grid(&self, gaze: &GazeSample) -> LevelMap {
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
        let lowest: Vec<Tile> = grid
            .tiles_of(0)
            .filter(|cell| levels.level(grid, *cell) == grid.coarsest())
            .take(self.config.noisy_cells as usize)
            .collect();
        lowest
            .into_iter()
            .for_each(|cell| levels.refine(grid, cell, middle));
        levels
    }

    fn cells_at_gaze(&self, gaze: DVec3) -> Vec<Tile> {
        let Some((face, place)) = self.grid.surface.locate(gaze) else {
            return Vec::new();
        };
        match self.config.edge_rule {
            EdgeRule::Single => vec![self.grid.cell_at(face, place)],
            EdgeRule::Conservative => {
                let margin = self.config.edge_margin.0 + 1e-9;
                let near = |cell: &Tile| angle_to_cell(&self.grid, *cell, gaze).0 <= margin;
                let mut cells: Vec<Tile> = self.grid.tiles_of(0).filter(near).collect();
                if cells.is_empty() {
                    cells.push(self.grid.cell_at(face, place));
                }
                cells
            }
        }
    }

    fn acuity(&self, moment: &Moment) -> LevelMap {
        let mut cells = self.cells.iter();
        LevelMap::from_cells(&self.grid, |_| {
            cells
                .next()
                .map_or(0, |bounds| self.acuity_level(bounds, moment))
        })
    }

    fn acuity_level(&self, bounds: &CellBounds, moment: &Moment) -> u8 {
        let gaze = &moment.gaze;
        let nearest = bounds.least_eccentricity(gaze.gaze_in_content);
        let coarsest = self.grid.coarsest();
        let beyond = self.beyond_disc(nearest, gaze);
        let best = self.config.acuity.best_acuity(beyond).0;
        let disc = self.disc_footprint(nearest, bounds.least_ppd());
        let least = (bounds.least_ppd().0 / (2.0 * best)).min(disc);
        if level_of_footprint(&self.grid, least) == coarsest {
            return coarsest;
        }
        let allowed = |probe: Probe| {
            let footprint = self.acuity_footprint(gaze, &probe);
            level_of_footprint(
                &self.grid,
                footprint.max(self.display_limit(moment, &probe)),
            )
        };
        probes(&self.grid, bounds.cell)
            .map(allowed)
            .min()
            .unwrap_or(0)
    }

    /// Level-0 pixels that a texel may span at a place before this eye could tell: the density of
    /// the content over twice the highest frequency that is resolved there.
    ///
    /// Eccentricity counts from the edge of the safety disc and the gaze's spread: whoever is off
    /// by that much still sees no coarser texel than the model allows.
    fn acuity_footprint(&self, gaze: &GazeSample, probe: &Probe) -> f64 {
        let eccentricity = angle_between(gaze.gaze_in_content, probe.direction);
        let beyond = self.beyond_disc(eccentricity, gaze);
        let disc = self.disc_footprint(eccentricity, probe.ppd);
        // The nearest direction to the gaze that an eye off by the disc's radius could look along.
        let toward = toward(gaze.gaze_in_content, probe.direction, eccentricity, beyond);
        let acuity = self.config.acuity.acuity(toward, probe.direction);
        (probe.ppd.0 / (2.0 * acuity.0)).min(disc)
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

    /// The footprint under which the display shows no difference; the safety disc is exempt.
    fn display_limit(&self, moment: &Moment, probe: &Probe) -> f64 {
        let eccentricity = angle_between(moment.gaze.gaze_in_content, probe.direction);
        let limit = moment
            .view
            .map_or(0.0, |view| display_footprint(&view, probe));
        limit.min(self.disc_footprint(eccentricity, probe.ppd))
    }
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

/// Level-0 pixels under one pixel of the display at the place of a probe.
fn display_footprint(view: &EyeView, probe: &Probe) -> f64 {
    probe.ppd.0 / view.ppd_towards(probe.direction).0
}

/// Whether a direction is in view, or no more than `margin` beside it.
pub(super) fn in_view(view: &EyeView, direction: DVec3, margin: Radians) -> bool {
    let depth = direction.dot(view.axes.forward);
    let across = libm::atan2(direction.dot(view.axes.right), depth);
    let down = libm::atan2(direction.dot(view.axes.down), depth);
    let reach = |tangent: f64| libm::atan(tangent) + margin.0;
    let field = view.field;
    (-reach(field.left)..=reach(field.right)).contains(&across)
        && (-reach(field.up)..=reach(field.down)).contains(&down)
}

/// Angle between a direction and the nearest place of a cell; 0 inside, borders included.
fn angle_to_cell(grid: &TileGrid, cell: Tile, direction: DVec3) -> Radians {
    let surface = &grid.surface;
    let axes = surface.axes(u32::from(cell.face));
    let depth = direction.dot(axes.forward);
    if depth <= 1e-9 {
        return Radians(core::f64::consts::PI);
    }
    let tangent = [
        direction.dot(axes.right) / depth,
        direction.dot(axes.down) / depth,
    ];
    let (from, size) = (grid.origin(cell), grid.covered(cell));
    let nearest = [0, 1].map(|k| {
        let side = f64::from(surface.size[k]);
        let place = (tangent[k] / surface.tangents[k] + 1.0) / 2.0 * side;
        place.clamp(f64::from(from[k]), f64::from(from[k] + size[k]))
    });
    angle_between(direction, surface.direction(u32::from(cell.face), nearest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asset::tile_grid::Cut;
    use crate::gaze::scan::Random;
    use crate::selection::level_map::{histogram, pixels};
    use crate::units::Seconds;
    use crate::view::axes::Axes;
    use crate::view::eye_view::Field;
    use crate::view::surface::{Screen, Surface};
    use proptest::prelude::*;

    fn degrees(yaw: f64, pitch: f64) -> Moment {
        let gaze = GazeSample::at(
            Seconds(0.0),
            Radians::from_degrees(yaw),
            Radians::from_degrees(pitch),
        );
        Moment {
            gaze,
            view: None,
            state: EyeState::Steady,
        }
    }

    fn kastner_pixels(config: PolicyConfig, moment: &Moment) -> (u64, Vec<u32>) {
        let grid = TileGrid::new(Surface::cube(3000), Cut::Grid([4, 4]), 3, 4).unwrap();
        let tiles = Selector::new(grid, config).select(moment).tiles;
        (pixels(&grid, &tiles), histogram(&grid, &tiles))
    }

    fn cube_16k(config: PolicyConfig) -> Selector {
        let grid = TileGrid::new(Surface::cube(4096), Cut::Tile(256), 5, 2).unwrap();
        Selector::new(grid, config)
    }

    fn share(selector: &Selector, moment: &Moment) -> f64 {
        let tiles = selector.select(moment).tiles;
        pixels(selector.grid(), &tiles) as f64 / selector.grid().surface.pixels() as f64
    }

    fn shares(selector: &Selector) -> (f64, f64) {
        let mut random = Random::new(1);
        let all: Vec<f64> = (0..300)
            .map(|_| {
                let gaze_in_content = random.direction();
                let gaze = GazeSample {
                    gaze_in_content,
                    ..degrees(0.0, 0.0).gaze
                };
                share(
                    selector,
                    &Moment {
                        gaze,
                        view: None,
                        state: EyeState::Steady,
                    },
                )
            })
            .collect();
        (
            all.iter().sum::<f64>() / 300.0,
            all.iter().copied().fold(0.0, f64::max),
        )
    }

    #[test]
    fn the_grid_policy_counts_kastner_s_cells() {
        let grid = PolicyConfig::new(Policy::Grid);
        let inner = degrees(-10.0, 10.0);
        assert_eq!(
            kastner_pixels(grid.clone(), &inner),
            (1_037_435, vec![1, 8, 87])
        );
        let noisy = PolicyConfig {
            noisy_cells: 22,
            ..grid.clone()
        };
        assert_eq!(kastner_pixels(noisy, &inner), (1_766_405, vec![1, 30, 65]));
        assert_eq!(
            kastner_pixels(grid, &degrees(0.0, 0.0)),
            (2_850_848, vec![4, 12, 80])
        );
        let coarsest = PolicyConfig::new(Policy::Coarsest);
        assert_eq!(kastner_pixels(coarsest, &inner), (212_064, vec![0, 0, 96]));
    }

    #[test]
    fn a_gaze_into_a_corner_of_the_cube_has_seven_middle_cells() {
        let single = PolicyConfig {
            edge_rule: EdgeRule::Single,
            ..PolicyConfig::new(Policy::Grid)
        };
        assert_eq!(
            kastner_pixels(single.clone(), &degrees(40.0, 30.0)).1,
            [1, 7, 88]
        );
        assert_eq!(kastner_pixels(single, &degrees(40.0, 10.0)).1, [1, 8, 87]);
    }

    #[test]
    fn acuity_takes_the_share_of_a_16k_cube_that_the_reference_gives() {
        let disc = |radius| PolicyConfig {
            safety_disc: Radians::from_degrees(radius),
            ..PolicyConfig::new(Policy::Acuity)
        };
        for (radius, mean, most) in [(0.0, 0.010, 0.015), (2.5, 0.013, 0.02), (5.0, 0.018, 0.03)] {
            let (found_mean, found_most) = shares(&cube_16k(disc(radius)));
            assert!(
                found_mean <= mean && found_most <= most,
                "{radius}: {found_mean}"
            );
        }
    }

    #[test]
    fn viewport_takes_what_is_in_view_at_the_density_of_the_display() {
        let selector = cube_16k(PolicyConfig::new(Policy::Viewport));
        let at = |size: u32| {
            let size = [size; 2];
            let field = Field::across(Radians::from_degrees(100.0), size);
            let view = Some(EyeView {
                axes: Axes::FRONT,
                field,
                size,
            });
            share(
                &selector,
                &Moment {
                    view,
                    ..degrees(0.0, 0.0)
                },
            )
        };
        let (source, quarter) = (at(1 << 20), at(1200));
        assert!((0.25..0.42).contains(&source), "{source}");
        assert!(quarter < 0.4 * source, "{quarter} of {source}");
    }

    #[test]
    fn an_uncertain_gaze_takes_more() {
        let selector = cube_16k(PolicyConfig::new(Policy::Acuity));
        let sure = degrees(12.0, 7.0);
        let spread = Radians::from_degrees(5.0);
        let unsure = Moment {
            gaze: GazeSample {
                spread,
                ..sure.gaze
            },
            view: None,
            state: EyeState::Steady,
        };
        assert!(share(&selector, &unsure) > share(&selector, &sure));
    }

    #[test]
    fn nothing_finer_than_the_display_shows_is_chosen() {
        let surface = Surface::flat([4096, 2048], Screen::default());
        let grid = TileGrid::new(surface, Cut::Tile(256), 5, 2).unwrap();
        let view = |scale: u32| {
            let size = [4096 / scale, 2048 / scale];
            Moment {
                view: Some(EyeView::filling(&surface, size)),
                ..degrees(3.0, 2.0)
            }
        };
        for policy in [Policy::Acuity, Policy::Viewport] {
            let selector = Selector::new(grid, PolicyConfig::new(policy));
            for (scale, finest) in [(1, 0), (2, 1), (4, 2), (8, 3)] {
                let levels = selector.select(&view(scale)).levels;
                let found = *levels.levels().iter().min().unwrap();
                assert!(found >= finest, "{policy:?} 1/{scale}: {found}");
                assert!(policy == Policy::Acuity || found == finest);
            }
        }
    }

    #[test]
    fn flat_content_in_view_at_its_own_density_is_all_finest() {
        let surface = Surface::flat([1280, 720], Screen::default());
        let grid = TileGrid::new(surface, Cut::Tile(128), 5, 2).unwrap();
        let view = Some(EyeView::filling(&surface, surface.size));
        let selector = Selector::new(grid, PolicyConfig::new(Policy::Viewport));
        let levels = selector
            .select(&Moment {
                view,
                ..degrees(0.0, 0.0)
            })
            .levels;
        assert_eq!(levels, LevelMap::filled(&grid, 0));
    }

    #[test]
    fn bounds_skip_no_cell_that_probing_would_refine() {
        for acuity in [
            AcuityModel::LINEAR,
            AcuityModel::Watson,
            AcuityModel::WatsonPaper,
        ] {
            let config = PolicyConfig {
                acuity,
                ..PolicyConfig::new(Policy::Acuity)
            };
            let grid = TileGrid::new(Surface::cube(1024), Cut::Tile(128), 5, 2).unwrap();
            let selector = Selector::new(grid, config);
            let moment = degrees(33.0, -21.0);
            for bounds in &selector.cells {
                let probed = probes(&grid, bounds.cell)
                    .map(|p| level_of_footprint(&grid, selector.acuity_footprint(&moment.gaze, &p)))
                    .min();
                assert_eq!(Some(selector.acuity_level(bounds, &moment)), probed);
            }
        }
    }

    proptest! {
        #[test]
        fn the_safety_disc_is_always_finest(
            yaw in -180.0..180.0f64, pitch in -89.0..89.0f64, disc in 0.5..6.0f64,
        ) {
            let config = PolicyConfig {
                safety_disc: Radians::from_degrees(disc),
                ..PolicyConfig::new(Policy::Acuity)
            };
            let grid = TileGrid::new(Surface::cube(8192), Cut::Tile(512), 5, 2).unwrap();
            let selector = Selector::new(grid, config);
            let moment = degrees(yaw, pitch);
            let levels = selector.select(&moment).levels;
            for step in 0..24 {
                let direction = crate::view::axes::direction_at(
                    moment.gaze.gaze_in_content,
                    Radians(f64::from(step)),
                    Radians::from_degrees(disc * 0.999),
                );
                let (face, place) = grid.surface.locate(direction).unwrap();
                prop_assert_eq!(levels.level(&grid, grid.cell_at(face, place)), 0);
            }
        }
    }
}
