//! Does the eye stay where it looked, whatever the head does?
//!
//! An eye that stays on one place of the world while the head nods sees the same detail there. What
//! was chosen for it stays then, and is chosen beforehand for what the head is about to turn to.

use crate::content::video::grid::tile_grid::TileGrid;
use crate::perception::glance::Glance;
use crate::units::Radians;
use crate::view::axes::angle_between;
use crate::view::eye_view::EyeView;

/// How far the head may turn under a steady eye before levels are chosen for where it points, in
/// degrees: the eye turns about as far in the head before the head follows it.
const MOST_TURNED_DEG: f64 = 30.0;
/// Room that is kept around the view for a head that turns grows in steps of so many degrees, as
/// far as the head turns. The first is the margin of `viewport`.
const ROOM_STEP_DEG: f64 = 10.0;
/// Room beyond where the head is, in degrees: what a head that turns by 60° a second reaches before
/// the next frame but one.
const LEAD_DEG: f64 = 2.0;

/// How much room around the view from which levels were chosen serves a head that has turned to
/// another; none where the picture does not turn with the head.
pub(super) fn head_room(grid: &TileGrid, was: &Glance, is: &Glance) -> Radians {
    if !turns_with_head(grid, was) {
        return Radians(0.0);
    }
    let turned = match (&was.view, &is.view) {
        (Some(was), Some(is)) => turn_between(was, is).to_degrees(),
        _ => 0.0,
    };
    let steps = libm::ceil(turned / ROOM_STEP_DEG).max(1.0);
    Radians::from_degrees(steps * ROOM_STEP_DEG + LEAD_DEG)
}

/// Whether the picture turns with a head inside the content.
pub(super) fn turns_with_head(grid: &TileGrid, glance: &Glance) -> bool {
    grid.surface.projection.surrounds() && !glance.is_magnified()
}

/// Whether the gaze stays within `slack` of where it was, as surely known and through the same
/// view, which may turn with the head by up to the head room; without slack it may not.
pub(super) fn stays(grid: &TileGrid, was: &Glance, is: &Glance, slack: Radians) -> bool {
    stays_within(
        grid,
        (was, is),
        slack,
        Radians::from_degrees(MOST_TURNED_DEG),
    )
}

/// The same however far the head turns. Levels are then chosen for where it points, and those
/// chosen for the gaze before are kept as well.
pub(super) fn gaze_stays(grid: &TileGrid, was: &Glance, is: &Glance, slack: Radians) -> bool {
    stays_within(grid, (was, is), slack, Radians(core::f64::consts::PI))
}

fn stays_within(
    grid: &TileGrid,
    (was, is): (&Glance, &Glance),
    slack: Radians,
    most_turned: Radians,
) -> bool {
    let [from, to] = [was, is].map(|glance| glance.gaze.gaze_in_content);
    let spreads = (was.gaze.spread.0 - is.gaze.spread.0).abs();
    let may_turn = slack.0 > 0.0 && turns_with_head(grid, was);
    let views_agree = match may_turn {
        true => is_turned_view(was, is, most_turned),
        false => was.view == is.view,
    };
    views_agree && spreads <= slack.0 && angle_between(from, to) <= slack
}

/// Whether both are through the same view, turned by at most an angle.
pub(super) fn is_turned_view(was: &Glance, is: &Glance, most: Radians) -> bool {
    match (&was.view, &is.view) {
        (Some(was), Some(is)) => {
            let turned = EyeView {
                axes: is.axes,
                ..*was
            };
            turned == *is && turn_between(was, is) <= most
        }
        (was, is) => was == is,
    }
}

/// By how much the axes of two views differ: the more of ahead and to the right.
fn turn_between(was: &EyeView, is: &EyeView) -> Radians {
    let ahead = angle_between(was.axes.forward, is.axes.forward);
    let right = angle_between(was.axes.right, is.axes.right);
    Radians(ahead.0.max(right.0))
}
