//! `foveal gaze classify`: what does the eye do at every sample of a trace?

use crate::commands::gaze::labelled_file::read_recording;
use crate::gaze_source::{
    GazeChoice, TrackerOptions, parse_tracker_screen, read_table, read_trace,
};
use crate::report::output::{self, open_file};
use anyhow::Context;
use clap::Args;
use foveal_core::gaze::saccade::{SaccadeConfig, SaccadeDetector};
use foveal_core::gaze::sample::{EyeEvent, GazeSample};
use foveal_core::units::{Seconds, counted};
use foveal_eval::gaze::labelled::LabelScreen;
use serde::Serialize;
use std::fmt::Write;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// What is labelled.
#[derive(Debug, Args)]
pub(crate) struct ClassifyArgs {
    /// A gaze trace (t_s, yaw_deg, pitch_deg), or a labelled recording, whose labels are ignored.
    trace: PathBuf,
    /// Write a table of t_s and event.
    #[arg(long, value_name = "FILE.csv")]
    out: Option<PathBuf>,
    /// Labelled recordings in pixels: size, pixels and distance of the screen.
    #[arg(long, value_name = "WxHm,WxH,Dm", value_parser = parse_tracker_screen)]
    screen: Option<LabelScreen>,
    #[command(flatten)]
    tracker: TrackerOptions,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Samples by event, and how many saccades they make.
#[derive(Clone, Copy, Debug, Default, Serialize)]
struct Counts {
    samples: usize,
    fixation: usize,
    saccade: usize,
    blink: usize,
    lost: usize,
    saccades: usize,
}

/// Runs the command.
pub(crate) fn run(args: &ClassifyArgs) -> anyhow::Result<()> {
    if let Some(out) = &args.out {
        output::spare_inputs(out, [args.trace.as_path()])?;
    }
    let trace = GazeChoice::Trace(args.trace.clone());
    let trials = match args.tracker.read_as(&trace)? {
        GazeChoice::Table(path, form) => vec![read_table(&path, &form)?.samples().to_vec()],
        _ => read_trials(&args.trace, args.screen.as_ref())?,
    };
    let mut counts = Counts::default();
    let mut table = "t_s,event\n".to_owned();
    tell_too_fast(&args.trace, &trials);
    for samples in &trials {
        let mut detector = SaccadeDetector::default();
        let mut jumping = false;
        for sample in samples {
            // In the head's space a turning head is not mistaken for a moving eye.
            let gaze = sample.gaze_in_content;
            let gaze = sample
                .head
                .map_or(gaze, |head| head.head_from_content(gaze));
            let said = detector.next(sample.time, gaze, sample.valid);
            counts.add(said.event, jumping);
            jumping = said.event == EyeEvent::Saccade;
            let Seconds(time) = sample.time;
            let _ = writeln!(table, "{time},{}", name(said.event));
        }
    }
    if let Some(out) = &args.out {
        output::write_out(out, table.as_bytes())?;
    }
    output::result(args.json, &counts, &text(&counts))
}

/// Says where the gaze jumps faster than an eye can: that is no saccade, but a tracker that has
/// lost the pupil, or a made trace.
fn tell_too_fast(trace: &Path, trials: &[Vec<GazeSample>]) {
    let fastest = SaccadeConfig::default().fastest;
    let jumps = |pair: &&[GazeSample]| {
        let [from, to] = [0, 1].map(|k| pair[k].gaze_in_content);
        let seconds = pair[1].time.0 - pair[0].time.0;
        let both = pair[0].valid && pair[1].valid;
        both && from.angle_between(to).to_degrees() > fastest * seconds
    };
    let pairs = trials.iter().flat_map(|samples| samples.windows(2));
    let count = pairs.filter(jumps).count() as u64;
    if count > 0 {
        output::say(&format!(
            "{}: {} faster than {fastest}°/s, which no eye makes; what follows counts as blink",
            trace.display(),
            counted(count, "jump"),
        ));
    }
}

impl Counts {
    fn add(&mut self, event: EyeEvent, jumping: bool) {
        self.samples += 1;
        match event {
            EyeEvent::Fixation => self.fixation += 1,
            EyeEvent::Saccade => self.saccade += 1,
            EyeEvent::Blink => self.blink += 1,
            EyeEvent::Lost => self.lost += 1,
        }
        self.saccades += usize::from(event == EyeEvent::Saccade && !jumping);
    }
}

fn name(event: EyeEvent) -> &'static str {
    match event {
        EyeEvent::Fixation => "fixation",
        EyeEvent::Saccade => "saccade",
        EyeEvent::Blink => "blink",
        EyeEvent::Lost => "lost",
    }
}

fn text(counts: &Counts) -> String {
    let row = |name: &str, count: usize| {
        let share = 100.0 * count as f64 / counts.samples.max(1) as f64;
        format!(
            "{name:<9} {:>17} {share:>6.1} %\n",
            counted(count, "sample")
        )
    };
    [
        row("fixation", counts.fixation),
        row("saccade", counts.saccade),
        row("blink", counts.blink),
        row("lost", counts.lost),
        format!(
            "{} in {}\n",
            counted(counts.saccades, "saccade"),
            counted(counts.samples, "sample")
        ),
    ]
    .concat()
}

/// Longest header that is looked at, in bytes.
const MAX_HEADER_BYTES: u64 = 64 * 1024;

/// The samples of a trace, or of each trial of a labelled recording.
fn read_trials(path: &Path, screen: Option<&LabelScreen>) -> anyhow::Result<Vec<Vec<GazeSample>>> {
    let name = path.display();
    let file = open_file(path, "gaze trace")?;
    let mut header = Vec::new();
    let mut start = BufReader::new(file).take(MAX_HEADER_BYTES);
    start
        .read_until(b'\n', &mut header)
        .with_context(|| format!("{name}: cannot be read"))?;
    let header = String::from_utf8_lossy(&header);
    let has = |column: &str| header.split(',').any(|found| found.trim() == column);
    if has("event") || has("x_px") {
        let recording = read_recording(path, screen)?;
        return Ok(recording
            .trials
            .into_iter()
            .map(|trial| trial.samples)
            .collect());
    }
    Ok(vec![read_trace(path)?.samples().to_vec()])
}
