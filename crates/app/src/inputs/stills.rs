//! Still pictures.

use super::format::Format;

pub(super) const FORMATS: &[Format] = &[Format {
    name: "Still pictures",
    read: "Whatever the FFmpeg in the program decodes.",
    rows: &[],
}];
