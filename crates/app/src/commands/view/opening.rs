//! How large does the window begin?

use crate::commands::view::Ready;
use anyhow::anyhow;
use std::sync::Arc;
use winit::dpi::PhysicalSize;
use winit::event_loop::ActiveEventLoop;
use winit::window::{Fullscreen, Window};

/// Pixels of a screen whose size nobody tells.
pub(super) const USUAL_SCREEN: [u32; 2] = [1920, 1080];

/// A window of `--view` pixels, or as large as the screen allows for a picture of `size`.
pub(super) fn open_window(
    ready: &Ready,
    size: [u32; 2],
    event_loop: &ActiveEventLoop,
) -> anyhow::Result<Arc<Window>> {
    let args = &ready.args;
    let name = ready.file.path().file_name().unwrap_or_default();
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
