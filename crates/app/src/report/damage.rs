//! Which damaged places of a pack are listed?

use foveal_media::pack::pack_file::PackFileError;

/// Most damaged places that are listed.
const MOST_LISTED: usize = 20;

/// The first damaged places, in words.
pub(crate) fn listed(damage: &[PackFileError]) -> Vec<String> {
    let first = damage.iter().take(MOST_LISTED);
    first.map(ToString::to_string).collect()
}
