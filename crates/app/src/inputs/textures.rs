//! Pictures on meshes.

use super::format::Format;

pub(super) const FORMATS: &[Format] = &[Format {
    name: "Textures",
    read: "PNG and JPEG.",
    rows: &[],
}];
