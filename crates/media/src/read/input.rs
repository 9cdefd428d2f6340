//! Which pictures does a video or image file hold, and when is each shown?

use std::io::ErrorKind;
use std::path::Path;

use crate::error::MediaError;
use crate::plain_file::open_plain;
use crate::read::film::ends::animation_end::gif_without_palette;
use crate::read::film::ends::other_file::other_file;
use crate::read::film::mended::Mended;
use crate::read::film::stream_input::StreamInput;
use crate::read::options::{ReadOptions, TimedPicture};
use crate::read::source::SourceInfo;
use crate::read::still::decoded_still::DecodedStill;
use crate::read::still::exr::still as exr;
use crate::read::still::heif_still::HeifStill;
use crate::read::still::large_still::LargeStill;
use crate::read::still::webp_input::WebPInput;
use crate::read::still::{float_map, qoi, radiance, tiff_still};

/// An open video or image file, read from front to back.
///
/// ```no_run
/// # fn main() -> Result<(), foveal_media::MediaError> {
/// let mut input = foveal_media::VideoInput::open("clip.mp4".as_ref())?;
/// while let Some(timed) = input.next_frame()? {
///     assert_eq!(timed.picture.width, input.info().width);
/// }
/// # Ok(())
/// # }
/// ```
pub struct VideoInput {
    source: Source,
}

enum Source {
    Stream(Box<StreamInput>),
    Still(Box<LargeStill>),
    Heif(Box<HeifStill>),
    Decoded(Box<DecodedStill>),
    WebP(Box<WebPInput>),
}

impl VideoInput {
    /// Opens the file and decodes its first frame; damage is mended, interlaced film deinterlaced.
    ///
    /// # Errors
    /// The file is missing, empty, no video, holds no frame, or asks for a colour matrix that a
    /// picture cannot hold.
    pub fn open(path: &Path) -> Result<Self, MediaError> {
        Self::open_with(path, ReadOptions::default())
    }

    /// The same as `options` say.
    ///
    /// # Errors
    /// As there; where it is strict, damage before the first frame too.
    pub fn open_with(path: &Path, options: ReadOptions) -> Result<Self, MediaError> {
        // Opening a pipe would wait for a writer.
        let bytes = file_bytes(path)?;
        let source = if let Some(still) = LargeStill::open(path)? {
            Source::Still(Box::new(still))
        } else if let Some(still) = HeifStill::open(path, bytes)? {
            Source::Heif(Box::new(still))
        } else if let Some(animation) = WebPInput::open(path, bytes)? {
            Source::WebP(Box::new(animation))
        } else if let Some(still) = radiance::open(path, bytes)? {
            Source::Decoded(Box::new(still))
        } else if let Some(still) = float_map::open(path, bytes)? {
            Source::Decoded(Box::new(still))
        } else if let Some(still) = exr::open(path, bytes)? {
            Source::Decoded(Box::new(still))
        } else if let Some(still) = tiff_still::open(path, bytes)? {
            Source::Decoded(Box::new(still))
        } else {
            qoi::check(path)?;
            let stream = StreamInput::open(path, bytes, options);
            Source::Stream(Box::new(stream.map_err(|error| match error {
                MediaError::NoFrames { .. } => refused_kind(path, bytes).unwrap_or(error),
                error => error,
            })?))
        };
        Ok(Self { source })
    }

    /// What is known of the file.
    #[must_use]
    pub fn info(&self) -> &SourceInfo {
        match &self.source {
            Source::Stream(stream) => &stream.info,
            Source::Still(still) => still.info(),
            Source::Heif(still) => still.info(),
            Source::Decoded(still) => still.info(),
            Source::WebP(animation) => animation.info(),
        }
    }

    /// Time stamp of the first picture in nanoseconds, 0 where it has none: what other streams of
    /// the file are timed against.
    pub(crate) fn first_stamp_ns(&self) -> i64 {
        match &self.source {
            Source::Stream(stream) => stream.first_stamp_ns,
            Source::Still(_) | Source::Heif(_) | Source::Decoded(_) | Source::WebP(_) => 0,
        }
    }

    /// What was mended so far.
    #[must_use]
    pub fn mended(&self) -> Mended {
        match &self.source {
            Source::Stream(stream) => stream.mended(),
            Source::Still(still) => Mended {
                is_transparent: still.has_seen_through(),
                ..Mended::default()
            },
            Source::Heif(_) | Source::Decoded(_) => Mended::default(),
            Source::WebP(animation) => animation.mended(),
        }
    }

    /// How long the last picture is shown, in nanoseconds, as far as the file says; to be asked
    /// after it.
    pub(crate) fn last_ns(&self) -> Option<i64> {
        match &self.source {
            Source::Stream(stream) => stream.last_ns(),
            Source::WebP(animation) => animation.last_ns(),
            Source::Still(_) | Source::Heif(_) | Source::Decoded(_) => None,
        }
    }

    /// The next picture in the order of display; None after the last.
    ///
    /// # Errors
    /// The file changes while it is read; where reading is strict, also: it breaks off, its data
    /// are damaged, or the picture size changes. The error names the frame. Pictures before it have
    /// been delivered.
    pub fn next_frame(&mut self) -> Result<Option<TimedPicture>, MediaError> {
        match &mut self.source {
            Source::Stream(stream) => stream.next_frame(),
            Source::Still(still) => Ok(still.picture()?.map(|picture| TimedPicture {
                picture,
                time_ns: 0,
            })),
            Source::Heif(still) => Ok(still.picture().map(|picture| TimedPicture {
                picture,
                time_ns: 0,
            })),
            Source::Decoded(still) => Ok(still.picture().map(|picture| TimedPicture {
                picture,
                time_ns: 0,
            })),
            Source::WebP(animation) => Ok(animation.next_frame()),
        }
    }
}

/// Why no frame of a file can be read, where that is for what it is.
fn refused_kind(path: &Path, bytes: u64) -> Option<MediaError> {
    let without_palette = || {
        gif_without_palette(path).map(|reason| MediaError::OtherFile {
            path: path.to_owned(),
            what: reason,
            next: "`magick FILE OUT.png` shows them in shades of grey".to_owned(),
        })
    };
    tiff_still::kind_refused(path, bytes)
        .or_else(without_palette)
        .or_else(|| other_file(path))
}

fn file_bytes(path: &Path) -> Result<u64, MediaError> {
    let other = |what: &str, next: &str| MediaError::OtherFile {
        path: path.to_owned(),
        what: what.to_owned(),
        next: next.to_owned(),
    };
    let (_, about) = open_plain(path).map_err(|error| match error.kind() {
        ErrorKind::IsADirectory => other("it is a folder", "give a file in it"),
        ErrorKind::Other => other(
            "it is not a plain file",
            "write what comes through a pipe to a file first, and give that",
        ),
        _ => MediaError::Open {
            path: path.to_owned(),
            reason: error.to_string(),
        },
    })?;
    if about.len() == 0 {
        return Err(MediaError::NotVideo {
            path: path.to_owned(),
            reason: "it is empty".to_owned(),
        });
    }
    Ok(about.len())
}
