//! Where does a panel look that turns with the head?

use crate::view::axes::Axes;
use crate::view::eye_view::{EyeView, Field};
use crate::view::head_pose::HeadPose;
use crate::view::panel::rig::Panel;
use crate::view::surface::Eye;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A panel before a head, as far as it matters to what is chosen and drawn: a view.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MountedPanel {
    /// What it is called.
    pub id: String,
    /// Whose picture it shows.
    #[serde(default, skip_serializing_if = "is_left")]
    pub eye: Eye,
    /// Where the eye is in the head, in metres.
    #[serde(default, skip_serializing_if = "is_origin")]
    pub position: [f64; 3],
    /// Direction of growing columns in the head's space (x right, y up, -z forward).
    pub right: [f64; 3],
    /// Direction of growing rows.
    pub down: [f64; 3],
    /// Where it looks.
    pub forward: [f64; 3],
    /// Its field of view.
    pub field: Field,
    /// Its pixels.
    pub size: [u32; 2],
}

impl MountedPanel {
    /// A view from a head that looks ahead.
    #[must_use]
    pub fn new(id: &str, view: &EyeView) -> Self {
        let Axes {
            right,
            down,
            forward,
        } = view.axes;
        Self {
            id: id.to_owned(),
            eye: view.eye,
            position: view.position.to_array(),
            right: right.to_array(),
            down: down.to_array(),
            forward: forward.to_array(),
            field: view.field,
            size: view.size,
        }
    }

    /// What a panel can show, through its optics.
    #[must_use]
    pub fn of(panel: &Panel) -> Self {
        Self::new(&panel.id, &panel.reach())
    }

    /// The same seen as from the middle of the head, for pictures on a surface around it.
    #[must_use]
    pub fn centred(self) -> Self {
        Self {
            position: [0.0; 3],
            ..self
        }
    }

    /// Its view where the head is turned to; the eye is where it is in the head.
    #[must_use]
    pub fn turned(&self, head: &HeadPose) -> EyeView {
        let axes = head.axes();
        let turned = |[x, y, z]: [f64; 3]| axes.right * x - axes.down * y - axes.forward * z;
        EyeView {
            position: turned(self.position),
            axes: Axes {
                right: turned(self.right),
                down: turned(self.down),
                forward: turned(self.forward),
            },
            field: self.field,
            size: self.size,
            eye: self.eye,
        }
    }

    /// The views of panels on one head, of which the first has its eye at `first`.
    #[must_use]
    pub fn views(panels: &[Self], head: &HeadPose, first: DVec3) -> Vec<EyeView> {
        let mut views: Vec<EyeView> = panels.iter().map(|it| it.turned(head)).collect();
        let own = views.first().map_or(DVec3::ZERO, |view| view.position);
        for view in &mut views {
            view.position = first + (view.position - own);
        }
        views
    }

    /// The views of panels on a head at this place.
    #[must_use]
    pub fn views_from(panels: &[Self], head: &HeadPose, at: DVec3) -> Vec<EyeView> {
        let own = panels.first().map(|first| first.turned(head).position);
        Self::views(panels, head, at + own.unwrap_or_default())
    }

    /// Its axes in the head's space.
    fn axes(&self) -> Axes {
        Axes {
            right: DVec3::from_array(self.right),
            down: DVec3::from_array(self.down),
            forward: DVec3::from_array(self.forward),
        }
    }

    /// What of it nothing could be seen through, if anything.
    #[must_use]
    pub fn fault(&self) -> Option<&'static str> {
        let is_placed = self.position.iter().all(|it| it.is_finite());
        match () {
            () if !self.field.is_open() => Some("field: expected tangents between 1e-6 and 1e6"),
            () if self.size.contains(&0) => Some("size: expected at least one pixel"),
            () if !self.axes().are_square() => {
                Some("right, down, forward: expected three unit vectors at right angles")
            }
            () if !is_placed => Some("position: expected three numbers"),
            () => None,
        }
    }
}

fn is_left(eye: &Eye) -> bool {
    *eye == Eye::Left
}

fn is_origin(position: &[f64; 3]) -> bool {
    *position == [0.0; 3]
}
