//! Can a pack be played with these options?

use crate::options::policy::check_thresholds;
use foveal_media::pack::pack_file::PackFile;
use foveal_play::{FrameOptions, FramePlayer};
use std::sync::Arc;

/// A player of an open pack; refuses more thresholds than it has levels for.
pub(crate) fn open_player(
    file: &Arc<PackFile>,
    options: FrameOptions,
) -> anyhow::Result<FramePlayer> {
    let grid = file.pack().description().grid(options.screen);
    check_thresholds(&options.player.config, &grid)?;
    Ok(FramePlayer::new(file, options)?)
}
