//! What is to happen by itself while a window is open?
//!
//! For kiosks, demonstrations and trials: a file with one thing a line, `SECONDS WHAT`, as
//! `0.5 key space`. While a line waits for the picture to settle, the script's time stands still.

use crate::commands::view::keys::action_named;
use anyhow::{Context, bail};
use foveal_core::units::Seconds;
use foveal_core::view::keys::Action;
use std::path::PathBuf;

/// What a line may say, for messages.
const FORMS: &str = "SECONDS and one of: key NAME, press NAME, release NAME, move X Y, leave, \
                     drag DX DY, wheel STEPS, resize W H, screenshot NAME, settle, quit";
/// Endings of pictures that no screenshot is.
const OTHER_PICTURES: [&str; 6] = ["jpg", "jpeg", "webp", "gif", "bmp", "tiff"];
/// Longest side of a window in pixels.
const MOST_SIDE: f64 = 8192.0;
/// Longest script in lines.
const MOST_LINES: usize = 100_000;

/// One thing that happens.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ScriptStep {
    /// What a key does.
    Key(Action),
    /// A key that does something while it is held, held from now on, or let go.
    Hold(Action, bool),
    /// The pointer to a place in the window, in pixels.
    Move([f64; 2]),
    /// The pointer out of the window.
    Leave,
    /// The content drawn along, in pixels.
    Drag([f64; 2]),
    /// The wheel away from the viewer, in steps.
    Wheel(f64),
    Resize([u32; 2]),
    /// Under this name, in the folder of screenshots.
    Screenshot(PathBuf),
    /// Wait until nothing in view can get finer.
    Settle,
    /// Test only: simulates GPU loss.
    LoseDevice,
    Quit,
}

/// How far the picture in the window is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PictureIs {
    /// Being fetched again; none of it has arrived.
    Missing,
    /// To get finer.
    There,
    Settled,
}

/// What is still to happen.
#[derive(Clone, Debug, Default)]
pub(crate) struct Script {
    /// In order of time, the next one last.
    rest: Vec<(f64, ScriptStep)>,
    /// How long it waited so far.
    waited: f64,
    waiting_since: Option<f64>,
}

impl Script {
    /// Reads a script of what happens over video, or in a scene; an error names the line.
    pub(crate) fn parse(text: &str, in_scene: bool) -> anyhow::Result<Self> {
        let mut rest = Vec::new();
        let mut before = 0.0;
        for (number, line) in text.lines().enumerate() {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let here = || format!("line {}: \"{line}\"", number + 1);
            let (at, step) = parse_line(line, in_scene).with_context(here)?;
            if at < before {
                bail!("{}: comes after {before} s; sort the lines by time", here());
            }
            if rest.len() == MOST_LINES {
                bail!("{}: more than {MOST_LINES} lines", here());
            }
            before = at;
            rest.push((at, step));
        }
        rest.reverse();
        Ok(Self {
            rest,
            ..Self::default()
        })
    }

    /// A script that closes the window after so long.
    pub(crate) fn quitting_at(time: Seconds) -> Self {
        Self {
            rest: vec![(time.0, ScriptStep::Quit)],
            ..Self::default()
        }
    }

    /// The next thing, if it is time for it; what needs the picture waits for it.
    pub(crate) fn next(&mut self, now: Seconds, picture: PictureIs) -> Option<ScriptStep> {
        let (at, step) = self.rest.last()?;
        if now.0 - self.waited < *at && self.waiting_since.is_none() {
            return None;
        }
        let can_happen = match step {
            ScriptStep::Settle => picture == PictureIs::Settled,
            ScriptStep::Screenshot(_) => picture != PictureIs::Missing,
            _ => true,
        };
        if !can_happen {
            self.waiting_since.get_or_insert(now.0);
            return None;
        }
        if let Some(since) = self.waiting_since.take() {
            self.waited += now.0 - since;
        }
        self.rest.pop().map(|(_, step)| step)
    }

    /// When to ask again; `None` when nothing is left, or it waits for the picture.
    pub(crate) fn due(&self) -> Option<Seconds> {
        let (at, _) = self.rest.last()?;
        self.waiting_since
            .is_none()
            .then_some(Seconds(at + self.waited))
    }
}

fn parse_line(line: &str, in_scene: bool) -> anyhow::Result<(f64, ScriptStep)> {
    let expected = || format!("expected {FORMS}");
    let (at, rest) = line
        .split_once(char::is_whitespace)
        .with_context(expected)?;
    let at: f64 = at.parse().ok().with_context(expected)?;
    if !(0.0..=1e7).contains(&at) {
        bail!("expected a time of 0 to 10000000 s");
    }
    let rest = rest.trim();
    let (what, given) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
    let given = given.trim();
    let number = |text: &str| text.parse::<f64>().ok().filter(|n| n.abs() <= 1e5);
    let pair = || {
        let (a, b) = given.split_once(char::is_whitespace)?;
        Some([number(a)?, number(b.trim())?])
    };
    let nothing = |step: ScriptStep| given.is_empty().then_some(step);
    let step = match what {
        "key" | "press" | "release" if given.is_empty() => None,
        "key" | "press" | "release" => Some(key_named(what, given, in_scene)?),
        "move" => pair().map(ScriptStep::Move),
        "leave" => nothing(ScriptStep::Leave),
        "drag" => pair().map(ScriptStep::Drag),
        "wheel" => number(given).map(ScriptStep::Wheel),
        "resize" => pair()
            .filter(|size| size.iter().all(|side| (0.0..=MOST_SIDE).contains(side)))
            .map(|size| ScriptStep::Resize(size.map(|side| side as u32))),
        "screenshot" => screenshot_named(given)?,
        "settle" => nothing(ScriptStep::Settle),
        "lose-device" => nothing(ScriptStep::LoseDevice),
        "quit" => nothing(ScriptStep::Quit),
        _ => None,
    };
    Ok((at, step.with_context(expected)?))
}

fn key_named(what: &str, name: &str, in_scene: bool) -> anyhow::Result<ScriptStep> {
    match (action_named(name, in_scene), what) {
        (None, _) => bail!("no key {name} does anything; `foveal view --help` lists all keys"),
        (Some(Action::Saccade), "key") => {
            bail!("key {name} does something while it is held; write \"press {name}\"")
        }
        (Some(action), "key") => Ok(ScriptStep::Key(action)),
        (Some(action @ (Action::Fly(_) | Action::Saccade)), _) => {
            Ok(ScriptStep::Hold(action, what == "press"))
        }
        _ => bail!("key {name} does all it does at once; write \"key {name}\""),
    }
}

fn screenshot_named(name: &str) -> anyhow::Result<Option<ScriptStep>> {
    let path = PathBuf::from(name);
    let is_name = path.file_name().is_some_and(|only| only == name) && !name.contains('\\');
    if !name.is_empty() && !is_name {
        bail!("a screenshot has a name without a folder; give the folder by --screenshots");
    }
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    if ending.is_some_and(|ending| OTHER_PICTURES.iter().any(|other| ending == *other)) {
        bail!("a screenshot is a PNG file; give it the ending .png");
    }
    let path = match path.extension() {
        None => path.with_extension("png"),
        Some(_) => path,
    };
    Ok((!name.is_empty()).then_some(ScriptStep::Screenshot(path)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_script_happens_in_order_and_waits_for_the_picture() {
        let text = "# a demonstration\n0 key space\n\n0.5 settle\n0.5 screenshot a b.png\n1 quit";
        let mut script = Script::parse(text, false).unwrap();
        let mut next = |now: f64, picture| script.next(Seconds(now), picture);
        let shot = ScriptStep::Screenshot("a b.png".into());
        assert!(matches!(
            next(0.0, PictureIs::Missing),
            Some(ScriptStep::Key(_))
        ));
        assert_eq!(next(0.4, PictureIs::Settled), None);
        assert_eq!(next(0.6, PictureIs::Missing), None);
        assert_eq!(next(9.0, PictureIs::There), None);
        assert_eq!(next(9.6, PictureIs::Settled), Some(ScriptStep::Settle));
        assert_eq!(next(9.6, PictureIs::Missing), None);
        assert_eq!(next(9.7, PictureIs::There), Some(shot));
        assert_eq!(next(9.9, PictureIs::Settled), None);
        assert_eq!(next(10.3, PictureIs::Missing), Some(ScriptStep::Quit));
        assert_eq!(script.due(), None);
    }

    #[test]
    fn in_a_scene_keys_that_fly_are_held_and_let_go() {
        let text = "0 press w\n1 release w\n1 key s\n2 key Shift+s\n3 press x";
        let mut script = Script::parse(text, true).unwrap();
        let deeds = [(); 5].map(|()| script.next(Seconds(9.0), PictureIs::There));
        let ahead = Action::Fly([0.0, 0.0, 1.0]);
        let back = Action::Fly([0.0, 0.0, -1.0]);
        assert_eq!(deeds[0], Some(ScriptStep::Hold(ahead, true)));
        assert_eq!(deeds[1], Some(ScriptStep::Hold(ahead, false)));
        assert_eq!(deeds[2], Some(ScriptStep::Key(back)));
        assert_eq!(deeds[3], Some(ScriptStep::Key(Action::Screenshot)));
        assert_eq!(deeds[4], Some(ScriptStep::Hold(Action::Saccade, true)));
    }

    #[test]
    fn what_is_no_deed_is_refused_with_its_line() {
        for line in [
            "key space",
            "0",
            "0 key nothing",
            "0 press",
            "0 press h",
            "0 press w",
            "x quit",
            "-1 quit",
            "nan quit",
            "0 move 1",
            "0 move 1 inf",
            "0 resize a b",
            "0 resize 20000 20000",
            "0 resize -1 400",
            "0 screenshot",
            "0 screenshot a.JPG",
            "0 screenshot ../../x.png",
            "0 screenshot /x.png",
            "0 screenshot a/",
            "0 screenshot ..",
            "0 key x",
            "0 key v",
            "0 quit now",
            "0 dance",
            "1e9 quit",
        ] {
            let error = Script::parse(&format!("0 settle\n{line}"), false).unwrap_err();
            assert!(error.to_string().starts_with("line 2"), "{line}: {error}");
        }
        let unsorted = Script::parse("2 settle\n1 quit", false);
        let unsorted = unsorted.unwrap_err().to_string();
        assert!(unsorted.contains("sort"), "{unsorted}");
    }

    #[test]
    fn any_text_is_read_or_refused() {
        let mut state = 7u64;
        let words = [
            "0", "1.5", "key", "space", "move", "\n", " ", "settle", "-3", "é", "quit",
        ];
        for _ in 0..5000 {
            let mut text = String::new();
            for _ in 0..12 {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                text.push_str(words[(state >> 33) as usize % words.len()]);
            }
            let _ = Script::parse(&text, state.is_multiple_of(2));
        }
    }
}
