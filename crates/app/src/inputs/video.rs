//! Films and streams.

use super::format::Format;

pub(super) const FORMATS: &[Format] = &[Format {
    name: "Video",
    read: "Whatever the FFmpeg in the program decodes.",
    rows: &[],
}];
