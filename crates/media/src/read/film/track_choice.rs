//! Which video track of a file is shown, and which are not?

use std::path::Path;

use av::codec::Id;
use av::format::context::Input;
use av::format::stream::{Disposition, Stream};
use av::media::Type;
use ffmpeg_next as av;
use foveal_core::units::counted;

use crate::read::film::opening::{open_input, read_packet};

/// Codecs of single pictures, by which covers are coded.
const OF_PICTURES: [Id; 8] = [
    Id::MJPEG,
    Id::PNG,
    Id::BMP,
    Id::GIF,
    Id::WEBP,
    Id::TIFF,
    Id::JPEG2000,
    Id::MJPEGB,
];
/// Packets that are looked at to tell a cover from a film.
const MOST_PACKETS: usize = 500;
/// FFmpeg's name of icons, whose pictures are tracks to it.
const ICON: &str = "ico";
/// Most tracks that are named.
const MOST_NAMED: usize = 3;

/// The track of a file that is shown: FFmpeg's choice, but never the cover picture of a sound file
/// or of a film; of an icon the largest picture.
pub(crate) fn shown_track(path: &Path, input: &Input) -> Option<usize> {
    if input.format().name() == ICON {
        return tracks(input).max_by_key(pixels_of).map(|it| it.index());
    }
    let best = input.streams().best(Type::Video).filter(|it| !is_cover(it));
    let best = best.or_else(|| tracks(input).next())?;
    let films: Vec<usize> = tracks(input)
        .filter(|it| !is_of_pictures(it))
        .map(|it| it.index())
        .collect();
    match is_of_pictures(&best) && !films.is_empty() {
        true => Some(film_among(path, best.index(), &films).unwrap_or(best.index())),
        false => Some(best.index()),
    }
}

/// What is said of the tracks that are not shown.
pub(crate) fn others_note(input: &Input, shown: usize) -> Option<String> {
    let all = tracks(input).count();
    if input.format().name() == ICON {
        return (all > 1).then(|| format!("the largest of its {all} pictures is shown"));
    }
    let others = || tracks(input).filter(|it| it.index() != shown);
    let named: Vec<String> = others().take(MOST_NAMED).map(|it| name_of(&it)).collect();
    let more = others().count().saturating_sub(MOST_NAMED);
    let more = match more {
        0 => String::new(),
        more => format!(" and {}", counted(more as u64, "other")),
    };
    (!named.is_empty()).then(|| {
        format!(
            "it has {all} video tracks, of which track {shown} is shown: not {}{more}; \
             `ffmpeg -i FILE -map 0:N -c copy OUT` takes track N out",
            named.join(", ")
        )
    })
}

fn tracks(input: &Input) -> impl Iterator<Item = Stream<'_>> {
    let is_video = |it: &Stream| it.parameters().medium() == Type::Video && !is_cover(it);
    input.streams().filter(is_video)
}

fn is_cover(stream: &Stream) -> bool {
    stream.disposition().contains(Disposition::ATTACHED_PIC)
}

fn is_of_pictures(stream: &Stream) -> bool {
    OF_PICTURES.contains(&stream.parameters().id())
}

/// Columns and rows as the container says.
#[allow(unsafe_code)] // ffmpeg-next has no name for them.
fn size_of(stream: &Stream) -> [i32; 2] {
    // SAFETY: the parameters are alive as long as the stream is; the fields are plain numbers.
    unsafe {
        let raw = (*stream.as_ptr()).codecpar;
        [(*raw).width, (*raw).height]
    }
}

fn pixels_of(stream: &Stream) -> i64 {
    let [w, h] = size_of(stream).map(i64::from);
    w * h
}

fn name_of(stream: &Stream) -> String {
    let codec = stream.parameters().id().name();
    let [w, h] = size_of(stream);
    let size = if w > 0 && h > 0 {
        format!(", {w}x{h}")
    } else {
        String::new()
    };
    format!("track {} ({codec}{size})", stream.index())
}

/// The first of the films, where a track of pictures is a single one; none where it is a film too.
/// The file is opened again, as what is read of it comes once.
fn film_among(path: &Path, pictures: usize, films: &[usize]) -> Option<usize> {
    let mut file = open_input(path, None).ok()?;
    let (mut own, mut others) = (0, vec![0_u32; films.len()]);
    for _ in 0..MOST_PACKETS {
        let mut packet = av::Packet::empty();
        if !read_packet(&mut packet, &mut file.input).ok()? {
            break;
        }
        if packet.stream() == pictures {
            own += 1;
        } else if let Some(at) = films.iter().position(|it| *it == packet.stream()) {
            others[at] += 1;
        }
        if own > 1 {
            return None;
        }
    }
    let most = others.iter().position(|count| *count > 1)?;
    films.get(most).copied()
}
