//! What are all figures of?

use foveal_core::view::panel::fit::SourceFit;
use foveal_core::view::panel::pixel_map::PixelMap;
use foveal_core::view::panel::rig::Panel;

/// Panels and the source that was placed before them.
#[derive(Clone, Copy)]
pub(super) struct DrawnRig<'a> {
    pub(super) panels: &'a [&'a Panel],
    pub(super) found: &'a SourceFit,
}

impl<'a> DrawnRig<'a> {
    /// The view of the source that a panel has.
    pub(super) fn map_of(&self, panel: &'a Panel) -> PixelMap<'a> {
        PixelMap {
            panel,
            placement: &self.found.placement,
            size: self.found.size,
        }
    }
}
