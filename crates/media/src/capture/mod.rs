//! What does a screen, a window, a camera or a filter graph show right now?
//!
//! A thread reads a device of FFmpeg and keeps the newest picture alone, in full colour: text on a
//! screen dies in 4:2:0. Only what a person names on the command line is opened.

mod device;
pub mod graph;
pub mod source;
mod windows;

use device::{Device, Next};
use source::{CaptureError, CapturedPicture, LiveSource};
use std::sync::mpsc::channel;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Longest wait for a source to open.
const MOST_OPENING: Duration = Duration::from_secs(10);

/// A source that is being captured; the capture ends with the value.
///
/// ```no_run
/// use foveal_media::capture::{Capture, source::LiveSource};
/// use std::time::Duration;
///
/// let source = LiveSource::parse("x11:root").unwrap();
/// let capture = Capture::open(&source)?;
/// if let Some(picture) = capture.next(Duration::from_secs(1)) {
///     println!("{:?}", picture.size);
/// }
/// # Ok::<(), foveal_media::capture::source::CaptureError>(())
/// ```
pub struct Capture {
    shared: Arc<Shared>,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    newest: Option<CapturedPicture>,
    /// Pictures that a newer one took the place of before anybody asked.
    dropped: u64,
    /// Why no more come.
    ended: Option<String>,
    is_given_up: bool,
}

impl Capture {
    /// Begins to capture.
    ///
    /// # Errors
    /// There is no such screen, window, device or graph.
    pub fn open(source: &LiveSource) -> Result<Self, CaptureError> {
        if let LiveSource::Graph(graph) = source {
            graph::check(graph).map_err(|reason| CaptureError::Open {
                name: source.to_string(),
                reason,
                next: "give a graph of others, such as lavfi:testsrc2".to_owned(),
            })?;
        }
        let shared = Arc::new(Shared::default());
        let (there, wanted) = (Arc::clone(&shared), source.clone());
        let (opened, is_open) = channel();
        // A device may never answer, and a graph's sums never end.
        let capturing = move || {
            let mut device = match Device::open(&wanted) {
                Ok(device) => device,
                Err(error) => {
                    // The receiver may be gone.
                    let _ = opened.send(Err(error));
                    return;
                }
            };
            if opened.send(Ok(())).is_err() {
                return;
            }
            let why = loop {
                match device.next() {
                    Next::Picture(picture) => {
                        if !there.put(picture) {
                            return;
                        }
                    }
                    Next::End(why) => break why,
                }
            };
            there.state().ended = Some(why);
            there.changed.notify_all();
        };
        let thread = std::thread::Builder::new().name("capture".to_owned());
        thread
            .spawn(capturing)
            .map_err(|error| CaptureError::Open {
                name: source.to_string(),
                reason: format!("no thread can be had for it: {error}"),
                next: "raise the limits on threads and memory: `ulimit -u`, `ulimit -v`".to_owned(),
            })?;
        match is_open.recv_timeout(MOST_OPENING) {
            Ok(opened) => opened.map(|()| Self { shared }),
            Err(_) => Err(CaptureError::Open {
                name: source.to_string(),
                reason: format!("it does not open within {} s", MOST_OPENING.as_secs()),
                next: "is it there, and does it work elsewhere?".to_owned(),
            }),
        }
    }

    /// The newest picture that was not asked for before, waited for so long; `None` where none
    /// came, or none will.
    #[must_use]
    pub fn next(&self, wait: Duration) -> Option<CapturedPicture> {
        let state = self.shared.state();
        let waits = |state: &mut State| state.newest.is_none() && state.ended.is_none();
        let waited = self.shared.changed.wait_timeout_while(state, wait, waits);
        let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        state.newest.take()
    }

    /// Why no more pictures come, once the last one was taken.
    #[must_use]
    pub fn ended(&self) -> Option<String> {
        let state = self.shared.state();
        state.ended.clone().filter(|_| state.newest.is_none())
    }

    /// Number of pictures that a newer one took the place of before anybody asked for them.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        self.shared.state().dropped
    }
}

impl Drop for Capture {
    fn drop(&mut self) {
        // A device that gives nothing keeps its thread until the program ends.
        self.shared.state().is_given_up = true;
    }
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts a picture in the place of one that was not taken; `false` where no picture is wanted
    /// any more.
    fn put(&self, picture: CapturedPicture) -> bool {
        let mut state = self.state();
        state.dropped += u64::from(state.newest.is_some());
        state.newest = Some(picture);
        self.changed.notify_all();
        !state.is_given_up
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_graph_shows_its_colours_and_ends_when_it_is_over() {
        let graph = "color=c=0x2060a0:size=64x48:rate=50:duration=0.5";
        let capture = Capture::open(&LiveSource::Graph(graph.to_owned())).unwrap();
        let picture = capture.next(Duration::from_secs(20)).unwrap();
        assert_eq!(picture.size, [64, 48]);
        let off = |a: u8, b: u8| a.abs_diff(b);
        for pixel in picture.rgba.chunks(4) {
            assert!(
                off(pixel[0], 0x20)
                    .max(off(pixel[1], 0x60))
                    .max(off(pixel[2], 0xa0))
                    <= 3
            );
            assert_eq!(pixel[3], 255);
        }
        while capture.next(Duration::from_secs(20)).is_some() {}
        assert!(capture.ended().unwrap().contains("over"));
    }

    #[test]
    fn what_is_not_there_is_refused_with_what_to_do() {
        let refusal = |name: &str| {
            let opened = Capture::open(&LiveSource::parse(name).unwrap());
            opened.err().unwrap().to_string()
        };
        assert!(refusal("lavfi:no_such_filter").starts_with("lavfi:no_such_filter: "));
        assert!(refusal("v4l2:/dev/no-such-camera").contains("v4l2:/dev/no-such-camera: "));
        let refused = refusal("lavfi:testsrc2,metadata=print:file=x");
        assert!(refused.contains("\"metadata\""), "{refused}");
    }
}
