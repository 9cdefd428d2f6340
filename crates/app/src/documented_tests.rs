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
        .flat_map(|(path, lines)| lines.map(|line| of_line(path, line, true)))
        .flatten()
        .collect();
    assert_eq!(shown.len(), 2 * examples::ALL.len());
    let complaints: Vec<_> = shown.iter().filter_map(complaint).collect();
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

/// Commands that run something, by the words that call them.
fn that_run(command: &clap::Command, path: &str, found: &mut Vec<String>) {
    let below = command.get_subcommands().filter(|c| c.get_name() != "help");
    let mut is_group = false;
    for command in below {
        is_group = true;
        let path = format!("{path} {}", command.get_name());
        that_run(command, path.trim(), found);
    }
    if !is_group {
        found.push(path.to_owned());
    }
}

#[test]
fn the_help_of_every_command_begins_with_a_sentence_and_ends_with_two_examples() {
    let program = examples::attached(Cli::command());
    let mut paths = Vec::new();
    that_run(&program, "", &mut paths);
    let mut listed: Vec<&str> = examples::ALL.iter().map(|(path, _)| *path).collect();
    listed.sort_unstable();
    paths.sort_unstable();
    assert_eq!(listed, paths);
    for (path, lines) in examples::ALL {
        let command = path
            .split(' ')
            .try_fold(&program, |at, name| at.find_subcommand(name))
            .unwrap();
        let ending = command.get_after_help().unwrap().to_string();
        assert!(ending.ends_with(lines[1]), "{path}: {ending}");
        let about = command.get_about().unwrap().to_string();
        let capital = about.chars().next().is_some_and(char::is_uppercase);
        assert!(capital && !about.contains('\n'), "{path}: {about}");
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
    let mut text = "# Commands\n\nLook up a command and its options here: this is what `--help` \
                    prints, with two examples at the end of each. The exit code is 0 when a \
                    command is done, 2 when the command line is wrong and nothing was done, and 1 \
                    when an input, the machine or a check failed ([results](formats/results.md)).\n"
        .to_owned();
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
