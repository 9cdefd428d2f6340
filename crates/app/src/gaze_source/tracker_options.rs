//! How is the table of an eye tracker read as a gaze?

use crate::gaze_source::choice::GazeChoice;
use crate::report::output::WrongUsage;
use anyhow::{Context, bail};
use clap::Args;
use foveal_core::gaze::read::tracker_table::{TrackerForm, TrackerScreen};

/// Units of time, with what they are called in the names of columns.
const UNITS: [(&str, f64); 6] = [
    ("ms", 1e-3),
    ("us", 1e-6),
    ("µs", 1e-6),
    ("μs", 1e-6),
    ("ns", 1e-9),
    ("s", 1.0),
];

/// Which columns are the gaze of a table that is no trace.
#[derive(Clone, Debug, Args)]
pub(crate) struct TrackerOptions {
    /// Read the table of trace:FILE as a tracker wrote it: the names of its columns of time and of
    /// the gaze on the screen, in pixels to the right and down, as t,x,y. Time is in seconds, or as
    /// the name ends in ms, us or ns, or as t:ms says.
    #[arg(long, value_name = "T,X,Y", value_parser = parse_columns, requires = "gaze_screen")]
    gaze_columns: Option<TimedColumns>,
    /// Size, pixels and distance of the screen that those pixels lie on, as
    /// 0.52x0.29m,1920x1080,0.6m.
    #[arg(long, value_name = "WxHm,WxH,Dm", value_parser = parse_tracker_screen)]
    #[arg(requires = "gaze_columns")]
    gaze_screen: Option<TrackerScreen>,
}

/// The columns of time and of the gaze, and how many seconds a unit of time is.
#[derive(Clone, Debug, PartialEq)]
struct TimedColumns {
    names: [String; 3],
    unit_s: f64,
}

impl TrackerOptions {
    /// The choice, read so.
    pub(crate) fn read_as(&self, choice: &GazeChoice) -> Result<GazeChoice, WrongUsage> {
        let (Some(columns), Some(screen)) = (&self.gaze_columns, self.gaze_screen) else {
            return Ok(choice.clone());
        };
        let form = TrackerForm {
            columns: columns.names.clone(),
            unit_s: columns.unit_s,
            screen,
        };
        match choice {
            GazeChoice::Trace(path) => Ok(GazeChoice::Table(path.clone(), form)),
            _ => Err(WrongUsage(
                "--gaze-columns reads a table; give it as --gaze trace:FILE".to_owned(),
            )),
        }
    }
}

fn parse_columns(text: &str) -> anyhow::Result<TimedColumns> {
    let names: Vec<&str> = text.split(',').map(str::trim).collect();
    let [time, x, y] = names[..] else {
        bail!("expected the names of three columns as t,x,y");
    };
    let told = time
        .rsplit_once(':')
        .and_then(|(name, unit)| Some((name.trim_end(), unit_named(unit.trim())?)));
    let (time, unit_s) = told.unwrap_or_else(|| (time, unit_in(time)));
    if [time, x, y].contains(&"") {
        bail!("expected the names of three columns as t,x,y; one of them is empty");
    }
    if time == x || time == y || x == y {
        bail!("expected the names of three columns as t,x,y; one is named twice");
    }
    Ok(TimedColumns {
        names: [time, x, y].map(str::to_owned),
        unit_s,
    })
}

fn unit_named(text: &str) -> Option<f64> {
    UNITS
        .iter()
        .find_map(|(name, seconds)| (*name == text).then_some(*seconds))
}

/// The unit that the name of a column ends in, as `time_ms` or `Time [ms]`; seconds where it has
/// none.
fn unit_in(name: &str) -> f64 {
    let mut words = name.rsplit(|c: char| !c.is_alphanumeric());
    let last = words.find(|word| !word.is_empty()).unwrap_or_default();
    unit_named(last).unwrap_or(1.0)
}

/// Reads `0.38x0.30m,1024x768,0.67m`: size in metres, size in pixels, distance in metres.
pub(crate) fn parse_tracker_screen(text: &str) -> anyhow::Result<TrackerScreen> {
    let wanted = "expected size, pixels and distance as 0.38x0.30m,1024x768,0.67m";
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let [size, pixels, distance] = parts[..] else {
        bail!("{wanted}");
    };
    let number = |text: &str, most: f64| {
        let number: f64 = text.trim().parse().context(wanted)?;
        if number > 0.0 && number <= most {
            Ok(number)
        } else {
            bail!("{wanted}; {number} is not in 0 to {most}")
        }
    };
    let pair = |text: &str, most: f64| {
        let (a, b) = text.split_once(['x', 'X']).context(wanted)?;
        Ok::<_, anyhow::Error>([number(a, most)?, number(b, most)?])
    };
    let metres = |text| str::strip_suffix(text, "m").context(wanted);
    Ok(TrackerScreen {
        size_m: pair(metres(size)?, 1000.0)?,
        size_px: pair(pixels, 1e6)?,
        distance_m: number(metres(distance)?, 1000.0)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_of_time_is_told_or_stands_in_the_name() {
        for (text, name, unit_s) in [
            ("t,x,y", "t", 1.0),
            ("time_ms,x,y", "time_ms", 1e-3),
            (
                "Recording timestamp [μs],x,y",
                "Recording timestamp [μs]",
                1e-6,
            ),
            (
                "Recording timestamp [µs],x,y",
                "Recording timestamp [µs]",
                1e-6,
            ),
            ("Time:ns,x,y", "Time", 1e-9),
            ("a:b,x,y", "a:b", 1.0),
            ("items,x,y", "items", 1.0),
        ] {
            let columns = parse_columns(text).unwrap();
            assert_eq!(
                (columns.names[0].as_str(), columns.unit_s),
                (name, unit_s),
                "{text}"
            );
        }
        for wrong in ["", "t,x", "t,x,y,z", "t,,y", ":ms,x,y"] {
            assert!(parse_columns(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_screen_has_a_size_pixels_and_a_distance() {
        let screen = parse_tracker_screen("0.38x0.30m,1024x768,0.67m").unwrap();
        assert_eq!(screen.size_m, [0.38, 0.30]);
        assert_eq!((screen.size_px, screen.distance_m), ([1024.0, 768.0], 0.67));
        for bad in [
            "",
            "0.38x0.30m",
            "0.38x0.30,1024x768,0.67m",
            "0x1m,2x2,1m",
            "axbm,2x2,1m",
        ] {
            let error = parse_tracker_screen(bad).unwrap_err().to_string();
            assert!(error.contains("as 0.38x0.30m,1024x768,0.67m"), "{error}");
        }
    }
}
