//! glTF 2.0 and GLB.

use super::format::Outcome::{Read, Refused, Remarked};
use super::format::{Finding, Format};

pub(super) const FORMATS: &[Format] = &[Format {
    name: "glTF",
    read: "glTF 2.0 as `.gltf` with its files, or `.glb`.",
    rows: &[
        Finding {
            found: "buffers packed by Draco or meshopt",
            outcome: Read,
            told: "unpacked",
        },
        Finding {
            found: "animations and skins",
            outcome: Remarked,
            told: "shown at rest",
        },
        Finding {
            found: "no triangle at all",
            outcome: Refused,
            told: "there is nothing to show",
        },
    ],
}];
