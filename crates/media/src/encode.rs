//! How do pictures become one closed group of access units?
//!
//! A fresh encoder for every group, so that a group is a pure function of its pictures and its
//! settings: libvpx carries search thresholds and its golden-frame cadence across forced keys.

use av::encoder::video::{Encoder, Video};
use av::format::Pixel;
use av::{Packet, codec, picture};
use ffmpeg_next as av;
use foveal_core::asset::codec::Codec;
use foveal_core::asset::picture::Picture;

use crate::error::MediaError;
use crate::ffmpeg::{open_encoder, start, wants_more};
use crate::frame::frame_from_picture;
use crate::stacked_png::png_from_picture;

/// Longer than any group: the only key frame is the one that is asked for.
const NO_OWN_KEYS: u32 = 9999;
/// The largest side that VP9 and JPEG can code, in pixels.
const LARGEST_SIDE: u32 = 65535;

/// How much time the encoder takes for smaller files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Speed {
    /// About twice as fast and 10 % larger (libvpx cpu-used 8).
    Fast,
    /// The knee of the curve (libvpx cpu-used 5).
    #[default]
    Default,
    /// About three times slower and 15 % smaller (libvpx cpu-used 4).
    Small,
}

/// How a group is coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncodeSettings {
    /// Codec of the access units.
    pub codec: Codec,
    /// The fixed quantiser, lower is finer: VP9 0–63, JPEG 1–31; PNG is lossless and ignores it.
    pub quality: u8,
    /// Frames a second as numerator and denominator, both positive.
    pub frame_rate: [i32; 2],
    /// Time against size.
    pub speed: Speed,
}

/// Codes the pictures as one closed group: one access unit for each picture, in their order, of
/// which only the first is a key frame (each one, for JPEG and PNG).
///
/// The same pictures and settings give the same bytes in one build of FFmpeg. JPEG takes its planes
/// as full range. Costs 2–4 ms for a VP9 encoder, then about 30 MPix/s at [`Speed::Default`].
///
/// ```
/// use foveal_core::asset::{codec::Codec, picture::Picture};
/// use foveal_media::{EncodeSettings, Speed, encode_group};
///
/// let grey = Picture::filled(64, 48, [128, 128, 128]);
/// let speed = Speed::Default;
/// let settings = EncodeSettings { codec: Codec::Png, quality: 0, frame_rate: [30, 1], speed };
/// let units = encode_group(&settings, &[grey.clone(), grey])?;
/// assert_eq!(units.len(), 2);
/// # Ok::<(), foveal_media::MediaError>(())
/// ```
///
/// # Errors
/// No picture, pictures of different or absurd sizes, a quality or a frame rate out of range, or an
/// encoder that is missing or does not answer each picture with one access unit.
pub fn encode_group(
    settings: &EncodeSettings,
    pictures: &[Picture],
) -> Result<Vec<Vec<u8>>, MediaError> {
    start();
    let size = check_pictures(pictures)?;
    check_settings(settings)?;
    let failed = |picture, reason| MediaError::Encode {
        codec: settings.codec.name(),
        picture,
        reason,
    };
    if settings.codec == Codec::Png {
        let compression = match settings.speed {
            Speed::Fast => png::Compression::Fast,
            Speed::Default => png::Compression::Balanced,
            Speed::Small => png::Compression::High,
        };
        let coded = pictures.iter().enumerate().map(|(i, picture)| {
            png_from_picture(picture, compression).map_err(|reason| failed(i, reason))
        });
        return coded.collect();
    }
    let mut encoder = open_group_encoder(settings, size).map_err(|reason| failed(0, reason))?;
    let mut units = Vec::with_capacity(pictures.len());
    for (i, picture) in pictures.iter().enumerate() {
        let is_key = i == 0 || settings.codec.is_intra();
        let unit = encode_one(&mut encoder, picture, i, is_key);
        units.push(unit.map_err(|reason| failed(i, reason))?);
    }
    expect_silence(&mut encoder).map_err(|reason| failed(pictures.len() - 1, reason))?;
    Ok(units)
}

/// The size that all pictures share.
fn check_pictures(pictures: &[Picture]) -> Result<[u32; 2], MediaError> {
    let refused = |field: String, found: String, expected: &str| MediaError::Setting {
        field,
        found,
        expected: expected.to_owned(),
    };
    let Some(first) = pictures.first() else {
        return Err(refused(
            "the group".to_owned(),
            "empty".to_owned(),
            "at least one picture",
        ));
    };
    let size = [first.width, first.height];
    if size.iter().any(|side| !(1..=LARGEST_SIDE).contains(side)) {
        let found = format!("{} x {}", size[0], size[1]);
        return Err(refused(
            "the size of picture 0".to_owned(),
            found,
            "sides of 1 to 65535",
        ));
    }
    for (i, picture) in pictures.iter().enumerate() {
        if [picture.width, picture.height] != size || !picture.is_consistent() {
            let found = format!("{} x {}", picture.width, picture.height);
            let expected = format!("{} x {} with planes of that size", size[0], size[1]);
            return Err(refused(
                format!("the size of picture {i}"),
                found,
                &expected,
            ));
        }
    }
    Ok(size)
}

fn check_settings(settings: &EncodeSettings) -> Result<(), MediaError> {
    let range = match settings.codec {
        Codec::Vp9 => 0..=63,
        Codec::Jpeg => 1..=31,
        Codec::Png => 0..=255,
    };
    if !range.contains(&settings.quality) {
        return Err(MediaError::Setting {
            field: format!("the {} quality", settings.codec.name()),
            found: settings.quality.to_string(),
            expected: format!("{} to {}", range.start(), range.end()),
        });
    }
    if settings.frame_rate.iter().any(|n| *n <= 0) {
        return Err(MediaError::Setting {
            field: "the frame rate".to_owned(),
            found: format!("{}/{}", settings.frame_rate[0], settings.frame_rate[1]),
            expected: "two positive numbers".to_owned(),
        });
    }
    Ok(())
}

fn open_group_encoder(settings: &EncodeSettings, size: [u32; 2]) -> Result<Encoder, String> {
    let (name, format) = match settings.codec {
        Codec::Vp9 => ("libvpx-vp9", Pixel::YUV420P),
        _ => ("mjpeg", Pixel::YUVJ420P),
    };
    let (codec, mut video) = new_encoder(name, format, size, settings.frame_rate)?;
    // Without it, every JPEG carries the name and version of the encoder.
    video.set_flags(codec::Flags::BITEXACT);
    set_fixed_quality(&mut video, settings.quality);
    let options = match settings.codec {
        Codec::Vp9 => vp9_options(settings.quality, settings.speed),
        _ => Vec::new(),
    };
    open_encoder(video, codec, &options)
}

/// An encoder of one thread with its size, format and clock, not yet open; the clock ticks once a
/// frame.
pub(crate) fn new_encoder(
    name: &str,
    format: Pixel,
    [width, height]: [u32; 2],
    frame_rate: [i32; 2],
) -> Result<(av::Codec, Video), String> {
    let codec = av::encoder::find_by_name(name)
        .ok_or_else(|| format!("this FFmpeg has no encoder named {name}"))?;
    let mut context = codec::Context::new_with_codec(codec);
    context.set_threading(codec::threading::Config::count(1));
    let mut video = context.encoder().video().map_err(|e| e.to_string())?;
    video.set_width(width);
    video.set_height(height);
    video.set_format(format);
    video.set_time_base((frame_rate[1], frame_rate[0]));
    video.set_frame_rate(Some((frame_rate[0], frame_rate[1])));
    video.set_gop(NO_OWN_KEYS);
    video.set_max_b_frames(0);
    Ok((codec, video))
}

/// One quantiser for all frames: for mjpeg the only setting that works through the library.
pub(crate) fn set_fixed_quality(video: &mut Video, quality: u8) {
    video.set_qmin(i32::from(quality));
    video.set_qmax(i32::from(quality));
}

/// libvpx in one pass without delay, hidden frames or anything else that outlives a frame.
pub(crate) fn vp9_options(quality: u8, speed: Speed) -> Vec<(&'static str, String)> {
    let cpu_used = match speed {
        Speed::Fast => 8,
        Speed::Default => 5,
        Speed::Small => 4,
    };
    vec![
        ("deadline", "realtime".to_owned()),
        ("cpu-used", cpu_used.to_string()),
        ("lag-in-frames", "0".to_owned()),
        ("auto-alt-ref", "0".to_owned()),
        ("aq-mode", "0".to_owned()),
        ("row-mt", "0".to_owned()),
        ("tile-columns", "0".to_owned()),
        // Bit rate 0 makes crf the constant-quality mode; qmin = qmax keeps it from pulsing.
        ("b", "0".to_owned()),
        ("crf", quality.to_string()),
    ]
}

/// Codes one picture and takes the one access unit that it gives.
fn encode_one(
    encoder: &mut Encoder,
    picture: &Picture,
    index: usize,
    is_key: bool,
) -> Result<Vec<u8>, String> {
    // The encoders read past the planes of a frame that is smaller than they expect.
    if [encoder.width(), encoder.height()] != [picture.width, picture.height] {
        return Err("the picture has not the encoder's size".to_owned());
    }
    let mut frame = frame_from_picture(picture, encoder.format())?;
    frame.set_kind(if index == 0 {
        picture::Type::I
    } else {
        picture::Type::None
    });
    frame.set_pts(i64::try_from(index).ok());
    encoder.send_frame(&frame).map_err(|e| e.to_string())?;
    let mut packet = Packet::empty();
    encoder
        .receive_packet(&mut packet)
        .map_err(|e| format!("no access unit: {e}"))?;
    if packet.is_key() != is_key {
        return Err(format!(
            "its key flag is {}, expected {is_key}",
            packet.is_key()
        ));
    }
    match packet.data() {
        Some(data) if !data.is_empty() => Ok(data.to_vec()),
        _ => Err("its access unit is empty".to_owned()),
    }
}

/// Checks that the encoder kept nothing back.
fn expect_silence(encoder: &mut Encoder) -> Result<(), String> {
    encoder.send_eof().map_err(|e| e.to_string())?;
    match encoder.receive_packet(&mut Packet::empty()) {
        Err(av::Error::Eof) => Ok(()),
        Err(e) if wants_more(e) => Ok(()),
        Err(e) => Err(e.to_string()),
        Ok(()) => Err("more access units than pictures".to_owned()),
    }
}
