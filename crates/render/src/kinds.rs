//! Which kinds of units has a scene, and what draws each?
//!
//! A kind is registered here, once for the GPU and once for the twin. `ARCHITECTURE.md` lists where
//! else a kind is named.

use crate::error::RenderError;
use crate::gpu::device::Gpu;
use crate::meshes::layer::MeshLayer;
use crate::pages::layer::PageLayer;
use crate::points::layer::PointLayer;
use crate::scene::kind::KindLayer;
use crate::scene::layer::SceneLayer;
use crate::scene::placements::Placements;
use crate::twin::TwinScene;
use crate::twin::scene::layer::TwinLayer;
use crate::twin::scene::meshes::TwinMeshes;
use crate::twin::scene::points::TwinPoints;
use crate::twin::shared::pages::TwinPages;
use foveal_core::content::scene::description::{SceneObject, SceneTexture};
use std::sync::Arc;

impl SceneLayer {
    /// No unit of these objects and textures; units may use `most_bytes` of GPU memory, as
    /// [`unit_bytes`](crate::meshes::unit_bytes) counts them. What lies between units may take an
    /// eighth more, of which pictures take theirs; tables take some bytes a triangle besides.
    ///
    /// # Errors
    /// The objects stand in more places than the device binds.
    pub fn new(
        gpu: &Gpu,
        objects: &[SceneObject],
        textures: &[SceneTexture],
        most_bytes: u64,
    ) -> Result<Self, RenderError> {
        let pages = PageLayer::new(gpu, textures, objects, most_bytes)?;
        let placements = Arc::new(Placements::new(objects, |number, object| {
            pages.table().place_of(number, object)
        }));
        let meshes = MeshLayer::new(gpu, objects, &placements)?;
        let mut layers: Vec<Box<dyn KindLayer>> = vec![Box::new(pages), Box::new(meshes)];
        if objects.iter().any(|it| it.shape.cloud().is_some()) {
            layers.push(Box::new(PointLayer::new(gpu, objects)?));
        }
        Self::of_layers(gpu, layers, placements, most_bytes)
    }
}

impl TwinScene {
    /// No unit of these objects and textures.
    #[must_use]
    pub fn new(objects: &[SceneObject], textures: &[SceneTexture]) -> Self {
        let pages = TwinPages::new(textures, objects);
        let placements = Arc::new(Placements::new(objects, |number, object| {
            pages.table.place_of(number, object)
        }));
        let meshes = TwinMeshes::new(objects.len(), &placements);
        let points = TwinPoints::new(objects);
        let layers: Vec<Box<dyn TwinLayer>> =
            vec![Box::new(pages), Box::new(meshes), Box::new(points)];
        Self::of_layers(layers, placements)
    }
}
