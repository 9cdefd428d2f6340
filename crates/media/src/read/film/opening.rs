//! How does FFmpeg read a file, whatever that holds?
//!
//! A file of nothing, such as a damaged recording or an image of an empty disk, may be of any size.
//! Many of FFmpeg's formats read all of it in search of a beginning, and keep it meanwhile. So what
//! is read for one packet has a limit.

use std::cell::Cell;
use std::ffi::{CStr, CString, c_int, c_void};
use std::path::Path;
use std::ptr;

use av::ffi;
use av::format::context::Input;
use ffmpeg_next as av;

use crate::plain_file::first_bytes;
use crate::read::film::corrected::corrections::corrections_of;
use crate::read::film::corrected::file::CorrectedFile;
use crate::read::film::damage_log::DamageLog;

/// Most bytes that are read for a packet, or to open a file. FFmpeg keeps them four times over.
const MOST_BYTES: i64 = 1 << 28;
/// So many times as many where a container says how long its packets are, which are kept once.
const KNOWN_LENGTHS: i64 = 4;
const TELL_LENGTHS: [&str; 8] = [
    "mov,mp4",
    "matroska",
    "avi",
    "nut",
    "mxf",
    "yuv4mpegpipe",
    "flv",
    "ivf",
];
/// The same of a picture, which is one packet.
const MOST_OF_PICTURE: i64 = 1 << 32;

/// How far a search of this thread is.
#[derive(Clone, Copy)]
struct State {
    /// Most bytes of it.
    most: i64,
    /// Bytes read of the file before it, once known.
    before: Option<i64>,
    is_over: bool,
}

thread_local! {
    static SEARCH: Cell<Option<State>> = const { Cell::new(None) };
    /// [`MOST_BYTES`], but for tests.
    static MOST: Cell<i64> = const { Cell::new(MOST_BYTES) };
}

/// As long as it lives, this thread reads no more of a file than a search may.
struct Search;

impl Search {
    fn begin() -> Self {
        SEARCH.set(Some(State {
            most: MOST.get(),
            before: None,
            is_over: false,
        }));
        Self
    }

    /// What an error means: that nothing was found, or what it says.
    fn told(&self, error: &av::Error) -> String {
        match SEARCH.get().filter(|it| it.is_over) {
            Some(state) => nothing(state.most),
            None => error.to_string(),
        }
    }
}

impl Drop for Search {
    fn drop(&mut self) {
        SEARCH.set(None);
    }
}

/// Asked by FFmpeg before each read of a file; `context` is that of the file.
#[allow(unsafe_code)] // FFmpeg calls it.
extern "C" fn is_interrupted(context: *mut c_void) -> c_int {
    let Some(mut state) = SEARCH.get() else {
        return 0;
    };
    // SAFETY: the context outlives its files, and is no other thread's while this one reads.
    let Some(context) = (unsafe { context.cast::<ffi::AVFormatContext>().as_ref() }) else {
        return 0;
    };
    // SAFETY: null, or the file of the context, open as long as it is read.
    let read = unsafe { context.pb.as_ref() }.map_or(0, |file| file.bytes_read);
    let found = read - *state.before.get_or_insert(read);
    state.is_over |= found > state.most && found > most_of(context, state.most);
    SEARCH.set(Some(state));
    c_int::from(state.is_over)
}

/// Most bytes of a search of a file, by its format, once that is known.
#[allow(unsafe_code)]
fn most_of(context: &ffi::AVFormatContext, most: i64) -> i64 {
    // SAFETY: null, or a constant of the library, whose name ends in NUL.
    let name = unsafe { context.iformat.as_ref().map(|it| CStr::from_ptr(it.name)) };
    let name = name.map_or(&b""[..], CStr::to_bytes);
    let tells = |it: &&str| name.starts_with(it.as_bytes());
    match name == b"image2" || name.ends_with(b"_pipe") {
        true => MOST_OF_PICTURE,
        false if TELL_LENGTHS.iter().any(tells) => most * KNOWN_LENGTHS,
        false => most,
    }
}

/// That a search found nothing.
fn nothing(most: i64) -> String {
    format!("{} MiB of it hold nothing to show", most >> 20)
}

/// An open file. What is corrected of it outlives what reads it, and so comes last.
pub(crate) struct OpenFile {
    pub(crate) input: Input,
    pub(crate) corrected: Option<CorrectedFile>,
    /// What was corrected, in words.
    pub(crate) told: Vec<String>,
}

/// FFmpeg's formats that it does not find by itself, and what their files begin with.
const UNFOUND: [(&CStr, [&[u8]; 2]); 1] = [(c"phm_pipe", [b"PH\n", b"Ph\n"])];

/// The format of a file that FFmpeg takes for another; null for others.
#[allow(unsafe_code)] // ffmpeg-next has no formats by name.
fn format_of(path: &Path) -> *const ffi::AVInputFormat {
    let head = first_bytes(path, 8).unwrap_or_default();
    let is_one = |(_, heads): &&(&CStr, [&[u8]; 2])| heads.iter().any(|it| head.starts_with(it));
    match UNFOUND.iter().find(is_one) {
        // SAFETY: the name ends in NUL; what comes back is a constant of the library, or null.
        Some((name, _)) => unsafe { ffi::av_find_input_format(name.as_ptr()) },
        None => ptr::null(),
    }
}

/// Opens a file and finds its streams, with what is wrong in its head corrected. The log, if there
/// is one, hears what is reported meanwhile and later, and must outlive it. The error says why it
/// is not opened.
#[allow(unsafe_code)] // ffmpeg-next takes options or an interruption, not both.
pub(crate) fn open_input(path: &Path, log: Option<&DamageLog>) -> Result<OpenFile, String> {
    let corrections = corrections_of(path);
    let told = corrections.told.clone();
    let corrected = match corrections.is_empty() {
        true => None,
        false => Some(CorrectedFile::open(path, corrections)?),
    };
    let format = format_of(path);
    let name = path.to_str().and_then(|it| CString::new(it).ok());
    let name = name.ok_or("its name cannot be passed to FFmpeg")?;
    let mut options = av::Dictionary::new();
    // A name with %d in it is a name, not a series of pictures.
    options.set("pattern_type", "none");
    let search = Search::begin();
    let why = |status: c_int| search.told(&av::Error::from(status));
    // SAFETY: the context was allocated here, and is freed by `avformat_open_input` where that
    // fails, else closed here or owned by what is returned; its callback is given itself, which
    // outlives its files; name and options outlive the call, which leaves a dictionary that is
    // owned again.
    unsafe {
        let mut context = ffi::avformat_alloc_context();
        if context.is_null() {
            return Err("there is no memory for it".to_owned());
        }
        if let Some(log) = log {
            log.listen_to_container(&mut *context);
        }
        (*context).interrupt_callback = ffi::AVIOInterruptCB {
            callback: Some(is_interrupted),
            opaque: context.cast(),
        };
        if let Some(corrected) = &corrected {
            (*context).pb = corrected.as_ptr();
        }
        let mut left = options.disown();
        let name = name.as_ptr();
        let opened = ffi::avformat_open_input(&raw mut context, name, format, &raw mut left);
        drop(av::Dictionary::own(left));
        if opened < 0 {
            return Err(why(opened));
        }
        let found = ffi::avformat_find_stream_info(context, ptr::null_mut());
        if found < 0 {
            ffi::avformat_close_input(&raw mut context);
            return Err(why(found));
        }
        Ok(OpenFile {
            input: Input::wrap(context),
            corrected,
            told,
        })
    }
}

/// Reads the next packet; false at the end of the file. The error says why there is none.
pub(crate) fn read_packet(packet: &mut av::Packet, input: &mut Input) -> Result<bool, String> {
    let search = Search::begin();
    match packet.read(input) {
        // What was kept of a search without an end is no packet, nor is that the file's end.
        read if SEARCH.get().is_some_and(|it| it.is_over) => {
            Err(search.told(&read.err().unwrap_or(av::Error::Exit)))
        }
        Ok(()) => Ok(true),
        Err(av::Error::Eof) => Ok(false),
        // A search before this one came to nothing.
        Err(av::Error::Exit) => Err(nothing(MOST.get())),
        Err(error) => Err(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::VideoInput;
    use crate::tests::scenes::Scratch;

    #[test]
    fn a_file_of_nothing_is_not_read_to_its_end() {
        MOST.set(8 << 20);
        for ending in ["h264", "mjpeg", "mp3"] {
            let file = Scratch::holding(ending, b"");
            let opened = std::fs::File::options().write(true).open(&*file).unwrap();
            opened.set_len(1 << 40).unwrap();
            let told = VideoInput::open(&file).err().unwrap().to_string();
            assert!(told.contains(ending), "{told}");
        }
    }
}
