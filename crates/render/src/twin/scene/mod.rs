//! What should be drawn of a scene's units?

mod cull_clusters;
mod draw_clusters;
mod draw_points;
mod footprints;
mod halve_depths;
mod mark_units;

use crate::error::RenderError;
use crate::image::RgbaImage;
use crate::meshes::units::{ComingUnit, DrawnCluster, SceneUnits};
use crate::pages::ComingPage;
use crate::points::cubes::standing;
use crate::points::units::{CloudUnits, ComingPoints};
use crate::scene::footprints::{FootprintSums, GazedParams, footprints_of, pixel_deg2, small_view};
use crate::scene::params::{SceneParams, SceneStyle, TWO_SIDED};
use crate::scene::placements::Placements;
use crate::twin::shared::pages::TwinPages;
use crate::twin::shared::raster::{Covered, Fragment, Sides, rasterise};
use crate::twin::shared::scene::{SceneInView, triangles_of};
use crate::twin::shared::wgsl::code;
use cull_clusters::{DrawnDepths, cull_clusters, is_hidden, is_seen};
use draw_clusters::{
    OfCluster, draw_clusters, draw_refiners, place_corner, texture_of_corner, texture_on,
};
use draw_points::{CloudInView, Splat, draw_point_refiners, draw_points, place_splat};
use footprints::footprints;
use foveal_core::content::scene::description::{SceneObject, SceneTexture};
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::footprints::Footprint;
use foveal_core::perception::glance::Glance;
use foveal_core::view::eye_view::EyeView;
use glam::{Vec2, Vec4};
use mark_units::mark_units;
use std::collections::{BTreeMap, HashMap, HashSet};

/// The units of a scene in main memory, and the pictures that are drawn of them.
pub struct TwinScene {
    units: SceneUnits,
    placements: Placements,
    pages: TwinPages,
    refiners: HashMap<(UnitId, u8), UnitId>,
    clouds: CloudUnits,
    objects: Vec<SceneObject>,
    /// What units are worth, where pictures are to show that.
    worths: Option<Vec<f32>>,
}

/// How near what is drawn in each pixel is; larger is nearer.
struct Depths {
    size: [u32; 2],
    depths: Vec<f32>,
}

impl Depths {
    fn of(size: [u32; 2]) -> Self {
        let depths = vec![0.0; size[0] as usize * size[1] as usize];
        Self { size, depths }
    }

    /// Whether something is in front of all before it.
    fn has_behind(&self, covered: &Covered<'_>) -> bool {
        let [x, y] = covered.pixel.map(|it| it as usize);
        covered.depth > self.depths[y * self.size[0] as usize + x]
    }

    /// Whether something is in front of all before it, which it is from now on.
    fn pass(&mut self, covered: &Covered<'_>) -> bool {
        let [x, y] = covered.pixel.map(|it| it as usize);
        let depth = &mut self.depths[y * self.size[0] as usize + x];
        let passes = covered.depth > *depth;
        *depth = depth.max(covered.depth);
        passes
    }
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
            clouds: CloudUnits::new(objects),
            objects: objects.to_vec(),
            worths: None,
        }
    }

    /// From now on paints over pictures what the unit is worth that would refine what a pixel
    /// shows, 0 to 1 by its number, less than 0 where that is not known; or nothing.
    pub fn mark(&mut self, worths: Option<&[f32]>) {
        self.worths = worths.map(<[f32]>::to_vec);
    }

    /// Adds a unit after its prerequisites.
    ///
    /// # Errors
    /// It does not fit to what is there: nothing changed then.
    pub fn upload(&mut self, coming: &ComingUnit<'_>) -> Result<(), RenderError> {
        self.units.insert(coming).map(|_| ())
    }

    /// Adds a unit of a cloud after the unit that it refines.
    ///
    /// # Errors
    /// It does not fit to what is there: nothing changed then.
    pub fn upload_points(&mut self, coming: &ComingPoints<'_>) -> Result<(), RenderError> {
        self.clouds.insert(coming).map(|_| ())
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
        self.clouds.remove(unit);
    }

    /// Takes all units away but those that are wanted, what these need, and roots.
    pub fn retain(&mut self, wanted: &HashSet<UnitId>) {
        self.units.retain(wanted);
        for unit in self.clouds.to_go(wanted) {
            self.clouds.remove(unit);
        }
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

    /// Number of clusters that can be seen in `view`, but are hidden by what `before` shows.
    #[must_use]
    pub fn clusters_hidden(&self, view: &EyeView, before: &EyeView, style: &SceneStyle) -> usize {
        let scene = self.scene(view, style);
        let drawn = self.depths(before, style);
        let hidden = |(block, placement): &(DrawnCluster<'_>, u32)| {
            is_seen(&scene, block, *placement) && is_hidden(&drawn, block, *placement)
        };
        self.drawn().filter(hidden).count()
    }

    /// How near what `view` shows is at least, in squares of pixels.
    fn depths(&self, view: &EyeView, style: &SceneStyle) -> DrawnDepths {
        let scene = self.scene(view, style);
        let mut depths = Depths::of(view.size);
        self.draw(&scene, &mut depths, |_, _, _| ());
        DrawnDepths::new(scene, &depths.depths)
    }

    /// From now on these are the units that would refine clusters, each by its unit and its number
    /// in it: what [`Self::ids`] shows.
    pub fn set_refiners(&mut self, refiners: HashMap<(UnitId, u8), UnitId>) {
        self.clouds.set_refiners(refiners.clone());
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
        let mut depths = Depths::of(view.size);
        self.draw(&scene, &mut depths, |of_cluster, fragment, texture| {
            let colour = draw_clusters(&scene, of_cluster, fragment, texture);
            image.set_pixel(fragment.pixel, code(colour));
        });
        self.draw_clouds(&scene, view, &mut depths, |splat, fragment| {
            image.set_pixel(fragment.pixel, code(draw_points(splat)));
        });
        if let Some(worths) = &self.worths {
            self.paint(worths, &mut image, &self.ids(view, style));
        }
        image
    }

    /// Paints what units are worth over a picture of what they would refine.
    fn paint(&self, worths: &[f32], image: &mut RgbaImage, ids: &[u32]) {
        for (pixel, unit) in image.pixels.as_chunks_mut::<4>().0.iter_mut().zip(ids) {
            let mark = mark_units(worths, *unit);
            let under = Vec4::from(pixel.map(|it| f32::from(it) / 255.0));
            *pixel = code(under.lerp(mark.truncate().extend(1.0), mark.w));
        }
    }

    /// For each pixel of `view`, row by row, the unit that would refine the cluster that is drawn
    /// there, by its number; 4294967295 where none would, and where nothing stands.
    #[must_use]
    pub fn ids(&self, view: &EyeView, style: &SceneStyle) -> Vec<u32> {
        let scene = self.scene(view, style);
        let [columns, rows] = view.size.map(|side| side as usize);
        let mut ids = vec![u32::MAX; columns * rows];
        let mut depths = Depths::of(view.size);
        self.draw(&scene, &mut depths, |of_cluster, fragment, _| {
            let [x, y] = fragment.pixel.map(|it| it as usize);
            ids[y * columns + x] = draw_refiners(of_cluster);
        });
        self.draw_clouds(&scene, view, &mut depths, |splat, fragment| {
            let [x, y] = fragment.pixel.map(|it| it as usize);
            ids[y * columns + x] = draw_point_refiners(splat);
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
        let coarsest = self.units.coarsest().max(self.clouds.coarsest());
        SceneInView {
            params: SceneParams::new(view, style, coarsest),
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
        depths: &mut Depths,
        mut each: impl FnMut(OfCluster, &Fragment, Vec4),
    ) {
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
                rasterise(triangle.map(corner), depths.size, sides, |covered| {
                    if !depths.has_behind(covered) {
                        return;
                    }
                    let fragment = covered.fragment();
                    if let Some(texture) = texture_on(&self.pages, head, &fragment) {
                        depths.pass(covered);
                        each(of_cluster, &fragment, texture);
                    }
                });
            }
        }
    }

    /// Calls `each` for every pixel that a point covers in front of all before it.
    fn draw_clouds(
        &self,
        scene: &SceneInView,
        view: &EyeView,
        depths: &mut Depths,
        mut each: impl FnMut(&Splat, &Fragment),
    ) {
        let standing = standing(&self.clouds, &self.objects);
        let cloud = CloudInView {
            cubes: standing.iter().map(|it| it.seen_by(view)).collect(),
            half_pixel: Vec2::from(view.size.map(|side| 1.0 / side.max(1) as f32)),
        };
        for (number, cube) in (0..).zip(&standing) {
            let there = self.clouds.unit(cube.unit);
            let of = there.and_then(|(note, _)| self.clouds.cloud(note.object));
            let (Some((_, placed)), Some(of)) = (there, of) else {
                continue;
            };
            for point in placed.drawn() {
                let splat = place_splat(scene, &cloud, number, (point, of));
                for triangle in [[0, 1, 2], [3, 2, 1]] {
                    let triangle = triangle.map(|corner: usize| splat.corners[corner]);
                    rasterise(triangle, depths.size, Sides::Both, |covered| {
                        if depths.pass(covered) {
                            each(&splat, &covered.fragment());
                        }
                    });
                }
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
