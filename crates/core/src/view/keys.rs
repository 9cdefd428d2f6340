//! Which keys are there, and what do they do?
//!
//! One table for the window and the page: a key does the same in both. In scenes some keys do
//! something else than in video, as there one flies. `docs/keys.md` and
//! `web/src/element/keys.ts` are made of it.

use serde::Serialize;

/// What a viewer can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "does", content = "by", rename_all = "camelCase")]
pub enum Action {
    /// Pause, or play on.
    Pause,
    /// Seconds forward or back.
    Skip(f64),
    /// Frames forward or back; pauses.
    Step(i64),
    /// To the first frame.
    First,
    /// To the last frame.
    Last,
    /// Draw the content along, to the right and down, in shares of the view's width.
    Move([f64; 2]),
    /// Come closer by this factor.
    Zoom(f64),
    /// Back to the whole picture, to the front of a sphere, or to the start of a scene.
    Reset,
    /// Fly through a scene while the key is held, to the right, up and ahead, or against these
    /// where a number is negative.
    Fly([f64; 3]),
    /// So many policies on, or back.
    Policy(i32),
    /// So many target scores on, or back.
    Target(i32),
    /// Sound, or none.
    Sound,
    /// Colour tiles, or parts of a scene, by their level, or not.
    Levels,
    /// Colour parts of a scene by what the eye would gain of finer ones, or not.
    Importance,
    /// The eye is in a saccade while the key is held.
    Saccade,
    /// Draw the borders of tiles, or not.
    Borders,
    /// Blur what lies outside the fovea, or not.
    Blur,
    /// The other way to fill pixels between samples.
    Interpolation,
    /// Tiles in textures, or in the atlas.
    Textures,
    /// The next eye.
    Eye,
    /// A picture of what is seen into a file.
    Screenshot,
    /// The whole screen, or not.
    FullScreen,
    /// The next page of the overlay: help, statistics, off.
    Overlay,
    /// Figures, or none.
    Figures,
    /// End.
    Quit,
}

/// What a key needs to do something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub enum Needs {
    /// Nothing.
    Nothing,
    /// Content of more than one frame.
    Frames,
    /// Sound that is heard.
    Heard,
    /// VideoUnits for two eyes.
    TwoEyes,
    /// A policy that shows samples.
    Samples,
    /// A policy that shows tiles.
    Tiles,
    /// Tiles in an atlas, as levels are marked there.
    Atlas,
    /// Video, stills included.
    Video,
    /// A scene to fly through.
    Scene,
}

/// Where a key is heard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeardIn {
    /// In the window and in the page.
    Both,
    /// In the window alone.
    Window,
}

/// A key with what it does. It is named as the web names it (`KeyboardEvent.key`), letters small,
/// behind `Shift+` where it counts with Shift alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Key {
    /// Its name.
    pub key: &'static str,
    /// What it does.
    #[serde(flatten)]
    pub action: Action,
}

/// A line of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// The keys as people call them.
    pub shown: &'static str,
    /// What they do, for people.
    pub says: &'static str,
    /// What they need.
    pub needs: Needs,
    /// Where they are heard.
    pub place: HeardIn,
    /// The keys.
    pub keys: &'static [Key],
}

/// Share of the view's width that an arrow moves.
const STEP: f64 = 0.0625;
/// Seconds that a key skips.
const SKIP_S: f64 = 5.0;
/// What a key, or a step of a wheel, zooms by.
pub const ZOOM: f64 = 1.25;

const fn key(key: &'static str, action: Action) -> Key {
    Key { key, action }
}

const fn row(
    shown: &'static str,
    says: &'static str,
    needs: Needs,
    place: HeardIn,
    keys: &'static [Key],
) -> Row {
    Row {
        shown,
        says,
        needs,
        place,
        keys,
    }
}

/// All keys, in the order in which they are listed.
#[rustfmt::skip]
pub const KEYS: &[Row] = {
    use Action::*;
    use Needs::{Atlas, Frames, Heard, Nothing, Samples, Scene, Tiles, TwoEyes, Video};
    use HeardIn::{Both, Window};
    &[
        row("H  ?", "cycle: help, statistics, off", Nothing, Both,
            &[key("h", Overlay), key("?", Overlay)]),
        row("space", "play, pause", Frames, Both,
            &[key(" ", Pause)]),
        row(",  .", "frame back, forward", Frames, Both,
            &[key(",", Step(-1)), key(".", Step(1))]),
        row("[  ]", "5 s back, forward", Frames, Both,
            &[key("[", Skip(-SKIP_S)), key("]", Skip(SKIP_S))]),
        row("Shift Left  Shift Right", "5 s back, forward", Frames, Both,
            &[key("Shift+ArrowLeft", Skip(-SKIP_S)), key("Shift+ArrowRight", Skip(SKIP_S))]),
        row("Home  End", "first, last frame", Frames, Both,
            &[key("Home", First), key("End", Last)]),
        row("Left  Right", "look around, move", Nothing, Both,
            &[key("ArrowLeft", Move([STEP, 0.0])), key("ArrowRight", Move([-STEP, 0.0]))]),
        row("Up  Down", "look up and down, move", Nothing, Both,
            &[key("ArrowUp", Move([0.0, STEP])), key("ArrowDown", Move([0.0, -STEP]))]),
        row("+", "closer", Nothing, Both,
            &[key("+", Zoom(ZOOM)), key("=", Zoom(ZOOM))]),
        row("-", "farther", Nothing, Both,
            &[key("-", Zoom(1.0 / ZOOM)), key("_", Zoom(1.0 / ZOOM))]),
        row("0", "whole picture, front of a sphere, start", Nothing, Both,
            &[key("0", Reset)]),
        row("P  Shift P", "next policy, the one before", Nothing, Both,
            &[key("p", Policy(1)), key("Shift+p", Policy(-1))]),
        row("J  Shift J", "higher, lower target score (JOD)", Nothing, Both,
            &[key("j", Target(1)), key("Shift+j", Target(-1))]),
        row("M", "sound", Heard, Both,
            &[key("m", Sound)]),
        row("L", "tiles coloured by level, red the finest", Atlas, Both,
            &[key("l", Levels)]),
        row("B", "borders of tiles", Atlas, Window,
            &[key("b", Borders)]),
        row("R", "radial blur", Video, Window,
            &[key("r", Blur)]),
        row("I", "interpolation", Samples, Window,
            &[key("i", Interpolation)]),
        row("T", "textures, atlas", Tiles, Window,
            &[key("t", Textures)]),
        row("E", "left, right, both eyes", TwoEyes, Window,
            &[key("e", Eye)]),
        row("S", "screenshot", Video, Window,
            &[key("s", Screenshot)]),
        row("X", "held: the eye jumps, and sees no change (saccade)", Nothing, Window,
            &[key("x", Saccade)]),
        row("O", "figures", Nothing, Both,
            &[key("o", Figures)]),
        row("F", "full screen", Nothing, Both,
            &[key("f", FullScreen)]),
        row("F1  F11", "as H, as F", Nothing, Window,
            &[key("F1", Overlay), key("F11", FullScreen)]),
        row("Q  Esc", "quit", Nothing, Window,
            &[key("q", Quit), key("Escape", Quit)]),
        row("W  S", "scenes: fly ahead, back; Shift: faster", Scene, Both,
            &[key("w", Fly([0.0, 0.0, 1.0])), key("s", Fly([0.0, 0.0, -1.0]))]),
        row("A  D", "scenes: fly left, right", Scene, Both,
            &[key("a", Fly([-1.0, 0.0, 0.0])), key("d", Fly([1.0, 0.0, 0.0]))]),
        row("E  C", "scenes: fly up, down", Scene, Both,
            &[key("e", Fly([0.0, 1.0, 0.0])), key("c", Fly([0.0, -1.0, 0.0]))]),
        row("Home", "scenes: back to the start", Scene, Both,
            &[key("Home", Reset)]),
        row("L", "scenes: coloured by level, red the finest", Scene, Both,
            &[key("l", Levels)]),
        row("I", "scenes: coloured by what finer parts are worth, red most", Scene, Window,
            &[key("i", Importance)]),
        row("Shift S", "scenes: screenshot", Scene, Window,
            &[key("Shift+s", Screenshot)]),
    ]
};

/// What a key does in the window over video, named as the web names it; `None` for keys that do
/// nothing.
pub fn action_of(name: &str, with_shift: bool) -> Option<Action> {
    action_by(name, with_shift, |row| row.needs != Needs::Scene)
}

/// The same in scenes: what keys do there comes before what they do over video.
pub fn action_in_scene(name: &str, with_shift: bool) -> Option<Action> {
    let own = action_by(name, with_shift, |row| row.needs == Needs::Scene);
    own.or_else(|| action_of(name, with_shift))
}

fn action_by(name: &str, with_shift: bool, counts: impl Fn(&Row) -> bool) -> Option<Action> {
    let name = match name.chars().count() {
        1 => name.to_lowercase(),
        _ => name.to_owned(),
    };
    let rows = || KEYS.iter().filter(|row| counts(row));
    let keys = || rows().flat_map(|row| row.keys);
    let find = |name: &str| keys().find(|key| key.key == name).map(|key| key.action);
    let shifted = with_shift.then(|| find(&format!("Shift+{name}"))).flatten();
    shifted.or_else(|| find(&name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_key_is_listed_once_for_video_and_once_for_scenes() {
        for of_scenes in [false, true] {
            let rows = KEYS.iter();
            let rows = rows.filter(|row| (row.needs == Needs::Scene) == of_scenes);
            let keys: Vec<&str> = rows.flat_map(|row| row.keys).map(|k| k.key).collect();
            let all: BTreeSet<&str> = keys.iter().copied().collect();
            assert_eq!(all.len(), keys.len(), "{keys:?}");
        }
    }

    #[test]
    fn in_scenes_one_flies_by_keys_that_do_other_things_over_video() {
        assert_eq!(action_of("s", false), Some(Action::Screenshot));
        assert_eq!(action_of("w", false), None);
        let back = Some(Action::Fly([0.0, 0.0, -1.0]));
        assert_eq!(action_in_scene("s", false), back);
        assert_eq!(action_in_scene("S", true), Some(Action::Screenshot));
        let ahead = Some(Action::Fly([0.0, 0.0, 1.0]));
        assert_eq!(action_in_scene("W", true), ahead, "with Shift faster");
        assert_eq!(action_in_scene("Home", false), Some(Action::Reset));
        assert_eq!(action_in_scene("P", true), Some(Action::Policy(-1)));
        assert_eq!(action_in_scene("q", false), Some(Action::Quit));
        assert_eq!(action_in_scene("i", false), Some(Action::Importance));
        assert_eq!(action_in_scene("x", false), Some(Action::Saccade));
    }

    #[test]
    fn a_key_and_its_opposite_undo_each_other() {
        let action = |name| action_of(name, false).unwrap();
        let (Action::Step(a), Action::Step(b)) = (action(","), action(".")) else {
            panic!("no steps");
        };
        assert_eq!(a + b, 0);
        let (Action::Zoom(a), Action::Zoom(b)) = (action("+"), action("-")) else {
            panic!("no zooms");
        };
        assert!((a * b - 1.0).abs() < 1e-12);
    }

    #[test]
    fn shift_counts_where_it_is_named_and_nowhere_else() {
        assert_eq!(action_of("P", true), Some(Action::Policy(-1)));
        assert_eq!(action_of("P", false), Some(Action::Policy(1)), "caps lock");
        assert_eq!(action_of("ArrowLeft", true), Some(Action::Skip(-SKIP_S)));
        assert_eq!(action_of("+", true), Some(Action::Zoom(ZOOM)));
        assert_eq!(action_of("M", true), Some(Action::Sound));
        assert_eq!(action_of("v", false), None);
    }
}
