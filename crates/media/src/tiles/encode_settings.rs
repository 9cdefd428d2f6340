//! How is a group of pictures to be coded?

use foveal_core::content::video::bytes::codec::Codec;

/// How much time the encoder takes for smaller files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Speed {
    /// About twice as fast and 10 % larger (libvpx cpu-used 8).
    Fast,
    /// The knee of the curve (libvpx cpu-used 5).
    #[default]
    Default,
    /// About twice as slow and 15 % smaller (libvpx cpu-used 4).
    Small,
    /// What others are measured against: libvpx's deadline good at cpu-used 4; for other codecs as
    /// [`Self::Small`].
    Reference,
}

impl Speed {
    /// The speed at which a level is coded, 0 the finest.
    ///
    /// [`Self::Small`] takes its time at the finest level, where most bytes are, and at the coarse
    /// ones, which everyone loads (docs/decisions/0010-small-hurries-at-the-second-level.md).
    #[must_use]
    pub const fn at_level(self, level: u8) -> Self {
        match self {
            Self::Small if level == 1 => Self::Default,
            speed => speed,
        }
    }
}

/// What decides how many bytes pictures take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rate {
    /// A quantiser, lower is finer: VP8, VP9 and AV1 0-63, H.264 and HEVC 0-51, JPEG 1-31; PNG is
    /// lossless and ignores it. VP9 stays between three quarters and nine eighths of it, the other
    /// codecs keep to it.
    Quantiser(u8),
    /// JPEG with the Independent JPEG Group's tables at this quality, 1-100, higher is finer.
    Ijg(u8),
    /// The finest quantiser at which the group takes at most so many bits per second, for the
    /// codecs that predict; takes four to six times as long.
    Bits(u32),
}

/// How a group is coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncodeSettings {
    /// Codec of the access units.
    pub codec: Codec,
    /// Quality, or bytes.
    pub rate: Rate,
    /// Frames a second as numerator and denominator, both positive.
    pub frame_rate: [i32; 2],
    /// Time against size.
    pub speed: Speed,
}
