//! Which parts of the view would units refine, measured while something else goes on?

use crate::error::RenderError;
use crate::scene::footprints::FootprintsBack;
use foveal_core::perception::footprints::{Footprint, Footprints};
use foveal_core::perception::moment::Moment;
use foveal_core::units::Radians;
use foveal_core::view::axes::angle_between;
use foveal_core::view::eye_view::EyeView;
use glam::DVec3;
use std::future::Future;
use std::pin::Pin;
use std::task::{Context, Poll, Waker};

/// A gaze that moved less is measured for already: an eccentricity is recorded less finely.
const STILL: Radians = Radians(core::f64::consts::PI / 180.0 / 8.0);

type Coming = Pin<Box<dyn Future<Output = Result<Vec<Footprint>, RenderError>>>>;

/// One measurement after the other.
#[derive(Default)]
pub(crate) struct Measuring {
    /// The views that are under way.
    coming: Vec<Coming>,
    /// What came of the others.
    found: Vec<Footprint>,
    /// What was measured last, or is under way: through these views, with this gaze.
    of: Option<(Vec<EyeView>, DVec3)>,
}

impl Measuring {
    /// What was measured is no longer what is drawn.
    pub(crate) fn forget(&mut self) {
        self.of = None;
    }

    /// Whether something is under way.
    pub(crate) fn is_under_way(&self) -> bool {
        !self.coming.is_empty()
    }

    /// Whether a moment is to be measured that was not.
    pub(crate) fn is_due(&self, moment: &Moment) -> bool {
        let is_measured = self.of.as_ref().is_some_and(|(views, gaze)| {
            let moved = angle_between(*gaze, moment.gaze.gaze_in_content);
            *views == moment.views && moved.0 <= STILL.0
        });
        !is_measured && !self.is_under_way()
    }

    /// Begins to measure a moment, of which this was found and this is on its way.
    pub(crate) fn begin(
        &mut self,
        moment: &Moment,
        found: Vec<Footprint>,
        coming: Vec<FootprintsBack>,
    ) {
        self.of = Some((moment.views.clone(), moment.gaze.gaze_in_content));
        self.found = found;
        let boxed = |back: FootprintsBack| Box::pin(back.list()) as Coming;
        self.coming = coming.into_iter().map(boxed).collect();
    }

    /// What was measured, once all of it is there; the device must have been polled.
    ///
    /// # Errors
    /// The device was lost on the way.
    pub(crate) fn finish(&mut self) -> Result<Option<Footprints>, RenderError> {
        let mut context = Context::from_waker(Waker::noop());
        while let Some(coming) = self.coming.last_mut() {
            match coming.as_mut().poll(&mut context) {
                Poll::Pending => return Ok(None),
                Poll::Ready(found) => {
                    self.coming.pop();
                    self.found.extend(found?);
                }
            }
        }
        Ok(Some(Footprints::new(std::mem::take(&mut self.found))))
    }
}
