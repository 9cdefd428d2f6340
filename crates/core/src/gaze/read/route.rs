//! What does a recorded route through a scene say?
//!
//! CSV with a header line: `t_s, x, y, z, yaw_deg, pitch_deg` and optionally `roll_deg`, in any
//! order; other columns are ignored. Normative: docs/formats/gaze.md.

use crate::gaze::read::trace::{MAX_LINE_BYTES, TraceError};
use crate::units::{Radians, Seconds};
use crate::view::route::{Route, Waypoint};
use glam::DVec3;

/// The columns; all but the last are needed.
const COLUMNS: [&str; 7] = ["t_s", "x", "y", "z", "yaw_deg", "pitch_deg", "roll_deg"];
/// The largest number that a cell may hold.
const LARGEST: f64 = 1e12;
/// Most rows of a route.
const MOST_ROWS: usize = 1_000_000;

/// Reads a route.
///
/// # Errors
/// Says in which line and column something else stands than what is expected.
///
/// ```
/// use foveal_core::gaze::read::route::parse_route;
/// let route = "t_s,x,y,z,yaw_deg,pitch_deg\n0,0,1.6,3,0,0\n4,0,1.6,1,0,-20\n";
/// assert!(parse_route(route).is_ok());
/// assert!(parse_route("t_s,x\n0,1\n").is_err());
/// ```
pub fn parse_route(text: &str) -> Result<Route, TraceError> {
    let mut lines = (1..).zip(text.lines());
    let (_, header) = lines.next().ok_or(TraceError::Header(COLUMNS[0]))?;
    let names: Vec<&str> = header
        .trim_start_matches('\u{feff}')
        .split(',')
        .map(str::trim)
        .collect();
    let place = COLUMNS.map(|column| names.iter().position(|name| *name == column));
    let missing = place[..6].iter().position(Option::is_none);
    if let Some(missing) = missing {
        return Err(TraceError::Header(COLUMNS[missing]));
    }
    let mut waypoints: Vec<Waypoint> = Vec::new();
    for (line, text) in lines.filter(|(_, text)| !text.trim().is_empty()) {
        if text.len() > MAX_LINE_BYTES {
            return Err(TraceError::LongLine(line));
        }
        if waypoints.len() == MOST_ROWS {
            return Err(TraceError::TooLong(line));
        }
        let waypoint = waypoint(line, text, &place)?;
        if let Some(before) = waypoints.last().filter(|it| waypoint.time <= it.time) {
            return Err(TraceError::Backwards {
                line,
                found: waypoint.time.0.to_string(),
                before: before.time.0.to_string(),
            });
        }
        waypoints.push(waypoint);
    }
    match waypoints.is_empty() {
        true => Err(TraceError::Empty),
        false => Ok(Route::Along(waypoints)),
    }
}

fn waypoint(line: usize, text: &str, place: &[Option<usize>; 7]) -> Result<Waypoint, TraceError> {
    let cells: Vec<&str> = text.split(',').map(str::trim).collect();
    let number = |column: usize| {
        let Some(place) = place[column] else {
            return Ok(0.0);
        };
        let cell = cells.get(place).copied().unwrap_or_default();
        let number = cell.parse::<f64>().ok();
        number
            .filter(|it| it.abs() <= LARGEST)
            .ok_or(TraceError::Value {
                line,
                column: COLUMNS[column],
                found: cell.chars().take(40).collect(),
                expected: "a number of at most 1e12",
            })
    };
    Ok(Waypoint {
        time: Seconds(number(0)?),
        position: DVec3::new(number(1)?, number(2)?, number(3)?),
        turn: [number(4)?, number(5)?, number(6)?].map(Radians::from_degrees),
    })
}

/// Takes any bytes for a route: the body of the fuzz target. Returns whether they were one.
#[must_use]
pub fn parse_anything(data: &[u8]) -> bool {
    core::str::from_utf8(data).is_ok_and(|text| parse_route(text).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        parse_route(text).unwrap_err().to_string()
    }

    #[test]
    fn what_is_no_route_is_refused_with_its_place() {
        let head = "t_s,x,y,z,yaw_deg,pitch_deg\n";
        assert!(error("").contains("t_s"));
        assert!(error("t_s,x,y,yaw_deg,pitch_deg\n0,0,0,0,0\n").contains("it lacks z"));
        assert!(error(head).contains("no rows"));
        let wrong = error(&format!("{head}0,0,0,0,0,0\n1,0,up,0,0,0\n"));
        assert!(
            wrong.starts_with("line 3, column y: found \"up\""),
            "{wrong}"
        );
        assert!(error(&format!("{head}1,0,0,0,0,0\n1,0,0,0,0,0\n")).contains("not after 1"));
        assert!(error(&format!("{head}0,0,nan,0,0,0\n")).contains("column y"));
        assert!(error(&format!("{head}0,0,0\n")).contains("column z"));
    }
}
