//! How is the program's help laid out: which commands serve which task?

use std::fmt::Write;

/// Commands by what a person wants to do.
const TASKS: [(&str, &[&str]); 6] = [
    ("Prepare", &["prepare", "calibrate", "info", "verify"]),
    ("Watch", &["view", "demo"]),
    ("Publish", &["export", "serve"]),
    (
        "Measure",
        &["simulate", "score", "evaluate", "bench", "select", "replay"],
    ),
    ("Gaze", &["gaze", "perception"]),
    ("Panels", &["panels"]),
];

/// The program with its commands listed by task.
pub(crate) fn by_task(program: clap::Command) -> clap::Command {
    let mut list = String::new();
    for (task, names) in TASKS {
        for (place, name) in (0..).zip(names) {
            let about = program
                .find_subcommand(name)
                .and_then(clap::Command::get_about)
                .map(ToString::to_string);
            let task = if place == 0 { task } else { "" };
            let _ = writeln!(list, "{task:<9} {name:<11} {}", about.unwrap_or_default());
        }
    }
    program.help_template(format!(
        "{{about}}.\n\n{{usage-heading}} {{usage}}\n\n{list}\n\
         `foveal COMMAND --help` explains a command. -V prints the version."
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Cli;
    use clap::CommandFactory;

    #[test]
    fn every_command_is_listed_once_and_the_list_fits_a_screen() {
        let mut program = by_task(Cli::command());
        let mut listed: Vec<&str> = TASKS
            .iter()
            .flat_map(|(_, names)| *names)
            .copied()
            .collect();
        listed.sort_unstable();
        let mut there: Vec<&str> = program
            .get_subcommands()
            .map(clap::Command::get_name)
            .collect();
        there.sort_unstable();
        assert_eq!(listed, there);
        let text = program.render_help().to_string();
        assert!(text.lines().count() <= 24, "{text}");
        assert!(
            text.lines().all(|line| line.chars().count() <= 80),
            "{text}"
        );
    }
}
