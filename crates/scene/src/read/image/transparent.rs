//! Which parts of a file are half transparent, and drawn opaque all the same?

use foveal_core::units::counted;

use super::super::sound::count;
use super::super::text::shortened;
use super::{PictureRows, may_have_alpha};
use crate::source::SourceScene;

/// Rows of a picture that are read together.
const ROWS: u32 = 64;

/// Reports how many materials are half transparent, given their names.
pub(in crate::read) fn tell<'a>(mut names: impl Iterator<Item = &'a str>, scene: &mut SourceScene) {
    let Some(first) = names.next() else { return };
    let times = 1 + names.count();
    count(&mut scene.repairs, "drawn_opaque", times);
    scene.remark(format!(
        "what is half transparent is drawn opaque: {}, the first {:?}",
        counted(times, "material"),
        shortened(first)
    ));
}

/// Whether a picture has a texel that is not opaque; false for a broken one.
pub(in crate::read) fn is_seen_through(picture: &[u8]) -> bool {
    if !may_have_alpha(picture) {
        return false;
    }
    let Some(mut rows) = PictureRows::open(picture) else {
        return false;
    };
    while let Some(texels) = rows.next(ROWS).filter(|it| !it.is_empty()) {
        if texels.iter().any(|[_, _, _, alpha]| *alpha < 255) {
            return true;
        }
    }
    false
}
