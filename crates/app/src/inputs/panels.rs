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
                "UTF-16, Latin-1, a type of document",
                Read,
                "as it was meant",
            ),
            found("decimal commas", Remarked, "read as points"),
            found(
                "a UTF-8 byte order mark, empty lines before the declaration, an `&` that begins \
                 no entity, control characters, Latin-1 that claims to be UTF-8",
                Remarked,
                "as it was meant",
            ),
            found(
                "files of a region whose name differs in case or blanks",
                Remarked,
                "used for it; files of a region that does not exist are left out, and a region \
                 without files is named",
            ),
            found(
                "resolutions of 0",
                Remarked,
                "treated as missing: a region is then a display of its own",
            ),
            found(
                "the place of a region in pixels of its buffer",
                Remarked,
                "divided by them",
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
                "an id that cannot be part of a file's name (`wall/L:1`)",
                Remarked,
                "with `-` in place of such characters",
            ),
            found(
                "`leftAngle` or `downAngle` without its sign",
                Remarked,
                "treated as negative where the frustum would be empty",
            ),
            found(
                "files of other kinds: `distortionMap`, `decodeLUT`, ..",
                Remarked,
                "not read",
            ),
            found(
                "a map of fewer values than its region has pixels, or up to four times more",
                Remarked,
                "a geometryWarpFile is interpolated, an alphaMap or betaMap resampled",
            ),
            found(
                "nodes of a geometryWarpFile that are not numbers; -1 in all three; 0 in all \
                 three, more than once",
                Read,
                "unlit",
            ),
            found(
                "bytes after a geometryWarpFile; its places in pixels of the region",
                Remarked,
                "left out; divided by its pixels",
            ),
            found(
                "an alphaMap or betaMap that is missing or no sound PNG",
                Remarked,
                "left out, with the region and the file",
            ),
            found(
                "a geometryWarpFile that is missing or cut, or whose places are pixels of another \
                 size",
                Remarked,
                "its panel is left out; without another panel it is refused",
            ),
            found(
                "a document that breaks off",
                Remarked,
                "what stands before that, with the line",
            ),
            found(
                "files next to a bare document whose names differ in capitals",
                Remarked,
                "these files",
            ),
            found(
                "any file that leads out or is too long",
                Refused,
                "by line and name",
            ),
            found("entities", Refused, "by line"),
        ],
    },
    Format {
        name: "Warp meshes",
        read: "Bourke's text (`.data`, `.mesh`, `.txt`, `.csv`; \
               [what of it](panels.md#warp-mesh)).",
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
            found("names of columns", Read, "passed over"),
            found(
                "nodes that do not stand in lines of their own",
                Read,
                "as it was meant",
            ),
            found(
                "shares of light of 0 or less at all nodes",
                Remarked,
                "full light: nothing would be drawn",
            ),
            found(
                "red, green and blue in place of a share of light",
                Remarked,
                "their mean",
            ),
            found(
                "shares of light of 0 to 255, 100 or 65535, or above 1",
                Remarked,
                "divided, or treated as 1",
            ),
            found(
                "nodes that are not numbers; an end within a row after the first two",
                Remarked,
                "nothing is drawn there",
            ),
            found("lines after the nodes", Remarked, "not read"),
            found(
                "u and v in pixels: the size of the picture is unknown",
                Refused,
                "by how far they reach",
            ),
            found("fewer nodes than two rows, or a fold", Refused, "by line"),
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
