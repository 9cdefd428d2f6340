//! How does FFmpeg open a file, whatever that holds?
//!
//! A file of nothing, such as a damaged recording or an image of an empty disk, may be of any size;
//! many of FFmpeg's formats read all of it in search of a beginning. So that has a time limit.

use std::cell::Cell;
use std::ffi::{CString, c_int, c_void};
use std::path::Path;
use std::ptr;
use std::time::{Duration, Instant};

use av::ffi;
use av::format::context::Input;
use ffmpeg_next as av;

/// Longest search for the first picture, or the first sound, of a file.
pub(crate) const MOST_SEARCH: Duration = Duration::from_secs(30);

thread_local! {
    /// Until when this thread reads on in what it opens.
    static UNTIL: Cell<Option<Instant>> = const { Cell::new(None) };
}

/// As long as it lives, what this thread opens is read no longer than [`MOST_SEARCH`].
pub(crate) struct Search {
    /// What bounded this thread before.
    before: Option<Instant>,
}

impl Search {
    pub(crate) fn begin() -> Self {
        Self::within(MOST_SEARCH)
    }

    fn within(most: Duration) -> Self {
        let until = Instant::now() + most;
        Self {
            before: UNTIL.replace(Some(until)),
        }
    }

    /// What an error means: that nothing was found in time, or what it says.
    pub(crate) fn told(error: String) -> String {
        match is_over() {
            true => format!(
                "nothing to show was found in it within {} s",
                MOST_SEARCH.as_secs()
            ),
            false => error,
        }
    }
}

impl Drop for Search {
    fn drop(&mut self) {
        UNTIL.set(self.before);
    }
}

fn is_over() -> bool {
    UNTIL.get().is_some_and(|until| Instant::now() > until)
}

/// Asked by FFmpeg before each read.
extern "C" fn is_interrupted(_: *mut c_void) -> c_int {
    c_int::from(is_over())
}

/// Opens a file and finds its streams, within the search of this thread, if it is in one.
#[allow(unsafe_code)] // ffmpeg-next takes options or an interruption, not both.
pub(crate) fn open_input(path: &Path) -> Result<Input, av::Error> {
    let name = path.to_str().and_then(|it| CString::new(it).ok());
    let name = name.ok_or(av::Error::InvalidData)?;
    let mut options = av::Dictionary::new();
    // A name with %d in it is a name, not a series of pictures.
    options.set("pattern_type", "none");
    // SAFETY: the context was allocated here, and is the library's, or freed by it, once it is
    // given to `avformat_open_input`; the callback needs no data, so it may outlive everything;
    // name and options outlive the call, which leaves a dictionary that is owned again.
    unsafe {
        let mut context = ffi::avformat_alloc_context();
        if context.is_null() {
            let errno = libc::ENOMEM;
            return Err(av::Error::Other { errno });
        }
        (*context).interrupt_callback.callback = Some(is_interrupted);
        let mut raw = options.disown();
        let file = name.as_ptr();
        let opened =
            ffi::avformat_open_input(&raw mut context, file, ptr::null_mut(), &raw mut raw);
        drop(av::Dictionary::own(raw));
        if opened < 0 {
            return Err(av::Error::from(opened));
        }
        let found = ffi::avformat_find_stream_info(context, ptr::null_mut());
        if found < 0 {
            ffi::avformat_close_input(&raw mut context);
            return Err(av::Error::from(found));
        }
        Ok(Input::wrap(context))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::scenes::Scratch;

    #[test]
    fn a_file_of_nothing_is_not_read_to_its_end() {
        crate::ffmpeg::start();
        let file = Scratch::holding("mjpeg", b"");
        let opened = std::fs::File::options().write(true).open(&*file).unwrap();
        // A minute and more at the speed of memory.
        opened.set_len(1 << 38).unwrap();
        let begun = Instant::now();
        let search = Search::within(Duration::from_millis(50));
        let found = open_input(&file);
        assert!(begun.elapsed() < Duration::from_secs(10));
        let streams = found.map_or(0, |it| it.streams().count());
        assert!(streams <= 1);
        assert!(Search::told("else".to_owned()).contains("within 30 s"));
        drop(search);
        assert_eq!(Search::told("else".to_owned()), "else");
    }
}
