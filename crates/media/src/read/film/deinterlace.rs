//! How does a frame of two fields become pictures that can be shown?
//!
//! The lines of an interlaced frame are from two moments, every other from the first. FFmpeg's
//! filter bwdif fills the missing lines of each moment from its neighbours in space and time.

use std::collections::VecDeque;

use av::filter::{self, Graph};
use av::frame::Video;
use ffmpeg_next as av;

/// What becomes of interlaced film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Deinterlace {
    /// A frame becomes one picture, of the moment of its first field.
    #[default]
    Frames,
    /// A frame becomes two pictures, one of each field, at twice the rate.
    Fields,
    /// A frame stays as it is: where things move, its edges are combs.
    Off,
}

/// Turns frames of one size and format into pictures of one moment each.
pub(crate) struct Deinterlacer {
    graph: Graph,
    /// Pictures that came out, and have not been taken.
    ready: VecDeque<Video>,
    is_at_end: bool,
}

impl Deinterlacer {
    /// For frames like this one, that have two pictures each where `fields` is set. The error says
    /// why FFmpeg does not do it.
    pub(crate) fn new(like: &Video, fields: bool) -> Result<Self, String> {
        let told = |e: av::Error| e.to_string();
        let mut graph = Graph::new();
        let find = |name: &str| filter::find(name).ok_or(format!("this FFmpeg has no {name}"));
        let format = av::ffi::AVPixelFormat::from(like.format()) as i32;
        let arguments = format!(
            "video_size={}x{}:pix_fmt={format}:time_base=1/2",
            like.width(),
            like.height()
        );
        graph
            .add(&find("buffer")?, "in", &arguments)
            .map_err(told)?;
        graph.add(&find("buffersink")?, "out", "").map_err(told)?;
        let mode = if fields { "send_field" } else { "send_frame" };
        let filters = format!("bwdif=mode={mode}:parity=auto:deint=interlaced");
        let linked = graph.output("in", 0).and_then(|it| it.input("out", 0));
        linked.and_then(|it| it.parse(&filters)).map_err(told)?;
        graph.validate().map_err(told)?;
        Ok(Self {
            graph,
            ready: VecDeque::new(),
            is_at_end: false,
        })
    }

    /// Takes the next frame, whose stamp is its `pts`.
    pub(crate) fn push(&mut self, frame: &Video) -> Result<(), String> {
        let mut source = self.graph.get("in").ok_or("the filter is gone")?;
        let added = source.source().add(frame);
        added.map_err(|e| e.to_string())?;
        self.pull()
    }

    /// There are no more frames.
    pub(crate) fn end(&mut self) -> Result<(), String> {
        if std::mem::replace(&mut self.is_at_end, true) {
            return Ok(());
        }
        let mut source = self.graph.get("in").ok_or("the filter is gone")?;
        source.source().flush().map_err(|e| e.to_string())?;
        self.pull()
    }

    fn pull(&mut self) -> Result<(), String> {
        let mut sink = self.graph.get("out").ok_or("the filter is gone")?;
        loop {
            let mut picture = Video::empty();
            match sink.sink().frame(&mut picture) {
                Ok(()) => self.ready.push_back(picture),
                Err(av::Error::Eof) => return Ok(()),
                Err(error) if crate::ffmpeg::wants_more(error) => return Ok(()),
                Err(error) => return Err(error.to_string()),
            }
        }
    }

    /// The next picture, if one has come out; its `pts` counts halves of the ticks of frames.
    pub(crate) fn next(&mut self) -> Option<Video> {
        self.ready.pop_front()
    }
}
