//! How is an OpenEXR picture read, so that no row of it stays black unsaid?

use std::path::Path;

use av::codec::{Id, context::Context, threading};
use av::format::Pixel;
use av::frame::Video;
use av::{Dictionary, Packet};
use ffmpeg_next as av;

use crate::error::MediaError;
use crate::ffmpeg::start;
use crate::plain_file::{first_bytes, read_plain};
use crate::read::film::damage_log::DamageLog;
use crate::read::frame::new_frame;
use crate::read::still::decoded_still::DecodedStill;
use crate::read::still::exr::head::{Colours, ExrHead, ExrRefusal, MAGIC};
use crate::read::still::still_tags::StillTags;

/// Most bytes of a file.
const MOST_BYTES: u64 = i32::MAX as u64 - 1024;
/// How much red, green and blue count for luminance (ITU-R BT.709), as in files that name no other
/// primaries.
const WEIGHTS: [f32; 3] = [0.2126, 0.7152, 0.0722];
const CONVERT: &str = "convert it with `magick FILE OUT.png` or `oiiotool FILE -o OUT.png`";

/// Reads an OpenEXR picture; `None` for any other file.
pub(crate) fn open(path: &Path, bytes: u64) -> Result<Option<DecodedStill>, MediaError> {
    let head = first_bytes(path, MAGIC.len() as u64).unwrap_or_default();
    if head != MAGIC {
        return Ok(None);
    }
    let broken = |reason: String| MediaError::NoFrames {
        path: path.to_owned(),
        reason,
    };
    let mut file = read_plain(path, MOST_BYTES).map_err(|error| broken(error.to_string()))?;
    let head = ExrHead::of(&file).map_err(|refusal| match refusal {
        ExrRefusal::Broken(reason) => broken(reason),
        ExrRefusal::Kind(found) => MediaError::Unsupported {
            path: path.to_owned(),
            field: "the kind of picture",
            found,
            next: CONVERT,
        },
    })?;
    for at in &head.small {
        file[*at].make_ascii_uppercase();
    }
    start();
    let frame = match head.colours {
        Colours::Plain => decoded(&file, &head, &head.layer),
        Colours::Chroma => of_chroma(&file, &head),
    };
    let tags = StillTags {
        notes: head.note.clone().into_iter().collect(),
        ..StillTags::default()
    };
    let still = frame.and_then(|frame| DecodedStill::of(&frame, tags, ("exr", bytes)));
    still.map(Some).map_err(broken)
}

/// What FFmpeg makes of the channels whose names begin with these letters.
fn decoded(file: &[u8], head: &ExrHead, begin: &str) -> Result<Video, String> {
    let codec = av::decoder::find(Id::EXR).ok_or("this FFmpeg has no decoder of OpenEXR")?;
    let mut log = DamageLog::of_decoder();
    let mut context = Context::new_with_codec(codec);
    log.listen_to_decoder(&mut context);
    context.set_threading(threading::Config {
        kind: threading::Type::Slice,
        count: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
        ..Default::default()
    });
    let mut options = Dictionary::new();
    options.set("layer", begin);
    options.set("part", &head.part.to_string());
    let opened = context.decoder().open_as_with(codec, options);
    let mut decoder = opened
        .and_then(|it| it.video())
        .map_err(|e| e.to_string())?;
    let mut packet = Packet::new(file.len());
    let inside = packet.data_mut().ok_or("there is no memory for it")?;
    inside.copy_from_slice(file);
    let sent = decoder
        .send_packet(&packet)
        .and_then(|()| decoder.send_eof());
    sent.map_err(|e| e.to_string())?;
    let mut frame = Video::empty();
    decoder
        .receive_frame(&mut frame)
        .map_err(|e| e.to_string())?;
    if frame.is_corrupt() || frame.has_decode_errors() || log.has_heard() {
        return Err("a part of it is damaged, and would be black".to_owned());
    }
    Ok(frame)
}

/// Colours of luminance Y and of (R - Y) / Y and (B - Y) / Y, as OpenEXR stores them.
fn of_chroma(file: &[u8], head: &ExrHead) -> Result<Video, String> {
    let before = match &*head.layer {
        "" => String::new(),
        layer => format!("{layer}."),
    };
    let luma = decoded(file, head, &head.layer)?;
    let size = [luma.width(), luma.height()];
    let of = |colour: &str| decoded(file, head, &format!("{before}{colour}"));
    let planes = [luma, of("R")?, of("B")?];
    let is_grey = |it: &Video| it.format() == Pixel::GRAYF32LE && it.width() == size[0];
    if !planes.iter().all(is_grey) {
        return Err("its luminance and its chroma are not stored alike".to_owned());
    }
    let mut frame = new_frame(Pixel::GBRPF32LE, size)?;
    for y in 0..size[1] as usize {
        let row = |plane: &Video| {
            let begin = y * plane.stride(0);
            let bytes = plane.data(0).get(begin..begin + 4 * size[0] as usize);
            let (samples, _) = bytes.unwrap_or_default().as_chunks::<4>();
            samples.iter().map(|it| f32::from_le_bytes(*it)).collect()
        };
        let [luma, red, blue]: [Vec<f32>; 3] = planes.each_ref().map(row);
        for (x, y_luma) in luma.iter().enumerate() {
            let [red, blue] = [&red, &blue].map(|it| (it.get(x).unwrap_or(&0.0) + 1.0) * y_luma);
            let green = (y_luma - red * WEIGHTS[0] - blue * WEIGHTS[2]) / WEIGHTS[1];
            for (plane, sample) in [green, blue, red].into_iter().enumerate() {
                let at = y * frame.stride(plane) + 4 * x;
                if let Some(four) = frame.data_mut(plane).get_mut(at..at + 4) {
                    four.copy_from_slice(&sample.to_le_bytes());
                }
            }
        }
    }
    Ok(frame)
}
