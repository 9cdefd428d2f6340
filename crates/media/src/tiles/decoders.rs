//! Which decoder does a tile get: the processor's or the graphics device's?
//!
//! A picture that the device decodes is handed over twice, in and out, which is taken to cost a
//! millisecond whatever its size; a thread decodes a tile of 512 x 512 pixels in that time. So
//! small tiles stay with the processor unless the device is asked for.

use crate::error::MediaError;
use crate::tiles::decode::GroupDecoder;
use crate::tiles::hardware::HardwareDevice;
use foveal_core::content::video::bytes::codec::Codec;
use std::sync::Arc;

/// Who decodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DecoderChoice {
    /// The processor.
    #[default]
    Software,
    /// The graphics device where there is one, for pictures of at least
    /// [`LEAST_PIXELS`]; the processor else.
    Auto,
    /// The graphics device, for as many decoders as it takes; the processor for the others.
    Hardware,
}

/// Pixels from which on a picture is worth its way to the device and back: some five times what a
/// thread decodes in the time of that way.
pub const LEAST_PIXELS: u64 = 1 << 20;

/// The decoders of a pack.
#[derive(Clone, Debug)]
pub struct Decoders {
    codec: Codec,
    least_pixels: u64,
    device: Option<Arc<HardwareDevice>>,
}

/// What was decoded on a device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DeviceUse {
    /// FFmpeg's name of the device; `None` without one.
    pub device: Option<String>,
    /// Decoders that were opened on it.
    pub decoders: usize,
    /// Those of them that failed, so that the processor took over.
    pub failed: usize,
}

impl Decoders {
    /// Decoders by the processor alone.
    #[must_use]
    pub fn software(codec: Codec) -> Self {
        Self {
            codec,
            least_pixels: 0,
            device: None,
        }
    }

    /// Decoders as chosen for pictures of at most `most_pixels`. A device is looked for only where
    /// it would decode, which may take some hundred milliseconds.
    ///
    /// # Errors
    /// [`DecoderChoice::Hardware`] without a device; the message names those that were tried.
    pub fn new(choice: DecoderChoice, codec: Codec, most_pixels: u64) -> Result<Self, MediaError> {
        let software = Self::software(codec);
        match choice {
            DecoderChoice::Software => Ok(software),
            DecoderChoice::Auto if most_pixels < LEAST_PIXELS => Ok(software),
            DecoderChoice::Auto => Ok(Self {
                least_pixels: LEAST_PIXELS,
                device: HardwareDevice::open(codec).ok(),
                ..software
            }),
            DecoderChoice::Hardware => Ok(Self {
                device: Some(HardwareDevice::open(codec)?),
                ..software
            }),
        }
    }

    /// A decoder of pictures of `size`.
    pub(crate) fn open(&self, size: [u32; 2]) -> Result<GroupDecoder, MediaError> {
        let [w, h] = size.map(u64::from);
        let device = self.device.as_ref().filter(|_| w * h >= self.least_pixels);
        match device.and_then(HardwareDevice::slot) {
            Some(slot) => GroupDecoder::on_device(self.codec, size, slot),
            None => GroupDecoder::new(self.codec, size),
        }
    }

    /// What was decoded on a device so far.
    #[must_use]
    pub fn device_use(&self) -> DeviceUse {
        let Some(device) = &self.device else {
            return DeviceUse::default();
        };
        let [decoders, failed] = device.counts();
        DeviceUse {
            device: Some(device.name().to_owned()),
            decoders,
            failed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::scenes::group;
    use crate::tiles::hardware::MOST_SLOTS;
    use crate::{EncodeSettings, Rate, Speed, encode_group};
    use ffmpeg_next::ffi::AVPixelFormat;

    #[test]
    fn a_device_is_looked_for_only_where_it_would_decode() {
        let small = Decoders::new(DecoderChoice::Auto, Codec::Vp9, LEAST_PIXELS - 1).unwrap();
        assert_eq!(small.device_use(), DeviceUse::default());
        let large = Decoders::new(DecoderChoice::Auto, Codec::Vp9, LEAST_PIXELS);
        large.unwrap().open([64, 64]).unwrap();
        let error = Decoders::new(DecoderChoice::Hardware, Codec::Png, 1).unwrap_err();
        assert!(error.to_string().contains("--decoder hardware"), "{error}");
    }

    /// Decoders of H.264 on a device that is not there.
    fn pretended(format: AVPixelFormat) -> Decoders {
        Decoders {
            device: Some(HardwareDevice::pretended(format)),
            ..Decoders::software(Codec::H264)
        }
    }

    #[test]
    fn decoders_beyond_those_that_a_device_takes_are_the_processor_s() {
        let decoders = pretended(AVPixelFormat::AV_PIX_FMT_VAAPI);
        let open = || decoders.open([256, 256]).unwrap();
        let all: Vec<_> = (0..MOST_SLOTS + 3).map(|_| open()).collect();
        assert_eq!(decoders.device_use().decoders, MOST_SLOTS);
        drop(all);
        drop(open());
        assert_eq!(decoders.device_use().decoders, MOST_SLOTS + 1);
        assert_eq!(decoders.device_use().failed, 0);
    }

    #[test]
    fn a_decoder_that_its_device_refuses_goes_on_in_software_and_is_counted() {
        let size = [96, 64];
        let settings = EncodeSettings {
            codec: Codec::H264,
            rate: Rate::Quantiser(20),
            frame_rate: [25, 1],
            speed: Speed::Default,
        };
        let units = encode_group(&settings, &group(size, 6, 3)).unwrap();
        let mut software = GroupDecoder::new(Codec::H264, size).unwrap();
        // No decoder offers the first; the second is what software decodes to.
        for (format, failed) in [
            (AVPixelFormat::AV_PIX_FMT_MEDIACODEC, 1),
            (AVPixelFormat::AV_PIX_FMT_YUV420P, 0),
        ] {
            let decoders = pretended(format);
            let mut decoder = decoders.open(size).unwrap();
            for turn in 0..2 {
                for (number, unit) in (0..).zip(&units) {
                    let expected = software.decode(unit, number).unwrap();
                    assert_eq!(decoder.decode(unit, number).unwrap(), expected);
                }
                software.restart();
                decoder.restart();
                let used = decoders.device_use();
                assert_eq!((used.decoders, used.failed), (1, failed), "turn {turn}");
            }
            // Damage is damage on a device, too.
            assert!(decoder.decode(&units[0][..units[0].len() / 2], 0).is_err());
        }
    }
}
