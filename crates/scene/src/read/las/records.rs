//! What is kept of the record of a point?

use super::header::{Layout, half_at, word_at};
use crate::source::SourceCloud;

/// Takes out of records what is kept of a point.
pub(super) struct Records {
    layout: Layout,
    pub(super) has_waves: bool,
    pub(super) cloud: SourceCloud,
}

impl Records {
    pub(super) fn new(layout: Layout) -> Self {
        Self {
            layout,
            has_waves: layout.has_waves,
            cloud: SourceCloud::default(),
        }
    }

    /// Number of points so far.
    pub(super) fn len(&self) -> usize {
        self.cloud.places.len()
    }

    /// Places of the points so far, in steps of the header's scale.
    pub(super) fn places(&self) -> &[[i32; 3]] {
        &self.cloud.places
    }

    /// Forgets all points but the first so many.
    pub(super) fn truncate(&mut self, points: usize) {
        let cloud = &mut self.cloud;
        cloud.places.truncate(points);
        cloud.intensities.truncate(points);
        cloud.classes.truncate(points);
        cloud.colours.truncate(points);
    }

    /// Adds a record, which is as long as its layout.
    pub(super) fn add(&mut self, record: &[u8]) {
        let cloud = &mut self.cloud;
        cloud
            .places
            .push([0, 4, 8].map(|at| word_at(record, at) as i32));
        cloud.intensities.push(half_at(record, 12));
        cloud.classes.push(self.layout.class_of(record));
        if let Some(at) = self.layout.colour {
            let colour = [at, at + 2, at + 4].map(|at| half_at(record, at));
            cloud.colours.push(colour);
        }
    }
}
