//! Which codec suits a video, and what does each cost?
//!
//! Kastner 2016, figures 5.4 to 5.6 and tables 5.1 and 5.2, for any input.

use crate::commands::demo::machine::Machine;
use crate::commands::evaluate::trial::{Trial, TrialOptions};
use crate::options::policy::CutOptions;
use crate::options::preset::SystemPreset;
use crate::report::output;
use anyhow::{Context, anyhow};
use clap::Args;
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::units::counted;
use foveal_media::prepare::{PrepareSettings, Quality};
use serde::Serialize;

#[derive(Clone, Debug, Args)]
pub(crate) struct CodecsArgs {
    #[command(flatten)]
    trial: TrialOptions,
    #[command(flatten)]
    cut: CutOptions,
    /// A published system whose cut and rule are taken; what is given as well wins.
    #[arg(long, value_enum)]
    preset: Option<SystemPreset>,
    /// Codecs to compare; jpeg90 is JPEG of quality 90.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = parse_coding)]
    #[arg(default_value = "vp8,vp9,h264,hevc,av1,jpeg90,jpeg100,png")]
    codecs: Vec<Coding>,
}

/// A codec under a name.
#[derive(Clone, Debug)]
struct Coding {
    name: String,
    codec: Codec,
    quality: Option<Quality>,
}

#[derive(Debug, Serialize)]
struct Report {
    machine: Machine,
    input: String,
    source_bytes: u64,
    frames: u32,
    codecs: Vec<Row>,
}

#[derive(Debug, Serialize)]
struct Row {
    codec: String,
    /// Bytes of the pack over those of as many frames of the input.
    storage_ratio: f64,
    #[serde(flatten)]
    trial: Trial,
}

pub(super) fn run(args: &CodecsArgs) -> anyhow::Result<()> {
    let jobs = args.trial.jobs()?;
    let input = &args.trial.input;
    let source_bytes = std::fs::metadata(input)
        .with_context(|| format!("{}: cannot be read", input.display()))?
        .len();
    let scratch = args.trial.scratch()?;
    let mut rows = Vec::new();
    for (number, coding) in (1..).zip(&args.codecs) {
        let of = args.codecs.len();
        output::say(&format!("{number} of {of}: {}", coding.name));
        let settings = args.settings(coding, jobs);
        let trial = args.trial.trial(&settings, args.preset, &scratch)?;
        let share = args.share_of_input()?;
        rows.push(Row {
            codec: coding.name.clone(),
            storage_ratio: trial.bytes as f64 / (source_bytes as f64 * share),
            trial,
        });
    }
    let report = Report {
        machine: Machine::here("none".to_owned()),
        input: input.display().to_string(),
        source_bytes,
        frames: rows.first().map_or(0, |row: &Row| row.trial.frames),
        codecs: rows,
    };
    output::result(args.trial.json, &report, &report.text())
}

impl CodecsArgs {
    fn settings(&self, coding: &Coding, jobs: usize) -> PrepareSettings {
        let cut = match self.preset {
            Some(preset) => preset.cut(&self.cut),
            None => self.cut.clone(),
        };
        PrepareSettings {
            cut: cut.asked(),
            levels: cut.levels,
            ratio: cut.ratio(),
            codec: coding.codec,
            quality: coding.quality.clone(),
            jobs,
            most_frames: Some(self.trial.frames),
            ..PrepareSettings::default()
        }
    }

    /// How much of the input its prepared frames are, as far as it says how many there are.
    fn share_of_input(&self) -> anyhow::Result<f64> {
        let info = foveal_media::VideoInput::open(&self.trial.input)?;
        let all = info.info().frames.unwrap_or(0);
        let prepared = u64::from(self.trial.frames);
        Ok(if all > prepared {
            prepared as f64 / all as f64
        } else {
            1.0
        })
    }
}

/// Reads the name of a codec, of JPEG with its quality as `jpeg90`.
fn parse_coding(name: &str) -> anyhow::Result<Coding> {
    let jpeg = name
        .strip_prefix("jpeg")
        .and_then(|quality| quality.parse().ok());
    let named = Codec::ALL.into_iter().find(|codec| codec.name() == name);
    let (codec, quality) = match (jpeg, named) {
        (Some(quality @ 1..=100), _) => (Codec::Jpeg, Some(Quality::Ijg(vec![quality]))),
        (_, Some(codec)) => (codec, None),
        _ => {
            let names = Codec::ALL.map(Codec::name).join(", ");
            return Err(anyhow!("expected one of {names} or jpeg1 to jpeg100"));
        }
    };
    Ok(Coding {
        name: name.to_owned(),
        codec,
        quality,
    })
}

impl Report {
    fn text(&self) -> String {
        let mut text = format!(
            "{}\n{}, {}\n\n\
             {:<8} {:>9} {:>8} {:>10} {:>12} {:>8} {:>8} {:>8} {:>8} {:>8}  bytes a level\n",
            self.machine.text(),
            self.input,
            counted(self.frames, "frame"),
            "codec",
            "prepare s",
            "MPix/s",
            "MB",
            self.codecs.first().map_or("fps", |row| row.trial.policy),
            "saccade",
            "grid",
            "saccade",
            "full",
            "coarsest",
        );
        for Row { codec, trial, .. } in &self.codecs {
            let levels: Vec<String> = trial
                .bytes_per_level
                .iter()
                .map(|bytes| format!("{:.2} MB", *bytes as f64 / 1e6))
                .collect();
            text += &format!(
                "{codec:<8} {:>9.1} {:>8.1} {:>10.2} {:>12.1} {:>8.1} {:>8.1} {:>8.1} {:>8.1} \
                 {:>8.0}  {}\n",
                trial.prepare_s,
                trial.prepare_mpix_per_s,
                trial.bytes as f64 / 1e6,
                trial.foveated_fps_median,
                trial.foveated_saccade_fps_p5,
                trial.grid_fps_median,
                trial.grid_saccade_fps_p5,
                trial.full_fps,
                trial.coarsest_fps,
                levels.join(" / "),
            );
        }
        text
    }
}
