//! Layouts of tiled displays.

use super::format::Format;

pub(super) const FORMATS: &[Format] = &[Format {
    name: "Layouts of tiled displays",
    read: "Rig files, MPCDI and meshes of warps.",
    rows: &[],
}];
