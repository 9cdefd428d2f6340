//! Clouds of points: LAS, LAZ, and PLY or OBJ without faces.

use super::format::Outcome::{Mended, Read, Refused, Remarked};
use super::format::{Finding, Format};

pub(super) const FORMATS: &[Format] = &[
    Format {
        name: "LAS and LAZ",
        read: "LAS 1.0 to 1.4 (`.las`, `.laz`).",
        rows: &[
            Finding {
                found: "bytes behind the points that the header counts",
                outcome: Mended,
                told: "left out, `repairs.bytes_behind_points`",
            },
            Finding {
                found: "fewer points than the header counts, as in a file that was cut short, and \
                        damaged chunks of LAZ",
                outcome: Mended,
                told: "those that are there, `repairs.missing_points`",
            },
            Finding {
                found: "wrong numbers of echoes, of records, of points of LAS 1.4, or no number of \
                        points",
                outcome: Mended,
                told: "what the file holds, `repairs.stale_counts`",
            },
            Finding {
                found: "hundreds of thousands of points at one place, as echoes that never came",
                outcome: Mended,
                told: "32,768 of them, `repairs.points_of_one_place`",
            },
            Finding {
                found: "a later minor version with known points",
                outcome: Remarked,
                told: "read as LAS 1.4",
            },
            Finding {
                found: "waveforms",
                outcome: Remarked,
                told: "points alone",
            },
            Finding {
                found: "fewer or no numbers of echoes",
                outcome: Read,
                told: "they are not looked at",
            },
            Finding {
                found: "LAZ whose last chunk has an unknown number of points",
                outcome: Refused,
                told: "some would be made up",
            },
        ],
    },
    Format {
        name: "PLY and OBJ clouds",
        read: "Files of vertices without faces.",
        rows: &[],
    },
];
