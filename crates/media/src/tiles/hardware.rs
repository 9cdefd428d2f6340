//! How does a graphics device decode pictures?
//!
//! FFmpeg's own decoders hand their parsed bits to the device; what comes out is copied back. Which
//! devices there are is known only by trying, and whether one takes a stream only by decoding.

use crate::error::MediaError;
use crate::ffmpeg::start;
use av::ffi::AVHWDeviceType as Kind;
use av::frame::Video;
use av::{codec, decoder, ffi};
use ffmpeg_next as av;
use foveal_core::content::video::bytes::codec::Codec;
use std::ffi::{CStr, c_int, c_void};
use std::ptr::{null, null_mut};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Devices in the order in which they are tried.
const KINDS: [Kind; 5] = [
    Kind::AV_HWDEVICE_TYPE_CUDA,
    Kind::AV_HWDEVICE_TYPE_VAAPI,
    Kind::AV_HWDEVICE_TYPE_VIDEOTOOLBOX,
    Kind::AV_HWDEVICE_TYPE_D3D11VA,
    Kind::AV_HWDEVICE_TYPE_VULKAN,
];

/// Decoders that are open on a device at once, at most: each takes memory of the device for its
/// reference pictures, and drivers refuse more than a few dozen.
pub(crate) const MOST_SLOTS: usize = 16;

/// A device that decodes.
#[derive(Debug)]
pub(crate) struct HardwareDevice {
    /// Owned; freed when this value goes away. Only ever read: decoders take references of it.
    context: *mut ffi::AVBufferRef,
    name: String,
    format: ffi::AVPixelFormat,
    open: AtomicUsize,
    opened: AtomicUsize,
    failed: AtomicUsize,
}

// SAFETY: FFmpeg counts the references of a buffer atomically and lets decoders of several threads
// share one device context, each through a reference of its own; the pointer itself never changes.
#[allow(unsafe_code, reason = "a pointer to FFmpeg's reference-counted device")]
unsafe impl Send for HardwareDevice {}
// SAFETY: as above.
#[allow(unsafe_code, reason = "a pointer to FFmpeg's reference-counted device")]
unsafe impl Sync for HardwareDevice {}

impl HardwareDevice {
    /// Opens the first device that there is for a codec; takes up to some hundred milliseconds.
    ///
    /// # Errors
    /// There is none; the message names what was tried.
    pub(crate) fn open(codec: Codec) -> Result<Arc<Self>, MediaError> {
        start();
        let none = |tried: &str| MediaError::Setting {
            field: "the device of --decoder hardware".to_owned(),
            found: format!("none that decodes {} ({tried})", codec.name()),
            expected: "a graphics device and its driver that FFmpeg knows (`ffmpeg -hwaccels`); \
                       give --decoder auto or software"
                .to_owned(),
        };
        let Some(decoder) = decoder_name(codec).and_then(decoder::find_by_name) else {
            return Err(none("no device does"));
        };
        let mut tried = Vec::new();
        for kind in KINDS {
            let Some(format) = format_of(decoder, kind) else {
                continue;
            };
            match open_context(kind) {
                Ok(context) => {
                    return Ok(Arc::new(Self {
                        context,
                        name: name_of(kind),
                        format,
                        open: AtomicUsize::new(0),
                        opened: AtomicUsize::new(0),
                        failed: AtomicUsize::new(0),
                    }));
                }
                Err(reason) => tried.push(format!("{}: {reason}", name_of(kind))),
            }
        }
        match tried.as_slice() {
            [] => Err(none("this FFmpeg was built without devices for it")),
            _ => Err(none(&format!("tried {}", tried.join("; ")))),
        }
    }

    /// A device that is not there, whose decoders are set to decode to `format`.
    #[cfg(test)]
    #[allow(unsafe_code, reason = "ffmpeg-next does not wrap hardware contexts")]
    pub(crate) fn pretended(format: ffi::AVPixelFormat) -> Arc<Self> {
        start();
        // SAFETY: allocates a context that is never initialised, which FFmpeg allows to be freed.
        let context = unsafe { ffi::av_hwdevice_ctx_alloc(Kind::AV_HWDEVICE_TYPE_VAAPI) };
        assert!(!context.is_null(), "this FFmpeg knows VA-API");
        Arc::new(Self {
            context,
            name: "pretended".to_owned(),
            format,
            open: AtomicUsize::new(0),
            opened: AtomicUsize::new(0),
            failed: AtomicUsize::new(0),
        })
    }

    /// What kind of device it is, as FFmpeg names it.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Decoders that were opened on it, and those of them that software had to stand in for.
    pub(crate) fn counts(&self) -> [usize; 2] {
        [&self.opened, &self.failed].map(|count| count.load(Ordering::Relaxed))
    }

    /// Room for one more decoder; `None` where as many are open as may be.
    pub(crate) fn slot(self: &Arc<Self>) -> Option<DecoderSlot> {
        let one_more = |open: usize| (open < MOST_SLOTS).then_some(open + 1);
        let order = Ordering::Relaxed;
        self.open.fetch_update(order, order, one_more).ok()?;
        self.opened.fetch_add(1, order);
        Some(DecoderSlot(Arc::clone(self)))
    }
}

impl Drop for HardwareDevice {
    #[allow(unsafe_code, reason = "FFmpeg counts references to its devices")]
    fn drop(&mut self) {
        // SAFETY: the reference was made by `open_context` and is given up once, here.
        unsafe { ffi::av_buffer_unref(&raw mut self.context) };
    }
}

/// The right to one decoder on a device.
#[derive(Debug)]
pub(crate) struct DecoderSlot(Arc<HardwareDevice>);

impl Drop for DecoderSlot {
    fn drop(&mut self) {
        self.0.open.fetch_sub(1, Ordering::Relaxed);
    }
}

impl DecoderSlot {
    /// Gives the slot up because the device failed, and counts that.
    pub(crate) fn fail(self) {
        self.0.failed.fetch_add(1, Ordering::Relaxed);
    }

    /// Makes a decoder that is not open yet decode on the device.
    #[allow(unsafe_code, reason = "ffmpeg-next does not wrap hardware contexts")]
    pub(crate) fn attach(&self, context: &mut codec::Context) -> Result<(), String> {
        // SAFETY: the context is allocated and not open; the device's buffer outlives the call, and
        // the new reference belongs to the context, which frees it. `opaque` is the user's own
        // field, here a number, never followed as a pointer.
        unsafe {
            let context = context.as_mut_ptr();
            let reference = ffi::av_buffer_ref(self.0.context);
            if reference.is_null() {
                return Err("no memory for a reference to the device".to_owned());
            }
            (*context).hw_device_ctx = reference;
            (*context).opaque = self.0.format as usize as *mut c_void;
            (*context).get_format = Some(choose_format);
        }
        Ok(())
    }

    /// Copies a picture from the device; one that lies in memory already is copied as it is.
    #[allow(unsafe_code, reason = "ffmpeg-next does not wrap hardware frames")]
    pub(crate) fn download(&self, frame: &Video) -> Result<Video, String> {
        let mut here = Video::empty();
        // SAFETY: both frames are allocated; `here` is empty, so that FFmpeg gives it memory and a
        // format of its own choice. A frame without a hardware context is only referenced.
        let status = unsafe {
            let (to, from) = (here.as_mut_ptr(), frame.as_ptr());
            let copied = if (*from).hw_frames_ctx.is_null() {
                ffi::av_frame_ref(to, from)
            } else {
                ffi::av_hwframe_transfer_data(to, from, 0)
            };
            copied.min(ffi::av_frame_copy_props(to, from))
        };
        if status < 0 {
            let reason = av::Error::from(status);
            return Err(format!("{}: no picture comes back: {reason}", self.0.name));
        }
        Ok(here)
    }
}

/// The decoder of FFmpeg that devices plug into; it may be another than the one for software.
pub(crate) fn decoder_name(codec: Codec) -> Option<&'static str> {
    match codec {
        Codec::Vp8 => Some("vp8"),
        Codec::Vp9 => Some("vp9"),
        Codec::H264 => Some("h264"),
        Codec::Hevc => Some("hevc"),
        Codec::Av1 => Some("av1"),
        Codec::Jpeg => Some("mjpeg"),
        Codec::Png => None,
    }
}

/// Called by FFmpeg with the formats that a stream can be decoded to: the device's, or none.
#[allow(unsafe_code, reason = "a callback of FFmpeg")]
unsafe extern "C" fn choose_format(
    context: *mut ffi::AVCodecContext,
    formats: *const ffi::AVPixelFormat,
) -> ffi::AVPixelFormat {
    // SAFETY: FFmpeg hands in its own context, whose `opaque` was set by `attach`, and a list that
    // ends with `AV_PIX_FMT_NONE`, which is not read beyond.
    unsafe {
        let wanted = (*context).opaque as usize;
        let mut place = formats;
        while *place != ffi::AVPixelFormat::AV_PIX_FMT_NONE {
            if *place as usize == wanted {
                return *place;
            }
            place = place.add(1);
        }
    }
    ffi::AVPixelFormat::AV_PIX_FMT_NONE
}

/// The format of a device's pictures, where a decoder can decode to it.
#[allow(
    unsafe_code,
    reason = "ffmpeg-next does not wrap hardware configurations"
)]
fn format_of(decoder: av::Codec, kind: Kind) -> Option<ffi::AVPixelFormat> {
    let by_device = ffi::AV_CODEC_HW_CONFIG_METHOD_HW_DEVICE_CTX as c_int;
    (0..).find_map(|index| {
        // SAFETY: the codec is static; the configuration is static or null after the last.
        let found = unsafe { ffi::avcodec_get_hw_config(decoder.as_ptr(), index).as_ref() };
        match found {
            None => Some(None),
            Some(config) if config.device_type == kind && config.methods & by_device != 0 => {
                Some(Some(config.pix_fmt))
            }
            Some(_) => None,
        }
    })?
}

#[allow(unsafe_code, reason = "ffmpeg-next does not wrap hardware contexts")]
fn open_context(kind: Kind) -> Result<*mut ffi::AVBufferRef, av::Error> {
    let mut context = null_mut();
    // SAFETY: `context` is a place for the new reference; the default device, without options.
    let status =
        unsafe { ffi::av_hwdevice_ctx_create(&raw mut context, kind, null(), null_mut(), 0) };
    if status < 0 {
        return Err(av::Error::from(status));
    }
    Ok(context)
}

#[allow(unsafe_code, reason = "ffmpeg-next does not wrap hardware contexts")]
fn name_of(kind: Kind) -> String {
    // SAFETY: a static string, or null for a kind that this FFmpeg does not know.
    let name = unsafe { ffi::av_hwdevice_get_type_name(kind).as_ref() };
    // SAFETY: as above; it ends with a NUL.
    name.map_or_else(
        || format!("{kind:?}"),
        |name| {
            unsafe { CStr::from_ptr(name) }
                .to_string_lossy()
                .into_owned()
        },
    )
}
