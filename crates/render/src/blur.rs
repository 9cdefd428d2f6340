//! How is a finished picture blurred outside the fovea?

use crate::device::Gpu;
use crate::params::BlurParams;
use crate::passes::{FORMAT, Target};
use crate::screen_pass::{Reads, ScreenPass, buffer};
use crate::shaders;
use foveal_core::units::Radians;
use foveal_core::view::eye_view::EyeView;
use glam::DVec3;

/// Halvings at most: the widest Gaussian has a spread of 2^8 · 0.65 pixels.
const MOST_HALVINGS: u32 = 8;

/// A blur that grows with eccentricity (Kastner 2016, section 4.4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadialBlur {
    /// Where the eye looks, a unit direction of the content's space.
    pub gaze: DVec3,
    /// Radius that is left untouched.
    pub fovea: Radians,
    /// By how much the minimum angle of resolution grows with eccentricity.
    pub slope: f64,
}

impl RadialBlur {
    /// The blur round a gaze: a fovea of 2.5°, and the slope of the linear model, 0.022.
    #[must_use]
    pub fn round(gaze: DVec3) -> Self {
        Self {
            gaze,
            fovea: Radians::from_degrees(2.5),
            slope: 0.022,
        }
    }
}

/// The pass, its halves and what it draws.
pub(crate) struct Blur {
    halve: ScreenPass,
    radial: ScreenPass,
    uniform: wgpu::Buffer,
    sampler: wgpu::Sampler,
    halves: wgpu::Texture,
    output: Target,
}

impl Blur {
    /// A blur of pictures of `size` pixels.
    fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        let halve = [(5, Reads::Picture), (6, Reads::Sampler)];
        let radial = [
            (4, Reads::Uniform),
            (5, Reads::Picture),
            (6, Reads::Picture),
            (7, Reads::Sampler),
        ];
        let bytes = size_of::<BlurParams>() as u64;
        Self {
            halve: ScreenPass::new(gpu, &shaders::blur_halve(), &halve),
            radial: ScreenPass::new(gpu, &shaders::blur_radial(), &radial),
            uniform: buffer(gpu, "blur", bytes, wgpu::BufferUsages::UNIFORM),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("between texels"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..wgpu::SamplerDescriptor::default()
            }),
            halves: halves(gpu, size),
            output: Target::new(gpu, size),
        }
    }

    /// Draws `picture` blurred, with the blur that `kept` keeps from picture to picture.
    pub(crate) fn of<'a>(
        kept: &'a mut Option<Self>,
        gpu: &Gpu,
        picture: &Target,
        view: &EyeView,
        wanted: &RadialBlur,
    ) -> &'a Target {
        let size = picture.size();
        let fits = kept.take().filter(|blur| blur.output.size() == size);
        let blur = kept.insert(fits.unwrap_or_else(|| Self::new(gpu, size)));
        blur.draw(gpu, picture, view, wanted);
        &blur.output
    }

    /// Orders the passes from `picture` to [`Self::output`].
    fn draw(&self, gpu: &Gpu, picture: &Target, view: &EyeView, blur: &RadialBlur) {
        let params = BlurParams::new(view, blur, self.halves.mip_level_count());
        gpu.queue
            .write_buffer(&self.uniform, 0, bytemuck::bytes_of(&params));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut larger = picture.picture_view().clone();
        for mip in 0..self.halves.mip_level_count() {
            let smaller = self.halves.create_view(&wgpu::TextureViewDescriptor {
                base_mip_level: mip,
                mip_level_count: Some(1),
                ..wgpu::TextureViewDescriptor::default()
            });
            let resources = [
                (5, wgpu::BindingResource::TextureView(&larger)),
                (6, wgpu::BindingResource::Sampler(&self.sampler)),
            ];
            let bound = self.halve.bind(gpu, &resources);
            self.halve.draw(&mut encoder, &bound, &smaller);
            larger = smaller;
        }
        let halves = self.halves.create_view(&Default::default());
        let resources = [
            (4, self.uniform.as_entire_binding()),
            (
                5,
                wgpu::BindingResource::TextureView(picture.picture_view()),
            ),
            (6, wgpu::BindingResource::TextureView(&halves)),
            (7, wgpu::BindingResource::Sampler(&self.sampler)),
        ];
        let bound = self.radial.bind(gpu, &resources);
        self.radial
            .draw(&mut encoder, &bound, self.output.picture_view());
        gpu.queue.submit([encoder.finish()]);
    }
}

/// Halvings of a picture: until a side would be less than a pixel.
pub(crate) fn halvings(size: [u32; 2]) -> u32 {
    size[0].min(size[1]).max(2).ilog2().min(MOST_HALVINGS)
}

fn halves(gpu: &Gpu, size: [u32; 2]) -> wgpu::Texture {
    let [width, height] = size.map(|side| (side / 2).max(1));
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("halves"),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: halvings(size),
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    })
}
