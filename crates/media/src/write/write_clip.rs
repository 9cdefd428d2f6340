//! How do pictures become a plain video file?

use std::path::Path;

use av::color;
use av::format::Pixel;
use ffmpeg_next as av;
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::view::picture::{Colour, Matrix, Picture};

use crate::error::MediaError;
use crate::ffmpeg::start;
use crate::read::frame::frame_from_picture;
use crate::tiles::encode_settings::Speed;
use crate::tiles::encoder::{fixed_quantiser, new_encoder, set_fixed_quality, vp9_options};
use crate::write::frame_file::{FrameFile, ReadyEncoder, not_written};

/// Key frames of a clip in codecs that predict, frames apart: a player can jump twice a second.
const CLIP_KEY_DISTANCE: u32 = 15;

/// Below this, FFmpeg's FFV1 writes pictures in slices that it reads back as zeros; pixels.
const SMALLEST_SLICED_SIDE: u32 = 16;

/// How a clip is coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClipCodec {
    /// Lossless, for generated scenes.
    Ffv1,
    /// Motion JPEG with this quantiser, 1 (finest) to 31; full range only.
    Mjpeg(u8),
    /// VP9 with this fixed quantiser, 0 (finest) to 63.
    Vp9(u8),
    /// H.264 with this fixed quantiser, 0 (lossless) to 51; even sizes only. FFmpeg needs libx264.
    H264(u8),
}

/// What every picture of a clip shares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClipFormat {
    /// Codec of the file's only stream.
    pub codec: ClipCodec,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Frames a second as numerator and denominator, both positive.
    pub frame_rate: [i32; 2],
    /// Colour of the pictures, written into the file.
    pub colour: Colour,
}

/// A video file being written; the ending of its name chooses the container (.mkv, .mp4, .mov, ..).
pub struct ClipWriter {
    file: FrameFile,
    format: ClipFormat,
}

impl ClipWriter {
    /// Creates the file, replacing one of that name.
    ///
    /// # Errors
    /// The file cannot be created, its ending names no container, or the encoder refuses the size,
    /// the quantiser or the colour.
    pub fn create(path: &Path, format: &ClipFormat) -> Result<Self, MediaError> {
        let encoder = clip_encoder(format).map_err(|reason| not_written(path, 0, reason))?;
        Ok(Self {
            file: FrameFile::create(path, encoder, &[])?,
            format: *format,
        })
    }

    /// Appends a picture, one frame after the last.
    ///
    /// # Errors
    /// The picture has another size, or the file cannot be written.
    pub fn push(&mut self, picture: &Picture) -> Result<(), MediaError> {
        self.push_at(picture, self.file.frames())
    }

    /// Appends a picture that is shown at tick `tick` of the frame rate, which must rise.
    ///
    /// # Errors
    /// The picture has another size, the tick does not rise, or the file cannot be written.
    pub fn push_at(&mut self, picture: &Picture, tick: u64) -> Result<(), MediaError> {
        let size = [picture.width, picture.height];
        if size != self.format.size || !picture.is_consistent() {
            let [w, h] = self.format.size;
            return Err(MediaError::Setting {
                field: format!("the size of picture {} of the clip", self.file.frames()),
                found: format!("{} x {}", size[0], size[1]),
                expected: format!("{w} x {h} with planes of that size"),
            });
        }
        let frame = frame_from_picture(picture, pixel_format(&self.format));
        let frame = frame.map_err(|reason| self.file.not_written(reason))?;
        self.file.push(frame, tick)
    }

    /// Writes what the encoder still holds and the end of the file.
    ///
    /// # Errors
    /// The file cannot be written, or holds no picture.
    pub fn finish(self) -> Result<(), MediaError> {
        self.file.finish()
    }
}

fn clip_encoder(format: &ClipFormat) -> Result<ReadyEncoder, String> {
    start();
    let (name, quality, most) = match format.codec {
        ClipCodec::Ffv1 => ("ffv1", 0, 0),
        ClipCodec::Mjpeg(q) => ("mjpeg", q, 31),
        ClipCodec::Vp9(q) => ("libvpx-vp9", q, 63),
        ClipCodec::H264(q) => ("libx264", q, 51),
    };
    if quality > most {
        return Err(format!(
            "the quantiser is {quality}, the highest of {name} is {most}"
        ));
    }
    if matches!(format.codec, ClipCodec::Mjpeg(_)) && !format.colour.full_range {
        return Err("motion JPEG holds full-range pictures only".to_owned());
    }
    if format.frame_rate.iter().any(|n| *n <= 0) {
        return Err(format!(
            "the frame rate is {:?}, expected positive numbers",
            format.frame_rate
        ));
    }
    let (codec, mut video) =
        new_encoder(name, pixel_format(format), format.size, format.frame_rate)?;
    video.set_colorspace(match format.colour.matrix {
        Matrix::Bt601 => color::Space::SMPTE170M,
        Matrix::Bt709 => color::Space::BT709,
        Matrix::Bt2020 => color::Space::BT2020NCL,
    });
    let full = format.colour.full_range;
    video.set_color_range(if full {
        color::Range::JPEG
    } else {
        color::Range::MPEG
    });
    video.set_gop(CLIP_KEY_DISTANCE);
    let options = match format.codec {
        ClipCodec::Ffv1 => vec![("level", ffv1_level(format.size).to_string())],
        ClipCodec::Mjpeg(q) => {
            set_fixed_quality(&mut video, q.max(1));
            Vec::new()
        }
        ClipCodec::Vp9(q) => {
            set_fixed_quality(&mut video, q);
            [vp9_options(Speed::Default), fixed_quantiser(Codec::Vp9, q)].concat()
        }
        ClipCodec::H264(q) => {
            video.set_max_b_frames(2);
            vec![("qp", q.to_string()), ("preset", "veryfast".to_owned())]
        }
    };
    Ok(ReadyEncoder {
        codec,
        video,
        options,
    })
}

/// Level 3 checks its samples by slices, which the smallest pictures cannot fill.
fn ffv1_level(size: [u32; 2]) -> u32 {
    if size.iter().any(|side| *side < SMALLEST_SLICED_SIDE) {
        1
    } else {
        3
    }
}

fn pixel_format(format: &ClipFormat) -> Pixel {
    match format.codec {
        ClipCodec::Mjpeg(_) => Pixel::YUVJ420P,
        _ => Pixel::YUV420P,
    }
}
