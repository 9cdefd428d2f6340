//! How do the packets of a file become decoded frames, and where do they break off?

use std::path::{Path, PathBuf};

use av::codec::{Id, threading};
use av::format::context::Input;
use av::format::stream::Stream;
use av::frame::Video;
use av::{Packet, decoder};
use ffmpeg_next as av;

use crate::error::MediaError;
use crate::ffmpeg::{path_for_ffmpeg, start, wants_more};
use crate::read::cut_short::is_cut_matroska;
use crate::read::opening::{open_input, read_packet};
use crate::read::source;
use crate::surround::spherical_boxes::broken_boxes_of;

/// More threads than this only cost memory: each holds a frame.
const MOST_THREADS: usize = 16;

/// Decoders that otherwise conceal damage, in silence or, with threads, at times. Others (TIFF's)
/// take it as an order to refuse harmless oddities.
const TOLD_TO_EXPLODE: [Id; 4] = [Id::H264, Id::HEVC, Id::MJPEG, Id::PNG];
/// A stream that was cut out of a longer one may begin with packets that lean on what is gone; so
/// many are passed over before the first frame.
const MOST_EARLY_ERRORS: u32 = 64;

/// What a transport stream tells of a packet whose counter jumps.
const LOST: &str = "its data are incomplete, or two streams were joined here, which \
                    `ffmpeg -i FILE OUT.mkv` mends";

/// The video stream of an open file.
pub(crate) struct FrameReader {
    input: Input,
    stream: usize,
    decoder: decoder::Video,
    /// Why the packets ended before the file did; told once the good frames are out.
    failure: Option<String>,
    /// The container does not report that it is cut, so that this is told at its end.
    is_cut: bool,
    path: PathBuf,
    bytes: u64,
    /// Whether a frame has come out.
    has_begun: bool,
    early_errors: u32,
    early_error: Option<String>,
}

impl FrameReader {
    /// Opens the file, which is `bytes` long, and the decoder of its video stream.
    pub(crate) fn open(path: &Path, bytes: u64) -> Result<Self, MediaError> {
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
        let input = open_input(&absolute)
            .map_err(|reason| refused_box(path).unwrap_or_else(|| not_video(reason)))?;
        // Lists make FFmpeg read files that nobody named here.
        if matches!(input.format().name(), "hls" | "concat" | "dash") {
            return Err(not_video(
                "it is a list of other files; give one of them".to_owned(),
            ));
        }
        // FFmpeg draws text files as pictures of a terminal; nobody means that.
        if input.format().name() == "tty" {
            return Err(not_video("it is a text file".to_owned()));
        }
        let Some(stream) = source::video_stream(&input) else {
            let found = source::stream_kinds(&input);
            return Err(MediaError::NoVideoStream {
                path: path.to_owned(),
                found,
            });
        };
        if stream.parameters().id() == Id::None {
            return Err(not_video(
                "it does not say how its pictures are coded".to_owned(),
            ));
        }
        let decoder = open_decoder(&stream).map_err(|e| MediaError::Unsupported {
            path: path.to_owned(),
            field: "the video codec",
            found: format!("{:?} ({e})", stream.parameters().id()).to_lowercase(),
            next: "convert the file with `ffmpeg -i FILE OUT.mp4`, or check that it is whole",
        })?;
        let stream = stream.index();
        let is_cut = is_cut_matroska(path, bytes);
        Ok(Self {
            input,
            stream,
            decoder,
            failure: None,
            is_cut,
            path: path.to_owned(),
            bytes,
            has_begun: false,
            early_errors: 0,
            early_error: None,
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

    /// The next frame in the order of display, None after the last. Frames before a break are
    /// delivered first, then the break is told once.
    pub(crate) fn next_frame(&mut self) -> Result<Option<Video>, String> {
        loop {
            match self.step() {
                Ok(Step::Fed) => {}
                Ok(Step::Frame(frame)) => {
                    self.has_begun = true;
                    return Ok(Some(frame));
                }
                Ok(Step::End) => {
                    let early = self.early_error.take().filter(|_| !self.has_begun);
                    return self.failure.take().or(early).map_or(Ok(None), Err);
                }
                Err(reason) if !self.has_begun && self.early_errors < MOST_EARLY_ERRORS => {
                    self.early_errors += 1;
                    self.early_error = Some(reason);
                }
                Err(reason) => return Err(reason),
            }
        }
    }

    fn step(&mut self) -> Result<Step, String> {
        let mut frame = Video::empty();
        match self.decoder.receive_frame(&mut frame) {
            Ok(()) if frame.is_corrupt() || frame.has_decode_errors() => {
                Err("the decoder had to guess parts of the picture".to_owned())
            }
            Ok(()) => Ok(Step::Frame(frame)),
            Err(av::Error::Eof) => Ok(Step::End),
            Err(e) if wants_more(e) => self.feed().map(|()| Step::Fed),
            Err(e) => Err(e.to_string()),
        }
    }

    /// Gives the decoder one packet of the stream, or tells it that there are no more.
    fn feed(&mut self) -> Result<(), String> {
        loop {
            // A fresh packet each time: av_read_frame overwrites without freeing.
            let mut packet = Packet::empty();
            match read_packet(&mut packet, &mut self.input) {
                Ok(true) if packet.stream() != self.stream => {}
                Ok(true) if packet.is_corrupt() => return self.end(Some(LOST)),
                // Some containers hold packets without data, which decoders refuse.
                Ok(true) if packet.size() == 0 => {}
                Ok(true) => return self.decoder.send_packet(&packet).map_err(|e| e.to_string()),
                Ok(false) if self.is_cut => return self.end(Some("it ends too early")),
                Ok(false) if self.has_shrunk() => {
                    return self.end(Some("it was cut while it was read"));
                }
                Ok(false) => return self.end(None),
                Err(why) => return self.end(Some(&why)),
            }
        }
    }

    /// Whether the file is shorter than when it was opened.
    fn has_shrunk(&self) -> bool {
        std::fs::metadata(&self.path).is_ok_and(|there| there.len() < self.bytes)
    }

    fn end(&mut self, failure: Option<&str>) -> Result<(), String> {
        self.failure = failure.map(str::to_owned);
        self.decoder.send_eof().map_err(|e| e.to_string())
    }
}

/// What one turn of the decoder brought.
enum Step {
    Frame(Video),
    Fed,
    End,
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

fn open_decoder(stream: &Stream) -> Result<decoder::Video, av::Error> {
    let mut context = av::codec::Context::from_parameters(stream.parameters())?;
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    context.set_threading(threading::Config {
        kind: threading::Type::Frame,
        count: cores.min(MOST_THREADS),
        ..Default::default()
    });
    let mut decoder = context.decoder();
    decoder.set_packet_time_base(stream.time_base());
    if TOLD_TO_EXPLODE.contains(&decoder.id()) {
        decoder.check(decoder::Check::EXPLODE);
    }
    decoder.video()
}
