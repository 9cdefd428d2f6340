//! How is window input handled, live or scripted?

use super::Open;
use crate::commands::view::keys::action_of;
use crate::commands::view::screen::screenshot;
use crate::commands::view::script::ScriptStep;
use crate::commands::view::window_player::WindowRequest;
use anyhow::Context;
use foveal_core::units::Seconds;
use foveal_core::view::flight::Steering;
use foveal_core::view::keys::{Action, ZOOM};
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, WindowEvent};
use winit::window::Fullscreen;

/// Pixels of a touchpad that are a step of a wheel.
const WHEEL_PIXELS: f64 = 60.0;
/// How long a window may take to resize when asked, in seconds.
const RESIZE_S: f64 = 1.0;

impl Open {
    pub(super) fn event(
        &mut self,
        event: WindowEvent,
        now: Seconds,
    ) -> anyhow::Result<WindowRequest> {
        match event {
            WindowEvent::CloseRequested | WindowEvent::Destroyed => return Ok(WindowRequest::Quit),
            WindowEvent::Resized(size) => self.resized([size.width, size.height]),
            WindowEvent::ScaleFactorChanged { .. } => self.stale = true,
            WindowEvent::Occluded(hidden) => {
                self.let_go(now);
                self.hidden = hidden;
                self.stale = true;
            }
            WindowEvent::Focused(false) => self.let_go(now),
            WindowEvent::KeyboardInput { event, .. } => return self.key(&event, now),
            WindowEvent::ModifiersChanged(held) => self.hold_shift(held.state().shift_key(), now),
            WindowEvent::CursorMoved { position, .. } => self.point([position.x, position.y]),
            WindowEvent::CursorLeft { .. } => self.player.viewer.pointer.leave(now),
            WindowEvent::MouseInput {
                state,
                button: MouseButton::Left,
                ..
            } => {
                self.dragging = state == ElementState::Pressed;
            }
            WindowEvent::MouseWheel { delta, .. } => self.wheel(match delta {
                MouseScrollDelta::LineDelta(_, steps) => f64::from(steps),
                MouseScrollDelta::PixelDelta(pixels) => pixels.y / WHEEL_PIXELS,
            }),
            WindowEvent::RedrawRequested => self.draw(now)?,
            _ => {}
        }
        Ok(WindowRequest::Nothing)
    }

    fn key(&mut self, event: &KeyEvent, now: Seconds) -> anyhow::Result<WindowRequest> {
        let is_pressed = event.state == ElementState::Pressed;
        // What Shift makes of a key that is let go counts for nothing: it may not have been held.
        let with_shift = self.with_shift && is_pressed;
        match action_of(
            &event.logical_key,
            with_shift,
            self.ready.opened.facts().is_entered,
        ) {
            Some(action @ (Action::Fly(_) | Action::Saccade)) => {
                self.hold(action, is_pressed, now);
            }
            Some(action) if is_pressed => return self.act(action, now),
            _ => {}
        }
        Ok(WindowRequest::Nothing)
    }

    /// A key does what it does from now on, or no longer.
    fn hold(&mut self, action: Action, is_held: bool, now: Seconds) {
        match action {
            Action::Fly(towards) => {
                let steering = self.player.viewer.navigation.steering();
                self.steer(steering.with(towards, is_held), now);
            }
            _ => self.player.hold_saccade(is_held, now),
        }
        self.stale = true;
    }

    fn hold_shift(&mut self, is_held: bool, now: Seconds) {
        self.with_shift = is_held;
        let steering = self.player.viewer.navigation.steering();
        self.steer(steering.hurried(is_held), now);
    }

    /// A window behind others has no key held.
    fn let_go(&mut self, now: Seconds) {
        self.steer(Steering::default(), now);
        self.player.hold_saccade(false, now);
    }

    fn steer(&mut self, steering: Steering, now: Seconds) {
        if let Some(pane) = self.pane() {
            self.player.viewer.navigation.steer(steering, &pane, now);
        }
    }

    fn resized(&mut self, size: [u32; 2]) {
        self.size = size;
        self.resizing = None;
        self.stale = true;
        self.screen.resize(size);
    }

    fn point(&mut self, place: [f64; 2]) {
        if self.dragging {
            self.drag([0, 1].map(|k| place[k] - self.pointer[k]));
        }
        self.pointer = place;
        // Both eyes' pictures show the same place of the content, each in its part.
        let across = self.pane().map_or(1.0, |pane| f64::from(pane.size[0]));
        let count = self.player.eyes().len() as f64;
        let part = (place[0] / across).floor().clamp(0.0, count - 1.0);
        self.player
            .viewer
            .pointer
            .move_to([place[0] - part * across, place[1]]);
    }

    fn drag(&mut self, by: [f64; 2]) {
        if let Some(pane) = self.pane() {
            self.player.viewer.navigation.drag(by, &pane);
        }
    }

    fn wheel(&mut self, steps: f64) {
        if let Some(pane) = self.pane() {
            let middle = pane.size.map(|side| f64::from(side) / 2.0);
            let place = self.player.viewer.pointer.place().unwrap_or(middle);
            let factor = ZOOM.powf(steps.clamp(-20.0, 20.0));
            self.player.viewer.navigation.zoom_by(factor, place, &pane);
        }
    }

    fn act(&mut self, action: Action, now: Seconds) -> anyhow::Result<WindowRequest> {
        self.stale = true;
        let Some(pane) = self.pane() else {
            return Ok(if action == Action::Quit {
                WindowRequest::Quit
            } else {
                WindowRequest::Nothing
            });
        };
        let request = self.player.act(action, &pane, now);
        match request {
            WindowRequest::FullScreen => {
                let full = self.window.fullscreen().is_some();
                let wanted = (!full).then_some(Fullscreen::Borderless(None));
                self.window.set_fullscreen(wanted);
            }
            WindowRequest::Screenshot => {
                let folder = self.ready.args.screenshots.as_deref();
                let frame = self.player.live.session().shown_tick().unwrap_or(0);
                let frame = self.player.live.session().timeline().frame_of(frame);
                let path = screenshot::free_path(self.ready.pack.path(), folder, frame);
                let said = match self.screenshot(&pane, &path) {
                    Ok(()) => path.display().to_string(),
                    Err(error) => format!("no screenshot: {error:#}"),
                };
                self.player.say(said, now);
            }
            WindowRequest::Quit | WindowRequest::Nothing => {}
        }
        Ok(request)
    }

    pub(super) fn perform(
        &mut self,
        step: ScriptStep,
        now: Seconds,
    ) -> anyhow::Result<WindowRequest> {
        match step {
            ScriptStep::Key(action) => return self.act(action, now),
            ScriptStep::Hold(action, is_held) => self.hold(action, is_held, now),
            ScriptStep::Move(place) => self.point(place),
            ScriptStep::Leave => self.player.viewer.pointer.leave(now),
            ScriptStep::Drag(by) => self.drag(by),
            ScriptStep::Wheel(steps) => self.wheel(steps),
            ScriptStep::Resize(size) => self.ask_size(size, now),
            ScriptStep::Screenshot(name) => {
                let folder = self.ready.args.screenshots.as_deref();
                let path = folder.map_or(name.clone(), |folder| folder.join(&name));
                let pane = self
                    .pane()
                    .context("a window without pixels has no picture")?;
                self.screenshot(&pane, &path)?;
            }
            ScriptStep::Settle => {}
            ScriptStep::LoseDevice => {
                self.screen.gpu().device.destroy();
                self.stale = true;
            }
            ScriptStep::Quit => return Ok(WindowRequest::Quit),
        }
        Ok(WindowRequest::Nothing)
    }

    /// Asks for another size; no pixels at all are what a system gives a window that it hides.
    fn ask_size(&mut self, size: [u32; 2], now: Seconds) {
        if size.contains(&0) {
            return self.resized(size);
        }
        let [w, h] = size;
        match self.window.request_inner_size(PhysicalSize::new(w, h)) {
            Some(size) => self.resized([size.width, size.height]),
            None => {
                let size = self.window.inner_size();
                self.resized([size.width, size.height]);
                self.resizing = (self.size != [w, h]).then_some(now.0 + RESIZE_S);
            }
        }
    }
}
