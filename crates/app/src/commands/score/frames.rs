//! Which frames does a file, a folder or a pack hold?

use crate::commands::score::folder::numbered_pictures;
use crate::commands::score::pack_frames::{Opening, PackFrames};
use crate::commands::score::picture::{check_source, from_image, is_png, read_picture};
use crate::report::output;
use crate::run::pack_place::begins_as_pack;
use anyhow::bail;
use foveal_eval::score::{Display, ScorePicture};
use foveal_media::VideoInput;
use foveal_render::RgbaImage;
use std::path::{Path, PathBuf};

/// Frames, read one after the other.
pub(super) struct Frames {
    /// What was named.
    pub(super) name: PathBuf,
    /// Columns and rows.
    pub(super) size: [u32; 2],
    /// Frames a second, where it says so.
    pub(super) fps: Option<f64>,
    /// How many there are, where it says so.
    pub(super) frames: Option<u64>,
    /// Whether that is certain.
    pub(super) is_exact: bool,
    /// Whether it is one picture.
    pub(super) is_still: bool,
    /// Whether code values follow a high dynamic range curve.
    pub(super) is_hdr: bool,
    /// What shows it, where it says so.
    pub(super) display: Option<Display>,
    source: Source,
}

enum Source {
    Still(Option<ScorePicture>),
    Folder(std::vec::IntoIter<PathBuf>),
    Video(Box<VideoInput>),
    Pack(Box<PackFrames>),
}

/// Whether a file is a pack, by its name or its first bytes.
pub(crate) fn is_pack(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "foveal") || begins_as_pack(path)
}

impl Frames {
    /// Opens what lies there, whatever it is.
    pub(super) fn open(path: &Path, opening: &Opening) -> anyhow::Result<Self> {
        if path.is_dir() {
            return Self::folder(path);
        }
        if is_pack(path) {
            return Self::pack(path, opening);
        }
        if is_png(path) {
            return Ok(Self::still(path, read_picture(path)?));
        }
        Self::video(path)
    }

    fn still(path: &Path, picture: ScorePicture) -> Self {
        Self {
            name: path.to_owned(),
            size: picture.size(),
            fps: None,
            frames: Some(1),
            is_exact: true,
            is_still: true,
            is_hdr: false,
            display: None,
            source: Source::Still(Some(picture)),
        }
    }

    fn folder(path: &Path) -> anyhow::Result<Self> {
        let files = numbered_pictures(path)?;
        let first = read_picture(&files[0])?;
        Ok(Self {
            frames: Some(files.len() as u64),
            is_still: files.len() == 1,
            source: Source::Folder(files.into_iter()),
            ..Self::still(path, first)
        })
    }

    fn video(path: &Path) -> anyhow::Result<Self> {
        let input = VideoInput::open(path)?;
        let about = input.info();
        check_source(path, about)?;
        let [frames, seconds] = about.frame_rate.map(f64::from);
        Ok(Self {
            name: path.to_owned(),
            size: [about.width, about.height],
            fps: (!about.looks_still).then_some(frames / seconds),
            frames: about.frames,
            is_exact: about.looks_still,
            is_still: about.looks_still,
            is_hdr: about.is_hdr,
            display: None,
            source: Source::Video(Box::new(input)),
        })
    }

    fn pack(path: &Path, opening: &Opening) -> anyhow::Result<Self> {
        if opening.needs_gaze {
            bail!(output::WrongUsage(format!(
                "{}: levels of a pack are chosen for a gaze; give --gaze or --gaze-trace",
                path.display()
            )));
        }
        let pack = PackFrames::open(path, opening)?;
        Ok(Self {
            name: path.to_owned(),
            size: pack.size(),
            fps: (pack.frames() > 1).then_some(pack.fps()),
            frames: Some(u64::from(pack.frames())),
            is_exact: true,
            is_still: pack.frames() == 1,
            is_hdr: false,
            display: Some(pack.display()),
            source: Source::Pack(Box::new(pack)),
        })
    }

    /// The next frame, for an eye whose gaze a pack asks for; `None` after the last.
    pub(super) fn next(
        &mut self,
        gaze_px: impl Fn() -> anyhow::Result<[f64; 2]>,
    ) -> anyhow::Result<Option<ScorePicture>> {
        match &mut self.source {
            Source::Still(picture) => Ok(picture.take()),
            Source::Folder(files) => match files.next() {
                Some(file) => sized(&file, self.size).map(Some),
                None => Ok(None),
            },
            Source::Video(input) => {
                let colour = input.info().colour;
                match input.next_frame()? {
                    Some(frame) => {
                        from_image(&RgbaImage::from_planes(&frame.picture, colour)).map(Some)
                    }
                    None => Ok(None),
                }
            }
            Source::Pack(pack) if pack.is_over() => Ok(None),
            Source::Pack(pack) => pack.next(gaze_px()?).map(Some),
        }
    }
}

/// A picture that must have the size of those before.
fn sized(path: &Path, [w, h]: [u32; 2]) -> anyhow::Result<ScorePicture> {
    let picture = read_picture(path)?;
    let found = picture.size();
    if found != [w, h] {
        let ([a, b], name) = (found, path.display());
        bail!("{name}: {a}x{b} pixels where the first of its folder has {w}x{h}; give one size");
    }
    Ok(picture)
}
