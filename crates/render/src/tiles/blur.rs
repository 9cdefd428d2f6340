//! How is a finished picture blurred outside the fovea?

use crate::gpu::buffers::written;
use crate::gpu::device::Gpu;
use crate::gpu::picture_target::{Area, PictureTarget};
use crate::gpu::screen_pass::{Reads, ScreenPass};
use crate::params::BlurParams;
use crate::shaders;
use foveal_core::units::Radians;
use foveal_core::view::eye_view::EyeView;
use glam::DVec3;

/// Halvings at most: the widest Gaussian has a spread of 2^8 · 0.65 pixels.
const MOST_HALVINGS: u32 = 8;

/// Spread of the Gaussian over the minimum angle of resolution whose limit, half a cycle, it dims
/// to a half: sqrt(ln 2 / 2) / π over half a cycle.
const SIGMA_OF_RESOLUTION: f64 = 0.374_774_4;

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

impl RadialBlur {
    /// The view in whose picture a pixel is two by two of those of `view`: what is blurred outside
    /// the fovea can be drawn at half the size at once.
    #[must_use]
    pub fn half_view(view: &EyeView) -> EyeView {
        EyeView {
            size: half(view.size),
            ..*view
        }
    }

    /// Left, top, width and height of the pixels of `view` that show anything of the sharp picture,
    /// or of some more; beyond them only halves show. `None` where that is no pixel.
    pub(crate) fn sharp_pixels(&self, view: &EyeView, first: FirstHalf) -> Option<[u32; 4]> {
        let params = BlurParams::new(view, self, 1, first);
        // Pixels are widest at the axis, so the blur is slowest there.
        let pixels = f64::from(first.shown_variance()).sqrt();
        let radius = self.fovea.0 + pixels * f64::from(params.pitch / params.growth);
        let axes = view.axes;
        let at = [axes.right, axes.down, axes.forward].map(|axis| self.gaze.dot(axis));
        let field = view.field;
        let across = reach(
            at[0],
            at[2],
            radius,
            [field.left, field.right],
            view.size[0],
        )?;
        let down = reach(at[1], at[2], radius, [field.up, field.down], view.size[1])?;
        Some([across[0], down[0], across[1] - across[0], down[1] - down[0]])
    }
}

/// First and last pixel, of `count` over the tangents from `-low` to `high`, within `radius` of a
/// unit direction with these parts along the side and ahead.
fn reach(
    along: f64,
    ahead: f64,
    radius: f64,
    [low, high]: [f64; 2],
    count: u32,
) -> Option<[u32; 2]> {
    let level = along.hypot(ahead);
    // A cone about the view's other axis is seen all across.
    let half_angle = match radius.sin() < level && radius < std::f64::consts::FRAC_PI_2 {
        true => (radius.sin() / level).asin(),
        false => std::f64::consts::PI,
    };
    let tangent = |angle: f64| {
        let most = std::f64::consts::FRAC_PI_2 - 1e-6;
        angle.clamp(-most, most).tan()
    };
    let angle = along.atan2(ahead);
    let pixel = |angle| (tangent(angle) + low) / (low + high) * f64::from(count);
    let first = (pixel(angle - half_angle) - 1.0).floor();
    let last = (pixel(angle + half_angle) + 1.0).ceil();
    let [first, last] = [first, last].map(|k| k.clamp(0.0, f64::from(count)) as u32);
    (first < last).then_some([first, last])
}

/// How the first half came to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FirstHalf {
    /// Drawn by itself: a pixel is the mean of four.
    Drawn,
    /// From the whole picture by the pass `blur_halve`.
    Halved,
}

impl FirstHalf {
    /// Variance in pixels² that it has before it is read between its texels.
    pub(crate) fn variance(self) -> f32 {
        match self {
            Self::Drawn => 0.25,
            Self::Halved => 0.75,
        }
    }

    /// The same after: reading between two texels adds the sixth of a texel's square.
    pub(crate) fn shown_variance(self) -> f32 {
        self.variance() + 4.0 / 6.0
    }
}

impl BlurParams {
    /// The parameters of `blur` in pictures of `view` with this many halves.
    #[must_use]
    pub(crate) fn new(view: &EyeView, blur: &RadialBlur, halves: u32, first: FirstHalf) -> Self {
        let m = view.ray_from_pixel();
        let column = |c: DVec3| [c.x as f32, c.y as f32, c.z as f32, 0.0];
        Self {
            ray_from_pixel: [column(m.x_axis), column(m.y_axis), column(m.z_axis)],
            gaze: blur.gaze.as_vec3().to_array(),
            fovea_chord: (2.0 * (blur.fovea.0 / 2.0).sin()) as f32,
            fovea: blur.fovea.0 as f32,
            growth: (SIGMA_OF_RESOLUTION * blur.slope) as f32,
            pitch: (m.x_axis.length() * m.y_axis.length()).sqrt() as f32,
            last: halves as f32 - 1.0,
            first: first.variance(),
            unused: 0.0,
            unused_pair: [0.0; 2],
        }
    }
}

/// The passes, the halves and what is drawn.
pub(crate) struct Blur {
    halve: ScreenPass,
    radial: ScreenPass,
    uniform: wgpu::Buffer,
    sampler: wgpu::Sampler,
    halves: PictureTarget,
    output: PictureTarget,
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
            uniform: written(gpu, "blur", bytes, wgpu::BufferUsages::UNIFORM),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("between texels"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..wgpu::SamplerDescriptor::default()
            }),
            halves: PictureTarget::with_mips(gpu, half(size), halvings(size)),
            output: PictureTarget::new(gpu, size),
        }
    }

    /// The blur of pictures of `size` pixels that `kept` keeps from picture to picture.
    pub(crate) fn of_size<'a>(kept: &'a mut Option<Self>, gpu: &Gpu, size: [u32; 2]) -> &'a Self {
        let fits = kept.take().filter(|blur| blur.output.size() == size);
        kept.insert(fits.unwrap_or_else(|| Self::new(gpu, size)))
    }

    /// Where the first half is drawn by callers that draw it themselves.
    pub(crate) fn first_half(&self) -> &PictureTarget {
        &self.halves
    }

    /// Records what draws `picture` blurred, once a frame.
    pub(crate) fn record(
        &self,
        (gpu, encoder): (&Gpu, &mut wgpu::CommandEncoder),
        picture: &PictureTarget,
        view: &EyeView,
        blur: &RadialBlur,
        first: FirstHalf,
    ) -> &PictureTarget {
        let mips = self.halves.picture.mip_level_count();
        let params = BlurParams::new(view, blur, mips, first);
        gpu.queue
            .write_buffer(&self.uniform, 0, bytemuck::bytes_of(&params));
        let mip_view = |mip: u32| {
            self.halves
                .picture
                .create_view(&wgpu::TextureViewDescriptor {
                    base_mip_level: mip,
                    mip_level_count: Some(1),
                    ..wgpu::TextureViewDescriptor::default()
                })
        };
        let (mut larger, drawn) = match first {
            FirstHalf::Drawn => (mip_view(0), 1),
            FirstHalf::Halved => (picture.picture_view().clone(), 0),
        };
        for mip in drawn..mips {
            let smaller = mip_view(mip);
            let resources = [
                (5, wgpu::BindingResource::TextureView(&larger)),
                (6, wgpu::BindingResource::Sampler(&self.sampler)),
            ];
            let bound = self.halve.bind(gpu, &resources);
            self.halve.record(encoder, &bound, Area::of_view(&smaller));
            larger = smaller;
        }
        let halves = self.halves.picture.create_view(&Default::default());
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
        self.radial.record(encoder, &bound, self.output.whole());
        &self.output
    }
}

/// Halvings of a picture: until a side would be less than a pixel.
pub(crate) fn halvings(size: [u32; 2]) -> u32 {
    size[0].min(size[1]).max(2).ilog2().min(MOST_HALVINGS)
}

/// Columns and rows of a half.
pub(crate) fn half(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| (side / 2).max(1))
}
