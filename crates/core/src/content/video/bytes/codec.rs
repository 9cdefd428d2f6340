//! Which codec are a pack's tiles coded with?

use serde::{Deserialize, Serialize};

/// Codec of the tiles of a pack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Codec {
    /// VP8 in closed groups: the cheapest to decode in old browsers.
    Vp8,
    /// VP9 in closed groups: the default.
    Vp9,
    /// H.264 in closed groups: decoded by hardware everywhere.
    H264,
    /// HEVC in closed groups.
    Hevc,
    /// AV1 in closed groups.
    Av1,
    /// Baseline JPEG, one picture a frame, full range.
    Jpeg,
    /// PNG, one picture a frame, lossless: the three planes stacked in one grey picture
    /// (`docs/formats/pack.md`).
    Png,
}

/// Smallest side of an HEVC picture, pixels: encoders ask for a whole coding tree unit.
const LEAST_HEVC_SIDE: u32 = 32;
/// Smallest side of an H.264 and of an AV1 picture here, pixels: one macroblock; below it encoders
/// differ in what they take.
const LEAST_BLOCK_SIDE: u32 = 16;

impl Codec {
    /// All codecs, in the order in which help texts name them.
    pub const ALL: [Self; 7] = [
        Self::Vp9,
        Self::Vp8,
        Self::H264,
        Self::Hevc,
        Self::Av1,
        Self::Jpeg,
        Self::Png,
    ];

    /// Whether every frame can be decoded by itself.
    #[must_use]
    pub fn is_intra(self) -> bool {
        matches!(self, Codec::Jpeg | Codec::Png)
    }

    /// The name that the command line and the pack use.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Codec::Vp8 => "vp8",
            Codec::Vp9 => "vp9",
            Codec::H264 => "h264",
            Codec::Hevc => "hevc",
            Codec::Av1 => "av1",
            Codec::Jpeg => "jpeg",
            Codec::Png => "png",
        }
    }

    /// The size in which a picture of `size` pixels is coded: its right and bottom border repeat up
    /// to there, and are cut off when it is decoded.
    ///
    /// ```
    /// use foveal_core::content::video::bytes::codec::Codec;
    /// assert_eq!(Codec::Vp9.coded_size([47, 3]), [47, 3]);
    /// assert_eq!(Codec::H264.coded_size([47, 3]), [48, 16]);
    /// ```
    #[must_use]
    pub fn coded_size(self, size: [u32; 2]) -> [u32; 2] {
        match self {
            Codec::Vp8 | Codec::Vp9 | Codec::Jpeg | Codec::Png => size,
            Codec::H264 | Codec::Av1 => size.map(|side| even(side).max(LEAST_BLOCK_SIDE)),
            Codec::Hevc => size.map(|side| even(side).max(LEAST_HEVC_SIDE)),
        }
    }

    /// The highest quantiser of the codec; the lowest is 0, for JPEG 1.
    #[must_use]
    pub fn highest_quantiser(self) -> u8 {
        match self {
            Codec::Vp8 | Codec::Vp9 | Codec::Av1 => 63,
            Codec::H264 | Codec::Hevc => 51,
            Codec::Jpeg => 31,
            Codec::Png => 255,
        }
    }
}

/// 4:2:0 chroma halves evenly.
fn even(side: u32) -> u32 {
    side.saturating_add(side % 2)
}
