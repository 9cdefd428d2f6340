//! What should be drawn of a scene's units?

use super::code;
use super::cull_clusters::cull_clusters;
use super::draw_clusters::{OfCluster, draw_clusters, place_corner};
use super::shared::raster::{Sides, rasterise};
use super::shared::scene::{Scene, triangles_of};
use crate::error::RenderError;
use crate::image::RgbaImage;
use crate::meshes::params::{BACKGROUND, SceneParams, SceneStyle, TWO_SIDED};
use crate::meshes::placements::Placements;
use crate::meshes::units::{ComingUnit, DrawnCluster, SceneUnits};
use foveal_core::content::scene::description::SceneObject;
use foveal_core::pack::unit::UnitId;
use foveal_core::view::eye_view::EyeView;
use glam::Vec3;
use std::collections::HashSet;

/// The units of a scene in main memory, and the pictures that are drawn of them.
pub struct TwinScene {
    units: SceneUnits,
    placements: Placements,
}

/// A picture with the depth of each pixel.
struct Target {
    image: RgbaImage,
    depths: Vec<f32>,
}

impl TwinScene {
    /// No unit of these objects.
    #[must_use]
    pub fn new(objects: &[SceneObject]) -> Self {
        Self {
            units: SceneUnits::new(objects.len()),
            placements: Placements::new(objects),
        }
    }

    /// Adds a unit after its prerequisites.
    ///
    /// # Errors
    /// It does not fit to what is there: nothing changed then.
    pub fn upload(&mut self, coming: &ComingUnit<'_>) -> Result<(), RenderError> {
        self.units.insert(coming).map(|_| ())
    }

    /// Takes a unit away.
    ///
    /// # Panics
    /// No other that is there may need it.
    pub fn remove(&mut self, unit: UnitId) {
        self.units.remove(unit);
    }

    /// Takes all units away but those that are wanted, what these need, and roots.
    pub fn retain(&mut self, wanted: &HashSet<UnitId>) {
        self.units.retain(wanted);
    }

    /// Number of clusters that are drawn, and of those of them that can be seen, each where it
    /// stands.
    #[must_use]
    pub fn clusters_seen(&self, view: &EyeView, style: &SceneStyle) -> [usize; 2] {
        let scene = self.scene(view, style);
        let seen = |it: &(DrawnCluster<'_>, u32)| cull_clusters(&scene, &it.0, it.1);
        [self.drawn().count(), self.drawn().filter(seen).count()]
    }

    /// The picture that `view` shows.
    #[must_use]
    pub fn picture(&self, view: &EyeView, style: &SceneStyle) -> RgbaImage {
        let scene = self.scene(view, style);
        let mut target = Target::new(view.size);
        for (block, placement) in self.drawn() {
            if !style.culls || cull_clusters(&scene, &block, placement) {
                target.draw(&scene, &block, placement);
            }
        }
        target.image
    }

    fn scene(&self, view: &EyeView, style: &SceneStyle) -> Scene {
        Scene {
            params: SceneParams::new(view, style, self.units.coarsest()),
            placements: self.placements.seen_by(view),
        }
    }

    /// The clusters that are drawn, each where it stands.
    fn drawn(&self) -> impl Iterator<Item = (DrawnCluster<'_>, u32)> {
        self.units.drawn().flat_map(|block| {
            let placements = self.placements.of(block.note.object);
            placements.map(move |placement| (block, placement))
        })
    }
}

impl Target {
    /// A picture of nothing.
    fn new(size: [u32; 2]) -> Self {
        let background = code(Vec3::splat(BACKGROUND).extend(1.0));
        let count = size[0] as usize * size[1] as usize;
        let pixels = background.repeat(count);
        Self {
            image: RgbaImage { size, pixels },
            depths: vec![0.0; count],
        }
    }

    fn draw(&mut self, scene: &Scene, block: &DrawnCluster<'_>, placement: u32) {
        let of_cluster = OfCluster {
            flags: scene.placements[placement as usize].flags,
            level: u32::from(block.note.level),
        };
        let sides = match of_cluster.flags & TWO_SIDED != 0 {
            true => Sides::Both,
            false => Sides::Front,
        };
        let size = self.image.size;
        for triangle in 0..triangles_of(block) {
            let corner = |k| place_corner(scene, block, placement, 3 * triangle + k);
            rasterise([0, 1, 2].map(corner), size, sides, |fragment| {
                let [x, y] = fragment.pixel.map(|it| it as usize);
                let depth = &mut self.depths[y * size[0] as usize + x];
                if fragment.depth > *depth {
                    *depth = fragment.depth;
                    let colour = draw_clusters(scene, of_cluster, &fragment);
                    self.image.set_pixel(fragment.pixel, code(colour));
                }
            });
        }
    }
}
