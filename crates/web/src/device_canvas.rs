//! How does a picture get onto a canvas of the page?

use foveal_render::Gpu;
use web_sys::OffscreenCanvas;

/// Format of the canvas: that of the pictures, so that they are copied bit by bit.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// A canvas that pictures are copied to.
pub(crate) struct DeviceCanvas {
    element: OffscreenCanvas,
    surface: wgpu::Surface<'static>,
    configured: bool,
}

impl DeviceCanvas {
    /// Takes a canvas over; says why where that is not possible.
    pub(crate) fn new(element: OffscreenCanvas) -> Result<Self, String> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let target = wgpu::SurfaceTarget::OffscreenCanvas(element.clone());
        let surface = instance.create_surface(target);
        Ok(Self {
            surface: surface.map_err(|error| error.to_string())?,
            element,
            configured: false,
        })
    }

    /// Another device draws from now on.
    pub(crate) fn forget_device(&mut self) {
        self.configured = false;
    }

    /// Shows `picture` with its left top pixel at `origin` of a canvas of `size` pixels, and black
    /// round it.
    pub(crate) fn show(
        &mut self,
        gpu: &Gpu,
        picture: &wgpu::Texture,
        origin: [u32; 2],
        size: [u32; 2],
    ) {
        self.fit(gpu, size);
        use wgpu::CurrentSurfaceTexture as Current;
        let target = match self.surface.get_current_texture() {
            Current::Success(target) | Current::Suboptimal(target) => target,
            _ => {
                self.configured = false;
                return;
            }
        };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let covers = [picture.width(), picture.height()] == size;
        if !covers {
            clear(&mut encoder, &target.texture);
        }
        let into = wgpu::TexelCopyTextureInfo {
            origin: wgpu::Origin3d {
                x: origin[0],
                y: origin[1],
                z: 0,
            },
            ..target.texture.as_image_copy()
        };
        let part = wgpu::Extent3d {
            width: picture.width().min(size[0].saturating_sub(origin[0])),
            height: picture.height().min(size[1].saturating_sub(origin[1])),
            depth_or_array_layers: 1,
        };
        encoder.copy_texture_to_texture(picture.as_image_copy(), into, part);
        gpu.queue.submit([encoder.finish()]);
        gpu.queue.present(target);
    }

    fn fit(&mut self, gpu: &Gpu, size: [u32; 2]) {
        let now = [self.element.width(), self.element.height()];
        if self.configured && now == size {
            return;
        }
        self.element.set_width(size[0]);
        self.element.set_height(size[1]);
        self.surface.configure(
            &gpu.device,
            &wgpu::SurfaceConfiguration {
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_DST,
                format: FORMAT,
                color_space: Default::default(),
                width: size[0],
                height: size[1],
                present_mode: wgpu::PresentMode::Fifo,
                desired_maximum_frame_latency: 2,
                alpha_mode: wgpu::CompositeAlphaMode::Opaque,
                view_formats: Vec::new(),
            },
        );
        self.configured = true;
    }
}

fn clear(encoder: &mut wgpu::CommandEncoder, target: &wgpu::Texture) {
    let view = target.create_view(&Default::default());
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("bars"),
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
}
