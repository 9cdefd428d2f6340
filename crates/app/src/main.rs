//! The `foveal` program: which command runs?

mod options;
mod output;
mod select;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Streams and renders only the detail that an eye can see.
#[derive(Debug, Parser)]
#[command(version, propagate_version = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// What would be chosen, without content: levels, pixels, shares.
    Select(select::SelectArgs),
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Select(args) => select::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => output::fail(&error),
    }
}
