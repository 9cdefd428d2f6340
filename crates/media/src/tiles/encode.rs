//! How do pictures become one closed group of access units?
//!
//! A fresh encoder for every group, so that a group is a pure function of its pictures and its
//! settings: libvpx carries search thresholds and its golden-frame cadence across forced keys.

use av::encoder::video::Encoder;
use av::{Packet, picture};
use ffmpeg_next as av;
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::bytes::key_frame::{is_key_frame, nal_units};
use foveal_core::view::picture::Picture;
use std::borrow::Cow;

use crate::error::MediaError;
use crate::ffmpeg::{start, wants_more};
use crate::read::frame::frame_from_picture;
use crate::tiles::encode_settings::{EncodeSettings, Rate, Speed};
use crate::tiles::encoder::open_group_encoder;
use crate::tiles::ijg_jpeg::jpeg_from_picture;
use crate::tiles::rate_search::finest_that_fits;
use crate::tiles::stacked_png::png_from_picture;

/// The largest side that most codecs can code, in pixels.
const LARGEST_SIDE: u32 = 65535;
/// Network abstraction layer units that hold notes, among them the encoder's name and options.
const H264_NOTES: [u8; 1] = [6];
const HEVC_NOTES: [u8; 2] = [39, 40];

/// Bits per second that can be asked for.
const LEAST_BITS: u32 = 1000;
const MOST_BITS: u32 = 2_000_000_000;

/// Codes the pictures as one closed group: one access unit for each picture, in their order, of
/// which only the first is a key frame (each one, for JPEG and PNG).
///
/// The same pictures and settings give the same bytes in one build of FFmpeg. JPEG takes its planes
/// as full range. Pictures are coded at [`Codec::coded_size`], their borders repeated up to there.
/// Costs 2–4 ms for a VP9 encoder, then about 30 MPix/s at [`Speed::Default`].
///
/// ```
/// use foveal_core::content::video::bytes::codec::Codec;
/// use foveal_core::view::picture::Picture;
/// use foveal_media::{EncodeSettings, Rate, Speed, encode_group};
///
/// let grey = Picture::filled(64, 48, [128, 128, 128]);
/// let (rate, speed) = (Rate::Quantiser(0), Speed::Default);
/// let settings = EncodeSettings { codec: Codec::Png, rate, frame_rate: [30, 1], speed };
/// let units = encode_group(&settings, &[grey.clone(), grey])?;
/// assert_eq!(units.len(), 2);
/// # Ok::<(), foveal_media::MediaError>(())
/// ```
///
/// # Errors
/// No picture, pictures of different or absurd sizes, a rate or a frame rate out of range, or an
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
    if let Some(still) = still_encoder(settings) {
        let coded = pictures.iter().enumerate();
        return coded
            .map(|(i, picture)| still(picture).map_err(|reason| failed(i, reason)))
            .collect();
    }
    let at = |quantiser| code_at(settings, quantiser, size, pictures);
    match settings.rate {
        Rate::Quantiser(quantiser) | Rate::Ijg(quantiser) => at(quantiser),
        Rate::Bits(bits) => {
            let [frames, seconds] = settings.frame_rate.map(f64::from);
            let seconds = pictures.len() as f64 * seconds / frames;
            let budget = f64::from(bits) / 8.0 * seconds;
            finest_that_fits(settings.codec.highest_quantiser(), budget as usize, at)
        }
    }
}

/// Codes the group at one quantiser.
fn code_at(
    settings: &EncodeSettings,
    quantiser: u8,
    size: [u32; 2],
    pictures: &[Picture],
) -> Result<Vec<Vec<u8>>, MediaError> {
    let failed = |picture, reason| MediaError::Encode {
        codec: settings.codec.name(),
        picture,
        reason,
    };
    let coded_size = settings.codec.coded_size(size);
    let mut encoder =
        open_group_encoder(settings, quantiser, coded_size).map_err(|reason| failed(0, reason))?;
    let mut units = Vec::with_capacity(pictures.len());
    for (i, picture) in pictures.iter().enumerate() {
        let picture = if coded_size == size {
            Cow::Borrowed(picture)
        } else {
            Cow::Owned(picture.crop([0, 0], coded_size))
        };
        let unit = encode_one(&mut encoder, &picture, i, settings.codec);
        units.push(unit.map_err(|reason| failed(i, reason))?);
    }
    expect_silence(&mut encoder).map_err(|reason| failed(pictures.len() - 1, reason))?;
    Ok(units)
}

/// Codes one picture by itself.
type StillEncoder = Box<dyn Fn(&Picture) -> Result<Vec<u8>, String>>;

/// The encoder of what FFmpeg does not code.
fn still_encoder(settings: &EncodeSettings) -> Option<StillEncoder> {
    match (settings.codec, settings.rate) {
        (Codec::Png, _) => {
            let compression = match settings.speed {
                Speed::Fast => png::Compression::Fast,
                Speed::Default => png::Compression::Balanced,
                Speed::Small | Speed::Reference => png::Compression::High,
            };
            Some(Box::new(move |picture| {
                png_from_picture(picture, compression)
            }))
        }
        (Codec::Jpeg, Rate::Ijg(quality)) => {
            let is_small = matches!(settings.speed, Speed::Small | Speed::Reference);
            Some(Box::new(move |picture| {
                jpeg_from_picture(picture, quality, is_small)
            }))
        }
        _ => None,
    }
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
    let codec = settings.codec;
    let (what, found, range) = match settings.rate {
        Rate::Quantiser(q) => {
            let least = u32::from(codec == Codec::Jpeg);
            let range = least..=u32::from(codec.highest_quantiser());
            ("quality", u32::from(q), range)
        }
        Rate::Ijg(q) if codec == Codec::Jpeg => ("quality", u32::from(q), 1..=100),
        Rate::Bits(bits) if !codec.is_intra() => ("bit rate", bits, LEAST_BITS..=MOST_BITS),
        rate => {
            return Err(MediaError::Setting {
                field: format!("the {} rate", codec.name()),
                found: format!("{rate:?}"),
                expected: "a quantiser".to_owned(),
            });
        }
    };
    if !range.contains(&found) {
        return Err(MediaError::Setting {
            field: format!("the {} {what}", codec.name()),
            found: found.to_string(),
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

/// Codes one picture and takes the one access unit that it gives.
fn encode_one(
    encoder: &mut Encoder,
    picture: &Picture,
    index: usize,
    codec: Codec,
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
    let unit = match packet.data() {
        Some(data) if !data.is_empty() => without_notes(codec, data),
        _ => return Err("its access unit is empty".to_owned()),
    };
    let is_key = index == 0 || codec.is_intra();
    if is_key_frame(codec, &unit) != is_key || packet.is_key() != is_key {
        let expected = if is_key { "a" } else { "no" };
        return Err(format!("its access unit should be {expected} key frame"));
    }
    Ok(unit)
}

/// The access unit without what an encoder says about itself.
fn without_notes(codec: Codec, unit: &[u8]) -> Vec<u8> {
    let is_note = |nal: &&[u8]| match codec {
        Codec::H264 => H264_NOTES.contains(&(nal[0] & 31)),
        _ => HEVC_NOTES.contains(&(nal[0] >> 1 & 63)),
    };
    if !matches!(codec, Codec::H264 | Codec::Hevc) || !nal_units(unit).any(|nal| is_note(&nal)) {
        return unit.to_vec();
    }
    let kept = nal_units(unit).filter(|nal| !is_note(nal));
    kept.flat_map(|nal| [&[0, 0, 0, 1], nal].concat()).collect()
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
