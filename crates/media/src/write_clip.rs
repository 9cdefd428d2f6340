//! How do pictures become a plain video file?

use std::path::{Path, PathBuf};

use av::encoder::video::{Encoder, Video};
use av::format::Pixel;
use av::format::context::Output;
use av::{Packet, codec, color, format};
use ffmpeg_next as av;
use foveal_core::asset::picture::{Colour, Matrix, Picture};

use crate::encode::{Speed, new_encoder, set_fixed_quality, vp9_options};
use crate::error::MediaError;
use crate::ffmpeg::{open_encoder, path_for_ffmpeg, start, wants_more};
use crate::frame::frame_from_picture;

/// Key frames of a clip in codecs that predict, frames apart: a player can jump about twice a second.
const CLIP_KEY_DISTANCE: u32 = 15;

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
        Ok(Self { file: FrameFile::create(path, encoder, &[])?, format: *format })
    }

    /// Appends a picture, one frame after the last.
    ///
    /// # Errors
    /// The picture has another size, or the file cannot be written.
    pub fn push(&mut self, picture: &Picture) -> Result<(), MediaError> {
        self.push_at(picture, self.file.frames)
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
                field: format!("the size of picture {} of the clip", self.file.frames),
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

/// An encoder that is ready but for opening, which the container has a say in.
pub(crate) struct ReadyEncoder {
    pub(crate) codec: av::Codec,
    pub(crate) video: Video,
    pub(crate) options: Vec<(&'static str, String)>,
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
        return Err(format!("the quantiser is {quality}, the highest of {name} is {most}"));
    }
    if matches!(format.codec, ClipCodec::Mjpeg(_)) && !format.colour.full_range {
        return Err("motion JPEG holds full-range pictures only".to_owned());
    }
    if format.frame_rate.iter().any(|n| *n <= 0) {
        return Err(format!("the frame rate is {:?}, expected positive numbers", format.frame_rate));
    }
    let (codec, mut video) =
        new_encoder(name, pixel_format(format), format.size, format.frame_rate)?;
    video.set_colorspace(match format.colour.matrix {
        Matrix::Bt601 => color::Space::SMPTE170M,
        Matrix::Bt709 => color::Space::BT709,
        Matrix::Bt2020 => color::Space::BT2020NCL,
    });
    let full = format.colour.full_range;
    video.set_color_range(if full { color::Range::JPEG } else { color::Range::MPEG });
    video.set_gop(CLIP_KEY_DISTANCE);
    let options = match format.codec {
        ClipCodec::Ffv1 => vec![("level", "3".to_owned())],
        ClipCodec::Mjpeg(q) => {
            set_fixed_quality(&mut video, q.max(1));
            Vec::new()
        }
        ClipCodec::Vp9(q) => {
            set_fixed_quality(&mut video, q);
            vp9_options(q, Speed::Default)
        }
        ClipCodec::H264(q) => {
            video.set_max_b_frames(2);
            vec![("qp", q.to_string()), ("preset", "veryfast".to_owned())]
        }
    };
    Ok(ReadyEncoder { codec, video, options })
}

fn pixel_format(format: &ClipFormat) -> Pixel {
    match format.codec {
        ClipCodec::Mjpeg(_) => Pixel::YUVJ420P,
        _ => Pixel::YUV420P,
    }
}

fn not_written(path: &Path, frame: u64, reason: String) -> MediaError {
    MediaError::Write { path: path.to_owned(), frame, reason }
}

/// A video file of one stream being written from FFmpeg frames.
pub(crate) struct FrameFile {
    path: PathBuf,
    output: Output,
    encoder: Encoder,
    frames: u64,
}

impl FrameFile {
    /// Creates the file; `side_data` are kinds and bytes that describe the stream.
    pub(crate) fn create(
        path: &Path,
        ready: ReadyEncoder,
        side_data: &[(av::ffi::AVPacketSideDataType, Vec<u8>)],
    ) -> Result<Self, MediaError> {
        start();
        let failed = |reason: String| not_written(path, 0, reason);
        let absolute = path_for_ffmpeg(path).map_err(failed)?;
        let mut output = format::output(&absolute).map_err(|e| failed(e.to_string()))?;
        let ReadyEncoder { codec, mut video, options } = ready;
        if output.format().flags().contains(format::Flags::GLOBAL_HEADER) {
            video.set_flags(codec::Flags::GLOBAL_HEADER);
        }
        let time_base = video.time_base();
        let encoder = open_encoder(video, codec, &options).map_err(failed)?;
        let mut stream = output.add_stream_with(&encoder).map_err(|e| failed(e.to_string()))?;
        stream.set_time_base(time_base);
        stream.set_avg_frame_rate(encoder.frame_rate());
        for (kind, bytes) in side_data {
            add_side_data(&mut stream, *kind, bytes).map_err(failed)?;
        }
        // Matroska otherwise writes random identifiers.
        let mut options = av::Dictionary::new();
        options.set("fflags", "+bitexact");
        options.set("strict", "unofficial");
        output.write_header_with(options).map_err(|e| failed(e.to_string()))?;
        Ok(Self { path: path.to_owned(), output, encoder, frames: 0 })
    }

    /// Appends a frame that is shown at this tick of the encoder's clock.
    pub(crate) fn push(&mut self, mut frame: av::frame::Video, tick: u64) -> Result<(), MediaError> {
        frame.set_pts(i64::try_from(tick).ok());
        self.encoder.send_frame(&frame).map_err(|e| self.not_written(e.to_string()))?;
        self.frames += 1;
        self.write_packets()
    }

    /// Writes what the encoder still holds and the end of the file.
    pub(crate) fn finish(mut self) -> Result<(), MediaError> {
        if self.frames == 0 {
            return Err(self.not_written("no picture was given".to_owned()));
        }
        self.encoder.send_eof().map_err(|e| self.not_written(e.to_string()))?;
        self.write_packets()?;
        self.output.write_trailer().map_err(|e| self.not_written(e.to_string()))
    }

    fn write_packets(&mut self) -> Result<(), MediaError> {
        loop {
            let mut packet = Packet::empty();
            match self.encoder.receive_packet(&mut packet) {
                Ok(()) => self.write(packet).map_err(|e| self.not_written(e.to_string()))?,
                Err(av::Error::Eof) => return Ok(()),
                Err(e) if wants_more(e) => return Ok(()),
                Err(e) => return Err(self.not_written(e.to_string())),
            }
        }
    }

    fn write(&mut self, mut packet: Packet) -> Result<(), av::Error> {
        let stream = self.output.stream(0).ok_or(av::Error::StreamNotFound)?;
        // Without it, the last frame of an MP4 would last no time.
        packet.set_duration(1);
        packet.rescale_ts(self.encoder.time_base(), stream.time_base());
        packet.set_stream(0);
        packet.write_interleaved(&mut self.output)
    }

    fn not_written(&self, reason: String) -> MediaError {
        not_written(&self.path, self.frames, reason)
    }
}

#[allow(unsafe_code)] // ffmpeg-next reads a stream's side data but cannot add to it.
fn add_side_data(
    stream: &mut format::stream::StreamMut,
    kind: av::ffi::AVPacketSideDataType,
    bytes: &[u8],
) -> Result<(), String> {
    // SAFETY: the stream is alive; the call returns null or `bytes.len()` writable bytes that the
    // stream owns.
    unsafe {
        let room = av::ffi::av_stream_new_side_data(stream.as_mut_ptr(), kind, bytes.len());
        if room.is_null() {
            return Err("no memory for side data".to_owned());
        }
        std::ptr::copy_nonoverlapping(bytes.as_ptr(), room, bytes.len());
    }
    Ok(())
}
