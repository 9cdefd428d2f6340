//! What may a rig file say, for editors and programs?

use clap::Args;
use foveal_scene::rig::rig_schema;

#[derive(Clone, Debug, Args)]
pub(crate) struct SchemaArgs {
    /// Print it on one line; it is JSON in any case.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &SchemaArgs) -> anyhow::Result<()> {
    let text = rig_schema();
    let value: serde_json::Value = serde_json::from_str(&text)?;
    crate::report::output::result(args.json, &value, &text)
}
