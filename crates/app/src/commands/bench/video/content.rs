//! What is played when no pack is given, and where is it kept?
//!
//! A clip of 64 frames is drawn, coded as H.264 as a camera would, and prepared like anybody's
//! video. Both files stay in the cache for the next run.

use crate::options::policy::CutOptions;
use crate::options::preset::SystemPreset;
use crate::report::output::{self, Counting};
use crate::run::calibrate::CalibrationExtent;
use crate::run::kept_pack::{calibrate_in_place, kept, plan_of, write_pack};
use anyhow::{Context, bail};
use clap::ValueEnum;
use foveal_core::view::picture::{Colour, Matrix, Picture};
use foveal_core::view::surface::{Projection, Screen};
use foveal_media::generate::{FRAMES_PER_SECOND, GeneratedScene, Pan, Turn};
use foveal_media::plain_file::rename_durably;
use foveal_media::prepare::{PrepareSettings, ProjectionChoice};
use foveal_media::{ClipCodec, ClipFormat, ClipWriter};
use std::path::{Path, PathBuf};

/// Frames of a generated clip.
const FRAMES: u32 = 64;
/// Quantiser of the original: visually lossless.
const ORIGINAL_QUALITY: u8 = 18;
/// Changes when a clip is drawn differently, so that a kept one is not used.
const DRAWN: u32 = 2;
/// Colour of generated scenes.
const SCENE_COLOUR: Colour = Colour {
    matrix: Matrix::Bt709,
    full_range: false,
    chroma_left: false,
};

/// A clip by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Generated {
    /// A sphere of 16384 pixels round, as six faces of 4096x4096.
    #[value(name = "panorama-16k")]
    Panorama16k,
    /// A flat picture of 7680x4320 pixels, 100° across.
    #[value(name = "wide-8k")]
    Wide8k,
    /// A flat picture of 15360x8640 pixels, 100° across.
    #[value(name = "wide-16k")]
    Wide16k,
}

/// A screen that a 16:9 picture fills 100° of (half of it is 1.1918 at unit distance).
pub(super) const WALL: Screen = Screen {
    diagonal_inches: 2.0 * 1.1918 * 1.147_35 / 0.0254,
    distance_m: 1.0,
    slant: None,
    filled: None,
};

/// A pack and what it was made from.
pub(super) struct PackAndOriginal {
    pub(super) pack: PathBuf,
    pub(super) original: Option<PathBuf>,
}

impl Generated {
    /// The clip and its pack under `cache`, made where they are not there: by default settings and
    /// calibrated, or cut and coded as `system` did.
    pub(super) fn prepare(
        self,
        cache: &Path,
        system: Option<SystemPreset>,
    ) -> anyhow::Result<PackAndOriginal> {
        std::fs::create_dir_all(cache)
            .with_context(|| format!("{}: the folder cannot be made", cache.display()))?;
        let name = self.to_possible_value();
        let name = name.as_ref().map_or("clip", |value| value.get_name());
        let original = cache.join(format!("{name}-{DRAWN}.mkv"));
        let of_system = system.map_or(String::new(), |system| format!("-{}", system.name()));
        let pack = cache.join(format!("{name}-{DRAWN}{of_system}.foveal"));
        if !original.is_file() {
            output::say(&format!("{}: is being drawn", original.display()));
            self.draw(&original)?;
        }
        let settings = self.settings(system)?;
        if kept(&original, &pack, &settings).is_none() {
            let plan = plan_of(&original, &settings)?;
            write_pack(&original, &pack, &plan, Some(u64::from(FRAMES)))?;
        }
        if system.is_none() {
            calibrate_in_place(&pack, CalibrationExtent::Usual)?;
        }
        let original = Some(original);
        Ok(PackAndOriginal { pack, original })
    }

    fn settings(self, system: Option<SystemPreset>) -> anyhow::Result<PrepareSettings> {
        let (choice, projection) = match self {
            Self::Panorama16k => (ProjectionChoice::Cube, Projection::Cube),
            Self::Wide8k | Self::Wide16k => (ProjectionChoice::Flat, Projection::Flat),
        };
        let usual = PrepareSettings {
            projection: choice,
            jobs: output::jobs(None)?,
            ..PrepareSettings::default()
        };
        let Some(system) = system else {
            return Ok(usual);
        };
        let cut = system.cut(&CutOptions::default());
        let (codec, quality) = match system.coding(projection) {
            Some((codec, quality)) => (codec, Some(quality)),
            None => (usual.codec, None),
        };
        Ok(PrepareSettings {
            cut: cut.asked(),
            levels: cut.levels,
            ratio: cut.ratio(),
            codec,
            quality,
            ..usual
        })
    }

    /// Draws one picture and moves before it: every pixel changes, and nothing is drawn twice.
    fn draw(self, path: &Path) -> anyhow::Result<()> {
        let flat = |width: u32, height: u32| {
            let margin = Pan::margin(FRAMES);
            let pan = Pan::over(
                GeneratedScene::wide([width + margin, height]).frame(0),
                width,
            );
            write_clip(path, [width, height], |number| pan.frame(number))
        };
        match self {
            Self::Panorama16k => {
                let turn = Turn::new(GeneratedScene::panorama([16384, 8192]).frame(0), 4096);
                write_clip(path, turn.size(), |number| turn.frame(number))
            }
            Self::Wide8k => flat(7680, 4320),
            Self::Wide16k => flat(15360, 8640),
        }
    }
}

/// Where drawing fails or is stopped, nothing is left under the clip's name.
fn write_clip(path: &Path, size: [u32; 2], frame: impl Fn(u32) -> Picture) -> anyhow::Result<()> {
    let partial = path.with_extension("partial.mkv");
    let format = ClipFormat {
        codec: ClipCodec::H264(ORIGINAL_QUALITY),
        size,
        frame_rate: [FRAMES_PER_SECOND as i32, 1],
        colour: SCENE_COLOUR,
    };
    let bar = output::bar(Some(u64::from(FRAMES)), Counting::Frames);
    let mut clip = ClipWriter::create(&partial, &format)?;
    for number in 0..FRAMES {
        clip.push(&frame(number))?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    clip.finish()?;
    rename_durably(&partial, path)
        .with_context(|| format!("{}: cannot be given its name", partial.display()))
}

/// The folder for what can be made again: by the user's choice, else where the system keeps such.
pub(super) fn cache(asked: Option<&Path>) -> anyhow::Result<PathBuf> {
    if let Some(asked) = asked {
        return Ok(asked.to_owned());
    }
    let of = |name| std::env::var_os(name).filter(|value| !value.is_empty());
    let base = of("XDG_CACHE_HOME")
        .or_else(|| of("LOCALAPPDATA"))
        .map(PathBuf::from)
        .or_else(|| of("HOME").map(|home| Path::new(&home).join(".cache")));
    match base {
        Some(base) => Ok(base.join("foveal")),
        None => bail!("no folder for caches is known here; give --cache DIR"),
    }
}
