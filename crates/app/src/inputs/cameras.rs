//! Files of 360° cameras.

use super::format::Format;

pub(super) const FORMATS: &[Format] = &[Format {
    name: "Files of 360° cameras",
    read: "Equirectangular and equi-angular 360° files, by their metadata or by option.",
    rows: &[],
}];
