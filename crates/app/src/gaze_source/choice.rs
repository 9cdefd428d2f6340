//! What does `--gaze` say?

use crate::options::policy::parse_pair;
use anyhow::{Context, anyhow, bail};
use foveal_core::gaze::read::tracker_table::TrackerForm;
use std::fmt;
use std::path::{Path, PathBuf};

/// What `--gaze` may be, for help and messages.
const FORMS: &str = "YAW,PITCH in degrees, center, scan, trace:FILE, head:FILE, udp:PORT, ws:URL \
                     or osc:PORT";

/// What `--gaze` was given.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum GazeChoice {
    /// Yaw to the right and pitch up, in degrees.
    At([f64; 2]),
    /// A simulated scan path.
    Scan,
    /// A recorded trace.
    Trace(PathBuf),
    /// The table of an eye tracker, as it wrote it.
    Table(PathBuf, TrackerForm),
    /// The head of a recorded trace.
    Head(PathBuf),
    /// The present sender.
    Live(LiveChoice),
}

impl GazeChoice {
    /// The file that it is read from, if any.
    pub(crate) fn file(&self) -> Option<&Path> {
        match self {
            Self::Trace(path) | Self::Table(path, _) | Self::Head(path) => Some(path),
            Self::At(_) | Self::Scan | Self::Live(_) => None,
        }
    }

    /// What a judge calls the gaze by which it judged: of a live eye only what was expected is
    /// known.
    pub(crate) fn as_judged(&self) -> String {
        match self {
            Self::At([yaw, pitch]) => format!("true gaze of the run ({yaw}, {pitch})"),
            Self::Scan => "true gaze of the run (scan)".to_owned(),
            Self::Trace(path) | Self::Table(path, _) => {
                format!("true gaze of the run (trace:{})", path.display())
            }
            Self::Head(path) => format!(
                "true gaze of the run (eyes of {}; where they are not known, what is expected)",
                path.display()
            ),
            Self::Live(sender) => format!("expected gaze of the run ({sender})"),
        }
    }
}

/// A sender of gazes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LiveChoice {
    /// Lines of JSON over UDP to this address.
    Udp(String),
    /// Lines of JSON from a WebSocket server.
    WebSocket(String),
    /// Eye messages over OSC to this address.
    Osc(String),
}

impl fmt::Display for LiveChoice {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Udp(address) => write!(out, "udp:{address}"),
            Self::WebSocket(url) => write!(out, "{url}"),
            Self::Osc(address) => write!(out, "osc:{address}"),
        }
    }
}

/// Reads the value of `--gaze`.
pub(crate) fn parse_gaze(text: &str) -> anyhow::Result<GazeChoice> {
    Ok(match text.split_once(':') {
        Some(("trace", file)) => GazeChoice::Trace(PathBuf::from(file)),
        Some(("head", file)) => GazeChoice::Head(PathBuf::from(file)),
        Some(("udp", port)) => GazeChoice::Live(LiveChoice::Udp(address(port)?)),
        Some(("osc", port)) => GazeChoice::Live(LiveChoice::Osc(address(port)?)),
        Some(("ws", rest)) => GazeChoice::Live(LiveChoice::WebSocket(url(rest))),
        Some(("wss", _)) => bail!("there is no TLS; use ws: to a bridge on this machine"),
        _ => match text {
            "center" | "centre" => GazeChoice::At([0.0, 0.0]),
            "scan" => GazeChoice::Scan,
            "mouse" => bail!("the mouse needs a window, as `foveal view` has; give {FORMS}"),
            _ => GazeChoice::At(direction(text)?),
        },
    })
}

/// How a gaze that stands in two words of a command line, as `--gaze 10 5`, is meant.
pub(crate) fn gaze_in_two_words(words: &[String]) -> Option<String> {
    let is_number = |word: &String| word.parse::<f64>().is_ok();
    let mut all = words.windows(3);
    let found = all.find(|it| it[0] == "--gaze" && is_number(&it[1]) && is_number(&it[2]))?;
    let [_, yaw, pitch] = found else { return None };
    Some(format!(
        "join the two numbers by a comma, as `--gaze {yaw},{pitch}`"
    ))
}

fn direction(text: &str) -> anyhow::Result<[f64; 2]> {
    let [yaw, pitch] = parse_pair(text).map_err(|_| match text.trim().parse::<f64>() {
        Ok(_) => anyhow!("one number; give yaw and pitch with a comma and no space, as 10,5"),
        Err(_) => anyhow!("expected {FORMS}"),
    })?;
    let beyond = |angle: &str, found: f64, most: f64| {
        anyhow!(
            "the {angle} {found} is beyond {most} degrees; give degrees to the right and up, as \
             10,5, not pixels"
        )
    };
    if pitch.abs() > 90.0 {
        return Err(beyond("pitch", pitch, 90.0));
    }
    if yaw.abs() > 36_000.0 {
        return Err(beyond("yaw", yaw, 36_000.0));
    }
    Ok([yaw, pitch])
}

/// `PORT` on this machine alone, or `HOST:PORT`.
fn address(text: &str) -> anyhow::Result<String> {
    let (host, port) = text.rsplit_once(':').unwrap_or(("127.0.0.1", text));
    let expected = || format!("\"{text}\": expected PORT or HOST:PORT, with a port of 0 to 65535");
    let port: u16 = port.parse().with_context(expected)?;
    if host.is_empty() {
        bail!(expected());
    }
    Ok(format!("{host}:{port}"))
}

/// `ws:URL`, in which the URL may be whole or begin at `//` or at the host.
fn url(rest: &str) -> String {
    let rest = rest.strip_prefix("ws:").unwrap_or(rest);
    let rest = rest.strip_prefix("//").unwrap_or(rest);
    format!("ws://{rest}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_is_read() {
        let live = |choice| GazeChoice::Live(choice);
        for (text, choice) in [
            ("-10,5", GazeChoice::At([-10.0, 5.0])),
            ("scan", GazeChoice::Scan),
            ("trace:a:b.csv", GazeChoice::Trace("a:b.csv".into())),
            ("head:a.csv", GazeChoice::Head("a.csv".into())),
            ("udp:5005", live(LiveChoice::Udp("127.0.0.1:5005".into()))),
            (
                "udp:0.0.0.0:5005",
                live(LiveChoice::Udp("0.0.0.0:5005".into())),
            ),
            ("osc:[::]:9000", live(LiveChoice::Osc("[::]:9000".into()))),
        ] {
            assert_eq!(parse_gaze(text).unwrap(), choice, "{text}");
        }
        for text in ["ws://h:1/p", "ws:ws://h:1/p", "ws:h:1/p"] {
            let expected = live(LiveChoice::WebSocket("ws://h:1/p".into()));
            assert_eq!(parse_gaze(text).unwrap(), expected, "{text}");
        }
    }

    #[test]
    fn what_is_no_gaze_is_refused() {
        for text in [
            "up",
            "0,91",
            "0,nan",
            "udp:",
            "udp:70000",
            "udp::1",
            "osc:x",
            "mouse",
            "wss://h",
        ] {
            assert!(parse_gaze(text).is_err(), "{text}");
        }
    }
}
