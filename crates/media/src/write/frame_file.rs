//! How do frames become a file with one video stream?

use std::path::{Path, PathBuf};

use av::encoder::video::{Encoder, Video};
use av::format::context::Output;
use av::{Packet, codec, format};
use ffmpeg_next as av;

use crate::error::MediaError;
use crate::ffmpeg::{open_encoder, path_for_ffmpeg, start, wants_more};

/// An encoder that is ready but for opening, which the container has a say in.
pub(crate) struct ReadyEncoder {
    /// The encoder.
    pub(crate) codec: av::Codec,
    /// Its settings.
    pub(crate) video: Video,
    /// Its own options.
    pub(crate) options: Vec<(&'static str, String)>,
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
        let ReadyEncoder {
            codec,
            mut video,
            options,
        } = ready;
        if output
            .format()
            .flags()
            .contains(format::Flags::GLOBAL_HEADER)
        {
            video.set_flags(codec::Flags::GLOBAL_HEADER);
        }
        let time_base = video.time_base();
        let encoder = open_encoder(video, codec, &options).map_err(failed)?;
        let mut stream = output
            .add_stream_with(&encoder)
            .map_err(|e| failed(e.to_string()))?;
        stream.set_time_base(time_base);
        stream.set_avg_frame_rate(encoder.frame_rate());
        for (kind, bytes) in side_data {
            add_side_data(&mut stream, *kind, bytes).map_err(failed)?;
        }
        // Matroska otherwise writes random identifiers.
        let mut options = av::Dictionary::new();
        options.set("fflags", "+bitexact");
        // MP4 writes projection and stereo only if asked for what is not in its standard.
        options.set("strict", "unofficial");
        // The index of an MP4 comes first, so that a browser can start at once.
        options.set("movflags", "+faststart");
        output
            .write_header_with(options)
            .map_err(|e| failed(e.to_string()))?;
        Ok(Self {
            path: path.to_owned(),
            output,
            encoder,
            frames: 0,
        })
    }

    /// Appends a frame that is shown at this tick of the encoder's clock.
    pub(crate) fn push(
        &mut self,
        mut frame: av::frame::Video,
        tick: u64,
    ) -> Result<(), MediaError> {
        frame.set_pts(i64::try_from(tick).ok());
        self.encoder
            .send_frame(&frame)
            .map_err(|e| self.not_written(e.to_string()))?;
        self.frames += 1;
        self.write_packets()
    }

    /// Writes what the encoder still holds and the end of the file.
    pub(crate) fn finish(mut self) -> Result<(), MediaError> {
        if self.frames == 0 {
            return Err(self.not_written("no picture was given".to_owned()));
        }
        self.encoder
            .send_eof()
            .map_err(|e| self.not_written(e.to_string()))?;
        self.write_packets()?;
        self.output
            .write_trailer()
            .map_err(|e| self.not_written(e.to_string()))
    }

    fn write_packets(&mut self) -> Result<(), MediaError> {
        loop {
            let mut packet = Packet::empty();
            match self.encoder.receive_packet(&mut packet) {
                Ok(()) => self
                    .write(packet)
                    .map_err(|e| self.not_written(e.to_string()))?,
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

    /// Number of frames given so far.
    pub(crate) fn frames(&self) -> u64 {
        self.frames
    }

    /// The error of this file at the frame that comes next.
    pub(crate) fn not_written(&self, reason: String) -> MediaError {
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

/// The error of a file that cannot be written at this frame.
pub(crate) fn not_written(path: &Path, frame: u64, reason: String) -> MediaError {
    MediaError::Write {
        path: path.to_owned(),
        frame,
        reason,
    }
}
