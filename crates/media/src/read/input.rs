//! Which pictures does a video or image file hold, and when is each shown?

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use av::codec::packet::side_data::Type;
use av::color::TransferCharacteristic;
use av::format::stream::Stream;
use av::frame::Video;
use ffmpeg_next as av;
use foveal_core::view::picture::Picture;

use crate::error::MediaError;
use crate::plain_file::open_plain;
use crate::read::deliver::{FrameConversion, has_alpha};
use crate::read::frame_reader::FrameReader;
use crate::read::large_still::LargeStill;
use crate::read::orientation::Orientation;
use crate::read::source::{self, SourceInfo, Transparency};
use crate::read::still_tags::StillTags;
use crate::read::timeline::FileTimeline;
use crate::surround::spherical::{side_data_of, spherical_of, stereo_of};
use crate::surround::spherical_boxes::{Ffmpeg, broken_boxes_of};

/// A picture and the time at which it is shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimedPicture {
    /// Upright, 8-bit 4:2:0, with the size and the colour of [`SourceInfo`].
    pub picture: Picture,
    /// Nanoseconds after the first picture; rises strictly.
    pub time_ns: i64,
}

/// An open video or image file, read from front to back.
///
/// ```no_run
/// # fn main() -> Result<(), foveal_media::MediaError> {
/// let mut input = foveal_media::VideoInput::open("clip.mp4".as_ref())?;
/// while let Some(timed) = input.next_frame()? {
///     assert_eq!(timed.picture.width, input.info().width);
/// }
/// # Ok(())
/// # }
/// ```
pub struct VideoInput {
    source: Source,
}

enum Source {
    Stream(Box<StreamInput>),
    Still(Box<LargeStill>),
}

impl VideoInput {
    /// Opens the file and decodes its first frame.
    ///
    /// # Errors
    /// The file is missing, empty, no video, holds no frame, or asks for a slanted rotation or a
    /// colour matrix that a picture cannot hold.
    pub fn open(path: &Path) -> Result<Self, MediaError> {
        // Opening a pipe would wait for somebody to write into it.
        let bytes = file_bytes(path)?;
        let source = match LargeStill::open(path)? {
            Some(still) => Source::Still(Box::new(still)),
            None => Source::Stream(Box::new(StreamInput::open(path, bytes)?)),
        };
        Ok(Self { source })
    }

    /// What is known of the file.
    #[must_use]
    pub fn info(&self) -> &SourceInfo {
        match &self.source {
            Source::Stream(stream) => &stream.info,
            Source::Still(still) => still.info(),
        }
    }

    /// Time stamp of the first picture in nanoseconds, 0 where it has none: what other streams of
    /// the file are timed against.
    pub(crate) fn first_stamp_ns(&self) -> i64 {
        match &self.source {
            Source::Stream(stream) => stream.first_stamp_ns,
            Source::Still(_) => 0,
        }
    }

    /// Time stamps so far that did not rise and were replaced by the frame rate.
    pub(crate) fn repaired_stamps(&self) -> u64 {
        match &self.source {
            Source::Stream(stream) => stream.timeline.repaired(),
            Source::Still(_) => 0,
        }
    }

    /// The next picture in the order of display; None after the last.
    ///
    /// # Errors
    /// The file breaks off, its data are damaged, or the picture size changes; the error names the
    /// frame. Pictures before it have been delivered.
    pub fn next_frame(&mut self) -> Result<Option<TimedPicture>, MediaError> {
        match &mut self.source {
            Source::Stream(stream) => stream.next_frame(),
            Source::Still(still) => Ok(still.picture()?.map(|picture| TimedPicture {
                picture,
                time_ns: 0,
            })),
        }
    }
}

/// What FFmpeg reads.
struct StreamInput {
    path: PathBuf,
    info: SourceInfo,
    reader: FrameReader,
    conversion: FrameConversion,
    timeline: FileTimeline,
    coded_size: [u32; 2],
    first_stamp_ns: i64,
    /// Decoded to learn the colours, and not yet delivered.
    first: Option<Video>,
    delivered: u64,
}

impl StreamInput {
    fn open(path: &Path, bytes: u64) -> Result<Self, MediaError> {
        let mut reader = FrameReader::open(path, bytes)?;
        let no_frames = |reason| MediaError::NoFrames {
            path: path.to_owned(),
            reason,
        };
        let first = reader.next_frame().map_err(no_frames)?;
        let first = first.ok_or_else(|| no_frames("it is empty".to_owned()))?;
        let stream = reader
            .stream()
            .ok_or_else(|| no_frames("it is gone".to_owned()))?;
        let tags = match source::is_image_format(reader.input()) {
            true => StillTags::of(path),
            false => StillTags::default(),
        };
        let orientation = orientation_of(path, &stream)?.unwrap_or(tags.orientation);
        let is_jpeg = reader.decoder().id() == av::codec::Id::MJPEG;
        let conversion = FrameConversion::new(&first, orientation, is_jpeg).map_err(|found| {
            let (path, field) = (path.to_owned(), "the colour matrix");
            let next = "convert it with `ffmpeg -i FILE -vf scale=out_color_matrix=bt709 OUT`";
            MediaError::Unsupported {
                path,
                field,
                found,
                next,
            }
        })?;
        let coded_size = [first.width(), first.height()];
        let info = SourceInfo {
            tags,
            ..describe(&reader, &stream, &first, &conversion, bytes)
        };
        let timeline = FileTimeline::new(stream.time_base(), info.frame_rate);
        let first_stamp_ns = timeline.stamp_ns(first.timestamp());
        let path = path.to_owned();
        let first = Some(first);
        Ok(Self {
            path,
            info,
            reader,
            conversion,
            timeline,
            coded_size,
            first_stamp_ns,
            first,
            delivered: 0,
        })
    }

    fn next_frame(&mut self) -> Result<Option<TimedPicture>, MediaError> {
        let next = match self.first.take() {
            Some(frame) => Ok(Some(frame)),
            None => self.reader.next_frame(),
        };
        let Some(frame) = next.map_err(|reason| self.broken(reason))? else {
            return Ok(None);
        };
        let size = [frame.width(), frame.height()];
        if size != self.coded_size {
            let (path, from) = (self.path.clone(), self.coded_size);
            return Err(MediaError::SizeChange {
                path,
                frame: self.delivered,
                from,
                to: size,
            });
        }
        let picture = self
            .conversion
            .picture(&frame)
            .map_err(|reason| self.broken(reason))?;
        let time_ns = self.timeline.time_ns(frame.timestamp());
        self.delivered += 1;
        Ok(Some(TimedPicture { picture, time_ns }))
    }

    fn broken(&self, reason: String) -> MediaError {
        MediaError::Broken {
            path: self.path.clone(),
            frame: self.delivered,
            seconds: self.timeline.predicted_ns() as f64 / 1e9,
            reason,
        }
    }
}

/// What the container and the first frame tell.
fn describe(
    reader: &FrameReader,
    stream: &Stream,
    first: &Video,
    conversion: &FrameConversion,
    bytes: u64,
) -> SourceInfo {
    let [width, height] = conversion
        .orientation()
        .turned_size([first.width(), first.height()]);
    let is_image = source::is_image_format(reader.input());
    let frame_rate = source::frame_rate_of(stream);
    let seconds = source::seconds_of(reader.input(), stream).filter(|_| !is_image);
    let broken_boxes = broken_boxes_of(reader.path());
    let is_misread = broken_boxes
        .iter()
        .any(|broken| broken.ffmpeg == Ffmpeg::Misreads);
    // VP8 and VP9 carry alpha as a second stream that FFmpeg's decoders leave out.
    let has_second_stream = stream.metadata().get("alpha_mode") == Some("1");
    let transparency = match has_alpha(first) {
        true => Some(Transparency::OverBlack),
        false => has_second_stream.then_some(Transparency::NotRead),
    };
    SourceInfo {
        width,
        height,
        frame_rate,
        frames: source::frames_of(stream, seconds, frame_rate).or(is_image.then_some(1)),
        seconds,
        colour: conversion.colour(),
        spherical: spherical_of(stream).filter(|_| !is_misread),
        stereo: stereo_of(stream),
        tags: StillTags::default(),
        broken_boxes,
        sound: source::sound_of(reader.input()),
        transparency,
        pixel_aspect: pixel_aspect(first),
        is_hdr: matches!(
            first.color_transfer_characteristic(),
            TransferCharacteristic::SMPTE2084 | TransferCharacteristic::ARIB_STD_B67
        ),
        codec: reader
            .decoder()
            .codec()
            .map_or_else(String::new, |c| c.name().to_owned()),
        pixel_format: first
            .format()
            .descriptor()
            .map_or("unknown", |d| d.name())
            .to_owned(),
        bytes,
        looks_still: is_image || stream.frames() == 1,
    }
}

fn file_bytes(path: &Path) -> Result<u64, MediaError> {
    let cannot_open = |reason| MediaError::Open {
        path: path.to_owned(),
        reason,
    };
    let (_, about) = open_plain(path).map_err(|error| {
        cannot_open(match error.kind() {
            ErrorKind::IsADirectory => "it is a folder; give a file in it".to_owned(),
            ErrorKind::Other => "it is not a file; what comes through a pipe must be written to \
                                 one first"
                .to_owned(),
            _ => error.to_string(),
        })
    })?;
    if about.len() == 0 {
        let reason = "it is empty".to_owned();
        return Err(MediaError::NotVideo {
            path: path.to_owned(),
            reason,
        });
    }
    Ok(about.len())
}

/// As the container says; `None` where it says nothing.
fn orientation_of(path: &Path, stream: &Stream) -> Result<Option<Orientation>, MediaError> {
    let Some(matrix) = side_data_of(stream, Type::DisplayMatrix) else {
        return Ok(None);
    };
    let orientation = Orientation::from_display_matrix(&matrix);
    orientation
        .map(Some)
        .ok_or_else(|| MediaError::Unsupported {
            path: path.to_owned(),
            field: "the display rotation",
            found: "not a multiple of 90 degrees".to_owned(),
            next: "turn the pictures themselves with `ffmpeg -i FILE OUT.mp4`",
        })
}

/// The shape of a frame's pixels; `None` when they are square or nothing is said.
fn pixel_aspect(frame: &Video) -> Option<[i32; 2]> {
    let aspect = frame.aspect_ratio();
    let [width, height] = [aspect.numerator(), aspect.denominator()];
    (width > 0 && height > 0 && width != height).then_some([width, height])
}
