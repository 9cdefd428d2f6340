//! Which formats are read, and how are irregular files handled?

use crate::inputs;
use crate::report::output;
use clap::Args;
use serde::Serialize;

#[derive(Clone, Debug, Args)]
pub(crate) struct FormatsArgs {
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What `prepare formats` prints.
#[derive(Serialize)]
struct Formats {
    formats: Vec<&'static inputs::Format>,
}

pub(crate) fn run(args: &FormatsArgs) -> anyhow::Result<()> {
    let formats = inputs::all().collect();
    output::result(args.json, &Formats { formats }, &inputs::markdown())
}
