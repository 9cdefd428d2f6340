//! How do panels come onto monitors, one window a surface?
//!
//! Where there is one window, the pass that warps draws into it; several share what it drew.

use super::args::WarpArgs;
use super::device::most_side_of;
use super::laid::Laid;
use super::sent::SentLayout;
use super::source::{PanelSource, SourceFrame};
use crate::commands::view::screen::{instance, request_adapter};
use crate::report::output::{WrongUsage, say};
use anyhow::{Context, anyhow, bail};
use foveal_core::view::panel::rig::{Panel, Rig};
use foveal_render::warp::{LoadedPlan, SourceTexture, WarpStyle, Warper};
use foveal_render::{Gpu, RgbaImage};
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::{PhysicalPosition, PhysicalSize};
use winit::event::{ElementState, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::{Key, NamedKey};
use winit::monitor::MonitorHandle;
use winit::window::{Fullscreen, Window, WindowId};

/// How long nothing is looked for.
const PAUSE: Duration = Duration::from_millis(3);

/// Shows a source on all panels until a window is closed, or so many frames were shown; how many
/// were, where the source lay, and what drew.
pub(super) fn run(
    args: &WarpArgs,
    rig: &Rig,
    panels: &[&Panel],
    source: &mut PanelSource,
) -> anyhow::Result<(u32, Laid, String)> {
    let laid = args.lay(rig, panels, (source, u32::MAX))?;
    let event_loop = EventLoop::new().map_err(|reason| {
        anyhow!(
            "--window: no display ({reason}); set DISPLAY or WAYLAND_DISPLAY, or give --out DIR"
        )
    })?;
    let mut app = App {
        instance: instance(event_loop.owned_display_handle()),
        args,
        rig,
        panels,
        source,
        laid,
        open: None,
        next: None,
        begun: Instant::now(),
        frames: 0,
        result: Ok(()),
    };
    event_loop
        .run_app(&mut app)
        .map_err(|reason| anyhow!("the display ended the run: {reason}"))?;
    app.result?;
    let open = app.open.context("no window was opened")?;
    Ok((app.frames, app.laid, open.gpu.adapter_name().to_owned()))
}

struct App<'a> {
    instance: wgpu::Instance,
    args: &'a WarpArgs,
    rig: &'a Rig,
    panels: &'a [&'a Panel],
    source: &'a mut PanelSource,
    laid: Laid,
    open: Option<Windows>,
    /// What is shown next, when it is due.
    next: Option<SourceFrame>,
    begun: Instant,
    frames: u32,
    result: anyhow::Result<()>,
}

/// The windows, and what fills them.
struct Windows {
    gpu: Gpu,
    all: Vec<PanelWindow>,
    warper: Warper,
    plan: LoadedPlan,
    texture: SourceTexture,
    style: WarpStyle,
}

/// The window of a surface.
struct PanelWindow {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    /// First column of the surface in the atlas, its columns and its rows.
    part: [u32; 3],
}

impl ApplicationHandler for App<'_> {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.open.is_none() {
            match self.open_windows(event_loop) {
                Ok(open) => self.open = Some(open),
                Err(error) => self.end(event_loop, Err(error)),
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let closes = match &event {
            WindowEvent::CloseRequested => true,
            WindowEvent::KeyboardInput { event, .. } => {
                let is_pressed = event.state == ElementState::Pressed;
                is_pressed && is_end(&event.logical_key)
            }
            _ => false,
        };
        if closes {
            return event_loop.exit();
        }
        let shows = matches!(
            event,
            WindowEvent::RedrawRequested | WindowEvent::Resized(_)
        );
        let shown = match &mut self.open {
            Some(open) if shows && self.frames > 0 => open.show(),
            _ => Ok(()),
        };
        if let Err(error) = shown {
            self.end(event_loop, Err(error));
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        if self.args.frames.is_some_and(|most| self.frames >= most) {
            return event_loop.exit();
        }
        match self.go_on() {
            // A picture is one frame, however many were asked for.
            Ok(None) if self.args.frames.is_some() && self.has_ended() => event_loop.exit(),
            Ok(next) => event_loop.set_control_flow(match next {
                Some(wait) => ControlFlow::WaitUntil(Instant::now() + wait),
                None => ControlFlow::Wait,
            }),
            Err(error) => self.end(event_loop, Err(error)),
        }
    }
}

fn is_end(key: &Key) -> bool {
    match key {
        Key::Named(NamedKey::Escape) => true,
        Key::Character(letter) => letter.eq_ignore_ascii_case("q"),
        _ => false,
    }
}

impl App<'_> {
    fn end(&mut self, event_loop: &ActiveEventLoop, result: anyhow::Result<()>) {
        self.result = result;
        event_loop.exit();
    }

    /// Whether something was shown and nothing more comes.
    fn has_ended(&self) -> bool {
        self.frames > 0 && !matches!(*self.source, PanelSource::Live(_))
    }

    /// Shows what is due; how long to wait for what comes next, where anything does.
    fn go_on(&mut self) -> anyhow::Result<Option<Duration>> {
        let Some(open) = &mut self.open else {
            return Ok(None);
        };
        if self.next.is_none() {
            self.next = match &mut *self.source {
                PanelSource::Live(live) => live.newest_frame(),
                source => source.frame(self.frames, &self.laid.parts)?,
            };
        }
        let Some(frame) = &self.next else {
            return Ok(self.source.live().and_then(|live| live.goes_on(PAUSE)));
        };
        let early = frame.due.saturating_sub(self.begun.elapsed());
        if !early.is_zero() {
            return Ok(Some(early.min(PAUSE)));
        }
        // A window that is captured may have another size now.
        if frame.picture.size != open.texture.size() {
            let placed = (&*self.source, most_side_of(&open.gpu));
            self.laid = self.args.lay(self.rig, self.panels, placed)?;
            open.fit(self.args, self.panels, &self.laid)?;
        }
        open.take(&frame.picture)?;
        open.show()?;
        self.next = None;
        self.frames += 1;
        Ok(Some(Duration::ZERO))
    }

    fn open_windows(&mut self, event_loop: &ActiveEventLoop) -> anyhow::Result<Windows> {
        let layout = SentLayout::of(self.panels);
        let mut all = Vec::new();
        let mut shared: Option<(wgpu::Adapter, Gpu)> = None;
        for (name, part) in layout.parts() {
            let monitor = self.monitor_of(name);
            let window = open_window(event_loop, (name, part), monitor)?;
            let surface = self.instance.create_surface(Arc::clone(&window))?;
            if shared.is_none() {
                let adapter = request_adapter(&self.instance, &surface)?;
                let gpu = pollster::block_on(Gpu::of_adapter(&adapter))?;
                shared = Some((adapter, gpu));
            }
            if let Some((adapter, gpu)) = &shared {
                let config = configuration(&surface, adapter, &window)?;
                surface.configure(&gpu.device, &config);
                all.push(PanelWindow {
                    window,
                    surface,
                    config,
                    part,
                });
            }
        }
        let (_, gpu) = shared.context("the rig has no surface")?;
        let most = most_side_of(&gpu);
        if self
            .laid
            .need
            .is_some_and(|need| need.iter().any(|side| *side > most))
        {
            self.laid = self
                .args
                .lay(self.rig, self.panels, (&*self.source, most))?;
            self.args.tell_shrunk(&self.laid);
        }
        let Some(filter) = self.args.filter_name().of_pass() else {
            bail!(WrongUsage(
                "--filter ewa: is drawn on the CPU and too slow for a window; give --out, or \
                 another filter"
                    .to_owned()
            ));
        };
        let style = WarpStyle {
            filter,
            paints: self.args.show_anisotropy,
        };
        let warper = Warper::onto(&gpu, all[0].config.format);
        Ok(Windows {
            plan: warper.load(&self.args.plan(self.panels, &self.laid, &layout))?,
            texture: SourceTexture::new(&gpu, self.laid.size, filter.reads_levels())?,
            warper,
            style,
            all,
            gpu,
        })
    }

    /// The monitor that the rig names for a surface; of panels without one nothing.
    fn monitor_of(&self, surface: &str) -> &str {
        let mut panels = self.panels.iter().map(|it| &it.output);
        let named = panels.find(|it| it.surface == surface && !it.monitor.is_empty());
        named.map_or("", |it| it.monitor.as_str())
    }
}

impl Windows {
    /// Makes room for a source that lies elsewhere or has another size.
    fn fit(&mut self, args: &WarpArgs, panels: &[&Panel], laid: &Laid) -> anyhow::Result<()> {
        let plan = args.plan(panels, laid, &SentLayout::of(panels));
        self.plan = self.warper.load(&plan)?;
        let has_levels = self.style.filter.reads_levels();
        self.texture = SourceTexture::new(&self.gpu, laid.size, has_levels)?;
        Ok(())
    }

    fn take(&mut self, picture: &RgbaImage) -> anyhow::Result<()> {
        Ok(self.texture.write(&self.gpu, picture)?)
    }

    /// Fills all windows.
    fn show(&mut self) -> anyhow::Result<()> {
        let mut targets = Vec::new();
        for it in &mut self.all {
            targets.push(it.target(&self.gpu));
        }
        let mut encoder = self.gpu.encoder("windows");
        let (plan, texture, style) = (&self.plan, &self.texture, &self.style);
        match &targets[..] {
            [Some(target)] => {
                let view = target.texture.create_view(&Default::default());
                let size = [target.texture.width(), target.texture.height()];
                let onto = (&view, size, None);
                self.warper
                    .record_onto(&mut encoder, plan, texture, style, onto);
            }
            _ => {
                self.warper.record(&mut encoder, plan, texture, style, None);
                for (it, target) in self.all.iter().zip(&targets) {
                    if let Some(target) = target {
                        it.copy(&mut encoder, plan.atlas(), &target.texture);
                    }
                }
            }
        }
        self.gpu.submit(encoder);
        for target in targets.into_iter().flatten() {
            self.gpu.queue.present(target);
        }
        Ok(())
    }
}

impl PanelWindow {
    /// What is drawn into next; `None` while the window is hidden.
    fn target(&mut self, gpu: &Gpu) -> Option<wgpu::SurfaceTexture> {
        let size = self.window.inner_size();
        let size = [size.width, size.height];
        if size.contains(&0) {
            return None;
        }
        if size != [self.config.width, self.config.height] {
            [self.config.width, self.config.height] = size;
            self.surface.configure(&gpu.device, &self.config);
        }
        for _ in 0..2 {
            match self.surface.get_current_texture() {
                wgpu::CurrentSurfaceTexture::Success(target)
                | wgpu::CurrentSurfaceTexture::Suboptimal(target) => return Some(target),
                wgpu::CurrentSurfaceTexture::Timeout | wgpu::CurrentSurfaceTexture::Occluded => {
                    return None;
                }
                _ => self.surface.configure(&gpu.device, &self.config),
            }
        }
        None
    }

    /// Copies this window's part of the atlas, as far as it has room.
    fn copy(&self, encoder: &mut wgpu::CommandEncoder, atlas: &wgpu::Texture, to: &wgpu::Texture) {
        let [first, columns, rows] = self.part;
        let origin = wgpu::Origin3d {
            x: first,
            y: 0,
            z: 0,
        };
        let from = wgpu::TexelCopyTextureInfo {
            origin,
            ..atlas.as_image_copy()
        };
        let size = wgpu::Extent3d {
            width: columns.min(to.width()),
            height: rows.min(to.height()),
            depth_or_array_layers: 1,
        };
        encoder.copy_texture_to_texture(from, to.as_image_copy(), size);
    }
}

/// A window as large as its surface; on a monitor that is named, all of that.
fn open_window(
    event_loop: &ActiveEventLoop,
    (name, [first, columns, rows]): (&str, [u32; 3]),
    monitor: &str,
) -> anyhow::Result<Arc<Window>> {
    let mut attributes = Window::default_attributes()
        .with_title(format!("{name} - Foveal panels"))
        .with_inner_size(PhysicalSize::new(columns, rows));
    if monitor.is_empty() {
        let beside = PhysicalPosition::new(first, 0);
        attributes = attributes.with_position(beside);
    } else {
        let found = monitor_called(event_loop, name, monitor)?;
        let size = found.size();
        if size.width < columns || size.height < rows {
            say(&format!(
                "monitor {monitor} has {} x {} pixels, and surface {name} {columns} x {rows}: the \
                 rest is not seen",
                size.width, size.height
            ));
        }
        attributes = attributes.with_fullscreen(Some(Fullscreen::Borderless(Some(found))));
    }
    let window = event_loop.create_window(attributes);
    Ok(Arc::new(window.map_err(|reason| {
        anyhow!("--window: no window can be opened: {reason}; is there a display?")
    })?))
}

fn monitor_called(
    event_loop: &ActiveEventLoop,
    surface: &str,
    monitor: &str,
) -> anyhow::Result<MonitorHandle> {
    let all: Vec<MonitorHandle> = event_loop.available_monitors().collect();
    let found = all.iter().find(|it| it.name().as_deref() == Some(monitor));
    found.cloned().with_context(|| {
        let names: Vec<String> = all.iter().filter_map(MonitorHandle::name).collect();
        let found = match names.is_empty() {
            true => "none has a name".to_owned(),
            false => {
                let names = names.iter().map(|it| format!("{it:?}"));
                format!("found: {}", names.collect::<Vec<_>>().join(", "))
            }
        };
        format!("surface {surface:?}: no monitor {monitor:?}; {found}")
    })
}

/// Takes codes as sRGB, and waits for the display.
fn configuration(
    surface: &wgpu::Surface<'_>,
    adapter: &wgpu::Adapter,
    window: &Window,
) -> anyhow::Result<wgpu::SurfaceConfiguration> {
    let size = window.inner_size();
    let [w, h] = [size.width, size.height].map(|side| side.max(1));
    let capabilities = surface.get_capabilities(adapter);
    let config = surface.get_default_config(adapter, w, h);
    let format = capabilities.formats.iter().find(|it| it.is_srgb());
    let copies = capabilities.usages.contains(wgpu::TextureUsages::COPY_DST);
    let (Some(mut config), Some(format), true) = (config, format, copies) else {
        bail!(
            "{}: its windows take no sRGB codes; give --out",
            adapter.get_info().name
        );
    };
    config.format = *format;
    config.usage |= wgpu::TextureUsages::COPY_DST;
    config.present_mode = wgpu::PresentMode::Fifo;
    Ok(config)
}
