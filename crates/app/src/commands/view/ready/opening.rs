//! How large does the window begin?

use crate::commands::view::ready::Ready;
use crate::commands::view::sound::Sound;
use crate::commands::view::sound::samples::Samples;
use crate::options::link::Link;
use crate::report::output::say;
use anyhow::anyhow;
use anyhow::bail;
use foveal_core::content::policy::{HasTables, PolicyConfig};
use foveal_core::units::Seconds;
use std::path::Path;
use std::sync::Arc;
use winit::dpi::PhysicalSize;
use winit::event_loop::ActiveEventLoop;
use winit::window::{Fullscreen, Window};

/// Screen size assumed when none is reported.
pub(in crate::commands::view) const USUAL_SCREEN: [u32; 2] = [1920, 1080];

/// A window of `--view` pixels, or as large as the screen allows for a picture of `size`.
pub(in crate::commands::view) fn open_window(
    ready: &Ready,
    size: [u32; 2],
    event_loop: &ActiveEventLoop,
) -> anyhow::Result<Arc<Window>> {
    let args = &ready.args;
    let name = ready.pack.path().file_name().unwrap_or_default();
    let monitor = event_loop.primary_monitor().map(|monitor| monitor.size());
    let most = monitor.map_or(USUAL_SCREEN, |size| [size.width, size.height]);
    let share = (0..2)
        .map(|k| f64::from(most[k].max(1)) * 0.85 / f64::from(size[k]))
        .fold(1.0, f64::min);
    let size = match args.view.view {
        Some(size) => size,
        None => size.map(|side| ((f64::from(side) * share) as u32).max(64)),
    };
    let attributes = Window::default_attributes()
        .with_title(format!("{} - Foveal", name.to_string_lossy()))
        .with_inner_size(PhysicalSize::new(size[0], size[1]))
        .with_fullscreen(args.full_screen.then_some(Fullscreen::Borderless(None)));
    let window = event_loop.create_window(attributes);
    Ok(Arc::new(window.map_err(|reason| {
        anyhow!("no window can be opened: {reason}; is there a display?")
    })?))
}

/// The policy, or what stands in for it where a pack has no signatures; for what is
/// to spend a link nothing can.
pub(in crate::commands::view) fn usable(
    pack: &Path,
    has: HasTables,
    config: PolicyConfig,
    link: Option<Link>,
) -> anyhow::Result<PolicyConfig> {
    let usable = match has.signatures || link.is_some() && config.policy.spends_a_budget() {
        true => config.clone(),
        false => config.without_signatures(),
    };
    if usable.is_met_by(has) {
        return Ok(config);
    }
    bail!(
        "{}: has no signatures or cues, by which this policy chooses; prepare it again",
        pack.display(),
    )
}

/// The device that plays these samples; one that cannot be opened is reported.
pub(in crate::commands::view) fn open_sound(samples: Samples, length: Seconds) -> Option<Sound> {
    let quiet = |error: anyhow::Error| say(&format!("warning: {error}; no sound"));
    Sound::open(samples, length).map_err(quiet).ok()
}
