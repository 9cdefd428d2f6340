//! How is FFmpeg started, once and quietly, and how is an encoder opened without losing options?

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use ffmpeg_next as av;

use crate::read::film::damage_log::begin_to_listen;

/// Registers FFmpeg's error texts and has its log listened to, not printed; every entry into FFmpeg
/// calls this first.
pub(crate) fn start() {
    static STARTED: OnceLock<()> = OnceLock::new();
    STARTED.get_or_init(|| {
        // It only registers devices and error texts, and always returns Ok.
        let _ = av::init();
        av::log::set_level(av::log::Level::Quiet);
        begin_to_listen();
    });
}

/// The path as FFmpeg takes it: absolute, so that no part of it reads as a protocol.
///
/// Refuses paths that are not UTF-8 or that hold a NUL, on which ffmpeg-next panics.
pub(crate) fn path_for_ffmpeg(path: &Path) -> Result<PathBuf, String> {
    let absolute = std::path::absolute(path).map_err(|e| e.to_string())?;
    match absolute.to_str() {
        None => Err("the path is not valid UTF-8, which FFmpeg needs; rename it".to_owned()),
        Some(text) if text.contains('\0') => Err("the path contains a NUL character".to_owned()),
        Some(_) => Ok(absolute),
    }
}

/// Whether the system had no thread or no memory left.
pub(crate) fn lacks_resources(error: av::Error) -> bool {
    let starved = [av::error::EAGAIN, av::error::ENOMEM];
    matches!(error, av::Error::Other { errno } if starved.contains(&errno))
}

/// Whether FFmpeg asks for more input before it can give output.
pub(crate) fn wants_more(error: av::Error) -> bool {
    matches!(error, av::Error::Other { errno } if errno == av::error::EAGAIN)
}

/// Opens the encoder; an option that it does not know is an error, not dropped in silence.
#[allow(unsafe_code)] // ffmpeg-next frees the options that the encoder did not take, unseen.
pub(crate) fn open_encoder(
    mut video: av::encoder::video::Video,
    codec: av::Codec,
    options: &[(&str, String)],
) -> Result<av::encoder::video::Encoder, String> {
    let mut dictionary = av::Dictionary::new();
    for (key, value) in options {
        dictionary.set(key, value);
    }
    // SAFETY: the context was allocated for this codec and is not open yet; the dictionary is
    // disowned before the call, which replaces it by what is left, and owned again after it.
    let (status, left) = unsafe {
        let mut raw = dictionary.disown();
        let status = av::ffi::avcodec_open2(video.as_mut_ptr(), codec.as_ptr(), &raw mut raw);
        (status, av::Dictionary::own(raw))
    };
    if status < 0 {
        return Err(format!(
            "the encoder does not open: {}",
            av::Error::from(status)
        ));
    }
    match left.iter().next() {
        Some((key, _)) => Err(format!("the encoder does not know the option {key}")),
        None => Ok(av::encoder::video::Encoder(video)),
    }
}
