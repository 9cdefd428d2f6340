//! What does a decoder say of damage that it does not report otherwise?
//!
//! Some of FFmpeg's decoders go on after damage, mark no frame, and only write a line.

use std::ffi::{CStr, c_char, c_int, c_void};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use av::ffi;
use ffmpeg_next as av;

/// Lines, up to where numbers come, after which the picture is not what it was meant to be.
const DAMAGE: [&str; 7] = [
    // HEVC: a picture that others lean on is not there.
    "Could not find ref with POC ",
    "CABAC_MAX_BIN : ",
    "First slice in a frame missing.",
    // FFV1.
    "slice CRC mismatch ",
    "bytestream end mismatching by ",
    // DNxHD and ProRes.
    "ac tex damaged ",
    "error decoding picture",
];

/// Counts what a decoder says, from any thread.
#[derive(Default)]
pub(crate) struct DecoderLog {
    said: Arc<AtomicU64>,
    heard: u64,
}

impl DecoderLog {
    /// Listens to a decoder that is not open yet, and must be gone before this is.
    #[allow(unsafe_code)] // The field has no safe name.
    pub(crate) fn listen(&self, context: &mut av::codec::Context) {
        // SAFETY: the context is alive; FFmpeg copies the pointer and never looks at it.
        unsafe { (*context.as_mut_ptr()).opaque = Arc::as_ptr(&self.said).cast_mut().cast() };
    }

    /// Whether damage was told of since this was asked.
    pub(crate) fn has_heard(&mut self) -> bool {
        let said = self.said.load(Ordering::Acquire);
        std::mem::replace(&mut self.heard, said) != said
    }
}

/// As FFmpeg calls what it hands its lines to, but for their numbers.
type Hear = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *mut c_void);

/// Has FFmpeg hand its lines over in place of printing them.
#[allow(unsafe_code)]
pub(crate) fn begin_to_listen() {
    // SAFETY: the last argument, a list of numbers whose type has other names on other systems, is
    // a pointer or handed over as one, and is not looked at; the function is there for ever.
    unsafe {
        let hear = std::mem::transmute::<Hear, unsafe extern "C" fn(_, _, _, _)>(hear as Hear);
        ffi::av_log_set_callback(Some(hear));
    }
}

#[allow(unsafe_code)] // FFmpeg calls it.
unsafe extern "C" fn hear(who: *mut c_void, level: c_int, line: *const c_char, _: *mut c_void) {
    if level > ffi::AV_LOG_ERROR || who.is_null() || line.is_null() {
        return;
    }
    // SAFETY: who speaks begins with a pointer to its class, and where that is a decoder's is one,
    // whose `opaque` is null or was set above, to what lives longer; the line ends in NUL.
    unsafe {
        if *who.cast::<*const ffi::AVClass>() != ffi::avcodec_get_class() {
            return;
        }
        let said = (*who.cast::<ffi::AVCodecContext>()).opaque;
        let line = CStr::from_ptr(line).to_bytes();
        if let Some(said) = said.cast::<AtomicU64>().as_ref()
            && DAMAGE.iter().any(|it| line.starts_with(it.as_bytes()))
        {
            said.fetch_add(1, Ordering::AcqRel);
        }
    }
}
