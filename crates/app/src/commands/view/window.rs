//! What does the system's window report, and what is done about it?

mod input;
pub(crate) mod panes;

use crate::commands::view::gaze_source::WindowGazeSource;
use crate::commands::view::log_file::LogFile;
use crate::commands::view::ready::Ready;
use crate::commands::view::ready::opening::{USUAL_SCREEN, open_sound, open_window};
use crate::commands::view::screen::overlay;
use crate::commands::view::screen::{self, Placed, PlacedPicture, Showing, WindowSurface};
use crate::commands::view::script::PictureIs;
use crate::commands::view::summary::Summary;
use crate::commands::view::window::panes::PanePart;
use crate::commands::view::window_player::{Begin, WindowPlayer, WindowRequest};
use crate::report::output;
use anyhow::{Context, anyhow, bail};
use foveal_core::session::actions::SessionEvent;
use foveal_core::session::session::SessionSettings;
use foveal_core::units::Seconds;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::navigation::Pane;
use foveal_play::Player;
use foveal_render::warp::PanelOptics;
use foveal_render::{DrawDevice, RgbaImage};
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Window, WindowId};

/// Tries to get another device when one was lost.
const MOST_TRIES: u32 = 20;
/// Time between those.
const TRY_EVERY: Duration = Duration::from_millis(250);
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
            // Its place in winit's source does not help users.
            let reason = reason.rsplit(".rs:").next().unwrap_or_default();
            let reason =
                reason.trim_start_matches(|c: char| c.is_ascii_digit() || ": ".contains(c));
            let reason = reason.trim_end_matches('.');
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
    ready: Ready,
    size: [u32; 2],
    hidden: bool,
    dragging: bool,
    /// Shift is held.
    with_shift: bool,
    /// Where the pointer was when it last moved.
    pointer: [f64; 2],
    /// Until when a window that was asked to resize is waited for.
    resizing: Option<f64>,
    /// The picture is not what it should be.
    stale: bool,
    /// When to try again to show it.
    again: Option<f64>,
    /// What times are counted from.
    epoch: Instant,
    /// When what is not yet shown was chosen.
    stepped: Option<Seconds>,
    /// What bends and dims panels, in a window of so many pixels.
    optics: Option<([u32; 2], PanelOptics)>,
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
            Ok(WindowRequest::Quit) => self.finish(event_loop),
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
            Ok(WindowRequest::Quit) => return self.finish(event_loop),
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
        let args = &ready.args;
        let surface = ready.surface();
        let panes = ready.panes();
        let size = match &panes {
            Some(panes) => panes.size(),
            None => args.view.eye_view(&surface)?.size,
        };
        let window = open_window(&ready, size, event_loop)?;
        let screen = WindowSurface::open(instance, &window, waker(proxy))?;
        let config = ready.config()?;
        let device = DrawDevice::Gpu(screen.gpu().clone());
        let drawer = ready.drawer(&device, ready.style(config.policy))?;
        let settings = SessionSettings {
            policy: config,
            bytes_per_s: args.link.map(|link| link.bytes_per_s),
            since: Some(Seconds(0.0)),
            zooms: panes.is_none(),
            measures: ready.opened.facts().is_measured,
            bounds: ready.bounds(),
        };
        let length = ready.opened.content().timeline().length();
        let gaze_source =
            WindowGazeSource::open(&args.gaze, &surface, args.seed, length, &ready.watching)?;
        let begin = Begin {
            policy: args.policy.clone(),
            navigation: ready.navigation()?,
            log: args.log.as_deref().map(LogFile::create).transpose()?,
            gaze_source,
            sound: ready.samples.take().and_then(|it| open_sound(it, length)),
            bytes_per_s: args.link.map(|link| link.bytes_per_s),
            once: args.once,
            paused: args.paused,
            eye: args.eye,
            two_eyes: surface.eyes > 1 && panes.is_none(),
            panes,
        };
        let live = Player::live(
            (&ready.pack, &ready.opened),
            (settings, ready.decoding),
            drawer,
            output::say,
            waker(proxy),
        )?;
        let now = Seconds(begun.elapsed().as_secs_f64());
        let size = window.inner_size();
        Ok(Self {
            screen,
            player: WindowPlayer::new(live, begin, now),
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
            optics: None,
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

    /// The picture as it is shown, without words.
    fn screenshot(&mut self, pane: &Pane, path: &std::path::Path) -> anyhow::Result<()> {
        if self.player.live.session().shown_tick().is_none() {
            bail!("nothing is there to be seen yet");
        }
        let parts = self.player.parts(pane);
        let device = self.player.live.drawer().device().clone();
        let mut images = Vec::new();
        for (number, part) in parts.iter().enumerate() {
            self.follow(&part.view)?;
            let marks = self.player.marks(&part.view);
            let drawer = self.player.live.drawer_mut();
            let image = drawer.picture(&part.view, marks.as_ref())?;
            let image = image.context("a window's pictures are drawn by a GPU")?;
            images.push(self.optics(pane).image(&device, number, image)?);
        }
        let whole = if self.player.has_panels() {
            Some(laid_out(&parts, &images))
        } else {
            let images = images.into_iter();
            images.reduce(|left, right| left.beside(&right))
        };
        let whole = whole.context("a picture of no eye")?;
        crate::report::picture_file::write_new_png(path, &whole)
    }

    /// What bends and dims the panels of this window.
    fn optics(&mut self, pane: &Pane) -> &mut PanelOptics {
        let known = self.optics.take().filter(|(size, _)| *size == pane.size);
        let player = &self.player;
        let made = known.unwrap_or_else(|| {
            let optics = PanelOptics::new(&player.panels_in(pane));
            (pane.size, optics)
        });
        &mut self.optics.insert(made).1
    }

    /// Moves what follows the gaze in an eye's view.
    fn follow(&mut self, view: &EyeView) -> anyhow::Result<()> {
        match self.player.gaze() {
            Some(gaze) => match self.player.live.drawer_mut().tiles_mut() {
                Some(tiles) => Ok(tiles.follow(&gaze, view)?),
                None => Ok(()),
            },
            None => Ok(()),
        }
    }

    /// One turn: what the script says, what is due, what must be painted.
    fn go_on(
        &mut self,
        now: Seconds,
        instance: &wgpu::Instance,
        proxy: &EventLoopProxy<Wake>,
    ) -> anyhow::Result<WindowRequest> {
        self.screen.listen();
        if self.screen.is_lost() {
            self.recover(instance, proxy)?;
        }
        let count = self.screen.take_errors();
        let session = self.player.live.session_mut();
        session.take(SessionEvent::GpuErrors { count });
        loop {
            if let Some(pane) = self.pane().filter(|_| !self.hidden)
                && self.player.step(&pane, now)?
            {
                self.stale = true;
                self.stepped = Some(now);
            }
            let Some(step) = self.ready.script.next(now, self.picture_is(now)) else {
                break;
            };
            if self.perform(step, now)? == WindowRequest::Quit {
                return Ok(WindowRequest::Quit);
            }
        }
        let waits = self.again.is_some_and(|again| now.0 < again);
        if self.stale && !waits && self.pane().is_some() && !self.hidden {
            self.window.request_redraw();
        }
        Ok(WindowRequest::Nothing)
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

    /// Starts over on another device.
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
                    let drawer = self.ready.drawer(&device, style)?;
                    Ok((screen, drawer))
                });
            match opened {
                Ok((screen, drawer)) => {
                    self.player.live.recover(drawer);
                    self.screen = screen;
                    self.optics = None;
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
        let parts = self.player.parts(&pane);
        let mut pictures = Vec::new();
        for (number, part) in parts.iter().enumerate() {
            self.follow(&part.view)?;
            let marks = self.player.marks(&part.view);
            let drawer = self.player.live.drawer_mut();
            let picture = drawer.draw(&part.view, marks.as_ref())?;
            let picture = picture.context("a window's pictures are drawn by a GPU")?;
            let mut picture = picture.clone();
            let gpu = self.screen.gpu().clone();
            let changed = self.optics(&pane).draw(&gpu, number, &picture)?.cloned();
            if changed.is_some() || number + 1 < parts.len() {
                picture = self
                    .screen
                    .keep(number, changed.as_ref().unwrap_or(&picture));
            }
            pictures.push(PlacedPicture {
                picture,
                origin: part.origin,
                flips: part.flips,
            });
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

/// Pictures in their places, from the first column and row of any on; black between them.
fn laid_out(parts: &[PanePart], images: &[RgbaImage]) -> RgbaImage {
    let first = [0, 1].map(|k| parts.iter().map(|part| part.origin[k]).min().unwrap_or(0));
    let end = |part: &PanePart, k: usize| part.origin[k] + part.size[k];
    let last = [0, 1].map(|k| parts.iter().map(|part| end(part, k)).max().unwrap_or(1));
    let mut whole = RgbaImage::black([0, 1].map(|k| last[k] - first[k]));
    for (part, image) in parts.iter().zip(images) {
        let [w, h] = image.size;
        for y in 0..h {
            for x in 0..w {
                let flipped = |flips: bool, at: u32, side: u32| match flips {
                    true => side - 1 - at,
                    false => at,
                };
                let from = [flipped(part.flips[0], x, w), flipped(part.flips[1], y, h)];
                let to = [part.origin[0] - first[0] + x, part.origin[1] - first[1] + y];
                whole.set_pixel(to, image.pixel(from));
            }
        }
    }
    whole
}

/// Wakes the event loop from any thread.
fn waker(proxy: &EventLoopProxy<Wake>) -> impl Fn() + Send + 'static {
    let proxy = proxy.clone();
    move || {
        // A loop that has ended needs no waking.
        let _ = proxy.send_event(Wake);
    }
}
