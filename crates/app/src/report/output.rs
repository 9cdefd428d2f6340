//! How do results and failures reach the caller?
//!
//! Results go to stdout: text for people, or with `--json` exactly one JSON object, also of a
//! failure (docs/formats/results.md). Everything else goes to stderr.

mod old_names;

use crate::report::called::called;
use crate::report::fault::Fault;
pub(crate) use crate::report::fault::told;
use crate::report::visible::{bounded, visible};
use anyhow::{Context, anyhow, bail};
use foveal_core::units::counted;
use foveal_media::plain_file::{open_plain, open_sink, read_plain, rename_durably, rename_new};
use indicatif::{ProgressBar, ProgressStyle};
use old_names::with_old_names;
use serde::Serialize;
use std::borrow::Cow;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether a result was printed; a failure after it is reported on stderr alone.
static PRINTED: AtomicBool = AtomicBool::new(false);

/// Whether a result was printed.
pub(crate) fn has_printed() -> bool {
    PRINTED.load(Ordering::Relaxed)
}

/// Prints `result` as one JSON object, or `text` for people.
pub(crate) fn result(json: bool, result: &impl Serialize, text: &str) -> anyhow::Result<()> {
    let line = if json {
        with_old_names(&called().command, serde_json::to_string(result)?)
    } else {
        visible(text.trim_end()).into_owned()
    };
    PRINTED.store(true, Ordering::Relaxed);
    match writeln!(std::io::stdout(), "{line}") {
        // The reader has seen enough (`foveal info | head`).
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        done => done.context("stdout cannot be written; the work itself is done"),
    }
}

/// Prints a result that is no good, and fails with `error`, which is a part of the JSON object.
pub(crate) fn result_that_fails(
    json: bool,
    result: &impl Serialize,
    text: &str,
    error: anyhow::Error,
) -> anyhow::Result<()> {
    #[derive(Serialize)]
    struct Failed<'a, T> {
        #[serde(flatten)]
        result: &'a T,
        error: Fault,
    }
    let error_parts = Fault::of(&error, called());
    let failed = Failed {
        result,
        error: error_parts,
    };
    if json || !text.is_empty() {
        self::result(json, &failed, text)?;
    }
    Err(error)
}

/// A command line that parses but cannot be meant.
#[derive(Debug)]
pub(crate) struct WrongUsage(pub(crate) String);

impl std::fmt::Display for WrongUsage {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(&self.0)
    }
}

impl std::error::Error for WrongUsage {}

/// The error for an option with this name and value out of `range`.
pub(crate) fn out_of_range(option: &str, found: impl ToString, range: &str) -> WrongUsage {
    WrongUsage(format!("{option} is {}; give {range}", found.to_string()))
}

/// Says why the command failed, under `--json` also on stdout: 2 for wrong usage, 1 for anything
/// else.
pub(crate) fn fail(error: &anyhow::Error) -> ExitCode {
    say(&format!("error: {}", told(error)));
    print_fault(&Fault::of(error, called()));
    ExitCode::from(if error.is::<WrongUsage>() { 2 } else { 1 })
}

/// Says why the command line cannot be read, or gives the help that it asks for.
pub(crate) fn fail_usage(error: &clap::Error) -> ! {
    // Help that was asked for is no failure, and may be of any length.
    if !error.use_stderr() {
        error.exit();
    }
    print_fault(&Fault::of_usage(error, called()));
    let text = error.render().to_string();
    let is_plain = matches!(
        (visible(&text), bounded(&text)),
        (Cow::Borrowed(_), Cow::Borrowed(_))
    );
    if !is_plain {
        say(text.trim_end());
        std::process::exit(error.exit_code());
    }
    error.exit()
}

/// The failure as the one JSON object, where one was asked for and none is there.
fn print_fault(fault: &Fault) {
    #[derive(Serialize)]
    struct Failed<'a> {
        error: &'a Fault,
    }
    if called().json && !PRINTED.load(Ordering::Relaxed) {
        // Where stdout takes nothing, stderr has it.
        let _ = result(true, &Failed { error: fault }, "");
    }
}

/// A line for people on stderr; it may be closed.
pub(crate) fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{}", visible(&bounded(line)));
}

/// Most threads that may be asked for.
const MOST_JOBS: usize = 256;

/// As many threads as asked for, else as many as there are cores.
pub(crate) fn jobs(asked: Option<usize>) -> Result<usize, WrongUsage> {
    match asked {
        Some(jobs) => threads("--jobs", jobs),
        None => Ok(std::thread::available_parallelism().map_or(1, std::num::NonZero::get)),
    }
}

/// As many threads as an option asks for.
pub(crate) fn threads(option: &str, asked: usize) -> Result<usize, WrongUsage> {
    match (1..=MOST_JOBS).contains(&asked) {
        true => Ok(asked),
        false => Err(out_of_range(option, asked, &format!("1 to {MOST_JOBS}"))),
    }
}

/// Longest text file that is read, in bytes.
const MAX_TEXT_BYTES: u64 = 1 << 30;

/// The text of a file that a person named; `what` it should be goes into the message.
pub(crate) fn read_text(path: &Path, what: &str) -> anyhow::Result<String> {
    let unread = || format!("{}: cannot be read as {what}", path.display());
    let bytes = told_apart(read_plain(path, MAX_TEXT_BYTES), (path, what), unread)?;
    String::from_utf8(bytes).map_err(|_| anyhow!("{}: is no text; give {what}", path.display()))
}

/// Longest file of settings, in bytes: its parser keeps some fifty times as many.
const MAX_SETTINGS_BYTES: usize = 1 << 20;

/// The text of a file of settings in TOML.
pub(crate) fn read_settings(path: &Path, what: &str) -> anyhow::Result<String> {
    let text = read_text(path, what)?;
    if text.len() > MAX_SETTINGS_BYTES {
        let (name, bytes) = (path.display(), text.len());
        bail!("{name}: has {bytes} bytes, and {what} at most {MAX_SETTINGS_BYTES}; shorten it");
    }
    Ok(text)
}

/// Opens the file that a person named; `what` it should be goes into the message. A pipe, which
/// may never get a writer, is refused.
pub(crate) fn open_file(path: &Path, what: &str) -> anyhow::Result<File> {
    let missing = || format!("{}: no {what} there", path.display());
    let as_csv = format!("a {what}, as CSV");
    let (file, _) = told_apart(open_plain(path), (path, &as_csv), missing)?;
    Ok(file)
}

/// What was read of a plain file, or what to say where there is something else, or nothing can be
/// read.
fn told_apart<T>(
    read: std::io::Result<T>,
    (path, what): (&Path, &str),
    unread: impl Fn() -> String,
) -> anyhow::Result<T> {
    let name = path.display();
    read.or_else(|error| match error.kind() {
        ErrorKind::IsADirectory => bail!("{name}: is a folder; give the file of {what}"),
        ErrorKind::Other => bail!(
            "{name}: is not a plain file; write what comes through a pipe into a file first, \
             and give {what} as that file"
        ),
        ErrorKind::FileTooLarge => {
            bail!("{name}: is larger than {MAX_TEXT_BYTES} bytes; give {what} that is shorter")
        }
        _ => Err(error).with_context(unread),
    })
}

/// Refuses to write where one of the inputs lies, under whatever name.
pub(crate) fn spare_inputs<'a>(
    out: &Path,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<(), WrongUsage> {
    let growing = growing_name(out).and_then(|growing| growing.canonicalize().ok());
    let written = [out.canonicalize().ok(), growing];
    let is_out = |input: &&Path| {
        input
            .canonicalize()
            .is_ok_and(|input| written.contains(&Some(input)))
    };
    match inputs.into_iter().find(is_out) {
        Some(input) => Err(WrongUsage(format!(
            "{} is what is read, and would be written over; give another place to write to",
            input.display()
        ))),
        None => Ok(()),
    }
}

/// Where a file grows that takes its own name when it is whole; `None` of a device or a pipe, which
/// takes bytes as they come: a rename would put a file in its place.
pub(crate) fn growing_name(path: &Path) -> Option<PathBuf> {
    let there = std::fs::metadata(path);
    if there.is_ok_and(|there| !there.is_file() && !there.is_dir()) {
        return None;
    }
    let mut growing = path.as_os_str().to_owned();
    growing.push(".partial");
    Some(growing.into())
}

/// Writes a file whole or not at all, and to the disk.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    write_as(path, bytes, rename_durably)
}

/// The same for the one file that a command was asked for; says what it replaces.
pub(crate) fn write_out(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    say_replaced(path);
    write_whole(path, bytes)
}

/// Says that an older file is written over, where there is one.
pub(crate) fn say_replaced(path: &Path) {
    if path.metadata().is_ok_and(|there| there.is_file()) {
        say(&format!(
            "{}: an older file is written over",
            path.display()
        ));
    }
}

/// [`write_whole`] for one of many, such as the pictures of a run, which the system may write when
/// it likes.
pub(crate) fn write_soon(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    write_as(path, bytes, |from, to| std::fs::rename(from, to))
}

/// Writes a file whole or not at all, and replaces nothing.
pub(crate) fn write_new(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let name = path.display();
    let mut growing = path.as_os_str().to_owned();
    growing.push(".partial");
    let growing = PathBuf::from(growing);
    let begun = File::create_new(&growing);
    let mut file = begun.with_context(|| format!("{}: cannot be written", growing.display()))?;
    let written = file
        .write_all(bytes)
        .and_then(|()| rename_new(&growing, path));
    if written.is_err() {
        let _ = std::fs::remove_file(&growing);
    }
    written.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => anyhow!(
            "{name}: is there already, and nothing is replaced; give another name or folder, or \
             move it away"
        ),
        _ => anyhow!(error).context(format!("{name}: cannot be written")),
    })
}

fn write_as(
    path: &Path,
    bytes: &[u8],
    rename: impl FnOnce(&Path, &Path) -> std::io::Result<()>,
) -> anyhow::Result<()> {
    let Some(growing) = growing_name(path) else {
        let written = open_sink(path).and_then(|mut sink| sink.write_all(bytes));
        return written.with_context(|| format!("{}: cannot be written", path.display()));
    };
    let written = std::fs::write(&growing, bytes).and_then(|()| rename(&growing, path));
    if written.is_err() {
        let _ = std::fs::remove_file(&growing);
    }
    written.with_context(|| format!("{}: cannot be written", path.display()))
}

/// Bytes with the unit that leaves digits to read.
pub(crate) fn size(bytes: u64) -> String {
    match bytes {
        0..100_000 => format!("{:.2} kB", bytes as f64 / 1e3),
        _ => format!("{:.2} MB", bytes as f64 / 1e6),
    }
}

/// Says how much was fetched again; nothing where nothing was.
pub(crate) fn refetched(bytes: u64) -> String {
    match bytes {
        0 => String::new(),
        _ => format!(
            "{} fetched again: more than a client holds in memory\n",
            size(bytes)
        ),
    }
}

/// Says that units were left out for lack of GPU memory; nothing where none was.
pub(crate) fn without_room(units: usize) -> String {
    match units {
        0 => String::new(),
        _ => format!(
            "{} had no room on the GPU, and coarser ones stood in: a larger --gpu-memory shows \
             more\n",
            counted(units, "unit")
        ),
    }
}

/// What a progress bar counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Counting {
    Frames,
    Bytes,
    Steps,
}

/// A progress bar with rate and time left on a terminal; silent in a pipe. Without a length it
/// counts up.
pub(crate) fn bar(length: Option<u64>, counting: Counting) -> ProgressBar {
    let bar = match length {
        Some(length) => ProgressBar::new(length),
        None => ProgressBar::no_length(),
    };
    let template = match (counting, length) {
        (Counting::Frames, Some(_)) => "{wide_bar} frame {pos} of {len}, {per_sec}, {eta} left",
        (Counting::Frames, None) => "{spinner} frame {pos}, {per_sec}",
        (Counting::Steps, _) => "{wide_bar} step {pos} of {len}, {elapsed} so far",
        (Counting::Bytes, _) => "{wide_bar} {bytes}/{total_bytes}, {bytes_per_sec}, {eta} left",
    };
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
