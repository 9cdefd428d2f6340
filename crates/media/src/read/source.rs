//! What is known of a source before it is read through?

use av::ffi;
use av::format::context::Input;
use av::format::stream::Stream;
use av::frame::Video;
use av::media::Type;
use ffmpeg_next as av;
use foveal_core::view::picture::Colour;

use crate::read::still::still_tags::StillTags;
use crate::surround::camera::Camera;
use crate::surround::spherical::{Spherical, Stereo};
use crate::surround::spherical_boxes::BrokenBox;

/// Frame rate of a stream that names none, frames a second.
const FALLBACK_RATE: [i32; 2] = [25, 1];
/// A frame rate above this is a clock, not a rate, frames a second.
const HIGHEST_RATE: f64 = 1000.0;

/// Frames that usually come this much faster than on average have the usual rate; and a rate is the
/// same as another that its stamps were rounded to, within this.
const MUCH_FASTER: f64 = 4.0;
const ROUNDED: f64 = 0.1;
/// Entries of an index that are looked at, and fewest lengths that show a usual one.
const MOST_ENTRIES: i32 = 100_000;
const LEAST_ENTRIES: usize = 3;

/// What a file says about its video, and what its first frame shows.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceInfo {
    /// Width of the delivered pictures in pixels, after rotation.
    pub width: u32,
    /// Height of the delivered pictures in pixels, after rotation.
    pub height: u32,
    /// Average frames a second as numerator and denominator, both positive; 25/1 if unknown.
    pub frame_rate: [i32; 2],
    /// Number of frames as far as the container says; an estimate.
    pub frames: Option<u64>,
    /// The same where the container gives it for these pictures, and not for the whole file: what
    /// is less was cut off.
    pub frames_told: Option<u64>,
    /// Length in seconds as far as the container says; an estimate.
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
    /// The camera whose raw file it is, if it is one.
    pub camera: Option<Camera>,
    /// Its best sound stream, if it has any.
    pub sound: Option<Sound>,
    /// What becomes of its transparency, where it has any.
    pub transparency: Option<Transparency>,
    /// Width over height of a pixel, as numerator and denominator, where pixels are not square.
    pub pixel_aspect: Option<[i32; 2]>,
    /// True when code values follow a high dynamic range curve (PQ or HLG).
    pub is_hdr: bool,
    /// Whether its first frame is of two fields.
    pub is_interlaced: bool,
    /// FFmpeg's name of the codec, as `h264`.
    pub codec: String,
    /// FFmpeg's name of the source's pixel format, as `yuv420p10le`.
    pub pixel_format: String,
    /// Size of the file in bytes.
    pub bytes: u64,
    /// True for an image file or a video of one frame.
    pub looks_still: bool,
}

impl SourceInfo {
    /// Of an upright picture that is read by itself, as far as these say: FFmpeg's names of its
    /// codec and its pixel format, and the bytes of its file.
    pub(crate) fn of_still(
        [width, height]: [u32; 2],
        colour: Colour,
        (codec, pixel_format): (&str, &str),
        tags: StillTags,
        bytes: u64,
    ) -> Self {
        Self {
            width,
            height,
            frame_rate: FALLBACK_RATE,
            frames: Some(1),
            frames_told: None,
            seconds: None,
            colour,
            spherical: None,
            stereo: None,
            is_hdr: tags.is_hdr,
            tags,
            broken_boxes: Vec::new(),
            camera: None,
            sound: None,
            transparency: None,
            pixel_aspect: None,
            is_interlaced: false,
            codec: codec.to_owned(),
            pixel_format: pixel_format.to_owned(),
            bytes,
            looks_still: true,
        }
    }
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

/// The best sound stream of the file, as far as the container says.
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
    let told = [stream.avg_frame_rate(), stream.rate()];
    let told = told.into_iter().find(plausible);
    let per_second = |rate: av::Rational| f64::from(rate.0) / f64::from(rate.1);
    let rate = match (told, usual_rate_of(stream).filter(plausible)) {
        // A few frames that are shown for long say nothing of the others.
        (Some(told), Some(usual)) if per_second(told) * MUCH_FASTER < per_second(usual) => {
            let least = stream.rate();
            let is_close =
                plausible(&least) && (per_second(least) / per_second(usual) - 1.0).abs() < ROUNDED;
            Some(if is_close { least } else { usual })
        }
        (told, usual) => told.or(usual),
    };
    rate.map_or(FALLBACK_RATE, |rate| [rate.0, rate.1])
}

/// Frames a second by what most frames of a container's index last; none where it holds few.
#[allow(unsafe_code)] // ffmpeg-next does not give the index of a stream.
fn usual_rate_of(stream: &Stream) -> Option<av::Rational> {
    // SAFETY: the stream is alive and nothing reads on in this call; an entry is null or lies in
    // its index.
    let stamps: Vec<i64> = unsafe {
        let raw = stream.as_ptr().cast_mut();
        let entries = ffi::avformat_index_get_entries_count(raw).clamp(0, MOST_ENTRIES);
        let stamp = |at| ffi::avformat_index_get_entry(raw, at).as_ref();
        (0..entries)
            .filter_map(stamp)
            .map(|it| it.timestamp)
            .collect()
    };
    let lengths = stamps
        .windows(2)
        .map(|pair| pair[1].saturating_sub(pair[0]));
    let mut lengths: Vec<i64> = lengths.filter(|ticks| *ticks > 0).collect();
    if lengths.len() < LEAST_ENTRIES {
        return None;
    }
    let middle = lengths.len() / 2;
    let ticks = *lengths.select_nth_unstable(middle).1;
    let tick = stream.time_base();
    let (mut frames, mut seconds) = (0, 0);
    // SAFETY: writes the two numbers.
    unsafe {
        let per = i64::from(tick.0).saturating_mul(ticks);
        let most = i64::from(i32::MAX);
        ffi::av_reduce(
            &raw mut frames,
            &raw mut seconds,
            i64::from(tick.1),
            per,
            most,
        );
    }
    Some(av::Rational(frames, seconds))
}

/// Length of the stream, or else of the file, in seconds.
pub(crate) fn seconds_of(input: &Input, stream: &Stream) -> Option<f64> {
    let tick = f64::from(stream.time_base());
    let own = stream.duration() as f64 * tick;
    let whole = input.duration() as f64 / f64::from(ffi::AV_TIME_BASE);
    [own, whole]
        .into_iter()
        .find(|seconds| *seconds > 0.0 && seconds.is_finite())
}

/// Number of frames by length and rate.
pub(crate) fn frames_of(seconds: Option<f64>, rate: [i32; 2]) -> Option<u64> {
    let [frames, per] = rate.map(f64::from);
    seconds.map(|s| (s * frames / per).round().max(1.0) as u64)
}

/// Containers whose lengths are not those of the pictures: they are of all streams together (ASF),
/// or a guess where writing broke off (AVI). How far their data reach shows whether they are whole.
const TELL_OF_OTHERS: [&str; 2] = ["asf", "avi"];

/// Number of frames that the container announces for this stream, without those that it says are
/// not to be shown.
#[allow(unsafe_code)] // ffmpeg-next gives neither a stream's index nor how lengths were found.
pub(crate) fn frames_told(input: &Input, stream: &Stream, rate: [i32; 2]) -> Option<u64> {
    if TELL_OF_OTHERS.contains(&input.format().name()) {
        return None;
    }
    // SAFETY: the context and its stream are alive, and nothing reads on in this call; an entry is
    // null or lies in the stream's index.
    let (discarded, entries, is_guess) = unsafe {
        let stream = stream.as_ptr().cast_mut();
        let entries = ffi::avformat_index_get_entries_count(stream).max(0);
        let is_discarded = |at: &i32| {
            let entry = ffi::avformat_index_get_entry(stream, *at).as_ref();
            entry.is_some_and(|it| it.flags() & ffi::AVINDEX_DISCARD_FRAME != 0)
        };
        let is_guess = (*input.as_ptr()).duration_estimation_method
            == ffi::AVDurationEstimationMethod::AVFMT_DURATION_FROM_BITRATE;
        let discarded = (0..entries).filter(is_discarded).count() as u64;
        (discarded, entries as u64, is_guess)
    };
    let own = stream.duration() as f64 * f64::from(stream.time_base());
    let own = Some(own).filter(|seconds| *seconds > 0.0 && seconds.is_finite() && !is_guess);
    let by_length = frames_of(own, rate);
    match u64::try_from(stream.frames())
        .ok()
        .filter(|frames| *frames > 0)
    {
        // An edit list shows a part of the samples.
        Some(frames) if discarded > 0 && entries >= frames => Some(entries - discarded),
        Some(frames) => Some(by_length.map_or(frames, |by_length| by_length.min(frames))),
        None => by_length,
    }
    .map(|frames| frames.max(1))
}

/// Largest number of a pixel's shape that is reported: finer differences are not visible.
const FINEST_SHAPE: i32 = 4096;
/// Widest and narrowest pixel that is believed.
const WIDEST_PIXEL: f64 = 8.0;

/// The shape of a stream's pixels by container and codec, as FFmpeg weighs them; `None` where they
/// are square, nothing is said, or what is said cannot be meant.
#[allow(unsafe_code)] // ffmpeg-next has no such call.
pub(crate) fn pixel_aspect_of(input: &Input, stream: &Stream, first: &Video) -> Option<[i32; 2]> {
    // SAFETY: all three are alive, and none of them is written to.
    let guess = unsafe {
        ffi::av_guess_sample_aspect_ratio(
            input.as_ptr().cast_mut(),
            stream.as_ptr().cast_mut(),
            first.as_ptr().cast_mut(),
        )
    };
    // A field of HEVC is a picture of half the height.
    let is_field = first.is_interlaced() && stream.parameters().id() == av::codec::Id::HEVC;
    pixel_aspect(guess.into(), if is_field { 2 } else { 1 })
}

/// The shape of pixels of which so many rows are one; `None` where they are square, or what is said
/// cannot be meant.
#[allow(unsafe_code)] // ffmpeg-next has no such call.
pub(crate) fn pixel_aspect(shape: av::Rational, rows: i64) -> Option<[i32; 2]> {
    if shape.0 <= 0 || shape.1 <= 0 {
        return None;
    }
    let (mut w, mut h) = (0, 0);
    // SAFETY: writes the two numbers.
    unsafe {
        let most = i64::from(FINEST_SHAPE);
        let (wide, high) = (i64::from(shape.0), i64::from(shape.1) * rows);
        ffi::av_reduce(&raw mut w, &raw mut h, wide, high, most);
    }
    let shape = f64::from(w) / f64::from(h.max(1));
    let is_meant = w > 0 && h > 0 && (1.0 / WIDEST_PIXEL..=WIDEST_PIXEL).contains(&shape);
    (is_meant && w != h).then_some([w, h])
}

/// Whether the demuxer reads single images.
pub(crate) fn is_image_format(input: &Input) -> bool {
    let name = input.format().name().to_owned();
    name == "image2" || name == "ico" || name.ends_with("_pipe")
}
