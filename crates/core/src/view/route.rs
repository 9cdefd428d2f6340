//! Where does the eye of a viewer stand who follows a route?

use super::axes::Axes;
use super::eye_view::{EyeView, Field};
use crate::units::{Radians, Seconds};
use core::f64::consts::TAU;
use glam::DVec3;

/// Share of the view's height, or of its width where that is less, that the whole scene fills.
const FILLED: f64 = 0.8;
/// How long an orbit takes.
const ORBIT_S: f64 = 12.0;

/// Where an eye stands, and which way the head is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyePose {
    /// Its place, in metres.
    pub position: DVec3,
    /// The head.
    pub axes: Axes,
}

/// A place on a route that was recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// When it is reached.
    pub time: Seconds,
    /// The place, in metres.
    pub position: DVec3,
    /// To the right, up and clockwise, in radians.
    pub turn: [Radians; 3],
}

/// How a viewer moves through a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Route {
    /// Stands on the +z side, upright, and looks along -z at the middle of the scene, which fills
    /// 80 % of the view's height, or of its width where that is less.
    Still,
    /// Goes round the vertical axis through the middle, as far from it, once in 12 s, and looks at
    /// it.
    Orbit,
    /// Recorded: straight from one place to the next, times growing; at least one.
    Along(Vec<Waypoint>),
}

impl Route {
    /// Where the eye is at a time, in a scene that a sphere round `centre` encloses.
    #[must_use]
    pub fn pose(&self, time: Seconds, (centre, radius): (DVec3, f64), field: &Field) -> EyePose {
        let distance = whole_from(radius, field);
        let turned = |turn: f64| EyePose {
            position: centre + distance * DVec3::new(libm::sin(turn), 0.0, libm::cos(turn)),
            axes: Axes::from_yaw_pitch_roll(Radians(-turn), Radians(0.0), Radians(0.0)),
        };
        match self {
            Self::Still => EyePose::before((centre, radius), Radians(0.0), field),
            Self::Orbit => turned(TAU * time.0 / ORBIT_S),
            Self::Along(waypoints) => along(waypoints, time),
        }
    }
}

impl Route {
    /// How long it takes; `None` of one that goes nowhere.
    #[must_use]
    pub fn length(&self) -> Option<Seconds> {
        match self {
            Self::Still => None,
            Self::Orbit => Some(Seconds(ORBIT_S)),
            Self::Along(waypoints) => waypoints.last().map(|it| it.time),
        }
    }
}

/// From how far a sphere fills what it should of a view.
fn whole_from(radius: f64, field: &Field) -> f64 {
    let sides = [field.up, field.down, field.left, field.right];
    let least = sides.into_iter().fold(f64::INFINITY, f64::min).max(1e-6);
    radius.max(1e-9) / libm::sin(libm::atan(FILLED * least))
}

impl EyePose {
    /// Before a scene that a sphere encloses, on its +z side, raised by an angle about its middle
    /// and looking there.
    #[must_use]
    pub fn before((centre, radius): (DVec3, f64), rise: Radians, field: &Field) -> Self {
        let distance = whole_from(radius, field);
        let towards = DVec3::new(0.0, libm::sin(rise.0), libm::cos(rise.0));
        Self {
            position: centre + distance * towards,
            axes: Axes::from_yaw_pitch_roll(Radians(0.0), Radians(-rise.0), Radians(0.0)),
        }
    }

    /// A view from here.
    #[must_use]
    pub fn view(&self, view: &EyeView) -> EyeView {
        EyeView {
            position: self.position,
            axes: self.axes,
            ..*view
        }
    }

    /// A direction of a head that is not turned, as `--gaze` gives it, in the world.
    #[must_use]
    pub fn world_from_head(&self, direction: DVec3) -> DVec3 {
        let Axes {
            forward,
            right,
            down,
        } = self.axes;
        right * direction.x - down * direction.y - forward * direction.z
    }
}

fn along(waypoints: &[Waypoint], time: Seconds) -> EyePose {
    let next = waypoints.partition_point(|it| it.time.0 <= time.0);
    let at = |number: usize| waypoints[number.min(waypoints.len() - 1)];
    let (from, to) = (at(next.saturating_sub(1)), at(next));
    let length = to.time.0 - from.time.0;
    let share = if length > 0.0 {
        ((time.0 - from.time.0) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let turn = [0, 1, 2].map(|k| {
        // The short way round.
        let apart = libm::remainder(to.turn[k].0 - from.turn[k].0, TAU);
        Radians(from.turn[k].0 + share * apart)
    });
    let [yaw, pitch, roll] = turn;
    EyePose {
        position: from.position.lerp(to.position, share),
        axes: Axes::from_yaw_pitch_roll(yaw, pitch, roll),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: (DVec3, f64) = (DVec3::new(1.0, 2.0, 3.0), 0.5);

    fn field() -> Field {
        Field::symmetric([1.2, 0.75])
    }

    #[test]
    fn who_stands_still_sees_the_scene_fill_four_fifths_of_the_height() {
        let pose = Route::Still.pose(Seconds(7.0), SCENE, &field());
        let distance = pose.position.z - 3.0;
        assert_eq!([pose.position.x, pose.position.y], [1.0, 2.0]);
        assert_eq!(pose.axes, Axes::FRONT);
        let half = libm::tan(libm::asin(0.5 / distance));
        assert!((half - 0.8 * 0.75).abs() < 1e-12);
    }

    #[test]
    fn an_orbit_looks_at_the_middle_from_the_same_distance_and_ends_where_it_began() {
        let at = |time| Route::Orbit.pose(Seconds(time), SCENE, &field());
        let still = Route::Still.pose(Seconds(0.0), SCENE, &field());
        for step in 0..24 {
            let pose = at(f64::from(step) / 2.0);
            let towards = SCENE.0 - pose.position;
            assert!((towards.normalize() - pose.axes.forward).length() < 1e-12);
            let apart = towards.length() - (still.position.z - 3.0);
            assert!(apart.abs() < 1e-12 && pose.position.y == 2.0);
        }
        for time in [0.0, 12.0] {
            assert!((at(time).position - still.position).length() < 1e-9);
        }
        let ahead = at(3.0).world_from_head(DVec3::NEG_Z);
        assert!((ahead - at(3.0).axes.forward).length() < 1e-12);
    }

    #[test]
    fn a_recorded_route_is_straight_from_place_to_place_and_turns_the_short_way() {
        let waypoint = |time, x, yaw: f64| Waypoint {
            time: Seconds(time),
            position: DVec3::new(x, 0.0, 0.0),
            turn: [Radians::from_degrees(yaw), Radians(0.0), Radians(0.0)],
        };
        let route = Route::Along(vec![waypoint(1.0, 0.0, 170.0), waypoint(3.0, 4.0, -170.0)]);
        let at = |time| route.pose(Seconds(time), SCENE, &field());
        assert_eq!(at(0.0), at(1.0));
        assert_eq!(at(9.0), at(3.0));
        assert_eq!(at(2.0).position.x, 2.0);
        assert!(
            at(2.0).axes.forward.z > 0.999,
            "yaw is 180 degrees half way"
        );
    }
}
