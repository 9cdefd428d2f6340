//! What does FFmpeg say of damage that it does not report otherwise?
//!
//! Some of its decoders and readers of containers go on after damage, mark nothing, and only write
//! a line.

use std::collections::BTreeMap;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, PoisonError, RwLock};

use av::ffi;
use ffmpeg_next as av;

/// How lines of decoders begin after which the picture is not what it was meant to be.
const OF_DECODERS: [&str; 9] = [
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
    // GIF.
    "LZW decode failed",
    // OpenEXR: rows that stay black.
    "decode_block() failed.",
];
/// How lines of readers of containers begin that have passed over something (FLV, ASF).
const OF_CONTAINERS: [&str; 5] = [
    "Packet mismatch ",
    "packet_obj_size ",
    "packet_replic_size ",
    "packet_frag_size ",
    "freeing incomplete packet ",
];

/// How lines of a decoder of H.264 begin that miss pictures before, and say nothing of the one that
/// they come with.
const OF_REFERENCES: [&str; 7] = [
    "mmco: ",
    "reference picture missing during reorder",
    "Missing reference picture",
    "number of reference frames",
    "co located POCs unavailable",
    "decode_slice_header error",
    "no frame!",
];

/// Which lines are listened to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Lines {
    Of(&'static [&'static str]),
    /// All errors but these.
    But(&'static [&'static str]),
}

struct Listener {
    lines: Lines,
    said: AtomicU64,
}

/// The listeners of all logs that live, by their addresses: a context of FFmpeg holds the address
/// in a field that other users of FFmpeg set to what they like.
static LISTENERS: RwLock<BTreeMap<usize, Arc<Listener>>> = RwLock::new(BTreeMap::new());

/// Counts the lines of one decoder or reader that report damage, from any thread.
pub(crate) struct DamageLog {
    listener: Arc<Listener>,
    heard: u64,
}

impl Drop for DamageLog {
    fn drop(&mut self) {
        let place = self.place() as usize;
        let mut all = LISTENERS.write().unwrap_or_else(PoisonError::into_inner);
        all.remove(&place);
    }
}

impl DamageLog {
    fn of(lines: Lines) -> Self {
        let said = AtomicU64::new(0);
        let log = Self {
            listener: Arc::new(Listener { lines, said }),
            heard: 0,
        };
        let mut all = LISTENERS.write().unwrap_or_else(PoisonError::into_inner);
        all.insert(log.place() as usize, Arc::clone(&log.listener));
        drop(all);
        log
    }

    /// Of a decoder that shows pictures.
    pub(crate) fn of_decoder() -> Self {
        Self::of(Lines::Of(&OF_DECODERS))
    }

    /// Of one that refuses damage: hears what is more than that pictures before are missing.
    pub(crate) fn of_judge() -> Self {
        Self::of(Lines::But(&OF_REFERENCES))
    }

    /// Of who reads a container.
    pub(crate) fn of_container() -> Self {
        Self::of(Lines::Of(&OF_CONTAINERS))
    }

    fn place(&self) -> *mut c_void {
        Arc::as_ptr(&self.listener).cast_mut().cast()
    }

    /// Listens to a decoder that is not open yet, and must be gone before this is.
    #[allow(unsafe_code)] // The field has no safe name.
    pub(crate) fn listen_to_decoder(&self, context: &mut av::codec::Context) {
        // SAFETY: the context is alive; FFmpeg copies the pointer and never looks at it.
        unsafe { (*context.as_mut_ptr()).opaque = self.place() };
    }

    /// Listens to who reads a container, which must be gone before this is.
    pub(crate) fn listen_to_container(&self, context: &mut ffi::AVFormatContext) {
        context.opaque = self.place();
    }

    /// Whether damage was reported since this was asked.
    pub(crate) fn has_heard(&mut self) -> bool {
        let said = self.listener.said.load(Ordering::Acquire);
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
    if level > ffi::AV_LOG_WARNING || who.is_null() || line.is_null() {
        return;
    }
    // SAFETY: who speaks begins with a pointer to its class; where that is a decoder's or a
    // container's, it is one; the line ends in NUL. `opaque` is looked up, and never followed.
    let (opaque, line) = unsafe {
        let class = *who.cast::<*const ffi::AVClass>();
        let opaque = if class == ffi::avcodec_get_class() {
            (*who.cast::<ffi::AVCodecContext>()).opaque
        } else if class == ffi::avformat_get_class() {
            (*who.cast::<ffi::AVFormatContext>()).opaque
        } else {
            return;
        };
        (opaque, CStr::from_ptr(line).to_bytes())
    };
    let all = LISTENERS.read().unwrap_or_else(PoisonError::into_inner);
    let Some(listener) = all.get(&(opaque as usize)) else {
        return;
    };
    let begins = |lines: &[&str]| lines.iter().any(|it| line.starts_with(it.as_bytes()));
    let is_damage = match listener.lines {
        Lines::Of(lines) => begins(lines),
        Lines::But(lines) => level <= ffi::AV_LOG_ERROR && !begins(lines),
    };
    let said = u64::from(is_damage);
    listener.said.fetch_add(said, Ordering::AcqRel);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn say(context: &mut av::codec::Context, line: &CStr) {
        // SAFETY: the context is alive and begins with its class; the line ends in NUL.
        #[allow(unsafe_code)]
        unsafe {
            let who = context.as_mut_ptr().cast();
            hear(who, ffi::AV_LOG_ERROR, line.as_ptr(), std::ptr::null_mut());
        }
    }

    #[test]
    fn a_context_whose_field_holds_something_else_is_not_listened_to() {
        let mut log = DamageLog::of_decoder();
        let mut context = av::codec::Context::new();
        log.listen_to_decoder(&mut context);
        say(&mut context, c"LZW decode failed");
        assert!(log.has_heard());
        // As a decoder of the graphics card keeps its pixel format there.
        #[allow(unsafe_code)]
        // SAFETY: the context is alive, and nothing follows the pointer.
        unsafe {
            (*context.as_mut_ptr()).opaque = 0xa5 as *mut c_void;
        }
        say(&mut context, c"LZW decode failed");
        assert!(!log.has_heard());
        log.listen_to_decoder(&mut context);
        drop(log);
        say(&mut context, c"LZW decode failed");
    }
}
