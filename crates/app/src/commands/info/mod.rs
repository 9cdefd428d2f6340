//! What is in a pack?

pub(crate) mod scene_info;

use crate::commands::info::scene_info::SceneInfo;
use crate::report::output;
use crate::report::remarks::remarks_told;
use crate::run::calibrate::sphere_width_deg;
use clap::Args;
use foveal_core::content::policy::calibration::Expectation;
use foveal_core::content::policy::{DEFAULT_TARGET, Policy};
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::bytes::description::{Description, Loss};
use foveal_core::content::video::bytes::rate::QualityScale;
use foveal_core::content::video::bytes::sound::{SOUND_RATE, SoundTable};
use foveal_core::content::video::calibration::{Calibration, CalibrationRow};
use foveal_core::content::video::grid::tile_grid::Cut;
use foveal_core::units::{Ppd, counted, one_line};
use foveal_core::view::surface::{Mapping, Projection};
use foveal_media::pack::pack::Pack;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::prepare::ANIMATIONS;
use foveal_media::sphere::{Coverage, face_size_for};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

#[derive(Clone, Debug, Args)]
pub(crate) struct InfoArgs {
    /// The pack.
    pack: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What `info` and `prepare` say of a pack.
#[derive(Debug, Serialize)]
pub(crate) struct PackInfo {
    content: MediaKind,
    pub(crate) projection: Projection,
    pub(crate) frames: u32,
    /// Null for a picture.
    fps: Option<f64>,
    seconds: Option<f64>,
    /// Pixels of the source.
    width: u32,
    height: u32,
    /// Pixels of one face at level 0.
    face_width: u32,
    face_height: u32,
    /// Eyes with a picture of their own.
    eyes: u8,
    /// Faces of one eye.
    faces: u32,
    /// How pixels lie over the faces of a cube.
    mapping: Mapping,
    /// Whether preparing the same file again would make it sharper.
    #[serde(skip)]
    is_softer: bool,
    /// Width and height of a pixel to each other.
    pixel_aspect: [u32; 2],
    /// Yaw that a view of a sphere begins at.
    front_deg: f64,
    /// Its sound, if it has any.
    sound: Option<SoundInfo>,
    cut: Cut,
    units: usize,
    levels: u8,
    level_ratio: u32,
    groups: Vec<u32>,
    codec: Codec,
    quality: Vec<u8>,
    quality_scale: QualityScale,
    quality_by_tile: bool,
    bit_rates: Vec<u32>,
    pub(crate) bytes: u64,
    bytes_per_level: Vec<u64>,
    /// What preparing lost; null where it was not measured.
    loss: Option<Loss>,
    /// What the judge found of the content; null where it was not calibrated.
    pub(crate) calibration: Option<CalibrationInfo>,
    /// What was mended or left out of the source, by name.
    repairs: BTreeMap<String, u64>,
    remarks: Vec<String>,
    source: String,
    source_bytes: u64,
    generator: String,
}

/// What a pack shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum MediaKind {
    Picture,
    Video,
}

impl MediaKind {
    pub(crate) fn of(about: &Description) -> Self {
        if about.is_still() {
            Self::Picture
        } else {
            Self::Video
        }
    }
}

/// What is said of a pack's sound.
#[derive(Debug, Serialize)]
struct SoundInfo {
    codec: &'static str,
    rate_hz: u32,
    channels: u8,
    seconds: f64,
    bytes: usize,
}

impl SoundInfo {
    fn new(sound: &SoundTable) -> Self {
        let packets = (0..sound.packets()).filter_map(|number| sound.packet(number));
        Self {
            codec: "opus",
            rate_hz: SOUND_RATE,
            channels: sound.channels,
            seconds: sound.samples as f64 / f64::from(SOUND_RATE),
            bytes: packets.map(<[u8]>::len).sum(),
        }
    }
}

/// What the judge found of the content of a pack.
#[derive(Debug, Serialize)]
pub(crate) struct CalibrationInfo {
    rows: Vec<CalibrationRowInfo>,
    gazes: u16,
    frames: u16,
    #[serde(skip)]
    of: Calibration,
}

#[derive(Debug, Serialize)]
struct CalibrationRowInfo {
    policy: &'static str,
    ppd: f64,
    zone: &'static str,
    bound: f64,
    jod_mean: f64,
    jod_sd: f64,
    pixels_share: f64,
    bytes: u64,
}

/// Scores whose share of the pixels `info` shows.
const SHOWN_TARGETS: [f64; 2] = [9.5, 9.0];
/// Parts of the picture: the whole, then its zones.
const PARTS: [&str; 4] = ["whole", "under_5_deg", "from_5_to_20_deg", "over_20_deg"];

impl CalibrationInfo {
    fn new(of: Calibration) -> Self {
        let row = |row: &CalibrationRow| CalibrationRowInfo {
            policy: Policy::judged_for(row.rule).name(),
            ppd: row.ppd,
            zone: PARTS[row.zone.map_or(0, |zone| zone + 1)],
            bound: row.bound,
            jod_mean: row.jod_mean,
            jod_sd: row.jod_sd,
            pixels_share: row.pixels_share,
            bytes: row.bytes,
        };
        Self {
            rows: of.rows().iter().map(row).collect(),
            gazes: of.gazes,
            frames: of.frames,
            of,
        }
    }

    /// The cheaper rule at the target that is chosen for by default, and its share of the pixels:
    /// in the largest view that was judged.
    pub(crate) fn at_default_target(&self) -> Option<(&'static str, f64)> {
        let (rule, share) = self.of.cheaper(DEFAULT_TARGET, None)?;
        Some((Policy::judged_for(rule).name(), share))
    }

    /// The largest view that was judged, in words.
    pub(crate) fn finest_view(&self, projection: Projection) -> String {
        let densities = self.of.densities(Expectation::ByLoss);
        match (projection, densities.last()) {
            (Projection::Flat, _) | (_, None) => "at full size".to_owned(),
            (_, Some(ppd)) => format!("in a view {}", view_of_sphere(*ppd)),
        }
    }

    /// A table: a row for each size of view, a column for each score, in each the cheaper rule.
    fn text(&self, projection: Projection) -> String {
        let mut densities = self.of.densities(Expectation::ByLoss);
        densities.sort_by(|a, b| b.total_cmp(a));
        let finest = densities.first().copied().unwrap_or(1.0);
        let mut text = format!("{:<28}", "share of the pixels needed");
        for target in SHOWN_TARGETS {
            let _ = write!(text, "{:<22}", format!("{target} JOD"));
        }
        for ppd in densities {
            let view = match (projection, (finest / ppd).round()) {
                (Projection::Flat, 1.0) => format!("full size ({ppd:.1} pixels/°)"),
                (Projection::Flat, times) => format!("1/{times} size ({ppd:.1} pixels/°)"),
                _ => view_of_sphere(ppd),
            };
            let _ = write!(text, "\n  {view:<26}");
            for target in SHOWN_TARGETS {
                let _ = write!(text, "{:<22}", self.share_in_words(target, ppd));
            }
        }
        let lines = text.lines().map(str::trim_end);
        lines.fold(String::new(), |all, line| all + line + "\n")
    }

    fn share_in_words(&self, target: f64, ppd: f64) -> String {
        if let Some((rule, share)) = self.of.cheaper(target, Some(Ppd(ppd))) {
            let name = Policy::judged_for(rule).name();
            return format!("{:.1} % {name}", 100.0 * share.min(1.0));
        }
        let there = |row: &&CalibrationRow| row.zone.is_none() && row.ppd == ppd;
        let best = self.of.rows().iter().filter(there);
        let best = best.max_by(|a, b| a.jod_mean.total_cmp(&b.jod_mean));
        best.map_or(String::new(), |best| {
            format!(
                "{:.1} % has {:.2}",
                100.0 * best.pixels_share.min(1.0),
                best.jod_mean
            )
        })
    }
}

fn view_of_sphere(ppd: f64) -> String {
    format!("{:.0}° wide, {ppd:.1} pixels/°", sphere_width_deg(ppd))
}

/// How long a video lasts; `None` of a picture.
pub(crate) fn seconds_of(file: &PackFile) -> anyhow::Result<Option<f64>> {
    let about = file.pack().description();
    let times = file.frame_times()?;
    let last = times.last().map_or(0.0, |&ns| ns as f64 / 1e9);
    Ok((!about.is_still()).then_some(last + about.last_frame_s()))
}

/// Frames a second: of an animation, whose pictures are each shown for a time of their own, on
/// average.
fn fps_of(about: &Description, seconds: f64) -> f64 {
    let is_animation = ANIMATIONS.contains(&about.source.codec.as_str());
    match is_animation && seconds > 0.0 {
        true => f64::from(about.frames) / seconds,
        false => about.fps(),
    }
}

impl PackInfo {
    pub(crate) fn new(file: &PackFile) -> anyhow::Result<Self> {
        let pack = file.pack();
        let about: &Description = pack.description();
        let seconds = seconds_of(file)?;
        Ok(Self {
            content: MediaKind::of(about),
            projection: about.projection,
            frames: about.frames,
            fps: seconds.map(|seconds| fps_of(about, seconds)),
            seconds,
            width: about.source.size[0],
            height: about.source.size[1],
            face_width: about.size[0],
            face_height: about.size[1],
            eyes: about.eyes,
            faces: pack.grid().surface.faces_of_an_eye(),
            mapping: about.mapping,
            is_softer: is_softer(about),
            pixel_aspect: about.pixel_aspect,
            front_deg: about.front_deg,
            sound: file.sound()?.map(|sound| SoundInfo::new(&sound)),
            cut: about.cut,
            units: pack.units().count(),
            levels: about.levels,
            level_ratio: about.ratio,
            groups: about.groups.clone(),
            codec: about.codec,
            quality: about.quality.clone(),
            quality_scale: about.quality_scale,
            quality_by_tile: about.quality_by_tile,
            bit_rates: about.bit_rates.clone(),
            bytes: file.bytes(),
            bytes_per_level: pack.index().bytes_per_level(),
            loss: about.loss,
            // What is wrong with it `verify` says; a player does without.
            calibration: file.calibration().ok().flatten().map(CalibrationInfo::new),
            repairs: about.repairs.clone(),
            remarks: about.remarks.clone(),
            source: about.source.name.clone(),
            source_bytes: about.source.bytes,
            generator: about.generator.clone(),
        })
    }

    pub(crate) fn text(&self) -> String {
        self.text_but(&[])
    }

    /// The same, without the remarks that were `said` already.
    pub(crate) fn text_but(&self, said: &[String]) -> String {
        let cut = match self.cut {
            Cut::Tile(px) => format!("tiles of {px} px"),
            Cut::Grid([c, r]) => format!("a grid of {c}x{r} a face"),
        };
        let content = match (self.fps, self.seconds) {
            (Some(fps), Some(seconds)) => {
                format!(
                    "{} at {fps:.3} fps, {seconds:.2} s",
                    counted(self.frames, "frame")
                )
            }
            _ => "a picture".to_owned(),
        };
        let mut text = format!(
            "{}, {}x{}, {}\n{content}\n\
             {}, {} of ratio {}, {cut}, {}\n{} from {}\n",
            one_line(&self.source),
            self.width,
            self.height,
            self.surround_told(),
            self.codec.name(),
            counted(self.levels, "level"),
            self.level_ratio,
            counted(self.units, "unit"),
            output::size(self.bytes),
            output::size(self.source_bytes),
        );
        text += &self.loss_told();
        if let Some(calibration) = &self.calibration {
            text += &calibration.text(self.projection);
        }
        if let Some(sound) = &self.sound {
            let _ = writeln!(
                text,
                "sound: {}, {} Hz, {}, {:.2} s, {}",
                sound.codec,
                sound.rate_hz,
                counted(sound.channels, "channel"),
                sound.seconds,
                output::size(sound.bytes as u64)
            );
        }
        if self.is_softer {
            text += "prepared again from a sphere this would be sharper: its faces are gnomonic\n";
        }
        for (level, bytes) in self.bytes_per_level.iter().enumerate() {
            let _ = writeln!(
                text,
                "level {level}: {}, {}{}",
                output::size(*bytes),
                self.quality_of(level),
                match self.content {
                    MediaKind::Picture => String::new(),
                    MediaKind::Video => format!(", groups of {}", self.groups[level]),
                }
            );
        }
        let new = |remark: &&String| !said.contains(remark);
        let remarks: Vec<String> = self.remarks.iter().filter(new).cloned().collect();
        text + &remarks_told(&self.repairs, &remarks)
    }

    /// How it surrounds the eye, in words.
    fn surround_told(&self) -> String {
        let [wide, high] = self.pixel_aspect;
        let mut surround = match (self.projection, self.faces) {
            (Projection::Flat, _) if wide != high => format!("flat, pixels of {wide}:{high}"),
            (Projection::Flat, _) => "flat".to_owned(),
            (Projection::Cube, 4) => {
                format!(
                    "four faces of {0}x{0} px round the horizon",
                    self.face_width
                )
            }
            (Projection::Cube, _) => format!("cube of {0}x{0} px faces", self.face_width),
            (Projection::Equirect, _) => {
                let [w, h] = [self.face_width, self.face_height];
                format!("equirectangular, {w}x{h} px")
            }
        };
        if self.mapping == Mapping::EquiAngular {
            surround += ", equi-angular";
        }
        if self.front_deg != 0.0 {
            surround += &format!(", opened at {:.0}°", self.front_deg);
        }
        if self.eyes > 1 {
            surround += ", for each of two eyes";
        }
        surround
    }

    /// A line about what preparing lost, if anybody measured.
    fn loss_told(&self) -> String {
        if let Some(Loss { psnr_db, jod }) = self.loss {
            let psnr = match psnr_db {
                Some(decibels) => format!("PSNR {decibels:.2} dB"),
                None => "no pixel differs".to_owned(),
            };
            return format!(
                "the finest level against the source: {psnr}, {jod:.2} JOD at the worst of nine \
                 gazes (10 is no difference)\n"
            );
        }
        String::new()
    }

    /// The score, the bytes and how many times the source's they are.
    pub(crate) fn in_short(&self) -> String {
        let score = match self.loss {
            Some(loss) => format!("{:.2} JOD against the source, ", loss.jod),
            None => String::new(),
        };
        let ratio = match self.source_bytes {
            0 => String::new(),
            bytes => format!(
                ", {:.1} times the size of the source",
                self.bytes as f64 / bytes as f64
            ),
        };
        format!("{score}{}{ratio}", output::size(self.bytes))
    }

    fn quality_of(&self, level: usize) -> String {
        match (self.bit_rates.get(level), self.quality_scale) {
            (Some(bits), _) => format!("{:.3} Mbit/s a tile", f64::from(*bits) / 1e6),
            (None, _) if self.codec == Codec::Png => "lossless".to_owned(),
            (None, QualityScale::Quantiser) if self.quality_by_tile => {
                format!("quality about {}, by tile", self.quality[level])
            }
            (None, QualityScale::Quantiser) => format!("quality {}", self.quality[level]),
            (None, QualityScale::Ijg) => format!("quality q{}", self.quality[level]),
        }
    }
}

/// Whether gnomonic faces were resampled from a sphere, which equi-angular ones keep better: those
/// of an input that is a cube have not a quarter of its width.
fn is_softer(about: &Description) -> bool {
    let is_cube = about.projection == Projection::Cube && about.cube_faces == 6;
    let quarter = face_size_for(about.source.size[0], Coverage::Full);
    is_cube && about.mapping == Mapping::Gnomonic && about.size[0] == quarter
}

pub(crate) fn run(args: &InfoArgs) -> anyhow::Result<()> {
    match Pack::open(&args.pack)? {
        Pack::Video(file) => {
            if let Err(error) = file.calibration() {
                let again = "`foveal calibrate PACK --out NEW` writes a copy with a new one";
                output::say(&format!("warning: {error}; {again}"));
            }
            let info = PackInfo::new(&file)?;
            output::result(args.json, &info, &info.text())
        }
        Pack::Scene(file) => {
            let info = SceneInfo::new(&file);
            output::result(args.json, &info, &info.text())
        }
    }
}
