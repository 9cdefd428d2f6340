//! How do the packets of a file become decoded frames, and where do they break off?

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use av::codec::{Id, threading};
use av::format::context::Input;
use av::format::stream::Stream;
use av::frame::Video;
use av::{Packet, decoder};
use ffmpeg_next as av;

use crate::error::{MediaError, is_system_full};
use crate::ffmpeg::{lacks_resources, path_for_ffmpeg, start, wants_more};
use crate::read::film::corrected::file::CorrectedFile;
use crate::read::film::damage_log::DamageLog;
use crate::read::film::ends::cut_short::{ToldEnd, why_cut};
use crate::read::film::ends::joints::{Joints, is_ogg_header};
use crate::read::film::ends::other_file::other_file;
use crate::read::film::film_notes::{FilmNotes, guessed_rate};
use crate::read::film::holes::Pieces;
use crate::read::film::mending::{Beginning, Judge, Mending, Place};
use crate::read::film::opening::{OpenFile, open_input, read_packet};
use crate::read::film::track_choice::shown_track;
use crate::read::source;
use crate::surround::clean_aperture::{CleanAperture, clean_aperture_of};
use crate::surround::spherical_boxes::broken_boxes_of;

/// More threads than this only cost memory: each holds a frame.
const MOST_THREADS: usize = 16;

/// Decoders that otherwise conceal damage, in silence or, with threads, at times. Others (TIFF's)
/// take it as an order to refuse harmless oddities.
const TOLD_TO_EXPLODE: [Id; 4] = [Id::H264, Id::HEVC, Id::MJPEG, Id::PNG];

/// What is reported of a transport stream's packet whose counter jumps.
const LOST: &str = "its data are incomplete, or two streams were joined here, which \
                    `ffmpeg -i FILE OUT.mkv` mends";

/// What is reported of a container with a part passed over, and of a packet with a hole.
const PASSED_OVER: &str = "a part of it does not belong to its format";
const HOLE: &str = "a part of a picture is gone, with zeros in its place";

/// Another recording may begin within this many packets after one that FFmpeg calls damaged: it
/// marks the packet one or two before.
const JOINT_WITHIN: usize = 3;

/// Errors in a row from a decoder that has no more packets, after which nothing more comes.
const MOST_AT_END: u32 = 64;

/// Why no more frames come.
#[derive(Clone, Debug)]
pub(crate) enum Break {
    /// The file ends before it should; the frames before it have come.
    Ends(String),
    /// Data are damaged: a reader that mends goes on.
    Damaged(String),
    /// The file changes while it is read, or nothing can be made of it.
    Fails(String),
}

impl Break {
    /// In words.
    pub(crate) fn reason(self) -> String {
        match self {
            Self::Ends(reason) | Self::Damaged(reason) | Self::Fails(reason) => reason,
        }
    }
}

/// The video stream of an open file.
pub(crate) struct FrameReader {
    input: Input,
    /// Read by the input, which is gone before it.
    _corrected: Option<CorrectedFile>,
    notes: FilmNotes,
    stream: usize,
    decoder: decoder::Video,
    /// Written by the decoder and the reader of the file, which are gone before them.
    log: DamageLog,
    file_log: DamageLog,
    pieces: Pieces,
    codec: Id,
    /// Why the packets ended before the file did; reported once the good frames are out.
    failure: Option<Break>,
    /// Errors since the decoder learnt that there are no more packets, once it did.
    errors_at_end: Option<u32>,
    /// Why it is cut, where the container does not report that at its end.
    why_cut: Option<String>,
    told_end: ToldEnd,
    joints: Joints,
    /// Packets read ahead in search of a joint.
    held: VecDeque<Packet>,
    path: PathBuf,
    bytes: u64,
    beginning: Beginning,
    /// There where damage is concealed and counted.
    mending: Option<Mending>,
    /// Stamp and duration of the packet that is shown last.
    last_packet: Option<(i64, i64)>,
    /// The packet that the decoder has taken last.
    last_place: Option<Place>,
    /// Where the last packet ends in the file.
    last_end: Option<u64>,
    aperture: Option<CleanAperture>,
}

/// Why a codec cannot be decoded: the system has too little left for it, or FFmpeg lacks it.
fn no_decoder(path: &Path, codec: Id, error: av::Error) -> MediaError {
    let path = path.to_owned();
    match lacks_resources(error) {
        true => MediaError::OtherFile {
            path,
            what: format!("no decoder can be had for it ({error})"),
            next: "raise the limits on threads and memory: `ulimit -u`, `ulimit -v`".to_owned(),
        },
        false => MediaError::Unsupported {
            path,
            field: "the video codec",
            found: format!("{codec:?} ({error})").to_lowercase(),
            next: "convert the file with `ffmpeg -i FILE OUT.mp4`, or check that it is whole",
        },
    }
}

impl FrameReader {
    /// Opens the file, which is `bytes` long, and the decoder of its video stream. A reader that
    /// mends shows what is damaged as far as it can be restored, on one thread, but for so many
    /// frames before the first good one; without `most_left_out` a reader breaks off there.
    pub(crate) fn open(
        path: &Path,
        bytes: u64,
        most_left_out: Option<u64>,
    ) -> Result<Self, MediaError> {
        let (file, file_log) = film_at(path)?;
        let (input, corrected) = (file.input, file.corrected);
        let stream = shown_track(path, &input).and_then(|it| input.stream(it));
        let Some(stream) = stream else {
            let found = source::stream_kinds(&input);
            let path = path.to_owned();
            let no_video = |path| MediaError::NoVideoStream { path, found };
            return Err(other_file(&path).unwrap_or_else(|| no_video(path)));
        };
        // A picture that is damaged is refused: there is no other that shows what is missing.
        let most_left_out = most_left_out.filter(|_| !source::is_image_format(&input));
        let mends = most_left_out.is_some();
        let codec = stream.parameters().id();
        let explodes = TOLD_TO_EXPLODE.contains(&codec);
        let log = DamageLog::of_decoder();
        let pieces = Pieces::of(codec, &extra_of(&stream));
        let decoder = open_decoder(&stream, explodes && !mends, !mends, &log);
        let decoder = decoder.map_err(|e| no_decoder(path, codec, e))?;
        let judge = match mends && explodes {
            true => Judge::of(|log| open_decoder(&stream, true, false, log).ok()),
            false => None,
        };
        let joints = Joints::of(input.format().name(), stream.time_base());
        let stream = stream.index();
        let format = input.format().name().to_owned();
        let why_cut = why_cut(path, bytes, &format);
        let notes = FilmNotes::of((path, bytes), (&input, stream), file.told);
        let told_end = ToldEnd::of(&input);
        let is_mp4 = input.format().name().contains("mp4");
        let aperture = is_mp4.then(|| clean_aperture_of(path)).flatten();
        Ok(Self {
            input,
            _corrected: corrected,
            notes,
            stream,
            decoder,
            log,
            file_log,
            pieces,
            codec,
            failure: None,
            errors_at_end: None,
            why_cut,
            told_end,
            joints,
            held: VecDeque::new(),
            path: path.to_owned(),
            bytes,
            beginning: Beginning::default(),
            mending: most_left_out.map(|most| Mending::new(judge, most, codec == Id::HEVC)),
            last_packet: None,
            last_place: None,
            last_end: None,
            aperture,
        })
    }

    /// Where the file is.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// The file.
    pub(crate) fn input(&self) -> &Input {
        &self.input
    }

    /// The decoder of the video stream.
    pub(crate) fn decoder(&self) -> &decoder::Video {
        &self.decoder
    }

    /// The video stream; None only if the file lost it.
    pub(crate) fn stream(&self) -> Option<Stream<'_>> {
        self.input.stream(self.stream)
    }

    /// What a person should know of the file, whatever its frames are.
    pub(crate) fn notes(&self) -> &FilmNotes {
        &self.notes
    }

    /// That nothing gives its rate, once a frame was decoded.
    pub(crate) fn guessed_rate(&self) -> Option<String> {
        guessed_rate((&self.input, self.stream), &self.decoder)
    }

    /// Whether damage is concealed and counted.
    pub(crate) fn mends(&self) -> bool {
        self.mending.is_some()
    }

    /// Frames at the beginning that could not be shown, frames that are damaged and shown, and
    /// packets after the first frame that became none.
    pub(crate) fn damage(&self) -> [u64; 3] {
        let first = self.beginning.first();
        let [damaged, lost] = self.mending.as_ref().map_or([0; 2], |it| it.counts(first));
        let is_at_end = self.errors_at_end.is_some();
        [self.beginning.dropped(is_at_end), damaged, lost]
    }

    /// How often time stamps started again, as they do where recordings were joined.
    pub(crate) fn joined(&self) -> u64 {
        self.joints.found()
    }

    /// Whether something was found that is no damage after all.
    pub(crate) fn has_forgiven(&self) -> bool {
        self.mending.as_ref().is_some_and(Mending::has_forgiven)
    }

    /// How long the last picture is shown, in ticks of the stream, as far as the file says.
    pub(crate) fn last_duration(&self) -> Option<i64> {
        let duration = self.last_packet.map(|(_, duration)| duration);
        duration.filter(|ticks| *ticks > 0)
    }

    /// The part of its pictures that the container says is to be shown, if it says that.
    pub(crate) fn aperture(&self) -> Option<&CleanAperture> {
        self.aperture.as_ref()
    }

    /// The next frame in the order of display, None after the last. Frames before a break are
    /// delivered first, then the break is reported once.
    pub(crate) fn next_frame(&mut self) -> Result<Option<Video>, Break> {
        loop {
            match self.step()? {
                Step::Fed => {}
                Step::Frame(frame) => return Ok(Some(frame)),
                Step::End => return self.failure.take().map_or(Ok(None), Err),
            }
        }
    }

    fn step(&mut self) -> Result<Step, Break> {
        let mut frame = Video::empty();
        let received = self.decoder.receive_frame(&mut frame);
        self.listen()?;
        match received {
            Ok(()) => {
                let is_flagged = frame.is_corrupt() || frame.has_decode_errors();
                let has_begun = self.beginning.has_begun();
                let is_fresh = self.beginning.is_fresh();
                if let Some(mending) = self.mending.as_mut().filter(|_| is_fresh) {
                    mending.forgive(&frame);
                }
                let is_shown = match &mut self.mending {
                    None if is_flagged => {
                        let why = "the decoder had to guess parts of the picture";
                        return Err(Break::Damaged(why.to_owned()));
                    }
                    None => true,
                    Some(mending) => mending.takes(&frame, is_flagged && !is_fresh, has_begun),
                };
                if !is_shown {
                    return Ok(Step::Fed);
                }
                self.beginning.shown(&frame);
                if let Some(aperture) = &self.aperture {
                    aperture.apply(&mut frame);
                }
                Ok(Step::Frame(frame))
            }
            Err(av::Error::Eof) => Ok(Step::End),
            Err(e) if wants_more(e) => self.feed().map(|()| Step::Fed),
            Err(e) => match (&mut self.errors_at_end, &self.mending) {
                // It may report a damaged last frame for ever.
                (Some(MOST_AT_END), Some(_)) => Ok(Step::End),
                (Some(errors), Some(_)) => {
                    *errors += 1;
                    Ok(Step::Fed)
                }
                _ => self.refused(None, &e).map(|()| Step::Fed),
            },
        }
    }

    /// Takes note of what the decoder has reported since this was called.
    fn listen(&mut self) -> Result<(), Break> {
        if !self.log.has_heard() {
            return Ok(());
        }
        match (&mut self.mending, self.last_place) {
            (None, _) => {
                let why = "the decoder had to guess parts of the picture";
                Err(Break::Damaged(why.to_owned()))
            }
            (Some(mending), Some(place)) if !self.beginning.is_fresh() => {
                mending.note(place);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The decoder refused what it was given.
    fn refused(&mut self, place: Option<Place>, error: &av::Error) -> Result<(), Break> {
        match &mut self.mending {
            None => Err(Break::Damaged(error.to_string())),
            Some(mending) => match mending.refuse(place) {
                true => Ok(()),
                false => Err(Break::Fails(error.to_string())),
            },
        }
    }

    /// Gives the decoder one packet of the stream, or signals that there are no more.
    fn feed(&mut self) -> Result<(), Break> {
        let mut packet = Packet::empty();
        let read = self.next_packet(&mut packet);
        if self.file_log.has_heard() {
            match &mut self.mending {
                None => return Err(Break::Damaged(PASSED_OVER.to_owned())),
                Some(mending) => mending.note(Place::Unknown),
            }
        }
        let failure = match read {
            Ok(true) if packet.is_corrupt() && self.mending.is_none() => {
                Some(Break::Damaged(LOST.to_owned()))
            }
            Ok(true) => return self.send(&packet),
            Ok(false) if self.why_cut.is_some() => self.why_cut.clone().map(Break::Ends),
            Ok(false) if self.has_rest() => {
                Some(Break::Ends("it ends within a picture".to_owned()))
            }
            Ok(false) if self.told_end.why_short().is_some() => {
                self.told_end.why_short().map(Break::Ends)
            }
            Ok(false) if self.has_shrunk() => {
                Some(Break::Fails("it was cut while it was read".to_owned()))
            }
            Ok(false) => None,
            Err(_) if self.has_shrunk() => {
                Some(Break::Fails("it was cut while it was read".to_owned()))
            }
            Err(why) => Some(Break::Ends(why)),
        };
        self.failure = failure;
        self.errors_at_end = Some(0);
        match self.decoder.send_eof() {
            Ok(()) => Ok(()),
            // It says so of the last frame; those that it still holds come.
            Err(error) => self.refused(None, &error),
        }
    }

    /// Reads the next packet of the stream; its stamps follow those before. False at the end.
    fn next_packet(&mut self, packet: &mut Packet) -> Result<bool, String> {
        match self.held.pop_front() {
            Some(held) => *packet = held,
            None if self.read_own(packet)?.is_none() => return Ok(false),
            None => {}
        }
        if self.is_container("mpegts") && packet.is_corrupt() && self.held.is_empty() {
            self.look_for_joint(packet);
        }
        Ok(true)
    }

    /// Where recordings are joined, the counter of their pieces starts again too. FFmpeg then calls
    /// one of the packets before damaged, which it is not.
    fn look_for_joint(&mut self, packet: &mut Packet) {
        for _ in 0..JOINT_WITHIN {
            let mut next = Packet::empty();
            // An error here is reported when its turn comes.
            let Ok(Some(is_joint)) = self.read_own(&mut next) else {
                return;
            };
            self.held.push_back(next);
            if is_joint {
                let all = self.held.iter_mut().chain([packet]);
                all.for_each(|it| it.set_flags(it.flags() - av::packet::Flags::CORRUPT));
                return;
            }
        }
    }

    /// The same from the file. Says whether time stamps start again there; none at the end.
    fn read_own(&mut self, packet: &mut Packet) -> Result<Option<bool>, String> {
        loop {
            // A fresh packet each time: av_read_frame overwrites without freeing.
            *packet = Packet::empty();
            if !read_packet(packet, &mut self.input)? {
                return Ok(None);
            }
            self.told_end.note(&self.input, packet);
            if self.is_container("ogg") && is_ogg_header(packet) {
                continue;
            }
            // Some containers hold packets without data, which decoders refuse.
            if packet.stream() == self.stream && packet.size() > 0 {
                return Ok(Some(self.joints.follow(packet)));
            }
        }
    }

    fn is_container(&self, name: &str) -> bool {
        self.input.format().name() == name
    }

    fn send(&mut self, packet: &Packet) -> Result<(), Break> {
        let stamp = packet.pts().or(packet.dts());
        let place = Place::of_packet(packet);
        self.last_place = Some(place);
        let end = packet.position() as i64 + packet.size() as i64;
        self.last_end = u64::try_from(end).ok().filter(|_| packet.position() >= 0);
        let bytes = packet.data().unwrap_or_default();
        if self.codec == Id::H264
            && self.beginning.is_nothing()
            && self.pieces.leans_on_others(bytes)
        {
            self.beginning.opens();
        }
        if !is_discarded(packet) {
            let at = packet.position() as i64;
            self.beginning.fed(place, at).map_err(Break::Fails)?;
        }
        if let Some(stamp) = stamp.filter(|it| self.last_packet.is_none_or(|(last, _)| *it > last))
        {
            self.last_packet = Some((stamp, packet.duration()));
        }
        let has_hole = self.pieces.has_hole(bytes);
        let is_open = self.beginning.is_open();
        match &mut self.mending {
            None if has_hole => return Err(Break::Damaged(HOLE.to_owned())),
            None => {}
            Some(mending) => mending.judge(packet, (place, has_hole), is_open),
        }
        match self.decoder.send_packet(packet) {
            Ok(()) => self.listen(),
            Err(error) => self.refused(Some(place), &error),
        }
    }

    /// Whether a file of pictures without an index ends with a part of one, which FFmpeg takes for
    /// its end.
    fn has_rest(&self) -> bool {
        self.is_container("yuv4mpegpipe") && self.last_end.is_some_and(|end| end < self.bytes)
    }

    /// Whether the file is shorter than when it was opened.
    fn has_shrunk(&self) -> bool {
        std::fs::metadata(&self.path).is_ok_and(|there| there.len() < self.bytes)
    }
}

/// What one turn of the decoder brought.
enum Step {
    Frame(Video),
    Fed,
    End,
}

/// Opens a film, with a log of what is reported meanwhile and later, which must outlive it.
fn film_at(path: &Path) -> Result<(OpenFile, DamageLog), MediaError> {
    start();
    let cannot_open = |reason| MediaError::Open {
        path: path.to_owned(),
        reason,
    };
    let absolute = path_for_ffmpeg(path).map_err(cannot_open)?;
    let not_video = |reason| MediaError::NotVideo {
        path: path.to_owned(),
        reason,
    };
    let log = DamageLog::of_container();
    let file =
        open_input(&absolute, Some(&log)).map_err(|reason| match is_system_full(&reason) {
            true => cannot_open(reason),
            false => other_file(path)
                .or_else(|| refused_box(path))
                .unwrap_or_else(|| not_video(reason)),
        })?;
    let input = &file.input;
    // Lists make FFmpeg read files that were not named here.
    if matches!(input.format().name(), "hls" | "concat" | "dash") {
        return Err(not_video(
            "it is a list of other files; give one of them".to_owned(),
        ));
    }
    // FFmpeg draws text files as pictures of a terminal, which is never meant.
    if input.format().name() == "tty" {
        return Err(not_video("it is a text file".to_owned()));
    }
    let has_codec = |stream: Stream| stream.parameters().id() != Id::None;
    let shown = shown_track(path, input).and_then(|it| input.stream(it));
    if shown.is_some_and(|stream| !has_codec(stream)) {
        return Err(other_file(path).unwrap_or_else(|| {
            not_video("it does not say how its pictures are coded".to_owned())
        }));
    }
    Ok((file, log))
}

/// What the container says of how a stream is coded.
#[allow(unsafe_code)] // ffmpeg-next has no name for it.
fn extra_of(stream: &Stream) -> Vec<u8> {
    // SAFETY: the parameters are alive as long as the stream is; their bytes, where there are any,
    // are as many as they say.
    unsafe {
        let raw = (*stream.as_ptr()).codecpar;
        match ((*raw).extradata, usize::try_from((*raw).extradata_size)) {
            (bytes, Ok(length)) if !bytes.is_null() => {
                std::slice::from_raw_parts(bytes, length).to_vec()
            }
            _ => Vec::new(),
        }
    }
}

/// Whether a packet is decoded and not shown, as an edit list asks.
#[allow(unsafe_code)] // ffmpeg-next has no name for the flag.
fn is_discarded(packet: &Packet) -> bool {
    use av::packet::Ref;
    // SAFETY: the packet is alive; the field is a plain number.
    let flags = unsafe { (*packet.as_ptr()).flags };
    flags & av::ffi::AV_PKT_FLAG_DISCARD != 0
}

/// The box for which FFmpeg does not open the file, if that is why.
fn refused_box(path: &Path) -> Option<MediaError> {
    // What it usually passes over may still make it stumble.
    let mut broken = broken_boxes_of(path);
    broken.sort_by_key(|broken| broken.ffmpeg);
    let refused = broken.into_iter().next()?;
    Some(MediaError::BrokenBox {
        path: path.to_owned(),
        name: refused.name,
        at: refused.at,
        what: refused.what,
    })
}

fn open_decoder(
    stream: &Stream,
    explodes: bool,
    has_threads: bool,
    log: &DamageLog,
) -> Result<decoder::Video, av::Error> {
    let mut context = av::codec::Context::from_parameters(stream.parameters())?;
    log.listen_to_decoder(&mut context);
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let count = if has_threads {
        cores.min(MOST_THREADS)
    } else {
        1
    };
    context.set_threading(threading::Config {
        kind: threading::Type::Frame,
        count,
        ..Default::default()
    });
    let mut decoder = context.decoder();
    decoder.set_packet_time_base(stream.time_base());
    if explodes && stream.parameters().id() == Id::HEVC {
        // Some encoders say what a picture is to come to.
        decoder.check(decoder::Check::EXPLODE | decoder::Check::CRC);
    } else if explodes {
        decoder.check(decoder::Check::EXPLODE);
    }
    decoder.video()
}
