//! What may a rig file say, for editors and programs?

use crate::report::output;
use clap::Args;
use foveal_scene::rig::rig_schema;
use serde::Serialize;

#[derive(Clone, Debug, Args)]
pub(crate) struct SchemaArgs {
    /// Print one JSON object that holds it as text; without, it is printed itself.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct SchemaReport {
    schema: String,
}

pub(crate) fn run(args: &SchemaArgs) -> anyhow::Result<()> {
    let schema = rig_schema();
    let report = SchemaReport {
        schema: schema.clone(),
    };
    output::result(args.json, &report, &schema)
}
