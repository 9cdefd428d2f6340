//! How does FFmpeg read a file some of whose bytes are corrected?

use std::ffi::{c_int, c_void};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::ptr;

use av::ffi;
use ffmpeg_next as av;

use crate::plain_file::open_plain;
use crate::read::film::corrected::bytes::Corrections;

/// Bytes read at once.
const PIECE: usize = 1 << 16;
/// What FFmpeg takes for an error of reading: EIO.
const FAILED: c_int = -5;

/// A file as it should be. It must outlive what reads it.
pub(crate) struct CorrectedFile {
    context: *mut ffi::AVIOContext,
    state: *mut State,
}

struct State {
    file: File,
    at: u64,
    corrections: Corrections,
}

// SAFETY: both pointers are owned, and nothing of them is tied to a thread.
#[allow(unsafe_code)]
unsafe impl Send for CorrectedFile {}

impl CorrectedFile {
    /// The file at `path`, with corrections.
    #[allow(unsafe_code)] // ffmpeg-next has no files that call back.
    pub(crate) fn open(path: &Path, corrections: Corrections) -> Result<Self, String> {
        let (file, _) = open_plain(path).map_err(|error| error.to_string())?;
        let state = Box::into_raw(Box::new(State {
            file,
            at: 0,
            corrections,
        }));
        // SAFETY: the buffer is FFmpeg's own, and is the context's from then on; the state lives as
        // long as the context.
        let context = unsafe {
            let buffer = ffi::av_malloc(PIECE).cast::<u8>();
            match buffer.is_null() {
                true => ptr::null_mut(),
                false => ffi::avio_alloc_context(
                    buffer,
                    PIECE as c_int,
                    0,
                    state.cast(),
                    Some(read),
                    None,
                    Some(seek),
                ),
            }
        };
        let this = Self { context, state };
        match context.is_null() {
            true => Err("there is no memory for it".to_owned()),
            false => Ok(this),
        }
    }

    /// What FFmpeg reads.
    pub(in crate::read::film) fn as_ptr(&self) -> *mut ffi::AVIOContext {
        self.context
    }
}

impl Drop for CorrectedFile {
    #[allow(unsafe_code)] // Both are ours to free.
    fn drop(&mut self) {
        // SAFETY: what reads it is gone; both were made above, and are freed once.
        unsafe {
            if !self.context.is_null() {
                ffi::av_freep((&raw mut (*self.context).buffer).cast());
                ffi::avio_context_free(&raw mut self.context);
            }
            drop(Box::from_raw(self.state));
        }
    }
}

#[allow(unsafe_code)] // FFmpeg calls it.
extern "C" fn read(state: *mut c_void, buffer: *mut u8, size: c_int) -> c_int {
    // SAFETY: the state of an open file, used by one thread at a time; the buffer has this size.
    let (state, buffer) = unsafe {
        let Some(state) = state.cast::<State>().as_mut() else {
            return FAILED;
        };
        let size = usize::try_from(size).unwrap_or(0);
        (state, std::slice::from_raw_parts_mut(buffer, size))
    };
    match state.file.read(buffer) {
        Ok(0) => ffi::AVERROR_EOF,
        Ok(count) => {
            state.corrections.correct(state.at, &mut buffer[..count]);
            state.at += count as u64;
            count as c_int
        }
        Err(_) => FAILED,
    }
}

#[allow(unsafe_code)] // The same.
extern "C" fn seek(state: *mut c_void, offset: i64, whence: c_int) -> i64 {
    // SAFETY: as above.
    let Some(state) = (unsafe { state.cast::<State>().as_mut() }) else {
        return i64::from(FAILED);
    };
    const SIZE: c_int = 0x10000;
    const FORCE: c_int = 0x20000;
    let to = match whence & !FORCE {
        SIZE => {
            let bytes = state.file.metadata().map(|it| it.len());
            return bytes.map_or(i64::from(FAILED), |it| it as i64);
        }
        0 => u64::try_from(offset).map(SeekFrom::Start).ok(),
        1 => Some(SeekFrom::Current(offset)),
        2 => Some(SeekFrom::End(offset)),
        _ => None,
    };
    match to.map(|to| state.file.seek(to)) {
        Some(Ok(at)) => {
            state.at = at;
            at as i64
        }
        _ => i64::from(FAILED),
    }
}
