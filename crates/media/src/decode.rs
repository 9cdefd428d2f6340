//! How does an access unit become a picture again?

use av::format::Pixel;
use av::frame::Video;
use av::{Packet, codec, color, decoder};
use ffmpeg_next as av;
use foveal_core::asset::codec::Codec;
use foveal_core::asset::key_frame::is_key_frame;
use foveal_core::asset::picture::Picture;

use crate::error::MediaError;
use crate::ffmpeg::{start, wants_more};
use crate::frame::picture_from_frame;
use crate::stacked_png::picture_from_png;

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
        let decoder = match codec {
            Codec::Vp8 => Some("vp8"),
            Codec::Vp9 => Some("vp9"),
            Codec::H264 => Some("h264"),
            Codec::Hevc => Some("hevc"),
            Codec::Av1 => Some("libdav1d"),
            Codec::Jpeg => Some("mjpeg"),
            Codec::Png => None,
        };
        let decoder = decoder.map(|name| open_decoder(name, codec.coded_size(size)));
        let decoder = decoder.transpose().map_err(|reason| MediaError::Setting {
            field: format!("the {} decoder of this FFmpeg", codec.name()),
            found: reason,
            expected: "an FFmpeg that was built with it (`ffmpeg -decoders` lists them); install \
                       one, or prepare the pack with another --codec"
                .to_owned(),
        })?;
        Ok(Self {
            codec,
            size,
            decoder,
            started: false,
        })
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
    /// decoder beside it: the caller compares it with the one that it gave in.
    ///
    /// # Errors
    /// Damaged data, a first access unit that is no key frame, a picture of another size or format,
    /// or anything but one picture. The decoder then waits for a key frame.
    pub fn decode(
        &mut self,
        access_unit: &[u8],
        frame_number: i64,
    ) -> Result<(Picture, i64), MediaError> {
        let decoded = self.decode_checked(access_unit, frame_number);
        if decoded.is_err() {
            self.restart();
        }
        decoded.map_err(|reason| MediaError::AccessUnit {
            codec: self.codec.name(),
            frame: frame_number,
            reason,
        })
    }

    fn decode_checked(&mut self, unit: &[u8], number: i64) -> Result<(Picture, i64), String> {
        let size = self.size;
        let Some(decoder) = &mut self.decoder else {
            return Ok((picture_from_png(unit, size)?, number));
        };
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
        let coded_size = self.codec.coded_size(size);
        check_frame(&frame, self.codec, coded_size)?;
        let out = frame.pts().ok_or("the picture lost its frame number")?;
        let mut picture = picture_from_frame(&frame)?;
        if coded_size != size {
            picture = picture.crop([0, 0], size);
        }
        self.started = true;
        Ok((picture, out))
    }
}

fn open_decoder(name: &str, size: [u32; 2]) -> Result<decoder::Video, String> {
    let codec = decoder::find_by_name(name).ok_or_else(|| format!("no {name}"))?;
    let mut context = codec::Context::new_with_codec(codec);
    context.set_threading(codec::threading::Config::count(1));
    // dav1d and others then hold nothing back.
    context.set_flags(codec::Flags::LOW_DELAY);
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
    if frame.format() != format {
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
