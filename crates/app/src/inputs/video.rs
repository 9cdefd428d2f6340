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
            found: "damage that a decoder only logs (a missing reference of HEVC, a slice of \
                    FFV1), a picture of HEVC that its own checksum refuses, a hole of zeros in \
                    coded data (32 in H.264 and HEVC, 512 in VP8, VP9, AV1 and MJPEG)",
            outcome: Mended,
            told: "the same",
        },
        Finding {
            found: "clusters of Matroska and WebM that are torn, or that their checksum refuses",
            outcome: Mended,
            told: "what FFmpeg finds in them, `repairs.damaged_clusters`",
        },
        Finding {
            found: "other bytes in the place of coded data of HEVC, VP8, VP9, AV1 or HuffYUV that \
                    decode all the same, where no checksum shows it; a bare stream (`.h264`, \
                    `.hevc`) that lacks whole pictures or ends in one of HEVC",
            outcome: Read,
            told: "as the decoder takes it, without a word: nothing in the file shows it",
        },
        Finding {
            found: "even time stamps with a hole in a few places",
            outcome: Remarked,
            told: "the frame before stays there, `repairs.time_gaps`, which `--strict` accepts; \
                   where there is damage, `repairs.missing_frames`",
        },
        Finding {
            found: "frames that last for hours between others",
            outcome: Remarked,
            told: "the rate is that of most frames of the index",
        },
        Finding {
            found: "an end before the one that the container gives (MP4, Matroska, AVI, ASF, FLV, \
                    MXF); within a frame (Y4M) or a packet (transport streams); an Ogg without its \
                    last page",
            outcome: Mended,
            told: "shown up to there, `repairs.cut_short`",
        },
        Finding {
            found: "a beginning that was lost, by time stamps that begin late in a film that is as \
                    much shorter (MP4 in pieces, Matroska)",
            outcome: Mended,
            told: "shown from there, `repairs.missing_frames`",
        },
        Finding {
            found: "a display matrix of zeros, of other than right angles, or slanted",
            outcome: Mended,
            told: "as stored, or by the nearest quarter turn, `repairs.broken_tags`; mirrors are \
                   followed",
        },
        Finding {
            found: "a clean aperture (`clap`) of MP4 or QuickTime",
            outcome: Remarked,
            told: "that part is shown; one that is no part of the picture is passed over, \
                   `repairs.broken_tags`",
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
            found: "recordings joined end to end (transport and program streams, Ogg), whose time \
                    stamps start again",
            outcome: Remarked,
            told: "played one after the other, `repairs.joined_recordings`; `--strict` accepts \
                   them",
        },
        Finding {
            found: "a second film behind the end of the first (MP4, FLV, ASF or APNG joined by \
                    `cat`)",
            outcome: Remarked,
            told: "the first, with where the second begins; pieces of MP4 that begin again are \
                   mixed",
        },
        Finding {
            found: "several video tracks",
            outcome: Remarked,
            told: "FFmpeg's choice, but never a track of one picture where another is a film; the \
                   others are named",
        },
        Finding {
            found: "a track of MP4 whose time scale is 0",
            outcome: Mended,
            told: "that of its length, `repairs.broken_tags`",
        },
        Finding {
            found: "an edit list of length 0, or one that begins behind the end; one that would \
                    leave out the first frames, as the order of frames (`ctts`) is lost; a first \
                    frame before the beginning",
            outcome: Mended,
            told: "all frames, `repairs.broken_tags`",
        },
        Finding {
            found: "an edit list that asks for another speed",
            outcome: Remarked,
            told: "full speed",
        },
        Finding {
            found: "a bare stream (`.h264`, `.mjpeg`) that gives no frame rate",
            outcome: Remarked,
            told: "25 frames a second",
        },
        Finding {
            found: "a segment of a stream (`.m4s`) without its init segment, or that alone",
            outcome: Refused,
            told: "with what joins them",
        },
        Finding {
            found: "an MP4 without its index (`moov`), or that ends within it",
            outcome: Refused,
            told: "with what rebuilds it",
        },
        Finding {
            found: "an Ogg that begins in the middle",
            outcome: Refused,
            told: "how it is coded stands at its beginning",
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
            told: "shown in their shape, listed in `pixel_aspect`; beyond 8:1 passed over",
        },
        Finding {
            found: "pixels whose shape changes",
            outcome: Mended,
            told: "shown in that of the first frame, `repairs.reshaped_frames`",
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
