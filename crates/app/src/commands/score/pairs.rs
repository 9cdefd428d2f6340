//! How do all pairs of a table get their scores, whatever one of them does?
//!
//! One row of CSV a pair; what is wrong with a pair is reported in its row, and the others are
//! scored.

use crate::commands::score::args::ScoreArgs;
use crate::commands::score::conditions::{GazeWords, display_of};
use crate::commands::score::frames::is_pack;
use crate::report::output::{self, out_of_range, told};
use anyhow::{Context, bail};
use csv::StringRecord;
use foveal_core::units::counted;
use foveal_eval::score::named_displays::NamedDisplay;
use foveal_media::plain_file::{open_sink, rename_durably};
use serde::Serialize;
use serde_json::Value;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Most pairs of a table.
const MOST_PAIRS: usize = 1_000_000;
/// Columns that every table has.
const FILES: [&str; 2] = ["reference", "test"];
/// Columns that are added, by the names that results have; `shown_on` is the display there.
const ADDED: [&str; 12] = [
    "jod", "value", "unit", "metric", "version", "mode", "shown_on", "ppd", "gaze", "fps",
    "frames", "error",
];

/// What became of a table.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Scored {
    /// How many were scored: all of them.
    pairs: usize,
    /// Where.
    out: PathBuf,
}

impl Scored {
    pub(super) fn text(&self) -> String {
        let pairs = counted(self.pairs, "pair");
        format!("{pairs} scored\n{}", self.out.display())
    }
}

/// Scores the rows of the table `list` and writes them with their scores to `out`, row by row.
pub(super) fn score_pairs(args: &ScoreArgs, list: &Path, out: &Path) -> anyhow::Result<Scored> {
    let table = Table::read(list)?;
    let mut read = vec![list.to_owned()];
    for row in &table.rows {
        read.extend(FILES.iter().filter_map(|column| table.file(row, column)));
    }
    output::spare_inputs(out, read.iter().map(PathBuf::as_path))?;
    if args.display.is_some() || table.no_row_names_a_display() {
        display_of("--display", args.display.as_deref(), None)?;
    }
    let added = || ADDED.into_iter().filter(|column| args.adds(column));
    let mut written = GrowingTable::begin(out)?;
    written.row(table.columns.iter().chain(added()))?;
    let mut failed = 0;
    for row in &table.rows {
        let scored = table.pair(row, args).and_then(|pair| pair.scored());
        failed += usize::from(scored.is_err());
        let found = scored.unwrap_or_else(|error| serde_json::json!({ "error": told(&error) }));
        let kept = (0..table.columns.len()).map(|at| row.get(at).unwrap_or_default().to_owned());
        let found = added().map(|column| {
            let key = if column == "shown_on" {
                "display"
            } else {
                column
            };
            text_of(&found[key])
        });
        written.row(kept.chain(found))?;
    }
    written.finish()?;
    let pairs = table.rows.len();
    if failed > 0 {
        bail!(
            "{}: {failed} of {} could not be scored; see column error of {}",
            list.display(),
            counted(pairs, "pair"),
            out.display()
        );
    }
    Ok(Scored {
        pairs,
        out: out.to_owned(),
    })
}

/// A value of a result as it stands in a table: nothing where there is none.
fn text_of(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

impl ScoreArgs {
    /// Whether results of this measure have a column.
    fn adds(&self, column: &str) -> bool {
        let by_eye = self.metric.companion().is_none();
        match column {
            "jod" => by_eye,
            "value" | "unit" => !by_eye,
            _ => true,
        }
    }

    fn scored(&self) -> anyhow::Result<Value> {
        let (Some(reference), Some(test)) = (&self.reference, &self.test) else {
            bail!("give reference and test");
        };
        Ok(serde_json::to_value(self.score(reference, test)?)?)
    }
}

/// Pairs, as a file names them.
struct Table {
    /// Where names of files begin.
    folder: PathBuf,
    columns: StringRecord,
    rows: Vec<StringRecord>,
}

impl Table {
    fn read(list: &Path) -> anyhow::Result<Self> {
        let name = list.display();
        let text = output::read_text(list, "a table of pairs")?;
        let text = text.trim_start_matches('\u{feff}');
        let mut reader = csv::ReaderBuilder::new()
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let columns = reader.headers().with_context(|| name.to_string())?.clone();
        for wanted in FILES {
            if columns.iter().filter(|column| *column == wanted).count() != 1 {
                bail!("{name}: line 1 needs one column {wanted}; begin it with reference,test");
            }
        }
        if let Some(taken) = ADDED
            .iter()
            .find(|added| columns.iter().any(|c| c == **added))
        {
            bail!("{name}: its column {taken} is one that is added; give it another name");
        }
        let rows: Vec<StringRecord> = reader
            .records()
            .take(MOST_PAIRS + 1)
            .collect::<Result<_, _>>()
            .with_context(|| name.to_string())?;
        if !(1..=MOST_PAIRS).contains(&rows.len()) {
            let found = counted(rows.len(), "row");
            bail!("{name}: {found} below the first; give 1 to {MOST_PAIRS}, one a pair");
        }
        let folder = list.parent().unwrap_or(Path::new("")).to_owned();
        Ok(Self {
            folder,
            columns,
            rows,
        })
    }

    /// Whether every row needs a display, and none says which; packs bring their own.
    fn no_row_names_a_display(&self) -> bool {
        self.rows.iter().all(|row| {
            let reference = self.file(row, FILES[0]);
            self.cell(row, "display").is_none() && !reference.is_some_and(|file| is_pack(&file))
        })
    }

    /// What stands in a column of a row; nothing where that is empty or there is no such column.
    fn cell<'a>(&self, row: &'a StringRecord, column: &str) -> Option<&'a str> {
        let at = self.columns.iter().position(|name| name == column)?;
        row.get(at).filter(|text| !text.is_empty())
    }

    /// A file that a column names.
    fn file(&self, row: &StringRecord, column: &str) -> Option<PathBuf> {
        self.cell(row, column).map(|name| self.folder.join(name))
    }

    /// The command that a row stands for.
    fn pair(&self, row: &StringRecord, args: &ScoreArgs) -> anyhow::Result<ScoreArgs> {
        let line = row.position().map_or(0, csv::Position::line);
        let (found, wanted) = (row.len(), self.columns.len());
        if found != wanted {
            let found = counted(found, "field");
            bail!("line {line} has {found}, line 1 has {wanted}; put names with commas in quotes");
        }
        if row.iter().any(|field| field.contains(char::is_control)) {
            bail!("line {line} holds a line end or another control character; rename the file");
        }
        let file = |column: &str| {
            self.file(row, column)
                .with_context(|| format!("line {line}, column {column}: empty; name a file"))
        };
        let mut pair = ScoreArgs {
            reference: Some(file(FILES[0])?),
            test: Some(file(FILES[1])?),
            ..args.clone()
        };
        let place = self.place(row).with_context(|| format!("line {line}"))?;
        let trace = self.file(row, "gaze_trace");
        if place.is_some() && trace.is_some() {
            bail!("line {line}: has gaze_x and gaze_trace; leave one of them empty");
        }
        if place.is_some() || trace.is_some() {
            (pair.gaze, pair.gaze_trace) = (place.map(GazeWords::at), trace);
        }
        if let Some(choice) = self.cell(row, "display") {
            let described = self.folder.join(choice);
            pair.display = match NamedDisplay::find(choice) {
                None if described.exists() => Some(described.display().to_string()),
                _ => Some(choice.to_owned()),
            };
        }
        Ok(pair)
    }

    /// Where the eye of a row looks, if it says so.
    fn place(&self, row: &StringRecord) -> anyhow::Result<Option<[f64; 2]>> {
        let mut place = [0.0; 2];
        let columns = ["gaze_x", "gaze_y"];
        if columns
            .iter()
            .all(|column| self.cell(row, column).is_none())
        {
            return Ok(None);
        }
        for (place, column) in place.iter_mut().zip(columns) {
            let text = self.cell(row, column).unwrap_or_default();
            let number = text.parse().ok().filter(|number: &f64| number.is_finite());
            *place = number.with_context(|| {
                format!("column {column}: found \"{text}\", expected a finite number of pixels")
            })?;
        }
        Ok(Some(place))
    }
}

/// A table that grows row by row next to its place, and takes it when it is whole: of a run that
/// was stopped the rows so far are in `NAME.partial`.
struct GrowingTable {
    out: PathBuf,
    /// None where rows go to a device or a pipe.
    growing: Option<PathBuf>,
    writer: csv::Writer<File>,
}

impl GrowingTable {
    fn begin(out: &Path) -> anyhow::Result<Self> {
        if out.is_dir() {
            bail!(out_of_range(
                "--out",
                out.display(),
                "the name of a file, not of a folder"
            ));
        }
        let growing = output::growing_name(out);
        let file = match &growing {
            Some(growing) => File::create(growing),
            None => open_sink(out),
        };
        let file = file.with_context(|| cannot_write(out))?;
        Ok(Self {
            out: out.to_owned(),
            growing,
            writer: csv::Writer::from_writer(file),
        })
    }

    fn row(&mut self, cells: impl IntoIterator<Item = impl AsRef<[u8]>>) -> anyhow::Result<()> {
        let written = self.writer.write_record(cells);
        written.with_context(|| cannot_write(&self.out))?;
        let flushed = self.writer.flush();
        flushed.with_context(|| cannot_write(&self.out))
    }

    fn finish(self) -> anyhow::Result<()> {
        match self.growing {
            Some(growing) => {
                let moved = rename_durably(&growing, &self.out);
                moved.with_context(|| cannot_write(&self.out))
            }
            None => Ok(()),
        }
    }
}

fn cannot_write(out: &Path) -> String {
    format!("{}: cannot be written", out.display())
}
