//! What is known of a viewer at one display time?

use crate::gaze::sample::{GazeSample, HeadPose};
use crate::perception::glance::Glance;
use crate::perception::parameters::EyeState;
use crate::units::Seconds;
use crate::view::eye_view::EyeView;

/// Where a viewer looks at one display time, and through what: a window, the two eyes of a headset,
/// the panels of a display. Levels are chosen over all views together: nothing is coarser than any
/// one of them asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Where the eye looks when the picture is shown, in the space of the content.
    pub gaze: GazeSample,
    /// Where the head is turned to.
    pub head: HeadPose,
    /// What the eye does, as far as the worth of a step depends on it.
    pub state: EyeState,
    /// What shows the content. Without any, all of it is in view, and nothing is cut to a display's
    /// density.
    pub views: Vec<EyeView>,
    /// How far the picture is behind the sound, where there is sound.
    pub behind_sound: Option<Seconds>,
}

impl Moment {
    /// A moment of a steady eye, whose head is not known.
    #[must_use]
    pub fn new(gaze: GazeSample, views: Vec<EyeView>) -> Self {
        Self {
            gaze,
            head: HeadPose::default(),
            state: EyeState::default(),
            views,
            behind_sound: None,
        }
    }

    /// The same through each view; through none where there is no view.
    pub fn glances(&self) -> impl Iterator<Item = Glance> + '_ {
        let none = self.views.is_empty().then_some(None);
        let views = self.views.iter().copied().map(Some).chain(none);
        views.map(|view| Glance {
            gaze: self.gaze,
            view,
            state: self.state,
        })
    }
}
