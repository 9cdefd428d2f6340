//! Layouts of tiled displays.

use super::format::Outcome::{Mended, Read, Refused, Remarked};
use super::format::{Finding, Format};

const fn found(
    found: &'static str,
    outcome: super::format::Outcome,
    told: &'static str,
) -> Finding {
    Finding {
        found,
        outcome,
        told,
    }
}

pub(super) const FORMATS: &[Format] = &[
    Format {
        name: "MPCDI",
        read: "VESA MPCDI up to 2.0, zipped or as `.xml` with its files \
               ([what of it](panels.md#mpcdi)).",
        rows: &[
            found(
                "an archive that holds its folder, or other documents",
                Read,
                "paths count from the folder of the document",
            ),
            found(
                "backslashes, other letter case, `./` and `..` in paths",
                Read,
                "the file that is meant, if it lies in the archive or folder",
            ),
            found(
                "paths of the machine that wrote it",
                Remarked,
                "the only file of that name",
            ),
            found(
                "UTF-16, Latin-1, a type of document, decimal commas",
                Read,
                "as it was meant",
            ),
            found(
                "pixels of a region that are not its share of the buffer",
                Remarked,
                "placed by its share",
            ),
            found(
                "regions that lie over each other",
                Remarked,
                "drawn as they lie",
            ),
            found(
                "an id that is there twice",
                Mended,
                "a number behind it, which is said",
            ),
            found(
                "a map of fewer values than its region has pixels, or up to four times more",
                Remarked,
                "a geometryWarpFile is interpolated, an alphaMap or betaMap resampled",
            ),
            found(
                "an alphaMap or betaMap that is missing or no sound PNG",
                Remarked,
                "left out, with the region and the file",
            ),
            found(
                "a geometryWarpFile that is missing, or any file that leads out or is too long",
                Refused,
                "by line and name",
            ),
            found("entities", Refused, "by line"),
        ],
    },
    Format {
        name: "Warp meshes",
        read: "Bourke's text (`.data`, `.mesh`, `.txt`; [what of it](panels.md#warp-mesh)).",
        rows: &[
            found(
                "comments, empty lines, line ends of Windows or old Macs, UTF-16",
                Read,
                "left out",
            ),
            found(
                "commas or semicolons between numbers, decimal commas",
                Read,
                "as it was meant",
            ),
            found("nodes without a share of light", Read, "full light"),
            found("lines behind the nodes", Remarked, "not read"),
            found("fewer nodes than it says, or a fold", Refused, "by line"),
        ],
    },
    Format {
        name: "Rig files",
        read: "Our own TOML and JSON ([all keys](panels.md)).",
        rows: &[found(
            "keys that there are not, panels over each other",
            Refused,
            "by line and key, with the nearest key",
        )],
    },
];
