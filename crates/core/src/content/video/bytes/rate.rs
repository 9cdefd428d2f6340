//! What decided how many bytes a tile's pictures take?

use serde::{Deserialize, Serialize};

/// Which scale a pack's `quality` is on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum QualityScale {
    /// The codec's own quantiser, lower is finer.
    #[default]
    Quantiser,
    /// The Independent JPEG Group's quality, 1 to 100, higher is finer.
    Ijg,
}

impl QualityScale {
    /// Whether this is what a pack that does not say has.
    #[must_use]
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}
