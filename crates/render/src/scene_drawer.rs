//! What draws a scene's units: the GPU, its CPU twin, or nothing?

use crate::draw_device::{DrawDevice, DrawnPicture};
use crate::error::RenderError;
#[cfg(not(target_arch = "wasm32"))]
use crate::image::RgbaImage;
use crate::scene::coming::{Coming, Refiners};
use crate::scene::layer::SceneLayer;
use crate::scene::measuring::Measuring;
use crate::scene::params::SceneStyle;
use crate::twin::TwinScene;
use crate::under::Under;
use foveal_core::content::scene::description::{SceneObject, SceneTexture};
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::footprints::Footprints;
use foveal_core::perception::moment::Moment;
use foveal_core::view::eye_view::EyeView;
use std::collections::{BTreeMap, HashSet};

/// Units of a scene and what draws them.
pub struct SceneDrawer {
    device: DrawDevice,
    engine: Engine,
    measuring: Measuring,
}

enum Engine {
    Gpu(Box<SceneLayer>),
    Twin(Box<TwinScene>),
    Nothing,
}

impl SceneDrawer {
    /// No unit of these objects and textures; units may take `most_bytes` of a GPU's memory.
    ///
    /// # Errors
    /// The objects stand in more places than the device binds.
    pub fn new(
        device: &DrawDevice,
        objects: &[SceneObject],
        textures: &[SceneTexture],
        most_bytes: u64,
    ) -> Result<Self, RenderError> {
        let engine = match device {
            DrawDevice::Gpu(gpu) => {
                let layer = SceneLayer::new(gpu, objects, textures, most_bytes)?;
                Engine::Gpu(Box::new(layer))
            }
            DrawDevice::Twin => Engine::Twin(Box::new(TwinScene::new(objects, textures))),
            DrawDevice::Nothing => Engine::Nothing,
        };
        Ok(Self {
            device: device.clone(),
            engine,
            measuring: Measuring::default(),
        })
    }

    /// What draws.
    #[must_use]
    pub fn device(&self) -> &DrawDevice {
        &self.device
    }

    /// Adds a unit after its prerequisites; one that is there stays as it is. `false` where
    /// there is no room for it and what is coarser is shown.
    ///
    /// # Errors
    /// It does not fit to what is there or into the GPU's memory: nothing changed then.
    pub fn upload(&mut self, coming: &Coming<'_>) -> Result<bool, RenderError> {
        if coming.payload.morphs() {
            self.measuring.forget();
        }
        match &mut self.engine {
            Engine::Gpu(layer) => layer.upload(coming),
            Engine::Twin(twin) => twin.upload(coming).map(|()| true),
            Engine::Nothing => Ok(true),
        }
    }

    /// Draws only units that are wanted, what these need, and roots. Of the others those stay that
    /// are `staying`, first what is to stay longest, each after those that it needs.
    pub fn keep(&mut self, wanted: &HashSet<UnitId>, staying: &[UnitId]) {
        self.measuring.forget();
        match &mut self.engine {
            Engine::Gpu(layer) => layer.keep(wanted, staying),
            Engine::Twin(twin) => twin.keep(wanted, staying),
            Engine::Nothing => {}
        }
    }

    /// Draws a unit again that stayed, after those that it needs; `false` where it did not stay.
    pub fn show(&mut self, unit: UnitId) -> bool {
        self.measuring.forget();
        match &mut self.engine {
            Engine::Gpu(layer) => layer.show(unit),
            Engine::Twin(twin) => twin.show(unit),
            Engine::Nothing => true,
        }
    }

    /// From now on the new vertices of these units have gone so much of their way from the coarse
    /// surface, 0 to 1, and all others are in their places.
    pub fn morph(&mut self, shares: &BTreeMap<UnitId, f64>) {
        match &mut self.engine {
            Engine::Gpu(layer) => layer.morph(shares),
            Engine::Twin(twin) => twin.morph(shares),
            Engine::Nothing => {}
        }
    }

    /// From now on these are the units that would refine clusters, each by its unit and its number
    /// in it: what an image of ids shows.
    pub fn set_refiners(&mut self, refiners: Refiners) {
        match &mut self.engine {
            Engine::Gpu(layer) => layer.set_refiners(refiners),
            Engine::Twin(twin) => twin.set_refiners(refiners),
            Engine::Nothing => {}
        }
    }

    /// From now on paints over pictures what the unit is worth that would refine what a pixel
    /// shows, 0 to 1 by its number, less than 0 where that is not known; or nothing.
    ///
    /// # Errors
    /// The device binds no buffer for as many units.
    pub fn mark(&mut self, worths: Option<&[f32]>) -> Result<(), RenderError> {
        match &mut self.engine {
            Engine::Gpu(layer) => layer.mark(worths),
            Engine::Twin(twin) => {
                twin.mark(worths);
                Ok(())
            }
            Engine::Nothing => Ok(()),
        }
    }

    /// Triangles of the clusters that a picture is drawn of, also of those that cannot be seen,
    /// each where it stands.
    #[must_use]
    pub fn triangles_drawn(&self) -> u64 {
        match &self.engine {
            Engine::Gpu(layer) => layer.triangles_drawn(),
            Engine::Twin(twin) => twin.triangles_drawn(),
            Engine::Nothing => 0,
        }
    }

    /// Bytes of GPU memory of units and tables.
    #[must_use]
    pub fn gpu_bytes(&self) -> u64 {
        match &self.engine {
            Engine::Gpu(layer) => layer.gpu_bytes(),
            Engine::Twin(_) | Engine::Nothing => 0,
        }
    }

    /// The layer on the GPU, where a GPU draws.
    pub fn layer(&mut self) -> Option<&mut SceneLayer> {
        match &mut self.engine {
            Engine::Gpu(layer) => Some(layer),
            Engine::Twin(_) | Engine::Nothing => None,
        }
    }

    /// The units in main memory, where the twin draws.
    #[must_use]
    pub fn twin(&self) -> Option<&TwinScene> {
        match &self.engine {
            Engine::Twin(twin) => Some(twin),
            Engine::Gpu(_) | Engine::Nothing => None,
        }
    }

    /// What parts of the view units would refine, where that was being measured and is known now.
    ///
    /// # Errors
    /// The device was lost.
    pub fn measured(&mut self) -> Result<Option<Footprints>, RenderError> {
        if !self.measuring.is_under_way() {
            return Ok(None);
        }
        self.poll(false)?;
        self.measuring.finish()
    }

    /// Whether something is being measured.
    #[must_use]
    pub fn is_measuring(&self) -> bool {
        self.measuring.is_under_way()
    }

    /// Whether a moment is to be measured that was not.
    #[must_use]
    pub fn is_due(&self, moment: &Moment) -> bool {
        self.measuring.is_due(moment)
    }

    /// What parts of the view units would refine of what is drawn now. Blocks.
    ///
    /// # Errors
    /// The device was lost, or binds no buffer for as many units.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn footprints(
        &mut self,
        moment: &Moment,
        style: &SceneStyle,
    ) -> Result<Footprints, RenderError> {
        self.begin_measuring(moment, style)?;
        self.poll(true)?;
        Ok(self.measuring.finish()?.unwrap_or_default())
    }

    /// Begins to measure what is drawn now.
    ///
    /// # Errors
    /// The device was lost, or binds no buffer for as many units.
    pub fn begin_measuring(
        &mut self,
        moment: &Moment,
        style: &SceneStyle,
    ) -> Result<(), RenderError> {
        let (mut found, mut coming) = (Vec::new(), Vec::new());
        for glance in moment.glances() {
            match &mut self.engine {
                Engine::Gpu(layer) => coming.extend(layer.footprints(&glance, style)?),
                Engine::Twin(twin) => found.extend(twin.footprints(&glance, style)),
                Engine::Nothing => return Ok(()),
            }
        }
        self.measuring.begin(moment, found, coming);
        Ok(())
    }

    /// Lets the device report what it is done with, or waits until it is done with all.
    fn poll(&self, waits: bool) -> Result<(), RenderError> {
        let DrawDevice::Gpu(gpu) = &self.device else {
            return Ok(());
        };
        let poll = match waits {
            true => wgpu::PollType::wait_indefinitely(),
            false => wgpu::PollType::Poll,
        };
        let polled = gpu.device.poll(poll);
        polled
            .map(|_| ())
            .map_err(|reason| RenderError::ReadBack(reason.to_string()))
    }

    /// The texture of the picture that a view shows on the GPU, in front of what is under it; the
    /// next call reuses it. `None` where no GPU draws.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn draw(
        &mut self,
        under: &Under,
        view: &EyeView,
        style: &SceneStyle,
    ) -> Result<Option<&wgpu::Texture>, RenderError> {
        match &mut self.engine {
            Engine::Gpu(layer) => {
                let texture = under.texture.as_ref();
                layer.draw_over(texture, view, style).map(Some)
            }
            Engine::Twin(_) | Engine::Nothing => Ok(None),
        }
    }

    /// The same, on its way to main memory; `None` when nothing draws.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn read(
        &mut self,
        under: &Under,
        view: &EyeView,
        style: &SceneStyle,
    ) -> Result<Option<DrawnPicture>, RenderError> {
        Ok(match &mut self.engine {
            Engine::Gpu(layer) => {
                let texture = under.texture.as_ref();
                Some(DrawnPicture::Coming(layer.read_over(texture, view, style)?))
            }
            Engine::Twin(twin) => {
                let picture = twin.picture_over(under.image.as_ref(), view, style);
                Some(DrawnPicture::Here(picture))
            }
            Engine::Nothing => None,
        })
    }

    /// The same, once it is there. Blocks.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn picture(
        &mut self,
        under: &Under,
        view: &EyeView,
        style: &SceneStyle,
    ) -> Result<Option<RgbaImage>, RenderError> {
        Ok(match (self.read(under, view, style)?, &self.device) {
            (Some(DrawnPicture::Coming(read)), DrawDevice::Gpu(gpu)) => Some(read.wait(gpu)?),
            (Some(DrawnPicture::Here(image)), _) => Some(image),
            (Some(DrawnPicture::Coming(_)) | None, _) => None,
        })
    }
}
