//! What does each panel of a rig show, of a flat picture of all that it can reach?
//!
//! Content that is drawn for each panel needs no other source: what bends a panel moves places of
//! its own picture, what fades or tints it does so pixel by pixel. Both are the pass that fills
//! panels from one source, whose source here is a panel's own picture.

use super::pass::{LoadedPlan, Warper};
use super::plan::{PanelOnSource, WarpPlan};
use super::source::{SourceTexture, levels_of};
use super::style::{WarpFilter, WarpStyle};
use crate::error::RenderError;
use crate::gpu::device::Gpu;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::panel::placement::{Placement, SourceProjection};
use foveal_core::view::panel::rig::Panel;
#[cfg(not(target_arch = "wasm32"))]
use {
    crate::draw_device::DrawDevice,
    crate::image::RgbaImage,
    crate::twin::{self, TwinSource},
};

/// Makes what panels are sent out of flat pictures of [`Panel::reach`].
#[derive(Default)]
pub struct PanelOptics {
    /// A panel each; nothing for one that shows its picture as it is.
    panels: Vec<Option<OpticsPlan>>,
    warper: Option<Warper>,
    /// Pictures with their coarser levels, of every size that there is.
    sources: Vec<SourceTexture>,
}

/// How one panel is made.
struct OpticsPlan {
    plan: WarpPlan,
    /// Columns and rows of its flat picture.
    flat: [u32; 2],
    style: WarpStyle,
    loaded: Option<LoadedPlan>,
}

impl PanelOptics {
    /// Of panels that are seen together: those that overlap share their light.
    #[must_use]
    pub fn new(panels: &[Panel]) -> Self {
        if panels.iter().all(Panel::is_plain) {
            return Self {
                panels: panels.iter().map(|_| None).collect(),
                ..Self::default()
            };
        }
        let flats: Vec<EyeView> = panels.iter().map(Panel::reach).collect();
        let placements: Vec<Placement> = flats.iter().map(placement_of).collect();
        let placed: Vec<PanelOnSource<'_>> = panels
            .iter()
            .zip(&placements)
            .zip(&flats)
            .map(|((panel, placement), flat)| PanelOnSource {
                panel,
                placement,
                part: [0, 0, flat.size[0], flat.size[1]],
                origin: [0; 2],
            })
            .collect();
        let plans = WarpPlan::one_by_one(&placed).into_iter().zip(&flats);
        let one = |(panel, (plan, flat)): (&Panel, (WarpPlan, &EyeView))| {
            (!panel.is_plain()).then(|| OpticsPlan {
                plan,
                flat: flat.size,
                style: style_of(panel),
                loaded: None,
            })
        };
        Self {
            panels: panels.iter().zip(plans).map(one).collect(),
            ..Self::default()
        }
    }

    /// Whether a panel is sent anything but its picture as it is.
    #[must_use]
    pub fn changes(&self, panel: usize) -> bool {
        self.panels.get(panel).is_some_and(Option::is_some)
    }

    /// The picture that a panel is sent, of its flat picture on the GPU: a texture of sRGB codes,
    /// which the next call for this panel reuses; `None` where that picture is it. All calls are on
    /// one GPU.
    ///
    /// # Errors
    /// The flat picture has not the size of [`Panel::reach`], or the device has no room for it.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        panel: usize,
        flat: &wgpu::Texture,
    ) -> Result<Option<&wgpu::Texture>, RenderError> {
        let Some(Some(one)) = self.panels.get_mut(panel) else {
            return Ok(None);
        };
        one.check([flat.width(), flat.height()])?;
        let warper = self.warper.get_or_insert_with(|| Warper::new(gpu));
        let source = source_for(&mut self.sources, gpu, one)?;
        let mut encoder = gpu.encoder("flat picture of a panel");
        let to = source.texture.as_image_copy();
        encoder.copy_texture_to_texture(flat.as_image_copy(), to, flat.size());
        gpu.submit(encoder);
        let (plan, style) = one.loaded(warper)?;
        Ok(Some(warper.draw(plan, source, &style)))
    }

    /// The same of a picture in main memory, drawn by a device and back. Blocks.
    ///
    /// # Errors
    /// As [`Self::draw`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn image(
        &mut self,
        device: &DrawDevice,
        panel: usize,
        flat: RgbaImage,
    ) -> Result<RgbaImage, RenderError> {
        let Some(Some(one)) = self.panels.get_mut(panel) else {
            return Ok(flat);
        };
        one.check(flat.size)?;
        let DrawDevice::Gpu(gpu) = device else {
            let source = TwinSource::new(&flat, one.style.filter.reads_levels());
            return Ok(twin::warp(&source, &one.plan, &one.style));
        };
        let warper = self.warper.get_or_insert_with(|| Warper::new(gpu));
        let source = source_for(&mut self.sources, gpu, one)?;
        source.write(gpu, &flat)?;
        let (plan, style) = one.loaded(warper)?;
        warper.read(plan, source, &style).wait(gpu)
    }
}

impl OpticsPlan {
    fn check(&self, flat: [u32; 2]) -> Result<(), RenderError> {
        match flat == self.flat {
            true => Ok(()),
            false => Err(RenderError::Misfit {
                what: "the flat picture of a panel".to_owned(),
                expected: format!("{:?} pixels", self.flat),
                found: format!("{flat:?} pixels"),
            }),
        }
    }

    /// Its plan on the GPU.
    fn loaded(&mut self, warper: &Warper) -> Result<(&LoadedPlan, WarpStyle), RenderError> {
        let loaded = match self.loaded.take() {
            Some(loaded) => loaded,
            None => warper.load(&self.plan)?,
        };
        Ok((self.loaded.insert(loaded), self.style))
    }
}

/// A plane that a view sees all of, and nothing else.
fn placement_of(flat: &EyeView) -> Placement {
    let f = flat.field;
    let window = [f.left, f.right, f.up, f.down];
    Placement::new(SourceProjection::Plane, flat.axes, window)
}

/// What is not bent lies pixel on pixel.
fn style_of(panel: &Panel) -> WarpStyle {
    WarpStyle {
        filter: match panel.distortion.is_none() {
            true => WarpFilter::Bilinear,
            false => WarpFilter::Auto,
        },
        ..WarpStyle::default()
    }
}

/// The texture for a panel's flat picture, made where none has its size.
fn source_for<'a>(
    sources: &'a mut Vec<SourceTexture>,
    gpu: &Gpu,
    one: &OpticsPlan,
) -> Result<&'a SourceTexture, RenderError> {
    let has_levels = one.style.filter.reads_levels();
    let count = if has_levels {
        levels_of(one.flat) as usize
    } else {
        1
    };
    let fits = |it: &SourceTexture| it.size() == one.flat && it.levels.len() == count;
    let at = match sources.iter().position(fits) {
        Some(at) => at,
        None => {
            sources.push(SourceTexture::new(gpu, one.flat, has_levels)?);
            sources.len() - 1
        }
    };
    Ok(&sources[at])
}
