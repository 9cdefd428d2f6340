//! Which options do several commands share, and how are their values written?

use crate::options::perception::{PerceptionOptions, read_acuity};
use crate::options::policy_choice::{PolicyChoice, policy_choice_parser};
use crate::report::output::{WrongUsage, out_of_range};
use anyhow::{Context, anyhow, bail};
use clap::{Args, ValueEnum};
use foveal_core::content::policy::asked::{SLOPES, TARGETS};
use foveal_core::content::policy::{
    DEFAULT_TARGET, EdgeRule, ImportanceSource, MASK_SIDE, MaskConfig, Policy, PolicyConfig,
    STEADINESS,
};
use foveal_core::content::video::grid::tile_grid::{Cut, TileGrid};
use foveal_core::perception::acuity::AcuityModel;
use foveal_core::perception::measured::acuity::MeasuredAcuity;
use foveal_core::units::{Radians, counted};
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::panel::rig::Panel;
use foveal_core::view::surface::{Mapping, Projection, Screen, Surface};
use std::path::PathBuf;

/// The value of `--acuity`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum AcuityChoice {
    Linear,
    Watson,
    WatsonPaper,
    /// Measurements in a file.
    File(PathBuf),
}

/// Reads the value of `--acuity`.
fn parse_acuity(text: &str) -> anyhow::Result<AcuityChoice> {
    Ok(match text {
        "linear" => AcuityChoice::Linear,
        "watson" => AcuityChoice::Watson,
        "watson-paper" => AcuityChoice::WatsonPaper,
        file if file.to_ascii_lowercase().ends_with(".csv") => AcuityChoice::File(file.into()),
        _ => bail!("expected linear, watson, watson-paper or a file FILE.csv"),
    })
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum EdgeRuleName {
    /// Every cell within the margin of the gaze is finest.
    Conservative,
    /// Only the cell that the gaze is in is finest.
    Single,
}

/// Which rule chooses levels.
#[derive(Clone, Debug, Args)]
pub(crate) struct PolicyOptions {
    /// How levels are chosen (default: auto; perceptual with --link; acuity for a pack without
    /// signatures, for a scene where nothing limits bytes, and with --acuity, --slope or
    /// --safety-disc; or the preset's).
    #[arg(long, value_parser = policy_choice_parser())]
    policy: Option<PolicyChoice>,
    /// The score in JOD that what is shown is expected to keep against every finest tile, 1 to
    /// 9.99: where within --link buying stops, else what levels are chosen for; none for what is
    /// worth anything (default: 9.5 for acuity and perceptual, else none).
    #[arg(long, value_name = "JOD|none", value_parser = parse_target)]
    #[arg(allow_hyphen_values = true)]
    target: Option<TargetChoice>,
    /// The eye of the acuity policy: linear (1/60° + --slope x eccentricity; the default), watson
    /// (Watson 2014, corrected), watson-paper (as Chen et al. 2022 print it), or measurements: CSV
    /// with ecc_deg and mar_deg or mar_arcmin, the smallest pixel that can be resolved.
    /// Measurements also limit what the eye resolves under perceptual and eccentricity.
    #[arg(long, value_name = "NAME|FILE.csv", value_parser = parse_acuity)]
    acuity: Option<AcuityChoice>,
    /// The linear eye: degrees by which the smallest pixel that it resolves grows with each
    /// degree of eccentricity; a slope of a cycle, two pixels, is twice as large (default: what
    /// --target takes; 0.022 for distance and sampled).
    #[arg(long, value_name = "SLOPE", allow_negative_numbers = true)]
    slope: Option<f64>,
    /// acuity: radius round the gaze, in degrees, that is always finest.
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    safety_disc: f64,
    /// viewport: what is kept fine around the view, in degrees.
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 10.0,
        allow_negative_numbers = true
    )]
    margin: f64,
    /// grid: which cells are finest.
    #[arg(long, value_enum, default_value = "conservative")]
    edge_rule: EdgeRuleName,
    /// grid: how near the gaze a cell must be to be finest, in degrees.
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    edge_margin: f64,
    /// grid: how many lowest-level cells, in index order, are promoted to the middle level.
    #[arg(long, value_name = "N", default_value_t = 0)]
    noisy_cells: u32,
    /// grid: RGB variance, in squared code values (0 to 16384), above which a cell is promoted to
    /// the middle level.
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    noise_threshold: Option<f64>,
    /// distance, sampled: degrees from the gaze up to which each level is shown, finest first, as
    /// 3,12; beyond the last all is coarsest (default: where acuity allows the next level).
    #[arg(
        long,
        value_name = "D1,D2,..",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    thresholds: Vec<f64>,
    /// sampled: how many samples (default: as many as acuity asks for; 690926 in the preset).
    #[arg(long, value_name = "N")]
    pub(crate) samples: Option<u32>,
    /// sampled: pixels of the view on a side of the square that samples lie in.
    #[arg(long, value_name = "PX", default_value_t = MASK_SIDE)]
    mask_size: u32,
    /// How far the gaze may go before what it leaves becomes coarser, in degrees; 0 follows every
    /// tremble. For policies that spend no budget.
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = STEADINESS.to_degrees(),
        allow_negative_numbers = true
    )]
    steadiness: f64,
    #[command(flatten)]
    perception: PerceptionOptions,
    /// perceptual with a link: fetch what is salient outside the region that gaze predicts.
    #[arg(long, value_enum, default_value = "off")]
    saliency: Switch,
    /// perceptual on scenes: how the worth of units is found; rendered draws every level for each
    /// choice.
    #[arg(long, value_enum, default_value = "signatures")]
    importance: ImportanceName,
}

/// How much an eye gets from the units of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ImportanceName {
    /// What was measured while preparing.
    Signatures,
    /// Pictures of all levels: slow, the reference.
    Rendered,
}

impl From<ImportanceName> for ImportanceSource {
    fn from(name: ImportanceName) -> Self {
        match name {
            ImportanceName::Signatures => Self::Signatures,
            ImportanceName::Rendered => Self::Rendered,
        }
    }
}

/// The value of `--target`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TargetChoice {
    Jod(f64),
    None,
}

/// How pixels lie over the faces of a cube.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MappingName {
    /// Evenly in angle: as sharp as the source everywhere.
    EquiAngular,
    /// Evenly in tangent, as a camera draws: softer in the middle of a face.
    Gnomonic,
}

impl MappingName {
    pub(crate) fn mapping(self) -> Mapping {
        match self {
            Self::EquiAngular => Mapping::EquiAngular,
            Self::Gnomonic => Mapping::Gnomonic,
        }
    }
}

/// Reads the value of `--target`.
pub(crate) fn parse_target(text: &str) -> anyhow::Result<TargetChoice> {
    if text == "none" {
        return Ok(TargetChoice::None);
    }
    let jod: f64 = text.trim().parse().map_err(|_| expected_target())?;
    match TARGETS.contains(&jod) {
        true => Ok(TargetChoice::Jod(jod)),
        false => Err(expected_target()),
    }
}

fn expected_target() -> anyhow::Error {
    anyhow!("expected a score of 1 to 9.99 JOD or none; 10 is --policy full")
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Switch {
    On,
    Off,
}

/// Longest side of a sample mask: as of a view.
const MOST_MASK_SIDE: u32 = 4096;
/// Largest mean variance of 8-bit colours in a pack.
const MOST_VARIANCE: f64 = 16_384.0;

impl PolicyOptions {
    /// The policy that was asked for.
    pub(crate) fn policy(&self) -> Policy {
        let is_of_acuity = self.acuity.is_some() || self.slope.is_some() || self.safety_disc != 0.0;
        let usual = match is_of_acuity && self.perception.sensitivity.is_none() {
            true => Policy::Acuity,
            false => Policy::Perceptual,
        };
        self.named().unwrap_or(usual)
    }

    pub(crate) fn named(&self) -> Option<Policy> {
        self.policy.and_then(PolicyChoice::named)
    }

    /// The same parameters for this policy.
    pub(crate) fn under(&self, policy: Policy) -> Self {
        Self {
            policy: Some(PolicyChoice::Is(policy)),
            ..self.clone()
        }
    }

    /// The same where these panels show it and no policy was named: what many people look at at
    /// once is as fine everywhere as its pixels can show.
    pub(crate) fn seen_by_many(&self, panels: &[Panel]) -> Self {
        let is_usual = self.named().is_none() && self.policy() == Policy::Perceptual;
        match is_usual && panels.iter().all(|panel| panel.is_for_both) {
            true => self.under(Policy::Viewport),
            false => self.clone(),
        }
    }

    /// Refuses a score for a scene that units are bought for: the score they make is unknown.
    pub(crate) fn refuse_score_of_scene(&self, policy: Policy) -> anyhow::Result<()> {
        if policy.spends_a_budget() && matches!(self.target, Some(TargetChoice::Jod(_))) {
            bail!(WrongUsage(format!(
                "--target: on a scene {} does not choose for a score; give --policy acuity, which \
                 does, or leave --target out",
                policy.name()
            )));
        }
        Ok(())
    }

    /// The same for a score, in the place of the acuity that was asked for.
    pub(crate) fn for_score(&self, target: Option<f64>) -> Self {
        Self {
            target: Some(target.map_or(TargetChoice::None, TargetChoice::Jod)),
            acuity: None,
            slope: None,
            ..self.clone()
        }
    }

    /// The policy with its parameters, checked.
    pub(crate) fn config(&self) -> anyhow::Result<PolicyConfig> {
        self.config_of(self.policy())
    }

    /// These parameters under another policy.
    pub(crate) fn config_of(&self, policy: Policy) -> anyhow::Result<PolicyConfig> {
        let measured = match &self.acuity {
            Some(AcuityChoice::File(path)) => Some(read_acuity(path)?),
            _ => None,
        };
        if self.importance == ImportanceName::Rendered && self.perception.sensitivity.is_some() {
            bail!(WrongUsage(
                "--importance rendered takes the model's own sensitivity; leave it out, or \
                 --sensitivity"
                    .to_owned()
            ));
        }
        Ok(PolicyConfig {
            policy,
            acuity: self.acuity(measured.as_ref())?,
            safety_disc: angle("--safety-disc", self.safety_disc)?,
            margin: angle("--margin", self.margin)?,
            edge_rule: match self.edge_rule {
                EdgeRuleName::Conservative => EdgeRule::Conservative,
                EdgeRuleName::Single => EdgeRule::Single,
            },
            edge_margin: angle("--edge-margin", self.edge_margin)?,
            noisy_cells: self.noisy_cells,
            noise_threshold: self.noise_threshold()?,
            thresholds: self.thresholds()?,
            mask: self.mask()?,
            steadiness: angle("--steadiness", self.steadiness)?,
            perception: self.perception.parameters(measured)?,
            saliency: self.saliency == Switch::On,
            importance: self.importance.into(),
            target: self.target(policy)?,
            bound: None,
            together: false,
        })
    }

    /// The score that levels are chosen for under a policy.
    pub(crate) fn target(&self, policy: Policy) -> anyhow::Result<Option<f64>> {
        let other = match (self.slope, &self.acuity) {
            (Some(_), _) => Some("--slope"),
            (None, None | Some(AcuityChoice::Linear)) => None,
            // What was measured limits what perceptual takes to be seen, at any score.
            (None, Some(AcuityChoice::File(_))) if policy != Policy::Acuity => None,
            (None, Some(_)) => Some("--acuity"),
        };
        match (self.target, other) {
            (Some(TargetChoice::Jod(_)), Some(other)) => bail!(WrongUsage(format!(
                "--target chooses what {other} does; give one of them"
            ))),
            (Some(TargetChoice::Jod(jod)), None) if policy.has_target() => Ok(Some(jod)),
            (None, None) if policy.facts().keeps_a_score => Ok(Some(DEFAULT_TARGET)),
            (None, Some(_)) if policy == Policy::Perceptual => Ok(Some(DEFAULT_TARGET)),
            _ => Ok(None),
        }
    }

    /// The model that was asked for, or what the file of measurements holds.
    fn acuity(&self, measured: Option<&MeasuredAcuity>) -> anyhow::Result<AcuityModel> {
        let choice = self.acuity.as_ref().unwrap_or(&AcuityChoice::Linear);
        match (choice, measured, self.slope) {
            (AcuityChoice::Linear, _, None) => Ok(AcuityModel::LINEAR),
            (AcuityChoice::Linear, _, Some(slope)) if SLOPES.contains(&slope) => {
                Ok(AcuityModel::linear(slope))
            }
            (AcuityChoice::Linear, _, Some(slope)) => {
                bail!(out_of_range("--slope", slope, "0 to 1 degree a degree"))
            }
            (_, Some(measured), None) => Ok(AcuityModel::Table(measured.clone())),
            (AcuityChoice::Watson, _, None) => Ok(AcuityModel::Watson),
            (_, _, None) => Ok(AcuityModel::WatsonPaper),
            (_, _, Some(_)) => bail!(WrongUsage(
                "--slope is for --acuity linear; leave one of them out".to_owned()
            )),
        }
    }

    fn noise_threshold(&self) -> anyhow::Result<Option<f64>> {
        match self.noise_threshold {
            Some(variance) if !(0.0..=MOST_VARIANCE).contains(&variance) => bail!(out_of_range(
                "--noise-threshold",
                variance,
                "a variance of 0 to 16384"
            )),
            threshold => Ok(threshold),
        }
    }

    fn thresholds(&self) -> anyhow::Result<Vec<Radians>> {
        if self.thresholds.windows(2).any(|pair| pair[0] > pair[1]) {
            let given = self.thresholds.iter().map(f64::to_string);
            let given = given.collect::<Vec<_>>().join(",");
            bail!(out_of_range("--thresholds", given, "angles that rise"));
        }
        let angles = self.thresholds.iter();
        angles
            .map(|degrees| angle("--thresholds", *degrees))
            .collect()
    }

    fn mask(&self) -> anyhow::Result<MaskConfig> {
        let side = self.mask_size;
        if !(1..=MOST_MASK_SIDE).contains(&side) {
            let range = format!("1 to {MOST_MASK_SIDE} pixels");
            bail!(out_of_range("--mask-size", side, &range));
        }
        match self.samples {
            Some(samples) if !(1..=side * side).contains(&samples) => bail!(out_of_range(
                "--samples",
                samples,
                &format!("1 to {}, all of the mask", counted(side * side, "pixel"))
            )),
            samples => Ok(MaskConfig { side, samples }),
        }
    }
}

/// Whether there is a level beyond every threshold.
pub(crate) fn check_thresholds(config: &PolicyConfig, grid: &TileGrid) -> anyhow::Result<()> {
    let (given, most) = (config.thresholds.len(), usize::from(grid.coarsest()));
    if given <= most {
        return Ok(());
    }
    let range = format!(
        "at most {} for {}",
        counted(most, "angle"),
        counted(grid.levels, "level")
    );
    bail!(out_of_range(
        "--thresholds",
        counted(given, "angle"),
        &range
    ))
}

fn angle(option: &str, degrees: f64) -> anyhow::Result<Radians> {
    if (0.0..=180.0).contains(&degrees) {
        Ok(Radians::from_degrees(degrees))
    } else {
        bail!(out_of_range(
            option,
            degrees,
            "an angle of 0 to 180 degrees"
        ))
    }
}

/// What shows the picture.
#[derive(Clone, Debug, Args)]
pub(crate) struct ViewOptions {
    /// Pixels of the view (default: the content's density, at most 1920 wide).
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub(crate) view: Option<[u32; 2]>,
    /// 360° content: field of view along the view's larger side, in degrees.
    #[arg(long, value_name = "DEG", default_value_t = 100.0)]
    fov: f64,
    /// Flat content: diagonal in inches and distance in metres of the screen it fills.
    #[arg(long, value_name = "INCHES,METRES", value_parser = parse_screen)]
    #[arg(allow_hyphen_values = true)]
    #[arg(default_value = "24,0.6")]
    pub(crate) screen: Screen,
}

/// Longest side of a view in pixels.
const MAX_VIEW_SIDE: u32 = 8192;
/// Widest view that is chosen without being asked for.
const DEFAULT_VIEW_WIDTH: u32 = 1920;

impl ViewOptions {
    /// The view of `surface`: flat content lies in it as large as it fits, a cube is seen with the
    /// field of view.
    pub(crate) fn eye_view(&self, surface: &Surface) -> anyhow::Result<EyeView> {
        let fov = self.fov()?;
        let size = match self.view {
            Some(size) => self.size_or(size)?,
            None => self.default_size(surface)?,
        };
        Ok(match surface.projection {
            Projection::Flat => EyeView::holding(surface, size),
            Projection::Cube | Projection::Equirect => {
                let field = Field::of_larger_side(fov, size);
                EyeView {
                    position: Default::default(),
                    axes: Axes::FRONT,
                    field,
                    size,
                    eye: Default::default(),
                }
            }
        })
    }

    /// The size that was asked for, or this one.
    pub(crate) fn size_or(&self, usual: [u32; 2]) -> anyhow::Result<[u32; 2]> {
        match self.view {
            Some([w, h]) if w.max(h) > MAX_VIEW_SIDE => {
                let range = format!("sides of 1 to {MAX_VIEW_SIDE}");
                bail!(out_of_range("--view", format!("{w}x{h}"), &range))
            }
            size => Ok(size.unwrap_or(usual)),
        }
    }

    /// Field of view of 360° content, along the larger side.
    pub(crate) fn fov(&self) -> anyhow::Result<Radians> {
        if (1.0..=170.0).contains(&self.fov) {
            Ok(Radians::from_degrees(self.fov))
        } else {
            bail!(out_of_range("--fov", self.fov, "1 to 170 degrees"))
        }
    }

    fn default_size(&self, surface: &Surface) -> anyhow::Result<[u32; 2]> {
        let [w, h] = surface.size;
        let (width, height_of_width) = match surface.projection {
            Projection::Flat => {
                let height_of_width = surface.tangents[1] / surface.tangents[0];
                let shown = (f64::from(h) / height_of_width).round() as u32;
                (w.max(shown), height_of_width)
            }
            Projection::Cube | Projection::Equirect => {
                let across = 2.0 * (self.fov()?.0 / 2.0).tan() / surface.pitch();
                // Even, and 16:10 as headset eyes roughly are.
                ((across as u32).next_multiple_of(16), 0.625)
            }
        };
        let width = width.min(DEFAULT_VIEW_WIDTH);
        let height = (f64::from(width) * height_of_width).round() as u32;
        Ok([width, height.clamp(1, MAX_VIEW_SIDE)])
    }
}

/// How pictures are cut.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct CutOptions {
    /// A pyramid of tiles of this many pixels on a side.
    #[arg(long, value_name = "PX", conflicts_with = "grid")]
    pub(crate) tile: Option<u32>,
    /// A grid of columns and rows per face, the same at every level.
    #[arg(long, value_name = "CxR", value_parser = parse_size)]
    pub(crate) grid: Option<[u32; 2]>,
    /// Number of levels.
    #[arg(long, value_name = "N")]
    pub(crate) levels: Option<u8>,
    /// Linear ratio between levels, 2 or 4 (default: 2).
    #[arg(long, value_name = "2|4")]
    pub(crate) level_ratio: Option<u32>,
}

impl CutOptions {
    /// The cut that was asked for.
    pub(crate) fn asked(&self) -> Option<Cut> {
        self.grid.map(Cut::Grid).or(self.tile.map(Cut::Tile))
    }

    /// The ratio between levels that was asked for, or the default.
    pub(crate) fn ratio(&self) -> u32 {
        self.level_ratio.unwrap_or(2)
    }

    /// The cut that was asked for, or the default for content on a surface.
    pub(crate) fn cut(&self, surface: &Surface) -> Cut {
        self.asked().unwrap_or(Cut::pyramid_for(surface))
    }
}

/// Reads `WxH`.
pub(crate) fn parse_size(text: &str) -> anyhow::Result<[u32; 2]> {
    let (w, h) = text
        .split_once(['x', 'X'])
        .context("expected two numbers as 1280x720")?;
    let size = [w.trim().parse()?, h.trim().parse()?];
    if size.contains(&0) {
        Err(anyhow!("each number must be at least 1"))
    } else {
        Ok(size)
    }
}

/// Reads `A,B` as finite numbers.
pub(crate) fn parse_pair(text: &str) -> anyhow::Result<[f64; 2]> {
    let (a, b) = text
        .split_once(',')
        .context("expected two numbers as 10,-5")?;
    let pair: [f64; 2] = [a.trim().parse()?, b.trim().parse()?];
    if pair.iter().all(|n| n.is_finite()) {
        Ok(pair)
    } else {
        Err(anyhow!("expected finite numbers"))
    }
}

fn parse_screen(text: &str) -> anyhow::Result<Screen> {
    let [diagonal_inches, distance_m] =
        parse_pair(text).context("expected inches and metres as 24,0.6")?;
    if (0.1..=10_000.0).contains(&diagonal_inches) && (0.01..=1000.0).contains(&distance_m) {
        Ok(Screen {
            diagonal_inches,
            distance_m,
            ..Screen::default()
        })
    } else {
        Err(anyhow!(
            "expected 0.1 to 10000 inches and 0.01 to 1000 metres"
        ))
    }
}
