//! What will a pack of this input look like?

use super::PrepareError;
use super::rates::{Quality, describe, rates_of};
use crate::encode::{Rate, Speed};
use crate::source::SourceInfo;
use crate::sphere::{Coverage, face_size_for};
use crate::spherical::{Projection as SourceProjection, Spherical, StereoLayout};
use foveal_core::asset::codec::Codec;
use foveal_core::asset::pack::{Description, Source};
use foveal_core::asset::picture::Colour;
use foveal_core::asset::rate::QualityScale;
use foveal_core::asset::tile_grid::{Cut, TileGrid};
use foveal_core::view::surface::{Screen, Surface};
use std::path::Path;

/// What the caller says about the projection of the input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProjectionChoice {
    /// Find it from metadata, name and size.
    #[default]
    Auto,
    /// A flat picture.
    Flat,
    /// The whole sphere, longitude across and latitude down.
    Equirect,
    /// The front half of the sphere (VR180).
    HalfEquirect,
}

/// How the input is turned into faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surround {
    /// It is the one face.
    Flat,
    /// It is resampled to a cube.
    Equirect(Coverage),
}

/// What the caller asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct PrepareSettings {
    /// Projection of the input.
    pub projection: ProjectionChoice,
    /// How pictures are cut; by size of the source if `None`.
    pub cut: Option<Cut>,
    /// Number of levels; five, fewer for tiny pictures, if `None`.
    pub levels: Option<u8>,
    /// Linear ratio between levels.
    pub ratio: u32,
    /// Codec of the tiles.
    pub codec: Codec,
    /// Quality or bit rate of the levels; the codec's default quantiser if `None`.
    pub quality: Option<Quality>,
    /// Time against size.
    pub speed: Speed,
    /// Threads.
    pub jobs: usize,
    /// Stop after this many frames.
    pub most_frames: Option<u32>,
}

impl Default for PrepareSettings {
    /// What `foveal prepare video` does without options, on one thread.
    fn default() -> Self {
        Self {
            projection: ProjectionChoice::Auto,
            cut: None,
            levels: None,
            ratio: 2,
            codec: Codec::Vp9,
            quality: None,
            speed: Speed::Default,
            jobs: 1,
            most_frames: None,
        }
    }
}

/// What will be made of an input.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The pack's description; frames and side tables are not final.
    pub description: Description,
    /// Its tiles.
    pub grid: TileGrid,
    /// How the input becomes faces.
    pub surround: Surround,
    /// What a person should know: how the projection was found, what was dropped.
    pub notes: Vec<String>,
    /// Frames as far as the container tells.
    pub frames: Option<u64>,
    /// Rate of each level, finest first.
    pub(super) rates: Vec<Rate>,
    pub(super) speed: Speed,
    pub(super) jobs: usize,
    pub(super) most_frames: Option<u32>,
    pub(super) source_chroma_left: bool,
    pub(super) stretch_to_full_range: bool,
}

/// Levels of a pack unless asked for otherwise or the picture is tiny.
const LEVELS: u8 = 5;
/// The longer side of a coarsest level is not halved below this many pixels.
const LEAST_COARSEST: u32 = 16;
/// A picture twice as wide as high counts as a sphere from this width on when nothing else tells.
const SPHERE_WIDTH: u32 = 3840;
/// Frame rate above which groups are twice as long.
const FAST_FPS: f64 = 40.0;

impl Plan {
    /// Plans the preparation of `input`; refuses options that do not fit it.
    pub fn new(
        input: &Path,
        info: &SourceInfo,
        settings: &PrepareSettings,
    ) -> Result<Self, PrepareError> {
        let mut notes = Vec::new();
        let surround = surround(input, info, settings.projection, &mut notes)?;
        let surface = surface(info, surround);
        let levels = settings
            .levels
            .unwrap_or_else(|| default_levels(surface, settings.ratio));
        let cut = settings.cut.unwrap_or(Cut::pyramid_for(&surface));
        let grid = TileGrid::new(surface, cut, levels, settings.ratio)?;
        notes.extend(losses(info));
        // JPEG stores planes as full range whatever the source has.
        let stretch_to_full_range = settings.codec == Codec::Jpeg && !info.colour.full_range;
        let colour = Colour {
            full_range: info.colour.full_range || stretch_to_full_range,
            chroma_left: info.colour.chroma_left && surround == Surround::Flat,
            ..info.colour
        };
        let rates = rates_of(settings.quality.as_ref(), settings.codec, levels)?;
        let frame_rate = info.frame_rate.map(|n| n.max(1) as u32);
        let mut description = Description {
            generator: concat!("foveal ", env!("CARGO_PKG_VERSION")).to_owned(),
            projection: surface.projection,
            size: surface.size,
            cut,
            levels,
            ratio: settings.ratio,
            codec: settings.codec,
            quality: Vec::new(),
            quality_scale: QualityScale::default(),
            bit_rates: Vec::new(),
            groups: groups(levels, f64::from(frame_rate[0]) / f64::from(frame_rate[1])),
            frames: info
                .frames
                .map_or(1, |frames| frames.clamp(1, 1 << 24) as u32),
            frame_rate,
            colour,
            source: Source {
                name: input
                    .file_name()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into_owned(),
                size: [info.width, info.height],
                bytes: info.bytes,
                codec: info.codec.clone(),
            },
            tables: Vec::new(),
        };
        describe(&rates, &mut description);
        Ok(Self {
            description,
            grid,
            surround,
            notes,
            frames: info.frames,
            rates,
            speed: settings.speed,
            jobs: settings.jobs.max(1),
            most_frames: settings.most_frames,
            source_chroma_left: info.colour.chroma_left,
            stretch_to_full_range,
        })
    }
}

impl Plan {
    /// Everything but the input and the program that the bytes of the pack depend on, as text.
    pub(super) fn what_decides_the_bytes(&self) -> String {
        let about = &self.description;
        format!(
            "{:?}",
            (
                (about, self.grid, self.surround, &self.rates),
                (self.speed, self.most_frames),
                (self.source_chroma_left, self.stretch_to_full_range),
            )
        )
    }
}

/// What of the input does not reach the pack.
fn losses(info: &SourceInfo) -> Vec<String> {
    let mut notes = Vec::new();
    if info.has_alpha {
        notes.push("its transparency is dropped".to_owned());
    }
    if let Some([width, height]) = info.pixel_aspect {
        notes.push(format!(
            "its pixels are {width}:{height} and are taken as square; make them so first with \
             `ffmpeg -i FILE -vf scale=iw*sar:ih,setsar=1 OUT`"
        ));
    }
    if info.is_hdr {
        notes.push("its high dynamic range curve is kept and shown as if it were none".to_owned());
    }
    if info.pixel_format != "yuv420p" && info.pixel_format != "yuvj420p" {
        notes.push(format!("{} is brought to 8-bit 4:2:0", info.pixel_format));
    }
    notes
}

fn surface(info: &SourceInfo, surround: Surround) -> Surface {
    match surround {
        Surround::Flat => Surface::flat([info.width, info.height], Screen::default()),
        Surround::Equirect(coverage) => Surface::cube(face_size_for(info.width, coverage)),
    }
}

fn default_levels(surface: Surface, ratio: u32) -> u8 {
    let longest = surface.size[0].max(surface.size[1]);
    let fits = |level: &u8| longest / ratio.max(2).pow(u32::from(*level)) >= LEAST_COARSEST;
    (1..LEVELS).take_while(fits).count() as u8 + 1
}

/// Frames in a group, finest level first: 8, 8, 16, .. 16, 32, doubled for fast content. Short
/// where the gaze switches, long where nothing ever switches (docs/concepts/video.md).
fn groups(levels: u8, fps: f64) -> Vec<u32> {
    let factor = if fps > FAST_FPS { 2 } else { 1 };
    let of_level = |level: u8| match level {
        _ if levels > 1 && level == levels - 1 => 32,
        0 | 1 => 8,
        _ => 16,
    };
    (0..levels).map(|level| of_level(level) * factor).collect()
}

fn surround(
    input: &Path,
    info: &SourceInfo,
    choice: ProjectionChoice,
    notes: &mut Vec<String>,
) -> Result<Surround, PrepareError> {
    match choice {
        ProjectionChoice::Flat => return Ok(Surround::Flat),
        ProjectionChoice::Equirect => return Ok(Surround::Equirect(Coverage::Full)),
        ProjectionChoice::HalfEquirect => return Ok(Surround::Equirect(Coverage::FrontHalf)),
        ProjectionChoice::Auto => {}
    }
    if let Some(stereo) = info.stereo {
        let layout = match stereo.layout {
            StereoLayout::SideBySide => "side by side",
            StereoLayout::TopBottom => "top and bottom",
            StereoLayout::Other => "interleaved",
        };
        return Err(PrepareError::Option(format!(
            "{} holds two eyes ({layout}), which cannot be prepared; give --projection flat to \
             prepare the pair as one flat picture, or one eye by itself",
            input.display()
        )));
    }
    if let Some(spherical) = &info.spherical {
        return surround_by_metadata(input, spherical, notes);
    }
    let twice_as_wide = info.width == 2 * info.height;
    let name = input
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase();
    let words = ["equirect", "pano", "sphere"];
    let named = words.iter().any(|word| name.contains(word)) || names_a_full_turn(&name);
    if twice_as_wide && (named || info.width >= SPHERE_WIDTH) {
        let why = if named {
            "by its name and 2:1 size"
        } else {
            "by its 2:1 size"
        };
        notes.push(format!(
            "taken for 360° {why}; give --projection flat if it is not"
        ));
        return Ok(Surround::Equirect(Coverage::Full));
    }
    let hint = if twice_as_wide {
        "; give --projection equirect if it is 360°"
    } else {
        ""
    };
    notes.push(format!("taken for flat by its size{hint}"));
    Ok(Surround::Flat)
}

/// Whether a name says 360 and means degrees: not a size as in `640x360`, `360p` or `xbox360`.
fn names_a_full_turn(name: &str) -> bool {
    name.match_indices("360").any(|(at, _)| {
        let before = name[..at].chars().next_back();
        let after = name[at + 3..].chars().next();
        !before.is_some_and(char::is_alphanumeric)
            && !after.is_some_and(|c| c.is_ascii_digit() || c == 'p' || c == 'x')
    })
}

fn surround_by_metadata(
    input: &Path,
    spherical: &Spherical,
    notes: &mut Vec<String>,
) -> Result<Surround, PrepareError> {
    if [spherical.yaw_deg, spherical.pitch_deg, spherical.roll_deg] != [0.0; 3] {
        notes.push("the turn of the sphere in its metadata is not applied".to_owned());
    }
    match spherical.projection {
        SourceProjection::Equirect => {
            notes.push("360° by its spherical metadata".to_owned());
            Ok(Surround::Equirect(Coverage::Full))
        }
        SourceProjection::EquirectPart { .. } if spherical.is_half() => {
            notes.push("180° by its spherical metadata".to_owned());
            Ok(Surround::Equirect(Coverage::FrontHalf))
        }
        _ => Err(PrepareError::Option(format!(
            "{} is a cube or a part of a sphere by its metadata, which cannot be prepared; make \
             it equirectangular with FFmpeg's filter v360, or give --projection flat",
            input.display()
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{group, write_clip};
    use crate::{ClipCodec, VideoInput};

    #[test]
    fn a_size_in_a_name_is_no_full_turn() {
        for name in [
            "tour_360.mp4",
            "360.mkv",
            "beach-360-4k.mp4",
            "360video.mp4",
        ] {
            assert!(names_a_full_turn(name), "{name}");
        }
        for name in [
            "clip_640x360.mp4",
            "360p.mp4",
            "xbox360.mp4",
            "13600.mp4",
            "a.mp4",
        ] {
            assert!(!names_a_full_turn(name), "{name}");
        }
    }

    #[test]
    fn what_does_not_reach_the_pack_is_said() {
        let clip = write_clip("mkv", ClipCodec::Ffv1, &group([64, 48], 1, 6));
        let plain = VideoInput::open(&clip).unwrap().info().clone();
        assert!(losses(&plain).is_empty());
        let info = SourceInfo {
            pixel_aspect: Some([16, 11]),
            is_hdr: true,
            has_alpha: true,
            pixel_format: "yuva420p10le".to_owned(),
            ..plain
        };
        let notes = losses(&info).join("; ");
        for word in [
            "16:11",
            "high dynamic range",
            "transparency",
            "yuva420p10le",
        ] {
            assert!(notes.contains(word), "{word} in {notes}");
        }
    }
}
