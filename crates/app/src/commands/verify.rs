//! Is every byte of a pack as it was written?

use crate::report::output;
use anyhow::anyhow;
use clap::Args;
use foveal_core::units::counted;
use foveal_media::pack::pack_file::PackFile;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Clone, Debug, Args)]
pub(crate) struct VerifyArgs {
    /// The pack.
    pack: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Verified {
    ok: bool,
    bytes: u64,
    units: usize,
    damage: Vec<String>,
}

/// Most damaged places that are listed.
const MOST_LISTED: usize = 20;

pub(crate) fn run(args: &VerifyArgs) -> anyhow::Result<()> {
    let file = PackFile::open(&args.pack)?;
    let bar = output::bar(Some(file.bytes()), output::Counting::Bytes);
    let damage = file.verify(|done, _| bar.set_position(done));
    bar.finish_and_clear();
    let found = damage.len();
    let verified = Verified {
        ok: damage.is_empty(),
        bytes: file.bytes(),
        units: file.pack().units().count(),
        damage: damage
            .iter()
            .take(MOST_LISTED)
            .map(ToString::to_string)
            .collect(),
    };
    if verified.ok {
        let text = format!(
            "{}: whole, {} bytes checked",
            args.pack.display(),
            verified.bytes
        );
        return output::result(args.json, &verified, &text);
    }
    let error = anyhow!(
        "{}: {}; copy the pack again, or prepare it again\n  {}",
        args.pack.display(),
        counted(found, "damaged place"),
        verified.damage.join("\n  ")
    );
    output::result_that_fails(args.json, &verified, "", error)
}
