//! How does a picture come into a window, with words over it?

use anyhow::bail;
use egui::{Color32, Rect, pos2, vec2};
use egui_wgpu::{RendererOptions, ScreenDescriptor};
use foveal_render::{Gpu, RenderError};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;
use winit::window::Window;

/// A window's surface on a device.
pub(crate) struct WindowSurface {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    gpu: Gpu,
    health: Arc<Health>,
    egui: egui::Context,
    painter: egui_wgpu::Renderer,
    /// The pictures as egui knows them, in the order in which they are shown.
    pictures: Vec<(wgpu::Texture, egui::TextureId)>,
    /// Pictures that were kept while those after them were drawn, by their number.
    kept: Vec<Option<wgpu::Texture>>,
}

/// What the driver reported about the device.
#[derive(Debug, Default)]
struct Health {
    lost: AtomicBool,
    errors: AtomicU64,
}

/// Pictures and where they go.
pub(crate) struct Placed {
    /// In order.
    pub(crate) pictures: Vec<PlacedPicture>,
    pub(crate) pixels_per_point: f32,
}

/// A picture and where it goes.
pub(crate) struct PlacedPicture {
    pub(crate) picture: wgpu::Texture,
    /// Its left and top in the window, in pixels.
    pub(crate) origin: [u32; 2],
    /// Whether left is shown right, and up down.
    pub(crate) flips: [bool; 2],
}

/// What became of showing a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Showing {
    Shown,
    /// The window cannot be seen now.
    Hidden,
    /// Try again at once.
    Again,
}

/// The instance that windows of this display live on.
pub(crate) fn instance(display: winit::event_loop::OwnedDisplayHandle) -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_with_display_handle(Box::new(display))
    })
}

impl WindowSurface {
    /// Opens a device that can show pictures in a window; `woken` is called when it is lost.
    pub(crate) fn open(
        instance: &wgpu::Instance,
        window: &Arc<Window>,
        woken: impl Fn() + Send + 'static,
    ) -> anyhow::Result<Self> {
        let surface = instance
            .create_surface(Arc::clone(window))
            .map_err(|reason| RenderError::NoAdapter(reason.to_string()))?;
        let adapter = request_adapter(instance, &surface)?;
        let gpu = pollster::block_on(Gpu::of_adapter(&adapter))?;
        let device = &gpu.device;
        let health = Arc::new(Health::default());
        let lost = Arc::clone(&health);
        device.set_device_lost_callback(move |_, _| {
            lost.lost.store(true, Ordering::Relaxed);
            woken();
        });
        let errors = Arc::clone(&health);
        device.on_uncaptured_error(Arc::new(move |_| {
            errors.errors.fetch_add(1, Ordering::Relaxed);
        }));
        let config = configuration(&surface, &adapter, window)?;
        surface.configure(device, &config);
        let options = RendererOptions {
            dithering: false,
            ..RendererOptions::default()
        };
        Ok(Self {
            painter: egui_wgpu::Renderer::new(device, config.format, options),
            surface,
            config,
            gpu,
            health,
            egui: egui::Context::default(),
            pictures: Vec::new(),
            kept: Vec::new(),
        })
    }

    pub(crate) fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    pub(crate) fn is_lost(&self) -> bool {
        self.health.lost.load(Ordering::Relaxed)
    }

    /// Lets the driver report what happened: a lost device, finished uploads.
    pub(crate) fn listen(&self) {
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
    }

    /// What the driver complained about since the last call.
    pub(crate) fn take_errors(&self) -> u64 {
        self.health.errors.swap(0, Ordering::Relaxed)
    }

    /// Fits the surface to a window of `size` pixels; a window without pixels is left alone.
    pub(crate) fn resize(&mut self, size: [u32; 2]) {
        if size.contains(&0) || size == [self.config.width, self.config.height] {
            return;
        }
        [self.config.width, self.config.height] = size;
        self.surface.configure(&self.gpu.device, &self.config);
    }

    /// A copy of the codes of the picture of a number, which stays when the next one is drawn into
    /// its texture.
    pub(crate) fn keep(&mut self, number: usize, picture: &wgpu::Texture) -> wgpu::Texture {
        let size = picture.size();
        let device = &self.gpu.device;
        if self.kept.len() <= number {
            self.kept.resize(number + 1, None);
        }
        let kept = self.kept[number].take().filter(|kept| kept.size() == size);
        let kept = kept.unwrap_or_else(|| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("picture next to another"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: picture.format().remove_srgb_suffix(),
                usage: wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_texture(picture.as_image_copy(), kept.as_image_copy(), size);
        self.gpu.queue.submit([encoder.finish()]);
        self.kept[number] = Some(kept.clone());
        kept
    }

    /// Shows pictures pixel for pixel, black around them, and over it what `words` paints; once
    /// they are drawn, `waits` says how long they are to wait.
    pub(crate) fn show(
        &mut self,
        placed: &Placed,
        words: impl FnMut(&egui::Painter),
        waits: Option<impl FnOnce() -> Duration>,
    ) -> anyhow::Result<Showing> {
        use wgpu::CurrentSurfaceTexture as Current;
        let (target, fits) = match self.surface.get_current_texture() {
            Current::Success(target) => (target, true),
            Current::Suboptimal(target) => (target, false),
            Current::Timeout | Current::Occluded => return Ok(Showing::Hidden),
            Current::Outdated | Current::Lost | Current::Validation => {
                if !self.is_lost() {
                    self.surface.configure(&self.gpu.device, &self.config);
                }
                return Ok(Showing::Again);
            }
        };
        let size = [target.texture.width(), target.texture.height()];
        let output = self.lay_out(placed, size, words);
        self.paint(&target.texture, size, output);
        if let Some(waits) = waits {
            // A lost device is noticed where it is used next.
            let _ = self.gpu.device.poll(wgpu::PollType::wait_indefinitely());
            std::thread::sleep(waits());
        }
        self.gpu.queue.present(target);
        if !fits {
            self.surface.configure(&self.gpu.device, &self.config);
        }
        Ok(Showing::Shown)
    }

    /// The pictures and the words, as shapes.
    fn lay_out(
        &mut self,
        placed: &Placed,
        size: [u32; 2],
        mut words: impl FnMut(&egui::Painter),
    ) -> egui::FullOutput {
        let scale = placed.pixels_per_point;
        let points = |pixels: u32| pixels as f32 / scale;
        let whole = Rect::from_min_size(pos2(0.0, 0.0), size.map(points).into());
        let mut pictures = Vec::new();
        for (at, placed) in placed.pictures.iter().enumerate() {
            let [left, top] = placed.origin.map(points);
            let picture = &placed.picture;
            let side = vec2(points(picture.width()), points(picture.height()));
            let rect = Rect::from_min_size(pos2(left, top), side);
            let [x, y] = placed.flips.map(|flips| if flips { 1.0 } else { 0.0 });
            let uv = Rect::from_min_max(pos2(x, y), pos2(1.0 - x, 1.0 - y));
            pictures.push((self.picture_id(at, picture), rect, uv));
        }
        let mut input = egui::RawInput {
            screen_rect: Some(whole),
            max_texture_side: Some(self.gpu.device.limits().max_texture_dimension_2d as usize),
            ..egui::RawInput::default()
        };
        let viewport = input.viewports.entry(input.viewport_id).or_default();
        viewport.native_pixels_per_point = Some(scale);
        self.egui.run_ui(input, |ui| {
            for (id, rect, uv) in &pictures {
                ui.painter().image(*id, *rect, *uv, Color32::WHITE);
            }
            words(ui.painter());
        })
    }

    fn picture_id(&mut self, at: usize, picture: &wgpu::Texture) -> egui::TextureId {
        let nearest = wgpu::FilterMode::Nearest;
        let device = &self.gpu.device;
        match self.pictures.get_mut(at) {
            Some((known, id)) if known == picture => *id,
            Some((known, id)) => {
                let view = picture.create_view(&wgpu::TextureViewDescriptor::default());
                self.painter
                    .update_egui_texture_from_wgpu_texture(device, &view, nearest, *id);
                *known = picture.clone();
                *id
            }
            None => {
                let view = picture.create_view(&wgpu::TextureViewDescriptor::default());
                let id = self.painter.register_native_texture(device, &view, nearest);
                self.pictures.push((picture.clone(), id));
                id
            }
        }
    }

    /// Paints shapes over black.
    fn paint(&mut self, target: &wgpu::Texture, size: [u32; 2], output: egui::FullOutput) {
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let mut textures = output.textures_delta;
        for (id, deltas) in textures.set.drain() {
            for delta in &deltas {
                self.painter.update_texture(device, queue, id, delta);
            }
        }
        let descriptor = ScreenDescriptor {
            size_in_pixels: size,
            pixels_per_point: output.pixels_per_point,
        };
        let shapes = self.egui.tessellate(output.shapes, output.pixels_per_point);
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut buffers =
            self.painter
                .update_buffers(device, queue, &mut encoder, &shapes, &descriptor);
        let view = target.create_view(&wgpu::TextureViewDescriptor::default());
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("window"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        let mut pass = pass.forget_lifetime();
        self.painter.render(&mut pass, &shapes, &descriptor);
        drop(pass);
        buffers.push(encoder.finish());
        queue.submit(buffers);
        for id in textures.free.drain() {
            self.painter.free_texture(&id);
        }
    }
}

pub(crate) fn request_adapter(
    instance: &wgpu::Instance,
    surface: &wgpu::Surface<'_>,
) -> anyhow::Result<wgpu::Adapter> {
    let mut options = wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::HighPerformance,
        compatible_surface: Some(surface),
        ..wgpu::RequestAdapterOptions::default()
    };
    if let Ok(adapter) = pollster::block_on(instance.request_adapter(&options)) {
        return Ok(adapter);
    }
    options.force_fallback_adapter = true;
    let adapter = pollster::block_on(instance.request_adapter(&options));
    Ok(adapter.map_err(|reason| RenderError::NoAdapter(reason.to_string()))?)
}

/// Waits for the display, and takes colours as they are.
fn configuration(
    surface: &wgpu::Surface<'_>,
    adapter: &wgpu::Adapter,
    window: &Window,
) -> anyhow::Result<wgpu::SurfaceConfiguration> {
    let size = window.inner_size();
    let [w, h] = [size.width, size.height].map(|side| side.max(1));
    let Some(mut config) = surface.get_default_config(adapter, w, h) else {
        bail!("{}: cannot draw in this window", adapter.get_info().name);
    };
    let formats = surface.get_capabilities(adapter).formats;
    let plain = [
        wgpu::TextureFormat::Bgra8Unorm,
        wgpu::TextureFormat::Rgba8Unorm,
    ];
    if let Some(format) = plain.into_iter().find(|format| formats.contains(format)) {
        config.format = format;
    }
    config.present_mode = wgpu::PresentMode::Fifo;
    Ok(config)
}
pub(crate) mod overlay;
pub(crate) mod screenshot;
pub(crate) mod words;
