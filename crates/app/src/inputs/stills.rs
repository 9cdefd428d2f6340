//! Still pictures.

use super::format::Outcome::{Mended, Read, Refused, Remarked};
use super::format::{Finding, Format};

pub(super) const FORMATS: &[Format] = &[Format {
    name: "Still pictures",
    read: "Whatever the FFmpeg in the program decodes, AVIF, and animations, which are films.",
    rows: &[
        Finding {
            found: "orientation in EXIF; `irot` and `imir` of AVIF",
            outcome: Read,
            told: "upright",
        },
        Finding {
            found: "AVIF of several tiles, or with alpha",
            outcome: Read,
            told: "whole, over black",
        },
        Finding {
            found: "AVIF with a crop (`clap`), or a series of pictures",
            outcome: Remarked,
            told: "all of the first picture",
        },
        Finding {
            found: "alpha that is not opaque",
            outcome: Remarked,
            told: "over black; alpha that is opaque everywhere is no matter",
        },
        Finding {
            found: "animated GIF, PNG (APNG) and WebP",
            outcome: Read,
            told: "a film, each picture for its time, the last one too",
        },
        Finding {
            found: "GIF, APNG or WebP that ends within a picture, or lacks pictures that it \
                    announces",
            outcome: Mended,
            told: "the pictures that are whole, `repairs.cut_short`",
        },
        Finding {
            found: "damaged pictures among those of an animated WebP",
            outcome: Mended,
            told: "the picture before stays, `repairs.damaged_frames`",
        },
        Finding {
            found: "broken EXIF or XMP",
            outcome: Mended,
            told: "passed over, `repairs.broken_tags`",
        },
        Finding {
            found: "HEIC",
            outcome: Refused,
            told: "with what converts it",
        },
        Finding {
            found: "a file that is cut within the picture",
            outcome: Refused,
            told: "what is missing is unknown",
        },
    ],
}];
