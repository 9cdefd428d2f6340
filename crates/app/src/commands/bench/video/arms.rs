//! What takes turns, and what did each reach?
//!
//! All of a comparison take turns, so that other work on the machine touches all alike.

use crate::commands::bench::video::report::{
    Before, Foveated, PublishedReport, Rate, Rates, Report, WorkersReport, name_of,
};
use crate::commands::demo::machine::Machine;
use crate::options::decoding::DeviceReport;
use crate::options::preset::SystemPreset;
use crate::report::output;
use crate::run::timed::{Conditions, Parts, Run, Way, decodes_per_frame};
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::perception::acuity::AcuityModel;
use foveal_play::Decoding;
use foveal_render::DrawDevice;

/// The slope that levels were chosen by before there was a target, in degrees a degree.
pub(super) const SLOPE_BEFORE: f64 = 0.022;
/// Turns that every policy takes.
const TURNS: u32 = 10;
/// Of a turn's foveated frames, those that the setting of before, `viewport` and `full` play too:
/// the latter are slower.
const SHARE_OF_BEFORE: u32 = 2;
const SHARE_OF_VIEWPORT: u32 = 10;
const SHARE_OF_FULL: u32 = 20;

/// The rule of a published system.
pub(super) struct Published<'a> {
    pub(super) system: SystemPreset,
    pub(super) way: Way,
    /// Of its first frames, in JOD; `None` where nothing draws.
    pub(super) score: Option<f64>,
    /// Its own pack and how that is played; `None` where it plays the one that ours plays.
    pub(super) own: Option<Conditions<'a>>,
}

/// Frames that are timed against each other.
pub(super) struct Arms {
    /// At least one.
    foveated: Vec<(Way, Run)>,
    before: Run,
    whole: Whole,
    published: Option<PublishedArms>,
    /// The first of the foveated ones on other numbers of threads, of which nothing is drawn.
    workers: Vec<(usize, Run)>,
}

/// The rule of a published system, and what its own pack takes whole, where it has its own.
struct PublishedArms {
    run: Run,
    own: Option<Whole>,
}

/// What a pack takes where nothing is chosen by the gaze.
struct Whole {
    viewport: Run,
    full: Run,
    coarsest: Run,
}

impl Whole {
    fn new(conditions: &Conditions<'_>) -> anyhow::Result<Self> {
        // The baselines must decode whatever they take, however late that is.
        let run = |policy| conditions.run(&Way::under(policy), false);
        Ok(Self {
            viewport: run(Policy::Viewport)?,
            full: run(Policy::Full)?,
            coarsest: run(Policy::Coarsest)?,
        })
    }

    fn turn(&mut self, turn: u32) -> anyhow::Result<()> {
        self.viewport.turn(turn.div_ceil(SHARE_OF_VIEWPORT))?;
        self.full.turn(turn.div_ceil(SHARE_OF_FULL))?;
        self.coarsest.turn(turn.div_ceil(SHARE_OF_BEFORE))
    }
}

/// As versions chose that knew no score.
fn before() -> Way {
    Way::of(PolicyConfig {
        acuity: AcuityModel::linear(SLOPE_BEFORE),
        ..PolicyConfig::new(Policy::Acuity)
    })
}

impl Arms {
    /// Plays `frames` foveated ones in each way, and as many of the others as their share is.
    pub(super) fn play(
        conditions: &Conditions<'_>,
        ways: &[Way],
        published: Option<&Published<'_>>,
        workers: &[usize],
        frames: u32,
    ) -> anyhow::Result<Self> {
        let foveated = |way: &Way| Ok((way.clone(), conditions.run(way, true)?));
        let on_workers = |jobs: &usize| {
            let others = Conditions {
                drawing: &DrawDevice::Nothing,
                decoding: Decoding {
                    jobs: *jobs,
                    ..conditions.decoding
                },
                ..conditions.clone()
            };
            Ok((*jobs, others.run(&ways[0], true)?))
        };
        let mut arms = Self {
            foveated: ways.iter().map(foveated).collect::<anyhow::Result<_>>()?,
            before: conditions.run(&before(), true)?,
            whole: Whole::new(conditions)?,
            published: match published {
                Some(Published { way, own, .. }) => Some(PublishedArms {
                    run: own.as_ref().unwrap_or(conditions).run(way, true)?,
                    own: own.as_ref().map(Whole::new).transpose()?,
                }),
                None => None,
            },
            workers: workers
                .iter()
                .map(on_workers)
                .collect::<anyhow::Result<_>>()?,
        };
        let turn = frames.div_ceil(TURNS);
        let all = turn * TURNS;
        let bar = output::bar(Some(u64::from(all)), output::Counting::Frames);
        for done in 0..TURNS {
            if bar.is_hidden() {
                output::say(&format!("{} of {all} frames are played", done * turn));
            }
            for (_, run) in &mut arms.foveated {
                run.turn(turn)?;
            }
            arms.before.turn(turn.div_ceil(SHARE_OF_BEFORE))?;
            arms.whole.turn(turn)?;
            if let Some(PublishedArms { run, own }) = &mut arms.published {
                run.turn(turn)?;
                own.as_mut().map_or(Ok(()), |own| own.turn(turn))?;
            }
            for (_, run) in &mut arms.workers {
                run.turn(turn)?;
            }
            bar.inc(u64::from(turn));
        }
        bar.finish_and_clear();
        Ok(arms)
    }

    /// What they reached.
    pub(super) fn report(
        self,
        conditions: &Conditions<'_>,
        frames: u32,
        original_fps: Option<f64>,
        published: Option<&Published<'_>>,
    ) -> anyhow::Result<Report> {
        let Self {
            foveated,
            before: mut of_before,
            whole,
            published: arms,
            workers,
        } = self;
        let about = conditions.file.pack().description();
        let told = published.zip(arms).map(|(told, arms)| {
            let over = ratio_of(&foveated[0].1, &arms.run);
            published_report(told, arms, (&whole, conditions), over)
        });
        let policies = foveated.into_iter();
        let policies = policies.map(|(way, run)| foveated_report(&way, run, &whole, conditions));
        let policies = policies.collect::<anyhow::Result<Vec<Foveated>>>()?;
        let first = policies[0].clone();
        Ok(Report {
            before: Before {
                slope: SLOPE_BEFORE,
                foveated_fps: fps(&of_before),
                ratio: ratio_of(&of_before, &whole.full),
                pixels_share_mean: of_before.share(),
                gpu_bytes: of_before.gpu_bytes(),
                score: conditions.score(&before())?,
            },
            machine: Machine::here(conditions.drawing.name().to_owned()),
            pack: name_of(conditions.file.path()),
            size_px: about.source.size,
            frames: frames.div_ceil(TURNS) * TURNS,
            turns: TURNS,
            jobs: conditions.decoding.jobs,
            viewport_fps: fps(&whole.viewport),
            full_fps: fps(&whole.full),
            coarsest_fps: fps(&whole.coarsest),
            original_fps,
            ratio_original: original_fps.map(|original| first.foveated_fps / original),
            viewport: Rates::of(&whole.viewport),
            full: Rates::of(&whole.full),
            coarsest: Rates::of(&whole.coarsest),
            first,
            policies: policies.into_iter().map(|it| (it.policy, it)).collect(),
            published: told,
            workers: workers.iter().map(workers_report).collect(),
        })
    }
}

/// What the foveated frames reached that were chosen in one way.
fn foveated_report(
    way: &Way,
    mut run: Run,
    whole: &Whole,
    conditions: &Conditions<'_>,
) -> anyhow::Result<Foveated> {
    let config = &way.config;
    let gpu_bytes = run.gpu_bytes();
    Ok(Foveated {
        policy: config.policy.name(),
        target: config.target,
        slope: match config.acuity {
            AcuityModel::Linear { slope, .. }
                if config.policy == Policy::Acuity && config.target.is_none() =>
            {
                Some(slope)
            }
            _ => None,
        },
        score: conditions.score(way)?,
        decoded_on: DeviceReport::new(run.device_use()),
        foveated_fps: fps(&run),
        ratio: ratio_of(&run, &whole.full),
        ratio_viewport: ratio_of(&run, &whole.viewport),
        foveated: Rates::of(&run),
        parts: Parts::of(&run.frames),
        decodes_per_frame: decodes_per_frame(&run.frames),
        late_frames: run.late,
        incomplete_frames: run.incomplete,
        frames_to_fovea_p95: run.to_fovea_p95(),
        pixels_share_mean: run.share(),
        gpu_bytes,
        gpu_share: gpu_share(gpu_bytes, conditions),
    })
}

/// What decoding takes on so many threads.
fn workers_report((workers, run): &(usize, Run)) -> WorkersReport {
    WorkersReport {
        workers: *workers,
        decode_ms_mean: Parts::of(&run.frames).decode.ms_mean,
        foveated_fps: fps(run),
    }
}

/// What a published rule reached; `ours` is what the pack of ours takes whole, and how it is
/// played.
fn published_report(
    published: &Published<'_>,
    arms: PublishedArms,
    (whole, ours): (&Whole, &Conditions<'_>),
    foveated_over_it: f64,
) -> PublishedReport {
    let PublishedArms { mut run, own } = arms;
    let whole = own.as_ref().unwrap_or(whole);
    let conditions = published.own.as_ref().unwrap_or(ours);
    let gpu_bytes = run.gpu_bytes();
    PublishedReport {
        name: published.system.name(),
        pack: name_of(conditions.file.path()),
        policy: published.way.config.policy.name(),
        score: published.score,
        rates: Rates::of(&run),
        full: Rates::of(&whole.full),
        coarsest: Rates::of(&whole.coarsest),
        ratio: ratio_of(&run, &whole.full),
        foveated_over_it,
        late_frames: run.late,
        incomplete_frames: run.incomplete,
        frames_to_fovea_p95: run.to_fovea_p95(),
        pixels_share_mean: run.share(),
        gpu_bytes,
        gpu_share: gpu_share(gpu_bytes, conditions),
    }
}

/// Of the whole finest level as 8-bit 4:2:0.
fn gpu_share(bytes: u64, conditions: &Conditions<'_>) -> f64 {
    let about = conditions.file.pack().description();
    let surface = about.grid(conditions.screen).surface;
    bytes as f64 / surface.bytes_of_planes() as f64
}

/// Frames a second decoded, the median of all turns.
fn fps(run: &Run) -> f64 {
    Rate::of(&run.decoding).median
}

/// How many times as many that is as another run's, turn by turn.
fn ratio_of(run: &Run, other: &Run) -> f64 {
    let pairs = run.decoding.iter().zip(&other.decoding);
    Rate::of(&pairs.map(|(a, b)| a / b).collect::<Vec<f64>>()).median
}
