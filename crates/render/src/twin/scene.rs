//! What should be drawn of a scene's units?

use super::cull_clusters::{cull_clusters, is_seen};
use super::draw_clusters::{
    OfCluster, draw_clusters, draw_refiners, place_corner, texture_of_corner, texture_on,
};
use super::footprints::footprints;
use super::shared::pages::TwinPages;
use super::shared::raster::{Fragment, Sides, rasterise};
use super::shared::scene::{SceneInView, triangles_of};
use super::shared::wgsl::code;
use crate::error::RenderError;
use crate::image::RgbaImage;
use crate::meshes::footprints::{
    FootprintSums, GazedParams, footprints_of, pixel_deg2, small_view,
};
use crate::meshes::params::{SceneParams, SceneStyle, TWO_SIDED};
use crate::meshes::placements::Placements;
use crate::meshes::units::{ComingUnit, DrawnCluster, SceneUnits};
use crate::pages::ComingPage;
use foveal_core::content::scene::description::{SceneObject, SceneTexture};
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::footprints::Footprint;
use foveal_core::perception::glance::Glance;
use foveal_core::view::eye_view::EyeView;
use glam::Vec4;
use std::collections::{BTreeMap, HashMap, HashSet};

/// The units of a scene in main memory, and the pictures that are drawn of them.
pub struct TwinScene {
    units: SceneUnits,
    placements: Placements,
    pages: TwinPages,
    refiners: HashMap<(UnitId, u8), UnitId>,
}

impl TwinScene {
    /// No unit of these objects and textures.
    #[must_use]
    pub fn new(objects: &[SceneObject], textures: &[SceneTexture]) -> Self {
        let pages = TwinPages::new(textures, objects);
        Self {
            units: SceneUnits::new(objects.len()),
            placements: Placements::new(objects, &pages.table),
            pages,
            refiners: HashMap::new(),
        }
    }

    /// Adds a unit after its prerequisites.
    ///
    /// # Errors
    /// It does not fit to what is there: nothing changed then.
    pub fn upload(&mut self, coming: &ComingUnit<'_>) -> Result<(), RenderError> {
        self.units.insert(coming).map(|_| ())
    }

    /// Adds a page of a texture after the page that it lies in.
    ///
    /// # Errors
    /// It does not fit to what is there: nothing changed then.
    pub fn upload_page(&mut self, coming: &ComingPage<'_>) -> Result<(), RenderError> {
        self.pages.upload(coming)
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
        self.pages.retain(wanted);
    }

    /// From now on the new vertices of these units have gone so much of their way from the coarse
    /// surface, 0 to 1, and all others are in their places.
    pub fn morph(&mut self, shares: &BTreeMap<UnitId, f64>) {
        self.units.morph(shares);
    }

    /// Triangles of the clusters that a picture is drawn of, also of those that cannot be seen,
    /// each where it stands.
    #[must_use]
    pub fn triangles_drawn(&self) -> u64 {
        let triangles = |(block, _): (DrawnCluster<'_>, u32)| u64::from(triangles_of(&block));
        self.drawn().map(triangles).sum()
    }

    /// Number of clusters that are drawn, and of those of them that can be seen, each where it
    /// stands.
    #[must_use]
    pub fn clusters_seen(&self, view: &EyeView, style: &SceneStyle) -> [usize; 2] {
        let scene = self.scene(view, style);
        let seen = |it: &(DrawnCluster<'_>, u32)| is_seen(&scene, &it.0, it.1);
        [self.drawn().count(), self.drawn().filter(seen).count()]
    }

    /// From now on these are the units that would refine clusters, each by its unit and its number
    /// in it: what [`Self::ids`] shows.
    pub fn set_refiners(&mut self, refiners: HashMap<(UnitId, u8), UnitId>) {
        self.refiners = refiners;
    }

    /// The picture that `view` shows.
    #[must_use]
    pub fn picture(&self, view: &EyeView, style: &SceneStyle) -> RgbaImage {
        let scene = self.scene(view, style);
        let background = style.background();
        let mut image = RgbaImage {
            size: view.size,
            pixels: background.repeat(view.size[0] as usize * view.size[1] as usize),
        };
        self.draw(&scene, view.size, |of_cluster, fragment, texture| {
            let colour = draw_clusters(&scene, of_cluster, fragment, texture);
            image.set_pixel(fragment.pixel, code(colour));
        });
        image
    }

    /// For each pixel of `view`, row by row, the unit that would refine the cluster that is drawn
    /// there, by its number; 4294967295 where none would, and where nothing stands.
    #[must_use]
    pub fn ids(&self, view: &EyeView, style: &SceneStyle) -> Vec<u32> {
        let scene = self.scene(view, style);
        let [columns, rows] = view.size.map(|side| side as usize);
        let mut ids = vec![u32::MAX; columns * rows];
        self.draw(&scene, view.size, |of_cluster, fragment, _| {
            let [x, y] = fragment.pixel.map(|it| it as usize);
            ids[y * columns + x] = draw_refiners(of_cluster);
        });
        ids
    }

    /// What of a glance's view each unit would refine; nothing where it has no view.
    #[must_use]
    pub fn footprints(&self, glance: &Glance, style: &SceneStyle) -> Vec<Footprint> {
        let Some(view) = glance.view.as_ref().map(small_view) else {
            return Vec::new();
        };
        let gazed = GazedParams::new(glance, &view);
        let mut sums: Vec<FootprintSums> = Vec::new();
        let ids = self.ids(&view, style);
        for (place, unit) in (0..).zip(ids).filter(|(_, unit)| *unit != u32::MAX) {
            let unit = unit as usize;
            sums.resize(sums.len().max(unit + 1), FootprintSums::default());
            let pixel = [place % view.size[0], place / view.size[0]];
            footprints(&gazed, pixel, view.size, &mut sums[unit]);
        }
        footprints_of(&sums, pixel_deg2(&gazed, view.size))
    }

    fn scene(&self, view: &EyeView, style: &SceneStyle) -> SceneInView {
        SceneInView {
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

    /// Calls `each` for every pixel that a triangle covers in front of all before it, with the
    /// colour of its texture there.
    fn draw(
        &self,
        scene: &SceneInView,
        size: [u32; 2],
        mut each: impl FnMut(OfCluster, &Fragment, Vec4),
    ) {
        let mut depths = vec![0.0; size[0] as usize * size[1] as usize];
        for (block, placement) in self.drawn() {
            let of_cluster = self.of_cluster(scene, &block, placement);
            let sides = match of_cluster.flags & TWO_SIDED != 0 {
                true => Sides::Both,
                false => Sides::Front,
            };
            let corners = cull_clusters(scene, &block, placement);
            let corner = |number| place_corner(scene, &block, placement, number);
            for triangle in corners.as_chunks::<3>().0 {
                let head = texture_of_corner(&self.pages, of_cluster, &block, triangle[0]);
                rasterise(triangle.map(corner), size, sides, |fragment| {
                    let [x, y] = fragment.pixel.map(|it| it as usize);
                    let depth = &mut depths[y * size[0] as usize + x];
                    if fragment.depth > *depth
                        && let Some(texture) = texture_on(&self.pages, head, &fragment)
                    {
                        *depth = fragment.depth;
                        each(of_cluster, &fragment, texture);
                    }
                });
            }
        }
    }

    fn of_cluster(
        &self,
        scene: &SceneInView,
        block: &DrawnCluster<'_>,
        placement: u32,
    ) -> OfCluster {
        let refiner = self.refiners.get(&(block.unit, block.cluster as u8));
        OfCluster {
            flags: scene.placements[placement as usize].flags,
            level: u32::from(block.note.level),
            refiner: refiner.map_or(u32::MAX, |unit| unit.0),
            textures: scene.placements[placement as usize].textures,
        }
    }
}
