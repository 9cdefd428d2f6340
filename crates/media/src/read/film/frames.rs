//! Which frames does a stream show, once damage is concealed and fields are made pictures?

use std::collections::VecDeque;
use std::path::Path;

use av::format::Pixel;
use av::frame::Video;
use ffmpeg_next as av;

use crate::error::MediaError;
use crate::read::film::clusters::{Clusters, clusters_of};
use crate::read::film::deinterlace::{Deinterlace, Deinterlacer};
use crate::read::film::frame_reader::{Break, FrameReader};
use crate::read::film::mended::Mended;
use crate::read::film::mending::MOST_LEFT_OUT;
use crate::read::options::ReadOptions;
use crate::read::source;

/// A frame, and its stamp in halves of the stream's ticks.
type Stamped = (Video, Option<i64>);

/// The frames of an open file.
///
/// Undamaged files are read by as many threads as there are. At the first damage the file is
/// opened again, and read from the beginning by a decoder that conceals what it cannot decode.
pub(crate) struct Frames {
    reader: FrameReader,
    bytes: u64,
    options: ReadOptions,
    /// Decoded to learn what the file holds, and not yet taken.
    first: Option<Video>,
    /// Frames taken from the reader, and the stamp of the last.
    taken: u64,
    last_stamp: Option<i64>,
    deinterlacer: Option<Deinterlacer>,
    made_for: Option<(Pixel, [u32; 2])>,
    ready: VecDeque<Stamped>,
    is_over: bool,
    deinterlaced: u64,
    interlaced: u64,
    breaks_off: Option<String>,
    /// The clusters of a Matroska file, once all is read.
    clusters: Clusters,
    /// Whether damage after the first frame made another reader go on.
    mends_since_damage: bool,
}

impl Frames {
    /// Opens the file, which is `bytes` long, and decodes its first frame.
    pub(crate) fn open(path: &Path, bytes: u64, options: ReadOptions) -> Result<Self, MediaError> {
        let no_frames = |reason| MediaError::NoFrames {
            path: path.to_owned(),
            reason,
        };
        let mut reader = FrameReader::open(path, bytes, None)?;
        let mut first = reader.next_frame();
        // Where no frame is good, damaged ones are shown.
        for most_left_out in [MOST_LEFT_OUT, 0] {
            let Err(Break::Damaged(why)) = &first else {
                break;
            };
            let why = why.clone();
            let mending = FrameReader::open(path, bytes, Some(most_left_out))?;
            if options.strict || !mending.mends() {
                break;
            }
            reader = mending;
            first = match reader.next_frame() {
                Ok(None) => Err(Break::Damaged(why)),
                next => next,
            };
        }
        let first = match first {
            Ok(Some(first)) => first,
            Ok(None) => return Err(no_frames("it is empty".to_owned())),
            Err(stop) => return Err(no_frames(stop.reason())),
        };
        let is_image = source::is_image_format(reader.input());
        // FFmpeg hands out the fields of HEVC one by one.
        let has_fields = reader.decoder().id() == av::codec::Id::HEVC;
        let deinterlace = match is_image || has_fields {
            true => Deinterlace::Off,
            false => options.deinterlace,
        };
        Ok(Self {
            reader,
            bytes,
            options: ReadOptions {
                deinterlace,
                ..options
            },
            first: Some(first),
            taken: 0,
            last_stamp: None,
            deinterlacer: None,
            made_for: None,
            ready: VecDeque::new(),
            is_over: false,
            deinterlaced: 0,
            interlaced: 0,
            breaks_off: None,
            clusters: Clusters::default(),
            mends_since_damage: false,
        })
    }

    /// What reads the file.
    pub(crate) fn reader(&self) -> &FrameReader {
        &self.reader
    }

    /// The first frame, before anything was taken.
    pub(crate) fn first(&self) -> Option<&Video> {
        self.first.as_ref()
    }

    /// Whether each frame, by its first one, becomes two pictures.
    pub(crate) fn has_two_pictures_a_frame(&self) -> bool {
        let is_interlaced = self.first.as_ref().is_some_and(Video::is_interlaced);
        is_interlaced && self.options.deinterlace == Deinterlace::Fields
    }

    /// What was mended so far.
    pub(crate) fn mended(&self) -> Mended {
        let [dropped_at_start, damaged, lost] = self.reader.damage();
        let is_told = dropped_at_start + damaged + lost > 0 || self.reader.has_forgiven();
        // Something made the first reader stop.
        let damaged = damaged.max(u64::from(self.mends_since_damage && !is_told));
        Mended {
            dropped_at_start,
            damaged,
            lost,
            breaks_off: self.breaks_off.clone(),
            deinterlaced: self.deinterlaced,
            interlaced: self.interlaced,
            clusters: self.clusters,
            joined: self.reader.joined(),
            ..Mended::default()
        }
    }

    /// The next frame in the order of display, None after the last.
    pub(crate) fn next(&mut self) -> Result<Option<Stamped>, Break> {
        loop {
            if let Some(ready) = self.ready.pop_front() {
                return Ok(Some(ready));
            }
            if self.is_over {
                return Ok(None);
            }
            match self.decoded()? {
                Some(frame) => self.take(frame)?,
                None => {
                    self.is_over = true;
                    if self.reader.input().format().name().contains("matroska") {
                        self.clusters = clusters_of(self.reader.path());
                    }
                    self.end_deinterlacer()?;
                }
            }
        }
    }

    fn take(&mut self, mut frame: Video) -> Result<(), Break> {
        let stamp = frame.timestamp();
        let wants = self.options.deinterlace != Deinterlace::Off;
        // A still that is stored in passes is whole.
        let is_interlaced = frame.is_interlaced() && !self.is_image();
        let layout = (frame.format(), [frame.width(), frame.height()]);
        if self.made_for.is_some_and(|made_for| made_for != layout) {
            self.end_deinterlacer()?;
        }
        if is_interlaced && wants && self.deinterlacer.is_none() {
            let fields = self.options.deinterlace == Deinterlace::Fields;
            self.deinterlacer = Deinterlacer::new(&frame, fields).ok();
            self.made_for = self.deinterlacer.is_some().then_some(layout);
        }
        let Some(deinterlacer) = &mut self.deinterlacer else {
            self.interlaced += u64::from(is_interlaced);
            self.ready.push_back((frame, stamp.map(halves)));
            return Ok(());
        };
        self.deinterlaced += u64::from(is_interlaced);
        frame.set_pts(stamp);
        deinterlacer.push(&frame).map_err(Break::Fails)?;
        self.collect();
        Ok(())
    }

    fn end_deinterlacer(&mut self) -> Result<(), Break> {
        if let Some(deinterlacer) = &mut self.deinterlacer {
            deinterlacer.end().map_err(Break::Fails)?;
        }
        self.collect();
        self.deinterlacer = None;
        self.made_for = None;
        Ok(())
    }

    fn collect(&mut self) {
        while let Some(picture) = self.deinterlacer.as_mut().and_then(Deinterlacer::next) {
            let stamp = picture.pts();
            self.ready.push_back((picture, stamp));
        }
    }

    /// The next frame as it is decoded; at the first damage by a reader that mends.
    fn decoded(&mut self) -> Result<Option<Video>, Break> {
        loop {
            let next = match self.first.take() {
                Some(frame) => Ok(Some(frame)),
                None => self.reader.next_frame(),
            };
            match next {
                Ok(Some(frame)) => {
                    self.taken += 1;
                    self.last_stamp = frame.timestamp().or(self.last_stamp);
                    return Ok(Some(frame));
                }
                Ok(None) => return Ok(None),
                Err(Break::Ends(reason)) if !self.options.strict => {
                    self.breaks_off = Some(reason);
                    return Ok(None);
                }
                // What lies behind a picture is none.
                Err(Break::Damaged(_)) if self.taken > 0 && self.is_image() => return Ok(None),
                Err(Break::Damaged(reason)) if !self.options.strict && !self.reader.mends() => {
                    self.begin_mending(reason)?;
                }
                Err(stop) => return Err(stop),
            }
        }
    }

    fn is_image(&self) -> bool {
        source::is_image_format(self.reader.input())
    }

    /// Goes on where the reader broke off, with one that mends.
    fn begin_mending(&mut self, reason: String) -> Result<(), Break> {
        let opened = FrameReader::open(self.reader.path(), self.bytes, Some(MOST_LEFT_OUT));
        let mut reader = opened.map_err(|error| Break::Fails(error.to_string()))?;
        if !reader.mends() {
            return Err(Break::Fails(reason));
        }
        for _ in 0..self.taken {
            let Some(frame) = reader.next_frame()? else {
                break;
            };
            if frame
                .timestamp()
                .zip(self.last_stamp)
                .is_some_and(|(at, last)| at > last)
            {
                self.first = Some(frame);
                break;
            }
        }
        // The frames that were taken are taken.
        self.reader = reader;
        self.mends_since_damage = true;
        Ok(())
    }
}

/// A stamp in halves of its ticks.
fn halves(stamp: i64) -> i64 {
    stamp.saturating_mul(2)
}
