//! What does a file of labelled gaze say?
//!
//! CSV with a header line, in one of two forms, columns in any order, others ignored:
//! `x_deg, y_deg, valid, event` (1000 samples a second, x to the right, y up), or
//! `trial, fs_hz, i, x_px, y_px` with one column `coder_NAME` per coder (0,0 is lost signal; `i`
//! counts the samples of a trial; y down, from the upper left). Labels are 0 undefined,
//! 1 fixation, 2 saccade, 3 post-saccadic oscillation, 4 pursuit, 5 blink, 6 undefined too.

use super::recording::{Label, Recording, Trial};
pub use foveal_core::gaze::read::tracker_table::TrackerScreen as LabelScreen;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::units::{Radians, Seconds};
use glam::DVec3;
use std::io::{BufRead, Read};
use thiserror::Error;

/// Longest line that is read, in bytes.
const MAX_LINE_BYTES: u64 = 64 * 1024;
/// Most rows that are read: an hour and more at 1000 Hz.
const MAX_ROWS: usize = 5_000_000;
/// Rate of files in degrees, which do not say it.
const DEGREES_RATE_HZ: f64 = 1000.0;
/// Lowest and highest rate in Hz.
const RATE_HZ: [f64; 2] = [10.0, 5000.0];
/// Largest sample index of a trial.
const MAX_INDEX: f64 = 1e9;
/// Start of the name of a coder's column.
const CODER: &str = "coder_";

/// Why a file is no labelled recording.
#[derive(Debug, Error)]
pub enum LabelledError {
    /// It cannot be read.
    #[error("{file}, line {line}: cannot be read: {cause}")]
    Read {
        /// The file.
        file: String,
        /// Line in the file, from 1.
        line: usize,
        /// What the system says.
        cause: std::io::Error,
    },
    /// A line that no table has.
    #[error("{file}, line {line}: longer than {MAX_LINE_BYTES} bytes; give a CSV table")]
    LongLine {
        /// The file.
        file: String,
        /// Line in the file, from 1.
        line: usize,
    },
    /// Columns are missing.
    #[error(
        "{file}, line 1: the header lacks {missing}; it must name x_deg, y_deg, valid, event, or \
         trial, fs_hz, i, x_px, y_px and a coder_NAME for each coder"
    )]
    Header {
        /// The file.
        file: String,
        /// The first column that is missing.
        missing: String,
    },
    /// Pixels without a screen.
    #[error(
        "{file}, line 1: x_px and y_px need the screen; give --screen 0.38x0.30m,1024x768,0.67m"
    )]
    NoScreen {
        /// The file.
        file: String,
    },
    /// A value that cannot be.
    #[error("{file}, line {line}, column {column}: found \"{found}\", expected {expected}")]
    Value {
        /// The file.
        file: String,
        /// Line in the file, from 1.
        line: usize,
        /// Name of the column.
        column: String,
        /// What stands there.
        found: String,
        /// What should.
        expected: String,
    },
    /// Nothing but a header.
    #[error("{file}: no rows after the header; give at least one sample")]
    Empty {
        /// The file.
        file: String,
    },
    /// Too long.
    #[error("{file}, line {line}: more than {MAX_ROWS} rows; cut the file")]
    TooLong {
        /// The file.
        file: String,
        /// Line in the file, from 1.
        line: usize,
    },
}

/// Reads a labelled recording. `name` is the file's, for messages; `screen` is needed for pixels.
/// Memory is bounded by the rows that are kept, whatever the length of a line.
pub fn read_labelled(
    name: &str,
    input: &mut impl BufRead,
    screen: Option<&LabelScreen>,
) -> Result<Recording, LabelledError> {
    let file = || name.to_owned();
    let mut lines = Lines {
        file: name,
        input,
        line: 0,
        text: Vec::new(),
    };
    let header = lines.next()?.unwrap_or_default().to_owned();
    let form = Form::of(&header, name, screen)?;
    let mut recording = Recording {
        name: file(),
        coders: form.coders.iter().map(|(_, coder)| coder.clone()).collect(),
        trials: Vec::new(),
    };
    let (mut rows, mut place) = (0, None);
    loop {
        let line = lines.line + 1;
        let Some(text) = lines.next()? else { break };
        if text.trim().is_empty() {
            continue;
        }
        rows += 1;
        if rows > MAX_ROWS {
            return Err(LabelledError::TooLong { file: file(), line });
        }
        let fields = text.split(',').map(str::trim).collect();
        let row = Row {
            file: name,
            line,
            fields,
            form: &form,
        };
        place = Some(row.add_to(&mut recording, place, rows - 1)?);
    }
    if rows == 0 {
        return Err(LabelledError::Empty { file: file() });
    }
    Ok(recording)
}

/// Takes any bytes for a labelled file in either form: the body of the fuzz target. Returns whether
/// they were one.
///
/// # Panics
/// When what was read is no recording: labels that do not go with samples, a gaze that is no
/// direction, a time that does not grow.
#[must_use]
pub fn parse_anything(data: &[u8]) -> bool {
    let screen = LabelScreen {
        size_m: [0.38, 0.30],
        size_px: [1024.0, 768.0],
        distance_m: 0.67,
    };
    let Ok(recording) = read_labelled("fuzz.csv", &mut &*data, Some(&screen)) else {
        return false;
    };
    for trial in &recording.trials {
        let samples = &trial.samples;
        assert_eq!(trial.labels.len(), recording.coders.len(), "coders");
        let counts = trial.labels.iter().map(Vec::len);
        assert!(counts.eq(recording.coders.iter().map(|_| samples.len())));
        let directions = samples.iter().map(|s| s.gaze_in_content.length());
        directions.for_each(|length| assert!((length - 1.0).abs() < 1e-9, "{length}"));
        let grows = |pair: &[GazeSample]| pair[0].time < pair[1].time;
        assert!(samples.windows(2).all(grows), "time");
    }
    true
}

/// Lines of bounded length.
struct Lines<'a, R> {
    file: &'a str,
    input: &'a mut R,
    line: usize,
    text: Vec<u8>,
}

impl<R: BufRead> Lines<'_, R> {
    fn next(&mut self) -> Result<Option<&str>, LabelledError> {
        self.line += 1;
        self.text.clear();
        let (file, line) = (self.file.to_owned(), self.line);
        let mut bounded = self.input.take(MAX_LINE_BYTES + 1);
        match bounded.read_until(b'\n', &mut self.text) {
            Err(cause) => Err(LabelledError::Read { file, line, cause }),
            Ok(0) => Ok(None),
            Ok(_) if self.text.len() as u64 > MAX_LINE_BYTES => {
                Err(LabelledError::LongLine { file, line })
            }
            Ok(_) => core::str::from_utf8(&self.text).map(Some).map_err(|_| {
                let cause = std::io::Error::other("it is no text in UTF-8");
                LabelledError::Read { file, line, cause }
            }),
        }
    }
}

/// Columns in degrees and in pixels, in the order that rows are read in.
const DEGREES: [&str; 4] = ["x_deg", "y_deg", "valid", "event"];
const PIXELS: [&str; 5] = ["x_px", "y_px", "trial", "fs_hz", "i"];

/// Where a file has its columns.
struct Form {
    screen: Option<LabelScreen>,
    /// Places of [`DEGREES`] or, with a screen, of [`PIXELS`].
    places: Vec<usize>,
    /// Places and names of the coders' columns.
    coders: Vec<(usize, String)>,
}

impl Form {
    fn of(header: &str, file: &str, screen: Option<&LabelScreen>) -> Result<Self, LabelledError> {
        let found: Vec<&str> = header
            .trim_start_matches('\u{feff}')
            .split(',')
            .map(str::trim)
            .collect();
        let in_pixels = found.iter().any(|name| PIXELS.contains(name));
        let wanted: &[&str] = if in_pixels { &PIXELS } else { &DEGREES };
        let lacks = |missing: &str| LabelledError::Header {
            file: file.to_owned(),
            missing: missing.to_owned(),
        };
        let place = |name: &&str| {
            found
                .iter()
                .position(|f| f == name)
                .ok_or_else(|| lacks(name))
        };
        let places = wanted.iter().map(place).collect::<Result<Vec<_>, _>>()?;
        if !in_pixels {
            let coders = vec![(places[3], "event".to_owned())];
            return Ok(Self {
                screen: None,
                places,
                coders,
            });
        }
        let coder = |(k, name): (usize, &&str)| Some((k, name.strip_prefix(CODER)?.to_owned()));
        let coders: Vec<_> = found.iter().enumerate().filter_map(coder).collect();
        if coders.is_empty() {
            return Err(lacks("coder_NAME"));
        }
        let screen = screen.ok_or_else(|| LabelledError::NoScreen {
            file: file.to_owned(),
        })?;
        Ok(Self {
            screen: Some(*screen),
            places,
            coders,
        })
    }
}

/// Trial and index of a row.
type Place = (String, f64);

struct Row<'a> {
    file: &'a str,
    line: usize,
    fields: Vec<&'a str>,
    form: &'a Form,
}

impl Row<'_> {
    /// Appends this row; returns where in the file's trials it lies.
    fn add_to(
        &self,
        recording: &mut Recording,
        before: Option<Place>,
        row: usize,
    ) -> Result<Place, LabelledError> {
        let (place, rate_hz, direction) = match &self.form.screen {
            None => self.degrees(row)?,
            Some(screen) => self.pixels(screen)?,
        };
        let same = before.as_ref().is_some_and(|before| before.0 == place.0);
        if !same {
            let labels = vec![Vec::new(); self.form.coders.len()];
            recording.trials.push(Trial {
                rate_hz,
                samples: Vec::new(),
                labels,
            });
        }
        let Some(trial) = recording.trials.last_mut() else {
            return Ok(place);
        };
        if trial.rate_hz != rate_hz {
            let expected = format!("{} as in the rest of the trial", trial.rate_hz);
            return Err(self.wrong(self.form.places[3], expected));
        }
        if let Some((_, index)) = before.filter(|(_, index)| same && place.1 <= *index) {
            let expected = format!("more than {index}: time must grow within a trial");
            return Err(self.wrong(self.form.places[4], expected));
        }
        let time = Seconds(place.1 / rate_hz);
        let known = trial
            .samples
            .last()
            .map_or(DVec3::NEG_Z, |last| last.gaze_in_content);
        trial.samples.push(GazeSample {
            gaze_in_content: direction.unwrap_or(known),
            valid: direction.is_some(),
            ..GazeSample::at(time, Radians(0.0), Radians(0.0))
        });
        for (coder, labels) in self.form.coders.iter().zip(&mut trial.labels) {
            labels.push(self.label(coder.0)?);
        }
        Ok(place)
    }

    fn degrees(&self, row: usize) -> Result<(Place, f64, Option<DVec3>), LabelledError> {
        let valid = self.number(self.form.places[2], [0.0, 1.0], "0 or 1")? > 0.5;
        let angle = |k: usize| self.number(self.form.places[k], [-90.0, 90.0], "degrees");
        let direction = if valid {
            let [yaw, pitch] = [angle(0)?, angle(1)?].map(Radians::from_degrees);
            Some(GazeSample::at(Seconds(0.0), yaw, pitch).gaze_in_content)
        } else {
            None
        };
        Ok(((String::new(), row as f64), DEGREES_RATE_HZ, direction))
    }

    fn pixels(&self, screen: &LabelScreen) -> Result<(Place, f64, Option<DVec3>), LabelledError> {
        let places = &self.form.places;
        let pixel = |k: usize| self.number(places[k], [-1e5, 1e5], "pixels");
        let at = [pixel(0)?, pixel(1)?];
        let trial = self.field(places[2]).to_owned();
        let rate_hz = self.number(places[3], RATE_HZ, "10 to 5000 samples a second")?;
        let index = self.number(places[4], [0.0, MAX_INDEX], "the number of the sample")?;
        let direction = (at != [0.0, 0.0]).then(|| screen.direction(at));
        Ok(((trial, index), rate_hz, direction))
    }

    fn label(&self, place: usize) -> Result<Label, LabelledError> {
        let expected = "a label: 0, 1, 2, 3, 4, 5 or 6";
        let code = self.number(place, [0.0, 6.0], expected)?;
        match code as u8 {
            _ if code.fract() != 0.0 => Err(self.wrong(place, expected)),
            1 => Ok(Label::Fixation),
            2 => Ok(Label::Saccade),
            3 => Ok(Label::Oscillation),
            4 => Ok(Label::Pursuit),
            5 => Ok(Label::Blink),
            _ => Ok(Label::Undefined),
        }
    }

    fn field(&self, place: usize) -> &str {
        self.fields.get(place).copied().unwrap_or_default()
    }

    fn number(
        &self,
        place: usize,
        [least, most]: [f64; 2],
        what: &str,
    ) -> Result<f64, LabelledError> {
        match self.field(place).parse::<f64>() {
            Ok(value) if (least..=most).contains(&value) => Ok(value),
            _ => Err(self.wrong(place, what)),
        }
    }

    fn wrong(&self, place: usize, expected: impl Into<String>) -> LabelledError {
        let names: &[&str] = if self.form.screen.is_some() {
            &PIXELS
        } else {
            &DEGREES
        };
        let known = self
            .form
            .places
            .iter()
            .position(|&p| p == place)
            .map(|k| names[k].to_owned());
        let coder = self.form.coders.iter().find(|(p, _)| *p == place);
        let column = known.or(coder.map(|(_, name)| format!("{CODER}{name}")));
        LabelledError::Value {
            file: self.file.to_owned(),
            line: self.line,
            column: column.unwrap_or_default(),
            found: self.field(place).to_owned(),
            expected: expected.into(),
        }
    }
}

#[cfg(test)]
mod tests;
