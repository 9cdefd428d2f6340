//! Still pictures.

use super::format::Outcome::{Mended, Read, Refused, Remarked};
use super::format::{Finding, Format};

pub(super) const FORMATS: &[Format] = &[Format {
    name: "Still pictures",
    read: "Whatever the FFmpeg in the program decodes; AVIF; Radiance (`.hdr`); OpenEXR; TIFF in \
           tiles, of floating-point samples, compressed by JPEG, and BigTIFF; and animations, \
           which are films.",
    rows: &[
        Finding {
            found: "orientation in EXIF; `irot` and `imir` of AVIF",
            outcome: Read,
            told: "upright",
        },
        Finding {
            found: "AVIF of several tiles, or with alpha",
            outcome: Read,
            told: "whole, over black",
        },
        Finding {
            found: "AVIF with a crop (`clap`), or a series of pictures",
            outcome: Remarked,
            told: "all of the first picture",
        },
        Finding {
            found: "alpha that is not opaque",
            outcome: Remarked,
            told: "over black; alpha that is opaque everywhere is no matter",
        },
        Finding {
            found: "animated GIF, PNG (APNG) and WebP",
            outcome: Read,
            told: "a film, each picture for its time, the last one too",
        },
        Finding {
            found: "GIF, APNG or WebP that ends within a picture, or lacks pictures that it \
                    announces",
            outcome: Mended,
            told: "the pictures that are whole, `repairs.cut_short`",
        },
        Finding {
            found: "damaged pictures among those of an animated WebP",
            outcome: Mended,
            told: "the picture before stays, `repairs.damaged_frames`",
        },
        Finding {
            found: "broken EXIF or XMP",
            outcome: Mended,
            told: "passed over, `repairs.broken_tags`",
        },
        Finding {
            found: "samples that count light (OpenEXR, Radiance, float maps, TIFF of \
                    floating-point samples from 0 to 1, PNG with gAMA 1.0 or a linear cICP), or \
                    light to another power (gAMA)",
            outcome: Remarked,
            told: "converted to sRGB; what is brighter than white is white, and its share is said",
        },
        Finding {
            found: "PQ or HLG, by the coded data or cICP of PNG",
            outcome: Remarked,
            told: "shown as standard range",
        },
        Finding {
            found: "a GIF whose screen is 0x0 or does not hold its pictures; a WebP that says that \
                    it is longer than it is",
            outcome: Mended,
            told: "whole, `repairs.broken_tags`",
        },
        Finding {
            found: "OpenEXR with named layers (`ViewLayer.Combined.R`), or of several parts",
            outcome: Remarked,
            told: "the layer with the whole picture, by its name; channels without a layer come \
                   first",
        },
        Finding {
            found: "OpenEXR of luminance and chroma (Y, RY, BY)",
            outcome: Read,
            told: "in colour; refused where chroma has fewer samples",
        },
        Finding {
            found: "Radiance in X, Y and Z of CIE; a JPEG without its end mark",
            outcome: Read,
            told: "as meant",
        },
        Finding {
            found: "pixels of a PNG beyond its palette; a WebP whose canvas is not its picture's \
                    size",
            outcome: Mended,
            told: "black; the picture alone: `repairs.broken_tags`",
        },
        Finding {
            found: "a GIF whose pictures leave places free",
            outcome: Read,
            told: "clear there, as in browsers",
        },
        Finding {
            found: "a TIFF whose first page is a smaller one of another",
            outcome: Remarked,
            told: "the other; of raw files of cameras the small one",
        },
        Finding {
            found: "several pages of a TIFF, pictures of an icon (`.ico`)",
            outcome: Remarked,
            told: "the first page, the largest picture",
        },
        Finding {
            found: "bytes behind the end of a picture",
            outcome: Read,
            told: "passed over",
        },
        Finding {
            found: "TIFF in L*a*b*, of whole numbers of 32 bits or with a sign, of heights, or \
                    compressed by JPEG in the old style, ZSTD, LZMA, LERC, JBIG or JPEG 2000",
            outcome: Refused,
            told: "by its kind, with what converts it",
        },
        Finding {
            found: "PDF, archives, web pages, pointers of Git LFS",
            outcome: Refused,
            told: "by their kind",
        },
        Finding {
            found: "a GIF without any palette; OpenEXR without colour or grey, or of samples in \
                    several depths",
            outcome: Refused,
            told: "by what it lacks, with what converts it",
        },
        Finding {
            found: "HEIC",
            outcome: Refused,
            told: "with what converts it",
        },
        Finding {
            found: "a file that is cut within the picture",
            outcome: Refused,
            told: "what is missing is unknown; OpenEXR and QOI by the rows that are missing",
        },
    ],
}];
