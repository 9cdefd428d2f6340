//! Clouds of points: LAS, LAZ, and PLY or OBJ without faces.

use super::format::Format;

pub(super) const FORMATS: &[Format] = &[
    Format {
        name: "LAS and LAZ",
        read: "LAS 1.0 to 1.4 (`.las`, `.laz`).",
        rows: &[],
    },
    Format {
        name: "PLY and OBJ clouds",
        read: "Files of vertices without faces.",
        rows: &[],
    },
];
