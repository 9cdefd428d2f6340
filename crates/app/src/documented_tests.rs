//! Does the program take every command that its documents and its help show?

use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches};

#[path = "../tests/program/documented.rs"]
mod documented;

use super::{Cli, examples, help, with_negative_numbers};
use documented::{Shown, of_documents, of_line};

/// What clap says of a command; `None` where it takes it. In a sentence arguments may be missing,
/// and numbers may be letters.
fn complaint(shown: &Shown) -> Option<String> {
    let words = std::iter::once("foveal").chain(shown.words.iter().map(String::as_str));
    let matches = with_negative_numbers(Cli::command()).try_get_matches_from(words);
    let error = matches
        .and_then(|matches| Cli::from_arg_matches(&matches))
        .err()?;
    let is_short = matches!(
        error.kind(),
        ErrorKind::MissingRequiredArgument
            | ErrorKind::MissingSubcommand
            | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
            | ErrorKind::InvalidValue
            | ErrorKind::ValueValidation
            | ErrorKind::TooFewValues
            | ErrorKind::WrongNumberOfValues
    );
    let tells = matches!(
        error.kind(),
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion
    );
    let is_fine = tells || (is_short && !shown.is_whole);
    (!is_fine).then(|| format!("{}: {:?}: {error}", shown.place, shown.words))
}

#[test]
fn every_command_that_the_documents_show_is_one_that_the_program_takes() {
    let shown = of_documents();
    assert!(shown.len() > 100, "{} commands found", shown.len());
    let complaints: Vec<_> = shown.iter().filter_map(complaint).collect();
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn every_example_of_the_help_is_one_that_the_program_takes() {
    let shown: Vec<Shown> = examples::ALL
        .iter()
        .flat_map(|(path, lines)| of_line(path, lines, true))
        .collect();
    assert!(shown.len() >= examples::ALL.len());
    let complaints: Vec<_> = shown.iter().filter_map(complaint).collect();
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    // Each hangs on a command that there is.
    for (path, _) in examples::ALL {
        let help = examples::attached(Cli::command());
        let command = path
            .split(' ')
            .try_fold(&help, |at, name| at.find_subcommand(name));
        let command = command.unwrap_or_else(|| panic!("there is no foveal {path}"));
        assert!(command.get_after_help().is_some(), "{path}");
    }
}

/// The help of a command and of those under it, as Markdown.
fn reference(command: &mut clap::Command, path: &str, text: &mut String) {
    let help = command.render_long_help().to_string();
    *text += &format!("\n## {path}\n\n```text\n{}\n```\n", help.trim_end());
    for below in command.get_subcommands_mut() {
        if below.get_name() != "help" {
            let path = format!("{path} {}", below.get_name());
            reference(below, &path, text);
        }
    }
}

/// `FOVEAL_BLESS=1` rewrites the page.
#[test]
fn the_page_of_commands_is_the_help_of_the_program() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/commands.md");
    let mut program = help::by_task(examples::attached(Cli::command()));
    program.build();
    let mut text = "# Commands\n\nWhat `--help` prints for each command.\n".to_owned();
    reference(&mut program, "foveal", &mut text);
    if std::env::var("FOVEAL_BLESS").is_ok_and(|value| value == "1") {
        std::fs::write(path, &text).unwrap();
    }
    let page = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        page == text,
        "docs/commands.md is not what the help says: run `cargo xtask bless commands`"
    );
}
