//! How does a device of FFmpeg give its pictures?

use super::source::{CaptureError, CapturedPicture, LiveSource};
use super::windows::{keep_covered, no_display, window_titled};
use crate::ffmpeg::{start, wants_more};
use crate::read::convert::{Converter, Layout};
use crate::read::deliver::layout_of;
use av::format::Pixel;
use av::format::context::Input;
use av::frame::Video;
use ffmpeg_next as av;
use std::time::{Duration, Instant};
use x11rb::rust_connection::RustConnection;

/// Pictures a second of a screen.
const RATE: &str = "30";
/// Opening a device leaves up to so many pictures behind, which are old by then.
const MOST_OLD: u32 = 10;
/// A picture that comes sooner than this was waiting.
const WAITED: Duration = Duration::from_millis(4);
/// How often, and how far apart, a window that changed its size is reopened.
const REOPENS: u32 = 20;
const REOPEN_EVERY: Duration = Duration::from_millis(100);
/// Longest time that a graph's picture is held back for its turn.
const MOST_PACE: Duration = Duration::from_secs(1);

/// What comes next of a device.
pub(super) enum Next {
    Picture(CapturedPicture),
    /// No more, and why.
    End(String),
}

/// An open device.
pub(super) struct Device {
    source: LiveSource,
    reader: Reader,
    converter: Option<Converter>,
    /// Pictures that may be older than the device's opening.
    old: u32,
    /// Has the X server keep what of a window others cover.
    _kept: Option<RustConnection>,
}

struct Reader {
    input: Input,
    stream: usize,
    decoder: av::decoder::Video,
    /// When the first picture came, and its time in the graph.
    first: Option<(Instant, f64)>,
}

impl Device {
    pub(super) fn open(source: &LiveSource) -> Result<Self, CaptureError> {
        start();
        let source = match source {
            LiveSource::Titled(title) => LiveSource::Window(window_titled(title)?),
            other => other.clone(),
        };
        let wrong = |reason: String, next: &str| CaptureError::Open {
            name: source.to_string(),
            reason,
            next: next.to_owned(),
        };
        let display = std::env::var("DISPLAY").unwrap_or_default();
        let is_of_x = matches!(source, LiveSource::Screen | LiveSource::Window(_));
        if is_of_x && display.is_empty() {
            let (reason, next) = no_display("DISPLAY is not set");
            return Err(wrong(reason, &next));
        }
        let kept = match &source {
            LiveSource::Window(window) => keep_covered(*window),
            _ => None,
        };
        let reader = Reader::open(&source, &display).map_err(|reason| {
            let next = match &source {
                LiveSource::Screen => "is DISPLAY that of a running X server that may be captured?",
                LiveSource::Window(_) => "is the window still there? xwininfo prints its number",
                LiveSource::Camera(_) => "give a device that `v4l2-ctl --list-devices` lists",
                _ => "give a graph that makes pictures, such as lavfi:testsrc2",
            };
            wrong(reason, next)
        })?;
        let old = match source {
            LiveSource::Graph(_) => 0,
            _ => MOST_OLD,
        };
        Ok(Self {
            source,
            reader,
            converter: None,
            old,
            _kept: kept,
        })
    }

    /// The next picture, once it is there.
    pub(super) fn next(&mut self) -> Next {
        loop {
            let begun = Instant::now();
            let frame = match self.reader.next() {
                Ok(Some(frame)) => frame,
                Ok(None) => return Next::End("it is over".to_owned()),
                Err(error) => match self.go_on(error) {
                    None => continue,
                    Some(why) => return Next::End(why),
                },
            };
            if self.old > 0 {
                self.old -= 1;
                if begun.elapsed() < WAITED {
                    continue;
                }
                self.old = 0;
            }
            if let LiveSource::Graph(_) = self.source {
                self.reader.wait_for(&frame);
            }
            return match self.picture(&frame) {
                Ok(picture) => Next::Picture(picture),
                Err(why) => Next::End(why),
            };
        }
    }

    /// Reopens a window that changed its size; why it ends where it cannot.
    fn go_on(&mut self, error: av::Error) -> Option<String> {
        let LiveSource::Window(_) = self.source else {
            return Some(format!("it cannot be read any more: {error}"));
        };
        let display = std::env::var("DISPLAY").unwrap_or_default();
        for _ in 0..REOPENS {
            if let Ok(reader) = Reader::open(&self.source, &display) {
                self.reader = reader;
                self.old = MOST_OLD;
                return None;
            }
            std::thread::sleep(REOPEN_EVERY);
        }
        Some("the window was closed".to_owned())
    }

    /// The picture of a frame, in full colour.
    fn picture(&mut self, frame: &Video) -> Result<CapturedPicture, String> {
        let from = layout_of(frame, false)?;
        if self.converter.as_ref().is_none_or(|it| it.from() != from) {
            let to = Layout {
                format: Pixel::RGBA,
                full_range: true,
                ..from
            };
            self.converter = Some(Converter::new(from, to)?);
        }
        let Some(converter) = &mut self.converter else {
            return Err("there is no conversion".to_owned());
        };
        let rgba = converter.run(frame)?;
        let [width, height] = from.size.map(|side| side as usize);
        let rows = rgba.data(0).chunks(rgba.stride(0)).take(height);
        let mut pixels: Vec<u8> = Vec::with_capacity(4 * width * height);
        rows.for_each(|row| pixels.extend_from_slice(&row[..4 * width]));
        pixels
            .iter_mut()
            .skip(3)
            .step_by(4)
            .for_each(|it| *it = 255);
        Ok(CapturedPicture {
            size: from.size,
            rgba: pixels,
        })
    }
}

impl Reader {
    fn open(source: &LiveSource, display: &str) -> Result<Self, String> {
        if let LiveSource::Graph(graph) = source {
            // What ends in sound takes no pixel format.
            let whole = LiveSource::Graph(with_whole_chroma(graph));
            return Self::open_as_it_is(&whole, display)
                .or_else(|_| Self::open_as_it_is(source, display));
        }
        Self::open_as_it_is(source, display)
    }

    fn open_as_it_is(source: &LiveSource, display: &str) -> Result<Self, String> {
        let mut options = av::Dictionary::new();
        let (device, url) = match source {
            LiveSource::Screen => ("x11grab", display),
            LiveSource::Window(number) => {
                options.set("window_id", &number.to_string());
                ("x11grab", display)
            }
            LiveSource::Camera(device) => ("video4linux2,v4l2", device.as_str()),
            LiveSource::Graph(graph) => ("lavfi", graph.as_str()),
            LiveSource::Titled(_) => return Err("a title is no device".to_owned()),
        };
        if device == "x11grab" {
            options.set("framerate", RATE);
        }
        if url.contains('\0') {
            return Err("its name holds a NUL character".to_owned());
        }
        let format = av::device::input::video().find(|it| it.name() == device);
        let format = format.ok_or_else(|| format!("this FFmpeg has no device {device}"))?;
        let opened = av::format::open_with(url, &format, options).map_err(|it| it.to_string())?;
        let av::format::Context::Input(input) = opened else {
            return Err(format!("{device} gives no pictures"));
        };
        let stream = input.streams().best(av::media::Type::Video);
        let stream = stream.ok_or_else(|| format!("{device} gives no pictures"))?;
        let context = av::codec::context::Context::from_parameters(stream.parameters());
        let decoder = context.and_then(|it| it.decoder().video());
        Ok(Self {
            stream: stream.index(),
            decoder: decoder.map_err(|it| format!("its pictures cannot be decoded: {it}"))?,
            input,
            first: None,
        })
    }

    /// The next frame; `None` after the last.
    fn next(&mut self) -> Result<Option<Video>, av::Error> {
        let mut frame = Video::empty();
        loop {
            match self.decoder.receive_frame(&mut frame) {
                Ok(()) => return Ok(Some(frame)),
                Err(av::Error::Eof) => return Ok(None),
                Err(error) if !wants_more(error) => return Err(error),
                Err(_) => {}
            }
            let mut packet = av::Packet::empty();
            match packet.read(&mut self.input) {
                Ok(()) if packet.stream() == self.stream => self.decoder.send_packet(&packet)?,
                Ok(()) => {}
                Err(av::Error::Eof) => self.decoder.send_eof()?,
                Err(error) if wants_more(error) => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Waits until it is a frame's turn: a graph gives its pictures as fast as they are taken.
    fn wait_for(&mut self, frame: &Video) {
        let base = self
            .input
            .stream(self.stream)
            .map(|it| f64::from(it.time_base()));
        let time = frame.timestamp().unwrap_or_default() as f64 * base.unwrap_or_default();
        let (begun, first) = *self.first.get_or_insert((Instant::now(), time));
        let due = Duration::try_from_secs_f64(time - first).unwrap_or_default();
        let left = due.saturating_sub(begun.elapsed());
        std::thread::sleep(left.min(MOST_PACE));
    }
}

/// Pixel formats with colour at every pixel.
const WHOLE_CHROMA: &str = "format=pix_fmts=rgba|bgra|rgb24|bgr24|gbrp|yuv444p|yuva444p|gray";

/// The graph, with colour at every pixel of what it ends in: where colour is halved, FFmpeg's
/// sources leave out the last column and row of an odd size.
fn with_whole_chroma(graph: &str) -> String {
    let chain = graph.trim_end();
    let label = match chain.ends_with(']') {
        true => chain.rfind('[').unwrap_or(chain.len()),
        false => chain.len(),
    };
    let (filters, label) = chain.split_at(label);
    format!("{filters},{WHOLE_CHROMA}{label}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_graph_of_an_odd_size_keeps_its_last_column_and_row() {
        for (graph, size) in [
            ("testsrc2=size=1001x667", [1001, 667]),
            ("testsrc2=s=33x17,hflip[out0]", [33, 17]),
            ("color=s=5x3", [5, 3]),
        ] {
            let source = LiveSource::Graph(graph.to_owned());
            let mut device = Device::open(&source).unwrap();
            let Next::Picture(picture) = device.next() else {
                panic!("{graph} gives no picture");
            };
            let [width, height] = picture.size;
            assert_eq!([width, height], size, "{graph}");
            assert_eq!(picture.rgba.len(), (4 * width * height) as usize);
        }
    }

    #[test]
    fn a_pixel_format_is_asked_for_before_the_label_of_the_output() {
        let asked = with_whole_chroma("color[a];[a]hflip[out0] ");
        assert_eq!(asked, format!("color[a];[a]hflip,{WHOLE_CHROMA}[out0]"));
    }
}
