//! Which damaged places of a pack are listed?

use foveal_media::pack::damage::Damage;

/// The first damaged places, in words.
pub(crate) fn listed(damage: &Damage) -> Vec<String> {
    damage.first().iter().map(ToString::to_string).collect()
}
