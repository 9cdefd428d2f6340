//! Clouds of points: LAS, LAZ, and PLY or OBJ without faces.

use super::format::Outcome::{Mended, Read, Refused, Remarked};
use super::format::{Finding, Format};

/// The same of scans and of clouds.
const FAR_POINTS: &str = "few points far beyond all others (1 % at most, 4 times as far), or such \
     as stand for no echo (-9999, 1e10)";

pub(super) const FORMATS: &[Format] = &[
    Format {
        name: "LAS and LAZ",
        read: "LAS 1.0 to 1.4 (`.las`, `.laz`).",
        rows: &[
            Finding {
                found: "colours of 8 bits, some of which have 16",
                outcome: Mended,
                told: "each as it is meant, `repairs.colours_of_another_depth`, with a remark",
            },
            Finding {
                found: "colours of 10 or 12 bits",
                outcome: Mended,
                told: "the largest code counts as full light, `repairs.colours_rescaled`",
            },
            Finding {
                found: FAR_POINTS,
                outcome: Mended,
                told: "left out, `repairs.outlier_points_left_out`; the remark says how many and \
                       where",
            },
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
                found: "a length of records that does not fit their format",
                outcome: Mended,
                told: "whichever of the two fits the bytes of all points, `repairs.stale_counts`",
            },
            Finding {
                found: "colours that are all black",
                outcome: Mended,
                told: "they stand for none: grey by intensities, else one grey, \
                       `repairs.black_colours`, with a remark",
            },
            Finding {
                found: "intensities without colours, a few of them far brighter than all others",
                outcome: Read,
                told: "grey; the brightest hundredth is white, without those of 65535 where \
                       these are fewer than half",
            },
            Finding {
                found: "a negative scale; a scale of 0 or an offset of no place where bounds are \
                        given",
                outcome: Mended,
                told: "turned the other way, `repairs.negative_scales`; as the bounds say, \
                       `repairs.stale_counts`",
            },
            Finding {
                found: "a place of points within the header or behind the end, or a header \
                        without a length; points that are said to be packed and are not",
                outcome: Mended,
                told: "behind the records before them, as plain points, `repairs.stale_counts`",
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
                outcome: Mended,
                told: "all, where packing them again gives the same bytes; else without those of \
                       its last 16 bytes, which could be made up: `repairs.stale_counts`, \
                       `repairs.missing_points`",
            },
        ],
    },
    Format {
        name: "PLY and OBJ clouds",
        read: "Files of vertices without faces.",
        rows: &[
            Finding {
                found: "colours from 0 to 255 as `int`, `uint`, `ushort`, `float` or `double`, \
                        from 0 to 1 as `uchar`, of 10 or 12 bits",
                outcome: Mended,
                told: "the largest code counts as full light, `repairs.colours_rescaled`",
            },
            Finding {
                found: "`rgb` or `rgba` packed into one `float` or `uint`, as PCL writes them",
                outcome: Read,
                told: "as colours",
            },
            Finding {
                found: "intensities without colours",
                outcome: Remarked,
                told: "grey, from 0 (where some are negative, from the least hundredth) to the \
                       brightest hundredth",
            },
            Finding {
                found: "colours that are all black",
                outcome: Mended,
                told: "they stand for none: grey by intensities, else one grey, \
                       `repairs.black_colours`, with a remark",
            },
            Finding {
                found: "red, green and blue of which one is missing",
                outcome: Mended,
                told: "left out, `repairs.colours_incomplete`",
            },
            Finding {
                found: "splats (`f_dc_0` ..)",
                outcome: Remarked,
                told: "drawn as points, in their own colour",
            },
            Finding {
                found: "compressed splats (`packed_position`)",
                outcome: Refused,
                told: "export them as a plain PLY file",
            },
            Finding {
                found: "colours that are no numbers",
                outcome: Mended,
                told: "white, `repairs.colours_made`",
            },
            Finding {
                found: FAR_POINTS,
                outcome: Mended,
                told: "left out, `repairs.outlier_points_left_out`; the remark says how many and \
                       where",
            },
            Finding {
                found: "several scans far from each other",
                outcome: Mended,
                told: "a cloud each, `repairs.outlier_points`",
            },
        ],
    },
];
