//! Which key of the table is a key of the window, or of a script?

use foveal_core::view::keys::{self, Action, KEYS};
use winit::keyboard::{Key, NamedKey};

/// Keys that are more than a character: as the web names them, as scripts do, as winit does.
const NAMED: [(&str, &str, NamedKey); 10] = [
    (" ", "space", NamedKey::Space),
    ("Home", "Home", NamedKey::Home),
    ("End", "End", NamedKey::End),
    ("ArrowLeft", "Left", NamedKey::ArrowLeft),
    ("ArrowRight", "Right", NamedKey::ArrowRight),
    ("ArrowUp", "Up", NamedKey::ArrowUp),
    ("ArrowDown", "Down", NamedKey::ArrowDown),
    ("F1", "F1", NamedKey::F1),
    ("F11", "F11", NamedKey::F11),
    ("Escape", "Esc", NamedKey::Escape),
];

/// The keys as a text for a terminal.
pub(crate) fn listed() -> String {
    let line = |row: &keys::Row| format!("  {:23} {}\n", row.shown, row.says);
    format!("Keys:\n{}", KEYS.iter().map(line).collect::<String>())
}

/// What a name on the web means over video, or in a scene.
fn action_on_web(name: &str, with_shift: bool, in_scene: bool) -> Option<Action> {
    match in_scene {
        true => keys::action_in_scene(name, with_shift),
        false => keys::action_of(name, with_shift),
    }
}

/// What a key means over video, or in a scene; `None` for keys that mean nothing.
pub(crate) fn action_of(key: &Key, with_shift: bool, in_scene: bool) -> Option<Action> {
    let name = match key {
        Key::Named(named) => NAMED.iter().find(|(.., key)| key == named)?.0,
        Key::Character(text) => text,
        _ => return None,
    };
    action_on_web(name, with_shift, in_scene)
}

/// What a key means that a script names: one character, or `space`, `Home`, `F11` and so on, all
/// of them behind `Shift+` or `Shift ` or not.
pub(crate) fn action_named(name: &str, in_scene: bool) -> Option<Action> {
    let shifted = name.split_once(['+', ' ']);
    let shifted = shifted.filter(|(shift, _)| shift.eq_ignore_ascii_case("shift"));
    let key = shifted.map_or(name, |(_, key)| key.trim());
    let is_character = key.chars().count() == 1;
    let mut names = NAMED.iter();
    let named = names.find(|(_, script, _)| script.eq_ignore_ascii_case(key));
    let web = named.map(|(web, ..)| *web);
    let web = web.or_else(|| is_character.then_some(key))?;
    let is_capital = is_character && key.chars().all(char::is_uppercase);
    action_on_web(web, is_capital || key != name, in_scene)
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::view::keys::Needs;

    #[test]
    fn every_key_of_the_table_is_one_of_the_window_and_of_scripts() {
        let of_row = |row: &'static keys::Row| row.keys.iter().map(move |key| (key, row.needs));
        for (key, needs) in KEYS.iter().flat_map(of_row) {
            let in_scene = needs == Needs::Scene;
            let name = key.key.strip_prefix("Shift+").unwrap_or(key.key);
            let with_shift = name != key.key;
            let named = NAMED.iter().find(|(web, ..)| *web == name);
            let (script, pressed) = match named {
                Some((_, script, named)) => (*script, Key::Named(*named)),
                None => (name, Key::Character(name.into())),
            };
            assert_eq!(
                action_of(&pressed, with_shift, in_scene),
                Some(key.action),
                "{name}"
            );
            let script = if with_shift {
                format!("Shift+{script}")
            } else {
                script.to_owned()
            };
            assert_eq!(
                action_named(&script, in_scene),
                Some(key.action),
                "{script}"
            );
        }
        assert_eq!(action_named("P", false), Some(Action::Policy(-1)));
        assert_eq!(action_named("ArrowLeft", false), None);
        for name in ["Shift+P", "shift P", "Shift p", "SHIFT+p"] {
            assert_eq!(
                action_named(name, false),
                Some(Action::Policy(-1)),
                "{name}"
            );
        }
        assert_eq!(action_named("home", false), Some(Action::First));
        assert_eq!(action_named("Shift", false), None);
        assert_eq!(action_of(&Key::Character("v".into()), false, false), None);
    }

    #[test]
    fn the_document_of_scripts_names_every_key_that_is_more_than_a_character() {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../docs/concepts/watching.md"
        );
        let text = std::fs::read_to_string(path).unwrap();
        let names = NAMED.map(|(_, script, _)| script).join(" ");
        let told = format!("one character, or {names}, or any\n");
        assert!(text.contains(&told), "{told}");
    }
}
