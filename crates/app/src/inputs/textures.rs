//! Pictures on meshes.

use super::format::Outcome::{Mended, Read, Refused, Remarked};
use super::format::{Finding, Format};

pub(super) const FORMATS: &[Format] = &[Format {
    name: "Textures",
    read: "PNG, JPEG, WebP, BMP and TGA, known by what is in them, whatever they are called.",
    rows: &[
        Finding {
            found: "packed runs, palettes, 15 and 16 bits, any corner first (TGA, BMP)",
            outcome: Read,
            told: "as meant",
        },
        Finding {
            found: "an alpha that is 0 everywhere (TGA, BMP)",
            outcome: Mended,
            told: "opaque, as other programs show it; of TGA `repairs.damaged_images`",
        },
        Finding {
            found: "a PNG without its end, or whose sums are wrong",
            outcome: Mended,
            told: "shown if all rows come, `repairs.damaged_images`",
        },
        Finding {
            found: "a WebP that moves",
            outcome: Remarked,
            told: "its first picture, `repairs.animated_images`",
        },
        Finding {
            found: "`Kd 0 0 0` beneath a picture",
            outcome: Mended,
            told: "the picture is shown, `repairs.black_under_textures`",
        },
        Finding {
            found: "quotes, `%20`, other capitals, and the folders of another machine in names",
            outcome: Mended,
            told: "the file of that name next to the model, or in `textures` or the like there: \
                   `repairs.files_found_elsewhere`, `repairs.files_found_by_case`",
        },
        Finding {
            found: "a file outside the folder of the model",
            outcome: Remarked,
            told: "not opened without `--allow-outside`: the surface has its colour alone",
        },
        Finding {
            found: "GIF, TIFF, DDS, KTX2, AVIF, HEIC, PSD, a pointer of Git LFS",
            outcome: Remarked,
            told: "left out by its name: the surface has its colour alone",
        },
        Finding {
            found: "a picture that is cut short, damaged, or claims more than its bytes can hold",
            outcome: Refused,
            told: "left out by its name, `repairs.missing_images`: the surface has its colour \
                   alone",
        },
    ],
}];
