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

/// What a key means; `None` for keys that mean nothing.
pub(crate) fn action_of(key: &Key, with_shift: bool) -> Option<Action> {
    let name = match key {
        Key::Named(named) => NAMED.iter().find(|(.., key)| key == named)?.0,
        Key::Character(text) => text,
        _ => return None,
    };
    keys::action_of(name, with_shift)
}

/// What a key means that a script names: one character, or `space`, `Home`, `F11` and so on, all
/// of them behind `Shift+` or not.
pub(crate) fn action_named(name: &str) -> Option<Action> {
    let key = name.strip_prefix("Shift+").unwrap_or(name);
    let is_character = key.chars().count() == 1;
    let named = NAMED.iter().find(|(_, script, _)| *script == key);
    let web = named.map(|(web, ..)| *web);
    let web = web.or_else(|| is_character.then_some(key))?;
    let is_capital = is_character && key.chars().all(char::is_uppercase);
    keys::action_of(web, is_capital || key != name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_the_table_is_one_of_the_window_and_of_scripts() {
        for key in KEYS.iter().flat_map(|row| row.keys) {
            let name = key.key.strip_prefix("Shift+").unwrap_or(key.key);
            let with_shift = name != key.key;
            let named = NAMED.iter().find(|(web, ..)| *web == name);
            let (script, pressed) = match named {
                Some((_, script, named)) => (*script, Key::Named(*named)),
                None => (name, Key::Character(name.into())),
            };
            assert_eq!(action_of(&pressed, with_shift), Some(key.action), "{name}");
            let script = if with_shift {
                format!("Shift+{script}")
            } else {
                script.to_owned()
            };
            assert_eq!(action_named(&script), Some(key.action), "{script}");
        }
        assert_eq!(action_named("P"), Some(Action::Policy(-1)));
        assert_eq!(action_named("ArrowLeft"), None);
        assert_eq!(action_of(&Key::Character("x".into()), false), None);
    }

    #[test]
    fn the_document_of_scripts_names_every_key_that_is_more_than_a_character() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/concepts/video.md");
        let text = std::fs::read_to_string(path).unwrap();
        let names = NAMED.map(|(_, script, _)| script).join(" ");
        let told = format!("one character, or {names}, or any\n");
        assert!(text.contains(&told), "{told}");
    }
}
