//! How is an AVIF picture read with all that its file says of it?
//!
//! FFmpeg reads the coded picture alone: tiles, alpha, turns and mirrors stand in boxes that it
//! passes over.

use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::{Path, PathBuf};

use av::codec::{Id, context::Context};
use av::format::Pixel;
use av::frame::Video;
use av::{Packet, color, ffi};
use ffmpeg_next as av;
use foveal_core::view::picture::{Colour, Picture};

use crate::error::MediaError;
use crate::ffmpeg::start;
use crate::plain_file::open_plain;
use crate::read::convert::{Converter, Layout};
use crate::read::deliver::{FrameConversion, layout_of};
use crate::read::frame::new_frame;
use crate::read::source::{SourceInfo, Transparency};
use crate::read::still::heif_boxes::{Heif, Tiled, bytes_of, read_heif};
use crate::read::still::still_tags::StillTags;
use crate::surround::photo_sphere::PhotoSphere;

/// Most bytes of a coded picture, or of what describes it.
const MOST_CODED: u64 = 1 << 28;
const MOST_XMP: u64 = 1 << 20;
/// Most pixels of a picture: what FFmpeg takes.
const MOST_PIXELS: u64 = (i32::MAX / 8) as u64;

/// An open AVIF picture, read once.
pub(crate) struct HeifStill {
    info: SourceInfo,
    picture: Option<Picture>,
}

impl HeifStill {
    /// Opens and reads an AVIF picture; `None` for a file of another kind. A picture of HEIF that
    /// is coded otherwise is refused with what converts it.
    pub(crate) fn open(path: &Path, bytes: u64) -> Result<Option<Self>, MediaError> {
        let Ok((file, _)) = open_plain(path) else {
            return Ok(None);
        };
        let mut file = BufReader::new(file);
        let Some(heif) = read_heif(&mut file) else {
            return Ok(None);
        };
        let broken = |reason| MediaError::NotVideo {
            path: path.to_owned(),
            reason,
        };
        let heif = heif.map_err(broken)?;
        if heif.coding != *b"av01" {
            return Err(refused(path.to_owned(), heif.coding));
        }
        let shown = Shown::read(&mut file, heif).map_err(|reason| MediaError::NoFrames {
            path: path.to_owned(),
            reason,
        })?;
        let (heif, picture) = (&shown.heif, &shown.picture);
        let tags = StillTags {
            orientation: heif.orientation,
            photo_sphere: shown.photo_sphere,
            broken: heif.passed_over.clone(),
            notes: shown.notes.clone(),
            ..StillTags::default()
        };
        let aspect = heif.pixel_aspect.map(|sides| sides.map(|side| side as i32));
        let aspect = aspect.filter(|[w, h]| *w > 0 && *h > 0 && w != h && w / h < 8 && h / w < 8);
        let size = [picture.width, picture.height];
        let names = ("av1", shown.format.as_str());
        let info = SourceInfo {
            transparency: shown.is_clear.then_some(Transparency::OverBlack),
            pixel_aspect: aspect.map(|[w, h]| match heif.orientation.transpose {
                true => [h, w],
                false => [w, h],
            }),
            is_hdr: shown.is_hdr,
            ..SourceInfo::of_still(size, shown.colour, names, tags, bytes)
        };
        Ok(Some(Self {
            info,
            picture: Some(shown.picture),
        }))
    }

    /// What is known of it.
    pub(crate) fn info(&self) -> &SourceInfo {
        &self.info
    }

    /// The picture; `None` when it has been taken.
    pub(crate) fn picture(&mut self) -> Option<Picture> {
        self.picture.take()
    }
}

fn refused(path: PathBuf, coding: [u8; 4]) -> MediaError {
    let is_heic = [b"hvc1", b"hev1", b"lhv1"].contains(&&coding);
    let found = match is_heic {
        true => "HEIC, as phones store it".to_owned(),
        false => format!("HEIF coded as {}", coding.escape_ascii()),
    };
    MediaError::Unsupported {
        path,
        field: "the format of the picture",
        found,
        next: "convert it with `heif-convert FILE OUT.png` or `magick FILE OUT.png`",
    }
}

/// A picture as it is seen.
struct Shown {
    heif: Heif,
    picture: Picture,
    colour: Colour,
    format: String,
    is_clear: bool,
    is_hdr: bool,
    photo_sphere: Option<PhotoSphere>,
    /// Which parts of it are not shown.
    notes: Vec<String>,
}

impl Shown {
    fn read(file: &mut BufReader<File>, mut heif: Heif) -> Result<Self, String> {
        start();
        let mut frame = frame_of(file, &heif.picture)?;
        if let Some((matrix, is_full)) = heif.colour {
            tell_colour(&mut frame, matrix, is_full);
        }
        let mut seen = None;
        if let Some((alpha, is_multiplied)) = heif.alpha.clone() {
            let with = frame_of(file, &alpha).and_then(|alpha| with_alpha(&frame, &alpha));
            match with {
                Ok(with) if !is_multiplied => seen = Some(with),
                // Colours that are multiplied already lie over black.
                Ok(_) => {}
                Err(why) => heif
                    .passed_over
                    .push(format!("its transparency is not read: {why}")),
            }
        }
        let mut notes = Vec::new();
        if heif.is_series {
            notes.push(
                "it is an animation, whose first picture is shown; `ffmpeg -i FILE OUT.mp4` of \
                 FFmpeg 7 or later makes a film of it"
                    .to_owned(),
            );
        }
        let layout = layout_of(&frame, false)?;
        let mut conversion = FrameConversion::new(&frame, heif.orientation, false)?;
        let colour = conversion.colour();
        let picture = conversion.picture(seen.as_ref().unwrap_or(&frame))?;
        let xmp = heif
            .xmp
            .as_ref()
            .and_then(|it| bytes_of(file, it, MOST_XMP).ok());
        let photo_sphere = xmp.and_then(|it| PhotoSphere::of_xmp(&it).ok()).flatten();
        Ok(Self {
            heif,
            colour,
            format: layout
                .format
                .descriptor()
                .map_or("unknown", |d| d.name())
                .to_owned(),
            is_clear: conversion.has_seen_through(),
            is_hdr: matches!(
                frame.color_transfer_characteristic(),
                color::TransferCharacteristic::SMPTE2084
                    | color::TransferCharacteristic::ARIB_STD_B67
            ),
            picture,
            photo_sphere,
            notes,
        })
    }
}

/// Matrix and range by the numbers of H.273, where they are usual ones.
fn tell_colour(frame: &mut Video, matrix: u16, is_full: bool) {
    let space = match matrix {
        0 => color::Space::RGB,
        1 => color::Space::BT709,
        5 => color::Space::BT470BG,
        6 => color::Space::SMPTE170M,
        9 => color::Space::BT2020NCL,
        _ => frame.color_space(),
    };
    frame.set_color_space(space);
    frame.set_color_range(match is_full {
        true => color::Range::JPEG,
        false => color::Range::MPEG,
    });
}

/// The pictures of all tiles, put together.
fn frame_of(file: &mut BufReader<File>, tiled: &Tiled) -> Result<Video, String> {
    let mut whole: Option<Video> = None;
    for (number, tile) in tiled.tiles.iter().enumerate() {
        let frame = decoded(file, tile)?;
        let Some(size) = tiled.size else {
            return Ok(frame);
        };
        let side = [frame.width(), frame.height()];
        let whole = match &mut whole {
            Some(whole) => whole,
            none => none.insert(canvas(&frame, size)?),
        };
        if frame.format() != whole.format() {
            return Err("its tiles are coded in different ways".to_owned());
        }
        let at = [number % tiled.columns, number / tiled.columns];
        lay(whole, &frame, [0, 1].map(|k| at[k] as u32 * side[k]))?;
    }
    whole.ok_or_else(|| "it has no tile".to_owned())
}

/// An empty frame of a size, of the same kind as a tile.
fn canvas(tile: &Video, size: [u32; 2]) -> Result<Video, String> {
    let [w, h] = size.map(u64::from);
    if w * h > MOST_PIXELS {
        return Err(format!("it has {w}x{h} pixels, more than {MOST_PIXELS}"));
    }
    let mut whole = new_frame(tile.format(), size)?;
    whole.set_color_space(tile.color_space());
    whole.set_color_range(tile.color_range());
    Ok(whole)
}

/// Copies a tile to its place; what reaches beyond is cut off.
#[allow(unsafe_code)] // Lengths of rows have no safe call.
fn lay(whole: &mut Video, tile: &Video, at: [u32; 2]) -> Result<(), String> {
    let format = ffi::AVPixelFormat::from(whole.format());
    // SAFETY: reads a constant table.
    let bytes = |width: u32, p: usize| unsafe {
        usize::try_from(ffi::av_image_get_linesize(format, width as i32, p as i32)).unwrap_or(0)
    };
    let rows = whole
        .format()
        .descriptor()
        .map_or(0, |it| it.log2_chroma_h());
    for p in 0..whole.planes().min(tile.planes()) {
        let shift = if p == 1 || p == 2 { rows } else { 0 };
        let down = |side: u32| (side >> shift) as usize;
        let [left, length] = [bytes(at[0], p), bytes(tile.width(), p)];
        let most = bytes(whole.width(), p);
        let (from, to) = (tile.stride(p), whole.stride(p));
        let lines = tile.data(p).chunks(from).take(down(tile.height()));
        let height = down(whole.height() + (1 << shift) - 1);
        let target = whole
            .data_mut(p)
            .chunks_mut(to)
            .take(height)
            .skip(down(at[1]));
        for (to, from) in target.zip(lines) {
            let length = length.min(most.saturating_sub(left)).min(from.len());
            let target = to.get_mut(left..left + length);
            target
                .ok_or("a tile does not fit")?
                .copy_from_slice(&from[..length]);
        }
    }
    Ok(())
}

/// One coded picture.
fn decoded(file: &mut BufReader<File>, tile: &[Range<u64>]) -> Result<Video, String> {
    let bytes = bytes_of(file, tile, MOST_CODED)?;
    let codec = av::decoder::find(Id::AV1).ok_or("this FFmpeg has no decoder of AV1")?;
    let opened = Context::new_with_codec(codec).decoder().open_as(codec);
    let mut decoder = opened
        .and_then(|it| it.video())
        .map_err(|e| e.to_string())?;
    let sent = decoder
        .send_packet(&Packet::copy(&bytes))
        .and_then(|()| decoder.send_eof());
    sent.map_err(|e| e.to_string())?;
    let mut frame = Video::empty();
    decoder
        .receive_frame(&mut frame)
        .map_err(|e| e.to_string())?;
    if frame.is_corrupt() || frame.has_decode_errors() {
        return Err("a part of it is damaged".to_owned());
    }
    Ok(frame)
}

/// A frame with the luma of another as its alpha.
fn with_alpha(frame: &Video, alpha: &Video) -> Result<Video, String> {
    let size = [frame.width(), frame.height()];
    if [alpha.width(), alpha.height()] != size {
        return Err("it is of another size".to_owned());
    }
    let from = layout_of(frame, false)?;
    let to = Layout {
        format: Pixel::YUVA444P,
        full_range: from.full_range && frame.color_space() != color::Space::RGB,
        ..from
    };
    let mut whole = Converter::new(from, to)?.run(frame)?;
    let grey = Layout {
        format: Pixel::GRAY8,
        full_range: true,
        ..layout_of(alpha, false)?
    };
    let from = Layout {
        full_range: alpha.color_range() != color::Range::MPEG,
        ..layout_of(alpha, false)?
    };
    let grey = Converter::new(from, grey)?.run(alpha)?;
    let [stride, from] = [whole.stride(3), grey.stride(0)];
    let rows = whole
        .data_mut(3)
        .chunks_mut(stride)
        .zip(grey.data(0).chunks(from));
    for (to, from) in rows.take(size[1] as usize) {
        to[..size[0] as usize].copy_from_slice(&from[..size[0] as usize]);
    }
    whole.set_color_space(match frame.color_space() {
        color::Space::RGB => color::Space::Unspecified,
        space => space,
    });
    whole.set_color_range(match to.full_range {
        true => color::Range::JPEG,
        false => color::Range::MPEG,
    });
    Ok(whole)
}
