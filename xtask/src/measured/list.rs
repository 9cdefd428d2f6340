//! Which figures do the documents state, and which command makes each?

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use serde_json::Value;

use crate::steps::{Outcome, repository_root};

/// Where the figures are.
pub(super) const LIST: &str = "docs/measured.toml";

/// [`LIST`].
pub(super) struct List {
    /// Files that runs read, by name: the commands that make each.
    pub(super) inputs: BTreeMap<String, Vec<String>>,
    pub(super) runs: Vec<Run>,
    pub(super) tables: Vec<Table>,
    pub(super) plots: Vec<Plot>,
    text: String,
}

/// A command and the figures that it prints.
pub(super) struct Run {
    pub(super) name: String,
    pub(super) command: String,
    pub(super) inputs: Vec<String>,
    /// About how long it takes on two cores, its inputs included.
    pub(super) minutes: f64,
    pub(super) needs_gpu: bool,
    /// Variables of the environment that it reads.
    pub(super) needs: Vec<String>,
    /// Whether `make test` repeats it.
    pub(super) sample: bool,
    pub(super) figures: Vec<Figure>,
}

/// A number in the JSON that a command prints.
pub(super) struct Figure {
    /// The name of its run, a dot, and its own.
    pub(super) id: String,
    pub(super) key: String,
    pub(super) value: f64,
    pub(super) tolerance: Tolerance,
}

/// How far a figure may move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tolerance {
    /// Not at all: a count.
    Exact,
    /// By so much, in the figure's own unit: a score.
    By(f64),
    /// By this share of itself.
    Share(f64),
    /// It is a time: it is reported, and never too far.
    Time,
}

/// A part of a document that is written from figures.
pub(super) struct Table {
    pub(super) name: String,
    pub(super) file: String,
    pub(super) text: String,
}

/// A picture of scores over costs.
pub(super) struct Plot {
    pub(super) file: String,
    pub(super) title: String,
    /// Words along the axis of costs.
    pub(super) axis: String,
    /// How the figures of a row end that are its cost and its score, without the hyphen.
    pub(super) x: String,
    pub(super) y: String,
    /// Costs are drawn times this.
    pub(super) factor: f64,
    pub(super) series: Vec<Series>,
}

/// A line of a plot: its name, and how the figures of its points begin.
pub(super) struct Series {
    pub(super) name: String,
    pub(super) rows: Vec<String>,
}

impl List {
    pub(super) fn of_repository() -> Result<Self, String> {
        let path = repository_root().join(LIST);
        let text = fs::read_to_string(path).map_err(|e| format!("{LIST}: {e}"))?;
        Self::parse(text).map_err(|e| format!("{LIST}: {e}"))
    }

    pub(super) fn parse(text: String) -> Result<Self, String> {
        let value: Value = toml::from_str(&text).map_err(|e| e.to_string())?;
        let inputs = value["input"].as_object().into_iter().flatten();
        let inputs = inputs
            .map(|(name, commands)| Ok((name.clone(), words(commands, name)?)))
            .collect::<Result<_, String>>()?;
        let runs = value["run"].as_array().into_iter().flatten();
        let runs: Vec<Run> = runs.map(run).collect::<Result<_, String>>()?;
        let tables = value["table"].as_array().into_iter().flatten();
        let tables = tables.map(table).collect::<Result<_, String>>()?;
        let plots = value["plot"].as_array().into_iter().flatten();
        let plots = plots.map(plot).collect::<Result<_, String>>()?;
        let list = Self {
            inputs,
            runs,
            tables,
            plots,
            text,
        };
        list.check()?;
        Ok(list)
    }

    fn check(&self) -> Outcome {
        let mut seen = BTreeSet::new();
        for figure in self.runs.iter().flat_map(|run| &run.figures) {
            if !seen.insert(&figure.id) {
                return Err(format!("{} stands there twice", figure.id));
            }
        }
        for run in &self.runs {
            let unknown = run.inputs.iter().find(|i| !self.inputs.contains_key(*i));
            if let Some(input) = unknown {
                return Err(format!("{}: no input is called {input}", run.name));
            }
            let is_time = |figure: &Figure| figure.tolerance == Tolerance::Time;
            let asks = run.needs_gpu || !run.needs.is_empty();
            if run.sample && (asks || run.figures.iter().any(is_time)) {
                let name = &run.name;
                return Err(format!("{name}: a sample has no times and needs nothing"));
            }
        }
        Ok(())
    }

    pub(super) fn figure(&self, id: &str) -> Option<&Figure> {
        let mut all = self.runs.iter().flat_map(|run| &run.figures);
        all.find(|figure| figure.id == id)
    }

    /// Documents that have tables.
    pub(super) fn documents(&self) -> BTreeSet<String> {
        self.tables.iter().map(|table| table.file.clone()).collect()
    }

    /// Writes figures that came out, by their ids, into the file, each on the line that names it.
    pub(super) fn take<'a>(&mut self, figures: impl Iterator<Item = (&'a str, f64)>) -> Outcome {
        for (id, now) in figures {
            let (run, name) = id.split_once('.').unwrap_or_default();
            let begins = format!("name = \"{run}\"");
            let key = format!("{name} = {{");
            let mut inside = false;
            let lines = self.text.lines().map(|line| {
                inside = (inside || line == begins) && !line.starts_with("[[");
                match inside && line.starts_with(&key) {
                    true => with_value(line, now),
                    false => line.to_owned(),
                }
            });
            self.text = lines.collect::<Vec<_>>().join("\n") + "\n";
        }
        let path = repository_root().join(LIST);
        fs::write(path, &self.text).map_err(|e| format!("{LIST}: {e}"))
    }
}

/// `line` with another number behind `value =`, rounded to six digits.
fn with_value(line: &str, value: f64) -> String {
    let Some((before, rest)) = line.split_once("value = ") else {
        return line.to_owned();
    };
    let after = rest.find([',', ' ', '}']).map_or("", |end| &rest[end..]);
    let rounded: f64 = match value.fract() == 0.0 {
        true => value,
        false => format!("{value:.5e}").parse().unwrap_or(value),
    };
    format!("{before}value = {rounded}{after}")
}

fn run(value: &Value) -> Result<Run, String> {
    let name = text(value, "name", "a run")?;
    let figures = value["figures"].as_object().into_iter().flatten();
    let figures = figures
        .map(|(key, value)| figure(&name, key, value))
        .collect::<Result<_, String>>()?;
    Ok(Run {
        command: text(value, "command", &name)?,
        inputs: words(&value["inputs"], &name)?,
        needs: words(&value["needs"], &name)?,
        minutes: number(value, "minutes", &name)?,
        needs_gpu: value["gpu"].as_bool().unwrap_or(false),
        sample: value["sample"].as_bool().unwrap_or(false),
        figures,
        name,
    })
}

fn figure(run: &str, name: &str, value: &Value) -> Result<Figure, String> {
    let id = format!("{run}.{name}");
    Ok(Figure {
        key: text(value, "key", &id)?,
        value: number(value, "value", &id)?,
        tolerance: tolerance(&value["tolerance"]).ok_or_else(|| {
            format!("{id}: a tolerance is \"exact\", \"time\", a number, or a share as \"2 %\"")
        })?,
        id,
    })
}

fn tolerance(value: &Value) -> Option<Tolerance> {
    if let Some(number) = value.as_f64() {
        return Some(Tolerance::By(number));
    }
    match value.as_str()? {
        "exact" => Some(Tolerance::Exact),
        "time" => Some(Tolerance::Time),
        share => {
            let percent: f64 = share.strip_suffix('%')?.trim().parse().ok()?;
            Some(Tolerance::Share(percent / 100.0))
        }
    }
}

fn table(value: &Value) -> Result<Table, String> {
    let name = text(value, "name", "a table")?;
    Ok(Table {
        file: text(value, "file", &name)?,
        text: text(value, "text", &name)?,
        name,
    })
}

fn plot(value: &Value) -> Result<Plot, String> {
    let file = text(value, "file", "a plot")?;
    let series = value["series"].as_array().into_iter().flatten();
    let series = series.map(|one| {
        Ok(Series {
            name: text(one, "name", &file)?,
            rows: words(&one["rows"], &file)?,
        })
    });
    Ok(Plot {
        title: text(value, "title", &file)?,
        axis: text(value, "axis", &file)?,
        x: text(value, "x", &file)?,
        y: text(value, "y", &file)?,
        factor: number(value, "factor", &file)?,
        series: series.collect::<Result<_, String>>()?,
        file,
    })
}

fn text(value: &Value, key: &str, owner: &str) -> Result<String, String> {
    let text = value[key].as_str().map(str::to_owned);
    text.ok_or_else(|| format!("{owner} lacks `{key}`"))
}

fn number(value: &Value, key: &str, owner: &str) -> Result<f64, String> {
    let number = value[key].as_f64();
    number.ok_or_else(|| format!("{owner} lacks the number `{key}`"))
}

fn words(value: &Value, owner: &str) -> Result<Vec<String>, String> {
    let words = value.as_array().into_iter().flatten();
    words
        .map(|word| word.as_str().map(str::to_owned))
        .collect::<Option<_>>()
        .ok_or_else(|| format!("{owner}: a list holds what is no text"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\
[input]
a = [\"make a\"]

[[run]]
name = \"one\"
command = \"foveal x --json\"
inputs = [\"a\"]
minutes = 1

[run.figures]
share = { key = \"share\", value = 0.5, tolerance = \"2 %\" }
jod = { key = \"jod\", value = 9, tolerance = 0.05 }
";

    #[test]
    fn a_figure_is_found_by_its_run_and_name_and_keeps_its_tolerance() {
        let list = List::parse(TEXT.to_owned()).unwrap();
        let figure = list.figure("one.share").unwrap();
        assert_eq!(
            (figure.value, figure.tolerance),
            (0.5, Tolerance::Share(0.02))
        );
        assert_eq!(
            list.figure("one.jod").unwrap().tolerance,
            Tolerance::By(0.05)
        );
    }

    #[test]
    fn a_time_is_no_sample_and_an_unknown_input_is_named() {
        let timed = TEXT.replace("0.05 }", "\"time\" }");
        let timed = timed.replace("minutes = 1", "minutes = 1\nsample = true");
        assert!(List::parse(timed).is_err_and(|message| message.contains("no times")));
        let unknown = TEXT.replace("[\"a\"]", "[\"b\"]");
        assert!(List::parse(unknown).is_err_and(|message| message.contains("called b")));
    }

    #[test]
    fn a_value_is_replaced_where_it_stands() {
        let line = "jod = { key = \"jod\", value = 9, tolerance = 0.05 }";
        let expected = "jod = { key = \"jod\", value = 9.12346, tolerance = 0.05 }";
        assert_eq!(with_value(line, 9.123_456_7), expected);
        assert_eq!(
            with_value(line, 1_037_435.0),
            line.replace("9,", "1037435,")
        );
    }
}
