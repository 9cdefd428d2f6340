//! What lies outside a texture?

use serde::{Deserialize, Serialize};

/// What lies outside a texture along an axis.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
#[serde(rename_all = "lowercase")]
pub enum Wrap {
    /// The same again.
    #[default]
    Repeat,
    /// The same mirrored.
    Mirror,
    /// Its outermost texels.
    Clamp,
}

impl Wrap {
    /// Which texel of `side` lies at a place along the axis, also outside the texture.
    ///
    /// # Panics
    /// There must be a texel.
    #[must_use]
    pub fn texel(self, at: i64, side: u32) -> u32 {
        let side = i64::from(side);
        let inside = match self {
            Self::Repeat => at.rem_euclid(side),
            Self::Clamp => at.clamp(0, side - 1),
            Self::Mirror => {
                let turned = at.rem_euclid(2 * side);
                turned.min(2 * side - 1 - turned)
            }
        };
        inside as u32
    }
}
