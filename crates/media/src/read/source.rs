//! What is known of a source before it is read through?

use av::format::context::Input;
use av::format::stream::{Disposition, Stream};
use av::media::Type;
use ffmpeg_next as av;
use foveal_core::view::picture::Colour;

use crate::read::still_tags::StillTags;
use crate::surround::spherical::{Spherical, Stereo};
use crate::surround::spherical_boxes::BrokenBox;

/// Frame rate of a stream that names none, frames a second.
const FALLBACK_RATE: [i32; 2] = [25, 1];
/// A frame rate above this is a clock, not a rate, frames a second.
const HIGHEST_RATE: f64 = 1000.0;

/// What a file says about its video, and what its first frame shows.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceInfo {
    /// Width of the delivered pictures in pixels, after rotation.
    pub width: u32,
    /// Height of the delivered pictures in pixels, after rotation.
    pub height: u32,
    /// Average frames a second as numerator and denominator, both positive; 25/1 if unknown.
    pub frame_rate: [i32; 2],
    /// Number of frames as far as the container tells; an estimate.
    pub frames: Option<u64>,
    /// Length in seconds as far as the container tells; an estimate.
    pub seconds: Option<f64>,
    /// Colour of the pictures as delivered.
    pub colour: Colour,
    /// Projection, where the file names one.
    pub spherical: Option<Spherical>,
    /// Layout of the two eyes, where the file names one.
    pub stereo: Option<Stereo>,
    /// What a picture file says of how it is meant to be looked at.
    pub tags: StillTags,
    /// What it says of projection and eyes that cannot be used.
    pub broken_boxes: Vec<BrokenBox>,
    /// Its best sound stream, if it has any.
    pub sound: Option<Sound>,
    /// What becomes of its transparency, where it has any.
    pub transparency: Option<Transparency>,
    /// Width over height of a pixel, as numerator and denominator, where pixels are not square.
    pub pixel_aspect: Option<[i32; 2]>,
    /// True when code values follow a high dynamic range curve (PQ or HLG).
    pub is_hdr: bool,
    /// FFmpeg's name of the codec, as `h264`.
    pub codec: String,
    /// FFmpeg's name of the source's pixel format, as `yuv420p10le`.
    pub pixel_format: String,
    /// Size of the file in bytes.
    pub bytes: u64,
    /// True for an image file or a video of one frame.
    pub looks_still: bool,
}

/// What becomes of a source's transparency: pictures as they are delivered have none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transparency {
    /// Pictures lie over black.
    OverBlack,
    /// It lies where it is not read: pictures show what is stored under it.
    NotRead,
}

impl Transparency {
    /// What a person should know of it.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::OverBlack => "what is transparent in it is shown over black",
            Self::NotRead => {
                "its transparency, a second stream, is not read: where it is transparent, the \
                 colours show that are stored there"
            }
        }
    }
}

/// What a file says about its sound.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sound {
    /// FFmpeg's name of the codec, as `aac`.
    pub codec: String,
    /// Number of channels.
    pub channels: u16,
}

/// The best sound stream of the file, as far as the container tells.
pub(crate) fn sound_of(input: &Input) -> Option<Sound> {
    let stream = input.streams().best(Type::Audio)?;
    let parameters = stream.parameters();
    let context = av::codec::Context::from_parameters(parameters.clone()).ok()?;
    let channels = context
        .decoder()
        .audio()
        .map_or(0, |audio| audio.channels());
    Some(Sound {
        codec: parameters.id().name().to_owned(),
        channels,
    })
}

/// The video stream to read: FFmpeg's choice, never the cover picture of a sound file.
pub(crate) fn video_stream(input: &Input) -> Option<Stream<'_>> {
    let is_cover = |stream: &Stream| stream.disposition().contains(Disposition::ATTACHED_PIC);
    let is_video = |stream: &Stream| stream.parameters().medium() == Type::Video;
    let best = input
        .streams()
        .best(Type::Video)
        .filter(|stream| !is_cover(stream));
    best.or_else(|| {
        input
            .streams()
            .find(|stream| is_video(stream) && !is_cover(stream))
    })
}

/// What streams a file without a video has, for a message.
pub(crate) fn stream_kinds(input: &Input) -> String {
    let kind = |stream: Stream| format!("{:?}", stream.parameters().medium()).to_lowercase();
    let kinds: Vec<String> = input.streams().map(kind).collect();
    if kinds.is_empty() {
        "no stream".to_owned()
    } else {
        format!("no video stream, only {}", kinds.join(", "))
    }
}

/// Average frames a second; both numbers are positive.
pub(crate) fn frame_rate_of(stream: &Stream) -> [i32; 2] {
    let plausible = |rate: &av::Rational| {
        rate.0 > 0 && rate.1 > 0 && f64::from(rate.0) / f64::from(rate.1) <= HIGHEST_RATE
    };
    [stream.avg_frame_rate(), stream.rate()]
        .into_iter()
        .find(plausible)
        .map_or(FALLBACK_RATE, |rate| [rate.0, rate.1])
}

/// Length of the stream, or else of the file, in seconds.
pub(crate) fn seconds_of(input: &Input, stream: &Stream) -> Option<f64> {
    let tick = f64::from(stream.time_base());
    let own = stream.duration() as f64 * tick;
    let whole = input.duration() as f64 / f64::from(av::ffi::AV_TIME_BASE);
    [own, whole]
        .into_iter()
        .find(|seconds| *seconds > 0.0 && seconds.is_finite())
}

/// Number of frames that the container names, or else length times rate.
pub(crate) fn frames_of(stream: &Stream, seconds: Option<f64>, rate: [i32; 2]) -> Option<u64> {
    match u64::try_from(stream.frames()) {
        Ok(frames) if frames > 0 => Some(frames),
        _ => seconds.map(|s| {
            (s * f64::from(rate[0]) / f64::from(rate[1]))
                .round()
                .max(1.0) as u64
        }),
    }
}

/// Whether the demuxer reads single images.
pub(crate) fn is_image_format(input: &Input) -> bool {
    let name = input.format().name().to_owned();
    name == "image2" || name.ends_with("_pipe")
}
