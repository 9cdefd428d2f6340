//! `foveal view`: what is in the window?

mod args;
mod asking;
mod draw_rate;
mod gaze_source;

mod keys;
mod log_file;
mod ready;
pub(crate) mod screen;
mod script;
mod sound;
mod styles;
mod summary;
mod telling;
mod window;
mod window_player;

use crate::report::output;
pub(crate) use args::ViewArgs;
use ready::Ready;

pub(crate) fn run(args: &ViewArgs) -> anyhow::Result<()> {
    let summary = window::run(Ready::new(args)?)?;
    output::result(args.json, &summary, &summary.text())
}
