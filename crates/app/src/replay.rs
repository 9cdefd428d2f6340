//! Does a logged session select the same again?

use crate::output;
use anyhow::{Context, bail};
use clap::Args;
use foveal_core::selection::session::{Session, sha256_hex};
use serde::Serialize;
use std::path::PathBuf;

#[derive(Clone, Debug, Args)]
pub(crate) struct ReplayArgs {
    /// The session.jsonl that simulate wrote.
    log: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Replayed {
    same: bool,
    frames: usize,
    differing_frames: usize,
    first_difference: Option<u32>,
    log_sha256: String,
    replay_sha256: String,
}

pub(crate) fn run(args: &ReplayArgs) -> anyhow::Result<()> {
    let name = args.log.display();
    let text = output::read_text(&args.log, "the session.jsonl of a simulate")?;
    let session = Session::parse(&text).with_context(|| name.to_string())?;
    let again = session.replay();
    let mut differing = session
        .frames
        .iter()
        .zip(&again.frames)
        .filter(|(a, b)| a != b)
        .peekable();
    let first_difference = differing.peek().map(|(frame, _)| frame.frame);
    let replayed = Replayed {
        frames: session.frames.len(),
        differing_frames: differing.count(),
        first_difference,
        log_sha256: sha256_hex(text.as_bytes()),
        replay_sha256: sha256_hex(again.write().as_bytes()),
        same: again.write() == text,
    };
    let verdict = if replayed.same {
        "the same selection again"
    } else {
        "another selection"
    };
    let text = format!(
        "{} frames: {verdict}\nsha256 {}",
        replayed.frames, replayed.replay_sha256
    );
    output::result(args.json, &replayed, &text)?;
    if !replayed.same {
        let from = first_difference.map_or("its first line".to_owned(), |f| format!("frame {f}"));
        bail!("{name}: the replay differs from {from} on: the log was changed, or the program");
    }
    Ok(())
}
