//! What does the system's window tell, and what is done about it?

use crate::commands::view::keys::action_of;
use crate::commands::view::log_file::LogFile;
use crate::commands::view::looking::Looking;
use crate::commands::view::opening::{USUAL_SCREEN, open_sound, open_window, usable};
use crate::commands::view::ready::Ready;
use crate::commands::view::screen::overlay;
use crate::commands::view::screen::screenshot;
use crate::commands::view::screen::{self, Placed, Showing, WindowSurface};
use crate::commands::view::script::{Deed, PictureIs};
use crate::commands::view::summary::Summary;
use crate::commands::view::window_player::{Begin, WindowPlayer, Wish};
use crate::options::showing::InterpolationName;
use anyhow::{Context, anyhow, bail};
use foveal_core::content::demand::Content;
use foveal_core::content::policy::Policy;
use foveal_core::content::video::Video;
use foveal_core::session::bounds::Bounds;
use foveal_core::session::session::SessionSettings;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::keys::{Action, ZOOM};
use foveal_core::view::navigation::{Navigation, Pane};
use foveal_play::LivePlayer;
use foveal_render::{DrawDevice, Drawer, RgbaImage, TileStyle};
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Fullscreen, Window, WindowId};

/// Tries to get another device when one was lost.
const MOST_TRIES: u32 = 20;
/// Time between those.
const TRY_EVERY: Duration = Duration::from_millis(250);
/// Pixels of a touchpad that are a step of a wheel.
const WHEEL_PIXELS: f64 = 60.0;
/// How long a window may take to become as large as it was told, in seconds.
const RESIZE_S: f64 = 1.0;
/// How long a surface that gave nothing is left alone, in seconds.
const AGAIN_S: f64 = 0.02;

/// Something happened outside the window.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wake;

/// Opens a window and stays until it is closed.
pub(crate) fn run(ready: Ready) -> anyhow::Result<Summary> {
    let event_loop = EventLoop::<Wake>::with_user_event()
        .build()
        .map_err(|reason| {
            let reason = reason.to_string();
            // Where in winit's source it was found helps nobody.
            let reason = reason.rsplit(".rs:").next().unwrap_or_default();
            let reason =
                reason.trim_start_matches(|c: char| c.is_ascii_digit() || ": ".contains(c));
            anyhow!(
                "no window can be opened: {reason}; run it where there is a display, or under \
             xvfb-run, or use `foveal simulate`, which needs none"
            )
        })?;
    let mut app = App {
        instance: screen::instance(event_loop.owned_display_handle()),
        proxy: event_loop.create_proxy(),
        begun: Instant::now(),
        ready: Some(ready),
        open: None,
        result: None,
    };
    event_loop
        .run_app(&mut app)
        .map_err(|reason| anyhow!("the display ended the session: {reason}"))?;
    match app.result {
        Some(result) => result,
        None => Err(anyhow!("the display ended before a window was there")),
    }
}

struct App {
    instance: wgpu::Instance,
    proxy: EventLoopProxy<Wake>,
    begun: Instant,
    ready: Option<Ready>,
    open: Option<Open>,
    result: Option<anyhow::Result<Summary>>,
}

/// An open window and what is in it.
struct Open {
    window: Arc<Window>,
    screen: WindowSurface,
    player: WindowPlayer,
    video: Arc<Video>,
    ready: Ready,
    size: [u32; 2],
    hidden: bool,
    dragging: bool,
    /// Shift is held.
    with_shift: bool,
    /// Where the pointer was when it last moved.
    pointer: [f64; 2],
    /// Until when a window that was told its size is waited for.
    resizing: Option<f64>,
    /// The picture is not what it should be.
    stale: bool,
    /// When to try again to show it.
    again: Option<f64>,
    /// What times are counted from.
    epoch: Instant,
    /// When what is not yet shown was chosen.
    stepped: Option<Seconds>,
}

impl ApplicationHandler<Wake> for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if let Some(ready) = self.ready.take() {
            match Open::new(ready, event_loop, (&self.instance, &self.proxy), self.begun) {
                Ok(open) => self.open = Some(open),
                Err(error) => self.end(event_loop, Err(error)),
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let now = self.now();
        let Some(open) = &mut self.open else {
            return;
        };
        match open.event(event, now) {
            Ok(Wish::Quit) => self.finish(event_loop),
            Ok(_) => {}
            Err(error) => self.end(event_loop, Err(error)),
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, _: Wake) {}

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let now = self.now();
        let Some(open) = &mut self.open else {
            return;
        };
        match open.go_on(now, &self.instance, &self.proxy) {
            Ok(Wish::Quit) => return self.finish(event_loop),
            Ok(_) => {}
            Err(error) => return self.end(event_loop, Err(error)),
        }
        let next = open.next_step(self.begun.elapsed().as_secs_f64());
        event_loop.set_control_flow(match next {
            Some(next) => {
                ControlFlow::WaitUntil(self.begun + Duration::from_secs_f64(next.max(0.0)))
            }
            None => ControlFlow::Wait,
        });
    }
}

impl App {
    fn now(&self) -> Seconds {
        Seconds(self.begun.elapsed().as_secs_f64())
    }

    fn finish(&mut self, event_loop: &ActiveEventLoop) {
        let result = self.open.as_ref();
        let result = result.map(|open| Ok(Summary::new(&open.player)));
        let missing = || Err(anyhow!("there is no window"));
        self.end(event_loop, result.unwrap_or_else(missing));
    }

    fn end(&mut self, event_loop: &ActiveEventLoop, result: anyhow::Result<Summary>) {
        self.result.get_or_insert(result);
        self.open = None;
        event_loop.exit();
    }
}

impl Open {
    fn new(
        mut ready: Ready,
        event_loop: &ActiveEventLoop,
        (instance, proxy): (&wgpu::Instance, &EventLoopProxy<Wake>),
        begun: Instant,
    ) -> anyhow::Result<Self> {
        let (args, file) = (&ready.args, Arc::clone(&ready.file));
        let about = file.pack().description();
        let grid = about.grid(args.view.screen);
        let view = args.view.eye_view(&grid.surface)?;
        let window = open_window(&ready, view.size, event_loop)?;
        let screen = WindowSurface::open(instance, &window, waker(proxy))?;
        let config = args.policy.config()?;
        let style = TileStyle {
            samples: config.policy == Policy::Sampled,
            ..args.showing.showing(InterpolationName::Blended)
        };
        let device = DrawDevice::Gpu(screen.gpu().clone());
        let video = file.video(args.view.screen)?;
        let drawer = Drawer::new(&device, &video, style)?;
        let settings = SessionSettings {
            policy: usable(&file, &video, config, args.link)?,
            bytes_per_s: args.link.map(|link| link.bytes_per_s),
            since: Some(Seconds(0.0)),
            zooms: true,
            bounds: Bounds::default(),
        };
        let length = video.timeline().length();
        let looking = Looking::open(
            &args.gaze,
            &grid.surface,
            args.seed,
            length,
            &ready.watching,
        )?;
        let begin = Begin {
            policy: args.policy.clone(),
            navigation: Navigation::new(grid.surface, args.view.fov()?)
                .facing(Radians::from_degrees(about.front_deg)),
            log: args.log.as_deref().map(LogFile::create).transpose()?,
            looking,
            sound: ready.samples.take().and_then(|it| open_sound(it, length)),
            once: args.once,
            paused: args.paused,
            eye: args.eye,
            two_eyes: grid.surface.eyes > 1,
        };
        let options = ready.live_options(settings);
        let live = LivePlayer::new(file, &video, options, drawer, waker(proxy))?;
        let now = Seconds(begun.elapsed().as_secs_f64());
        let size = window.inner_size();
        Ok(Self {
            screen,
            player: WindowPlayer::new(live, begin, now),
            video,
            ready,
            size: [size.width, size.height],
            hidden: false,
            dragging: false,
            with_shift: false,
            pointer: [0.0; 2],
            resizing: None,
            stale: true,
            again: None,
            epoch: begun,
            stepped: None,
            window,
        })
    }

    /// The part of the window that one eye's picture lies in; `None` while it has no pixels.
    fn pane(&self) -> Option<Pane> {
        if self.size.contains(&0) {
            return None;
        }
        let monitor = self.window.current_monitor().map(|monitor| monitor.size());
        let screen = monitor.map_or(USUAL_SCREEN, |size| [size.width, size.height]);
        let screen = if screen.contains(&0) {
            USUAL_SCREEN
        } else {
            screen
        };
        let pane = Pane::new(self.size, screen, self.ready.args.view.screen);
        Some(pane.part(self.player.eyes().len()))
    }

    fn event(&mut self, event: WindowEvent, now: Seconds) -> anyhow::Result<Wish> {
        match event {
            WindowEvent::CloseRequested | WindowEvent::Destroyed => return Ok(Wish::Quit),
            WindowEvent::Resized(size) => self.resized([size.width, size.height]),
            WindowEvent::ScaleFactorChanged { .. } => self.stale = true,
            WindowEvent::Occluded(hidden) => {
                self.hidden = hidden;
                self.stale = true;
            }
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                if let Some(action) = action_of(&event.logical_key, self.with_shift) {
                    return self.act(action, now);
                }
            }
            WindowEvent::ModifiersChanged(held) => self.with_shift = held.state().shift_key(),
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
        Ok(Wish::Nothing)
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

    fn act(&mut self, action: Action, now: Seconds) -> anyhow::Result<Wish> {
        self.stale = true;
        let Some(pane) = self.pane() else {
            return Ok(if action == Action::Quit {
                Wish::Quit
            } else {
                Wish::Nothing
            });
        };
        let wish = self.player.act(action, &pane, now);
        match wish {
            Wish::FullScreen => {
                let full = self.window.fullscreen().is_some();
                let wanted = (!full).then_some(Fullscreen::Borderless(None));
                self.window.set_fullscreen(wanted);
            }
            Wish::Screenshot => {
                let folder = self.ready.args.screenshots.as_deref();
                let frame = self.player.live.session().shown_tick().unwrap_or(0);
                let frame = self.player.live.session().timeline().frame_of(frame);
                let path = screenshot::free_path(self.ready.file.path(), folder, frame);
                let said = match self.screenshot(&pane, &path) {
                    Ok(()) => path.display().to_string(),
                    Err(error) => format!("no screenshot: {error:#}"),
                };
                self.player.say(said, now);
            }
            Wish::Quit | Wish::Nothing => {}
        }
        Ok(wish)
    }

    /// The picture as it is shown, without words.
    fn screenshot(&mut self, pane: &Pane, path: &std::path::Path) -> anyhow::Result<()> {
        if self.player.live.session().shown_tick().is_none() {
            bail!("nothing is there to be seen yet");
        }
        let shown = self.player.shown(pane);
        let marks = self.player.marks();
        let mut whole: Option<RgbaImage> = None;
        for eye in self.player.eyes() {
            let view = EyeView {
                eye: *eye,
                ..shown.view
            };
            self.follow(&view)?;
            let image = self.player.live.drawer().picture(&view, marks.as_ref())?;
            let image = image.context("a window's pictures are drawn by a GPU")?;
            whole = Some(whole.map_or(image.clone(), |left| left.beside(&image)));
        }
        let whole = whole.context("a picture of no eye")?;
        crate::report::picture_file::write_png(path, &whole)
    }

    /// Moves what follows the gaze in an eye's view.
    fn follow(&mut self, view: &EyeView) -> anyhow::Result<()> {
        match self.player.gaze() {
            Some(gaze) => Ok(self.player.live.drawer().follow(&gaze, view)?),
            None => Ok(()),
        }
    }

    /// One turn: what the script says, what is due, what must be painted.
    fn go_on(
        &mut self,
        now: Seconds,
        instance: &wgpu::Instance,
        proxy: &EventLoopProxy<Wake>,
    ) -> anyhow::Result<Wish> {
        self.screen.listen();
        if self.screen.is_lost() {
            self.recover(instance, proxy)?;
        }
        self.player.live.session_mut().figures.gpu_errors += self.screen.take_errors();
        loop {
            if let Some(pane) = self.pane().filter(|_| !self.hidden)
                && self.player.step(&pane, now)?
            {
                self.stale = true;
                self.stepped = Some(now);
            }
            let Some(deed) = self.ready.script.next(now, self.picture_is(now)) else {
                break;
            };
            if self.perform(deed, now)? == Wish::Quit {
                return Ok(Wish::Quit);
            }
        }
        let waits = self.again.is_some_and(|again| now.0 < again);
        if self.stale && !waits && self.pane().is_some() && !self.hidden {
            self.window.request_redraw();
        }
        Ok(Wish::Nothing)
    }

    fn perform(&mut self, deed: Deed, now: Seconds) -> anyhow::Result<Wish> {
        match deed {
            Deed::Key(action) => return self.act(action, now),
            Deed::Move(place) => self.point(place),
            Deed::Leave => self.player.viewer.pointer.leave(now),
            Deed::Drag(by) => self.drag(by),
            Deed::Wheel(steps) => self.wheel(steps),
            Deed::Resize(size) => self.ask_size(size, now),
            Deed::Screenshot(name) => {
                let folder = self.ready.args.screenshots.as_deref();
                let path = folder.map_or(name.clone(), |folder| folder.join(&name));
                let pane = self
                    .pane()
                    .context("a window without pixels has no picture")?;
                self.screenshot(&pane, &path)?;
            }
            Deed::Settle => {}
            Deed::LoseDevice => {
                self.screen.gpu().device.destroy();
                self.stale = true;
            }
            Deed::Quit => return Ok(Wish::Quit),
        }
        Ok(Wish::Nothing)
    }

    fn picture_is(&self, now: Seconds) -> PictureIs {
        let resizing = self.resizing.is_some_and(|until| now.0 < until);
        let nothing_to_show = self.pane().is_none();
        if (nothing_to_show || self.player.is_settled()) && !resizing {
            PictureIs::Settled
        } else if nothing_to_show || self.player.live.session().shown_tick().is_some() {
            PictureIs::There
        } else {
            PictureIs::Missing
        }
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

    /// Begins anew on another device.
    fn recover(
        &mut self,
        instance: &wgpu::Instance,
        proxy: &EventLoopProxy<Wake>,
    ) -> anyhow::Result<()> {
        let style = self.player.live.style();
        let mut tries = 0;
        loop {
            tries += 1;
            let opened =
                WindowSurface::open(instance, &self.window, waker(proxy)).and_then(|screen| {
                    let device = DrawDevice::Gpu(screen.gpu().clone());
                    let drawer = Drawer::new(&device, &self.video, style)?;
                    Ok((screen, drawer))
                });
            match opened {
                Ok((screen, drawer)) => {
                    self.player.live.recover(drawer);
                    self.screen = screen;
                    self.stale = true;
                    return Ok(());
                }
                Err(error) if tries == MOST_TRIES => {
                    return Err(error.context("the GPU was lost and did not come back"));
                }
                Err(_) => std::thread::sleep(TRY_EVERY),
            }
        }
    }

    fn draw(&mut self, now: Seconds) -> anyhow::Result<()> {
        let Some(pane) = self.pane() else {
            return Ok(());
        };
        if self.hidden || self.screen.is_lost() || self.player.live.session().shown_tick().is_none()
        {
            return Ok(());
        }
        let shown = self.player.shown(&pane);
        let marks = self.player.marks();
        let mut pictures = Vec::new();
        let eyes = self.player.eyes();
        for (part, eye) in (0..).zip(eyes) {
            let view = EyeView {
                eye: *eye,
                ..shown.view
            };
            self.follow(&view)?;
            let picture = self.player.live.drawer().draw(&view, marks.as_ref())?;
            let picture = picture.context("a window's pictures are drawn by a GPU")?;
            let mut picture = picture.clone();
            if part + 1 < eyes.len() as u32 {
                picture = self.screen.keep(&picture);
            }
            let [left, top] = shown.origin;
            pictures.push((picture, [left + part * pane.size[0], top]));
        }
        let (told, message) = self.player.words(now);
        let placed = Placed {
            pictures,
            pixels_per_point: self.window.scale_factor() as f32,
        };
        let since = || Seconds(self.epoch.elapsed().as_secs_f64());
        let mut drawn = None;
        let player = &self.player;
        let early = || player.early_by(*drawn.insert(since()));
        let waits = player.holds_back().then_some(early);
        let words = |on: &_| overlay::paint(on, told.as_ref(), message.as_deref());
        let showing = self.screen.show(&placed, words, waits)?;
        if showing == Showing::Shown {
            let at = drawn.unwrap_or_else(since);
            self.player.drawn(self.stepped.take(), at);
        }
        self.stale = showing == Showing::Again;
        self.again = self.stale.then_some(now.0 + AGAIN_S);
        Ok(())
    }

    /// When to go on though nothing happens.
    fn next_step(&self, now: f64) -> Option<f64> {
        let script = self.ready.script.due().map(|due| due.0);
        let resizing = self.resizing.filter(|until| *until > now);
        let viewer = if self.hidden || self.size.contains(&0) {
            None
        } else {
            self.player.next_step(Seconds(now)).map(|next| next.0)
        };
        let again = self.again.filter(|_| self.stale);
        let times = [script, resizing, viewer, again];
        times.into_iter().flatten().reduce(f64::min)
    }
}

/// Wakes the event loop from any thread.
fn waker(proxy: &EventLoopProxy<Wake>) -> impl Fn() + Send + 'static {
    let proxy = proxy.clone();
    move || {
        // A loop that has ended needs no waking.
        let _ = proxy.send_event(Wake);
    }
}
