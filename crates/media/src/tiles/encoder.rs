//! Which encoder of FFmpeg codes a codec, and with which settings?

use av::encoder::video::{Encoder, Video};
use av::format::Pixel;
use av::{codec, encoder};
use ffmpeg_next as av;
use foveal_core::content::video::bytes::codec::Codec;

use crate::ffmpeg::open_encoder;
use crate::tiles::encode_settings::{EncodeSettings, Speed};

/// Longer than any group: the only key frame is the one that is asked for.
const NO_OWN_KEYS: u32 = 9999;

type Options = Vec<(&'static str, String)>;

/// An encoder for one group at a fixed quantiser.
pub(crate) fn open_group_encoder(
    settings: &EncodeSettings,
    quantiser: u8,
    size: [u32; 2],
) -> Result<Encoder, String> {
    let (name, format) = match settings.codec {
        Codec::Vp8 => ("libvpx", Pixel::YUV420P),
        Codec::H264 => ("libx264", Pixel::YUV420P),
        Codec::Hevc => ("libx265", Pixel::YUV420P),
        Codec::Av1 => ("libaom-av1", Pixel::YUV420P),
        Codec::Jpeg => ("mjpeg", Pixel::YUVJ420P),
        Codec::Vp9 | Codec::Png => ("libvpx-vp9", Pixel::YUV420P),
    };
    let (codec, mut video) = new_encoder(name, format, size, settings.frame_rate)?;
    // Without it, every JPEG carries the name and version of the encoder.
    video.set_flags(codec::Flags::BITEXACT);
    let mut options = match settings.codec {
        Codec::Vp8 => vp8_options(settings.speed, size[1]),
        Codec::H264 => h264_options(settings.speed),
        Codec::Hevc => hevc_options(settings.speed, size),
        Codec::Av1 => av1_options(settings.speed),
        Codec::Jpeg => Vec::new(),
        Codec::Vp9 | Codec::Png => vp9_options(settings.speed),
    };
    match settings.codec {
        Codec::Vp9 if settings.speed != Speed::Reference => {
            let [finest, coarsest] = vp9_quantisers(quantiser);
            options.extend(fixed_quantiser(settings.codec, coarsest));
            video.set_qmin(i32::from(finest));
            video.set_qmax(i32::from(coarsest));
        }
        codec => {
            options.extend(fixed_quantiser(codec, quantiser));
            if !matches!(codec, Codec::H264 | Codec::Hevc) {
                set_fixed_quality(&mut video, quantiser);
            }
        }
    }
    open_encoder(video, codec, &options)
}

/// An encoder of one thread with its size, format and clock, not yet open; the clock ticks once a
/// frame.
pub(crate) fn new_encoder(
    name: &str,
    format: Pixel,
    [width, height]: [u32; 2],
    frame_rate: [i32; 2],
) -> Result<(av::Codec, Video), String> {
    let codec = encoder::find_by_name(name).ok_or_else(|| {
        format!(
            "this FFmpeg has no encoder named {name}; install an FFmpeg that was built with it \
             (`ffmpeg -encoders` lists them), or choose another codec"
        )
    })?;
    let mut context = codec::Context::new_with_codec(codec);
    context.set_threading(codec::threading::Config::count(1));
    let mut video = context.encoder().video().map_err(|e| e.to_string())?;
    video.set_width(width);
    video.set_height(height);
    video.set_format(format);
    video.set_time_base((frame_rate[1], frame_rate[0]));
    video.set_frame_rate(Some((frame_rate[0], frame_rate[1])));
    video.set_gop(NO_OWN_KEYS);
    video.set_max_b_frames(0);
    Ok((codec, video))
}

/// One quantiser for all frames: for mjpeg the only setting that works through the library.
pub(crate) fn set_fixed_quality(video: &mut Video, quality: u8) {
    video.set_qmin(i32::from(quality));
    video.set_qmax(i32::from(quality));
}

/// The finest and the coarsest quantiser of a VP9 group round the one that was asked for.
///
/// What the key frame and the middle of a group hold, the other frames copy: finer there and
/// coarser elsewhere, a group of the same mean quality takes 6 to 10 % fewer bytes
/// (docs/decisions/0009-quantisers-within-bounds.md). The bounds keep its frames within about a
/// decibel of each other.
fn vp9_quantisers(quantiser: u8) -> [u8; 2] {
    let finest = quantiser - quantiser / 4;
    let coarsest = quantiser + quantiser / 8;
    [finest, coarsest.min(Codec::Vp9.highest_quantiser())]
}

/// What makes an encoder keep to one quantiser.
pub(crate) fn fixed_quantiser(codec: Codec, quality: u8) -> Options {
    let quality = quality.to_string();
    match codec {
        // Bit rate 0 makes crf the constant-quality mode; qmin = qmax keeps it from pulsing.
        Codec::Vp9 | Codec::Av1 => vec![("b", "0".to_owned()), ("crf", quality)],
        // No bit rate is as high as what the finest quantiser may take.
        Codec::Vp8 => vec![("b", "1000000000".to_owned()), ("crf", quality)],
        Codec::H264 | Codec::Hevc => vec![("qp", quality)],
        Codec::Jpeg | Codec::Png => Vec::new(),
    }
}

/// libvpx in one pass without delay, hidden frames or anything else that outlives a frame.
pub(crate) fn vp9_options(speed: Speed) -> Options {
    let cpu_used = match speed {
        Speed::Fast => 8,
        Speed::Default => 5,
        Speed::Small | Speed::Reference => 4,
    };
    let deadline = if speed == Speed::Reference {
        "good"
    } else {
        "realtime"
    };
    let mut options = vec![
        ("deadline", deadline.to_owned()),
        ("cpu-used", cpu_used.to_string()),
        ("lag-in-frames", "0".to_owned()),
        ("auto-alt-ref", "0".to_owned()),
        ("aq-mode", "0".to_owned()),
        ("row-mt", "0".to_owned()),
        ("tile-columns", "0".to_owned()),
    ];
    if speed != Speed::Reference {
        // A frame's symbol statistics serve the next one: 1 to 2 % of the bytes.
        options.push(("frame-parallel", "0".to_owned()));
    }
    options
}

/// Negative, or libvpx chooses its speed by the clock, and with it the bytes.
fn vp8_options(speed: Speed, height: u32) -> Options {
    let cpu_used = match speed {
        // Beyond -4 the loop filter of a picture one macroblock high goes by memory that libvpx
        // 1.12 never wrote: other bytes from run to run.
        _ if height <= 16 => -4,
        Speed::Fast => -12,
        Speed::Default => -6,
        Speed::Small | Speed::Reference => -4,
    };
    vec![
        ("deadline", "realtime".to_owned()),
        ("cpu-used", cpu_used.to_string()),
        ("lag-in-frames", "0".to_owned()),
        ("auto-alt-ref", "0".to_owned()),
    ]
}

fn h264_options(speed: Speed) -> Options {
    let preset = match speed {
        Speed::Fast => "ultrafast",
        Speed::Default => "veryfast",
        Speed::Small | Speed::Reference => "medium",
    };
    vec![
        ("preset", preset.to_owned()),
        ("tune", "zerolatency".to_owned()),
        ("forced-idr", "1".to_owned()),
        (
            "x264-params",
            "scenecut=0:open-gop=0:repeat-headers=1".to_owned(),
        ),
    ]
}

fn hevc_options(speed: Speed, size: [u32; 2]) -> Options {
    let preset = match speed {
        Speed::Fast => "ultrafast",
        Speed::Default => "superfast",
        Speed::Small | Speed::Reference => "fast",
    };
    // Motion search in a picture one tree unit wide or high, and what is tried after a block that
    // could have been skipped, go by memory that x265 3.5 never wrote: other bytes each run.
    let tree_unit = if size[0].min(size[1]) > 32 { 32 } else { 16 };
    let parameters = format!(
        "log-level=none:scenecut=0:open-gop=0:repeat-headers=1:info=0:hrd=0:aud=0:\
         pools=none:frame-threads=1:wpp=0:ctu={tree_unit}:early-skip=1"
    );
    vec![
        ("preset", preset.to_owned()),
        ("tune", "zerolatency".to_owned()),
        ("forced-idr", "1".to_owned()),
        ("x265-params", parameters),
    ]
}

/// libaom in one pass without delay or hidden frames.
fn av1_options(speed: Speed) -> Options {
    let cpu_used = match speed {
        Speed::Fast => 10,
        Speed::Default => 8,
        Speed::Small | Speed::Reference => 6,
    };
    vec![
        ("usage", "realtime".to_owned()),
        ("lag-in-frames", "0".to_owned()),
        ("row-mt", "0".to_owned()),
        ("aq-mode", "0".to_owned()),
        // FFmpeg's own option ends at 8.
        ("aom-params", format!("cpu-used={cpu_used}")),
    ]
}
