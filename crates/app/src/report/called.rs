//! With which words was the program called?

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

static CALLED: OnceLock<Called> = OnceLock::new();

/// Reads the command line of this process; `program` lists the commands. To be called once, before
/// anything is reported.
pub(crate) fn read_command_line(program: &clap::Command) {
    CALLED.get_or_init(|| Called::with(program, std::env::args_os().skip(1)));
}

/// The command line of this process; where nothing has read it, as in a test, no words.
pub(crate) fn called() -> &'static Called {
    CALLED.get_or_init(|| Called::with(&clap::Command::new("foveal"), std::iter::empty()))
}

/// Whether `--json` is asked for, as far as the command line was read. Allocates nothing.
pub(crate) fn json_asked() -> bool {
    CALLED.get().is_some_and(|called| called.json)
}

impl Called {
    fn with(program: &clap::Command, words: impl Iterator<Item = OsString>) -> Self {
        let words: Vec<String> = words
            .map(|word| word.to_string_lossy().into_owned())
            .collect();
        let mut command = "foveal".to_owned();
        let mut at = program;
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
