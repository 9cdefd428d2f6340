//! Does the program take every command that its documents and its help show?

use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches};

#[path = "../tests/program/documented.rs"]
mod documented;

use super::{Cli, examples, with_negative_numbers};
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
