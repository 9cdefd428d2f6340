//! What is the smallest thing that can be sent?

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// One refinement step of any kind of content: its number is its place in the pack's index, so the
/// bytes of a unit are found in constant time.
///
/// For video a unit is a tile at a level over one group of pictures; having it lets the client
/// show that region at that level for those frames. Units of coarser levels come first.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct UnitId(pub u32);

/// SHA-256 of bytes in hexadecimal.
#[must_use]
pub fn sha256_hex(bytes: &[u8]) -> String {
    let bytes = Sha256::digest(bytes);
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
