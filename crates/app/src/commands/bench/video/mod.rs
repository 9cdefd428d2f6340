//! How fast does foveated video play, against playing it whole?
//!
//! One pack, one pool of decoders, one gaze: the foveated frames, `viewport`, `full` and `coarsest`
//! take turns in one run, together with the original file's own decoder. With `--policy all` both
//! rules that keep a target do, and with `--workers` other numbers of threads. With `--preset` a
//! published system's rule takes turns as well, and the foveated frames are chosen for the score
//! that it reaches.

mod arms;
mod content;
mod equal;
mod report;

use crate::options::decoding::DecodingOptions;
use crate::options::policy::{TargetChoice, parse_target};
use crate::options::policy_choice::{PoliciesChoice, policies_choice_parser};
use crate::options::preset::SystemPreset;
use crate::options::renderer::{RendererName, open_device};
use crate::report::output::{self, WrongUsage, out_of_range};
use crate::run::timed::{Conditions, Way};
use anyhow::bail;
use arms::{Arms, Published, SLOPE_BEFORE};
use clap::Args;
use content::{Generated, PackAndOriginal, WALL, cache};
use foveal_core::content::policy::asked::SLOPES;
use foveal_core::content::policy::{DEFAULT_TARGET, Policy, PolicyConfig};
use foveal_core::perception::acuity::AcuityModel;
use foveal_core::view::surface::Screen;
use foveal_media::VideoInput;
use foveal_media::pack::pack_file::PackFile;
use foveal_render::DrawDevice;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

#[derive(Clone, Debug, Args)]
pub(crate) struct VideoArgs {
    /// The pack to play.
    #[arg(conflicts_with = "generate")]
    pack: Option<PathBuf>,
    /// Play a drawn clip instead, made on first use and kept.
    #[arg(long, value_enum)]
    generate: Option<Generated>,
    /// The file that the pack was made from, to be decoded for comparison.
    #[arg(
        long,
        value_name = "FILE",
        requires = "pack",
        conflicts_with = "generate"
    )]
    original: Option<PathBuf>,
    /// Where drawn clips are kept (default: the user's folder for caches).
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// How the foveated frames are chosen; auto is acuity where the pack has no calibration.
    #[arg(long, value_parser = policies_choice_parser(), default_value = "auto")]
    policy: PoliciesChoice,
    /// The score in JOD that they are chosen for, 1 to 9.99, or none (default: 9.5; with --preset
    /// what its rule reaches).
    #[arg(long, value_name = "JOD|none", value_parser = parse_target)]
    #[arg(allow_hyphen_values = true, conflicts_with = "slope")]
    target: Option<TargetChoice>,
    /// acuity: degrees a degree by which the smallest pixel grows, in place of a target.
    #[arg(long, value_name = "SLOPE", allow_negative_numbers = true)]
    slope: Option<f64>,
    /// A published system whose rule is timed as well, on the same pack; with --generate on one
    /// that is cut and coded as it did.
    #[arg(long, value_enum)]
    preset: Option<SystemPreset>,
    /// Foveated frames to play; 10 to 100000.
    #[arg(long, value_name = "N", default_value_t = 600)]
    frames: u32,
    /// What draws the pictures.
    #[arg(long, value_enum, default_value = "gpu")]
    renderer: RendererName,
    #[command(flatten)]
    decoding: DecodingOptions,
    /// Numbers of decoding threads to decode the foveated frames with as well.
    #[arg(long, value_name = "N,..", value_delimiter = ',')]
    workers: Vec<usize>,
    /// Seed of the gaze.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Frames of the original that are decoded, at most.
const ORIGINAL_FRAMES: u32 = 24;

pub(super) fn run(args: &VideoArgs) -> anyhow::Result<()> {
    if !(10..=100_000).contains(&args.frames) {
        bail!(out_of_range("--frames", args.frames, "10 to 100000"));
    }
    // Says what is wrong with the options before anything long begins.
    for policy in args.named() {
        args.config(policy)?;
    }
    for workers in &args.workers {
        output::threads("--workers", *workers)?;
    }
    let drawing = open_device(args.renderer)?;
    let content = args.content(None)?;
    let conditions = args.conditions(&content.pack, &drawing)?;
    let policies = args.policies(&conditions)?;
    let published = match args.preset {
        Some(system) => Some(args.published(system, &conditions)?),
        None => None,
    };
    let way = |policy| {
        let config = args.config(policy)?;
        anyhow::Ok(Way::of(match (&published, args.target, args.slope) {
            (Some(published), None, None) => equal::as_good_as(published, &conditions, config)?,
            _ => config,
        }))
    };
    let ways = policies.into_iter().map(way);
    let ways = ways.collect::<anyhow::Result<Vec<Way>>>()?;
    let original = content.original.as_deref().map(original_fps).transpose()?;
    let arms = Arms::play(
        &conditions,
        &ways,
        published.as_ref(),
        &args.workers,
        args.frames,
    )?;
    let report = arms.report(&conditions, args.frames, original, published.as_ref())?;
    output::result(args.json, &report, &report.text())
}

impl VideoArgs {
    /// The policies that were named, those that keep a target for all.
    fn named(&self) -> Vec<Policy> {
        match self.policy {
            PoliciesChoice::All => vec![Policy::Acuity, Policy::Perceptual],
            PoliciesChoice::One(choice) => choice.named().into_iter().collect(),
        }
    }

    /// The policies of the foveated frames; of a calibrated pack the one that needs fewer pixels is
    /// the first, or chosen where none was named.
    fn policies(&self, conditions: &Conditions<'_>) -> anyhow::Result<Vec<Policy>> {
        let mut policies = self.named();
        if let [policy] = policies[..] {
            return Ok(vec![policy]);
        }
        let target = match self.target {
            Some(TargetChoice::Jod(jod)) => Some(jod),
            Some(TargetChoice::None) => None,
            None => self.slope.is_none().then_some(DEFAULT_TARGET),
        };
        let cheaper = match target {
            Some(target) => {
                let calibration = conditions.file.calibration()?;
                calibration.and_then(|it| it.cheaper(target, Some(conditions.density())))
            }
            None => None,
        };
        let first = cheaper.map_or(Policy::Acuity, |(rule, _)| Policy::judged_for(rule));
        policies.retain(|policy| *policy != first);
        policies.insert(0, first);
        Ok(policies)
    }

    /// How the foveated frames are chosen.
    fn config(&self, policy: Policy) -> anyhow::Result<PolicyConfig> {
        if self.slope.is_some() && policy != Policy::Acuity {
            bail!(WrongUsage(
                "--slope is for --policy acuity; leave one of them out".to_owned()
            ));
        }
        if self.target.is_some() && !policy.has_target() {
            bail!(WrongUsage(format!(
                "--target: {} chooses for no score; leave one of them out",
                policy.name()
            )));
        }
        let slope = self.slope.unwrap_or(SLOPE_BEFORE);
        if !SLOPES.contains(&slope) {
            bail!(out_of_range("--slope", slope, "0 to 1 degree a degree"));
        }
        let target = match (self.target, self.slope) {
            (Some(TargetChoice::Jod(jod)), _) => Some(jod),
            (Some(TargetChoice::None), _) | (None, Some(_)) => None,
            (None, None) => policy.has_target().then_some(DEFAULT_TARGET),
        };
        Ok(PolicyConfig {
            acuity: AcuityModel::linear(slope),
            target,
            ..PolicyConfig::new(policy)
        })
    }

    /// What is played: as the user's pack is, or a drawn clip cut and coded as `system` did.
    fn content(&self, system: Option<SystemPreset>) -> anyhow::Result<PackAndOriginal> {
        match (&self.pack, self.generate) {
            (Some(pack), _) => Ok(PackAndOriginal {
                pack: pack.clone(),
                original: self.original.clone(),
            }),
            (None, Some(generated)) => generated.prepare(&cache(self.cache.as_deref())?, system),
            (None, None) => bail!(WrongUsage(
                "give a PACK, or --generate panorama-16k|wide-8k|wide-16k".to_owned()
            )),
        }
    }

    fn conditions<'a>(
        &self,
        pack: &Path,
        drawing: &'a DrawDevice,
    ) -> anyhow::Result<Conditions<'a>> {
        Ok(Conditions {
            file: Arc::new(PackFile::open(pack)?),
            drawing,
            screen: self.generate.map_or_else(Screen::default, |_| WALL),
            decoding: self.decoding.decoding()?,
            seed: self.seed,
        })
    }

    /// The rule of a published system, and the pack that it plays.
    fn published<'a>(
        &self,
        system: SystemPreset,
        ours: &Conditions<'a>,
    ) -> anyhow::Result<Published<'a>> {
        let own = match self.generate {
            Some(_) => {
                let pack = self.content(Some(system))?.pack;
                Some(self.conditions(&pack, ours.drawing)?)
            }
            None => None,
        };
        let conditions = own.as_ref().unwrap_or(ours);
        let way = system.way(conditions.file.pack().description().projection);
        let score = conditions.score(&way)?;
        Ok(Published {
            system,
            way,
            score,
            own,
        })
    }
}

/// Frames a second that the original file's own decoder gives, on all cores.
fn original_fps(path: &Path) -> anyhow::Result<f64> {
    let mut video = VideoInput::open(path)?;
    let begun = Instant::now();
    let mut frames = 0;
    while frames < ORIGINAL_FRAMES && video.next_frame()?.is_some() {
        frames += 1;
    }
    Ok(f64::from(frames) / begun.elapsed().as_secs_f64())
}
