//! Would a viewer see that a unit is shown in place of coarser ones?

use super::Scene;
use super::demand::acuity_excess;
use super::sight::ViewOfScene;
use crate::content::policy::{Policy, PolicyConfig};
use crate::pack::unit::UnitId;
use crate::perception::acuity::AcuityModel;
use crate::perception::moment::Moment;
use crate::perception::parameters::EyeState;
use crate::units::Radians;

/// Who may see a step at one moment.
#[derive(Debug)]
pub struct VisibleSteps {
    /// What each view shows; none where nothing is seen.
    sights: Vec<ViewOfScene>,
    acuity: AcuityModel,
}

impl VisibleSteps {
    /// A viewer at this moment. In a saccade, right after one and in a blink no step is seen.
    #[must_use]
    pub fn new(moment: &Moment) -> Self {
        let sight = |glance| ViewOfScene::new(&glance, Radians(0.0));
        Self {
            sights: match moment.state {
                EyeState::Steady => moment.glances().map(sight).collect(),
                EyeState::Landed | EyeState::Jumping => Vec::new(),
            },
            acuity: PolicyConfig::new(Policy::Acuity).acuity,
        }
    }

    /// Whether nothing at all is seen.
    #[must_use]
    pub fn is_blind(&self) -> bool {
        self.sights.is_empty()
    }

    /// Whether the error of what a unit is shown in place of is in view, and larger than a pixel
    /// and than what the eye resolves there. Costs a microsecond for each place and view.
    ///
    /// # Panics
    /// There must be such a unit.
    #[must_use]
    pub fn sees(&self, scene: &Scene, unit: UnitId) -> bool {
        let mut seen = self.sights.iter().flat_map(|sight| {
            let stands = scene.stands(unit).iter();
            stands.filter_map(|stand| sight.seen(&stand.sphere, stand.error))
        });
        seen.any(|seen| acuity_excess(&seen, &self.acuity) > 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::demand::Content;
    use crate::content::scene::scripted::scripted_scene;
    use crate::gaze::sample::GazeSample;
    use crate::units::Seconds;
    use crate::view::axes::Axes;
    use crate::view::eye_view::{EyeView, Field};
    use glam::DVec3;

    fn moment(away: f64, state: EyeState) -> Moment {
        let size = [1280, 800];
        let view = EyeView {
            position: DVec3::new(0.0, 0.0, away),
            axes: Axes::FRONT,
            field: Field::across(Radians::from_degrees(60.0), size),
            size,
            eye: Default::default(),
        };
        let gaze = GazeSample::at(Seconds(0.0), Radians(0.0), Radians(0.0));
        Moment {
            state,
            ..Moment::new(gaze, vec![view])
        }
    }

    #[test]
    fn steps_are_seen_near_by_and_not_from_afar_nor_behind_nor_while_the_eye_jumps() {
        let scene = scripted_scene().unwrap();
        let units = || scene.pack().units().skip(scene.base(0).len());
        let seen = |moment: &Moment| {
            let witness = VisibleSteps::new(moment);
            units().filter(|unit| witness.sees(&scene, *unit)).count()
        };
        let bounds = scene.bounds();
        let [near, far] = [1.5, 4000.0].map(|it| bounds.centre.z + it * bounds.radius);
        let here = seen(&moment(near, EyeState::Steady));
        assert!(here > 0, "none of {} steps is seen", units().count());
        for unseen in [
            moment(far, EyeState::Steady),
            moment(-near, EyeState::Steady),
            moment(near, EyeState::Jumping),
            moment(near, EyeState::Landed),
        ] {
            assert_eq!(seen(&unseen), 0, "{unseen:?}");
        }
        assert!(VisibleSteps::new(&moment(near, EyeState::Jumping)).is_blind());
    }
}
