//! How coarse may each cell be for one eye behind several views, without asking it for every view?
//!
//! What the eye resolves does not depend on where a view lies, only on how dense its display is: it
//! is found once for all panels of a density, and only where one of them shows a cell.

use crate::content::video::grid::cells::{CellBounds, level_of_footprint};
use crate::content::video::grid::level_map::LevelMap;
use crate::content::video::rules::Rules;
use crate::content::video::rules::known_acuity::{EyeBehind, KnownAcuity, UNKNOWN};
use crate::perception::glance::Glance;
use crate::view::frustum::Frustum;

impl Rules {
    /// What the eye could tell, and the view shows.
    pub(super) fn acuity(
        &self,
        glance: &Glance,
        known: &mut KnownAcuity,
        asked: impl Fn(usize) -> bool,
    ) -> LevelMap {
        let eye = EyeBehind {
            acuity: self.config.acuity,
            gaze: glance.gaze.gaze_in_content,
            spread: glance.gaze.spread,
            ppd: glance.view.map_or(0.0, |view| view.most_ppd().0),
        };
        let is_shared = self.turns(glance) || glance.view.is_none();
        let mut alone = KnownAcuity::default();
        let known = if is_shared { known } else { &mut alone };
        let levels_known = known.levels(eye, self.cells.len());
        let sight = glance.view.as_ref().map(|view| self.sight(view));
        let mut cells = self.cells.iter().enumerate();
        let mut levels = LevelMap::from_cells(&self.grid, |_| match cells.next() {
            Some((rank, bounds)) if asked(rank) => {
                let mut resolved = || {
                    let level = &mut levels_known[rank];
                    if *level == UNKNOWN {
                        *level = self.acuity_level(bounds, glance);
                    }
                    *level
                };
                match &sight {
                    Some(sight) if !glance.is_magnified() => {
                        self.needed_in_sight(bounds, glance, sight, resolved)
                    }
                    _ => resolved(),
                }
            }
            _ => self.grid.coarsest(),
        });
        if let Some(view) = &glance.view {
            self.refine_under(view, &mut levels, |probe| self.allowed_level(glance, probe));
        }
        levels
    }

    /// The coarser of what the eye resolves and the finest that `viewport` would show; of the
    /// latter the safety disc is exempt.
    fn needed_in_sight(
        &self,
        bounds: &CellBounds,
        glance: &Glance,
        sight: &Frustum,
        resolved: impl FnOnce() -> u8,
    ) -> u8 {
        let coarsest = self.grid.coarsest();
        let exempt = match self.config.safety_disc.0 > 0.0 {
            true => {
                let nearest = bounds.least_eccentricity(glance.gaze.gaze_in_content);
                let disc = self.disc_footprint(nearest, bounds.least_ppd());
                level_of_footprint(&self.grid, disc)
            }
            false => coarsest,
        };
        let is_beyond = bounds.is_beyond(sight);
        if is_beyond && exempt == coarsest {
            return coarsest;
        }
        let resolved = resolved();
        match &glance.view {
            Some(view) if !is_beyond && resolved < exempt => {
                let shown = self.shown_level(bounds, view, sight, resolved);
                resolved.max(shown.min(exempt))
            }
            _ => resolved.max(exempt),
        }
    }
}
