//! Which codec are a pack's tiles coded with?

use serde::{Deserialize, Serialize};

/// Codec of the tiles of a pack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Codec {
    /// VP9 in closed groups: the default.
    Vp9,
    /// Baseline JPEG, one picture a frame, full range.
    Jpeg,
    /// PNG, one picture a frame, lossless: the three planes stacked in one grey picture
    /// (`docs/formats/pack.md`).
    Png,
}

impl Codec {
    /// Whether every frame can be decoded by itself.
    #[must_use]
    pub fn is_intra(self) -> bool {
        matches!(self, Codec::Jpeg | Codec::Png)
    }

    /// The name that the command line and the pack use.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Codec::Vp9 => "vp9",
            Codec::Jpeg => "jpeg",
            Codec::Png => "png",
        }
    }
}
