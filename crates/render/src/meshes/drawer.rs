//! What draws a scene's units: the GPU, its CPU twin, or nothing?

use crate::draw_device::{DrawDevice, DrawnPicture};
use crate::error::RenderError;
#[cfg(not(target_arch = "wasm32"))]
use crate::image::RgbaImage;
use crate::meshes::layer::SceneLayer;
use crate::meshes::params::SceneStyle;
use crate::meshes::units::ComingUnit;
use crate::points::units::ComingPoints;
use crate::twin::TwinScene;
use foveal_core::content::scene::description::SceneObject;
use foveal_core::pack::unit::UnitId;
use foveal_core::view::eye_view::EyeView;
use std::collections::{HashMap, HashSet};

/// Units of a scene and what draws them.
pub struct SceneDrawer {
    device: DrawDevice,
    engine: Engine,
}

enum Engine {
    Gpu(Box<SceneLayer>),
    Twin(Box<TwinScene>),
    Nothing,
}

impl SceneDrawer {
    /// No unit of these objects; units may take `most_bytes` of a GPU's memory.
    ///
    /// # Errors
    /// The objects stand in more places than the device binds.
    pub fn new(
        device: &DrawDevice,
        objects: &[SceneObject],
        most_bytes: u64,
    ) -> Result<Self, RenderError> {
        let engine = match device {
            DrawDevice::Gpu(gpu) => {
                Engine::Gpu(Box::new(SceneLayer::new(gpu, objects, most_bytes)?))
            }
            DrawDevice::Twin => Engine::Twin(Box::new(TwinScene::new(objects))),
            DrawDevice::Nothing => Engine::Nothing,
        };
        Ok(Self {
            device: device.clone(),
            engine,
        })
    }

    /// What draws.
    #[must_use]
    pub fn device(&self) -> &DrawDevice {
        &self.device
    }

    /// Adds a unit after its prerequisites; one that is there stays as it is.
    ///
    /// # Errors
    /// It does not fit to what is there or into the GPU's memory: nothing changed then.
    pub fn upload(&mut self, coming: &ComingUnit<'_>) -> Result<(), RenderError> {
        match &mut self.engine {
            Engine::Gpu(layer) => layer.upload(coming),
            Engine::Twin(twin) => twin.upload(coming),
            Engine::Nothing => Ok(()),
        }
    }

    /// Adds a unit of a cloud after the unit that it refines; one that is there stays as it is.
    ///
    /// # Errors
    /// It does not fit to what is there or into the GPU's memory: nothing changed then.
    pub fn upload_points(&mut self, coming: &ComingPoints<'_>) -> Result<(), RenderError> {
        match &mut self.engine {
            Engine::Gpu(layer) => layer.upload_points(coming),
            Engine::Twin(twin) => twin.upload_points(coming),
            Engine::Nothing => Ok(()),
        }
    }

    /// Evicts all units but those that are wanted, what these need, and roots.
    pub fn keep(&mut self, wanted: &HashSet<UnitId>) {
        match &mut self.engine {
            Engine::Gpu(layer) => layer.retain(wanted),
            Engine::Twin(twin) => twin.retain(wanted),
            Engine::Nothing => {}
        }
    }

    /// From now on these are the units that would refine clusters, each by its unit and its number
    /// in it: what an image of ids shows.
    pub fn set_refiners(&mut self, refiners: HashMap<(UnitId, u8), UnitId>) {
        match &mut self.engine {
            Engine::Gpu(layer) => layer.set_refiners(refiners),
            Engine::Twin(twin) => twin.set_refiners(refiners),
            Engine::Nothing => {}
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

    /// The texture of the picture that a view shows on the GPU; the next call reuses it. `None`
    /// where no GPU draws.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn draw(
        &mut self,
        view: &EyeView,
        style: &SceneStyle,
    ) -> Result<Option<&wgpu::Texture>, RenderError> {
        match &mut self.engine {
            Engine::Gpu(layer) => layer.draw(view, style).map(Some),
            Engine::Twin(_) | Engine::Nothing => Ok(None),
        }
    }

    /// The picture that a view shows, on its way to main memory; `None` when nothing draws.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn read(
        &mut self,
        view: &EyeView,
        style: &SceneStyle,
    ) -> Result<Option<DrawnPicture>, RenderError> {
        Ok(match &mut self.engine {
            Engine::Gpu(layer) => Some(DrawnPicture::Coming(layer.read(view, style)?)),
            Engine::Twin(twin) => Some(DrawnPicture::Here(twin.picture(view, style))),
            Engine::Nothing => None,
        })
    }

    /// The picture that a view shows; `None` when nothing draws. Blocks.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn picture(
        &mut self,
        view: &EyeView,
        style: &SceneStyle,
    ) -> Result<Option<RgbaImage>, RenderError> {
        Ok(match &mut self.engine {
            Engine::Gpu(layer) => Some(layer.picture(view, style)?),
            Engine::Twin(twin) => Some(twin.picture(view, style)),
            Engine::Nothing => None,
        })
    }
}
