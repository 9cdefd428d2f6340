//! Files of 360° cameras.

use super::format::Outcome::{Read, Refused, Remarked};
use super::format::{Finding, Format};

pub(super) const FORMATS: &[Format] = &[Format {
    name: "Files of 360° cameras",
    read: "Equirectangular files and cubes, by metadata, name and size, or by `--projection`.",
    rows: &[
        Finding {
            found: "a part of the sphere, by the bounds of `sv3d` or by GPano",
            outcome: Read,
            told: "where it lies on the whole; the rest is black",
        },
        Finding {
            found: "a turn or tilt of the sphere in its metadata",
            outcome: Remarked,
            told: "not applied, but for the heading of photographs",
        },
        Finding {
            found: "a word in the name: `pano`, `sphere`, `360`, ..",
            outcome: Remarked,
            told: "believed as a whole word: `atmosphere` does not match",
        },
        Finding {
            found: "GoPro's `.360`",
            outcome: Refused,
            told: "with the command that converts it; `--projection flat` shows a track as it is",
        },
        Finding {
            found: "Insta360's `.insp` and `.insv`, also under another name",
            outcome: Refused,
            told: "with the command that converts it",
        },
        Finding {
            found: "two fisheyes side by side, by their look",
            outcome: Refused,
            told: "with the command that converts it",
        },
    ],
}];
