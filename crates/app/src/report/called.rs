//! With which words was the program called?

use clap::CommandFactory;
use std::ffi::OsString;
use std::sync::OnceLock;

/// The words of a command line, as results and failures need them.
#[derive(Debug)]
pub(crate) struct Called {
    /// The program and its command, as `foveal bench video`.
    pub(crate) command: String,
    /// All words but the program's own name.
    pub(crate) words: Vec<String>,
    /// Whether `--json` is among the words, also where the rest makes no sense.
    pub(crate) json: bool,
}

/// The command line of this process.
pub(crate) fn called() -> &'static Called {
    static CALLED: OnceLock<Called> = OnceLock::new();
    CALLED.get_or_init(|| Called::with(std::env::args_os().skip(1)))
}

impl Called {
    fn with(words: impl Iterator<Item = OsString>) -> Self {
        let words: Vec<String> = words
            .map(|word| word.to_string_lossy().into_owned())
            .collect();
        let mut command = "foveal".to_owned();
        let program = crate::Cli::command();
        let mut at = &program;
        for word in words.iter().filter(|word| !word.starts_with('-')) {
            let Some(next) = at.find_subcommand(word) else {
                break;
            };
            command = format!("{command} {word}");
            at = next;
        }
        Self {
            command,
            json: words
                .iter()
                .take_while(|word| *word != "--")
                .any(|word| word == "--json"),
            words,
        }
    }
}
