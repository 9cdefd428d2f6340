//! What will a pack of this input look like?

use super::error::PrepareError;
use super::rates::{describe, is_auto, rates_of};
use super::remarks::Remarks;
use super::settings::{FACE_SIZES, PrepareSettings, SpherePack};
use crate::read::options::ReadOptions;
use crate::read::source::{Sound, SourceInfo};
use crate::sphere::{Coverage, face_size_for};
use crate::surround::cube_layout::CubeLayout;
use crate::surround::eye_layout::EyeLayout;
use crate::surround::found::{Surround, SurroundOfEyes, surround_of};
use crate::surround::sphere_part::SpherePart;
use crate::tiles::encode_settings::{Rate, Speed};
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::bytes::description::{Description, Source};
use foveal_core::content::video::bytes::rate::QualityScale;
use foveal_core::content::video::grid::tile_grid::{Cut, TileGrid};
use foveal_core::view::picture::Colour;
use foveal_core::view::surface::{Mapping, Projection, Screen, Surface};
use std::collections::BTreeMap;
use std::path::Path;

/// What will be made of an input.
#[derive(Clone, Debug, PartialEq)]
pub struct PreparationPlan {
    /// The pack's description; frames and side tables are not final.
    pub description: Description,
    /// Its tiles.
    pub grid: TileGrid,
    /// How the input becomes faces.
    pub surround: Surround,
    /// Where in a frame the pictures of the eyes lie.
    pub eyes: EyeLayout,
    /// Where a picture of a part of a sphere, or one that is turned, lies on the whole.
    pub part: Option<SpherePart>,
    /// What a person should know: how the projection was found, what is lost.
    pub remarks: Remarks,
    /// Whether the input is one picture.
    pub is_still: bool,
    /// Frames as far as the container says.
    pub frames: Option<u64>,
    /// Rate of each level, finest first.
    pub(super) rates: Vec<Rate>,
    /// Pixels of one eye's picture, of the whole where it is a part.
    pub(super) eye_size: [u32; 2],
    /// Whether the pack is to have sound.
    pub(super) has_sound: bool,
    pub(super) speed: Speed,
    pub(super) jobs: usize,
    pub(super) most_frames: Option<u32>,
    pub(super) source_chroma_left: bool,
    pub(super) stretch_to_full_range: bool,
    /// How the input is read.
    pub reading: ReadOptions,
    /// Frames that the container announces for these pictures.
    pub(super) frames_told: Option<u64>,
    /// Whether its remarks mention transparency.
    pub(super) tells_of_transparency: bool,
}

/// Levels of a pack unless asked for otherwise or the picture is tiny.
const LEVELS: u8 = 5;
/// Faces of a resampled sphere may be this many times as fine as the sphere, and always this large.
/// There is a bound because memory grows with their pixels.
const MOST_FINER: u32 = 2;
const LEAST_FACE_BOUND: u32 = 2048;
/// The longer side of a coarsest level is not halved below this many pixels.
const LEAST_COARSEST: u32 = 16;
/// Frame rate above which groups are twice as long.
const FAST_FPS: f64 = 40.0;

impl PreparationPlan {
    /// Plans the preparation of `input`; refuses options that do not fit it.
    pub fn new(
        input: &Path,
        info: &SourceInfo,
        settings: &PrepareSettings,
    ) -> Result<Self, PrepareError> {
        let mut remarks = Remarks::default();
        let found = surround_of(input, info, settings, &mut remarks)?;
        let surface = surface_as_asked(&found, settings)?;
        let levels = levels_as_asked(surface, settings);
        let cut = settings.cut.unwrap_or(Cut::pyramid_for(&surface));
        let grid = TileGrid::new(surface, cut, levels, settings.ratio)?;
        refuse_broken(input, info, settings)?;
        remark_on(info, settings, &mut remarks);
        let stretch_to_full_range = stretches(info, settings);
        let is_moved = is_resampled(found.surround, &surface);
        let colour = colour_of(info, stretch_to_full_range, is_moved);
        let rates = rates_of(settings, info.looks_still, levels)?;
        let frame_rate = info.frame_rate.map(|n| n.max(1) as u32);
        let mut description = Description {
            generator: concat!("foveal ", env!("CARGO_PKG_VERSION")).to_owned(),
            projection: surface.projection,
            size: surface.size,
            eyes: surface.eyes,
            cube_faces: surface.cube_faces,
            mapping: surface.mapping,
            pixel_aspect: found.pixel_aspect,
            front_deg: found.front_deg,
            cut,
            levels,
            ratio: settings.ratio,
            codec: settings.codec,
            quality: Vec::new(),
            quality_scale: QualityScale::default(),
            quality_by_tile: is_auto(settings, info),
            bit_rates: Vec::new(),
            groups: groups(levels, info.looks_still, frame_rate),
            frames: info.frames.unwrap_or(1).clamp(1, 1 << 24) as u32,
            frame_rate,
            colour,
            source: source_of(input, info),
            identity: None,
            loss: None,
            last_frame_s: None,
            remarks: remarks.all().into_iter().map(str::to_owned).collect(),
            repairs: passed_over(info),
            tables: Vec::new(),
        };
        describe(&rates, &mut description);
        Ok(Self {
            description,
            grid,
            surround: found.surround,
            eyes: found.eyes,
            part: found.part,
            eye_size: found.eye_size,
            remarks,
            is_still: info.looks_still,
            frames: info.frames,
            rates,
            has_sound: settings.sound && info.sound.is_some(),
            speed: settings.speed,
            jobs: settings.jobs.max(1),
            most_frames: settings.most_frames,
            source_chroma_left: info.colour.chroma_left,
            stretch_to_full_range,
            reading: settings.reading(),
            frames_told: info.frames_told,
            tells_of_transparency: info.transparency.is_some(),
        })
    }
}

impl PreparationPlan {
    /// What one eye's picture of the source itself lies on where it is flat or a cube.
    pub(crate) fn source_surface(&self, screen: Screen) -> Surface {
        match self.surround {
            Surround::Cube(layout) => cube_of(layout, self.eye_size),
            Surround::Flat | Surround::Equirect(_) => Surface {
                eyes: 1,
                ..self.description.grid(screen).surface
            },
        }
    }

    /// Everything but the input and the program that the bytes of the pack depend on, as text.
    pub(super) fn what_decides_the_bytes(&self) -> String {
        // Remarks describe what decides, and decide nothing; quantisers that are looked for follow
        // from the input.
        let mut about = Description {
            remarks: Vec::new(),
            repairs: Default::default(),
            ..self.description.clone()
        };
        let mut rates = &self.rates[..];
        if self.description.quality_by_tile {
            about.quality.clear();
            rates = &[];
        }
        format!(
            "{:?}",
            (
                (about, self.grid, self.surround, self.eyes, self.part, rates),
                (self.speed, self.most_frames, self.has_sound),
                (
                    self.source_chroma_left,
                    self.stretch_to_full_range,
                    self.reading.deinterlace,
                ),
            )
        )
    }
}

/// JPEG stores planes as full range whatever the source has.
fn stretches(info: &SourceInfo, settings: &PrepareSettings) -> bool {
    settings.codec == Codec::Jpeg && !info.colour.full_range
}

/// The colour of a pack of an input.
fn colour_of(info: &SourceInfo, is_stretched: bool, chroma_moves: bool) -> Colour {
    Colour {
        full_range: info.colour.full_range || is_stretched,
        chroma_left: info.colour.chroma_left && !chroma_moves,
        ..info.colour
    }
}

fn levels_as_asked(surface: Surface, settings: &PrepareSettings) -> u8 {
    let usual = || default_levels(surface, settings.ratio);
    settings.levels.unwrap_or_else(usual)
}

fn remark_on(info: &SourceInfo, settings: &PrepareSettings, remarks: &mut Remarks) {
    remarks.warnings.extend(losses(info));
    remarks.notes.extend(sound_note(info, settings.sound));
    remarks.notes.extend(format_note(info));
}

/// What a file says of itself that cannot be used is passed over, unless that is not wanted.
fn refuse_broken(
    input: &Path,
    info: &SourceInfo,
    settings: &PrepareSettings,
) -> Result<(), PrepareError> {
    let boxes = info
        .broken_boxes
        .iter()
        .map(|it| format!("its {} box {}", it.name, it.what));
    let mut broken = info.tags.broken.iter().cloned().chain(boxes);
    match broken.next().filter(|_| settings.strict) {
        None => Ok(()),
        Some(what) => Err(PrepareError::Strict(input.display().to_string(), what)),
    }
}

/// What was passed over of the input, by name.
fn passed_over(info: &SourceInfo) -> BTreeMap<String, u64> {
    let counts = [
        ("broken_tags", info.tags.broken.len()),
        ("broken_boxes", info.broken_boxes.len()),
    ];
    let there = counts.into_iter().filter(|(_, count)| *count > 0);
    there
        .map(|(name, count)| (name.to_owned(), count as u64))
        .collect()
}

/// What of the input does not reach the pack.
fn losses(info: &SourceInfo) -> Vec<String> {
    let mut losses = Vec::new();
    losses.extend(info.transparency.map(|what| what.words().to_owned()));
    if info.is_hdr {
        losses.push("its high dynamic range curve is kept and shown as standard range".to_owned());
    }
    losses
}

/// Every pack has the same pixel format.
fn format_note(info: &SourceInfo) -> Option<String> {
    let is_kept = ["yuv420p", "yuvj420p"].contains(&info.pixel_format.as_str());
    (!is_kept).then(|| format!("{} is converted to 8-bit 4:2:0", info.pixel_format))
}

fn source_of(input: &Path, info: &SourceInfo) -> Source {
    let name = input.file_name().unwrap_or_default();
    Source {
        name: name.to_string_lossy().into_owned(),
        size: [info.width, info.height],
        bytes: info.bytes,
        codec: info.codec.clone(),
    }
}

/// What becomes of the sound, where that is not what one expects.
fn sound_note(info: &SourceInfo, is_wanted: bool) -> Option<String> {
    match &info.sound {
        None if !info.looks_still => Some("it has no sound".to_owned()),
        Some(sound) if is_wanted && sound.channels > 2 => {
            let Sound { channels, codec } = sound;
            Some(format!(
                "the {channels} channels of its sound ({codec}) are mixed down to two"
            ))
        }
        _ => None,
    }
}

fn surface(found: &SurroundOfEyes) -> Surface {
    let [w, h] = found.eye_size;
    let surface = match found.surround {
        Surround::Flat => {
            Surface::flat_with_pixels(found.eye_size, found.pixel_aspect, Screen::default())
        }
        // Squeezed across or down, the longer side says how much detail there is.
        Surround::Equirect(Coverage::Full) if found.eyes.eyes() > 1 => {
            Surface::cube(face_size_for(w.max(2 * h), Coverage::Full))
        }
        Surround::Equirect(Coverage::FrontHalf) if found.eyes.eyes() > 1 => {
            Surface::cube(face_size_for(w.max(h), Coverage::FrontHalf))
        }
        Surround::Equirect(coverage) => Surface::cube(face_size_for(w, coverage)),
        Surround::Cube(layout) => cube_of(layout, found.eye_size),
    };
    if found.eyes.eyes() > 1 {
        surface.for_two_eyes()
    } else {
        surface
    }
}

/// Most bytes of memory that preparing needs for each pixel of six faces, and in addition to them.
const BYTES_A_PIXEL: u64 = 110;
const BYTES_BESIDE: u64 = 200 << 20;

/// Bytes of memory that preparing a cube needs, whose faces have this many pixels on a side.
pub(super) fn face_memory(side: u32) -> u64 {
    6 * u64::from(side).pow(2) * BYTES_A_PIXEL + BYTES_BESIDE
}

fn gigabytes(bytes: u64) -> String {
    format!("{:.1} GB", bytes as f64 / 1e9)
}

/// The faces that a picture holds.
fn cube_of(layout: CubeLayout, eye_size: [u32; 2]) -> Surface {
    let cube = Surface::cube(layout.face_size(eye_size));
    match layout.faces() {
        4 => cube.without_poles(),
        _ => cube,
    }
}

/// Faces that are resampled have the mapping and the size that were asked for; faces that are cut
/// out keep theirs.
fn cube_as_asked(
    surface: Surface,
    surround: Surround,
    settings: &PrepareSettings,
) -> Result<Surface, PrepareError> {
    let wrong = |what: String| Err(PrepareError::Option(what));
    let kind = match surround {
        Surround::Equirect(_) => {
            let size = settings.face_size.unwrap_or(surface.size[0]);
            if !FACE_SIZES.contains(&size) || !size.is_multiple_of(16) {
                return Err(PrepareError::FaceSize(size));
            }
            let own = surface.size[0];
            let most = (MOST_FINER * own).max(LEAST_FACE_BOUND);
            if size > most {
                return Err(PrepareError::Option(format!(
                    "--face-size {size}: a quarter of the sphere has {own} pixels, and faces that \
                     are more than {MOST_FINER} times as fine take {} of memory and show no more; \
                     give at most {most}",
                    gigabytes(face_memory(size))
                )));
            }
            return Ok(Surface {
                size: [size; 2],
                mapping: settings.mapping.unwrap_or(Mapping::EquiAngular),
                ..surface
            });
        }
        Surround::Cube(_) => "its faces are cut out as they are, gnomonic",
        Surround::Flat => "it is flat, without faces",
    };
    if settings.mapping == Some(Mapping::EquiAngular) {
        return wrong(format!("--mapping equi-angular: {kind}; leave it out"));
    }
    if let Some(size) = settings.face_size {
        return wrong(format!("--face-size {size}: {kind}; leave it out"));
    }
    Ok(surface)
}

/// What the pack shows lies on.
fn surface_as_asked(
    found: &SurroundOfEyes,
    settings: &PrepareSettings,
) -> Result<Surface, PrepareError> {
    match settings.pack_projection {
        SpherePack::Cube => cube_as_asked(surface(found), found.surround, settings),
        SpherePack::Equirect => equirect_as_asked(found, settings),
    }
}

/// Whether chroma comes to lie between its luma samples, wherever it lay.
fn is_resampled(surround: Surround, surface: &Surface) -> bool {
    match surround {
        Surround::Flat => false,
        Surround::Equirect(_) => surface.projection == Projection::Cube,
        Surround::Cube(_) => surface.projection == Projection::Equirect,
    }
}

/// One picture of the whole sphere, as dense as what it is made of.
fn equirect_as_asked(
    found: &SurroundOfEyes,
    settings: &PrepareSettings,
) -> Result<Surface, PrepareError> {
    let wrong = |what: &str| Err(PrepareError::Option(format!("--pack-projection {what}")));
    if settings.mapping.is_some() || settings.face_size.is_some() {
        return wrong("equirect: it has no faces; leave --mapping and --face-size out");
    }
    let [w, h] = found.eye_size;
    let size = match found.surround {
        Surround::Flat => {
            return wrong(
                "equirect: the input is flat; leave it out, or say how it surrounds the eye with \
                 --projection",
            );
        }
        Surround::Equirect(Coverage::Full) => [w, h],
        Surround::Equirect(Coverage::FrontHalf) => [2 * w, h],
        Surround::Cube(layout) => {
            let face = layout.face_size(found.eye_size);
            [4 * face, 2 * face]
        }
    };
    let surface = Surface::equirect(size);
    Ok(match found.eyes.eyes() {
        1 => surface,
        _ => surface.for_two_eyes(),
    })
}

fn default_levels(surface: Surface, ratio: u32) -> u8 {
    // Of a whole turn a quarter counts, as one face of a cube has it.
    let longest = match surface.projection {
        Projection::Equirect => (surface.size[0] / 4).max(surface.size[1] / 2),
        Projection::Flat | Projection::Cube => surface.size[0].max(surface.size[1]),
    };
    let fits = |level: &u8| longest / ratio.max(2).pow(u32::from(*level)) >= LEAST_COARSEST;
    (1..LEVELS).take_while(fits).count() as u8 + 1
}

/// Frames in a group: 8, at the coarsest level 32, doubled for fast content. Short where the gaze
/// switches, long where nothing ever switches (docs/concepts/video.md). A still has one.
fn groups(levels: u8, is_still: bool, [frames, seconds]: [u32; 2]) -> Vec<u32> {
    let is_fast = f64::from(frames) / f64::from(seconds) > FAST_FPS;
    let factor = if is_fast { 2 } else { 1 };
    let of_level = |level: u8| match level {
        _ if is_still => 1,
        _ if levels > 1 && level == levels - 1 => 32 * factor,
        _ => 8 * factor,
    };
    (0..levels).map(of_level).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_of_faces_is_at_least_what_was_measured() {
        // Of two frames at two threads.
        for (side, megabytes) in [(1024, 865), (2048, 2789), (4096, 8190)] {
            assert!(face_memory(side) >= megabytes * 1_000_000, "{side}");
        }
        assert!(face_memory(2048) < 3_100_000_000);
    }
    use crate::read::source::Transparency;
    use crate::tests::scenes::{group, write_clip};
    use crate::{ClipCodec, VideoInput};

    #[test]
    fn what_does_not_reach_the_pack_is_said() {
        let clip = write_clip("mkv", ClipCodec::Ffv1, &group([64, 48], 1, 6));
        let plain = VideoInput::open(&clip).unwrap().info().clone();
        assert!(losses(&plain).is_empty() && format_note(&plain).is_none());
        let info = SourceInfo {
            is_hdr: true,
            transparency: Some(Transparency::OverBlack),
            pixel_format: "yuva420p10le".to_owned(),
            ..plain
        };
        let said = losses(&info).join("; ");
        for word in ["high dynamic range", "black"] {
            assert!(said.contains(word), "{word} in {said}");
        }
        assert!(format_note(&info).unwrap().contains("yuva420p10le"));
    }
}
