//! How does an access unit become a picture again?

use av::format::Pixel;
use av::frame::Video;
use av::{Packet, codec, color, decoder};
use ffmpeg_next as av;
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::bytes::key_frame::is_key_frame;
use foveal_core::view::picture::Picture;

use crate::error::MediaError;
use crate::ffmpeg::{start, wants_more};
use crate::read::frame::{picture_from_frame, picture_from_nv12};
use crate::tiles::hardware::{DecoderSlot, decoder_name};
use crate::tiles::stacked_png::picture_from_png;

/// What FFmpeg adds to the sides of a picture at most when it checks `max_pixels`.
const ALIGNMENT: u64 = 128;

/// A decoder for the groups of tiles of one size.
///
/// Codecs that predict keep state from one access unit to the next, so a jump needs
/// [`GroupDecoder::restart`] and then a key frame. Takes one thread; opening costs about 0.01 ms.
pub struct GroupDecoder {
    codec: Codec,
    size: [u32; 2],
    /// None for PNG, which has no state.
    decoder: Option<decoder::Video>,
    /// Where a graphics device decodes.
    slot: Option<DecoderSlot>,
    /// False from a restart to the next key frame.
    started: bool,
}

impl GroupDecoder {
    /// A decoder of pictures of exactly `size` (width and height in pixels).
    ///
    /// # Errors
    /// The size has a side of 0 or more than 65535 pixels, or this FFmpeg lacks the decoder.
    pub fn new(codec: Codec, size: [u32; 2]) -> Result<Self, MediaError> {
        start();
        if size.iter().any(|side| !(1..=65535).contains(side)) {
            return Err(MediaError::Setting {
                field: "the decoder's size".to_owned(),
                found: format!("{} x {}", size[0], size[1]),
                expected: "sides of 1 to 65535".to_owned(),
            });
        }
        Ok(Self {
            codec,
            size,
            decoder: open_software(codec, size)?,
            slot: None,
            started: false,
        })
    }

    /// The same on a graphics device; by the processor where the device takes no such stream,
    /// which is known at the first key frame.
    pub(crate) fn on_device(
        codec: Codec,
        size: [u32; 2],
        slot: DecoderSlot,
    ) -> Result<Self, MediaError> {
        let coded_size = codec.coded_size(size);
        let opened = decoder_name(codec)
            .ok_or_else(|| "no device decodes it".to_owned())
            .and_then(|name| open_decoder(name, coded_size, Some(&slot)));
        match opened {
            Ok(decoder) => Ok(Self {
                codec,
                size,
                decoder: Some(decoder),
                slot: Some(slot),
                started: false,
            }),
            Err(_) => {
                slot.fail();
                Self::new(codec, size)
            }
        }
    }

    /// Width and height of its pictures in pixels.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Forgets the pictures so far; the next access unit must be a key frame.
    pub fn restart(&mut self) {
        if let Some(decoder) = &mut self.decoder {
            decoder.flush();
        }
        self.started = false;
    }

    /// Decodes one access unit, and returns the picture with the frame number that came out of the
    /// decoder with it: the caller compares it with the one that it gave in.
    ///
    /// # Errors
    /// Damaged data, a first access unit that is no key frame, a picture of another size or format,
    /// or anything but one picture. The decoder then waits for a key frame.
    pub fn decode(
        &mut self,
        access_unit: &[u8],
        frame_number: i64,
    ) -> Result<(Picture, i64), MediaError> {
        let decoded = match self.decoder {
            Some(_) => self.frame(access_unit, frame_number),
            None => {
                let picture = picture_from_png(access_unit, self.size);
                return picture
                    .map(|picture| (picture, frame_number))
                    .map_err(|reason| self.failed(frame_number, reason));
            }
        };
        let picture = decoded.and_then(|(frame, out)| Ok((self.picture(&frame)?, out)));
        picture.map_err(|reason| self.failed(frame_number, reason))
    }

    /// Decodes one access unit for the sake of those that build on it: no picture is copied.
    ///
    /// # Errors
    /// As [`GroupDecoder::decode`].
    pub fn skip(&mut self, access_unit: &[u8], frame_number: i64) -> Result<(), MediaError> {
        if self.decoder.is_none() {
            return Ok(());
        }
        let decoded = self.frame(access_unit, frame_number);
        decoded
            .map(drop)
            .map_err(|reason| self.failed(frame_number, reason))
    }

    fn failed(&mut self, frame: i64, reason: String) -> MediaError {
        self.restart();
        MediaError::AccessUnit {
            codec: self.codec.name(),
            frame,
            reason,
        }
    }

    /// The frame of an access unit and the number that came out with it; a device that fails at a
    /// key frame is left.
    fn frame(&mut self, unit: &[u8], number: i64) -> Result<(Video, i64), String> {
        let decoded = self.frame_checked(unit, number);
        if decoded.is_ok() || !self.leave_device()? || !is_key_frame(self.codec, unit) {
            return decoded;
        }
        self.frame_checked(unit, number)
    }

    /// Goes on without the device that failed; false where there was none.
    fn leave_device(&mut self) -> Result<bool, String> {
        let Some(slot) = self.slot.take() else {
            return Ok(false);
        };
        slot.fail();
        self.decoder = open_software(self.codec, self.size).map_err(|e| e.to_string())?;
        self.started = false;
        Ok(true)
    }

    fn frame_checked(&mut self, unit: &[u8], number: i64) -> Result<(Video, i64), String> {
        let decoder = self.decoder.as_mut().ok_or("it has no frames")?;
        if unit.is_empty() {
            return Err("it is empty".to_owned());
        }
        if !self.started && !is_key_frame(self.codec, unit) {
            return Err("it is no key frame, with which decoding must start".to_owned());
        }
        let mut packet = Packet::copy(unit);
        packet.set_pts(Some(number));
        decoder.send_packet(&packet).map_err(|e| e.to_string())?;
        let mut frame = Video::empty();
        decoder
            .receive_frame(&mut frame)
            .map_err(|e| format!("no picture: {e}"))?;
        if decoder
            .receive_frame(&mut Video::empty())
            .err()
            .is_none_or(|e| !wants_more(e))
        {
            return Err("more than one picture".to_owned());
        }
        if let Some(slot) = &self.slot {
            frame = slot.download(&frame)?;
        }
        check_frame(&frame, self.codec, self.codec.coded_size(self.size))?;
        let out = frame.pts().ok_or("the picture lost its frame number")?;
        self.started = true;
        Ok((frame, out))
    }

    fn picture(&self, frame: &Video) -> Result<Picture, String> {
        let picture = match frame.format() {
            Pixel::NV12 => picture_from_nv12(frame)?,
            _ => picture_from_frame(frame)?,
        };
        Ok(match [picture.width, picture.height] == self.size {
            true => picture,
            false => picture.crop([0, 0], self.size),
        })
    }
}

/// The processor's decoder; none for PNG.
fn open_software(codec: Codec, size: [u32; 2]) -> Result<Option<decoder::Video>, MediaError> {
    let name = match codec {
        Codec::Av1 => Some("libdav1d"),
        codec => decoder_name(codec),
    };
    let opened = name.map(|name| open_decoder(name, codec.coded_size(size), None));
    opened.transpose().map_err(|reason| MediaError::Setting {
        field: format!("the {} decoder of this FFmpeg", codec.name()),
        found: reason,
        expected: "an FFmpeg that was built with it (`ffmpeg -decoders` lists them); install one, \
                   or prepare the pack with another --codec"
            .to_owned(),
    })
}

fn open_decoder(
    name: &str,
    size: [u32; 2],
    slot: Option<&DecoderSlot>,
) -> Result<decoder::Video, String> {
    let codec = decoder::find_by_name(name).ok_or_else(|| format!("no {name}"))?;
    let mut context = codec::Context::new_with_codec(codec);
    context.set_threading(codec::threading::Config::count(1));
    // dav1d and others then hold nothing back.
    context.set_flags(codec::Flags::LOW_DELAY);
    if let Some(slot) = slot {
        slot.attach(&mut context)?;
    }
    let mut decoder = context.decoder();
    // Damage is reported, not concealed.
    decoder.check(decoder::Check::EXPLODE);
    let [width, height] = size.map(|side| u64::from(side) + ALIGNMENT);
    let mut options = av::Dictionary::new();
    // A damaged header cannot ask for more memory than the picture needs.
    options.set("max_pixels", &(width * height).to_string());
    let opened = decoder
        .open_as_with(codec, options)
        .and_then(decoder::Opened::video);
    opened.map_err(|e| e.to_string())
}

fn check_frame(frame: &Video, codec: Codec, size: [u32; 2]) -> Result<(), String> {
    if [frame.width(), frame.height()] != size {
        let [w, h] = size;
        return Err(format!(
            "the picture is {} x {}, expected {w} x {h}",
            frame.width(),
            frame.height()
        ));
    }
    let format = if codec == Codec::Jpeg {
        Pixel::YUVJ420P
    } else {
        Pixel::YUV420P
    };
    // Devices interleave chroma.
    if frame.format() != format && frame.format() != Pixel::NV12 {
        return Err(format!(
            "the pixel format is {:?}, expected {format:?}",
            frame.format()
        ));
    }
    // What a pack's colours mean stands in its description alone.
    if codec != Codec::Jpeg && frame.color_range() == color::Range::JPEG {
        return Err("it says that it is full range, expected no range".to_owned());
    }
    if frame.is_corrupt() || frame.has_decode_errors() {
        return Err("the decoder had to guess parts of the picture".to_owned());
    }
    Ok(())
}
