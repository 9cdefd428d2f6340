//! What does a key do?

use winit::keyboard::{Key, NamedKey};

/// What a viewer can ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Action {
    Pause,
    /// Seconds forward or back.
    Skip(f64),
    /// Frames forward or back; pauses.
    Step(i64),
    First,
    Last,
    /// Draw the content along, in shares of the window's width.
    Move([f64; 2]),
    /// Come closer by this factor.
    Zoom(f64),
    Reset,
    /// The next policy, or the one before.
    Policy(i32),
    HeatMap,
    Borders,
    /// Blur what lies outside the fovea, or not.
    Blur,
    /// The other way to fill pixels between samples.
    Interpolation,
    /// Tiles in textures, or in the atlas.
    Textures,
    /// The next eye.
    Eye,
    Screenshot,
    FullScreen,
    Overlay,
    Quit,
}

/// Share of the window's width that an arrow key moves.
const STEP: f64 = 0.05;
/// Seconds that a bracket skips.
const SKIP_S: f64 = 5.0;
/// What a key zooms by.
pub(crate) const ZOOM: f64 = 1.25;

/// What a key needs to do something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Needs {
    Nothing,
    /// Content of more than one frame.
    Frames,
    /// Content for two eyes.
    TwoEyes,
    /// A policy that shows samples.
    Samples,
    /// A policy that shows tiles.
    Tiles,
    /// Tiles in an atlas, as levels are marked there.
    Atlas,
}

/// The keys, for people, and what they need.
pub(crate) const KEYS: [(&str, &str, Needs); 17] = [
    ("space", "pause, play", Needs::Frames),
    (", .", "frame back, forward", Needs::Frames),
    ("[ ]", "5 s back, forward", Needs::Frames),
    ("Home End", "first, last frame", Needs::Frames),
    ("arrows, drag", "turn, move", Needs::Nothing),
    ("+ -, wheel", "zoom", Needs::Nothing),
    ("0", "whole picture", Needs::Nothing),
    ("P", "next policy", Needs::Nothing),
    ("R", "radial blur", Needs::Nothing),
    ("I", "interpolation", Needs::Samples),
    ("T", "textures, atlas", Needs::Tiles),
    ("E", "left, right, both eyes", Needs::TwoEyes),
    ("M  B", "heat map, borders", Needs::Atlas),
    ("S", "screenshot", Needs::Nothing),
    ("F11", "full screen", Needs::Nothing),
    ("H F1", "this overlay", Needs::Nothing),
    ("Q Esc", "quit", Needs::Nothing),
];

/// The keys as a text for a terminal.
pub(crate) fn listed() -> String {
    let line = |(keys, what, _): &(&str, &str, Needs)| format!("  {keys:14} {what}\n");
    format!("Keys:\n{}", KEYS.iter().map(line).collect::<String>())
}

/// What a key means; `None` for keys that mean nothing.
pub(crate) fn action_of(key: &Key) -> Option<Action> {
    match key {
        Key::Named(named) => action_of_named(*named),
        Key::Character(text) => action_of_character(text),
        _ => None,
    }
}

fn action_of_named(key: NamedKey) -> Option<Action> {
    Some(match key {
        NamedKey::Space => Action::Pause,
        NamedKey::Home => Action::First,
        NamedKey::End => Action::Last,
        NamedKey::ArrowLeft => Action::Move([STEP, 0.0]),
        NamedKey::ArrowRight => Action::Move([-STEP, 0.0]),
        NamedKey::ArrowUp => Action::Move([0.0, STEP]),
        NamedKey::ArrowDown => Action::Move([0.0, -STEP]),
        NamedKey::F1 => Action::Overlay,
        NamedKey::F11 => Action::FullScreen,
        NamedKey::Escape => Action::Quit,
        _ => return None,
    })
}

fn action_of_character(text: &str) -> Option<Action> {
    Some(match text {
        " " => Action::Pause,
        "," => Action::Step(-1),
        "." => Action::Step(1),
        "[" => Action::Skip(-SKIP_S),
        "]" => Action::Skip(SKIP_S),
        "+" | "=" => Action::Zoom(ZOOM),
        "-" => Action::Zoom(1.0 / ZOOM),
        "0" => Action::Reset,
        "p" => Action::Policy(1),
        "P" => Action::Policy(-1),
        "m" | "M" => Action::HeatMap,
        "b" | "B" => Action::Borders,
        "r" | "R" => Action::Blur,
        "i" | "I" => Action::Interpolation,
        "t" | "T" => Action::Textures,
        "e" | "E" => Action::Eye,
        "s" | "S" => Action::Screenshot,
        "h" | "H" => Action::Overlay,
        "q" | "Q" => Action::Quit,
        _ => return None,
    })
}

/// The key of a name in a script: one character, or `space`, `Home`, `F11` and so on.
pub(crate) fn key_named(name: &str) -> Option<Key> {
    let named = match name {
        "space" => NamedKey::Space,
        "Home" => NamedKey::Home,
        "End" => NamedKey::End,
        "Left" => NamedKey::ArrowLeft,
        "Right" => NamedKey::ArrowRight,
        "Up" => NamedKey::ArrowUp,
        "Down" => NamedKey::ArrowDown,
        "F1" => NamedKey::F1,
        "F11" => NamedKey::F11,
        "Esc" => NamedKey::Escape,
        one if one.chars().count() == 1 => return Some(Key::Character(one.into())),
        _ => return None,
    };
    Some(Key::Named(named))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_that_is_listed_does_something() {
        let words = KEYS.iter().flat_map(|(keys, ..)| keys.split([' ']));
        for word in words.filter(|word| !word.is_empty()) {
            let word = word
                .strip_suffix(',')
                .filter(|w| !w.is_empty())
                .unwrap_or(word);
            if ["arrows", "drag", "wheel"].contains(&word) {
                continue;
            }
            let key = key_named(word).unwrap_or_else(|| panic!("no key {word}"));
            assert!(action_of(&key).is_some(), "{word}");
        }
    }

    #[test]
    fn a_key_and_its_opposite_undo_each_other() {
        let action = |name| action_of(&key_named(name).unwrap()).unwrap();
        let (Action::Step(a), Action::Step(b)) = (action(","), action(".")) else {
            panic!("no steps");
        };
        assert_eq!(a + b, 0);
        let (Action::Zoom(a), Action::Zoom(b)) = (action("+"), action("-")) else {
            panic!("no zooms");
        };
        assert!((a * b - 1.0).abs() < 1e-12);
        assert_eq!(action_of(&Key::Character("x".into())), None);
    }
}
