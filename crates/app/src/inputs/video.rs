//! Films and streams.

use super::format::Outcome::{Mended, Read, Refused, Remarked};
use super::format::{Finding, Format};

pub(super) const FORMATS: &[Format] = &[Format {
    name: "Video",
    read: "Whatever the FFmpeg in the program decodes. `--strict` refuses all that is *mended* \
           here.",
    rows: &[
        Finding {
            found: "a stream that begins in the middle: cut at any packet, or an open group of \
                    pictures",
            outcome: Mended,
            told: "shown from the first whole frame on, `repairs.frames_dropped_at_start`",
        },
        Finding {
            found: "damaged data",
            outcome: Mended,
            told: "shown as FFmpeg conceals them, `repairs.damaged_frames`; what gives no frame is \
                   `repairs.lost_packets`",
        },
        Finding {
            found: "an end before the one that the container tells",
            outcome: Mended,
            told: "shown up to there, `repairs.cut_short`",
        },
        Finding {
            found: "an edit list, a copy that was trimmed, sound longer than the pictures",
            outcome: Read,
            told: "what the list shows, whole",
        },
        Finding {
            found: "time stamps that do not rise",
            outcome: Mended,
            told: "replaced by the frame rate, `repairs.time_stamps`",
        },
        Finding {
            found: "damaged sound",
            outcome: Mended,
            told: "silent there, `repairs.damaged_sound_packets`",
        },
        Finding {
            found: "interlaced frames (MPEG-2, H.264, ..)",
            outcome: Remarked,
            told: "deinterlaced by bwdif at the frame rate, with `--deinterlace fields` at the \
                   rate of fields; `repairs.deinterlaced_frames`",
        },
        Finding {
            found: "interlaced HEVC",
            outcome: Remarked,
            told: "each field is a picture, as FFmpeg hands them out",
        },
        Finding {
            found: "pixels that are not square, by the stream or by the container alone",
            outcome: Read,
            told: "shown in their shape, told in `pixel_aspect`; beyond 8:1 passed over",
        },
        Finding {
            found: "pixels whose shape changes",
            outcome: Remarked,
            told: "shown in that of the first frame",
        },
        Finding {
            found: "pictures whose size changes",
            outcome: Mended,
            told: "scaled into the first size in their own shape, `repairs.resized_frames`",
        },
        Finding {
            found: "boxes of projection or stereo (`sv3d`, `st3d`) that are broken",
            outcome: Mended,
            told: "passed over, `repairs.broken_boxes`; refused where FFmpeg opens no such file",
        },
        Finding {
            found: "a list of other files, a text, no frame at all",
            outcome: Refused,
            told: "there is nothing to show",
        },
    ],
}];
