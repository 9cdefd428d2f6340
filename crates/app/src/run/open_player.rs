//! Can a pack be played with these options?

use crate::options::policy::check_thresholds;
use foveal_media::pack::pack_file::PackFile;
use foveal_play::{Player, PlayerOptions};
use std::sync::Arc;

/// A player of an open pack; refuses more thresholds than it has levels for.
pub(crate) fn open_player(file: Arc<PackFile>, options: PlayerOptions) -> anyhow::Result<Player> {
    let grid = file.pack().description().grid(options.screen);
    check_thresholds(&options.config, &grid)?;
    Ok(Player::new(file, options)?)
}
