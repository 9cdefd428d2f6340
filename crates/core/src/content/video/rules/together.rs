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
    /// What the eye could notice, and the view shows.
    pub(super) fn acuity(
        &self,
        glance: &Glance,
        known: &mut KnownAcuity,
        asked: impl Fn(usize) -> bool,
    ) -> LevelMap {
        let eye = EyeBehind {
            acuity: self.config.acuity.clone(),
            gaze: glance.gaze.gaze_in_content,
            spread: glance.gaze.spread,
            ppd: glance.view.map_or(0.0, |view| view.most_ppd().0),
        };
        let is_shared = self.turns(glance) || glance.view.is_none();
        let mut alone = KnownAcuity::default();
        let known = if is_shared { known } else { &mut alone };
        let levels_known = known.levels(eye, self.cells.len());
        let sight = glance.view.as_ref().map(|view| self.sight(view));
        let around = self.sight_around(glance);
        let mut level = |(rank, bounds): (usize, &CellBounds)| {
            let coarsest = self.grid.coarsest();
            if !asked(rank) || levels_known[rank] == coarsest {
                return coarsest;
            }
            let mut resolved = || {
                let level = &mut levels_known[rank];
                if *level == UNKNOWN {
                    *level = self.acuity_level(bounds, glance);
                }
                *level
            };
            match &sight {
                Some(sight) if !glance.is_magnified() => {
                    let sights = (sight, around.as_ref());
                    self.needed_in_sight(bounds, glance, sights, resolved)
                }
                _ => resolved(),
            }
        };
        let columns = self.grid.cells()[0] as usize;
        let mut levels = Vec::with_capacity(self.cells.len());
        for row in self.cells.chunks(columns) {
            let first = levels.len();
            let sight = around.as_ref().or(sight.as_ref());
            let sight = sight.filter(|_| !glance.is_magnified());
            match sight.is_some_and(|sight| self.is_row_beyond(row, sight)) {
                true => levels.resize(first + row.len(), self.grid.coarsest()),
                false => levels.extend((first..).zip(row).map(&mut level)),
            }
        }
        let mut levels = LevelMap::by_rank(levels);
        if let Some(view) = &glance.view {
            self.refine_under(view, &mut levels, |probe| self.allowed_level(glance, probe));
        }
        levels
    }

    /// Whether no part of a row of cells of one face is in sight, and none of it is exempt;
    /// false where that is not sure, as of a row that goes all around.
    fn is_row_beyond(&self, row: &[CellBounds], sight: &Frustum) -> bool {
        if !self.grid.surface.is_of_planes() {
            return false;
        }
        let (Some(first), Some(last)) = (row.first(), row.last()) else {
            return true;
        };
        let [upper_left, _, lower_left, _] = first.corners();
        let [_, upper_right, _, lower_right] = last.corners();
        let corners = [upper_left, upper_right, lower_left, lower_right];
        let corners = corners.map(|corner| corner.direction);
        self.config.safety_disc.0 <= 0.0 && sight.is_missed_between(corners)
    }

    /// The coarser of what the eye resolves and the finest that `viewport` would show; of the
    /// latter the safety disc is exempt. What only a turning head brings into sight, at the border
    /// of the view, is a level coarser than the eye resolves.
    fn needed_in_sight(
        &self,
        bounds: &CellBounds,
        glance: &Glance,
        (sight, around): (&Frustum, Option<&Frustum>),
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
        let may_come = is_beyond && around.is_some_and(|around| !bounds.is_beyond(around));
        if is_beyond && exempt == coarsest && !may_come {
            return coarsest;
        }
        let resolved = resolved();
        if may_come {
            return resolved.max(exempt.min(resolved + 1)).min(coarsest);
        }
        match &glance.view {
            Some(view) if !is_beyond && resolved < exempt => {
                let middle = bounds.middle();
                if self.level_shown(view, middle) <= resolved && sight.reaches(middle.direction) {
                    return resolved;
                }
                let shown = self.shown_level(bounds, view, sight, resolved);
                resolved.max(shown.min(exempt))
            }
            _ => resolved.max(exempt),
        }
    }
}
