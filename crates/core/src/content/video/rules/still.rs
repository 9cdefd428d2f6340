//! Does the eye stay where it looked, whatever the head does?
//!
//! An eye that stays on one place of the world while the head nods sees the same detail there. What
//! was chosen for it stays then, and is chosen beforehand for what the head may turn to.

use crate::content::video::grid::tile_grid::TileGrid;
use crate::perception::glance::Glance;
use crate::units::Radians;
use crate::view::axes::angle_between;
use crate::view::eye_view::EyeView;
use glam::DVec3;

/// How far the head may turn under a steady eye before levels are chosen for where it points, in
/// degrees: the eye turns about as far in the head before the head follows it.
const HEAD_ROOM_DEG: f64 = 30.0;

/// The same as an angle.
pub(super) fn head_room() -> Radians {
    Radians::from_degrees(HEAD_ROOM_DEG)
}

/// Whether the picture turns with a head inside the content.
pub(super) fn turns_with_head(grid: &TileGrid, glance: &Glance) -> bool {
    grid.surface.projection.surrounds() && !glance.is_magnified()
}

/// Whether the gaze stays within `slack` of where it was, as surely known and through the same
/// view, which may turn with the head by up to the head room; without slack it may not.
pub(super) fn stays(grid: &TileGrid, was: &Glance, is: &Glance, slack: Radians) -> bool {
    let [from, to] = [was, is].map(|glance| glance.gaze.gaze_in_content);
    let spreads = (was.gaze.spread.0 - is.gaze.spread.0).abs();
    let may_turn = slack.0 > 0.0 && turns_with_head(grid, was);
    let views_agree = match may_turn {
        true => is_turned_view(was, is, head_room()),
        false => was.view == is.view,
    };
    views_agree && spreads <= slack.0 && angle_between(from, to) <= slack
}

/// Whether both are through the same view, turned by at most an angle.
pub(super) fn is_turned_view(was: &Glance, is: &Glance, most: Radians) -> bool {
    let within = |a: DVec3, b: DVec3| angle_between(a, b) <= most;
    match (&was.view, &is.view) {
        (Some(was), Some(is)) => {
            let turned = EyeView {
                axes: is.axes,
                ..*was
            };
            turned == *is
                && within(was.axes.forward, is.axes.forward)
                && within(was.axes.right, is.axes.right)
        }
        (was, is) => was == is,
    }
}
