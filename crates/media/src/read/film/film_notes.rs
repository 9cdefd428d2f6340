//! What of a film is corrected, not shown, or shown otherwise than it asks for?

use std::path::Path;

use av::decoder;
use av::format::context::Input;
use ffmpeg_next as av;

use crate::read::film::corrected::mp4_says;
use crate::read::film::ends::behind_end::behind_end;
use crate::read::film::track_choice::others_note;
use crate::read::source;

/// FFmpeg's formats that are a stream without a container, whose rate is an option of its reader
/// where the stream itself gives none.
const BARE: [&str; 10] = [
    "mjpeg",
    "h264",
    "hevc",
    "m4v",
    "mpegvideo",
    "cavsvideo",
    "dirac",
    "dnxhd",
    "vc1",
    "h263",
];

/// What a person should know of a film, whatever its frames are.
pub(crate) struct FilmNotes {
    /// What was wrong in its head.
    pub(crate) corrected: Vec<String>,
    /// What is not shown, or not as it asks for.
    pub(crate) other: Vec<String>,
}

impl FilmNotes {
    /// Of a file of so many bytes, the track of it that is shown, and what was corrected.
    pub(crate) fn of(
        (path, bytes): (&Path, u64),
        (input, track): (&Input, usize),
        corrected: Vec<String>,
    ) -> Self {
        let format = input.format().name().to_owned();
        let mut other: Vec<String> = others_note(input, track).into_iter().collect();
        other.extend(behind_end(path, bytes, &format));
        if format.contains("mp4") {
            other.extend(mp4_says::notes_of(path));
        }
        Self { corrected, other }
    }
}

/// That nothing gives a rate, so that FFmpeg takes its usual one, once a frame was decoded.
#[allow(unsafe_code)] // ffmpeg-next gives no rate of a decoder.
pub(crate) fn guessed_rate(
    (input, track): (&Input, usize),
    decoder: &decoder::Video,
) -> Option<String> {
    if !BARE.contains(&input.format().name()) {
        return None;
    }
    // SAFETY: the decoder is alive; the field is two plain numbers.
    let told = unsafe { (*decoder.as_ptr()).framerate };
    let [frames, seconds] = source::frame_rate_of(&input.stream(track)?);
    (told.num <= 0 || told.den <= 0).then(|| {
        format!(
            "nothing in it gives a frame rate: {:.3} frames a second are taken; `ffmpeg -r RATE \
             -i FILE -c copy OUT.mkv` gives it another",
            f64::from(frames) / f64::from(seconds)
        )
    })
}
