//! What did a source deliver?

use crate::gaze_source::{
    Counts, FIRST_SAMPLE, GazeChoice, GazeSource, Live, LiveChoice, TrackerOptions, ViewerModel,
    interrupted, parse_gaze, read_table, read_trace,
};
use crate::report::output::{self, WrongUsage, out_of_range};
use anyhow::{Context, bail};
use clap::Args;
use foveal_core::gaze::read::row::TraceRow;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::units::{Seconds, counted};
use foveal_core::view::surface::Surface;
use foveal_media::plain_file::rename_durably;
use serde::Serialize;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

#[derive(Clone, Debug, Args)]
pub(crate) struct RecordArgs {
    /// YAW,PITCH in degrees, center, scan, trace:FILE, head:FILE, udp:PORT, ws:URL or osc:PORT.
    #[arg(long, value_name = "G", allow_hyphen_values = true, value_parser = parse_gaze)]
    gaze: GazeChoice,
    #[command(flatten)]
    tracker: TrackerOptions,
    /// The trace to write.
    #[arg(long, value_name = "TRACE.csv")]
    out: PathBuf,
    /// Stop this many seconds after the first sample (default: at Ctrl-C, or where a trace ends).
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    seconds: Option<f64>,
    /// Seed of the scan path.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What was recorded.
#[derive(Debug, Serialize)]
struct Recorded {
    file: String,
    samples: u64,
    valid: u64,
    /// From the first sample to the last.
    seconds: f64,
    /// Null of a recording that is too short to have one.
    rate_hz: Option<f64>,
    /// What the sender's clock said at 0; null of a source that is not live.
    source_start_s: Option<f64>,
    #[serde(flatten)]
    counts: Counts,
}

/// Longest recording in seconds: a day.
const LONGEST_S: f64 = 86_400.0;
/// Recordings of less than this many seconds have no rate.
const SHORTEST_S: f64 = 0.01;
/// Samples per second of a source that has none of its own.
const RATE_HZ: f64 = 100.0;
/// Time between two looks at what came, and between two writes.
const LOOK: Duration = Duration::from_millis(50);

pub(crate) fn run(args: &RecordArgs) -> anyhow::Result<()> {
    let seconds = args.seconds;
    if seconds.is_some_and(|seconds| !(seconds > 0.0 && seconds <= LONGEST_S)) {
        let range = format!("more than 0 and at most {LONGEST_S}");
        bail!(out_of_range(
            "--seconds",
            seconds.unwrap_or_default(),
            &range
        ));
    }
    check_target(args)?;
    let recorded = match &args.tracker.read_as(&args.gaze)? {
        GazeChoice::Live(choice) => record_live(args, choice)?,
        GazeChoice::Table(file, form) => copy(args, read_table(file, form)?.rows(), |row| row)?,
        GazeChoice::Trace(file) => copy(args, read_trace(file)?.rows(), |row| row)?,
        GazeChoice::Head(file) => copy(args, read_trace(file)?.rows(), |row| TraceRow {
            gaze_deg: None,
            valid: false,
            ..row
        })?,
        GazeChoice::At(_) | GazeChoice::Scan => {
            let Some(seconds) = seconds else {
                bail!(WrongUsage(
                    "--seconds is needed: this source never ends".to_owned()
                ));
            };
            let surface = Surface::cube(1);
            let mut source = GazeSource::new(
                &args.gaze,
                &surface,
                args.seed,
                Seconds(seconds),
                &ViewerModel::default(),
            )?;
            let steps = 0..(seconds * RATE_HZ).ceil() as u32;
            let times = steps.map(|step| Seconds(f64::from(step) / RATE_HZ));
            let rows: Vec<TraceRow> = times
                .map(|time| TraceRow::of(&received_at_once(source.look(time).gaze)))
                .collect();
            copy(args, &rows, |row| row)?
        }
    };
    output::result(args.json, &recorded, &recorded.text())
}

/// Refuses, before anything is recorded, a target that cannot be written or would lose something.
fn check_target(args: &RecordArgs) -> anyhow::Result<()> {
    let out = &args.out;
    let name = out.display();
    if out.exists() && !out.is_file() {
        bail!("{name}: is not a plain file; give another --out");
    }
    let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty());
    if folder.is_some_and(|folder| !folder.is_dir()) {
        bail!("{name}: cannot be written: its folder is not there; make it first");
    }
    let growing = growing(out);
    if growing.exists() {
        bail!(
            "{}: holds a recording that was interrupted; rename or remove it first",
            growing.display()
        );
    }
    if let Some(file) = args.gaze.file() {
        output::spare_inputs(out, [file])?;
    }
    Ok(())
}

/// The name under which a recording grows.
fn growing(out: &Path) -> PathBuf {
    let mut growing = out.as_os_str().to_owned();
    growing.push(".partial");
    PathBuf::from(growing)
}

/// A sample of a source that needs no way to come.
fn received_at_once(sample: GazeSample) -> GazeSample {
    GazeSample {
        received: sample.time,
        ..sample
    }
}

/// Writes the rows of a source that is known whole.
fn copy(
    args: &RecordArgs,
    rows: &[TraceRow],
    change: impl Fn(TraceRow) -> TraceRow,
) -> anyhow::Result<Recorded> {
    let start = rows.first().map_or(0.0, |row| row.time.0);
    let end = args
        .seconds
        .map_or(f64::INFINITY, |seconds| start + seconds);
    let mut sink = Sink::create(&args.out)?;
    let kept = rows.iter().take_while(|row| row.time.0 < end);
    sink.write(kept.map(|row| change(*row)))?;
    sink.finish(Counts::default(), None)
}

fn record_live(args: &RecordArgs, choice: &LiveChoice) -> anyhow::Result<Recorded> {
    let interrupted = interrupted()?;
    let live = Live::open(choice)?;
    if !live.wait_for_first(FIRST_SAMPLE, &interrupted)? {
        bail!("--gaze {choice}: interrupted before a gaze came; nothing was written");
    }
    let mut sink = Sink::create(&args.out)?;
    let begun = Instant::now();
    let over = || {
        let elapsed = begun.elapsed().as_secs_f64();
        args.seconds.is_some_and(|seconds| elapsed >= seconds)
    };
    loop {
        // Asked before the last look, so that everything that came until then is written.
        let last = interrupted.load(Ordering::Relaxed) || over();
        sink.write(live.take().into_iter())?;
        if last {
            let start = live.start().map(|start| start.0);
            return sink.finish(live.counts(), start);
        }
        std::thread::sleep(LOOK);
    }
}

/// A trace that grows: under a name of its own until it is whole.
struct Sink {
    path: PathBuf,
    growing: PathBuf,
    file: File,
    samples: u64,
    valid: u64,
    /// Times of the first and the last row.
    span: Option<[f64; 2]>,
}

impl Sink {
    fn create(path: &Path) -> anyhow::Result<Self> {
        let growing = growing(path);
        // Another recording to this name may have begun since it was looked for.
        let created = File::create_new(&growing).and_then(|mut file| {
            file.write_all(TraceRow::header().as_bytes())?;
            Ok(file)
        });
        Ok(Self {
            file: created.with_context(|| cannot_write(&growing))?,
            path: path.to_owned(),
            growing,
            samples: 0,
            valid: 0,
            span: None,
        })
    }

    /// Writes rows through to the file.
    fn write(&mut self, rows: impl Iterator<Item = TraceRow>) -> anyhow::Result<()> {
        let mut text = String::new();
        for row in rows {
            row.write(&mut text);
            self.samples += 1;
            self.valid += u64::from(row.valid);
            let [first, _] = self.span.unwrap_or([row.time.0; 2]);
            self.span = Some([first, row.time.0]);
        }
        let written = self.file.write_all(text.as_bytes());
        written.with_context(|| cannot_write(&self.growing))
    }

    fn finish(self, counts: Counts, source_start_s: Option<f64>) -> anyhow::Result<Recorded> {
        drop(self.file);
        rename_durably(&self.growing, &self.path).with_context(|| {
            let kept = self.growing.display();
            format!("{}; the recording is in {kept}", cannot_write(&self.path))
        })?;
        let seconds = self.span.map_or(0.0, |[first, last]| last - first);
        let steps = self.samples.saturating_sub(1) as f64;
        Ok(Recorded {
            file: self.path.display().to_string(),
            samples: self.samples,
            valid: self.valid,
            seconds,
            rate_hz: (seconds > SHORTEST_S).then(|| steps / seconds),
            source_start_s,
            counts,
        })
    }
}

fn cannot_write(path: &Path) -> String {
    format!("{}: cannot be written", path.display())
}

impl Recorded {
    fn text(&self) -> String {
        format!(
            "{}: {}, {} of them valid, over {:.2} s{}",
            self.file,
            counted(self.samples, "sample"),
            self.valid,
            self.seconds,
            self.rate_hz
                .map_or(String::new(), |hz| format!(" ({hz:.1} Hz)"))
        )
    }
}
