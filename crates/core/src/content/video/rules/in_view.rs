//! How coarse may a cell be for what a picture shows of it?
//!
//! The answer is that of all its probes. Most cells need not be probed: they are out of sight, or
//! one probe needs the finest level that any place of the cell could.

use crate::content::video::grid::cells::{CellBounds, Probe, level_of_footprint, probes};
use crate::content::video::grid::level_map::LevelMap;
use crate::content::video::rules::Rules;
use crate::perception::glance::Glance;
use crate::units::{Ppd, Radians};
use crate::view::axes::angle_between;
use crate::view::eye_view::EyeView;
use crate::view::frustum::Frustum;

impl Rules {
    /// What is in view at the density of the display.
    pub(super) fn viewport(&self, glance: &Glance) -> LevelMap {
        let Some(view) = &glance.view else {
            panic!("the viewport policy chooses by what is in view");
        };
        let sight = self.sight(view);
        let mut cells = self.cells.iter();
        let mut levels = LevelMap::from_cells(&self.grid, |_| {
            let level = |bounds| self.shown_level(bounds, view, &sight, 0);
            cells.next().map_or(self.grid.coarsest(), level)
        });
        self.refine_under(view, &mut levels, |probe| self.level_shown(view, probe));
        levels
    }

    /// What is in view or so near that a coarse cell there would be seen fading into it.
    pub(super) fn sight(&self, view: &EyeView) -> Frustum {
        Frustum::new(view, Radians(self.config.margin.0.max(self.grid.fade().0)))
    }

    /// What a head that turns under a steady eye brings there as well, where the view turns with
    /// it and room is kept for that.
    pub(super) fn sight_around(&self, glance: &Glance) -> Option<Frustum> {
        let view = glance.view.as_ref().filter(|_| self.turns(glance))?;
        let margin = self.grid.fade().0 + self.head_room.0;
        (self.head_room.0 > 0.0).then(|| {
            let margin = margin.max(self.config.margin.0);
            Frustum::new(view, Radians(margin))
        })
    }

    pub(super) fn level_shown(&self, view: &EyeView, probe: &Probe) -> u8 {
        level_of_footprint(&self.grid, view.footprint(probe.ppd, probe.direction))
    }

    /// The level at which the display shows no more of a cell; any level up to `enough` where that
    /// is as fine.
    pub(super) fn shown_level(
        &self,
        bounds: &CellBounds,
        view: &EyeView,
        sight: &Frustum,
        enough: u8,
    ) -> u8 {
        if bounds.is_beyond(sight) {
            return self.grid.coarsest();
        }
        let corners = bounds.corners();
        let least = match self.grid.surface.is_of_planes() {
            true => least_footprint(view, corners),
            false => least_footprint_round(view, bounds),
        };
        let floor = level_of_footprint(&self.grid, least);
        let stop = floor.max(enough);
        let finest = |probes: &mut dyn Iterator<Item = Probe>| {
            let mut finest = None;
            for probe in probes.filter(|probe| sight.reaches(probe.direction)) {
                let level = self.level_shown(view, &probe);
                finest = Some(finest.map_or(level, |finest: u8| finest.min(level)));
                if level <= stop {
                    break;
                }
            }
            finest
        };
        match finest(&mut corners.iter().copied()) {
            Some(level) if level <= stop => level,
            _ => finest(&mut probes(&self.grid, bounds.cell)).unwrap_or(self.grid.coarsest()),
        }
    }

    /// The level of a cell in a window: bounds on the sphere say nothing of angles at the eye, but
    /// what is not in view, or nearly, is not seen at all.
    pub(super) fn magnified_level(&self, bounds: &CellBounds, glance: &Glance) -> u8 {
        let Some(view) = &glance.view else {
            return self.grid.coarsest();
        };
        let sight = self.sight(view);
        if bounds.is_beyond(&sight) {
            return self.grid.coarsest();
        }
        let floor = match self.grid.surface.is_of_planes() {
            true => self.magnified_floor(bounds, view, glance),
            false => 0,
        };
        if floor == self.grid.coarsest() {
            return floor;
        }
        let nearest = bounds.nearest_probe(&self.grid, glance.gaze.gaze_in_content);
        if sight.reaches(nearest.direction) && self.allowed_level(glance, &nearest) == floor {
            return floor;
        }
        probes(&self.grid, bounds.cell)
            .filter(|probe| sight.reaches(probe.direction))
            .map(|probe| self.allowed_level(glance, &probe))
            .min()
            .unwrap_or(self.grid.coarsest())
    }

    /// No place of a cell is allowed a finer level than this in a window.
    ///
    /// On planes, as faces and pictures are, a cell lies within its corners, and so do the angles
    /// at which it appears.
    fn magnified_floor(&self, bounds: &CellBounds, view: &EyeView, glance: &Glance) -> u8 {
        let corners = bounds.corners();
        let Some(gaze) = view.seen_direction(glance.gaze.gaze_in_content) else {
            return self.grid.coarsest();
        };
        let Some(centre) = view.seen_direction(bounds.centre()) else {
            return 0;
        };
        let mut radius = Radians(0.0);
        for corner in corners {
            match view.seen_direction(corner.direction) {
                Some(seen) => radius = Radians(radius.0.max(angle_between(centre, seen).0)),
                None => return 0,
            }
        }
        let nearest = Radians((angle_between(gaze, centre).0 - radius.0 - ROUNDING).max(0.0));
        let shown = least_footprint(view, corners);
        let ppd = shown * view.as_seen().least_ppd().0;
        let beyond = self.beyond_disc(nearest, &glance.gaze);
        let footprint = shown.max(ppd / (2.0 * self.config.acuity.best_acuity(beyond).0));
        let disc = self.disc_footprint(nearest, Ppd(ppd));
        level_of_footprint(&self.grid, footprint.min(disc) * (1.0 - ROUNDING))
    }
}

/// What bounds and probes of the same place may differ by.
const ROUNDING: f64 = 1e-7;

/// No place between these has fewer level-0 pixels under a pixel of the display.
///
/// Densities of a face and of a picture are those of two planes, whose ratio is linear along the
/// face: least at a corner. Outside the picture its density counts as at its border, and is less.
fn least_footprint(view: &EyeView, corners: &[Probe; 4]) -> f64 {
    let on_plane = |probe: &Probe| {
        let depth = probe.direction.dot(view.axes.forward);
        probe.ppd.0 * depth / view.least_ppd().0
    };
    corners.iter().map(on_plane).fold(f64::MAX, f64::min)
}

/// The same of a cell of the sphere, by its least density and what of it is farthest from ahead.
fn least_footprint_round(view: &EyeView, bounds: &CellBounds) -> f64 {
    let depth = libm::cos(bounds.most_eccentricity(view.axes.forward).0);
    bounds.least_ppd().0 * depth / view.least_ppd().0
}
