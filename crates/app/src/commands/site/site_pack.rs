//! What does a site ask of a pack, whatever is in it?

use crate::commands::site::poster::{self, Poster};
use crate::report::output;
use foveal_core::view::surface::Projection;
use foveal_media::pack::pack::Pack;
use foveal_render::DrawDevice;
use serde::Serialize;
use std::sync::Arc;

/// The picture that stands for a pack.
pub(super) fn poster_of(pack: &Pack, drawing: &DrawDevice) -> anyhow::Result<Poster> {
    match pack {
        Pack::Video(file) => poster::of_video(Arc::clone(file), drawing),
        Pack::Scene(file) => poster::of_scene(file, drawing),
    }
}

/// What to say where a pack is larger than what it was made from, and gains little by that: flat
/// video.
pub(super) fn growth(pack: &Pack) -> Option<String> {
    let file = pack.video()?;
    let source = file.pack().description().source.bytes;
    let is_flat = file.pack().grid().surface.projection == Projection::Flat;
    (is_flat && source > 0 && file.bytes() > source).then(|| {
        format!(
            "warning: {}: {}, and its source {}; flat video on an ordinary link mostly costs more \
             bytes as a pack (docs/concepts/policies.md says what gains)",
            file.path().display(),
            output::size(file.bytes()),
            output::size(source)
        )
    })
}

/// What a pack of a list is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum ListedKind {
    Picture,
    Video,
    Scene,
}

impl ListedKind {
    pub(super) fn of(pack: &Pack) -> Self {
        match pack.video() {
            Some(file) if file.pack().description().is_still() => Self::Picture,
            Some(_) => Self::Video,
            None => Self::Scene,
        }
    }
}
