//! What do selection, sessions and caches know of a piece of content?

use crate::pack::unit::UnitId;
use core::ops::Range;
use serde::{Deserialize, Serialize};

/// Which of the assets of a scene.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct AssetId(pub u16);

impl AssetId {
    /// The asset of a scene that has no other.
    pub const ONLY: Self = Self(0);

    /// A unit of it.
    #[must_use]
    pub const fn unit(self, unit: UnitId) -> UnitRef {
        UnitRef { asset: self, unit }
    }
}

/// A unit of one asset of a scene: what is chosen, fetched, decoded, kept and shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct UnitRef {
    /// The asset.
    pub asset: AssetId,
    /// Its unit.
    pub unit: UnitId,
}

/// What there is to know of a unit before it is fetched.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unit {
    /// Its level, 0 the finest.
    pub level: u8,
    /// Bytes to fetch; `None` until the index page that covers it has been loaded.
    pub bytes: Option<u32>,
    /// What a frame of it shows, in samples: what decoding takes.
    pub samples: u64,
    /// Bytes that a frame of it takes on the GPU.
    pub gpu_bytes: u64,
    /// The frames that it shows; of content without time, frame 0.
    pub frames: Range<u32>,
}
