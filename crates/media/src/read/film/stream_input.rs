//! Which pictures does a file hold that FFmpeg reads?

use std::path::{Path, PathBuf};

use av::codec::packet::side_data::Type;
use av::color::TransferCharacteristic;
use av::format::Pixel;
use av::format::stream::Stream;
use av::frame::Video;
use ffmpeg_next as av;
use foveal_core::view::picture::Picture;

use crate::error::MediaError;
use crate::read::convert::{Converter, Layout};
use crate::read::deliver::FrameConversion;
use crate::read::film::film_notes::FilmNotes;
use crate::read::film::frame_reader::{Break, FrameReader};
use crate::read::film::frames::Frames;
use crate::read::film::mended::Mended;
use crate::read::film::timeline::FileTimeline;
use crate::read::frame::has_alpha;
use crate::read::frame::{frame_from_picture, picture_from_frame};
use crate::read::options::{ReadOptions, TimedPicture};
use crate::read::orientation::Orientation;
use crate::read::source::{self, SourceInfo, Transparency};
use crate::read::still::still_tags::StillTags;
use crate::surround::camera::{Camera, may_be_two_fisheyes, shows_two_fisheyes};
use crate::surround::clean_aperture::CleanAperture;
use crate::surround::sphere_part::SpherePart;
use crate::surround::spherical::{side_data_of, spherical_of, stereo_of};
use crate::surround::spherical_boxes::{Ffmpeg, broken_boxes_of};

/// An open file that FFmpeg reads.
pub(crate) struct StreamInput {
    path: PathBuf,
    pub(crate) info: SourceInfo,
    frames: Frames,
    options: ReadOptions,
    conversion: FrameConversion,
    timeline: FileTimeline,
    coded_size: [u32; 2],
    /// Width over height of a pixel of the first frame, as its own data say.
    coded_aspect: av::Rational,
    pub(crate) first_stamp_ns: i64,
    delivered: u64,
    /// What was mended of the pictures themselves.
    mended: Mended,
}

impl StreamInput {
    pub(crate) fn open(path: &Path, bytes: u64, options: ReadOptions) -> Result<Self, MediaError> {
        let frames = Frames::open(path, bytes, options)?;
        let no_frames = |reason: &str| MediaError::NoFrames {
            path: path.to_owned(),
            reason: reason.to_owned(),
        };
        let first = frames.first().ok_or_else(|| no_frames("it is empty"))?;
        let reader = frames.reader();
        let stream = reader.stream().ok_or_else(|| no_frames("it is gone"))?;
        let mut tags = match source::is_image_format(reader.input()) {
            true => StillTags::of(path),
            false => StillTags::default(),
        };
        let orientation = oriented(reader, (&stream, first), &mut tags);
        let is_jpeg = reader.decoder().id() == av::codec::Id::MJPEG;
        let conversion = FrameConversion::new(first, orientation, is_jpeg).map_err(|found| {
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
        let coded_aspect = first.aspect_ratio();
        let mut conversion = conversion;
        let FilmNotes { corrected, other } = reader.notes();
        tags.broken.extend_from_slice(corrected);
        tags.notes.extend_from_slice(other);
        tags.notes.extend(reader.guessed_rate());
        tags.notes.extend(conversion.light_as(first, tags.power));
        let mut info = describe(reader, &stream, first, &conversion, bytes);
        info.is_hdr |= tags.is_hdr;
        info.tags = tags;
        look_at(&mut info, first, &mut conversion);
        if frames.has_two_pictures_a_frame() {
            info.frame_rate[0] = info.frame_rate[0].saturating_mul(2);
            for frames in [&mut info.frames, &mut info.frames_told]
                .into_iter()
                .flatten()
            {
                *frames = frames.saturating_mul(2);
            }
        }
        let timeline = FileTimeline::new(stream.time_base(), info.frame_rate).of_halves();
        let first_stamp = first.timestamp().map(|stamp| stamp.saturating_mul(2));
        let first_stamp_ns = timeline.stamp_ns(first_stamp);
        Ok(Self {
            path: path.to_owned(),
            info,
            frames,
            options,
            conversion,
            timeline,
            coded_size,
            coded_aspect,
            first_stamp_ns,
            delivered: 0,
            mended: Mended::default(),
        })
    }

    /// What was mended so far.
    pub(crate) fn mended(&self) -> Mended {
        Mended {
            first_damaged: self.mended.first_damaged,
            resized: self.mended.resized,
            sizes: self.mended.sizes,
            reshaped: self.mended.reshaped,
            repaired_stamps: self.timeline.repaired(),
            is_transparent: self.conversion.has_seen_through(),
            ..self.frames.mended()
        }
    }

    /// How long the last picture is shown, in nanoseconds, as far as the file says.
    pub(crate) fn last_ns(&self) -> Option<i64> {
        let ticks = self.frames.reader().last_duration()?;
        Some(self.timeline.stamp_ns(Some(ticks.saturating_mul(2))))
    }

    pub(crate) fn next_frame(&mut self) -> Result<Option<TimedPicture>, MediaError> {
        let next = self.frames.next().map_err(|stop| self.broken(stop))?;
        let Some((frame, stamp)) = next else {
            return Ok(None);
        };
        if self.mended.first_damaged.is_none() && self.frames.mended().damaged > 0 {
            self.mended.first_damaged = Some((self.delivered, self.timeline.predicted_ns()));
        }
        let size = [frame.width(), frame.height()];
        if size != self.coded_size && self.options.strict {
            let (path, from) = (self.path.clone(), self.coded_size);
            return Err(MediaError::SizeChange {
                path,
                frame: self.delivered,
                from,
                to: size,
            });
        }
        let picture = self.conversion.picture(&frame);
        let picture = picture.and_then(|picture| match size == self.coded_size {
            true => Ok(picture),
            false => self.fitted(&picture, &frame),
        });
        let picture = picture.map_err(|reason| self.broken(Break::Damaged(reason)))?;
        let is_reshaped = size == self.coded_size && frame.aspect_ratio() != self.coded_aspect;
        self.mended.reshaped += u64::from(is_reshaped);
        let time_ns = self.timeline.time_ns(stamp);
        self.delivered += 1;
        Ok(Some(TimedPicture { picture, time_ns }))
    }

    /// A picture of another size than the first, as large as it fits into the first's, with black
    /// round it.
    fn fitted(&mut self, picture: &Picture, frame: &Video) -> Result<Picture, String> {
        self.mended.resized += 1;
        let size = [self.info.width, self.info.height];
        let from = [picture.width, picture.height];
        self.mended.sizes.get_or_insert([size, from]);
        let colour = self.conversion.colour();
        let shape = |aspect: av::Rational| match (aspect.numerator(), aspect.denominator()) {
            (a, b) if a > 0 && b > 0 => f64::from(a) / f64::from(b),
            _ => 1.0,
        };
        // Wider pixels than the first's count for more of them.
        let wide = f64::from(from[0]) * shape(frame.aspect_ratio()) / shape(self.coded_aspect);
        let scale = (f64::from(size[0]) / wide).min(f64::from(size[1]) / f64::from(from[1]));
        let inner = [wide * scale, f64::from(from[1]) * scale];
        let inner = [0, 1].map(|k| (inner[k].round() as u32).clamp(1, size[k]));
        let layout = |size| Layout {
            format: Pixel::YUV420P,
            size,
            matrix: colour.matrix,
            full_range: colour.full_range,
            chroma_left: colour.chroma_left,
        };
        let frame = frame_from_picture(picture, Pixel::YUV420P)?;
        let scaled = Converter::new(layout(from), layout(inner))?.run(&frame)?;
        let black = if colour.full_range { 0 } else { 16 };
        let at = [0, 1].map(|k| (size[k] - inner[k]) / 4 * 2);
        let part = SpherePart { whole: size, at };
        Ok(part.whole_of(&picture_from_frame(&scaled)?, black))
    }

    fn broken(&self, stop: Break) -> MediaError {
        MediaError::Broken {
            path: self.path.clone(),
            frame: self.delivered,
            seconds: self.timeline.predicted_ns() as f64 / 1e9,
            reason: stop.reason(),
        }
    }
}

/// What the container and the first frame say, but for transparency that must be looked for.
fn describe(
    reader: &FrameReader,
    stream: &Stream,
    first: &Video,
    conversion: &FrameConversion,
    bytes: u64,
) -> SourceInfo {
    let orientation = conversion.orientation();
    let [width, height] = orientation.turned_size([first.width(), first.height()]);
    let is_image = source::is_image_format(reader.input());
    let frame_rate = source::frame_rate_of(stream);
    let seconds = source::seconds_of(reader.input(), stream).filter(|_| !is_image);
    let broken_boxes = broken_boxes_of(reader.path());
    let is_misread = broken_boxes
        .iter()
        .any(|broken| broken.ffmpeg == Ffmpeg::Misreads);
    // VP8 and VP9 carry alpha as a second stream that FFmpeg's decoders leave out.
    let has_second_stream = stream.metadata().get("alpha_mode") == Some("1");
    let told = source::frames_told(reader.input(), stream, frame_rate);
    let guessed = || source::frames_of(seconds, frame_rate).or(is_image.then_some(1));
    let aspect = source::pixel_aspect_of(reader.input(), stream, first);
    let aspect = match reader.aperture() {
        Some(aperture) => aperture.aspect(aspect),
        None => aspect,
    };
    SourceInfo {
        width,
        height,
        frame_rate,
        frames: told.or_else(guessed),
        frames_told: told,
        seconds,
        colour: conversion.colour(),
        spherical: spherical_of(stream).filter(|_| !is_misread),
        stereo: stereo_of(stream),
        tags: StillTags::default(),
        broken_boxes,
        camera: Camera::of(
            reader.path(),
            reader.input(),
            [first.width(), first.height()],
            is_image,
        ),
        sound: source::sound_of(reader.input()),
        transparency: has_second_stream.then_some(Transparency::NotRead),
        pixel_aspect: aspect.map(|[w, h]| {
            if orientation.transpose {
                [h, w]
            } else {
                [w, h]
            }
        }),
        is_hdr: matches!(
            first.color_transfer_characteristic(),
            TransferCharacteristic::SMPTE2084 | TransferCharacteristic::ARIB_STD_B67
        ),
        is_interlaced: first.is_interlaced() && !is_image,
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

/// What only a look at the first picture shows.
fn look_at(info: &mut SourceInfo, first: &Video, conversion: &mut FrameConversion) {
    let may_be_raw = info.camera.is_none() && may_be_two_fisheyes([info.width, info.height]);
    if !has_alpha(first) && !may_be_raw {
        return;
    }
    let Ok(picture) = conversion.picture(first) else {
        return;
    };
    if conversion.has_seen_through() {
        info.transparency = Some(Transparency::OverBlack);
    }
    let black = if info.colour.full_range { 0 } else { 16 };
    if may_be_raw && shows_two_fisheyes(&picture, black) {
        let is_still = info.looks_still;
        info.camera = Some(Camera::TwoFisheyes { is_still });
    }
}

/// How a film wants its pictures laid, and what is odd about that and what is shown of them, which
/// is put to what its tags say.
fn oriented(
    reader: &FrameReader,
    (stream, first): (&Stream, &Video),
    tags: &mut StillTags,
) -> Orientation {
    match reader.aperture().map(CleanAperture::remark) {
        None => {}
        Some(Ok(note)) => tags.notes.push(note),
        Some(Err(broken)) => tags.broken.push(broken),
    }
    let Some(matrix) = display_matrix_of(stream, first) else {
        return tags.orientation;
    };
    let (orientation, odd) = Orientation::from_display_matrix(&matrix);
    tags.broken.extend(odd);
    orientation
}

/// As the container says, else the first frame.
fn display_matrix_of(stream: &Stream, first: &Video) -> Option<Vec<u8>> {
    let of_frame = || {
        let data = first.side_data(av::frame::side_data::Type::DisplayMatrix)?;
        Some(data.data().to_vec())
    };
    side_data_of(stream, Type::DisplayMatrix).or_else(of_frame)
}
